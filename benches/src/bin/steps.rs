//! Does a number of steps of one case and nothing else, for a tool that counts instructions; or
//! counts them itself.
//!
//!     steps CASE SIZE STEPS
//!     steps CASE SIZE

#![allow(clippy::print_stdout, reason = "prints a count")]

use std::env;

use yardstick::cases::Case;
use yardstick::instructions::Counter;

fn main() -> Result<(), String> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let number = |text: &String| {
        let number = text.parse::<u32>();
        number.map_err(|_| format!("`{text}` is no number"))
    };
    match &arguments[..] {
        [case, size] => {
            let counter = Counter::find().ok_or("there is no valgrind here")?;
            let count = counter.count(&Case::new(case, number(size)? as usize))?;
            println!("{count:.0} instructions per step");
        }
        [case, size, steps] => {
            Case::new(case, number(size)? as usize).run()?(number(steps)?.into());
        }
        _ => return Err("usage: steps CASE SIZE [STEPS]".to_owned()),
    }
    Ok(())
}

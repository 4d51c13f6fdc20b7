//! Does a number of steps of one case and nothing else, for a tool that counts instructions; or
//! counts them itself.
//!
//!     steps CASE SIZE STEPS [ROUNDS]
//!     steps CASE SIZE
//!
//! With rounds, it does the steps as many times and prints the time of the quickest round.

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
        [case, size, steps, rounds] => {
            let mut run = Case::new(case, number(size)? as usize).run()?;
            let steps = u64::from(number(steps)?.max(1));
            let times = (0..number(rounds)?.max(1)).map(|_| run(steps));
            let least = times.min().unwrap_or_default().as_secs_f64();
            println!("{:.1} ns per step", 1e9 * least / steps as f64);
        }
        _ => return Err("usage: steps CASE SIZE [STEPS [ROUNDS]]".to_owned()),
    }
    Ok(())
}

//! Attacks the solver with generated mechanisms: `attack [CASES [SEED [KIND]]]`.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program for the terminal"
)]

use std::process::ExitCode;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: u64| {
        let given = arguments.next();
        given.map_or(Ok(default), |text| text.parse())
    };
    let (Ok(cases), Ok(seed)) = (number(1000), number(1)) else {
        eprintln!("usage: attack [CASES [SEED [KIND]]]");
        return ExitCode::from(2);
    };
    let kind = arguments.next();
    let mut differ = 0;
    for (index, (name, _)) in fuzz::attack::KINDS.iter().enumerate() {
        if kind.as_deref().is_some_and(|kind| kind != *name) {
            continue;
        }
        let counts = fuzz::attack::run(index, seed, cases, |case, words| {
            println!("{name}, seed {case}: {words}");
        });
        println!("{name}, seeds {seed} to {}: {counts:?}", seed + cases - 1);
        differ += counts.differ;
    }
    if differ == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

//! Attacks the solver with generated mechanisms: `attack [CASES [SEED [KIND [fixed|moving]]]]`.

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
        eprintln!("usage: attack [CASES [SEED [KIND [fixed|moving]]]]");
        return ExitCode::from(2);
    };
    let kind = arguments.next();
    let only = arguments.next();
    let mut differ = 0;
    for (index, (name, _)) in fuzz::attack::KINDS.iter().enumerate() {
        if kind.as_deref().is_some_and(|kind| kind != *name) {
            continue;
        }
        for (moving, lengths) in [(false, "fixed"), (true, "moving")] {
            if only.as_deref().is_some_and(|only| only != lengths) {
                continue;
            }
            let kind = (index, moving);
            let counts = fuzz::attack::run(kind, seed, cases, |case, words| {
                println!("{name}, {lengths} lengths, seed {case}: {words}");
                if cases == 1 {
                    println!("{:#?}", fuzz::attack::plain_case(kind, case));
                }
            });
            let last = seed + cases - 1;
            println!("{name}, {lengths} lengths, seeds {seed} to {last}: {counts:?}");
            differ += counts.differ;
        }
    }
    if differ == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

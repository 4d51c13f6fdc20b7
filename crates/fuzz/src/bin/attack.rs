//! Attacks the solver with generated mechanisms:
//! `attack [CASES [SEED [KIND [fixed|moving|corners|rough|none|extremes]]]]`.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program for the terminal"
)]

use std::process::ExitCode;

use fuzz::attack::Variant;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: u64| {
        let given = arguments.next();
        given.map_or(Ok(default), |text| text.parse())
    };
    let (Ok(cases), Ok(seed)) = (number(1000), number(1)) else {
        eprintln!("usage: attack [CASES [SEED [KIND [fixed|moving|corners|rough|none|extremes]]]]");
        return ExitCode::from(2);
    };
    let kind = arguments.next();
    let only = arguments.next();
    let mut differ = 0;
    for (index, (name, _)) in fuzz::attack::KINDS.iter().enumerate() {
        if kind.as_deref().is_some_and(|kind| kind != *name) {
            continue;
        }
        for (variant, word, words) in [
            (Variant::Fixed, "fixed", "fixed lengths"),
            (Variant::Moving, "moving", "moving lengths"),
            (Variant::Cornered, "corners", "lengths with corners"),
            (Variant::Rough, "rough", "rough estimates"),
            (Variant::LeftOut, "none", "no estimates"),
        ] {
            // Without estimates gears have no nearest branch: asked for only.
            let is_asked = only.as_deref().map(|only| only == word);
            if !is_asked.unwrap_or(variant != Variant::LeftOut) {
                continue;
            }
            let kind = (index, variant);
            let counts = fuzz::attack::run(kind, seed, cases, |case, finding| {
                println!("{name}, {words}, seed {case}: {finding}");
                if cases == 1 {
                    println!("{:#?}", fuzz::attack::plain_case(kind, case));
                }
            });
            let last = seed + cases - 1;
            println!("{name}, {words}, seeds {seed} to {last}: {counts:?}");
            differ += counts.differ;
        }
        if only.as_deref().is_none_or(|only| only == "extremes") {
            let kind = (index, Variant::Fixed);
            let counts = fuzz::attack::run_extremes(kind, seed, cases, |case, finding| {
                println!("{name}, extremes, seed {case}: {finding}");
                if cases == 1 {
                    println!("{:#?}", fuzz::attack::plain_case(kind, case));
                }
            });
            println!("{name}, extremes, seed {seed} on: {counts:?}");
            differ += counts.differ;
        }
    }
    for (index, (name, _)) in fuzz::attack::FORCE_KINDS.iter().enumerate() {
        if kind.as_deref().is_some_and(|kind| kind != *name) {
            continue;
        }
        let counts = fuzz::attack::run_forces(index, seed, cases, |case, finding| {
            println!("{name}, seed {case}: {finding}");
            if cases == 1 {
                println!("{}", fuzz::attack::force_case(index, case));
            }
        });
        let last = seed + cases - 1;
        println!("{name}, seeds {seed} to {last}: {counts:?}");
        differ += counts.differ;
    }
    for (index, (name, _)) in fuzz::attack::FREE_KINDS.iter().enumerate() {
        if kind.as_deref().is_some_and(|kind| kind != *name) {
            continue;
        }
        let counts = fuzz::attack::run_free(index, seed, cases, |case, finding| {
            println!("{name}, seed {case}: {finding}");
        });
        if cases == 1 {
            println!("{}", fuzz::attack::free_case(index, seed));
            println!("{}", fuzz::attack::free_events(index, seed));
        }
        let last = seed + cases - 1;
        println!("{name}, seeds {seed} to {last}: {counts:?}");
        differ += counts.differ;
    }
    if differ == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

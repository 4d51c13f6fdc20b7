//! Does so many steps of one case and nothing else, for a tool that counts instructions.
//!
//!     steps CASE SIZE STEPS

use std::hint::black_box;

use set_up::runtime_library;
use yardstick::generated::{Ground, chain, scissor_lift};
use yardstick::motion::{Moving, Sweep};
use yardstick::yardstick::{Chain, Cycle, Kind, OUTPUTS, four_bar};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [case, size, steps] = &arguments[..] else {
        panic!("usage: steps CASE SIZE STEPS")
    };
    let size: usize = size.parse().expect("a number");
    let steps: u64 = steps.parse().expect("a number");
    match case.as_str() {
        "closed_form" => {
            let mut out = [0.0; OUTPUTS];
            let mut sweep = Sweep::turn(10_000);
            repeat(steps, || four_bar(sweep.step(), black_box(&mut out)));
        }
        "four_bar" => moving(
            include_str!("../../../mechanisms/four_bar.toml"),
            Sweep::turn(10_000),
            steps,
        ),
        "chain" => moving(&chain(size, Ground::Straight), Sweep::turn(10_000), steps),
        "lift" => moving(&scissor_lift(size), Sweep::lift(size), steps),
        "c_chain" => c_chain(size, Kind::Plain, steps),
        "c_chain_updated" => c_chain(size, Kind::Updated, steps),
        "c_chain_condition" => c_chain(size, Kind::Condition, steps),
        "c_fmu" => drop(Cycle::yardstick().run(steps)),
        "fmu" => drop(Cycle::biela(&runtime_library()).run(steps)),
        other => panic!("no case `{other}`"),
    }
}

fn repeat(steps: u64, mut step: impl FnMut()) {
    for _ in 0..steps {
        step();
    }
}

fn moving(text: &str, mut sweep: Sweep, steps: u64) {
    let mut mechanism = Moving::new(text);
    repeat(steps, || {
        black_box(mechanism.step(sweep.step()));
    });
}

fn c_chain(loops: usize, kind: Kind, steps: u64) {
    let mut chain = Chain::new(loops, Ground::Straight);
    let mut sweep = Sweep::turn(10_000);
    repeat(steps, || {
        black_box(chain.step(kind, sweep.step()));
    });
}

//! Times of biela and of the yardsticks, side by side.

use std::hint::black_box;
use std::time::Duration;

use biela::kinematics::Solver;
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use set_up::runtime_library;
use yardstick::generated::{Ground, chain, scissor_lift};
use yardstick::motion::{Moving, Sweep, set_up};
use yardstick::sizes;
use yardstick::yardstick::{Chain, Cycle, Kind, OUTPUTS, four_bar};

const FOUR_BAR: &str = include_str!("../../mechanisms/four_bar.toml");
/// Steps a turn of the crank: coarse, by degrees, fine.
const TURNS: [u32; 3] = [100, 360, 10_000];

/// Position, velocity and acceleration of the four-bar's bodies.
fn step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("four_bar");
    let mut sweep = Sweep::turn(10_000);
    let mut out = [0.0; OUTPUTS];
    group.bench_function("c", |b| {
        b.iter(|| four_bar(sweep.step(), black_box(&mut out)));
    });
    for turn in TURNS {
        let mut sweep = Sweep::turn(turn);
        let mut mechanism = Moving::new(FOUR_BAR);
        group.bench_function(BenchmarkId::new("biela", turn), |b| {
            b.iter(|| mechanism.step(sweep.step()));
        });
    }
    group.finish();
}

/// A cycle of the FMU, timed in C.
fn fmu(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("fmu");
    let mut cycle = Cycle::yardstick();
    group.bench_function("c", |b| b.iter_custom(|cycles| cycle.run(cycles)));
    let mut cycle = Cycle::biela(&runtime_library());
    group.bench_function("biela", |b| b.iter_custom(|cycles| cycle.run(cycles)));
    group.finish();
}

/// Chains, 10,000 steps a turn.
fn chains(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("chain");
    for loops in sizes::CHAIN {
        for (name, kind) in [
            ("c", Kind::Plain),
            ("c_updated", Kind::Updated),
            ("c_condition", Kind::Condition),
        ] {
            let mut sweep = Sweep::turn(10_000);
            let mut chain = Chain::new(loops, Ground::Straight);
            group.bench_function(BenchmarkId::new(name, loops), |b| {
                b.iter(|| chain.step(kind, sweep.step()));
            });
        }
    }
    for loops in sizes::chain() {
        let mut sweep = Sweep::turn(10_000);
        let mut mechanism = Moving::new(&chain(loops, Ground::Straight));
        group.bench_function(BenchmarkId::new("biela", loops), |b| {
            b.iter(|| mechanism.step(sweep.step()));
        });
    }
    group.finish();
}

/// A chain of ten loops at other step sizes.
fn coarse(criterion: &mut Criterion) {
    for turn in [100, 360] {
        let mut group = criterion.benchmark_group(format!("chain_{turn}"));
        let mut sweep = Sweep::turn(turn);
        let mut yardstick = Chain::new(10, Ground::Straight);
        group.bench_function(BenchmarkId::new("c", 10), |b| {
            b.iter(|| yardstick.step(Kind::Plain, sweep.step()));
        });
        let mut sweep = Sweep::turn(turn);
        let mut mechanism = Moving::new(&chain(10, Ground::Straight));
        group.bench_function(BenchmarkId::new("biela", 10), |b| {
            b.iter(|| mechanism.step(sweep.step()));
        });
        group.finish();
    }
}

/// Scissor lifts driven by the height of the free end.
fn lifts(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("lift");
    for cells in sizes::lift() {
        let mut sweep = Sweep::lift(cells);
        let mut mechanism = Moving::new(&scissor_lift(cells));
        group.bench_function(BenchmarkId::new("biela", cells), |b| {
            b.iter(|| mechanism.step(sweep.step()));
        });
    }
    group.finish();
}

/// From the text to the first pose.
fn set_ups(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("set_up");
    let made = |text: &str| -> Solver { set_up(text).0 };
    for loops in sizes::set_up() {
        let text = chain(loops, Ground::Straight);
        group.bench_function(BenchmarkId::new("biela", loops), |b| {
            b.iter_with_large_drop(|| made(&text));
        });
    }
    let text = scissor_lift(sizes::TEN_BODIES);
    group.bench_function("ten_bodies", |b| b.iter_with_large_drop(|| made(&text)));
    group.finish();
}

fn short() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1200))
        .sample_size(40)
}

criterion_group! {
    name = benches;
    config = short();
    targets = step, fmu, chains, coarse, lifts, set_ups
}
criterion_main!(benches);

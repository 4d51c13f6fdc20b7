//! Prints how biela compares with the yardsticks, as tables: times from criterion's files,
//! instructions, memory and errors measured here.
//!
//!     ratios [README]
//!
//! The tables also replace those between the two marks in README, if given.

#![allow(clippy::print_stdout, reason = "prints tables")]

mod memory;
mod table;
mod times;

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::f64::consts::TAU;

use biela::mechanism::Jet;
use memory::kept;
use table::{or_not_run, short, table};
use times::{Time, time};
use yardstick::by_hand::four_bar;
use yardstick::cases::Case;
use yardstick::chain::{Chain, Kind};
use yardstick::comparisons::{Comparison, comparisons, counted_cases, lifts, set_ups};
use yardstick::free::{RUNS, Run};
use yardstick::generated::{Ground, chain};
use yardstick::instructions::Counter;
use yardstick::motion::{Moving, Stepper, Sweep};
use yardstick::sizes;

const FROM: &str = "<!-- ratios: from here -->\n";
const TO: &str = "<!-- ratios: to here -->";

fn main() {
    let counter = Counter::find();
    let mut out = String::new();
    ratios(&mut out, counter.as_ref());
    without_yardstick(&mut out, counter.as_ref());
    free_runs(&mut out);
    libraries(&mut out);
    chains(&mut out);
    scissor_lifts(&mut out, counter.as_ref());
    set_up(&mut out);
    long_run(&mut out);
    yardsticks(&mut out);
    if counter.is_none() {
        out += "Instructions were not counted: there is no valgrind here.\n";
    }
    println!("{out}");
    if let Some(readme) = std::env::args().nth(1) {
        let text = std::fs::read_to_string(&readme).expect("the README can be read");
        let (before, rest) = text.split_once(FROM).expect("the README has the mark");
        let (_, after) = rest
            .split_once(TO)
            .expect("the README has the closing mark");
        let text = format!("{before}{FROM}\n{out}{TO}{after}");
        std::fs::write(&readme, text).expect("the README can be written");
    }
}

/// Counts the instructions per step of a case, if valgrind is there.
fn count(counter: Option<&Counter>, case: &Case) -> Option<f64> {
    let counter = counter?;
    let count = counter.count(case);
    Some(count.unwrap_or_else(|error| panic!("{} {}: {error}", case.name, case.size)))
}

/// Writes the ratio of two numbers with the numbers.
fn fraction(a: f64, b: f64) -> String {
    format!("{} ({} / {})", short(a / b), short(a), short(b))
}

/// Biela beside its yardsticks.
fn ratios(out: &mut String, counter: Option<&Counter>) {
    let row = |comparison: Comparison| {
        let Comparison {
            what,
            mark,
            biela,
            yardstick,
        } = comparison;
        let times = [&biela, &yardstick].map(|case| Some(time(case)?.of_each(case.size)));
        let counts = [&biela, &yardstick].map(|case| count(counter, case));
        let ratio = |[ours, theirs]: [Time; 2]| {
            let [least, median] = [ours.least / theirs.least, ours.median / theirs.median];
            format!("{} ({})", short(least), short(median))
        };
        [
            what,
            mark.to_owned(),
            or_not_run(both(times), ratio),
            or_not_run(both(counts), |[ours, theirs]| fraction(ours, theirs)),
            or_not_run(times[0], Time::write),
            or_not_run(times[1], Time::write),
        ]
    };
    table(
        out,
        [
            "one step or cycle",
            "mark",
            "time, biela / yardstick: least (median)",
            "instructions, biela / yardstick",
            "biela",
            "yardstick",
        ],
        comparisons().into_iter().map(row),
    );
}

fn both<T>([a, b]: [Option<T>; 2]) -> Option<[T; 2]> {
    Some([a?, b?])
}

/// Instructions of mechanisms that have no yardstick.
fn without_yardstick(out: &mut String, counter: Option<&Counter>) {
    let row = |case: Case| {
        let count = or_not_run(count(counter, &case), short);
        [case.name, count]
    };
    table(
        out,
        ["mechanism without yardstick", "instructions per step"],
        counted_cases().into_iter().map(row),
    );
}

/// Whole runs of free motion.
fn free_runs(out: &mut String) {
    const REPEATS: usize = 5;
    let row = |run: &Run| {
        let costs = [(); REPEATS].map(|()| run.cost(run.steps));
        let quickest = costs.into_iter().min_by(|a, b| a.time.total_cmp(&b.time));
        let cost = quickest.expect("it ran");
        let events = match cost.events {
            0 => String::new(),
            events => format!("{events} ({} per second)", short(events as f64 / cost.time)),
        };
        [
            run.what.to_owned(),
            format!("{} ms", short(1e3 * cost.time)),
            cost.evaluations.to_string(),
            events,
            format!("{:.0e} J", cost.energy_error.abs()),
            run.published.to_owned(),
        ]
    };
    table(
        out,
        [
            "run at tolerance 1e-8",
            "time",
            "evaluations",
            "events",
            "error of the energy",
            "published, on other machines",
        ],
        RUNS.iter().map(row),
    );
}

/// Sizes of what an FMU and a page carry, as far as they are built.
fn libraries(out: &mut String) {
    let release = std::env::current_exe().expect("this program runs from a file");
    let target = release.ancestors().nth(2).expect("it is in target/release");
    let row = |(what, file): (&str, &str)| {
        let size = std::fs::metadata(target.join(file));
        let size = size.map(|size| format!("{:.2} MB", size.len() as f64 * 1e-6));
        [
            what.to_owned(),
            size.unwrap_or_else(|_| "not built (`make page`)".to_owned()),
        ]
    };
    let library = format!("release/{DLL_PREFIX}biela_runtime{DLL_SUFFIX}");
    table(
        out,
        ["built here", "size"],
        [
            ("library inside an FMU", library.as_str()),
            ("solver of a page", "runtimes/page.wasm"),
        ]
        .map(row),
    );
}

/// Measures time, memory and errors over the length of a chain.
fn chains(out: &mut String) {
    let row = |loops: usize| {
        let each = |bytes: usize| format!("{}", bytes / loops);
        let theirs = error(loops, Chain::new(loops, Ground::Straight, Kind::Plain));
        let ours = time(&Case::new("chain", loops)).map(|time| time.of_each(loops));
        let mut bytes = 0;
        let [straight, zigzag] = [Ground::Straight, Ground::Zigzag].map(|ground| {
            let text = chain(loops, ground);
            let (mechanism, kept) = kept(|| Moving::new(&text));
            bytes = kept;
            error(loops, mechanism)
        });
        [
            format!("{loops}"),
            or_not_run(ours, Time::write),
            each(bytes),
            each(Chain::bytes(loops)),
            format!("{straight:.0e} ({zigzag:.0e})"),
            format!("{theirs:.0e}"),
        ]
    };
    table(
        out,
        [
            "chain",
            "biela: time per loop",
            "biela: bytes per loop",
            "C: bytes per loop",
            "biela: error of acceleration (zigzag)",
            "C: error of acceleration",
        ],
        sizes::chain().into_iter().map(row),
    );
    *out += "Marks: time and memory per loop within a factor 1.5 up to 10,000 loops, errors at \
             most 1e-10.\n\n";
}

/// Returns the largest error of a rocker's acceleration over a turn in 100 steps, relative to the
/// largest acceleration.
fn error(loops: usize, mut chain: impl Stepper) -> f64 {
    let mut sweep = Sweep::turn(100);
    let mut closed_form = four_bar();
    let (mut error, mut largest) = (0.0_f64, 0.0_f64);
    for _ in 0..100 {
        let crank = sweep.step();
        chain.step(&[crank]);
        let truth = closed_form.at(crank)[26];
        let [_, _, found] = chain.state();
        largest = largest.max(truth.abs());
        for rocker in 0..loops {
            error = error.max((found[6 * rocker + 8] - truth).abs());
        }
    }
    error / largest
}

/// Time and instructions of scissor lifts.
fn scissor_lifts(out: &mut String, counter: Option<&Counter>) {
    let mut growth = Growth::default();
    let row = |case: Case| {
        let time = time(&case);
        [
            format!("{}", case.size),
            or_not_run(time, Time::write),
            growth.exponent(case.size, time),
            or_not_run(count(counter, &case), short),
        ]
    };
    table(
        out,
        [
            "scissor lift",
            "biela: time per step",
            "growth: exponent of the cells",
            "instructions per step",
        ],
        lifts().map(row),
    );
    *out += "Mark: growth no worse than 1.2.\n\n";
}

/// Exponent of the size in the growth of time, from one row of a table to the next.
#[derive(Default)]
struct Growth {
    before: Option<(usize, Time)>,
}

impl Growth {
    fn exponent(&mut self, size: usize, time: Option<Time>) -> String {
        let before = std::mem::replace(&mut self.before, time.map(|time| (size, time)));
        let (Some((smaller, before)), Some(time)) = (before, time) else {
            return String::new();
        };
        let exponent = (time.least / before.least).ln() / (size as f64 / smaller as f64).ln();
        format!("{exponent:.2}")
    }
}

/// Times of set-up.
fn set_up(out: &mut String) {
    let mut growth = Growth::default();
    let row = |case: Case| {
        let time = time(&case);
        let (what, mark, exponent) = match case.name.as_str() {
            "set_up_chain" => (
                format!("chain of {}", case.size),
                if case.size == 1_000 { "50 ms" } else { "" },
                growth.exponent(case.size, time),
            ),
            _ => (
                format!("ten bodies (scissor lift of {})", case.size),
                "1 ms",
                String::new(),
            ),
        };
        [
            what,
            mark.to_owned(),
            or_not_run(time, Time::write),
            exponent,
        ]
    };
    table(
        out,
        ["set-up", "mark", "biela", "growth: exponent of the loops"],
        set_ups().map(row),
    );
}

/// Ten million steps of the four-bar, a thousand turns on and on, against the closed form.
fn long_run(out: &mut String) {
    const TURN: u32 = 10_000;
    const TURNS: u32 = 1_000;
    let mut moving = Moving::new(&chain(1, Ground::Straight));
    let start = moving.solver.pose().drivers[0];
    let mut closed_form = four_bar();
    let mut rows = Vec::new();
    let mut worst = (0.0_f64, 0.0_f64);
    for turn in 0..TURNS {
        if turn % (TURNS / 10) == 0 {
            worst = (0.0, 0.0);
        }
        for step in 1..=TURN {
            let angle = start + TAU * (f64::from(turn) + f64::from(step) / f64::from(TURN));
            let at_rest = Jet::constant(angle);
            moving.step(&[at_rest]);
            worst.0 = worst.0.max(moving.solver.residual());
            if step % 100 == 0 {
                // The rocker's angle is the third of the third body; it rocks, and does not turn.
                let off = moving.solver.pose().q[8] - closed_form.at(at_rest)[20];
                worst.1 = worst.1.max(off.abs());
            }
        }
        let tenth = turn / (TURNS / 10);
        if (turn + 1) % (TURNS / 10) == 0 && [0, 4, 9].contains(&tenth) {
            rows.push([
                format!("million {}", tenth + 1),
                format!("{:.1e}", worst.0),
                format!("{:.1e} rad", worst.1),
            ]);
        }
    }
    table(
        out,
        [
            "ten million steps of the four-bar",
            "largest residual",
            "largest error of the rocker's angle",
        ],
        rows,
    );
    *out += "The crank's own angle, up to 6,283 rad, is rounded to 5e-13 rad by then.\n\n";
}

/// Times of the variants of the chain in C.
fn yardsticks(out: &mut String) {
    let row = |loops: usize| {
        let of = |name| {
            let time = time(&Case::new(name, loops)).map(|time| time.of_each(loops));
            or_not_run(time, Time::write)
        };
        [
            format!("{loops}"),
            of("c_chain"),
            of("c_chain_updated"),
            of("c_chain_condition"),
        ]
    };
    table(
        out,
        [
            "chain in C, each loop",
            "plain",
            "sines updated",
            "with condition",
        ],
        sizes::chain().into_iter().map(row),
    );
}

//! Prints how biela compares with the yardsticks, as a table: times from criterion's files,
//! instructions, memory and errors measured here.
//!
//!     ratios [README]
//!
//! The table also replaces the one between the two marks in README, if given.

#![allow(clippy::print_stdout, reason = "a table is what it is for")]

mod instructions;
mod memory;
mod times;

use std::f64::consts::TAU;
use std::fmt::Write as _;

use biela::mechanism::Jet;
use instructions::Counter;
use memory::kept;
use times::{Time, time};
use yardstick::generated::{Ground, chain};
use yardstick::motion::{Moving, Sweep};
use yardstick::sizes;
use yardstick::yardstick::{Chain, Kind, OUTPUTS, four_bar};

const FROM: &str = "<!-- ratios: from here -->\n";
const TO: &str = "<!-- ratios: to here -->";

fn main() {
    let counter = Counter::find();
    let mut out = String::new();
    steps(&mut out, counter.as_ref());
    growth(&mut out);
    set_up(&mut out);
    long_run(&mut out);
    yardsticks(&mut out);
    if counter.is_none() {
        out += "\nInstructions were not counted: there is no valgrind here.\n";
    }
    println!("{out}");
    if let Some(readme) = std::env::args().nth(1) {
        let text = std::fs::read_to_string(&readme).expect("the README can be read");
        let (before, rest) = text.split_once(FROM).expect("the README has the mark");
        let (_, after) = rest
            .split_once(TO)
            .expect("the README has the closing mark");
        let text = format!("{before}{FROM}\n{out}\n{TO}{after}");
        std::fs::write(&readme, text).expect("the README can be written");
    }
}

/// One line of the tables.
fn line(out: &mut String, cells: &[&str]) {
    writeln!(out, "| {} |", cells.join(" | ")).expect("a text takes all");
}

const NOT_RUN: &str = "not run";

fn ratio(a: Option<Time>, b: Option<Time>) -> String {
    match (a, b) {
        (Some(a), Some(b)) => format!(
            "{} ({})",
            short(a.least / b.least),
            short(a.median / b.median)
        ),
        _ => NOT_RUN.to_owned(),
    }
}

/// Three digits, or all before the point.
fn short(number: f64) -> String {
    let digits = 2_i32.saturating_sub(number.abs().log10().floor() as i32);
    format!("{number:.*}", digits.clamp(0, 2) as usize)
}

fn nanoseconds(time: Option<Time>) -> String {
    match time {
        Some(Time { least, .. }) if least < 1e4 => format!("{} ns", short(least)),
        Some(Time { least, .. }) if least < 1e7 => format!("{} µs", short(least / 1e3)),
        Some(Time { least, .. }) => format!("{} ms", short(least / 1e6)),
        None => NOT_RUN.to_owned(),
    }
}

fn steps(out: &mut String, counter: Option<&Counter>) {
    line(
        out,
        &[
            "one step or cycle",
            "mark",
            "time, biela / C: least (median)",
            "instructions, biela / C",
            "biela",
            "C",
        ],
    );
    line(out, &["---", "---:", "---:", "---:", "---:", "---:"]);
    let counted = |ours: &str, theirs: &str, size: usize, runs: bool| match counter {
        Some(counter) if runs => {
            let [ours, theirs] = [ours, theirs].map(|case| counter.count(case, size));
            format!(
                "{} ({} / {})",
                short(ours / theirs),
                short(ours),
                short(theirs)
            )
        }
        _ => NOT_RUN.to_owned(),
    };

    let closed = time("four_bar/c");
    for (turn, mark) in [(10_000, "3"), (360, ""), (100, "")] {
        let ours = time(&format!("four_bar/biela/{turn}"));
        let instructions = if turn == 10_000 {
            counted("four_bar", "closed_form", 1, true)
        } else {
            String::new()
        };
        line(
            out,
            &[
                &format!("four-bar, {turn} steps a turn"),
                mark,
                &ratio(ours, closed),
                &instructions,
                &nanoseconds(ours),
                &nanoseconds(closed),
            ],
        );
    }
    let [ours, theirs] = ["fmu/biela", "fmu/c"].map(time);
    line(
        out,
        &[
            "FMI cycle of the four-bar",
            "3",
            &ratio(ours, theirs),
            &counted("fmu", "c_fmu", 1, true),
            &nanoseconds(ours),
            &nanoseconds(theirs),
        ],
    );
    let run = sizes::chain();
    for loops in sizes::CHAIN {
        let [ours, theirs] = ["biela", "c"]
            .map(|side| time(&format!("chain/{side}/{loops}")).map(|time| time.of_each(loops)));
        let runs = run.contains(&loops);
        let ours = ours.filter(|_| runs);
        line(
            out,
            &[
                &format!("chain of {loops}, each loop"),
                if (10..=1_000).contains(&loops) {
                    "1.75"
                } else {
                    ""
                },
                &ratio(ours, theirs),
                &counted("chain", "c_chain", loops, runs),
                &nanoseconds(ours),
                &nanoseconds(theirs),
            ],
        );
        if (10..=1_000).contains(&loops) {
            let theirs = time(&format!("chain/c_condition/{loops}")).map(|t| t.of_each(loops));
            line(
                out,
                &[
                    &format!("chain of {loops}, condition in C too"),
                    "2.1",
                    &ratio(ours, theirs),
                    "",
                    &nanoseconds(ours),
                    &nanoseconds(theirs),
                ],
            );
        }
    }
    for turn in [360, 100] {
        let [ours, theirs] = ["biela", "c"]
            .map(|side| time(&format!("chain_{turn}/{side}/10")).map(|time| time.of_each(10)));
        line(
            out,
            &[
                &format!("chain of 10, each loop, {turn} steps a turn"),
                "",
                &ratio(ours, theirs),
                "",
                &nanoseconds(ours),
                &nanoseconds(theirs),
            ],
        );
    }
}

/// How time, memory and errors grow with the size.
fn growth(out: &mut String) {
    *out += "\n";
    line(
        out,
        &[
            "chain",
            "biela: time of a loop",
            "biela: bytes a loop",
            "C: bytes a loop",
            "biela: error of acceleration (zigzag)",
            "C: error of acceleration",
        ],
    );
    line(out, &["---:", "---:", "---:", "---:", "---:", "---:"]);
    let run = sizes::chain();
    for loops in sizes::CHAIN {
        let each = |bytes: usize| format!("{}", bytes / loops);
        let mut yardstick = Chain::new(loops, Ground::Straight);
        let theirs = error(loops, |crank| {
            yardstick.step(Kind::Plain, crank);
            yardstick.state()[2].to_vec()
        });
        let (mut ours, mut bytes, mut errors) = (None, NOT_RUN.to_owned(), NOT_RUN.to_owned());
        if run.contains(&loops) {
            ours = time(&format!("chain/biela/{loops}")).map(|time| time.of_each(loops));
            let [straight, zigzag] = [Ground::Straight, Ground::Zigzag].map(|ground| {
                let text = chain(loops, ground);
                let (mut mechanism, kept) = kept(|| Moving::new(&text));
                bytes = each(kept);
                error(loops, |crank| {
                    mechanism.step(crank);
                    mechanism.rates.acceleration().to_vec()
                })
            });
            errors = format!("{straight:.0e} ({zigzag:.0e})");
        }
        line(
            out,
            &[
                &format!("{loops}"),
                &nanoseconds(ours),
                &bytes,
                &each(Chain::bytes(loops)),
                &errors,
                &format!("{theirs:.0e}"),
            ],
        );
    }
    *out += "\nMarks: time and memory of a loop within a factor 1.5 up to 10,000 loops, errors at \
             most 1e-10.\n\n";

    line(
        out,
        &[
            "scissor lift",
            "biela: time of a step",
            "growth: exponent of the cells",
        ],
    );
    line(out, &["---:", "---:", "---:"]);
    let mut before: Option<(usize, Time)> = None;
    for cells in sizes::lift() {
        let Some(now) = time(&format!("lift/biela/{cells}")) else {
            continue;
        };
        let exponent = before.map_or(String::new(), |(fewer, time)| {
            let exponent = (now.least / time.least).ln() / (cells as f64 / fewer as f64).ln();
            format!("{exponent:.2}")
        });
        line(
            out,
            &[&format!("{cells}"), &nanoseconds(Some(now)), &exponent],
        );
        before = Some((cells, now));
    }
    *out += "\nMark: growth no worse than 1.2.\n";
}

/// Largest error of a rocker's acceleration over a turn in 100 steps, relative to the largest
/// acceleration.
fn error(loops: usize, mut acceleration: impl FnMut(Jet) -> Vec<f64>) -> f64 {
    let mut sweep = Sweep::turn(100);
    let (mut error, mut largest) = (0.0_f64, 0.0_f64);
    for _ in 0..100 {
        let crank = sweep.step();
        let mut truth = [0.0; OUTPUTS];
        four_bar(crank, &mut truth);
        let found = acceleration(crank);
        largest = largest.max(truth[26].abs());
        for rocker in 0..loops {
            error = error.max((found[6 * rocker + 8] - truth[26]).abs());
        }
    }
    error / largest
}

/// Ten million steps of the four-bar, a thousand turns on and on, against the closed form.
fn long_run(out: &mut String) {
    const TURN: u32 = 10_000;
    const TURNS: u32 = 1_000;
    *out += "\n";
    line(
        out,
        &[
            "ten million steps of the four-bar",
            "largest residual",
            "largest error of the rocker's angle",
        ],
    );
    line(out, &["---", "---:", "---:"]);
    let mut moving = Moving::new(&chain(1, Ground::Straight));
    let start = moving.solver.pose().drivers[0];
    let at_rest = |value| Jet::new(value, [0.0, 0.0]);
    let mut worst = (0.0_f64, 0.0_f64);
    for turn in 0..TURNS {
        if turn % (TURNS / 10) == 0 {
            worst = (0.0, 0.0);
        }
        for step in 1..=TURN {
            let angle = start + TAU * (f64::from(turn) + f64::from(step) / f64::from(TURN));
            moving.step(at_rest(angle));
            worst.0 = worst.0.max(moving.solver.residual());
            if step % 100 == 0 {
                let mut exact = [0.0; OUTPUTS];
                four_bar(at_rest(angle), &mut exact);
                // The rocker's angle is the third of the third body; it rocks, and does not turn.
                let off = moving.solver.pose().q[8] - exact[20];
                worst.1 = worst.1.max(off.abs());
            }
        }
        let tenth = turn / (TURNS / 10);
        if (turn + 1) % (TURNS / 10) == 0 && [0, 4, 9].contains(&tenth) {
            line(
                out,
                &[
                    &format!("million {}", tenth + 1),
                    &format!("{:.1e}", worst.0),
                    &format!("{:.1e} rad", worst.1),
                ],
            );
        }
    }
    *out += "\nThe crank's own angle, up to 6,283 rad, is rounded to 5e-13 rad by then.\n";
}

fn set_up(out: &mut String) {
    *out += "\n";
    line(
        out,
        &["set-up", "mark", "biela", "growth: exponent of the loops"],
    );
    line(out, &["---", "---:", "---:", "---:"]);
    let mut before: Option<(usize, Time)> = None;
    for loops in sizes::SET_UP {
        let now =
            time(&format!("set_up/biela/{loops}")).filter(|_| sizes::set_up().contains(&loops));
        let exponent = match (now, before) {
            (Some(now), Some((fewer, time))) => {
                let exponent = (now.least / time.least).ln() / (loops as f64 / fewer as f64).ln();
                format!("{exponent:.2}")
            }
            _ => String::new(),
        };
        let mark = if loops == 1_000 { "50 ms" } else { "" };
        line(
            out,
            &[
                &format!("chain of {loops}"),
                mark,
                &nanoseconds(now),
                &exponent,
            ],
        );
        before = now.map(|now| (loops, now));
    }
    let ten = time("set_up/ten_bodies");
    line(
        out,
        &[
            "ten bodies (scissor lift of 5)",
            "1 ms",
            &nanoseconds(ten),
            "",
        ],
    );
}

/// What the variants of the yardstick's chain take.
fn yardsticks(out: &mut String) {
    *out += "\n";
    line(
        out,
        &[
            "chain in C, each loop",
            "plain",
            "sines updated",
            "with condition",
        ],
    );
    line(out, &["---:", "---:", "---:", "---:"]);
    for loops in sizes::CHAIN {
        let [plain, updated, condition] = ["c", "c_updated", "c_condition"].map(|kind| {
            nanoseconds(time(&format!("chain/{kind}/{loops}")).map(|time| time.of_each(loops)))
        });
        line(out, &[&format!("{loops}"), &plain, &updated, &condition]);
    }
}

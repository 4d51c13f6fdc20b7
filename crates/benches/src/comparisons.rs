//! Cases of biela beside what they are measured by.

use crate::cases::Case;
use crate::sizes;

/// A case of biela and its yardstick.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Label.
    pub what: String,
    /// Largest ratio of times aimed at, empty if there is none.
    pub mark: &'static str,
    /// Case of biela.
    pub biela: Case,
    /// Yardstick: a case in C, or another one of biela.
    pub yardstick: Case,
}

/// Label, case, yardstick and marks at each of [`sizes::SWEEPS`]. Newton takes two corrections in
/// coarse steps and a closed form none, so that there only fine steps have a mark.
const MECHANISMS: [(&str, &str, &str, [&str; 3]); 8] = [
    ("four-bar", "four_bar", "c_four_bar", ["3", "", ""]),
    (
        "slider–crank",
        "slider_crank",
        "c_slider_crank",
        ["3", "", ""],
    ),
    (
        "cam, roller follower",
        "cam_roller",
        "c_cam_roller",
        ["3"; 3],
    ),
    ("cam, flat follower", "cam_flat", "c_cam_flat", ["3"; 3]),
    ("cam, knife edge", "cam_knife", "c_cam_knife", ["3"; 3]),
    (
        "parallelogram / four-bar of biela",
        "parallelogram",
        "four_bar",
        ["2"; 3],
    ),
    (
        "four-bar with all forces",
        "four_bar_forces",
        "c_four_bar_forces",
        ["3", "", ""],
    ),
    (
        "four-bar with / without forces of biela",
        "four_bar_forces",
        "four_bar",
        ["1.6"; 3],
    ),
];

/// Label and names of the orders in which a cycle gets its outputs.
const CYCLES: [(&str, &str, &str); 4] = [
    ("in file order", "fmu", "c_fmu"),
    ("by quantity", "fmu_by_quantity", "c_fmu_by_quantity"),
    ("last first", "fmu_reversed", "c_fmu_reversed"),
    ("in random order", "fmu_random", "c_fmu_random"),
];

/// Returns the comparisons in the order of the table.
#[must_use]
pub fn comparisons() -> Vec<Comparison> {
    let mut all = Vec::new();
    let mut add = |what: String, mark, biela: String, yardstick: String, size| {
        let (biela, yardstick) = (Case::new(biela, size), Case::new(yardstick, size));
        all.push(Comparison {
            what,
            mark,
            biela,
            yardstick,
        });
    };
    for (what, biela, yardstick, marks) in MECHANISMS {
        for (steps, mark) in sizes::SWEEPS.into_iter().zip(marks) {
            add(
                format!("{what}, {steps} steps per turn"),
                mark,
                format!("{biela}@{steps}"),
                format!("{yardstick}@{steps}"),
                1,
            );
        }
    }
    for (order, biela, yardstick) in CYCLES {
        let what = format!("FMI cycle of the four-bar, outputs {order}");
        add(what, "3", biela.to_owned(), yardstick.to_owned(), 1);
    }
    add(
        "FMI cycle of the four-bar, FMI 3.0 / 2.0 of biela".to_owned(),
        "1.05",
        "fmu_of_fmi_3".to_owned(),
        "fmu".to_owned(),
        1,
    );
    for (what, name) in [("pendulum", "pendulum"), ("four-bar", "four_bar")] {
        add(
            format!("{what} that moves freely, 0.01 s"),
            "4",
            format!("free_{name}"),
            format!("c_free_{name}"),
            1,
        );
    }
    for loops in sizes::chain() {
        for (also, mark, yardstick) in [
            ("each loop", "1.75", "c_chain"),
            ("condition in C too", "2.1", "c_chain_condition"),
        ] {
            let mark = if (10..=1_000).contains(&loops) {
                mark
            } else {
                ""
            };
            let what = format!("chain of {loops}, {also}");
            add(what, mark, "chain".to_owned(), yardstick.to_owned(), loops);
        }
    }
    for steps in &sizes::SWEEPS[1..] {
        let what = format!("chain of 10, each loop, {steps} steps per turn");
        let [biela, yardstick] = ["chain", "c_chain"].map(|name| format!("{name}@{steps}"));
        add(what, "", biela, yardstick, 10);
    }
    all
}

/// Returns all cases that are timed, each once.
#[must_use]
pub fn timed_cases() -> Vec<Case> {
    let compared = comparisons();
    let compared = compared.iter().flat_map(|row| [&row.biela, &row.yardstick]);
    let mut cases = Vec::new();
    let rest = sizes::chain()
        .into_iter()
        .map(|loops| Case::new("c_chain_updated", loops))
        .chain(lifts())
        .chain(set_ups());
    for case in compared.cloned().chain(rest) {
        if !cases.contains(&case) {
            cases.push(case);
        }
    }
    cases
}

/// Returns the cases of scissor lifts.
pub fn lifts() -> impl Iterator<Item = Case> {
    sizes::lift()
        .into_iter()
        .map(|cells| Case::new("lift", cells))
}

/// Returns the cases of set-up: chains, then ten bodies.
pub fn set_ups() -> impl Iterator<Item = Case> {
    let chains = sizes::set_up().into_iter();
    chains
        .map(|loops| Case::new("set_up_chain", loops))
        .chain([Case::new("set_up_lift", sizes::TEN_BODIES)])
}

/// Returns the cases of which instructions are counted and nothing else: mechanisms without a
/// yardstick.
#[must_use]
pub fn counted_cases() -> [Case; 9] {
    [
        "five_bar_robot",
        "platform_3rpr",
        "jansen_leg",
        "block_and_tackle",
        "sash_window",
        "geared_five_bar",
        "rack_drive",
        "scissor_lift_screw",
        "groove_cam",
    ]
    .map(|name| Case::new(name, 1))
}

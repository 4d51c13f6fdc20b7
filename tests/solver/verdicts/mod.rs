//! A bank of small mechanisms and what has to be said of each: that it closes, and where; that it
//! is proved not to close, and by how much; that it was not found to close; that it closes in a
//! singular position. All numbers come from closed forms, said beside each.

mod cams;
mod closing;
mod impossible;
mod invariance;
mod mechanisms;
mod refused;
mod singular;
mod two_loops;

use self::mechanisms::{linked, upright};
use crate::common::mechanisms::slider_crank;
use crate::common::{solve, straight_to};
use biela::kinematics::{Error, Fit, OpenJoint, Path, Reason, Solver, Verdict};
use biela::mechanism::{Mechanism, Source};

/// Expected verdict.
enum Expected {
    /// It closes: some coordinates, such as `rocker.phi`.
    Closes(Vec<(&'static str, f64)>),
    /// It closes nearly in a singular position, with a reciprocal condition of this or down to a
    /// third of it, as the norms of two unit vectors have it.
    NearlySingular(f64),
    /// It is proved not to, in so many ways: what stays open, by how many metres and radians.
    Impossible(usize, Vec<(&'static str, f64, f64)>),
    /// It was not found to, and what stays open.
    NotFound(Vec<(&'static str, f64, f64)>),
    /// It closes in a singular position.
    Singular,
    /// It closes; a motion of its driver to a value is given up, for this reason.
    GivenUp(f64, Reason),
    /// Its file is refused, with this message.
    Refused(&'static str),
}

use Expected::{Closes, GivenUp, Impossible, NearlySingular, NotFound, Refused, Singular};

struct Case {
    name: &'static str,
    text: String,
    expected: Expected,
}

fn case(name: &'static str, text: String, expected: Expected) -> Case {
    Case {
        name,
        text,
        expected,
    }
}

fn coordinate(solver: &Solver, path: &str) -> f64 {
    let (body, coordinate) = path.split_once('.').expect("body and coordinate");
    let body = solver.mechanism().body_id(body).expect("it is there");
    let k = ["x", "y", "phi"]
        .iter()
        .position(|name| *name == coordinate);
    solver.pose().q[3 * body.index() + k.expect("a coordinate")]
}

/// The joints open, and their gaps, within a part of the largest or of the rounding.
fn assert_open(name: &str, open: &[OpenJoint], expected: &[(&str, f64, f64)], part: f64) {
    assert_eq!(open.len(), expected.len(), "{name}: {open:?}");
    for (open, (element, gap, angle)) in open.iter().zip(expected) {
        assert_eq!(open.origin, *element, "{name}");
        assert!(
            (open.gap - gap).abs() <= part * gap + 1e-14,
            "{name}: {open:?}, {gap}"
        );
        assert!(
            (open.angle - angle).abs() <= part * angle,
            "{name}: {open:?}, {angle}"
        );
    }
}

fn judge(case: &Case) {
    let Case {
        name,
        text,
        expected,
    } = case;
    if let Refused(message) = expected {
        let errors = Mechanism::parse(&Source::new("test.toml", text.as_str()))
            .err()
            .unwrap_or_default();
        let messages: Vec<_> = errors.iter().map(|error| &error.message).collect();
        assert_eq!(messages, [message], "{name}");
        return;
    }
    let found = solve(text);
    let described = match &found {
        Ok(solver) => format!("{:?}", solver.pose()),
        Err(error) => error.to_string(),
    };
    match (expected, found) {
        (Closes(coordinates), Ok(solver)) => {
            assert!(solver.residual() < 1e-14, "{name}");
            for (path, value) in coordinates {
                let found = coordinate(&solver, path);
                assert!(
                    (found - value).abs() < 1e-13,
                    "{name}: {path} = {found}, not {value}"
                );
            }
        }
        (NearlySingular(rcond), Ok(mut solver)) => {
            let found = solver.rcond();
            assert!(
                found > rcond / 3.0 && found < *rcond,
                "{name}: {found}, not {rcond}"
            );
        }
        (
            Impossible(expected_ways, expected),
            Err(Error::NotAssembled {
                verdict,
                open,
                nearest,
                ..
            }),
        ) => {
            let Verdict::Impossible { ways, .. } = verdict else {
                panic!("{name}: {described}");
            };
            assert_eq!(ways, *expected_ways, "{name}");
            // Closed forms are exact; elsewhere what is closed is held ten thousand times harder
            // than what is open, and each joint gives a hundred-millionth of the gap.
            assert_open(name, &open, expected, 1e-7);
            assert!(nearest.iter().all(|x| x.is_finite()), "{name}");
            assert!(
                described.starts_with("the mechanism cannot close"),
                "{name}: {described}"
            );
        }
        (NotFound(expected), Err(Error::NotAssembled { verdict, open, .. })) => {
            assert!(
                matches!(verdict, Verdict::NotFound { .. }),
                "{name}: {described}"
            );
            assert_open(name, &open, expected, 1e-7);
            assert!(
                described.contains("deterministic starts, which is no proof"),
                "{described}"
            );
        }
        (GivenUp(value, reason), Ok(mut solver)) => {
            let mut path = Path::new(solver.mechanism());
            straight_to(&solver, &mut path, *value);
            let blocked = solver.track(&path).expect_err(name);
            assert_eq!(blocked.reason, *reason, "{name}");
            assert!(solver.residual() < 1e-12, "{name}");
        }
        (Singular, Err(Error::Singular { rcond, .. })) => assert!(rcond < 1e-7, "{name}: {rcond}"),
        _ => panic!("{name}: {described}"),
    }
}

fn bank() -> Vec<Case> {
    let bank: Vec<_> = [
        closing::cases(),
        impossible::cases(),
        two_loops::cases(),
        cams::cases(),
        singular::cases(),
        refused::cases(),
    ]
    .into_iter()
    .flatten()
    .collect();
    assert!(bank.len() >= 30);
    bank
}

fn judge_all(bank: &[Case]) {
    let failed: Vec<_> = bank
        .iter()
        .filter(|case| {
            std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| judge(case))).is_err()
        })
        .map(|case| case.name)
        .collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

#[test]
fn every_mechanism_of_the_bank_gets_its_verdict() {
    judge_all(&bank());
}

#[test]
fn an_arm_of_any_size_beside_it_leaves_the_verdict_the_same() {
    for length in ["1e6", "1e-7"] {
        println!("beside an arm of {length} m");
        let mut bank = bank();
        // The condition is that of the whole mechanism.
        bank.retain(|case| !matches!(case.expected, Refused(_) | NearlySingular(_)));
        for case in &mut bank {
            case.text = invariance::with_arm(&case.text, length);
        }
        judge_all(&bank);
    }
}

/// The length that would do is told, with what it is now, and does.
#[test]
fn the_length_with_which_it_would_close_is_told() {
    let upright = |coupler, rocker| upright([1.0, coupler, rocker, 2.0], 90.0);
    let with_rod = |rod| slider_crank([1.0, rod], 4.0, "90*deg", ["0, 0, 1", "0, 0, 0", "1, 0, 0"]);
    let linked = |length| linked(length, 90.0, ["0, 0, 1", "4, 0, 1.5"]);
    // The least change of a length of the closed forms of the bank, and the mechanism with one a
    // little beyond.
    let (five, seventeen) = (5_f64.sqrt(), 17_f64.sqrt());
    for (text, length, beyond, says) in [
        (
            upright(1.0, 1.0),
            five - 1.0,
            upright(1.0, 1.24),
            "body `rocker` would reach with more than 1236.1 mm from `B` to `O`, which is 1000.0 \
             mm now",
        ),
        (
            upright(1.0, 4.0),
            five + 1.0,
            upright(1.0, 3.2),
            "body `rocker` would reach with less than 3236.0 mm from `B` to `O`, which is 4000.0 \
             mm now",
        ),
        // The guide is what stays open; the rod is what is too short.
        (
            with_rod(2.0),
            3.0,
            with_rod(3.1),
            "body `rod` would reach with more than 3000.0 mm from `A` to `B`, which is 2000.0 mm \
             now",
        ),
        (
            linked(9.0),
            seventeen + 2.0,
            linked(6.1),
            "joint `rod` would reach with a length of less than 6123.1 mm, which is 9000.0 mm now",
        ),
    ] {
        let Err(error) = solve(&text) else {
            panic!("it closes: {says}");
        };
        assert!(error.to_string().ends_with(says), "{error}");
        let Error::NotAssembled { fit: Some(fit), .. } = error else {
            panic!("without a length: {error}");
        };
        let Fit::Length { length: found, .. } = *fit else {
            panic!("{fit:?}");
        };
        assert!((found - length).abs() < 1e-6, "{found}, not {length}");
        assert!(solve(&beyond).is_ok(), "{says}");
    }
}

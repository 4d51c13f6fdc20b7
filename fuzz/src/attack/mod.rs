//! Jumps of generated mechanisms against the same motions in tiny steps, and against themselves at
//! another scale and under other names.
//!
//! Each case draws a mechanism, a jump of its drivers or parameters, and expects:
//! - one jump ends where tiny steps end: at the same pose, or at the same position that stops the
//!   motion; a jump that the solver gives up for its number of sub-steps ends where tiny steps to
//!   the same place end, as that number is a limit per call and tiny steps come farther with it;
//! - lengths times a thousand or a thousandth, and other names, change nothing: the same verdict,
//!   the same pose, sub-steps within a factor of two;
//! - no call takes more than [`MOST_SUBSTEPS`] sub-steps.

mod kinds;

use std::sync::Arc;

use biela::kinematics::{Curve, Path, Reason, Solver};
use biela::mechanism::{Mechanism, Source};

use crate::mutation::Chance;

pub use kinds::{Draw, KINDS};

/// Most sub-steps of a call.
pub const MOST_SUBSTEPS: u32 = 100_000;
/// The number of tiny steps in a jump.
const TINY: u32 = 400;
/// Largest difference of poses, in radians and parts of the scale: rounding next to positions that
/// are nearly singular.
const SAME: f64 = 1e-7;
/// Largest difference of the places where a motion stops, as part of the jump: tiny steps end in
/// front of a dead point to the root of the rounding.
const SAME_STOP: f64 = 1e-5;

/// A mechanism of a kind and a jump of it.
#[derive(Clone, Debug)]
pub struct Case {
    /// The mechanism file.
    pub text: String,
    /// The value of each driver after the jump \[m or rad\].
    pub drivers: Vec<f64>,
    /// Names and values of the parameters that jump.
    pub parameters: Vec<(String, f64)>,
}

/// The end of a jump.
#[derive(Clone, Debug)]
struct End {
    /// The part of the jump that was possible.
    reached: f64,
    /// q there, lengths divided by the scale.
    q: Vec<f64>,
    substeps: u32,
    message: String,
    /// Whether the motion was given up for its number of sub-steps, at no particular place.
    given_up: bool,
}

/// The result of a case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Finding {
    /// All as expected.
    Agrees,
    /// The mechanism does not close from its estimates.
    NotAssembled,
    /// A difference, in words.
    Differs(String),
}

/// The counts of a kind.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Cases that agree.
    pub agree: u32,
    /// Cases that did not close.
    pub not_assembled: u32,
    /// Cases that differ.
    pub differ: u32,
    /// The most sub-steps of a call.
    pub substeps: u32,
}

/// Runs a number of cases of a kind and reports each difference to `found`, with the seed of its
/// case.
pub fn run(kind: usize, seed: u64, cases: u64, mut found: impl FnMut(u64, &str)) -> Counts {
    let mut counts = Counts::default();
    for case in seed..seed + cases {
        let (finding, substeps) = try_case(kind, case);
        counts.substeps = counts.substeps.max(substeps);
        match finding {
            Finding::Agrees => counts.agree += 1,
            Finding::NotAssembled => counts.not_assembled += 1,
            Finding::Differs(words) => {
                counts.differ += 1;
                found(case, &words);
            }
        }
    }
    counts
}

/// Returns a case at a scale, its names beginning with `prefix`.
#[must_use]
pub fn case(kind: usize, seed: u64, scale: f64, prefix: &str) -> Case {
    // Neighbouring seeds shall have nothing in common.
    let mut chance = Chance::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    (KINDS[kind].1)(&mut chance, scale, prefix)
}

/// Tries a case. Returns the most sub-steps of a call, too.
#[must_use]
pub fn try_case(kind: usize, seed: u64) -> (Finding, u32) {
    let plain = case(kind, seed, 1.0, "");
    let Some(jump) = end(&plain, 1.0, 1, 1.0) else {
        return (Finding::NotAssembled, 0);
    };
    let differs = |what: &str, other: &End| {
        let words = format!("{what}: jump {jump:?}, other {other:?}");
        (Finding::Differs(words), jump.substeps)
    };
    if jump.substeps > MOST_SUBSTEPS {
        return differs("too many sub-steps", &jump);
    }
    let part = if jump.given_up { jump.reached } else { 1.0 };
    let Some(tiny) = end(&plain, 1.0, TINY, part) else {
        return (Finding::NotAssembled, 0);
    };
    if let Some(what) = difference(&jump, &tiny) {
        return differs(what, &tiny);
    }
    for (scale, prefix) in [(1e-3, ""), (1e3, ""), (1.0, "other_")] {
        let Some(there) = end(&case(kind, seed, scale, prefix), scale, 1, 1.0) else {
            return (
                Finding::Differs(format!("closes, but not at scale {scale}")),
                jump.substeps,
            );
        };
        if let Some(what) = difference(&jump, &there) {
            return differs(&format!("at scale {scale}, names {prefix}: {what}"), &there);
        }
        let [fewer, more] = [
            jump.substeps.min(there.substeps),
            jump.substeps.max(there.substeps),
        ];
        // In front of a stop the number of sub-steps is that of halvings.
        if jump.reached >= 1.0 && more > 2 * fewer + 1 {
            return differs(&format!("other sub-steps at scale {scale}"), &there);
        }
    }
    (Finding::Agrees, jump.substeps)
}

/// Returns the difference of two ends of a jump.
fn difference(a: &End, b: &End) -> Option<&'static str> {
    if (a.reached - b.reached).abs() > SAME_STOP {
        return Some(match a.reached < b.reached {
            true => "stops earlier",
            false => "stops later",
        });
    }
    let off = a.q.iter().zip(&b.q).map(|(a, b)| (a - b).abs());
    let most = off.fold(0.0, f64::max);
    // A motion that stops at a dead point has come to the root of the rounding of its place.
    let same = if a.reached < 1.0 { 0.02 } else { SAME };
    (most.is_nan() || most > same).then_some("another pose")
}

/// Moves along the first `part` of the jump in a number of steps. `None` if the mechanism does not
/// close.
fn end(case: &Case, scale: f64, steps: u32, part: f64) -> Option<End> {
    let source = Source::new("attack.toml", case.text.as_str());
    let mechanism = match Mechanism::parse(&source) {
        Ok((mechanism, _)) => Arc::new(mechanism),
        Err(problems) => panic!("{problems:#?}\n{}", case.text),
    };
    let mut path = Path::new(&mechanism);
    let mut solver = Solver::new(Arc::clone(&mechanism)).ok()?;
    solver.assemble(&path).ok()?;
    let start = solver.pose().clone();
    let mut to = start.parameters.clone();
    for (name, value) in &case.parameters {
        let parameters = &mechanism.parameters;
        let index = parameters.iter().position(|p| p.name == *name)?;
        to[index] = *value;
    }
    let mut end = End {
        reached: 0.0,
        q: Vec::new(),
        substeps: 0,
        message: String::new(),
        given_up: false,
    };
    for step in 1..=steps {
        let s = part * f64::from(step) / f64::from(steps);
        let between = |from: f64, to: f64| from + s * (to - from);
        let pose = solver.pose().clone();
        path.start = pose.time;
        path.duration = 0.0;
        path.from.clone_from(&pose.parameters);
        for (k, value) in path.to.iter_mut().enumerate() {
            *value = between(start.parameters[k], to[k]);
        }
        for (k, curve) in path.curves.iter_mut().enumerate() {
            let position = between(start.drivers[k], case.drivers[k]);
            *curve = Curve::Input {
                position,
                velocity: 0.0,
                acceleration: 0.0,
                jump: pose.drivers[k] - position,
            };
        }
        match solver.track(&path) {
            Ok(progress) => {
                end.substeps = end.substeps.max(progress.substeps);
                end.reached = s;
            }
            Err(blocked) => {
                end.substeps = end.substeps.max(blocked.progress.substeps);
                end.reached = part * (f64::from(step - 1) + blocked.s) / f64::from(steps);
                end.given_up = matches!(blocked.reason, Reason::TooLong | Reason::NearSingular);
                end.message = format!("{:?}", blocked.reason);
                break;
            }
        }
    }
    let bodies = 3 * mechanism.bodies.len();
    let q = solver.pose().q[..bodies].iter().enumerate();
    end.q = q
        .map(|(k, value)| if k % 3 == 2 { *value } else { value / scale })
        .collect();
    Some(end)
}

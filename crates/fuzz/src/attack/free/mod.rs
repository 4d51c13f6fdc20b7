//! Free motions of generated mechanisms with stops, backlash, ropes, cams and friction.
//!
//! Each case draws a mechanism and expects:
//! - with other communication steps and another tolerance it has the same events, the same places and
//!   the same end, or is refused by the same words, as far as the motion is not chaotic: see
//!   [`compare`];
//! - a fresh motion that is given the state half-way goes on with the same bits;
//! - no stop is passed, no contact is penetrated, friction follows its law, joints stay closed, and
//!   energy does not grow where nothing drives;
//! - the motion is that of a closed form where there is one: see [`truth`];
//! - no motion takes more than [`MOST_EVALUATIONS`](run::MOST_EVALUATIONS) evaluations;
//! - no motion is refused but by what its kind may meet: stops of driven parts, dead points, joints that
//!   jam.
//!
//! | file or folder | subject |
//! |---|---|
//! | `text` | the text of a mechanism, with numbers that can be nudged |
//! | `case` | [`Case`]: a mechanism, and what is known of its motion |
//! | `truth` | motions in closed form |
//! | `align` | events of two motions, side by side |
//! | `run` | a motion from row to row |
//! | `compare` | two motions that have to be the same |
//! | `kinds` | the kinds of mechanisms |

mod align;
mod case;
mod compare;
mod kinds;
mod run;
mod text;
mod truth;

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::mutation::Chance;
use align::Happening;
use case::Case;
use compare::Sensitivity;
use run::{Manner, Ready, Refusal};
use text::Text;

pub use kinds::FREE_KINDS;

/// Rows of the motion that the others are compared with.
const ROWS: u32 = 140;
/// The manners in which a motion is followed, the first of them with the rows of the others among its
/// own.
const MANNERS: [Manner; 6] = [
    manner(1e-10, ROWS),
    manner(1e-10, 20),
    manner(1e-10, 2),
    manner(1e-8, ROWS),
    manner(1e-8, 20),
    manner(1e-8, 2),
];
/// Number of nudged motions.
const NUDGES: u64 = 2;

const fn manner(tolerance: f64, steps: u32) -> Manner {
    Manner { tolerance, steps }
}

/// The counts of a kind.
#[derive(Clone, Debug, Default)]
pub struct FreeCounts {
    /// Cases that agree.
    pub agree: u32,
    /// Cases among them that are compared for a part of their time only, as they are chaotic.
    pub chaotic: u32,
    /// Cases that do not close, or do not start.
    pub not_started: u32,
    /// Cases that differ.
    pub differ: u32,
    /// The most evaluations of a motion.
    pub evaluations: u64,
    /// Number of events.
    pub events: usize,
    /// Refusals among those that agree, by their words: their number, and the seed of the first.
    pub refused: BTreeMap<String, (u32, u64)>,
}

/// Runs a number of cases of a kind, and reports each difference to `found`, with the seed of its case.
pub fn run_free(
    kind: usize,
    seed: u64,
    cases: u64,
    mut found: impl FnMut(u64, &str),
) -> FreeCounts {
    let mut counts = FreeCounts::default();
    for case in seed..seed + cases {
        match try_case(kind, case, &mut counts) {
            Ok(()) => {}
            Err(words) => {
                counts.differ += 1;
                found(case, &words);
            }
        }
    }
    counts
}

/// Returns the mechanism file of a case.
#[must_use]
pub fn free_case(kind: usize, seed: u64) -> String {
    case(kind, seed, None).text
}

/// Returns the events of a case in each manner and in truth, in words.
#[must_use]
pub fn free_events(kind: usize, seed: u64) -> String {
    let case = case(kind, seed, None);
    let Some(ready) = Ready::new(&case.text) else {
        return "it does not close".to_owned();
    };
    let mut words = String::new();
    for manner in MANNERS {
        let told = match ready.follow(&case, manner) {
            Ok(record) => record.told(),
            Err(hangs) => hangs,
        };
        let _ = writeln!(words, "{manner:?}\n{told}");
    }
    if let Some(truth) = &case.truth {
        let impacts: Vec<_> = truth.impacts.iter().map(Happening::told).collect();
        let _ = writeln!(words, "truth\n{}", impacts.join("\n"));
    }
    words
}

/// Returns a case, with its numbers nudged in one of several ways.
fn case(kind: usize, seed: u64, nudge: Option<u64>) -> Case {
    // Neighbouring seeds shall have nothing in common.
    let mut chance = Chance::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    (FREE_KINDS[kind].1)(&mut chance, Text::new(nudge))
}

/// Tries a case.
///
/// # Errors
///
/// The first difference, in words.
fn try_case(kind: usize, seed: u64, counts: &mut FreeCounts) -> Result<(), String> {
    let plain = case(kind, seed, None);
    let Some(ready) = Ready::new(&plain.text) else {
        counts.not_started += 1;
        return Ok(());
    };
    let base = ready.follow(&plain, MANNERS[0])?;
    counts.evaluations = counts.evaluations.max(base.evaluations);
    counts.events += base.events.len();
    if let Some(violation) = &base.violation {
        return Err(violation.clone());
    }
    check_refusal(&plain, base.refusal.as_ref())?;
    if base.rows.is_empty() {
        counts.not_started += 1;
        return Ok(());
    }
    let mut nudged = Vec::new();
    for nudge in 1..=NUDGES {
        let case = case(kind, seed, Some(nudge));
        let Some(ready) = Ready::new(&case.text) else {
            continue;
        };
        let words = |words| format!("nudged in way {nudge}: {words}");
        nudged.push(ready.follow(&case, MANNERS[0]).map_err(words)?);
    }
    let sensitivity = Sensitivity::new(&base, &nudged, plain.duration);
    if let Some(truth) = &plain.truth {
        sensitivity.compare_truth(truth, MANNERS[0].tolerance)?;
    }
    for manner in &MANNERS[1..] {
        let words = |words| format!("with {manner:?}: {words}");
        let other = ready.follow(&plain, *manner).map_err(words)?;
        counts.evaluations = counts.evaluations.max(other.evaluations);
        if let Some(violation) = other.violation {
            return Err(words(violation));
        }
        sensitivity
            .compare(&other, manner.tolerance)
            .map_err(words)?;
        check_refusal(&plain, other.refusal.as_ref()).map_err(words)?;
    }
    ready.try_restored(&plain, MANNERS[1])?;
    counts.agree += 1;
    counts.chaotic += u32::from(sensitivity.horizon < plain.duration);
    if let Some(refusal) = &base.refusal {
        let refused = counts.refused.entry(refusal.name.clone());
        refused.or_insert((0, seed)).0 += 1;
    }
    Ok(())
}

/// # Errors
///
/// The refusal is none of those that the mechanism may have.
fn check_refusal(case: &Case, refusal: Option<&Refusal>) -> Result<(), String> {
    let Some(Refusal { name, time, .. }) = refusal else {
        return Ok(());
    };
    let mut known = case.refusals.iter();
    if known.any(|words| name.contains(words)) {
        Ok(())
    } else {
        Err(format!("refused at {time} s: {name}"))
    }
}

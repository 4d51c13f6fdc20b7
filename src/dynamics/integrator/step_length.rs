//! The length of the next step: after an accepted one, after a refused one, before the end.

use std::fmt::{Debug, Display};

use super::error::{Error, Reason, Refusal};
use super::state::{LEAST_MEMORY, State};

/// Safety factor on the length of the next step (Hairer, Nørsett, Wanner I, Eq. II.4.13).
const SAFETY: f64 = 0.9;

/// Smallest ratio of two consecutive steps.
const LEAST_RATIO: f64 = 0.2;

/// Largest ratio of two consecutive steps, as in `dop853.f`.
const LARGEST_RATIO: f64 = 6.0;

/// Ratio of a step to the one before it at which the system failed.
const FAILURE_RATIO: f64 = 0.25;

/// Largest number of refused trial steps in a row.
const LARGEST_TRIALS: u32 = 60;

/// Ratio of the smallest step to the time.
const LEAST_STEP: f64 = 16.0 * f64::EPSILON;

/// Largest ratio by which a step is stretched to end at the time asked for. The error grows by
/// half at order 8, for which the safety factor has room.
const STRETCH: f64 = 1.05;

/// Returns the length of a step over a part of a gap: all of it if the proposed step nearly
/// reaches the end, half of it if two steps do, so that no short step remains.
pub(super) fn fitted(state: &State, gap: f64) -> f64 {
    let proposed = state.h.max(least(state));
    if STRETCH * proposed >= gap {
        gap
    } else {
        proposed.min(0.5 * gap)
    }
}

/// Returns the smallest length of a proposed step \[s\].
fn least(state: &State) -> f64 {
    LEAST_STEP * state.t.abs().max((state.t - state.origin).abs())
}

/// Proposes the next step after an accepted one of this length; `shortened` after refused trials,
/// which let no step grow at once.
pub(super) fn lengthen(state: &mut State, length: f64, order: f64, error: f64, shortened: bool) {
    let ratio = step_ratio(error, state.memory, order);
    let proposed = length * if shortened { ratio.min(1.0) } else { ratio };
    if length < state.h {
        // The step was cut: its error says little about the step that was proposed.
        state.h = state.h.max(proposed);
    } else {
        state.h = proposed;
        state.memory = error.max(LEAST_MEMORY);
    }
}

/// Proposes a shorter step after a refused one of this length.
///
/// # Errors
///
/// [`Error::Stopped`] after a hard failure, [`Error::Stuck`] after too many trials or at the
/// smallest step.
pub(super) fn shorten<C: Debug + Display>(
    state: &mut State,
    length: f64,
    order: f64,
    refusal: Refusal<C>,
    trials: u32,
) -> Result<(), Error<C>> {
    let reason = match refusal {
        Refusal::Stop(cause) => return Err(Error::Stopped { t: state.t, cause }),
        Refusal::Retry(reason) => reason,
        Refusal::Cut(_) => return Ok(()),
    };
    if let Reason::Inaccurate(error) = reason {
        state.statistics.rejected += 1;
        state.h = length * step_ratio(error, 1.0, order).min(1.0);
    } else {
        state.statistics.failed += 1;
        state.h = length * FAILURE_RATIO;
    }
    if trials >= LARGEST_TRIALS || state.h < least(state) {
        return Err(Error::Stuck {
            t: state.t,
            h: length,
            trials,
            reason,
        });
    }
    Ok(())
}

/// Returns the ratio of the next step to one with this `error` estimate, for a method of `order`,
/// after an accepted step with the error `memory`: a proportional-integral controller (Hairer,
/// Wanner II, section IV.2), whose memory keeps steps near a stability bound from oscillating.
fn step_ratio(error: f64, memory: f64, order: f64) -> f64 {
    let beta = 0.2 / order;
    let ratio = SAFETY * error.powf(0.75 * beta - 1.0 / order) * memory.powf(beta);
    ratio.clamp(LEAST_RATIO, LARGEST_RATIO)
}

//! The length of the first step.

use super::control::ErrorControl;
use super::error::Refusal;
use super::state::Statistics;
use super::system::{System, evaluate};

/// The start of an integration.
pub(super) struct Start<'a> {
    /// Time \[s\].
    pub(super) t: f64,
    /// The solution.
    pub(super) x: &'a [f64],
    /// The derivative.
    pub(super) dx: &'a [f64],
    /// Time to the first time asked for \[s\], negative towards earlier times: the right-hand side
    /// may change there.
    pub(super) gap: f64,
}

impl Start<'_> {
    /// Returns the length of a first step \[s\] for a method of `order`, from the sizes of x, of f
    /// and of the change of f over a short Euler step (Hairer, Nørsett, Wanner I, section II.4).
    /// `end` is storage for x and f.
    pub(super) fn step<S: System>(
        &self,
        system: &mut S,
        control: &ErrorControl,
        order: f64,
        end: &mut [Vec<f64>; 2],
        statistics: &mut Statistics,
    ) -> Result<f64, Refusal<S::Cause>> {
        let Self { t, x, dx, gap } = *self;
        let size = control.norm([x, x], |component| x[component]);
        let slope = control.norm([x, x], |component| dx[component]);
        let short = if size < 1e-5 || slope < 1e-5 {
            1e-6
        } else {
            0.01 * size / slope
        };
        let short = short.min(gap.abs());
        let [moved, there] = end;
        for (component, moved) in moved.iter_mut().enumerate() {
            *moved = x[component] + gap.signum() * short * dx[component];
        }
        match evaluate(system, t + gap.signum() * short, moved, there, statistics) {
            // The integrator will try the short step, and shorten it.
            Err(Refusal::Retry(_)) => return Ok(short),
            evaluated => evaluated?,
        }
        let change = control.norm([x, x], |component| there[component] - dx[component]);
        let largest = slope.max(change / short);
        let long = if largest > 1e-15 {
            (0.01 / largest).powf(1.0 / order)
        } else {
            (1e-3 * short).max(1e-6)
        };
        Ok(long.min(100.0 * short))
    }
}

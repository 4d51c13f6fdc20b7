//! The right-hand side of the equations.

use std::fmt::{Debug, Display};

use nalgebra::DMatrix;

use super::error::{Failure, Reason, Refusal};
use super::state::Statistics;

/// Ordinary differential equations ẋ = f(t, x), whose right-hand side may fail.
pub trait System {
    /// Cause of a failure.
    type Cause: Debug + Display;

    /// Sets `dx` to f(t, x). Trial points of one step are not in the order of time.
    ///
    /// # Errors
    ///
    /// [`Failure`]; a derivative that is not finite counts as [`Failure::Trial`].
    fn derivatives(
        &mut self,
        t: f64,
        x: &[f64],
        dx: &mut [f64],
    ) -> Result<(), Failure<Self::Cause>>;

    /// Sets `jacobian` to ∂f/∂x and `dx_dt` to ∂f/∂t at the last accepted point, at which f is
    /// `dx`. The stiff method needs both exact to keep its order.
    ///
    /// The default takes forward differences, by increments as in `radau5.f`, and allocates one
    /// copy of x.
    ///
    /// # Errors
    ///
    /// As for [`derivatives`](Self::derivatives).
    fn jacobian(
        &mut self,
        t: f64,
        x: &[f64],
        dx: &[f64],
        jacobian: &mut DMatrix<f64>,
        dx_dt: &mut [f64],
    ) -> Result<(), Failure<Self::Cause>> {
        let increment = |x: f64| (f64::EPSILON * x.abs().max(1e-5)).sqrt();
        let mut moved = x.to_vec();
        for (column, mut entries) in jacobian.column_iter_mut().enumerate() {
            moved[column] += increment(x[column]);
            let entries = entries.as_mut_slice();
            self.derivatives(t, &moved, entries)?;
            differences(entries, dx, moved[column] - x[column]);
            moved[column] = x[column];
        }
        let later = t + increment(t);
        self.derivatives(later, x, dx_dt)?;
        differences(dx_dt, dx, later - t);
        Ok(())
    }

    /// Moves the end of a trial step onto what the motion obeys exactly, before f is evaluated there.
    /// The default leaves it.
    ///
    /// # Errors
    ///
    /// As for [`derivatives`](Self::derivatives).
    fn project(&mut self, t: f64, x: &mut [f64]) -> Result<(), Failure<Self::Cause>> {
        let _ = (t, x);
        Ok(())
    }

    /// Takes note that the step to this point is accepted. The default does nothing.
    ///
    /// # Errors
    ///
    /// [`Failure::Trial`] refuses the step: the integrator tries a shorter one from the last
    /// accepted point, which the system must still be at. [`Failure::Hard`] ends the integration,
    /// [`Failure::Cut`] has the step end earlier.
    fn accept(&mut self, t: f64, x: &[f64], dx: &[f64]) -> Result<(), Failure<Self::Cause>> {
        let _ = (t, x, dx);
        Ok(())
    }
}

/// Replaces values by their difference quotients.
fn differences(values: &mut [f64], from: &[f64], increment: f64) {
    for (value, from) in values.iter_mut().zip(from) {
        *value = (*value - from) / increment;
    }
}

/// A trial step, from the last accepted point.
pub(super) struct Trial<'a> {
    /// Time of its start \[s\].
    pub(super) start: f64,
    /// Time of its end \[s\].
    pub(super) end: f64,
    /// The solution at its start.
    pub(super) x: &'a [f64],
    /// The derivative at its start.
    pub(super) dx: &'a [f64],
}

impl Trial<'_> {
    /// Returns the length of the step \[s\], negative towards earlier times.
    pub(super) fn length(&self) -> f64 {
        self.end - self.start
    }

    /// Returns the time at a fraction of the step \[s\].
    pub(super) fn time(&self, fraction: f64) -> f64 {
        if fraction < 1.0 {
            self.start + fraction * self.length()
        } else {
            self.end
        }
    }
}

/// Evaluates the right-hand side, counts the evaluation and checks its result.
pub(super) fn evaluate<S: System>(
    system: &mut S,
    t: f64,
    x: &[f64],
    dx: &mut [f64],
    statistics: &mut Statistics,
) -> Result<(), Refusal<S::Cause>> {
    statistics.evaluations += 1;
    if !x.iter().all(|x| x.is_finite()) {
        return Err(Refusal::Retry(Reason::NotFinite));
    }
    system.derivatives(t, x, dx)?;
    if dx.iter().all(|dx| dx.is_finite()) {
        Ok(())
    } else {
        Err(Refusal::Retry(Reason::NotFinite))
    }
}

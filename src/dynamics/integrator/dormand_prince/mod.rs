//! The explicit method of Dormand and Prince of order 8(5,3), as in the code `dop853.f` of Hairer,
//! Nørsett, Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., section II.10.

pub mod tableau;

use super::control::ErrorControl;
use super::dense::DenseOutput;
use super::error::Refusal;
use super::state::Statistics;
use super::system::{System, Trial, evaluate};
use tableau::{A, C, DENSE, END, ERROR_3, ERROR_5, STAGES, Terms};

/// Order of the method.
pub(super) const ORDER: f64 = 8.0;

/// Storage of the method.
#[derive(Clone, Debug)]
pub(super) struct DormandPrince {
    /// Derivatives k at the stages.
    stages: [Vec<f64>; STAGES],
    /// Argument of the last stage before the end.
    x: Vec<f64>,
}

impl DormandPrince {
    /// Makes the storage.
    pub(super) fn new(order: usize) -> Self {
        Self {
            stages: std::array::from_fn(|_| vec![0.0; order]),
            x: vec![0.0; order],
        }
    }

    /// Sets `end` to the solution at the end of a trial step and returns the norm of its error,
    /// which is NaN if the solution is not finite.
    pub(super) fn step<S: System>(
        &mut self,
        system: &mut S,
        trial: &Trial<'_>,
        control: &ErrorControl,
        end: &mut [f64],
        statistics: &mut Statistics,
    ) -> Result<f64, Refusal<S::Cause>> {
        let h = trial.length();
        self.stages[0].copy_from_slice(trial.dx);
        for stage in 1..END {
            self.advance(trial.x, h, A[stage], None);
            let (t, dx) = (trial.time(C[stage]), &mut self.stages[stage]);
            evaluate(system, t, &self.x, dx, statistics)?;
        }
        self.advance(trial.x, h, A[END], Some(end));
        Ok(self.error(control, trial, end))
    }

    /// Sets `x`, or the stage argument, to `from` plus the step along a sum of stages.
    fn advance(&mut self, from: &[f64], h: f64, terms: Terms, x: Option<&mut [f64]>) {
        let Self {
            stages,
            x: argument,
        } = self;
        let x = x.unwrap_or(argument);
        for (component, x) in x.iter_mut().enumerate() {
            *x = from[component] + h * sum(stages, terms, component);
        }
    }

    /// Returns the norm of the error, which joins estimates of orders 5 and 3 to one of order 7
    /// (section II.10, as in `dop853.f`).
    fn error(&self, control: &ErrorControl, trial: &Trial<'_>, end: &[f64]) -> f64 {
        let norm = |terms| control.norm([trial.x, end], |i| sum(&self.stages, terms, i));
        let (fifth, third) = (norm(ERROR_5), norm(ERROR_3));
        if fifth == 0.0 {
            return 0.0;
        }
        // At rest their squares are less than any number.
        trial.length().abs() * fifth * (fifth / fifth.hypot(0.1 * third))
    }

    /// Returns an estimate of the Lipschitz constant from the last two stages, both at the end of
    /// the step \[1/s\] (Hairer, Wanner II, section IV.2).
    pub(super) fn lipschitz(&self, control: &ErrorControl, end: [&[f64]; 2]) -> f64 {
        let [x, dx] = end;
        let change = |to: &[f64], from: &[f64]| control.norm([x, x], |i| to[i] - from[i]);
        let distance = change(x, &self.x);
        if distance > 0.0 {
            change(dx, &self.stages[END - 1]) / distance
        } else {
            0.0
        }
    }

    /// Evaluates the three stages of the dense output and sets its coefficients; `dx` is the
    /// derivative at the end.
    pub(super) fn interpolate<S: System>(
        &mut self,
        system: &mut S,
        dense: &mut DenseOutput,
        dx: &[f64],
        statistics: &mut Statistics,
    ) -> Result<(), Refusal<S::Cause>> {
        let h = dense.length();
        let (start, x) = dense.start();
        self.stages[END].copy_from_slice(dx);
        for stage in END + 1..STAGES {
            self.advance(x, h, A[stage], None);
            let (t, dx) = (start + C[stage] * h, &mut self.stages[stage]);
            evaluate(system, t, &self.x, dx, statistics)?;
        }
        for (component, dx) in dx.iter().enumerate() {
            dense.set_component(component, |change| {
                let first = h * self.stages[0][component] - change;
                let second = change - h * dx - first;
                let [a, b, c, d] = DENSE.map(|terms| h * sum(&self.stages, terms, component));
                [first, second, a, b, c, d]
            });
        }
        Ok(())
    }
}

/// Returns a sum over stages of one component.
fn sum(stages: &[Vec<f64>], terms: Terms, component: usize) -> f64 {
    let products = terms
        .iter()
        .map(|&(stage, factor)| factor * stages[stage][component]);
    products.sum()
}

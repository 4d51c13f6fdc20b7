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
    /// Derivatives k at the stages, by component.
    stages: Vec<[f64; STAGES]>,
    /// Argument of the last stage before the end, and its derivative.
    x: Vec<f64>,
    dx: Vec<f64>,
}

impl DormandPrince {
    /// Makes the storage.
    pub(super) fn new(order: usize) -> Self {
        Self {
            stages: vec![[0.0; STAGES]; order],
            x: vec![0.0; order],
            dx: vec![0.0; order],
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
        set(&mut self.stages, 0, trial.dx);
        for stage in 1..END {
            self.advance(trial.x, h, A[stage], None);
            self.evaluate(stage, system, trial.time(C[stage]), statistics)?;
        }
        self.advance(trial.x, h, A[END], Some(end));
        Ok(self.error(control, trial, end))
    }

    /// Evaluates the derivatives of a stage at the argument.
    fn evaluate<S: System>(
        &mut self,
        stage: usize,
        system: &mut S,
        t: f64,
        statistics: &mut Statistics,
    ) -> Result<(), Refusal<S::Cause>> {
        evaluate(system, t, &self.x, &mut self.dx, statistics)?;
        set(&mut self.stages, stage, &self.dx);
        Ok(())
    }

    /// Sets `x`, or the stage argument, to `from` plus the step along a sum of stages.
    fn advance(&mut self, from: &[f64], h: f64, terms: Terms, x: Option<&mut [f64]>) {
        let x = x.unwrap_or(&mut self.x);
        for ((x, from), stages) in x.iter_mut().zip(from).zip(&self.stages) {
            *x = from + h * sum(stages, terms);
        }
    }

    /// Returns the norm of the error, which joins estimates of orders 5 and 3 to one of order 7
    /// (section II.10, as in `dop853.f`).
    fn error(&self, control: &ErrorControl, trial: &Trial<'_>, end: &[f64]) -> f64 {
        let norm = |terms| control.norm([trial.x, end], |i| sum(&self.stages[i], terms));
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
        let distance = control.norm([x, x], |i| x[i] - self.x[i]);
        if distance > 0.0 {
            control.norm([x, x], |i| dx[i] - self.stages[i][END - 1]) / distance
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
        set(&mut self.stages, END, dx);
        for stage in END + 1..STAGES {
            self.advance(x, h, A[stage], None);
            self.evaluate(stage, system, start + C[stage] * h, statistics)?;
        }
        for (component, (dx, stages)) in dx.iter().zip(&self.stages).enumerate() {
            dense.set_component(component, |change| {
                let first = h * stages[0] - change;
                let second = change - h * dx - first;
                let [a, b, c, d] = DENSE.map(|terms| h * sum(stages, terms));
                [first, second, a, b, c, d]
            });
        }
        Ok(())
    }
}

/// Returns a sum over the stages of one component.
fn sum(stages: &[f64; STAGES], terms: Terms) -> f64 {
    let products = terms.iter().map(|&(stage, factor)| factor * stages[stage]);
    products.sum()
}

/// Sets the derivatives of a stage.
fn set(stages: &mut [[f64; STAGES]], stage: usize, dx: &[f64]) {
    for (stages, dx) in stages.iter_mut().zip(dx) {
        stages[stage] = *dx;
    }
}

//! The Rosenbrock method Rodas5P of order 5(4): L-stable, stiffly accurate, without iterations.
//!
//! The stages u solve linear systems with one matrix (Hairer, Wanner, *Solving Ordinary
//! Differential Equations II*, section IV.7, for ẋ = f(t, x)):
//!
//! (I / (γ h) − ∂f/∂x) uᵢ = f(t + αᵢ h, x + Σ aᵢⱼ uⱼ) + Σ cᵢⱼ uⱼ / h + γᵢ h ∂f/∂t

pub mod tableau;

use nalgebra::DMatrix;

use super::control::ErrorControl;
use super::dense::DenseOutput;
use super::error::{Reason, Refusal};
use super::state::Statistics;
use super::system::{System, Trial, evaluate};
use crate::kinematics::{DenseLu, Factors, Singular};
use tableau::{A, ALPHA, C, DENSE, GAMMA, GAMMA_T, STAGES};

/// Order of the method.
pub(super) const ORDER: f64 = 5.0;

/// Number of products with the Jacobian in an estimate of its spectral radius. The first half
/// turns the vector towards the largest eigenvalues, the second half is averaged.
const PRODUCTS: usize = 12;

/// Storage of the method.
#[derive(Clone, Debug)]
pub(super) struct Rosenbrock {
    jacobian: DMatrix<f64>,
    /// ∂f/∂t.
    dx_dt: Vec<f64>,
    /// Whether both belong to the last accepted point.
    linearised: bool,
    factors: DenseLu,
    /// The stages u.
    stages: [Vec<f64>; STAGES],
    /// Argument of a stage.
    x: Vec<f64>,
}

impl Rosenbrock {
    /// Makes the storage.
    pub(super) fn new(order: usize) -> Self {
        Self {
            jacobian: DMatrix::zeros(order, order),
            dx_dt: vec![0.0; order],
            linearised: false,
            factors: DenseLu::new(order, 0),
            stages: std::array::from_fn(|_| vec![0.0; order]),
            x: vec![0.0; order],
        }
    }

    /// Drops the Jacobian: the accepted point or the right-hand side has changed.
    pub(super) fn forget(&mut self) {
        self.linearised = false;
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
        self.linearise(system, trial, statistics)?;
        self.factorise(trial.length(), statistics)
            .map_err(|Singular| Refusal::Retry(Reason::Singular))?;
        for stage in 0..STAGES {
            self.set_argument(stage, trial.x);
            let (stages, rest) = self.stages.split_at_mut(stage);
            let u = &mut rest[0];
            if stage == 0 {
                u.copy_from_slice(trial.dx);
            } else {
                evaluate(system, trial.time(ALPHA[stage]), &self.x, u, statistics)?;
            }
            for (component, u) in u.iter_mut().enumerate() {
                *u += sum(stages, C[stage], component) / trial.length()
                    + GAMMA_T[stage] * trial.length() * self.dx_dt[component];
            }
            self.factors.solve(u);
        }
        // The last stage is the error: the argument before it has order 4.
        let error = &self.stages[STAGES - 1];
        for (end, (x, error)) in end.iter_mut().zip(self.x.iter().zip(error)) {
            *end = x + error;
        }
        Ok(control.norm([trial.x, end], |component| error[component]))
    }

    /// Evaluates the Jacobian at the start of the step, once for all trials from there.
    fn linearise<S: System>(
        &mut self,
        system: &mut S,
        trial: &Trial<'_>,
        statistics: &mut Statistics,
    ) -> Result<(), Refusal<S::Cause>> {
        if !self.linearised {
            statistics.jacobians += 1;
            let (jacobian, dx_dt) = (&mut self.jacobian, &mut self.dx_dt);
            system.jacobian(trial.start, trial.x, trial.dx, jacobian, dx_dt)?;
            self.linearised = true;
        }
        Ok(())
    }

    /// Factorises I / (γ h) − ∂f/∂x.
    fn factorise(&mut self, h: f64, statistics: &mut Statistics) -> Result<(), Singular> {
        statistics.factorisations += 1;
        self.factors.clear();
        for (column, derivatives) in self.jacobian.column_iter().enumerate() {
            for (row, derivative) in derivatives.iter().enumerate() {
                self.factors.add(row, column, -derivative);
            }
            self.factors.add(column, column, 1.0 / (GAMMA * h));
        }
        self.factors.factorise(0.0)
    }

    /// Sets the argument of a stage.
    fn set_argument(&mut self, stage: usize, from: &[f64]) {
        for (component, x) in self.x.iter_mut().enumerate() {
            *x = match A.get(stage) {
                Some(terms) => from[component] + sum(&self.stages, terms, component),
                None => *x + self.stages[stage - 1][component],
            };
        }
    }

    /// Returns an estimate of the spectral radius of the Jacobian at the start of the step \[1/s\],
    /// by the power method. Overwrites ∂f/∂t.
    pub(super) fn spectral_radius(&mut self, control: &ErrorControl, x: &[f64]) -> f64 {
        // Both are needed until the end of the step only, the stages for the dense output too.
        let (vector, product) = (&mut self.x, &mut self.dx_dt);
        for (component, entry) in vector.iter_mut().enumerate() {
            // A component out of error control does not act on the others.
            let weight = control.weight(component, x[component]);
            *entry = if weight.is_finite() { weight } else { 0.0 };
        }
        let mut growth = 1.0;
        for count in 0..PRODUCTS {
            product.fill(0.0);
            for (column, factor) in self.jacobian.column_iter().zip(&*vector) {
                for (sum, entry) in product.iter_mut().zip(&column) {
                    *sum += factor * entry;
                }
            }
            let norm = control.norm([x, x], |component| product[component]);
            if !(norm > 0.0 && norm.is_finite()) {
                return norm;
            }
            for (entry, value) in vector.iter_mut().zip(&*product) {
                *entry = value / norm;
            }
            if 2 * count >= PRODUCTS {
                growth *= norm;
            }
        }
        growth.powf(2.0 / PRODUCTS as f64)
    }

    /// Sets the coefficients of the dense output, of order 4 and without evaluations.
    pub(super) fn interpolate(&self, dense: &mut DenseOutput) {
        for component in 0..self.x.len() {
            let [a, b, c] = DENSE.map(|terms| sum(&self.stages, terms, component));
            dense.set_component(component, |_| [a, b + c, -c, 0.0, 0.0, 0.0]);
        }
    }
}

/// Returns a sum over stages of one component.
fn sum(stages: &[Vec<f64>], factors: &[f64], component: usize) -> f64 {
    let products = stages
        .iter()
        .zip(factors)
        .map(|(stage, factor)| factor * stage[component]);
    products.sum()
}

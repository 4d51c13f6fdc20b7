//! Velocity and acceleration analysis (Ec. 3.6.10 and 3.6.11).

use nalgebra::DVector;

use super::configuration::Configuration;
use super::factor::DenseLu;
use super::system::System;
use crate::mechanism::{DriverId, Jet};

/// First and second derivative of q: with respect to time, or along a path.
#[derive(Clone, Debug)]
pub struct Rates {
    velocity: DVector<f64>,
    acceleration: DVector<f64>,
}

impl Rates {
    /// Rates of zero for `unknowns` generalized coordinates.
    #[must_use]
    pub fn new(unknowns: usize) -> Self {
        Self {
            velocity: DVector::zeros(unknowns),
            acceleration: DVector::zeros(unknowns),
        }
    }

    /// q̇: \[m/s, m/s, rad/s\] for each body.
    #[must_use]
    pub fn velocity(&self) -> &[f64] {
        self.velocity.as_slice()
    }

    /// q̈: \[m/s², m/s², rad/s²\] for each body.
    #[must_use]
    pub fn acceleration(&self) -> &[f64] {
        self.acceleration.as_slice()
    }

    /// Solves both equations with the Jacobian factorised at the accepted pose:
    /// Phi_q q̇ = u̇ in the drivers' rows, then Phi_q q̈ = ü − q̇ᵀ (∂²c/∂q²) q̇.
    pub(super) fn solve(
        &mut self,
        system: &System,
        at: &Configuration,
        lu: &DenseLu,
        driver: impl Fn(DriverId) -> Jet,
    ) {
        system.velocity_side(at, |d| driver(d).first, self.velocity.as_mut_slice());
        lu.solve(&mut self.velocity);
        unscale(system, &mut self.velocity, at.size());

        system.acceleration_side(
            at,
            self.velocity.as_slice(),
            |d| driver(d).second,
            self.acceleration.as_mut_slice(),
        );
        lu.solve(&mut self.acceleration);
        unscale(system, &mut self.acceleration, at.size());
    }

    pub(super) fn is_finite(&self) -> bool {
        self.velocity.iter().all(|v| v.is_finite())
            && self.acceleration.iter().all(|v| v.is_finite())
    }
}

fn unscale(system: &System, rates: &mut DVector<f64>, size: f64) {
    for (column, rate) in rates.iter_mut().enumerate() {
        *rate *= system.column_scale(column, size);
    }
}

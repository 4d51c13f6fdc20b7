//! First and second derivatives of the generalized coordinates.

/// First and second derivative of q: with respect to time, or along a path.
#[derive(Clone, Debug, Default)]
pub struct Rates {
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
}

impl Rates {
    /// Returns rates of zero for `unknowns` generalized coordinates.
    #[must_use]
    pub fn new(unknowns: usize) -> Self {
        Self {
            velocity: vec![0.0; unknowns],
            acceleration: vec![0.0; unknowns],
        }
    }

    /// Returns q̇, \[m/s, m/s, rad/s\] for each body.
    #[must_use]
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Returns q̈, \[m/s², m/s², rad/s²\] for each body.
    #[must_use]
    pub fn acceleration(&self) -> &[f64] {
        &self.acceleration
    }

    /// Copies other rates of as many coordinates.
    pub(in crate::kinematics) fn copy_from(&mut self, other: &Self) {
        self.velocity.copy_from_slice(&other.velocity);
        self.acceleration.copy_from_slice(&other.acceleration);
    }

    /// Returns velocity and acceleration, to be written.
    pub(in crate::kinematics) fn both_mut(&mut self) -> (&mut [f64], &mut [f64]) {
        (&mut self.velocity, &mut self.acceleration)
    }

    /// Writes the rates of a motion along which u runs with u̇ and ü, from these derivatives with
    /// respect to u: q̇ = q_u u̇ and q̈ = q_uu u̇² + q_u ü. Returns whether all are finite.
    pub(in crate::kinematics) fn scale(&self, first: f64, second: f64, rates: &mut Self) -> bool {
        // The sum is zero unless a term is not finite; terms may be added in any order.
        let mut sum = 0.0;
        let derivatives = self.velocity.iter().zip(&self.acceleration);
        let rates = rates.velocity.iter_mut().zip(&mut rates.acceleration);
        for ((v, a), (velocity, acceleration)) in derivatives.zip(rates) {
            *velocity = v * first;
            *acceleration = a * (first * first) + v * second;
            sum += 0.0 * (*velocity + *acceleration);
        }
        sum == 0.0
    }

    /// Returns whether all rates are finite.
    pub(in crate::kinematics) fn is_finite(&self) -> bool {
        let all = self.velocity.iter().chain(&self.acceleration);
        all.fold(0.0, |sum, rate| sum + 0.0 * rate) == 0.0
    }
}

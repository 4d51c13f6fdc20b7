//! The solution between the ends of a step.

/// Number of coefficients besides the two ends, for a polynomial of degree 7.
pub(super) const COEFFICIENTS: usize = 6;

/// A polynomial in time between the ends of a step, in the form of Hairer, Nørsett, Wanner I,
/// section II.6: with θ from 0 at the start to 1 at the end,
///
/// x = (1 − θ) x₀ + θ (x₁ + (1 − θ) (c₀ + θ (c₁ + (1 − θ) (c₂ + …)))).
#[derive(Clone, Debug)]
pub struct DenseOutput {
    /// Time of the start \[s\].
    start: f64,
    /// Time of the end \[s\].
    end: f64,
    /// The solution at both ends.
    x: [Vec<f64>; 2],
    coefficients: [Vec<f64>; COEFFICIENTS],
}

impl DenseOutput {
    /// Makes the storage.
    pub(super) fn new(order: usize) -> Self {
        let zeros = || vec![0.0; order];
        Self {
            start: 0.0,
            end: 0.0,
            x: std::array::from_fn(|_| zeros()),
            coefficients: std::array::from_fn(|_| zeros()),
        }
    }

    /// Sets the ends.
    pub(super) fn set_ends(&mut self, times: [f64; 2], x: [&[f64]; 2]) {
        [self.start, self.end] = times;
        for (own, x) in self.x.iter_mut().zip(x) {
            own.copy_from_slice(x);
        }
    }

    /// Returns the length of the step \[s\].
    pub(super) fn length(&self) -> f64 {
        self.end - self.start
    }

    /// Returns the time \[s\] and the solution at the start.
    pub(super) fn start(&self) -> (f64, &[f64]) {
        (self.start, &self.x[0])
    }

    /// Sets all coefficients of one component.
    pub(super) fn set_component(
        &mut self,
        component: usize,
        values: impl FnOnce(f64) -> [f64; COEFFICIENTS],
    ) {
        let values = values(self.x[1][component] - self.x[0][component]);
        for (coefficient, value) in self.coefficients.iter_mut().zip(values) {
            coefficient[component] = value;
        }
    }

    /// Sets `x` to the solution at a time in the step; at both ends to the bit. Beyond the ends
    /// the polynomial extrapolates. Components beyond the shorter of `x` and the state stay.
    pub fn interpolate(&self, t: f64, x: &mut [f64]) {
        let later = (t - self.start) / self.length();
        let earlier = 1.0 - later;
        let order = self.x[0].len();
        for (component, x) in x.iter_mut().enumerate().take(order) {
            let mut sum = 0.0;
            for (power, coefficient) in self.coefficients.iter().enumerate().rev() {
                let factor = if power % 2 == 0 { earlier } else { later };
                sum = factor * (coefficient[component] + sum);
            }
            *x = earlier * self.x[0][component] + later * (self.x[1][component] + sum);
        }
    }
}

//! The path over one step of all that moves a mechanism from outside.

mod drivers;
mod motions;
mod rates;

use crate::kinematics::tolerances::SAME_PLACE_ON_PATH;
use crate::mechanism::{DriverId, DriverSource, Jet, Mechanism};

pub(super) use drivers::PathDrivers;
pub(super) use motions::Motions;
pub use rates::Rates;

/// Time, parameters and drivers from one communication point to the next, as functions of s from
/// 0 to 1.
///
/// Time and parameters run straight. A driver runs along its [`DriverPath`].
#[derive(Clone, Debug)]
pub struct Path {
    /// Time at s = 0 \[s\].
    pub start: f64,
    /// Time from s = 0 to s = 1 \[s\], not negative; zero where only values change.
    pub duration: f64,
    /// Parameters at s = 0 \[SI\].
    pub from: Vec<f64>,
    /// Parameters at s = 1 \[SI\]. In between, the derived ones follow the others.
    pub to: Vec<f64>,
    /// One per driver.
    pub driver_paths: Vec<DriverPath>,
}

/// The course of one driver along a [`Path`]. Lengths in metres, angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriverPath {
    /// position + velocity τ + acceleration τ²/2 with τ = s · duration, and the rest of a jump at
    /// the start, (1 − s) · jump. Held inputs have neither velocity nor acceleration.
    Input {
        /// Value of the polynomial at s = 0.
        position: f64,
        /// Its first derivative in time at s = 0.
        velocity: f64,
        /// Its second derivative in time.
        acceleration: f64,
        /// The value that the mechanism has at s = 0 minus `position`.
        jump: f64,
    },
    /// The driver's prescribed motion.
    Motion,
    /// Σ c_k sᵏ, by its coefficients.
    Polynomial([f64; 6]),
}

impl DriverPath {
    /// Returns the polynomial of degree 5 through values and two derivatives by s at both ends.
    #[must_use]
    pub fn through(from: Jet, to: Jet) -> Self {
        let [first, half] = [from.first(), 0.5 * from.second()];
        // The rest of value and derivatives at the end.
        let value = to.value - (from.value + first + half);
        let slope = to.first() - (first + 2.0 * half);
        let bend = to.second() - 2.0 * half;
        Self::Polynomial([
            from.value,
            first,
            half,
            10.0 * value - 4.0 * slope + 0.5 * bend,
            -15.0 * value + 7.0 * slope - bend,
            6.0 * value - 3.0 * slope + 0.5 * bend,
        ])
    }

    /// Returns the cubic with these values at 0, 1/3, 2/3 and 1.
    #[must_use]
    pub fn cubic([a, b, c, d]: [f64; 4]) -> Self {
        Self::Polynomial([
            a,
            -5.5 * a + 9.0 * b - 4.5 * c + d,
            9.0 * a - 22.5 * b + 18.0 * c - 4.5 * d,
            -4.5 * a + 13.5 * b - 13.5 * c + 4.5 * d,
            0.0,
            0.0,
        ])
    }

    /// Returns an input's polynomial a time `tau` after s = 0, without the rest of a jump; `None` for
    /// other paths.
    #[inline]
    #[must_use]
    pub fn input_after(&self, tau: f64) -> Option<Jet> {
        let Self::Input {
            position,
            velocity,
            acceleration,
            ..
        } = *self
        else {
            return None;
        };
        Some(Jet::new(position, [velocity, acceleration]).after(tau))
    }

    /// Returns a held input at `position`, reached straight from the value `now`.
    #[must_use]
    pub fn held(position: f64, now: f64) -> Self {
        Self::Input {
            position,
            velocity: 0.0,
            acceleration: 0.0,
            jump: now - position,
        }
    }
}

impl Path {
    /// Returns a path on which nothing moves, at the file's own values.
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
        let parameters = mechanism.default_parameters();
        let drivers = mechanism.drivers.iter();
        let paths = drivers.map(|driver| match driver.source {
            DriverSource::Input { start } | DriverSource::Free { start, .. } => {
                DriverPath::held(start, start)
            }
            DriverSource::Motion(_) => DriverPath::Motion,
        });
        Self {
            start: mechanism.simulation.start,
            duration: 0.0,
            from: parameters.clone(),
            to: parameters,
            driver_paths: paths.collect(),
        }
    }

    /// Returns whether the parameters differ between the two ends.
    #[must_use]
    pub fn moves_parameters(&self) -> bool {
        self.from != self.to
    }

    /// Returns whether any driver runs along a prescribed motion.
    #[must_use]
    pub fn has_motions(&self) -> bool {
        self.driver_paths.contains(&DriverPath::Motion)
    }

    /// Returns the time at s.
    #[must_use]
    pub fn time(&self, s: f64) -> f64 {
        self.start + s * self.duration
    }

    /// Returns the drivers' values at the end.
    #[must_use]
    pub fn drivers_at_end(&self, mechanism: &Mechanism) -> Vec<f64> {
        let mut motions = Motions::new(mechanism);
        motions.set_parameters(|p| Jet::constant(self.to[p.index()]));
        let mut drivers = vec![Jet::constant(0.0); self.driver_paths.len()];
        self.drivers(1.0, &motions, &mut drivers);
        drivers.iter().map(|driver| driver.value).collect()
    }

    /// Returns the first s after `s` at which a motion begins another piece, or the end of the
    /// path.
    pub(super) fn next_point(&self, s: f64, motions: &Motions) -> f64 {
        if self.duration <= 0.0 {
            return 1.0;
        }
        // A nearer point has been reached.
        let after = self.time(s + SAME_PLACE_ON_PATH);
        ((motions.next_point(after) - self.start) / self.duration).min(1.0)
    }

    /// Writes the parameters at s with their derivatives with respect to s.
    pub(super) fn parameters(&self, mechanism: &Mechanism, s: f64, out: &mut [Jet]) {
        for ((out, from), to) in out.iter_mut().zip(&self.from).zip(&self.to) {
            // Exact at both ends.
            let value = if s < 1.0 { from + s * (to - from) } else { *to };
            *out = Jet::linear(value, to - from);
        }
        mechanism.derive_parameters(out);
    }

    /// Writes the drivers' values at s with their derivatives with respect to s; `motions` are
    /// those for the parameters at s.
    pub(super) fn drivers(&self, s: f64, motions: &Motions, out: &mut [Jet]) {
        let h = self.duration;
        for ((driver, path), out) in self.driver_paths.iter().enumerate().zip(out) {
            // Written in place: a value that is copied on waits for its parts.
            match *path {
                DriverPath::Motion => {
                    *out = motions.evaluate(DriverId(driver), Jet::linear(self.time(s), h));
                }
                DriverPath::Input {
                    position,
                    velocity,
                    acceleration,
                    jump,
                } => {
                    let at = Jet::new(position, [velocity, acceleration]).after(s * h);
                    out.value = at.value + (1.0 - s) * jump;
                    out.derivatives = [h * at.first() - jump, h * h * acceleration];
                }
                DriverPath::Polynomial(coefficients) => {
                    let on = |derivative| polynomial(&coefficients, derivative, s);
                    *out = Jet::new(on(0), [on(1), on(2)]);
                }
            }
        }
    }
}

/// Returns a derivative of Σ c_k sᵏ.
pub(super) fn polynomial(coefficients: &[f64], derivative: usize, s: f64) -> f64 {
    let terms = coefficients.iter().enumerate().skip(derivative).rev();
    terms.fold(0.0, |sum, (k, coefficient)| {
        let factor: usize = (k + 1 - derivative..=k).product();
        sum * s + factor as f64 * coefficient
    })
}

//! Standard motion laws of cam and servo design: strokes from 0 to 1.

use std::f64::consts::PI;

use crate::mechanism::Number;

/// Motion law: course of a driver from one value of its table to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// Polynomial 3-4-5: velocity and acceleration are zero at both ends.
    Polynomial345,
    /// Polynomial 4-5-6-7: the jerk is zero at both ends as well.
    Polynomial4567,
    /// The acceleration is a whole sine wave.
    Cycloidal,
    /// Half a cosine wave; the acceleration jumps at both ends.
    Harmonic,
    /// Sine pieces of two frequencies: small velocity and acceleration peaks.
    ModifiedSine,
    /// Constant acceleration with sine flanks: the smallest smooth acceleration peak.
    ModifiedTrapezoidal,
    /// The servo drive's profile: constant acceleration, velocity and deceleration for a third
    /// each, so that the velocity is a trapezium.
    Trapezoidal,
}

impl Law {
    /// All laws.
    pub const ALL: [Self; 7] = [
        Self::Polynomial345,
        Self::Polynomial4567,
        Self::Cycloidal,
        Self::Harmonic,
        Self::ModifiedSine,
        Self::ModifiedTrapezoidal,
        Self::Trapezoidal,
    ];
    /// The ends of the pieces of all laws, as parts of their time.
    pub const PIECES: [f64; 9] = [
        0.0,
        0.125,
        1.0 / 3.0,
        0.375,
        0.5,
        0.625,
        2.0 / 3.0,
        0.875,
        1.0,
    ];

    /// Returns whether its acceleration jumps, at its ends or in between.
    #[must_use]
    pub fn jumps(self) -> bool {
        matches!(self, Self::Harmonic | Self::Trapezoidal)
    }

    /// Returns the way from one point of a table to the next, at the abscissa `x` of this segment.
    pub fn between<N: Number>(self, abscissas: &[N], ordinates: &[N], segment: usize, x: N) -> N {
        let [from, to] = [segment, segment + 1].map(|k| abscissas[k]);
        let [low, high] = [segment, segment + 1].map(|k| ordinates[k]);
        low + (high - low) * self.stroke((x - from) / (to - from))
    }

    /// Returns the part of the stroke done after the part `tau` of its time, both from 0 to 1.
    ///
    /// Each law is symmetric: s(τ) + s(1 − τ) = 1.
    pub fn stroke<N: Number>(self, tau: N) -> N {
        let c = N::constant;
        if tau.real() > 0.5 {
            return c(1.0) - self.first_half(c(1.0) - tau);
        }
        self.first_half(tau)
    }

    /// Returns the largest magnitude of the second derivative of [`stroke`](Self::stroke). For the
    /// polynomials the third derivative is zero there, at (1 − 2τ)² = 1/3 and 1/5.
    #[must_use]
    pub fn peak_acceleration(self) -> f64 {
        match self {
            Self::Polynomial345 => 10.0 / 3_f64.sqrt(),
            Self::Polynomial4567 => 16.8 / 5_f64.sqrt(),
            Self::Cycloidal => 2.0 * PI,
            Self::Harmonic => PI * PI / 2.0,
            Self::ModifiedSine => 4.0 * PI * PI / (4.0 + PI),
            Self::ModifiedTrapezoidal => 8.0 * PI / (2.0 + PI),
            Self::Trapezoidal => 4.5,
        }
    }

    fn first_half<N: Number>(self, tau: N) -> N {
        let c = N::constant;
        let t = tau.real();
        let cube = tau * tau * tau;
        match self {
            Self::Polynomial345 => cube * (c(10.0) + tau * (c(6.0) * tau - c(15.0))),
            Self::Polynomial4567 => {
                cube * tau * (c(35.0) + tau * (tau * (c(70.0) - c(20.0) * tau) - c(84.0)))
            }
            Self::Cycloidal => tau - (c(2.0 * PI) * tau).sin() / c(2.0 * PI),
            Self::Harmonic => c(0.5) * (c(1.0) - (c(PI) * tau).cos()),
            Self::ModifiedSine => {
                let part = if t < 0.125 {
                    c(PI) * tau - c(0.25) * (c(4.0 * PI) * tau).sin()
                } else {
                    c(2.0) + c(PI) * tau - c(2.25) * (c(4.0 * PI / 3.0) * tau + c(PI / 3.0)).sin()
                };
                part / c(4.0 + PI)
            }
            Self::ModifiedTrapezoidal => {
                // Peak acceleration, which makes the stroke 1, and the velocities and strokes
                // where one piece follows the other.
                let peak = 8.0 * PI / (2.0 + PI);
                let v1 = peak / (4.0 * PI);
                let s1 = v1 * (0.125 - 1.0 / (4.0 * PI));
                let (v2, s2) = (v1 + 0.25 * peak, s1 + 0.25 * v1 + peak / 32.0);
                if t < 0.125 {
                    c(v1) * (tau - (c(4.0 * PI) * tau).sin() / c(4.0 * PI))
                } else if t < 0.375 {
                    let x = tau - c(0.125);
                    c(s1) + x * (c(v1) + c(0.5 * peak) * x)
                } else {
                    let x = tau - c(0.375);
                    let flank = c(peak / (16.0 * PI * PI)) * (c(1.0) - (c(4.0 * PI) * x).cos());
                    c(s2) + c(v2) * x + flank
                }
            }
            Self::Trapezoidal => {
                if t < 1.0 / 3.0 {
                    c(2.25) * tau * tau
                } else {
                    c(1.5) * tau - c(0.25)
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::Jet;
    use proptest::prelude::*;

    /// Returns the peak velocity of a unit stroke in unit time, at τ = 1/2.
    fn peak_velocity(law: Law) -> f64 {
        match law {
            Law::Polynomial345 => 15.0 / 8.0,
            Law::Polynomial4567 => 35.0 / 16.0,
            Law::Cycloidal | Law::ModifiedTrapezoidal => 2.0,
            Law::Harmonic => PI / 2.0,
            Law::ModifiedSine => 4.0 * PI / (4.0 + PI),
            Law::Trapezoidal => 1.5,
        }
    }

    #[test]
    fn peaks_are_those_of_the_closed_forms() {
        for law in Law::ALL {
            let (velocity, acceleration) = (peak_velocity(law), law.peak_acceleration());
            let peak = |of: fn(Jet) -> f64| {
                (0..=100_000)
                    .map(|k| of(law.stroke(Jet::variable(f64::from(k) / 1e5))).abs())
                    .fold(0.0, f64::max)
            };
            // Half a step beside the peak, 5e-6, loses at most half the second derivative there,
            // below 60 for the velocities and 600 for the accelerations, times its square.
            assert!((peak(|s| s.first()) - velocity).abs() < 1e-9, "{law:?}");
            assert!(
                (peak(|s| s.second()) - acceleration).abs() < 1e-8,
                "{law:?}"
            );
        }
    }

    #[test]
    fn a_stroke_goes_from_rest_to_rest() {
        for law in Law::ALL {
            let (start, end) = (
                law.stroke(Jet::variable(0.0)),
                law.stroke(Jet::variable(1.0)),
            );
            assert_eq!((start.value, end.value), (0.0, 1.0), "{law:?}");
            assert_eq!((start.first(), end.first()), (0.0, 0.0), "{law:?}");
            let smooth = !matches!(law, Law::Harmonic | Law::Trapezoidal);
            if smooth {
                assert!(start.second().abs() + end.second().abs() < 1e-14, "{law:?}");
            }
        }
    }

    proptest! {
        /// Across a step of 1e-7 the value changes by less than twice the largest velocity times
        /// that, and the velocity by the largest acceleration times that: no jumps where pieces
        /// meet. The velocity is the value's own derivative (the mean value theorem's bound is
        /// half of 8 · 1e-7 here).
        #[test]
        fn pieces_meet(tau in 0.0..0.999_f64) {
            const STEP: f64 = 1e-7;
            for law in Law::ALL {
                for tau in [tau, 0.125, 0.375, 0.5, 0.625, 0.875, 1.0 / 3.0, 2.0 / 3.0] {
                    let (here, there) =
                        (law.stroke(Jet::variable(tau - STEP)), law.stroke(Jet::variable(tau)));
                    prop_assert!((there.value - here.value - STEP * here.first()).abs() < 1e-13);
                    prop_assert!((there.first() - here.first()).abs() < 8.0 * STEP);
                }
            }
        }
    }
}

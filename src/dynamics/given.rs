//! Inputs from outside during a free motion.

use crate::kinematics::Path;
use crate::mechanism::{DriverId, Jet};

/// The inputs of a mechanism as functions of time.
pub trait Given {
    /// Returns value, velocity and acceleration of a driver that is an input \[SI\].
    fn driver(&self, driver: DriverId, time: f64) -> Jet;

    /// Writes the sizes of the forces that are inputs \[SI\], in the order of their variables.
    fn loads(&self, time: f64, loads: &mut [f64]);
}

/// The inputs of a step: drivers on the polynomials of a path, forces as functions of the time since its
/// start. What jumps does so at the start.
#[derive(Clone, Copy, Debug)]
pub struct GivenByPath<'a, F> {
    /// The path.
    pub path: &'a Path,
    /// Returns the size of an input of a force \[SI\] a time \[s\] after the start.
    pub load: F,
}

impl<F: Fn(usize, f64) -> f64> Given for GivenByPath<'_, F> {
    fn driver(&self, driver: DriverId, time: f64) -> Jet {
        let driver_path = self.path.driver_paths[driver.index()];
        let at = driver_path.input_after(time - self.path.start);
        at.expect("the curve of an input is a polynomial in time")
    }

    fn loads(&self, time: f64, loads: &mut [f64]) {
        let tau = time - self.path.start;
        for (input, load) in loads.iter_mut().enumerate() {
            *load = (self.load)(input, tau);
        }
    }
}

/// Returns the motion at the fraction `s` of a time `h` on the cubic that has the values and velocities of
/// `from` and `to` at its ends. Returns `to` unless `h` is positive.
#[must_use]
pub fn on_cubic(from: Jet, to: Jet, h: f64, s: f64) -> Jet {
    if h <= 0.0 {
        return to;
    }
    let [before, after] = [from, to].map(|jet| h * jet.first());
    let rise = to.value - from.value;
    // Coefficients of s² and s³.
    let [square, cube] = [
        3.0 * rise - 2.0 * before - after,
        before + after - 2.0 * rise,
    ];
    Jet::new(
        from.value + s * (before + s * (square + s * cube)),
        [
            (before + s * (2.0 * square + 3.0 * s * cube)) / h,
            (2.0 * square + 6.0 * s * cube) / (h * h),
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::on_cubic;
    use crate::mechanism::Jet;

    /// t³ − 2 t between 1 and 3: the cubic itself.
    #[test]
    fn a_cubic_is_met_between_its_ends() {
        let exact = |t: f64| Jet::new(t * t * t - 2.0 * t, [3.0 * t * t - 2.0, 6.0 * t]);
        let (from, to) = (exact(1.0), exact(3.0));
        for s in [0.0, 0.25, 0.5, 1.0] {
            let (at, truth) = (on_cubic(from, to, 2.0, s), exact(1.0 + 2.0 * s));
            // Some roundings of numbers up to 27 and twice that.
            assert!((at.value - truth.value).abs() < 2e-14, "{s}");
            assert!((at.first() - truth.first()).abs() < 2e-14, "{s}");
            assert!((at.second() - truth.second()).abs() < 5e-14, "{s}");
        }
        assert_eq!(on_cubic(from, to, 0.0, 0.5), to);
    }
}

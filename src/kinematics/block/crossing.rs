//! The motion of a block through a change point, as polynomials.

use crate::mechanism::DriverId;

/// The place up to which a crossing is good: rounding may move a driver's value beyond its ends.
pub(in crate::kinematics) const SEAM: f64 = 1.0 + 1e-9;

/// The motion of one block of equations through a change point, as a function of the one driver
/// that moves the block.
///
/// On either side of the point, where the block is regular, position and both derivatives are known
/// to rounding; between them each unknown is the polynomial of fifth degree with these values.
/// Newton–Raphson would lose the position as eps/δ at the distance δ from the point, the velocity
/// as eps/δ² and the acceleration as eps/δ³.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// Index of the block in the order of solution.
    pub block: usize,
    /// The driver that moves the block.
    pub driver: DriverId,
    /// The driver's value at the change point \[m or rad\].
    pub center: f64,
    /// Distance from the change point to either end \[m or rad\].
    pub half_width: f64,
    /// One polynomial per unknown of the block in x = (u − center) / half_width, from the constant
    /// upwards.
    pub coefficients: Vec<[f64; 6]>,
    /// The null vector of the Jacobian at the point, one entry per unknown of the block, scaled so
    /// that metres and radians compare and the largest entry is one.
    pub free: Vec<f64>,
}

impl Crossing {
    /// Returns x for a value of the driver: −1 at one end, 1 at the other.
    pub(in crate::kinematics) fn place(&self, value: f64) -> f64 {
        (value - self.center) / self.half_width
    }

    /// Returns an unknown with its first and second derivative in the driver's value.
    pub(in crate::kinematics) fn evaluate(&self, local: usize, value: f64) -> [f64; 3] {
        let [a0, a1, a2, a3, a4, a5] = self.coefficients[local];
        let x = self.place(value);
        let width = self.half_width;
        [
            a0 + x * (a1 + x * (a2 + x * (a3 + x * (a4 + x * a5)))),
            (a1 + x * (2.0 * a2 + x * (3.0 * a3 + x * (4.0 * a4 + x * 5.0 * a5)))) / width,
            (2.0 * a2 + x * (6.0 * a3 + x * (12.0 * a4 + x * 20.0 * a5))) / (width * width),
        ]
    }

    /// Bounds the magnitudes of an unknown's first and second derivative in the driver's value.
    pub(in crate::kinematics) fn steepest(&self, local: usize) -> [f64; 2] {
        let width = self.half_width;
        let powers = (0..6).zip(&self.coefficients[local]);
        let [first, second] = powers.fold([0.0; 2], |[first, second], (power, a)| {
            let power = f64::from(power);
            [
                first + power * a.abs(),
                second + power * (power - 1.0) * a.abs(),
            ]
        });
        [first / width, second / (width * width)]
    }
}

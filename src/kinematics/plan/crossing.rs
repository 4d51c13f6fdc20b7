//! The motion of a block through a change point, as polynomials.

use crate::kinematics::alignment::Alignment;
use crate::mechanism::DriverId;

/// The inner places of a crossing at which the motion is known, beside its ends and its center.
pub(in crate::kinematics) const INNER: f64 = 0.6;
/// Squares of the places at which each part of a polynomial is known: the center once, the others
/// with two derivatives.
const NODES: [f64; TERMS] = {
    let inner = INNER * INNER;
    [0.0, inner, inner, inner, 1.0, 1.0, 1.0]
};
/// Number of coefficients of either part of a polynomial.
const TERMS: usize = 7;

/// A polynomial in x: its even part E(x²), then P of its odd part x P(x²), both in Newton's form.
pub type Polynomial = [[f64; TERMS]; 2];

/// The place up to which a crossing is good: rounding may move a driver's value beyond its ends.
pub(in crate::kinematics) const SEAM: f64 = 1.0 + 1e-9;

/// The motion of one block of equations through a change point, as a function of the one driver
/// that moves the block.
///
/// On either side of the point, where the block is regular, position and both derivatives are known
/// to rounding at two places, and at the point itself position and velocity; between them each
/// unknown is the polynomial of degree 13 with these values. Newton–Raphson would lose the position
/// as eps/δ at the distance δ from the point, the velocity as eps/δ² and the acceleration as
/// eps/δ³.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// The redundant rows set aside, ascending: the blocks are those of the others.
    pub set_aside: Vec<usize>,
    /// Index of the block in the order of solution.
    pub block: usize,
    /// The driver that moves the block.
    pub driver: DriverId,
    /// The driver's value at the change point \[m or rad\].
    pub center: f64,
    /// Distance from the change point to either end \[m or rad\].
    pub half_width: f64,
    /// One polynomial per unknown of the block in x = (u − center) / half_width.
    pub coefficients: Vec<Polynomial>,
    /// The null vector of the Jacobian at the point, one entry per unknown of the block, scaled so
    /// that metres and radians compare and the largest entry is one.
    pub free: Vec<f64>,
    /// The lines that meet there.
    pub alignment: Alignment,
}

impl Crossing {
    /// Returns x for a value of the driver: −1 at one end, 1 at the other.
    pub(in crate::kinematics) fn place(&self, value: f64) -> f64 {
        (value - self.center) / self.half_width
    }

    /// Returns an unknown with its first and second derivative in the driver's value.
    pub(in crate::kinematics) fn evaluate(&self, local: usize, value: f64) -> [f64; 3] {
        let [even, odd] = &self.coefficients[local];
        let x = self.place(value);
        let square = x * x;
        let [e, e1, e2] = newton_form(even, square);
        let [p, p1, p2] = newton_form(odd, square);
        let width = self.half_width;
        [
            e + x * p,
            (2.0 * x * e1 + p + 2.0 * square * p1) / width,
            (2.0 * e1 + 4.0 * square * e2 + x * (6.0 * p1 + 4.0 * square * p2)) / (width * width),
        ]
    }

    /// Returns the same motion after the driver and the unknowns have turned by these angles
    /// \[rad\].
    pub(in crate::kinematics) fn turned(
        &self,
        driver: f64,
        unknowns: impl Iterator<Item = f64>,
    ) -> Self {
        let mut turned = self.clone();
        turned.center += driver;
        for ([even, _], turn) in turned.coefficients.iter_mut().zip(unknowns) {
            even[0] += turn;
        }
        turned
    }

    /// Bounds the magnitudes of an unknown's first and second derivative in the driver's value.
    pub(in crate::kinematics) fn steepest(&self, local: usize) -> [f64; 2] {
        let width = self.half_width;
        let [[_, e1, e2], [p, p1, p2]] = self.coefficients[local].each_ref().map(steepest_form);
        [
            (2.0 * e1 + p + 2.0 * p1) / width,
            (2.0 * e1 + 4.0 * e2 + 6.0 * p1 + 4.0 * p2) / (width * width),
        ]
    }
}

/// Returns Newton's form of the polynomial in y with the value `center` at 0 and these values and
/// derivatives at the square of the inner places and at 1: its divided differences.
pub(in crate::kinematics) fn divided_differences(
    center: f64,
    inner: [f64; 3],
    end: [f64; 3],
) -> [f64; TERMS] {
    const GROUPS: [usize; TERMS] = [0, 1, 1, 1, 2, 2, 2];
    const FACTORIALS: [f64; 3] = [1.0, 1.0, 2.0];
    let jets = [[center, 0.0, 0.0], inner, end];
    let mut column = GROUPS.map(|group| jets[group][0]);
    let mut coefficients = [0.0; TERMS];
    coefficients[0] = column[0];
    for order in 1..TERMS {
        for low in 0..TERMS - order {
            let high = low + order;
            column[low] = if GROUPS[low] == GROUPS[high] {
                jets[GROUPS[low]][order] / FACTORIALS[order]
            } else {
                (column[low + 1] - column[low]) / (NODES[high] - NODES[low])
            };
        }
        coefficients[order] = column[0];
    }
    coefficients
}

/// Returns a polynomial in Newton's form with its first and second derivative.
fn newton_form(coefficients: &[f64; TERMS], y: f64) -> [f64; 3] {
    let terms = coefficients.iter().zip(&NODES).rev();
    terms.fold([0.0; 3], |[value, first, second], (a, node)| {
        let off = y - node;
        [
            value * off + a,
            first * off + value,
            second * off + 2.0 * first,
        ]
    })
}

/// Bounds the magnitudes of a polynomial in Newton's form and of its first and second derivative
/// from 0 to 1, where no factor is above one.
fn steepest_form(coefficients: &[f64; TERMS]) -> [f64; 3] {
    let powers = (0..TERMS as i32).map(f64::from).zip(coefficients);
    powers.fold([0.0; 3], |[value, first, second], (power, a)| {
        [
            value + a.abs(),
            first + power * a.abs(),
            second + power * (power - 1.0) * a.abs(),
        ]
    })
}

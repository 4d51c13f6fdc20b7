//! Polar coordinates turned into Cartesian ones.

use std::f64::consts::FRAC_PI_2;

use super::{Expression, MAX_STACK, Operation};
use crate::mechanism::number::Unary;

/// Largest difference from a quarter turn that rounding explains \[quarter turns\]: degrees are
/// multiplied by a rounded constant.
const OFF_QUARTER: f64 = 4.0 * f64::EPSILON;

impl Expression {
    /// Returns `[r cos(angle), r sin(angle)]`; `None` if these would need more than [`MAX_STACK`]
    /// operands at one time.
    ///
    /// Sine and cosine of a constant number of quarter turns are exactly 0, 1 or -1.
    pub(in crate::mechanism) fn from_polar(r: &Self, angle: &Self) -> Option<[Self; 2]> {
        if let Some(angle) = angle.literal() {
            let [cos, sin] = cos_and_sin(angle);
            return Some([r.scaled(cos), r.scaled(sin)]);
        }
        // The radius waits while the angle is computed.
        if angle.height >= MAX_STACK {
            return None;
        }
        let times = |function| {
            let function = [Operation::Unary(function), Operation::Multiply];
            let program = [&r.program, &angle.program, &function[..]].concat();
            Self::new(program, &r.functions.or(&angle.functions))
        };
        Some([times(Unary::Cos), times(Unary::Sin)])
    }

    fn scaled(&self, factor: f64) -> Self {
        match (self.literal(), factor) {
            // Not a zero with a sign.
            (Some(value), _) => Self::constant(value * factor + 0.0),
            (None, 0.0) => Self::constant(0.0),
            (None, 1.0) => self.clone(),
            (None, -1.0) => {
                let program = [&*self.program, &[Operation::Negate]].concat();
                Self::new(program, &self.functions)
            }
            (None, _) => {
                let factor = [Operation::Number(factor), Operation::Multiply];
                Self::new([&*self.program, &factor].concat(), &self.functions)
            }
        }
    }
}

fn cos_and_sin(angle: f64) -> [f64; 2] {
    let quarters = angle / FRAC_PI_2;
    let nearest = quarters.round();
    if (quarters - nearest).abs() > OFF_QUARTER * nearest.abs().max(1.0) {
        return [angle.cos(), angle.sin()];
    }
    match nearest.rem_euclid(4.0) {
        0.0 => [1.0, 0.0],
        1.0 => [0.0, 1.0],
        2.0 => [-1.0, 0.0],
        _ => [0.0, -1.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constant_quarter_turns_are_exact() {
        let deg = std::f64::consts::PI / 180.0;
        let r = Expression::constant(0.3);
        for (angle, [x, y]) in [
            (0.0, [0.3, 0.0]),
            (90.0, [0.0, 0.3]),
            (-90.0, [0.0, -0.3]),
            (180.0, [-0.3, 0.0]),
            (-450.0, [0.0, -0.3]),
            (630.0, [0.0, -0.3]),
        ] {
            let point = Expression::from_polar(&r, &Expression::constant(angle * deg));
            let point = point.expect("it is shallow").map(|x| x.literal());
            let expected = [x, y].map(|x| Some(x + 0.0));
            assert_eq!(point.map(|x| x.map(|x| x + 0.0)), expected, "{angle} deg");
        }
    }
}

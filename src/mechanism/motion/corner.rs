//! The search for corners of a motion.

use super::{MotionInForce, PrescribedMotion};
use crate::mechanism::Jet;

/// Ranges that are looked at in one search. Some hundred lead to a corner, or to the place at which pieces
/// join smoothly. A motion with twice as many such places in one step of a host passes for one without
/// corners behind the last of them.
const MOST_RANGES: u32 = 10_000;
/// Change of a velocity from which it is a jump, in what the acceleration changes it by within the last range
/// of a search. Halved or doubled, no motion of a machine is told from
/// another: the range is some roundings of the time, so that a smooth velocity changes by about one of these,
/// and one that jumps by many millions.
const JUMP: f64 = 1e3;
/// Rounding of a velocity, that of some operations, relative to it.
const ROUNDING: f64 = 1e-12;

impl MotionInForce {
    /// Returns the first corner from `from` to `to`, at which the velocity jumps: a time before it and one
    /// after it, a rounding apart. Allocates nothing.
    ///
    /// Only motions with pieces, such as `abs(t - 1)`, and tables of straight lines have corners: other
    /// tables join smoothly.
    #[must_use]
    pub fn corner(&self, from: f64, to: f64) -> Option<[f64; 2]> {
        if let PrescribedMotion::Table(function) = &self.motion {
            let has_corners = self.valid && function.first_jump() == Some(1);
            return has_corners
                .then(|| self.corner_of_table(from, to))
                .flatten();
        }
        let has_pieces = matches!(&self.motion, PrescribedMotion::Expression(expression) if expression.has_pieces());
        if !has_pieces || from >= to {
            return None;
        }
        let resolution = f64::EPSILON * from.abs().max(to.abs());
        self.first_corner([from, to], resolution, &mut { MOST_RANGES })
    }

    /// Returns the first corner of a table behind `from` up to `to`.
    fn corner_of_table(&self, from: f64, to: f64) -> Option<[f64; 2]> {
        let mut corner = self.next_point(from);
        while corner <= to {
            let before = corner.next_down();
            let [left, right] = [before, corner].map(|t| self.evaluate(Jet::variable(t)).first());
            if (right - left).abs() > ROUNDING * left.abs().max(right.abs()) {
                return Some([before, corner]);
            }
            corner = self.next_point(corner);
        }
        None
    }

    /// Returns the first corner in a range: halves are searched where the motion is not shown to be smooth.
    fn first_corner(
        &self,
        [from, to]: [f64; 2],
        resolution: f64,
        left: &mut u32,
    ) -> Option<[f64; 2]> {
        *left = left.checked_sub(1)?;
        // A corner at an end of the range is one.
        let bound = self.curvature(from - resolution, to + resolution);
        if bound.is_some_and(f64::is_finite) {
            return None;
        }
        let middle = from.midpoint(to);
        if to - from > resolution && from < middle && middle < to {
            let first = self.first_corner([from, middle], resolution, left);
            return first.or_else(|| self.first_corner([middle, to], resolution, left));
        }
        let [before, after] = [from, to].map(|t| self.evaluate(Jet::variable(t)));
        let jump = (after.first() - before.first()).abs();
        let largest = |of: fn(&Jet) -> f64| of(&before).abs().max(of(&after).abs());
        let smooth = JUMP * (to - from) * largest(Jet::second) + ROUNDING * largest(Jet::first);
        (jump > smooth).then_some([from, to])
    }
}

#[cfg(test)]
mod tests {
    use crate::mechanism::expression::{Scope, Variable};
    use crate::mechanism::names::NameTable;
    use crate::mechanism::{Expression, Jet, MotionInForce, PrescribedMotion};

    /// Asserts that a motion has its corners from −1 to 10 s where they are, to some roundings.
    fn assert_corners(text: &str, expected: &[f64]) {
        let names = NameTable::new();
        let scope = Scope::new(&names, &[Variable::Time]);
        let expression = Expression::parse(text, scope).expect("an expression");
        let mut motion = MotionInForce::new(&PrescribedMotion::Expression(expression), 0);
        motion.set_parameters(|_| Jet::constant(0.0));
        let mut from = -1.0;
        for corner in expected {
            let [before, after] = motion.corner(from, 10.0).expect(text);
            let rounding = 4.0 * f64::EPSILON * 10.0;
            assert!(before < after && after - before < rounding, "{text}");
            assert!((corner - before).abs() < rounding, "{text}: {before}");
            from = after;
        }
        assert_eq!(motion.corner(from, 10.0), None, "{text}");
    }

    #[test]
    fn corners_are_found() {
        assert_corners("abs(t - 0.1)", &[0.1]);
        assert_corners("abs(t)", &[0.0]);
        assert_corners("max(0, 0.3*(t - 1/3))", &[1.0 / 3.0]);
        assert_corners("min(1, abs(t - 2))", &[1.0, 2.0, 3.0]);
        let pi = std::f64::consts::PI;
        assert_corners("abs(sin(t))", &[0.0, pi, 2.0 * pi, 3.0 * pi]);
    }

    /// Pieces that join smoothly make none.
    #[test]
    fn smooth_joins_are_none() {
        assert_corners("max(t - 1, 0)^2", &[]);
        assert_corners("t*abs(t)", &[]);
        assert_corners("sin(t) + t^3", &[]);
    }
}

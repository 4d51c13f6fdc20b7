//! Bounds of a contour while its parameters move.
//!
//! Parameters and the polar angle are functions of the place on a sub-step, enclosed over all of
//! it. The contour is evaluated on such numbers with their derivatives with respect to the polar
//! angle, so that R and R′ come as functions of the place, too.

use std::f64::consts::TAU;

use super::closed_points::{ClosedPoints, parts_of_turn};
use super::{ContourInForce, Joint, ProfileInForce};
use crate::mechanism::expression::MOST_SWITCHES;
use crate::mechanism::{Expression, Interval, Jet3, Number, ParameterId, Table, Taylor};

/// A number along a sub-step.
type Enclosed = Jet3<Interval>;

/// A profile whose parameters may move along a sub-step.
///
/// Made once; [`set_parameters`](Self::set_parameters) then changes it without allocating.
#[derive(Clone, Debug)]
pub struct MovingProfile {
    curve: MovingCurve,
    /// All parameters.
    parameters: Vec<Enclosed>,
    /// Parameters that the profile uses.
    used: Vec<ParameterId>,
}

#[derive(Clone, Debug)]
enum MovingCurve {
    Expression(Expression),
    Points {
        table: Table,
        points: Box<ClosedPoints<Enclosed>>,
    },
}

impl ProfileInForce {
    /// Makes the profile for parameters that move, whose values are set later.
    #[must_use]
    pub fn moving(&self) -> MovingProfile {
        let curve = match &self.curve {
            ContourInForce::Expression { expression, .. } => {
                MovingCurve::Expression(expression.clone())
            }
            ContourInForce::Points { table, points } => MovingCurve::Points {
                table: table.clone(),
                points: Box::new(points.moving()),
            },
        };
        MovingProfile {
            curve,
            parameters: vec![Enclosed::constant(0.0); self.parameters.len()],
            used: self.used.clone(),
        }
    }
}

impl MovingProfile {
    /// Sets the parameters along the sub-step.
    pub fn set_parameters(&mut self, parameter: impl Fn(ParameterId) -> Enclosed) {
        let kept = |id: &ParameterId| self.parameters[id.index()] == parameter(*id);
        if self.used.iter().all(kept) {
            return;
        }
        for &id in &self.used {
            self.parameters[id.index()] = parameter(id);
        }
        if let MovingCurve::Points { table, points } = &mut self.curve {
            points.set_moving(table, &parameter);
        }
    }

    /// Returns whether a parameter of the profile moves.
    #[must_use]
    pub fn moves(&self) -> bool {
        let mut used = self.used.iter().map(|p| self.parameters[p.index()]);
        used.any(|parameter| !parameter.is_single())
    }

    /// Encloses R and R′ for a polar angle along the sub-step. `None` without bounds, as where
    /// pieces of the contour may meet with a corner; `in_force` is the profile at its end.
    #[must_use]
    pub fn radius(&self, in_force: &ProfileInForce, theta: Enclosed) -> Option<[Enclosed; 2]> {
        let radius = match &self.curve {
            MovingCurve::Points { points, .. } => points.enclose(theta),
            MovingCurve::Expression(expression) => {
                let pieces = parts_of_turn(theta, Interval::point(0.0));
                let mut found = None;
                for theta in pieces {
                    let part = Interval::new(0.0, TAU).intersection(theta.value);
                    if part.is_undefined() {
                        continue;
                    }
                    let theta = Enclosed::new(part, theta.derivatives);
                    let piece = self.on_pieces(expression, in_force.joint, theta)?;
                    found = Some(found.map_or(piece, |found: [Enclosed; 2]| {
                        [found[0].hull(piece[0]), found[1].hull(piece[1])]
                    }));
                }
                found
            }
        };
        radius.filter(|[radius, _]| radius.value.low > 0.0)
    }

    /// Encloses R and R′ of an expression for angles within the turn.
    fn on_pieces(
        &self,
        expression: &Expression,
        joint: Joint,
        theta: Enclosed,
    ) -> Option<[Enclosed; 2]> {
        type WithSlope = Taylor<Enclosed, 1>;
        let parameter = |p: ParameterId| WithSlope::fixed(self.parameters[p.index()]);
        let hull = |switches| {
            let theta = |_| WithSlope::variable(theta);
            let hull = expression.hull_of_pieces(&(&parameter, &theta), switches);
            hull.map(|radius| [radius.value, radius.first()])
        };
        let on_one = hull(None);
        if on_one.is_some() || joint == Joint::Kink {
            return on_one;
        }
        let [mut radius, mut slope] = hull(Some(MOST_SWITCHES))?;
        if self.moves() {
            // Pieces that join smoothly at the end may have a corner in between.
            radius.derivatives[1] = Interval::unknown();
        }
        if joint == Joint::Slope {
            // It has a corner.
            slope.derivatives[1] = Interval::unknown();
        }
        Some([radius, slope])
    }
}

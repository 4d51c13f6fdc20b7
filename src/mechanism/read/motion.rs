//! Prescribed motions: expressions of time, and tables.

use crate::mechanism::diagnostic::code;
use crate::mechanism::expression::MovingNames;
use crate::mechanism::motion::not_finite;
use crate::mechanism::syntax::Value;
use crate::mechanism::wording::shown;
use crate::mechanism::{
    CoordinateKind, Ends, Expression, Interpolation, Jet, Law, MotionInForce, PointFunction,
    PrescribedMotion, Span, Variable,
};

use super::context::Context;
use super::kind::Described;
use super::kind::{Item, Kind, Word, schema};
use super::number::NUMBER;
use super::points::{PointKeys, PointTable};
use super::table::table;

table! {
    /// A motion through points.
    struct MotionKeys<'a> {
        /// Way from each point to the next; a spline if left out.
        law: Interpolation = LAW,
        /// Motion before the first point and after the last; clamped if left out.
        ends: Ends = ENDS,
    }
}

pub(super) const LAW: Word<Interpolation> = Word::new("motion law", code::ILLEGAL_VALUE, || {
    vec![
        ("spline", Interpolation::Spline),
        ("linear", Interpolation::Linear),
        ("steps", Interpolation::Steps),
        ("polynomial_345", Interpolation::Law(Law::Polynomial345)),
        ("polynomial_4567", Interpolation::Law(Law::Polynomial4567)),
        ("cycloidal", Interpolation::Law(Law::Cycloidal)),
        ("harmonic", Interpolation::Law(Law::Harmonic)),
        ("modified_sine", Interpolation::Law(Law::ModifiedSine)),
        (
            "modified_trapezoidal",
            Interpolation::Law(Law::ModifiedTrapezoidal),
        ),
        ("trapezoidal", Interpolation::Law(Law::Trapezoidal)),
    ]
});

pub(super) const ENDS: Word<Ends> = Word::new("kind of ends", code::ILLEGAL_VALUE, || {
    vec![
        ("clamped", Ends::Clamped),
        ("natural", Ends::Natural),
        ("periodic", Ends::Periodic),
        ("linear", Ends::Linear),
        ("zero", Ends::Zero),
    ]
});

/// A key `motion`: a function of time.
pub(super) struct MotionKey;

/// Motion before it is checked for its coordinate.
pub(super) struct ReadMotion {
    written: WrittenMotion,
    span: Span,
}

enum WrittenMotion {
    Expression(Expression),
    Points(PointTable, Interpolation, Ends),
}

impl<'a> Kind<'a> for MotionKey {
    type Value = ReadMotion;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<ReadMotion> {
        if context.is_points_alone(
            item,
            "motion",
            "expected `motion = \"10*deg*t\"`, `motion = { table = [[0, 0], [1, 2]] }` or `motion = \
             { file = \"a.csv\" }`",
        ) {
            return None;
        }
        let written = if item.value.get_ref().is_table() {
            let fields = context.fields(item.span(), item.value, "the motion".to_owned())?;
            let keys = context.table::<(PointKeys<'a>, MotionKeys<'a>)>(&fields);
            let (points, interpolation, ends) = context.motion_table(keys)?;
            WrittenMotion::Points(points, interpolation, ends)
        } else {
            WrittenMotion::Expression(context.motion_formula(item.value)?)
        };
        Some(ReadMotion {
            written,
            span: item.span(),
        })
    }

    schema! {{ "anyOf": [NUMBER.schema(), <(PointKeys<'_>, MotionKeys<'_>)>::schema()] }}
}

impl<'a> Context<'a> {
    /// Reads a motion by an expression in t, over parameters and inputs.
    fn motion_formula(&mut self, value: &'a Value<'a>) -> Option<Expression> {
        let inputs = self.inputs.in_order();
        let of_signals = inputs.iter().filter_map(|(name, place)| {
            let dimension = self.input_dimensions[*place]?;
            Some((*name, dimension))
        });
        let moving = MovingNames {
            known: (inputs
                .iter()
                .map(|(name, place)| (*name, Variable::Input(*place))))
            .collect(),
            dimensions: Vec::new(),
            of_signals: of_signals.collect(),
            computed: Vec::new(),
            usable: "a motion may use parameters, inputs and `t`",
            law: None,
            may_jump: false,
        };
        let moving = (!inputs.is_empty()).then_some(&moving);
        let formula = self.formula(value, &[Variable::Time], moving)?;
        Some(formula.expression)
    }

    pub(super) fn motion_table(
        &mut self,
        (point_keys, keys): (PointKeys<'a>, MotionKeys<'a>),
    ) -> Option<(PointTable, Interpolation, Ends)> {
        let [law_place, ends_place] = [&keys.law.span, &keys.ends.span].map(Clone::clone);
        let interpolation = keys.law.or(Interpolation::Spline);
        let ends = keys.ends.or(Ends::Clamped);
        let jumping = match (interpolation, ends) {
            (Some(Interpolation::Steps), _) => Some(("`steps`", law_place)),
            (_, Some(Ends::Zero)) => Some(("ends that are `zero`", ends_place.clone())),
            _ => None,
        };
        if let Some((what, place)) = jumping {
            let message = format!("a motion or the law of a coupling has no {what}: it would jump");
            self.error(code::ILLEGAL_VALUE, place, message)
                .suggest("only the `value` of forces and measures may jump, in `[functions]`");
            return None;
        }
        let is_spline = interpolation == Some(Interpolation::Spline);
        if let (Some(_), Some(Ends::Natural), false) = (interpolation, ends, is_spline) {
            let message = "only a spline has natural ends";
            self.error(code::ILLEGAL_VALUE, ends_place, message)
                .suggest("`linear` ends go on with the last slope");
            return None;
        }
        let points = self.points(point_keys)?;
        Some((points, interpolation?, ends?))
    }

    /// Returns the motion, and what it follows if it uses inputs. Refuses a motion whose value or rates at the start time are not finite, and a distance
    /// that is not positive there or in the table.
    pub(super) fn check_motion(
        &mut self,
        read: ReadMotion,
        kind: Option<CoordinateKind>,
        start_time: f64,
    ) -> Option<(PrescribedMotion, Option<Expression>)> {
        let ReadMotion { written, span } = read;
        let is_distance = kind == Some(CoordinateKind::Distance);
        let is_angle = kind.is_some_and(CoordinateKind::is_angle);
        let mut follows = None;
        let motion = match written {
            WrittenMotion::Expression(expression) if expression.inputs().next().is_some() => {
                let starts = &self.input_starts;
                let start = |index| {
                    let start = starts.get(index).copied().unwrap_or(0.0);
                    Some(Expression::constant(start))
                };
                let motion = expression.with_inputs(start)?;
                follows = Some(expression);
                PrescribedMotion::Expression(motion)
            }
            WrittenMotion::Expression(expression) => PrescribedMotion::Expression(expression),
            WrittenMotion::Points(points, interpolation, ends) => {
                if is_distance {
                    self.check_ordinates_positive(&points, "a distance")?;
                }
                if is_angle {
                    self.warn_of_ordinates(&points);
                }
                PrescribedMotion::Table(PointFunction {
                    table: points.table,
                    interpolation,
                    ends,
                })
            }
        };
        if !self.knows(motion.parameters()) {
            return Some((motion, follows));
        }
        let mut in_force = MotionInForce::new(&motion, self.parameter_values.len());
        in_force.set_parameters(|id| Jet::constant(self.known_value(id)));
        let start = in_force.evaluate(Jet::variable(start_time));
        if let Some(what) = not_finite(start) {
            self.not_finite(span, &format!("at t = {}, {what}", shown(start_time)));
            return None;
        }
        if is_angle && matches!(motion, PrescribedMotion::Expression(_)) {
            self.warn_of_motion(&span, start);
        }
        if is_distance && start.value <= 0.0 {
            let message = format!(
                "a distance, at the start time too, must be positive, is {}",
                shown(start.value)
            );
            self.error(code::ILLEGAL_VALUE, span, message);
        }
        Some((motion, follows))
    }
}

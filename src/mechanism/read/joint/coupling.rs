//! `coupling`: an equation between coordinates.

use std::collections::{HashMap, HashSet};

use crate::mechanism::diagnostic::code;
use crate::mechanism::expression::{LawOfCoupling, MovingNames};
use crate::mechanism::read::context::Context;
use crate::mechanism::read::kind::Described;
use crate::mechanism::read::kind::{Flag, Item, Kind, schema};
use crate::mechanism::read::motion::MotionKeys;
use crate::mechanism::read::number::{NUMBER, Quantity, RATIO};
use crate::mechanism::read::points::PointKeys;
use crate::mechanism::syntax::Value;
use crate::mechanism::{
    Coordinate, CoordinateEquation, CoordinateKind, Dimension, Expression, JointKind, MOST_BODIES,
    MOST_COUPLED, Phase, PointFunction, PrescribedMotion, Variable,
};

use super::phase::{PhaseOf, phase};
use super::{Made, joint_type};

joint_type! {
    own markers;
    "coupling" or "equation"
        or "screw" as "type = \"coupling\", equation = \"travel = pitch*turn/(2*pi)\""
        or "mimic" as "type = \"coupling\", equation = \"right = -left\""
        or "differential" as "type = \"coupling\", equation = \"cage = (left + right)/2\""
        or "geneva" as "type = \"coupling\", equation = \"wheel = law(crank)\", law = …"
        => |keys, context| context.coupling(keys);

    /// An equation between coordinates: of drivers, and of measures that are no formulas.
    struct Coupling<'a> {
        /// Equation, such as "travel = pitch*turn/(2*pi)", over names of drivers and measures,
        /// parameters, functions and `law`.
        #[required("\"travel = pitch*turn/(2*pi)\"")]
        equation: &'a Value<'a> = Equation,
        /// Function `law` of one argument in the equation: an expression in x, or points with the
        /// way between them.
        law: Law = LawOfOneArgument,
        /// Constant of left - right; zero if left out, "drawn" for what the estimates give.
        phase: Phase = PhaseOf(NUMBER),
        /// Width of the gap in which left - right is free, in free motion.
        backlash: Quantity = NUMBER.positive(),
        /// Whether left is at least right in free motion, in place of equal.
        unilateral: bool = Flag,
        /// Part of the velocity with which it bounces where it is held, from 0 to 1; zero if left out.
        restitution: Quantity = RATIO,
    }
}

/// Equation, not read yet.
struct Equation;

impl<'a> Kind<'a> for Equation {
    type Value = &'a Value<'a>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<&'a Value<'a>> {
        context.text(item.value)?;
        Some(item.value)
    }

    schema! {{ "type": "string" }}
}

/// Function of one argument.
struct LawOfOneArgument;

/// Law as it is read.
pub(super) enum Law {
    Expression(Expression, Option<Dimension>),
    Table(PrescribedMotion),
}

impl<'a> Kind<'a> for LawOfOneArgument {
    type Value = Law;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Law> {
        let expected = "expected `law = \"x^2\"`, `law = { table = [[0, 0], [1, 2]] }` or `law = { file = \
                        \"a.csv\" }`";
        if context.is_points_alone(item, "law", expected) {
            return None;
        }
        if !item.value.get_ref().is_table() {
            let formula = context.formula(item.value, &[Variable::Argument(0)], None)?;
            return Some(Law::Expression(formula.expression, formula.dimension));
        }
        let fields = context.fields(item.span(), item.value, "the law".to_owned())?;
        let keys = context.table::<(PointKeys<'a>, MotionKeys<'a>)>(&fields);
        let (points, interpolation, ends) = context.motion_table(keys)?;
        Some(Law::Table(PrescribedMotion::Table(PointFunction {
            table: points.table,
            interpolation,
            ends,
        })))
    }

    schema! {{ "anyOf": [NUMBER.schema(), <(PointKeys<'_>, MotionKeys<'_>)>::schema()] }}
}

impl<'a> Context<'a> {
    fn coupling(&mut self, keys: Coupling<'a>) -> Option<Made> {
        let law = keys.law.optional()?;
        let phase = phase(keys.phase)?;
        let play = match (keys.unilateral.value, &keys.backlash.key) {
            (Some(true), Some(span)) => {
                let subject = &keys.owner.subject;
                let message = format!("{subject} has `backlash`, but is `unilateral`");
                self.error(code::UNKNOWN_KEY, span.clone(), message)
                    .suggest("left - right is free in a gap, or above its least value");
                return None;
            }
            (Some(true), None) => {
                self.unilateral(keys.unilateral, keys.restitution, &keys.owner)?
            }
            _ => self.backlash(keys.backlash, keys.restitution, &keys.owner)?,
        };
        let value = keys.equation.value?;
        let declared = self.coordinates.iter();
        let declared: Vec<(&str, Coordinate)> = declared
            .map(|&(name, coordinate)| Some((name, coordinate?)))
            .collect::<Option<_>>()?;
        let names = declared.iter().map(|(name, _)| *name);
        let kinds = declared.iter().map(|(_, coordinate)| coordinate.kind);
        let dimension = |kind: CoordinateKind| kind.unit().dimension;
        let moving = MovingNames {
            known: names.zip((0..).map(Variable::Coordinate)).collect(),
            dimensions: kinds.map(dimension).collect(),
            of_signals: HashMap::new(),
            computed: self.computed.clone(),
            usable: "an equation may use parameters, drivers and measures with a coordinate",
            law: law.as_ref().map(|law| match law {
                Law::Expression(expression, dimension) => {
                    LawOfCoupling::Expression(expression, *dimension)
                }
                Law::Table(_) => LawOfCoupling::Table,
            }),
            may_jump: false,
        };
        let parsed = self.equation(value, &moving)?;
        let places = CoordinateEquation::places(&parsed.expression);
        let coordinates: Vec<(String, Coordinate)> = places
            .iter()
            .map(|&place| (declared[place].0.to_owned(), declared[place].1))
            .collect();
        self.check_coupled(&coordinates, value)?;
        let difference = parsed.expression.with_coordinates(&places);
        let (_, first) = coordinates.first()?;
        let (_, last) = coordinates.last()?;
        let ends = [first.from, last.to];
        let is_angle = match parsed.dimension {
            Some(dimension) => dimension.m == 0,
            None => coordinates
                .iter()
                .all(|(_, coordinate)| coordinate.kind.is_angle()),
        };
        let law = law.and_then(|law| match law {
            Law::Table(motion) => Some(motion),
            Law::Expression(..) => None,
        });
        let equation = CoordinateEquation {
            text: value.get_ref().as_str().unwrap_or_default().to_owned(),
            coordinates,
            difference,
            law,
            is_angle,
            phase,
            play,
        };
        Some((JointKind::Coupling(Box::new(equation)), ends))
    }

    /// Refuses an equation of no coordinates or of too many, or of coordinates of too many bodies.
    fn check_coupled(
        &mut self,
        coordinates: &[(String, Coordinate)],
        value: &'a Value<'a>,
    ) -> Option<()> {
        let markers = coordinates.iter().flat_map(|(_, c)| c.markers());
        let bodies: HashSet<_> = markers.filter_map(|m| self.carriers[m.index()]).collect();
        let most = |count, things, most: usize| {
            format!("the equation has {count} {things}, {most} at most are possible")
        };
        let (message, help) = if coordinates.is_empty() {
            (
                "the equation has no coordinate".to_owned(),
                "name drivers and measures: `travel = pitch*turn/(2*pi)`",
            )
        } else if coordinates.len() > MOST_COUPLED {
            (
                most(coordinates.len(), "coordinates", MOST_COUPLED),
                "use several couplings",
            )
        } else if bodies.len() > MOST_BODIES {
            (
                most(bodies.len(), "bodies", MOST_BODIES),
                "use several couplings",
            )
        } else {
            return Some(());
        };
        self.error(code::BAD_EXPRESSION, value.span(), message)
            .suggest(help);
        None
    }
}

//! Prescribed motions: expressions of time, and tables.

use toml::de::DeValue;

use crate::mechanism::diagnostic::code;
use crate::mechanism::motion::not_finite;
use crate::mechanism::names::shown;
use crate::mechanism::syntax::Value;
use crate::mechanism::{
    CoordinateKind, Ends, Interpolation, Jet, Law, Motion, MotionInForce, MotionTable, Variable,
};

use super::context::{Context, Fields};
use super::tables::TABLE_KEYS;

/// The keys of a motion given by a table, besides those of the table.
pub(super) const KEYS: [&str; 2] = ["law", "ends"];

pub(super) const LAWS: [(&str, Interpolation); 8] = [
    ("spline", Interpolation::Spline),
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
];

pub(super) const ENDS: [(&str, Ends); 3] = [
    ("clamped", Ends::Clamped),
    ("natural", Ends::Natural),
    ("periodic", Ends::Periodic),
];

/// The ways to write a motion.
pub(super) const MOTION_FORMS: &str = "`motion = \"10*deg*t\"`, `motion = { table = [[0, 0], \
                                       [1, 2]] }` or `motion = { file = \"a.csv\" }`";

impl<'a> Context<'a> {
    /// A prescribed motion, checked at the start time.
    pub(super) fn motion(
        &mut self,
        value: &'a Value<'a>,
        kind: Option<CoordinateKind>,
        start_time: f64,
    ) -> Option<Motion> {
        let motion = match value.get_ref() {
            DeValue::Table(table) => {
                let fields = Fields {
                    table,
                    place: value.span(),
                    subject: "the motion".to_owned(),
                };
                Motion::Table(self.motion_table(&fields, kind)?)
            }
            DeValue::Array(_) => {
                self.not_a_motion(value, "an array of points is no motion by itself");
                return None;
            }
            DeValue::String(text) if text.ends_with(".csv") => {
                self.not_a_motion(value, "the name of a file is no motion by itself");
                return None;
            }
            _ => Motion::Expression(self.expression(value, Some(Variable::Time))?),
        };
        self.check_start(&motion, value, kind, start_time)?;
        Some(motion)
    }

    fn not_a_motion(&mut self, value: &'a Value<'a>, message: &str) {
        self.error_with_help(
            code::WRONG_TYPE,
            value.span(),
            message,
            format!("expected {MOTION_FORMS}"),
        );
    }

    fn motion_table(
        &mut self,
        fields: &Fields<'a>,
        kind: Option<CoordinateKind>,
    ) -> Option<MotionTable> {
        let mut legal = KEYS.to_vec();
        legal.extend(TABLE_KEYS);
        self.check_keys(fields, &legal);
        let interpolation = match fields.get("law") {
            Some(value) => self.choice(value, &LAWS, code::ILLEGAL_VALUE, "motion law"),
            None => Some(Interpolation::Spline),
        };
        let ends = match fields.get("ends") {
            Some(value) => self.choice(value, &ENDS, code::ILLEGAL_VALUE, "kind of ends"),
            None => Some(Ends::Clamped),
        };
        if let (Some(Interpolation::Law(_)), Some(Ends::Natural)) = (interpolation, ends) {
            self.error_with_help(
                code::ILLEGAL_VALUE,
                fields.get("ends")?.span(),
                "only a spline has natural ends",
                "the other laws come to rest at each point".to_owned(),
            );
            return None;
        }
        let known = self.table(fields, "[t, u]")?;
        if kind == Some(CoordinateKind::Distance) {
            self.check_ordinates_positive(&known, "a distance")?;
        }
        Some(MotionTable {
            table: known.table,
            interpolation: interpolation?,
            ends: ends?,
        })
    }

    /// Refuses a motion whose value or rates at the start time are not finite, and a distance
    /// that is not positive there.
    fn check_start(
        &mut self,
        motion: &Motion,
        value: &'a Value<'a>,
        kind: Option<CoordinateKind>,
        start_time: f64,
    ) -> Option<()> {
        let values = &self.parameter_values;
        if motion.parameters().any(|id| values[id.index()].is_none()) {
            return Some(());
        }
        let mut in_force = MotionInForce::new(motion, values.len());
        in_force.set_parameters(|id| Jet::constant(values[id.index()].unwrap_or(0.0)));
        let start = in_force.evaluate(Jet::variable(start_time));
        if let Some(what) = not_finite(start) {
            self.not_finite(
                value.span(),
                &format!("at t = {}, {what}", shown(start_time)),
            );
            return None;
        }
        if kind == Some(CoordinateKind::Distance) && start.value <= 0.0 {
            let message = format!(
                "a distance, at the start time too, must be positive, is {}",
                shown(start.value)
            );
            self.error(code::ILLEGAL_VALUE, value.span(), message);
        }
        Some(())
    }
}

//! Forces: along a coordinate, or at a marker.

use crate::mechanism::diagnostic::code;
use crate::mechanism::{Expression, Force, ForceLaw, Load, MarkerId, Spring, Variable};

use super::context::Context;
use super::coordinate::CoordinateKeys;
use super::kind::{AnyOf, Array, Entry, Text};
use super::number::{Formula, NUMBER, Quantity};
use super::reference::MarkerName;
use super::table::table;

table! {
    /// A generalized force along a coordinate: value - stiffness*(c - free) - damping*(rate of c).
    struct CoordinateForceKeys<'a> {
        /// Force or torque along the coordinate [N or N.m]: an expression in t, position and
        /// velocity. Without value, stiffness and damping the force is an FMI input.
        value: Quantity = Formula(&[Variable::Time, Variable::Position, Variable::Velocity]),
        /// Stiffness of a spring [N/m or N.m/rad].
        stiffness: Quantity = NUMBER,
        /// Value of the coordinate at which the spring is free of force [m or rad].
        free: Quantity = NUMBER,
        /// Coefficient of a damper [N.s/m or N.m.s/rad].
        damping: Quantity = NUMBER,
        /// Description in one line.
        description: String = Text,
    }

    /// A force at a marker's point and a torque on its body; FMI inputs if both are left out.
    struct MarkerForceKeys<'a> {
        /// Marker at whose point the force acts.
        #[required("\"crank.A\"")]
        marker: MarkerId = MarkerName,
        /// Marker along whose axes the components are; ground's frame if left out.
        axes: MarkerId = MarkerName,
        /// Components of the force [N]: expressions in t.
        value: [Quantity; 2] = Array::new("[fx, fy]", [Formula(&[Variable::Time]); 2]),
        /// Torque on the body [N.m]: an expression in t.
        torque: Quantity = Formula(&[Variable::Time]),
        /// Description in one line.
        description: String = Text,
    }
}

/// A force of either shape.
pub(super) type AnyForce =
    AnyOf<(CoordinateKeys<'static>, CoordinateForceKeys<'static>), MarkerForceKeys<'static>>;

impl<'a> Context<'a> {
    /// Reads a force; its value is checked at `start_time` [s] where that suffices.
    pub(super) fn force(&mut self, entry: Entry<'a>, start_time: f64) -> Option<Force> {
        let fields = self.entry_fields(entry, "force")?;
        let has = |key| fields.table.contains_key(key);
        let (place, has) = match (has("coordinate"), has("marker")) {
            (true, false) => {
                let keys = self.table::<(CoordinateKeys<'a>, CoordinateForceKeys<'a>)>(&fields);
                return self.coordinate_force(entry, keys, start_time);
            }
            (false, true) => {
                let keys = self.table::<MarkerForceKeys<'a>>(&fields);
                return self.marker_force(entry, keys, start_time);
            }
            (true, true) => ("both", "and"),
            (false, false) => ("neither", "nor"),
        };
        let message = format!("{} has {place} `coordinate` {has} `marker`", fields.subject);
        self.error(code::FORCE_SHAPE, fields.place.clone(), message)
            .suggest(
                "give `coordinate` and `markers` for a force between two bodies, such as a spring, \
                 or `marker` for a force at a point",
            );
        None
    }

    fn coordinate_force(
        &mut self,
        entry: Entry<'a>,
        (coordinate, keys): (CoordinateKeys<'a>, CoordinateForceKeys<'a>),
        start_time: f64,
    ) -> Option<Force> {
        let coordinate = self.coordinate(coordinate);
        let owner = &keys.owner;
        match (&keys.stiffness.key, &keys.free.key) {
            (Some(_), None) => self.missing_key(owner, "free", "0.1"),
            (None, Some(span)) => {
                let message = format!("{} has `free`, but no `stiffness`", owner.subject);
                self.error(code::UNKNOWN_KEY, span.clone(), message)
                    .suggest("`free` is the value at which a spring is free of force");
            }
            _ => {}
        }
        if let (Some(coordinate), Some(free)) = (coordinate, &keys.free.value) {
            self.warn_of_unit(free, coordinate.kind.unit());
        }
        if let Some(value) = &keys.value.value {
            self.check_force(value, start_time)?;
        }
        let value = keys.value.optional()?.map(|value| value.expression);
        let damping = keys.damping.optional()?.map(|damping| damping.expression);
        let stiffness = keys.stiffness.optional()?;
        let free = keys.free.optional()?;
        let spring = match (stiffness, free) {
            (None, _) => None,
            (Some(stiffness), free) => Some(Spring {
                stiffness: stiffness.expression,
                free: free?.expression,
            }),
        };
        let is_input = value.is_none() && spring.is_none() && damping.is_none();
        Some(Force {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            load: Load::Coordinate {
                coordinate: coordinate?,
                law: (!is_input).then_some(ForceLaw {
                    value,
                    spring,
                    damping,
                    ..ForceLaw::default()
                }),
            },
        })
    }

    fn marker_force(
        &mut self,
        entry: Entry<'a>,
        keys: MarkerForceKeys<'a>,
        start_time: f64,
    ) -> Option<Force> {
        let components = keys.value.value.iter().flatten();
        for value in components.chain(&keys.torque.value) {
            self.check_force(value, start_time)?;
        }
        let marker = keys.marker.value?;
        if self.carriers[marker.index()].is_none() {
            let message = format!("{} acts on ground, which does not move", keys.owner.subject);
            self.error(code::UNKNOWN_BODY, keys.marker.span.clone(), message)
                .suggest("give a marker of a body");
        }
        let axes = keys.axes.optional()?;
        let law = match (keys.value.optional()?, keys.torque.optional()?) {
            (None, None) => None,
            (force, torque) => {
                let zero = || Expression::constant(0.0);
                let force = force.map(|force| force.map(|component| component.expression));
                let [x, y] = force.unwrap_or_else(|| [zero(), zero()]);
                Some([x, y, torque.map_or_else(zero, |torque| torque.expression)])
            }
        };
        Some(Force {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            load: Load::Marker { marker, axes, law },
        })
    }

    /// Refuses a force that is not finite at the start time; one that uses the coordinate is not
    /// known yet.
    fn check_force(&mut self, value: &Quantity, start_time: f64) -> Option<()> {
        let expression = &value.expression;
        let uses = |variable| expression.uses(variable);
        if uses(Variable::Position)
            || uses(Variable::Velocity)
            || !self.knows(expression.parameters())
        {
            return Some(());
        }
        if !expression
            .evaluate(&|id| self.known_value(id), start_time)
            .is_finite()
        {
            self.not_finite(value.span.clone(), "at the start time, the value");
            return None;
        }
        Some(())
    }
}

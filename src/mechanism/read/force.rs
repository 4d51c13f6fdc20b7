//! Forces: along a coordinate, or at a marker.

use crate::mechanism::diagnostic::code;
use crate::mechanism::expression::MovingNames;
use crate::mechanism::syntax::Value;
use crate::mechanism::{
    CoordinateKind, Driver, DriverId, Expression, Force, ForceLaw, Load, MarkerId, Measure, Order,
    Signal, Spring, Variable,
};

use super::context::Context;
use super::coordinate::CoordinateKeys;
use super::derived::Unread;
use super::kind::{AnyOf, Array, Entry, Flag, Text};
use super::number::{NUMBER, Quantity};
use super::reference::MarkerName;
use super::table::{Field, table};

table! {
    /// A generalized force along a coordinate: value - stiffness*(c - free) - damping*(rate of c).
    struct CoordinateForceKeys<'a> {
        /// Force or torque along the coordinate [N or N.m]: an expression in t, position and
        /// velocity, and those of drivers, freedoms and measures, such as crank.position. Without
        /// value, stiffness and damping the force is an FMI input.
        value: &'a Value<'a> = Unread,
        /// Whether value is the force of a spring of constant force: a number, with a potential energy.
        constant: bool = Flag,
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
        /// Components of the force [N]: expressions in t and in positions and velocities of drivers,
        /// freedoms and measures.
        value: [&'a Value<'a>; 2] = Array::new("[fx, fy]", [Unread, Unread]),
        /// Torque on the body [N.m], likewise.
        torque: &'a Value<'a> = Unread,
        /// Description in one line.
        description: String = Text,
    }
}

/// A force of either shape.
pub(super) type AnyForce =
    AnyOf<(CoordinateKeys<'static>, CoordinateForceKeys<'static>), MarkerForceKeys<'static>>;

impl<'a> Context<'a> {
    /// Reads the forces; their values are checked at `start_time` [s] where that suffices.
    pub(super) fn forces(
        &mut self,
        entries: &Field<Vec<Entry<'a>>>,
        drivers: &[Driver],
        measures: &[Measure],
        start_time: f64,
    ) -> Vec<Force> {
        let owners = |signal: Signal, name: &str, kind: CoordinateKind| {
            let orders = [Order::Position, Order::Velocity].into_iter();
            let units = kind.units();
            let named = orders.zip(units).map(|(order, unit)| {
                let name = format!("{name}.{}", order.suffix());
                (name, Variable::Signal(signal, order), unit.dimension)
            });
            named.collect::<Vec<_>>()
        };
        let of_drivers = drivers.iter().enumerate().flat_map(|(index, driver)| {
            let signal = Signal::Motion(DriverId(index));
            owners(signal, &driver.name, driver.coordinate.kind)
        });
        let of_measures = measures.iter().enumerate().flat_map(|(index, measure)| {
            owners(
                Signal::Measure(index),
                &measure.name,
                measure.coordinate.kind,
            )
        });
        let inputs = self.inputs.in_order().into_iter();
        let inputs = inputs.map(|(name, place)| {
            let dimension = self.input_dimensions[place];
            (name.to_owned(), Variable::Input(place), dimension)
        });
        let signals = of_drivers.chain(of_measures);
        let signals = signals.map(|(name, variable, unit)| (name, variable, Some(unit)));
        let signals: Vec<_> = signals.chain(inputs).collect();
        let computed = self.computed.clone();
        let known = signals
            .iter()
            .map(|(name, variable, _)| (name.as_str(), *variable));
        let of_signals = signals.iter();
        let of_signals = of_signals.filter_map(|(name, _, unit)| Some((name.as_str(), (*unit)?)));
        let moving = MovingNames {
            known: known.collect(),
            dimensions: Vec::new(),
            of_signals: of_signals.collect(),
            computed,
            usable: "a force may use parameters, inputs, `t`, and `position` and `velocity` of \
                     drivers, freedoms and measures with a coordinate",
            law: None,
            may_jump: true,
        };
        let entries = entries.items().iter();
        let read = entries.filter_map(|entry| self.force(*entry, &moving, start_time));
        read.collect()
    }

    /// Reads a force.
    fn force(
        &mut self,
        entry: Entry<'a>,
        moving: &MovingNames<'_>,
        start_time: f64,
    ) -> Option<Force> {
        let fields = self.entry_fields(entry, "force")?;
        let has = |key| fields.table.contains_key(key);
        let (place, has) = match (has("coordinate"), has("marker")) {
            (true, false) => {
                let keys = self.table::<(CoordinateKeys<'a>, CoordinateForceKeys<'a>)>(&fields);
                return self.coordinate_force(entry, keys, moving, start_time);
            }
            (false, true) => {
                let keys = self.table::<MarkerForceKeys<'a>>(&fields);
                return self.marker_force(entry, keys, moving, start_time);
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
        moving: &MovingNames<'_>,
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
        const OWN: [Variable; 3] = [Variable::Time, Variable::Position, Variable::Velocity];
        let is_constant = keys.constant.or(false)?;
        let value = match keys.value.value {
            Some(value) => {
                let expression = self.force_value(value, &OWN, moving, start_time)?;
                if is_constant && expression.variables().next().is_some() {
                    let message = format!("the `value` of {} is not constant", owner.subject);
                    self.error(code::BAD_EXPRESSION, value.span(), message)
                        .suggest("a constant spring has a number, over parameters at most");
                    return None;
                }
                Some(expression)
            }
            None if is_constant => {
                self.missing_key(owner, "value", "-20");
                return None;
            }
            None => None,
        };
        let resisting = [
            (
                "stiffness",
                &keys.stiffness,
                "a spring that pushes away from where it is free",
            ),
            ("damping", &keys.damping, "a damper that speeds up"),
        ];
        for (key, field, what) in resisting {
            if field.number().is_some_and(|number| number < 0.0) {
                let message = format!("{} has a negative `{key}`: {what}", owner.subject);
                self.warn(code::UNUSUAL_VALUE, field.span.clone(), message);
            }
        }
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
                    is_constant,
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
        moving: &MovingNames<'_>,
        start_time: f64,
    ) -> Option<Force> {
        let mut read = |value| self.force_value(value, &[Variable::Time], moving, start_time);
        let [value, torque] = [keys.value.key.is_some(), keys.torque.key.is_some()];
        // Each is read, so that each wrong one is reported.
        let force = keys.value.value.map(|components| components.map(&mut read));
        let force = force.map(|[x, y]| Some([x?, y?]));
        let torque = if torque {
            Some(keys.torque.value.and_then(read)?)
        } else {
            None
        };
        let force = if value { Some(force??) } else { None };
        let marker = keys.marker.value?;
        if self.carriers[marker.index()].is_none() {
            let message = format!("{} acts on ground, which does not move", keys.owner.subject);
            self.error(code::UNKNOWN_BODY, keys.marker.span.clone(), message)
                .suggest("give a marker of a body");
        }
        let axes = keys.axes.optional()?;
        let law = match (force, torque) {
            (None, None) => None,
            (force, torque) => {
                let zero = || Expression::constant(0.0);
                let [x, y] = force.unwrap_or_else(|| [zero(), zero()]);
                Some([x, y, torque.unwrap_or_else(zero)])
            }
        };
        Some(Force {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            load: Load::Marker { marker, axes, law },
        })
    }

    /// Reads the size of a force, over its own `variables` and what moves elsewhere. Refuses one that is
    /// not finite at the start time, unless it depends on what moves, which is not known yet.
    fn force_value(
        &mut self,
        value: &'a Value<'a>,
        variables: &[Variable],
        moving: &MovingNames<'_>,
        start_time: f64,
    ) -> Option<Expression> {
        let Quantity {
            expression, span, ..
        } = self.formula(value, variables, Some(moving))?;
        let is_known = expression.variables().all(|which| which == Variable::Time);
        if is_known
            && self.knows(expression.parameters())
            && !expression
                .evaluate(&|id| self.known_value(id), start_time)
                .is_finite()
        {
            self.not_finite(span, "at the start time, the value");
            return None;
        }
        Some(expression)
    }
}

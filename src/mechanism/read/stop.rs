//! Stops: where a coordinate may not go.

use crate::mechanism::diagnostic::code;
use crate::mechanism::wording::shown;
use crate::mechanism::{Coordinate, CoordinateKind, Expression, Stop, StopContact};

use super::context::Context;
use super::kind::{Entry, Fields, Text};
use super::number::{NUMBER, Quantity, RATIO};
use super::placed::{Placed, Placing};
use super::table::{Field, table};

table! {
    /// Limits that a coordinate does not pass: driven motion ends there, free motion bounces or rests.
    /// With a stiffness the coordinate goes beyond against a spring.
    struct StopKeys<'a> {
        /// Least value of the coordinate [m or rad].
        min: Quantity = NUMBER,
        /// Largest value of the coordinate [m or rad].
        max: Quantity = NUMBER,
        /// Part of the velocity with which free motion bounces, from 0 to 1; zero if left out.
        restitution: Quantity = RATIO,
        /// Stiffness of an elastic stop [N/m or N.m/rad].
        stiffness: Quantity = NUMBER.positive(),
        /// Coefficient of its damper [N.s/m or N.m.s/rad].
        damping: Quantity = NUMBER.not_negative(),
        /// Description in one line.
        description: String = Text,
    }
}

/// A stop of either shape.
pub(super) type AnyStop = Placed<StopKeys<'static>>;

const PLACING: Placing = Placing {
    noun: "stop",
    verb: "limit",
    code: code::STOP_COORDINATE,
    or: "",
};

impl<'a> Context<'a> {
    /// Reads a stop, after the measures and drivers.
    pub(super) fn stop(&mut self, entry: Entry<'a>) -> Option<Stop> {
        let (coordinate, of, keys) = self.placed::<StopKeys<'a>>(entry, &PLACING)?;
        let StopKeys {
            owner,
            restitution,
            stiffness,
            damping,
            ..
        } = &keys;
        let contact = self.stop_contact(owner, restitution, [stiffness, damping]);
        let [min, max] = self.limits_of(coordinate, [keys.min, keys.max], &keys.owner);
        Some(Stop {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            coordinate: coordinate?,
            of,
            min,
            max,
            contact: contact?,
        })
    }

    /// Returns the behaviour at the limits of a stop, or of a contact.
    pub(super) fn stop_contact(
        &mut self,
        owner: &Fields<'a>,
        restitution: &Field<Quantity>,
        [stiffness, damping]: [&Field<Quantity>; 2],
    ) -> Option<StopContact> {
        let expression = |field: &Field<Quantity>| {
            let quantity = field.value.as_ref();
            quantity.map(|quantity| quantity.expression.clone())
        };
        self.check_restitution(restitution);
        match (&stiffness.key, &restitution.key, &damping.key) {
            (None, _, Some(span)) => {
                let message = format!("{} has `damping`, but no `stiffness`", owner.subject);
                self.error(code::UNKNOWN_KEY, span.clone(), message)
                    .suggest("a damper stands beside the spring of an elastic stop");
                None
            }
            (Some(_), Some(span), _) => {
                let message = format!("{} has both `stiffness` and `restitution`", owner.subject);
                self.error(code::UNKNOWN_KEY, span.clone(), message)
                    .suggest(
                        "an elastic stop has a `stiffness` and a `damping`, a rigid one a \
                     `restitution`",
                    );
                None
            }
            (Some(_), None, _) => Some(StopContact::Elastic {
                stiffness: expression(stiffness)?,
                damping: expression(damping),
            }),
            (None, _, None) => Some(StopContact::Rigid {
                restitution: expression(restitution),
            }),
        }
    }

    /// Checks the limits of a coordinate, which is `None` after an error, and returns them.
    fn limits_of(
        &mut self,
        coordinate: Option<Coordinate>,
        [min, max]: [Field<Quantity>; 2],
        owner: &Fields<'a>,
    ) -> [Option<Expression>; 2] {
        let kind = coordinate.map(|coordinate| coordinate.kind);
        for limit in [&min, &max] {
            if let (Some(kind), Some(value)) = (kind, &limit.value) {
                self.warn_of_unit(value, kind.unit());
            }
        }
        if min.key.is_none() && max.key.is_none() {
            let message = format!("{} has neither `min` nor `max`", owner.subject);
            self.error(code::MISSING_KEY, owner.place.clone(), message)
                .suggest("a stop has a `min`, a `max` or both");
        }
        let expression = |limit: &Option<Quantity>| limit.as_ref().map(|q| q.expression.clone());
        let expressions = [&min, &max].map(|limit| expression(&limit.value));
        let span = max.span.clone();
        let unit = kind.map(CoordinateKind::unit);
        if let [Some(least), Some(most)] = self.limits([min, max], ("the value", None), unit)
            && least >= most
            && most >= least
        {
            let suffix = unit.map_or_else(String::new, |unit| unit.suffix());
            let message = format!("`min` and `max` are both {}{suffix}", shown(least));
            self.error(code::OUT_OF_RANGE, span, message)
                .suggest("a coordinate that cannot move is held in `[constraints]`");
        }
        expressions
    }
}

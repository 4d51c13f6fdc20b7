//! Drivers: coordinates that move.

use crate::mechanism::diagnostic::code;
use crate::mechanism::{CoordinateKind, Driver, DriverSource};

use super::context::Context;
use super::coordinate::CoordinateKeys;
use super::kind::{Entry, Flag, Text};
use super::motion::{MotionKey, ReadMotion};
use super::number::{NUMBER, Quantity};
use super::table::table;

table! {
    /// A coordinate that is driven.
    #[one_of(
        start,
        motion,
        code::DRIVER_SOURCE,
        "give `start = \"60*deg\"` for an FMI input, or `motion = \"10*deg*t\"` for a prescribed motion"
    )]
    struct DriverKeys<'a> {
        /// Start value; makes the driver an FMI input [m or rad].
        start: Quantity = NUMBER,
        /// Prescribed motion: an expression in t and inputs, or a table.
        motion: ReadMotion = MotionKey,
        /// Lower limit [m or rad], such as the shortest length of a cylinder.
        min: Quantity = NUMBER,
        /// Upper limit [m or rad].
        max: Quantity = NUMBER,
        /// Whether the input gives an angle modulo one turn: each value means the nearest turn.
        wrapped: bool = Flag,
        /// Description in one line.
        description: String = Text,
    }
}

impl<'a> Context<'a> {
    /// Reads a driver; a prescribed motion is checked at `start_time` [s].
    pub(super) fn driver(&mut self, entry: Entry<'a>, start_time: f64) -> Option<Driver> {
        let (coordinate, keys) =
            self.entry::<(CoordinateKeys<'a>, DriverKeys<'a>)>(entry, "driver")?;
        let coordinate = self.coordinate(coordinate);
        let kind = coordinate.map(|coordinate| coordinate.kind);
        let wrapped = self.wrapped(&keys, kind);
        for (value, subject) in [
            (&keys.start.value, "the `start` of a distance"),
            (&keys.min.value, "the `min` of a distance"),
            (&keys.max.value, "the `max` of a distance"),
        ] {
            if let (Some(kind), Some(value)) = (kind, value) {
                self.check_coordinate_value(kind, value, subject);
            }
        }
        let unit = kind.map(CoordinateKind::unit);
        let start = ("`start`", keys.start.value.as_ref());
        let [min, max] = self.limits([keys.min, keys.max], start, unit);
        let (source, follows) = match (keys.start.value, keys.motion.value) {
            (Some(start), _) => {
                let start = start.value?;
                (DriverSource::Input { start }, None)
            }
            (None, motion) => {
                let (motion, follows) = self.check_motion(motion?, kind, start_time)?;
                (DriverSource::Motion(motion), follows)
            }
        };
        Some(Driver {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            coordinate: coordinate?,
            is_input: matches!(source, DriverSource::Input { .. }),
            source,
            follows,
            min,
            max,
            wrapped,
        })
    }

    /// Returns whether the driver is wrapped, which only the input of an angle can be.
    fn wrapped(&mut self, keys: &DriverKeys<'a>, kind: Option<CoordinateKind>) -> bool {
        let wrapped = keys.wrapped.value.unwrap_or(false);
        let reason = match kind {
            Some(CoordinateKind::Angle) if keys.motion.key.is_none() => return wrapped,
            Some(CoordinateKind::Angle) => "its motion is prescribed",
            Some(_) => "it is no `angle`",
            None => return wrapped,
        };
        if wrapped {
            let message = format!("{} is `wrapped`, but {reason}", keys.owner.subject);
            self.error(code::ILLEGAL_VALUE, keys.wrapped.span.clone(), message)
                .suggest(
                    "only the input of an angle can be given modulo one turn: leave `wrapped` out",
                );
        }
        wrapped
    }
}

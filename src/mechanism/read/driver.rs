//! Drivers: coordinates that move.

use crate::mechanism::diagnostic::code;
use crate::mechanism::{Driver, DriverSource};

use super::context::Context;
use super::coordinate::CoordinateKeys;
use super::kind::{Entry, Text};
use super::motion::{PrescribedMotion, ReadMotion};
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
        /// Prescribed motion: an expression in t, or a table.
        motion: ReadMotion = PrescribedMotion,
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
        let source = match (keys.start.value, keys.motion.value) {
            (Some(start), _) => {
                if let Some(kind) = kind {
                    self.check_coordinate_value(kind, &start, "the `start` of a distance");
                }
                DriverSource::Input {
                    start: start.value?,
                }
            }
            (None, motion) => DriverSource::Motion(self.check_motion(motion?, kind, start_time)?),
        };
        Some(Driver {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            coordinate: coordinate?,
            source,
        })
    }
}

//! Freedoms: coordinates that the forces move.

use crate::mechanism::diagnostic::code;
use crate::mechanism::wording::quoted;
use crate::mechanism::{Body, CoordinateKind, Driver, DriverSource, Mechanism};

use super::context::Context;
use super::coordinate::CoordinateKeys;
use super::kind::{Entry, Text};
use super::number::{NUMBER, Quantity};
use super::table::table;

table! {
    /// A coordinate that the forces move.
    struct FreedomKeys<'a> {
        /// Value at the start [m or rad]; that of the estimates if left out.
        start: Quantity = NUMBER,
        /// Velocity at the start [m/s or rad/s]; zero if left out.
        velocity: Quantity = NUMBER,
        /// Description in one line.
        description: String = Text,
    }
}

impl<'a> Context<'a> {
    /// Reports freedoms of a mechanism without masses.
    pub(super) fn check_freedoms(&mut self, mechanism: &Mechanism, freedoms: &[Entry<'a>]) {
        let has_mass = mechanism.bodies.iter().any(Body::has_mass);
        for entry in freedoms.iter().filter(|_| !has_mass) {
            let name = quoted(entry.name());
            let message = format!("the freedom {name} has nothing to move: no body has a mass");
            self.error(code::MISSING_MASS, entry.key.span(), message)
                .suggest("give the bodies `mass`, `center` and `inertia`, or `shapes` with a `thickness` and a \
                     `density`");
        }
    }

    /// Reads a freedom. Its start is not a number if the file leaves it to the estimates.
    pub(super) fn freedom(&mut self, entry: Entry<'a>) -> Option<Driver> {
        let (coordinate, keys) =
            self.entry::<(CoordinateKeys<'a>, FreedomKeys<'a>)>(entry, "freedom")?;
        let coordinate = self.coordinate(coordinate);
        let kind = coordinate.map(|coordinate| coordinate.kind);
        if let (Some(kind), Some(start)) = (kind, &keys.start.value) {
            self.check_coordinate_value(kind, start, "the `start` of a distance");
        }
        if let (Some(kind), Some(velocity)) = (kind, &keys.velocity.value) {
            self.warn_of_unit(velocity, CoordinateKind::units(kind)[1]);
        }
        let source = DriverSource::Free {
            start: keys.start.number_or(f64::NAN)?,
            velocity: keys.velocity.number_or(0.0)?,
            named: None,
        };
        Some(Driver {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            coordinate: coordinate?,
            source,
            follows: None,
            is_input: false,
            min: None,
            max: None,
            wrapped: false,
        })
    }
}

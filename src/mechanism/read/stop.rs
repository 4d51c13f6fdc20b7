//! Stops: where a coordinate may not go.

use crate::mechanism::diagnostic::code;
use crate::mechanism::names;
use crate::mechanism::wording::{quoted, shown};
use crate::mechanism::{Coordinate, CoordinateKind, Span, Stop};

use super::context::Context;
use super::coordinate::CoordinateKeys;
#[cfg(feature = "cli")]
use super::kind::NAME;
use super::kind::{AnyOf, Entry, Item, Kind, Text, schema};
use super::number::{NUMBER, Quantity};
use super::table::table;

table! {
    /// Limits that a coordinate does not pass: the motion ends there.
    struct StopKeys<'a> {
        /// Least value of the coordinate [m or rad].
        min: Quantity = NUMBER,
        /// Largest value of the coordinate [m or rad].
        max: Quantity = NUMBER,
        /// Description in one line.
        description: String = Text,
    }

    /// The coordinate of a measure or driver.
    struct OfKeys<'a> {
        /// Measure or driver whose coordinate is limited.
        #[required("\"travel\"")]
        of: (&'a str, Span) = CoordinateName,
    }
}

/// Name of a measure or driver, which is looked up later.
struct CoordinateName;

impl<'a> Kind<'a> for CoordinateName {
    type Value = (&'a str, Span);

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<(&'a str, Span)> {
        Some((context.text(item.value)?, item.span()))
    }

    schema! {{ "type": "string", "pattern": NAME }}
}

/// A stop of either shape.
pub(super) type AnyStop =
    AnyOf<(CoordinateKeys<'static>, StopKeys<'static>), (OfKeys<'static>, StopKeys<'static>)>;

impl<'a> Context<'a> {
    /// Reads a stop, after the measures and drivers.
    pub(super) fn stop(&mut self, entry: Entry<'a>) -> Option<Stop> {
        let fields = self.entry_fields(entry, "stop")?;
        let has = |key| fields.table.contains_key(key);
        let (place, has) = match (has("coordinate"), has("of")) {
            (true, false) => {
                let (keys, limits) = self.table::<(CoordinateKeys<'a>, StopKeys<'a>)>(&fields);
                let coordinate = self.coordinate(keys);
                return self.limited(entry, (coordinate, None), limits);
            }
            (false, true) => {
                let (keys, limits) = self.table::<(OfKeys<'a>, StopKeys<'a>)>(&fields);
                let (name, coordinate) = keys.of.value.map_or((None, None), |(name, span)| {
                    (Some(name.to_owned()), self.coordinate_of(name, &span))
                });
                return self.limited(entry, (coordinate, name), limits);
            }
            (true, true) => ("both", "and"),
            (false, false) => ("neither", "nor"),
        };
        let message = format!("{} has {place} `coordinate` {has} `of`", fields.subject);
        self.error(code::STOP_COORDINATE, fields.place.clone(), message)
            .suggest(
                "give `of = \"MEASURE\"` to limit a measure or a driver, or `coordinate` and \
                 `markers`",
            );
        None
    }

    /// Returns the coordinate of a measure or driver; `None` with an error, its own or one here.
    fn coordinate_of(&mut self, name: &str, span: &Span) -> Option<Coordinate> {
        let mut all = self.coordinates.iter();
        if let Some((_, coordinate)) = all.find(|(own, _)| *own == name) {
            return *coordinate;
        }
        if self.computed.contains(&name) {
            let message = format!("{} is a computed measure", quoted(name));
            self.error(code::UNKNOWN_COORDINATE, span.clone(), message)
                .suggest("a stop limits a coordinate: name one that the measure is computed from");
            return None;
        }
        let candidates: Vec<&str> = self.coordinates.iter().map(|(own, _)| *own).collect();
        let message = format!("no measure or driver {}", quoted(name));
        let help = names::help(name, &candidates, &[]);
        self.error(code::UNKNOWN_COORDINATE, span.clone(), message)
            .help = help;
        None
    }

    /// Checks the limits of a coordinate, which is `None` after an error.
    fn limited(
        &mut self,
        entry: Entry<'a>,
        (coordinate, of): (Option<Coordinate>, Option<String>),
        keys: StopKeys<'a>,
    ) -> Option<Stop> {
        let kind = coordinate.map(|coordinate| coordinate.kind);
        for limit in [&keys.min, &keys.max] {
            if let (Some(kind), Some(value)) = (kind, &limit.value) {
                self.warn_of_unit(value, kind.unit());
            }
        }
        if keys.min.key.is_none() && keys.max.key.is_none() {
            let owner = &keys.owner;
            let message = format!("{} has neither `min` nor `max`", owner.subject);
            self.error(code::MISSING_KEY, owner.place.clone(), message)
                .suggest("a stop has a `min`, a `max` or both");
        }
        let expression = |limit: &Option<Quantity>| limit.as_ref().map(|q| q.expression.clone());
        let [min, max] = [&keys.min, &keys.max].map(|limit| expression(&limit.value));
        let span = keys.max.span.clone();
        let unit = kind.map(CoordinateKind::unit);
        if let [Some(least), Some(most)] =
            self.limits([keys.min, keys.max], ("the value", None), unit)
            && least >= most
            && most >= least
        {
            let suffix = unit.map_or_else(String::new, |unit| unit.suffix());
            let message = format!("`min` and `max` are both {}{suffix}", shown(least));
            self.error(code::OUT_OF_RANGE, span, message)
                .suggest("a coordinate that cannot move is held in `[constraints]`");
        }
        Some(Stop {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            coordinate: coordinate?,
            of,
            min,
            max,
        })
    }
}

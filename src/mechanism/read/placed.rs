//! Coordinates that are given themselves, or by the name of a measure or driver.

use crate::mechanism::diagnostic::code;
use crate::mechanism::names;
use crate::mechanism::wording::quoted;
use crate::mechanism::{Coordinate, Span};

use super::context::Context;
use super::coordinate::CoordinateKeys;
use super::kind::NAME;
use super::kind::{AnyOf, Entry, Item, Kind, schema};
use super::table::{Keys, table};

table! {
    /// The coordinate of a measure or driver.
    struct OfKeys<'a> {
        /// Measure or driver whose coordinate it is.
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

/// A table with a coordinate of either shape.
pub(super) type Placed<K> = AnyOf<(CoordinateKeys<'static>, K), (OfKeys<'static>, K)>;

/// A part of the mechanism that concerns a coordinate: its noun, what it does with the coordinate, and
/// the code of the error where the coordinate is missing.
pub(super) struct Placing {
    pub(super) noun: &'static str,
    pub(super) verb: &'static str,
    pub(super) code: &'static str,
    /// Another way to say where it acts, as the end of a sentence.
    pub(super) or: &'static str,
}

impl<'a> Context<'a> {
    /// Reads an entry with a coordinate. Returns the coordinate, `None` after an error, the measure or
    /// driver that names it, and the other keys.
    pub(super) fn placed<K: Keys<'a>>(
        &mut self,
        entry: Entry<'a>,
        placing: &Placing,
    ) -> Option<(Option<Coordinate>, Option<String>, K)> {
        let Placing {
            noun,
            verb,
            code,
            or,
        } = *placing;
        let fields = self.entry_fields(entry, noun)?;
        let has = |key| fields.table.contains_key(key);
        let (place, has) = match (has("coordinate"), has("of")) {
            (true, false) => {
                let (coordinate, keys) = self.table::<(CoordinateKeys<'a>, K)>(&fields);
                return Some((self.coordinate(coordinate), None, keys));
            }
            (false, true) => {
                let (of, keys) = self.table::<(OfKeys<'a>, K)>(&fields);
                let (name, coordinate) = of.of.value.map_or((None, None), |(name, span)| {
                    let coordinate = self.coordinate_of(name, &span, placing);
                    (Some(name.to_owned()), coordinate)
                });
                return Some((coordinate, name, keys));
            }
            (true, true) => ("both", "and"),
            (false, false) => ("neither", "nor"),
        };
        let message = format!("{} has {place} `coordinate` {has} `of`", fields.subject);
        self.error(code, fields.place.clone(), message)
            .suggest(format!(
                "give `of = \"MEASURE\"` to {verb} a measure or a driver, or `coordinate` and \
                 `markers`{or}"
            ));
        None
    }

    /// Returns the coordinate of a measure or driver; `None` with an error, its own or one here.
    fn coordinate_of(
        &mut self,
        name: &str,
        span: &Span,
        Placing { noun, verb, .. }: &Placing,
    ) -> Option<Coordinate> {
        let mut all = self.coordinates.iter();
        if let Some((_, coordinate)) = all.find(|(own, _)| *own == name) {
            if coordinate.is_some_and(|coordinate| coordinate.shapes().is_some()) {
                let message = format!("{} is a clearance, which is measured only", quoted(name));
                self.error(code::UNKNOWN_COORDINATE, span.clone(), message)
                    .suggest("`[contacts]` keep two shapes apart");
                return None;
            }
            return *coordinate;
        }
        if self.computed.contains(&name) {
            let message = format!("{} is a computed measure", quoted(name));
            self.error(code::UNKNOWN_COORDINATE, span.clone(), message)
                .suggest(format!(
                    "a {noun} {verb}s a coordinate: name one that the measure is computed from"
                ));
            return None;
        }
        let candidates: Vec<&str> = self.coordinates.iter().map(|(own, _)| *own).collect();
        let message = format!("no measure, driver or freedom {}", quoted(name));
        let help = names::help(name, &candidates, &[]);
        self.error(code::UNKNOWN_COORDINATE, span.clone(), message)
            .help = help;
        None
    }
}

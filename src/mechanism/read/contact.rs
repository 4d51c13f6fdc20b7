//! Contacts: shapes that do not enter each other.

use crate::mechanism::diagnostic::code;
use crate::mechanism::wording::quoted;
use crate::mechanism::{Expression, Mechanism, ShapeId, Stop, StopContact};

use super::context::Context;
use super::kind::{Entry, Text};
use super::reference::{SHAPES, ShapePair};
use super::table::table;

table! {
    /// Two shapes that do not enter each other: driven motion ends where they touch.
    struct ContactKeys<'a> {
        /// Two shapes on different bodies, of which one is round.
        #[required(SHAPES)]
        shapes: [ShapeId; 2] = ShapePair,
        /// Description in one line.
        description: String = Text,
    }
}

impl<'a> Context<'a> {
    /// Reads the contacts: stops of clearances at zero.
    pub(super) fn contacts(&mut self, entries: &[Entry<'a>]) -> Vec<Stop> {
        let mut pairs: Vec<[ShapeId; 2]> = Vec::new();
        let mut stops = Vec::new();
        for entry in entries {
            let Some(keys) = self.entry::<ContactKeys<'a>>(*entry, "contact") else {
                continue;
            };
            let Some(mut pair) = keys.shapes.value else {
                continue;
            };
            if !pair.iter().any(|shape| self.shapes[shape.index()].is_round) {
                let message = format!("no shape of {} is round", keys.owner.subject);
                self.error(code::SHAPE, keys.shapes.span.clone(), message)
                    .suggest(
                        "corner against corner has no direction: give one of the outlines a \
                         `fillet`, 0.1 mm will do",
                    );
            }
            let coordinate = self.clearance(pair);
            pair.sort_unstable();
            if pairs.contains(&pair) {
                let message = format!(
                    "the shapes of {} have a contact already",
                    keys.owner.subject
                );
                self.error(code::DUPLICATE_NAME, keys.shapes.span.clone(), message);
            }
            pairs.push(pair);
            stops.extend(coordinate.map(|coordinate| Stop {
                name: entry.name().to_owned(),
                description: keys.description.value.unwrap_or_default(),
                coordinate,
                of: None,
                min: Some(Expression::constant(0.0)),
                max: None,
                contact: StopContact::Rigid { restitution: None },
            }));
        }
        stops
    }

    /// Reports contacts of a mechanism with freedoms.
    pub(super) fn check_contacts(&mut self, mechanism: &Mechanism, contacts: &[Entry<'a>]) {
        for entry in contacts.iter().filter(|_| mechanism.has_freedoms()) {
            let name = quoted(entry.name());
            let message = format!("the contact {name} acts in driven motion only");
            self.error(code::SHAPE, entry.key.span(), message).suggest(
                "forces of contacts are not computed: remove it, or drive all coordinates; a \
                 measure of its clearance is possible",
            );
        }
    }
}

//! Contacts: shapes that meet.

use crate::mechanism::diagnostic::code;
use crate::mechanism::wording::quoted;
use crate::mechanism::{Expression, Mechanism, ShapeId, Stop};

use super::context::Context;
use super::kind::{Entry, Text};
use super::number::{NUMBER, Quantity, RATIO};
use super::reference::{SHAPES, ShapePair};
use super::table::table;

table! {
    /// Two shapes that do not enter each other: driven motion ends where they touch, free motion bounces or
    /// rests. With a stiffness they overlap against a spring.
    struct ContactKeys<'a> {
        /// Two shapes on different bodies, of which one is round.
        #[required(SHAPES)]
        shapes: [ShapeId; 2] = ShapePair,
        /// Part of the velocity with which free motion bounces, from 0 to 1; zero if left out.
        restitution: Quantity = RATIO,
        /// Stiffness of an elastic contact, at each place that touches [N/m].
        stiffness: Quantity = NUMBER.positive(),
        /// Coefficient of its damper [N.s/m].
        damping: Quantity = NUMBER.not_negative(),
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
            let ContactKeys {
                owner,
                restitution,
                stiffness,
                damping,
                ..
            } = &keys;
            let contact = self.stop_contact(owner, restitution, [stiffness, damping]);
            pair.sort_unstable();
            if pairs.contains(&pair) {
                let message = format!(
                    "the shapes of {} have a contact already",
                    keys.owner.subject
                );
                self.error(code::DUPLICATE_NAME, keys.shapes.span.clone(), message);
            }
            pairs.push(pair);
            stops.extend(coordinate.zip(contact).map(|(coordinate, contact)| Stop {
                name: entry.name().to_owned(),
                description: keys.description.value.unwrap_or_default(),
                coordinate,
                of: None,
                min: Some(Expression::constant(0.0)),
                max: None,
                contact,
            }));
        }
        stops
    }

    /// Reports elastic contacts that would push twice at one place.
    pub(super) fn check_contacts(&mut self, mechanism: &Mechanism, contacts: &[Entry<'a>]) {
        let parameters = mechanism.default_parameters();
        for entry in contacts {
            let stop = mechanism
                .stops
                .iter()
                .find(|stop| stop.name == entry.name());
            let elastic = stop.filter(|stop| !stop.is_rigid());
            let shapes = elastic.and_then(|stop| stop.coordinate.shapes());
            let Some(shapes) = shapes.filter(|own| mechanism.elements(*own, &parameters).overlap)
            else {
                continue;
            };
            let [a, b] = shapes.map(|id| quoted(&mechanism.shape_path(id)));
            let name = quoted(entry.name());
            let message = format!("the contact {name} of {a} and {b} cannot have a `stiffness`");
            self.error(code::SHAPE, entry.key.span(), message).suggest(
                "an elastic contact is one of a `disc` with a shape without bends, arcs round free \
                 space or notches with more than one corner; make it rigid",
            );
        }
    }
}

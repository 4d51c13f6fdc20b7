//! Bodies and their markers.

use crate::mechanism::diagnostic::code;
use crate::mechanism::names::{quoted, shown};
use crate::mechanism::syntax::Value;
use crate::mechanism::{Body, Diagnostic, Expression, Marker, MarkerId};

use super::context::{Context, Entry, Fields, Quantity};
use super::names::Sections;

/// The keys of a body.
pub(super) const KEYS: [&str; 6] = [
    "markers",
    "estimate",
    "mass",
    "inertia",
    "center",
    "description",
];

impl<'a> Context<'a> {
    /// All markers: those of ground, then those of the bodies.
    pub(super) fn lower_markers(&mut self, sections: &Sections<'a>) -> Vec<Marker> {
        let markers = sections.markers.iter();
        markers
            .filter_map(|(body, entry)| {
                let [x, y, angle] = self.frame(entry.value)?;
                Some(Marker {
                    name: entry.name().to_owned(),
                    body: *body,
                    position: [x, y],
                    angle,
                })
            })
            .collect()
    }

    /// A marker's place `[x, y]` or `[x, y, angle]`.
    fn frame(&mut self, value: &'a Value<'a>) -> Option<[Expression; 3]> {
        let expected = "an array `[x, y]` or `[x, y, angle]`";
        let items = self.items_of(value, 2..=3, expected)?;
        if items.len() == 3 {
            let frame = self.quantities::<3>(value, expected)?;
            self.warn_of_degrees(&frame[2]);
            return Some(frame.map(|q| q.expression));
        }
        let [x, y] = self.quantities::<2>(value, expected)?;
        Some([x.expression, y.expression, Expression::constant(0.0)])
    }

    pub(super) fn lower_bodies(&mut self, entries: &[Entry<'a>]) -> Vec<Body> {
        // Markers have their ids in the order of the bodies.
        let mut next_marker = self.markers.first().map_or(0, |ground| ground.len());
        let mut bodies = Vec::with_capacity(entries.len());
        for (index, entry) in entries.iter().enumerate() {
            let count = self.markers[index + 1].len();
            let markers = (next_marker..next_marker + count).map(MarkerId).collect();
            next_marker += count;
            bodies.extend(self.lower_body(*entry, markers));
        }
        bodies
    }

    fn lower_body(&mut self, entry: Entry<'a>, markers: Vec<MarkerId>) -> Option<Body> {
        // Its type has been checked when its markers were declared.
        let table = entry.value.get_ref().as_table()?;
        let fields = Fields {
            table,
            place: entry.key.span(),
            subject: format!("body {}", quoted(entry.name())),
        };
        self.check_keys(&fields, &KEYS);
        let estimate = fields
            .get("estimate")
            .and_then(|value| self.quantities::<3>(value, "an array `[x, y, phi]`"));
        if let Some([_, _, phi]) = &estimate {
            self.warn_of_degrees(phi);
        }
        let mass = fields.get("mass").and_then(|value| self.quantity(value));
        if let Some(mass) = &mass {
            self.check_positive(mass, "`mass`");
        }
        let inertia = fields.get("inertia").and_then(|value| self.quantity(value));
        self.check_inertia(inertia.as_ref());
        let center = fields
            .get("center")
            .and_then(|value| self.quantities::<2>(value, "an array `[x, y]`"));
        self.warn_of_missing_mass(&fields);
        Some(Body {
            name: entry.name().to_owned(),
            description: self.description(&fields),
            markers,
            estimate: estimate.map_or_else(
                || [const { 0.0 }; 3].map(Expression::constant),
                |estimate| estimate.map(|q| q.expression),
            ),
            mass: mass.map(|q| q.expression),
            inertia: inertia.map(|q| q.expression),
            center: center.map(|center| center.map(|q| q.expression)),
        })
    }

    /// A point mass has no inertia: zero is legal.
    fn check_inertia(&mut self, inertia: Option<&Quantity>) {
        let Some(inertia) = inertia else { return };
        if let Some(value) = inertia.value.filter(|value| *value < 0.0) {
            let message = format!("`inertia` must not be negative, is {}", shown(value));
            self.error(code::ILLEGAL_VALUE, inertia.span.clone(), message);
        }
    }

    fn warn_of_missing_mass(&mut self, fields: &Fields<'a>) {
        if fields.get("mass").is_some() {
            return;
        }
        for key in ["inertia", "center"] {
            if let Some(span) = fields.key_span(key) {
                let message = format!("`{key}` of {} has no effect without `mass`", fields.subject);
                self.problems
                    .push(Diagnostic::warning(code::MISSING_MASS, message).label(span, ""));
            }
        }
    }
}

//! Coordinates between two markers: constraints, drivers and measures.

use crate::mechanism::diagnostic::code;
use crate::mechanism::names::quoted;
use crate::mechanism::{
    Constraint, Coordinate, CoordinateKind, Driver, DriverSource, MarkerId, Measure,
};

use super::context::{Context, Entry, Fields, Quantity};
use super::motions::MOTION_FORMS;

pub(super) const COORDINATES: [(&str, CoordinateKind); 4] = [
    ("angle", CoordinateKind::Angle),
    ("x", CoordinateKind::X),
    ("y", CoordinateKind::Y),
    ("distance", CoordinateKind::Distance),
];

/// The keys of a coordinate; and those that constraints, drivers and measures have besides.
pub(super) const KEYS: [&str; 3] = ["coordinate", "markers", "axes"];
pub(super) const CONSTRAINT_KEYS: [&str; 2] = ["value", "description"];
pub(super) const DRIVER_KEYS: [&str; 3] = ["start", "motion", "description"];
pub(super) const MEASURE_KEYS: [&str; 1] = ["description"];

/// How markers are written, for help where they are missing.
const MARKERS_FORM: &str = "[\"ground.O\", \"crank.O\"]";

impl<'a> Context<'a> {
    pub(super) fn lower_constraints(&mut self, entries: &[Entry<'a>]) -> Vec<Constraint> {
        let constraints = entries.iter();
        constraints
            .filter_map(|entry| self.lower_constraint(*entry))
            .collect()
    }

    fn lower_constraint(&mut self, entry: Entry<'a>) -> Option<Constraint> {
        let fields = self.entry_fields(entry, "constraint")?;
        let coordinate = self.coordinate(&fields, &CONSTRAINT_KEYS);
        self.description(&fields);
        let value = self.required_quantity(&fields, "value", "0");
        let (coordinate, value) = (coordinate?, value?);
        if coordinate.kind == CoordinateKind::Distance {
            self.check_positive(&value, "a distance");
        }
        if coordinate.kind == CoordinateKind::Angle {
            self.warn_of_degrees(&value);
        }
        Some(Constraint {
            name: entry.name().to_owned(),
            coordinate,
            value: value.expression,
        })
    }

    pub(super) fn lower_drivers(&mut self, entries: &[Entry<'a>], start_time: f64) -> Vec<Driver> {
        let drivers = entries.iter();
        drivers
            .filter_map(|entry| self.lower_driver(*entry, start_time))
            .collect()
    }

    fn lower_driver(&mut self, entry: Entry<'a>, start_time: f64) -> Option<Driver> {
        let fields = self.entry_fields(entry, "driver")?;
        let coordinate = self.coordinate(&fields, &DRIVER_KEYS);
        let description = self.description(&fields);
        let kind = coordinate.map(|coordinate| coordinate.kind);
        let source = self.driver_source(&fields, kind, start_time);
        Some(Driver {
            name: entry.name().to_owned(),
            description,
            coordinate: coordinate?,
            source: source?,
        })
    }

    fn driver_source(
        &mut self,
        fields: &Fields<'a>,
        kind: Option<CoordinateKind>,
        start_time: f64,
    ) -> Option<DriverSource> {
        let motion = fields
            .get("motion")
            .map(|value| self.motion(value, kind, start_time));
        let start = fields.get("start").map(|value| self.quantity(value));
        match (start, motion) {
            (Some(start), None) => {
                let start = start?;
                if kind == Some(CoordinateKind::Distance) {
                    self.check_positive(&start, "the `start` of a distance");
                }
                if kind == Some(CoordinateKind::Angle) {
                    self.warn_of_degrees(&start);
                }
                Some(DriverSource::Input {
                    start: start.value?,
                })
            }
            (None, Some(motion)) => Some(DriverSource::Motion(motion?)),
            (Some(_), Some(_)) => {
                self.error_with_help(
                    code::DRIVER_SOURCE,
                    fields.key_span("start")?,
                    format!("{} has both `start` and `motion`", fields.subject),
                    "leave `start` out for a prescribed motion, `motion` for an FMI input"
                        .to_owned(),
                );
                None
            }
            (None, None) => {
                self.error_with_help(
                    code::DRIVER_SOURCE,
                    fields.place.clone(),
                    format!("{} has neither `start` nor `motion`", fields.subject),
                    format!(
                        "`start = \"60*deg\"` makes it an FMI input, {MOTION_FORMS} prescribes it"
                    ),
                );
                None
            }
        }
    }

    pub(super) fn lower_measures(&mut self, entries: &[Entry<'a>]) -> Vec<Measure> {
        let measures = entries.iter();
        measures
            .filter_map(|entry| {
                let fields = self.entry_fields(*entry, "measure")?;
                let coordinate = self.coordinate(&fields, &MEASURE_KEYS);
                let description = self.description(&fields);
                Some(Measure {
                    name: entry.name().to_owned(),
                    description,
                    coordinate: coordinate?,
                })
            })
            .collect()
    }

    /// The table of a named entry of a section of `what`s.
    pub(super) fn entry_fields(&mut self, entry: Entry<'a>, what: &str) -> Option<Fields<'a>> {
        let subject = format!("{what} {}", quoted(entry.name()));
        self.fields(entry.key, entry.value, subject)
    }

    pub(super) fn required_quantity(
        &mut self,
        fields: &Fields<'a>,
        key: &str,
        form: &str,
    ) -> Option<Quantity> {
        let value = self.required(fields, key, form)?;
        self.quantity(value)
    }

    /// The coordinate that a table describes, besides which it may have the keys `further`.
    fn coordinate(&mut self, fields: &Fields<'a>, further: &[&str]) -> Option<Coordinate> {
        let mut legal = KEYS.to_vec();
        legal.extend(further);
        self.check_keys(fields, &legal);
        let kind = self
            .required(fields, "coordinate", "\"angle\"")
            .and_then(|value| {
                self.choice(value, &COORDINATES, code::UNKNOWN_COORDINATE, "coordinate")
            });
        let markers = self.marker_pair(fields);
        let axes = fields.get("axes").map(|value| self.marker(value));
        if let (Some(CoordinateKind::Angle | CoordinateKind::Distance), Some(span)) =
            (kind, fields.key_span("axes"))
        {
            self.error_with_help(
                code::UNKNOWN_KEY,
                span,
                format!(
                    "{} has `axes`, but is neither an `x` nor a `y`",
                    fields.subject
                ),
                "an angle or a distance is the same on any axes".to_owned(),
            );
        }
        let (from, to) = markers?;
        Some(Coordinate {
            kind: kind?,
            from,
            to,
            axes: axes.unwrap_or(Some(from))?,
        })
    }

    /// The two markers under `markers`, fixed on different bodies.
    pub(super) fn marker_pair(&mut self, fields: &Fields<'a>) -> Option<(MarkerId, MarkerId)> {
        let value = self.required(fields, "markers", MARKERS_FORM)?;
        let items = self.items_of(value, 2..=2, "an array of two markers")?;
        // Both are looked up, so that each says what is wrong with it.
        let markers: Vec<Option<MarkerId>> = items.iter().map(|item| self.marker(item)).collect();
        let &[Some(from), Some(to)] = markers.as_slice() else {
            return None;
        };
        let carrier = self.carriers[from.index()];
        if carrier == self.carriers[to.index()] {
            let name = quoted(self.carrier_name(carrier));
            self.error_with_help(
                code::SAME_BODY,
                value.span(),
                format!("both markers of {} are on {name}", fields.subject),
                "a coordinate is measured between two bodies, or ground and a body".to_owned(),
            );
            return None;
        }
        Some((from, to))
    }
}

//! Coordinates between two markers, and the constraints and measures made of them.

use crate::mechanism::diagnostic::code;
use crate::mechanism::{
    Constraint, Coordinate, CoordinateKind, FeatureRun, MarkerId, Measure, ShapeId,
};

use super::context::Context;
use super::kind::{Entry, Text, Word, word_here};
use super::number::{Limit, NUMBER, Quantity};
use super::reference::{MARKERS, MarkerName, MarkerPair, SHAPES, ShapePair};
use super::table::table;

table! {
    /// A coordinate between two markers.
    struct CoordinateKeys<'a> {
        /// Quantity measured from marker i to marker j.
        #[required("\"angle\"")]
        coordinate: CoordinateKind = COORDINATE,
        /// Markers i and j, on different bodies: j is measured as seen from i.
        #[required(MARKERS)]
        markers: [MarkerId; 2] = MarkerPair,
        /// Marker on whose axes x or y is measured; marker i if left out.
        axes: MarkerId = MarkerName,
    }

    /// The least distance of the outlines of two shapes.
    struct ClearanceKeys<'a> {
        /// Quantity measured: the clearance, negative as far as the shapes overlap with their radii.
        #[required("\"clearance\"")]
        coordinate: () = CLEARANCE,
        /// Two shapes on different bodies.
        #[required(SHAPES)]
        shapes: [ShapeId; 2] = ShapePair,
    }

    /// A coordinate held at a value.
    struct ConstraintKeys<'a> {
        /// Value at which the coordinate is held [m or rad].
        #[required("0")]
        value: Quantity = NUMBER,
        /// Description in one line.
        description: String = Text,
    }

    /// A coordinate that is an output, with its velocity and acceleration.
    struct MeasureKeys<'a> {
        /// Description in one line.
        description: String = Text,
    }
}

const COORDINATE: Word<CoordinateKind> = Word::new("coordinate", code::UNKNOWN_COORDINATE, || {
    let kinds = [
        CoordinateKind::Angle,
        CoordinateKind::X,
        CoordinateKind::Y,
        CoordinateKind::Distance,
    ];
    kinds.map(|kind| (kind.word(), kind)).into()
})
.with_synonyms(|text| match text.to_ascii_lowercase().as_str() {
    "rotation" | "phi" => Some(word_here("angle")),
    "length" => Some(word_here("distance")),
    "clearance" => Some("only a measure is a clearance: `[measures]`".to_owned()),
    _ => None,
});

const CLEARANCE: Word<()> = Word::new("coordinate", code::UNKNOWN_COORDINATE, || {
    vec![("clearance", ())]
});

impl<'a> Context<'a> {
    pub(super) fn constraint(&mut self, entry: Entry<'a>) -> Option<Constraint> {
        let (coordinate, keys) =
            self.entry::<(CoordinateKeys<'a>, ConstraintKeys<'a>)>(entry, "constraint")?;
        let coordinate = self.coordinate(coordinate)?;
        let value = keys.value.value?;
        self.check_coordinate_value(coordinate.kind, &value, "a distance");
        Some(Constraint {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            coordinate,
            value: value.expression,
        })
    }

    pub(super) fn measure(&mut self, entry: Entry<'a>) -> Option<Measure> {
        let table = entry.value.get_ref().as_table();
        let kind = table.and_then(|table| table.get("coordinate"));
        let is_clearance = kind.and_then(|kind| kind.get_ref().as_str()) == Some("clearance");
        let (coordinate, keys) = if is_clearance {
            let (own, keys) =
                self.entry::<(ClearanceKeys<'a>, MeasureKeys<'a>)>(entry, "measure")?;
            own.coordinate.value?;
            (self.clearance(own.shapes.value?), keys)
        } else {
            let (own, keys) =
                self.entry::<(CoordinateKeys<'a>, MeasureKeys<'a>)>(entry, "measure")?;
            (self.coordinate(own), keys)
        };
        Some(Measure {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            coordinate: coordinate?,
        })
    }

    /// Returns the clearance of two shapes, `None` if one of them could not be read.
    pub(super) fn clearance(&self, shapes: [ShapeId; 2]) -> Option<Coordinate> {
        let [from, to] = shapes.map(|shape| self.shapes[shape.index()].marker);
        Some(Coordinate {
            kind: CoordinateKind::Clearance(shapes, [FeatureRun::WHOLE; 2]),
            from: from?,
            to: to?,
            axes: from?,
        })
    }

    pub(super) fn coordinate(&mut self, keys: CoordinateKeys<'a>) -> Option<Coordinate> {
        let kind = keys.coordinate.value;
        let has_axes = kind.is_none_or(CoordinateKind::has_axes);
        if let Some(span) = keys.axes.key.clone().filter(|_| !has_axes) {
            let subject = keys.owner.subject;
            let message = format!("{subject} has `axes`, but is neither an `x` nor a `y`");
            self.error(code::UNKNOWN_KEY, span, message)
                .suggest("an angle or a distance is the same on any axes");
        }
        let [from, to] = keys.markers.value?;
        Some(Coordinate {
            kind: kind?,
            from,
            to,
            axes: keys.axes.or(from)?,
        })
    }

    /// Reports a distance that is not positive, and warns of a value that looks like one in
    /// another unit.
    pub(super) fn check_coordinate_value(
        &mut self,
        kind: CoordinateKind,
        value: &Quantity,
        subject: &str,
    ) {
        self.warn_of_unit(value, kind.unit());
        if kind == CoordinateKind::Distance {
            self.check_limit(Limit::Positive, value, subject);
        }
    }
}

//! Ground, the moving bodies and their markers.

use std::marker::PhantomData;

use crate::mechanism::diagnostic::code;
use crate::mechanism::names::NameTable;
use crate::mechanism::wording::quoted;
use crate::mechanism::{Body, BodyId, Expression, Marker, MarkerId, Shape, Unit};

use super::context::{BODY_QUANTITIES, Context};
use super::kind::{Array, Entry, Fields, Item, Kind, Named, Text, schema};
use super::kind::{Described, NAME};
use super::number::{ANGLE, LENGTH, NUMBER, Number, POINT, Quantity};
use super::shape::{AnyShape, DENSITY, THICKNESS};
use super::table::{Field, Keys, table};

table! {
    /// The body that never moves; its frame is the global one.
    struct GroundKeys<'a> {
        /// Frames fixed on ground.
        markers: Vec<NamedFrame<'a>> = Frames,
        /// Outlines of ground.
        shapes: Vec<Entry<'a>> = Named(PhantomData::<AnyShape>),
    }

    /// A rigid body that moves.
    struct BodyKeys<'a> {
        /// Frames fixed on the body.
        markers: Vec<NamedFrame<'a>> = Frames,
        /// Start of the search for the assembled pose [m, m, rad]; zeros if left out.
        estimate: [Quantity; 3] = Array::new("[x, y, phi]", [LENGTH, LENGTH, ANGLE]),
        /// Mass.
        mass: Quantity = NUMBER.in_unit(Unit::KILOGRAM).positive(),
        /// Moment of inertia about the centre of mass.
        inertia: Quantity = NUMBER.in_unit(Unit::KILOGRAM_METRE_SQUARED).not_negative(),
        /// Centre of mass in the body's frame.
        center: [Quantity; 2] = POINT,
        /// Outlines of the body.
        shapes: Vec<Entry<'a>> = Named(PhantomData::<AnyShape>),
        /// Thickness of its shapes.
        thickness: Quantity = THICKNESS,
        /// Density of its shapes [kg/m3], which gives them mass.
        density: Quantity = DENSITY,
        /// Description in one line.
        description: String = Text,
    }
}

table! {
    /// A point of a body in polar coordinates; the axes are parallel to those of the body.
    struct PolarKeys<'a> {
        /// Distance from the body's origin.
        #[required("0.1")]
        r: Quantity = LENGTH,
        /// Direction from the body's origin, counter-clockwise from the body's x-axis.
        #[required("\"90*deg\"")]
        angle: Quantity = ANGLE,
    }
}

/// x, y \[m\] and angle \[rad\] of a marker in the frame of its body.
type Frame = [Expression; 3];

/// A marker's name, and its frame, `None` if it is wrong.
type NamedFrame<'a> = (Entry<'a>, Option<Frame>);

/// Markers by their names.
struct Frames;

impl Frames {
    const SHORT: Array<Number, 2> = Array::new(
        "[x, y]` or `[x, y, angle]`, or a table `{ r, angle }",
        [LENGTH; 2],
    );
    const LONG: Array<Number, 3> = Array::new("[x, y, angle]", [LENGTH, LENGTH, ANGLE]);
}

impl<'a> Kind<'a> for Frames {
    type Value = Vec<NamedFrame<'a>>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Self::Value> {
        if !item.value.get_ref().is_table() {
            context
                .wrong_type(item.value, "a table of markers with their names")
                .suggest("write for example `markers = { A = [0, 0], B = [0.1, 0] }`");
            return None;
        }
        let entries = context.entries(item)?.into_iter();
        let mut frame = |entry: Entry<'a>| {
            let marker = Item {
                key: entry.key,
                value: entry.value,
                ..*item
            };
            if entry.value.get_ref().is_table() {
                return context.polar_frame(entry);
            }
            let length = entry
                .value
                .get_ref()
                .as_array()
                .map_or(0, |items| items.len());
            if length == 3 {
                let frame = Self::LONG.read(context, &marker)?;
                context.warn_of_decimal_comma(entry.value.span());
                return Some(frame.map(|q| q.expression));
            }
            let [x, y] = Self::SHORT.read(context, &marker)?.map(|q| q.expression);
            Some([x, y, Expression::constant(0.0)])
        };
        Some(entries.map(|entry| (entry, frame(entry))).collect())
    }

    schema! {
        {
            "type": "object",
            "propertyNames": { "pattern": NAME, "not": { "enum": BODY_QUANTITIES } },
            "additionalProperties": {
                "description": "[x, y], [x, y, angle] or { r, angle } in the body's frame [m, rad].",
                "anyOf": [Self::SHORT.schema(), Self::LONG.schema(), PolarKeys::schema()],
            },
        }
    }
}

impl<'a> Context<'a> {
    /// Reads ground and the bodies; declares their markers, those of ground first.
    pub(super) fn bodies(
        &mut self,
        ground: &Field<Fields<'a>>,
        entries: &Field<Vec<Entry<'a>>>,
    ) -> (Vec<Body>, Vec<Marker>, Vec<Shape>) {
        // A value that is no table has been reported.
        let readable = entries.key.is_none() || entries.value.is_some();
        if readable && entries.items().is_empty() {
            let place = entries.key.clone().unwrap_or(0..0);
            self.error(code::NO_BODIES, place, "the mechanism has no bodies")
                .suggest("add one: `[bodies.crank]`");
        }
        let mut markers = Vec::new();
        let mut shapes = Vec::new();
        let mut keys = (ground.value.as_ref()).map(|fields| self.table::<GroundKeys<'a>>(fields));
        let ground = match &mut keys {
            Some(keys) => frames::<GroundKeys<'a>>(&keys.owner, &mut keys.markers),
            None => ground.key.is_none().then(Vec::new),
        };
        self.declare_markers(None, ground, &mut markers);
        match &keys {
            Some(keys) => self.read_shapes(None, &keys.shapes, &[None, None], &mut shapes),
            None => self.shape_names.push(None),
        }
        let mut bodies = Vec::new();
        for (index, entry) in entries.items().iter().enumerate() {
            let first = self.carriers.len();
            let mut keys = self.entry::<BodyKeys<'a>>(*entry, "body");
            let frames = (keys.as_mut())
                .and_then(|keys| frames::<BodyKeys<'a>>(&keys.owner, &mut keys.markers));
            self.declare_markers(Some(BodyId(index)), frames, &mut markers);
            let ids = (first..self.carriers.len()).map(MarkerId).collect();
            match keys {
                Some(keys) => bodies.push(self.body(*entry, keys, ids, &mut shapes)),
                None => self.shape_names.push(None),
            }
        }
        (bodies, markers, shapes)
    }

    /// Reads a marker given by polar coordinates.
    fn polar_frame(&mut self, entry: Entry<'a>) -> Option<Frame> {
        let keys = self.entry::<PolarKeys<'a>>(entry, "marker")?;
        let (r, angle) = (keys.r.expression()?, keys.angle.expression()?);
        let Some([x, y]) = Expression::from_polar(&r, &angle) else {
            let message = "the expressions are nested too deeply";
            self.error(code::BAD_EXPRESSION, entry.value.span(), message)
                .suggest("give a part of them a name: a parameter of its own");
            return None;
        };
        Some([x, y, Expression::constant(0.0)])
    }

    fn body(
        &mut self,
        entry: Entry<'a>,
        keys: BodyKeys<'a>,
        markers: Vec<MarkerId>,
        shapes: &mut Vec<Shape>,
    ) -> Body {
        let id = BodyId(self.shape_names.len() - 1);
        let expression =
            |field: &Field<Quantity>| field.value.as_ref().map(|size| size.expression.clone());
        let plate = [&keys.thickness, &keys.density].map(expression);
        let first = shapes.len();
        self.read_shapes(Some(id), &keys.shapes, &plate, shapes);
        let is_weighed = shapes[first..].iter().any(|shape| shape.weight.is_some());
        self.check_weight(&keys, is_weighed);
        let of_mass = [("inertia", &keys.inertia.key), ("center", &keys.center.key)];
        for (name, key) in of_mass {
            if let (None, Some(span), false) = (&keys.mass.key, key, is_weighed) {
                let subject = &keys.owner.subject;
                let message = format!("`{name}` of {subject} has no effect without `mass`");
                self.warn(code::MISSING_MASS, span.clone(), message);
            }
        }
        let estimate = keys.estimate.expressions();
        Body {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            markers,
            estimate: estimate.unwrap_or_else(|| [0.0; 3].map(Expression::constant)),
            mass: keys.mass.expression(),
            inertia: keys.inertia.expression(),
            center: keys.center.expressions(),
            is_weighed,
        }
    }

    /// Reports masses that are given twice, and plates without an outline.
    fn check_weight(&mut self, keys: &BodyKeys<'a>, is_weighed: bool) {
        let subject = &keys.owner.subject;
        let given = [
            ("mass", &keys.mass.key),
            ("inertia", &keys.inertia.key),
            ("center", &keys.center.key),
        ];
        for (name, key) in given {
            if let (Some(span), true) = (key, is_weighed) {
                let message = format!("{subject} has both `{name}` and shapes with a `density`");
                self.error(code::ILLEGAL_VALUE, span.clone(), message)
                    .suggest("leave out one: mass, center and inertia follow from the shapes");
            }
        }
        let plate = [
            ("thickness", &keys.thickness.key),
            ("density", &keys.density.key),
        ];
        for (name, key) in plate {
            if let (Some(span), true) = (key, keys.shapes.items().is_empty()) {
                let message = format!("`{name}` of {subject} has no effect without `shapes`");
                self.warn(code::MISSING_MASS, span.clone(), message);
            }
        }
    }

    /// Declares the markers of a body, of ground if it is `None`; those that cannot be read are
    /// no reason for further errors.
    fn declare_markers(
        &mut self,
        carrier: Option<BodyId>,
        frames: Option<Vec<NamedFrame<'a>>>,
        markers: &mut Vec<Marker>,
    ) {
        let mut table = frames.is_some().then(NameTable::new);
        for (entry, frame) in frames.unwrap_or_default() {
            let name = entry.name();
            self.check_name(entry, "marker");
            if BODY_QUANTITIES.contains(&name) {
                let message = format!("{} is a quantity of the body itself", quoted(name));
                self.error(code::RESERVED_NAME, entry.key.span(), message);
            }
            let marker = MarkerId(self.carriers.len());
            if let Some(table) = &mut table {
                table.insert(name, marker);
            }
            let owner = self.carrier_name(carrier);
            self.owners.entry(name).or_insert(owner);
            self.carriers.push(carrier);
            markers.extend(frame.map(|[x, y, angle]| Marker {
                name: name.to_owned(),
                body: carrier,
                position: [x, y],
                angle,
            }));
        }
        self.markers.push(table);
    }
}

/// Takes the markers of a body or of ground, none if they are left out. Returns `None` if they
/// cannot be read, or may stand under an unknown key.
fn frames<'a, K: Keys<'a>>(
    owner: &Fields<'a>,
    markers: &mut Field<Vec<NamedFrame<'a>>>,
) -> Option<Vec<NamedFrame<'a>>> {
    let is_known = |name: &str| K::keys().iter().any(|key| key.name == name);
    let is_complete =
        markers.key.is_none() && owner.table.keys().all(|key| is_known(key.get_ref()));
    let frames = markers.value.take();
    frames.or_else(|| is_complete.then(Vec::new))
}

//! Shapes of bodies and of ground.

use crate::mechanism::diagnostic::code;
use crate::mechanism::names::NameTable;
use crate::mechanism::shape::MOST_CORNERS;
use crate::mechanism::wording::quoted;
use crate::mechanism::{
    BodyId, Diagnostic, Expression, MarkerId, Mechanism, OutlineCorner, Shape, ShapeFault,
    ShapeForm, ShapeId, Span,
};

use super::context::{BODY_QUANTITIES, Context, KnownShape};
use super::kind::{AnyOf, Described, Entry, Fields, Item, Kind, NAME, Text, schema};
use super::number::{LENGTH, NUMBER, Number, Quantity, RATIO};
use super::table::{Field, table};

table! {
    /// All points at most a radius from a marker.
    struct DiscKeys<'a> {
        /// Marker of the body at the centre.
        #[required("\"A\"")]
        disc: (&'a str, Span) = OwnMarker,
        /// Radius.
        #[required("\"10*mm\"")]
        radius: Quantity = LENGTH.positive(),
    }

    /// All points at most a radius from the polyline through markers.
    struct BarKeys<'a> {
        /// Markers of the body in order, two or more.
        #[required("[\"A\", \"B\"]")]
        bar: Vec<(&'a str, Span)> = OwnMarkers,
        /// Radius.
        #[required("\"10*mm\"")]
        radius: Quantity = LENGTH.positive(),
    }

    /// A polygon of lines and arcs.
    struct OutlineKeys<'a> {
        /// Markers of the body at the corners, in either order.
        #[required("[\"A\", \"B\", \"C\"]")]
        outline: Vec<(&'a str, Span, Option<Quantity>)> = Corners,
        /// Width of a round rim by which it grows; zero if left out.
        radius: Quantity = LENGTH.not_negative(),
        /// Radius that rounds its convex corners from inside; zero if left out.
        fillet: Quantity = LENGTH.not_negative(),
    }

    /// A round hole in those shapes of the body in which its centre lies.
    struct HoleKeys<'a> {
        /// Marker of the body at the centre.
        #[required("\"A\"")]
        hole: (&'a str, Span) = OwnMarker,
        /// Radius.
        #[required("\"10*mm\"")]
        radius: Quantity = LENGTH.positive(),
        /// Description in one line.
        description: String = Text,
    }

    /// An open surface, with free space on the right of the way through its markers.
    struct WallKeys<'a> {
        /// Markers of the body in order, two or more.
        #[required("[\"A\", \"B\"]")]
        wall: Vec<(&'a str, Span)> = OwnMarkers,
        /// Depth of the solid behind the surface, and fillet of its convex corners and ends.
        #[required("\"10*mm\"")]
        depth: Quantity = LENGTH.positive(),
        /// Description in one line.
        description: String = Text,
    }

    /// Thickness and density of a shape.
    struct PlateKeys<'a> {
        /// Thickness; that of the body if left out.
        thickness: Quantity = LENGTH.positive(),
        /// Density [kg/m3]; that of the body if left out. With it the shape has a mass.
        density: Quantity = NUMBER.positive(),
        /// Description in one line.
        description: String = Text,
    }

    /// A corner of an outline, with an arc to the next one.
    struct CornerKeys<'a> {
        /// Marker of the body.
        #[required("\"A\"")]
        marker: (&'a str, Span) = OwnMarker,
        /// Tangent of a quarter of the arc's angle, positive counter-clockwise, as in DXF.
        #[required("0.5")]
        bulge: Quantity = RATIO,
    }
}

/// A shape of any form.
pub(super) type AnyShape = AnyOf<
    (DiscKeys<'static>, PlateKeys<'static>),
    AnyOf<
        (BarKeys<'static>, PlateKeys<'static>),
        AnyOf<
            (OutlineKeys<'static>, PlateKeys<'static>),
            AnyOf<HoleKeys<'static>, WallKeys<'static>>,
        >,
    >,
>;

/// Words of the forms.
const FORMS: [&str; 5] = ["disc", "bar", "outline", "hole", "wall"];

/// Name of a marker of the body itself.
struct OwnMarker;

impl<'a> Kind<'a> for OwnMarker {
    type Value = (&'a str, Span);

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Self::Value> {
        Some((context.text(item.value)?, item.span()))
    }

    schema! {{ "type": "string", "pattern": NAME }}
}

/// Names of two or more markers of the body itself.
struct OwnMarkers;

impl<'a> Kind<'a> for OwnMarkers {
    type Value = Vec<(&'a str, Span)>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Self::Value> {
        let items = context.items(item.value, "an array of markers")?;
        context.check_count(items.len(), 2, item)?;
        let markers = items
            .iter()
            .map(|value| OwnMarker.read(context, &item.with(value)));
        // Each is read, so that each wrong one is reported.
        let markers: Vec<_> = markers.collect();
        markers.into_iter().collect()
    }

    schema! {{ "type": "array", "minItems": 2, "maxItems": MOST_CORNERS, "items": OwnMarker.schema() }}
}

/// Corners of an outline: markers of the body itself, with arcs.
struct Corners;

impl<'a> Kind<'a> for Corners {
    type Value = Vec<(&'a str, Span, Option<Quantity>)>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Self::Value> {
        let items = context.items(item.value, "an array of markers")?;
        let has_arc = items.iter().any(|value| value.get_ref().is_table());
        context.check_count(items.len(), if has_arc { 2 } else { 3 }, item)?;
        let mut corner = |value| {
            let item = item.with(value);
            if !item.value.get_ref().is_table() {
                let (name, span) = OwnMarker.read(context, &item)?;
                return Some((name, span, None));
            }
            let subject = format!("a corner of {}", item.fields.subject);
            let fields = context.fields(item.span(), item.value, subject)?;
            let keys = context.table::<CornerKeys<'a>>(&fields);
            let ((name, span), bulge) = (keys.marker.value?, keys.bulge.value?);
            Some((name, span, Some(bulge)))
        };
        let corners: Vec<_> = items.iter().map(&mut corner).collect();
        corners.into_iter().collect()
    }

    schema! {
        {
            "type": "array",
            "minItems": 2,
            "maxItems": MOST_CORNERS,
            "items": { "anyOf": [OwnMarker.schema(), CornerKeys::schema()] },
        }
    }
}

/// Thickness [m] of plates.
pub(super) const THICKNESS: Number = LENGTH.positive();
/// Density [kg/m³] of plates.
pub(super) const DENSITY: Number = NUMBER.positive();

/// Thickness and density that a body gives its shapes.
pub(super) type Plate = [Option<Expression>; 2];

impl<'a> Context<'a> {
    /// Reports an array of markers with too few or too many of them.
    fn check_count(&mut self, count: usize, least: usize, item: &Item<'_, 'a>) -> Option<()> {
        if (least..=MOST_CORNERS).contains(&count) {
            return Some(());
        }
        let (subject, word) = (&item.fields.subject, item.key.get_ref());
        let message = if count < least {
            format!("too few markers in `{word}` of {subject}: {count}, at least {least}")
        } else {
            format!("too many markers in `{word}` of {subject}: {count}, at most {MOST_CORNERS}")
        };
        self.error(code::SHAPE, item.span(), message);
        None
    }

    /// Reads the shapes of a body, of ground if it is `None`, after its markers. `owner` is its name as the
    /// subject of sentences.
    pub(super) fn read_shapes(
        &mut self,
        carrier: Option<BodyId>,
        entries: &Field<Vec<Entry<'a>>>,
        plate: &Plate,
        shapes: &mut Vec<Shape>,
    ) {
        let owner = self.carrier_name(carrier);
        let table = carrier.map_or(0, |body| body.index() + 1);
        let mut known = NameTable::new();
        for entry in entries.items() {
            let name = entry.name();
            self.check_name(*entry, "shape");
            let of = quoted(owner);
            let message = if BODY_QUANTITIES.contains(&name) {
                Some(format!("{} is a quantity of the body itself", quoted(name)))
            } else if self.markers[table]
                .as_ref()
                .is_some_and(|known| known.get(name).is_some())
            {
                Some(format!(
                    "the shape {} has the name of a marker of {of}",
                    quoted(name)
                ))
            } else {
                None
            };
            if let Some(message) = message {
                self.error(code::DUPLICATE_NAME, entry.key.span(), message)
                    .suggest("shapes and markers of a body share one name space");
            }
            known.insert(name, ShapeId(shapes.len()));
            let read = self.shape(*entry, carrier, plate);
            self.shapes.push(KnownShape {
                place: entry.key.span(),
                carrier,
                marker: read.as_ref().and_then(|shape| shape.markers().next()),
                is_round: read.as_ref().is_none_or(Shape::is_round),
            });
            // A shape that cannot be read keeps its place, so that names find it.
            shapes.push(read.unwrap_or_else(|| Shape {
                name: name.to_owned(),
                description: String::new(),
                body: carrier,
                form: ShapeForm::Bar {
                    markers: Vec::new(),
                    radius: Expression::constant(0.0),
                },
                weight: None,
            }));
        }
        // Shapes that cannot be read have been reported.
        let is_readable = entries.key.is_none() || entries.value.is_some();
        self.shape_names.push(is_readable.then_some(known));
    }

    fn shape(&mut self, entry: Entry<'a>, carrier: Option<BodyId>, plate: &Plate) -> Option<Shape> {
        let of = self.carrier_name(carrier);
        let mut fields = self.entry_fields(entry, "shape")?;
        fields.subject = format!("shape `{of}.{}`", entry.name());
        let forms = FORMS
            .into_iter()
            .filter(|form| fields.table.contains_key(*form));
        let forms: Vec<&str> = forms.collect();
        let form = match forms[..] {
            [form] => form,
            [] => {
                let message = format!("{} has none of `{}`", fields.subject, FORMS.join("`, `"));
                self.error(code::SHAPE, fields.place.clone(), message)
                    .suggest("for example `bar = [\"A\", \"B\"], radius = \"5*mm\"`");
                return None;
            }
            [first, second, ..] => {
                let message = format!("{} is both a `{first}` and a `{second}`", fields.subject);
                self.error(code::SHAPE, fields.place.clone(), message)
                    .suggest("give each its own name: shapes of a body add up");
                return None;
            }
        };
        let (form, description, weight) = match form {
            "disc" => {
                let (own, rest) = self.table::<(DiscKeys<'a>, PlateKeys<'a>)>(&fields);
                let marker = self.own_marker(carrier, own.disc.value);
                let weight = self.weight(&fields, &rest, plate);
                let form = ShapeForm::Disc {
                    marker: marker?,
                    radius: own.radius.expression()?,
                };
                (form, rest.description, weight?)
            }
            "bar" => {
                let (own, rest) = self.table::<(BarKeys<'a>, PlateKeys<'a>)>(&fields);
                let markers = self.own_markers(carrier, own.bar.value);
                let weight = self.weight(&fields, &rest, plate);
                let form = ShapeForm::Bar {
                    markers: markers?,
                    radius: own.radius.expression()?,
                };
                (form, rest.description, weight?)
            }
            "outline" => {
                let (own, rest) = self.table::<(OutlineKeys<'a>, PlateKeys<'a>)>(&fields);
                let corners = own.outline.value?.into_iter();
                let corners = corners.map(|(name, span, bulge)| {
                    Some(OutlineCorner {
                        marker: self.own_marker(carrier, Some((name, span)))?,
                        bulge: bulge.map(|bulge| bulge.expression),
                    })
                });
                let corners: Vec<_> = corners.collect();
                let weight = self.weight(&fields, &rest, plate);
                let form = ShapeForm::Outline {
                    corners: corners.into_iter().collect::<Option<Vec<_>>>()?,
                    radius: own.radius.optional()?.map(|size| size.expression),
                    fillet: own.fillet.optional()?.map(|size| size.expression),
                };
                (form, rest.description, weight?)
            }
            "hole" => {
                let own = self.table::<HoleKeys<'a>>(&fields);
                let form = ShapeForm::Hole {
                    marker: self.own_marker(carrier, own.hole.value)?,
                    radius: own.radius.expression()?,
                };
                (form, own.description, None)
            }
            _ => {
                let own = self.table::<WallKeys<'a>>(&fields);
                let form = ShapeForm::Wall {
                    markers: self.own_markers(carrier, own.wall.value)?,
                    depth: own.depth.expression()?,
                };
                (form, own.description, None)
            }
        };
        Some(Shape {
            name: entry.name().to_owned(),
            description: description.value.unwrap_or_default(),
            body: carrier,
            form,
            weight: weight.filter(|_| carrier.is_some()),
        })
    }

    /// Returns thickness and density of a shape, its own or those of its body: `Some(None)` for a shape
    /// without density, `None` after an error.
    fn weight(
        &mut self,
        fields: &Fields<'a>,
        own: &PlateKeys<'a>,
        [thickness, density]: &Plate,
    ) -> Option<Option<[Expression; 2]>> {
        let of = |field: &Field<Quantity>, body: &Option<Expression>| match &field.key {
            Some(_) => Some(Some(field.value.as_ref()?.expression.clone())),
            None => Some(body.clone()),
        };
        let (thickness, density) = (of(&own.thickness, thickness)?, of(&own.density, density)?);
        match (thickness, density) {
            (_, None) => Some(None),
            (Some(thickness), Some(density)) => Some(Some([thickness, density])),
            (None, Some(_)) => {
                let message = format!("{} has a `density`, but no `thickness`", fields.subject);
                self.error(code::MISSING_KEY, fields.place.clone(), message)
                    .suggest("give it or its body a `thickness`, for example `\"10*mm\"`");
                None
            }
        }
    }

    fn own_markers(
        &mut self,
        carrier: Option<BodyId>,
        names: Option<Vec<(&'a str, Span)>>,
    ) -> Option<Vec<MarkerId>> {
        let markers = names?
            .into_iter()
            .map(|name| self.own_marker(carrier, Some(name)));
        let markers: Vec<_> = markers.collect();
        markers.into_iter().collect()
    }

    /// Returns the marker of this name on the body itself.
    fn own_marker(
        &mut self,
        carrier: Option<BodyId>,
        name: Option<(&'a str, Span)>,
    ) -> Option<MarkerId> {
        let (name, span) = name?;
        let table = carrier.map_or(0, |body| body.index() + 1);
        // Markers that cannot be read have been reported.
        let known = self.markers[table].as_ref()?;
        let marker = known.get(name);
        if marker.is_none() {
            let owner = quoted(self.carrier_name(carrier));
            let help = match name.split_once('.') {
                Some((_, own)) if known.get(own).is_some() => {
                    Some(format!("a shape takes markers of its own body: `{own}`"))
                }
                _ => known.help(name),
            };
            let message = format!("no marker {} on {owner}", quoted(name));
            self.error(code::UNKNOWN_MARKER, span, message).help = help;
        }
        marker
    }

    /// Reports a shape without a proper outline for the file's parameters.
    pub(super) fn check_shapes(&mut self, mechanism: &Mechanism) {
        if mechanism.shapes.is_empty() {
            return;
        }
        let parameters = mechanism.default_parameters();
        let fault = mechanism.shape_fault(&parameters);
        let fault = fault.or_else(|| mechanism.crossing_fault(&parameters));
        let Some(fault) = fault else { return };
        let own = (0..mechanism.shapes.len()).map(ShapeId);
        let place = own.zip(&self.shapes).find_map(|(id, known)| {
            (mechanism.shape_path(id) == fault.shape).then(|| known.place.clone())
        });
        let problem = Diagnostic::error(code::SHAPE, fault.to_string());
        let problem = match place {
            Some(span) => problem.label(span, ""),
            None => problem,
        };
        self.report(problem).help = help(&fault);
    }
}

/// Returns the correction of a shape without a proper outline.
fn help(fault: &ShapeFault) -> Option<String> {
    use crate::mechanism::ShapeFaultKind as Kind;
    let help = match fault.kind {
        Kind::Size | Kind::NoEdge => return None,
        Kind::Back => "give each corner its own place",
        Kind::Short => "use a smaller one, or move the corners apart",
        Kind::Crossing => "list the markers in order round the outline",
        Kind::HoleOutside => {
            "holes are round and lie within; a notch is a part of an `outline`, as an arc"
        }
    };
    Some(help.to_owned())
}

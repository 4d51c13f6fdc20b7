//! References to bodies and markers by their names.

use crate::mechanism::diagnostic::code;
use crate::mechanism::names;
use crate::mechanism::syntax;
use crate::mechanism::wording::quoted;
use crate::mechanism::{BodyId, MarkerId, ShapeId, Span};

use super::context::{Context, GROUND};
use super::kind::NAME;
use super::kind::{Array, Item, Kind, schema, word_here};

/// Example of `markers`, for help where they are missing.
pub(super) const MARKERS: &str = "[\"ground.O\", \"crank.O\"]";

/// Marker, written `body.marker`.
pub(super) struct MarkerName;

impl<'a> Kind<'a> for MarkerName {
    type Value = MarkerId;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<MarkerId> {
        let text = context.text(item.value)?;
        let Some((body_name, marker_name)) = text.split_once('.') else {
            let help = match context.owners.get(text) {
                Some(owner) => format!("did you mean `{owner}.{text}`?"),
                None => "a marker is written `body.marker`".to_owned(),
            };
            let message = format!("no marker {}", quoted(text));
            context
                .error(code::UNKNOWN_MARKER, item.span(), message)
                .suggest(help);
            return None;
        };
        let part = |part| syntax::part_span(context.source, item.span(), text, part);
        let body_span = part(0..body_name.len());
        let marker_span = part(body_name.len() + 1..text.len());
        let table = if body_name == GROUND {
            0
        } else {
            context.body_at(body_name, body_span, &[GROUND])?.index() + 1
        };
        // Markers that cannot be read have been reported.
        let table = context.markers[table].as_ref()?;
        let marker = table.get(marker_name);
        if marker.is_none() {
            let message = format!("no marker {} on {}", quoted(marker_name), quoted(body_name));
            let help = table.help(marker_name);
            context
                .error(code::UNKNOWN_MARKER, marker_span, message)
                .help = help;
        }
        marker
    }

    schema! {{ "$ref": "#/$defs/marker" }}
}

/// Markers i and j, fixed on different bodies.
pub(super) struct MarkerPair;

impl MarkerPair {
    const ARRAY: Array<MarkerName, 2> = Array::new(MARKERS, [MarkerName, MarkerName]);
}

impl<'a> Kind<'a> for MarkerPair {
    type Value = [MarkerId; 2];

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<[MarkerId; 2]> {
        let markers = Self::ARRAY.read(context, item)?;
        let [carrier, other] = markers.map(|marker| context.carriers[marker.index()]);
        if carrier == other {
            let (subject, body) = (&item.fields.subject, quoted(context.carrier_name(carrier)));
            let message = format!("both markers of {subject} are on {body}");
            context
                .error(code::SAME_BODY, item.span(), message)
                .suggest("the two are on different bodies, of which one may be `ground`");
            return None;
        }
        Some(markers)
    }

    schema! { Self::ARRAY.schema() }
}

/// Example of `shapes`, for help where they are missing.
pub(super) const SHAPES: &str = "[\"pawl.nose\", \"wheel.rim\"]";

/// Shape, written `body.shape`.
pub(super) struct ShapeName;

impl<'a> Kind<'a> for ShapeName {
    type Value = ShapeId;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<ShapeId> {
        let text = context.text(item.value)?;
        let Some((body_name, shape_name)) = text.split_once('.') else {
            let message = format!("no shape {}", quoted(text));
            context
                .error(code::SHAPE, item.span(), message)
                .suggest("a shape is written `body.shape`");
            return None;
        };
        let part = |part| syntax::part_span(context.source, item.span(), text, part);
        let body_span = part(0..body_name.len());
        let shape_span = part(body_name.len() + 1..text.len());
        let table = if body_name == GROUND {
            0
        } else {
            context.body_at(body_name, body_span, &[GROUND])?.index() + 1
        };
        // Shapes that cannot be read have been reported.
        let table = context.shape_names[table].as_ref()?;
        let shape = table.get(shape_name);
        if shape.is_none() {
            let message = format!("no shape {} on {}", quoted(shape_name), quoted(body_name));
            let help = table.help(shape_name);
            context.error(code::SHAPE, shape_span, message).help = help;
        }
        shape
    }

    schema! {{ "$ref": "#/$defs/marker" }}
}

/// Shapes of two different bodies.
pub(super) struct ShapePair;

impl ShapePair {
    const ARRAY: Array<ShapeName, 2> = Array::new(SHAPES, [ShapeName, ShapeName]);
}

impl<'a> Kind<'a> for ShapePair {
    type Value = [ShapeId; 2];

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<[ShapeId; 2]> {
        let shapes = Self::ARRAY.read(context, item)?;
        let [carrier, other] = shapes.map(|shape| context.shapes[shape.index()].carrier);
        if carrier == other {
            let (subject, body) = (&item.fields.subject, quoted(context.carrier_name(carrier)));
            let message = format!("both shapes of {subject} are on {body}");
            context
                .error(code::SAME_BODY, item.span(), message)
                .suggest("the two are on different bodies, of which one may be `ground`");
            return None;
        }
        Some(shapes)
    }

    schema! { Self::ARRAY.schema() }
}

/// Moving body.
pub(super) struct BodyName;

impl<'a> Kind<'a> for BodyName {
    type Value = BodyId;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<BodyId> {
        let name = context.text(item.value)?;
        let span = syntax::part_span(context.source, item.span(), name, 0..name.len());
        if name == GROUND {
            context.error(code::UNKNOWN_BODY, span, "`ground` is no moving body");
            return None;
        }
        context.body_at(name, span, &[])
    }

    schema! {{ "type": "string", "pattern": NAME }}
}

/// Moving body or ground, which is `None`.
pub(super) struct CarrierName;

impl<'a> Kind<'a> for CarrierName {
    type Value = Option<BodyId>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Option<BodyId>> {
        if item.value.get_ref().as_str() == Some(GROUND) {
            return Some(None);
        }
        BodyName.read(context, item).map(Some)
    }

    schema! { BodyName.schema() }
}

/// Joint or constraint, by its place among the joints and then the constraints.
pub(super) struct HolderName;

impl<'a> Kind<'a> for HolderName {
    type Value = usize;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<usize> {
        let name = context.text(item.value)?;
        let place = context.holders.get(name);
        if place.is_none() {
            let message = format!("no joint or constraint {}", quoted(name));
            let help = context.holders.help(name);
            context
                .error(code::UNKNOWN_REACTION, item.span(), message)
                .help = help;
        }
        place
    }

    schema! {{ "type": "string", "pattern": NAME }}
}

impl Context<'_> {
    /// Returns the moving body called `name`; the names `further` would be right too.
    fn body_at(&mut self, name: &str, span: Span, further: &[&str]) -> Option<BodyId> {
        let body = self.bodies.get(name);
        if body.is_none() {
            let help = match name.to_ascii_lowercase().as_str() {
                "frame" | "world" | "base" | "fixed" if further.contains(&GROUND) => {
                    Some(word_here(GROUND))
                }
                _ => (self.bodies.candidates())
                    .and_then(|known| names::help(name, &[known, further.to_vec()].concat(), &[])),
            };
            let message = format!("no body {}", quoted(name));
            self.error(code::UNKNOWN_BODY, span, message).help = help;
        }
        body
    }
}

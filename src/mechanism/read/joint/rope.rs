//! `rope`: a rope over points and pulleys.

use std::collections::HashSet;

use crate::mechanism::diagnostic::code;
use crate::mechanism::read::context::Context;
use crate::mechanism::read::kind::Described;
use crate::mechanism::read::kind::{Flag, Item, Kind, Word, schema};
use crate::mechanism::read::number::{LENGTH, Number, Quantity, RATIO};
use crate::mechanism::read::reference::MarkerName;
use crate::mechanism::read::table::{Field, table};
use crate::mechanism::wording::quoted;
use crate::mechanism::{
    Expression, JointKind, MOST_BODIES, MarkerId, Pulley, PulleySide, Rope, RopePoint,
};

use super::joint_type;

joint_type! {
    own markers;
    "rope" or "cable" or "string" or "cord"
        or "pulley" as "type = \"rope\", markers = [\"ground.A\", { marker = \"block.P\", radius = 0.05, side = \"left\" }, \"ground.B\"], length = 1.5"
        or "tackle" as "type = \"rope\", markers = [\"ground.A\", \"block.P\"], parts = [4], length = 1.5"
        => |keys, context| context.rope(keys);

    /// A rope that keeps its length, over points and pulleys.
    struct RopeKeys<'a> {
        /// Two markers or more from the first to the last; a pulley is a table with marker, radius
        /// and side.
        #[required("[\"ground.A\", \"block.P\"]")]
        markers: Vec<RopePoint> = RopePoints,
        /// Sum of the lengths from marker to marker, each times its number of parts.
        #[required("1.5")]
        length: Quantity = LENGTH.positive(),
        /// Number of parts of the rope from each marker to the next; 1 each if left out.
        parts: Vec<Quantity> = Parts,
        /// Whether the rope goes slack in free motion, where it would have to push.
        unilateral: bool = Flag,
        /// Part of the velocity with which it bounces as it pulls taut, from 0 to 1; zero if left out.
        restitution: Quantity = RATIO,
    }
}

table! {
    /// A pulley of a rope.
    struct PulleyKeys<'a> {
        /// Marker at the centre.
        #[required("\"ground.A\"")]
        marker: MarkerId = MarkerName,
        /// Radius of the rope's arc.
        #[required("0.05")]
        radius: Quantity = LENGTH.positive(),
        /// Side of the rope on which the pulley is, seen from the first marker to the last.
        #[required("\"left\"")]
        side: PulleySide = SIDE,
    }
}

const SIDE: Word<PulleySide> = Word::new("side of a pulley", code::ILLEGAL_VALUE, || {
    vec![("left", PulleySide::Left), ("right", PulleySide::Right)]
});

/// Markers and pulleys that a rope runs over.
struct RopePoints;

impl<'a> Kind<'a> for RopePoints {
    type Value = Vec<RopePoint>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Vec<RopePoint>> {
        let items = context.items(item.value, "an array of markers and pulleys")?;
        if items.len() < 2 {
            context.wrong_type(item.value, "an array of two markers or more");
            return None;
        }
        let mut read = |item: Item<'_, 'a>| {
            if !item.value.get_ref().is_table() {
                return Some(RopePoint {
                    marker: MarkerName.read(context, &item)?,
                    pulley: None,
                });
            }
            let fields = context.fields(item.span(), item.value, "the pulley".to_owned())?;
            let keys = context.table::<PulleyKeys<'a>>(&fields);
            let (radius, side) = (keys.radius.expression(), keys.side.value);
            Some(RopePoint {
                marker: keys.marker.value?,
                pulley: Some(Pulley {
                    radius: radius?,
                    side: side?,
                }),
            })
        };
        // Each is read, so that each wrong one is reported.
        let points: Vec<_> = items.iter().map(|value| read(item.with(value))).collect();
        let points: Vec<RopePoint> = points.into_iter().collect::<Option<_>>()?;
        for (pair, value) in points.windows(2).zip(&items[1..]) {
            if pair[0].marker == pair[1].marker {
                let message = "a rope needs different markers one after the other";
                context.error(code::SAME_BODY, value.span(), message);
                return None;
            }
        }
        for (point, value) in [
            (&points[0], &items[0]),
            (&points[items.len() - 1], &items[items.len() - 1]),
        ] {
            if point.pulley.is_some() {
                let message = "a rope ends at a marker, not on a pulley";
                context
                    .error(code::ILLEGAL_VALUE, value.span(), message)
                    .suggest("give the marker of the body that the rope is fixed to");
                return None;
            }
        }
        let carriers = points
            .iter()
            .map(|point| context.carriers[point.marker.index()]);
        let carriers: HashSet<_> = carriers.collect();
        if let (1, Some(carrier)) = (carriers.len(), carriers.iter().next()) {
            let (subject, body) = (&item.fields.subject, quoted(context.carrier_name(*carrier)));
            let message = format!("all markers of {subject} are on {body}");
            context.error(code::SAME_BODY, item.span(), message);
            return None;
        }
        if carriers.iter().flatten().count() > MOST_BODIES {
            let message = format!("a rope runs over {MOST_BODIES} moving bodies at most");
            context.error(code::ILLEGAL_VALUE, item.span(), message);
            return None;
        }
        Some(points)
    }

    schema! {
        {
            "type": "array",
            "items": { "anyOf": [MarkerName.schema(), PulleyKeys::schema()] },
            "minItems": 2,
        }
    }
}

/// Numbers of parts.
struct Parts;

impl Parts {
    const PART: Number = RATIO.positive();
}

impl<'a> Kind<'a> for Parts {
    type Value = Vec<Quantity>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Vec<Quantity>> {
        let items = context.items(item.value, "an array of numbers")?;
        // Each is read, so that each wrong one is reported.
        let parts: Vec<_> = items
            .iter()
            .map(|value| Self::PART.read(context, &item.with(value)))
            .collect();
        parts.into_iter().collect()
    }

    schema! {{ "type": "array", "items": Self::PART.schema() }}
}

impl<'a> Context<'a> {
    fn rope(&mut self, keys: RopeKeys<'a>) -> Option<(JointKind, [MarkerId; 2])> {
        let (points, length) = (keys.markers.value, keys.length.expression());
        let points = points?;
        let parts = self.parts(&points, keys.parts)?;
        let ends = [points[0].marker, points[points.len() - 1].marker];
        let rope = Rope {
            length: length?,
            points,
            parts,
            play: self.unilateral(keys.unilateral, keys.restitution, &keys.owner)?,
        };
        Some((JointKind::Rope(rope), ends))
    }

    /// Returns the number of parts of each leg, one for each pair of neighbours and equal on both
    /// sides of a pulley.
    fn parts(
        &mut self,
        points: &[RopePoint],
        parts: Field<Vec<Quantity>>,
    ) -> Option<Vec<Expression>> {
        let legs = points.len() - 1;
        let place = parts.span.clone();
        let Some(parts) = parts.optional()? else {
            return Some(vec![Expression::constant(1.0); legs]);
        };
        if parts.len() != legs {
            let message = format!(
                "a rope over {} markers has {legs} parts, found {}",
                points.len(),
                parts.len()
            );
            self.error(code::WRONG_TYPE, place, message)
                .suggest("a number for each pair of neighbouring markers");
            return None;
        }
        for (point, pair) in points[1..].iter().zip(parts.windows(2)) {
            if point.pulley.is_some() && pair[0].expression != pair[1].expression {
                let message = "a pulley has the same number of parts on both sides";
                self.error(code::ILLEGAL_VALUE, pair[1].span.clone(), message)
                    .suggest(
                        "only a marker without a pulley is between different numbers of parts",
                    );
                return None;
            }
        }
        Some(parts.into_iter().map(|part| part.expression).collect())
    }
}

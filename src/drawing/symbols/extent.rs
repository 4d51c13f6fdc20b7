//! What a symbol extends over.

use std::f64::consts::TAU;

use super::on_body;
use crate::drawing::outline::{Point, direction};
use crate::drawing::scene::{Anchor, Frame, Symbol};

impl Symbol {
    /// The points between which what is drawn to scale extends, at q \[m\].
    pub(in crate::drawing) fn extremes(&self, q: &[f64]) -> Vec<Point> {
        let at = |anchor: &Anchor| anchor.placed(q).point;
        let circle = |anchor: &Anchor, radius: f64| {
            let around = [0.0, 0.25, 0.5, 0.75].map(|part| direction(part * TAU));
            around.map(|side| at(anchor) + radius * side)
        };
        let axis = |along: &Anchor, range: &[f64; 2]| {
            let Frame { point, angle } = along.placed(q);
            range.map(|s| point + s * direction(angle)).to_vec()
        };
        match self {
            Self::Link { body, points } => points
                .iter()
                .map(|&position| at(&on_body(*body, position)))
                .collect(),
            Self::Block { at: anchor, .. }
            | Self::SlotBlock { at: anchor, .. }
            | Self::Fixture { at: anchor }
            | Self::Pin { at: anchor }
            | Self::Weld { at: anchor }
            | Self::Knife { at: anchor }
            | Self::AngleDriver { to: anchor, .. }
            | Self::Point { at: anchor, .. } => vec![at(anchor)],
            Self::SlideWay { along, range, .. }
            | Self::Slot { along, range }
            | Self::Rack { along, range, .. }
            | Self::Face { along, range, .. } => axis(along, range),
            Self::Rod { ends } => ends.iter().map(at).collect(),
            Self::LengthDriver { from, to, .. } => vec![at(from), at(to)],
            Self::Cam {
                at: anchor,
                contour,
            } => contour
                .iter()
                .map(|&position| {
                    at(&Anchor {
                        position,
                        ..*anchor
                    })
                })
                .collect(),
            Self::Roller { at: anchor, radius }
            | Self::Wheel {
                at: anchor, radius, ..
            } => circle(anchor, *radius).to_vec(),
            Self::Belt { centers, radii, .. } => centers
                .iter()
                .zip(radii)
                .flat_map(|(center, radius)| circle(center, *radius))
                .collect(),
            Self::Trace { points, .. } => points.iter().map(|&p| Point::from(p)).collect(),
        }
    }
}

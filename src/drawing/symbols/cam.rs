//! Cams and what touches them.

use super::names::around;
use super::{BAR, LINE, PIN, Pen, colour_of};
use crate::drawing::labels::{Candidate, ON_WHEEL};
use crate::drawing::outline::{Outline, Point, across, direction, unit};
use crate::drawing::scene::Anchor;
use crate::drawing::sheet::Layer;

/// From a knife's edge to where it is as wide as a bar.
const KNIFE: f64 = 17.0;
/// Thickness of a flat-faced follower, and of the line that is its face.
const FACE: [f64; 2] = [10.0, 3.0];

impl Pen<'_> {
    pub(super) fn cam(&mut self, at: Anchor, contour: &[[f64; 2]]) {
        let (axle, _) = self.place(at);
        let points: Vec<Point> = contour
            .iter()
            .map(|&position| self.place(Anchor { position, ..at }).0)
            .collect();
        let colour = colour_of(at.body);
        let outline = Outline::polygon(&points);
        self.area(Layer::Wheel, outline, (colour, 0.3), Some(colour));
        let Some(body) = at.body else { return };
        // Inside, best on the far side from the axle, or around.
        let middle = points.iter().sum::<Point>() / points.len() as f64;
        let distances = points.iter().map(|p| (p - middle).norm());
        let (least, most) = distances.fold((f64::INFINITY, 0.0_f64), |(least, most), d| {
            (least.min(d), most.max(d))
        });
        let away = unit(middle - axle);
        let places = &mut self.body_places[body.index()];
        for (part, cost) in [(0.5, 0.0), (0.35, 1.0), (0.65, 1.0)] {
            for turn in [0.0, 0.5, -0.5, 1.0, -1.0, 1.5, -1.5] {
                let aside = direction(turn);
                let side = aside.x * away + aside.y * across(away);
                places.push(Candidate {
                    anchor: middle + part * least * side,
                    side: None,
                    gap: 0.0,
                    cost: cost + f64::abs(turn) - ON_WHEEL,
                });
            }
        }
        places.extend(around(middle, most + 1.0));
    }

    pub(super) fn knife(&mut self, at: Anchor) {
        let (edge, inwards) = self.place(at);
        let colour = colour_of(at.body);
        // The flanks touch the round end of the bar.
        let sine = BAR / KNIFE;
        let cosine = (1.0 - sine * sine).sqrt();
        let flank = KNIFE * cosine;
        let [left, right] = [1.0, -1.0]
            .map(|side| edge + flank * (cosine * inwards + side * sine * across(inwards)));
        let flanks = [left, edge, right];
        let fill = (colour.tint(0.45), 1.0);
        self.area(Layer::Slot, Outline::polygon(&flanks), fill, None);
        self.line(Layer::Slot, Outline::line(&flanks), colour, LINE);
    }

    /// Moves the corner of a body at a knife's edge to where the knife begins.
    pub(super) fn make_room(&self, at: Anchor, corners: &mut [Point]) {
        let (edge, inwards) = self.place(at);
        for corner in corners.iter_mut().filter(|corner| **corner == edge) {
            *corner += KNIFE * inwards;
        }
    }

    pub(super) fn roller(&mut self, at: Anchor, radius: f64) {
        let (center, _) = self.place(at);
        let colour = colour_of(at.body);
        let radius = radius * self.scale;
        let outline = Outline::circle(center, radius);
        self.area(Layer::Slot, outline, (colour.tint(0.2), 1.0), Some(colour));
        if let Some(body) = at.body {
            let places = &mut self.body_places[body.index()];
            // What carries the roller names the body better.
            places.extend(around(center, radius.max(PIN) + 1.0).map(|mut candidate| {
                candidate.cost += 4.0;
                candidate
            }));
        }
    }

    pub(super) fn face(&mut self, along: Anchor, range: [f64; 2], above: bool) {
        let (_, axis) = self.place(along);
        let [start, end] = self.ends(along, range);
        let [start, end] = [start - BAR * axis, end + BAR * axis];
        let colour = colour_of(along.body);
        let back = self.back(along, above);
        let depth = FACE[0] * back;
        let outline = Outline::polygon(&[start, end, end + depth, start + depth]);
        self.area(Layer::Slot, outline, (colour.tint(0.45), 1.0), Some(colour));
        let face = Outline::line(&[start, end]);
        self.line(Layer::Slot, face, colour.shade(0.8), FACE[1]);
        self.places_beside(along.body, [start + depth, end + depth], back);
    }

    /// The direction from a face into its follower, which is where the cam is not.
    fn back(&self, along: Anchor, above: bool) -> Point {
        let (_, axis) = self.place(along);
        // On the sheet y points down.
        if above { across(axis) } else { -across(axis) }
    }

    /// Moves the corners of a body that are on its face to the face's back. A body that is only
    /// a pivot there stays around it.
    pub(super) fn stay_behind(&self, along: Anchor, above: bool, corners: &mut [Point]) {
        if corners.len() < 2 {
            return;
        }
        let (origin, _) = self.place(along);
        let back = self.back(along, above);
        for corner in corners {
            // Far less than can be seen, far more than rounding.
            if back.dot(&(*corner - origin)).abs() < 1e-3 {
                *corner += FACE[0] * back;
            }
        }
    }
}

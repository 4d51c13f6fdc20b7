//! Links, blocks and slots.

use super::{BAR, BLOCK, Pen, SLOT_BLOCK, colour_of, on_body};
use crate::drawing::labels::Candidate;
use crate::drawing::outline::{Outline, Point, across, convex_hull};
use crate::drawing::palette::Colour;
use crate::drawing::scene::{Anchor, Symbol};
use crate::drawing::sheet::Layer;
use crate::mechanism::BodyId;

/// Half the width of a bar with a slot.
const SLOTTED_BAR: f64 = 8.5;
/// Half the width of a slot.
const SLOT: f64 = 4.0;

impl Pen<'_> {
    pub(super) fn link(&mut self, body: BodyId, points: &[[f64; 2]]) {
        let colour = Colour::of_body(body.index());
        let mut corners: Vec<Point> = points
            .iter()
            .map(|&position| self.place(on_body(body, position)).0)
            .collect();
        let mut half = BAR;
        for symbol in &self.scene.symbols {
            match symbol {
                Symbol::Knife { at } if at.body == Some(body) => self.make_room(*at, &mut corners),
                Symbol::Face { along, above, .. } if along.body == Some(body) => {
                    self.stay_behind(*along, *above, &mut corners);
                }
                Symbol::Slot { along, range } if along.body == Some(body) => {
                    corners.extend(self.slot_ends(*along, *range));
                    half = SLOTTED_BAR;
                }
                _ => {}
            }
        }
        let hull = convex_hull(&corners);
        let (layer, opacity) = if hull.len() > 2 {
            (Layer::Plate, 0.25)
        } else {
            (Layer::Bar, 0.45)
        };
        let outline = Outline::around(&hull, half);
        self.area(layer, outline, (colour, opacity), Some(colour));
        self.places_along(body, &hull);
    }

    pub(super) fn block(&mut self, at: Anchor, on: Option<BodyId>) {
        let (center, along) = self.place(at);
        let colour = colour_of(at.body);
        let outline = Outline::block(center, along, BLOCK);
        // It covers the bar that it slides on; the rod that moves it stays in sight.
        let layer = if on.is_some() {
            Layer::Block
        } else {
            Layer::Slider
        };
        self.area(layer, outline, (colour.tint(0.45), 1.0), Some(colour));
        if let Some(body) = at.body {
            let up = across(along);
            let places = &mut self.body_places[body.index()];
            for (side, gap) in [
                (up, 0.5 * BLOCK[1]),
                (-up, 0.5 * BLOCK[1]),
                (along, 0.5 * BLOCK[0]),
                (-along, 0.5 * BLOCK[0]),
            ] {
                for (more, cost) in [(4.0, 0.0), (16.0, 4.0), (30.0, 12.0)] {
                    for shift in [0.0, 16.0, -16.0] {
                        places.push(Candidate {
                            anchor: center + shift * across(side),
                            side: Some(side),
                            gap: gap + more,
                            cost: cost + f64::abs(shift) / 8.0,
                        });
                    }
                }
            }
        }
    }

    pub(super) fn slot_block(&mut self, at: Anchor, along: Anchor) {
        let (center, _) = self.place(at);
        let (_, axis) = self.place(along);
        let colour = colour_of(at.body);
        let outline = Outline::block(center, axis, SLOT_BLOCK);
        self.area(Layer::Block, outline, (colour.tint(0.6), 1.0), Some(colour));
    }

    pub(super) fn slot(&mut self, along: Anchor, range: [f64; 2]) {
        let colour = colour_of(along.body);
        let outline = Outline::around(&self.slot_ends(along, range), SLOT);
        self.area(Layer::Slot, outline, (Colour::WHITE, 1.0), Some(colour));
    }

    /// A slot has room for its block at both ends.
    fn slot_ends(&self, along: Anchor, range: [f64; 2]) -> [Point; 2] {
        let (_, axis) = self.place(along);
        let [start, end] = self.ends(along, range);
        let more = 0.5 * SLOT_BLOCK[0] * axis;
        [start - more, end + more]
    }
}

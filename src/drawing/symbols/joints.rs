//! Pins, welds and rods, and what ground holds bodies by.

use super::wheels::{RACK_BODY, TOOTH};
use super::{BAR, BLOCK, PIN, Pen, SLOT_BLOCK};
use crate::drawing::outline::{Outline, across};
use crate::drawing::palette::Colour;
use crate::drawing::scene::{Anchor, Held, WaySide};
use crate::drawing::sheet::Layer;

const WELD: f64 = 9.0;
/// Height and half the base of the triangle under a fixed pivot.
const TRIANGLE: [f64; 2] = [17.0, 11.0];
/// How far a hatched line reaches beyond what stands on it.
const BEYOND: f64 = 6.0;

impl Pen<'_> {
    pub(super) fn pin(&mut self, at: Anchor) {
        let (center, _) = self.place(at);
        let outline = Outline::circle(center, PIN);
        self.area(
            Layer::Joint,
            outline,
            (Colour::WHITE, 1.0),
            Some(Colour::INK),
        );
    }

    pub(super) fn weld(&mut self, at: Anchor) {
        let (center, along) = self.place(at);
        let outline = Outline::block(center, along, [WELD, WELD]);
        self.area(Layer::Joint, outline, (Colour::INK, 1.0), None);
    }

    pub(super) fn rod(&mut self, ends: [Anchor; 2]) {
        let ends = ends.map(|end| self.place(end).0);
        self.line(Layer::Block, Outline::line(&ends), Colour::INK, 2.0);
    }

    pub(super) fn fixture(&mut self, at: Anchor) {
        let (pivot, down) = self.place(at);
        let [height, half] = TRIANGLE;
        let (foot, aside) = (pivot + height * down, across(down));
        let corners = [pivot, foot + half * aside, foot - half * aside];
        self.area(
            Layer::Ground,
            Outline::polygon(&corners),
            (Colour::GROUND.tint(0.15), 1.0),
            Some(Colour::GROUND),
        );
        let reach = (half + BEYOND) * aside;
        self.hatched([foot - reach, foot + reach], down);
    }

    pub(super) fn slide_way(&mut self, along: Anchor, range: [f64; 2], side: WaySide, holds: Held) {
        let (_, axis) = self.place(along);
        let [start, end] = self.ends(along, range);
        // On the sheet y points down.
        let up = -across(axis);
        let (half, away) = match holds {
            Held::Point => (0.5 * SLOT_BLOCK[0], PIN),
            Held::Block => (0.5 * BLOCK[0], 0.5 * BLOCK[1]),
            Held::Bar => (0.0, BAR),
            Held::Rack => (0.0, 0.5 * TOOTH[1] + RACK_BODY),
        };
        let more = (half + BEYOND) * axis;
        let sides: &[f64] = match side {
            WaySide::Above => &[1.0],
            WaySide::Below => &[-1.0],
            WaySide::Both => &[1.0, -1.0],
        };
        for sign in sides {
            let outwards = *sign * up;
            let aside = (away + 1.0) * outwards;
            self.hatched([start - more + aside, end + more + aside], outwards);
        }
    }
}

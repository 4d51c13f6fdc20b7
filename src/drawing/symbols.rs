//! How each symbol of a scene looks on a sheet.

mod cam;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::labels::{self, Candidate, Label, ON_WHEEL, Placed};
use super::outline::{Outline, Point, across, convex_hull, direction, unit};
use super::palette::Colour;
use super::rider::Rider;
use super::scene::{Anchor, Frame, Held, Scene, Symbol, WaySide};
use super::sheet::{Layer, Mark, Stroke};
use crate::mechanism::BodyId;

/// Half the width of a bar.
const BAR: f64 = 6.5;
/// Half the width of a bar with a slot.
const SLOTTED_BAR: f64 = 8.5;
const PIN: f64 = 4.2;
const POINT: f64 = 3.0;
/// Length and height of a block, and of one in a slot.
const BLOCK: [f64; 2] = [34.0, 22.0];
const SLOT_BLOCK: [f64; 2] = [15.0, 8.0];
/// Half the width of a slot.
const SLOT: f64 = 4.0;
const WELD: f64 = 9.0;
/// Height and half the base of the triangle under a fixed pivot.
const TRIANGLE: [f64; 2] = [17.0, 11.0];
/// How far a hatched line reaches beyond what stands on it.
const BEYOND: f64 = 6.0;
/// Spacing and depth of hatching.
const HATCH: f64 = 6.0;
/// Thickness of a ring gear, and length of the mark on a wheel.
const RIM: f64 = 10.0;
/// Pitch and height of a rack's teeth.
const TOOTH: [f64; 2] = [9.0, 5.0];
/// Height of a rack under its teeth.
const RACK_BODY: f64 = 2.0 * BAR;
/// Radius of an angle driver's arc.
const ARC: f64 = 27.0;
/// An angle smaller than this, 20°, has no room for an arrow.
const SEEN: f64 = PI / 9.0;
/// The arc where the angle itself is too small to be seen.
const SMALL_ARC: f64 = 1.6;
/// A line shorter than this has no room for two arrows.
const SHORT: f64 = 18.0;
/// How far a dimension line lies beside what it measures.
pub(super) const BESIDE: f64 = 21.0;
/// How far a dimension line between two pins ends before their middle.
pub(super) const DRIVER_INSET: f64 = PIN + 1.0;
/// Length and half the width of an arrow.
const ARROW: [f64; 2] = [8.0, 2.9];

/// The names of more bodies than this would hide them.
const MOST_NAMES: usize = 60;

const THIN: f64 = 0.9;
const LINE: f64 = 1.4;
const DASHES: &[f64] = &[4.0, 3.0];
const DASH_DOTS: &[f64] = &[10.0, 3.0, 2.0, 3.0];

/// Draws symbols on a sheet whose origin is that of the mechanism.
pub(super) struct Pen<'a> {
    scene: &'a Scene,
    q: &'a [f64],
    /// Units of the sheet for a metre.
    scale: f64,
    /// The middle of all bodies.
    middle: Point,
    /// Whether the mechanism moves: then drivers are drawn so that they can move with it.
    moving: bool,
    marks: Vec<Mark>,
    /// Lines that change their shape when the mechanism moves, which others draw then; labels
    /// keep clear of them all the same.
    changing: Vec<Mark>,
    driver_labels: Vec<Label>,
    point_labels: Vec<Label>,
    /// For each body the places for its name, from all that is drawn of it.
    body_places: Vec<Vec<Candidate>>,
}

impl<'a> Pen<'a> {
    pub(super) fn new(scene: &'a Scene, q: &'a [f64], scale: f64) -> Self {
        let mut pen = Self {
            scene,
            q,
            scale,
            middle: Point::zeros(),
            moving: false,
            marks: Vec::new(),
            changing: Vec::new(),
            driver_labels: Vec::new(),
            point_labels: Vec::new(),
            body_places: scene.bodies.iter().map(|_| Vec::new()).collect(),
        };
        let mut points = Vec::new();
        for symbol in &scene.symbols {
            if let Symbol::Link { .. }
            | Symbol::Block { .. }
            | Symbol::Wheel { .. }
            | Symbol::Cam { .. } = symbol
            {
                points.extend(symbol.extremes(q));
            }
        }
        if !points.is_empty() {
            pen.middle = pen.on_sheet(points.iter().sum::<Point>() / points.len() as f64);
        }
        pen
    }

    /// A pen for a mechanism that starts to move at q.
    pub(super) fn moving(scene: &'a Scene, q: &'a [f64], scale: f64) -> Self {
        Self {
            moving: true,
            ..Self::new(scene, q, scale)
        }
    }

    /// How many marks there are so far.
    pub(super) fn drawn(&self) -> usize {
        self.marks.len()
    }

    /// All marks, and the labels at their places.
    pub(super) fn finish(self) -> (Vec<Mark>, Vec<Placed>) {
        // They choose their places in this order.
        let mut labels = self.driver_labels;
        labels.extend(self.point_labels);
        let bodies = self.scene.bodies.iter().zip(self.body_places).enumerate();
        let named = self.scene.bodies.len() <= MOST_NAMES;
        labels.extend(
            bodies
                .filter(|_| named)
                .map(|(index, (name, candidates))| Label {
                    content: name.clone(),
                    // Dark enough to be read: half the colour's light.
                    colour: Colour::of_body(index).shade(0.55),
                    follows: Rider::Body(BodyId(index)),
                    may_miss: true,
                    candidates,
                }),
        );
        let placed = labels::place(labels, self.marks.iter().chain(&self.changing));
        (self.marks, placed)
    }

    pub(super) fn draw(&mut self, symbol: &Symbol) {
        match symbol {
            Symbol::Link { body, points } => self.link(*body, points),
            Symbol::Block { at, on } => self.block(*at, *on),
            Symbol::SlotBlock { at, along } => self.slot_block(*at, *along),
            Symbol::SlideWay {
                along,
                range,
                side,
                holds,
            } => self.slide_way(*along, *range, *side, *holds),
            Symbol::Slot { along, range } => self.slot(*along, *range),
            Symbol::Fixture { at } => self.fixture(*at),
            Symbol::Pin { at } => self.pin(*at),
            Symbol::Weld { at } => self.weld(*at),
            Symbol::Rod { ends } => self.rod(*ends),
            Symbol::Wheel { at, radius, ring } => self.wheel(*at, *radius, *ring),
            Symbol::Belt {
                centers,
                radii,
                crossed,
            } => self.belt(*centers, *radii, *crossed),
            Symbol::Rack {
                along,
                range,
                above,
            } => self.rack(*along, *range, *above),
            Symbol::Cam { at, contour } => self.cam(*at, contour),
            Symbol::Knife { at } => self.knife(*at),
            Symbol::Roller { at, radius } => self.roller(*at, *radius),
            Symbol::Face {
                along,
                range,
                above,
            } => self.face(*along, *range, *above),
            Symbol::AngleDriver { name, from, to } => self.angle_driver(name, *from, *to),
            Symbol::LengthDriver {
                name,
                from,
                to,
                axis,
                beside,
            } => self.length_driver(name, [*from, *to], *axis, *beside),
            Symbol::Point { name, at } => self.point(name, *at),
            Symbol::Trace { body, points } => self.trace(*body, points),
        }
    }

    // -- places ------------------------------------------------------------------------------

    fn on_sheet(&self, point: Point) -> Point {
        self.scale * Point::new(point.x, -point.y)
    }

    /// Point and x-axis of an anchor on the sheet.
    fn place(&self, anchor: Anchor) -> (Point, Point) {
        let Frame { point, angle } = anchor.placed(self.q);
        (self.on_sheet(point), on_sheet_direction(angle))
    }

    /// The two ends of a part of an anchor's x-axis.
    fn ends(&self, along: Anchor, range: [f64; 2]) -> [Point; 2] {
        let (origin, axis) = self.place(along);
        range.map(|s| origin + self.scale * s * axis)
    }

    // -- marks -------------------------------------------------------------------------------

    fn line(&mut self, layer: Layer, outline: Outline, colour: Colour, width: f64) {
        self.dashed(layer, outline, colour, width, &[]);
    }

    fn dashed(
        &mut self,
        layer: Layer,
        outline: Outline,
        colour: Colour,
        width: f64,
        dashes: &'static [f64],
    ) {
        self.marks.push(Mark {
            layer,
            outline,
            fill: None,
            stroke: Some(Stroke {
                colour,
                width,
                dashes,
            }),
        });
    }

    fn area(&mut self, layer: Layer, outline: Outline, fill: (Colour, f64), edge: Option<Colour>) {
        self.marks.push(Mark {
            layer,
            outline,
            fill: Some(fill),
            stroke: edge.map(|colour| Stroke {
                colour,
                width: LINE,
                dashes: &[],
            }),
        });
    }

    /// A line with hatching on one side: what does not move.
    fn hatched(&mut self, [start, end]: [Point; 2], outwards: Point) {
        let along = unit(end - start);
        let length = (end - start).norm();
        self.line(
            Layer::Ground,
            Outline::line(&[start, end]),
            Colour::GROUND,
            LINE,
        );
        let count = (length / HATCH).round().max(1.0);
        let mut hatching = Outline::default();
        for k in 0..count as usize {
            let foot = start + (k as f64 + 1.0) / count * length * along;
            hatching.add_line(&[foot, foot + HATCH * (outwards - along)]);
        }
        self.line(Layer::Ground, hatching, Colour::GROUND, THIN);
    }

    fn arrow(&mut self, tip: Point, along: Point) {
        let [length, half] = ARROW;
        let base = tip - length * along;
        let aside = half * across(along);
        let outline = Outline::polygon(&[tip, base + aside, base - aside]);
        self.area(Layer::Driver, outline, (Colour::DRIVER, 1.0), None);
    }

    // -- bodies ------------------------------------------------------------------------------

    fn link(&mut self, body: BodyId, points: &[[f64; 2]]) {
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

    /// Places for a body's name along the edges of its hull, and inside a large one.
    fn places_along(&mut self, body: BodyId, hull: &[Point]) {
        let places = &mut self.body_places[body.index()];
        let center = hull.iter().sum::<Point>() / hull.len() as f64;
        if hull.len() == 1 {
            places.extend(around(center, BAR));
            return;
        }
        if hull.len() > 2 {
            places.push(Candidate {
                anchor: center,
                side: None,
                gap: 0.0,
                cost: 0.0,
            });
        }
        for corner in hull {
            places.extend(around(*corner, BAR + 1.0).map(|mut candidate| {
                // Several bodies meet there: the name could be any one's.
                candidate.cost += 10.0;
                candidate
            }));
        }
        for (index, start) in hull.iter().enumerate() {
            let end = hull[(index + 1) % hull.len()];
            let normal = across(unit(end - start));
            for (part, less) in [
                (0.5, 0.0),
                (0.38, 1.0),
                (0.62, 1.0),
                (0.26, 2.0),
                (0.74, 2.0),
                (0.14, 4.0),
                (0.86, 4.0),
            ] {
                for (gap, far) in [(BAR + 5.0, 0.0), (BAR + 13.0, 5.0), (BAR + 24.0, 12.0)] {
                    let anchor = start + part * (end - start);
                    // Outside: away from the middle of the hull; a bar has both sides, one of
                    // them as its edge back.
                    let out = if hull.len() > 2 && normal.dot(&(anchor - center)) < 0.0 {
                        -normal
                    } else {
                        normal
                    };
                    places.push(Candidate {
                        anchor,
                        side: Some(out),
                        gap,
                        cost: less + far + 1.0,
                    });
                }
            }
        }
    }

    /// Places for a body's name on one side of a line.
    fn places_beside(&mut self, body: Option<BodyId>, [start, end]: [Point; 2], side: Point) {
        let Some(body) = body else { return };
        let places = &mut self.body_places[body.index()];
        for part in [0.5, 0.3, 0.7, 0.1, 0.9] {
            for (gap, far) in [(5.0, 0.0), (13.0, 5.0), (24.0, 12.0)] {
                places.push(Candidate {
                    anchor: start + part * (end - start),
                    side: Some(side),
                    gap,
                    cost: far + 4.0 * f64::abs(part - 0.5),
                });
            }
        }
    }

    fn block(&mut self, at: Anchor, on: Option<BodyId>) {
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

    fn slot_block(&mut self, at: Anchor, along: Anchor) {
        let (center, _) = self.place(at);
        let (_, axis) = self.place(along);
        let colour = colour_of(at.body);
        let outline = Outline::block(center, axis, SLOT_BLOCK);
        self.area(Layer::Block, outline, (colour.tint(0.6), 1.0), Some(colour));
    }

    fn slot(&mut self, along: Anchor, range: [f64; 2]) {
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

    fn wheel(&mut self, at: Anchor, radius: f64, ring: bool) {
        let (center, axis) = self.place(at);
        let colour = colour_of(at.body);
        let radius = radius * self.scale;
        let mark = if ring {
            let mut rim = Outline::circle(center, radius);
            rim.0.extend(Outline::circle(center, radius + RIM).0);
            self.line(Layer::Wheel, rim, colour, LINE);
            [radius, radius + RIM]
        } else {
            let pitch = Outline::circle(center, radius);
            self.area(Layer::Wheel, pitch.clone(), (colour, 0.2), None);
            self.dashed(Layer::Wheel, pitch, colour, LINE, DASH_DOTS);
            [(radius - RIM).max(0.6 * radius), radius]
        };
        if at.body.is_some() {
            // What shows how far it has turned.
            let mark = Outline::line(&mark.map(|r| center + r * axis));
            self.line(Layer::Wheel, mark, colour.shade(0.8), 2.4);
        } else if ring {
            let outer = radius + RIM;
            let count = (TAU * outer / (2.0 * HATCH)).round();
            let mut hatching = Outline::default();
            for k in 0..count as usize {
                let out = on_sheet_direction(k as f64 / count * TAU);
                let foot = center + outer * out;
                hatching.add_line(&[foot, foot + HATCH * (out - across(out))]);
            }
            self.line(Layer::Wheel, hatching, colour, THIN);
        }
        if let Some(body) = at.body {
            let outside = if ring { radius + RIM } else { radius };
            let places = &mut self.body_places[body.index()];
            places.extend(around(center, outside + 1.0));
            let inside = around(center, 0.35 * radius).chain(around(center, 0.6 * radius));
            places.extend(inside.map(|candidate| Candidate {
                cost: candidate.cost - if ring { 0.0 } else { ON_WHEEL },
                ..candidate
            }));
        }
    }

    // -- joints ------------------------------------------------------------------------------

    fn pin(&mut self, at: Anchor) {
        let (center, _) = self.place(at);
        let outline = Outline::circle(center, PIN);
        self.area(
            Layer::Joint,
            outline,
            (Colour::WHITE, 1.0),
            Some(Colour::INK),
        );
    }

    fn weld(&mut self, at: Anchor) {
        let (center, along) = self.place(at);
        let outline = Outline::block(center, along, [WELD, WELD]);
        self.area(Layer::Joint, outline, (Colour::INK, 1.0), None);
    }

    fn rod(&mut self, ends: [Anchor; 2]) {
        let ends = ends.map(|end| self.place(end).0);
        self.line(Layer::Block, Outline::line(&ends), Colour::INK, 2.0);
    }

    fn fixture(&mut self, at: Anchor) {
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

    fn slide_way(&mut self, along: Anchor, range: [f64; 2], side: WaySide, holds: Held) {
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

    fn belt(&mut self, centers: [Anchor; 2], radii: [f64; 2], crossed: bool) {
        let [a, b] = centers.map(|center| self.place(center).0);
        let [r, s] = radii.map(|radius| radius * self.scale);
        let (along, distance) = (unit(b - a), (b - a).norm());
        let far = if crossed { -s } else { s };
        // The tangents touch both circles under the same angle from the line of centres.
        let cosine = (r - far) / distance;
        if cosine.abs() >= 1.0 {
            return;
        }
        let sine = (1.0 - cosine * cosine).sqrt();
        for side in [1.0, -1.0] {
            let normal = cosine * along + side * sine * across(along);
            let tangent = Outline::line(&[a + r * normal, b + far * normal]);
            self.line(Layer::Wheel, tangent, Colour::INK, LINE);
        }
        for (center, radius) in [(a, r), (b, s)] {
            let circle = Outline::circle(center, radius);
            self.line(Layer::Wheel, circle, Colour::INK, LINE);
        }
    }

    fn rack(&mut self, along: Anchor, range: [f64; 2], above: bool) {
        let (_, axis) = self.place(along);
        let [start, end] = self.ends(along, range);
        let colour = colour_of(along.body);
        let towards = if above { -across(axis) } else { across(axis) };
        let [pitch, height] = TOOTH;
        let length = (end - start).norm();
        let count = (length / pitch).round().max(1.0);
        let pitch = length / count;
        let (root, tip) = (-0.5 * height * towards, 0.5 * height * towards);
        let at = |s: f64| start + s * axis;
        let mut profile = vec![at(0.0) + root];
        for k in 0..count as usize {
            let s = k as f64 * pitch;
            profile.extend([
                at(s + 0.1 * pitch) + root,
                at(s + 0.3 * pitch) + tip,
                at(s + 0.7 * pitch) + tip,
                at(s + 0.9 * pitch) + root,
            ]);
        }
        profile.push(at(length) + root);
        if along.body.is_some() {
            let back = -(0.5 * height + RACK_BODY) * towards;
            profile.extend([at(length) + back, at(0.0) + back]);
            let outline = Outline::polygon(&profile);
            self.area(Layer::Slot, outline, (colour.tint(0.45), 1.0), Some(colour));
            self.places_beside(along.body, [start + back, end + back], -towards);
        } else {
            self.line(Layer::Ground, Outline::line(&profile), Colour::GROUND, LINE);
            let under = -(0.5 * height + 4.0) * towards;
            self.hatched([start + under, end + under], -towards);
        }
        let pitch_line = Outline::line(&[start, end]);
        self.dashed(Layer::Slot, pitch_line, colour, THIN, DASH_DOTS);
    }

    // -- drivers -----------------------------------------------------------------------------

    fn angle_driver(&mut self, name: &str, from: Anchor, to: Anchor) {
        let Frame {
            angle: reference, ..
        } = from.placed(self.q);
        let (center, axis) = self.place(to);
        let turn = (to.placed(self.q).angle - reference) % TAU;
        // The arrow alone can turn with its body.
        let seen = !self.moving && (SEEN..=TAU - SEEN).contains(&turn.abs());
        let (start, turn) = if seen {
            let foot = on_sheet_direction(reference);
            let line = Outline::line(&[center + PIN * foot, center + (ARC + 8.0) * foot]);
            self.line(Layer::Driver, line, Colour::DRIVER, THIN);
            (reference, turn)
        } else {
            let towards = to.placed(self.q).angle;
            (towards - 0.5 * SMALL_ARC, SMALL_ARC)
        };
        // The arrow's length belongs to the arc; on the sheet angles count clockwise.
        let tip = if seen {
            axis
        } else {
            on_sheet_direction(start + turn)
        };
        let ahead = turn.signum();
        let shaft = turn - ahead * ARROW[0] / ARC;
        let arc = Outline::arc(center, ARC, -start, -shaft);
        self.line(Layer::Driver, arc, Colour::DRIVER, LINE);
        let chord = on_sheet_direction(start + turn + ahead * (FRAC_PI_2 - 0.5 * ARROW[0] / ARC));
        self.arrow(center + ARC * tip, chord);
        let mut candidates = Vec::new();
        for (part, cost) in [(0.5, 0.0), (0.7, 1.0), (0.3, 1.0), (0.9, 3.0), (0.1, 3.0)] {
            for (gap, far) in [(4.0, 0.0), (12.0, 4.0), (24.0, 10.0)] {
                let side = on_sheet_direction(start + part * turn);
                candidates.push(Candidate {
                    anchor: center + ARC * side,
                    side: Some(side),
                    gap,
                    cost: cost + far,
                });
            }
        }
        // If all along the arc is taken, near it.
        let middle = on_sheet_direction(start + 0.5 * turn);
        candidates.extend(around(center, ARC + 2.0).map(|mut candidate| {
            let off = candidate.side.map_or(0.0, |side| 1.0 - side.dot(&middle));
            candidate.cost += 2.0 + 4.0 * off;
            candidate
        }));
        self.driver_labels.push(Label {
            content: name.to_owned(),
            colour: Colour::DRIVER.shade(0.8),
            follows: Rider::Point(to),
            may_miss: false,
            candidates,
        });
    }

    fn length_driver(
        &mut self,
        name: &str,
        markers: [Anchor; 2],
        axis: Option<Anchor>,
        beside: bool,
    ) {
        let [from, to] = markers.map(|marker| self.place(marker).0);
        let along = axis.map_or_else(|| unit(to - from), |axis| self.place(axis).1);
        let aside = self.away(across(along), 0.5 * (from + to));
        let offset = if beside {
            BESIDE * aside
        } else {
            Point::zeros()
        };
        // For a coordinate along an axis, the line lies at the point that is driven.
        let foot = to - (to - from).dot(&along) * along;
        let short = (to - foot).norm() < SHORT;
        let [start, end] = if short {
            [to - SHORT * along, to + SHORT * along]
        } else {
            [foot, to]
        };
        let inset = if beside { 0.0 } else { DRIVER_INSET };
        let forth = unit(end - start);
        let [start, end] = [start + offset + inset * forth, end + offset - inset * forth];
        if beside && !short && !self.moving {
            for (point, line_end) in [(from, start), (to, end)] {
                let away = unit(line_end - point);
                let extension = Outline::line(&[point + (PIN + 2.0) * away, line_end + 4.0 * away]);
                self.line(Layer::Driver, extension, Colour::DRIVER, THIN);
            }
        }
        let arrow = 0.8 * ARROW[0] * forth;
        let line = Outline::line(&[start + arrow, end - arrow]);
        if self.moving {
            self.changing.push(Mark {
                layer: Layer::Driver,
                outline: line,
                fill: None,
                stroke: None,
            });
        } else {
            self.line(Layer::Driver, line, Colour::DRIVER, LINE);
            self.arrow(end, forth);
            self.arrow(start, -forth);
        }
        let mut candidates = Vec::new();
        for (part, cost) in [(0.5, 0.0), (0.35, 1.0), (0.65, 1.0), (0.2, 3.0), (0.8, 3.0)] {
            for (side, other) in [(aside, 0.0), (-aside, 1.0)] {
                for (gap, far) in [(5.0, 0.0), (14.0, 5.0)] {
                    candidates.push(Candidate {
                        anchor: start + part * (end - start),
                        side: Some(side),
                        gap,
                        cost: cost + other + far,
                    });
                }
            }
        }
        for tip in [start, end] {
            candidates.extend(around(tip, 5.0));
        }
        self.driver_labels.push(Label {
            content: name.to_owned(),
            colour: Colour::DRIVER.shade(0.8),
            follows: Rider::Point(markers[1]),
            may_miss: false,
            candidates,
        });
    }

    /// This direction or the opposite one: away from the mechanism.
    fn away(&self, aside: Point, from: Point) -> Point {
        if aside.dot(&(self.middle - from)) > 1e-6 {
            -aside
        } else {
            aside
        }
    }

    /// On which side of a length driver's line it is drawn: 1 for that of the axis turned by a
    /// quarter turn on the sheet, -1 for the other.
    pub(super) fn side_of_length(&self, markers: [Anchor; 2], axis: Option<Anchor>) -> f64 {
        let [from, to] = markers.map(|marker| self.place(marker).0);
        let along = axis.map_or_else(|| unit(to - from), |axis| self.place(axis).1);
        let aside = across(along);
        aside.dot(&self.away(aside, 0.5 * (from + to)))
    }

    // -- points ------------------------------------------------------------------------------

    fn point(&mut self, name: &str, at: Anchor) {
        let (center, _) = self.place(at);
        let dot = Outline::circle(center, POINT);
        self.area(Layer::Point, dot, (Colour::INK, 1.0), None);
        self.point_labels.push(Label {
            content: name.to_owned(),
            colour: Colour::INK,
            follows: Rider::of(at),
            may_miss: false,
            candidates: around(center, PIN).collect(),
        });
    }

    fn trace(&mut self, body: Option<BodyId>, points: &[[f64; 2]]) {
        let points: Vec<Point> = points
            .iter()
            .map(|&[x, y]| self.on_sheet(Point::new(x, y)))
            .collect();
        let colour = colour_of(body).shade(0.85);
        self.dashed(Layer::Trace, Outline::line(&points), colour, THIN, DASHES);
    }
}

impl Symbol {
    /// The points between which what is drawn to scale extends, at q \[m\].
    pub(super) fn extremes(&self, q: &[f64]) -> Vec<Point> {
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

fn on_body(body: BodyId, position: [f64; 2]) -> Anchor {
    Anchor {
        body: Some(body),
        position,
        angle: 0.0,
    }
}

fn colour_of(body: Option<BodyId>) -> Colour {
    body.map_or(Colour::GROUND, |body| Colour::of_body(body.index()))
}

/// The unit vector of an angle on the sheet, where y points down.
fn on_sheet_direction(angle: f64) -> Point {
    direction(-angle)
}

/// Places around something round: right and above first, as one reads.
fn around(center: Point, radius: f64) -> impl Iterator<Item = Candidate> {
    const SIDES: u32 = 16;
    [(3.0, 0.0), (10.0, 4.0), (20.0, 10.0)]
        .into_iter()
        .flat_map(move |(gap, far)| {
            (0..SIDES).map(move |k| {
                let turn = f64::from(k) / f64::from(SIDES) * TAU;
                let from_best = (turn - 0.25 * PI).cos();
                Candidate {
                    anchor: center,
                    side: Some(on_sheet_direction(turn)),
                    gap: gap + radius,
                    cost: far + 1.0 - from_best,
                }
            })
        })
}

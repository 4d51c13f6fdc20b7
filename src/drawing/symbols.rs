//! How each symbol of a scene looks on a sheet.

mod bodies;
mod cam;
mod drivers;
mod extent;
mod joints;
mod names;
mod wheels;

pub(super) use drivers::BESIDE;
use names::around;

use super::labels::{self, Candidate, Label, Placed};
use super::outline::{Outline, Point, direction, unit};
use super::palette::Colour;
use super::rider::Rider;
use super::scene::{Anchor, Frame, Scene, Symbol};
use super::sheet::{Layer, Mark, Stroke};
use crate::mechanism::BodyId;

/// Half the width of a bar.
const BAR: f64 = 6.5;
const PIN: f64 = 4.2;
const POINT: f64 = 3.0;
/// Length and height of a block, and of one in a slot.
const BLOCK: [f64; 2] = [34.0, 22.0];
const SLOT_BLOCK: [f64; 2] = [15.0, 8.0];
/// Spacing and depth of hatching.
const HATCH: f64 = 6.0;

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

//! The pen that symbols are drawn with.

use std::f64::consts::FRAC_PI_2;

use super::*;
use crate::drawing::anchor::Frame;
use crate::drawing::attachment::on_sheet;
use crate::drawing::label::{self, Label, Placed};
use crate::drawing::sheet::{Elastic, Mark, Stroke};

/// Half the width of a bar.
pub(super) const BAR: f64 = 6.5;
/// Radius of a revolute joint's circle.
pub(super) const PIN: f64 = 4.2;
/// Length and height of a block.
pub(super) const BLOCK: [f64; 2] = [34.0, 22.0];
/// Length and half the width of an arrow.
pub(super) const ARROW: [f64; 2] = [8.0, 2.9];
/// Distance from the tip of an arrow to the line's end inside it.
pub(super) const IN_ARROW: f64 = 0.8 * ARROW[0];
/// Spacing and depth of hatching.
pub(super) const HATCH: f64 = 6.0;
/// Width of a thin line.
pub(super) const THIN: f64 = 0.9;
/// Width of a line.
pub(super) const LINE: f64 = 1.4;
/// Dashes and gaps of paths.
pub(super) const DASHES: &[f64] = &[4.0, 3.0];
/// Dashes and gaps of pitch lines.
pub(super) const DASH_DOTS: &[f64] = &[10.0, 3.0, 2.0, 3.0];

/// Part of a body's colour in its texts: half its light can be read.
pub(super) const NAME: f64 = 0.55;
/// Least distance on the sheet that can be seen.
const SEEN: f64 = 0.1;

/// Most bodies with names: more names would hide the mechanism.
const MOST_NAMES: usize = 60;

/// Draws symbols on a sheet whose origin is the origin of the mechanism.
pub(in crate::drawing) struct Pen<'a> {
    /// The symbols to which bodies are fitted.
    pub(super) fitting: Vec<&'a dyn Shape>,
    pub(super) q: &'a [f64],
    /// Units of the sheet per metre.
    pub(super) scale: f64,
    /// Middle of all bodies.
    middle: Point,
    /// Whether the mechanism starts to move: marks then keep their shape in their frames.
    pub(super) moving: bool,
    /// Whether the tips of arrows are open, as those of freedoms are.
    pub(super) open_arrows: bool,
    others: OtherPoses<'a>,
    /// The frame that the next marks and labels move with.
    attachment: Attachment,
    marks: Vec<Mark>,
    labels: Vec<(Named, Label)>,
    /// Places for the name of each body, from everything drawn of it.
    body_places: Vec<Vec<Candidate>>,
}

/// Things that labels name, in the order in which the labels choose their places; bodies come last.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Named {
    Driver,
    /// A load has a name if there is room.
    Load,
    /// A point, or the size of a force there.
    Point,
    Length,
}

/// Poses besides the one that is drawn.
#[derive(Clone, Copy)]
pub(in crate::drawing) enum OtherPoses<'a> {
    /// Poses that a picture at rest shows faintly.
    Shown(&'a [Vec<f64>]),
    /// Poses along which the mechanism moves; labels keep their places over them.
    Motion(&'a [&'a [f64]]),
    /// None, in a glimpse without labels.
    Glimpse,
}

impl<'a> Pen<'a> {
    /// Draws symbols at the pose q. Returns the marks, and the labels at their places.
    pub(in crate::drawing) fn draw(
        symbols: &'a [Symbol],
        bodies: &[String],
        q: &'a [f64],
        scale: f64,
        others: OtherPoses<'a>,
    ) -> (Vec<Mark>, Vec<Placed>) {
        let shapes = || symbols.iter().map(Symbol::shape);
        let points: Vec<Point> = shapes()
            .filter(|shape| shape.shows().is_some())
            .flat_map(Shape::extent)
            .map(|disc| disc.center.placed(q).point)
            .collect();
        let middle = points.iter().sum::<Point>() / points.len().max(1) as f64;
        let mut pen = Self {
            fitting: shapes().filter(|shape| shape.fitted().is_some()).collect(),
            q,
            scale,
            middle: on_sheet(middle, scale),
            moving: !matches!(others, OtherPoses::Shown(_)),
            open_arrows: false,
            others,
            attachment: Attachment::Ground,
            marks: Vec::new(),
            labels: Vec::new(),
            body_places: bodies.iter().map(|_| Vec::new()).collect(),
        };
        for shape in shapes() {
            shape.draw(&mut pen);
        }
        pen.finish(bodies)
    }

    /// Returns all marks, and the labels at their places.
    fn finish(mut self, bodies: &[String]) -> (Vec<Mark>, Vec<Placed>) {
        let motion = match self.others {
            OtherPoses::Motion(motion) => motion,
            OtherPoses::Glimpse => return (self.marks, Vec::new()),
            OtherPoses::Shown(poses) => {
                let shown: Vec<Mark> = (self.marks.iter().filter(|mark| shows_body(mark)))
                    .flat_map(|mark| poses.iter().filter_map(|q| self.faint(mark, q)))
                    .collect();
                self.marks.extend(shown);
                &[]
            }
        };
        self.labels.sort_by_key(|(kind, _)| *kind);
        let mut labels: Vec<Label> = self.labels.into_iter().map(|(_, label)| label).collect();
        if bodies.len() <= MOST_NAMES {
            let bodies = bodies.iter().zip(self.body_places).enumerate();
            labels.extend(bodies.map(|(index, (name, candidates))| Label {
                content: name.clone(),
                colour: Colour::of_body(index).shade(NAME),
                attachment: Attachment::Body(BodyId(index)),
                optional: true,
                candidates,
            }));
        }
        let placed = label::place(labels, &self.marks, self.q, motion, self.scale);
        (self.marks, placed)
    }

    /// Returns the faint outline of a mark at another pose, `None` if it is where it was.
    fn faint(&self, mark: &Mark, q: &[f64]) -> Option<Mark> {
        /// Part of the colour that is left.
        const FAINT: f64 = 0.5;
        let moved = mark.moved(self.q, q, self.scale);
        let [old, new] = [mark, &moved].map(|mark| mark.outline.flattened());
        let far = |(old, new): (&[Point; 2], &[Point; 2])| (old[0] - new[0]).norm() > SEEN;
        let has_moved = old.iter().zip(&new).any(far);
        let colour = (mark.stroke.map(|stroke| stroke.colour)).or(mark.fill.map(|(c, _)| c))?;
        has_moved.then(|| Mark {
            layer: Layer::Pose,
            fill: None,
            stroke: Some(Stroke::solid(colour.tint(FAINT), THIN)),
            ..moved
        })
    }

    /// Attaches the next marks and labels to the body of an anchor. Returns the point and x-axis
    /// of the anchor on the sheet, and the colour of the body.
    pub(super) fn on(&mut self, anchor: Anchor) -> (Point, Point, Colour) {
        self.attach(Attachment::of(anchor));
        let (point, axis) = self.place(anchor);
        (point, axis, colour_of(anchor.body))
    }

    /// Sets the frame that the next marks and labels move with.
    pub(super) fn attach(&mut self, attachment: Attachment) {
        self.attachment = attachment;
    }

    // -- places ------------------------------------------------------------------------------

    /// Returns a global point on the sheet.
    pub(super) fn on_sheet(&self, point: Point) -> Point {
        on_sheet(point, self.scale)
    }

    /// Returns point and x-axis of an anchor on the sheet.
    pub(super) fn place(&self, anchor: Anchor) -> (Point, Point) {
        let Frame { point, angle } = anchor.placed(self.q);
        (self.on_sheet(point), on_sheet_direction(angle))
    }

    /// Returns the two ends of a part of an anchor's x-axis on the sheet.
    pub(super) fn ends(&self, along: Anchor, range: [f64; 2]) -> [Point; 2] {
        let (origin, axis) = self.place(along);
        range.map(|s| origin + self.scale * s * axis)
    }

    /// Returns this direction or the opposite one: away from the mechanism.
    pub(super) fn away(&self, aside: Point, from: Point) -> Point {
        if aside.dot(&(self.middle - from)) > 1e-6 {
            -aside
        } else {
            aside
        }
    }

    // -- marks -------------------------------------------------------------------------------

    /// Draws a solid line.
    pub(super) fn line(&mut self, layer: Layer, outline: Outline, colour: Colour, width: f64) {
        self.dashed(layer, outline, colour, width, &[]);
    }

    /// Draws a line of dashes and gaps.
    pub(super) fn dashed(
        &mut self,
        layer: Layer,
        outline: Outline,
        colour: Colour,
        width: f64,
        dashes: &'static [f64],
    ) {
        let stroke = Stroke {
            dashes,
            ..Stroke::solid(colour, width)
        };
        self.marks.push(Mark {
            attachment: self.attachment,
            ..Mark::line(layer, outline, stroke)
        });
    }

    /// Draws an area with a colour and an opacity, and an edge.
    pub(super) fn area(
        &mut self,
        layer: Layer,
        outline: Outline,
        fill: (Colour, f64),
        edge: Option<Colour>,
    ) {
        self.marks.push(Mark {
            layer,
            outline,
            fill: Some(fill),
            stroke: edge.map(|colour| Stroke::solid(colour, LINE)),
            attachment: self.attachment,
            elastic: None,
        });
    }

    /// Draws a line whose points change with a length: each point, in the frame of the
    /// attachment, at length zero, and its change per unit of length.
    pub(super) fn elastic(
        &mut self,
        layer: Layer,
        measure: Measure,
        points: Vec<[Point; 2]>,
        colour: Colour,
        width: f64,
    ) {
        let frame = self.attachment.placement(self.q, self.scale);
        let elastic = Elastic { measure, points };
        let outline = elastic
            .outline(self.q, self.scale)
            .map(|point| frame.outside(point));
        self.marks.push(Mark {
            attachment: self.attachment,
            elastic: Some(elastic),
            ..Mark::line(layer, outline, Stroke::solid(colour, width))
        });
    }

    /// Draws a line with hatching on one side, the sign of ground.
    pub(super) fn hatched(&mut self, [start, end]: [Point; 2], outwards: Point) {
        let along = unit(end - start);
        let length = (end - start).norm();
        let edge = Outline::line(&[start, end]);
        self.line(Layer::Ground, edge, Colour::GROUND, LINE);
        let count = (length / HATCH).round().max(1.0);
        let mut hatching = Outline::default();
        for k in 0..count as usize {
            let foot = start + (k as f64 + 1.0) / count * length * along;
            hatching.add_line(&[foot, foot + HATCH * (outwards - along)]);
        }
        self.line(Layer::Ground, hatching, Colour::GROUND, THIN);
    }

    /// Draws a line from a point to another one, with an arrow there.
    pub(super) fn straight_arrow(
        &mut self,
        layer: Layer,
        [from, to]: [Point; 2],
        colour: Colour,
        width: f64,
    ) {
        let way = to - from;
        let along = unit(way);
        let shaft = Outline::line(&[from, to - IN_ARROW.min(way.norm()) * along]);
        self.line(layer, shaft, colour, width);
        self.tip(layer, to, along, colour);
    }

    /// Draws an arc about a point, from a direction by an angle, both counter-clockwise, with an
    /// arrow at its end.
    pub(super) fn arc_arrow(
        &mut self,
        layer: Layer,
        (center, radius): (Point, f64),
        [start, turn]: [f64; 2],
        colour: Colour,
        width: f64,
    ) {
        let ahead = turn.signum();
        let shaft = turn - ahead * (ARROW[0] / radius).min(turn.abs());
        // On the sheet angles count clockwise.
        let arc = Outline::arc(center, radius, -start, -shaft);
        self.line(layer, arc, colour, width);
        let end = start + turn;
        let chord = on_sheet_direction(end + ahead * (FRAC_PI_2 - 0.5 * ARROW[0] / radius));
        self.tip(
            layer,
            center + radius * on_sheet_direction(end),
            chord,
            colour,
        );
    }

    /// Draws the tip of an arrow.
    pub(super) fn tip(&mut self, layer: Layer, tip: Point, along: Point, colour: Colour) {
        let [length, half] = ARROW;
        let base = tip - length * along;
        let aside = half * across(along);
        if self.open_arrows {
            let shaft = Outline::line(&[base, tip]);
            self.line(layer, shaft, colour, LINE);
            let outline = Outline::line(&[base + aside, tip, base - aside]);
            self.line(layer, outline, colour, LINE);
        } else {
            let outline = Outline::polygon(&[tip, base + aside, base - aside]);
            self.area(layer, outline, (colour, 1.0), None);
        }
    }

    // -- names -------------------------------------------------------------------------------

    /// Writes a text at the best of these places.
    pub(super) fn label(
        &mut self,
        kind: Named,
        text: &str,
        colour: Colour,
        candidates: impl IntoIterator<Item = Candidate>,
    ) {
        let label = Label {
            content: text.to_owned(),
            colour,
            attachment: self.attachment,
            optional: kind == Named::Load,
            candidates: candidates.into_iter().collect(),
        };
        self.labels.push((kind, label));
    }

    /// Offers places for the name of a body; ground has none.
    pub(super) fn offer(
        &mut self,
        body: Option<BodyId>,
        places: impl IntoIterator<Item = Candidate>,
    ) {
        if let Some(body) = body {
            self.body_places[body.index()].extend(places);
        }
    }

    /// Offers places for the name of a body on one side of a line.
    pub(super) fn offer_beside(&mut self, body: Option<BodyId>, line: [Point; 2], side: Point) {
        let parts = [0.5, 0.3, 0.7, 0.1, 0.9].map(|part| (part, 4.0 * f64::abs(part - 0.5)));
        let gaps = [(5.0, 0.0), (13.0, 5.0), (24.0, 12.0)];
        self.offer(body, Candidate::beside(line, &parts, &[(side, 0.0)], &gaps));
    }
}

/// Returns whether a mark shows a body, or a part of it that moves along the body.
fn shows_body(mark: &Mark) -> bool {
    matches!(
        mark.layer,
        Layer::Shape
            | Layer::Slider
            | Layer::Plate
            | Layer::Bar
            | Layer::Wheel
            | Layer::Slot
            | Layer::Block
    )
}

/// Returns the colour of a body or of ground.
pub(super) fn colour_of(body: Option<BodyId>) -> Colour {
    body.map_or(Colour::GROUND, |body| Colour::of_body(body.index()))
}

/// Returns the unit vector of an angle on the sheet, where y points down.
pub(super) fn on_sheet_direction(angle: f64) -> Point {
    direction(-angle)
}

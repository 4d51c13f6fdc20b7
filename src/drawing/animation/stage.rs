//! What stands on the sheet while a mechanism moves, and what it rides on.

use std::f64::consts::PI;

use super::Animation;
use crate::drawing::labels::Placed;
use crate::drawing::outline::{Point, convex_hull};
use crate::drawing::rider::Rider;
use crate::drawing::scene::{Anchor, Frame, Symbol};
use crate::drawing::sheet::{
    Bounds, CAPITALS, MARGIN, Mark, Text, WIDTH, extent, fitting, scale_bar, size,
};
use crate::drawing::symbols::{BESIDE, Pen};

/// Poses that decide how much room the motion needs.
const SAMPLES: usize = 120;
/// Room around the mechanism for its symbols and names.
const AROUND: f64 = 46.0;
/// More points than this with arrows for their rates would hide each other.
const MOST_POINTS: usize = 24;

/// All that is drawn.
pub(super) struct Stage {
    /// Units of the sheet for a metre.
    pub(super) scale: f64,
    /// Upper left corner and size of what is seen.
    pub(super) view: [Point; 2],
    /// The frames that move.
    pub(super) riders: Vec<Rider>,
    /// Marks in the frames of their riders, in the order in which one covers the other.
    pub(super) marks: Vec<(usize, Mark)>,
    pub(super) labels: Vec<(usize, Placed)>,
    pub(super) lengths: Vec<LengthDriver>,
    /// Points whose rates are shown by arrows.
    pub(super) points: Vec<(usize, Anchor)>,
    /// The text beside the bar that shows the scale.
    pub(super) scale_text: Text,
}

/// A driver of a length, which changes its shape.
pub(super) struct LengthDriver {
    pub(super) rider: usize,
    pub(super) markers: [Anchor; 2],
    pub(super) axis: Option<Anchor>,
    /// How far beside its line it is drawn, in the rider's frame.
    pub(super) offset: f64,
}

impl Stage {
    pub(super) fn new(animation: &Animation) -> Self {
        let moments = &animation.moments;
        let every = moments.len().div_ceil(SAMPLES).max(1);
        let sampled = || moments.iter().step_by(every).map(|m| m.q.as_slice());
        let scene = &animation.scene;
        let q = moments.first().map_or(&[][..], |moment| &moment.q);
        let extent = extent(scene, sampled());
        let room = size(scene, q, extent, WIDTH) - Point::repeat(2.0 * (MARGIN + AROUND));
        let scale = fitting(room, extent);

        let mut pen = Pen::moving(scene, q, scale);
        let mut of_symbols = Vec::new();
        let mut riders = vec![Rider::Ground];
        let mut lengths = Vec::new();
        for symbol in &scene.symbols {
            let before = pen.drawn();
            pen.draw(symbol);
            let rider = place_of(&mut riders, Rider::of_symbol(symbol));
            of_symbols.extend(std::iter::repeat_n(rider, pen.drawn() - before));
            if let Symbol::LengthDriver {
                from,
                to,
                axis,
                beside,
                ..
            } = symbol
            {
                let markers = [*from, *to];
                let side = pen.side_of_length(markers, *axis);
                lengths.push(LengthDriver {
                    rider,
                    markers,
                    axis: *axis,
                    offset: if *beside { BESIDE * side } else { 0.0 },
                });
            }
        }
        let (marks, labels) = pen.finish();
        let labels: Vec<(usize, Placed)> = (labels.into_iter())
            .map(|label| (place_of(&mut riders, label.follows), label))
            .collect();
        let mut marks: Vec<(usize, Mark)> = of_symbols.into_iter().zip(marks).collect();
        marks.sort_by_key(|(_, mark)| mark.layer);
        let home: Vec<Placement> = riders.iter().map(|r| Placement::new(r, q, scale)).collect();
        for (rider, mark) in &mut marks {
            mark.outline = mark.outline.map(|p| home[*rider].inside(p));
        }
        let points = points(&mut riders, animation);
        let mut stage = Self {
            scale,
            view: [Point::zeros(); 2],
            riders,
            marks,
            labels,
            lengths,
            points,
            scale_text: scale_bar(Point::zeros(), scale).1,
        };
        stage.frame(q, sampled());
        stage
    }

    /// Finds what is seen over the motion, and puts the scale below it.
    fn frame<'a>(&mut self, home: &[f64], poses: impl Iterator<Item = &'a [f64]>) {
        let mut corners: Vec<Vec<Point>> = vec![Vec::new(); self.riders.len()];
        for (rider, mark) in &self.marks {
            corners[*rider].extend(mark.outline.flattened().into_iter().flatten());
        }
        for corners in &mut corners {
            *corners = convex_hull(corners);
        }
        let homes: Vec<Placement> = self.placements(home);
        let mut bounds = Bounds::NONE;
        for q in poses {
            let placements = self.placements(q);
            for (placement, corners) in placements.iter().zip(&corners) {
                for corner in corners {
                    bounds.add(placement.outside(*corner));
                }
            }
            for (rider, label) in &self.labels {
                let (home, now) = (&homes[*rider], &placements[*rider]);
                let mut place = label.place;
                place.anchor = now.outside(home.inside(place.anchor));
                place.side = place.side.map(|side| now.turned(home.turned_back(side)));
                let size = Point::new(label.text.width(), CAPITALS);
                let center = place.center(size);
                bounds.add(center - 0.5 * size);
                bounds.add(center + 0.5 * size);
            }
            for driver in &self.lengths {
                for marker in driver.markers {
                    let at = Placement::new(&Rider::Point(marker), q, self.scale).origin;
                    let room = Point::repeat(driver.offset.abs() + 4.0);
                    bounds.add(at - room);
                    bounds.add(at + room);
                }
            }
        }
        let corner = Point::new(bounds.low.x, bounds.high.y + 16.0);
        let (bar, text) = scale_bar(corner, self.scale);
        for point in bar.outline.flattened().into_iter().flatten() {
            bounds.add(point);
        }
        bounds.add(text.start + Point::new(text.width(), 0.0));
        self.marks.push((0, bar));
        self.scale_text = text;
        let margin = Point::repeat(MARGIN);
        self.view = [bounds.low - margin, bounds.size() + 2.0 * margin];
    }

    /// Where all riders are at q.
    pub(super) fn placements(&self, q: &[f64]) -> Vec<Placement> {
        let riders = self.riders.iter();
        riders.map(|r| Placement::new(r, q, self.scale)).collect()
    }
}

/// The index of a rider, which is added if it is new.
fn place_of(riders: &mut Vec<Rider>, rider: Rider) -> usize {
    let known = riders.iter().position(|known| *known == rider);
    known.unwrap_or_else(|| {
        riders.push(rider);
        riders.len() - 1
    })
}

/// The points of interest, and the joints that move; each place once.
fn points(riders: &mut Vec<Rider>, animation: &Animation) -> Vec<(usize, Anchor)> {
    let symbols = &animation.scene.symbols;
    let of_interest = symbols.iter().filter_map(|symbol| match symbol {
        Symbol::Point { at, .. } => Some(*at),
        _ => None,
    });
    let joints = symbols.iter().filter_map(|symbol| match symbol {
        Symbol::Pin { at } | Symbol::Block { at, .. } | Symbol::Roller { at, .. } => Some(*at),
        _ => None,
    });
    let (Some(first), Some(middle)) = (
        animation.moments.first(),
        animation.moments.get(animation.moments.len() / 3),
    ) else {
        return Vec::new();
    };
    let places = |anchor: &Anchor| [first, middle].map(|moment| anchor.placed(&moment.q).point);
    let mut points: Vec<(usize, Anchor)> = Vec::new();
    let mut known: Vec<[Point; 2]> = Vec::new();
    for anchor in of_interest.chain(joints) {
        let at = places(&anchor);
        let near = |other: &[Point; 2]| {
            let apart = (at[0] - other[0]).norm() + (at[1] - other[1]).norm();
            apart < 1e-9 * (1.0 + at[0].norm())
        };
        if anchor.body.is_some() && !known.iter().any(near) && points.len() < MOST_POINTS {
            known.push(at);
            points.push((place_of(riders, Rider::of(anchor)), anchor));
        }
    }
    points
}

/// A frame on the sheet, where y points down and angles count clockwise.
#[derive(Clone, Copy)]
pub(super) struct Placement {
    pub(super) origin: Point,
    /// \[rad\], from -π to π.
    pub(super) angle: f64,
}

impl Placement {
    pub(super) fn new(rider: &Rider, q: &[f64], scale: f64) -> Self {
        let Frame { point, angle } = rider.frame(q);
        Self {
            origin: scale * Point::new(point.x, -point.y),
            angle: (PI - angle).rem_euclid(2.0 * PI) - PI,
        }
    }

    fn turned(&self, v: Point) -> Point {
        nalgebra::Rotation2::new(self.angle) * v
    }

    /// A direction of the sheet in the frame.
    pub(super) fn turned_back(&self, v: Point) -> Point {
        nalgebra::Rotation2::new(-self.angle) * v
    }

    /// A point of the frame on the sheet.
    pub(super) fn outside(&self, point: Point) -> Point {
        self.origin + self.turned(point)
    }

    /// A point of the sheet in the frame.
    pub(super) fn inside(&self, point: Point) -> Point {
        self.turned_back(point - self.origin)
    }
}

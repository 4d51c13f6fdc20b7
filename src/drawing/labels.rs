//! Where names go: near what they name, clear of everything else.

use super::lettering;
use super::outline::Point;
use super::palette::Colour;
use super::rider::Rider;
use super::sheet::{Bounds, CAPITALS, Layer, Mark, Text};

/// A text that looks for its place.
pub(super) struct Label {
    pub(super) content: String,
    pub(super) colour: Colour,
    /// What it stays with when the mechanism moves.
    pub(super) follows: Rider,
    /// Whether it is rather left out than written over another one.
    pub(super) may_miss: bool,
    pub(super) candidates: Vec<Candidate>,
}

/// A label that has its place.
pub(super) struct Placed {
    pub(super) text: Text,
    pub(super) follows: Rider,
    pub(super) place: Candidate,
}

/// A place for a label.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// Where it has to be near.
    pub(super) anchor: Point,
    /// A unit vector: the label lies on this side of the anchor, beside it; none: on it.
    pub(super) side: Option<Point>,
    /// The gap between the two.
    pub(super) gap: f64,
    /// How much worse than the best place it is, in lengths of line covered.
    pub(super) cost: f64,
}

/// What stays free around a label.
const PAD: f64 = 2.0;
/// What an overlap with another label costs, a unit of area.
const ON_LABEL: f64 = 4.0;
/// What a label on the area of another body costs.
const ON_AREA: f64 = 14.0;
/// What a label on a wheel or a cam costs: they are large and pale.
pub(super) const ON_WHEEL: f64 = 3.0;
/// A place has to be this much better: rounding decides nothing.
const BETTER: f64 = 1e-6;

/// Gives each label in turn the best of its places. Those that may be missing are, where no
/// place is clear of the labels before them.
pub(super) fn place<'a>(labels: Vec<Label>, marks: impl Iterator<Item = &'a Mark>) -> Vec<Placed> {
    let obstacles: Vec<Obstacle> = marks.map(Obstacle::new).collect();
    let mut taken: Vec<Bounds> = Vec::new();
    let mut placed = Vec::new();
    for label in labels {
        let size = Point::new(lettering::width(&label.content, CAPITALS), CAPITALS);
        let mut best: Option<(f64, Candidate)> = None;
        let clear = |candidate: &&Candidate| {
            let center = candidate.center(size);
            let bounds = Bounds {
                low: center - 0.5 * size,
                high: center + 0.5 * size,
            };
            !label.may_miss || taken.iter().all(|other| overlap(&bounds, other) <= 0.0)
        };
        for candidate in label.candidates.iter().filter(clear) {
            let center = candidate.center(size);
            let bounds = around(center, size);
            let on_labels: f64 = taken.iter().map(|other| overlap(&bounds, other)).sum();
            let on_marks: f64 = obstacles.iter().map(|o| o.cost(&bounds, center)).sum();
            let cost = candidate.cost + ON_LABEL * on_labels + on_marks;
            if best.is_none_or(|(least, _)| cost < least - BETTER) {
                best = Some((cost, *candidate));
            }
        }
        if let Some((_, place)) = best {
            let center = place.center(size);
            taken.push(around(center, size));
            placed.push(Placed {
                text: Text {
                    content: label.content,
                    start: center + Point::new(-0.5 * size.x, 0.5 * size.y),
                    colour: label.colour,
                },
                follows: label.follows,
                place,
            });
        }
    }
    placed
}

impl Candidate {
    /// The middle of a label of this size.
    pub(super) fn center(&self, size: Point) -> Point {
        self.side.map_or(self.anchor, |side| {
            // As far out as the side of the text's box that faces the anchor.
            let reach = 0.5 * (size.x * side.x.abs() + size.y * side.y.abs());
            self.anchor + (self.gap + reach) * side
        })
    }
}

fn around(center: Point, size: Point) -> Bounds {
    let half = 0.5 * size + Point::repeat(PAD);
    Bounds {
        low: center - half,
        high: center + half,
    }
}

fn overlap(a: &Bounds, b: &Bounds) -> f64 {
    let common = a.high.inf(&b.high) - a.low.sup(&b.low);
    common.x.max(0.0) * common.y.max(0.0)
}

/// A mark that labels had better not cover.
struct Obstacle {
    pieces: Vec<[Point; 2]>,
    bounds: Bounds,
    /// What a unit of its line costs.
    line: f64,
    area: f64,
}

impl Obstacle {
    fn new(mark: &Mark) -> Self {
        let pieces = mark.outline.flattened();
        let mut bounds = Bounds::NONE;
        for point in pieces.iter().flatten() {
            bounds.add(*point);
        }
        let line = match mark.layer {
            Layer::Trace => 0.6,
            Layer::Wheel | Layer::Plate | Layer::Bar | Layer::Slot => 1.5,
            Layer::Ground | Layer::Driver | Layer::Scale | Layer::Grid | Layer::Curve => 2.5,
            Layer::Slider | Layer::Block | Layer::Joint | Layer::Point => 4.0,
        };
        let area = match mark.layer {
            Layer::Wheel if mark.fill.is_some() => ON_WHEEL,
            Layer::Slider | Layer::Plate | Layer::Bar | Layer::Block if mark.fill.is_some() => {
                ON_AREA
            }
            _ => 0.0,
        };
        Self {
            pieces,
            bounds,
            line,
            area,
        }
    }

    fn cost(&self, label: &Bounds, center: Point) -> f64 {
        if overlap(&self.bounds_padded(), label) <= 0.0 {
            return 0.0;
        }
        let covered: f64 = self.pieces.iter().map(|piece| inside(*piece, label)).sum();
        let area = if self.area > 0.0 && self.contains(center) {
            self.area
        } else {
            0.0
        };
        self.line * covered + area
    }

    /// Lines along an axis have no area of their own.
    fn bounds_padded(&self) -> Bounds {
        let pad = Point::repeat(1.0);
        Bounds {
            low: self.bounds.low - pad,
            high: self.bounds.high + pad,
        }
    }

    /// Whether a point lies inside: a ray from it meets the outline an odd number of times.
    fn contains(&self, p: Point) -> bool {
        let crossings = self.pieces.iter().filter(|[a, b]| {
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)
        });
        crossings.count() % 2 == 1
    }
}

/// The length of a line that lies inside a rectangle (Liang–Barsky).
fn inside([a, b]: [Point; 2], bounds: &Bounds) -> f64 {
    let along = b - a;
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (low, high) = (bounds.low[axis] - a[axis], bounds.high[axis] - a[axis]);
        if along[axis].abs() < 1e-12 {
            if low > 0.0 || high < 0.0 {
                return 0.0;
            }
            continue;
        }
        let (s, t) = (low / along[axis], high / along[axis]);
        enter = enter.max(s.min(t));
        leave = leave.min(s.max(t));
    }
    (leave - enter).max(0.0) * along.norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_of_a_line_inside_a_rectangle_is_measured() {
        let bounds = Bounds {
            low: Point::zeros(),
            high: Point::new(4.0, 2.0),
        };
        for (line, expected) in [
            ([[-1.0, 1.0], [9.0, 1.0]], 4.0),
            ([[1.0, 1.0], [2.0, 1.0]], 1.0),
            ([[-1.0, 3.0], [9.0, 3.0]], 0.0),
            ([[2.0, -5.0], [2.0, 1.0]], 1.0),
            ([[-1.0, -1.0], [5.0, 5.0]], 8_f64.sqrt()),
        ] {
            let line = line.map(|[x, y]| Point::new(x, y));
            assert!((inside(line, &bounds) - expected).abs() < 1e-12, "{line:?}");
        }
    }
}

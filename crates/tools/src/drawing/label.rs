//! Places of names: near the thing named, clear of everything else.

use std::f64::consts::{PI, TAU};

use super::attachment::{Attachment, Placement};
use super::lettering;
use super::outline::{Point, contains, direction};
use super::palette::Colour;
use super::sheet::{Bounds, CAPITALS, Layer, Mark, Text};

/// A text that needs a place.
pub(super) struct Label {
    pub(super) content: String,
    pub(super) colour: Colour,
    /// The frame that it moves with.
    pub(super) attachment: Attachment,
    /// Whether it is left out where every place overlaps another label.
    pub(super) optional: bool,
    pub(super) candidates: Vec<Candidate>,
}

/// A label at its place.
pub(super) struct Placed {
    pub(super) text: Text,
    pub(super) attachment: Attachment,
    pub(super) place: Candidate,
}

/// A place for a label.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// The point that the label names.
    pub(super) anchor: Point,
    /// Unit vector towards the label, which lies beside the anchor; `None` for a label on it.
    pub(super) side: Option<Point>,
    /// Gap between the anchor and the label.
    pub(super) gap: f64,
    /// Penalty against the best place, in lengths of line covered.
    pub(super) cost: f64,
}

/// A number with its penalty: a part of a line or a gap.
pub(super) type Graded = (f64, f64);

/// Free space around a label.
const PAD: f64 = 2.0;
/// Cost of an overlap with another label, per unit of area.
const ON_LABEL: f64 = 4.0;
/// Cost of a label on the area of another body.
const ON_AREA: f64 = 14.0;
/// Cost of a label on a wheel or a cam: they are large and pale.
pub(super) const ON_WHEEL: f64 = 3.0;
/// Least difference in cost that counts: rounding decides nothing.
const BETTER: f64 = 1e-6;
/// Difference in cost of places among which the order of the candidates may decide.
const AS_GOOD: f64 = 3.0 * BETTER;

impl Placed {
    /// Returns its middle after its frame has moved from one placement to another.
    pub(super) fn center(&self, frames: [Placement; 2]) -> Point {
        self.place.moved(frames).center(self.text.size())
    }
}

impl Candidate {
    /// Returns places beside a line: at parts of its length, on sides, at gaps.
    pub(super) fn beside(
        [start, end]: [Point; 2],
        parts: &[Graded],
        sides: &[(Point, f64)],
        gaps: &[Graded],
    ) -> Vec<Self> {
        let mut places = Vec::with_capacity(parts.len() * sides.len() * gaps.len());
        for (part, of_part) in parts {
            for (side, of_side) in sides {
                for (gap, of_gap) in gaps {
                    places.push(Self {
                        anchor: start + *part * (end - start),
                        side: Some(*side),
                        gap: *gap,
                        cost: of_part + of_side + of_gap,
                    });
                }
            }
        }
        places
    }

    /// Returns places around a circle: right and above first, as one reads.
    pub(super) fn around(center: Point, radius: f64) -> impl Iterator<Item = Self> {
        const SIDES: u32 = 16;
        [(3.0, 0.0), (10.0, 4.0), (20.0, 10.0)]
            .into_iter()
            .flat_map(move |(gap, far)| {
                (0..SIDES).map(move |k| {
                    let turn = f64::from(k) / f64::from(SIDES) * TAU;
                    let from_best = (turn - 0.25 * PI).cos();
                    Self {
                        anchor: center,
                        side: Some(direction(-turn)),
                        gap: gap + radius,
                        cost: far + 1.0 - from_best,
                    }
                })
            })
    }

    /// Returns the place with a further penalty.
    pub(super) fn costlier(self, by: f64) -> Self {
        Self {
            cost: self.cost + by,
            ..self
        }
    }

    /// Returns the place after its frame has moved from one placement to another.
    pub(super) fn moved(&self, [from, to]: [Placement; 2]) -> Self {
        Self {
            anchor: to.outside(from.inside(self.anchor)),
            side: self.side.map(|side| to.turned(from.turned_back(side))),
            ..*self
        }
    }

    /// Returns the middle of a label of this size.
    pub(super) fn center(&self, size: Point) -> Point {
        self.side.map_or(self.anchor, |side| {
            // The side of the text's box that faces the anchor keeps the gap.
            let reach = 0.5 * (size.x * side.x.abs() + size.y * side.y.abs());
            self.anchor + (self.gap + reach) * side
        })
    }
}

/// Gives each label in turn its best place: at the pose `home`, at which the marks are drawn, and
/// on average over the poses of a motion, during which a label keeps its place in its frame.
/// Optional labels without a place clear of the labels before them at `home` are left out.
pub(super) fn place(
    labels: Vec<Label>,
    marks: &[Mark],
    home: &[f64],
    motion: &[&[f64]],
    scale: f64,
) -> Vec<Placed> {
    let poses = std::iter::once(home).chain(motion.iter().copied());
    let mut views: Vec<View> = poses
        .map(|q| View {
            q,
            obstacles: marks
                .iter()
                .map(|mark| Obstacle::new(&mark.moved(home, q, scale)))
                .collect(),
            taken: Vec::new(),
        })
        .collect();
    let share = 1.0 / views.len() as f64;
    let mut placed = Vec::new();
    for label in labels {
        let size = Point::new(lettering::width(&label.content, CAPITALS), CAPITALS);
        let padded = size + Point::repeat(2.0 * PAD);
        let at = |q: &[f64]| label.attachment.placement(q, scale);
        let frames: Vec<[Placement; 2]> = views.iter().map(|v| [at(home), at(v.q)]).collect();
        let clear = |candidate: &&Candidate| {
            let bounds = Bounds::about(candidate.center(size), size);
            let taken = &views[0].taken;
            !label.optional || taken.iter().all(|other| bounds.overlap(other) <= 0.0)
        };
        // Good places first, so that few others are worth a look.
        let mut cheapest: Vec<(usize, &Candidate)> = (label.candidates.iter().enumerate())
            .filter(|(_, c)| clear(c))
            .collect();
        cheapest.sort_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost));
        let mut least = f64::INFINITY;
        let mut good: Vec<(usize, f64)> = Vec::new();
        for (number, candidate) in cheapest {
            let most = least + AS_GOOD;
            let mut cost = candidate.cost;
            for (view, frames) in views.iter().zip(&frames) {
                if cost > most {
                    break;
                }
                let center = candidate.moved(*frames).center(size);
                let bounds = Bounds::about(center, padded);
                cost += share * view.cost(&bounds, center, (most - cost) / share);
            }
            if cost <= most {
                good.push((number, cost));
                least = least.min(cost);
            }
        }
        good.sort_by_key(|(number, _)| *number);
        let better = |best: (usize, f64), other: (usize, f64)| {
            if other.1 < best.1 - BETTER {
                other
            } else {
                best
            }
        };
        let Some((best, _)) = good.into_iter().reduce(better) else {
            continue;
        };
        let place = label.candidates[best];
        for (view, frames) in views.iter_mut().zip(frames) {
            let center = place.moved(frames).center(size);
            view.taken.push(Bounds::about(center, padded));
        }
        placed.push(Placed {
            text: Text {
                content: label.content,
                start: place.center(size) + Point::new(-0.5 * size.x, 0.5 * size.y),
                colour: label.colour,
            },
            attachment: label.attachment,
            place,
        });
    }
    placed
}

/// A pose as labels see it.
struct View<'a> {
    q: &'a [f64],
    obstacles: Vec<Obstacle>,
    /// The labels placed so far.
    taken: Vec<Bounds>,
}

impl View<'_> {
    /// Returns the cost of a label with its middle at `center`, or a part of it above `most`.
    fn cost(&self, label: &Bounds, center: Point, most: f64) -> f64 {
        let on_labels: f64 = self.taken.iter().map(|other| label.overlap(other)).sum();
        let on_labels = ON_LABEL * on_labels;
        let mut on_marks = 0.0;
        for obstacle in &self.obstacles {
            if on_labels + on_marks > most {
                break;
            }
            on_marks += obstacle.cost(label, center);
        }
        on_labels + on_marks
    }
}

/// A mark that labels keep clear of.
struct Obstacle {
    /// Pieces of the outline, a few neighbours in each part.
    parts: Vec<Part>,
    bounds: Bounds,
    /// Cost per unit of its line covered.
    line: f64,
    /// Cost of a label with its middle in the area.
    area: f64,
}

/// Neighbouring pieces of an outline.
struct Part {
    pieces: Vec<[Point; 2]>,
    bounds: Bounds,
}

/// Pieces in a part of an outline.
const PIECES: usize = 8;

impl Part {
    fn new(pieces: &[[Point; 2]]) -> Self {
        let mut bounds = Bounds::NONE;
        for point in pieces.iter().flatten() {
            bounds.add(*point);
        }
        // Lines along an axis have no area of their own.
        let one = Point::repeat(1.0);
        Self {
            pieces: pieces.to_vec(),
            bounds: Bounds {
                low: bounds.low - one,
                high: bounds.high + one,
            },
        }
    }
}

impl Obstacle {
    fn new(mark: &Mark) -> Self {
        let parts: Vec<Part> = mark
            .outline
            .flattened()
            .chunks(PIECES)
            .map(Part::new)
            .collect();
        let mut bounds = Bounds::NONE;
        for part in &parts {
            bounds.join(&part.bounds);
        }
        let line = match mark.layer {
            Layer::Trace | Layer::Pose | Layer::Shape => 0.6,
            Layer::Wheel | Layer::Plate | Layer::Bar | Layer::Slot | Layer::Dimension => 1.5,
            Layer::Ground | Layer::Driver | Layer::Scale | Layer::Grid | Layer::Curve => 2.5,
            Layer::Slider | Layer::Block | Layer::Joint | Layer::Point | Layer::Force => 4.0,
        };
        let area = match mark.layer {
            Layer::Wheel if mark.fill.is_some() => ON_WHEEL,
            Layer::Slider | Layer::Plate | Layer::Bar | Layer::Block if mark.fill.is_some() => {
                ON_AREA
            }
            _ => 0.0,
        };
        Self {
            parts,
            bounds,
            line,
            area,
        }
    }

    fn cost(&self, label: &Bounds, center: Point) -> f64 {
        if !self.bounds.meets(label) {
            return 0.0;
        }
        let near = self.parts.iter().filter(|part| part.bounds.meets(label));
        let pieces = near.flat_map(|part| &part.pieces);
        let covered: f64 = pieces.map(|piece| inside(*piece, label)).sum();
        let all = self
            .parts
            .iter()
            .flat_map(|part| part.pieces.iter().copied());
        let area = if self.area > 0.0 && contains(all, center) {
            self.area
        } else {
            0.0
        };
        self.line * covered + area
    }
}

/// Returns the length of the part of a line inside a rectangle (Liang–Barsky).
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

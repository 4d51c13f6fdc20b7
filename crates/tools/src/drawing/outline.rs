//! Lines and curves in the plane, and the outlines that symbols are made of.

use nalgebra::Vector2;

/// A point or a direction in the plane.
pub(super) type Point = Vector2<f64>;

/// A piece of an [`Outline`]; each starts where the one before ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Segment {
    /// The start of another line.
    Move(Point),
    /// A straight line.
    Line(Point),
    /// A cubic Bézier curve: two control points and the end.
    Curve([Point; 3]),
    /// A straight line back to the start.
    Close,
}

/// One or several lines, open or closed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Outline(pub(super) Vec<Segment>);

impl Outline {
    /// Returns a polyline.
    pub(super) fn line(points: &[Point]) -> Self {
        let mut outline = Self::default();
        outline.add_line(points);
        outline
    }

    /// Returns a closed polygon.
    pub(super) fn polygon(points: &[Point]) -> Self {
        let mut outline = Self::line(points);
        outline.0.push(Segment::Close);
        outline
    }

    /// Returns a circle.
    pub(super) fn circle(center: Point, radius: f64) -> Self {
        let mut outline = Self::arc(center, radius, 0.0, std::f64::consts::TAU);
        outline.0.push(Segment::Close);
        outline
    }

    /// Returns an arc from one direction by an angle, which may be negative.
    pub(super) fn arc(center: Point, radius: f64, from: f64, by: f64) -> Self {
        let mut outline = Self::default();
        outline
            .0
            .push(Segment::Move(center + radius * direction(from)));
        outline.add_arc(center, radius, from, by);
        outline
    }

    /// Returns a rectangle about a point, its length along a direction.
    pub(super) fn block(center: Point, along: Point, [length, height]: [f64; 2]) -> Self {
        let half = 0.5 * length * along;
        let up = 0.5 * height * across(along);
        Self::polygon(&[
            center - half - up,
            center + half - up,
            center + half + up,
            center - half + up,
        ])
    }

    /// Returns the outline at a distance around the convex hull of points: a disc, a rounded bar
    /// or a rounded polygon.
    pub(super) fn around(points: &[Point], distance: f64) -> Self {
        let hull = convex_hull(points);
        if let [center] = hull[..] {
            return Self::circle(center, distance);
        }
        let mut outline = Self::default();
        for (index, corner) in hull.iter().enumerate() {
            let before = hull[(index + hull.len() - 1) % hull.len()];
            let after = hull[(index + 1) % hull.len()];
            // The hull runs counter-clockwise: outwards is to the right.
            let from = angle(-across(corner - before));
            let turn = (angle(-across(after - corner)) - from).rem_euclid(std::f64::consts::TAU);
            let start = corner + distance * direction(from);
            outline.0.push(if index == 0 {
                Segment::Move(start)
            } else {
                Segment::Line(start)
            });
            outline.add_arc(*corner, distance, from, turn);
        }
        outline.0.push(Segment::Close);
        outline
    }

    /// Adds a polyline.
    pub(super) fn add_line(&mut self, points: &[Point]) {
        for (index, point) in points.iter().enumerate() {
            self.0.push(if index == 0 {
                Segment::Move(*point)
            } else {
                Segment::Line(*point)
            });
        }
    }

    /// Continues straight to a point.
    pub(super) fn continue_to(&mut self, to: Point) {
        self.0.push(Segment::Line(to));
    }

    /// Closes the last line.
    pub(super) fn close(&mut self) {
        self.0.push(Segment::Close);
    }

    /// Continues along an arc from its first point.
    pub(super) fn add_arc(&mut self, center: Point, radius: f64, from: f64, by: f64) {
        // Up to a quarter turn a cubic is within 3e-4 of the radius.
        let pieces = (by.abs() / std::f64::consts::FRAC_PI_2 - 1e-9)
            .ceil()
            .max(1.0);
        let step = by / pieces;
        let handle = 4.0 / 3.0 * (step / 4.0).tan() * radius;
        for piece in 0..pieces as usize {
            let (u, v) = (
                direction(from + piece as f64 * step),
                direction(from + (piece + 1) as f64 * step),
            );
            let end = center + radius * v;
            self.0.push(Segment::Curve([
                center + radius * u + handle * across(u),
                end - handle * across(v),
                end,
            ]));
        }
    }

    /// Returns straight pieces in place of the outline, fine enough to measure distances on a
    /// sheet.
    pub(super) fn flattened(&self) -> Vec<[Point; 2]> {
        const PIECES: usize = 6;
        let mut pieces = Vec::new();
        let (mut start, mut at) = (Point::zeros(), Point::zeros());
        for segment in &self.0 {
            match *segment {
                Segment::Move(to) => (start, at) = (to, to),
                Segment::Line(to) => {
                    pieces.push([at, to]);
                    at = to;
                }
                Segment::Curve([c, d, to]) => {
                    let mut last = at;
                    for piece in 1..=PIECES {
                        let s = piece as f64 / PIECES as f64;
                        let r = 1.0 - s;
                        let next = at * r.powi(3)
                            + c * (3.0 * r * r * s)
                            + d * (3.0 * r * s * s)
                            + to * s.powi(3);
                        pieces.push([last, next]);
                        last = next;
                    }
                    at = to;
                }
                Segment::Close => {
                    pieces.push([at, start]);
                    at = start;
                }
            }
        }
        pieces
    }

    /// Returns the outline under a map of the plane that keeps straight lines straight.
    pub(super) fn map(&self, map: impl Fn(Point) -> Point) -> Self {
        let segments = self.0.iter().map(|segment| match *segment {
            Segment::Move(to) => Segment::Move(map(to)),
            Segment::Line(to) => Segment::Line(map(to)),
            Segment::Curve(points) => Segment::Curve(points.map(&map)),
            Segment::Close => Segment::Close,
        });
        Self(segments.collect())
    }
}

/// Returns the unit vector of an angle.
pub(super) fn direction(angle: f64) -> Point {
    Point::new(angle.cos(), angle.sin())
}

/// Returns the angle of a vector.
pub(super) fn angle(v: Point) -> f64 {
    v.y.atan2(v.x)
}

/// Returns the least and the greatest of some numbers; infinities if there are none.
pub(super) fn extremes(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], number| {
        [low.min(number), high.max(number)]
    })
}

/// Returns the least and the greatest of the numbers that are finite; zeros if there are none.
pub(super) fn finite_extremes<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> [f64; 2] {
    let finite = numbers.into_iter().copied().filter(|n| n.is_finite());
    let [low, high] = extremes(finite);
    if low <= high { [low, high] } else { [0.0; 2] }
}

/// Returns a vector turned by a quarter turn, counter-clockwise.
pub(super) fn across(v: Point) -> Point {
    Point::new(-v.y, v.x)
}

/// Returns the unit vector along `v`, or along the x-axis if `v` has no length.
pub(super) fn unit(v: Point) -> Point {
    v.try_normalize(1e-12).unwrap_or_else(Point::x)
}

/// Returns the ends of a common tangent of circles about two points, whose radii are positive for a
/// circle on the left of the way from the first to the second. Of circles that overlap it returns the
/// centres.
pub(super) fn tangent(centers: [Point; 2], radii: [f64; 2]) -> [Point; 2] {
    let (d, offset) = (centers[1] - centers[0], radii[1] - radii[0]);
    let square = d.norm_squared();
    let length = (square - offset * offset).max(0.0).sqrt();
    if length == 0.0 {
        return centers;
    }
    let normal = across((length * d - offset * across(d)) / square);
    [
        centers[0] - radii[0] * normal,
        centers[1] - radii[1] * normal,
    ]
}

/// Returns whether a point lies inside closed lines: a ray from it meets them an odd number of
/// times.
pub(super) fn contains(pieces: impl Iterator<Item = [Point; 2]>, p: Point) -> bool {
    let crossed = pieces.filter(|[a, b]| {
        (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)
    });
    crossed.count() % 2 == 1
}

/// Returns the corners of the convex hull, counter-clockwise from the leftmost, without points
/// on its edges to within rounding (Andrew's monotone chains).
pub(super) fn convex_hull(points: &[Point]) -> Vec<Point> {
    let before = |a: &Point, b: &Point| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y));
    let mut sorted = points.to_vec();
    sorted.sort_unstable_by(before);
    let Some(&start) = sorted.first() else {
        return Vec::new();
    };
    let turn = |a: Point, b: Point, c: Point| (b - a).perp(&(c - a));
    let chain = |sorted: &mut dyn Iterator<Item = &Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for &point in sorted {
            while let [.., a, b] = chain[..]
                && turn(a, b, point) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain
    };
    let mut hull = chain(&mut sorted.iter());
    hull.extend(chain(&mut sorted.iter().rev()).into_iter().skip(1));
    // Rounding leaves corners next to each other and on edges; the start comes twice.
    let extent = sorted
        .iter()
        .map(|p| (p - start).norm())
        .fold(0.0, f64::max);
    let near = 1e-9 * extent;
    let is_corner = |hull: &[Point], k: usize| {
        let (last, next) = (
            hull[(k + hull.len() - 1) % hull.len()],
            hull[(k + 1) % hull.len()],
        );
        let is_between = (hull[k] - last).dot(&(hull[k] - next)) <= 0.0;
        let is_on_edge = is_between && turn(last, hull[k], next).abs() <= near * extent;
        (hull[k] - last).norm() > near && !is_on_edge
    };
    while hull.len() > 1
        && let Some(k) = (0..hull.len()).rev().find(|&k| !is_corner(&hull, k))
    {
        hull.remove(k);
    }
    let first = (0..hull.len()).min_by(|&i, &j| before(&hull[i], &hull[j]));
    hull.rotate_left(first.unwrap_or(0));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hull_leaves_out_points_inside_and_on_edges() {
        let points = [[0, 0], [2, 0], [1, 0], [1, 1], [2, 2], [0, 2], [0, 0]]
            .map(|[x, y]| Point::new(f64::from(x), f64::from(y)));
        let hull = convex_hull(&points);
        let expected = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        assert_eq!(hull, expected.map(|[x, y]| Point::new(x, y)));
        // Points on a line have its two ends as their hull, in any direction.
        let line: Vec<_> = (0..5).map(|k| f64::from(k) * direction(0.3)).collect();
        assert_eq!(convex_hull(&line), [line[0], line[4]]);
        assert_eq!(convex_hull(&points[..1]), points[..1]);
        // Rounding orders neither the points of a vertical edge nor equal points.
        let e = 1e-16;
        let upright =
            [(0.0, 0.0), (e, 0.5), (-e, 1.0), (2.0 * e, 0.0)].map(|(x, y)| Point::new(x, y));
        assert_eq!(convex_hull(&upright).len(), 2);
        let twice = [(e, 0.0), (0.0, 0.0), (0.0, 0.25)].map(|(x, y)| Point::new(x, y));
        assert_eq!(convex_hull(&twice).len(), 2);
        let with_corner = [&upright[..], &[Point::new(1.0, 0.0)]].concat();
        let hull = convex_hull(&with_corner);
        assert_eq!(hull.len(), 3);
        assert!(hull.iter().any(|p| p.norm() < 1e-9), "{hull:?}");
    }

    #[test]
    fn outline_around_points_keeps_its_distance() {
        let points = [Point::zeros(), Point::new(10.0, 0.0), Point::new(3.0, 4.0)];
        for count in 1..=3 {
            let corners = &points[..count];
            for [from, to] in Outline::around(corners, 2.0).flattened() {
                let middle = 0.5 * (from + to);
                let hull = convex_hull(corners);
                let distance = (0..hull.len())
                    .map(|k| distance_to(hull[k], hull[(k + 1) % hull.len()], middle))
                    .fold(f64::INFINITY, f64::min);
                // A chord of a sixth of a quarter turn is 2 (1 - cos 7.5°) inside its arc, and
                // the cubic 3e-4 of the radius off it.
                assert!(distance < 2.001 && distance > 2.0 - 0.018, "{distance}");
            }
        }
    }

    fn distance_to(a: Point, b: Point, p: Point) -> f64 {
        let along = b - a;
        let s = if along.norm() > 0.0 {
            ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (a + s * along - p).norm()
    }
}

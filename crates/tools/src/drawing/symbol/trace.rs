//! Paths of points of interest.

use super::*;

/// The path of a point of interest over ground, or a piece of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// The body of the point, `None` for ground.
    pub body: Option<BodyId>,
    /// The path \[m\].
    pub points: Vec<[f64; 2]>,
}

/// Greatest distance of two paths that look like one, as a part of the path's extent.
const NEAR: f64 = 2e-3;
/// Least length of path, in such distances, between two points of the path that count as two
/// visits of one place.
const FAR_ALONG: f64 = 6.0;
/// Least number of consecutive points that make a way back.
const WAY_BACK: usize = 6;
/// Composes the path of a point along the whole motion, unless the point is at rest.
pub(super) fn compose(composer: &mut Composer, at: Anchor) {
    let motion = composer.motion.iter();
    let path: Vec<Point> = motion.map(|q| at.placed(q).point).collect();
    let largest = |points: &mut dyn Iterator<Item = f64>| points.fold(0.0, f64::max);
    let extent = largest(&mut path.iter().map(|p| (p - path[0]).norm()));
    if extent <= 1e-9 * largest(&mut path.iter().map(|p| p.norm())) {
        return;
    }
    let near = NEAR * extent;
    let pieces = without_ways_back(&path, near);
    let traces = pieces.into_iter().map(|piece| Trace {
        body: at.body,
        points: piece.iter().map(|&p| p.into()).collect(),
    });
    composer.symbols.extend(traces.map(Into::into));
}

/// Returns the pieces of a path without those on which it returns to earlier points, to within
/// `near`: dashes drawn twice would fill each other's gaps.
fn without_ways_back(path: &[Point], near: f64) -> Vec<&[Point]> {
    let mut travelled = vec![0.0];
    for ends in path.windows(2) {
        travelled.push(travelled[travelled.len() - 1] + (ends[1] - ends[0]).norm());
    }
    let comes_back = |k: usize| {
        let earlier = path.windows(2).zip(&travelled[1..]);
        earlier
            .take_while(|(_, travelled_to)| **travelled_to < travelled[k] - FAR_ALONG * near)
            .filter(|(ends, _)| is_about(ends, path[k], near))
            .any(|(ends, _)| distance([ends[0], ends[1]], path[k]) < near)
    };
    let known: Vec<bool> = (0..path.len()).map(comes_back).collect();
    let mut pieces = Vec::new();
    let mut start = 0;
    let mut k = 0;
    while k < path.len() {
        let run = known[k..].iter().take_while(|known| **known).count();
        // A path that only crosses itself, or closes, goes on.
        if run >= WAY_BACK {
            pieces.push(&path[start..k]);
            start = k + run - 1;
        }
        k += run.max(1);
    }
    pieces.push(&path[start..]);
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

/// Returns whether a point is in the rectangle around two others, `near` included.
fn is_about(ends: &[Point], p: Point, near: f64) -> bool {
    let (a, b) = (ends[0], ends[1]);
    let between = |a: f64, b: f64, p: f64| p > a.min(b) - near && p < a.max(b) + near;
    between(a.x, b.x, p.x) && between(a.y, b.y, p.y)
}

/// Returns the distance of a point from a line between two others.
fn distance([a, b]: [Point; 2], p: Point) -> f64 {
    let along = b - a;
    let length = along.norm_squared();
    let s = if length > 0.0 {
        ((p - a).dot(&along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (a + s * along - p).norm()
}

impl Shape for Trace {
    fn draw(&self, pen: &mut Pen) {
        pen.attach(Attachment::Ground);
        let points = self.points.iter().map(|&p| pen.on_sheet(p.into()));
        let outline = Outline::line(&points.collect::<Vec<_>>());
        let colour = colour_of(self.body).shade(0.85);
        pen.dashed(Layer::Trace, outline, colour, THIN, DASHES);
    }

    fn extent(&self) -> Vec<Disc> {
        let points = self.points.iter();
        points
            .map(|&p| Anchor::origin(None).moved_to(p).into())
            .collect()
    }
}

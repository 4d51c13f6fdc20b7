//! Curves as lines and arcs, fitted by pairs of arcs that join smoothly.

use std::f64::consts::PI;

/// A corner of a polyline, with the bulge of the piece that follows: the tangent of a quarter of its
/// angle, positive for an arc that turns to the left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vertex {
    pub(super) at: [f64; 2],
    pub(super) bulge: f64,
}

/// A point of a curve with its unit tangent.
pub(super) type Sample = ([f64; 2], [f64; 2]);

/// Pieces into which a curve is divided at first.
const FIRST: u32 = 16;
/// Most halvings of a piece; arcs then span a millionth of the curve.
const DEEPEST: u32 = 16;
/// Samples between the ends of a pair of arcs at which its distance is measured. The distance of a
/// smooth curve from a pair of arcs has few waves within it.
const SAMPLES: u32 = 16;

/// Returns the arcs of a curve from one place to another, none farther than `tolerance` from it. The
/// last vertex is the curve's end.
pub(super) fn fit(
    curve: &impl Fn(f64) -> Sample,
    [from, to]: [f64; 2],
    tolerance: f64,
) -> Vec<Vertex> {
    let place = |k: u32| from + (to - from) * f64::from(k) / f64::from(FIRST);
    let mut open: Vec<([f64; 2], u32)> = (0..FIRST)
        .rev()
        .map(|k| ([place(k), place(k + 1)], DEEPEST))
        .collect();
    let mut vertices = Vec::new();
    while let Some(([a, b], left)) = open.pop() {
        let pair = Pair::between(curve(a), curve(b));
        let inner = (1..SAMPLES).map(|k| a + (b - a) * f64::from(k) / f64::from(SAMPLES));
        let is_near = |place: f64| pair.distance(curve(place).0) <= tolerance;
        if left == 0 || inner.into_iter().all(is_near) {
            vertices.extend(pair.arcs.map(|arc| Vertex {
                at: arc.from,
                bulge: (arc.half / 2.0).tan(),
            }));
        } else {
            let middle = a.midpoint(b);
            open.push(([middle, b], left - 1));
            open.push(([a, middle], left - 1));
        }
    }
    vertices.push(Vertex {
        at: curve(to).0,
        bulge: 0.0,
    });
    vertices
}

/// Two arcs with one tangent where they meet.
struct Pair {
    arcs: [Arc; 2],
}

/// An arc, or a line.
struct Arc {
    from: [f64; 2],
    to: [f64; 2],
    /// Half of its angle, positive to the left \[rad\].
    half: f64,
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Returns the angle from one direction to another.
fn turn(from: [f64; 2], to: [f64; 2]) -> f64 {
    (from[0] * to[1] - from[1] * to[0]).atan2(dot(from, to))
}

impl Pair {
    /// Returns the pair of arcs with equal tangent lengths d: with v from start to end and
    /// t = t₀ + t₁, 2 d² (1 − t₀·t₁) + 2 d v·t = v·v.
    fn between((start, t0): Sample, (end, t1): Sample) -> Self {
        let v = minus(end, start);
        let along = dot(v, [t0[0] + t1[0], t0[1] + t1[1]]);
        let square = 2.0 * (1.0 - dot(t0, t1));
        // The stable form of the positive root, which also holds for parallel tangents.
        let root = (along * along + square * dot(v, v)).sqrt();
        let d = dot(v, v) / (along + root);
        let d = if d.is_finite() { d } else { 0.0 };
        let middle = [0, 1].map(|k| (start[k] + end[k] + d * (t0[k] - t1[k])) / 2.0);
        let first = turn(t0, minus(middle, start));
        let second = turn(minus(end, middle), t1);
        let arc = |from, to, half: f64| Arc {
            from,
            to,
            half: half.clamp(-0.9 * PI, 0.9 * PI),
        };
        Self {
            arcs: [arc(start, middle, first), arc(middle, end, second)],
        }
    }

    fn distance(&self, point: [f64; 2]) -> f64 {
        self.arcs[0]
            .distance(point)
            .min(self.arcs[1].distance(point))
    }
}

impl Arc {
    /// Returns the distance of a point.
    fn distance(&self, point: [f64; 2]) -> f64 {
        let chord = minus(self.to, self.from);
        let length = dot(chord, chord).sqrt();
        let ends = [self.from, self.to].map(|end| dot(minus(point, end), minus(point, end)).sqrt());
        let nearest_end = ends[0].min(ends[1]);
        if length == 0.0 {
            return nearest_end;
        }
        let unit = chord.map(|x| x / length);
        let way = minus(point, self.from);
        let along = dot(way, unit);
        let across = way[1] * unit[0] - way[0] * unit[1];
        let sin = self.half.sin();
        // A chord whose arc is a millionth of its length off is a line.
        if sin.abs() < 1e-9 {
            return if (0.0..=length).contains(&along) {
                across.abs()
            } else {
                nearest_end
            };
        }
        // The centre lies to the left of the chord's middle by R cos(half), R with the sign of half.
        let radius = length / (2.0 * sin);
        let height = radius * self.half.cos();
        let from_centre = [along - length / 2.0, across - height];
        // The arc is seen from its centre opposite to the side of the centre.
        let axis = [0.0, -radius.signum()];
        if turn(axis, from_centre).abs() <= self.half.abs() {
            (dot(from_centre, from_centre).sqrt() - radius.abs()).abs()
        } else {
            nearest_end
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn ellipse(angle: f64) -> Sample {
        let (sin, cos) = angle.sin_cos();
        let speed = (2.0 * sin).hypot(cos);
        ([2.0 * cos, sin], [-2.0 * sin / speed, cos / speed])
    }

    /// Returns points of a polyline's arcs.
    fn points(vertices: &[Vertex]) -> Vec<[f64; 2]> {
        let pieces = vertices.windows(2).flat_map(|ends| {
            let [a, b] = [ends[0].at, ends[1].at];
            let sweep = 4.0 * ends[0].bulge.atan();
            (0..8).map(move |k| {
                let part = f64::from(k) / 8.0;
                // A chord of an arc has half the arc's angle to its tangent.
                let share = (sweep * part / 2.0).sin() / (sweep / 2.0).sin();
                let share = if share.is_finite() { share } else { part };
                let (sin, cos) = (-(sweep * (1.0 - part)) / 2.0).sin_cos();
                let chord = minus(b, a).map(|x| x * share);
                [
                    a[0] + chord[0] * cos - chord[1] * sin,
                    a[1] + chord[0] * sin + chord[1] * cos,
                ]
            })
        });
        pieces.collect()
    }

    #[test]
    fn arcs_of_a_circle_are_the_circle() {
        let circle = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            ([cos, sin], [-sin, cos])
        };
        let vertices = fit(&circle, [0.0, TAU], 1e-12);
        assert_eq!(vertices.len(), 2 * FIRST as usize + 1);
        for [x, y] in points(&vertices) {
            assert!((x.hypot(y) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn no_arc_is_farther_from_an_ellipse_than_the_tolerance() {
        for tolerance in [1e-3, 1e-5] {
            let vertices = fit(&ellipse, [0.0, TAU], tolerance);
            for [x, y] in points(&vertices) {
                // First order in the distance: the error of the equation over its gradient.
                let gradient = (x / 2.0).hypot(2.0 * y);
                let distance = ((x / 2.0).powi(2) + y * y - 1.0) / gradient;
                assert!(distance.abs() < 1.05 * tolerance, "{distance:e}");
            }
        }
        // A third of the angle, a twenty-seventh of the error.
        let [coarse, fine] = [1e-3, 1e-6].map(|t| fit(&ellipse, [0.0, TAU], t).len());
        assert!(fine < 16 * coarse, "{coarse}, {fine}");
    }

    #[test]
    fn a_line_stays_a_line_and_a_corner_ends() {
        let line = |s: f64| ([s, 0.0], [1.0, 0.0]);
        let vertices = fit(&line, [0.0, 1.0], 1e-9);
        assert!(vertices.iter().all(|vertex| vertex.bulge == 0.0));
        let corner = |s: f64| {
            if s < 0.3 {
                ([s, 0.0], [1.0, 0.0])
            } else {
                ([0.3, s - 0.3], [0.0, 1.0])
            }
        };
        assert!(fit(&corner, [0.0, 1.0], 1e-9).len() < 200);
    }
}

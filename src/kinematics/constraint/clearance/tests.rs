//! Clearances against outlines that are sampled finely, and their derivatives and bounds against
//! differences.

use super::*;
use crate::kinematics::constraint::definition;
use crate::mechanism::Source;

/// Shapes of all forms in pairs, on two bodies and on ground.
const BODIES: &str = r#"
format = 1
name = "shapes"
[ground.markers]
A = [-1, -0.2]
B = [0.1, 0]
C = [0.4, 0.5]
[ground.shapes]
floor = { wall = ["A", "B", "C"], depth = 0.05 }
post = { disc = "C", radius = 0.1 }
[bodies.a]
markers = { A = [-0.3, 0.1], B = [0.1, -0.2], C = [0.4, 0.1], D = [0.1, 0.1], E = [0.05, 0.4], M = [-0.1, -0.05] }
[bodies.a.shapes]
hollow = { outline = ["A", "M", "B", "C", "D", "E"], fillet = 0.02 }
sharp = { outline = ["A", "M", "B", "C", "D", "E"] }
rim = { outline = ["E", "D", "C", "B", "A"], radius = 0.03 }
plate = { disc = "A", radius = 0.5 }
bore = { hole = "A", radius = 0.4 }
[bodies.b]
markers = { A = [0, 0], B = [0.3, 0], C = [0.4, 0.3], D = [0.05, 0.35] }
[bodies.b.shapes]
nose = { disc = "B", radius = 0.04 }
arm = { bar = ["A", "B", "C"], radius = 0.03 }
lens = { outline = [{ marker = "A", bulge = 0.3 }, "B", { marker = "C", bulge = -0.35 }, "D"], fillet = 0.01 }
moon = { outline = [{ marker = "A", bulge = 1.6 }, { marker = "B", bulge = -1.2 }] }
[joints]
one = { type = "revolute", markers = ["ground.A", "a.A"] }
two = { type = "revolute", markers = ["ground.A", "b.A"] }
[measures]
p0 = { coordinate = "clearance", shapes = ["a.hollow", "b.nose"] }
p1 = { coordinate = "clearance", shapes = ["b.lens", "a.hollow"] }
p2 = { coordinate = "clearance", shapes = ["a.rim", "b.arm"] }
p3 = { coordinate = "clearance", shapes = ["a.sharp", "b.lens"] }
p4 = { coordinate = "clearance", shapes = ["ground.floor", "b.arm"] }
p5 = { coordinate = "clearance", shapes = ["b.moon", "ground.post"] }
p6 = { coordinate = "clearance", shapes = ["ground.floor", "a.rim"] }
p7 = { coordinate = "clearance", shapes = ["a.sharp", "b.moon"] }
"#;

const UNKNOWNS: usize = 6;

fn mechanism() -> Mechanism {
    let source = Source::new("shapes.toml", BODIES);
    let read = Mechanism::parse(&source);
    read.unwrap_or_else(|problems| panic!("{}", problems[0].one_line(&source)))
        .0
}

fn clearances(mechanism: &Mechanism) -> Vec<Clearance> {
    let measures = mechanism.measures.iter();
    let shapes = measures.filter_map(|measure| measure.coordinate.shapes());
    let whole = |shapes| Clearance {
        shapes,
        runs: [FeatureRun::WHOLE; 2],
    };
    shapes.map(whole).collect()
}

fn configuration(mechanism: &Mechanism) -> Configuration {
    let mut at = Configuration::new(mechanism, 0, (Vec::new(), Vec::new()), 0);
    at.set_parameters(mechanism, &[], &[])
        .expect("the sample has numbers only");
    at
}

/// Numbers between -1 and 1 in a fixed order.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

fn pose(next: &mut impl FnMut() -> f64) -> Vec<f64> {
    (0..UNKNOWNS)
        .map(|k| next() * if k % 3 == 2 { 3.2 } else { 1.2 })
        .collect()
}

/// Returns points on the outline of a shape, close to each other.
fn sampled(mechanism: &Mechanism, shape: ShapeId, at: &Configuration, step: f64) -> Vec<[f64; 2]> {
    let own = &mechanism.shapes[shape.index()];
    let frame = at.frame(own.body);
    let mut points = Vec::new();
    mechanism.boundary(own, &[], &mut |piece| {
        let [a, b] = piece.ends;
        let length = match piece.arc {
            None => (b[0] - a[0]).hypot(b[1] - a[1]),
            Some((_, radius, turn)) => radius * turn.abs(),
        };
        let count = (length / step).ceil().max(1.0);
        for k in 0..=count as usize {
            let part = k as f64 / count;
            let point = match piece.arc {
                None => [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])],
                Some((center, radius, turn)) => {
                    let from = (a[1] - center[1]).atan2(a[0] - center[0]);
                    let (sin, cos) = (from + part * turn).sin_cos();
                    [center[0] + radius * cos, center[1] + radius * sin]
                }
            };
            let point = frame.origin + frame.rotate(point.into());
            points.push(point.into());
        }
    });
    points
}

/// Returns whether the nearest place of a wall is not on its surface: its back, where it is as deep again,
/// is no outline.
fn is_off_surface(mechanism: &Mechanism, clearance: Clearance, near: [Vector2<f64>; 2]) -> bool {
    let is_wall = mechanism.shape_path(clearance.shapes[0]) == "ground.floor";
    let corners = [[-1.0, -0.2], [0.1, 0.0], [0.4, 0.5]].map(Vector2::from);
    let is_on = |from: Vector2<f64>, to: Vector2<f64>| {
        let (along, arm) = (to - from, near[0] - from);
        let place = along.dot(&arm) / along.norm_squared();
        (0.0..1.0).contains(&place) && along.perp(&arm).abs() < 1e-12
    };
    is_wall && !is_on(corners[0], corners[1]) && !is_on(corners[1], corners[2])
}

#[test]
fn clearances_are_the_least_distances_of_outlines() {
    const STEP: f64 = 2e-3;
    let mechanism = mechanism();
    let mut at = configuration(&mechanism);
    let mut next = numbers();
    let mut compared = 0;
    for _ in 0..60 {
        at.set_pose(&mechanism, &pose(&mut next));
        for clearance in clearances(&mechanism) {
            let value = clearance.value(&at);
            let [a, b] = clearance
                .shapes
                .map(|shape| sampled(&mechanism, shape, &at, STEP));
            let pairs = a.iter().flat_map(|p| b.iter().map(move |q| (p, q)));
            let distances = pairs.map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1]));
            let least = distances.fold(f64::INFINITY, f64::min);
            let near = clearance.places(&at).expect("both have places");
            // The clearance is not this distance where outlines cross, and behind a wall.
            if clearance.is_crossed(&mechanism, &at, &[])
                || least < STEP
                || value < 0.0
                || is_off_surface(&mechanism, clearance, near)
            {
                continue;
            }
            compared += 1;
            // The nearest points of two outlines are at most half a step from a sample each; the
            // smallest radius is 1 cm.
            let off = STEP * STEP * (1.0 / least + 30.0);
            assert!(
                value <= least + 1e-12 && value >= least - off,
                "{clearance:?}: {value} {least}"
            );
            let apart = (near[1] - near[0]).norm();
            assert!(
                (apart - value).abs() < 1e-12,
                "{clearance:?}: {value} {apart}"
            );
        }
    }
    assert!(compared > 150, "{compared}");
}

#[test]
fn rates_are_those_of_the_branch_in_force() {
    const H: f64 = 1e-4;
    let mechanism = mechanism();
    let mut at = configuration(&mechanism);
    let mut next = numbers();
    let mut compared = 0;
    for _ in 0..400 {
        let (q, v) = (pose(&mut next), pose(&mut next));
        for clearance in clearances(&mechanism) {
            let mut look = |s: f64| {
                let moved: Vec<f64> = q.iter().zip(&v).map(|(q, v)| q + s * v).collect();
                at.set_pose(&mechanism, &moved);
                let near = clearance.nearest(&at).expect("both have places");
                let mut row = Gradient::new();
                let value = clearance.value_and_gradient(&at, &mut row);
                (
                    near.branch.features,
                    value,
                    row.dot(&v),
                    near.length.min(near.core),
                )
            };
            let stencil = [-2.0, -1.0, 1.0, 2.0].map(|k| look(k * H));
            let here = look(0.0);
            at.set_pose(&mechanism, &q);
            // A short length bends a lot, and where cores meet there is no rate.
            if stencil.iter().any(|at| at.0 != here.0) || here.3 < 0.05 {
                continue;
            }
            compared += 1;
            let difference =
                |of: &dyn Fn(usize) -> f64| (8.0 * (of(2) - of(1)) - (of(3) - of(0))) / (12.0 * H);
            let rate = difference(&|k| stencil[k].1);
            assert!(
                (here.2 - rate).abs() < 1e-8,
                "{clearance:?}: {} {rate}",
                here.2
            );
            let quadratic = clearance.quadratic(&at, &v);
            let bent = difference(&|k| stencil[k].2);
            assert!(
                (quadratic - bent).abs() < 1e-6,
                "{clearance:?}: {quadratic} {bent}"
            );
            let mut derived = Gradient::new();
            let of_formula = [
                definition::derived_value(&clearance, &at),
                definition::derived_gradient(&clearance, &at, &mut derived),
                definition::derived_quadratic(&clearance, &at, &v),
            ];
            let by_hand = [here.1, here.1, quadratic];
            for (by_hand, derived) in by_hand.iter().zip(of_formula) {
                let rounding = 1e-12 * (1.0 + by_hand.abs());
                assert!((by_hand - derived).abs() < rounding, "{by_hand} {derived}");
            }
            assert!((derived.dot(&v) - here.2).abs() < 1e-12);
        }
    }
    assert!(compared > 1000, "{compared}");
}

#[test]
fn clearances_lie_no_deeper_below_their_chords_than_bounded() {
    let mechanism = mechanism();
    let mut at = configuration(&mechanism);
    let mut next = numbers();
    let mut tightest: f64 = 0.0;
    for round in 0..400 {
        let length = [1.0, 0.1, 0.01][round % 3];
        let (end, way) = (pose(&mut next), pose(&mut next));
        let way: Vec<f64> = way.iter().map(|v| length * v).collect();
        // A curve through both ends that deviates from its chord.
        let aside: Vec<f64> = pose(&mut next).iter().map(|v| 0.1 * length * v).collect();
        let place = |s: f64| -> Vec<f64> {
            let parts = end.iter().zip(&way).zip(&aside);
            let part = 4.0 * s * (1.0 - s);
            parts
                .map(|((q, v), a)| q - (1.0 - s) * v + part * a)
                .collect()
        };
        for clearance in clearances(&mechanism) {
            let mut value = |s: f64| {
                at.set_pose(&mechanism, &place(s));
                clearance.value(&at)
            };
            let (from, to) = (value(0.0), value(1.0));
            let depths = (1..40).map(|k| f64::from(k) / 40.0);
            let depths = depths.map(|s| from + s * (to - from) - value(s));
            let deepest = depths.fold(0.0, f64::max);
            at.set_pose(&mechanism, &end);
            let moving = [CoreMotion::default(); 2];
            let off = |k: usize| aside[k].abs();
            let bound = clearance.deviation(&at, |k| way[k], off, moving);
            assert!(
                deepest <= bound + 1e-13,
                "{clearance:?}: {deepest} > {bound}"
            );
            tightest = tightest.max(deepest / bound);
        }
    }
    // The bound is of use.
    assert!(tightest > 0.3, "{tightest}");
}

#[test]
fn a_pin_in_a_bore_and_a_corner_have_the_clearances_of_closed_forms() {
    let text = BODIES.replace(
        "[measures]",
        "[measures]\nbore = { coordinate = \"clearance\", shapes = [\"a.bore\", \"b.nose\"] }",
    );
    let source = Source::new("shapes.toml", text);
    let (mechanism, _) = Mechanism::parse(&source).expect("it is right");
    let mut at = configuration(&mechanism);
    let clearance = clearances(&mechanism)[0];
    // The pin's centre is 0.3 from the origin of b, the bore's at (-0.3, 0.1) on a.
    for turn in [0.0, 0.7, 2.0] {
        let (sin, cos) = f64::sin_cos(turn);
        for apart in [0.0, 0.2, 0.36, 0.5] {
            let pin = [-0.3 + apart, 0.1];
            let q = [0.0, 0.0, 0.0, pin[0] - 0.3 * cos, pin[1] - 0.3 * sin, turn];
            at.set_pose(&mechanism, &q);
            let value = clearance.value(&at);
            assert!((value - (0.4 - apart - 0.04)).abs() < 1e-15, "{value}");
        }
    }
}

/// A place beside an edge, so near its end that both are as near to rounding.
#[test]
fn an_edge_is_nearer_than_its_ends_whatever_rounding_says() {
    let mut next = numbers();
    for k in 0..2000 {
        let (sin, cos) = (3.2 * next()).sin_cos();
        let offset = [next(), next()];
        let turned =
            |[x, y]: [f64; 2]| [offset[0] + cos * x - sin * y, offset[1] + sin * x + cos * y];
        let feature = |kind, center, ends: [[f64; 2]; 2]| Feature {
            kind,
            center: turned(center),
            ends: ends.map(turned),
            radius: 0.0,
            position: 0,
        };
        // Within 1e-12 of the edge's end, places are rounding.
        let before = 10_f64.powf(-10.5 + 1.5 * next());
        let place = [0.3 - before, 0.005];
        let place = feature(FeatureKind::Place, place, [place; 2]);
        let end = [0.3, 0.0];
        let edge = feature(FeatureKind::Edge, [0.15, 0.0], [[0.0; 2], end]);
        let end = feature(FeatureKind::Place, end, [end; 2]);
        let both = if k % 2 == 0 { [edge, end] } else { [end, edge] };
        let of = |side: usize, k: usize| Some(if side == 0 { place } else { both[k] });
        let (branch, _) = nearest([1, 2], of).expect("they have a distance");
        assert!(matches!(branch.form, Form::Edge(..)), "{before}");
    }
}

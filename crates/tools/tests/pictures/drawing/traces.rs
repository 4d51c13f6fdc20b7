//! The paths of points.

use biela::mechanism::BodyId;
use biela_tools::drawing::{Scene, Symbol};

use crate::common::{assembled, shipped};
use crate::drawing::scenes::{near, scene, scene_of};

#[test]
fn trace_is_the_path_of_its_point() {
    let (mut solver, _) = assembled(&shipped("four_bar"));
    let scene = Scene::new(&mut solver, true);
    let traces: Vec<_> = scene
        .symbols
        .iter()
        .filter_map(|s| match s {
            Symbol::Trace(trace) if trace.body == Some(BodyId(1)) => Some(&trace.points),
            _ => None,
        })
        .collect();
    let [points] = traces[..] else {
        panic!("{traces:?}")
    };
    // The crank turns fully, so the curve closes.
    let (first, last) = (points[0], points[points.len() - 1]);
    assert!(near(first[0], last[0]) && near(first[1], last[1]));
    // P is hypot(125, 50) mm from both ends of the coupler, one of which is on the crank's circle
    // of 100 mm about O2, the other on the rocker's of 300 mm about O4.
    let reach = f64::hypot(0.125, 0.05);
    for [x, y] in points {
        assert!((f64::hypot(*x, *y) - 0.1).abs() <= reach + 1e-12);
        assert!((f64::hypot(x - 0.4, *y) - 0.3).abs() <= reach + 1e-12);
    }
    let without = Scene::new(&mut solver, false);
    assert_eq!(without.symbols.len(), scene.symbols.len() - 1);
}

#[test]
fn rocking_point_draws_its_arc_once() {
    // The left rocker's end moves on a circle about O2, forth and back.
    let (mut solver, _) = assembled(&shipped("chebyshev"));
    let length = |points: &[[f64; 2]]| -> f64 {
        points
            .windows(2)
            .map(|p| f64::hypot(p[1][0] - p[0][0], p[1][1] - p[0][1]))
            .sum()
    };
    let drawn: f64 = Scene::new(&mut solver, true)
        .symbols
        .iter()
        .map(|s| match s {
            Symbol::Trace(trace) if trace.body == Some(BodyId(0)) => length(&trace.points),
            _ => 0.0,
        })
        .sum();
    // Turning points: coupler and right rocker in line, stretched (7 parts) and folded (3), on a
    // base of 4 with a left rocker of 5. The arc is the rocker's length times the difference.
    let angle = |far: f64| ((25.0 + 16.0 - far * far) / 40.0_f64).acos();
    let arc = 0.25 * (angle(7.0) - angle(3.0));
    assert!((drawn / arc - 1.0).abs() < 0.03, "{drawn} {arc}");
}

#[test]
fn trace_continues_until_the_mechanism_is_back() {
    let pieces = |name: &str| -> Vec<Vec<[f64; 2]>> {
        let trace = |s: &Symbol| match s {
            Symbol::Trace(trace) => Some(trace.points.clone()),
            _ => None,
        };
        scene(name).symbols.iter().filter_map(trace).collect()
    };
    // The cranks are back after two turns of the first.
    let curve = pieces("geared_five_bar");
    assert_eq!(curve.len(), 1);
    let (first, last) = (curve[0][0], curve[0][curve[0].len() - 1]);
    assert!((0..2).all(|k| (first[k] - last[k]).abs() < 1e-9));
    // Planet and arm are back after four turns of the sun: a hypocycloid with three cusps, of
    // length 16 r. Near a cusp, where both sides look like one line, one side is left out.
    let length = |points: &Vec<[f64; 2]>| -> f64 {
        let steps = points.windows(2);
        let step = |p: &[[f64; 2]]| f64::hypot(p[1][0] - p[0][0], p[1][1] - p[0][1]);
        steps.map(step).sum()
    };
    let drawn: f64 = pieces("planetary_gear").iter().map(length).sum();
    assert!((drawn / (16.0 * 0.024) - 1.0).abs() < 0.03, "{drawn}");
}

/// Returns the ends and the length of the one path in a scene.
fn only_path(text: &str) -> ([[f64; 2]; 2], f64) {
    let scene = scene_of(text);
    let mut traces = scene.symbols.iter().filter_map(|symbol| match symbol {
        Symbol::Trace(trace) => Some(&trace.points),
        _ => None,
    });
    let (Some(points), None) = (traces.next(), traces.next()) else {
        panic!("there is one path")
    };
    let steps = points
        .windows(2)
        .map(|p| f64::hypot(p[1][0] - p[0][0], p[1][1] - p[0][1]));
    ([points[0], points[points.len() - 1]], steps.sum())
}

const ARM: &str = r#"format = 1
name = "arm"
[ground.markers]
O = [0, 0]
G = [0.4, 0]
[bodies.arm]
markers = { O = [0, 0], A = [0.3, 0], P = [0.5, 0] }
estimate = [0, 0, 0.3]
[joints]
O = { type = "revolute", markers = ["ground.O", "arm.O"] }
[outputs]
markers = ["arm.P"]
"#;

// Flat at its start, the arm leaves the rectangle around itself.
#[test]
fn a_path_covers_the_whole_range_of_an_angle() {
    let driver = r#"[drivers]
angle = { coordinate = "angle", markers = ["ground.O", "arm.O"], start = 0, min = 0, max = "85*deg" }
"#;
    let ([first, last], length) = only_path(&format!("{ARM}{driver}"));
    let end = 85.0_f64.to_radians();
    assert!(near(first[0], 0.5) && near(first[1], 0.0), "{first:?}");
    assert!(
        near(last[0], 0.5 * end.cos()) && near(last[1], 0.5 * end.sin()),
        "{last:?}"
    );
    assert!((length / (0.5 * end) - 1.0).abs() < 1e-4, "{length}");
}

#[test]
fn a_path_covers_the_whole_range_of_a_length() {
    let driver = r#"[drivers]
cylinder = { coordinate = "distance", markers = ["ground.G", "arm.A"], start = 0.2, min = 0.15, max = 0.6 }
"#;
    let ([first, last], _) = only_path(&format!("{ARM}{driver}"));
    for (end, length) in [(first, 0.15), (last, 0.6_f64)] {
        // Law of cosines: the angle between the arm and the base of the cylinder.
        let cos = (0.16 + 0.09 - length * length) / (2.0 * 0.4 * 0.3);
        assert!(near(end[0], 0.5 * cos), "{end:?} {cos}");
        assert!(near(end[1], 0.5 * (1.0 - cos * cos).sqrt()), "{end:?}");
    }
}

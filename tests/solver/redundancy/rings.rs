//! Rings of equal cells that fold all at once.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

use biela::kinematics::{Reason, SingularKind, Solver};

use crate::common::{assembled, parse, straight_to};

/// The length of the arms of a ring \[m\].
const ARM: f64 = 0.4;
/// The distance of its middle pins from the centre at the start \[m\].
const RADIUS: f64 = 0.7;

/// Returns a ring of `cells` pairs of angled bars that cross in pins on rays from the centre, three of
/// which are slots on ground. The driver is the distance of the first pin from the centre.
///
/// Each bar joins points on the two rays half-way to the next pins, both the length [`ARM`] away from
/// its own pin: the pin of a triangle whose other corner lies on a line through the centre at half
/// the angle π/n between two cells. It is farthest from the centre where its arms are at right angles
/// to that line, at `ARM`/sin(π/n). There the inner and the outer pins of all cells coincide.
fn ring(cells: usize) -> String {
    let half = PI / cells as f64;
    let (across, along) = (RADIUS * half.sin(), RADIUS * half.cos());
    let off = (ARM * ARM - across * across).sqrt();
    let point =
        |radius: f64, angle: f64| format!("[{}, {}]", radius * angle.cos(), radius * angle.sin());
    let mut ground = "[ground.markers]\n".to_owned();
    let (mut bodies, mut joints) = (String::new(), "[joints]\n".to_owned());
    for k in 0..cells {
        let angle = TAU * k as f64 / cells as f64;
        let next = (k + 1) % cells;
        let pin = point(RADIUS, angle);
        writeln!(ground, "ray{k} = [0, 0, {angle}]").expect("a text takes all");
        for (name, sign) in [("a", 1.0), ("b", -1.0)] {
            let outer = point(along + off, angle + sign * half);
            let inner = point(along - off, angle - sign * half);
            writeln!(
                bodies,
                "[bodies.{name}{k}]\nmarkers = {{ P = {pin}, O = {outer}, I = {inner} }}"
            )
            .expect("a text takes all");
        }
        for (pin, ends) in [
            ("P", [format!("a{k}.P"), format!("b{k}.P")]),
            ("O", [format!("a{k}.O"), format!("b{next}.O")]),
            ("I", [format!("b{k}.I"), format!("a{next}.I")]),
        ] {
            let [from, to] = ends;
            writeln!(
                joints,
                "{pin}{k} = {{ type = \"revolute\", markers = [\"{from}\", \"{to}\"] }}"
            )
            .expect("a text takes all");
        }
        if [0, cells / 4, cells / 2].contains(&k) {
            writeln!(
                joints,
                "ray{k} = {{ type = \"slot\", markers = [\"ground.ray{k}\", \"a{k}.P\"] }}"
            )
            .expect("a text takes all");
        }
    }
    format!(
        "format = 1\nname = \"ring\"\n{ground}{bodies}{joints}[drivers]\nopen = {{ coordinate = \
         \"x\", markers = [\"ground.ray0\", \"a0.P\"], start = {RADIUS} }}\n"
    )
}

#[test]
fn a_ring_stops_where_all_of_its_cells_fold() {
    for cells in [6, 8] {
        let farthest = ARM / (PI / cells as f64).sin();
        let (mut solver, mut path) = assembled(&parse(&ring(cells)));
        assert!(!solver.redundancies().is_empty());
        straight_to(&solver, &mut path, farthest + 0.1);
        let blocked = solver.track(&path).expect_err("the ring opens no farther");
        let Reason::Singular(end) = blocked.reason else {
            panic!("{cells}: {blocked:?}");
        };
        assert_eq!(end.kind, SingularKind::DeadPoint);
        // All bars turn at the dead point.
        assert_eq!(end.bodies.len(), 2 * cells);
        // The rounding of coordinates of one, a few dozen of them in a row, and as much again where the
        // driver's row is a small part of the null vector.
        let off = end.drivers[0] - farthest;
        assert!(off.abs() < 1e-12, "{cells}: {off:e}");
        // The pose there: outer pins and inner ones coincide.
        let apart = pins_apart(&solver, &end.q);
        // Along the motion a place is known to the root of the rounding.
        assert!(apart < 1e-7, "{cells}: {apart:e}");
    }
}

/// Returns the distance of the outer from the inner pin between the first two rays, from the places of
/// the markers on their bodies.
fn pins_apart(solver: &Solver, q: &[f64]) -> f64 {
    let mechanism = solver.mechanism();
    let point = |body: &str, name: &str| {
        let body = mechanism.body_id(body).expect("the body exists").index();
        let mut markers = mechanism.bodies[body].markers.iter();
        let marker = markers.find_map(|marker| {
            let marker = &mechanism.markers[marker.index()];
            (marker.name == name).then_some(marker)
        });
        let marker = marker.expect("the marker exists");
        let [x, y] = [0, 1].map(|k| marker.position[k].literal().expect("a number"));
        let (sin, cos) = q[3 * body + 2].sin_cos();
        let origin = &q[3 * body..];
        [origin[0] + x * cos - y * sin, origin[1] + x * sin + y * cos]
    };
    let (outer, inner) = (point("a0", "O"), point("b0", "I"));
    (outer[0] - inner[0]).hypot(outer[1] - inner[1])
}

/// A mechanism with redundant joints whose sub-steps are short next to a nearly singular position: a
/// step past it ends where tiny steps end.
#[test]
fn a_slow_stretch_does_not_end_a_step() {
    let text = include_str!("near_singular.toml");
    let target = -0.000_273_519_624_655_271_8;
    let ends = [1, 400].map(|steps| {
        let (mut solver, mut path) = assembled(&parse(text));
        let start = solver.pose().drivers[0];
        for step in 1..=steps {
            let part = f64::from(step) / f64::from(steps);
            straight_to(&solver, &mut path, start + part * (target - start));
            let tracked = solver.track(&path);
            tracked.unwrap_or_else(|blocked| panic!("{step} of {steps}: {blocked:?}"));
        }
        solver.pose().q.clone()
    });
    let [jump, tiny] = &ends;
    for (k, (jump, tiny)) in jump.iter().zip(tiny).enumerate() {
        // The rounding of the pose over its condition, which is above 1e-4.
        assert!((jump - tiny).abs() < 1e-11, "q[{k}]: {jump} or {tiny}");
    }
}

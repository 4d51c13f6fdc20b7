//! Imported mechanisms move as the ones that their files describe.
//!
//! All samples of one name are one mechanism, in millimetres: a four-bar with its crank of 40 at 60°,
//! coupler of 100 with P at (50, 30), rocker of 80 and base of 110; a slider–crank with a crank of
//! 30 at 45°, a rod of 90 and a way 10 above the crank's pivot; the four-bar with a rod of 150 from P
//! to an arm of 70, the second loop.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use biela::kinematics::{Rates, Solver};
use biela::mechanism::Mechanism;

use crate::common::{assembled, parse, straight_to};
use crate::{import, samples};

pub(crate) type Point = [f64; 2];

/// Returns the point at distances `a` and `b` \[mm\] of two others, to the left of the way from the
/// first to the second.
pub(crate) fn dyad(from: Point, a: f64, to: Point, b: f64) -> Point {
    let way = [to[0] - from[0], to[1] - from[1]];
    let d = way[0].hypot(way[1]);
    let along = (a * a - b * b + d * d) / (2.0 * d);
    let across = (a * a - along * along).sqrt();
    [
        from[0] + (along * way[0] - across * way[1]) / d,
        from[1] + (along * way[1] + across * way[0]) / d,
    ]
}

/// Returns the points of a sample's mechanism \[mm\] with the crank at an angle.
pub(crate) fn expected(name: &str, crank: f64) -> Vec<(&'static str, Point)> {
    let (sin, cos) = crank.sin_cos();
    if name == "slider_crank" {
        let b = [30.0 * cos, 30.0 * sin];
        let c = b[0] + (8100.0 - (10.0 - b[1]).powi(2)).sqrt();
        return vec![("B", b), ("C", [c, 10.0])];
    }
    let b = [40.0 * cos, 40.0 * sin];
    let c = dyad(b, 100.0, [110.0, 0.0], 80.0);
    let unit = [(c[0] - b[0]) / 100.0, (c[1] - b[1]) / 100.0];
    let p = [
        b[0] + 50.0 * unit[0] - 30.0 * unit[1],
        b[1] + 50.0 * unit[1] + 30.0 * unit[0],
    ];
    let mut points = vec![("B", b), ("C", c), ("P", p)];
    if name == "two_loops" {
        points.push(("E", dyad(p, 150.0, [200.0, 20.0], 70.0)));
    }
    points
}

/// Returns the place of a marker, on whichever body it is \[mm\].
pub(crate) fn place(solver: &Solver, mechanism: &Mechanism, name: &str) -> Point {
    let is = |marker: &biela::mechanism::Marker| marker.name == name && marker.body.is_some();
    let index = mechanism.markers.iter().position(is);
    let marker = &mechanism.markers[index.unwrap_or_else(|| panic!("no marker {name}"))];
    let parameters = mechanism.default_parameters();
    let local = marker
        .position
        .each_ref()
        .map(|e| e.evaluate(&|p| parameters[p.index()], 0.0_f64));
    let body = marker.body.expect("it moves").index();
    let q = &solver.pose().q[3 * body..];
    let (sin, cos) = q[2].sin_cos();
    [
        1000.0 * (q[0] + cos * local[0] - sin * local[1]),
        1000.0 * (q[1] + sin * local[0] + cos * local[1]),
    ]
}

/// Returns the drawn positions' accuracy \[mm\] in a format.
fn resolution(format: &str) -> f64 {
    match format {
        // Fourteen digits of metres or millimetres; written with twelve of the size.
        "asmt" | "pylinkage" => 1e-9,
        // Six decimals of a 96th of an inch, and six of a millimetre.
        "linkage2" => 1e-6,
        "dxf" => 1e-6,
        // Half of ten micrometres.
        "pmks" => 5e-3,
        _ => unreachable!("it is a format"),
    }
}

/// Moves a sample through a turn, and compares its points with their closed forms.
fn check(format: &str, path: &Path, name: &str) {
    let draft = import(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mechanism: Arc<Mechanism> = parse(&draft.write("sample"));
    let (mut solver, mut way) = assembled(&mechanism);
    let first = if name == "slider_crank" {
        45.0
    } else {
        60.0_f64
    };
    let start = solver.pose().drivers[0];
    // An error of the drawn points moves others by at most the ratio of the arms, below 10 for
    // transmission angles above 30°, in two loops one after the other.
    let tolerance = 20.0 * resolution(format);
    for step in 0..=48 {
        let turn = f64::from(step) / 48.0 * TAU;
        straight_to(&solver, &mut way, start + turn);
        if step > 0 {
            solver
                .track(&way)
                .unwrap_or_else(|e| panic!("{}: {e:?}", path.display()));
        }
        for (marker, point) in expected(name, first.to_radians() + turn) {
            let marker = match (format, marker) {
                ("asmt", marker) if name == "slider_crank" => {
                    ["b", "pin"][usize::from(marker == "C")]
                }
                (_, marker) => marker,
            };
            let found = place(&solver, &mechanism, marker);
            let error = (found[0] - point[0]).hypot(found[1] - point[1]);
            assert!(
                error < tolerance,
                "{}: {marker} is off by {error} mm at step {step}",
                path.display()
            );
        }
    }
    let mut rates = Rates::new(mechanism.bodies.len() * 3);
    let rate = |_| biela::mechanism::Jet::new(0.0, [1.0, 0.0]);
    solver
        .solve_rates(rate, &mut rates)
        .expect("it is not singular");
}

#[test]
fn imported_mechanisms_move_like_their_originals() {
    for format in ["asmt", "dxf", "linkage2", "pmks", "pylinkage"] {
        let mut checked = 0;
        for path in samples(format) {
            let file = path.file_name().expect("it has one").to_string_lossy();
            let name = file.split('.').next().expect("it has a start").to_owned();
            // The four-bar also with its rocker replaced by a way.
            let name = name.trim_end_matches("_on_arc");
            if ["four_bar", "slider_crank", "two_loops"].contains(&name) {
                check(format, &path, name);
                checked += 1;
            }
        }
        assert!(checked >= 3, "{format}");
    }
}

/// A pinion turns a wheel of four times its size backwards by a quarter, from where it was drawn.
#[test]
fn gears_turn_by_their_ratio() {
    for (sample, drawn) in [("linkage2/gears.linkage2", 0.0), ("asmt/gears.asmt", 0.3)] {
        let path = crate::common::folder("crates/tools/tests/exchange/samples").join(sample);
        let mechanism = parse(&import(&path).expect("it is right").write("gears"));
        let (mut solver, mut way) = assembled(&mechanism);
        straight_to(&solver, &mut way, 1.0);
        solver.track(&way).expect("nothing stops it");
        let wheel = mechanism
            .bodies
            .iter()
            .position(|b| b.name.to_lowercase() == "wheel");
        let angle = solver.pose().q[3 * wheel.expect("it has one") + 2];
        // The angle is written with nine decimals of a degree.
        assert!((angle - drawn + 0.25).abs() < 1e-11, "{sample}: {angle}");
    }
}

/// A pinion above its rack, on a standing axle, takes the rack along to the right when it turns
/// counter-clockwise: x of the pinion from the rack + radius·angle is constant.
#[test]
fn a_rack_moves_as_its_pinion_turns() {
    let path = crate::common::folder("crates/tools/tests/exchange/samples/asmt/rack.asmt");
    let mechanism = parse(&import(&path).expect("it is right").write("rack"));
    let (mut solver, mut way) = assembled(&mechanism);
    straight_to(&solver, &mut way, 1.0);
    solver.track(&way).expect("nothing stops it");
    let rack = mechanism.bodies.iter().position(|body| body.name == "rack");
    let x = solver.pose().q[3 * rack.expect("it has one")];
    assert!((x - 0.01).abs() < 1e-15, "{x}");
}

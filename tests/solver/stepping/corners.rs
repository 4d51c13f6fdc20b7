//! Parameters that move over corners of the expressions in which they are.

use biela::kinematics::{DriverPath, Path, Progress, Reason, Solver};

use crate::common::{assembled, parse};
use crate::stepping::difference;

/// Lengths of a coupler as expressions of `n`, each continuous from 0.2 to 1.7: with corners and
/// smooth joins, at a root, and made of parts that jump together.
const LENGTHS: [&str; 24] = [
    "0.28 + 1e-6*abs(n - 1)",
    "0.28 + 0.02*abs(n - 1)",
    "0.28 - 0.02*abs(sin(5*n))",
    "min(0.3, max(0.25, n/4))",
    "max(0.26, min(n/4, 0.5 - n/4), 0.27)",
    "0.28 + 0.05*max(0, n - 1)^3",
    "0.28 + 0.05*max(0, n - 1)^1.5",
    "0.28 + 0.02*hypot(n - 1, 0)",
    "0.28 + 0.02*hypot(n - 1, 2*n - 2)",
    "0.28 + 0.02*sqrt((n - 1)^2)",
    "0.28 + 0.02*((n - 1)^2)^0.5",
    "0.28 + 0.02*sqrt(abs(n - 1))",
    "0.28 + 0.02*sign(n - 1)*(n - 1)",
    "0.28 + 0.02*(1 + sign(n - 1))*(n - 1)^3",
    "0.28 + 0.02*(n - floor(n))*(ceil(n) - n)",
    "0.28 + 0.02*abs(mod(n, 1) - 0.5)",
    "0.28 + 0.01*cos(mod(2*n, 1)*2*pi)",
    "0.28 + 0.01*acos(cos(3*n))",
    "0.28 + 0.01*asin(sin(3*n))",
    "0.28 + 0.02*atan2(abs(n - 1), 1)",
    "0.28 + 0.01*cos(atan2(n - 1, -1))",
    // Through parameters that are derived from others.
    "0.28 + 0.02*kink",
    "0.28 + 0.02*abs(saw - 0.5)",
    "max(first, second)",
];

/// Returns a drag link with this length of its coupler.
fn drag_link(length: &str) -> String {
    format!(
        "format = 1\nname = 'drag_link'\n[parameters]\nn = {{ value = 0.2, tunable = true }}\n\
         side = 'abs(n - 1)'\nkink = 'max(side, 0.3)'\nsaw = 'mod(n, 1)'\nfirst = '0.27 + 0.01*n'\n\
         second = '0.27 + n/100'\n[ground.markers]\nO = [0, 0]\nD = [0.1, 0]\n[bodies.crank]\n\
         markers = {{ O = [0, 0], A = [0.3, 0] }}\nestimate = [0, 0, 1]\n[bodies.coupler]\n\
         markers = {{ A = [0, 0], B = ['{length}', 0] }}\nestimate = [0.16, 0.25, 3.0]\n\
         [bodies.rocker]\nmarkers = {{ D = [0, 0], B = [0.32, 0] }}\nestimate = [0.1, 0, 2.1]\n\
         [joints]\nO = {{ type = 'revolute', markers = ['ground.O', 'crank.O'] }}\n\
         A = {{ type = 'revolute', markers = ['crank.A', 'coupler.A'] }}\n\
         B = {{ type = 'revolute', markers = ['coupler.B', 'rocker.B'] }}\n\
         D = {{ type = 'revolute', markers = ['ground.D', 'rocker.D'] }}\n[drivers]\n\
         u = {{ coordinate = 'angle', markers = ['ground.O', 'crank.O'], start = 1 }}\n"
    )
}

/// Moves the first parameter to `n` and the driver to `u`, in equal steps.
fn go_to(solver: &mut Solver, [n, u]: [f64; 2], steps: u32) -> Result<Progress, Reason> {
    let mechanism = std::sync::Arc::clone(solver.mechanism());
    let mut path = Path::new(&mechanism);
    let (from, at) = (solver.pose().parameters[0], solver.pose().drivers[0]);
    let mut most = Progress::default();
    for step in 1..=steps {
        let s = f64::from(step) / f64::from(steps);
        path.from.clone_from(&solver.pose().parameters);
        path.to[0] = from + s * (n - from);
        mechanism.derive_parameters(&mut path.to);
        let now = solver.pose().drivers[0];
        path.driver_paths[0] = DriverPath::held(at + s * (u - at), now);
        let progress = solver.track(&path).map_err(|blocked| blocked.reason)?;
        most.substeps = most.substeps.max(progress.substeps);
        most.checked += progress.checked;
    }
    Ok(most)
}

/// Returns how far the rocker is from its place by the law of cosines, on the side of the line
/// from its pivot to the crank's pin on which it is, and that side.
fn off(solver: &Solver) -> (f64, bool) {
    let pose = solver.pose();
    let mut markers = solver.mechanism().markers.iter();
    // That of the coupler is the first of this name.
    let end = markers
        .find(|marker| marker.name == "B")
        .expect("it has one");
    let length = end.position[0].value(&pose.parameters);
    let u = pose.drivers[0];
    let (x, y) = (0.3 * u.cos() - 0.1, 0.3 * u.sin());
    let (span, leaning) = (x.hypot(y), y.atan2(x));
    let cosine = (span * span + 0.32 * 0.32 - length * length) / (2.0 * span * 0.32);
    let turned = (pose.q[8] - leaning).rem_euclid(std::f64::consts::TAU);
    let is_ahead = turned < std::f64::consts::PI;
    let opening = if is_ahead {
        turned
    } else {
        std::f64::consts::TAU - turned
    };
    (opening - cosine.acos(), is_ahead)
}

/// Rounding of the pose and of the law of cosines: some eps over the least sine between the links,
/// 0.1, for lengths of 0.3.
const ROUNDING: f64 = 1e-13;

#[test]
fn one_step_over_a_corner_ends_where_the_closed_form_does() {
    for length in LENGTHS {
        let mechanism = parse(&drag_link(length));
        for target in [[1.7, 1.0], [1.7, 4.0], [1.0, 2.0], [1.0 + 1e-9, 1.0]] {
            let (mut solver, _) = assembled(&mechanism);
            let (_, side) = off(&solver);
            let tracked = go_to(&mut solver, target, 1);
            let progress = tracked.unwrap_or_else(|reason| panic!("{length}: {reason:?}"));
            let (away, on) = off(&solver);
            assert!(away.abs() < ROUNDING, "{length}, to {target:?}: {away:e}");
            assert_eq!(on, side, "{length}, to {target:?}");
            assert_eq!(progress.checked, 0, "{length}, to {target:?}");
            // Parts that jump together take a sub-step per halving down to 1e-12, thrice.
            assert!(progress.substeps < 600, "{length}: {progress:?}");
            // And back, from where a corner may be.
            go_to(&mut solver, [0.2, 1.0], 1).expect(length);
            let (away, on) = off(&solver);
            assert!(
                away.abs() < ROUNDING && on == side,
                "{length}, back: {away:e}"
            );
        }
    }
}

/// A corner of the usual kind takes a few sub-steps.
#[test]
fn corners_take_few_sub_steps() {
    for length in &LENGTHS[..6] {
        let (mut solver, _) = assembled(&parse(&drag_link(length)));
        let progress = go_to(&mut solver, [1.7, 1.0], 1).expect(length);
        assert!(progress.substeps <= 12, "{length}: {progress:?}");
    }
}

/// A length that jumps from one assembly to one that does not close, or far away, ends the motion.
#[test]
fn a_number_that_jumps_is_refused() {
    for length in ["0.28 + 0.2*floor(n)", "0.28 + 0.2*sign(n - 1)*cos(n)"] {
        let (mut solver, _) = assembled(&parse(&drag_link(length)));
        for steps in [1, 100] {
            go_to(&mut solver, [1.7, 1.0], steps).expect_err(length);
            assert!((solver.pose().parameters[0] - 1.0).abs() < 1e-9, "{length}");
        }
    }
}

/// A marker that is in no equation may move in any way.
#[test]
fn an_output_may_jump() {
    let text = drag_link("0.28").replace(
        "D = [0, 0], B = [0.32, 0]",
        "D = [0, 0], B = [0.32, 0], P = ['floor(n)', '0.1*abs(n - 1)', '3*sign(n - 1)']",
    );
    let (mut solver, _) = assembled(&parse(&text));
    let progress = go_to(&mut solver, [1.7, 1.0], 1).expect("no equation changes");
    assert_eq!(progress.substeps, 1);
}

/// A platform on three legs, one of which has a length that is a function of `n`.
fn platform(length: &str) -> String {
    "format = 1\nname = 'platform'\n[parameters]\nn = { value = 0.2, tunable = true }\n\
        [ground.markers]\nA0 = [-1, 1]\nA1 = ['0.01 - 0.1*abs(n - 1)', 1.9]\nA2 = [1.9, -0.6]\n\
        [bodies.p]\nmarkers = { B0 = [0, -1.4], B1 = ['-2 + 0.1*max(n, 1)', '-0.1*hypot(n - 1, 0)'], \
        B2 = [-0.2, 1.8] }\nestimate = [0.44, 0.15, -1.3]\n[constraints]\n\
        l1 = { coordinate = 'distance', markers = ['ground.A1', 'p.B1'], value = 'LENGTH' }\n\
        l2 = { coordinate = 'distance', markers = ['ground.A2', 'p.B2'], value = 1.44 }\n[drivers]\n\
        u0 = { coordinate = 'distance', markers = ['ground.A0', 'p.B0'], start = 1.26 }\n"
        .replace("LENGTH", length)
}

/// Parts that jump together are passed wherever they do, though rejected sub-steps are shortened by
/// large ratios.
#[test]
fn parts_that_jump_together_are_passed_anywhere() {
    for place in (1..100).step_by(4) {
        let corner = 0.2 + 0.015 * f64::from(place);
        let length = format!("0.4 + 0.1*abs(mod(n + {:?}, 1) - 0.5)", 2.0 - corner);
        let (mut solver, _) = assembled(&parse(&platform(&length)));
        let start = solver.pose().q.clone();
        for target in [[1.7, 1.2], [0.2, 1.26]] {
            let tracked = go_to(&mut solver, target, 1);
            tracked.unwrap_or_else(|reason| panic!("{length}, to {target:?}: {reason:?}"));
        }
        assert!(difference(&solver.pose().q, &start) < 1e-12, "{length}");
    }
}

/// Legs of a platform, wheels and a body held at an angle change with corners. The truth is the
/// same path in tiny parts.
#[test]
fn corners_in_other_blocks_are_passed() {
    let wheels = "format = 1\nname = 'wheels'\n[parameters]\nn = { value = 0.2, tunable = true }\n\
        [ground.markers]\nO = [0, 0]\nP = [0.3, 0]\n[bodies.a]\nmarkers = { O = [0, 0] }\n[bodies.b]\n\
        markers = { P = [0, 0] }\nestimate = [0.3, 0, 0]\n[bodies.c]\n\
        markers = { Q = [0, 0, 'abs(n - 1)'] }\nestimate = [0.3, 0, 0]\n[joints]\n\
        O = { type = 'revolute', markers = ['ground.O', 'a.O'] }\n\
        P = { type = 'revolute', markers = ['ground.P', 'b.P'] }\n\
        Q = { type = 'weld', markers = ['b.P', 'c.Q'] }\n\
        k = { type = 'belt', markers = ['a.O', 'b.P'], radii = ['0.1 + 0.02*abs(n - 1)', 0.1] }\n\
        [drivers]\nu = { coordinate = 'angle', markers = ['ground.O', 'a.O'], start = 1 }\n";
    let platform = platform("0.3 + 0.1*min(n, 1)");
    for (text, to) in [(platform.as_str(), 1.2), (wheels, 4.0)] {
        let mechanism = parse(text);
        let follow = |steps: u32| {
            let (mut solver, _) = assembled(&mechanism);
            let progress = go_to(&mut solver, [1.7, to], steps).expect("it follows");
            assert_eq!(progress.checked, 0);
            solver.pose().q.clone()
        };
        let (whole, truth) = (follow(1), follow(1000));
        assert!(difference(&whole, &truth) < 1e-10, "{whole:?} {truth:?}");
    }
}

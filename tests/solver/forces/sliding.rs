//! Friction in curves, on cams and on the pins of links, in driven motion.

use std::sync::Arc;

use biela::kinematics::{Direction, ForceQuantity, Solution};
use biela::mechanism::{DriverId, Mechanism};

use crate::common::{assembled, parse};

const EFFORT: ForceQuantity = ForceQuantity::Effort(DriverId(0));

/// Returns the effort of the driver at a position, a velocity and an acceleration.
fn effort(mechanism: &Arc<Mechanism>, [position, velocity, acceleration]: [f64; 3]) -> f64 {
    let mut moved = (**mechanism).clone();
    if let biela::mechanism::DriverSource::Input { start } = &mut moved.drivers[0].source {
        *start = position;
    }
    let (mut solver, _) = assembled(&Arc::new(moved));
    let mut solution = Solution::new(&solver);
    solution.seek_forces(&solver);
    solution.driver_rates[0].derivatives = [velocity, acceleration];
    solution.solve(&mut solver).expect("it does not jam");
    solution.force(EFFORT)
}

/// Compares the exact changes of the effort and of reactions with differences of order 4 over 2e-3.
fn check_changes(mechanism: &Arc<Mechanism>, at: [f64; 3]) {
    let (mut solver, _) = assembled(mechanism);
    let mut solution = Solution::new(&solver);
    solution.seek_forces(&solver);
    solution.driver_rates[0].derivatives = [at[1], at[2]];
    solution.solve(&mut solver).expect("it does not jam");
    for place in 0..4 {
        let mut direction = Direction::zero(mechanism);
        match place {
            0 => direction.drivers[0].value = 1.0,
            1 | 2 => direction.drivers[0].derivatives[place - 1] = 1.0,
            _ => direction.parameters[0] = 1.0,
        }
        let changes = solution.force_changes(&mut solver, &direction);
        let changes = changes.expect("they exist").expect("forces are sought");
        let found = changes.change(EFFORT).expect("it exists");
        let difference = |h: f64| {
            let [above, below] = [h, -h].map(|h| {
                let (mut other, mut at) = ((**mechanism).clone(), at);
                match at.get_mut(place) {
                    Some(number) => *number += h,
                    None => other.parameters[0].default += h,
                }
                effort(&Arc::new(other), at)
            });
            (above - below) / (2.0 * h)
        };
        let wanted = (4.0 * difference(1e-3) - difference(2e-3)) / 3.0;
        let error = (found - wanted).abs() / (1.0 + wanted.abs());
        assert!(error < 1e-8, "{place}: {found} {wanted}");
    }
}

/// A cam that turns, an eccentric disc of 0.03 m, and a follower of 0.4 kg above it.
fn cam(start: f64, follower: &str, friction: &str) -> Arc<Mechanism> {
    parse(&format!(
        r#"
format = 1
name = "cam"
[parameters]
coefficient = 0.2
[ground.markers]
O = [0, 0]
G = [0, 0, "90*deg"]
[bodies.cam]
markers = {{ O = [0, 0] }}
estimate = [0, 0, {start}]
[bodies.follower]
mass = 0.4
markers = {{ R = [0, 0, "90*deg"], C = [0, 0] }}
estimate = [0, 0.045, 0]
[joints]
pivot = {{ type = "revolute", markers = ["ground.O", "cam.O"] }}
guide = {{ type = "translational", markers = ["ground.G", "follower.R"] }}
contact = {{ type = "cam", markers = ["cam.O", "follower.C"], {follower}, profile = "0.01*cos(theta) + sqrt(0.03^2 - (0.01*sin(theta))^2)" }}
[drivers]
turn = {{ coordinate = "angle", markers = ["ground.O", "cam.O"], start = {start} }}
[forces]
load = {{ marker = "follower.C", value = [0, -50] }}
[friction]
rub = {{ joint = "contact", coefficient = "coefficient"{friction} }}
[simulation]
gravity = [0, 0]
"#
    ))
}

/// A flat face bears the load F over the disc's centre e (cos φ, sin φ), and rubs on its top.
#[test]
fn a_flat_follower_rubs_on_its_cam() {
    for (angle, speed) in [(0.4_f64, 1e-9), (0.4, -1e-9), (2.5, 1e-9)] {
        let found = effort(&cam(angle, "follower = 'flat'", ""), [angle, speed, 0.0]);
        let rub = 0.2 * 50.0 * (0.01 * angle.sin() + 0.03);
        let wanted = 50.0 * 0.01 * angle.cos() + speed.signum() * rub;
        assert!((found - wanted).abs() < 1e-13, "{found} {wanted}");
    }
    check_changes(&cam(0.4, "follower = 'flat'", ""), [0.4, 7.0, 5.0]);
}

/// A knife rubs along the contour: N n + T t holds the load upright, T = μ N.
#[test]
fn a_knife_rubs_on_its_cam() {
    let angle = 0.4_f64;
    let (sine, cosine) = angle.sin_cos();
    let center = [0.01 * cosine, 0.01 * sine];
    let top = center[1] + (0.03_f64.powi(2) - center[0] * center[0]).sqrt();
    let n = [-center[0] / 0.03, (top - center[1]) / 0.03];
    let normal = 50.0 / (n[1] + 0.2 * n[0]);
    // The moment of N n + T t about the pivot, with t = n⊥.
    let wanted = top * normal * -(n[0] - 0.2 * n[1]);
    let mechanism = cam(angle, "follower = 'knife'", "");
    let found = effort(&mechanism, [angle, 1e-9, 0.0]);
    assert!((found - wanted).abs() < 1e-13, "{found} {wanted}");
    check_changes(&mechanism, [0.4, 7.0, 5.0]);
}

/// The pin of a roller, of radius a, bears N and T, and its moment μ a √(N² + T²) is T ρ, which the contact
/// bears: T = κ N with κ = k / √(1 − k²), k = μ a / ρ.
#[test]
fn a_roller_rubs_on_its_pin() {
    let angle = 0.4_f64;
    let (sine, cosine) = angle.sin_cos();
    let center = [0.01 * cosine, 0.01 * sine];
    let height = center[1] + (0.04_f64.powi(2) - center[0] * center[0]).sqrt();
    let n = [-center[0] / 0.04, (height - center[1]) / 0.04];
    let k = 0.2 * 0.006 / 0.01;
    let kappa = k / (1.0_f64 - k * k).sqrt();
    let normal = 50.0 / (n[1] + kappa * n[0]);
    let force = [n[0] - kappa * n[1], n[1] + kappa * n[0]].map(|part| normal * part);
    let contact = [0, 1].map(|c| center[c] + 0.03 * n[c]);
    let wanted = contact[0] * force[1] - contact[1] * force[0];
    let mechanism = cam(
        angle,
        "follower = 'roller', radius = 0.01",
        ", radius = 0.006",
    );
    let found = effort(&mechanism, [angle, 1e-9, 0.0]);
    assert!((found - wanted).abs() < 1e-13, "{found} {wanted}");
    check_changes(&mechanism, [0.4, 7.0, 5.0]);
}

/// A slider–crank whose rod is a link, or a body without mass on two pins.
fn slider_crank(is_link: bool) -> Arc<Mechanism> {
    let (body, rod, friction) = if is_link {
        (
            "",
            "rod = { type = 'link', markers = ['crank.A', 'slider.B'], length = 0.3 }",
            "rub = { joint = 'rod', coefficient = 'coefficient', radius = [0.02, 0.015] }",
        )
    } else {
        (
            "[bodies.rod]\nmarkers = { A = [0, 0], B = [0.3, 0] }\nestimate = [0.06, 0.08, -0.26]",
            "a = { type = 'revolute', markers = ['crank.A', 'rod.A'] }\n\
             b = { type = 'revolute', markers = ['rod.B', 'slider.B'] }",
            "at_a = { joint = 'a', coefficient = 'coefficient', radius = 0.02 }\n\
             at_b = { joint = 'b', coefficient = 'coefficient', radius = 0.015 }",
        )
    };
    parse(&format!(
        r#"
format = 1
name = "slider_crank"
[parameters]
coefficient = 0.3
[ground.markers]
O = [0, 0]
[bodies.crank]
mass = 1
center = [0.03, 0.01]
inertia = 0.004
markers = {{ O = [0, 0], A = [0.1, 0] }}
estimate = [0, 0, 0.9]
[bodies.slider]
mass = 2
markers = {{ B = [0, 0] }}
estimate = [0.35, 0, 0]
{body}
[joints]
O = {{ type = "revolute", markers = ["ground.O", "crank.O"] }}
{rod}
guide = {{ type = "translational", markers = ["ground.O", "slider.B"] }}
[drivers]
turn = {{ coordinate = "angle", markers = ["ground.O", "crank.O"], start = 0.9 }}
[forces]
push = {{ marker = "slider.B", value = [-300, 20] }}
[friction]
{friction}
"#
    ))
}

/// The pins of a link rub as those of a massless rod: they bear its couple too.
#[test]
fn a_link_rubs_as_a_rod_on_two_pins() {
    let [link, rod] = [true, false].map(slider_crank);
    for at in [[0.9, 6.0, -3.0], [2.1, -4.0, 2.0], [4.0, 1e-9, 0.0]] {
        let [found, wanted] = [&link, &rod].map(|mechanism| effort(mechanism, at));
        assert!((found - wanted).abs() < 1e-11, "{found} {wanted}");
    }
    check_changes(&link, [0.9, 6.0, -3.0]);
}

/// A point in a groove, whose two sides press it whichever way: a carriage that a force pulls to and fro.
#[test]
fn the_groove_rubs_by_both_sides() {
    let mechanism = parse(
        r#"
format = 1
name = "groove"
[parameters]
coefficient = 0.25
[ground.markers]
O = [0, 0]
[bodies.bead]
mass = 2
markers = { P = [0, 0] }
estimate = [0.3, -0.4, 0]
[constraints]
level = { coordinate = "angle", markers = ["ground.O", "bead.P"], value = 0 }
[joints]
groove = { type = "curve", markers = ["ground.O", "bead.P"], x = "0.5*cos(s)", y = "0.5*sin(s)", from = "-pi", to = 0 }
[drivers]
x = { coordinate = "x", markers = ["ground.O", "bead.P"], start = 0.3 }
[friction]
rub = { joint = "groove", coefficient = "coefficient" }
"#,
    );
    // At the angle θ of the radius, cos θ = 0.6 and sin θ = −0.8, ẋ = 0.4 θ̇, and ẍ = 0 makes
    // θ̈ = 0.75 θ̇². Along the groove 0.8 F = m R θ̈ + m g cos θ ± μ |N|, and towards the centre
    // N = m R θ̇² − m g sin θ + 0.6 F: negative where the outer side lets go.
    for velocity in [0.7_f64, -0.7, 2.0, -2.0] {
        let square = (velocity / 0.4).powi(2);
        let along = 2.0 * (0.5 * 0.75 * square + 9.81 * 0.6);
        let across = 2.0 * (0.5 * square + 9.81 * 0.8);
        let rub = 0.25 * velocity.signum();
        let wanted = (along + rub * across) / (0.8 - rub * 0.6);
        let found = effort(&mechanism, [0.3, velocity, 0.0]);
        assert!(
            (found - wanted).abs() < 1e-12,
            "{velocity}: {found} {wanted}"
        );
    }
    check_changes(&mechanism, [0.3, 0.7, 1.0]);
}

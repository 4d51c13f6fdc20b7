//! Mechanisms against Lagrange's equations in minimal coordinates, with closed-form kinematics.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use biela::mechanism::{Jet, Mechanism};

use super::minimal::{Mass, Minimal, body, from, unloaded};
use super::run::{Fed, assert_lagrange, times};
use super::taylor::Taylor;
use crate::common::{folder, parse, shipped};

pub(super) const GRAVITY: [f64; 2] = [0.0, -9.81];

pub(super) fn zero() -> [Taylor; 2] {
    [Taylor::from(0.0); 2]
}

/// Inertia of a thin rod about its middle.
pub(super) fn rod(mass: f64, length: f64) -> f64 {
    mass * length * length / 12.0
}

fn double_pendulum(z: &[Taylor], _: Taylor) -> Vec<Mass> {
    let upper = z[0] - FRAC_PI_2;
    let lower = upper + z[1];
    let [x, y] = from(zero(), 0.4, upper);
    let [o, _] = zero();
    vec![
        body(1.0, rod(1.0, 0.4), [o, o, upper], [0.2, 0.0]),
        body(0.6, rod(0.6, 0.3), [x, y, lower], [0.15, 0.0]),
    ]
}

#[test]
fn double_pendulum_follows_lagrange() {
    let truth = Minimal {
        gravity: GRAVITY,
        masses: double_pendulum,
        loads: unloaded,
    };
    assert_lagrange(
        "double_pendulum",
        &shipped("double_pendulum"),
        Fed::default(),
        &truth,
        &times(3.0, 30),
    );
}

/// Pins and angles of the four-bar of 0.1, 0.25, 0.3 and 0.4 m at a crank angle: the crank's pin,
/// the coupler's angle, the rocker's angle.
pub(super) fn four_bar_kinematics(crank: Taylor) -> ([Taylor; 2], Taylor, Taylor) {
    let pin = from(zero(), 0.1, crank);
    let diagonal = (0.4 - pin[0]).hypot(pin[1]);
    let leaning = (-pin[1]).atan2(0.4 - pin[0]);
    let corner = |beside: f64, opposite: f64| {
        let cosine = (diagonal * diagonal + beside * beside - opposite * opposite)
            / (2.0 * beside * diagonal);
        cosine.acos()
    };
    (
        pin,
        leaning + corner(0.25, 0.3),
        leaning + PI - corner(0.3, 0.25),
    )
}

pub(super) fn four_bar(z: &[Taylor], _: Taylor) -> Vec<Mass> {
    let ([x, y], coupler, rocker) = four_bar_kinematics(z[0]);
    let [o, _] = zero();
    vec![
        body(2.0, 0.008, [o, o, z[0]], [0.0, 0.0]),
        body(0.5, 0.003, [x, y, coupler], [0.12, 0.02]),
        body(0.8, 0.006, [o + 0.4, o, rocker], [0.15, 0.0]),
    ]
}

fn torque(t: f64) -> f64 {
    1.5 * (3.0 * t).sin()
}

pub(super) fn four_bar_loads(z: &[Taylor], t: Taylor) -> Vec<(Taylor, f64)> {
    let (_, _, rocker) = four_bar_kinematics(z[0]);
    vec![(z[0], torque(t.value)), (rocker, -0.02 * rocker.first)]
}

pub(super) const FOUR_BAR: Minimal = Minimal {
    gravity: GRAVITY,
    masses: four_bar,
    loads: four_bar_loads,
};

pub(super) fn torque_input() -> Fed {
    Fed {
        loads: |t, loads| loads.fill(torque(t)),
        ..Fed::default()
    }
}

#[test]
fn four_bar_follows_lagrange() {
    assert_lagrange(
        "four_bar_free",
        &shipped("four_bar_free"),
        torque_input(),
        &FOUR_BAR,
        &times(3.0, 30),
    );
}

/// The rod's angle and the slider's stroke of 0.05 and 0.15 m.
fn slider_crank_kinematics(crank: Taylor) -> (Taylor, Taylor) {
    let down = 0.05 * crank.sin();
    let across = (0.15 * 0.15 - down * down).sqrt();
    ((-down).atan2(across), 0.05 * crank.cos() + across)
}

fn slider_crank(z: &[Taylor], _: Taylor) -> Vec<Mass> {
    let (rod, stroke) = slider_crank_kinematics(z[0]);
    let [x, y] = from(zero(), 0.05, z[0]);
    let [o, _] = zero();
    vec![
        body(1.5, 0.004, [o, o, z[0]], [0.0, 0.0]),
        body(0.3, 8e-4, [x, y, rod], [0.06, 0.0]),
        body(0.5, 0.0, [stroke, o, o], [0.0, 0.0]),
    ]
}

fn slider_crank_loads(z: &[Taylor], t: Taylor) -> Vec<(Taylor, f64)> {
    let (_, stroke) = slider_crank_kinematics(z[0]);
    vec![(z[0], torque(t.value)), (stroke, -60.0 * stroke.first)]
}

#[test]
fn slider_crank_with_a_motor_follows_lagrange() {
    let truth = Minimal {
        gravity: GRAVITY,
        masses: slider_crank,
        loads: slider_crank_loads,
    };
    assert_lagrange(
        "slider_crank_motor",
        &shipped("slider_crank_motor"),
        torque_input(),
        &truth,
        &times(2.0, 20),
    );
}

/// Cranks of 0.12 and 0.1 m on pivots 0.3 m apart, links of 0.3 m: never stretched, never folded.
fn five_bar(z: &[Taylor], _: Taylor) -> Vec<Mass> {
    let [o, _] = zero();
    let [ax, ay] = from(zero(), 0.12, z[0]);
    let [bx, by] = from([o + 0.3, o], 0.1, z[1]);
    let (dx, dy) = (bx - ax, by - ay);
    let leaning = dy.atan2(dx);
    let corner = (dx.hypot(dy) / 0.6).acos();
    vec![
        body(1.0, 0.002, [o, o, z[0]], [0.05, 0.01]),
        body(0.7, 0.003, [o + 0.3, o, z[1]], [0.06, 0.0]),
        body(0.4, 0.004, [ax, ay, leaning + corner], [0.15, 0.0]),
        body(0.5, 0.005, [bx, by, leaning + PI - corner], [0.14, 0.0]),
    ]
}

fn five_bar_text() -> String {
    let corner = (0.3_f64 / 0.6).acos();
    format!(
        "format = 1\nname = \"five_bar\"\n[ground.markers]\nO1 = [0, 0]\nO2 = [0.3, 0]\n\
         [bodies.left]\nmarkers = {{ O = [0, 0], A = [0.12, 0] }}\nestimate = [0, 0, 1.5]\n\
         mass = 1\ninertia = 0.002\ncenter = [0.05, 0.01]\n\
         [bodies.right]\nmarkers = {{ O = [0, 0], B = [0.1, 0] }}\nestimate = [0.3, 0, 1.2]\n\
         mass = 0.7\ninertia = 0.003\ncenter = [0.06, 0]\n\
         [bodies.one]\nmarkers = {{ A = [0, 0], C = [0.3, 0] }}\nestimate = [0, 0.12, {corner}]\n\
         mass = 0.4\ninertia = 0.004\ncenter = [0.15, 0]\n\
         [bodies.two]\nmarkers = {{ B = [0, 0], C = [0.3, 0] }}\n\
         estimate = [0.32, 0.1, {}]\nmass = 0.5\ninertia = 0.005\ncenter = [0.14, 0]\n\
         [joints]\nO1 = {{ type = \"revolute\", markers = [\"ground.O1\", \"left.O\"] }}\n\
         O2 = {{ type = \"revolute\", markers = [\"ground.O2\", \"right.O\"] }}\n\
         A = {{ type = \"revolute\", markers = [\"left.A\", \"one.A\"] }}\n\
         B = {{ type = \"revolute\", markers = [\"right.B\", \"two.B\"] }}\n\
         C = {{ type = \"revolute\", markers = [\"one.C\", \"two.C\"] }}\n\
         [freedoms]\nleft_angle = {{ coordinate = \"angle\", markers = [\"ground.O1\", \"left.O\"], \
         start = 1.5, velocity = 3 }}\n\
         right_angle = {{ coordinate = \"angle\", markers = [\"ground.O2\", \"right.O\"], \
         start = 1.2, velocity = -2 }}\n",
        PI - corner
    )
}

#[test]
fn five_bar_follows_lagrange() {
    let truth = Minimal {
        gravity: GRAVITY,
        masses: five_bar,
        loads: unloaded,
    };
    assert_lagrange(
        "five_bar",
        &parse(&five_bar_text()),
        Fed::default(),
        &truth,
        &times(2.0, 20),
    );
}

fn cart_pole(z: &[Taylor], _: Taylor) -> Vec<Mass> {
    let [o, _] = zero();
    vec![
        body(1.0, 0.0, [z[0], o, o], [0.0, 0.0]),
        body(0.2, rod(0.2, 0.6), [z[0], o, z[1] + FRAC_PI_2], [0.3, 0.0]),
    ]
}

fn cart_pole_loads(z: &[Taylor], t: Taylor) -> Vec<(Taylor, f64)> {
    vec![(z[0], torque(t.value) - 0.1 * z[0].first)]
}

#[test]
fn cart_pole_follows_lagrange() {
    let truth = Minimal {
        gravity: GRAVITY,
        masses: cart_pole,
        loads: cart_pole_loads,
    };
    assert_lagrange(
        "cart_pole",
        &shipped("cart_pole"),
        torque_input(),
        &truth,
        &times(4.0, 40),
    );
}

fn swinging_tip(z: &[Taylor], t: Taylor) -> Vec<Mass> {
    let crank = 0.6 * (4.0 * t).sin() - FRAC_PI_2;
    let [x, y] = from(zero(), 0.2, crank);
    let [o, _] = zero();
    vec![
        body(1.0, 0.01, [o, o, crank], [0.1, 0.0]),
        body(0.4, 0.004, [x, y, crank + z[0]], [0.2, 0.0]),
    ]
}

fn swinging_tip_loads(z: &[Taylor], _: Taylor) -> Vec<(Taylor, f64)> {
    vec![(z[0], -0.004 * z[0].first)]
}

pub(super) const SWINGING_TIP: Minimal = Minimal {
    gravity: GRAVITY,
    masses: swinging_tip,
    loads: swinging_tip_loads,
};

/// The shipped mechanism with the crank as an input.
fn tip_on_an_input() -> Arc<Mechanism> {
    let path = folder("mechanisms").join("swinging_tip.toml");
    let text = std::fs::read_to_string(path).expect("it is shipped");
    let motion = "motion = \"sway*sin(frequency*t)\"";
    assert!(text.contains(motion));
    parse(&text.replace(motion, "start = 0"))
}

/// The crank follows a prescribed motion, then the same motion as an input.
#[test]
fn a_tip_on_a_driven_crank_follows_lagrange() {
    let moved = Fed {
        driver: |_, t| {
            let (sin, cos) = (4.0 * t).sin_cos();
            Jet::new(0.6 * sin, [2.4 * cos, -9.6 * sin])
        },
        ..Fed::default()
    };
    let kinds = [
        ("motion", shipped("swinging_tip"), Fed::default()),
        ("input", tip_on_an_input(), moved),
    ];
    for (kind, mechanism, fed) in kinds {
        let name = format!("swinging_tip, {kind}");
        assert_lagrange(&name, &mechanism, fed, &SWINGING_TIP, &times(4.0, 40));
    }
}

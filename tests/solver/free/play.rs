//! Joints that open in free motion: ropes, cams and wheels with backlash, against closed forms.

use std::sync::Arc;

use biela::dynamics::EventKind;
use biela::kinematics::{Direction, ForceQuantity, Rates, Solution};
use biela::mechanism::Mechanism;

use super::events::{assert_near, played};
use super::run::{Fed, Run};
use crate::common::parse;

const TOLERANCE: f64 = 1e-10;
const G: f64 = 9.81;

/// A ball of 2 kg at a rope of 1 m that is fixed at the origin.
fn ball([x, y]: [f64; 2], [vx, vy]: [f64; 2], more: &str) -> Arc<Mechanism> {
    parse(&format!(
        r#"
format = 1
name = "ball"
[ground.markers]
A = [0, 0]
[bodies.ball]
mass = 2
markers = {{ B = [0, 0] }}
[joints]
rope = {{ type = "rope", markers = ["ground.A", "ball.B"], length = 1, unilateral = true{more} }}
[constraints]
upright = {{ coordinate = "angle", markers = ["ground.A", "ball.B"], value = 0 }}
[freedoms]
x = {{ coordinate = "x", markers = ["ground.A", "ball.B"], start = {x}, velocity = {vx} }}
y = {{ coordinate = "y", markers = ["ground.A", "ball.B"], start = {y}, velocity = {vy} }}
"#
    ))
}

/// Force of the first joint that the outputs name at the present time.
fn reaction(run: &mut Run, joint: usize, component: usize) -> f64 {
    let mut solution = Solution::new(&run.solver);
    solution.seek_forces(&run.solver);
    run.free.tell(&mut solution);
    solution
        .solve(&mut run.solver)
        .expect("the pose is regular");
    solution.force(ForceQuantity::Reaction(joint, component))
}

#[test]
fn a_ball_falls_into_its_rope() {
    // It falls from (0.3, 0) to where the rope is stretched; only the velocity across stays.
    let drop = (1.0_f64 - 0.09).sqrt();
    let (time, fall) = ((2.0 * drop / G).sqrt(), (2.0 * G * drop).sqrt());
    let mut run = Run::new(&ball([0.3, 0.0], [0.0, 0.0], ""), TOLERANCE, Fed::default());
    let events = played(&mut run, time + 1e-9, 3);
    assert_near(events[0].time, time);
    let EventKind::Impact { speed } = events[0].kind else {
        panic!("{events:?}");
    };
    assert_near(speed, fall * drop);
    let across = fall * 0.3;
    let tension = 2.0 * (across * across + G * drop);
    assert!(
        (reaction(&mut run, 0, 0) - tension).abs() < 1e-6,
        "{tension}"
    );
    let state = run.state();
    assert!((state[2] - -across * drop).abs() < 1e-7, "{state:?}");
    played(&mut run, 20.0, 1);
    assert!(
        run.free.energy_error().abs() < 1e-9,
        "{}",
        run.free.energy_error()
    );
    let [values, ..] = run.freedoms();
    assert!(values[0].hypot(values[1]) < 1.0 + 1e-12, "{values:?}");
}

/// A bounce throws it back with a part of the speed along the rope.
#[test]
fn a_rope_throws_back() {
    let mechanism = ball([0.0, -0.5], [0.0, 0.0], ", restitution = 0.6");
    let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
    let [time, fall] = [(1.0 / G).sqrt(), G.sqrt()];
    let flight = 2.0 * 0.6 * fall / G;
    let events = played(&mut run, time + flight + 1e-6, 3);
    assert_eq!(events.len(), 2, "{events:?}");
    assert_near(events[0].time, time);
    assert_near(events[1].time, time + flight);
}

/// From the lowest point with v² between 2 g L and 5 g L the rope goes slack at the angle β above the
/// level with 3 g L sin β = v² − 2 g L.
#[test]
fn a_rope_goes_slack() {
    let square = 3.5 * G;
    let mechanism = ball([0.0, -1.0], [square.sqrt(), 0.0], "");
    let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
    let events = played(&mut run, 1.0, 3);
    assert_eq!(events[0].kind, EventKind::Leaves, "{events:?}");
    let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
    run.to(events[0].time);
    let height = (square - 2.0 * G) / (3.0 * G);
    assert_near(run.state()[1], height);
}

/// The knife on r = 0.045 − 0.005 sin: it leaves where the contour falls away faster than it, and
/// meets it again on its parabola.
#[test]
fn a_cam_throws_its_follower() {
    let (speed, eccentricity) = (60.0, 0.005);
    let text = format!(
        r#"
format = 1
name = "cam"
[ground.markers]
O = [0, 0]
G = [0, 0, "90*deg"]
[bodies.cam]
markers = {{ O = [0, 0] }}
[bodies.follower]
mass = 0.5
markers = {{ R = [0, 0, "90*deg"], C = [0, 0] }}
estimate = [0, 0.045, 0]
[joints]
pivot = {{ type = "revolute", markers = ["ground.O", "cam.O"] }}
guide = {{ type = "translational", markers = ["ground.G", "follower.R"] }}
contact = {{ type = "cam", markers = ["cam.O", "follower.C"], follower = "knife", profile = "0.045 - 0.005*cos(theta)", unilateral = true }}
[drivers]
turn = {{ coordinate = "angle", markers = ["ground.O", "cam.O"], motion = "{speed}*t" }}
[freedoms]
lift = {{ coordinate = "x", markers = ["ground.G", "follower.R"], start = 0.045, velocity = {velocity} }}
"#,
        velocity = -speed * eccentricity
    );
    let place = |t: f64| 0.045 - eccentricity * (speed * t).sin();
    let rate = |t: f64| -eccentricity * speed * (speed * t).cos();
    let leaves = (std::f64::consts::PI + (G / (eccentricity * speed * speed)).asin()) / speed;
    let flight = |t: f64| {
        let h = t - leaves;
        place(leaves) + h * (rate(leaves) - 0.5 * G * h)
    };
    let (mut low, mut high) = (leaves + 0.02, leaves + 0.1);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if flight(middle) > place(middle) {
            low = middle
        } else {
            high = middle
        }
    }
    let speed = rate(low) - (rate(leaves) - G * (low - leaves));
    let mut run = Run::new(&parse(&text), TOLERANCE, Fed::default());
    let events = played(&mut run, low + 1e-6, 5);
    assert_eq!(events[0].kind, EventKind::Leaves, "{events:?}");
    assert_near(events[0].time, leaves);
    assert_near(events[1].time, low);
    let EventKind::Impact { speed: found } = events[1].kind else {
        panic!("{events:?}");
    };
    assert_near(found, speed);
    // It rides again, pushed by no more than it needs.
    run.to(low + 0.01);
    let t = low + 0.01;
    assert_near(run.state()[0], place(t));
    let lifting = G + eccentricity * 3600.0 * (60.0 * t).sin();
    assert_near(reaction(&mut run, 2, 1), 0.5 * lifting);
}

/// A pinion of 20 teeth and a wheel of 60, with play.
fn wheels(turned: f64, velocity: f64, more: &str, parts: &str) -> Arc<Mechanism> {
    parse(&format!(
        r#"
format = 1
name = "wheels"
[parameters]
torque = 0.4
[ground.markers]
O = [0, 0]
P = [0.1, 0]
[bodies.pinion]
mass = 1
inertia = 0.001
markers = {{ O = [0, 0] }}
[bodies.wheel]
mass = 1
inertia = 0.02
markers = {{ P = [0, 0] }}
estimate = [0.1, 0, 0]
[joints]
O = {{ type = "revolute", markers = ["ground.O", "pinion.O"] }}
P = {{ type = "revolute", markers = ["ground.P", "wheel.P"] }}
mesh = {{ type = "gear", markers = ["pinion.O", "wheel.P"], teeth = [20, 60], phase = "drawn", backlash = 0.03{more} }}
[freedoms]
a = {{ coordinate = "angle", markers = ["ground.O", "pinion.O"], start = 0, velocity = {velocity} }}
b = {{ coordinate = "angle", markers = ["ground.P", "wheel.P"], start = {turned} }}
[forces]
motor = {{ coordinate = "angle", markers = ["ground.O", "pinion.O"], value = "torque" }}
{parts}
"#
    ))
}

#[test]
fn wheels_meet_on_both_flanks() {
    let (velocity, restitution) = (6.0, 0.5);
    let still = "brake = { coordinate = \"angle\", markers = [\"ground.O\", \"pinion.O\"], value = \"-torque\" }";
    let mechanism = wheels(0.0, velocity, ", restitution = 0.5", still);
    let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
    let closing = velocity / 3.0;
    let first = 0.015 / closing;
    let second = first + 0.03 / (restitution * closing);
    let events = played(&mut run, second + 1e-6, 4);
    assert_eq!(events.len(), 2, "{events:?}");
    for (event, time, speed) in [
        (events[0], first, closing),
        (events[1], second, restitution * closing),
    ] {
        assert_near(event.time, time);
        let EventKind::Impact { speed: found } = event.kind else {
            panic!("{events:?}");
        };
        assert_near(found, speed);
    }
    // Momenta about the two pivots change by P and 3 P: a third of the pinion's joins the wheel's.
    let [_, velocities, _] = run.freedoms();
    let angular = 0.001 * velocities[0] - 0.02 * velocities[1] / 3.0;
    assert_near(angular, 0.001 * velocity);
}

/// The wheels accelerate together as the flanks touch; derivatives know it too.
#[test]
fn touching_flanks_carry_the_torque() {
    let mechanism = wheels(0.015, 0.0, "", "");
    let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
    let inertia = 0.001 + 0.02 / 9.0;
    assert_near(run.free.drivers()[0].second(), 0.4 / inertia);
    let id = mechanism.parameter_id("torque").expect("it is there");
    let mut direction = Direction::by_parameter(&mechanism, id);
    let mut rates = Rates::new(run.solver.pose().q.len());
    let drivers = run.free.drivers().to_vec();
    (run.solver)
        .solve_rates(|driver| drivers[driver.index()], &mut rates)
        .expect("the pose is regular");
    let completed = run.free.complete(&mut run.solver, &rates, &mut direction);
    completed.expect("it has derivatives");
    assert_near(direction.drivers[0].second(), 1.0 / inertia);
    assert_near(direction.drivers[1].second(), -1.0 / (3.0 * inertia));
    // The torque on the wheel.
    assert_near(reaction(&mut run, 2, 2), -0.02 * 0.4 / inertia / 3.0);
}

/// A bolt on a spring is at or above the contour of the nose that passes below it, A (1 − cos ωt): it leaves
/// where the spring cannot follow, m A ω² cos ωt + k (h + x₀) = 0, swings about −x₀, and lands.
#[test]
fn a_bolt_leaves_the_nose_that_lifts_it() {
    let [mass, stiffness, lead, height, omega] = [0.2_f64, 100.0, 0.01, 0.005, 50.0];
    let mechanism = parse(&format!(
        r#"
format = 1
name = "bolt"
[ground.markers]
O = [0, 0]
G = [0, 0, "90*deg"]
[bodies.door]
markers = {{ O = [0, 0] }}
[bodies.bolt]
mass = {mass}
markers = {{ G = [0, 0, "90*deg"] }}
[joints]
hinge = {{ type = "translational", markers = ["ground.O", "door.O"] }}
guide = {{ type = "translational", markers = ["ground.G", "bolt.G"] }}
latch = {{ type = "coupling", equation = "lift = {height}*(1 - cos(way/0.01))", unilateral = true }}
[drivers]
way = {{ coordinate = "x", markers = ["ground.O", "door.O"], motion = "0.5*t" }}
[freedoms]
lift = {{ coordinate = "x", markers = ["ground.G", "bolt.G"], start = 0 }}
[forces]
spring = {{ coordinate = "x", markers = ["ground.G", "bolt.G"], stiffness = {stiffness}, free = -{lead} }}
[simulation]
gravity = [0, 0]
"#
    ));
    let place = |t: f64| height * (1.0 - (omega * t).cos());
    let rate = |t: f64| height * omega * (omega * t).sin();
    let push =
        |t: f64| mass * height * omega * omega * (omega * t).cos() + stiffness * (place(t) + lead);
    let leaves = {
        let spare = height * (mass * omega * omega - stiffness);
        (-stiffness * (height + lead) / spare).acos() / omega
    };
    let own = (stiffness / mass).sqrt();
    let flight = |t: f64| {
        let (sine, cosine) = (own * (t - leaves)).sin_cos();
        let [far, fast] = [place(leaves) + lead, rate(leaves) / own];
        [
            far * cosine + fast * sine - lead,
            own * (fast * cosine - far * sine),
        ]
    };
    let (mut low, mut high) = (leaves + 0.02, std::f64::consts::TAU / omega);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if flight(middle)[0] > place(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    let closing = rate(low) - flight(low)[1];
    let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
    run.to(0.02);
    assert_near(reaction(&mut run, 2, 2), push(0.02));
    let middle = 0.5 * (leaves + low);
    let mut events = played(&mut run, middle, 2);
    assert_near(run.state()[0], flight(middle)[0]);
    assert!(reaction(&mut run, 2, 2).abs() < f64::MIN_POSITIVE);
    events.extend(played(&mut run, low + 0.002, 2));
    assert_eq!(events[0].kind, EventKind::Leaves, "{events:?}");
    assert_near(events[0].time, leaves);
    assert_near(events[1].time, low);
    let EventKind::Impact { speed } = events[1].kind else {
        panic!("{events:?}");
    };
    assert_near(speed, closing);
    assert_near(run.state()[0], place(low + 0.002));
    assert_near(reaction(&mut run, 2, 2), push(low + 0.002));
}

/// Two wheels of which a is at or beyond twice b: turns count, and b, ten turns behind, drives a from where
/// they meet, with momenta changed by P and −2 P.
#[test]
fn the_faster_wheel_meets_the_other_after_turns() {
    let text = |equation: &str| {
        format!(
            r#"
format = 1
name = "wheels"
[ground.markers]
O = [0, 0]
[bodies.left]
mass = 1
inertia = 0.3
markers = {{ O = [0, 0] }}
estimate = [0, 0, 63]
[bodies.right]
mass = 1
inertia = 0.5
markers = {{ O = [0, 0] }}
[joints]
o = {{ type = "revolute", markers = ["ground.O", "left.O"] }}
p = {{ type = "revolute", markers = ["ground.O", "right.O"] }}
pawl = {{ type = "coupling", equation = "{equation}", unilateral = true, restitution = 0.25 }}
[freedoms]
a = {{ coordinate = "angle", markers = ["ground.O", "left.O"], start = 63 }}
b = {{ coordinate = "angle", markers = ["ground.O", "right.O"], start = 0, velocity = 7 }}
"#
        )
    };
    let (time, closing) = (63.0 / 14.0, 14.0);
    let impulse = 1.25 * closing / (1.0 / 0.3 + 4.0 / 0.5);
    let [a, b] = [impulse / 0.3, 7.0 - 2.0 * impulse / 0.5];
    let mut run = Run::new(&parse(&text("a = 2*b")), TOLERANCE, Fed::default());
    let events = played(&mut run, time + 1.0, 3);
    assert_eq!(events.len(), 1, "{events:?}");
    assert_near(events[0].time, time);
    let EventKind::Impact { speed } = events[0].kind else {
        panic!("{events:?}");
    };
    assert_near(speed, closing);
    let state = run.state();
    let wanted = [63.0 + a, 7.0 * time + b, a, b];
    for (found, wanted) in state.into_iter().zip(wanted) {
        assert_near(found, wanted);
    }
    // The other way round they overlap: the start is moved apart, by the least motion in the metric of
    // the inertia.
    let run = Run::new(&parse(&text("2*b = a")), TOLERANCE, Fed::default());
    let [values, ..] = run.freedoms();
    let push = 63.0 / (1.0 / 0.3 + 4.0 / 0.5);
    assert_near(values[0], 63.0 - push / 0.3);
    assert_near(values[1], 2.0 * push / 0.5);
}

/// A start at which the parts would overlap is moved until they touch.
#[test]
fn an_overlapping_start_is_closed() {
    let run = Run::new(
        &ball([0.3, -1.2], [0.0, 0.0], ""),
        TOLERANCE,
        Fed::default(),
    );
    let [values, ..] = run.freedoms();
    assert!(
        (values[0].hypot(values[1]) - 1.0).abs() < 1e-13,
        "{values:?}"
    );
}

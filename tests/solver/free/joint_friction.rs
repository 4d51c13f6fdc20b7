//! Friction in joints, in free motion: against closed forms, an equation of motion solved apart, and
//! finite differences.

use std::sync::Arc;

use biela::dynamics::EventKind;
use biela::kinematics::{Direction, Rates};
use biela::mechanism::{DriverId, Mechanism, Order};

use super::events::{assert_near, check, pendulum, played, slider};
use super::run::{Fed, Run};
use crate::common::parse;

const G: f64 = 9.81;

/// A block of 2 kg on a slope: friction is the coefficient times its weight across.
#[test]
fn a_block_turns_back_or_sticks_on_a_slope() {
    let slope = |coefficient: f64| {
        let friction =
            format!("[friction]\nrail = {{ joint = \"guide\", coefficient = {coefficient} }}");
        slider(20.0, 0.0, 3.0, &friction)
    };
    let (sine, cosine) = 20.0_f64.to_radians().sin_cos();
    let (coefficient, time) = (0.2, 2.0);
    let [up, down] = [1.0, -1.0].map(|sign| G * (sine + sign * coefficient * cosine));
    let (turn, top) = (3.0 / up, 9.0 / (2.0 * up));
    let fallen = time - turn;
    let state = [top - 0.5 * down * fallen * fallen, -down * fallen];
    check(&slope(coefficient), time, &[], state);
    // tan 20° = 0.364.
    let up = G * (sine + 0.37 * cosine);
    let rest = [(3.0 / up, EventKind::Sticks)];
    check(&slope(0.37), time, &rest, [9.0 / (2.0 * up), 0.0]);
}

/// A force F beside a guide of length L, at an arm a, presses its ends with F a / L each: it moves the
/// drawer only if 2 μ a < L, however large it is.
#[test]
fn a_drawer_jams_where_the_arm_is_long() {
    let drawer = |coefficient: f64, force: f64| {
        let parts = format!(
            r#"
[forces]
pull = {{ marker = "slider.P", value = [{force}, 0], torque = {torque} }}
[friction]
rail = {{ joint = "guide", coefficient = {coefficient}, length = 0.2 }}
[simulation]
gravity = [0, 0]
"#,
            torque = 0.05 * force
        );
        slider(0.0, 0.0, 0.0, &parts)
    };
    let (force, time) = (10.0, 0.5);
    let acceleration = force * (1.0 - 2.0 * 0.3 * 0.05 / 0.2) / 2.0;
    let state = [0.5 * acceleration * time * time, acceleration * time];
    check(&drawer(0.3, force), time, &[], state);
    for force in [1.0, 1e6] {
        check(&drawer(2.1, force), time, &[], [0.0, 0.0]);
    }
}

/// Radius of the pin.
const RADIUS: f64 = 0.02;
const COEFFICIENT: f64 = 0.4;

fn pinned(start: f64) -> String {
    let parts = format!(
        "[friction]\nfit = {{ joint = \"pin\", coefficient = {COEFFICIENT}, static = 0.5, radius = {RADIUS} }}"
    );
    pendulum(&parts).replace("start = 0 }", &format!("start = {start} }}"))
}

/// Acceleration of the rod at an angle and a velocity: J α = −m g c cos φ ∓ μ r |R|, with
/// R = m (a + g) by its centre of mass. The norm is the fixed point of a contraction.
fn acceleration(angle: f64, velocity: f64) -> f64 {
    let (sine, cosine) = angle.sin_cos();
    let (center, inertia) = (0.5, 1.0 / 3.0);
    let mut acceleration = 0.0;
    for _ in 0..100 {
        let along = -center * velocity * velocity + G * sine;
        let across = center * acceleration + G * cosine;
        let friction = COEFFICIENT * RADIUS * along.hypot(across);
        acceleration = (-G * center * cosine - velocity.signum() * friction) / inertia;
    }
    acceleration
}

/// The motion from rest to a time by the method of Runge and Kutta of order 4, in steps of 1e-4 s: their
/// error is some 1e-14.
fn swung(start: f64, until: f64) -> [f64; 2] {
    let steps = (until / 1e-4).round() as usize;
    let h = until / steps as f64;
    let slope = |[angle, velocity]: [f64; 2]| [velocity, acceleration(angle, velocity)];
    let ahead = |x: [f64; 2], part: f64, k: [f64; 2]| [x[0] + part * k[0], x[1] + part * k[1]];
    // It falls from the first instant on.
    let mut x = [start, -0.0];
    for _ in 0..steps {
        let first = slope(x);
        let second = slope(ahead(x, 0.5 * h, first));
        let third = slope(ahead(x, 0.5 * h, second));
        let last = slope(ahead(x, h, third));
        for k in 0..2 {
            x[k] += h / 6.0 * (first[k] + 2.0 * (second[k] + third[k]) + last[k]);
        }
    }
    x
}

#[test]
fn a_pendulum_swings_with_friction_in_its_pin() {
    check(&pinned(0.0), 0.7, &[], swung(0.0, 0.7));
}

#[test]
fn a_pendulum_sticks_where_its_pin_bears_the_moment() {
    // m g c sin β < μ r m g up to β = asin(0.02).
    let hanging = -std::f64::consts::FRAC_PI_2;
    check(&pinned(hanging + 0.0199), 1.0, &[], [hanging + 0.0199, 0.0]);
    let mut run = Run::new(&parse(&pinned(hanging + 0.0201)), 1e-10, Fed::default());
    played(&mut run, 0.1, 1);
    assert!(run.state()[1] < 0.0, "{:?}", run.state());
    // A swing ends at rest between these angles.
    let mut run = Run::new(&parse(&pinned(0.0)), 1e-10, Fed::default());
    let events = played(&mut run, 60.0, 7);
    assert_eq!(events.len(), 1, "{events:?}");
    assert!((run.state()[0] - hanging).abs() < 0.02, "{:?}", run.state());
    assert_near(run.free.energy_error(), 0.0);
}

/// A crank, a rod and a slider with friction in all joints.
const SLIDER_CRANK: &str = r#"
format = 1
name = "slider_crank"
[parameters]
coefficient = 0.15
load = 40
[ground.markers]
O = [0, 0]
[bodies.crank]
mass = 1.2
center = [0.04, 0.01]
inertia = 0.004
markers = { O = [0, 0], A = [0.1, 0] }
estimate = [0, 0, "50*deg"]
[bodies.rod]
mass = 0.8
center = [0.15, 0]
inertia = 0.009
markers = { A = [0, 0], B = [0.3, 0] }
estimate = [0.06, 0.08, "-14*deg"]
[bodies.slider]
mass = 1.5
markers = { B = [0, 0], P = [0.02, 0.03] }
estimate = [0.36, 0, 0]
[joints]
O = { type = "revolute", markers = ["ground.O", "crank.O"] }
A = { type = "revolute", markers = ["crank.A", "rod.A"] }
B = { type = "revolute", markers = ["rod.B", "slider.B"] }
guide = { type = "translational", markers = ["ground.O", "slider.B"] }
[freedoms]
turn = { coordinate = "angle", markers = ["ground.O", "crank.O"], start = "50*deg", velocity = 4 }
[forces]
push = { marker = "slider.P", value = ["-load", 0] }
[friction]
at_O = { joint = "O", coefficient = "coefficient", radius = 0.012 }
at_A = { joint = "A", coefficient = "coefficient", static = 0.3, stribeck = 5, radius = 0.01 }
at_B = { joint = "B", coefficient = 0.2, viscous = 0.01, radius = 0.008 }
rail = { joint = "guide", coefficient = "coefficient", length = 0.05 }
"#;

fn accelerated(mechanism: &Mechanism) -> f64 {
    let run = Run::new(&Arc::new(mechanism.clone()), 1e-10, Fed::default());
    run.free.drivers()[0].second()
}

/// The directional derivatives of the acceleration agree with finite differences, of order 4.
#[test]
fn the_acceleration_changes_as_differences_say() {
    let mechanism = parse(SLIDER_CRANK);
    let turn = DriverId(0);
    let mut run = Run::new(&mechanism, 1e-10, Fed::default());
    let mut rates = Rates::new(run.solver.pose().q.len());
    let drivers = run.free.drivers().to_vec();
    (run.solver)
        .solve_rates(|driver| drivers[driver.index()], &mut rates)
        .expect("the pose is regular");
    let start = |order: Order| {
        let mechanism = mechanism.clone();
        move |by: f64| {
            let mut other = (*mechanism).clone();
            let value = match order {
                Order::Position => 50.0_f64.to_radians(),
                _ => 4.0,
            };
            other.set_start(turn, order, value + by);
            other
        }
    };
    let parameter = |name: &'static str| {
        let mechanism = mechanism.clone();
        move |by: f64| {
            let mut other = (*mechanism).clone();
            let id = other.parameter_id(name).expect("it is there");
            other.parameters[id.index()].default += by;
            other
        }
    };
    let mut by_position = Direction::zero(&mechanism);
    by_position.drivers[0].value = 1.0;
    let mut by_velocity = Direction::zero(&mechanism);
    by_velocity.drivers[0].derivatives[0] = 1.0;
    let by = |name| {
        let id = mechanism.parameter_id(name).expect("it is there");
        Direction::by_parameter(&mechanism, id)
    };
    type Other = Box<dyn Fn(f64) -> Mechanism>;
    let cases: [(&str, Direction, Other, f64); 4] = [
        (
            "position",
            by_position,
            Box::new(start(Order::Position)),
            1e-3,
        ),
        (
            "velocity",
            by_velocity,
            Box::new(start(Order::Velocity)),
            1e-2,
        ),
        (
            "coefficient",
            by("coefficient"),
            Box::new(parameter("coefficient")),
            1e-3,
        ),
        ("load", by("load"), Box::new(parameter("load")), 1e-1),
    ];
    for (name, mut direction, other, h) in cases {
        let mut loads = vec![0.0; run.solver.forces().loads()];
        let completed = run
            .free
            .complete(&mut run.solver, &rates, &mut direction, &mut loads);
        completed.expect("it has derivatives");
        let found = direction.drivers[0].second();
        let difference = |h: f64| (accelerated(&other(h)) - accelerated(&other(-h))) / (2.0 * h);
        let wanted = (4.0 * difference(0.5 * h) - difference(h)) / 3.0;
        let error = (found - wanted).abs() / (1.0 + wanted.abs());
        assert!(error < 1e-8, "{name}: {found} {wanted}");
    }
}

/// Friction takes its work from the energy, in events and between; the machine comes to rest
/// and stays there.
#[test]
fn a_machine_comes_to_rest() {
    let mut run = Run::new(&parse(SLIDER_CRANK), 1e-10, Fed::default());
    let events = played(&mut run, 20.0, 40);
    assert!(
        run.free.energy_error().abs() < 1e-9,
        "{}",
        run.free.energy_error()
    );
    assert!(events.len() < 40, "{events:?}");
    let at = run.state();
    assert!(at[1].abs() < 1e-14, "{at:?}");
    played(&mut run, 100.0, 3);
    assert!(
        (run.state()[0] - at[0]).abs() < 1e-13,
        "{at:?} {:?}",
        run.state()
    );
}

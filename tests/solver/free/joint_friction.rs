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

/// The motion from rest to a time.
fn swung(start: f64, until: f64) -> [f64; 2] {
    let slope = |[angle, velocity]: [f64; 2]| [velocity, acceleration(angle, velocity)];
    // It falls from the first instant on.
    integrated([start, -0.0], slope, until)
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

/// Integrates by the method of Runge and Kutta of order 4, in steps of 1e-4 s: their error is some 1e-13.
fn integrated<const N: usize>(
    mut x: [f64; N],
    slope: impl Fn([f64; N]) -> [f64; N],
    until: f64,
) -> [f64; N] {
    let steps = (until / 1e-4).round() as usize;
    let h = until / steps as f64;
    let ahead = |mut x: [f64; N], part: f64, k: [f64; N]| {
        x.iter_mut().zip(k).for_each(|(x, k)| *x += part * k);
        x
    };
    for _ in 0..steps {
        let first = slope(x);
        let second = slope(ahead(x, 0.5 * h, first));
        let third = slope(ahead(x, 0.5 * h, second));
        let last = slope(ahead(x, h, third));
        for k in 0..N {
            x[k] += h / 6.0 * (first[k] + 2.0 * (second[k] + third[k]) + last[k]);
        }
    }
    x
}

/// A bead in an upright round groove: R θ″ = −g cos θ ± μ |N| / m, N = m (R θ′² − g sin θ).
#[test]
fn a_bead_slides_in_a_round_groove() {
    let (radius, start) = (0.5, -0.3_f64);
    let text = format!(
        r#"
format = 1
name = "bead"
[ground.markers]
O = [0, 0]
[bodies.bead]
mass = 2
markers = {{ P = [0, 0] }}
estimate = [{x}, {y}, 0]
[constraints]
level = {{ coordinate = "angle", markers = ["ground.O", "bead.P"], value = 0 }}
[joints]
groove = {{ type = "curve", markers = ["ground.O", "bead.P"], x = "0.5*cos(s)", y = "0.5*sin(s)", from = "-pi", to = 0 }}
[freedoms]
x = {{ coordinate = "x", markers = ["ground.O", "bead.P"], start = {x} }}
[friction]
rub = {{ joint = "groove", coefficient = 0.2, static = 0.25 }}
"#,
        x = radius * start.cos(),
        y = radius * start.sin(),
    );
    let slope = |[angle, rate]: [f64; 2]| {
        let normal = radius * rate * rate - G * angle.sin();
        // It goes down, to lower angles.
        [rate, (-G * angle.cos() + 0.2 * normal) / radius]
    };
    let [angle, rate] = integrated([start, 0.0], slope, 0.5);
    let state = [radius * angle.cos(), -radius * angle.sin() * rate];
    check(&text, 0.5, &[], state);
    // It comes to rest where the groove is flatter than tan⁻¹ 0.25.
    let mut run = Run::new(&parse(&text), 1e-10, Fed::default());
    let events = played(&mut run, 10.0, 7);
    assert_eq!(
        events.last().map(|event| event.kind),
        Some(EventKind::Sticks)
    );
    let [x, rate] = [run.state()[0], run.state()[1]];
    assert!(x.abs() < 0.5 * 0.25 && rate.abs() < 1e-14, "{x} {rate}");
    assert!(run.free.energy_error().abs() < 1e-9);
}

/// A carriage on a straight curve is a drawer on a guide: a force beside it jams it in the same way.
#[test]
fn a_carriage_rubs_by_its_length() {
    let carriage = |coefficient: f64| {
        let parts = format!(
            r#"
[forces]
pull = {{ marker = "slider.P", value = [10, 0], torque = 0.5 }}
[friction]
rail = {{ joint = "guide", coefficient = {coefficient}, length = 0.2 }}
[simulation]
gravity = [0, 0]
"#
        );
        let joint = "type = \"curve\", x = \"s\", y = \"0*s\", from = -1, follow = true";
        slider(0.0, 0.0, 0.0, &parts).replace("type = \"translational\"", joint)
    };
    let acceleration = 10.0 * (1.0 - 2.0 * 0.3 * 0.05 / 0.2) / 2.0;
    let state = [0.125 * acceleration, 0.5 * acceleration];
    check(&carriage(0.3), 0.5, &[], state);
    check(&carriage(2.1), 0.5, &[], [0.0, 0.0]);
}

/// A part on a bed that shakes at an angle β: it slides while it is pressed by m (g + ÿ), flies freely from
/// where that ends, and slides on where it lands.
fn conveyor(beta: f64, speed: f64) -> String {
    format!(
        r#"
format = 1
name = "conveyor"
[ground.markers]
O = [0, 0, "{beta}*deg"]
G = [0, 0]
[bodies.bed]
markers = {{ O = [0, 0, "{beta}*deg"], B = [0, 0] }}
[bodies.part]
mass = 0.7
markers = {{ C = [0, 0] }}
[constraints]
level = {{ coordinate = "angle", markers = ["ground.G", "part.C"], value = 0 }}
[joints]
guide = {{ type = "translational", markers = ["ground.O", "bed.O"] }}
press = {{ type = "coupling", equation = "height = 0", unilateral = true }}
[drivers]
shake = {{ coordinate = "x", markers = ["ground.O", "bed.O"], motion = "0.01*sin(60*t)" }}
[freedoms]
x = {{ coordinate = "x", markers = ["ground.G", "part.C"], start = 0, velocity = {speed} }}
y = {{ coordinate = "y", markers = ["ground.G", "part.C"], start = 0, velocity = {rise} }}
[measures]
height = {{ coordinate = "y", markers = ["bed.B", "part.C"] }}
slip = {{ coordinate = "x", markers = ["bed.B", "part.C"] }}
[friction]
rub = {{ joint = "press", of = "slip", coefficient = 0.3 }}
"#,
        rise = 0.6 * beta.to_radians().sin(),
    )
}

#[test]
fn a_part_hops_on_a_conveyor() {
    let (coefficient, speed, sine) = (0.3, 2.0, 0.5);
    let place = |t: f64| 0.01 * sine * (60.0 * t).sin();
    let rate = |t: f64| 0.6 * sine * (60.0 * t).cos();
    let leaves = (G / (36.0 * sine)).asin() / 60.0;
    // While it slides, its speed falls by μ (g t + ẏ), and in flight it stays.
    let slid = |[x, v]: [f64; 2], from: f64, t: f64| {
        let h = t - from;
        let fall = 0.5 * G * h * h + place(t) - place(from) - rate(from) * h;
        [
            x + v * h - coefficient * fall,
            v - coefficient * (G * h + rate(t) - rate(from)),
        ]
    };
    let flight = |t: f64| {
        let h = t - leaves;
        place(leaves) + h * (rate(leaves) - 0.5 * G * h)
    };
    let (mut low, mut high) = (leaves + 0.005, leaves + 0.09);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if flight(middle) > place(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    let [x, v] = slid([0.0, speed], 0.0, leaves);
    let landed = [x + v * (low - leaves), v];
    let mut run = Run::new(&parse(&conveyor(30.0, speed)), 1e-10, Fed::default());
    let compare = |run: &Run, [x, v]: [f64; 2]| {
        assert_near(run.state()[0], x);
        assert_near(run.state()[2], v);
    };
    let mut events = played(&mut run, 0.5 * leaves, 2);
    compare(&run, slid([0.0, speed], 0.0, 0.5 * leaves));
    events.extend(played(&mut run, 0.5 * (leaves + low), 2));
    compare(&run, [x + v * 0.5 * (low - leaves), v]);
    let next = low + 0.003;
    events.extend(played(&mut run, next, 2));
    compare(&run, slid(landed, low, next));
    assert_near(events[0].time, leaves);
    assert_near(events[1].time, low);
    assert_eq!(events[0].kind, EventKind::Leaves);
}

/// A part that nothing moves aside hops on its place.
#[test]
fn a_part_hops_on_its_place() {
    let mut run = Run::new(&parse(&conveyor(90.0, 0.0)), 1e-10, Fed::default());
    let events = played(&mut run, 1.0, 7);
    assert!(events.len() < 100, "{}", events.len());
    assert!(run.state()[0].abs() < 1e-12, "{:?}", run.state());
    let landings = events.iter();
    let landings = landings.filter(|event| matches!(event.kind, EventKind::Impact { .. }));
    assert!(landings.count() > 4, "{events:?}");
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
        let completed = run.free.complete(&mut run.solver, &rates, &mut direction);
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

//! Forces that are functions of what moves elsewhere, against integrations written apart.

use std::path::Path;
use std::sync::Arc;

use biela::kinematics::{Budget, Direction, Output};
use biela::mechanism::{Mechanism, Source};

use super::run::{Fed, Run, error};
use crate::common::parse;

const TOLERANCE: f64 = 1e-10;
/// Largest error of values and velocities.
const MARK: f64 = 1e-8;

/// Integrates x″ = f(x, x′) by the classical method of fourth order on equal steps, whose error on these
/// motions is far below the mark: some 1e-12 where f is smooth, a step's square times the change of the
/// slope, 1e-10, where it has a corner.
fn integrated<const N: usize>(
    mut x: [f64; N],
    f: impl Fn(f64, &[f64; N]) -> [f64; N],
    until: f64,
    steps: u32,
) -> [f64; N] {
    let h = until / f64::from(steps);
    let moved = |x: &[f64; N], by: f64, k: &[f64; N]| {
        let mut moved = *x;
        for (moved, k) in moved.iter_mut().zip(k) {
            *moved += by * k;
        }
        moved
    };
    for step in 0..steps {
        let t = h * f64::from(step);
        let k1 = f(t, &x);
        let k2 = f(t + 0.5 * h, &moved(&x, 0.5 * h, &k1));
        let k3 = f(t + 0.5 * h, &moved(&x, 0.5 * h, &k2));
        let k4 = f(t + h, &moved(&x, h, &k3));
        for k in 0..N {
            x[k] += h / 6.0 * (k1[k] + 2.0 * k2[k] + 2.0 * k3[k] + k4[k]);
        }
    }
    x
}

/// A body of 2 kg on a rail, with these functions and forces.
fn on_rail(functions: &str, forces: &str, [start, velocity]: [f64; 2]) -> Arc<Mechanism> {
    let text = format!(
        r#"
format = 1
name = "rail"
{functions}
[ground.markers]
G = [0, 0]
[bodies.cart]
mass = 2
markers = {{ S = [0, 0] }}
[joints]
rail = {{ type = "translational", markers = ["ground.G", "cart.S"] }}
[freedoms]
way = {{ coordinate = "x", markers = ["ground.G", "cart.S"], start = {start}, velocity = {velocity} }}
[forces]
{forces}
"#
    );
    parse(&text)
}

const ALONG: &str = r#"coordinate = "x", markers = ["ground.G", "cart.S"]"#;

/// A damper with a kinked characteristic and a hardening spring, through their tables: straight lines have
/// corners at rest, where the motion turns, and at 0.5 m/s.
#[test]
fn a_damper_follows_its_table() {
    let functions = r#"
[functions]
damper = { table = [[-2, -40], [-0.5, -25], [0, 0], [0.5, 10], [2, 16]], law = "linear", ends = "linear" }
spring = { table = [[-0.3, -120], [0, 0], [0.3, 90]], law = "linear", ends = "linear" }
"#;
    let forces = format!(
        "d = {{ {ALONG}, value = \"-damper(velocity)\" }}\n\
         s = {{ {ALONG}, value = \"-spring(way.position)\" }}\n"
    );
    let line = |points: &[[f64; 2]], x: f64| {
        let last = points.len() - 2;
        let k = points[1..=last].iter().take_while(|p| p[0] <= x).count();
        let ([a, f], [b, g]) = (points[k], points[k + 1]);
        f + (g - f) * (x - a) / (b - a)
    };
    let exact = integrated(
        [0.25, 0.0],
        |_, &[x, v]| {
            let damper = [
                [-2.0, -40.0],
                [-0.5, -25.0],
                [0.0, 0.0],
                [0.5, 10.0],
                [2.0, 16.0],
            ];
            let spring = [[-0.3, -120.0], [0.0, 0.0], [0.3, 90.0]];
            [v, -(line(&damper, v) + line(&spring, x)) / 2.0]
        },
        1.5,
        300_000,
    );
    let mut run = Run::new(
        &on_rail(functions, &forces, [0.25, 0.0]),
        TOLERANCE,
        Fed::default(),
    );
    run.to(1.5);
    let off = error(&run.state(), &exact);
    assert!(off < MARK, "{off}");
    assert!(run.free.energy_error().abs() < 1e-8);
}

/// A force that steps with the way does a known work: the velocity at a place follows from the energy.
#[test]
fn a_force_that_steps_does_its_work() {
    let functions = r#"
[functions]
push = { table = [[0, 3], [0.1, 1], [0.4, -3], [0.7, 8]], law = "steps", ends = "zero" }
"#;
    let forces = format!("f = {{ {ALONG}, value = \"push(position)\" }}\n");
    let mechanism = on_rail(functions, &forces, [0.05, 1.0]);
    // Stretch by stretch with constant accelerations.
    let (mut t, mut x, mut v) = (0.0, 0.05, 1.0_f64);
    for (end, force) in [(0.1, 3.0), (0.4, 1.0), (0.7, -3.0)] {
        let a: f64 = force / 2.0;
        let after = (v * v + 2.0 * a * (end - x)).sqrt();
        t += (after - v) / a;
        (x, v) = (end, after);
    }
    let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
    // At the last point its value counts still; behind it nothing pushes.
    run.to(t + 0.1);
    let exact = [x + 0.1 * v, v];
    let off = error(&run.state(), &exact);
    assert!(off < MARK, "{off}: {:?} {exact:?}", run.state());
    assert!(run.free.energy_error().abs() < 1e-8);
}

/// From rest on a point of a table, or next to it, the motion leaves the point by the square of the time.
#[test]
fn a_motion_starts_from_rest_on_a_point() {
    let functions = r#"
[functions]
push = { table = [[0, -4], [0.5, -4], [0.6, -4]], law = "linear" }
"#;
    let forces = format!("f = {{ {ALONG}, value = \"push(position)\" }}\n");
    for start in [0.5, 0.5 + 1e-14, 0.5 + 1e-12, 0.5 + 1e-7] {
        let mechanism = on_rail(functions, &forces, [start, 0.0]);
        let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
        run.to(0.2);
        let off = error(&run.state(), &[start - 0.2 * 0.2, -0.4]);
        assert!(off < MARK, "{off}: {:?}", run.state());
        let steps = run.statistics().accepted;
        assert!(steps < 60, "{steps}");
    }
}

/// A relay that brakes whatever moves has no solution once it is at rest: it pushes to and fro. The motion
/// goes up to there, and is refused.
#[test]
fn a_jump_that_turns_the_motion_back_at_once_is_refused() {
    let functions = r#"
[functions]
relay = { table = [[-1, 10], [0, -10], [1, -10]], law = "steps" }
"#;
    let forces = format!("f = {{ {ALONG}, value = \"relay(velocity)\" }}\n");
    let mechanism = on_rail(functions, &forces, [0.3, 1.0]);
    let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
    // The way there takes less than a hundred.
    run.solver.set_budget(Budget::of(10_000));
    let (free, fed) = (&mut run.free, Fed::default());
    let refused = free.advance(&mut run.solver, &mut run.solution, &fed, 0.5);
    let refused = refused.expect_err("it cannot rest");
    assert!(refused.to_string().contains("sub-steps"), "{refused}");
    // It brakes at 5 m/s² and is at rest after 0.2 s and 0.1 m.
    let pose = run.solver.pose();
    let (time, way) = (pose.time, pose.drivers[0]);
    assert!(
        (time - 0.2).abs() < 1e-6 && (way - 0.4).abs() < 1e-6,
        "{time} {way}"
    );
}

/// Gas pressure over the crank's angle, through a periodic spline, pushes the piston of an engine with a
/// load on its crank: the force acts along one coordinate and depends on another.
#[test]
fn an_engine_runs_by_its_pressure_table() {
    let text = r#"
format = 1
name = "engine"
[parameters]
r = 0.05
l = 0.17
area = 0.005
[functions]
pressure = { table = [[0, 30], [20, 55], [60, 18], [120, 4], [180, 1], [270, 2], [320, 8], [360, 30]], scale = ["deg", 1e5], ends = "periodic" }
[ground.markers]
O = [0, 0]
[bodies.crank]
mass = 4
inertia = 0.05
center = [0, 0]
markers = { O = [0, 0], A = ["r", 0] }
[bodies.rod]
mass = 0.6
inertia = 0.002
center = ["l/3", 0]
markers = { A = [0, 0], B = ["l", 0] }
estimate = ["r", 0, 0]
[bodies.piston]
mass = 0.8
markers = { B = [0, 0] }
estimate = ["r + l", 0, 0]
[joints]
O = { type = "revolute", markers = ["ground.O", "crank.O"] }
A = { type = "revolute", markers = ["crank.A", "rod.A"] }
B = { type = "revolute", markers = ["rod.B", "piston.B"] }
bore = { type = "translational", markers = ["ground.O", "piston.B"] }
[freedoms]
turn = { coordinate = "angle", markers = ["ground.O", "crank.O"], start = 0.2, velocity = 100 }
[measures]
stroke = { coordinate = "x", markers = ["ground.O", "piston.B"] }
[forces]
gas = { coordinate = "x", markers = ["ground.O", "piston.B"], value = "-area*pressure(turn.position)" }
load = { coordinate = "angle", markers = ["ground.O", "crank.O"], value = "-0.002*turn.velocity^2 - 0.5*stroke.velocity" }
[simulation]
gravity = [0, 0]
"#;
    let mechanism = parse(text);
    let (r, l, area): (f64, f64, f64) = (0.05, 0.17, 0.005);
    // The periodic spline once more, by its equations in dense form.
    let angles: Vec<f64> = [0.0, 20.0, 60.0, 120.0, 180.0, 270.0, 320.0, 360.0_f64]
        .iter()
        .map(|a| a.to_radians())
        .collect();
    let pressures = [30.0, 55.0, 18.0, 4.0, 1.0, 2.0, 8.0, 30.0].map(|p: f64| p * 1e5);
    let n = angles.len() - 1;
    let width = |k: usize| angles[k % n + 1] - angles[k % n];
    let chord = |k: usize| (pressures[k % n + 1] - pressures[k % n]) / width(k);
    let mut matrix = nalgebra::DMatrix::<f64>::zeros(n, n);
    let mut side = nalgebra::DVector::<f64>::zeros(n);
    for k in 0..n {
        let before = (k + n - 1) % n;
        matrix[(k, before)] += width(before);
        matrix[(k, k)] += 2.0 * (width(before) + width(k));
        matrix[(k, (k + 1) % n)] += width(k);
        side[k] = 6.0 * (chord(k) - chord(before));
    }
    let moments = matrix.lu().solve(&side).expect("it is dominant");
    let pressure = |phi: f64| {
        let x = phi.rem_euclid(std::f64::consts::TAU);
        let k = angles[1..n].iter().take_while(|a| **a <= x).count();
        let (h, m, q) = (width(k), moments[k], moments[(k + 1) % n]);
        let (a, b) = (angles[k + 1] - x, x - angles[k]);
        (m * a.powi(3) + q * b.powi(3)) / (6.0 * h)
            + (pressures[k] / h - m * h / 6.0) * a
            + (pressures[k + 1] / h - q * h / 6.0) * b
    };
    // Lagrange's equation of the crank's angle, with positions of the bodies in closed form; their second
    // derivatives by those of the formulas.
    let bodies = |phi: f64| {
        // Value, first and second derivative of sine and cosine of the rod's angle by phi.
        let (s, c) = phi.sin_cos();
        let beta = (-r * s / l).asin();
        let cb = beta.cos();
        let b1 = -r * c / (l * cb);
        let b2 = (r * s / l + beta.sin() * b1 * b1) / cb;
        let along = |part: f64| {
            let (sb, cb) = beta.sin_cos();
            let x1 = -r * s - part * l * sb * b1;
            let x2 = -r * c - part * l * (cb * b1 * b1 + sb * b2);
            let y1 = r * c + part * l * cb * b1;
            let y2 = -r * s + part * l * (cb * b2 - sb * b1 * b1);
            ([x1, y1], [x2, y2])
        };
        (along(1.0), along(1.0 / 3.0), [b1, b2])
    };
    let motion = |_: f64, &[phi, w]: &[f64; 2]| {
        let ((p1, p2), (g1, g2), [b1, b2]) = bodies(phi);
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let inertia = 0.05 + 0.6 * dot(g1, g1) + 0.002 * b1 * b1 + 0.8 * p1[0] * p1[0];
        let slope = 0.6 * dot(g1, g2) + 0.002 * b1 * b2 + 0.8 * p1[0] * p2[0];
        let torque = -area * pressure(phi) * p1[0] - 0.002 * w * w - 0.5 * p1[0] * w;
        [w, (torque - slope * w * w) / inertia]
    };
    let until = 0.12;
    let exact = integrated([0.2, 100.0], motion, until, 60_000);
    let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
    run.to(until);
    let off = error(&run.state(), &exact);
    assert!(off < MARK, "{off}: {:?} {exact:?}", run.state());
    assert!(exact[0] > 10.0, "it turns: {exact:?}");
}

/// A motor with a map of torque over speed and voltage, a ramp of time, turns a wiper's crank; the map is a
/// spline of two arguments through a polynomial of third degree, which it meets exactly.
#[test]
fn a_motor_follows_its_map() {
    let torque = |w: f64, u: f64| 0.08 * u - 0.02 * w - 0.0002 * w * w * w + 0.001 * u * w;
    let mut csv = String::from("rad/s");
    let volts = [0.0, 4.0, 8.0, 12.0, 16.0];
    for u in volts {
        csv += &format!(",{u}");
    }
    for w in [-10.0, 0.0, 5.0, 12.0, 20.0, 40.0] {
        csv += &format!("\n{w}");
        for u in volts {
            csv += &format!(",{}", torque(w, u));
        }
    }
    let folder = std::env::temp_dir().join(format!("biela-motor-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("map.csv"), csv).expect("a file");
    let text = r#"
format = 1
name = "motor"
[functions]
torque = { file = "map.csv", arguments = 2 }
[ground.markers]
O = [0, 0]
[bodies.arm]
mass = 0.5
inertia = 0.02
center = [0.1, 0]
markers = { O = [0, 0] }
[joints]
O = { type = "revolute", markers = ["ground.O", "arm.O"] }
[freedoms]
turn = { coordinate = "angle", markers = ["ground.O", "arm.O"], start = "-90*deg" }
[forces]
motor = { coordinate = "angle", markers = ["ground.O", "arm.O"], value = "torque(velocity, 2 + 3*t)" }
"#;
    let path = folder.join("motor.toml");
    std::fs::write(&path, text).expect("a file");
    let source = Source::open("motor.toml".to_owned(), Path::new(&path)).expect("it is text");
    let (mechanism, _) = Mechanism::parse(&source).expect("it is right");
    std::fs::remove_dir_all(&folder).expect("it is ours");
    let start = -std::f64::consts::FRAC_PI_2;
    let exact = integrated(
        [start, 0.0],
        |t, &[phi, w]| {
            let inertia = 0.02 + 0.5 * 0.01;
            [
                w,
                (torque(w, 2.0 + 3.0 * t) - 0.5 * 9.81 * 0.1 * phi.cos()) / inertia,
            ]
        },
        2.0,
        40_000,
    );
    let mut run = Run::new(&Arc::new(mechanism), TOLERANCE, Fed::default());
    run.to(2.0);
    let off = error(&run.state(), &exact);
    assert!(off < MARK, "{off}: {:?} {exact:?}", run.state());
}

/// A pendulum on a cart whose force sees the pendulum, a measure and the time: exact derivatives of the
/// accelerations by states against differences, and the stiff method on the same motion.
const BALANCED: &str = r#"
format = 1
name = "balanced"
[parameters]
kp = { value = 60, tunable = true }
[functions]
limit = { value = "20*tanh(x/20)" }
[ground.markers]
G = [0, 0]
[bodies.cart]
mass = 1
markers = { S = [0, 0] }
[bodies.pole]
mass = 0.2
inertia = 0.01
center = [0, 0.4]
markers = { P = [0, 0], T = [0, 0.8] }
[joints]
rail = { type = "translational", markers = ["ground.G", "cart.S"] }
pin = { type = "revolute", markers = ["cart.S", "pole.P"] }
[freedoms]
way = { coordinate = "x", markers = ["ground.G", "cart.S"], start = 0 }
lean = { coordinate = "angle", markers = ["ground.G", "pole.P"], start = 0.1 }
[measures]
tip = { coordinate = "x", markers = ["ground.G", "pole.T"] }
[forces]
servo = { coordinate = "x", markers = ["ground.G", "cart.S"], value = "limit(kp*tip.position + 8*tip.velocity - 30*lean.position - 4*lean.velocity + 0.5*sin(t))" }
air = { marker = "pole.T", value = ["-0.1*tip.velocity*abs(tip.velocity)", "0.02*lean.velocity"], torque = "-0.01*way.velocity" }
"#;

#[test]
fn derivatives_of_forces_agree_with_differences() {
    let mechanism = parse(BALANCED);
    let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
    run.to(0.37);
    let state = run.state();
    run.solution.seek_forces(&run.solver);
    let space = run.free.linearize(&mut run.solver, &mut run.solution, &[]);
    let space = space.expect("the pose is regular");
    // Accelerations at states beside, each by a motion that begins there.
    let accelerations = |state: &[f64]| {
        let mut moved = (*mechanism).clone();
        moved.simulation.start = 0.37;
        for (k, driver) in moved.drivers.iter_mut().enumerate() {
            if let biela::mechanism::DriverSource::Free {
                start, velocity, ..
            } = &mut driver.source
            {
                (*start, *velocity) = (state[k], state[2 + k]);
            }
        }
        let run = Run::new(&Arc::new(moved), TOLERANCE, Fed::default());
        let [_, _, accelerations] = run.freedoms();
        accelerations
    };
    // The states of the linear equations: value and velocity of each freedom in turn.
    let order = [0, 2, 1, 3];
    const H: f64 = 1e-5;
    for (column, which) in order.into_iter().enumerate() {
        let beside = |by: f64| {
            let mut state = state.clone();
            state[which] += by;
            accelerations(&state)
        };
        let (after, before) = (beside(H), beside(-H));
        for k in 0..2 {
            let difference = (after[k] - before[k]) / (2.0 * H);
            let exact = space.a[(2 * k + 1, column)];
            // The square of the step times a sixth of third derivatives, some thousands.
            assert!(
                (difference - exact).abs() < 1e-6 * (1.0 + exact.abs()),
                "{exact} {difference}"
            );
        }
    }
}

/// The change of the motion with a parameter, by the variational equations, against differences of motions.
#[test]
fn changes_of_the_motion_agree_with_differences() {
    let mechanism = parse(BALANCED);
    let (mut solver, _) = crate::common::assembled(&mechanism);
    let mut direction = Direction::zero(&mechanism);
    direction.parameters[0] = 1.0;
    let free = biela::dynamics::FreeMotion::along(&solver, 1e-11, vec![direction]);
    let mut free = free.expect("a tolerance").expect("freedoms");
    let fed = Fed::default();
    free.start(&mut solver, &fed).expect("it starts");
    let mut run = Run::of(solver, free, fed);
    run.to(0.5);
    run.solution.seek_forces(&run.solver);
    let varied = run
        .free
        .varied(&mut run.solver, &mut run.solution)
        .expect("derivatives");
    let ends = [-1.0, 1.0].map(|sign: f64| {
        let text = BALANCED.replace("value = 60", &format!("value = {}", 60.0 + 1e-3 * sign));
        let mut run = Run::new(&parse(&text), 1e-12, Fed::default());
        run.to(0.5);
        run.state()
    });
    let [before, after] = ends;
    for (k, driver) in varied[0].drivers.iter().enumerate() {
        let difference = (after[k] - before[k]) / 2e-3;
        let exact = driver.value;
        assert!((difference - exact).abs() < 1e-7, "{exact} {difference}");
    }
}

/// A mass in the plane on a spring of free length zero, k r in any direction.
fn bound(start: [f64; 2], velocity: [f64; 2]) -> Arc<Mechanism> {
    let ([x, y], [u, v]) = (start, velocity);
    parse(&format!(
        r#"
format = 1
name = "bound"
[parameters]
k = 18
free = 0
[ground.markers]
G = [0.3, -0.2]
[bodies.ball]
mass = 2
markers = {{ C = [0.1, 0.1] }}
[constraints]
level = {{ coordinate = "angle", markers = ["ground.G", "ball.C"], value = 0 }}
[freedoms]
x = {{ coordinate = "x", markers = ["ground.G", "ball.C"], start = {x}, velocity = {u} }}
y = {{ coordinate = "y", markers = ["ground.G", "ball.C"], start = {y}, velocity = {v} }}
[forces]
pull = {{ coordinate = "distance", markers = ["ground.G", "ball.C"], stiffness = "k", free = "free" }}
[simulation]
gravity = [0, 0]
"#
    ))
}

/// A spring of free length zero swings a mass through its other end, from there, at rest there and round it:
/// x = x₀ cos ωt + v₀/ω sin ωt along each axis.
#[test]
fn a_spring_of_free_length_zero_goes_through_zero() {
    let omega = 3.0_f64;
    for (start, velocity) in [
        ([0.0, 0.0], [0.3, -0.4]),
        ([0.0, 0.0], [0.0, 0.0]),
        ([0.2, 0.0], [0.0, 0.0]),
        ([0.2, 0.1], [0.3, -0.15]),
    ] {
        let mut run = Run::new(&bound(start, velocity), TOLERANCE, Fed::default());
        for time in [0.4, std::f64::consts::FRAC_PI_6, 3.1, 10.0] {
            run.to(time);
            let (sine, cosine) = (omega * time).sin_cos();
            let state = run.state();
            for k in 0..2 {
                let value = start[k] * cosine + velocity[k] / omega * sine;
                let rate = velocity[k] * cosine - start[k] * omega * sine;
                for (found, wanted) in [(state[k], value), (state[2 + k], rate)] {
                    assert!((found - wanted).abs() < MARK, "{time} s: {found} {wanted}");
                }
            }
        }
        assert!(run.free.energy_error().abs() < 1e-9);
    }
}

/// At zero the spring is linear in x and y, so that δẍ = −k/m δx exactly; its size, a cone, has no derivative,
/// and a free length that changes leaves it none.
#[test]
fn a_spring_at_zero_has_the_derivatives_of_its_components() {
    let mechanism = bound([0.0, 0.0], [0.0, 0.0]);
    let mut run = Run::new(&mechanism, TOLERANCE, Fed::default());
    run.solution.seek_forces(&run.solver);
    let mut linear = |outputs: &[Output]| {
        let Run {
            free,
            solver,
            solution,
            ..
        } = &mut run;
        free.linearize(solver, solution, outputs)
    };
    let space = linear(&[]).expect("it is regular");
    for (row, column) in (0..4).flat_map(|row| (0..4).map(move |column| (row, column))) {
        let wanted = match (row, column) {
            (0, 1) | (2, 3) => 1.0,
            (1, 0) | (3, 2) => -9.0,
            _ => 0.0,
        };
        let found = space.a[(row, column)];
        assert!((found - wanted).abs() < 1e-14, "{row} {column}: {found}");
    }
    let size = Output::all(&mechanism);
    let size = size
        .into_iter()
        .filter(|output| output.name == "pull.effort");
    let size: Vec<_> = size.collect();
    let refused = linear(&size).expect_err("a cone").to_string();
    assert!(
        refused.starts_with("force `pull` has no finite derivative"),
        "{refused}"
    );
    let [by_stiffness, by_length] = [0, 1].map(|place| {
        let mut direction = Direction::zero(&mechanism);
        direction.parameters[place] = 1.0;
        direction
    });
    let Run {
        free,
        solver,
        solution,
        ..
    } = &mut run;
    let completed = free.complete(solver, &solution.rates, &mut by_length.clone());
    let refused = completed.expect_err("no direction").to_string();
    assert!(
        refused.starts_with("force `pull` has no finite derivative"),
        "{refused}"
    );
    // The change of the motion with k, from the centre.
    let (mut solver, _) = crate::common::assembled(&bound([0.0, 0.0], [0.3, -0.4]));
    let free = biela::dynamics::FreeMotion::along(&solver, 1e-11, vec![by_stiffness]);
    let mut free = free.expect("a tolerance").expect("freedoms");
    let fed = Fed::default();
    free.start(&mut solver, &fed).expect("it starts");
    let mut run = Run::of(solver, free, fed);
    let (time, omega) = (0.7, 3.0_f64);
    run.to(time);
    run.solution.seek_forces(&run.solver);
    let varied = run.free.varied(&mut run.solver, &mut run.solution);
    let varied = varied.expect("derivatives");
    // ∂/∂ω of sin ωt / ω by dω/dk = 1 / (2 m ω).
    let (sine, cosine) = (omega * time).sin_cos();
    let change = (time * cosine - sine / omega) / omega / (4.0 * omega);
    for (driver, velocity) in varied[0].drivers.iter().zip([0.3, -0.4]) {
        assert!((driver.value - velocity * change).abs() < MARK);
    }
}

/// A motor by its voltage, which a host gives, with a controller of the arm's angle: the force sees two
/// inputs. Their values begin at those of the file.
#[test]
fn a_servo_follows_its_set_point() {
    let text = r#"
format = 1
name = "servo"
[inputs]
supply = { unit = "V", start = 12, min = 0, max = 24 }
goal = { unit = "rad", start = "-90*deg" }
[parameters]
k = { value = 0.6, unit = "N.m/A" }
resistance = { value = 1.5, unit = "ohm" }
[ground.markers]
O = [0, 0]
[bodies.arm]
mass = 0.5
inertia = 0.02
center = [0.1, 0]
markers = { O = [0, 0] }
[joints]
O = { type = "revolute", markers = ["ground.O", "arm.O"] }
[freedoms]
turn = { coordinate = "angle", markers = ["ground.O", "arm.O"], start = "-90*deg" }
[forces]
motor = { coordinate = "angle", markers = ["ground.O", "arm.O"], value = "k*(supply*tanh(2*(goal - turn.position)) - k*velocity)/resistance" }
"#;
    let mechanism = parse(text);
    let names: Vec<_> = mechanism
        .load_inputs()
        .into_iter()
        .map(|i| (i.name, i.start))
        .collect();
    let start = -std::f64::consts::FRAC_PI_2;
    assert_eq!(
        names,
        [("supply".to_owned(), 12.0), ("goal".to_owned(), start)]
    );
    let goal = |t: f64| start + t * (2.0 - t);
    let exact = integrated(
        [start, 0.0],
        |t, &[phi, w]| {
            let torque = 0.6 * (12.0 * (2.0 * (goal(t) - phi)).tanh() - 0.6 * w) / 1.5;
            [w, (torque - 0.5 * 9.81 * 0.1 * phi.cos()) / 0.025]
        },
        1.0,
        40_000,
    );
    // The supply stays as it is in the file.
    let fed = Fed {
        loads: |t, loads| loads[1] = -std::f64::consts::FRAC_PI_2 + t * (2.0 - t),
        ..Fed::default()
    };
    let mut run = Run::new(&mechanism, TOLERANCE, fed);
    run.to(1.0);
    let off = error(&run.state(), &exact);
    assert!(off < MARK, "{off}: {:?} {exact:?}", run.state());
    // By inputs against differences: the torque is linear in the supply.
    run.solution.seek_forces(&run.solver);
    run.solution.loads.copy_from_slice(&[12.0, goal(1.0)]);
    let space = run.free.linearize(&mut run.solver, &mut run.solution, &[]);
    let space = space.expect("the pose is regular");
    assert_eq!(space.inputs, ["supply", "goal"]);
    let [phi, _] = exact;
    let lean = (2.0 * (goal(1.0) - phi)).tanh();
    assert!((space.b[(1, 0)] - 0.6 * lean / 1.5 / 0.025).abs() < 1e-6);
    let slope = 0.6 * 12.0 * 2.0 * (1.0 - lean * lean) / 1.5 / 0.025;
    assert!((space.b[(1, 1)] - slope).abs() < 1e-5, "{slope}");
}

/// A quarter of a car on a road: the damper's force follows its table over the rate of a measure, hard in
/// rebound and soft in compression, with corners where the flow opens.
#[test]
fn a_quarter_car_follows_the_table_of_its_damper() {
    let text = r#"
format = 1
name = "quarter_car"
[functions]
damper = { table = [[-1, -900], [-0.2, -420], [0, 0], [0.1, 120], [1, 300]], law = "linear", ends = "linear" }
[ground.markers]
G = [0, 0, "90*deg"]
[bodies.road]
markers = { R = [0, 0, "90*deg"] }
[bodies.wheel]
mass = 40
markers = { W = [0, 0, "90*deg"] }
[bodies.car]
mass = 300
markers = { C = [0, 0, "90*deg"] }
[joints]
of_road = { type = "translational", markers = ["ground.G", "road.R"] }
of_wheel = { type = "translational", markers = ["ground.G", "wheel.W"] }
of_car = { type = "translational", markers = ["ground.G", "car.C"] }
[drivers]
bumps = { coordinate = "x", markers = ["ground.G", "road.R"], motion = "0.02*sin(12*t)" }
[freedoms]
hop = { coordinate = "x", markers = ["ground.G", "wheel.W"], start = 0 }
bounce = { coordinate = "x", markers = ["ground.G", "car.C"], start = 0 }
[measures]
travel = { coordinate = "x", markers = ["wheel.W", "car.C"] }
[forces]
tyre = { coordinate = "x", markers = ["road.R", "wheel.W"], stiffness = 150000, free = 0 }
spring = { coordinate = "x", markers = ["wheel.W", "car.C"], stiffness = 16000, free = 0 }
damping = { coordinate = "x", markers = ["wheel.W", "car.C"], value = "-damper(travel.velocity)" }
[simulation]
gravity = [0, 0]
"#;
    let table = [
        [-1.0, -900.0],
        [-0.2, -420.0],
        [0.0, 0.0],
        [0.1, 120.0],
        [1.0, 300.0],
    ];
    let damper = |v: f64| {
        let k = table[1..4].iter().take_while(|p| p[0] <= v).count();
        let ([a, f], [b, g]): ([f64; 2], [f64; 2]) = (table[k], table[k + 1]);
        f + (g - f) * (v - a) / (b - a)
    };
    let exact = integrated(
        [0.0; 4],
        |t, &[wheel, car, w, c]| {
            let tyre = -150_000.0 * (wheel - 0.02 * (12.0 * t).sin());
            let inside = -16_000.0 * (car - wheel) - damper(c - w);
            [w, c, (tyre - inside) / 40.0, inside / 300.0]
        },
        1.0,
        400_000,
    );
    let mut run = Run::new(&parse(text), TOLERANCE, Fed::default());
    run.to(1.0);
    let off = error(&run.state(), &exact);
    assert!(off < MARK, "{off}: {:?} {exact:?}", run.state());
}

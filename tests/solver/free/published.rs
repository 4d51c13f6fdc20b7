//! Published motions: Andrews' mechanism, and problems of the IFToMM library of multibody
//! benchmarks (A01 pendulum, A02 chain of four-bars, the cart-pole with a light cart).

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write as _;
use std::time::Instant;

use biela::kinematics::Rates;

use super::minimal::{Mass, Minimal, body, unloaded};
use super::pendulum::{swinging, turning_from_above};
use super::run::{CLOSED, Fed, Run, error, times};
use super::taylor::Taylor;
use crate::common::{parse, shipped};

/// Solution at 0.03 s, problem "andrews" of the Test Set for Initial Value Problem Solvers:
/// β, Θ, γ, Φ, δ, Ω, ε. Nine digits are right: the published state misses its own energy balance
/// by 2e-10 J.
const ANDREWS: [f64; 7] = [
    15.81077119629904,
    -15.75637105984298,
    0.04082224013073101,
    -0.5347301163226948,
    0.5244099658805304,
    0.5347301163226948,
    1.048080741042263,
];

#[test]
fn andrews_mechanism_ends_as_published() {
    let mechanism = shipped("andrews_free");
    let body = |name: &str| 3 * mechanism.body_id(name).expect("a body").index() + 2;
    let measure = |name: &str| {
        let found = mechanism.measures.iter().position(|m| m.name == name);
        found.expect("a measure")
    };
    // The published digits, and the contract's marks.
    for (tolerance, mark) in [(1e-10, 1e-8), (1e-8, 1e-6), (1e-6, 1e-4)] {
        let begin = Instant::now();
        let mut run = Run::new(&mechanism, tolerance, Fed::default());
        run.to(0.03);
        let elapsed = begin.elapsed();
        let rates = Rates::new(run.solver.pose().q.len());
        let q = &run.solver.pose().q;
        let angle = |name| run.solver.measure(measure(name), &rates).value;
        let found = [
            run.solver.pose().drivers[0],
            angle("Theta"),
            q[body("K3")],
            angle("Phi"),
            q[body("K5")],
            angle("Omega"),
            q[body("K7")],
        ];
        let largest = error(&found, &ANDREWS);
        println!(
            "| andrews {tolerance:e} | {largest:.1e} / {mark:e} | energy {:.1e} J | joints {:.1e} \
             | {:?} in {elapsed:?} |",
            run.energy_error,
            run.residual,
            run.statistics()
        );
        assert!(largest < mark, "{found:?}");
        assert!(run.residual < CLOSED);
    }
}

/// A01: 1 kg at 1 m, level and at rest, 10 s; energy to 5e-5 J.
#[test]
fn a01_pendulum() {
    let text = "format = 1\nname = \"a01\"\n[ground.markers]\nO = [0, 0, \"-90*deg\"]\n\
        [bodies.rod]\nmarkers = { O = [0, 0] }\nestimate = [0, 0, 0]\nmass = 1\ncenter = [1, 0]\n\
        [joints]\nO = { type = \"revolute\", markers = [\"ground.O\", \"rod.O\"] }\n\
        [freedoms]\nswing = { coordinate = \"angle\", markers = [\"ground.O\", \"rod.O\"], \
        start = \"90*deg\" }\n";
    for (tolerance, mark) in [(1e-10, 1e-8), (1e-8, 1e-6), (1e-6, 1e-4)] {
        let begin = Instant::now();
        let mut run = Run::new(&parse(text), tolerance, Fed::default());
        run.to(10.0);
        let elapsed = begin.elapsed();
        let exact = swinging(9.81_f64.sqrt(), FRAC_PI_2, 10.0);
        let largest = error(&run.state(), &exact);
        println!(
            "| A01 {tolerance:e} | {largest:.1e} / {mark:e} | energy {:.1e} J | {:?} in \
             {elapsed:?} |",
            run.energy_error,
            run.statistics()
        );
        assert!(largest < mark);
        assert!(run.energy_error < 5e-5);
    }
}

/// A02: `count` squares of bars of 1 m and 1 kg, side by side on ground.
fn squares(count: usize) -> String {
    let mut pivots = String::new();
    let mut bodies = String::new();
    let mut joints = String::new();
    let bar = "mass = 1\ninertia = \"1/12\"\ncenter = [0.5, 0]\nmarkers = { A = [0, 0], \
               B = [1, 0] }";
    for k in 0..=count {
        // A text takes all that is written to it.
        let _ = writeln!(pivots, "O{k} = [{k}, 0]");
        let _ = writeln!(
            bodies,
            "[bodies.post{k}]\nestimate = [{k}, 0, \"90*deg\"]\n{bar}"
        );
        let _ = writeln!(
            joints,
            "O{k} = {{ type = \"revolute\", markers = [\"ground.O{k}\", \"post{k}.A\"] }}"
        );
    }
    for k in 1..=count {
        let before = k - 1;
        let _ = writeln!(
            bodies,
            "[bodies.beam{k}]\nestimate = [{before}, 1, 0]\n{bar}"
        );
        let _ = writeln!(
            joints,
            "A{k} = {{ type = \"revolute\", markers = [\"post{before}.B\", \"beam{k}.A\"] }}\n\
             B{k} = {{ type = \"revolute\", markers = [\"beam{k}.B\", \"post{k}.B\"] }}"
        );
    }
    format!(
        "format = 1\nname = \"squares\"\n[ground.markers]\ndown = [0, 0, \"-90*deg\"]\n{pivots}\
         {bodies}[joints]\n{joints}[freedoms]\npost = {{ coordinate = \"angle\", \
         markers = [\"ground.down\", \"post0.A\"], start = \"180*deg\", velocity = 1 }}\n"
    )
}

/// All posts turn alike, all beams move like their tips: one pendulum with J = (N + 1)/3 + N and
/// the moment (N + 1)/2 + N, that turns over. It passes change points, where all bars lie in one
/// line; the motion is right or ends with an error.
#[test]
fn a02_chains_of_squares_are_right_or_refused() {
    for (count, until, tolerance, mark) in [
        (1, 10.0, 1e-10, 1e-8),
        (2, 10.0, 1e-10, 1e-8),
        (2, 10.0, 1e-6, 1e-4),
        (5, 4.0, 1e-10, 1e-8),
        (40, 1.0, 1e-8, 1e-6),
    ] {
        let n = f64::from(count);
        let (inertia, moment) = ((n + 1.0) / 3.0 + n, 0.5 * (n + 1.0) + n);
        let omega = (9.81 * moment / inertia).sqrt();
        let begin = Instant::now();
        let mut run = Run::new(
            &parse(&squares(usize::try_from(count).expect("few"))),
            tolerance,
            Fed::default(),
        );
        let mut largest = 0.0_f64;
        let mut stopped = None;
        for time in &times(until, 20)[1..] {
            if let Err(error) = run.try_to(*time) {
                stopped = Some(error);
                break;
            }
            let exact = turning_from_above(omega, 1.0, *time);
            largest = largest.max(error(&run.state(), &exact));
        }
        let elapsed = begin.elapsed();
        println!(
            "| A02 {count} {tolerance:e} | {largest:.1e} / {mark:e} | joints {:.1e} | {:?} | {:?} \
             in {elapsed:?} |",
            run.residual,
            stopped,
            run.statistics()
        );
        assert!(largest < mark, "{count}: {largest}");
        assert!(run.residual < CLOSED);
    }
}

/// The angle of the pole on a light cart, whose common centre of mass falls straight down.
fn light(z: &[Taylor], _: Taylor) -> Vec<Mass> {
    let (cart, pole) = (1e-6, 1.0);
    let cart_x = -pole / (cart + pole) * z[0].cos();
    let o = Taylor::from(0.0);
    vec![
        body(cart, 0.0, [cart_x, o, o], [0.0, 0.0]),
        body(pole, 0.0, [cart_x, o, z[0]], [1.0, 0.0]),
    ]
}

/// The light cart: at the lowest position the pole turns at 4,429 rad/s for less than a
/// microsecond. The motion is right or ends with an error. The mass matrix has the condition 1e6
/// there, of which a solution by √M ∂q/∂u sees the root.
#[test]
fn a_pole_on_a_light_cart_is_right_or_refused() {
    let text = "format = 1\nname = \"light\"\n[ground.markers]\nO = [0, 0]\n\
        [bodies.cart]\nmarkers = { O = [0, 0] }\nestimate = [0, 0, 0]\nmass = 1e-6\n\
        [bodies.pole]\nmarkers = { O = [0, 0] }\nestimate = [0, 0, 0]\nmass = 1\n\
        center = [1, 0]\n\
        [joints]\nrail = { type = \"translational\", markers = [\"ground.O\", \"cart.O\"] }\n\
        O = { type = \"revolute\", markers = [\"cart.O\", \"pole.O\"] }\n\
        [freedoms]\nx = { coordinate = \"x\", markers = [\"ground.O\", \"cart.O\"], start = 0 }\n\
        lean = { coordinate = \"angle\", markers = [\"ground.O\", \"pole.O\"], start = 0 }\n";
    let truth = Minimal {
        gravity: [0.0, -9.81],
        masses: light,
        loads: unloaded,
    };
    let times = times(10.0, 40);
    let exact = truth.motion(&[0.0, 0.0], &times);
    for (tolerance, mark) in [(1e-10, 1e-8), (1e-8, 1e-6), (1e-6, 1e-4)] {
        let begin = Instant::now();
        let mut run = Run::new(&parse(text), tolerance, Fed::default());
        let mut largest = 0.0_f64;
        let mut stopped = None;
        for (time, exact) in times.iter().zip(&exact) {
            if let Err(error) = run.try_to(*time) {
                stopped = Some(error);
                break;
            }
            let [values, velocities, _] = run.freedoms();
            let found = [values[1], velocities[1]];
            largest = largest.max(error(&found, exact));
            assert!(values[1] < 1e-9 && values[1] > -PI - 1e-9);
        }
        println!(
            "| light cart {tolerance:e} | {largest:.1e} / {mark:e} | energy {:.1e} J | {stopped:?} \
             | {:?} in {:?} |",
            run.energy_error,
            run.statistics(),
            begin.elapsed()
        );
        assert!(largest < mark, "{tolerance}: {largest}");
    }
}

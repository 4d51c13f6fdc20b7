//! Freedoms with coordinates that have dead points on the way, in mechanisms of links, ropes, curves,
//! slots and cams.

use std::fmt::Write as _;
use std::sync::Arc;

use biela::dynamics::FreeMotion;
use biela::kinematics::{Direction, Path, Solver};
use biela::mechanism::{BodyId, Mechanism, Signal};

use super::chains::Random;
use super::pendulum::{swinging, turning};
use super::run::{Fed, Run, error};
use crate::common::{assembled, parse};

const GRAVITY: f64 = 9.81;
/// Length of the links of a swing.
const LENGTH: f64 = 2.0;
/// Largest error of places and velocities, relative to 1 + |value|, in tolerances: that of the contract's
/// marks.
const MARK: f64 = 100.0;

/// A platform on two equal links: each of its points moves as a pendulum of their length.
pub(super) fn swing(freedom: &str, [x, y]: [f64; 2]) -> String {
    format!(
        r#"
format = 1
name = "swing"
[ground.markers]
O = [0, 0]
P = [1, 0]
Q = [0, -2]
R = [0.3, -2.4]
[bodies.seat]
mass = 1
inertia = 0.1
center = [0.5, 0]
markers = {{ A = [0, 0], B = [1, 0] }}
estimate = [{x:?}, {y:?}, 0]
[joints]
left = {{ type = "link", markers = ["ground.O", "seat.A"], length = 2 }}
right = {{ type = "link", markers = ["ground.P", "seat.B"], length = 2 }}
[freedoms]
freedom = {{ {freedom} }}
"#
    )
}

/// Place of the platform, and its velocity, for an angle and its rate.
fn place(state: &[f64]) -> ([f64; 2], [f64; 2]) {
    let (sin, cos) = state[0].sin_cos();
    let speed = LENGTH * state[1];
    ([LENGTH * sin, -LENGTH * cos], [speed * cos, speed * sin])
}

fn distance([x, y]: [f64; 2], [px, py]: [f64; 2]) -> f64 {
    (x - px).hypot(y - py)
}

fn omega() -> f64 {
    (GRAVITY / LENGTH).sqrt()
}

/// Compares a swing with a truth for its angle and rate, at all tolerances.
fn assert_swings(name: &str, mechanism: &Arc<Mechanism>, truth: impl Fn(f64) -> Vec<f64>) {
    for tolerance in [1e-4, 1e-8, 1e-12] {
        let mut run = Run::new(mechanism, tolerance, Fed::default());
        let mut largest = 0.0_f64;
        for time in (0..=8).map(|step| 0.5 * f64::from(step)) {
            run.to(time);
            let ([x, y], [vx, vy]) = place(&truth(time));
            let (q, v) = (&run.solver.pose().q, run.solution.rates.velocity());
            let found = [q[0], q[1], v[0], v[1]];
            largest = largest.max(error(&found, &[x, y, vx, vy]));
        }
        // Rounding of a place, 1e-15, grows by the condition next to a dead point and over the run.
        let mark = (MARK * tolerance).max(1e-10);
        assert!(largest < mark, "{name} at {tolerance:e}: {largest:e}");
        // Up to ten passages: the steps of a good coordinate, some 30 a second, and as many again.
        let steps = run.statistics().accepted;
        assert!(steps < 600, "{name} at {tolerance:e}: {steps} steps");
    }
}

/// Heights and ways beside the lowest point, distances from a point on the way and off it.
#[test]
fn swings_move_by_elliptic_functions_in_any_coordinate() {
    for amplitude in [0.2, 2.2] {
        let ([x, y], _) = place(&[amplitude, 0.0]);
        let (q, r) = (distance([x, y], [0.0, -2.0]), distance([x, y], [0.3, -2.4]));
        for freedom in [
            format!("coordinate = \"y\", markers = [\"ground.O\", \"seat.A\"], start = {y:?}"),
            format!(
                "coordinate = \"y\", markers = [\"seat.B\", \"ground.P\"], start = {:?}",
                -y
            ),
            format!("coordinate = \"x\", markers = [\"ground.O\", \"seat.A\"], start = {x:?}"),
            format!(
                "coordinate = \"distance\", markers = [\"ground.Q\", \"seat.A\"], start = {q:?}"
            ),
            format!(
                "coordinate = \"distance\", markers = [\"ground.R\", \"seat.A\"], start = {r:?}"
            ),
        ] {
            let mechanism = parse(&swing(&freedom, [x, y]));
            let truth = |time| swinging(omega(), amplitude, time);
            assert_swings(&format!("{amplitude}, {freedom}"), &mechanism, truth);
        }
    }
}

/// Round and round, past both ends of each coordinate.
#[test]
fn swings_turn_over_in_any_coordinate() {
    let speed = 3.0 * omega();
    let begin = 0.3;
    let truth = |time: f64| turning(omega(), speed, begin + time);
    let ([x, y], [vx, vy]) = place(&truth(0.0));
    for freedom in [
        format!(
            "coordinate = \"y\", markers = [\"ground.O\", \"seat.A\"], start = {y:?}, velocity = {vy:?}"
        ),
        format!(
            "coordinate = \"x\", markers = [\"ground.O\", \"seat.A\"], start = {x:?}, velocity = {vx:?}"
        ),
    ] {
        assert_swings(&freedom, &parse(&swing(&freedom, [x, y])), truth);
    }
}

/// The change of a swing by its height at the start, in the coordinates of bodies.
#[test]
fn derivatives_go_along_through_dead_points() {
    let amplitude = 0.9;
    let ([x, y], _) = place(&[amplitude, 0.0]);
    let freedom =
        format!("coordinate = \"y\", markers = [\"ground.O\", \"seat.A\"], start = {y:?}");
    let mechanism = parse(&swing(&freedom, [x, y]));
    let (mut solver, _): (Solver, Path) = assembled(&mechanism);
    let mut direction = Direction::zero(&mechanism);
    direction.drivers[0].value = 1.0;
    let free = FreeMotion::along(&solver, 1e-10, vec![direction]).expect("a tolerance");
    let mut free = free.expect("it has a freedom");
    free.start(&mut solver, &Fed::default()).expect("it starts");
    let mut run = Run::of(solver, free, Fed::default());
    for time in [0.5, 1.0, 2.0, 3.0] {
        run.to(time);
        let Run {
            solver,
            solution,
            free,
            ..
        } = &mut run;
        free.tell(solution);
        let varied = free.varied(solver, solution).expect("it is smooth");
        let rates = (&solution.rates, &solution.driver_rates);
        let change = solver.sensitivity(rates.0, rates.1, &varied[0]);
        let change = change.expect("it is regular");
        let q = [0, 1].map(|k| change.signal(Signal::Body(BodyId(0), k)).value);
        // y = −2 cos θ at the start; the difference has an error of its step squared.
        let step = 1e-4;
        let ends = [-step, step].map(|by| {
            let ([x, y], _) = place(&swinging(omega(), amplitude + by, time));
            [x, y]
        });
        let by_angle = |k: usize| (ends[1][k] - ends[0][k]) / (2.0 * step);
        let exact = [0, 1].map(|k| by_angle(k) / (LENGTH * amplitude.sin()));
        assert!(error(&q, &exact) < 1e-7, "{time}: {q:?} {exact:?}");
    }
}

/// A random mechanism: its bodies and joints at an exact pose, and sets of coordinates any one of which may
/// be its freedoms, a good one first.
struct Case {
    parts: String,
    sets: Vec<Vec<&'static str>>,
    /// Velocities of the good ones.
    velocities: Vec<f64>,
}

/// Two unequal links.
fn links(random: &mut Random) -> Option<Case> {
    let [span, width] = [0.0; 2].map(|_| random.between(0.6, 1.2));
    let [left, right] = [0.0; 2].map(|_| random.between(1.4, 2.2));
    let (sin, cos) = random.between(-0.7, 0.7).sin_cos();
    let a = [left * sin, -left * cos];
    // B at the distances `width` from A and `right` from P, to the right of the way from A to P.
    let [dx, dy] = [span - a[0], -a[1]];
    let reach = dx.hypot(dy);
    let along = (reach * reach + width * width - right * right) / (2.0 * reach);
    let aside = (width * width - along * along).sqrt();
    let b = [
        a[0] + (along * dx + aside * dy) / reach,
        a[1] + (along * dy - aside * dx) / reach,
    ];
    let angle = f64::atan2(b[1] - a[1], b[0] - a[0]);
    let [x, y] = a;
    (aside > 0.3).then(|| Case {
        parts: format!(
            r#"
[ground.markers]
O = [0, 0]
P = [{span:?}, 0]
Q = [0.1, -3]
[bodies.seat]
mass = 1
inertia = 0.1
center = [{:?}, -0.1]
markers = {{ A = [0, 0], B = [{width:?}, 0], C = [0.2, -0.3] }}
estimate = [{x:?}, {y:?}, {angle:?}]
[joints]
left = {{ type = "link", markers = ["ground.O", "seat.A"], length = {left:?} }}
right = {{ type = "link", markers = ["ground.P", "seat.B"], length = {right:?} }}
"#,
            0.5 * width
        ),
        sets: vec![
            vec![r#""x", markers = ["ground.O", "seat.A"]"#],
            vec![r#""y", markers = ["ground.O", "seat.A"]"#],
            vec![r#""y", markers = ["ground.O", "seat.C"]"#],
            vec![r#""x", markers = ["seat.B", "ground.O"]"#],
            vec![r#""distance", markers = ["ground.Q", "seat.C"]"#],
            vec![r#""distance", markers = ["ground.P", "seat.A"]"#],
        ],
        velocities: vec![random.between(-1.0, 1.0)],
    })
}

/// Two equal ropes, each round a point of the platform: it moves on an ellipse without turning.
fn ropes(random: &mut Random) -> Option<Case> {
    let (focus, half) = (random.between(0.1, 0.5), random.between(0.8, 1.5));
    let (sin, cos) = random.between(-0.9, 0.9).sin_cos();
    let [x, y] = [half * sin, -(half * half - focus * focus).sqrt() * cos];
    Some(Case {
        parts: format!(
            r#"
[ground.markers]
O = [{:?}, 0]
P = [{focus:?}, 0]
O2 = [{:?}, 0]
P2 = [{:?}, 0]
Q = [0.1, -2]
[bodies.seat]
mass = 1
inertia = 0.1
center = [0.5, 0]
markers = {{ A = [0, 0], B = [1, 0] }}
estimate = [{x:?}, {y:?}, 0]
[joints]
left = {{ type = "rope", markers = ["ground.O", "seat.A", "ground.P"], length = {:?} }}
right = {{ type = "rope", markers = ["ground.O2", "seat.B", "ground.P2"], length = {:?} }}
"#,
            -focus,
            1.0 - focus,
            1.0 + focus,
            2.0 * half,
            2.0 * half
        ),
        sets: vec![
            vec![r#""x", markers = ["ground.O", "seat.A"]"#],
            vec![r#""y", markers = ["ground.O", "seat.A"]"#],
            vec![r#""distance", markers = ["ground.Q", "seat.A"]"#],
            vec![r#""distance", markers = ["ground.O", "seat.A"]"#],
        ],
        velocities: vec![random.between(-1.0, 1.0)],
    })
}

/// A carriage on a closed track: its angle is a good coordinate all around.
fn track(random: &mut Random) -> Option<Case> {
    let [a, b] = [0.0; 2].map(|_| random.between(0.7, 1.6));
    let (sin, cos) = random.between(0.0, std::f64::consts::TAU).sin_cos();
    let angle = f64::atan2(b * cos, -a * sin);
    Some(Case {
        parts: format!(
            r#"
[ground.markers]
O = [0, 0]
Q = [0.3, 0.2]
[bodies.seat]
mass = 1
inertia = 0.05
center = [0, 0.1]
markers = {{ A = [0, 0], C = [0, 0.2] }}
estimate = [{:?}, {:?}, {angle:?}]
[joints]
track = {{ type = "curve", markers = ["ground.O", "seat.A"], x = "{a:?}*cos(2*pi*s)", y = "{b:?}*sin(2*pi*s)", closed = true, follow = true }}
"#,
            a * cos,
            b * sin
        ),
        sets: vec![
            vec![r#""angle", markers = ["ground.O", "seat.A"]"#],
            vec![r#""x", markers = ["ground.O", "seat.A"]"#],
            vec![r#""y", markers = ["ground.O", "seat.C"]"#],
            vec![r#""distance", markers = ["ground.Q", "seat.C"]"#],
        ],
        velocities: vec![random.between(-4.0, 4.0)],
    })
}

/// A bar whose pins slide in two slots at right angles.
fn slots(random: &mut Random) -> Option<Case> {
    let length = random.between(0.8, 1.6);
    let angle = random.between(-3.1, 3.1);
    Some(Case {
        parts: format!(
            r#"
[ground.markers]
level = [0, 0]
upright = [0, 0, "90*deg"]
Q = [0.2, 0.1]
[bodies.bar]
mass = 1
inertia = 0.1
center = [{:?}, 0]
markers = {{ B = [0, 0], A = [{length:?}, 0], C = [{:?}, 0.1] }}
estimate = [0, {:?}, {angle:?}]
[joints]
level = {{ type = "slot", markers = ["ground.level", "bar.A"] }}
upright = {{ type = "slot", markers = ["ground.upright", "bar.B"] }}
"#,
            0.5 * length,
            0.4 * length,
            -length * angle.sin()
        ),
        sets: vec![
            vec![r#""angle", markers = ["ground.level", "bar.A"]"#],
            vec![r#""x", markers = ["ground.level", "bar.A"]"#],
            vec![r#""y", markers = ["ground.level", "bar.C"]"#],
            vec![r#""distance", markers = ["ground.Q", "bar.C"]"#],
            vec![r#""distance", markers = ["ground.level", "bar.B"]"#],
        ],
        velocities: vec![random.between(-3.0, 3.0)],
    })
}

/// A tappet on a cam.
fn cam(random: &mut Random) -> Option<Case> {
    let (base, lift) = (random.between(0.4, 0.6), random.between(0.1, 0.15));
    let angle = random.between(-3.1, 3.1);
    Some(Case {
        parts: format!(
            r#"
[ground.markers]
O = [0, 0]
guide = [0, 0, "90*deg"]
[bodies.cam]
mass = 2
inertia = 0.05
markers = {{ O = [0, 0], C = [0.3, 0] }}
estimate = [0, 0, {angle:?}]
[bodies.tappet]
mass = 0.5
markers = {{ F = [0, 0, "90*deg"] }}
estimate = [0, {:?}, 0]
[joints]
pin = {{ type = "revolute", markers = ["ground.O", "cam.O"] }}
guide = {{ type = "translational", markers = ["ground.guide", "tappet.F"] }}
contact = {{ type = "cam", markers = ["cam.O", "tappet.F"], follower = "knife", profile = "{base:?} + {lift:?}*cos(theta)" }}
"#,
            base + lift * (0.5 * std::f64::consts::PI - angle).cos()
        ),
        sets: vec![
            vec![r#""angle", markers = ["ground.O", "cam.O"]"#],
            vec![r#""y", markers = ["ground.O", "tappet.F"]"#],
            vec![r#""distance", markers = ["tappet.F", "cam.C"]"#],
        ],
        velocities: vec![random.between(5.0, 9.0)],
    })
}

/// A swing that hangs from a swing.
fn double_swing(random: &mut Random) -> Option<Case> {
    let [first, second] = [0.0; 2].map(|_| random.between(-0.4, 0.4));
    let [upper, lower] = [0.0; 2].map(|_| random.between(0.8, 1.6));
    let a = [upper * first.sin(), -upper * first.cos()];
    let b = [a[0] + lower * second.sin(), a[1] - lower * second.cos()];
    Some(Case {
        parts: format!(
            r#"
[ground.markers]
O = [0, 0]
P = [1, 0]
[bodies.seat]
mass = 1
inertia = 0.1
center = [0.5, 0]
markers = {{ A = [0, 0], B = [1, 0] }}
estimate = [{:?}, {:?}, 0]
[bodies.low]
mass = 0.7
inertia = 0.1
center = [0.5, 0]
markers = {{ A = [0, 0], B = [1, 0] }}
estimate = [{:?}, {:?}, 0]
[joints]
left = {{ type = "link", markers = ["ground.O", "seat.A"], length = {upper:?} }}
right = {{ type = "link", markers = ["ground.P", "seat.B"], length = {upper:?} }}
left_low = {{ type = "link", markers = ["seat.A", "low.A"], length = {lower:?} }}
right_low = {{ type = "link", markers = ["seat.B", "low.B"], length = {lower:?} }}
"#,
            a[0], a[1], b[0], b[1]
        ),
        sets: vec![
            vec![
                r#""x", markers = ["ground.O", "seat.A"]"#,
                r#""x", markers = ["seat.A", "low.A"]"#,
            ],
            vec![
                r#""y", markers = ["ground.O", "seat.A"]"#,
                r#""y", markers = ["seat.A", "low.A"]"#,
            ],
            vec![
                r#""y", markers = ["ground.O", "seat.A"]"#,
                r#""x", markers = ["ground.O", "low.A"]"#,
            ],
        ],
        velocities: vec![random.between(-0.5, 0.5), random.between(-0.5, 0.5)],
    })
}

/// A swing on a carriage that is driven to and fro.
fn driven_swing(random: &mut Random) -> Option<Case> {
    let (sin, cos) = random.between(-0.7, 0.7).sin_cos();
    let length = random.between(0.8, 1.6);
    let sway = random.between(0.02, 0.1);
    Some(Case {
        parts: format!(
            r#"
[ground.markers]
O = [0, 0]
[bodies.carriage]
mass = 1
markers = {{ O = [0, 0], P = [1, 0] }}
[bodies.seat]
mass = 1
inertia = 0.1
center = [0.5, 0]
markers = {{ A = [0, 0], B = [1, 0] }}
estimate = [{:?}, {:?}, 0]
[drivers]
sway = {{ coordinate = "x", markers = ["ground.O", "carriage.O"], motion = "{sway:?}*sin(3*t)" }}
[joints]
guide = {{ type = "translational", markers = ["ground.O", "carriage.O"] }}
left = {{ type = "link", markers = ["carriage.O", "seat.A"], length = {length:?} }}
right = {{ type = "link", markers = ["carriage.P", "seat.B"], length = {length:?} }}
"#,
            length * sin,
            -length * cos
        ),
        sets: vec![
            vec![r#""x", markers = ["carriage.O", "seat.A"]"#],
            vec![r#""y", markers = ["carriage.O", "seat.A"]"#],
            vec![r#""y", markers = ["ground.O", "seat.B"]"#],
            vec![r#""x", markers = ["ground.O", "seat.A"]"#],
        ],
        velocities: vec![random.between(-1.0, 1.0)],
    })
}

impl Case {
    /// The mechanism with one of the sets as its freedoms; all coordinates are measured.
    fn text(&self, set: usize, states: &[[f64; 2]]) -> String {
        let mut text = format!("format = 1\nname = \"any\"\n{}[freedoms]\n", self.parts);
        for (k, (coordinate, [start, velocity])) in self.sets[set].iter().zip(states).enumerate() {
            // The estimates say where the good ones start.
            let start = if start.is_nan() {
                String::new()
            } else {
                format!(", start = {start:?}")
            };
            writeln!(
                text,
                "freedom{k} = {{ coordinate = {coordinate}{start}, velocity = {velocity:?} }}"
            )
            .expect("a string takes it");
        }
        text += "[measures]\n";
        for (k, coordinate) in self.sets.iter().flatten().enumerate() {
            writeln!(text, "measure{k} = {{ coordinate = {coordinate} }}")
                .expect("a string takes it");
        }
        text
    }
}

/// Any coordinates that say at the start how a mechanism moves give the same motion, with its energy.
#[test]
fn any_coordinates_give_the_same_motion() {
    const TOLERANCE: f64 = 1e-8;
    type Kind = fn(&mut Random) -> Option<Case>;
    let kinds: [(&str, Kind); 7] = [
        ("links", links),
        ("ropes", ropes),
        ("track", track),
        ("slots", slots),
        ("cam", cam),
        ("double swing", double_swing),
        ("driven swing", driven_swing),
    ];
    for (name, kind) in kinds {
        let cases = (0..).filter_map(|seed| Some((seed, kind(&mut Random::new(seed))?)));
        let mut compared = 0;
        for (seed, case) in cases.take(3) {
            let states: Vec<_> = case.velocities.iter().map(|v| [f64::NAN, *v]).collect();
            let begin = Run::new(&parse(&case.text(0, &states)), TOLERANCE, Fed::default());
            let motion = |set: usize, states: &[[f64; 2]]| {
                let text = case.text(set, states);
                let mut run = Run::new(&parse(&text), TOLERANCE, Fed::default());
                let times = (1..=8).map(|step| 0.25 * f64::from(step));
                let states = times.map(|time| {
                    if let Err(error) = run.try_to(time) {
                        panic!("{name} {seed} to {time} s: {error}\n{text}");
                    }
                    let q = run.solver.pose().q.iter().copied();
                    let state: Vec<f64> = q
                        .chain(run.solution.rates.velocity().iter().copied())
                        .collect();
                    state
                });
                let states: Vec<Vec<f64>> = states.collect();
                // Kinetic energies are some joules.
                let energy = run.energy_error;
                assert!(
                    energy < MARK * TOLERANCE,
                    "{name} {seed}: {energy:e}\n{text}"
                );
                let steps = run.statistics().accepted;
                assert!(steps < 2000, "{name} {seed}: {steps} steps\n{text}");
                states
            };
            let exact = motion(0, &states);
            let mut measures = 0..;
            for (set, coordinates) in case.sets.iter().enumerate() {
                let states: Vec<_> = coordinates
                    .iter()
                    .zip(&mut measures)
                    .map(|(_, k)| {
                        let at = begin.solver.measure(k, &begin.solution.rates);
                        [at.value, at.first()]
                    })
                    .collect();
                // A coordinate that stands at the start says nothing.
                let moves = states.iter().zip(&case.velocities);
                if set == 0
                    || moves
                        .into_iter()
                        .any(|([_, v], good)| (v / good).abs() < 0.05)
                {
                    continue;
                }
                compared += 1;
                let found = motion(set, &states);
                for (found, exact) in found.iter().zip(&exact) {
                    let off = error(found, exact);
                    let text = case.text(set, &states);
                    assert!(
                        off < MARK * TOLERANCE,
                        "{name} {seed} {set}: {off:e}\n{text}"
                    );
                }
            }
        }
        assert!(compared > 2, "{name}: {compared}");
    }
}

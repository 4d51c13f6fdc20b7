//! Events between the ends of a step: whatever the rows of a run, the same happens at the same instants.

use biela::dynamics::{Event, EventKind};

use super::events::{assert_near, played, slider};
use super::run::{Fed, Run};
use crate::common::parse;

const TOLERANCE: f64 = 1e-10;
const G: f64 = 9.81;

/// Numbers of rows in a second.
const ROWS: [u32; 5] = [1, 2, 10, 37, 200];

fn run(text: &str) -> Run {
    Run::new(&parse(text), TOLERANCE, Fed::default())
}

/// Returns where a condition that holds at `low` and not at `high` ends.
fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// A floor that moves up and down: its height, velocity and acceleration.
type Floor = fn(f64) -> [f64; 3];

/// Returns the height at a time of a body that falls on a moving floor from a height, touches it at
/// first or not, and bounces with a restitution. What does not bounce stays on the floor while this
/// falls no faster than the body.
fn on_floor(floor: Floor, mut place: [f64; 2], restitution: f64, until: f64) -> f64 {
    /// Far shorter than any flight or period here.
    const SCAN: f64 = 1e-5;
    let mut t = 0.0;
    loop {
        let [height, velocity, acceleration] = floor(t);
        let touches = place[0] <= height + 1e-12 && place[1] <= velocity + 1e-12;
        if touches && acceleration > -G {
            let mut end = t;
            while end < until && floor(end)[2] > -G {
                end += SCAN;
            }
            t = bisect(end - SCAN, end, |t| floor(t)[2] > -G);
            if t >= until {
                return floor(until)[0];
            }
            let [height, velocity, _] = floor(t);
            place = [height, velocity];
        }
        let at = |s: f64| place[0] + place[1] * s - 0.5 * G * s * s;
        let is_above = |s: f64| at(s) > floor(t + s)[0];
        // From the floor the flight begins above it.
        let mut end = SCAN;
        while t + end < until && is_above(end) {
            end += SCAN;
        }
        if t + end >= until {
            return at(until - t);
        }
        let s = bisect(end - SCAN, end, is_above);
        let (height, velocity) = (at(s), place[1] - G * s);
        t += s;
        let of_floor = floor(t)[1];
        place = [height, of_floor - restitution * (velocity - of_floor)];
    }
}

fn vibrating(amplitude: f64, frequency: f64) -> String {
    format!(
        r#"
format = 1
name = "vibrating_table"
[ground.markers]
G = [0, 0, "90*deg"]
[bodies.table]
markers = {{ S = [0, 0, "90*deg"] }}
[bodies.ball]
mass = 1
markers = {{ S = [0, 0, "90*deg"] }}
estimate = [0, 0.05, 0]
[joints]
gt = {{ type = "translational", markers = ["ground.G", "table.S"] }}
gb = {{ type = "translational", markers = ["ground.G", "ball.S"] }}
[drivers]
shake = {{ coordinate = "x", markers = ["ground.G", "table.S"], motion = "{amplitude}*sin({frequency}*t)" }}
[freedoms]
y = {{ coordinate = "x", markers = ["ground.G", "ball.S"], start = 0.05 }}
[stops]
hit = {{ coordinate = "x", markers = ["table.S", "ball.S"], min = 0, restitution = 0.5 }}
"#
    )
}

/// The ball's flight is a parabola, exact for any step, while the table moves through many periods.
#[test]
fn a_ball_meets_a_vibrating_table() {
    let slow: Floor = |t| {
        let (sin, cos) = (100.0 * t).sin_cos();
        [0.01 * sin, cos, -100.0 * sin]
    };
    let truth = on_floor(slow, [0.05, 0.0], 0.5, 0.7);
    for rows in ROWS {
        let mut run = run(&vibrating(0.01, 100.0));
        played(&mut run, 0.7, rows);
        // Each of the eleven bounces multiplies errors by some two.
        let error = (run.state()[0] - truth).abs();
        assert!(error < 1e-6, "{rows} rows: {error}");
    }
}

/// An eccentric circle under a flat face, of which the face jumps off at each turn.
#[test]
fn a_flat_follower_lands_on_its_cam() {
    let text = r#"
format = 1
name = "tappet"
[ground.markers]
O = [0, 0]
S = [0, 0, "90*deg"]
[bodies.cam]
markers = { O = [0, 0] }
[bodies.tap]
mass = 1
markers = { F = [0, 0], S = [0, 0, "90*deg"] }
estimate = [0, 0.0264, 0]
[joints]
p = { type = "revolute", markers = ["ground.O", "cam.O"] }
s = { type = "translational", markers = ["ground.S", "tap.S"] }
c = { type = "cam", markers = ["cam.O", "tap.F"], follower = "flat", profile = "0.0197*cos(theta) + sqrt(0.0264^2 - 0.0197^2*sin(theta)^2)", unilateral = true }
[drivers]
th = { coordinate = "angle", markers = ["ground.O", "cam.O"], motion = "30*t" }
[freedoms]
y = { coordinate = "x", markers = ["ground.S", "tap.S"], start = 0.0264, velocity = 0.591 }
"#;
    let lift: Floor = |t| {
        let (sin, cos) = (30.0 * t).sin_cos();
        [0.0264 + 0.0197 * sin, 0.591 * cos, -17.73 * sin]
    };
    let truths = [0.4, 1.0].map(|until| (until, on_floor(lift, [0.0264, 0.591], 0.0, until)));
    for rows in ROWS {
        let mut run = run(text);
        for (until, truth) in truths {
            played(&mut run, until, rows);
            assert_near(run.state()[0], truth);
        }
    }
}

/// The distance from a small obstacle is V-shaped in time: no polynomial through the ends of a step
/// shows it.
#[test]
fn a_pendulum_strikes_a_small_obstacle() {
    let text = r#"
format = 1
name = "pendulum_stop"
[ground.markers]
W = [0, 0]
P = [0, -1.02]
[bodies.rod]
mass = 1
inertia = 0.1
center = [1, 0]
markers = { O = [0, 0], T = [1, 0] }
[joints]
O = { type = "revolute", markers = ["ground.W", "rod.O"] }
[freedoms]
swing = { coordinate = "angle", markers = ["ground.W", "rod.O"], start = 0 }
[stops]
hit = { coordinate = "distance", markers = ["ground.P", "rod.T"], min = 0.03, restitution = 0.5 }
"#;
    // The angle at which the distance is 0.03, and the speed there by the energy.
    let distance = |angle: f64| angle.cos().hypot(angle.sin() + 1.02);
    let angle = bisect(0.0, std::f64::consts::FRAC_PI_2, |a| distance(-a) > 0.03);
    let speed = (2.0 * G * angle.sin() / 1.1).sqrt();
    let slope = (distance(-angle - 1e-6) - distance(-angle + 1e-6)) / 2e-6;
    let truth = slope.abs() * speed;
    for rows in ROWS {
        let mut run = run(text);
        let events = played(&mut run, 2.0, rows);
        let Event { time, kind, .. } = events[0];
        // A quarter of the period, less the last bit of the way.
        assert!((time - 0.615_610_656).abs() < 1e-9, "{rows} rows: {time}");
        let EventKind::Impact { speed } = kind else {
            panic!("{kind:?}")
        };
        // The difference quotient is right to 1e-9.
        assert!((speed - truth).abs() < 1e-8, "{speed} {truth}");
    }
}

/// A knife edge waits on a stop above a cam, whose lobe of 0.03 rad passes it within a millisecond.
#[test]
fn a_narrow_lobe_strikes() {
    let text = r#"
format = 1
name = "lobe"
[ground.markers]
O = [0, 0]
S = [0, 0, "90*deg"]
[bodies.cam]
markers = { O = [0, 0] }
[bodies.tap]
mass = 1
markers = { F = [0, 0], S = [0, 0, "90*deg"] }
estimate = [0, 0.05, 0]
[joints]
p = { type = "revolute", markers = ["ground.O", "cam.O"] }
s = { type = "translational", markers = ["ground.S", "tap.S"] }
c = { type = "cam", markers = ["cam.O", "tap.F"], follower = "knife", profile = "0.04 + 0.02*exp(-5000*(1 - cos(theta)))", unilateral = true }
[drivers]
th = { coordinate = "angle", markers = ["ground.O", "cam.O"], motion = "30*t" }
[freedoms]
y = { coordinate = "x", markers = ["ground.S", "tap.S"], start = 0.05 }
[stops]
rest = { of = "y", min = 0.05 }
"#;
    // The lobe stands at theta = 0, and meets the edge at an angle of 90° less the half of its width.
    let radius = |theta: f64| 0.04 + 0.02 * (-5000.0 * (1.0 - theta.cos())).exp();
    let half = bisect(0.0, 0.2, |theta| radius(theta) > 0.05);
    let truth = (std::f64::consts::FRAC_PI_2 - half) / 30.0;
    for rows in ROWS {
        let mut run = run(text);
        let events = played(&mut run, 0.1, rows);
        let strikes = |event: &&Event| matches!(event.kind, EventKind::Impact { .. });
        let first = events.iter().find(strikes).expect("the lobe strikes");
        assert_near(first.time, truth);
    }
}

/// A block that friction holds does not move, whatever the load does below the limit: the load tells the
/// integrator nothing of its peaks.
#[test]
fn a_load_that_oscillates_breaks_friction_loose() {
    let text = slider(
        0.0,
        0.0,
        0.0,
        "[forces]\nload = { coordinate = \"x\", markers = [\"ground.O\", \"slider.P\"], value = \"10.5*sin(50*t)\" }\n\
         [friction]\nrub = { of = \"way\", force = 10 }",
    );
    let truth = (10.0 / 10.5_f64).asin() / 50.0;
    for rows in ROWS {
        let mut run = run(&text);
        let events = played(&mut run, 0.1, rows);
        assert_eq!(events[0].kind, EventKind::Slides, "{rows} rows: {events:?}");
        assert_near(events[0].time, truth);
    }
}

/// A driven plate rubs on a block that the ground holds: at each reversal the force on the block turns.
#[test]
fn friction_turns_with_a_driven_plate() {
    let text = r#"
format = 1
name = "plate"
[ground.markers]
G = [0, 0]
[bodies.plate]
markers = { O = [0, 0] }
[bodies.block]
mass = 1
markers = { O = [0, 0] }
[joints]
gp = { type = "translational", markers = ["ground.G", "plate.O"] }
gb = { type = "translational", markers = ["ground.G", "block.O"] }
[drivers]
p = { coordinate = "x", markers = ["ground.G", "plate.O"], motion = "0.1*cos(5*t)" }
[freedoms]
b = { coordinate = "x", markers = ["ground.G", "block.O"], start = 0 }
[forces]
load = { coordinate = "x", markers = ["ground.G", "block.O"], value = 9 }
[friction]
to_ground = { of = "b", force = 10 }
to_plate = { coordinate = "x", markers = ["plate.O", "block.O"], force = 2 }
"#;
    let reversal = std::f64::consts::PI / 5.0;
    for rows in ROWS {
        let mut run = run(text);
        played(&mut run, 0.5, rows);
        // 9 − 2 N rest on the ground; the plate moves to the left.
        assert_near(run.state()[0], 0.0);
        played(&mut run, 1.0, rows);
        // 9 + 2 − 10 N move 1 kg from the reversal on.
        assert_near(run.state()[0], 0.5 * (1.0 - reversal).powi(2));
    }
}

/// Dry friction of a bearing whose shaft is driven asks for more effort and changes no motion.
#[test]
fn friction_on_a_driven_coordinate_leaves_the_freedoms_alone() {
    let text = |parts: &str, motion: &str| {
        format!(
            r#"
format = 1
name = "arm"
[ground.markers]
base = [0, 0]
[bodies.upper]
markers = {{ base = [0, 0], elbow = [0.4, 0] }}
mass = 3
inertia = 0.05
[bodies.lower]
markers = {{ elbow = [0, 0] }}
estimate = [0.4, 0, 0]
mass = 2
inertia = 0.03
center = [0.15, 0]
[joints]
base = {{ type = "revolute", markers = ["ground.base", "upper.base"] }}
elbow = {{ type = "revolute", markers = ["upper.elbow", "lower.elbow"] }}
[drivers]
shoulder = {{ coordinate = "angle", markers = ["ground.base", "upper.base"], motion = "{motion}" }}
[freedoms]
bend = {{ coordinate = "angle", markers = ["upper.elbow", "lower.elbow"], start = 0 }}
{parts}
"#
        )
    };
    for motion in ["t", "sin(3*t)", "max(0, t - 1)^3"] {
        let mut plain = run(&text("", motion));
        played(&mut plain, 2.0, 4);
        for rows in ROWS {
            let rubbed = "[friction]\nf = { of = \"shoulder\", force = 0.5 }";
            let mut run = run(&text(rubbed, motion));
            played(&mut run, 2.0, rows);
            for (value, truth) in run.state().iter().zip(plain.state()) {
                assert_near(*value, truth);
            }
        }
    }
}

/// Two masses are pressed against a wall and against each other: infinitely many impacts of both come to an
/// end.
#[test]
fn two_contacts_come_to_rest_together() {
    for restitution in [0.1, 0.3, 0.5] {
        let text = format!(
            r#"
format = 1
name = "pair"
[ground.markers]
G = [0, 0]
[bodies.a]
mass = 1
markers = {{ O = [0, 0] }}
[bodies.b]
mass = 1
markers = {{ O = [0, 0] }}
estimate = [0.2, 0, 0]
[joints]
ga = {{ type = "translational", markers = ["ground.G", "a.O"] }}
gb = {{ type = "translational", markers = ["ground.G", "b.O"] }}
[freedoms]
fa = {{ coordinate = "x", markers = ["ground.G", "a.O"], start = 0.1 }}
fb = {{ coordinate = "x", markers = ["ground.G", "b.O"], start = 0.3 }}
[stops]
wall = {{ of = "fa", min = 0, restitution = {restitution} }}
pair = {{ coordinate = "x", markers = ["a.O", "b.O"], min = 0.1, restitution = {restitution} }}
[simulation]
gravity = [-9.81, 0]
"#
        );
        for rows in [1, 20] {
            let mut run = run(&text);
            let events = played(&mut run, 2.0, rows);
            for (value, truth) in run.state().iter().zip([0.0, 0.1, 0.0, 0.0]) {
                assert_near(*value, truth);
            }
            let rests = |event: &&Event| event.kind == EventKind::Rests;
            assert!(events.iter().filter(rests).count() >= 2, "{events:?}");
        }
    }
}

/// Backlash of wheels hundreds of radians from the start is that at the start.
#[test]
fn backlash_does_not_depend_on_turns() {
    let text = |start: f64| {
        format!(
            r#"
format = 1
name = "wheels"
[ground.markers]
A = [0, 0]
B = [0.3, 0]
[bodies.motor]
mass = 1
inertia = 0.01
markers = {{ O = [0, 0] }}
[bodies.wheel]
mass = 1
inertia = 0.02
markers = {{ O = [0, 0] }}
estimate = [0.3, 0, 0]
[joints]
a = {{ type = "revolute", markers = ["ground.A", "motor.O"] }}
b = {{ type = "revolute", markers = ["ground.B", "wheel.O"] }}
mesh = {{ type = "gear", markers = ["motor.O", "wheel.O"], teeth = [20, 40], backlash = "0.5*deg", restitution = 0.5 }}
[freedoms]
m = {{ coordinate = "angle", markers = ["ground.A", "motor.O"], start = {start} }}
w = {{ coordinate = "angle", markers = ["ground.B", "wheel.O"], start = {} }}
[forces]
torque = {{ coordinate = "angle", markers = ["ground.A", "motor.O"], value = "0.5*cos(4*t)" }}
drag = {{ coordinate = "angle", markers = ["ground.B", "wheel.O"], damping = 0.005 }}
"#,
            -0.5 * start
        )
    };
    let mut at_zero = run(&text(0.0));
    played(&mut at_zero, 1.0, 10);
    let turns = 2.0 * std::f64::consts::PI * 48.0;
    let mut far = run(&text(turns));
    played(&mut far, 1.0, 10);
    let starts = [turns, -0.5 * turns, 0.0, 0.0];
    for ((value, truth), start) in far.state().iter().zip(at_zero.state()).zip(starts) {
        // The flanks' places are known to the rounding of 300 rad, and impacts multiply it.
        assert!((value - start - truth).abs() < 1e-7, "{value} {truth}");
    }
}

/// A body that starts at the limit of an elastic stop with a damper, and moves in: from the first instant on
/// the damper pushes, as behind the limit.
#[test]
fn a_start_at_an_elastic_limit_goes_on() {
    let start = |place: f64| {
        slider(
            0.0,
            place,
            -2.0,
            "[stops]\nend = { of = \"way\", min = 0, stiffness = 26000, damping = 197 }",
        )
    };
    let mut at = run(&start(0.0));
    played(&mut at, 0.5, 5);
    // The same stop, met in flight.
    let mut before = run(&start(0.2));
    played(&mut before, 0.6, 5);
    for (value, truth) in at.state().iter().zip(before.state()) {
        assert_near(*value, truth);
    }
}

/// Wheels that touch hundreds of radians from zero part at the instant at which those near zero do: there the
/// force between them is noise of places far coarser than the time.
#[test]
fn wheels_far_from_zero_part() {
    let text = |start: f64| {
        format!(
            r#"
format = 1
name = "wheels"
[ground.markers]
A = [0, 0]
B = [1, 0]
[bodies.motor]
mass = 1
inertia = 0.019326037216665832
markers = {{ O = [0, 0] }}
[bodies.wheel]
mass = 1
inertia = 0.3707413090641088
markers = {{ O = [0, 0] }}
estimate = [1, 0, 0]
[joints]
a = {{ type = "revolute", markers = ["ground.A", "motor.O"] }}
b = {{ type = "revolute", markers = ["ground.B", "wheel.O"] }}
mesh = {{ type = "gear", markers = ["motor.O", "wheel.O"], radii = [1.3456264896436345, 1.0], backlash = 0.19077399447635052, restitution = 0 }}
[freedoms]
m = {{ coordinate = "angle", markers = ["ground.A", "motor.O"], start = {start} }}
w = {{ coordinate = "angle", markers = ["ground.B", "wheel.O"], start = {}, velocity = 1.5293640643019244 }}
[forces]
torque = {{ coordinate = "angle", markers = ["ground.A", "motor.O"], value = 1.3567475993581313 }}
spring = {{ coordinate = "angle", markers = ["ground.A", "motor.O"], stiffness = 89.81948978100218, free = {} }}
"#,
            0.0313 - 1.3456264896436345 * start,
            start - 0.4469
        )
    };
    let parted = |start: f64| {
        let mut run = run(&text(start));
        let events = played(&mut run, 0.3, 30);
        let left = events
            .iter()
            .filter(|event| event.kind == EventKind::Leaves);
        let times: Vec<f64> = left.map(|event| event.time).collect();
        (times, run.state().to_vec())
    };
    let (near, _) = parted(0.0);
    assert!(!near.is_empty());
    for start in [-360.585_065_314_829_25, -300.3, 306.970_538_684_66] {
        let (far, _) = parted(start);
        assert_eq!(far.len(), near.len());
        for (far, near) in far.iter().zip(&near) {
            // Roundings of 360 rad over those of the stroke, at some rad/s.
            assert!((far - near).abs() < 1e-9, "{far} {near}");
        }
    }
}

/// A ball on a rope comes to rest at the same instant whatever the rows and the tolerance.
#[test]
fn bounces_on_a_rope_come_to_an_end() {
    let text = r#"
format = 1
name = "ball"
[ground.markers]
G = [0, 0, "90*deg"]
A = [-0.2075617396621524, -0.07338213232555435]
[bodies.ball]
mass = 1.7
markers = { B = [0, 0], S = [0, 0, "90*deg"] }
estimate = [0, -0.23, 0]
[joints]
guide = { type = "translational", markers = ["ground.G", "ball.S"] }
rope = { type = "rope", markers = ["ground.A", "ball.B"], length = 0.26028938293399645, unilateral = true, restitution = 0.5176637713091388 }
[freedoms]
y = { coordinate = "x", markers = ["ground.G", "ball.S"], start = -0.23044481757122787, velocity = 1.0530464976525389 }
"#;
    let rest = |tolerance: f64, rows: u32| {
        let mut run = Run::new(&parse(text), tolerance, Fed::default());
        let events = played(&mut run, 1.6846162657385584, rows);
        let rests = events.iter().filter(|event| event.kind == EventKind::Rests);
        let rests: Vec<f64> = rests.map(|event| event.time).collect();
        assert!(matches!(rests[..], [_]) && events.len() < 40, "{events:?}");
        rests[0]
    };
    let truth = rest(1e-12, 1);
    for rows in ROWS {
        for tolerance in [1e-8, 1e-10] {
            let off = (rest(tolerance, rows) - truth).abs();
            // The bounces, shorter by a half each, magnify the errors of the first two flights.
            assert!(off < 1e3 * tolerance, "{rows} {tolerance} {off}");
        }
    }
}

/// Masses between elastic stops of which one is damped: the force of the damper ends and begins steeply.
#[test]
fn masses_on_damped_stops_go_on() {
    let text = r#"
format = 1
name = "row"
[ground.markers]
G = [0, 0, -0.9871818225982525]
[bodies]
m0 = { markers = { O = [0, 0] }, estimate = [0.143401624468173, -0.21716109719545512, -0.9871818225982525], mass = 1.069433409825704 }
m1 = { markers = { O = [0, 0] }, estimate = [0.21365639374580345, -0.3235518220992017, -0.9871818225982525], mass = 4.7292630406192115 }
[joints]
g0 = { type = "translational", markers = ["ground.G", "m0.O"] }
g1 = { type = "translational", markers = ["ground.G", "m1.O"] }
[freedoms]
x0 = { coordinate = "x", markers = ["ground.G", "m0.O"], start = 0.2602363695474651 }
x1 = { coordinate = "x", markers = ["ground.G", "m1.O"], start = 0.3877303652954915, velocity = -1.8918725620345278 }
[stops]
hit0 = { of = "x0", min = 0.1473850217577611, stiffness = 89744.78019807466 }
hit1 = { coordinate = "x", markers = ["m0.O", "m1.O"], min = 0.0782127612656669, stiffness = 2441213.9291782407, damping = 6905.547694680709 }
wall = { of = "x1", max = 0.6075260025579614, stiffness = 104849.78349381515 }
[friction]
rub0 = { of = "x0", force = 0.6995856208213878 }
rub1 = { of = "x1", force = 9.299503798544512 }
"#;
    let ends = ROWS.map(|rows| {
        let mut run = run(text);
        played(&mut run, 1.2, rows);
        run.state().to_vec()
    });
    for end in &ends {
        for (value, other) in end.iter().zip(&ends[0]) {
            // Some dozen impacts magnify the tolerance.
            assert!((value - other).abs() < 1e-5, "{ends:?}");
        }
    }
}

/// Three bodies in a row lie at their elastic stops. Two of them fall on together and do not strike: between
/// them there is rounding alone, until the first meets the wall.
#[test]
fn bodies_that_fall_together_do_not_strike() {
    let text = r#"
format = 1
name = "row"
[ground.markers]
G = [0, 0, -0.8436598086516264]
[bodies]
m0 = { markers = { O = [0, 0] }, estimate = [0.04180312642678481, -0.04698173958201653, -0.8436598086516264], mass = 3.144327068071071 }
m1 = { markers = { O = [0, 0] }, estimate = [0.12844320427615086, -0.14435487701980473, -0.8436598086516264], mass = 1.3431295374081558 }
m2 = { markers = { O = [0, 0] }, estimate = [0.24046100958005492, -0.2702495601974961, -0.8436598086516264], mass = 1.9755808826862138 }
[joints]
g0 = { type = "translational", markers = ["ground.G", "m0.O"] }
g1 = { type = "translational", markers = ["ground.G", "m1.O"] }
g2 = { type = "translational", markers = ["ground.G", "m2.O"] }
[freedoms]
x0 = { coordinate = "x", markers = ["ground.G", "m0.O"], start = 0.06288708319842934 }
x1 = { coordinate = "x", markers = ["ground.G", "m1.O"], start = 0.19322522414045212 }
x2 = { coordinate = "x", markers = ["ground.G", "m2.O"], start = 0.3617406832458845 }
[stops]
hit0 = { of = "x0", min = 0.06288708319842934, stiffness = 1677121.2476812208 }
hit1 = { coordinate = "x", markers = ["m0.O", "m1.O"], min = 0.09809709372378482, stiffness = 241.14271858284837 }
hit2 = { coordinate = "x", markers = ["m1.O", "m2.O"], min = 0.16851545910543236, stiffness = 4501.548974304855, damping = 76.88439608007313 }
wall = { of = "x2", max = 0.3920800010526304, stiffness = 640060.3917087323, damping = 1578.8197313241783 }
[friction]
rub0 = { of = "x0", force = 15.960214464332909 }
"#;
    for rows in [2, 20, 140] {
        let mut run = run(text);
        let events = played(&mut run, 1.3652341495156044, rows);
        let early = events.iter().find(|event| event.time < 0.09);
        assert!(early.is_none() && !events.is_empty(), "{rows} {events:?}");
    }
}

/// A rack lies at a stop, pressed by its pinion with a force that falls. While the stop holds it friction exerts
/// what it does in sliding; friction alone holds the rack from the instant at which the force is as large as that.
#[test]
fn friction_takes_over_from_a_stop_at_one_instant() {
    let (radius, sliding, torque, rate) = (
        0.044813755245649116,
        0.6967615973009714,
        0.7859375077973626,
        6.392675103243939,
    );
    let text = format!(
        r#"
format = 1
name = "rack"
[ground.markers]
P = [0, {radius}]
G = [0, 0]
[bodies]
pinion = {{ markers = {{ O = [0, 0] }}, estimate = [0, {radius}, 0], mass = 1, inertia = 0.015214342247499913 }}
rack = {{ markers = {{ O = [0, 0] }}, mass = 0.7913442354947707 }}
[joints]
P = {{ type = "revolute", markers = ["ground.P", "pinion.O"] }}
G = {{ type = "translational", markers = ["ground.G", "rack.O"] }}
mesh = {{ type = "rack_and_pinion", markers = ["pinion.O", "rack.O"], radius = {radius}, backlash = 1.4690205859409053e-5, restitution = 0.13218111659746343 }}
[freedoms]
turn = {{ coordinate = "angle", markers = ["ground.P", "pinion.O"], start = 0 }}
way = {{ coordinate = "x", markers = ["ground.G", "rack.O"], start = 0 }}
[stops]
end = {{ of = "way", min = -0.1546219698490779, max = 0.05996928621936358, restitution = 0.13218111659746343 }}
[friction]
rub = {{ of = "way", force = {sliding}, static = 0.7544780744153505 }}
[forces]
drive = {{ coordinate = "angle", markers = ["ground.P", "pinion.O"], value = "{torque}*sin({rate}*t)" }}
"#
    );
    let press = f64::asin(sliding * radius / torque);
    let truth = (std::f64::consts::PI - press) / rate;
    for rows in [2, 20, 140] {
        let mut run = run(&text);
        let events = played(&mut run, 0.55, rows);
        let sticks = events.iter().rfind(|event| event.kind == EventKind::Sticks);
        let time = sticks.map(|event| event.time).unwrap_or_default();
        // The force is known to 1e-12 of itself, and falls by 100 N/s.
        assert!((time - truth).abs() < 1e-9, "{rows} {truth} {events:?}");
    }
}

/// A load that is constant for most of a row, and then grows, breaks friction loose where it is as large as
/// that: the force that held it was the same to the bit before.
#[test]
fn a_load_that_begins_late_breaks_friction_loose() {
    let text = slider(
        0.0,
        0.0,
        0.0,
        "[friction]\nrub = { of = \"way\", force = 50 }\n[forces]\n\
         push = { coordinate = \"x\", markers = [\"ground.O\", \"slider.P\"], \
         value = \"max(0, 400*(t - 0.75))\" }",
    );
    for rows in ROWS {
        let events = played(&mut run(&text), 1.0, rows);
        let slides = events
            .iter()
            .filter(|event| event.kind == EventKind::Slides);
        let times: Vec<f64> = slides.map(|event| event.time).collect();
        assert!(
            times.len() == 1 && (times[0] - 0.875).abs() < 1e-9,
            "{rows} {events:?}"
        );
    }
}

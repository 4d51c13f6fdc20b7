//! Free motion on pages, against closed forms and `FreeMotion`.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

use serde_json::{Value, json};

use super::{open, parameter, wrapped};
use crate::page::{Host, Outcome, Over, Session};
use biela::dynamics::{FreeMotion, Given};
use biela::kinematics::{ForceQuantity, Path, Solution, Solver};
use biela::mechanism::{BodyId, DriverId, Jet, Mechanism, Source};

const PENDULUM: &str = include_str!("../../../../../mechanisms/pendulum_free.toml");
const FOUR_BAR: &str = include_str!("../../../../../mechanisms/four_bar_free.toml");
const SWINGING_TIP: &str = include_str!("../../../../../mechanisms/swinging_tip.toml");
const LENGTH: f64 = 0.5;
const GRAVITY: f64 = 9.81;
const SWING: DriverId = DriverId(0);
const ROD: BodyId = BodyId(0);
/// The tolerance of the files over some seconds, with a digit to spare.
const TOLERANCE: f64 = 1e-7;

/// No input moves.
struct Still;

impl Given for Still {
    fn driver(&self, _: DriverId, _: f64) -> Jet {
        Jet::constant(0.0)
    }

    fn loads(&self, _: f64, loads: &mut [f64]) {
        loads.fill(0.0);
    }
}

/// Goes to a time as a page does, sixty times a second.
fn play(session: &mut Session, until: f64) {
    while session.pose().time < until {
        let next = (session.pose().time + 1.0 / 60.0).min(until);
        assert_eq!(session.go_to(next), Outcome::Reached);
    }
}

fn variable(session: &Session, name: &str) -> f64 {
    let description = session.description();
    let variables = description["variables"].as_array().expect("a list");
    let index = variables.iter().position(|v| v["name"] == name);
    session.variable(index.expect("it is there"))
}

fn bits(session: &Session) -> Vec<u64> {
    session.pose().q.iter().map(|x| x.to_bits()).collect()
}

/// Returns the place of the rod's tip.
fn tip(session: &Session) -> [f64; 2] {
    session.point(ROD, [LENGTH / 2.0, 0.0]).into()
}

/// Two equal wheels with a ratio of 1/2 and a backlash of 1 deg.
const WHEELS: &str = r#"
format = 1
name = "wheels"
ground.markers = { O = [0, 0] }
bodies.a = { markers = { O = [0, 0] }, mass = 1, inertia = 0.01 }
bodies.b = { markers = { O = [0, 0] }, mass = 1, inertia = 0.01 }
joints.O = { type = "revolute", markers = ["ground.O", "a.O"] }
joints.P = { type = "revolute", markers = ["ground.O", "b.O"] }
joints.mesh = { type = "gear", markers = ["a.O", "b.O"], teeth = [20, 40], backlash = "1*deg" }
freedoms.p = { coordinate = "angle", markers = ["ground.O", "a.O"], start = "100*deg" }
freedoms.q = { coordinate = "angle", markers = ["ground.O", "b.O"] }
"#;

/// As the file is opened, and where the hand goes on: the angles take 2/5 and 4/5 of the depth.
#[test]
fn parts_that_overlap_are_told() {
    let mut session = open(WHEELS);
    let warnings = &session.description()["warnings"];
    let opened = "t = 0 s: the parts of joint `mesh` overlap by 49.5 deg; moved apart: `p` from 100 deg to \
                  80.2 deg, `q` from 0 deg to -39.6 deg";
    assert_eq!(*warnings, json!([opened]));
    assert!((session.driver(DriverId(0)).value.to_degrees() - 80.2).abs() < 1e-12);
    let Outcome::Stopped(obstacle) = session.drive(DriverId(0), 90.2_f64.to_radians()) else {
        panic!("the wheels overlap by 5 deg");
    };
    assert_eq!(
        obstacle.message,
        "t = 0 s: the parts of joint `mesh` overlap by 5 deg; moved apart: `p` from 90.2 deg to 88.2 deg, \
         `q` from -39.6 deg to -43.6 deg"
    );
    assert_eq!(session.go_to(0.1), Outcome::Reached);
}

// The period is 4 K(sin 60°) sqrt(I/(m g a)), by the arithmetic-geometric mean: K = π/(2 agm(1, cos)).
#[test]
fn a_pendulum_that_is_let_go_swings_in_its_period() {
    let mut session = open(PENDULUM);
    let [mut a, mut b] = [1.0, FRAC_PI_3.cos()];
    for _ in 0..6 {
        [a, b] = [0.5 * (a + b), f64::sqrt(a * b)];
    }
    let quarter = FRAC_PI_2 / a * f64::sqrt(2.0 * LENGTH / (3.0 * GRAVITY));
    play(&mut session, quarter);
    assert!(session.driver(SWING).value.abs() < TOLERANCE);
    // All its energy is kinetic there, with the height of the start as its measure.
    let speed = f64::sqrt(3.0 * GRAVITY / LENGTH * (1.0 + FRAC_PI_3.cos()));
    assert!((session.driver(SWING).first() + speed).abs() < 10.0 * TOLERANCE);
    play(&mut session, 4.0 * quarter);
    let end = session.driver(SWING);
    assert!((end.value - 2.0 * FRAC_PI_3).abs() < TOLERANCE);
}

#[test]
fn a_page_agrees_with_the_free_motion_and_keeps_the_energy() {
    for text in [
        PENDULUM,
        include_str!("../../../../../mechanisms/double_pendulum.toml"),
        include_str!("../../../../../mechanisms/cart_pole.toml"),
    ] {
        let mut session = open(text);
        let before = variable(&session, "energy.total");
        play(&mut session, 1.0);
        let (mechanism, _) = Mechanism::parse(&Source::new("a.toml", text)).expect("it is right");
        let path = Path::new(&mechanism);
        let mut solver = Solver::assembled(mechanism.into(), &path).expect("it closes");
        let mut motion = FreeMotion::new(&solver, 1e-10).expect("a tolerance");
        let motion = motion.as_mut().expect("it has freedoms");
        motion.start(&mut solver, &Still).expect("it has inertia");
        let mut solution = Solution::new(&solver);
        let flown = motion.advance(&mut solver, &mut solution, &Still, 1.0);
        flown.expect("nothing stops it");
        for (page, free) in session.pose().q.iter().zip(&solver.pose().q) {
            assert!((page - free).abs() < TOLERANCE, "{page} {free}");
        }
        // The cart has a damper.
        if session.mechanism().forces.is_empty() {
            let after = variable(&session, "energy.total");
            assert!((after - before).abs() < TOLERANCE, "{before} {after}");
        }
    }
}

// At rest the spring's moment is that of the weight, k (hand − tip) × r = m g a sin θ; the tip is
// between its place without the hand and the hand. All energy gained is work.
#[test]
fn a_hand_pulls_by_a_spring() {
    let hanging = PENDULUM
        .replace("\"120*deg\"", "0")
        .replace("30*deg", "-90*deg");
    assert_ne!(hanging, PENDULUM);
    let mut session = open(&hanging);
    let before = variable(&session, "energy.total");
    let hand = [0.2, -0.4];
    assert_eq!(
        session.hold(ROD, [LENGTH / 2.0, 0.0], hand),
        Outcome::Reached
    );
    let stiffness = session.spring.as_ref().map(|spring| spring.stiffness);
    let stiffness = stiffness.expect("the hand holds the rod");
    for time in [0.1, 0.5, 6.0] {
        play(&mut session, time);
        let motion = session.motion.free().expect("it swings");
        let error = motion.energy_error();
        assert!(error.abs() < TOLERANCE, "{error}");
    }
    let [x, y] = tip(&session);
    let moment = stiffness * (x * (hand[1] - y) - y * (hand[0] - x));
    let weight = 1.2 * GRAVITY * 0.5 * x;
    assert!((moment - weight).abs() < 1e-6, "{moment} {weight}");
    assert!(x > 0.1 && x < LENGTH * hand[0] / f64::hypot(hand[0], hand[1]));
    let gained = variable(&session, "energy.total") - before;
    assert!((gained - 1.2 * GRAVITY * 0.5 * (y + LENGTH)).abs() < 1e-6);
    // The effort of a freedom is zero, with the spring as a force among others.
    let effort = session.motion.solution.force(ForceQuantity::Effort(SWING));
    assert!(effort.abs() < 1e-9, "{effort}");
    let mut frame = Vec::new();
    session.write_frame(&mut frame);
    let at = session.layout()["spring"].as_u64().expect("a place") as usize;
    assert_eq!(frame[at + 2..at + 4], session.picture.place(hand));
    session.let_go();
    session.write_frame(&mut frame);
    assert!(frame[at].is_nan());
    // Without the hand it swings back, and keeps its energy.
    let held = variable(&session, "energy.total");
    play(&mut session, 6.3);
    assert!(tip(&session)[0] < 0.5 * x);
    assert!((variable(&session, "energy.total") - held).abs() < TOLERANCE);
}

// A body on the spring oscillates at about 2 Hz, whatever its mass and size; gravity aside.
#[test]
fn the_spring_fits_the_mass() {
    for mass in ["1e-3", "1e3"] {
        let weightless = PENDULUM.replace("stop = 4.0", "stop = 4.0\ngravity = [0, 0]");
        let text = weightless.replace("value = 1.2", &format!("value = {mass}"));
        let mut session = open(&text);
        let [x, y] = tip(&session);
        let aside = [x + 0.02 * y, y - 0.02 * x];
        assert_eq!(
            session.hold(ROD, [LENGTH / 2.0, 0.0], aside),
            Outcome::Reached
        );
        // 1 − exp(−ζ ω t) (…) of a damped oscillator is 0.98 after 0.26 s at 2 Hz and ζ = 0.7.
        play(&mut session, 0.26);
        let [u, v] = tip(&session);
        let way = f64::hypot(u - x, v - y) / (0.02 * LENGTH);
        assert!((way - 0.98).abs() < 0.05, "{mass}: {way}");
    }
}

#[test]
fn a_reset_returns_to_the_same_bits() {
    for text in [PENDULUM, FOUR_BAR] {
        let mut session = open(text);
        let home = bits(&session);
        play(&mut session, 0.7);
        let there = bits(&session);
        session.hold(ROD, [0.05, 0.0], [0.3, 0.2]);
        play(&mut session, 1.1);
        session.let_go();
        session.drive(SWING, 0.5);
        play(&mut session, 1.5);
        session.reset();
        assert_eq!(bits(&session), home);
        play(&mut session, 0.7);
        assert_eq!(bits(&session), there);
        session.keep();
        play(&mut session, 0.9);
        let on = bits(&session);
        assert!(session.undo());
        assert_eq!(bits(&session), there);
        play(&mut session, 0.9);
        assert_eq!(bits(&session), on);
    }
}

#[test]
fn time_goes_back_to_where_the_motion_was_let_go() {
    let mut session = open(PENDULUM);
    play(&mut session, 0.5);
    let there = session.driver(SWING);
    play(&mut session, 1.0);
    assert_eq!(session.go_to(0.5), Outcome::Reached);
    assert!((session.driver(SWING).value - there.value).abs() < TOLERANCE);
    assert_eq!(session.drive(SWING, 0.3), Outcome::Reached);
    assert!(session.driver(SWING).first().abs() <= 0.0);
    let slope = 1.5 * GRAVITY / LENGTH * f64::sin(0.3);
    assert!((session.driver(SWING).second() + slope).abs() < 1e-12);
    play(&mut session, 0.8);
    let Outcome::Stopped(obstacle) = session.go_to(0.2) else {
        panic!("the hand was there at 0.5 s");
    };
    assert_eq!(obstacle.message, "the motion was let go at t = 0.5 s");
    assert!((session.pose().time - 0.5).abs() <= 0.0);
}

#[test]
fn a_body_that_is_dragged_is_let_go_from_rest() {
    let mut session = open(PENDULUM);
    play(&mut session, 0.2);
    let outcome = session.drag(ROD, [LENGTH / 2.0, 0.0], [0.4, 0.0]);
    assert_eq!(outcome, Outcome::Reached);
    let now = session.driver(SWING);
    assert!((now.value - FRAC_PI_2).abs() < 1e-9 && now.first() == 0.0);
    assert!((now.second() + 1.5 * GRAVITY / LENGTH).abs() < 1e-9);
    session.set_speed(SWING, 2.0, 0.0);
    assert!((session.driver(SWING).first() - 2.0).abs() <= 0.0);
}

/// Returns the four-bar with the rocker's angle as its freedom, at the same start.
fn rocker_is_free() -> String {
    let crank = open(FOUR_BAR);
    let [rocker, omega] = ["rocker.phi", "rocker.omega"].map(|name| variable(&crank, name));
    let freedom = r#"crank_angle = { coordinate = "angle", markers = ["ground.O2", "crank.O"], start = "60*deg", velocity = 12 }"#;
    assert!(FOUR_BAR.contains(freedom));
    let other = format!(
        r#"rocker_angle = {{ coordinate = "angle", markers = ["ground.O4", "rocker.O"], start = {rocker}, velocity = {omega} }}"#
    );
    FOUR_BAR.replace(freedom, &other)
}

// The rocker's angle has dead points, past which the motion goes on in another coordinate: the page
// shows the file's own all the time, and may be paused, held, drawn and saved there.
#[test]
fn a_motion_in_other_coordinates_is_shown_in_the_files_own() {
    let mut session = open(&rocker_is_free());
    let mut crank = open(FOUR_BAR);
    let mut exchanged = 0;
    for k in 1..=40 {
        let time = 0.02 * f64::from(k);
        play(&mut session, time);
        play(&mut crank, time);
        let off = session.driver(SWING).value - variable(&crank, "rocker.phi");
        assert!(wrapped(off).abs() < 100.0 * TOLERANCE, "{time}: {off}");
        let is_exchanged = session.motion.solver.mechanism().drivers[0].coordinate
            != session.mechanism().drivers[0].coordinate;
        if is_exchanged {
            exchanged += 1;
            if exchanged == 3 {
                let before = bits(&session);
                session.redraw(false);
                session.chart(Over::Time, &[0], 20);
                assert_eq!(bits(&session), before);
                let again = open(&session.text().expect("the file was read"));
                for (a, b) in again.pose().q.iter().zip(&session.pose().q) {
                    assert!(wrapped(a - b).abs() < 1e-6, "{a} {b}");
                }
            }
        }
    }
    assert!(exchanged > 5, "{exchanged}");
    // The hand holds and throws it on.
    for k in 0..60 {
        let hand = [0.4 + 0.2 * f64::from(k % 7), 0.3];
        session.hold(BodyId(2), [0.3, 0.0], hand);
        let until = session.pose().time + 0.02;
        play(&mut session, until);
        let motion = session.motion.free().expect("it moves");
        let error = motion.energy_error();
        assert!(error.abs() < 100.0 * TOLERANCE, "{error}");
    }
    session.let_go();
    assert!(variable(&session, "energy.kinetic") > 0.0);
    assert_eq!(session.drive(SWING, 2.5), Outcome::Reached);
    assert!(wrapped(variable(&session, "rocker.phi") - 2.5).abs() < 1e-9);
}

#[test]
fn driven_coordinates_follow_their_motions() {
    let mut session = open(SWINGING_TIP);
    play(&mut session, 0.9);
    let crank = session.driver(DriverId(0));
    assert!((crank.value - 0.6 * f64::sin(3.6)).abs() < 1e-12);
    assert!((crank.first() - 2.4 * f64::cos(3.6)).abs() < 1e-12);
    // As an input it moves at the speed that the reader sets.
    let text = SWINGING_TIP.replace("motion = \"sway*sin(frequency*t)\"", "start = 0");
    let mut session = open(&text);
    session.set_speed(DriverId(0), 1.5, -1.0);
    play(&mut session, 0.5);
    let crank = session.driver(DriverId(0));
    assert!((crank.value - (0.75 - 0.125)).abs() < 1e-12);
    assert!((crank.first() - 1.0).abs() < 1e-12);
}

// The power of the motor is all that is added, and the damper takes a part of it away.
#[test]
fn a_motor_has_the_torque_that_the_reader_sets() {
    let mut session = open(FOUR_BAR);
    let free = variable(&session, "crank_angle.acceleration");
    session.set_load(0, 3.0);
    let driven = variable(&session, "crank_angle.acceleration");
    let motion = session.motion.free().expect("it moves");
    let torque = motion.inertia()[(0, 0)] * (driven - free);
    assert!((torque - 3.0).abs() < 1e-9, "{torque}");
    play(&mut session, 0.5);
    let motion = session.motion.free().expect("it moves");
    assert!(motion.energy_error().abs() < 10.0 * TOLERANCE);
}

#[test]
fn a_freedom_without_inertia_is_told_and_the_page_stays() {
    let text = PENDULUM.replace(
        "inertia = \"mass*length^2/12\"",
        "center = [\"-length/2\", 0]",
    );
    assert_ne!(text, PENDULUM);
    let mut session = open(&text);
    let Outcome::Stopped(obstacle) = session.go_to(0.1) else {
        panic!("nothing says how it moves");
    };
    assert!(
        obstacle.message.contains("no body with a mass moves along"),
        "{}",
        obstacle.message
    );
    assert_eq!(session.drive(SWING, 0.4), Outcome::Reached);
    let held = session.hold(ROD, [0.1, 0.0], [0.3, 0.3]);
    assert!(matches!(held, Outcome::Refused(_)), "{held:?}");
}

#[test]
fn a_chart_shows_the_motion_to_come_and_leaves_the_present_one() {
    let mut session = open(PENDULUM);
    let energies = session.description()["energies"].clone();
    let places: Vec<usize> = energies
        .as_array()
        .expect("it has mass")
        .iter()
        .map(|place| place.as_u64().expect("a place") as usize)
        .collect();
    play(&mut session, 0.5);
    let before = bits(&session);
    let chart = session.chart(Over::Time, &places, 41);
    assert_eq!(bits(&session), before);
    assert_eq!(chart["x"][0], 0.0);
    assert_eq!(chart["x"][40], 4.0);
    let value = |row: usize, k: usize| chart["y"][row][k].as_f64().expect("a number");
    for k in 0..41 {
        let sum = value(0, k) + value(1, k);
        assert!((sum - value(2, k)).abs() < 1e-12);
        assert!((sum - value(2, 0)).abs() < TOLERANCE);
    }
    // Beyond its time the chart begins at the present.
    play(&mut session, 4.5);
    assert_eq!(
        session.chart(Over::Time, &places, 3)["x"],
        json!([4.5, 6.5, 8.5])
    );
}

#[test]
fn a_host_holds_and_lets_go() {
    let mut host = Host::default();
    let mut ask = |request: Value| host.answer(&request.to_string());
    ask(json!({ "do": "open", "name": "a.toml", "text": PENDULUM, "files": [] }));
    let hold = json!({ "do": "hold", "body": 0, "grip": [0.1, 0], "at": [30, 40] });
    assert_eq!(ask(hold.clone())["outcome"], "reached");
    assert_eq!(
        ask(json!({ "do": "time", "value": 0.1 }))["outcome"],
        "reached"
    );
    assert!(ask(json!({ "do": "let_go" }))["error"].is_null());
    let driven = include_str!("../../../../../mechanisms/four_bar.toml");
    ask(json!({ "do": "open", "name": "a.toml", "text": driven, "files": [] }));
    assert_eq!(ask(hold)["message"], "nothing moves by forces");
}

// A body that falls by 1 m and is thrown back: v = √(2 g h), and the next impact 2 e v / g later.
#[test]
fn a_chart_tells_impacts() {
    let mut session = open(include_str!("../../../../../tests/page/ball.toml"));
    let chart = session.chart(Over::Time, &[], 10);
    let events = chart["events"].as_array().expect("a list");
    let fall = (2.0 / GRAVITY).sqrt();
    assert_eq!(events.len(), 2, "{events:?}");
    for (event, time) in events.iter().zip([fall, 2.0 * fall]) {
        let x = event["x"].as_f64().expect("a time");
        assert!((x - time).abs() < TOLERANCE, "{x} {time}");
        let text = event["text"].as_str().expect("a text");
        assert!(text.contains("impact at stop `bottom`"), "{text}");
    }
    // While it plays nothing is kept.
    session.go_to(0.6);
    let chart = session.chart(Over::Time, &[], 10);
    assert_eq!(chart["events"].as_array().map(Vec::len), Some(2));
}

/// A block that friction holds on a slope, beside an arm on a rod whose length can be set.
const SLOPE: &str = r#"
format = 1
name = "slope"
parameters.rod_length = { value = 1, unit = "m" }
ground.markers = { O = [0, 0, "-30*deg"], A = [0, 0], B = [1.5, 0] }
bodies.block = { markers = { P = [0, 0, "-30*deg"] }, mass = 1 }
bodies.arm = { markers = { A = [0, 0], B = [1, 0] }, mass = 1, inertia = 1, estimate = [0, 0, "40*deg"] }
joints.way = { type = "translational", markers = ["ground.O", "block.P"] }
joints.A = { type = "revolute", markers = ["ground.A", "arm.A"] }
joints.rod = { type = "link", markers = ["ground.B", "arm.B"], length = "rod_length" }
freedoms.slip = { coordinate = "x", markers = ["ground.O", "block.P"] }
friction.rub = { of = "slip", force = 20 }
"#;

#[test]
fn friction_still_holds_after_a_refused_parameter() {
    let mut session = open(SLOPE);
    play(&mut session, 0.1);
    let rod = parameter(&session, "rod_length");
    // The arm's end comes no nearer to B than 0.5 m.
    assert!(matches!(session.set(rod, 0.1, false), Outcome::Refused(_)));
    play(&mut session, 0.5);
    assert!(variable(&session, "slip.position").abs() < 1e-12);
}

// A slider that follows an input carries a pendulum: it moves as one that the hand moves.
#[test]
fn what_follows_an_input_carries_what_is_free() {
    let text = |driver: &str| {
        format!(
            r#"
            format = 1
            name = "carrier"
            [inputs]
            level = {{ start = 0.1 }}
            [ground.markers]
            O = [0, 0]
            [bodies.block]
            markers = {{ B = [0, 0] }}
            [bodies.rod]
            markers = {{ B = [0, 0] }}
            mass = 1
            inertia = 0.1
            center = [0, -0.5]
            [joints]
            guide = {{ type = "translational", markers = ["ground.O", "block.B"] }}
            hinge = {{ type = "revolute", markers = ["block.B", "rod.B"] }}
            [drivers]
            x = {{ coordinate = "x", markers = ["ground.O", "block.B"], {driver} }}
            [freedoms]
            swing = {{ coordinate = "angle", markers = ["block.B", "rod.B"], start = 0.3 }}
            "#
        )
    };
    let mut follower = open(&text("motion = \"2*level\""));
    let mut driven = open(&text("start = 0.2"));
    for (step, level) in [0.1, 0.4, 0.4, -0.2].into_iter().enumerate() {
        assert_eq!(follower.set_load(0, level), Outcome::Reached);
        assert_eq!(driven.drive(DriverId(0), 2.0 * level), Outcome::Reached);
        let time = 0.2 * (step + 1) as f64;
        assert_eq!(follower.go_to(time), Outcome::Reached);
        assert_eq!(driven.go_to(time), Outcome::Reached);
        let pairs = follower.pose().q.iter().zip(&driven.pose().q);
        for (found, truth) in pairs {
            assert!((found - truth).abs() < 1e-12, "{step}: {found} {truth}");
        }
    }
    assert!((follower.pose().q[0] + 0.4).abs() < 1e-15);
}

//! Moves by hand against closed forms.

mod files;
mod free;

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI, TAU};

use serde_json::{Value, json};

use super::outcome::Obstacle;
use super::{Host, Outcome, Session};
use biela::mechanism::{BodyId, DriverId, ParameterId, Source};

const FOUR_BAR: &str = include_str!("../../../../../mechanisms/four_bar.toml");
const FIVE_BAR: &str = include_str!("../../../../../mechanisms/five_bar_robot.toml");
const CRANK: f64 = 0.10;

fn open(text: &str) -> Session {
    Session::open(Source::new("test.toml", text)).expect("the mechanism assembles")
}

/// Returns an angle between -π and π.
fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

fn parameter(session: &Session, name: &str) -> ParameterId {
    let mut parameters = session.mechanism().parameters.iter();
    ParameterId(
        parameters
            .position(|p| p.name == name)
            .expect("it is there"),
    )
}

// A point of the crank at its end is nearest to a target where the crank points at it. Newton's
// method ends at rounding of the angle, which is 1e-15 per radian; 1e-12 leaves room for products.
#[test]
fn a_crank_points_at_the_hand() {
    for target in [
        [0.2, 0.1],
        [-0.3, 0.02],
        [0.01, -0.4],
        [0.05, 0.09],
        [-0.02, -0.03],
    ] {
        let mut session = open(FOUR_BAR);
        let outcome = session.drag(BodyId(0), [CRANK, 0.0], target);
        assert_eq!(outcome, Outcome::Reached);
        let off = session.pose().drivers[0] - f64::atan2(target[1], target[0]);
        assert!(wrapped(off).abs() < 1e-12, "{target:?}: {off}");
    }
}

// With a crank of 0.36 m the coupler is the shortest link (Grashof), so that the crank only rocks.
#[test]
fn a_stop_names_no_driver_that_the_file_does_not_have() {
    let (before, rest) = FOUR_BAR.split_once("[drivers]").expect("it has drivers");
    let (_, after) = rest.split_once("[measures]").expect("measures follow");
    let text = format!("{before}[measures]{after}");
    let mut session = open(&text.replace("value = 0.10", "value = 0.36"));
    let Outcome::Stopped(obstacle) = session.drive(DriverId(0), FRAC_PI_3 + PI) else {
        panic!("the crank cannot get there");
    };
    let end = "the mechanism cannot go on";
    assert!(obstacle.message.ends_with(end), "{}", obstacle.message);
}

// With two drivers a point in reach is reached: the residual is that of the linear systems.
#[test]
fn a_point_with_two_degrees_of_freedom_comes_to_the_hand() {
    let mut session = open(FIVE_BAR);
    let body = session
        .mechanism()
        .body_id("left_forearm")
        .expect("it is there");
    let grip = [0.35, 0.0];
    let q = &session.pose().q[3 * body.index()..];
    let tip = [q[0] + 0.35 * q[2].cos(), q[1] + 0.35 * q[2].sin()];
    let target = [tip[0] + 0.02, tip[1] - 0.015];
    assert_eq!(session.drag(body, grip, target), Outcome::Reached);
    let q = &session.pose().q[3 * body.index()..];
    let (sin, cos) = q[2].sin_cos();
    let point = [
        q[0] + cos * grip[0] - sin * grip[1],
        q[1] + sin * grip[0] + cos * grip[1],
    ];
    let off = f64::hypot(point[0] - target[0], point[1] - target[1]);
    assert!(off < 1e-12, "{off}");
}

#[test]
fn a_grip_is_the_same_point_of_the_body() {
    let session = open(FOUR_BAR);
    let [x, y] = session.grip(
        BodyId(0),
        [CRANK * FRAC_PI_3.cos(), CRANK * FRAC_PI_3.sin()],
    );
    assert!((x - CRANK).abs() < 1e-15 && y.abs() < 1e-15);
}

// The bolt is 0.03 m times the sine of the handle's angle from its middle place.
#[test]
fn a_bolt_stops_at_its_strike_plate() {
    let mut session = open(include_str!("../../../../../mechanisms/latch.toml"));
    let Outcome::Stopped(obstacle) = session.drive(DriverId(0), 1.0) else {
        panic!("the strike plate is in the way")
    };
    let start = "stop `strike` reached: throw = 0.020000000 m: the mechanism cannot go on, with \
                 `handle_angle` at 0.729727656 rad";
    assert!(obstacle.message.starts_with(start), "{}", obstacle.message);
    let [x, y] = obstacle.at.expect("it has a place");
    assert!((x - 0.08).abs() < 1e-14 && (y + 0.03).abs() < 1e-14);
    let angle = session.pose().drivers[0];
    assert!((angle - (2.0_f64 / 3.0).asin()).abs() < 1e-12);
    // A strike plate that moves into the bolt is refused with the same reason.
    let reach = parameter(&session, "reach");
    let Outcome::Refused(obstacle) = session.set(reach, 0.01, false) else {
        panic!("the bolt is in the way")
    };
    assert!(obstacle.message.starts_with("stop `strike` reached"));
    assert_eq!(session.drive(DriverId(0), 0.0), Outcome::Reached);
    assert_eq!(session.set(reach, 0.01, false), Outcome::Reached);
}

#[test]
fn a_rocker_that_drives_stops_at_its_dead_point() {
    let crank = r#"crank_angle = { coordinate = "angle", markers = ["ground.O2", "crank.O"], start = "60*deg" }"#;
    let rocker = r#"rocker_angle = { coordinate = "angle", markers = ["ground.O4", "rocker.O"], start = 2.143696809154905 }"#;
    assert!(FOUR_BAR.contains(crank));
    let mut session = open(&FOUR_BAR.replace(crank, rocker));
    // Crank and coupler in line: the law of cosines in the triangle with the base and the rocker.
    let limit = PI - f64::acos((0.16 + 0.09 - 0.35 * 0.35) / (2.0 * 0.4 * 0.3));
    let Outcome::Stopped(obstacle) = session.drive(DriverId(0), 0.3) else {
        panic!("the dead point stops it");
    };
    // A hand's move takes no time.
    let message = &obstacle.message;
    assert!(
        message.contains("dead point") && !message.contains("t = "),
        "{message}"
    );
    assert!(obstacle.at.is_some());
    assert!((session.pose().drivers[0] - limit).abs() < 1e-9);
    // The hand pulls on, then back.
    let stopped = session.drag(BodyId(2), [0.3, 0.0], [0.7, 0.0]);
    assert!(matches!(stopped, Outcome::Stopped(_)), "{stopped:?}");
    assert!((session.pose().drivers[0] - limit).abs() < 1e-9);
    let angle = limit + 0.2;
    let target = [0.4 + 0.3 * angle.cos(), 0.3 * angle.sin()];
    assert_eq!(
        session.drag(BodyId(2), [0.3, 0.0], target),
        Outcome::Reached
    );
    assert!((session.pose().drivers[0] - angle).abs() < 1e-9);
}

#[test]
fn a_parameter_that_opens_a_joint_is_refused() {
    let mut session = open(FOUR_BAR);
    let coupler = parameter(&session, "coupler_length");
    let before = session.pose().clone();
    let Outcome::Refused(obstacle) = session.set(coupler, 0.9, false) else {
        panic!("the loop does not close");
    };
    assert!(
        obstacle.message.contains("stays open by"),
        "{}",
        obstacle.message
    );
    assert_eq!(session.pose(), &before);
    let Outcome::Refused(obstacle) = session.set(coupler, 0.0, false) else {
        panic!("it is below its limit");
    };
    assert_eq!(obstacle.message, "`coupler_length` must be at least 1 mm");
    assert_eq!(session.set(coupler, 0.27, false), Outcome::Reached);
}

#[test]
fn undo_and_redo_return_to_the_same_bits() {
    let mut session = open(FOUR_BAR);
    let home = session.pose().clone();
    session.keep();
    session.drive(DriverId(0), 2.0);
    let there = session.pose().clone();
    assert!(session.undo());
    assert_eq!(session.pose(), &home);
    assert!(session.redo());
    assert_eq!(session.pose(), &there);
    session.reset();
    assert_eq!(session.pose(), &home);
}

#[test]
fn another_position_is_the_mirror_image() {
    let mut session = open(FOUR_BAR);
    let found = session.assemblies();
    assert_eq!(found["pictures"].as_array().map(Vec::len), Some(1));
    let rocker = session.pose().q[8];
    assert_eq!(session.choose(0), Outcome::Reached);
    // About the line from A to O4.
    let [x, y] = [CRANK * FRAC_PI_3.cos(), CRANK * FRAC_PI_3.sin()];
    let line = f64::atan2(y, x - 0.4);
    let off = session.pose().q[8] - (2.0 * line - rocker);
    assert!(wrapped(off).abs() < 1e-12, "{off}");
    assert!(session.undo());
    assert_eq!(session.pose().q[8].to_bits(), rocker.to_bits());
}

#[test]
fn a_saved_file_assembles_at_the_pose() {
    let mut session = open(FOUR_BAR);
    session.set(parameter(&session, "base"), 0.38, false);
    session.drive(DriverId(0), 2.5);
    let text = session.text().expect("the file was read");
    let again = open(&text);
    let pairs = again.pose().q.iter().zip(&session.pose().q);
    for (a, b) in pairs {
        assert!((a - b).abs() < 1e-14, "{a} {b}");
    }
    let base = text
        .lines()
        .find(|line| line.starts_with("base"))
        .expect("it stays");
    assert!(
        base.starts_with("base           = { value = 0.38, unit"),
        "{base}"
    );
    let written = session.text_with_parameters().expect("the file was read");
    let changed = written
        .lines()
        .zip(FOUR_BAR.lines())
        .filter(|(a, b)| a != b);
    assert_eq!(changed.count(), 1);
}

#[test]
fn values_keep_their_units() {
    let text = FOUR_BAR.replace(
        "base           = { value = 0.40,",
        "base = { value = \"40 * cm\",",
    );
    assert_ne!(text, FOUR_BAR);
    let mut session = open(&text);
    session.set(parameter(&session, "base"), 0.3825, false);
    session.drive(DriverId(0), 81.3_f64.to_radians());
    let text = session.text().expect("the file was read");
    assert!(text.contains("value = \"38.25*cm\","), "{text}");
    assert!(text.contains("start = \"81.3*deg\""), "{text}");
    // Digits that no unit rounds stay.
    session.set(parameter(&session, "base"), 0.4 + 1e-15, false);
    let text = session.text_with_parameters().expect("the file was read");
    let again = open(&text);
    let base = parameter(&again, "base");
    let [set, read] = [&session, &again].map(|s| s.pose().parameters[base.index()]);
    assert!((set - read).abs() <= 4.0 * f64::EPSILON * 0.4, "{text}");
}

#[test]
fn numbers_without_units_have_the_digits_that_they_need() {
    let text = FOUR_BAR.replace("start = \"60*deg\"", "start = 1, max = \"60*deg\"");
    assert_ne!(text, FOUR_BAR);
    let mut session = open(&text);
    // 0.7999999999999999
    session.drive(DriverId(0), 0.1 + 0.7);
    let text = session.text().expect("the file was read");
    assert!(text.contains("start = 0.8,"), "{text}");
    // Twelve digits of the stop would be beyond it.
    session.drive(DriverId(0), FRAC_PI_3);
    let text = session.text().expect("the file was read");
    let start = format!("start = {FRAC_PI_3},");
    assert!(text.contains(&start), "{text}");
}

#[test]
fn time_runs_both_ways() {
    let text = FOUR_BAR.replace("start = \"60*deg\"", "motion = \"60*deg + 2*t\"");
    let mut session = open(&text);
    assert_eq!(session.go_to(1.5), Outcome::Reached);
    let there = session.pose().q.clone();
    assert_eq!(session.go_to(0.25), Outcome::Reached);
    assert!((session.pose().q[2] - (FRAC_PI_3 + 0.5)).abs() < 1e-12);
    assert_eq!(session.go_to(1.5), Outcome::Reached);
    for (a, b) in session.pose().q.iter().zip(&there) {
        assert!((a - b).abs() < 1e-12);
    }
    // The hand turns time.
    let angle = FRAC_PI_3 + 1.0;
    let target = [2.0 * CRANK * angle.cos(), 2.0 * CRANK * angle.sin()];
    assert_eq!(
        session.drag(BodyId(0), [CRANK, 0.0], target),
        Outcome::Reached
    );
    assert!((session.pose().time - 0.5).abs() < 1e-9);
}

#[test]
fn requests_are_answered_and_nonsense_is_refused() {
    let mut host = Host::default();
    let mut ask = |request: Value| host.answer(&request.to_string());
    assert!(ask(json!({ "do": "drive", "driver": 0, "value": 1.0 }))["error"].is_string());
    let open = json!({ "do": "open", "name": "a.toml", "text": FOUR_BAR, "files": [] });
    assert_eq!(ask(open)["page"]["name"], "four_bar");
    let wrong = json!({ "do": "open", "name": "a.toml", "text": "x", "files": [] });
    assert!(ask(wrong)["problems"][0].is_string());
    for (request, key) in [
        (
            json!({ "do": "drive", "driver": 0, "value": 1.5 }),
            "outcome",
        ),
        (
            json!({ "do": "drive", "driver": 7, "value": 1.5 }),
            "outcome",
        ),
        (
            json!({ "do": "set", "parameter": 99, "value": 1.5 }),
            "outcome",
        ),
        (
            json!({ "do": "drag", "body": 0, "grip": [0, 0], "at": [1, 2] }),
            "outcome",
        ),
        (
            json!({ "do": "drag", "body": 99, "grip": [0, 0], "at": [1, 2] }),
            "error",
        ),
        (json!({ "do": "drag", "body": 0 }), "error"),
        (json!({ "do": "choose", "index": 3 }), "outcome"),
        (
            json!({ "do": "chart", "variables": [0, 999], "samples": 3 }),
            "x",
        ),
        (json!({ "do": "trace", "body": 99, "grip": [0, 0] }), "done"),
        (json!({ "do": "path", "driver": 0, "samples": 5 }), "points"),
        (json!({ "do": "path", "driver": 0 }), "error"),
        (
            json!({ "do": "poses", "driver": 99, "samples": 5 }),
            "poses",
        ),
        (json!({ "do": "fly" }), "error"),
        (json!({ "do": "diagram", "scale": 2 }), "error"),
        (
            json!({ "do": "drive", "driver": 0, "value": 1.5, "anew": true }),
            "error",
        ),
        (json!([]), "error"),
    ] {
        assert!(!ask(request.clone())[key].is_null(), "{request}");
    }
    assert!(host.answer("{")["error"].is_string());
}

#[test]
fn the_frame_has_the_places_that_the_layout_says() {
    let mut session = open(FOUR_BAR);
    let layout = session.layout();
    let mut frame = Vec::new();
    session.write_frame(&mut frame);
    let place = |key: &str| layout[key].as_u64().map_or(0, |at| at as usize);
    assert!((frame[place("drivers")] - FRAC_PI_3).abs() < 1e-15);
    assert!((frame[place("parameters") + 3] - 0.4).abs() < 1e-15);
    assert_eq!(frame.len(), place("points") + 4 * session.picture.points());
}

#[test]
fn a_chart_over_the_crank_is_periodic_and_leaves_the_pose() {
    let mut session = open(FOUR_BAR);
    let before = session.pose().clone();
    let rocker = session.outputs.iter().position(|q| q.name == "rocker.phi");
    let over = super::Over::Driver(DriverId(0));
    let chart = session.chart(over, &[rocker.expect("it is there")], 61);
    let y = chart["y"][0].as_array().expect("a list");
    assert_eq!(y.len(), 61);
    let at = |k: usize| y[k].as_f64().expect("a number");
    assert!((at(0) - at(60)).abs() < 1e-12);
    assert_eq!(session.pose(), &before);
}

// The crank's end goes round on a circle of 100 mm, at 0.1 m · ω: to rounding.
#[test]
fn a_traced_point_has_its_path_and_its_speed() {
    let mut session = open(FOUR_BAR);
    let before = session.pose().clone();
    let over = super::Over::Driver(DriverId(0));
    assert_eq!(session.path(over, 61), json!([]));
    session.trace(Some((BodyId(0), [0.1, 0.0])));
    let path = session.path(over, 61);
    let points = path.as_array().expect("a list");
    assert_eq!(points.len(), 61);
    let scale = session.picture.scale();
    let center = session.picture.place([0.0; 2]);
    for point in points {
        let [x, y] = [0, 1].map(|k| point[k].as_f64().expect("a number") - center[k]);
        assert!((f64::hypot(x, y) - 0.1 * scale).abs() < 1e-12 * scale);
    }
    session.set_speed(DriverId(0), 3.0, 0.0);
    let at = session.layout()["traced"].as_u64().expect("a place") as usize;
    let mut frame = Vec::new();
    session.write_frame(&mut frame);
    let (sin, cos) = FRAC_PI_3.sin_cos();
    for (value, expected) in frame[at..]
        .iter()
        .zip([0.1 * cos, 0.1 * sin, -0.3 * sin, 0.3 * cos])
    {
        assert!((value - expected).abs() < 1e-14);
    }
    assert_eq!(session.pose(), &before);
    session.trace(None);
    session.write_frame(&mut frame);
    assert!(frame[at..at + 4].iter().all(|value| value.is_nan()));
}

#[test]
fn poses_over_each_other_are_those_of_the_driver() {
    let mut session = open(FOUR_BAR);
    let before = session.pose().clone();
    let layout = session.layout();
    let mut frame = Vec::new();
    let poses = session.poses(super::Over::Driver(DriverId(0)), 5);
    let poses: Vec<Vec<f64>> = serde_json::from_value(poses).expect("lists of numbers");
    assert_eq!(session.pose(), &before);
    assert_eq!(poses.len(), 5);
    let places = |key: &str| layout[key].as_u64().map_or(0, |at| at as usize);
    for (quarter, pose) in poses.iter().enumerate() {
        let angle = FRAC_PI_2 * quarter as f64;
        assert_eq!(session.drive(DriverId(0), angle), Outcome::Reached);
        session.write_frame(&mut frame);
        let shown = &frame[places("attachments")..places("points")];
        assert_eq!(shown.len(), pose.len());
        let scale = session.picture.scale();
        for (a, b) in shown.iter().zip(pose) {
            // A turn of the crank by way of other poses.
            assert!((a - b).rem_euclid(360.0).min((b - a).rem_euclid(360.0)) < 1e-9 * scale);
        }
    }
}

// The powers of driver and load add up to zero: effort + Fx dx/dφ + Fy dy/dφ + torque = 0, at
// (x, y) = (l cos φ, l sin φ). Numbers of the size 10: to 1e-13.
#[test]
fn a_load_is_felt_by_the_driver() {
    let mut session = open(
        r#"
        format = 1
        name = "arm"
        [ground.markers]
        O = [0, 0]
        [bodies.arm]
        markers = { O = [0, 0], P = [0.5, 0] }
        [joints]
        O = { type = "revolute", markers = ["ground.O", "arm.O"] }
        [forces]
        load = { marker = "arm.P" }
        [drivers]
        angle = { coordinate = "angle", markers = ["ground.O", "arm.O"], start = 0.3 }
        "#,
    );
    let loads = [7.0, -11.0, 0.5];
    for (input, size) in loads.into_iter().enumerate() {
        session.set_load(input, size);
    }
    let effort = |session: &Session| {
        let is_effort = |output: &&biela::kinematics::Output| output.name == "angle.effort";
        let output = session.outputs.iter().find(is_effort);
        session.value(output.expect("it has dynamics"))
    };
    let (sin, cos) = 0.3_f64.sin_cos();
    let expected = 0.5 * (loads[0] * sin - loads[1] * cos) - loads[2];
    assert!((effort(&session) - expected).abs() < 1e-13);
    assert_eq!(session.description()["loads"][1]["value"], loads[1]);
    session.reset();
    assert!(effort(&session).abs() <= 0.0);
}

/// An arm on a rod whose length follows an input, and time.
const REACH: &str = r#"
format = 1
name = "reach"
[parameters]
gain = 2
[inputs]
level = { start = 0.4, max = 1.5 }
[ground.markers]
O = [0, 0]
D = [1, 0]
[bodies.arm]
markers = { O = [0, 0], P = [1, 0] }
estimate = [0, 0, 0.8]
[joints]
O = { type = "revolute", markers = ["ground.O", "arm.O"] }
[drivers]
rod = { coordinate = "distance", markers = ["ground.D", "arm.P"], motion = "gain*level + 0.1*t" }
"#;

/// Returns the angle at which the arm is for a length of the rod: a chord of the circle of radius 1.
fn arm_at(length: f64) -> f64 {
    2.0 * (0.5 * length).asin()
}

// The slider of an input moves what follows it, up to the dead point; time, parameters, undo and the
// file go from there.
#[test]
fn a_slider_of_an_input_moves_what_follows_it() {
    let mut session = open(REACH);
    let off = |session: &Session, length: f64| (session.pose().q[2] - arm_at(length)).abs();
    assert!(off(&session, 0.8) < 1e-12);
    assert_eq!(session.description()["loads"][0]["moves"], true);
    assert_eq!(session.description()["drivers"][0]["is_input"], false);
    session.keep();
    assert_eq!(session.set_load(0, 0.6), Outcome::Reached);
    assert!(off(&session, 1.2) < 1e-12);
    assert_eq!(session.go_to(0.5), Outcome::Reached);
    assert!(off(&session, 1.25) < 1e-12);
    assert_eq!(session.set_load(0, 0.5), Outcome::Reached);
    assert!(off(&session, 1.05) < 1e-12);
    assert!((session.motion.solution.driver_rates[0].first() - 0.1).abs() < 1e-15);
    let gain = parameter(&session, "gain");
    assert_eq!(session.set(gain, 3.0, false), Outcome::Reached);
    assert!(off(&session, 1.55) < 1e-12);
    assert_eq!(session.go_to(0.0), Outcome::Reached);
    assert!(off(&session, 1.5) < 1e-12);
    let text = session.text().expect("it was read");
    assert!(
        text.contains("level = { start = 0.5, max = 1.5 }"),
        "{text}"
    );
    assert!(off(&open(&text), 1.5) < 1e-12);
    // A length of 2 is the dead point, near which the length changes with the square of the angle.
    let Outcome::Stopped(obstacle) = session.set_load(0, 1.0) else {
        panic!("the arm does not reach as far");
    };
    assert!(obstacle.message.contains("`rod`"), "{}", obstacle.message);
    let level = session.load(0).expect("it is there");
    assert!((3.0 * level - 2.0).abs() < 1e-5, "{level}");
    assert!(off(&session, 3.0 * level) < 1e-7);
    assert!(session.undo());
    assert!(off(&session, 0.8) < 1e-12);
    assert_eq!(session.load(0), Some(0.4));
    assert_eq!(session.go_to(0.5), Outcome::Reached);
    assert!(off(&session, 0.85) < 1e-12);
    assert_eq!(
        session.set_load(0, f64::NAN),
        Outcome::Refused(Obstacle::new("the value is no finite number"))
    );
    session.reset();
    assert!(off(&session, 0.8) < 1e-12);
}

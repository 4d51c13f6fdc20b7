//! Corners of prescribed motions, at which velocities of drivers jump, against closed forms.

use biela::dynamics::EventKind;

use super::events::{assert_near, played};
use super::run::{Fed, Run};
use crate::common::parse;

const TOLERANCE: f64 = 1e-10;
const G: f64 = 9.81;

/// A ball on a table that moves, with the ball's height over ground or over the table as the freedom.
fn table(motion: &str, is_relative: bool, [start, velocity]: [f64; 2], restitution: f64) -> Run {
    let base = if is_relative { "table.S" } else { "ground.G" };
    let text = format!(
        r#"
format = 1
name = "table"
[ground.markers]
G = [0, 0, "90*deg"]
[bodies.table]
markers = {{ S = [0, 0, "90*deg"] }}
[bodies.ball]
mass = 2
markers = {{ S = [0, 0, "90*deg"] }}
[joints]
of_table = {{ type = "translational", markers = ["ground.G", "table.S"] }}
of_ball = {{ type = "translational", markers = ["ground.G", "ball.S"] }}
[drivers]
lift = {{ coordinate = "x", markers = ["ground.G", "table.S"], motion = "{motion}" }}
[freedoms]
height = {{ coordinate = "x", markers = ["{base}", "ball.S"], start = {start}, velocity = {velocity} }}
[stops]
plate = {{ coordinate = "x", markers = ["table.S", "ball.S"], min = 0, restitution = {restitution} }}
"#
    );
    Run::new(&parse(&text), TOLERANCE, Fed::default())
}

/// The table sinks at 1 m/s with the ball on it, and rises at 1 m/s from 0.1 s on: the ball is struck with
/// 2 m/s and leaves the table with 2 e, whatever the rows and the coordinate. Without a bounce it stays.
#[test]
fn a_table_that_turns_strikes_its_ball() {
    for (steps, is_relative) in [(1, false), (7, false), (10, false), (1, true), (9, true)] {
        for e in [0.0, 0.5] {
            let start = if is_relative { [0.0, 0.0] } else { [0.1, -1.0] };
            let mut run = table("abs(t - 0.1)", is_relative, start, e);
            let after = 0.05;
            let events = played(&mut run, 0.1 + after, steps);
            let EventKind::Impact { speed } = events[0].kind else {
                panic!("{events:?}");
            };
            assert_near(events[0].time, 0.1);
            assert_near(speed, 2.0);
            let above = 2.0 * e * after
                - if e > 0.0 {
                    0.5 * G * after * after
                } else {
                    0.0
                };
            let height = if is_relative { above } else { above + after };
            assert_near(run.state()[0], height);
            assert!(run.free.energy_error().abs() < 1e-9);
        }
    }
}

/// A table that rises and turns down lets the ball fly: a contact does not pull.
#[test]
fn a_table_that_turns_down_leaves_its_ball() {
    for (steps, is_relative) in [(1, false), (7, false), (10, false), (1, true)] {
        let start = if is_relative { [0.0, 0.0] } else { [-0.1, 1.0] };
        let mut run = table("-abs(t - 0.1)", is_relative, start, 0.5);
        let after = 0.05;
        let events = played(&mut run, 0.1 + after, steps);
        assert_eq!(events.len(), 1, "{events:?}");
        assert_eq!(events[0].kind, EventKind::Leaves);
        assert_near(events[0].time, 0.1);
        let flight = after - 0.5 * G * after * after;
        assert_near(
            run.state()[0],
            if is_relative { flight + after } else { flight },
        );
        assert!(run.free.energy_error().abs() < 1e-9);
    }
}

/// A bob of 1 kg hangs 0.5 m below a trolley that turns from −1 to 1 m/s. Nothing pushes the bob along its
/// way: it keeps −1 m/s, and swings by 2 m/s over 0.5 m.
#[test]
fn a_bob_keeps_its_velocity_where_its_trolley_turns() {
    let text = r#"
format = 1
name = "trolley"
[ground.markers]
G = [0, 0]
[bodies.trolley]
markers = { S = [0, 0] }
[bodies.bob]
mass = 1
center = [0, -0.5]
markers = { P = [0, 0] }
[joints]
rail = { type = "translational", markers = ["ground.G", "trolley.S"] }
pin = { type = "revolute", markers = ["trolley.S", "bob.P"] }
[drivers]
way = { coordinate = "x", markers = ["ground.G", "trolley.S"], motion = "abs(t - 0.3)" }
[freedoms]
swing = { coordinate = "angle", markers = ["ground.G", "bob.P"] }
"#;
    let mut run = Run::new(&parse(text), TOLERANCE, Fed::default());
    run.to(0.3 + 1e-9);
    let [values, velocities, _] = run.freedoms();
    // It has swung for a nanosecond, in which gravity changes the velocity by 1e-17.
    assert!(values[0].abs() < 1e-8, "{values:?}");
    assert_near(velocities[0], -2.0 / 0.5);
    run.to(2.0);
    assert!(run.free.energy_error().abs() < 1e-8);
}

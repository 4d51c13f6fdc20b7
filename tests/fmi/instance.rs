//! The slave between communication points and after a step that failed.

use std::f64::consts::{PI, TAU};

use crate::clauses::{running, started};
use crate::common::log::Heard;
use crate::common::{Instance, instance_of, parse, shipped};
use biela::fmi::{Category, Error, Failure, Interface, State, value_reference};

fn running_with(name: &str, heard: &Heard) -> Instance {
    started(heard.instance(shipped(name), Interface::CoSimulation, true))
}

/// Values of the outputs with these names.
fn read(instance: &mut Instance, names: &[&str]) -> Vec<f64> {
    let list = instance.variables();
    let references: Vec<u32> = names
        .iter()
        .map(|name| {
            let place = list.iter().position(|v| v.name == *name);
            value_reference(place.expect("an output"))
        })
        .collect();
    let mut values = vec![0.0; names.len()];
    instance
        .get_real(&references, &mut values)
        .expect("readable");
    values
}

/// Readings of a host in between do not show in the pose of a discarded step.
#[test]
fn a_discarded_step_leaves_pose_and_rates_of_the_last_communication_point() {
    let mut instance = running("tlv");
    for (step, length) in [0.36, 0.38, 0.41].into_iter().enumerate() {
        instance.set_real(&[1], &[length]).unwrap();
        instance.do_step(0.1 * step as f64, 0.1).unwrap();
    }
    let names = ["arm.phi", "arm.omega", "arm.alpha"];
    let before = read(&mut instance, &names);
    assert!(before[1] > 0.0);
    instance.set_real(&[1, 2], &[0.5, 7.0]).unwrap();
    assert_ne!(read(&mut instance, &names), before);
    instance.set_real(&[1], &[0.9]).unwrap();
    let error = instance.do_step(0.3, 0.1).expect_err("0.9 m is too long");
    assert!(matches!(error, Error::Model(Failure::Discarded(_))));
    assert_eq!(instance.state(), State::StepFailed);
    assert!(instance.is_terminated());
    assert_eq!(read(&mut instance, &names), before);
}

#[test]
fn a_step_that_would_never_end_is_discarded() {
    let mut instance = running("four_bar");
    instance.set_real(&[1], &[1e12]).unwrap();
    let error = instance.do_step(0.0, 0.1).expect_err("that is too far");
    assert!(error.to_string().contains("more sub-steps"), "{error}");
}

/// A millimetre per 1e-300 s has no finite square.
#[test]
fn a_step_far_too_short_is_no_singular_position() {
    let mut instance = running("tlv");
    for (step, length) in [0.36, 0.361].into_iter().enumerate() {
        instance.set_real(&[1], &[length]).unwrap();
        instance.do_step(1e-300 * step as f64, 1e-300).unwrap();
    }
    let variables = instance.variables();
    let alpha = variables.iter().position(|v| v.name == "arm.alpha");
    let alpha = value_reference(alpha.expect("an output"));
    let error = instance
        .get_real(&[alpha], &mut [0.0])
        .expect_err("endless");
    let message = error.to_string();
    assert!(
        message.contains("driver `side_length` is too fast"),
        "{message}"
    );
}

/// The side grows as 0.35 + 0.2 t, told with derivatives; it ends at 0.65 m, at t = 1.5 s. Each
/// value is off by a nanometre from where the polynomial before it ended.
#[test]
fn the_last_successful_time_of_a_moving_input_is_where_it_stopped() {
    let mut instance = running("tlv");
    for step in 0.. {
        let t = 0.4 * f64::from(step);
        let off = if step % 2 == 0 { 1e-9 } else { 0.0 };
        instance.set_real(&[1], &[0.35 + 0.2 * t + off]).unwrap();
        instance
            .set_real_input_derivatives(&[1], &[1], &[0.2])
            .unwrap();
        if instance.do_step(t, 0.4).is_err() {
            break;
        }
    }
    // A nanometre is 5e-9 s of travel; the dead point itself is met to about as much.
    assert!((instance.last_successful_time() - 1.5).abs() < 1e-7);
}

/// At 0.65 m arm and rod are in line.
#[test]
fn a_dead_point_is_told_with_driver_value_limit_and_bodies() {
    let heard = Heard::default();
    let mut instance = running_with("tlv", &heard);
    instance.set_real(&[1], &[0.7]).unwrap();
    instance.do_step(0.0, 0.1).expect_err("0.7 m is too long");
    assert_eq!(
        heard.take(Category::Warning),
        [
            "dead point, where body `arm` and body `rod` line up, after 0.8571 of the step from 0 s \
             over 0.1 s: driver `side_length` was asked for 0.700000000 m and cannot go beyond \
             0.650000000 m"
        ]
    );
}

/// Two wheels turn beside the arm, one by an input and one by a prescribed motion.
#[test]
fn a_dead_point_is_not_told_with_drivers_of_other_bodies() {
    let triangle = include_str!("../../mechanisms/tlv.toml");
    let wheels = r#"
        [bodies.fan]
        markers.O = [0, 0]
        [bodies.wheel]
        markers.O = [0, 0]
        [joints.fan_pin]
        type = "revolute"
        markers = ["ground.O", "fan.O"]
        [joints.wheel_pin]
        type = "revolute"
        markers = ["ground.O", "wheel.O"]
        [drivers.fan_angle]
        coordinate = "angle"
        markers = ["ground.O", "fan.O"]
        start = 0
        [drivers.wheel_angle]
        coordinate = "angle"
        markers = ["ground.O", "wheel.O"]
        motion = "3*t"
    "#;
    let heard = Heard::default();
    let mechanism = parse(&format!("{triangle}{wheels}"));
    let mut instance = started(heard.instance(mechanism, Interface::CoSimulation, true));
    // The side's length and the fan's angle.
    instance.set_real(&[1, 4], &[0.7, 2.0]).unwrap();
    instance.do_step(0.0, 0.1).expect_err("0.7 m is too long");
    let [message] = &heard.take(Category::Warning)[..] else {
        panic!("one warning")
    };
    assert!(
        message.ends_with(
            "driver `side_length` was asked for 0.700000000 m and cannot go beyond 0.650000000 m"
        ),
        "{message}"
    );
}

#[test]
fn an_approach_to_a_dead_point_is_warned_of_once() {
    let heard = Heard::default();
    let mut instance = running_with("tlv", &heard);
    let mut warned = Vec::new();
    // Twice to within a nanometre of the limit, and back.
    for (step, off) in [0.1, 1e-8, 1e-9, 1e-8, 1e-9, 0.1, 1e-9, 1e-8]
        .into_iter()
        .enumerate()
    {
        instance.set_real(&[1], &[0.65 - off]).unwrap();
        instance.do_step(step as f64, 1.0).unwrap();
        let messages = heard.take(Category::Warning);
        warned.push(messages.len());
        for message in messages {
            assert!(
                message.contains("near a singular position, with a reciprocal condition of")
                    && message.ends_with("body `arm` and body `rod` all but line up"),
                "{message}"
            );
        }
    }
    assert_eq!(warned, [0, 1, 0, 0, 0, 0, 1, 0]);
}

#[test]
fn a_change_point_is_an_event_not_a_warning() {
    let heard = Heard::default();
    let mut instance = running_with("parallelogram", &heard);
    heard.take(Category::Events);
    let start = PI / 3.0;
    let mut passed = 0;
    for step in 1..=500 {
        let angle = start + TAU * f64::from(step) / 500.0;
        instance.set_real(&[1], &[angle]).unwrap();
        instance.do_step(f64::from(step - 1), 1.0).unwrap();
        let [q] = read(&mut instance, &["follower.phi"])[..] else {
            panic!("one output was asked for")
        };
        assert!((q - angle).abs() < 1e-12);
        let all = heard.take_all();
        assert!(
            all.iter()
                .all(|message| message.category != Category::Warning)
        );
        for message in all
            .iter()
            .filter(|message| message.category == Category::Events)
        {
            let message = &message.text;
            assert!(
                message.contains(
                    " s: change point passed on the smooth motion, with driver `crank_angle` at "
                ) && message.ends_with("body `coupler` and body `follower` line up there"),
                "{message}"
            );
            passed += 1;
        }
    }
    assert_eq!(passed, 2);
}

/// References in a row are read from a table, others one by one: both give the same, whichever
/// bodies are outputs, and positions do not wait for rates.
#[test]
fn references_in_a_row_read_as_each_by_itself() {
    let text = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/mechanisms/four_bar.toml"
    ));
    let text = text.expect("it is shipped");
    for bodies in [
        None,
        Some("'crank'"),
        Some("'rocker', 'crank'"),
        Some("'coupler', 'rocker'"),
        Some("'rocker'"),
        Some(""),
    ] {
        let outputs = bodies.map_or(String::new(), |list| format!("bodies = [{list}]\n"));
        let text = text.replace("[outputs]\n", &format!("[outputs]\n{outputs}"));
        let mut instance = started(instance_of(parse(&text), Interface::CoSimulation));
        let reals: Vec<_> = instance.variables().iter().zip(1_u32..).collect();
        let reals: Vec<_> = reals
            .into_iter()
            .filter(|(variable, _)| variable.kind.is_real())
            .map(|(variable, reference)| (variable.name.clone(), reference))
            .collect();
        for (name, by) in [("crank_angle.position", 0.3), ("crank_angle.velocity", 2.0)] {
            let input = reals
                .iter()
                .find(|(real, _)| real == name)
                .expect("it has it");
            let now = read(&mut instance, &[name])[0];
            instance
                .set_real(&[input.1], &[now + by])
                .expect("an input");
        }
        instance.do_step(0.0, 0.1).expect("the crank turns freely");
        for from in 0..reals.len() {
            for to in from + 1..=reals.len() {
                let row: Vec<_> = reals[from..to]
                    .iter()
                    .map(|(_, reference)| *reference)
                    .collect();
                let mut together = vec![0.0; row.len()];
                instance.get_real(&row, &mut together).expect("it stands");
                let reversed: Vec<_> = row.iter().rev().copied().collect();
                let mut apart = vec![0.0; row.len()];
                instance.get_real(&reversed, &mut apart).expect("it stands");
                apart.reverse();
                assert_eq!(together, apart, "{bodies:?}: {:?}", &reals[from..to]);
            }
        }
        // Whose they are, too.
        let rocker: Vec<_> = reals
            .iter()
            .filter(|(name, _)| name == "rocker.x")
            .collect();
        for (name, _) in rocker {
            assert_eq!(read(&mut instance, &[name]), [0.4], "{bodies:?}");
        }
    }
}

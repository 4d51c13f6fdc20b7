//! Intermediate update: inputs and outputs on the way of a step.

use std::f64::consts::PI;

use biela::fmi::{CoSimulation, Error, Failure, StepProgress};

use super::{CYLINDER, instance_of, new_instance, running, start, step_with};
use crate::clauses::{get, set, vr};
use crate::common::log::Heard;
use crate::common::shipped;

/// An agreement about intermediate update of these variables.
fn intermediate(name: &str, variables: &[&str], early_return_allowed: bool) -> CoSimulation {
    let any = instance_of(name, CoSimulation::default(), &Heard::default());
    CoSimulation {
        early_return_allowed,
        intermediate_update: true,
        required_intermediate_variables: variables.iter().map(|name| vr(&any, name)).collect(),
        ..CoSimulation::default()
    }
}

/// Inputs set at the end of a step hold there: no lag, and rates from the third point on.
#[test]
fn intermediate_inputs_bring_the_lag_to_zero() {
    let agreed = intermediate("pendulum", &["swing_angle.position", "rod.phi"], false);
    let mut instance = running("pendulum", agreed);
    let swing = |t: f64| 0.3 * t - 0.2 * t * t;
    set(&mut instance, [("swing_angle.position", swing(0.0))]);
    for n in 0..10 {
        let (time, h) = (0.1 * f64::from(n), 0.1);
        set(&mut instance, [("swing_angle.position", swing(time))]);
        let mut points = Vec::new();
        let outcome = step_with(&mut instance, time, h, |instance, time| {
            points.push(time);
            set(instance, [("swing_angle.position", swing(time))]);
            None
        });
        assert!(!outcome.early_return);
        assert_eq!(points.len(), 4);
        assert_eq!(points[3], time + h);
        let [phi, omega, alpha] = get(&mut instance, ["rod.phi", "rod.omega", "rod.alpha"]);
        let end = time + h;
        assert!((phi - (swing(end) - PI / 2.0)).abs() < 1e-14, "{phi}");
        if n > 0 {
            // The parabola through three points, whose steps of 25 ms bring rounding of 1e-16/h².
            assert!((omega - (0.3 - 0.4 * end)).abs() < 1e-12, "{omega}");
            assert!((alpha + 0.4).abs() < 1e-10, "{alpha}");
        }
    }
}

/// Inputs that nothing is set for are held: the path leads to them straight, and outputs on the
/// way belong to it.
#[test]
fn outputs_on_the_way_belong_to_the_path() {
    let agreed = intermediate("pendulum", &["swing_angle.position", "rod.phi"], false);
    let mut instance = running("pendulum", agreed);
    let [start] = get(&mut instance, ["rod.phi"]);
    let [from] = get(&mut instance, ["swing_angle.position"]);
    set(&mut instance, [("swing_angle.position", from + 0.4)]);
    step_with(&mut instance, 0.0, 1.0, |instance, time| {
        let [phi] = get(instance, ["rod.phi"]);
        assert!(
            (phi - (start + 0.4 * time)).abs() < 1e-14,
            "{phi} at {time}"
        );
        None
    });
    // Half the way is left when the host sets another value.
    step_with(&mut instance, 1.0, 1.0, |instance, time| {
        let [phi] = get(instance, ["rod.phi"]);
        let set_at_half = if time > 1.5 { 0.6 } else { 0.4 };
        assert!(
            (phi - (start + set_at_half)).abs() < 1e-14,
            "{phi} at {time}"
        );
        if time == 1.5 {
            set(instance, [("swing_angle.position", from + 0.6)]);
        }
        None
    });
}

/// 4.2.1.2: what the host may do in intermediate update.
#[test]
fn intermediate_update_allows_required_variables_only() {
    let agreed = intermediate("pendulum", &["swing_angle.position", "rod.phi"], false);
    let mut instance = running("pendulum", agreed);
    let [position, velocity, phi, x, length] = [
        "swing_angle.position",
        "swing_angle.velocity",
        "rod.phi",
        "rod.x",
        "length",
    ]
    .map(|name| vr(&instance, name));
    let mut point = 0;
    step_with(&mut instance, 0.0, 0.1, |instance, _| {
        point += 1;
        let mut value = [0.0];
        assert!(instance.get_real(&[phi], &mut value).is_ok());
        for other in [x, velocity, length] {
            let refused = instance.get_real(&[other], &mut value).unwrap_err();
            assert!(
                matches!(refused, Error::NotIntermediate { .. }),
                "{refused}"
            );
        }
        for other in [velocity, length] {
            let refused = instance.set_real(&[other], &[0.1]).unwrap_err();
            assert!(
                matches!(refused, Error::NotIntermediate { .. }),
                "{refused}"
            );
        }
        assert!(instance.set_real(&[phi], &[0.1]).is_err());
        assert!(instance.set_real(&[position], &[0.1]).is_ok());
        let refused = instance.get_real(&[phi], &mut value).unwrap_err();
        assert!(matches!(refused, Error::ReadAfterSet), "{refused}");
        assert!(instance.begin_step(0.0, 0.1).is_err());
        assert!(instance.fmu_state().is_err());
        None
    });
    assert_eq!(point, 4);
}

/// 4.2.1.2: the host asks for an early return, and outputs belong to the inputs at its time.
#[test]
fn the_host_asks_for_an_early_return() {
    let agreed = intermediate("pendulum", &["swing_angle.position"], true);
    for wish in [0.25, 0.3, 0.7, 1.0] {
        let mut instance = running("pendulum", agreed.clone());
        let [from] = get(&mut instance, ["swing_angle.position"]);
        let [start] = get(&mut instance, ["rod.phi"]);
        set(&mut instance, [("swing_angle.position", from + 0.4)]);
        let outcome = step_with(&mut instance, 0.0, 1.0, |_, _| Some(wish));
        assert_eq!(outcome.early_return, wish < 1.0);
        assert_eq!(outcome.last_successful_time, wish);
        assert!(!outcome.event_handling_needed && !outcome.terminate_simulation);
        let [phi] = get(&mut instance, ["rod.phi"]);
        assert!((phi - (start + 0.4)).abs() < 1e-14, "{phi}");
        step_with(&mut instance, wish, 0.5, |_, _| None);
    }
}

/// A dead point between two points of intermediate update leaves nothing of the step behind.
#[test]
fn a_discarded_step_takes_back_intermediate_inputs() {
    let agreed = intermediate(CYLINDER, &["side_length.position"], false);
    let mut instance = running(CYLINDER, agreed);
    set(&mut instance, [("side_length.position", 0.4)]);
    step_with(&mut instance, 0.0, 0.1, |_, _| None);
    let before = instance.fmu_state().unwrap();
    let mut progress = instance.begin_step(0.1, 0.1).unwrap();
    let error = loop {
        assert!(matches!(progress, StepProgress::Intermediate { .. }));
        set(&mut instance, [("side_length.position", 0.9)]);
        match instance.resume_step(None) {
            Ok(next) => progress = next,
            Err(error) => break error,
        }
    };
    assert!(
        matches!(error, Error::Model(Failure::Discarded(_))),
        "{error}"
    );
    assert_eq!(instance.fmu_state().unwrap(), before);
    step_with(&mut instance, 0.1, 0.1, |_, _| None);
}

/// "The FMU is in the same state as before the call" (3.0.2, 2.2.4), the sources of rates included.
#[test]
fn a_discarded_step_with_intermediate_update_leaves_the_state_as_it_was() {
    let variables = ["side_length.acceleration"];
    let mut instance = start(
        new_instance(shipped(CYLINDER), &Heard::default()),
        intermediate(CYLINDER, &variables, false),
    );
    let values = [
        ("side_length.position", 0.9),
        ("side_length.acceleration", 1.0),
    ];
    set(&mut instance, values);
    let before = instance.fmu_state().expect("legal");
    let mut progress = instance.begin_step(0.0, 1.0);
    while let Ok(StepProgress::Intermediate { .. }) = progress {
        progress = instance.resume_step(None);
    }
    let error = progress.expect_err("the cylinder is too short");
    assert!(matches!(error, Error::Model(Failure::Discarded(_))));
    assert_eq!(instance.fmu_state().as_ref(), Ok(&before));
}

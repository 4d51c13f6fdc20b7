//! Going on from a state: all is as it was, to the last bit.

use biela::fmi::{Causality, Error, Failure, Interface, Quantity, State, StateError};
use biela::mechanism::Order;

use crate::common::{FmuState, Instance, co_simulation, instance_of, references};
use crate::fmu_state::{act, go_on, initialized, look, mechanisms};

/// The state as another instance reads it.
fn through_bytes(from: &Instance, to: &mut Instance, state: &FmuState) -> FmuState {
    let bytes = from
        .serialize_fmu_state(state)
        .expect("it is the same mechanism");
    to.deserialize_fmu_state(&bytes)
        .expect("nothing was done to it")
}

/// From a state on everything is as it was, to the last bit: in the instance itself, after the
/// state has gone through bytes, and in another instance that had been elsewhere.
fn assert_replays(name: &str, instance: &mut Instance, from: u32) {
    let state = instance.fmu_state().expect("allowed in this state");
    let first = (look(instance), go_on(instance, from));
    instance.set_fmu_state(&state).expect("it is its own");
    assert_eq!(instance.fmu_state().as_ref(), Ok(&state), "{name}");
    assert_eq!((look(instance), go_on(instance, from)), first, "{name}");

    let mut other = initialized(name, [3, 2]);
    go_on(&mut other, 0);
    let read = through_bytes(instance, &mut other, &state);
    assert_eq!(read, state, "{name}");
    other
        .set_fmu_state(&read)
        .expect("the mechanism is the same");
    assert_eq!((look(&mut other), go_on(&mut other, from)), first, "{name}");
}

#[test]
fn from_a_state_on_everything_is_as_it_was() {
    for name in mechanisms() {
        for settings in [[1, 1], [3, 2]] {
            let mut instance = initialized(&name, settings);
            for step in 0..7 {
                assert_eq!(act(&mut instance, step).outcome, Ok(()), "{name}");
            }
            assert_replays(&name, &mut instance, 7);
        }
    }
}

/// Getting a state changes nothing, and every state replays the run: each step is taken without a
/// state, after getting one, and from one in another instance that had been elsewhere.
#[test]
fn getting_a_state_leaves_no_trace() {
    for name in mechanisms() {
        let mut straight = initialized(&name, [1, 1]);
        let mut watched = initialized(&name, [1, 1]);
        let mut other = initialized(&name, [3, 2]);
        go_on(&mut other, 0);
        // All that the host does at every fourth step falls together with all at every fifth.
        for step in 0..20 {
            let state = watched.fmu_state().expect("allowed in this state");
            other
                .set_fmu_state(&state)
                .expect("it is the same mechanism");
            let expected = act(&mut straight, step);
            assert_eq!(act(&mut watched, step), expected, "{name}, step {step}");
            assert_eq!(
                act(&mut other, step),
                expected,
                "{name}, step {step}: restored"
            );
        }
    }
}

/// A reset instance goes on like a new one, wherever it has been.
#[test]
fn a_reset_instance_goes_on_like_a_new_one() {
    for name in mechanisms() {
        let mut new = co_simulation(&name);
        let mut used = initialized(&name, [1, 1]);
        for step in 0..12 {
            let _ = act(&mut used, step);
        }
        used.reset().expect("allowed in this state");
        for instance in [&mut new, &mut used] {
            instance.setup_experiment(0.0, Some(10.0)).expect("legal");
            instance.enter_initialization_mode().expect("legal");
            instance.exit_initialization_mode().expect("it starts");
        }
        for step in 0..20 {
            let expected = act(&mut new, step);
            assert_eq!(act(&mut used, step), expected, "{name}, step {step}");
        }
    }
}

/// A state can be got between setting and stepping, when outputs have been read ahead or not.
#[test]
fn what_was_set_since_the_last_step_is_part_of_the_state() {
    for read_ahead in [false, true] {
        let mut instance = initialized("four_bar", [1, 1]);
        for step in 0..3 {
            act(&mut instance, step);
        }
        instance.set_real(&[1, 2], &[1.3, 0.5]).unwrap();
        instance
            .set_real_input_derivatives(&[1], &[2], &[0.7])
            .unwrap();
        if read_ahead {
            look(&mut instance);
        }
        assert_replays("four_bar", &mut instance, 3);
    }
}

/// Tunable parameters count as they were set, and as far as the last step has taken them.
#[test]
fn tunable_parameters_are_part_of_the_state() {
    let mut instance = initialized("four_bar", [1, 1]);
    let tunable = (1..)
        .zip(instance.variables())
        .find(|(_, variable)| variable.name == "rocker_length")
        .map(|(reference, _)| reference)
        .expect("the four-bar has a rocker");
    instance.set_real(&[tunable], &[0.31]).unwrap();
    act(&mut instance, 0);
    instance.set_real(&[tunable], &[0.32]).unwrap();
    assert_replays("four_bar", &mut instance, 1);
}

fn fixed_parameter(instance: &Instance) -> u32 {
    (1..)
        .zip(instance.variables())
        .find(|(_, variable)| variable.causality == Causality::Parameter)
        .map(|(reference, _)| reference)
        .expect("it has a parameter")
}

/// Before and during initialization, too, and then with everything set so far.
#[test]
fn states_before_the_first_step() {
    type Prepare = fn(&mut Instance);
    let prepare: [Prepare; 4] = [
        |_| {},
        |instance| {
            let parameter = fixed_parameter(instance);
            instance.setup_experiment(2.0, Some(3.0)).unwrap();
            instance.set_real(&[1, parameter], &[0.7, 0.21]).unwrap();
        },
        |instance| {
            instance.enter_initialization_mode().unwrap();
            instance.set_real(&[1], &[0.9]).unwrap();
        },
        |instance| {
            instance.enter_initialization_mode().unwrap();
            instance.set_real(&[1], &[0.9]).unwrap();
            look(instance);
        },
    ];
    let start = |instance: &mut Instance| {
        let entered = instance.enter_initialization_mode();
        let before = look(instance);
        let left = instance.exit_initialization_mode();
        (entered, before, left, look(instance))
    };
    for prepare in prepare {
        let mut instance = co_simulation("four_bar");
        prepare(&mut instance);
        let state = instance.fmu_state().unwrap();
        let first = start(&mut instance);
        assert_eq!(first.2, Ok(()));
        go_on(&mut instance, 0);
        instance.set_fmu_state(&state).unwrap();
        assert_eq!(start(&mut instance), first);

        let mut other = initialized("four_bar", [2, 2]);
        let read = through_bytes(&instance, &mut other, &state);
        other.set_fmu_state(&read).unwrap();
        assert_eq!(start(&mut other), first);
    }
}

/// The length of the triangle's side that a step cannot reach.
const TOO_LONG: f64 = 0.9;

#[test]
fn a_host_goes_on_from_before_a_step_that_failed() {
    let mut straight = initialized("tlv", [1, 1]);
    let mut detour = initialized("tlv", [1, 1]);
    for instance in [&mut straight, &mut detour] {
        act(instance, 0);
        act(instance, 1);
    }
    let before = detour.fmu_state().unwrap();
    detour.set_real(&[1], &[TOO_LONG]).unwrap();
    let error = detour.do_step(0.2, 0.1).unwrap_err();
    assert!(matches!(error, Error::Model(Failure::Discarded(_))));
    assert_eq!(detour.state(), State::StepFailed);
    let failed = detour.fmu_state().unwrap();
    let at_failure = look(&mut detour);

    detour.set_fmu_state(&before).unwrap();
    assert_eq!(detour.state(), State::StepComplete);
    assert!(!detour.is_terminated());
    assert_eq!(go_on(&mut detour, 2), go_on(&mut straight, 2));

    // The failed state itself is one to be looked at, not to be left by a step.
    detour.set_fmu_state(&failed).unwrap();
    assert_eq!(look(&mut detour), at_failure);
    let refused = detour.do_step(0.2, 0.1).unwrap_err();
    assert!(matches!(refused, Error::State { .. }), "{refused}");
}

#[test]
fn a_host_goes_on_after_termination_and_a_failed_initialization() {
    let mut straight = initialized("tlv", [1, 1]);
    act(&mut straight, 0);
    let state = straight.fmu_state().unwrap();
    let expected = go_on(&mut straight, 1);

    let mut ended = initialized("tlv", [1, 1]);
    ended.terminate().unwrap();
    let mut broken = co_simulation("tlv");
    let parameter = references(&broken, |quantity| {
        matches!(quantity, Quantity::Parameter(_))
    })
    .into_iter()
    .find(|&reference| broken.variables()[reference as usize - 1].name == "arm_length")
    .unwrap();
    broken.set_real(&[parameter], &[10.0]).unwrap();
    broken.enter_initialization_mode().unwrap();
    broken.exit_initialization_mode().unwrap_err();
    assert_eq!(broken.state(), State::Error);
    for mut instance in [ended, broken] {
        // Neither is harmed by getting and reading a state where it is.
        let here = instance.fmu_state().unwrap();
        let seen = look(&mut instance);
        let read = through_bytes(&straight, &mut instance, &state);
        assert_eq!(look(&mut instance), seen);
        instance.set_fmu_state(&read).unwrap();
        assert_eq!(go_on(&mut instance, 1), expected);
        instance.set_fmu_state(&here).unwrap();
        assert_eq!(look(&mut instance), seen);
    }
}

#[test]
fn a_reset_after_setting_a_state_gives_a_new_instance() {
    let mut used = initialized("four_bar", [3, 2]);
    go_on(&mut used, 0);
    let state = used.fmu_state().unwrap();
    let mut other = initialized("four_bar", [1, 1]);
    let read = through_bytes(&used, &mut other, &state);
    other.set_fmu_state(&read).unwrap();
    other.reset().unwrap();
    assert_eq!(other.fmu_state(), co_simulation("four_bar").fmu_state());
}

/// The triangle is driven by its length in one file and by its arm in the other.
#[test]
fn a_state_of_another_mechanism_is_refused() {
    let mut instance = initialized("tlv", [1, 1]);
    let mut other = initialized("tlv_crank", [1, 1]);
    let state = other.fmu_state().unwrap();
    let before = instance.fmu_state();
    let refused = |outcome: Result<(), Error>| {
        let error = outcome.expect_err("it is of another mechanism");
        let StateError::Guid { given, expected } = (match &error {
            Error::FmuState(error) => error.clone(),
            _ => panic!("{error}"),
        }) else {
            panic!("{error}")
        };
        assert_ne!(given, expected);
        let message = error.to_string();
        assert!(
            message.contains(&given) && message.contains(&expected),
            "{message}"
        );
    };
    refused(instance.set_fmu_state(&state));
    refused(instance.serialize_fmu_state(&state).map(drop));
    let bytes = other.serialize_fmu_state(&state).unwrap();
    refused(instance.deserialize_fmu_state(&bytes).map(drop));
    assert_eq!(instance.fmu_state(), before);
}

/// Next to a change point: the parallelogram laid flat at 180°, on the way and on the point.
#[test]
fn a_state_next_to_a_change_point_goes_on_with_the_same_bits() {
    let mut instance = initialized("parallelogram", [1, 1]);
    let position = references(&instance, |quantity| {
        matches!(quantity, Quantity::Input(_, Order::Position))
    });
    let mut plain = 0;
    for (step, angle) in [1.2, 3.13, std::f64::consts::PI, 3.15, 4.0]
        .into_iter()
        .enumerate()
    {
        instance.set_real(&position, &[angle]).unwrap();
        instance.do_step(0.1 * step as f64, 0.1).unwrap();
        let state = instance.fmu_state().unwrap();
        let bytes = instance.serialize_fmu_state(&state).unwrap();
        assert_eq!(instance.deserialize_fmu_state(&bytes).as_ref(), Ok(&state));
        let near = (1..=3).contains(&step);
        if step == 0 {
            plain = bytes.len();
        }
        assert_eq!(bytes.len() > plain, near);
        let mut other = initialized("parallelogram", [1, 1]);
        let read = other.deserialize_fmu_state(&bytes).unwrap();
        other.set_fmu_state(&read).unwrap();
        let go_on = |instance: &mut Instance| {
            let first = look(instance);
            instance.set_real(&position, &[angle + 0.011]).unwrap();
            let outcome = instance.do_step(0.1 * (step + 1) as f64, 0.1);
            (first, outcome, look(instance))
        };
        let expected = go_on(&mut instance);
        assert_eq!(go_on(&mut other), expected);
        instance.set_fmu_state(&state).unwrap();
        assert_eq!(go_on(&mut instance), expected);
        instance.set_fmu_state(&state).unwrap();
    }
}

/// An arm of 0.48 m whose pin is pulled towards a point 0.25 m from its axle: at 0.23 m it is at a
/// dead point, which a step meets.
#[test]
fn a_refused_step_leaves_no_trace_in_a_state_set_after_it() {
    let arm = crate::common::parse(
        "format = 1\nname = 'arm'\n[ground.markers]\nO = [0, 0]\nC = [0.25, 0]\n\
         [bodies.arm]\nmarkers = { a = [0, 0], b = [0.48, 0] }\nestimate = [0, 0, 1.4]\n\
         [joints]\nO = { type = 'revolute', markers = ['ground.O', 'arm.a'] }\n[drivers]\n\
         u = { coordinate = 'distance', markers = ['ground.C', 'arm.b'], start = 0.5 }\n",
    );
    let new = || {
        let mut instance = instance_of(arm.clone(), Interface::CoSimulation);
        instance.setup_experiment(0.0, Some(10.0)).expect("legal");
        let choices = references(&instance, |quantity| {
            matches!(quantity, Quantity::RateSource | Quantity::Extrapolation)
        });
        instance.set_integer(&choices, &[3, 2]).expect("there are");
        instance.enter_initialization_mode().expect("legal");
        instance.exit_initialization_mode().expect("it starts");
        instance
    };
    let position = references(&new(), |quantity| {
        matches!(quantity, Quantity::Input(_, Order::Position))
    });
    let mut first = new();
    for step in 0..2 {
        first.set_real(&position, &[0.516]).expect("an input");
        first
            .do_step(0.01 * f64::from(step), 0.01)
            .expect("it reaches");
    }
    let state = first.fmu_state().expect("legal");
    let meet = |instance: &mut Instance, looks_first: bool| {
        instance.set_real(&position, &[0.0165]).expect("an input");
        if looks_first {
            let _ = look(instance);
        }
        let outcome = instance.do_step(0.02, 3.0);
        assert!(outcome.is_err());
        look(instance)
    };
    let truth = meet(&mut first, false);
    for looks_first in [false, true, false] {
        first.set_fmu_state(&state).expect("its own");
        assert_eq!(
            meet(&mut first, looks_first),
            truth,
            "looks first: {looks_first}"
        );
    }
}

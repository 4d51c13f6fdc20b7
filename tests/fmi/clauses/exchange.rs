//! Model exchange: what may be discarded (2.1.3), stop time (2.1.6), discrete values (2.1.7),
//! functions without states (3.2.3).

use biela::fmi::{Category, Error, Failure, Interface, State, Status};

use crate::clauses::{get, initialized, set, started, vr};
use crate::common::log::Heard;
use crate::common::{instance_of, shipped};

const LENGTH: &str = "side_length.position";

/// The triangle of sides 0.4 m and 0.25 m closes up to a third side of 0.65 m.
const TOO_LONG: f64 = 0.7;

#[test]
fn a_getter_discards_and_an_accepted_step_ends_the_simulation() {
    let heard = Heard::default();
    let mut instance = started(heard.instance(shipped("tlv"), Interface::ModelExchange, false));
    instance.set_time(0.1).expect("legal");
    set(&mut instance, [(LENGTH, 0.6)]);
    assert_eq!(
        instance
            .completed_integrator_step()
            .map(|step| step.must_end),
        Ok(false)
    );
    let accepted = get(&mut instance, ["arm.phi"]);

    instance.set_time(0.2).expect("legal");
    set(&mut instance, [(LENGTH, TOO_LONG)]);
    let arm = vr(&instance, "arm.phi");
    let error = instance.reals(&[arm]).map(|_| ()).expect_err("too long");
    assert!(matches!(error, Error::Model(Failure::Discarded(_))));
    heard.take_all();

    // Neither `fmi2CompletedIntegratorStep` nor `fmi2EnterEventMode` may discard.
    assert_eq!(
        instance
            .completed_integrator_step()
            .map(|step| step.must_end),
        Ok(true)
    );
    let log = heard.take_all();
    let [message] = &log[..] else {
        panic!("{log:?}")
    };
    assert_eq!(message.status, Status::Error);
    assert!(message.text.contains("the simulation must end: dead point"));
    assert_eq!(instance.enter_event_mode(), Ok(()));
    assert_eq!(instance.state(), State::EventMode);
    assert_eq!(
        instance.new_discrete_states().map(|event| event.must_end),
        Ok(true)
    );

    // The last accepted pose stays; a host that goes on from there may.
    set(&mut instance, [(LENGTH, 0.6)]);
    assert_eq!(
        instance.new_discrete_states().map(|event| event.must_end),
        Ok(false)
    );
    assert_eq!(get(&mut instance, ["arm.phi"]), accepted);
}

/// Whole numbers "can only change at an event instant where `fmi2Discard` does not make sense".
#[test]
fn integers_are_read_beyond_a_dead_point_and_change_at_events_only() {
    let mut instance = started(instance_of(shipped("tlv"), Interface::ModelExchange));
    let counts = ["solver.iterations", "solver.substeps", "solver.proved"];
    let counts = counts.map(|name| vr(&instance, name));
    let read = |instance: &mut crate::clauses::Instance| {
        let values = instance.integers(&counts).expect("always known");
        values.collect::<Vec<_>>()
    };
    let at_start = read(&mut instance);
    instance.set_time(0.1).expect("legal");
    set(&mut instance, [(LENGTH, 0.6)]);
    get(&mut instance, ["arm.phi"]);
    assert_eq!(read(&mut instance), at_start);
    assert_eq!(
        instance
            .completed_integrator_step()
            .map(|step| step.must_end),
        Ok(false)
    );
    assert_eq!(read(&mut instance), at_start);
    instance.enter_event_mode().expect("legal");
    assert_ne!(read(&mut instance), at_start);
    set(&mut instance, [(LENGTH, TOO_LONG)]);
    assert_eq!(read(&mut instance).len(), 3);
}

/// "If the environment tries to compute past `stopTime`, the FMU has to return `fmi2Error`": where a
/// step is accepted. A solver's trial looks ahead, as FMPy's does with CVode.
#[test]
fn a_step_accepted_beyond_the_stop_time_is_an_error() {
    let mut instance = instance_of(shipped("tlv"), Interface::ModelExchange);
    instance.setup_experiment(0.0, Some(1.0)).expect("legal");
    initialized(&mut instance);
    // Hosts add up steps: 1e-12 s is rounding.
    instance.set_time(1.0 + 1e-12).expect("rounding");
    assert_eq!(
        instance
            .completed_integrator_step()
            .map(|step| step.must_end),
        Ok(false)
    );
    instance.set_time(1.1).expect("a trial");
    get(&mut instance, ["arm.phi"]);
    let errors = [
        instance.completed_integrator_step().map(|_| ()),
        instance.enter_event_mode(),
    ];
    for error in errors.map(|refused| refused.expect_err("beyond")) {
        assert_eq!(error.status(), Status::Error);
        let message = error.to_string();
        assert_eq!(message, "the time 1.1 s is beyond the stop time 1 s");
    }
    assert_eq!(instance.state(), State::ContinuousTimeMode);
    // Without a stop time there is none.
    let mut endless = started(instance_of(shipped("tlv"), Interface::ModelExchange));
    endless.set_time(1e6).expect("legal");
    assert_eq!(
        endless
            .completed_integrator_step()
            .map(|step| step.must_end),
        Ok(false)
    );
}

/// With nx = 0 and nz = 0 these are answered in initialization mode too (3.2.3).
#[test]
fn derivatives_and_nominals_of_no_states_are_read_in_initialization_mode() {
    let mut instance = instance_of(shipped("tlv"), Interface::ModelExchange);
    let refused = instance.derivatives_of_states(0).is_err();
    assert!(refused, "not before initialization");
    instance.setup_experiment(0.0, None).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    let derivatives = instance.derivatives_of_states(0).map(Iterator::count);
    assert_eq!(derivatives, Ok(0));
    assert_eq!(instance.nominals(0).map(Iterator::count), Ok(0));
}

/// In co-simulation only setters, steps and status functions discard (2.1.3).
#[test]
fn a_getter_of_co_simulation_does_not_discard() {
    let heard = Heard::default();
    let mut instance = started(heard.instance(shipped("tlv"), Interface::CoSimulation, false));
    let before = get(&mut instance, ["arm.phi"]);
    set(&mut instance, [(LENGTH, TOO_LONG)]);
    let arm = vr(&instance, "arm.phi");
    for error in [
        instance.reals(&[arm]).map(|_| ()).expect_err("too long"),
        instance
            .output_derivatives(&[arm], &[1])
            .map(|_| ())
            .expect_err("too long"),
        instance
            .directional_derivative(&[arm], &[1], &[1.0])
            .map(|_| ())
            .expect_err("too long"),
    ] {
        assert_eq!(error.status(), Status::Error, "{error}");
        assert!(
            error.to_string().contains("cannot go beyond 0.65"),
            "{error}"
        );
    }
    assert_eq!(heard.take(Category::Warning), [""; 0]);
    // Nothing has changed: back within reach, the host goes on.
    set(&mut instance, [(LENGTH, 0.35)]);
    assert_eq!(get(&mut instance, ["arm.phi"]), before);
    instance.do_step(0.0, 0.1).expect("it is within reach");
}

/// "The solution at the final time … can be retrieved" (2.0.5, 3.2.3): that of the inputs set last.
#[test]
fn values_after_the_end_are_those_of_the_inputs_set_last() {
    let crank = "crank_angle.position";
    for in_event_mode in [true, false] {
        let mut instance = started(instance_of(shipped("four_bar"), Interface::ModelExchange));
        instance.set_time(0.1).expect("legal");
        set(&mut instance, [(crank, 1.1)]);
        assert_eq!(
            instance
                .completed_integrator_step()
                .map(|step| step.must_end),
            Ok(false)
        );
        if in_event_mode {
            instance.enter_event_mode().expect("legal");
        }
        set(&mut instance, [(crank, 1.3)]);
        if in_event_mode {
            assert_eq!(
                instance.new_discrete_states().map(|event| event.must_end),
                Ok(false)
            );
        }
        instance.terminate().expect("legal");
        assert_eq!(get(&mut instance, [crank, "crank.phi"]), [1.3, 1.3]);
    }
    // Without such a pose the values stay those of the last one.
    let heard = Heard::default();
    let mut instance = started(heard.instance(shipped("tlv"), Interface::ModelExchange, false));
    let before = get(&mut instance, ["arm.phi"]);
    set(&mut instance, [(LENGTH, TOO_LONG)]);
    heard.take_all();
    instance.terminate().expect("legal");
    assert_eq!(get(&mut instance, ["arm.phi"]), before);
    let log = heard.take_all();
    assert!(
        log.iter()
            .any(|message| message.text.contains("dead point")),
        "{log:?}"
    );
}

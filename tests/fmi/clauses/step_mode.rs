//! Steps and events of FMI 3.0 co-simulation (4.2).

mod derivatives;
mod intermediate_update;

use std::f64::consts::PI;
use std::sync::Arc;

use biela::fmi::{
    Category, CoSimulation, Error, Failure, Interface, MechanismModel, State, Status, StepOutcome,
    StepProgress, Version,
};
use biela::mechanism::Mechanism;

use crate::clauses::{get, set, vr};
use crate::common::log::Heard;
use crate::common::mechanisms::crank;
use crate::common::{Instance, parse, shipped};

/// The two-link arm with a cylinder reaches 0.7 m at most: base and arm in a line.
const CYLINDER: &str = "tlv";

fn new_instance(mechanism: Arc<Mechanism>, heard: &Heard) -> Instance {
    heard.instance_of(Version::Fmi3, mechanism, Interface::CoSimulation)
}

fn instance_of(name: &str, agreed: CoSimulation, heard: &Heard) -> Instance {
    let mut instance = new_instance(shipped(name), heard);
    instance.agree(agreed).expect("known variables");
    instance
}

fn running(name: &str, agreed: CoSimulation) -> Instance {
    start(new_instance(shipped(name), &Heard::default()), agreed)
}

/// Starts an instance, up to its first step.
fn start(mut instance: Instance, agreed: CoSimulation) -> Instance {
    let event_mode_used = agreed.event_mode_used;
    instance.agree(agreed).expect("known variables");
    instance
        .enter_initialization_mode_at(0.0, None)
        .expect("legal");
    instance.exit_initialization_mode().expect("it starts");
    if event_mode_used {
        assert_eq!(instance.state(), State::EventMode);
        assert!(!instance.new_discrete_states().expect("legal").must_end);
        instance.enter_step_mode().expect("legal");
    }
    assert_eq!(instance.state(), State::StepMode);
    instance
}

/// An agreement about events and early return.
fn agreed(event_mode_used: bool, early_return_allowed: bool) -> CoSimulation {
    CoSimulation {
        event_mode_used,
        early_return_allowed,
        ..CoSimulation::default()
    }
}

fn done(progress: StepProgress) -> StepOutcome {
    match progress {
        StepProgress::Done(outcome) => outcome,
        StepProgress::Intermediate { .. } => panic!("the step goes on: {progress:?}"),
    }
}

/// Steps without intermediate update.
fn step(instance: &mut Instance, point: f64, h: f64) -> StepOutcome {
    done(instance.begin_step(point, h).expect("it can be taken"))
}

/// Steps with `at` called at each point of intermediate update.
fn step_with(
    instance: &mut Instance,
    point: f64,
    h: f64,
    mut at: impl FnMut(&mut Instance, f64) -> Option<f64>,
) -> StepOutcome {
    let mut progress = instance.begin_step(point, h).expect("it can be taken");
    while let StepProgress::Intermediate { time, .. } = progress {
        assert_eq!(instance.state(), State::IntermediateUpdateMode);
        let wish = at(instance, time);
        progress = instance.resume_step(wish).expect("it goes on");
    }
    done(progress)
}

const OUTPUTS: [&str; 3] = ["arm.phi", "arm.omega", "arm.alpha"];

/// Steps of FMI 2.0 and of FMI 3.0 give the same bits.
#[test]
fn steps_have_the_bits_of_fmi_2() {
    let model = MechanismModel::new(shipped(CYLINDER), Interface::CoSimulation).unwrap();
    let mut old = Instance::new(model, Box::new(Heard::default()), false);
    old.enter_initialization_mode().unwrap();
    old.exit_initialization_mode().unwrap();
    // A host that takes calls without using them, and one that handles events, as well.
    let called_back = CoSimulation {
        intermediate_update: true,
        ..CoSimulation::default()
    };
    let mut all = [agreed(false, false), agreed(true, true), called_back]
        .map(|agreed| running(CYLINDER, agreed));
    for n in 0..20 {
        let (time, length) = (0.05 * f64::from(n), 0.4 + 0.1 * f64::from(n).sin());
        set(&mut old, [("side_length.position", length)]);
        old.do_step(time, 0.05).unwrap();
        let expected = get(&mut old, OUTPUTS);
        for instance in &mut all {
            set(instance, [("side_length.position", length)]);
            step_with(instance, time, 0.05, |_, _| None);
            assert_eq!(get(instance, OUTPUTS), expected, "t = {time} s");
        }
    }
}

/// 2.3.1: a call that returns an error ends the simulation; reset begins a new one.
#[test]
fn an_error_ends_the_simulation() {
    let mut instance = running("pendulum", CoSimulation::default());
    let error = instance.enter_continuous_time_mode().unwrap_err();
    assert_eq!(instance.report("call", &error), Status::Error);
    assert_eq!(instance.state(), State::Terminated);
    assert!(instance.begin_step(0.0, 0.1).is_err());
    instance.reset().unwrap();
    assert_eq!(instance.state(), State::Instantiated);
}

/// 2.2.4: a value outside its limits is discarded, and the simulation goes on.
#[test]
fn a_discard_changes_nothing() {
    let mut instance = instance_of("four_bar", CoSimulation::default(), &Heard::default());
    let reference = vr(&instance, "crank_length");
    let error = instance.set_real(&[reference], &[-1.0]).unwrap_err();
    assert_eq!(instance.report("call", &error), Status::Discard);
    assert_eq!(instance.state(), State::Instantiated);
}

/// 4.2.1.1: after setting, variables are read after a step; in event mode at once.
#[test]
fn outputs_are_read_after_a_step_or_in_event_mode() {
    let mut instance = running(CYLINDER, agreed(true, true));
    let before = get(&mut instance, ["arm.phi"]);
    set(&mut instance, [("side_length.position", 0.45)]);
    let arm = vr(&instance, "arm.phi");
    let refused = instance.get_real(&[arm], &mut [0.0]).unwrap_err();
    assert!(matches!(refused, Error::NotStepped { .. }), "{refused}");
    // Inputs and parameters do not depend on a step.
    assert_eq!(get(&mut instance, ["side_length.position"]), [0.45]);
    instance.enter_event_mode().unwrap();
    let now = get(&mut instance, ["arm.phi"]);
    assert_ne!(now, before);
    // Any order of setting and reading: the pose belongs to the values.
    set(&mut instance, [("side_length.position", 0.5)]);
    assert_ne!(get(&mut instance, ["arm.phi"]), now);
    set(&mut instance, [("side_length.position", 0.45)]);
    assert_eq!(get(&mut instance, ["arm.phi"]), now);
    assert!(!instance.new_discrete_states().unwrap().must_end);
    instance.enter_step_mode().unwrap();
    assert_eq!(get(&mut instance, ["arm.phi"]), now);
    step(&mut instance, 0.0, 0.1);
    assert_eq!(get(&mut instance, ["arm.phi"]), now);
}

/// A jump at an event is no motion: rates are those of the last step, and the estimate begins
/// anew after it.
#[test]
fn a_jump_at_an_event_resets_the_estimate() {
    let mut instance = running(CYLINDER, agreed(true, true));
    for n in 0..4 {
        set(
            &mut instance,
            [("side_length.position", 0.36 + 0.01 * f64::from(n))],
        );
        step(&mut instance, 0.1 * f64::from(n), 0.1);
    }
    let [omega] = get(&mut instance, ["arm.omega"]);
    assert!(omega.abs() > 0.1);
    instance.enter_event_mode().unwrap();
    set(&mut instance, [("side_length.position", 0.5)]);
    let [at_event] = get(&mut instance, ["arm.omega"]);
    // The same rate of the cylinder, at another pose.
    assert!(at_event.abs() > 0.01 && (at_event - omega).abs() < 0.5 * omega.abs());
    instance.enter_step_mode().unwrap();
    step(&mut instance, 0.4, 0.1);
    assert_eq!(get(&mut instance, ["arm.omega"]), [0.0]);
}

/// The rates of a prescribed motion are exact, in event mode too.
#[test]
fn a_prescribed_motion_has_its_rates_at_an_event() {
    let rate = "parameters.rate = { value = 2.0, unit = 'rad/s', tunable = true }\n";
    let text = crank("motion = 'rate*t'") + rate;
    let instance = new_instance(parse(&text), &Heard::default());
    let mut instance = start(instance, agreed(true, false));
    let rates = ["crank.phi", "turn.velocity", "crank.omega"];
    step(&mut instance, 0.0, 0.5);
    assert_eq!(get(&mut instance, rates), [1.0, 2.0, 2.0]);
    instance.enter_event_mode().unwrap();
    set(&mut instance, [("rate", 4.0)]);
    assert_eq!(get(&mut instance, rates), [2.0, 4.0, 4.0]);
}

/// 4.2.1.1: the state before the call, inputs included.
#[test]
fn a_dead_point_is_discarded_where_no_early_return_is_allowed() {
    for event_mode_used in [false, true] {
        let mut instance = running(CYLINDER, agreed(event_mode_used, false));
        for n in 0..3 {
            set(
                &mut instance,
                [("side_length.position", 0.36 + 0.01 * f64::from(n))],
            );
            step(&mut instance, 0.1 * f64::from(n), 0.1);
        }
        let before = get(&mut instance, OUTPUTS);
        let saved = instance.fmu_state().unwrap();
        set(&mut instance, [("side_length.position", 0.9)]);
        let with_input = instance.fmu_state().unwrap();
        let error = instance.begin_step(0.3, 0.1).unwrap_err();
        assert!(
            matches!(error, Error::Model(Failure::Discarded(_))),
            "{error}"
        );
        assert_eq!(instance.report("fmi3DoStep", &error), Status::Discard);
        assert_eq!(instance.state(), State::StepMode);
        assert_eq!(instance.fmu_state().unwrap(), with_input);
        assert_eq!(get(&mut instance, ["side_length.position"]), [0.9]);
        instance.set_fmu_state(&saved).unwrap();
        assert_eq!(get(&mut instance, OUTPUTS), before);
        set(&mut instance, [("side_length.position", 0.39)]);
        step(&mut instance, 0.3, 0.1);
    }
}

/// The cylinder extends by 0.1 m/s along its own curve, from 0.65 m, and the arm is stretched at
/// base + arm length.
#[test]
fn a_dead_point_is_an_early_return_at_its_time() {
    for event_mode_used in [false, true] {
        let mut instance = instance_of(CYLINDER, agreed(event_mode_used, true), &Heard::default());
        let [base, arm] = get(&mut instance, ["base", "arm_length"]);
        let dead_point = base + arm;
        let extrapolation = vr(&instance, "extrapolation");
        instance.set_integer(&[extrapolation], &[2]).unwrap();
        let start = dead_point - 0.05;
        set(&mut instance, [("side_length.position", start)]);
        instance.enter_initialization_mode_at(0.0, None).unwrap();
        instance.exit_initialization_mode().unwrap();
        if event_mode_used {
            instance.enter_step_mode().unwrap();
        }
        let (mut time, h, mut saved) = (0.0, 0.2, None);
        let outcome = loop {
            let position = start + 0.1 * time;
            set(
                &mut instance,
                [
                    ("side_length.position", position),
                    ("side_length.velocity", 0.1),
                ],
            );
            let outcome = step(&mut instance, time, h);
            time = outcome.last_successful_time;
            if outcome.early_return {
                break outcome;
            }
            if saved.is_none() {
                saved = Some(instance.fmu_state().unwrap());
            }
        };
        let saved = saved.expect("the first step has ended");
        assert_eq!(outcome.event_handling_needed, event_mode_used);
        assert_eq!(outcome.terminate_simulation, !event_mode_used);
        // Near a dead point the angle goes with the root of the way: the time is exact to the
        // rounding of the lengths.
        assert!((time - 0.5).abs() < 1e-9, "{time}");
        let [angle] = get(&mut instance, ["arm.phi"]);
        assert!((angle.abs() - PI).abs() < 1e-4, "{angle}");
        if event_mode_used {
            // No way on: the next step makes no progress.
            set(&mut instance, [("side_length.position", dead_point)]);
            let next = step(&mut instance, time, h);
            assert!(next.early_return && next.terminate_simulation);
            assert!((next.last_successful_time - time).abs() < 1e-9);
            // A state of before leads on.
            instance.set_fmu_state(&saved).unwrap();
            set(&mut instance, [("side_length.velocity", -0.1)]);
            let back = step(&mut instance, 0.2, h);
            assert!(!back.early_return && !back.terminate_simulation, "{back:?}");
        }
    }
}

/// A held input that jumps beyond a dead point: the step makes no progress at all.
#[test]
fn a_jump_beyond_a_dead_point_ends_at_the_start_of_the_step() {
    let mut instance = running(CYLINDER, agreed(true, true));
    set(&mut instance, [("side_length.position", 0.4)]);
    step(&mut instance, 0.0, 0.1);
    let before = get(&mut instance, OUTPUTS);
    for terminate in [false, true] {
        set(&mut instance, [("side_length.position", 0.9)]);
        let outcome = step(&mut instance, 0.1, 0.1);
        assert!(outcome.early_return && outcome.event_handling_needed);
        assert_eq!(outcome.terminate_simulation, terminate);
        assert_eq!(outcome.last_successful_time, 0.1);
        assert_eq!(get(&mut instance, OUTPUTS), before);
    }
    // An event at which no pose exists ends the simulation.
    instance.enter_event_mode().unwrap();
    set(&mut instance, [("side_length.position", 0.95)]);
    assert!(instance.new_discrete_states().unwrap().must_end);
}

/// 2.3.1: nothing is logged while logging is off, the warning of a dead point included.
#[test]
fn logging_that_is_off_is_off() {
    let heard = Heard::default();
    let model = MechanismModel::new(shipped(CYLINDER), Interface::CoSimulation).unwrap();
    let sink = Box::new(heard.clone());
    let mut instance = Instance::of_version(Version::Fmi3, model, sink, false);
    instance.agree(agreed(false, true)).unwrap();
    instance.enter_initialization_mode_at(0.0, None).unwrap();
    instance.exit_initialization_mode().unwrap();
    set(&mut instance, [("side_length.position", 0.9)]);
    assert!(step(&mut instance, 0.0, 0.1).terminate_simulation);
    let error = instance.begin_step(7.0, 0.1).unwrap_err();
    instance.report("fmi3DoStep", &error);
    assert_eq!(heard.take_all(), []);
    instance
        .set_debug_logging(true, &["logStatusWarning"])
        .unwrap();
    instance.reset().unwrap();
    instance.enter_initialization_mode_at(0.0, None).unwrap();
    instance.exit_initialization_mode().unwrap();
    set(&mut instance, [("side_length.position", 0.9)]);
    step(&mut instance, 0.0, 0.1);
    let warned = heard.take(Category::Warning);
    assert_eq!(warned.len(), 1, "{warned:?}");
}

/// A state goes from one instance to another, in event mode too, and through its bytes.
#[test]
fn fmu_states_keep_the_mode() {
    let mut instance = running(CYLINDER, agreed(true, true));
    set(&mut instance, [("side_length.position", 0.4)]);
    step(&mut instance, 0.0, 0.1);
    instance.enter_event_mode().unwrap();
    set(&mut instance, [("side_length.position", 0.45)]);
    let there = get(&mut instance, OUTPUTS);
    let state = instance.fmu_state().unwrap();
    let bytes = instance.serialize_fmu_state(&state).unwrap();
    instance.enter_step_mode().unwrap();
    step(&mut instance, 0.1, 0.1);

    let mut other = instance_of(CYLINDER, agreed(true, true), &Heard::default());
    let read = other.deserialize_fmu_state(&bytes).unwrap();
    other.set_fmu_state(&read).unwrap();
    assert_eq!(other.state(), State::EventMode);
    assert_eq!(get(&mut other, OUTPUTS), there);
    other.enter_step_mode().unwrap();
    step(&mut other, 0.1, 0.1);
    assert_eq!(get(&mut other, OUTPUTS), get(&mut instance, OUTPUTS));

    let mut without_events = instance_of(CYLINDER, agreed(false, true), &Heard::default());
    assert!(without_events.set_fmu_state(&state).is_err());
    let model = MechanismModel::new(shipped(CYLINDER), Interface::CoSimulation).unwrap();
    let mut old = Instance::new(model, Box::new(Heard::default()), false);
    assert!(old.deserialize_fmu_state(&bytes).is_err());
    assert!(old.set_fmu_state(&state).is_err());
}

/// A cord along a distance that is zero at one communication point has no force there; one step on
/// it has again (3.0.2, 2.2.4: after a discard an instance is as before the call).
#[test]
fn a_value_that_does_not_exist_ends_nothing() {
    let cord = parse(
        "format = 1\nname = 'cord'\n[ground.markers]\nO = [0, 0]\n[bodies.slider]\n\
         markers = { S = [0, 0] }\nmass = 1\nestimate = [-0.02, 0, 0]\n[joints]\n\
         rail = { type = 'translational', markers = ['ground.O', 'slider.S'] }\n[drivers]\n\
         u = { coordinate = 'x', markers = ['ground.O', 'slider.S'], start = -0.02 }\n[forces]\n\
         cord = { coordinate = 'distance', markers = ['ground.O', 'slider.S'], value = -3 }\n",
    );
    let mut instance = start(new_instance(cord, &Heard::default()), agreed(false, false));
    for (n, position) in [-0.01, 0.0, 0.01].into_iter().enumerate() {
        set(&mut instance, [("u.position", position)]);
        step(&mut instance, 0.1 * n as f64, 0.1);
        let effort = vr(&instance, "u.effort");
        let found = instance.reals(&[effort]).map(|mut values| values.next());
        match found {
            Ok(_) => assert!(position != 0.0),
            Err(error) => {
                assert_eq!(position, 0.0);
                assert_eq!(instance.report("fmi3GetFloat64", &error), Status::Discard);
            }
        }
        assert_eq!(instance.state(), State::StepMode);
    }
}

//! A call takes a bounded number of sub-steps, `solver.budget`.

#![allow(
    clippy::float_cmp,
    reason = "values that are set come back to the last bit, and a pose that stays does"
)]

use biela::fmi::{
    Category, CoSimulation, Error, Failure, Instance as FmiInstance, Interface, MechanismModel,
    StepProgress, Version,
};

use crate::clauses::{get, running, set, started};
use crate::common::log::Heard;
use crate::common::{Instance, co_simulation, shipped};

const STEP: f64 = 0.1;

/// The bits of all Reals.
fn bits(instance: &mut Instance) -> Vec<u64> {
    let reals = (1..).zip(instance.variables());
    let reals: Vec<u32> = reals
        .filter(|(_, variable)| variable.kind.is_real())
        .map(|(reference, _)| reference)
        .collect();
    let values = instance.reals(&reals).expect("they exist");
    values.map(f64::to_bits).collect()
}

fn discarded(result: Result<impl std::fmt::Debug, Error>) -> String {
    match result.expect_err("it takes too long") {
        Error::Model(Failure::Discarded(why)) => why,
        error => panic!("{error}"),
    }
}

/// A host that permits no early return goes on from the point before the step, as if it had not been.
#[test]
fn a_free_motion_that_takes_too_long_is_discarded_and_leaves_no_trace() {
    let begin = || {
        let model = MechanismModel::new(shipped("four_bar_free"), Interface::CoSimulation);
        let model = model.expect("it assembles");
        let log = Box::new(Heard::default());
        let mut instance = FmiInstance::of_version(Version::Fmi3, model, log, true);
        instance
            .enter_initialization_mode_at(0.0, None)
            .expect("legal");
        instance.exit_initialization_mode().expect("it starts");
        instance.begin_step(0.0, STEP).expect("it moves");
        instance
    };
    let mut straight = begin();
    let [plenty] = get(&mut straight, ["solver.budget"]);
    straight.begin_step(STEP, STEP).expect("it moves");
    let expected = bits(&mut straight);
    // The step takes some 200 sub-steps, one of the integrator twelve or more. With 1e9 N m the first trial
    // leads millions of turns on.
    for (budget, torque, progresses) in [(60, 0.0, true), (3000, 1e9, false)] {
        let mut tried = begin();
        let values = [
            ("solver.budget", f64::from(budget)),
            ("motor.effort", torque),
        ];
        set(&mut tried, values);
        let why = discarded(tried.begin_step(STEP, STEP));
        let told = [
            "given up in the step from 0.1 s over 0.1 s: t = 0.1",
            &format!("takes more than {budget} sub-steps"),
            "set `solver.budget` higher",
        ];
        assert!(told.iter().all(|told| why.contains(told)), "{why}");
        assert_eq!(!why.contains("t = 0.100000000 s"), progresses, "{why}");
        set(
            &mut tried,
            [("solver.budget", plenty), ("motor.effort", 0.0)],
        );
        tried.begin_step(STEP, STEP).expect("it moves");
        assert_eq!(bits(&mut tried), expected);
    }
}

/// A host that permits an early return goes on from where the motion was given up, and meets the
/// same instants again: small budgets in turn lead where a large one does.
#[test]
fn an_early_return_goes_on_with_a_new_budget() {
    let begin = |budget| {
        let model = MechanismModel::new(shipped("double_pendulum"), Interface::CoSimulation);
        let model = model.expect("it assembles");
        let log = Box::new(Heard::default());
        let mut instance = FmiInstance::of_version(Version::Fmi3, model, log, true);
        let wishes = CoSimulation {
            event_mode_used: true,
            early_return_allowed: true,
            ..CoSimulation::default()
        };
        instance.agree(wishes).expect("legal");
        set(&mut instance, [("solver.budget", budget)]);
        instance
            .enter_initialization_mode_at(0.0, None)
            .expect("legal");
        instance.exit_initialization_mode().expect("it starts");
        instance.enter_step_mode().expect("legal");
        instance
    };
    let names = ["shoulder.position", "elbow.position"];
    let mut whole = begin(1e6);
    whole.begin_step(0.0, 1.0).expect("it moves");
    let expected = get(&mut whole, names);

    let mut parts = begin(100.0);
    let (mut time, mut returns) = (0.0, 0);
    while time < 1.0 {
        let progress = parts.begin_step(time, 1.0 - time).expect("it moves");
        let StepProgress::Done(outcome) = progress else {
            panic!("{progress:?}")
        };
        assert!(outcome.last_successful_time > time, "it comes to an end");
        time = outcome.last_successful_time;
        if outcome.early_return {
            assert!(!outcome.terminate_simulation);
            parts.enter_event_mode().expect("legal");
            parts.enter_step_mode().expect("legal");
            returns += 1;
        }
    }
    assert!(returns > 3, "{returns}");
    let found = get(&mut parts, names);
    for (found, expected) in found.into_iter().zip(expected) {
        // The same steps of the integrator, but for the lengths of the last ones: its tolerance 1e-10,
        // which the motion of a second makes grow a hundredfold at most.
        assert!((found - expected).abs() < 1e-8, "{found} {expected}");
    }
}

/// A step that is refused for its budget is repeated with a larger one.
#[test]
fn a_host_goes_back_and_raises_the_budget() {
    let heard = Heard::default();
    let [mut plain, mut instance] = [0, 1]
        .map(|_| started(heard.instance(shipped("four_bar_free"), Interface::CoSimulation, true)));
    plain.do_step(0.0, STEP).expect("it moves");
    let before = instance.fmu_state().expect("legal");
    // Twelve evaluations are one step of the integrator, and some more choose the first one.
    set(&mut instance, [("solver.budget", 40.0)]);
    discarded(instance.do_step(0.0, STEP));
    let reached = instance.last_successful_time();
    assert!(0.0 < reached && reached < STEP, "{reached}");
    assert!(!instance.is_terminated(), "the host can go back");
    let told = heard.take(Category::Warning);
    assert!(
        told.last()
            .is_some_and(|told| told.contains("takes more than 40 sub-steps")),
        "{told:?}"
    );

    instance.set_fmu_state(&before).expect("its own");
    instance
        .do_step(0.0, STEP)
        .expect("the budget is that of the state");
    assert_eq!(bits(&mut instance), bits(&mut plain));
}

/// A sub-step turns a crank by less than a turn, so that a thousand turns take more than 500.
#[test]
fn a_driven_step_that_takes_too_long_is_discarded() {
    let heard = Heard::default();
    let mut instance = started(heard.instance(shipped("four_bar"), Interface::CoSimulation, true));
    let [start] = get(&mut instance, ["crank_angle.position"]);
    let far = start + 1e3 * std::f64::consts::TAU;
    set(
        &mut instance,
        [("solver.budget", 500.0), ("crank_angle.position", far)],
    );
    let before = instance.fmu_state().expect("legal");
    let why = discarded(instance.do_step(0.0, STEP));
    assert!(
        why.contains("the step takes more than 500 sub-steps"),
        "{why}"
    );
    // Held inputs have their values at the ends of a step alone.
    assert_eq!(get(&mut instance, ["crank.phi"]), [start]);
    assert_eq!(instance.last_successful_time(), 0.0);
    instance.set_fmu_state(&before).expect("its own");
    set(&mut instance, [("solver.budget", 1e5)]);
    instance.do_step(0.0, STEP).expect("it turns");
    let [place] = get(&mut instance, ["crank.phi"]);
    // A rounding of six thousand radians.
    assert!((place - far).abs() < 1e-12 * far, "{place} {far}");
}

/// Initialization has the same budget.
#[test]
fn a_start_that_takes_too_long_is_refused() {
    let mut instance = co_simulation("four_bar");
    instance.setup_experiment(0.0, None).expect("legal");
    // A way to the angle, and one by the turn.
    set(
        &mut instance,
        [("solver.budget", 1.0), ("crank_angle.position", 9.0)],
    );
    instance.enter_initialization_mode().expect("legal");
    let error = instance
        .exit_initialization_mode()
        .expect_err("it takes more");
    assert!(
        error.to_string().contains("takes more than 1 sub-steps"),
        "{error}"
    );
}

/// The budget is part of a saved state, and of no value; a reset gives the start back.
#[test]
fn the_budget_is_kept_and_reset_as_parameters_are() {
    let mut instance = running("four_bar");
    set(&mut instance, [("solver.budget", 1234.0)]);
    let state = instance.fmu_state().expect("legal");
    let bytes = instance.serialize_fmu_state(&state).expect("its own");
    instance.reset().expect("legal");
    let mut instance = started(instance);
    assert_eq!(get(&mut instance, ["solver.budget"]), [3e5]);
    let read = instance.deserialize_fmu_state(&bytes).expect("untouched");
    instance.set_fmu_state(&read).expect("its own");
    assert_eq!(get(&mut instance, ["solver.budget"]), [1234.0]);
    let reference = [crate::clauses::vr(&instance, "solver.budget")];
    for none in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        instance
            .set_real(&reference, &[none])
            .expect_err("it is none");
    }
    assert_eq!(get(&mut instance, ["solver.budget"]), [1234.0]);
}

//! FMUs at stops.

#![allow(
    clippy::float_cmp,
    reason = "values that are set come back to the last bit, and a pose that stays does"
)]

use std::sync::Arc;

use biela::fmi::{
    Category, CoSimulation, Error, Failure, Instance as FmiInstance, Interface, Kind,
    MechanismModel, StateChange, StepProgress, Version,
};
use biela::mechanism::Mechanism;

use crate::clauses::{get, set, started, vr};
use crate::common::log::Heard;
use crate::common::{Instance, parse};

/// A nut on a guide, with a wall at a place that the host may move.
fn nut(source: &str) -> Arc<Mechanism> {
    parse(&format!(
        r#"
format = 1
name = "nut"
[parameters]
wall_place = {{ value = 0.12, unit = "m", tunable = true }}
[ground.markers]
S = [0, 0]
[bodies.nut]
mass = 1
markers = {{ N = [0, 0] }}
[joints]
guide = {{ type = "translational", markers = ["ground.S", "nut.N"] }}
[stops]
wall = {{ of = "feed", max = "wall_place" }}
{source}
"#
    ))
}

fn driven() -> Arc<Mechanism> {
    nut("[drivers]\nfeed = { coordinate = \"x\", markers = [\"ground.S\", \"nut.N\"], start = 0 }")
}

fn instance(heard: &Heard, interface: Interface, version: Version) -> Instance {
    heard.instance_of(version, driven(), interface)
}

/// A step of 0.1 s along 1 m/s from 0.05 m, held where it starts otherwise.
fn go(instance: &mut Instance, time: f64, position: f64) -> Result<(), Error> {
    set(instance, [("feed.position", position)]);
    let reference = [vr(instance, "feed.position")];
    instance
        .set_real_input_derivatives(&reference, &[1], &[1.0])
        .expect("legal");
    instance.do_step(time, 0.1)
}

#[test]
fn a_step_into_a_stop_is_discarded_with_its_name_and_time() {
    let heard = Heard::default();
    let mut instance = started(instance(&heard, Interface::CoSimulation, Version::Fmi2));
    go(&mut instance, 0.0, 0.0).expect("0.1 m is inside");
    let error = go(&mut instance, 0.1, 0.1).expect_err("0.2 m is not");
    assert!(matches!(error, Error::Model(Failure::Discarded(_))));
    assert_eq!(
        heard.take(Category::Warning),
        [
            "stop `wall` reached: feed = 0.120000000 m, after 0.2000 of the step from 0.1 s over \
             0.1 s: driver `feed` was asked for 0.200000000 m and cannot go beyond 0.120000000 m"
        ]
    );
    // Rounding of 0.12 m at 1 m/s.
    assert!((instance.last_successful_time() - 0.12).abs() < 1e-13);
    let [x] = get(&mut instance, ["nut.x"]);
    assert!((x - 0.12).abs() < 1e-13);
}

#[test]
fn a_master_that_goes_back_rests_at_the_stop_and_leaves_it() {
    let heard = Heard::default();
    let mut instance = started(instance(&heard, Interface::CoSimulation, Version::Fmi2));
    set(&mut instance, [("feed.position", 0.12)]);
    instance
        .do_step(0.0, 0.1)
        .expect("it goes to the stop itself");
    instance.do_step(0.1, 0.1).expect("it rests there");
    let at_stop = instance.fmu_state().expect("legal");
    set(&mut instance, [("feed.position", 0.13)]);
    instance.do_step(0.2, 0.1).expect_err("it is beyond");
    assert_eq!(get(&mut instance, ["nut.x"]), [0.12]);
    instance.set_fmu_state(&at_stop).expect("its own");
    assert_eq!(get(&mut instance, ["nut.x"]), [0.12]);
    set(&mut instance, [("feed.position", 0.07)]);
    instance.do_step(0.2, 0.1).expect("it leads inward");
    assert_eq!(get(&mut instance, ["nut.x"]), [0.07]);
    // Another instance goes on from the state in the same way.
    let bytes = instance.serialize_fmu_state(&at_stop).expect("legal");
    let mut other = started(self::instance(
        &heard,
        Interface::CoSimulation,
        Version::Fmi2,
    ));
    let read = other.deserialize_fmu_state(&bytes).expect("its own");
    other.set_fmu_state(&read).expect("the same mechanism");
    set(&mut other, [("feed.position", 0.1200001)]);
    other.do_step(0.2, 0.1).expect_err("it is beyond");
}

#[test]
fn a_wall_that_moves_meets_the_nut() {
    let heard = Heard::default();
    let mut instance = started(instance(&heard, Interface::CoSimulation, Version::Fmi2));
    set(&mut instance, [("feed.position", 0.1)]);
    instance.do_step(0.0, 0.1).expect("it is inside");
    let before = instance.fmu_state().expect("legal");
    set(&mut instance, [("wall_place", 0.08)]);
    instance
        .do_step(0.1, 0.1)
        .expect_err("the wall meets the nut");
    let [warning] = &heard.take(Category::Warning)[..] else {
        panic!("one message")
    };
    assert!(
        warning.starts_with("stop `wall` reached: feed = 0.100000000 m, after 0.5000 of the step"),
        "{warning}"
    );
    instance.set_fmu_state(&before).expect("its own");
    set(
        &mut instance,
        [("wall_place", 0.08), ("feed.position", 0.05)],
    );
    instance.do_step(0.1, 0.1).expect("the nut makes way");
}

#[test]
fn a_start_beyond_a_stop_is_refused() {
    let heard = Heard::default();
    let mut instance = instance(&heard, Interface::CoSimulation, Version::Fmi2);
    instance.setup_experiment(0.0, None).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    set(&mut instance, [("feed.position", 0.2)]);
    let error = instance
        .exit_initialization_mode()
        .expect_err("it is beyond");
    let message = error.to_string();
    let expected = "the start pose is beyond stop `wall`: feed = 0.200000000 m is above its `max` = 0.120000000 m";
    assert!(message.contains(expected), "{message}");
}

#[test]
fn a_step_returns_early_at_a_stop() {
    let heard = Heard::default();
    let mut instance = instance(&heard, Interface::CoSimulation, Version::Fmi3);
    instance
        .agree(CoSimulation {
            event_mode_used: true,
            early_return_allowed: true,
            ..CoSimulation::default()
        })
        .expect("legal");
    let extrapolation = vr(&instance, "extrapolation");
    instance.set_integer(&[extrapolation], &[2]).expect("legal");
    instance
        .enter_initialization_mode_at(0.0, None)
        .expect("legal");
    instance.exit_initialization_mode().expect("it starts");
    instance.enter_step_mode().expect("legal");
    set(
        &mut instance,
        [("feed.position", 0.0), ("feed.velocity", 0.5)],
    );
    let progress = instance.begin_step(0.0, 1.0).expect("it returns early");
    let StepProgress::Done(outcome) = progress else {
        panic!("{progress:?}")
    };
    assert!(
        outcome.early_return && outcome.event_handling_needed,
        "{outcome:?}"
    );
    // 0.5 m/s from 0: the rounding of 0.12 m.
    assert!(
        (outcome.last_successful_time - 0.24).abs() < 1e-13,
        "{outcome:?}"
    );
    assert_eq!(heard.take(Category::Error).len(), 0);
    let [x] = get(&mut instance, ["nut.x"]);
    assert!((x - 0.12).abs() < 1e-13, "{x}");
}

/// A nut that moves freely at 1 m/s towards the wall, with friction of 0.5 N.
fn free() -> Arc<Mechanism> {
    nut(r#"
[freedoms]
feed = { coordinate = "x", markers = ["ground.S", "nut.N"], start = 0, velocity = 1 }
[friction]
rail = { of = "feed", force = 0.5 }
"#)
}

/// The event indicators of the wall (least value, largest value) and of friction.
fn indicators(instance: &mut Instance) -> [f64; 4] {
    let all: Vec<f64> = instance.event_indicators(4).expect("known").collect();
    all.try_into().expect("four")
}

#[test]
fn event_indicators_tell_stops_and_friction_in_model_exchange() {
    let heard = Heard::default();
    let model = MechanismModel::new(free(), Interface::ModelExchange).expect("it assembles");
    let instance = FmiInstance::new(model, Box::new(heard.clone()), true);
    let mut instance = started(instance);
    let go = |instance: &mut Instance, time: f64, states: [f64; 2]| {
        instance.set_time(time).expect("legal");
        instance.set_continuous_states(&states).expect("legal");
        let derivatives = instance.derivatives_of_states(2).expect("known");
        derivatives.last().expect("two")
    };
    let event = |instance: &mut Instance| {
        let completed = instance.completed_integrator_step().expect("legal");
        assert!(!completed.must_end);
        instance.enter_event_mode().expect("legal");
        let event = instance.new_discrete_states().expect("it goes on");
        instance.enter_continuous_time_mode().expect("legal");
        assert!(!event.must_end);
        let states: Vec<f64> = instance.continuous_states(2).expect("known").collect();
        (event.states, states)
    };
    // Sliding: 0.5 N on 1 kg.
    assert_eq!(go(&mut instance, 0.1, [0.1, 0.9]), -0.5);
    let [_, wall, sliding, _] = indicators(&mut instance);
    assert!((wall - 0.02).abs() < 1e-12 && (sliding - 0.9).abs() < 1e-12);
    // Beyond the wall, as far as a host finds its instant: the nut is stopped, and rests.
    go(&mut instance, 0.12, [0.12 + 1e-12, 0.8]);
    let [_, wall, ..] = indicators(&mut instance);
    assert!(wall < 0.0, "{wall}");
    let (change, states) = event(&mut instance);
    assert_eq!(change, StateChange::Values);
    assert!(
        (states[0] - 0.12).abs() < 1e-15 && states[1] == 0.0,
        "{states:?}"
    );
    assert_eq!(go(&mut instance, 0.2, [0.12, 0.0]), 0.0);
    // Nothing changes at a further event.
    let (change, again) = event(&mut instance);
    assert_eq!((change, again), (StateChange::None, vec![0.12, 0.0]));
    assert!(heard.take(Category::Error).is_empty());
}

#[test]
fn the_state_of_a_contact_is_saved() {
    let heard = Heard::default();
    let start = |interface| {
        let model = MechanismModel::new(free(), interface).expect("it assembles");
        started(FmiInstance::new(model, Box::new(heard.clone()), true))
    };
    let mut instance = start(Interface::CoSimulation);
    // It meets the wall after 0.124 s and rests there; saved before and after.
    for (time, at_rest) in [(0.1, false), (0.2, true)] {
        instance.do_step(time - 0.1, 0.1).expect("it moves");
        let [velocity] = get(&mut instance, ["feed.velocity"]);
        assert_eq!(velocity == 0.0, at_rest);
        let saved = instance.fmu_state().expect("legal");
        let bytes = instance.serialize_fmu_state(&saved).expect("legal");
        instance.do_step(time, 0.1).expect("it goes on");
        let first = get(
            &mut instance,
            ["feed.position", "feed.velocity", "wall.effort"],
        );
        let mut other = start(Interface::CoSimulation);
        let read = other.deserialize_fmu_state(&bytes).expect("its own");
        other.set_fmu_state(&read).expect("the same mechanism");
        other.do_step(time, 0.1).expect("it goes on");
        let second = get(
            &mut other,
            ["feed.position", "feed.velocity", "wall.effort"],
        );
        assert_eq!(first, second);
        instance.set_fmu_state(&saved).expect("its own");
    }
}

/// A step ends, for a host that handles events, at the first one: with intermediate update and without.
#[test]
fn a_step_of_free_motion_returns_early_at_an_event() {
    for intermediate_update in [false, true] {
        let heard = Heard::default();
        let model = MechanismModel::new(free(), Interface::CoSimulation).expect("it assembles");
        let mut instance =
            FmiInstance::of_version(Version::Fmi3, model, Box::new(heard.clone()), true);
        instance
            .agree(CoSimulation {
                event_mode_used: true,
                early_return_allowed: true,
                intermediate_update,
                ..CoSimulation::default()
            })
            .expect("legal");
        instance
            .enter_initialization_mode_at(0.0, None)
            .expect("legal");
        instance.exit_initialization_mode().expect("it starts");
        instance.enter_step_mode().expect("legal");
        let step = |instance: &mut Instance, start: f64, h: f64| {
            let mut progress = instance.begin_step(start, h).expect("it moves");
            loop {
                match progress {
                    StepProgress::Done(outcome) => return outcome,
                    StepProgress::Intermediate { .. } => {
                        progress = instance.resume_step(None).expect("it moves");
                    }
                }
            }
        };
        let outcome = step(&mut instance, 0.0, 1.0);
        // t − t²/4 = 0.12.
        let meets = 2.0 * (1.0 - 0.88_f64.sqrt());
        assert!(
            outcome.early_return && outcome.event_handling_needed && !outcome.terminate_simulation,
            "{outcome:?}"
        );
        assert!(
            (outcome.last_successful_time - meets).abs() < 1e-9,
            "{outcome:?}"
        );
        instance.enter_event_mode().expect("legal");
        assert_eq!(get(&mut instance, ["feed.velocity"]), [0.0]);
        instance.new_discrete_states().expect("it goes on");
        instance.enter_step_mode().expect("legal");
        let start = outcome.last_successful_time;
        let outcome = step(&mut instance, start, 1.0);
        assert!(
            !outcome.early_return && !outcome.event_handling_needed,
            "{outcome:?}"
        );
        let [place, velocity] = get(&mut instance, ["feed.position", "feed.velocity"]);
        assert!(
            (place - 0.12).abs() < 1e-13 && velocity == 0.0,
            "{place} {velocity}"
        );
        assert!(heard.take(Category::Error).is_empty());
    }
}

/// Two wheels of equal inertia with a ratio of 1/2 and a backlash of 1 deg, which overlap at the start:
/// 100 deg and 0 become 80.2 deg and −39.6 deg.
fn wheels() -> Arc<Mechanism> {
    parse(
        r#"
format = 1
name = "wheels"
[ground.markers]
O = [0, 0]
[bodies]
a = { markers = { O = [0, 0] }, mass = 1, inertia = 0.01 }
b = { markers = { O = [0, 0] }, mass = 1, inertia = 0.01 }
[joints]
O = { type = "revolute", markers = ["ground.O", "a.O"] }
P = { type = "revolute", markers = ["ground.O", "b.O"] }
mesh = { type = "gear", markers = ["a.O", "b.O"], teeth = [20, 40], backlash = "1*deg" }
[freedoms]
p = { coordinate = "angle", markers = ["ground.O", "a.O"], start = "100*deg" }
q = { coordinate = "angle", markers = ["ground.O", "b.O"] }
"#,
    )
}

/// The warning of the wheels, which overlap by a depth.
fn told(depth: &str, p: [&str; 2], q: [&str; 2]) -> String {
    format!(
        "t = 0 s: the parts of joint `mesh` overlap by {depth} deg; moved apart: `p` from {} deg to {} deg, \
         `q` from {} deg to {} deg",
        p[0], p[1], q[0], q[1]
    )
}

/// Unasked, an FMU begins where its model description says, and says what it has moved; a start that the
/// host sets is moved in the same way, and told.
#[test]
fn starts_that_overlap_are_moved_and_told() {
    let names = ["p.position", "q.position"];
    let assert_at = |instance: &mut Instance, degrees: [f64; 2]| {
        for (value, degrees) in get(instance, names).into_iter().zip(degrees) {
            assert!(
                (value.to_degrees() - degrees).abs() < 1e-12,
                "{value} {degrees}"
            );
        }
    };
    for interface in [Interface::CoSimulation, Interface::ModelExchange] {
        let heard = Heard::default();
        let instance = heard.instance(wheels(), interface, true);
        let starts = names.map(|name| {
            let named = instance.variables().iter().find(|v| v.name == name);
            named.expect("an output").kind.clone()
        });
        for (kind, degrees) in starts.iter().zip([80.2_f64, -39.6]) {
            let Kind::Real {
                start: Some(start), ..
            } = kind
            else {
                panic!("{kind:?}")
            };
            assert!((start.to_degrees() - degrees).abs() < 1e-12, "{start}");
        }
        let mut instance = started(instance);
        assert_at(&mut instance, [80.2, -39.6]);
        let own = told("49.5", ["100", "80.2"], ["0", "-39.6"]);
        assert_eq!(heard.take(Category::Warning), [own]);

        // A depth of 20 deg has 1/2 · 16/(5/4) and 16/(5/4) deg of the angles.
        instance.reset().expect("legal");
        let angle = |degrees: f64| degrees.to_radians();
        set(
            &mut instance,
            [("p.position", angle(41.0)), ("q.position", 0.0)],
        );
        let mut instance = started(instance);
        assert_at(&mut instance, [33.0, -16.0]);
        let own = told("20", ["41", "33"], ["0", "-16"]);
        assert_eq!(heard.take(Category::Warning), [own]);
        let state = instance.fmu_state().expect("legal");
        instance.set_fmu_state(&state).expect("its own");
        assert_at(&mut instance, [33.0, -16.0]);

        // Wheels that touch are where the host has set them.
        instance.reset().expect("legal");
        set(
            &mut instance,
            [("p.position", angle(40.0)), ("q.position", angle(-19.6))],
        );
        let mut instance = started(instance);
        assert_at(&mut instance, [40.0, -19.6]);
        assert_eq!(heard.take(Category::Warning), [""; 0]);
    }
}

/// A wall that the host moves by 0.05 m takes the nut along, and says so.
#[test]
fn a_wall_that_jumps_takes_a_free_nut_along() {
    for interface in [Interface::CoSimulation, Interface::ModelExchange] {
        let heard = Heard::default();
        let text =
            "t = 0 s: stop `wall` is passed by 0.05 m; moved apart: `feed` from 0 m to -0.05 m";
        let mut instance = started(heard.instance(free(), interface, true));
        if interface == Interface::CoSimulation {
            set(&mut instance, [("wall_place", -0.05)]);
            instance.do_step(0.0, 0.01).expect("it goes on");
        } else {
            instance.enter_event_mode().expect("legal");
            set(&mut instance, [("wall_place", -0.05)]);
            let event = instance.new_discrete_states().expect("it goes on");
            assert_eq!(event.states, StateChange::Values);
            let states: Vec<f64> = instance.continuous_states(2).expect("known").collect();
            assert_eq!(states, [-0.05, 0.0]);
        }
        assert_eq!(heard.take(Category::Warning), [text], "{interface:?}");
    }
}

/// A nut that runs into the wall at the start: the log tells it when initialization ends, and once more
/// after a reset, where initialization ends once more. The states are those after it
/// already.
#[test]
fn an_impact_at_the_start_is_logged_once_per_start() {
    let mechanism = nut(
        "[freedoms]\nfeed = { coordinate = \"x\", markers = [\"ground.S\", \"nut.N\"], \
         start = 0.12, velocity = 1 }",
    );
    for interface in Interface::ALL {
        let heard = Heard::default();
        let impacts = || {
            let mut told = heard.take(Category::Events);
            told.retain(|told| told.contains("stop `wall`"));
            told
        };
        let expected = ["t = 0.000000000 s: impact at stop `wall` with 1 m/s"];
        let mut instance = heard.instance(Arc::clone(&mechanism), interface, true);
        for _ in 0..2 {
            instance = started(instance);
            let told = impacts();
            assert_eq!(told[..1], expected);
            assert!(
                told[1..].iter().all(|told| told.contains("rest at")),
                "{told:?}"
            );
            if interface == Interface::CoSimulation {
                instance.do_step(0.0, 0.1).expect("it rests there");
                let [x, v] = get(&mut instance, ["feed.position", "feed.velocity"]);
                assert_eq!([x, v], [0.12, 0.0]);
                assert_eq!(impacts(), [] as [&str; 0]);
            }
            instance.reset().expect("legal");
        }
    }
}

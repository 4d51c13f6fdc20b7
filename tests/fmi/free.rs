//! FMUs of mechanisms with freedoms: states that are saved, derivatives, model exchange beside
//! co-simulation.

use biela::dynamics::integrator::{ErrorControl, Failure, Integrator, Method, System};
use biela::fmi::{
    Call, Category, Causality, Error, Interface, MechanismModel, Quantity, StateChange,
    StepProgress, Variable, Version, value_reference,
};
use biela::mechanism::Mechanism;
use std::sync::Arc;

use crate::clauses::{get, set, started, vr};
use crate::common::log::Heard;
use crate::common::{Instance, folder, instance_of, parse, shipped};
use crate::differences::{DIFFERENCE, differences};

/// Mechanisms with a force input, if they have one, and with their freedoms.
const FREE: [(&str, Option<&str>, &[&str]); 11] = [
    ("pendulum_free", None, &["swing"]),
    ("double_pendulum", None, &["shoulder", "elbow"]),
    ("engine_free", Some("load.effort"), &["crank_angle"]),
    ("five_bar_free", None, &["left_angle", "right_angle"]),
    ("four_bar_chain", None, &["post_angle"]),
    ("four_bar_free", Some("motor.effort"), &["crank_angle"]),
    ("slider_crank_motor", Some("motor.effort"), &["crank_angle"]),
    ("swinging_tip", None, &["swing"]),
    ("cart_pole", Some("push.effort"), &["travel", "lean"]),
    ("andrews_free", None, &["beta"]),
    ("wiper_motor", Some("voltage"), &["motor_angle"]),
];

/// The four-bar with longer crank and coupler, and with its rocker's angle as the freedom. No link
/// turns fully: every coordinate meets its dead points.
const ROCKER: (&str, Option<&str>, &[&str]) = ("rocker", Some("motor.effort"), &["swing"]);

/// A shipped mechanism, or the one above.
fn mechanism(name: &str) -> Arc<Mechanism> {
    if name != ROCKER.0 {
        return shipped(name);
    }
    let path = folder("mechanisms").join("four_bar_free.toml");
    let text = std::fs::read_to_string(path).expect("it is shipped");
    let text = text
        .replace("value = 0.30", "value = 0.24")
        .replace("value = 0.25", "value = 0.30")
        .replace("value = 0.10", "value = 0.20");
    let begin = text.find("crank_angle = ").expect("its freedom");
    let end = begin + text[begin..].find('\n').expect("a line");
    parse(&format!(
        "{}swing = {{ coordinate = \"angle\", markers = [\"ground.O4\", \"rocker.O\"], \
         start = \"92.27944*deg\", velocity = 4.0 }}{}",
        &text[..begin],
        &text[end..]
    ))
}

fn instance(name: &str, interface: Interface, version: Version) -> Instance {
    Heard::default().instance_of(version, mechanism(name), interface)
}

/// Initializes in co-simulation at 0 s.
fn running(name: &str, version: Version) -> Instance {
    started(instance(name, Interface::CoSimulation, version))
}

fn now(instance: &mut Instance) -> f64 {
    let [time] = get(instance, ["time"]);
    time
}

/// Takes a step, as a host of the instance's version does.
fn step(instance: &mut Instance, t: f64, h: f64) {
    if instance.version() == Version::Fmi2 {
        instance.do_step(t, h).expect("it moves");
    } else {
        let progress = instance.begin_step(t, h).expect("it moves");
        assert!(matches!(progress, StepProgress::Done(_)), "{progress:?}");
    }
}

/// The step of a host: a thirtieth of the way that is sensible for each mechanism.
fn step_size(name: &str) -> f64 {
    if name == "andrews_free" { 1e-3 } else { 0.02 }
}

/// Takes steps with a motor whose torque changes, and returns the bits of all Reals after each.
fn go_on(instance: &mut Instance, name: &str, input: Option<&str>, from: u32) -> Vec<Vec<u64>> {
    let h = step_size(name);
    let reals: Vec<u32> = (0..instance.variables().len())
        .filter(|place| instance.variables()[*place].kind.is_real())
        .map(value_reference)
        .collect();
    let steps = (from..from + 10).map(|index| {
        let t = h * f64::from(index);
        if let Some(input) = input {
            set(instance, [(input, 0.3 * (7.0 * t).cos())]);
        }
        step(instance, t, h);
        let values = instance.reals(&reals).expect("they exist");
        values.map(f64::to_bits).collect()
    });
    steps.collect()
}

/// From a state in the middle of a run all goes on to the same bits: in the same instance, in
/// another one that was elsewhere, and after the state has gone through bytes.
#[test]
fn a_state_in_the_middle_goes_on_to_the_same_bits() {
    for version in [Version::Fmi2, Version::Fmi3] {
        for (name, input, _) in FREE.into_iter().chain([ROCKER]) {
            let mut straight = running(name, version);
            let mut first = running(name, version);
            go_on(&mut straight, name, input, 0);
            go_on(&mut first, name, input, 0);
            let expected = go_on(&mut straight, name, input, 10);

            let state = first.fmu_state().expect("legal");
            assert_eq!(go_on(&mut first, name, input, 10), expected, "{name}");
            first.set_fmu_state(&state).expect("its own");
            assert_eq!(go_on(&mut first, name, input, 10), expected, "{name}");

            let mut other = running(name, version);
            go_on(&mut other, name, input, 0);
            go_on(&mut other, name, input, 10);
            let bytes = first.serialize_fmu_state(&state).expect("its own");
            let read = other.deserialize_fmu_state(&bytes).expect("untouched");
            assert_eq!(read, state, "{name}");
            other.set_fmu_state(&read).expect("the same mechanism");
            assert_eq!(go_on(&mut other, name, input, 10), expected, "{name}");
        }
    }
}

/// The size of a host's step and what it reads between does not matter to the marks.
#[test]
fn small_steps_end_where_large_ones_do() {
    for (name, _, freedoms) in FREE.into_iter().chain([ROCKER]) {
        let h = 10.0 * step_size(name);
        let mut large = running(name, Version::Fmi2);
        let mut small = running(name, Version::Fmi2);
        large.do_step(0.0, h).expect("it moves");
        for step in 0..50 {
            let t = h * f64::from(step) / 50.0;
            let next = h * f64::from(step + 1) / 50.0;
            small.do_step(t, next - t).expect("it moves");
        }
        for freedom in freedoms {
            for rate in ["position", "velocity"] {
                let output = format!("{freedom}.{rate}");
                let [one] = get(&mut large, [&output]);
                let [other] = get(&mut small, [&output]);
                // The default tolerance of 1e-8, of a run of one step and of one of fifty.
                let off = (one - other).abs() / (1.0 + one.abs());
                assert!(off < 1e-7, "{name}, {output}: {one} {other}");
            }
        }
    }
}

/// The value references of the variables that are wanted.
fn references(instance: &Instance, is_wanted: impl Fn(&Variable<Quantity>) -> bool) -> Vec<u32> {
    let variables = instance.variables().iter().enumerate();
    let wanted = variables.filter(|(_, variable)| is_wanted(variable));
    wanted.map(|(place, _)| value_reference(place)).collect()
}

/// The value references of outputs and derivatives that can be differentiated, but states.
fn unknowns(instance: &Instance) -> Vec<u32> {
    references(instance, |variable| {
        variable.is_unknown() && !variable.causality.is_state() && variable.kind.is_real()
    })
}

/// Derivatives of accelerations and of all outputs by states, force inputs and tunable parameters,
/// against central differences.
#[test]
fn derivatives_in_model_exchange_are_those_of_differences() {
    for version in [Version::Fmi2, Version::Fmi3] {
        for (name, input, freedoms) in FREE.into_iter().chain([ROCKER]) {
            let mut instance = hosted(name, version);
            let count = 2 * freedoms.len();
            if name == ROCKER.0 {
                fly_through_an_exchange(&mut instance);
            }
            if version == Version::Fmi3 {
                assert_eq!(instance.number_of_states(), Ok(count), "{name}");
            }
            // Away from rest, where much would vanish.
            let start: Vec<f64> = instance.continuous_states(count).expect("known").collect();
            let moved: Vec<f64> = start
                .iter()
                .zip(1..)
                .map(|(x, k)| x + 0.1 * f64::from(k))
                .collect();
            let time = now(&mut instance) + 0.1 * step_size(name);
            instance.set_time(time).expect("legal");
            instance.set_continuous_states(&moved).expect("legal");
            if let Some(input) = input {
                set(&mut instance, [(input, 0.7)]);
            }
            let states = references(&instance, |variable| variable.causality.is_state());
            let unknowns = unknowns(&instance);
            assert_eq!(states.len(), count, "{name}");
            for (place, &known) in states.iter().enumerate() {
                let exact = derivative(&mut instance, &unknowns, known);
                let found = differences_by_state(&mut instance, &unknowns, &moved, place);
                compare(&instance, name, &unknowns, known, &exact, &found);
            }
            if let Some(input) = input {
                let known = vr(&instance, input);
                let exact = derivative(&mut instance, &unknowns, known);
                let found = differences(&mut instance, &unknowns, known);
                compare(&instance, name, &unknowns, known, &exact, &found);
            }
        }
    }
}

#[track_caller]
fn derivative(instance: &mut Instance, unknowns: &[u32], known: u32) -> Vec<f64> {
    let along = instance.directional_derivative(unknowns, &[known], &[1.0]);
    along.unwrap_or_else(|error| panic!("{known}: {error}"))
}

/// Returns the derivatives of the unknowns by one state, by differences of fourth order.
fn differences_by_state(
    instance: &mut Instance,
    unknowns: &[u32],
    states: &[f64],
    place: usize,
) -> Vec<f64> {
    // As in `differences`.
    let step = 1e-5;
    let mut moved = |steps: f64| -> Vec<f64> {
        let mut states = states.to_vec();
        states[place] += steps * step;
        instance.set_continuous_states(&states).expect("legal");
        instance.reals(unknowns).expect("it closes").collect()
    };
    let [far_before, before, after, far_after] = [-2.0, -1.0, 1.0, 2.0].map(&mut moved);
    moved(0.0);
    let way = (states[place] + step) - (states[place] - step);
    let difference = |unknown: usize| {
        let (near, far) = (
            after[unknown] - before[unknown],
            far_after[unknown] - far_before[unknown],
        );
        (8.0 * near - far) / (6.0 * way)
    };
    (0..unknowns.len()).map(difference).collect()
}

#[track_caller]
fn compare(
    instance: &Instance,
    name: &str,
    unknowns: &[u32],
    known: u32,
    exact: &[f64],
    found: &[f64],
) {
    let label = |reference: u32| &instance.variables()[reference as usize - 1].name;
    // Rounding of the difference of large values is that of the values.
    let scale = exact.iter().fold(1.0_f64, |scale, d| scale.max(d.abs()));
    for ((unknown, exact), found) in unknowns.iter().zip(exact).zip(found) {
        let off = (exact - found).abs() / scale;
        assert!(
            off < DIFFERENCE,
            "{name}: d {}/d {}: {exact}, by differences {found}",
            label(*unknown),
            label(known)
        );
    }
}

/// In initialization mode of co-simulation: by the starts of the states and by parameters, too.
#[test]
fn derivatives_in_initialization_are_those_of_differences() {
    for (name, input, freedoms) in FREE.into_iter().chain([ROCKER]) {
        let mut instance = instance(name, Interface::CoSimulation, Version::Fmi2);
        instance.setup_experiment(0.0, None).expect("legal");
        instance.enter_initialization_mode().expect("legal");
        for (freedom, speed) in freedoms.iter().zip([0.8, -1.1]) {
            set(&mut instance, [(&format!("{freedom}.velocity"), speed)]);
        }
        if let Some(input) = input {
            set(&mut instance, [(input, 0.7)]);
        }
        let unknowns = unknowns(&instance);
        let mut knowns = references(&instance, |variable| {
            let is_parameter = variable.causality == Causality::Parameter;
            let has_start = matches!(
                variable.causality,
                Causality::State | Causality::StartedOutput
            );
            has_start || is_parameter && variable.kind.is_real()
        });
        knowns.extend(input.map(|input| vr(&instance, input)));
        for known in knowns {
            let exact = derivative(&mut instance, &unknowns, known);
            let found = differences(&mut instance, &unknowns, known);
            compare(&instance, name, &unknowns, known, &exact, &found);
        }
    }
}

/// Begins in model exchange at 0 s.
fn hosted(name: &str, version: Version) -> Instance {
    let mut instance = instance(name, Interface::ModelExchange, version);
    if version == Version::Fmi2 {
        return started(instance);
    }
    let entered = instance.enter_initialization_mode_at(0.0, None);
    entered.expect("legal");
    instance.exit_initialization_mode().expect("it starts");
    instance.new_discrete_states().expect("legal");
    instance.enter_continuous_time_mode().expect("legal");
    instance
}

/// Goes on, as a host of model exchange does, to a time or up to an event. Returns whether the states
/// were exchanged there.
fn host(instance: &mut Instance, until: f64) -> bool {
    let count = references(instance, |variable| variable.causality.is_state()).len();
    let start: Vec<f64> = instance.continuous_states(count).expect("known").collect();
    let nominals = instance.nominals(count).expect("known").collect();
    let control = ErrorControl::new(1e-9, nominals).expect("valid");
    let time = now(instance);
    let mut integrator =
        Integrator::new(Method::Explicit, control, time, start).expect("a valid start");
    while integrator.state().t.to_bits() != until.to_bits() {
        let mut host = Host {
            instance,
            has_event: false,
        };
        integrator.advance(&mut host, until).expect("it moves");
        if host.has_event {
            instance.enter_event_mode().expect("legal");
            let event = instance.new_discrete_states().expect("it goes on");
            instance.enter_continuous_time_mode().expect("legal");
            assert_eq!(event.states, StateChange::Exchange);
            assert!(!event.must_end);
            return true;
        }
    }
    false
}

/// Goes on until the states are exchanged, some steps after their last change.
fn fly_through_an_exchange(instance: &mut Instance) {
    let mut exchanged = false;
    while !exchanged {
        assert!(now(instance) < 5.0, "the rocker meets a dead point before");
        let until = now(instance) + 0.02;
        exchanged = host(instance, until);
    }
}

/// A host of model exchange.
struct Host<'a> {
    instance: &'a mut Instance,
    has_event: bool,
}

impl System for Host<'_> {
    type Cause = Error;

    fn derivatives(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<(), Failure<Error>> {
        let read = |instance: &mut Instance, dx: &mut [f64]| -> Result<(), Error> {
            instance.set_time(t)?;
            instance.set_continuous_states(x)?;
            let derivatives = instance.derivatives_of_states(x.len())?;
            dx.iter_mut().zip(derivatives).for_each(|(to, d)| *to = d);
            Ok(())
        };
        read(self.instance, dx).map_err(Failure::Trial)
    }

    fn accept(&mut self, t: f64, x: &[f64], _: &[f64]) -> Result<(), Failure<Error>> {
        let accept = |instance: &mut Instance| -> Result<bool, Error> {
            instance.set_time(t)?;
            instance.set_continuous_states(x)?;
            let step = instance.completed_integrator_step()?;
            assert!(!step.must_end);
            Ok(step.has_event)
        };
        self.has_event = accept(self.instance).map_err(Failure::Hard)?;
        Ok(())
    }
}

/// Integrated by the host, and by the FMU itself: the same, to the tolerances of both, through
/// exchanges of states.
#[test]
fn model_exchange_goes_where_co_simulation_goes() {
    for (name, _, freedoms) in FREE.into_iter().chain([ROCKER]) {
        for version in [Version::Fmi2, Version::Fmi3] {
            let is_rocker = name == ROCKER.0;
            let until = if is_rocker {
                1.0
            } else {
                10.0 * step_size(name)
            };
            let mut itself = running(name, version);
            step(&mut itself, 0.0, until);
            let mut hosted = hosted(name, version);
            let mut exchanges = 0;
            while now(&mut hosted) < until {
                exchanges += usize::from(host(&mut hosted, until));
            }
            assert!(!is_rocker || exchanges > 1, "{exchanges}");
            for freedom in freedoms {
                for rate in ["position", "velocity", "acceleration"] {
                    let output = format!("{freedom}.{rate}");
                    let [expected] = get(&mut itself, [&output]);
                    let [found] = get(&mut hosted, [&output]);
                    let off = (found - expected).abs() / (1.0 + expected.abs());
                    assert!(off < 1e-6, "{name}, {output}: {found} {expected}");
                }
            }
        }
    }
}

/// In exchanged coordinates all that moves freely depends on the inputs of drivers, too, and so on how
/// their rates are made.
#[test]
fn what_moves_freely_depends_on_the_rates_of_drivers() {
    let path = folder("mechanisms").join("five_bar_free.toml");
    let text = std::fs::read_to_string(path).expect("it is shipped");
    let driven = text.replace("[freedoms]\n", "[drivers]\n");
    let mixed = driven.replace("\nright_angle = ", "\n[freedoms]\nright_angle = ");
    let model = MechanismModel::new(parse(&mixed), Interface::CoSimulation).expect("it closes");
    let sink = Box::new(Heard::default());
    let mut instance = Instance::of_version(Version::Fmi3, model, sink, false);
    let entered = instance.enter_initialization_mode_at(0.0, None);
    entered.expect("legal");
    instance.exit_initialization_mode().expect("it starts");
    let crank = vr(&instance, "right_crank.phi");
    let known = instance.dependencies(Call::GetVariableDependencies, crank);
    let known: Vec<_> = known
        .expect("legal")
        .into_iter()
        .map(|(vr, _)| vr)
        .collect();
    for name in ["left_angle.position", "rates", "extrapolation", "state[1]"] {
        assert!(known.contains(&vr(&instance, name)), "{name}: {known:?}");
    }
}

/// A force that jumps at a communication point counts from there on: a block of 2 kg.
#[test]
fn a_force_that_jumps_acts_from_its_step_on() {
    let text = "format = 1\nname = \"block\"\n[ground.markers]\nO = [0, 0]\n\
        [bodies.block]\nmarkers = { B = [0, 0] }\nmass = 2\n\
        [joints]\nguide = { type = \"translational\", markers = [\"ground.O\", \"block.B\"] }\n\
        [freedoms]\nx = { coordinate = \"x\", markers = [\"ground.O\", \"block.B\"] }\n\
        [forces]\nmotor = { coordinate = \"x\", markers = [\"ground.O\", \"block.B\"] }\n";
    let mechanism: Arc<Mechanism> = parse(text);
    let mut instance = started(instance_of(mechanism, Interface::CoSimulation));
    let (mut x, mut v) = (0.0, 0.0);
    for (step, force) in (0..).zip([4.0, -1.0, 0.0, 8.0]) {
        set(&mut instance, [("motor.effort", force)]);
        // A reading before the step sees the new force at the old place.
        let [acceleration, velocity] = get(&mut instance, ["x.acceleration", "x.velocity"]);
        assert!((acceleration - 0.5 * force).abs() < 1e-14);
        assert!((velocity - v).abs() < 1e-13);
        instance
            .do_step(0.5 * f64::from(step), 0.5)
            .expect("it moves");
        x += 0.5 * v + 0.0625 * force;
        v += 0.25 * force;
        let found = get(&mut instance, ["x.position", "x.velocity"]);
        assert!((found[0] - x).abs() < 1e-12 && (found[1] - v).abs() < 1e-12);
    }
}

/// A host that has no tolerance may give zero: that of the file is used, without a word.
#[test]
fn a_tolerance_of_zero_is_none() {
    let run = |tolerance: Option<f64>| {
        let heard = Heard::default();
        let mechanism = shipped("double_pendulum");
        let mut instance = heard.instance(mechanism, Interface::CoSimulation, true);
        tolerance
            .into_iter()
            .for_each(|tolerance| instance.set_tolerance(tolerance));
        let mut instance = started(instance);
        let bits = go_on(&mut instance, "double_pendulum", None, 0);
        (bits, heard.take(Category::Warning))
    };
    let plain = run(None);
    assert_eq!(run(Some(0.0)), plain);
    assert_ne!(run(Some(1e-4)).0, plain.0);
    assert_ne!(run(Some(-1.0)).1, plain.1);
}

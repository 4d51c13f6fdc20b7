//! Declared dependencies (2.2.8) and directional derivatives (2.1.9), over all settings.

use std::collections::BTreeSet;

use biela::fmi::{Causality, Kind, Quantity, Unknown, Version, describe, value_reference};
use biela::kinematics::OutputSource;
use biela::mechanism::Order;

use crate::clauses::vr;
use crate::common::{Instance, assembled, co_simulation, references, shipped, stems};

/// All choices of `rates` and `extrapolation`.
const SETTINGS: [[i32; 2]; 6] = [[1, 1], [2, 1], [3, 1], [1, 2], [2, 2], [3, 2]];

/// Step size \[s\]: some lengths do not go further than a few centimetres at 0.7 m/s.
const H: f64 = 0.017;

fn outputs(instance: &Instance) -> Vec<u32> {
    references(instance, |quantity| {
        matches!(quantity, Quantity::Output(OutputSource::Signal(..)))
    })
}

fn inputs(instance: &Instance) -> Vec<u32> {
    references(instance, |quantity| matches!(quantity, Quantity::Input(..)))
}

/// Returns values for inputs at a time.
type Inputs = fn(&Instance, &[u32], f64) -> Vec<f64>;

/// Returns values for all inputs, each different from its start value.
fn moving(instance: &Instance, inputs: &[u32], t: f64) -> Vec<f64> {
    let values = inputs.iter().enumerate().map(|(place, &reference)| {
        let variable = &instance.variables()[reference as usize - 1];
        let (Quantity::Input(_, order), Kind::Real { start, .. }) =
            (variable.quantity, &variable.kind)
        else {
            panic!("no input");
        };
        let start = start.expect("inputs have start values");
        match order {
            Order::Position => start + 0.003 + 0.1 * t * t,
            Order::Velocity => 0.7 + 0.1 * place as f64 + 0.2 * t,
            Order::Acceleration => -0.4 + 0.1 * place as f64,
        }
    });
    values.collect()
}

/// Returns an instance in initialization mode, between the points of every table.
fn initializing(name: &str, settings: [i32; 2]) -> Instance {
    let mut instance = co_simulation(name);
    instance.setup_experiment(0.317, None).expect("legal");
    let choices = references(&instance, |quantity| {
        matches!(quantity, Quantity::RateSource | Quantity::Extrapolation)
    });
    let settings = &settings[..choices.len()];
    instance.set_integer(&choices, settings).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    instance
}

/// Returns the same with accelerations of zero, so that `auto` takes differences of velocities.
fn coasting(instance: &Instance, inputs: &[u32], t: f64) -> Vec<f64> {
    let mut values = moving(instance, inputs, t);
    for driver in values.chunks_mut(3) {
        driver[2] = 0.0;
    }
    values
}

/// Returns an instance after four steps, so that each estimate has its three samples.
fn running(name: &str, settings: [i32; 2]) -> Instance {
    running_at(name, settings, moving)
}

/// Returns the same for the values that `at` returns for the inputs at a time.
fn running_at(name: &str, settings: [i32; 2], at: Inputs) -> Instance {
    let mut instance = initializing(name, settings);
    instance.exit_initialization_mode().expect("it starts");
    let inputs = inputs(&instance);
    for step in 0..4 {
        let t = H * f64::from(step);
        let values = at(&instance, &inputs, t);
        instance.set_real(&inputs, &values).expect("inputs");
        let point = instance.last_successful_time();
        instance.do_step(point, H).expect("it is not far");
    }
    instance
}

fn read(instance: &mut Instance, references: &[u32]) -> Vec<f64> {
    let values = instance.reals(references).expect("it stands");
    values.collect()
}

/// Returns the variables of `unknowns` that differ between two readings.
fn differing(unknowns: &[u32], one: &[f64], other: &[f64]) -> Vec<u32> {
    let changed = unknowns.iter().zip(one).zip(other);
    changed
        // Rounding of accelerations up to some thousand.
        .filter(|&((_, one), other)| (one - other).abs() > 1e-9 * (1.0 + one.abs()))
        .map(|((&unknown, _), _)| unknown)
        .collect()
}

/// Returns the value references of continuous states.
fn states(instance: &Instance) -> Vec<u32> {
    (1..)
        .zip(instance.variables())
        .filter_map(|(vr, variable)| (variable.causality.is_state()).then_some(vr))
        .collect()
}

/// Asserts that the model description declares a dependency of each of `changed` on one of `knowns`.
fn assert_declared(declared: &[Unknown], changed: &[u32], knowns: &[u32], context: &str) {
    for &unknown in changed {
        let entry = declared
            .iter()
            .find(|entry| entry.value_reference == unknown);
        let entry = entry.unwrap_or_else(|| panic!("{context}: {unknown} is not listed"));
        assert!(
            knowns
                .iter()
                .any(|known| entry.dependencies.contains_key(known)),
            "{context}: {unknown} depends on {knowns:?}"
        );
    }
}

/// A step with one input perturbed changes only outputs that declare it, in every setting.
#[test]
fn outputs_depend_on_declared_inputs_and_time_only() {
    for name in stems("mechanisms", "toml") {
        let (solver, _) = assembled(&shipped(&name));
        let description = describe(solver.mechanism(), solver.structure(), Version::Fmi2);
        for settings in SETTINGS {
            let mut instance = running(&name, settings);
            let (inputs, outputs) = (inputs(&instance), outputs(&instance));
            // Over a step time and forces act by the states, too.
            let by = |known: u32| [vec![known], states(&instance)].concat();
            let [by_inputs, by_time] = [
                inputs.iter().copied().map(by).collect::<Vec<_>>(),
                vec![by(vr(&instance, "time"))],
            ];
            let point = instance.last_successful_time();
            let before = instance.fmu_state().expect("legal");
            let mut after = |known: Option<usize>, h: f64| {
                instance.set_fmu_state(&before).expect("its own");
                let mut values = moving(&instance, &inputs, 4.0 * H);
                if let Some(known) = known {
                    values[known] += 1e-4;
                }
                instance.set_real(&inputs, &values).expect("inputs");
                instance.do_step(point, h).expect("it is not far");
                read(&mut instance, &outputs)
            };
            let base = after(None, H);
            for (known, references) in by_inputs.iter().enumerate() {
                let changed = differing(&outputs, &base, &after(Some(known), H));
                let context = format!("{name} {settings:?}");
                assert_declared(&description.outputs, &changed, references, &context);
            }
            // With held inputs, a longer step changes what depends on time itself.
            if settings == [2, 1] {
                let changed = differing(&outputs, &base, &after(None, 1.01 * H));
                assert_declared(&description.outputs, &changed, &by_time[0], &name);
            }
        }
    }
}

#[test]
fn initial_unknowns_depend_on_declared_knowns_only() {
    for name in stems("mechanisms", "toml") {
        let (solver, _) = assembled(&shipped(&name));
        let description = describe(solver.mechanism(), solver.structure(), Version::Fmi2);
        for settings in SETTINGS {
            let context = format!("{name} {settings:?}");
            let mut instance = initializing(&name, settings);
            let inputs = inputs(&instance);
            let values = moving(&instance, &inputs, 0.0);
            instance.set_real(&inputs, &values).expect("inputs");
            let mut unknowns = outputs(&instance);
            unknowns.extend(
                (1..)
                    .zip(instance.variables())
                    .filter_map(|(vr, variable)| {
                        (variable.causality == Causality::CalculatedParameter).then_some(vr)
                    }),
            );
            let base = read(&mut instance, &unknowns);
            let parameters = (1..)
                .zip(instance.variables())
                .filter_map(|(vr, variable)| {
                    let real =
                        variable.causality == Causality::Parameter && variable.kind.is_real();
                    real.then_some(vr)
                });
            let knowns: Vec<u32> = parameters.chain(inputs.iter().copied()).collect();
            for known in knowns {
                let [value] = read(&mut instance, &[known])[..] else {
                    panic!("one was read")
                };
                instance.set_real(&[known], &[value + 1e-5]).expect("near");
                let changed = differing(&unknowns, &base, &read(&mut instance, &unknowns));
                assert_declared(&description.initial_unknowns, &changed, &[known], &context);
                instance.set_real(&[known], &[value]).expect("as before");
            }
            // The settings themselves.
            for setting in ["rates", "extrapolation"] {
                let found = instance.variables().iter().position(|v| v.name == setting);
                let Some(known) = found else { continue };
                let known = value_reference(known);
                let value = instance.integers(&[known]).expect("legal").next();
                for choice in 1..=3 {
                    if instance.set_integer(&[known], &[choice]).is_ok() {
                        let changed = differing(&unknowns, &base, &read(&mut instance, &unknowns));
                        assert_declared(
                            &description.initial_unknowns,
                            &changed,
                            &[known],
                            &context,
                        );
                    }
                }
                let value = value.expect("one was read");
                instance.set_integer(&[known], &[value]).expect("as before");
            }
        }
    }
}

/// The union over all settings is no larger than it has to be.
#[test]
fn each_declared_input_acts_in_some_setting() {
    let name = "four_bar";
    let (solver, _) = assembled(&shipped(name));
    let description = describe(solver.mechanism(), solver.structure(), Version::Fmi2);
    let mut acting = BTreeSet::new();
    let runs = SETTINGS.map(|settings| {
        [
            (settings, moving as fn(&_, &_, _) -> _),
            (settings, coasting),
        ]
    });
    for &(settings, at) in runs.as_flattened() {
        let mut instance = running_at(name, settings, at);
        let (inputs, outputs) = (inputs(&instance), outputs(&instance));
        let point = instance.last_successful_time();
        let before = instance.fmu_state().expect("legal");
        let mut after = |known: u32, by: f64| {
            instance.set_fmu_state(&before).expect("its own");
            let mut values = at(&instance, &inputs, 4.0 * H);
            values[known as usize - 1] += by;
            instance.set_real(&inputs, &values).expect("inputs");
            instance.do_step(point, H).expect("it is not far");
            read(&mut instance, &outputs)
        };
        for &known in &inputs {
            let (base, moved) = (after(known, 0.0), after(known, 1e-2));
            let changed = differing(&outputs, &base, &moved);
            acting.extend(changed.into_iter().map(|unknown| (unknown, known)));
        }
    }
    let declared: BTreeSet<_> = description
        .outputs
        .iter()
        .flat_map(|unknown| {
            unknown
                .dependencies
                .keys()
                .map(|&known| (unknown.value_reference, known))
        })
        .collect();
    assert_eq!(declared, acting);
}

/// Part of a known over which differences of fourth order are taken; its fourth power is their
/// truncation, and rounding of 1e-16 is divided by it.
const STEP: f64 = 1e-5;
/// Error of such a difference, relative to the largest derivative of the same order of time.
const DIFFERENCE: f64 = 1e-6;

/// Asserts that derivatives agree with differences of the values that `at` returns for a change.
fn assert_derivatives(
    context: &str,
    orders: &[usize],
    exact: &[f64],
    mut at: impl FnMut(f64) -> Vec<f64>,
) {
    let [far_before, before, after, far_after] = [-2.0, -1.0, 1.0, 2.0].map(|k| at(k * STEP));
    let mut largest = [1.0_f64; 3];
    for (exact, &order) in exact.iter().zip(orders) {
        largest[order] = largest[order].max(exact.abs());
    }
    for (index, (exact, &order)) in exact.iter().zip(orders).enumerate() {
        let near = after[index] - before[index];
        let far = far_after[index] - far_before[index];
        let difference = (8.0 * near - far) / (12.0 * STEP);
        assert!(
            (exact - difference).abs() <= DIFFERENCE * largest[order],
            "{context}: output {index}: {exact} and {difference}"
        );
    }
}

fn orders(instance: &Instance, outputs: &[u32]) -> Vec<usize> {
    let order = |&vr: &u32| match instance.variables()[vr as usize - 1].quantity {
        Quantity::Output(OutputSource::Signal(_, order)) => order as usize,
        _ => panic!("no output"),
    };
    outputs.iter().map(order).collect()
}

/// In every setting: the derivatives are those of the whole step, estimates and extrapolation
/// included.
#[test]
fn derivatives_by_inputs_are_those_of_the_step() {
    // Other settings than `auto` do not ask whether an acceleration is zero.
    let auto = SETTINGS.into_iter().filter(|settings| settings[0] == 1);
    let cases: Vec<([i32; 2], Inputs)> = SETTINGS
        .map(|settings| (settings, moving as Inputs))
        .into_iter()
        .chain(auto.map(|settings| (settings, coasting as Inputs)))
        .collect();
    for name in stems("mechanisms", "toml") {
        for &(settings, at) in &cases {
            let mut instance = running_at(&name, settings, at);
            let (inputs, outputs) = (inputs(&instance), outputs(&instance));
            let orders = orders(&instance, &outputs);
            let point = instance.last_successful_time();
            let before = instance.fmu_state().expect("legal");
            let values = at(&instance, &inputs, 4.0 * H);
            for (index, &known) in inputs.iter().enumerate() {
                // With `auto` an acceleration comes into use once it is not zero: no derivative.
                if settings[0] == 1 && values[index] == 0.0 {
                    continue;
                }
                let step = |instance: &mut Instance, by: f64| {
                    instance.set_fmu_state(&before).expect("its own");
                    let mut values = values.clone();
                    values[index] += by;
                    instance.set_real(&inputs, &values).expect("inputs");
                    instance.do_step(point, H).expect("it is not far");
                    read(instance, &outputs)
                };
                step(&mut instance, 0.0);
                let exact = instance
                    .directional_derivative(&outputs, &[known], &[1.0])
                    .expect("the pose is regular");
                let context = format!("{name} {settings:?} by {known}");
                let steps = |by: f64| step(&mut instance, by);
                assert_derivatives(&context, &orders, &exact, steps);
            }
        }
    }
}

/// "If a variable with causality = independent is explicitly defined …, a directional derivative
/// with respect to this variable can be computed."
#[test]
fn derivatives_by_time_are_those_of_prescribed_motions() {
    for name in stems("mechanisms", "toml") {
        let at = |start: f64| {
            let mut instance = co_simulation(&name);
            instance.setup_experiment(start, None).expect("legal");
            let inputs = inputs(&instance);
            let values = moving(&instance, &inputs, 0.0);
            instance.set_real(&inputs, &values).expect("inputs");
            let choices = references(&instance, |quantity| quantity == Quantity::RateSource);
            let rates = vec![2; choices.len()];
            instance.set_integer(&choices, &rates).expect("legal");
            instance.enter_initialization_mode().expect("legal");
            instance
        };
        let mut instance = at(0.317);
        let outputs = outputs(&instance);
        let orders = orders(&instance, &outputs);
        let time = vr(&instance, "time");
        let exact = instance
            .directional_derivative(&outputs, &[time], &[1.0])
            .expect("the pose is regular");
        let values = |by: f64| read(&mut at(0.317 + by), &outputs);
        assert_derivatives(&format!("{name} by time"), &orders, &exact, values);
    }
}

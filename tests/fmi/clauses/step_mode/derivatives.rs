//! Derivatives and dependencies of FMI 3.0, at run time.

use biela::fmi::{Call, CoSimulation, Version, describe};

use super::{agreed, instance_of, running, step};
use crate::clauses::{get, set, vr};
use crate::common::log::Heard;
use crate::common::shipped;

/// v·(J u) = (Jᵀ v)·u, by inputs, parameters and time, in initialization and after steps.
#[test]
fn adjoint_derivatives_are_those_of_the_transposed_jacobian() {
    for name in crate::common::stems("mechanisms", "toml") {
        let mut instance = instance_of(&name, CoSimulation::default(), &Heard::default());
        instance.enter_initialization_mode_at(0.0, None).unwrap();
        let of = |causality: &[biela::fmi::Causality]| -> Vec<u32> {
            let variables = instance.variables().iter().enumerate();
            variables
                .filter(|(_, v)| causality.contains(&v.causality) && v.kind.is_real())
                .map(|(place, _)| biela::fmi::value_reference(place))
                .collect()
        };
        use biela::fmi::Causality::{Independent, Input, Output, Parameter};
        let (knowns, unknowns) = (of(&[Input, Parameter, Independent]), of(&[Output]));
        let u: Vec<f64> = (0..knowns.len()).map(|k| (k as f64 + 1.0).sin()).collect();
        let v: Vec<f64> = (0..unknowns.len())
            .map(|k| (k as f64 + 2.0).cos())
            .collect();
        for stepped in [false, true] {
            if stepped {
                instance.exit_initialization_mode().unwrap();
                let h = 1e-3;
                for n in 0..3 {
                    step(&mut instance, h * f64::from(n), h);
                }
            }
            let Ok(ju) = instance.directional_derivative(&unknowns, &knowns, &u) else {
                // A motion that begins with a jump of its rate.
                assert!(instance.adjoint_derivative(&unknowns, &knowns, &v).is_err());
                continue;
            };
            let jv = instance.adjoint_derivative(&unknowns, &knowns, &v).unwrap();
            let left: f64 = ju.iter().zip(&v).map(|(a, b)| a * b).sum();
            let right: f64 = jv.iter().zip(&u).map(|(a, b)| a * b).sum();
            let scale: f64 = ju.iter().zip(&v).map(|(a, b)| (a * b).abs()).sum::<f64>()
                + jv.iter().zip(&u).map(|(a, b)| (a * b).abs()).sum::<f64>();
            assert!(
                (left - right).abs() <= 1e-11 * scale,
                "{name}: {left} {right}"
            );
        }
    }
}

/// 2.2.9: dependencies at run time are those of the model description.
#[test]
fn dependencies_at_run_time_are_those_of_the_model_description() {
    for name in ["four_bar", "slider_crank", "pendulum"] {
        let mechanism = shipped(name);
        let (solver, _) = crate::common::assembled(&mechanism);
        let description = describe(&mechanism, solver.structure(), Version::Fmi3);
        let mut instance = instance_of(name, CoSimulation::default(), &Heard::default());
        let call = Call::GetVariableDependencies;
        let expected = |unknown: &biela::fmi::Unknown| -> Vec<_> {
            let mut all = unknown.dependencies.clone();
            all.extend(&unknown.parameters);
            all.into_iter().collect()
        };
        for unknown in &description.initial_unknowns {
            let found = instance
                .dependencies(call, unknown.value_reference)
                .unwrap();
            assert_eq!(found, expected(unknown));
        }
        instance.enter_initialization_mode_at(0.0, None).unwrap();
        instance.exit_initialization_mode().unwrap();
        for unknown in &description.outputs {
            let found = instance
                .dependencies(call, unknown.value_reference)
                .unwrap();
            assert_eq!(found, expected(unknown));
        }
        let input = instance.dependencies(call, 1).unwrap();
        assert_eq!(input, []);
    }
}

/// In event mode a host changes values without a step: derivatives are those of values that it sets
/// and gets there (3.0.2, 2.2.11).
#[test]
fn derivatives_in_event_mode_are_those_of_set_and_get() {
    let mut instance = running("four_bar", agreed(true, false));
    for n in 0..3 {
        let t = 0.01 * f64::from(n);
        set(&mut instance, [("crank_angle.position", 1.05 + t)]);
        step(&mut instance, t, 0.01);
    }
    instance.enter_event_mode().unwrap();
    let outputs = ["crank.phi", "crank.omega", "crank.alpha"];
    let references = outputs.map(|name| vr(&instance, name));
    let position = vr(&instance, "crank_angle.position");
    let exact = instance.directional_derivative(&references, &[position], &[1.0]);
    assert_eq!(exact.unwrap(), [1.0, 0.0, 0.0]);
    let before = get(&mut instance, outputs);
    set(&mut instance, [("crank_angle.position", 1.09)]);
    let [phi, rates @ ..] = get(&mut instance, outputs);
    assert_eq!(phi, 1.09);
    assert_eq!(rates, before[1..]);
}

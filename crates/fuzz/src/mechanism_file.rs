//! Mechanism files: whatever the text, it is a mechanism or it is told why not.

use std::sync::Arc;

use biela::fmi::{Causality, Interface, Quantity, Version};
use biela::kinematics::OutputSource;
use biela::mechanism::{Mechanism, Order, Source};

use crate::{instance, reals};

/// More text brings nothing new, only time.
const LONGEST: usize = 1 << 14;

/// Reads the bytes as a file; a mechanism that assembles then runs, and does not come to an end
/// that nobody is told of.
///
/// # Panics
///
/// A fault of biela.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    if text.len() > LONGEST {
        return;
    }
    let source = Source::new("fuzz.toml", text);
    let (mechanism, diagnostics) = match Mechanism::parse(&source) {
        Ok((mechanism, warnings)) => (Some(mechanism), warnings),
        Err(diagnostics) => (None, diagnostics),
    };
    assert!(mechanism.is_some() || !diagnostics.is_empty(), "no reason");
    for diagnostic in diagnostics {
        assert!(!diagnostic.one_line(&source).contains('\n'));
    }
    let Some(mechanism) = mechanism else { return };
    let mechanism = Arc::new(mechanism);
    for interface in Interface::ALL {
        run_instance(&mechanism, interface);
    }
}

fn run_instance(mechanism: &Arc<Mechanism>, interface: Interface) {
    let Ok(mut instance) = instance(mechanism, Version::Fmi2, interface) else {
        return;
    };
    let reals = reals(&instance);
    let ready = instance
        .setup_experiment(0.0, None)
        .and_then(|()| instance.enter_initialization_mode())
        .and_then(|()| instance.exit_initialization_mode());
    if ready.is_err() {
        return;
    }
    let all = |causality| -> Vec<u32> {
        let variables = (1..).zip(instance.variables());
        variables
            .filter(|(_, variable)| variable.causality == causality)
            .map(|(reference, _)| reference)
            .collect()
    };
    let (inputs, outputs) = (all(Causality::Input), all(Causality::Output));
    if interface == Interface::ModelExchange {
        instance.enter_continuous_time_mode().expect("legal");
    }
    for step in 0..3 {
        let time = 0.1 * f64::from(step);
        let mut values = vec![0.0; inputs.len()];
        if instance.get_real(&inputs, &mut values).is_err() {
            return;
        }
        for value in values.iter_mut().step_by(3) {
            *value += 0.05;
        }
        instance.set_real(&inputs, &values).expect("it is finite");
        let gone = match interface {
            Interface::CoSimulation => instance.do_step(time, 0.1),
            Interface::ModelExchange => instance
                .set_time(time + 0.1)
                .and_then(|()| instance.completed_integrator_step())
                .map(drop),
        };
        let read = instance.reals(&reals).map(Iterator::collect::<Vec<_>>);
        if let Ok(values) = read {
            // A motion may be infinitely fast; a pose is a pose.
            let positions = values.iter().zip(&reals).filter(|&(_, &reference)| {
                let quantity = instance.variables()[reference as usize - 1].quantity;
                matches!(
                    quantity,
                    Quantity::Output(OutputSource::Signal(_, Order::Position))
                )
            });
            for (value, _) in positions {
                assert!(value.is_finite(), "a position is {value}");
            }
        }
        if let [known, ..] = inputs[..] {
            // There may be none at a singular position.
            let _ = instance.directional_derivative(&outputs, &[known], &[1.0]);
        }
        if gone.is_err() {
            return;
        }
    }
    let state = instance.fmu_state().expect("it is running");
    let bytes = instance.serialize_fmu_state(&state).expect("it is its own");
    let again = instance.deserialize_fmu_state(&bytes);
    assert_eq!(again, Ok(state), "what was written is what is read");
}

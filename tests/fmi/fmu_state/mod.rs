//! FMU states: going on from one, and bytes that are none.

mod bytes;
mod going_on;

use crate::common::{Instance, co_simulation, references, stems};
use biela::fmi::{Error, Kind, Quantity, State};
use biela::mechanism::Order;

/// The shipped mechanisms that can take steps of 0.1 s. The motor of `andrews_free` turns a hundred
/// times in the first of them, and faster and faster; `free` has its states.
fn mechanisms() -> impl Iterator<Item = String> {
    let names = stems("mechanisms", "toml").into_iter();
    names.filter(|name| name != "andrews_free")
}

fn initialized(name: &str, settings: [i32; 2]) -> Instance {
    let mut instance = co_simulation(name);
    instance.setup_experiment(0.0, Some(10.0)).expect("legal");
    let choices: Vec<u32> = references(&instance, |quantity| {
        matches!(quantity, Quantity::RateSource | Quantity::Extrapolation)
    });
    instance
        .set_integer(&choices, &settings[..choices.len()])
        .expect("there are such choices");
    instance.enter_initialization_mode().expect("legal");
    instance.exit_initialization_mode().expect("it starts");
    instance
}

/// All variables to the last bit, and what the status functions tell.
#[derive(Debug, PartialEq)]
struct Look {
    state: State,
    reals: Result<Vec<u64>, Error>,
    integers: Result<Vec<i32>, Error>,
    last: u64,
    terminated: bool,
}

fn look(instance: &mut Instance) -> Look {
    let (reals, integers): (Vec<u32>, Vec<u32>) = (1..=instance.variables().len() as u32)
        .partition(|&reference| {
            let variable = &instance.variables()[reference as usize - 1];
            matches!(variable.kind, Kind::Real { .. })
        });
    let values = instance.reals(&reals);
    let reals = values.map(|values| values.map(f64::to_bits).collect());
    let values = instance.integers(&integers);
    let integers = values.map(Iterator::collect);
    Look {
        state: instance.state(),
        reals,
        integers,
        last: instance.last_successful_time().to_bits(),
        terminated: instance.is_terminated(),
    }
}

/// A step: how it ended, and what is to be seen after it.
#[derive(Debug, PartialEq)]
struct Act {
    outcome: Result<(), Error>,
    look: Look,
}

/// One step of a host that uses all that there is to use.
fn act(instance: &mut Instance, step: u32) -> Act {
    let t = 0.1 * f64::from(step);
    for position in references(instance, |quantity| {
        matches!(quantity, Quantity::Input(_, Order::Position))
    }) {
        let start = match instance.variables()[position as usize - 1].kind {
            Kind::Real { start, .. } => start.expect("inputs have start values"),
            _ => unreachable!("inputs are Reals"),
        };
        let value = start + 0.03 * (5.0 * t).sin();
        // Refused after a step that failed.
        let _ = instance.set_real(&[position], &[value]);
        if step % 4 == 1 {
            let _ = instance.set_real(&[position + 1], &[0.15 * (5.0 * t).cos()]);
        }
        if step % 5 == 2 {
            let _ = instance.set_real_input_derivatives(
                &[position, position + 1],
                &[1, 1],
                &[0.15 * (5.0 * t).cos(), 0.1],
            );
        }
    }
    if step % 3 == 2 {
        let _ = look(instance);
    }
    let outcome = instance.do_step(t, 0.1);
    Act {
        outcome,
        look: look(instance),
    }
}

fn go_on(instance: &mut Instance, from: u32) -> Vec<Act> {
    (from..from + 8).map(|step| act(instance, step)).collect()
}

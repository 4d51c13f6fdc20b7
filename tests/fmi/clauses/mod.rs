//! Clauses of FMI 2.0.5 and 3.0.2, by section, and how hosts' algorithms fare with them.

#![allow(
    clippy::float_cmp,
    reason = "values that are set come back to the last bit, and a pose that stays does"
)]

mod dependencies;
mod derived;
mod exchange;
mod logging;
mod masters;
mod rates;
mod step_mode;
mod times;
mod values;

use crate::common::{Instance, co_simulation};
use biela::fmi::{Interface, Version, value_reference};

/// Returns the value reference of a variable.
pub(crate) fn vr(instance: &Instance, name: &str) -> u32 {
    let mut variables = instance.variables().iter();
    let found = variables.position(|variable| variable.name == name);
    value_reference(found.unwrap_or_else(|| panic!("no variable `{name}`")))
}

/// Returns the values of Real variables.
pub(crate) fn get<const N: usize>(instance: &mut Instance, names: [&str; N]) -> [f64; N] {
    let references = names.map(|name| vr(instance, name));
    let mut values = [0.0; N];
    let read = instance.get_real(&references, &mut values);
    read.unwrap_or_else(|error| panic!("{names:?}: {error}"));
    values
}

/// Sets Real variables.
pub(crate) fn set<const N: usize>(instance: &mut Instance, values: [(&str, f64); N]) {
    let references = values.map(|(name, _)| vr(instance, name));
    let set = instance.set_real(&references, &values.map(|(_, value)| value));
    set.unwrap_or_else(|error| panic!("{values:?}: {error}"));
}

/// Initializes at 0 s; in model exchange the host integrates then.
pub(crate) fn started(mut instance: Instance) -> Instance {
    match instance.version() {
        Version::Fmi2 => {
            instance.setup_experiment(0.0, None).expect("legal");
            instance.enter_initialization_mode().expect("legal");
        }
        Version::Fmi3 => {
            let entered = instance.enter_initialization_mode_at(0.0, None);
            entered.expect("legal");
        }
    }
    leave_initialization(&mut instance);
    instance
}

/// Returns an instance of a shipped mechanism for co-simulation, initialized at 0 s.
pub(crate) fn running(name: &str) -> Instance {
    started(co_simulation(name))
}

/// Initializes with the settings made.
pub(crate) fn initialized(instance: &mut Instance) {
    instance.enter_initialization_mode().expect("legal");
    leave_initialization(instance);
}

fn leave_initialization(instance: &mut Instance) {
    instance.exit_initialization_mode().expect("it starts");
    if instance.interface() == Interface::ModelExchange {
        instance.new_discrete_states().expect("legal");
        instance.enter_continuous_time_mode().expect("legal");
    }
}

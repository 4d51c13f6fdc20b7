//! The FMU: the standard's clauses, instances, states, the C interface.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/differences.rs"]
#[allow(dead_code, reason = "the tests of the solver use all of it")]
mod differences;

mod budget;
mod c_host;
mod clauses;
mod contacts;
mod fmu_state;
mod free;
mod hostile;
mod inputs;
mod instance;
mod model;
mod model_description;
mod stops;

//! The FMU: the standard's clauses, instances, states, the C interface.

#[path = "../common/mod.rs"]
mod common;

mod c_host;
mod clauses;
mod fmu_state;
mod hostile;
mod instance;
mod model;
mod model_description;

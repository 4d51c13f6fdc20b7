//! The FMU: variables, co-simulation instance, C interface, model description and packaging.
//!
//! The same library serves every mechanism. Exporting writes the mechanism's file and the
//! [model description](model_description) made from its [table of variables](Variables) into an
//! archive beside this library; instantiating reads the mechanism back. An [`Instance`] is safe
//! Rust and knows nothing of C; `abi` wraps it. An [`FmuState`] is what it can be set back to.

mod abi;
mod codec;
mod guid;
mod inputs;
mod instance;
mod log;
pub mod model_description;
mod package;
mod serialized;
mod state;
mod uri;
mod variables;

pub use guid::guid;
pub use instance::{Error, FmuState, Instance, StateError, Status};
pub use log::{Category, Sink};
pub use package::{Document, PackageError, Platform, RESOURCE, RuntimeLibrary, write_fmu};
pub use state::{Call, State};
pub use uri::{UriError, resource_path};
pub use variables::{
    Causality, Enumeration, Kind, Order, Quantity, TABLE_VERSION, Variability, Variable, Variables,
};

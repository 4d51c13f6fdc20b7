//! FMI 2.0: models as FMUs, for co-simulation and for model exchange.
//!
//! | part | knows | |
//! |---|---|---|
//! | `abi` | C | the functions of `fmi2Functions.h`; pointers in, status out |
//! | [`Instance`] | the standard | the state machine, what may be set when, log, FMU states |
//! | [`Model`] | | what an instance asks of a model |
//! | [`MechanismModel`] | mechanisms | a mechanism and its solver as a model |
//! | [`ModelDescription`], [`write_fmu`] | the archive | XML and packaging |
//!
//! All but [`MechanismModel`] and what belongs to it know nothing of mechanisms. An [`Instance`]
//! is safe Rust; every call of the C interface has its twin there.
//!
//! The same library serves every mechanism. Exporting writes the mechanism's file and the model
//! description made from its [table of variables](variables()) into an archive beside this
//! library; instantiating reads the mechanism back.

mod abi;
mod codec;
pub(crate) mod error;
mod instance;
mod log;
mod mechanism;
mod model;
mod model_description;
mod package;
mod serialized;
mod state;
mod uri;
mod variable;

pub use codec::{Codec, Unreadable};
pub use error::{Error, Failure, StateError, Status};
pub use instance::{FmuState, Instance};
pub use log::{Category, Logger, Sink};
pub use mechanism::{
    MechanismModel, MechanismState, Order, Quantity, RESOURCE, TABLE_VERSION, describe, guid,
    variables, write_fmu,
};
pub use model::Model;
pub use model_description::{Capabilities, Experiment, ModelDescription, Unknown};
pub use package::{Document, PackageError, Platform, RuntimeLibrary, write as write_archive};
pub use state::{Call, Interface, Phase, State};
pub use uri::{UriError, resource_path};
pub use variable::{Causality, Enumeration, Kind, Variability, Variable};

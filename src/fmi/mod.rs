//! FMI 2.0 and 3.0: a mechanism as an FMU, for co-simulation and for model exchange.
//!
//! | part | subject |
//! |---|---|
//! | `abi` | the functions of `fmi2Functions.h` and `fmi3Functions.h`: pointers in, status out |
//! | [`Instance`] | the standard: state machine, permitted values, log, FMU states |
//! | [`Model`] | the interface between an instance and a model |
//! | [`MechanismModel`] | a mechanism and its solver as a model |
//! | [`ModelDescription`], [`write_fmu`] | `modelDescription.xml` and the archive |
//!
//! Only `mechanism_model` knows mechanisms. Only `abi` knows C: an [`Instance`] is safe Rust and
//! has a method for every function of the C interface.
//!
//! One library serves all mechanisms. The export packs it together with the mechanism's file and
//! the model description, which comes from the [table of variables](variables()). The FMU reads
//! the mechanism when the host instantiates it.

#[cfg(feature = "abi")]
mod abi;
mod codec;
pub(crate) mod error;
mod instance;
mod log;
mod mechanism_model;
mod model;
mod model_description;
mod package;
mod serialized;
mod state;
mod status;
mod uri;
mod variable;

pub use codec::{Codec, Unreadable};
pub use error::{Error, Failure, StateError, check_limits};
pub use instance::{
    CoSimulation, CompletedStep, EventResult, FmuState, Instance, Reals, StepOutcome, StepProgress,
};
pub use log::{Advice, Category, Logger, Sink};
pub use mechanism_model::{
    MechanismModel, MechanismState, Quantity, RESOURCE, TABLE_VERSION, describe, guid, variables,
    write_fmu,
};
pub use model::{Groups, Model, StateChange};
pub use model_description::{
    Capabilities, DependencyKind, Document, Experiment, Member, ModelDescription, Terminal, Unknown,
};
pub use package::{Platform, RuntimeLibrary, write as write_archive};
pub use state::{Call, Interface, Phase, State, Version};
pub use status::Status;
pub use uri::{UriError, resource_path};
pub use variable::{Causality, Enumeration, Kind, Variability, Variable, value_reference};

//! Types and constants of `fmi2TypesPlatform.h` and `fmi2FunctionTypes.h` (FMI 2.0.4), under the
//! names that they have there; `tests.rs` compares them with the headers.

use std::ffi::{c_char, c_int, c_uint, c_void};

/// An instance, opaque to the host.
pub type fmi2Component = *mut c_void;
/// The host's own data, handed back to its callbacks.
pub type fmi2ComponentEnvironment = *mut c_void;
/// The handle of a variable.
pub type fmi2ValueReference = c_uint;
/// A value of type Real.
pub type fmi2Real = f64;
/// A value of type Integer or Enumeration.
pub type fmi2Integer = c_int;
/// 0 ([`fmi2False`]) or 1.
pub type fmi2Boolean = c_int;
/// A string in UTF-8 that ends in NUL.
pub type fmi2String = *const c_char;
/// A byte of a serialized state.
pub type fmi2Byte = c_char;

/// The Boolean value false.
pub const fmi2False: fmi2Boolean = 0;

/// Outcome of a call.
pub type fmi2Status = c_uint;

/// Interface of an instance.
pub type fmi2Type = c_uint;
/// Model exchange.
pub const fmi2ModelExchange: fmi2Type = 0;
/// Co-simulation.
pub const fmi2CoSimulation: fmi2Type = 1;

/// Status that `fmi2GetStatus` and its kin are asked for.
pub type fmi2StatusKind = c_uint;
/// Status of the last `fmi2DoStep`.
pub const fmi2DoStepStatus: fmi2StatusKind = 0;
/// Time up to which the last step came.
pub const fmi2LastSuccessfulTime: fmi2StatusKind = 2;
/// Whether the slave wants to end the simulation.
pub const fmi2Terminated: fmi2StatusKind = 3;

/// The host's logger.
pub type fmi2CallbackLogger = Option<
    unsafe extern "C" fn(
        fmi2ComponentEnvironment,
        fmi2String,
        fmi2Status,
        fmi2String,
        fmi2String,
        ...
    ),
>;
/// The host's `calloc`.
pub type fmi2CallbackAllocateMemory = Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>;
/// The host's `free`.
pub type fmi2CallbackFreeMemory = Option<unsafe extern "C" fn(*mut c_void)>;
/// The host's notice of a step that ends later.
pub type fmi2StepFinished = Option<unsafe extern "C" fn(fmi2ComponentEnvironment, fmi2Status)>;

/// Callbacks that the host gives to `fmi2Instantiate`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmi2CallbackFunctions {
    /// Takes messages.
    pub logger: fmi2CallbackLogger,
    /// Allocates memory; unused.
    pub allocateMemory: fmi2CallbackAllocateMemory,
    /// Frees it; unused.
    pub freeMemory: fmi2CallbackFreeMemory,
    /// Unused: no step ends later.
    pub stepFinished: fmi2StepFinished,
    /// Handed back to the callbacks.
    pub componentEnvironment: fmi2ComponentEnvironment,
}

/// Answer of `fmi2NewDiscreteStates`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmi2EventInfo {
    /// Whether the event iteration goes on.
    pub newDiscreteStatesNeeded: fmi2Boolean,
    /// Whether the instance wants to end the simulation.
    pub terminateSimulation: fmi2Boolean,
    /// Whether nominal values of states changed.
    pub nominalsOfContinuousStatesChanged: fmi2Boolean,
    /// Whether values of states changed.
    pub valuesOfContinuousStatesChanged: fmi2Boolean,
    /// Whether `nextEventTime` holds a time.
    pub nextEventTimeDefined: fmi2Boolean,
    /// Time of the next event \[s\].
    pub nextEventTime: fmi2Real,
}

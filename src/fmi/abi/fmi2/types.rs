//! Types and constants of `fmi2TypesPlatform.h` and `fmi2FunctionTypes.h` (FMI 2.0.4), under the
//! names that they have there; `tests.rs` compares each of them with the headers.

use std::ffi::{c_char, c_void};

/// An instance.
pub type fmi2Component = *mut c_void;
/// Data of the host, handed back to its callbacks.
pub type fmi2ComponentEnvironment = *mut c_void;
/// A copy of an instance's state.
pub type fmi2FMUstate = *mut c_void;
/// Number of a variable.
pub type fmi2ValueReference = u32;
/// A real number.
pub type fmi2Real = f64;
/// An integer.
pub type fmi2Integer = i32;
/// A Boolean: false if zero.
pub type fmi2Boolean = i32;
/// A character of a string.
pub type fmi2Char = c_char;
/// A string, which ends in NUL.
pub type fmi2String = *const fmi2Char;
/// A byte of a serialized state.
pub type fmi2Byte = c_char;

/// Outcome of a call.
pub type fmi2Status = u32;
/// Interface of an instance.
pub type fmi2Type = u32;
/// Question to an instance about its last step.
pub type fmi2StatusKind = u32;

/// The Boolean value false.
pub const fmi2False: fmi2Boolean = 0;

/// Model exchange.
pub const fmi2ModelExchange: fmi2Type = 0;
/// Co-simulation.
pub const fmi2CoSimulation: fmi2Type = 1;

/// Status of the last `fmi2DoStep`.
pub const fmi2DoStepStatus: fmi2StatusKind = 0;
/// Time up to which the last step came.
pub const fmi2LastSuccessfulTime: fmi2StatusKind = 2;
/// Whether the slave wants to end the simulation.
pub const fmi2Terminated: fmi2StatusKind = 3;

/// The host's logger: its environment, the instance's name, status, category, format, arguments.
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
/// The host's allocation: number and size of the objects.
pub type fmi2CallbackAllocateMemory = Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>;
/// The host's release of what it has allocated.
pub type fmi2CallbackFreeMemory = Option<unsafe extern "C" fn(*mut c_void)>;
/// The host's answer to the end of a step that takes longer than its call.
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

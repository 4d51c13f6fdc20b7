//! Structures and constants of `fmi2FunctionTypes.h` (FMI 2.0.4), under the names that they have
//! there; `tests.rs` compares them with the headers. The simple types are those of Rust.

use std::ffi::{c_char, c_void};

/// The Boolean value false.
pub const fmi2False: i32 = 0;

/// Model exchange, an `fmi2Type`.
pub const fmi2ModelExchange: u32 = 0;
/// Co-simulation, an `fmi2Type`.
pub const fmi2CoSimulation: u32 = 1;

/// Status of the last `fmi2DoStep`, an `fmi2StatusKind`.
pub const fmi2DoStepStatus: u32 = 0;
/// Time up to which the last step came, an `fmi2StatusKind`.
pub const fmi2LastSuccessfulTime: u32 = 2;
/// Whether the slave wants to end the simulation, an `fmi2StatusKind`.
pub const fmi2Terminated: u32 = 3;

/// The host's logger: its environment, the instance's name, status, category, format, arguments.
pub type Logger = Option<
    unsafe extern "C" fn(*mut c_void, *const c_char, u32, *const c_char, *const c_char, ...),
>;

/// Callbacks that the host gives to `fmi2Instantiate`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmi2CallbackFunctions {
    /// Takes messages.
    pub logger: Logger,
    /// Allocates memory; unused.
    pub allocateMemory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Frees it; unused.
    pub freeMemory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// Unused: no step ends later.
    pub stepFinished: Option<unsafe extern "C" fn(*mut c_void, u32)>,
    /// Handed back to the callbacks.
    pub componentEnvironment: *mut c_void,
}

/// Answer of `fmi2NewDiscreteStates`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmi2EventInfo {
    /// Whether the event iteration goes on.
    pub newDiscreteStatesNeeded: i32,
    /// Whether the instance wants to end the simulation.
    pub terminateSimulation: i32,
    /// Whether nominal values of states changed.
    pub nominalsOfContinuousStatesChanged: i32,
    /// Whether values of states changed.
    pub valuesOfContinuousStatesChanged: i32,
    /// Whether `nextEventTime` holds a time.
    pub nextEventTimeDefined: i32,
    /// Time of the next event \[s\].
    pub nextEventTime: f64,
}

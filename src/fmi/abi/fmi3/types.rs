//! Types and constants of `fmi3PlatformTypes.h` and `fmi3FunctionTypes.h`, under the names that they
//! have there; `tests.rs` compares each of them with the headers.

use std::ffi::{c_char, c_void};

/// An instance.
pub type fmi3Instance = *mut c_void;
/// Data of the host, handed back to its callbacks.
pub type fmi3InstanceEnvironment = *mut c_void;
/// A copy of an instance's state.
pub type fmi3FMUState = *mut c_void;
/// Number of a variable.
pub type fmi3ValueReference = u32;
/// A real number of 32 bits.
pub type fmi3Float32 = f32;
/// A real number of 64 bits.
pub type fmi3Float64 = f64;
/// An integer of 8 bits.
pub type fmi3Int8 = i8;
/// An integer of 8 bits, not negative.
pub type fmi3UInt8 = u8;
/// An integer of 16 bits.
pub type fmi3Int16 = i16;
/// An integer of 16 bits, not negative.
pub type fmi3UInt16 = u16;
/// An integer of 32 bits.
pub type fmi3Int32 = i32;
/// An integer of 32 bits, not negative.
pub type fmi3UInt32 = u32;
/// An integer of 64 bits.
pub type fmi3Int64 = i64;
/// An integer of 64 bits, not negative.
pub type fmi3UInt64 = u64;
/// A Boolean.
pub type fmi3Boolean = bool;
/// A character of a string.
pub type fmi3Char = c_char;
/// A string, which ends in NUL.
pub type fmi3String = *const fmi3Char;
/// A byte of binary data or of a serialized state.
pub type fmi3Byte = u8;
/// Binary data.
pub type fmi3Binary = *const fmi3Byte;
/// The state of a clock.
pub type fmi3Clock = bool;

/// Outcome of a call.
pub type fmi3Status = u32;
/// Kind of a dependency.
pub type fmi3DependencyKind = u32;
/// Kind of a clock's interval.
pub type fmi3IntervalQualifier = u32;

/// Dependency with a constant factor.
pub const fmi3Constant: fmi3DependencyKind = 1;
/// Dependency without a particular structure.
pub const fmi3Dependent: fmi3DependencyKind = 5;

/// The host's logger: its environment, status, category, message.
pub type fmi3LogMessageCallback =
    Option<unsafe extern "C" fn(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String)>;
/// The host's update of clocks.
pub type fmi3ClockUpdateCallback = Option<unsafe extern "C" fn(fmi3InstanceEnvironment)>;
/// The host's protection from being interrupted.
pub type fmi3LockPreemptionCallback = Option<unsafe extern "C" fn()>;
/// The end of that protection.
pub type fmi3UnlockPreemptionCallback = Option<unsafe extern "C" fn()>;
/// The host's intermediate update: its environment, the time, whether inputs may be set, outputs be
/// read, whether the solver has accepted the point, whether the step may end early; then the
/// host's wish for that and the time of the end.
pub type fmi3IntermediateUpdateCallback = Option<
    unsafe extern "C" fn(
        fmi3InstanceEnvironment,
        fmi3Float64,
        fmi3Boolean,
        fmi3Boolean,
        fmi3Boolean,
        fmi3Boolean,
        *mut fmi3Boolean,
        *mut fmi3Float64,
    ),
>;

//! Types and constants of `fmi3PlatformTypes.h` and `fmi3FunctionTypes.h` (FMI 3.0.2), under the names
//! that they have there; `tests.rs` compares them with the headers.

use std::ffi::{c_char, c_uint, c_void};

use crate::fmi::abi::intermediate::Callback;

/// An instance, opaque to the host.
pub type fmi3Instance = *mut c_void;
/// The host's own data, handed back to its callbacks.
pub type fmi3InstanceEnvironment = *mut c_void;
/// The handle of a variable.
pub type fmi3ValueReference = u32;
/// A value of type Float32.
pub type fmi3Float32 = f32;
/// A value of type Float64.
pub type fmi3Float64 = f64;
/// A value of type Int8.
pub type fmi3Int8 = i8;
/// A value of type UInt8.
pub type fmi3UInt8 = u8;
/// A value of type Int16.
pub type fmi3Int16 = i16;
/// A value of type UInt16.
pub type fmi3UInt16 = u16;
/// A value of type Int32.
pub type fmi3Int32 = i32;
/// A value of type UInt32.
pub type fmi3UInt32 = u32;
/// A value of type Int64 or Enumeration.
pub type fmi3Int64 = i64;
/// A value of type UInt64.
pub type fmi3UInt64 = u64;
/// A value of type Boolean.
pub type fmi3Boolean = bool;
/// A string in UTF-8 that ends in NUL.
pub type fmi3String = *const c_char;
/// A byte of a serialized state.
pub type fmi3Byte = u8;
/// A value of type Binary.
pub type fmi3Binary = *const fmi3Byte;
/// The activation of a clock.
pub type fmi3Clock = bool;

/// Outcome of a call.
pub type fmi3Status = c_uint;

/// Kind of a dependency.
pub type fmi3DependencyKind = c_uint;
/// With a constant factor.
pub const fmi3Constant: fmi3DependencyKind = 1;
/// Without a particular structure.
pub const fmi3Dependent: fmi3DependencyKind = 5;

/// Whether the interval of a clock has changed.
pub type fmi3IntervalQualifier = c_uint;

/// The host's logger.
pub type fmi3LogMessageCallback =
    Option<unsafe extern "C" fn(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String)>;
/// The host's notice of the activation of a clock.
pub type fmi3ClockUpdateCallback = Option<unsafe extern "C" fn(fmi3InstanceEnvironment)>;
/// The host's intermediate update.
pub type fmi3IntermediateUpdateCallback = Callback;
/// The host's lock against preemption.
pub type fmi3LockPreemptionCallback = Option<unsafe extern "C" fn()>;
/// The host's release of that lock.
pub type fmi3UnlockPreemptionCallback = Option<unsafe extern "C" fn()>;

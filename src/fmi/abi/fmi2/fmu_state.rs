//! Getting, setting and serializing the FMU state.

use super::types::{fmi2Byte, fmi2Component, fmi2FMUstate, fmi2Status};
use crate::fmi::abi::saved_state;

/// `fmi2GetFMUstate`: makes a copy of the state, or puts it in place of one that the host hands over for
/// that.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety). `*fmu_state` holds a value, other than in functions
/// that write only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(
    c: fmi2Component,
    fmu_state: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: the host's promise.
    unsafe { saved_state::get(c, "fmi2GetFMUstate", fmu_state) }
}

/// `fmi2SetFMUstate`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: fmi2Component, fmu_state: fmi2FMUstate) -> fmi2Status {
    // SAFETY: the host's promise.
    unsafe { saved_state::set(c, "fmi2SetFMUstate", fmu_state) }
}

/// `fmi2FreeFMUstate`; nothing happens for null, either way.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(
    c: fmi2Component,
    fmu_state: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: the host's promise.
    unsafe { saved_state::free(c, "fmi2FreeFMUstate", fmu_state) }
}

/// `fmi2SerializedFMUstateSize`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    c: fmi2Component,
    fmu_state: fmi2FMUstate,
    size: *mut usize,
) -> fmi2Status {
    // SAFETY: the host's promise.
    unsafe { saved_state::size(c, "fmi2SerializedFMUstateSize", fmu_state, size) }
}

/// `fmi2SerializeFMUstate`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: fmi2Component,
    fmu_state: fmi2FMUstate,
    serialized_state: *mut fmi2Byte,
    size: usize,
) -> fmi2Status {
    // SAFETY: the host's promise; a byte of the standard is one of Rust with another sign.
    unsafe {
        saved_state::serialize(
            c,
            "fmi2SerializeFMUstate",
            fmu_state,
            serialized_state.cast(),
            size,
        )
    }
}

/// `fmi2DeSerializeFMUstate`: makes a state, which is then the host's to free.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: fmi2Component,
    serialized_state: *const fmi2Byte,
    size: usize,
    fmu_state: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: the host's promise; a byte of the standard is one of Rust with another sign.
    unsafe {
        saved_state::deserialize(
            c,
            "fmi2DeSerializeFMUstate",
            serialized_state.cast(),
            size,
            fmu_state,
        )
    }
}

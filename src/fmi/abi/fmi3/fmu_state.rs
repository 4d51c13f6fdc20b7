//! Getting, setting and serializing the FMU state.

use super::types::{fmi3Byte, fmi3FMUState, fmi3Instance, fmi3Status};
use crate::fmi::abi::saved_state;

/// `fmi3GetFMUState`: makes a copy of the state, or puts it in place of one that the host hands over for
/// that.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety). `*fmu_state` holds a value, other than in functions
/// that write only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(
    c: fmi3Instance,
    fmu_state: *mut fmi3FMUState,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe { saved_state::get(c, "fmi3GetFMUState", fmu_state) }
}

/// `fmi3SetFMUState`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(c: fmi3Instance, fmu_state: fmi3FMUState) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe { saved_state::set(c, "fmi3SetFMUState", fmu_state) }
}

/// `fmi3FreeFMUState`; nothing happens for null, either way.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(
    c: fmi3Instance,
    fmu_state: *mut fmi3FMUState,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe { saved_state::free(c, "fmi3FreeFMUState", fmu_state) }
}

/// `fmi3SerializedFMUStateSize`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    c: fmi3Instance,
    fmu_state: fmi3FMUState,
    size: *mut usize,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe { saved_state::size(c, "fmi3SerializedFMUStateSize", fmu_state, size) }
}

/// `fmi3SerializeFMUState`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    c: fmi3Instance,
    fmu_state: fmi3FMUState,
    serialized_state: *mut fmi3Byte,
    size: usize,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        saved_state::serialize(
            c,
            "fmi3SerializeFMUState",
            fmu_state,
            serialized_state,
            size,
        )
    }
}

/// `fmi3DeserializeFMUState`: makes a state, which is then the host's to free.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    c: fmi3Instance,
    serialized_state: *const fmi3Byte,
    size: usize,
    fmu_state: *mut fmi3FMUState,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        saved_state::deserialize(
            c,
            "fmi3DeserializeFMUState",
            serialized_state,
            size,
            fmu_state,
        )
    }
}

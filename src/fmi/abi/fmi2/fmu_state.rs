//! Getting, setting and serializing the FMU state.
//!
//! An `fmi2FMUstate` is a box with an [`FmuState`]. It belongs to the host until
//! `fmi2FreeFMUstate`, and outlives the instance that it was got from.

use std::ptr::null_mut;

use super::types::{fmi2Byte, fmi2Component, fmi2FMUstate, fmi2Status};

use crate::fmi::abi::Exported;
use crate::fmi::abi::arguments::{Room, slice, write};
use crate::fmi::abi::component::{CallError, with_instance};
use crate::fmi::{Call, Error, Model, StateError};

type FmuState = crate::fmi::FmuState<<Exported as Model>::State>;

/// The state behind a handle of the host.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety) for an `fmi2FMUstate`, while the reference is used.
unsafe fn state<'a>(handle: fmi2FMUstate) -> Result<&'a FmuState, CallError> {
    // SAFETY: promised by the caller.
    unsafe { handle.cast::<FmuState>().as_ref() }
        .ok_or_else(|| CallError::Argument("`FMUstate` is a null pointer".to_owned()))
}

/// `fmi2GetFMUstate`: makes a copy of the state, or puts it in place of one that the host hands
/// over for that.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety). `*fmu_state` holds a value, other than in functions that
/// write only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(
    c: fmi2Component,
    fmu_state: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: the host's promise; a state to be replaced is a box of this library.
    unsafe {
        with_instance(c, "fmi2GetFMUstate", |instance| {
            let [handle] = slice("FMUstate", fmu_state, 1)? else {
                unreachable!("one was asked for");
            };
            let state = instance.fmu_state()?;
            match handle.cast::<FmuState>().as_mut() {
                Some(existing) => *existing = state,
                None => fmu_state.write(Box::into_raw(Box::new(state)).cast()),
            }
            Ok(())
        })
    }
}

/// `fmi2SetFMUstate`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: fmi2Component, fmu_state: fmi2FMUstate) -> fmi2Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(c, "fmi2SetFMUstate", |instance| {
            Ok(instance.set_fmu_state(state(fmu_state)?)?)
        })
    }
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
    // SAFETY: the host's promise; a state that is not null is a box of this library.
    unsafe {
        with_instance(c, "fmi2FreeFMUstate", |instance| {
            instance.allow(Call::FreeFMUstate)?;
            if fmu_state.is_null() {
                return Ok(());
            }
            let handle = slice("FMUstate", fmu_state, 1)?[0];
            if !handle.is_null() {
                drop(Box::from_raw(handle.cast::<FmuState>()));
                fmu_state.write(null_mut());
            }
            Ok(())
        })
    }
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
    unsafe {
        with_instance(c, "fmi2SerializedFMUstateSize", |instance| {
            let bytes = instance.serialized_fmu_state_size(state(fmu_state)?)?;
            write("size", size, bytes)
        })
    }
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
    // SAFETY: the host's promise.
    unsafe {
        with_instance(c, "fmi2SerializeFMUstate", |instance| {
            let bytes = instance.serialize_fmu_state(state(fmu_state)?)?;
            let room = Room::new("serializedState", serialized_state, size)?;
            // With more room the host would hand back more than was written.
            if size != bytes.len() {
                let (needed, given) = (bytes.len(), size);
                let refused = StateError::Room { needed, given };
                return Err(CallError::Refused(Error::FmuState(refused)));
            }
            room.fill(bytes.into_iter().map(|byte| byte as fmi2Byte));
            Ok(())
        })
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
        with_instance(c, "fmi2DeSerializeFMUstate", |instance| {
            let bytes = slice("serializedState", serialized_state.cast::<u8>(), size)?;
            let room = Room::new("FMUstate", fmu_state, 1)?;
            let state = instance.deserialize_fmu_state(bytes)?;
            room.fill([Box::into_raw(Box::new(state)).cast()]);
            Ok(())
        })
    }
}

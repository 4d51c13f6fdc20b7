//! FMU states as the host sees them: got, set, freed and serialized.
//!
//! A handle is a box with an [`FmuState`]. It belongs to the host until it frees it, and outlives
//! the instance that it was got from.

use std::ptr::null_mut;

use super::Exported;
use super::arguments::{Room, slice, write};
use super::component::{CallError, Handle, StatusCode, with_instance};
use crate::fmi::{Call, Error, Model, StateError};

type FmuState = crate::fmi::FmuState<<Exported as Model>::State>;

/// Name of the argument in messages.
const ARGUMENT: &str = "FMUstate";

/// Returns the state behind a handle of the host.
///
/// # Safety
///
/// The [host's promise](super#safety) for an FMU state, while the reference is used.
unsafe fn state<'a>(handle: Handle) -> Result<&'a FmuState, CallError> {
    // SAFETY: promised by the caller.
    unsafe { handle.cast::<FmuState>().as_ref() }
        .ok_or_else(|| CallError::Argument(format!("`{ARGUMENT}` is a null pointer")))
}

/// Makes a copy of the state, or puts it in place of one that the host hands over for that.
///
/// # Safety
///
/// The [host's promise](super#safety). `*fmu_state` holds a value, other than in functions that
/// write only.
pub(super) unsafe fn get(c: Handle, call: &str, fmu_state: *mut Handle) -> StatusCode {
    // SAFETY: the host's promise; a state to be replaced is a box of this library.
    unsafe {
        with_instance(c, call, |instance| {
            let [handle] = slice(ARGUMENT, fmu_state, 1)? else {
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

/// Restores a state.
///
/// # Safety
///
/// The [host's promise](super#safety).
pub(super) unsafe fn set(c: Handle, call: &str, fmu_state: Handle) -> StatusCode {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(c, call, |instance| {
            Ok(instance.set_fmu_state(state(fmu_state)?)?)
        })
    }
}

/// Frees a state; nothing happens for null, either way.
///
/// # Safety
///
/// The [host's promise](super#safety).
pub(super) unsafe fn free(c: Handle, call: &str, fmu_state: *mut Handle) -> StatusCode {
    // SAFETY: the host's promise; a state that is not null is a box of this library.
    unsafe {
        with_instance(c, call, |instance| {
            instance.allow(Call::FreeFMUstate)?;
            if fmu_state.is_null() {
                return Ok(());
            }
            let handle = slice(ARGUMENT, fmu_state, 1)?[0];
            if !handle.is_null() {
                drop(Box::from_raw(handle.cast::<FmuState>()));
                fmu_state.write(null_mut());
            }
            Ok(())
        })
    }
}

/// Writes the number of bytes of a serialized state.
///
/// # Safety
///
/// The [host's promise](super#safety).
pub(super) unsafe fn size(
    c: Handle,
    call: &str,
    fmu_state: Handle,
    size: *mut usize,
) -> StatusCode {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(c, call, |instance| {
            let bytes = instance.serialized_fmu_state_size(state(fmu_state)?)?;
            write("size", size, bytes)
        })
    }
}

/// Writes a state as bytes.
///
/// # Safety
///
/// The [host's promise](super#safety).
pub(super) unsafe fn serialize(
    c: Handle,
    call: &str,
    fmu_state: Handle,
    serialized_state: *mut u8,
    size: usize,
) -> StatusCode {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(c, call, |instance| {
            let bytes = instance.serialize_fmu_state(state(fmu_state)?)?;
            let room = Room::new("serializedState", serialized_state, size)?;
            // With more room the host would hand back more than was written.
            if size != bytes.len() {
                let (needed, given) = (bytes.len(), size);
                let refused = StateError::Room { needed, given };
                return Err(CallError::Refused(Error::FmuState(refused)));
            }
            room.fill(bytes);
            Ok(())
        })
    }
}

/// Makes a state from bytes, which is then the host's to free.
///
/// # Safety
///
/// The [host's promise](super#safety).
pub(super) unsafe fn deserialize(
    c: Handle,
    call: &str,
    serialized_state: *const u8,
    size: usize,
    fmu_state: *mut Handle,
) -> StatusCode {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(c, call, |instance| {
            let bytes = slice("serializedState", serialized_state, size)?;
            let room = Room::new(ARGUMENT, fmu_state, 1)?;
            let state = instance.deserialize_fmu_state(bytes)?;
            room.fill([Box::into_raw(Box::new(state)).cast()]);
            Ok(())
        })
    }
}

//! FMU states as the host sees them: got, set, freed and serialized.
//!
//! A handle is a box with an [`FmuState`]. It belongs to the host until it frees it, and outlives
//! the instance that it was got from.

use super::Exported;
use super::arguments::{NULL, refuse};
use super::component::Handle;
use crate::fmi::{Error, Model};

pub(super) type FmuState = crate::fmi::FmuState<<Exported as Model>::State>;

/// Name of the argument in messages.
pub(super) const ARGUMENT: &str = "FMUstate";

/// Returns the state behind a handle of the host.
///
/// # Safety
///
/// The [host's promise](super#safety) for an FMU state, while the reference is used.
pub(super) unsafe fn state<'a>(handle: Handle) -> Result<&'a FmuState, Error> {
    // SAFETY: promised by the caller.
    unsafe { handle.cast::<FmuState>().as_ref() }.ok_or_else(|| refuse(ARGUMENT, NULL))
}

/// Returns the handle of a state, which is then the host's to free.
pub(super) fn hand_over(state: FmuState) -> Handle {
    Box::into_raw(Box::new(state)).cast()
}

/// Defines the functions of a version of the standard that get, set, free, measure, serialize and
/// deserialize a state.
macro_rules! fmu_state_calls {
    (
        $state:ty, $byte:ty;
        $get:ident $set:ident $free:ident $size:ident $serialize:ident $deserialize:ident
    ) => {
        use std::ptr::null_mut;

        use $crate::fmi::abi::arguments::{fill, room, slice, write};
        use $crate::fmi::abi::saved_state::{ARGUMENT, FmuState, hand_over, state};
        use $crate::fmi::{Call, Error, StateError};

        $crate::fmi::abi::calls::instance_calls! {
            #[doc = concat!("`", stringify!($get), "`: makes a copy of the state, or puts it in place of one")]
            /// that the host hands over for that: `*fmu_state` holds a value, other than in functions that
            /// write only.
            $get(fmu_state: *mut $state) = |instance| {
                let handle = slice(ARGUMENT, fmu_state, 1)?[0];
                let state = instance.fmu_state()?;
                match handle.cast::<FmuState>().as_mut() {
                    Some(existing) => *existing = state,
                    None => fmu_state.write_unaligned(hand_over(state)),
                }
                Ok(())
            };
            #[doc = concat!("`", stringify!($set), "`.")]
            $set(fmu_state: $state) = |instance| instance.set_fmu_state(state(fmu_state)?);
            #[doc = concat!("`", stringify!($free), "`; nothing happens for null, either way.")]
            $free(fmu_state: *mut $state) = |instance| {
                instance.allow(Call::FreeFMUstate)?;
                if fmu_state.is_null() {
                    return Ok(());
                }
                let handle = slice(ARGUMENT, fmu_state, 1)?[0];
                if !handle.is_null() {
                    drop(Box::from_raw(handle.cast::<FmuState>()));
                    fmu_state.write_unaligned(null_mut());
                }
                Ok(())
            };
            #[doc = concat!("`", stringify!($size), "`.")]
            $size(fmu_state: $state, size: *mut usize) = |instance| {
                let bytes = instance.serialized_fmu_state_size(state(fmu_state)?)?;
                write("size", size, bytes)
            };
            // A byte of a standard is one of Rust, perhaps with another sign.
            #[doc = concat!("`", stringify!($serialize), "`.")]
            $serialize(fmu_state: $state, serialized_state: *mut $byte, size: usize) = |instance| {
                let bytes = instance.serialize_fmu_state(state(fmu_state)?)?;
                let room = room("serializedState", serialized_state.cast(), size)?;
                // With more room the host would hand back more than was written.
                if size != bytes.len() {
                    let (needed, given) = (bytes.len(), size);
                    return Err(Error::FmuState(StateError::Room { needed, given }));
                }
                fill(room, bytes);
                Ok(())
            };
            #[doc = concat!("`", stringify!($deserialize), "`: makes a state, which is then the host's to free.")]
            $deserialize(
                serialized_state: *const $byte,
                size: usize,
                fmu_state: *mut $state,
            ) = |instance| {
                let bytes = slice("serializedState", serialized_state.cast(), size)?;
                let room = room(ARGUMENT, fmu_state, 1)?;
                fill(room, [hand_over(instance.deserialize_fmu_state(&bytes)?)]);
                Ok(())
            };
        }
    };
}
pub(super) use fmu_state_calls;

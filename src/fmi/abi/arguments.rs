//! Arrays and strings of the host, which may begin at any address.

use std::borrow::Cow;
use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::slice;

use crate::fmi::Error;

/// Fault of a pointer that is null.
pub(super) const NULL: &str = "is a null pointer";

/// A value at any address.
#[derive(Clone, Copy)]
#[repr(C, packed)]
pub(super) struct Unaligned<T>(T);

impl<T> From<T> for Unaligned<T> {
    #[inline]
    fn from(value: T) -> Self {
        Self(value)
    }
}

/// Returns the array of `length` items at `pointer`, a copy if it is not aligned.
///
/// # Safety
///
/// A pointer that is not null points to `length` items that live and do not change while the
/// slice is used.
pub(super) unsafe fn slice<'a, T: Copy>(
    name: &'static str,
    pointer: *const T,
    length: usize,
) -> Result<Cow<'a, [T]>, Error> {
    check_array(name, pointer, length)?;
    if length == 0 {
        return Ok(Cow::Borrowed(&[]));
    }
    // SAFETY: checked above as far as possible, promised by the caller beyond.
    Ok(unsafe {
        if pointer.is_aligned() {
            Cow::Borrowed(slice::from_raw_parts(pointer, length))
        } else {
            copy(slice::from_raw_parts(pointer.cast(), length)).into()
        }
    })
}

#[cold]
fn copy<T: Copy>(items: &[Unaligned<T>]) -> Vec<T> {
    items.iter().map(|item| item.0).collect()
}

/// Returns the memory for `length` items at `pointer`, to be written. It may hold nothing yet, so that
/// it is never read.
///
/// # Safety
///
/// A pointer that is not null points to room for `length` items that nobody else touches while the
/// memory is used.
pub(super) unsafe fn room<'a, T: Copy>(
    name: &'static str,
    pointer: *mut T,
    length: usize,
) -> Result<&'a mut [MaybeUninit<Unaligned<T>>], Error> {
    check_array(name, pointer, length)?;
    if length == 0 {
        return Ok(&mut []);
    }
    // SAFETY: checked above as far as possible, promised by the caller beyond; items that may hold
    // nothing, at any address, have the size of items.
    Ok(unsafe { slice::from_raw_parts_mut(pointer.cast(), length) })
}

/// Writes values from the first item on, as many as there are and have room.
#[inline]
pub(super) fn fill<T: Copy>(
    room: &mut [MaybeUninit<Unaligned<T>>],
    values: impl IntoIterator<Item = T>,
) {
    for (item, value) in room.iter_mut().zip(values) {
        item.write(value.into());
    }
}

/// Checks that a pointer leads to room for one item.
pub(super) fn check_room<T>(name: &'static str, pointer: *mut T) -> Result<(), Error> {
    check_array(name, pointer, 1)
}

#[inline]
fn check_array<T>(name: &'static str, pointer: *const T, length: usize) -> Result<(), Error> {
    let why = if length == 0 {
        return Ok(());
    } else if pointer.is_null() {
        NULL
    } else if length > isize::MAX as usize / size_of::<T>() {
        "has an impossible length"
    } else {
        return Ok(());
    };
    Err(refuse(name, why))
}

/// Returns the error of an argument that is unusable.
#[cold]
pub(super) fn refuse(name: &'static str, why: impl Into<String>) -> Error {
    let why = why.into();
    Error::Argument { name, why }
}

/// Returns the text of a C string.
///
/// # Safety
///
/// A pointer that is not null points to a string that ends in NUL and lives and does not change
/// while the text is used.
pub(super) unsafe fn text<'a>(
    name: &'static str,
    pointer: *const c_char,
) -> Result<&'a str, Error> {
    if pointer.is_null() {
        return Err(refuse(name, NULL));
    }
    // SAFETY: promised by the caller.
    unsafe { CStr::from_ptr(pointer) }
        .to_str()
        .map_err(|_| refuse(name, "is not UTF-8"))
}

/// Writes one value through a pointer of the host.
///
/// # Safety
///
/// A pointer that is not null can be written.
pub(super) unsafe fn write<T: Copy>(
    name: &'static str,
    pointer: *mut T,
    value: T,
) -> Result<(), Error> {
    // SAFETY: promised by the caller.
    fill(unsafe { room(name, pointer, 1)? }, [value]);
    Ok(())
}

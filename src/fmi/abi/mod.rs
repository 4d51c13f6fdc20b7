//! The C interfaces: every function of `fmi2Functions.h` and of `fmi3Functions.h`.
//!
//! | file | subject |
//! |---|---|
//! | `fmi2`, `fmi3` | the functions of one version, by subject |
//! | `calls` | functions that are calls on an instance |
//! | `instantiation` | instantiation, as far as the versions share it |
//! | `component` | instances as the host sees them |
//! | `arguments` | arrays and strings of the host |
//! | `intermediate` | the host's part in a step of FMI 3.0 |
//! | `saved_state` | FMU states as the host sees them |
//! | `message` | messages to the host |
//!
//! Pointers come in, a status goes out. Each function checks what it can of its pointers, turns
//! them into slices and calls the [`Instance`](super::Instance); a panic becomes a fatal status and
//! never crosses into the host. Nothing is written to stdout or stderr.
//!
//! # Safety
//!
//! The host promises, by the standard, what no function can check:
//!
//! - An instance that is not null came from a function of this library that instantiates, and has
//!   not been freed. A call on it while another is being served, from the logger or from another
//!   thread, is refused.
//! - A pointer to an array that is not null points to as many items as the argument for its length
//!   says, at any address. Items that are read hold values and do not change during the call; items that are
//!   written may hold nothing yet, and nobody else uses them during the call.
//! - A string that is not null ends in NUL.
//! - An FMU state that is not null came from this library, has not been freed, and is used by
//!   one call at a time. A pointer from anywhere else cannot be recognized.

#![allow(
    unsafe_code,
    reason = "the C interface takes raw pointers; all of biela's unsafe code is in this module"
)]
#![allow(
    non_camel_case_types,
    non_snake_case,
    non_upper_case_globals,
    reason = "the names are those of the standard"
)]

mod arguments;
mod calls;
mod component;
mod floating_point;
mod fmi2;
mod fmi3;
mod instantiation;
mod intermediate;
mod message;
mod saved_state;
#[cfg(test)]
mod tests;

/// The model whose C interface this is.
type Exported = super::MechanismModel;

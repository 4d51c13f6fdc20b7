//! The C interface: every function of `fmi2Functions.h`.
//!
//! Pointers come in, a status goes out. Each function checks what it can of its pointers, turns
//! them into slices and calls the [`Instance`](super::Instance); a panic becomes `fmi2Fatal` and
//! never crosses into the host. Nothing is written to stdout or stderr.
//!
//! # Safety
//!
//! The host promises, by the standard, what no function can check:
//!
//! - A component that is not null came from `fmi2Instantiate` and has not been freed. A call on it
//!   while another is being served, from the logger or from another thread, is refused.
//! - A pointer to an array that is not null points to as many items as are told with it. Those
//!   that are read hold values and stay as they are during the call; those that are written may
//!   hold nothing yet, and nobody else touches them during the call.
//! - A string that is not null ends in NUL.
//! - An `fmi2FMUstate` that is not null came from this library, has not been freed, and is used by
//!   one call at a time. A pointer from anywhere else cannot be told from one.

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
mod component;
mod floating_point;
mod fmi2;
mod message;

/// The model whose C interface this is.
type Exported = super::MechanismModel;

//! The C interface: every function of `fmi2Functions.h`.
//!
//! Pointers come in, a status goes out. Each function checks what it can of its pointers, turns
//! them into slices and calls the [`Instance`](super::Instance); a panic becomes `fmi2Fatal` and
//! never crosses into the host. Nothing is written to stdout or stderr.
//!
//! # Safety
//!
//! What no function can check is the host's promise, as the standard has it:
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
    non_snake_case,
    non_upper_case_globals,
    reason = "the names are those of the standard"
)]

mod access;
mod arguments;
mod component;
mod exchange;
mod fmu_state;
mod host;
mod lifecycle;
mod stepping;
#[cfg(test)]
mod tests;

use access::*;
use exchange::*;
use fmu_state::*;
use lifecycle::*;
use stepping::*;

/// The model whose C interface this is.
type Exported = super::MechanismModel;

// `fmi-sys` defines and exports a logger for importing hosts. Hidden, it stays inside.
#[cfg(target_os = "linux")]
core::arch::global_asm!(".hidden callback_log");
#[cfg(target_os = "macos")]
core::arch::global_asm!(".private_extern _callback_log");

/// Checks at compile time that each export has the signature of the standard's header.
macro_rules! check_signatures {
    ($($function:ident: $signature:ident,)*) => {
        $(const _: fmi_sys::fmi2::$signature = Some($function);)*
    };
}

check_signatures! {
    fmi2GetTypesPlatform: fmi2GetTypesPlatformTYPE,
    fmi2GetVersion: fmi2GetVersionTYPE,
    fmi2SetDebugLogging: fmi2SetDebugLoggingTYPE,
    fmi2Instantiate: fmi2InstantiateTYPE,
    fmi2FreeInstance: fmi2FreeInstanceTYPE,
    fmi2SetupExperiment: fmi2SetupExperimentTYPE,
    fmi2EnterInitializationMode: fmi2EnterInitializationModeTYPE,
    fmi2ExitInitializationMode: fmi2ExitInitializationModeTYPE,
    fmi2Terminate: fmi2TerminateTYPE,
    fmi2Reset: fmi2ResetTYPE,
    fmi2GetReal: fmi2GetRealTYPE,
    fmi2GetInteger: fmi2GetIntegerTYPE,
    fmi2GetBoolean: fmi2GetBooleanTYPE,
    fmi2GetString: fmi2GetStringTYPE,
    fmi2SetReal: fmi2SetRealTYPE,
    fmi2SetInteger: fmi2SetIntegerTYPE,
    fmi2SetBoolean: fmi2SetBooleanTYPE,
    fmi2SetString: fmi2SetStringTYPE,
    fmi2GetFMUstate: fmi2GetFMUstateTYPE,
    fmi2SetFMUstate: fmi2SetFMUstateTYPE,
    fmi2FreeFMUstate: fmi2FreeFMUstateTYPE,
    fmi2SerializedFMUstateSize: fmi2SerializedFMUstateSizeTYPE,
    fmi2SerializeFMUstate: fmi2SerializeFMUstateTYPE,
    fmi2DeSerializeFMUstate: fmi2DeSerializeFMUstateTYPE,
    fmi2GetDirectionalDerivative: fmi2GetDirectionalDerivativeTYPE,
    fmi2EnterEventMode: fmi2EnterEventModeTYPE,
    fmi2NewDiscreteStates: fmi2NewDiscreteStatesTYPE,
    fmi2EnterContinuousTimeMode: fmi2EnterContinuousTimeModeTYPE,
    fmi2CompletedIntegratorStep: fmi2CompletedIntegratorStepTYPE,
    fmi2SetTime: fmi2SetTimeTYPE,
    fmi2SetContinuousStates: fmi2SetContinuousStatesTYPE,
    fmi2GetDerivatives: fmi2GetDerivativesTYPE,
    fmi2GetEventIndicators: fmi2GetEventIndicatorsTYPE,
    fmi2GetContinuousStates: fmi2GetContinuousStatesTYPE,
    fmi2GetNominalsOfContinuousStates: fmi2GetNominalsOfContinuousStatesTYPE,
    fmi2SetRealInputDerivatives: fmi2SetRealInputDerivativesTYPE,
    fmi2GetRealOutputDerivatives: fmi2GetRealOutputDerivativesTYPE,
    fmi2DoStep: fmi2DoStepTYPE,
    fmi2CancelStep: fmi2CancelStepTYPE,
    fmi2GetStatus: fmi2GetStatusTYPE,
    fmi2GetRealStatus: fmi2GetRealStatusTYPE,
    fmi2GetIntegerStatus: fmi2GetIntegerStatusTYPE,
    fmi2GetBooleanStatus: fmi2GetBooleanStatusTYPE,
    fmi2GetStringStatus: fmi2GetStringStatusTYPE,
}

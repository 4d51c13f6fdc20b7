//! The tests of both versions with FMI 2.0; the structures and constants of its header.

use fmi_sys::fmi2 as header;

use super::access::*;
use super::exchange::*;
use super::fmu_state::*;
use super::lifecycle::*;
use super::stepping::*;
use super::types::*;
use crate::fmi::Version;
use crate::fmi::abi::tests::{Abi, header_tests};

// SAFETY: as for the functions.
const ABI: Abi<fmi2Byte> = unsafe {
    Abi {
        version: Version::Fmi2,
        enter_initialization_mode: |c| fmi2EnterInitializationMode(c),
        set_one_debug_category: |c, category| fmi2SetDebugLogging(c, 1, 1, &category),
        get: |c, references, n, values| fmi2GetReal(c, references, n, values),
        set: |c, references, n, values| fmi2SetReal(c, references, n, values),
        get_state: fmi2GetFMUstate,
        set_state: fmi2SetFMUstate,
        free_state: fmi2FreeFMUstate,
        state_size: fmi2SerializedFMUstateSize,
        serialize: fmi2SerializeFMUstate,
        deserialize: fmi2DeSerializeFMUstate,
        free: fmi2FreeInstance,
    }
};

header_tests! {
    ABI, Fmi2Binding;
    on an instance:
        fmi2SetDebugLogging, fmi2SetupExperiment, fmi2EnterInitializationMode,
        fmi2ExitInitializationMode, fmi2Terminate, fmi2Reset, fmi2GetReal, fmi2GetInteger,
        fmi2GetBoolean, fmi2GetString, fmi2SetReal, fmi2SetInteger, fmi2SetBoolean, fmi2SetString,
        fmi2GetFMUstate, fmi2SetFMUstate, fmi2FreeFMUstate, fmi2SerializedFMUstateSize,
        fmi2SerializeFMUstate, fmi2DeSerializeFMUstate, fmi2GetDirectionalDerivative,
        fmi2EnterEventMode, fmi2EnterContinuousTimeMode, fmi2CompletedIntegratorStep, fmi2SetTime,
        fmi2SetContinuousStates, fmi2GetDerivatives, fmi2GetEventIndicators,
        fmi2GetContinuousStates, fmi2GetNominalsOfContinuousStates, fmi2SetRealInputDerivatives,
        fmi2GetRealOutputDerivatives, fmi2DoStep, fmi2CancelStep, fmi2GetStatus, fmi2GetRealStatus,
        fmi2GetIntegerStatus, fmi2GetBooleanStatus, fmi2GetStringStatus, fmi2NewDiscreteStates as
        NewDiscreteStates<fmi2EventInfo>;
    others:
        fmi2GetTypesPlatform, fmi2GetVersion, fmi2FreeInstance, fmi2Instantiate as
        Instantiate<fmi2CallbackFunctions>;
    // The number of functions in `fmi2Functions.h`.
    of 44;
    types:
        fmi2Component fmi2ComponentEnvironment fmi2FMUstate fmi2ValueReference fmi2Real fmi2Integer
        fmi2Boolean fmi2Char fmi2String fmi2Byte fmi2Status fmi2Type fmi2StatusKind
        fmi2CallbackLogger fmi2CallbackAllocateMemory fmi2CallbackFreeMemory fmi2StepFinished;
    statuses:
        fmi2Status_fmi2OK fmi2Status_fmi2Warning fmi2Status_fmi2Discard fmi2Status_fmi2Error
        fmi2Status_fmi2Fatal;
}

/// The two structures, and the functions that take a pointer to one: a pointer to the header's
/// own structure would be another type.
macro_rules! check_layouts {
    ($($structure:ident { $($field:ident),* $(,)? })*) => {
        $(
            const _: () = assert!(
                size_of::<$structure>() == size_of::<header::$structure>()
                    && align_of::<$structure>() == align_of::<header::$structure>()
            );
            $(const _: () = assert!(
                std::mem::offset_of!($structure, $field)
                    == std::mem::offset_of!(header::$structure, $field)
            );)*
            /// Gives each field to the header's structure, which takes it only if its type fits.
            const _: fn($structure) -> header::$structure = |structure| header::$structure {
                $($field: structure.$field),*
            };
        )*
    };
}

check_layouts! {
    fmi2CallbackFunctions {
        logger, allocateMemory, freeMemory, stepFinished, componentEnvironment,
    }
    fmi2EventInfo {
        newDiscreteStatesNeeded,
        terminateSimulation,
        nominalsOfContinuousStatesChanged,
        valuesOfContinuousStatesChanged,
        nextEventTimeDefined,
        nextEventTime,
    }
}

type Instantiate<Functions> = unsafe extern "C" fn(
    fmi2String,
    fmi2Type,
    fmi2String,
    fmi2String,
    *const Functions,
    fmi2Boolean,
    fmi2Boolean,
) -> fmi2Component;
const _: Instantiate<fmi2CallbackFunctions> = fmi2Instantiate;
const _: header::fmi2InstantiateTYPE = None::<Instantiate<header::fmi2CallbackFunctions>>;

type NewDiscreteStates<Info> = unsafe extern "C" fn(fmi2Component, *mut Info) -> fmi2Status;
const _: NewDiscreteStates<fmi2EventInfo> = fmi2NewDiscreteStates;
const _: header::fmi2NewDiscreteStatesTYPE = None::<NewDiscreteStates<header::fmi2EventInfo>>;

#[test]
fn constants_are_those_of_the_header() {
    assert_eq!(
        [fmi2ModelExchange, fmi2CoSimulation],
        [
            header::fmi2Type_fmi2ModelExchange,
            header::fmi2Type_fmi2CoSimulation
        ]
    );
    assert_eq!(
        [fmi2DoStepStatus, fmi2LastSuccessfulTime, fmi2Terminated],
        [
            header::fmi2StatusKind_fmi2DoStepStatus,
            header::fmi2StatusKind_fmi2LastSuccessfulTime,
            header::fmi2StatusKind_fmi2Terminated,
        ]
    );
    assert_eq!(u32::try_from(fmi2False), Ok(header::fmi2False));
}

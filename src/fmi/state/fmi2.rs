//! Calls of FMI 2.0 by state (3.2.3 and 4.2.4).

use super::{Allowed, Call, Interface, State, table};

table! {
    SetDebugLogging = fmi2SetDebugLogging:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepInProgress StepFailed StepCanceled
            Terminated Error
        ];
    SetupExperiment = fmi2SetupExperiment,
    EnterInitializationMode = fmi2EnterInitializationMode:
        [Instantiated]
        [Instantiated];
    ExitInitializationMode = fmi2ExitInitializationMode:
        [InitializationMode]
        [InitializationMode];
    Terminate = fmi2Terminate:
        [EventMode ContinuousTimeMode]
        [StepComplete StepFailed];
    Reset = fmi2Reset,
    GetFMUstate = fmi2GetFMUstate,
    SetFMUstate = fmi2SetFMUstate,
    FreeFMUstate = fmi2FreeFMUstate,
    SerializedFMUstateSize = fmi2SerializedFMUstateSize,
    SerializeFMUstate = fmi2SerializeFMUstate,
    DeSerializeFMUstate = fmi2DeSerializeFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    GetReal = fmi2GetReal,
    GetInteger = fmi2GetInteger,
    GetBoolean = fmi2GetBoolean,
    GetString = fmi2GetString,
    GetDirectionalDerivative = fmi2GetDirectionalDerivative:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    SetReal = fmi2SetReal:
        [Instantiated InitializationMode EventMode ContinuousTimeMode]
        [Instantiated InitializationMode StepComplete];
    SetInteger = fmi2SetInteger,
    SetBoolean = fmi2SetBoolean,
    SetString = fmi2SetString:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode StepComplete];
    EnterEventMode = fmi2EnterEventMode,
    SetTime = fmi2SetTime:
        [EventMode ContinuousTimeMode]
        [];
    NewDiscreteStates = fmi2NewDiscreteStates,
    EnterContinuousTimeMode = fmi2EnterContinuousTimeMode:
        [EventMode]
        [];
    CompletedIntegratorStep = fmi2CompletedIntegratorStep,
    SetContinuousStates = fmi2SetContinuousStates:
        [ContinuousTimeMode]
        [];
    GetDerivatives = fmi2GetDerivatives,
    GetEventIndicators = fmi2GetEventIndicators,
    GetContinuousStates = fmi2GetContinuousStates:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [];
    GetNominalsOfContinuousStates = fmi2GetNominalsOfContinuousStates:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [];
    SetRealInputDerivatives = fmi2SetRealInputDerivatives:
        []
        [Instantiated InitializationMode StepComplete];
    GetRealOutputDerivatives = fmi2GetRealOutputDerivatives:
        []
        [StepComplete StepFailed StepCanceled Terminated Error];
    DoStep = fmi2DoStep:
        []
        [StepComplete];
    CancelStep = fmi2CancelStep:
        []
        [StepInProgress];
    GetStatus = fmi2GetStatus,
    GetRealStatus = fmi2GetRealStatus,
    GetIntegerStatus = fmi2GetIntegerStatus,
    GetBooleanStatus = fmi2GetBooleanStatus,
    GetStringStatus = fmi2GetStringStatus:
        []
        [StepComplete StepInProgress StepFailed Terminated];
}

/// Returns whether the call may end with `fmi2Discard` (FMI 2.0, 2.1.3).
pub(super) fn may_discard(call: Call, interface: Interface) -> bool {
    match call {
        Call::SetReal | Call::SetInteger | Call::SetBoolean | Call::SetString => true,
        Call::GetReal
        | Call::SetContinuousStates
        | Call::GetContinuousStates
        | Call::GetDerivatives
        | Call::GetEventIndicators => interface == Interface::ModelExchange,
        Call::DoStep
        | Call::GetStatus
        | Call::GetRealStatus
        | Call::GetIntegerStatus
        | Call::GetBooleanStatus
        | Call::GetStringStatus => interface == Interface::CoSimulation,
        _ => false,
    }
}

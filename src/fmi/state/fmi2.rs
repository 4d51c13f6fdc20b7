//! Calls of FMI 2.0 by state (3.2.3 and 4.2.4).

use super::{Allowed, Call, Interface, State, table};

table! {
    SetDebugLogging = fmi2SetDebugLogging:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepInProgress StepFailed
            StepCanceled Terminated Error
        ];
    SetupExperiment = fmi2SetupExperiment:
        [Instantiated]
        [Instantiated];
    EnterInitializationMode = fmi2EnterInitializationMode:
        [Instantiated]
        [Instantiated];
    ExitInitializationMode = fmi2ExitInitializationMode:
        [InitializationMode]
        [InitializationMode];
    Terminate = fmi2Terminate:
        [EventMode ContinuousTimeMode]
        [StepComplete StepFailed];
    Reset = fmi2Reset:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    GetReal = fmi2GetReal:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    GetInteger = fmi2GetInteger:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    GetBoolean = fmi2GetBoolean:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    GetString = fmi2GetString:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    SetReal = fmi2SetReal:
        [Instantiated InitializationMode EventMode ContinuousTimeMode]
        [Instantiated InitializationMode StepComplete];
    SetInteger = fmi2SetInteger:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode StepComplete];
    SetBoolean = fmi2SetBoolean:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode StepComplete];
    SetString = fmi2SetString:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode StepComplete];
    GetFMUstate = fmi2GetFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    SetFMUstate = fmi2SetFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    FreeFMUstate = fmi2FreeFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    SerializedFMUstateSize = fmi2SerializedFMUstateSize:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    SerializeFMUstate = fmi2SerializeFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    DeSerializeFMUstate = fmi2DeSerializeFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    GetDirectionalDerivative = fmi2GetDirectionalDerivative:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    EnterEventMode = fmi2EnterEventMode:
        [EventMode ContinuousTimeMode]
        [];
    NewDiscreteStates = fmi2NewDiscreteStates:
        [EventMode]
        [];
    EnterContinuousTimeMode = fmi2EnterContinuousTimeMode:
        [EventMode]
        [];
    CompletedIntegratorStep = fmi2CompletedIntegratorStep:
        [ContinuousTimeMode]
        [];
    SetTime = fmi2SetTime:
        [EventMode ContinuousTimeMode]
        [];
    SetContinuousStates = fmi2SetContinuousStates:
        [ContinuousTimeMode]
        [];
    GetDerivatives = fmi2GetDerivatives:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [];
    GetEventIndicators = fmi2GetEventIndicators:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [];
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
    GetStatus = fmi2GetStatus:
        []
        [StepComplete StepInProgress StepFailed Terminated];
    GetRealStatus = fmi2GetRealStatus:
        []
        [StepComplete StepInProgress StepFailed Terminated];
    GetIntegerStatus = fmi2GetIntegerStatus:
        []
        [StepComplete StepInProgress StepFailed Terminated];
    GetBooleanStatus = fmi2GetBooleanStatus:
        []
        [StepComplete StepInProgress StepFailed Terminated];
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

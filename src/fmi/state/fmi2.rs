//! Calls of FMI 2.0 by state (3.2.3 and 4.2.4).

use super::{Allowed, Call, Interface, State, table};

table! {
    SetDebugLogging:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepInProgress StepFailed StepCanceled
            Terminated Error
        ];
    SetupExperiment EnterInitializationMode:
        [Instantiated]
        [Instantiated];
    ExitInitializationMode:
        [InitializationMode]
        [InitializationMode];
    Terminate:
        [EventMode ContinuousTimeMode]
        [StepComplete StepFailed];
    Reset GetFMUstate SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate
    DeSerializeFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    GetReal GetInteger GetBoolean GetString GetDirectionalDerivative:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    SetReal:
        [Instantiated InitializationMode EventMode ContinuousTimeMode]
        [Instantiated InitializationMode StepComplete];
    SetInteger SetBoolean SetString:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode StepComplete];
    EnterEventMode SetTime:
        [EventMode ContinuousTimeMode]
        [];
    NewDiscreteStates EnterContinuousTimeMode:
        [EventMode]
        [];
    CompletedIntegratorStep SetContinuousStates:
        [ContinuousTimeMode]
        [];
    GetDerivatives GetEventIndicators GetContinuousStates:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [];
    GetNominalsOfContinuousStates:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [];
    SetRealInputDerivatives:
        []
        [Instantiated InitializationMode StepComplete];
    GetRealOutputDerivatives:
        []
        [StepComplete StepFailed StepCanceled Terminated Error];
    DoStep:
        []
        [StepComplete];
    CancelStep:
        []
        [StepInProgress];
    GetStatus GetRealStatus GetIntegerStatus GetBooleanStatus GetStringStatus:
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

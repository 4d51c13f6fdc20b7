//! Calls of FMI 3.0 by state (2.3, 3.2.1 and 4.2.1).
//!
//! There are no structural parameters, so that configuration mode is never entered, and no
//! scheduled execution: their calls are never allowed.

use super::{Allowed, Call, Interface, State, table};

table! {
    SetDebugLogging Reset GetInt8 GetUInt8 GetInt16 GetUInt16 GetInt32 GetUInt32 GetInteger
    GetUInt64 GetBoolean GetString GetBinary GetNumberOfVariableDependencies GetVariableDependencies
    GetFMUstate SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate
    DeSerializeFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    EnterInitializationMode:
        [Instantiated]
        [Instantiated];
    ExitInitializationMode SetShiftDecimal SetShiftFraction:
        [InitializationMode]
        [InitializationMode];
    EnterEventMode:
        [ContinuousTimeMode]
        [StepMode];
    Terminate:
        [EventMode ContinuousTimeMode]
        [EventMode StepMode];
    GetReal GetFloat32:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode IntermediateUpdateMode Terminated];
    SetReal SetFloat32:
        [Instantiated InitializationMode EventMode ContinuousTimeMode]
        [Instantiated InitializationMode EventMode StepMode IntermediateUpdateMode];
    SetInt8 SetUInt8 SetInt16 SetUInt16 SetInt32 SetUInt32 SetInteger SetUInt64 SetBoolean SetString
    SetBinary:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetClock SetClock EvaluateDiscreteStates NewDiscreteStates:
        [EventMode]
        [EventMode];
    GetDirectionalDerivative GetAdjointDerivative:
        [InitializationMode EventMode ContinuousTimeMode Terminated]
        [InitializationMode EventMode StepMode Terminated];
    GetIntervalDecimal GetIntervalFraction GetShiftDecimal GetShiftFraction SetIntervalDecimal
    SetIntervalFraction:
        [InitializationMode EventMode]
        [InitializationMode EventMode];
    EnterContinuousTimeMode:
        [EventMode]
        [];
    CompletedIntegratorStep SetTime SetContinuousStates:
        [ContinuousTimeMode]
        [];
    GetDerivatives GetEventIndicators GetContinuousStates GetNominalsOfContinuousStates:
        [InitializationMode EventMode ContinuousTimeMode Terminated]
        [];
    GetNumberOfEventIndicators GetNumberOfContinuousStates:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [];
    EnterStepMode:
        []
        [EventMode];
    GetRealOutputDerivatives:
        []
        [StepMode IntermediateUpdateMode Terminated];
    DoStep:
        []
        [StepMode];
}

//! Calls of FMI 3.0 by state (2.3, 3.2.1 and 4.2.1).
//!
//! There are no structural parameters, so that configuration mode is never entered, and no
//! scheduled execution.

use super::{Allowed, Call, Interface, State, table};

table! {
    SetDebugLogging = fmi3SetDebugLogging,
    Reset = fmi3Reset,
    GetInt8 = fmi3GetInt8,
    GetUInt8 = fmi3GetUInt8,
    GetInt16 = fmi3GetInt16,
    GetUInt16 = fmi3GetUInt16,
    GetInt32 = fmi3GetInt32,
    GetUInt32 = fmi3GetUInt32,
    GetInteger = fmi3GetInt64,
    GetUInt64 = fmi3GetUInt64,
    GetBoolean = fmi3GetBoolean,
    GetString = fmi3GetString,
    GetBinary = fmi3GetBinary,
    GetNumberOfVariableDependencies = fmi3GetNumberOfVariableDependencies,
    GetVariableDependencies = fmi3GetVariableDependencies,
    GetFMUstate = fmi3GetFMUState,
    SetFMUstate = fmi3SetFMUState,
    FreeFMUstate = fmi3FreeFMUState,
    SerializedFMUstateSize = fmi3SerializedFMUStateSize,
    SerializeFMUstate = fmi3SerializeFMUState,
    DeSerializeFMUstate = fmi3DeserializeFMUState:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    EnterInitializationMode = fmi3EnterInitializationMode:
        [Instantiated]
        [Instantiated];
    ExitInitializationMode = fmi3ExitInitializationMode,
    SetShiftDecimal = fmi3SetShiftDecimal,
    SetShiftFraction = fmi3SetShiftFraction:
        [InitializationMode]
        [InitializationMode];
    EnterEventMode = fmi3EnterEventMode:
        [ContinuousTimeMode]
        [StepMode];
    Terminate = fmi3Terminate:
        [EventMode ContinuousTimeMode]
        [EventMode StepMode];
    GetReal = fmi3GetFloat64,
    GetFloat32 = fmi3GetFloat32:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode IntermediateUpdateMode Terminated];
    SetReal = fmi3SetFloat64,
    SetFloat32 = fmi3SetFloat32:
        [Instantiated InitializationMode EventMode ContinuousTimeMode]
        [Instantiated InitializationMode EventMode StepMode IntermediateUpdateMode];
    SetInt8 = fmi3SetInt8,
    SetUInt8 = fmi3SetUInt8,
    SetInt16 = fmi3SetInt16,
    SetUInt16 = fmi3SetUInt16,
    SetInt32 = fmi3SetInt32,
    SetUInt32 = fmi3SetUInt32,
    SetInteger = fmi3SetInt64,
    SetUInt64 = fmi3SetUInt64,
    SetBoolean = fmi3SetBoolean,
    SetString = fmi3SetString,
    SetBinary = fmi3SetBinary:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetClock = fmi3GetClock,
    SetClock = fmi3SetClock,
    EvaluateDiscreteStates = fmi3EvaluateDiscreteStates,
    NewDiscreteStates = fmi3UpdateDiscreteStates:
        [EventMode]
        [EventMode];
    GetDirectionalDerivative = fmi3GetDirectionalDerivative,
    GetAdjointDerivative = fmi3GetAdjointDerivative:
        [InitializationMode EventMode ContinuousTimeMode Terminated]
        [InitializationMode EventMode StepMode Terminated];
    EnterConfigurationMode = fmi3EnterConfigurationMode,
    ExitConfigurationMode = fmi3ExitConfigurationMode,
    ActivateModelPartition = fmi3ActivateModelPartition:
        []
        [];
    GetIntervalDecimal = fmi3GetIntervalDecimal,
    GetIntervalFraction = fmi3GetIntervalFraction,
    GetShiftDecimal = fmi3GetShiftDecimal,
    GetShiftFraction = fmi3GetShiftFraction,
    SetIntervalDecimal = fmi3SetIntervalDecimal,
    SetIntervalFraction = fmi3SetIntervalFraction:
        [InitializationMode EventMode]
        [InitializationMode EventMode];
    EnterContinuousTimeMode = fmi3EnterContinuousTimeMode:
        [EventMode]
        [];
    CompletedIntegratorStep = fmi3CompletedIntegratorStep,
    SetTime = fmi3SetTime,
    SetContinuousStates = fmi3SetContinuousStates:
        [ContinuousTimeMode]
        [];
    GetDerivatives = fmi3GetContinuousStateDerivatives,
    GetEventIndicators = fmi3GetEventIndicators,
    GetContinuousStates = fmi3GetContinuousStates,
    GetNominalsOfContinuousStates = fmi3GetNominalsOfContinuousStates:
        [InitializationMode EventMode ContinuousTimeMode Terminated]
        [];
    GetNumberOfEventIndicators = fmi3GetNumberOfEventIndicators,
    GetNumberOfContinuousStates = fmi3GetNumberOfContinuousStates:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [];
    EnterStepMode = fmi3EnterStepMode:
        []
        [EventMode];
    GetRealOutputDerivatives = fmi3GetOutputDerivatives:
        []
        [StepMode IntermediateUpdateMode Terminated];
    DoStep = fmi3DoStep:
        []
        [StepMode];
}

//! Calls of FMI 3.0 by state (2.3, 3.2.1 and 4.2.1).
//!
//! There are no structural parameters, so that configuration mode is never entered, and no
//! scheduled execution.

use super::{Allowed, Call, Interface, State, table};

table! {
    SetDebugLogging = fmi3SetDebugLogging:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    EnterInitializationMode = fmi3EnterInitializationMode:
        [Instantiated]
        [Instantiated];
    ExitInitializationMode = fmi3ExitInitializationMode:
        [InitializationMode]
        [InitializationMode];
    EnterEventMode = fmi3EnterEventMode:
        [ContinuousTimeMode]
        [StepMode];
    Terminate = fmi3Terminate:
        [EventMode ContinuousTimeMode]
        [EventMode StepMode];
    Reset = fmi3Reset:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    GetReal = fmi3GetFloat64:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode IntermediateUpdateMode Terminated];
    SetReal = fmi3SetFloat64:
        [Instantiated InitializationMode EventMode ContinuousTimeMode]
        [Instantiated InitializationMode EventMode StepMode IntermediateUpdateMode];
    GetFloat32 = fmi3GetFloat32:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode IntermediateUpdateMode Terminated];
    SetFloat32 = fmi3SetFloat32:
        [Instantiated InitializationMode EventMode ContinuousTimeMode]
        [Instantiated InitializationMode EventMode StepMode IntermediateUpdateMode];
    GetInt8 = fmi3GetInt8:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SetInt8 = fmi3SetInt8:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetUInt8 = fmi3GetUInt8:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SetUInt8 = fmi3SetUInt8:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetInt16 = fmi3GetInt16:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SetInt16 = fmi3SetInt16:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetUInt16 = fmi3GetUInt16:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SetUInt16 = fmi3SetUInt16:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetInt32 = fmi3GetInt32:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SetInt32 = fmi3SetInt32:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetUInt32 = fmi3GetUInt32:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SetUInt32 = fmi3SetUInt32:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetInteger = fmi3GetInt64:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SetInteger = fmi3SetInt64:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetUInt64 = fmi3GetUInt64:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SetUInt64 = fmi3SetUInt64:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetBoolean = fmi3GetBoolean:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SetBoolean = fmi3SetBoolean:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetString = fmi3GetString:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SetString = fmi3SetString:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetBinary = fmi3GetBinary:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SetBinary = fmi3SetBinary:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode EventMode StepMode];
    GetClock = fmi3GetClock:
        [EventMode]
        [EventMode];
    SetClock = fmi3SetClock:
        [EventMode]
        [EventMode];
    GetNumberOfVariableDependencies = fmi3GetNumberOfVariableDependencies:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    GetVariableDependencies = fmi3GetVariableDependencies:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    GetFMUstate = fmi3GetFMUState:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SetFMUstate = fmi3SetFMUState:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    FreeFMUstate = fmi3FreeFMUState:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SerializedFMUstateSize = fmi3SerializedFMUStateSize:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    SerializeFMUstate = fmi3SerializeFMUState:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    DeSerializeFMUstate = fmi3DeserializeFMUState:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [Instantiated InitializationMode EventMode StepMode Terminated];
    GetDirectionalDerivative = fmi3GetDirectionalDerivative:
        [InitializationMode EventMode ContinuousTimeMode Terminated]
        [InitializationMode EventMode StepMode Terminated];
    GetAdjointDerivative = fmi3GetAdjointDerivative:
        [InitializationMode EventMode ContinuousTimeMode Terminated]
        [InitializationMode EventMode StepMode Terminated];
    EnterConfigurationMode = fmi3EnterConfigurationMode:
        []
        [];
    ExitConfigurationMode = fmi3ExitConfigurationMode:
        []
        [];
    GetIntervalDecimal = fmi3GetIntervalDecimal:
        [InitializationMode EventMode]
        [InitializationMode EventMode];
    GetIntervalFraction = fmi3GetIntervalFraction:
        [InitializationMode EventMode]
        [InitializationMode EventMode];
    GetShiftDecimal = fmi3GetShiftDecimal:
        [InitializationMode EventMode]
        [InitializationMode EventMode];
    GetShiftFraction = fmi3GetShiftFraction:
        [InitializationMode EventMode]
        [InitializationMode EventMode];
    SetIntervalDecimal = fmi3SetIntervalDecimal:
        [InitializationMode EventMode]
        [InitializationMode EventMode];
    SetIntervalFraction = fmi3SetIntervalFraction:
        [InitializationMode EventMode]
        [InitializationMode EventMode];
    SetShiftDecimal = fmi3SetShiftDecimal:
        [InitializationMode]
        [InitializationMode];
    SetShiftFraction = fmi3SetShiftFraction:
        [InitializationMode]
        [InitializationMode];
    EvaluateDiscreteStates = fmi3EvaluateDiscreteStates:
        [EventMode]
        [EventMode];
    NewDiscreteStates = fmi3UpdateDiscreteStates:
        [EventMode]
        [EventMode];
    EnterContinuousTimeMode = fmi3EnterContinuousTimeMode:
        [EventMode]
        [];
    CompletedIntegratorStep = fmi3CompletedIntegratorStep:
        [ContinuousTimeMode]
        [];
    SetTime = fmi3SetTime:
        [ContinuousTimeMode]
        [];
    SetContinuousStates = fmi3SetContinuousStates:
        [ContinuousTimeMode]
        [];
    GetDerivatives = fmi3GetContinuousStateDerivatives:
        [InitializationMode EventMode ContinuousTimeMode Terminated]
        [];
    GetEventIndicators = fmi3GetEventIndicators:
        [InitializationMode EventMode ContinuousTimeMode Terminated]
        [];
    GetContinuousStates = fmi3GetContinuousStates:
        [InitializationMode EventMode ContinuousTimeMode Terminated]
        [];
    GetNominalsOfContinuousStates = fmi3GetNominalsOfContinuousStates:
        [InitializationMode EventMode ContinuousTimeMode Terminated]
        [];
    GetNumberOfEventIndicators = fmi3GetNumberOfEventIndicators:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated]
        [];
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
    ActivateModelPartition = fmi3ActivateModelPartition:
        []
        [];
}

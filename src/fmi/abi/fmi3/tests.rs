//! The tests of both versions with FMI 3.0; its steps and the constants of its header.

use fmi_sys::fmi3 as header;

use super::access::*;
use super::derivatives::*;
use super::exchange::*;
use super::fmu_state::*;
use super::lifecycle::*;
use super::stepping::*;
use super::types::*;
use crate::fmi::Version;
use crate::fmi::abi::tests::{Abi, component, header_tests};

// SAFETY: as for the functions.
const ABI: Abi<fmi3Byte> = unsafe {
    Abi {
        version: Version::Fmi3,
        enter_initialization_mode: |c| fmi3EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0),
        set_one_debug_category: |c, category| fmi3SetDebugLogging(c, true, 1, &category),
        get: |c, references, n, values| fmi3GetFloat64(c, references, n, values, n),
        set: |c, references, n, values| fmi3SetFloat64(c, references, n, values, n),
        get_state: fmi3GetFMUState,
        set_state: fmi3SetFMUState,
        free_state: fmi3FreeFMUState,
        state_size: fmi3SerializedFMUStateSize,
        serialize: fmi3SerializeFMUState,
        deserialize: fmi3DeserializeFMUState,
        free: fmi3FreeInstance,
    }
};

header_tests! {
    ABI, Fmi3Binding;
    on an instance:
        fmi3SetDebugLogging, fmi3EnterInitializationMode, fmi3ExitInitializationMode,
        fmi3EnterEventMode, fmi3Terminate, fmi3Reset, fmi3GetFloat32, fmi3GetFloat64, fmi3GetInt8,
        fmi3GetUInt8, fmi3GetInt16, fmi3GetUInt16, fmi3GetInt32, fmi3GetUInt32, fmi3GetInt64,
        fmi3GetUInt64, fmi3GetBoolean, fmi3GetString, fmi3GetBinary, fmi3GetClock, fmi3SetFloat32,
        fmi3SetFloat64, fmi3SetInt8, fmi3SetUInt8, fmi3SetInt16, fmi3SetUInt16, fmi3SetInt32,
        fmi3SetUInt32, fmi3SetInt64, fmi3SetUInt64, fmi3SetBoolean, fmi3SetString, fmi3SetBinary,
        fmi3SetClock, fmi3GetNumberOfVariableDependencies, fmi3GetVariableDependencies,
        fmi3GetFMUState, fmi3SetFMUState, fmi3FreeFMUState, fmi3SerializedFMUStateSize,
        fmi3SerializeFMUState, fmi3DeserializeFMUState, fmi3GetDirectionalDerivative,
        fmi3GetAdjointDerivative, fmi3EnterConfigurationMode, fmi3ExitConfigurationMode,
        fmi3GetIntervalDecimal, fmi3GetIntervalFraction, fmi3GetShiftDecimal, fmi3GetShiftFraction,
        fmi3SetIntervalDecimal, fmi3SetIntervalFraction, fmi3SetShiftDecimal, fmi3SetShiftFraction,
        fmi3EvaluateDiscreteStates, fmi3UpdateDiscreteStates, fmi3EnterContinuousTimeMode,
        fmi3CompletedIntegratorStep, fmi3SetTime, fmi3SetContinuousStates,
        fmi3GetContinuousStateDerivatives, fmi3GetEventIndicators, fmi3GetContinuousStates,
        fmi3GetNominalsOfContinuousStates, fmi3GetNumberOfEventIndicators,
        fmi3GetNumberOfContinuousStates, fmi3EnterStepMode, fmi3GetOutputDerivatives, fmi3DoStep,
        fmi3ActivateModelPartition;
    others:
        fmi3GetVersion, fmi3InstantiateModelExchange, fmi3InstantiateCoSimulation,
        fmi3InstantiateScheduledExecution, fmi3FreeInstance;
    // The number of functions in `fmi3Functions.h`.
    of 75;
    types:
        fmi3Instance fmi3InstanceEnvironment fmi3FMUState fmi3ValueReference fmi3Float32 fmi3Float64
        fmi3Int8 fmi3UInt8 fmi3Int16 fmi3UInt16 fmi3Int32 fmi3UInt32 fmi3Int64 fmi3UInt64
        fmi3Boolean fmi3Char fmi3String fmi3Byte fmi3Binary fmi3Clock fmi3Status fmi3DependencyKind
        fmi3IntervalQualifier fmi3LogMessageCallback fmi3ClockUpdateCallback
        fmi3LockPreemptionCallback fmi3UnlockPreemptionCallback fmi3IntermediateUpdateCallback;
    statuses:
        fmi3Status_fmi3OK fmi3Status_fmi3Warning fmi3Status_fmi3Discard fmi3Status_fmi3Error
        fmi3Status_fmi3Fatal;
}

/// In FMI 3.0 a refused call ends the simulation (2.3.1): pointers that are not aligned are no reason.
#[test]
fn a_step_writes_to_any_address() {
    let c = component(Version::Fmi3);
    let mut memory = [[0_u8; 8]; 4];
    let [mut event, mut end, mut early] = [false; 3];
    // SAFETY: the component is a new one; the memory has room for a reference and a number, each at an
    // odd address.
    unsafe {
        assert_eq!(
            fmi3EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0),
            0
        );
        assert_eq!(fmi3ExitInitializationMode(c), 0);
        let memory = memory.as_mut_ptr().cast::<u8>();
        let (reference, number) = (memory.add(1).cast::<u32>(), memory.add(17).cast::<f64>());
        reference.write_unaligned(1);
        number.write_unaligned(0.7);
        assert_eq!(fmi3SetFloat64(c, reference, 1, number, 1), 0);
        let (event, end, early) = (&raw mut event, &raw mut end, &raw mut early);
        assert_eq!(fmi3DoStep(c, 0.0, 0.25, true, event, end, early, number), 0);
        assert_eq!(number.read_unaligned().to_bits(), 0.25_f64.to_bits());
        assert_eq!(fmi3GetFloat64(c, reference, 1, number, 1), 0);
        assert_eq!(number.read_unaligned().to_bits(), 0.7_f64.to_bits());
        fmi3FreeInstance(c);
    }
}

#[test]
fn constants_are_those_of_the_header() {
    assert_eq!(
        [fmi3Constant, fmi3Dependent],
        [
            header::fmi3DependencyKind_fmi3Constant,
            header::fmi3DependencyKind_fmi3Dependent,
        ]
    );
}

//! The signatures and constants of the standard's headers.

use fmi_sys::fmi3 as header;

use super::access::*;
use super::derivatives::*;
use super::exchange::*;
use super::fmu_state::*;
use super::lifecycle::*;
use super::stepping::*;
use super::types::*;
use crate::fmi::abi::component::{Component, status_code};
use crate::fmi::{Category, Instance, Interface, MechanismModel, Sink, Status, Version};
use crate::mechanism::{Mechanism, Source};

/// In FMI 3.0 a refused call ends the simulation (2.3.1): pointers that are not aligned are no reason.
#[test]
fn a_step_writes_to_any_address() {
    let text = include_str!("../../../../mechanisms/pendulum.toml");
    let (mechanism, _) = Mechanism::parse(&Source::new("pendulum.toml", text)).unwrap();
    let model = MechanismModel::new(mechanism.into(), Interface::CoSimulation).unwrap();
    let instance = Instance::of_version(Version::Fmi3, model, Box::new(Silent), false);
    let c = Component::hand_over(instance, None);
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

struct Silent;

impl Sink for Silent {
    fn write(&self, _: Status, _: Category, _: &str) {}
}

/// Checks at compile time that each function has the signature of the standard's header.
macro_rules! check_signatures {
    ($($function:ident: $signature:ident,)*) => {
        $(const _: header::$signature = Some($function);)*
        const FUNCTIONS: usize = [$(stringify!($function)),*].len();
    };
}

check_signatures! {
    fmi3GetVersion: fmi3GetVersionTYPE,
    fmi3SetDebugLogging: fmi3SetDebugLoggingTYPE,
    fmi3InstantiateModelExchange: fmi3InstantiateModelExchangeTYPE,
    fmi3InstantiateCoSimulation: fmi3InstantiateCoSimulationTYPE,
    fmi3InstantiateScheduledExecution: fmi3InstantiateScheduledExecutionTYPE,
    fmi3FreeInstance: fmi3FreeInstanceTYPE,
    fmi3EnterInitializationMode: fmi3EnterInitializationModeTYPE,
    fmi3ExitInitializationMode: fmi3ExitInitializationModeTYPE,
    fmi3EnterEventMode: fmi3EnterEventModeTYPE,
    fmi3Terminate: fmi3TerminateTYPE,
    fmi3Reset: fmi3ResetTYPE,
    fmi3GetFloat32: fmi3GetFloat32TYPE,
    fmi3GetFloat64: fmi3GetFloat64TYPE,
    fmi3GetInt8: fmi3GetInt8TYPE,
    fmi3GetUInt8: fmi3GetUInt8TYPE,
    fmi3GetInt16: fmi3GetInt16TYPE,
    fmi3GetUInt16: fmi3GetUInt16TYPE,
    fmi3GetInt32: fmi3GetInt32TYPE,
    fmi3GetUInt32: fmi3GetUInt32TYPE,
    fmi3GetInt64: fmi3GetInt64TYPE,
    fmi3GetUInt64: fmi3GetUInt64TYPE,
    fmi3GetBoolean: fmi3GetBooleanTYPE,
    fmi3GetString: fmi3GetStringTYPE,
    fmi3GetBinary: fmi3GetBinaryTYPE,
    fmi3GetClock: fmi3GetClockTYPE,
    fmi3SetFloat32: fmi3SetFloat32TYPE,
    fmi3SetFloat64: fmi3SetFloat64TYPE,
    fmi3SetInt8: fmi3SetInt8TYPE,
    fmi3SetUInt8: fmi3SetUInt8TYPE,
    fmi3SetInt16: fmi3SetInt16TYPE,
    fmi3SetUInt16: fmi3SetUInt16TYPE,
    fmi3SetInt32: fmi3SetInt32TYPE,
    fmi3SetUInt32: fmi3SetUInt32TYPE,
    fmi3SetInt64: fmi3SetInt64TYPE,
    fmi3SetUInt64: fmi3SetUInt64TYPE,
    fmi3SetBoolean: fmi3SetBooleanTYPE,
    fmi3SetString: fmi3SetStringTYPE,
    fmi3SetBinary: fmi3SetBinaryTYPE,
    fmi3SetClock: fmi3SetClockTYPE,
    fmi3GetNumberOfVariableDependencies: fmi3GetNumberOfVariableDependenciesTYPE,
    fmi3GetVariableDependencies: fmi3GetVariableDependenciesTYPE,
    fmi3GetFMUState: fmi3GetFMUStateTYPE,
    fmi3SetFMUState: fmi3SetFMUStateTYPE,
    fmi3FreeFMUState: fmi3FreeFMUStateTYPE,
    fmi3SerializedFMUStateSize: fmi3SerializedFMUStateSizeTYPE,
    fmi3SerializeFMUState: fmi3SerializeFMUStateTYPE,
    fmi3DeserializeFMUState: fmi3DeserializeFMUStateTYPE,
    fmi3GetDirectionalDerivative: fmi3GetDirectionalDerivativeTYPE,
    fmi3GetAdjointDerivative: fmi3GetAdjointDerivativeTYPE,
    fmi3EnterConfigurationMode: fmi3EnterConfigurationModeTYPE,
    fmi3ExitConfigurationMode: fmi3ExitConfigurationModeTYPE,
    fmi3GetIntervalDecimal: fmi3GetIntervalDecimalTYPE,
    fmi3GetIntervalFraction: fmi3GetIntervalFractionTYPE,
    fmi3GetShiftDecimal: fmi3GetShiftDecimalTYPE,
    fmi3GetShiftFraction: fmi3GetShiftFractionTYPE,
    fmi3SetIntervalDecimal: fmi3SetIntervalDecimalTYPE,
    fmi3SetIntervalFraction: fmi3SetIntervalFractionTYPE,
    fmi3SetShiftDecimal: fmi3SetShiftDecimalTYPE,
    fmi3SetShiftFraction: fmi3SetShiftFractionTYPE,
    fmi3EvaluateDiscreteStates: fmi3EvaluateDiscreteStatesTYPE,
    fmi3UpdateDiscreteStates: fmi3UpdateDiscreteStatesTYPE,
    fmi3EnterContinuousTimeMode: fmi3EnterContinuousTimeModeTYPE,
    fmi3CompletedIntegratorStep: fmi3CompletedIntegratorStepTYPE,
    fmi3SetTime: fmi3SetTimeTYPE,
    fmi3SetContinuousStates: fmi3SetContinuousStatesTYPE,
    fmi3GetContinuousStateDerivatives: fmi3GetContinuousStateDerivativesTYPE,
    fmi3GetEventIndicators: fmi3GetEventIndicatorsTYPE,
    fmi3GetContinuousStates: fmi3GetContinuousStatesTYPE,
    fmi3GetNominalsOfContinuousStates: fmi3GetNominalsOfContinuousStatesTYPE,
    fmi3GetNumberOfEventIndicators: fmi3GetNumberOfEventIndicatorsTYPE,
    fmi3GetNumberOfContinuousStates: fmi3GetNumberOfContinuousStatesTYPE,
    fmi3EnterStepMode: fmi3EnterStepModeTYPE,
    fmi3GetOutputDerivatives: fmi3GetOutputDerivativesTYPE,
    fmi3DoStep: fmi3DoStepTYPE,
    fmi3ActivateModelPartition: fmi3ActivateModelPartitionTYPE,
}

/// Checks at compile time that each type is that of the standard's header.
macro_rules! check_types {
    ($($name:ident,)*) => {
        $(const _: fn($name) -> header::$name = |value| value;)*
        const TYPES: usize = [$(stringify!($name)),*].len();
    };
}

check_types! {
    fmi3Instance,
    fmi3InstanceEnvironment,
    fmi3FMUState,
    fmi3ValueReference,
    fmi3Float32,
    fmi3Float64,
    fmi3Int8,
    fmi3UInt8,
    fmi3Int16,
    fmi3UInt16,
    fmi3Int32,
    fmi3UInt32,
    fmi3Int64,
    fmi3UInt64,
    fmi3Boolean,
    fmi3Char,
    fmi3String,
    fmi3Byte,
    fmi3Binary,
    fmi3Clock,
    fmi3Status,
    fmi3DependencyKind,
    fmi3IntervalQualifier,
    fmi3LogMessageCallback,
    fmi3ClockUpdateCallback,
    fmi3LockPreemptionCallback,
    fmi3UnlockPreemptionCallback,
    fmi3IntermediateUpdateCallback,
}

/// No exported function and no type is left out of the comparisons.
#[test]
fn all_functions_and_types_are_compared() {
    // `fmi3Functions.h` has 75.
    assert_eq!(FUNCTIONS, 75);
    let types = include_str!("types.rs").matches("\npub type ").count();
    assert_eq!(TYPES, types);
}

#[test]
fn constants_are_those_of_the_header() {
    assert_eq!(
        [
            Status::Ok,
            Status::Warning,
            Status::Discard,
            Status::Error,
            Status::Fatal
        ]
        .map(status_code),
        [
            header::fmi3Status_fmi3OK,
            header::fmi3Status_fmi3Warning,
            header::fmi3Status_fmi3Discard,
            header::fmi3Status_fmi3Error,
            header::fmi3Status_fmi3Fatal,
        ]
    );
    assert_eq!(
        [fmi3Constant, fmi3Dependent],
        [
            header::fmi3DependencyKind_fmi3Constant,
            header::fmi3DependencyKind_fmi3Dependent,
        ]
    );
}

//! Cases that no host can bring about, or see, by itself. `tests/fmi/c_host` has the rest.

use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use fmi_sys::fmi2 as header;
use fmi_sys::fmi2::{
    fmi2Status_fmi2Error as fmi2Error, fmi2Status_fmi2Fatal as fmi2Fatal,
    fmi2Status_fmi2OK as fmi2OK,
};

use super::access::*;
use super::exchange::*;
use super::fmu_state::*;
use super::lifecycle::*;
use super::stepping::*;
use super::types::*;
use crate::fmi::abi::component::{Component, Handle, StatusCode, status_code};
use crate::fmi::{Category, Instance, Interface, MechanismModel, Sink, Status};
use crate::mechanism::{Mechanism, Source};

/// A sink that panics at its first message and counts the fatal ones after it.
#[derive(Default)]
struct Breaking {
    broken: AtomicBool,
    fatal: Arc<AtomicUsize>,
}

impl Sink for Breaking {
    fn write(&self, status: Status, _: Category, _: &str) {
        assert!(self.broken.swap(true, Ordering::Relaxed), "a defect");
        if status == Status::Fatal {
            self.fatal.fetch_add(1, Ordering::Relaxed);
        }
    }
}

fn component(sink: impl Sink + Send + 'static) -> Handle {
    let text = include_str!("../../../../mechanisms/pendulum.toml");
    let (mechanism, _) = Mechanism::parse(&Source::new("pendulum.toml", text)).unwrap();
    let model = MechanismModel::new(mechanism.into(), Interface::CoSimulation).unwrap();
    Component::hand_over(Instance::new(model, Box::new(sink), false), None)
}

/// Answers of each function that goes to an instance, given nothing.
///
/// # Safety
///
/// As for the functions.
unsafe fn answers(c: Handle) -> [StatusCode; 40] {
    // SAFETY: promised by the caller; null pointers are legal arguments or refused.
    unsafe {
        [
            fmi2SetDebugLogging(c, 0, 0, null()),
            fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0),
            fmi2EnterInitializationMode(c),
            fmi2ExitInitializationMode(c),
            fmi2Terminate(c),
            fmi2Reset(c),
            fmi2GetReal(c, null(), 0, null_mut()),
            fmi2GetInteger(c, null(), 0, null_mut()),
            fmi2GetBoolean(c, null(), 0, null_mut()),
            fmi2GetString(c, null(), 0, null_mut()),
            fmi2SetReal(c, null(), 0, null()),
            fmi2SetInteger(c, null(), 0, null()),
            fmi2SetBoolean(c, null(), 0, null()),
            fmi2SetString(c, null(), 0, null()),
            fmi2GetFMUstate(c, &mut null_mut()),
            fmi2SetFMUstate(c, null_mut()),
            fmi2FreeFMUstate(c, &mut null_mut()),
            fmi2SerializedFMUstateSize(c, null_mut(), null_mut()),
            fmi2SerializeFMUstate(c, null_mut(), null_mut(), 0),
            fmi2DeSerializeFMUstate(c, null(), 0, &mut null_mut()),
            fmi2GetDirectionalDerivative(c, null(), 0, null(), 0, null(), null_mut()),
            fmi2SetRealInputDerivatives(c, null(), 0, null(), null()),
            fmi2GetRealOutputDerivatives(c, null(), 0, null(), null_mut()),
            fmi2DoStep(c, 0.0, 1.0, 1),
            fmi2CancelStep(c),
            fmi2GetStatus(c, 0, null_mut()),
            fmi2GetRealStatus(c, 2, null_mut()),
            fmi2GetIntegerStatus(c, 0, null_mut()),
            fmi2GetBooleanStatus(c, 3, null_mut()),
            fmi2GetStringStatus(c, 1, null_mut()),
            fmi2EnterEventMode(c),
            fmi2NewDiscreteStates(c, null_mut()),
            fmi2EnterContinuousTimeMode(c),
            fmi2CompletedIntegratorStep(c, 1, null_mut(), null_mut()),
            fmi2SetTime(c, 0.0),
            fmi2SetContinuousStates(c, null(), 0),
            fmi2GetDerivatives(c, null_mut(), 0),
            fmi2GetEventIndicators(c, null_mut(), 0),
            fmi2GetContinuousStates(c, null_mut(), 0),
            fmi2GetNominalsOfContinuousStates(c, null_mut(), 0),
        ]
    }
}

#[test]
fn after_a_defect_nothing_but_freeing_is_left() {
    let sink = Breaking::default();
    let fatal = Arc::clone(&sink.fatal);
    let c = component(sink);
    // SAFETY: the component is a new one, and the list has one string.
    let status = unsafe { fmi2SetDebugLogging(c, 1, 1, &c"nonsense".as_ptr()) };
    assert_eq!(status, fmi2Fatal);
    assert_eq!(fatal.load(Ordering::Relaxed), 1);
    // SAFETY: it has not been freed.
    let answers = unsafe { answers(c) };
    assert_eq!(answers, [fmi2Error; 40]);
    assert_eq!(fatal.load(Ordering::Relaxed), 1);
    // SAFETY: it is not used any more.
    unsafe { fmi2FreeInstance(c) };
}

/// Getters write to memory that holds nothing yet, as much as they should.
#[test]
fn memory_to_be_written_need_not_hold_anything() {
    let c = component(Breaking::default());
    let mut values = [MaybeUninit::<f64>::uninit(); 3];
    let mut state = MaybeUninit::uninit();
    let mut size = MaybeUninit::uninit();
    // SAFETY: the component is a new one, arrays are as long as is said, and `state` is read
    // after `fmi2DeSerializeFMUstate` has written it.
    unsafe {
        assert_eq!(fmi2EnterInitializationMode(c), fmi2OK);
        let status = fmi2GetReal(c, [1, 2].as_ptr(), 2, values.as_mut_ptr().cast());
        assert_eq!(status, fmi2OK);
        let written = [values[0].assume_init(), values[1].assume_init()];
        assert_eq!(written[1].to_bits(), 0.0_f64.to_bits());

        let mut got = null_mut();
        assert_eq!(fmi2GetFMUstate(c, &mut got), fmi2OK);
        let status = fmi2SerializedFMUstateSize(c, got, size.as_mut_ptr());
        assert_eq!(status, fmi2OK);
        let size = size.assume_init();
        let mut bytes = vec![MaybeUninit::<u8>::uninit(); size];
        let status = fmi2SerializeFMUstate(c, got, bytes.as_mut_ptr().cast(), size);
        assert_eq!(status, fmi2OK);
        let status = fmi2DeSerializeFMUstate(c, bytes.as_ptr().cast(), size, state.as_mut_ptr());
        assert_eq!(status, fmi2OK);
        let mut state = state.assume_init();
        assert_eq!(fmi2SetFMUstate(c, state), fmi2OK);
        for handle in [&mut got, &mut state] {
            assert_eq!(fmi2FreeFMUstate(c, handle), fmi2OK);
            assert!(handle.is_null());
        }
        fmi2FreeInstance(c);
    }
}

/// Hosts that pack their data pass pointers that are not aligned.
#[test]
fn arrays_begin_at_any_address() {
    let c = component(Breaking::default());
    // SAFETY: the component is a new one.
    assert_eq!(unsafe { fmi2EnterInitializationMode(c) }, fmi2OK);
    for offset in 0..8 {
        let mut memory = [[0_u8; 8]; 8];
        let set = f64::from(offset) + 0.1;
        // SAFETY: the memory has room for a reference, two numbers and a state, each with its offset.
        unsafe {
            let place = |k: usize| {
                memory
                    .as_mut_ptr()
                    .cast::<u8>()
                    .add(16 * k + offset as usize)
            };
            let [references, given, got, state] = [0, 1, 2, 3].map(place);
            let (references, state) = (references.cast::<u32>(), state.cast::<Handle>());
            let (given, got) = (given.cast::<f64>(), got.cast::<f64>());
            references.write_unaligned(1);
            given.write_unaligned(set);
            assert_eq!(fmi2SetReal(c, references, 1, given), fmi2OK);
            assert_eq!(fmi2GetReal(c, references, 1, got), fmi2OK);
            assert_eq!(got.read_unaligned().to_bits(), set.to_bits());
            state.write_unaligned(null_mut());
            assert_eq!(fmi2GetFMUstate(c, state), fmi2OK);
            assert_eq!(fmi2SetFMUstate(c, state.read_unaligned()), fmi2OK);
            assert_eq!(fmi2FreeFMUstate(c, state), fmi2OK);
            assert!(state.read_unaligned().is_null());
        }
    }
    // SAFETY: it is not used any more.
    unsafe { fmi2FreeInstance(c) };
}

/// Checks at compile time that each function has the signature of the standard's header.
macro_rules! check_signatures {
    ($($function:ident: $signature:ident,)*) => {
        $(const _: header::$signature = Some($function);)*
        const FUNCTIONS: usize = [$(stringify!($function)),*].len();
    };
}

check_signatures! {
    fmi2GetTypesPlatform: fmi2GetTypesPlatformTYPE,
    fmi2GetVersion: fmi2GetVersionTYPE,
    fmi2SetDebugLogging: fmi2SetDebugLoggingTYPE,
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

/// Checks at compile time that each type is that of the standard's header.
macro_rules! check_types {
    ($($name:ident,)*) => {
        $(const _: fn($name) -> header::$name = |value| value;)*
        const TYPES: usize = [$(stringify!($name)),*].len();
    };
}

check_types! {
    fmi2Component,
    fmi2ComponentEnvironment,
    fmi2FMUstate,
    fmi2ValueReference,
    fmi2Real,
    fmi2Integer,
    fmi2Boolean,
    fmi2Char,
    fmi2String,
    fmi2Byte,
    fmi2Status,
    fmi2Type,
    fmi2StatusKind,
    fmi2CallbackLogger,
    fmi2CallbackAllocateMemory,
    fmi2CallbackFreeMemory,
    fmi2StepFinished,
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

/// No exported function and no type is left out of the comparisons.
#[test]
fn all_functions_and_types_are_compared() {
    // `fmi2Functions.h` has 44: two more follow below.
    assert_eq!(FUNCTIONS, 42);
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
            header::fmi2Status_fmi2OK,
            header::fmi2Status_fmi2Warning,
            header::fmi2Status_fmi2Discard,
            header::fmi2Status_fmi2Error,
            header::fmi2Status_fmi2Fatal,
        ]
    );
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

//! What no host can bring about, or see, by itself. `tests/c_host` has the rest.

use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use fmi_sys::fmi2::{
    fmi2Component, fmi2Status, fmi2Status_fmi2Error, fmi2Status_fmi2Fatal, fmi2Status_fmi2OK,
};

use super::component::Component;
use super::*;
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

fn component(sink: impl Sink + Send + 'static) -> fmi2Component {
    let text = include_str!("../../../mechanisms/pendulum.toml");
    let (mechanism, _) = Mechanism::parse(&Source::new("pendulum.toml", text)).unwrap();
    let model = MechanismModel::new(mechanism.into(), Interface::CoSimulation).unwrap();
    Component::hand_over(Instance::new(model, Box::new(sink), false))
}

/// What each function that goes to an instance answers, given nothing.
///
/// # Safety
///
/// As for the functions.
unsafe fn answers(c: fmi2Component) -> [fmi2Status; 40] {
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
    assert_eq!(status, fmi2Status_fmi2Fatal);
    assert_eq!(fatal.load(Ordering::Relaxed), 1);
    // SAFETY: it has not been freed.
    let answers = unsafe { answers(c) };
    assert_eq!(answers, [fmi2Status_fmi2Error; 40]);
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
        assert_eq!(fmi2EnterInitializationMode(c), fmi2Status_fmi2OK);
        let status = fmi2GetReal(c, [0, 1].as_ptr(), 2, values.as_mut_ptr().cast());
        assert_eq!(status, fmi2Status_fmi2OK);
        let written = [values[0].assume_init(), values[1].assume_init()];
        assert_eq!(written[1].to_bits(), 0.0_f64.to_bits());

        let mut got = null_mut();
        assert_eq!(fmi2GetFMUstate(c, &mut got), fmi2Status_fmi2OK);
        let status = fmi2SerializedFMUstateSize(c, got, size.as_mut_ptr());
        assert_eq!(status, fmi2Status_fmi2OK);
        let size = size.assume_init();
        let mut bytes = vec![MaybeUninit::<u8>::uninit(); size];
        let status = fmi2SerializeFMUstate(c, got, bytes.as_mut_ptr().cast(), size);
        assert_eq!(status, fmi2Status_fmi2OK);
        let status = fmi2DeSerializeFMUstate(c, bytes.as_ptr().cast(), size, state.as_mut_ptr());
        assert_eq!(status, fmi2Status_fmi2OK);
        let mut state = state.assume_init();
        assert_eq!(fmi2SetFMUstate(c, state), fmi2Status_fmi2OK);
        for handle in [&mut got, &mut state] {
            assert_eq!(fmi2FreeFMUstate(c, handle), fmi2Status_fmi2OK);
            assert!(handle.is_null());
        }
        fmi2FreeInstance(c);
    }
}

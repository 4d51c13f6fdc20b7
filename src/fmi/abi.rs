//! The C interface: every function of `fmi2Functions.h`.
//!
//! Pointers come in, a status goes out. Each function checks what it can of its pointers, turns
//! them into slices and calls the [`Instance`]; a panic becomes `fmi2Fatal` and never crosses
//! into the host. Nothing is written to stdout or stderr.

#![allow(
    unsafe_code,
    reason = "the C interface takes raw pointers; all of biela's unsafe code is in this file"
)]
#![allow(
    non_snake_case,
    non_upper_case_globals,
    reason = "the names are those of the standard"
)]

use std::any::Any;
use std::ffi::{CStr, CString, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

use fmi_sys::fmi2::{
    fmi2Boolean, fmi2Byte, fmi2CallbackFunctions, fmi2CallbackLogger, fmi2Component, fmi2EventInfo,
    fmi2FMUstate, fmi2Integer, fmi2Real, fmi2Status, fmi2Status_fmi2Discard, fmi2Status_fmi2Error,
    fmi2Status_fmi2Fatal, fmi2Status_fmi2OK, fmi2Status_fmi2Warning, fmi2StatusKind,
    fmi2StatusKind_fmi2DoStepStatus, fmi2StatusKind_fmi2LastSuccessfulTime,
    fmi2StatusKind_fmi2Terminated, fmi2String, fmi2Type, fmi2Type_fmi2CoSimulation,
    fmi2ValueReference,
};

use super::instance::{Error, Instance, Status};
use super::log::{Category, Sink};
use super::state::Call;

// `fmi-sys` defines and exports a logger for importing hosts. Hidden, it stays inside.
#[cfg(target_os = "linux")]
core::arch::global_asm!(".hidden callback_log");
#[cfg(target_os = "macos")]
core::arch::global_asm!(".private_extern _callback_log");

/// Checks at compile time that each export has the signature of the standard's header.
macro_rules! check_signatures {
    ($($function:ident: $signature:ident,)*) => {
        $(const _: fmi_sys::fmi2::$signature = Some($function);)*
    };
}

check_signatures! {
    fmi2GetTypesPlatform: fmi2GetTypesPlatformTYPE,
    fmi2GetVersion: fmi2GetVersionTYPE,
    fmi2SetDebugLogging: fmi2SetDebugLoggingTYPE,
    fmi2Instantiate: fmi2InstantiateTYPE,
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
    fmi2NewDiscreteStates: fmi2NewDiscreteStatesTYPE,
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

/// The host's logger callback.
struct HostLogger {
    callback: fmi2CallbackLogger,
    environment: *mut c_void,
    instance_name: CString,
}

// SAFETY: the environment pointer is never read here, only handed back to the host, which uses an
// instance from one thread at a time and so gets its callback from one thread at a time.
unsafe impl Send for HostLogger {}

impl Sink for HostLogger {
    fn write(&self, status: Status, category: Category, message: &str) {
        let Some(callback) = self.callback else {
            return;
        };
        // The standard reads `#r12#` in a message as a reference to a variable.
        let message = message.replace('#', "##");
        let (category, message) = (c_string(category.name()), c_string(&message));
        // SAFETY: the host promises a function with the signature of the header, all strings live
        // until it returns, and the format has exactly one argument, a string.
        unsafe {
            callback(
                self.environment,
                self.instance_name.as_ptr(),
                status_code(status),
                category.as_ptr(),
                c"%s".as_ptr(),
                message.as_ptr(),
            );
        }
    }
}

fn status_code(status: Status) -> fmi2Status {
    match status {
        Status::Ok => fmi2Status_fmi2OK,
        Status::Warning => fmi2Status_fmi2Warning,
        Status::Discard => fmi2Status_fmi2Discard,
        Status::Error => fmi2Status_fmi2Error,
        Status::Fatal => fmi2Status_fmi2Fatal,
    }
}

/// A C string; NUL characters inside, which it could not carry, are left out.
fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', "")).unwrap_or_default()
}

/// What a caught panic says.
fn panic_message(payload: &(dyn Any + Send)) -> &str {
    payload
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| payload.downcast_ref::<&str>().copied())
        .unwrap_or("no message")
}

/// Runs `f` on the instance behind `component`; its error goes to the host's logger, a panic
/// becomes `fmi2Fatal`.
fn with_instance(
    component: fmi2Component,
    call: &str,
    f: impl FnOnce(&mut Instance) -> Result<(), CallError>,
) -> fmi2Status {
    if component.is_null() {
        return fmi2Status_fmi2Error;
    }
    // SAFETY: a component that is not null came from `fmi2Instantiate`, has not been freed, and
    // is used from one thread at a time (FMI 2.0, 2.1.1).
    let instance = unsafe { &mut *component.cast::<Instance>() };
    let outcome = catch_unwind(AssertUnwindSafe(|| match f(instance) {
        Ok(()) => Status::Ok,
        Err(CallError::Refused(error)) => instance.report(call, &error),
        Err(CallError::Argument(message)) => instance.report_argument(call, &message),
        Err(CallError::NotAvailable) => Status::Discard,
    }));
    let status = outcome.unwrap_or_else(|payload| {
        let what = format!("{call}: defect in biela: {}", panic_message(&*payload));
        // The host's callback may be what panicked; a second panic must not escape either.
        let _ = catch_unwind(AssertUnwindSafe(|| instance.lose(&what)));
        Status::Fatal
    });
    status_code(status)
}

/// Why a call did not return `fmi2OK`.
enum CallError {
    /// The instance said no.
    Refused(Error),
    /// An argument is no use at all.
    Argument(String),
    /// The status asked for does not exist here.
    NotAvailable,
}

impl From<Error> for CallError {
    fn from(error: Error) -> Self {
        Self::Refused(error)
    }
}

/// The array `pointer` of `length` items.
///
/// # Safety
///
/// A pointer that is not null points to `length` items that live and do not change during the
/// call.
unsafe fn slice<'a, T>(name: &str, pointer: *const T, length: usize) -> Result<&'a [T], CallError> {
    check_array(name, pointer, length)?;
    if length == 0 {
        return Ok(&[]);
    }
    // SAFETY: checked above as far as possible, promised by the caller beyond.
    Ok(unsafe { std::slice::from_raw_parts(pointer, length) })
}

/// The array `pointer` of `length` items, to be written.
///
/// # Safety
///
/// As [`slice`], and nobody else reads or writes the items during the call.
unsafe fn slice_mut<'a, T>(
    name: &str,
    pointer: *mut T,
    length: usize,
) -> Result<&'a mut [T], CallError> {
    check_array(name, pointer, length)?;
    if length == 0 {
        return Ok(&mut []);
    }
    // SAFETY: checked above as far as possible, promised by the caller beyond.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, length) })
}

fn check_array<T>(name: &str, pointer: *const T, length: usize) -> Result<(), CallError> {
    let refuse = |why: &str| Err(CallError::Argument(format!("`{name}` {why}")));
    if length == 0 {
        Ok(())
    } else if pointer.is_null() {
        refuse("is a null pointer")
    } else if !pointer.is_aligned() {
        refuse("is not aligned for its type")
    } else if length > isize::MAX as usize / size_of::<T>() {
        refuse("has an impossible length")
    } else {
        Ok(())
    }
}

/// The text behind a C string.
///
/// # Safety
///
/// A pointer that is not null points to a string that ends in NUL and lives during the call.
unsafe fn text<'a>(name: &str, pointer: *const c_char) -> Result<&'a str, CallError> {
    if pointer.is_null() {
        return Err(CallError::Argument(format!("`{name}` is a null pointer")));
    }
    // SAFETY: promised by the caller.
    unsafe { CStr::from_ptr(pointer) }
        .to_str()
        .map_err(|_| CallError::Argument(format!("`{name}` is not UTF-8")))
}

/// Writes one value through a pointer of the host.
///
/// # Safety
///
/// A pointer that is not null can be written.
unsafe fn write<T>(name: &str, pointer: *mut T, value: T) -> Result<(), CallError> {
    // SAFETY: promised by the caller.
    let target = unsafe { slice_mut(name, pointer, 1)? };
    target[0] = value;
    Ok(())
}

/// `fmi2GetTypesPlatform`: always `"default"`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// `fmi2GetVersion`: always `"2.0"`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// `fmi2Instantiate`: reads the mechanism in the resources and assembles it.
///
/// Null if that fails; the reason has gone to the logger.
///
/// # Safety
///
/// As the standard has it: strings end in NUL, `functions` points to callbacks that live as long
/// as the instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instance_name: fmi2String,
    fmu_type: fmi2Type,
    fmu_guid: fmi2String,
    fmu_resource_location: fmi2String,
    functions: *const fmi2CallbackFunctions,
    _visible: fmi2Boolean,
    logging_on: fmi2Boolean,
) -> fmi2Component {
    silence_panics();
    if functions.is_null() {
        return std::ptr::null_mut();
    }
    // SAFETY: not null, and promised by the caller to be readable.
    let callbacks = unsafe { &*functions };
    let logger = |instance_name: &str| HostLogger {
        callback: callbacks.logger,
        environment: callbacks.componentEnvironment,
        instance_name: c_string(instance_name),
    };
    let complain = |message: &str| {
        // SAFETY: promised by the caller.
        let name = unsafe { text("instanceName", instance_name) };
        logger(name.unwrap_or_default()).write(
            Status::Error,
            Category::Error,
            &format!("fmi2Instantiate: {message}"),
        );
        std::ptr::null_mut()
    };
    let attempt = catch_unwind(AssertUnwindSafe(|| -> Result<_, CallError> {
        // SAFETY: promised by the caller.
        let (name, guid, resources) = unsafe {
            (
                text("instanceName", instance_name)?,
                text("fmuGUID", fmu_guid)?,
                text("fmuResourceLocation", fmu_resource_location)?,
            )
        };
        if name.is_empty() {
            return Err(CallError::Argument("`instanceName` is empty".to_owned()));
        }
        if fmu_type != fmi2Type_fmi2CoSimulation {
            return Err(CallError::Argument(
                "this FMU is for co-simulation only, not for model exchange".to_owned(),
            ));
        }
        let sink = Box::new(logger(name));
        Ok(Instance::instantiate(
            guid,
            resources,
            sink,
            logging_on != 0,
        )?)
    }));
    match attempt {
        Ok(Ok(instance)) => Box::into_raw(Box::new(instance)).cast(),
        Ok(Err(CallError::Argument(message))) => complain(&message),
        // The instance has told its sink already.
        Ok(Err(_)) => std::ptr::null_mut(),
        Err(payload) => complain(&format!("defect in biela: {}", panic_message(&*payload))),
    }
}

/// A caught panic reaches the host as a message; std would print it to stderr as well. The
/// library has a copy of std of its own, so that no other panic in the process is silenced.
fn silence_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| std::panic::set_hook(Box::new(|_| {})));
}

/// `fmi2FreeInstance`; nothing happens for null.
///
/// # Safety
///
/// `c` is null or came from [`fmi2Instantiate`] and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: fmi2Component) {
    if !c.is_null() {
        // SAFETY: promised by the caller; the box was made in `fmi2Instantiate`.
        let instance = unsafe { Box::from_raw(c.cast::<Instance>()) };
        let _ = catch_unwind(AssertUnwindSafe(|| drop(instance)));
    }
}

/// `fmi2SetDebugLogging`.
///
/// # Safety
///
/// As the standard has it: `categories` has `n_categories` strings that end in NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: fmi2Component,
    logging_on: fmi2Boolean,
    n_categories: usize,
    categories: *const fmi2String,
) -> fmi2Status {
    with_instance(c, "fmi2SetDebugLogging", |instance| {
        instance.allow(Call::SetDebugLogging)?;
        // SAFETY: promised by the caller.
        let categories = unsafe { slice("categories", categories, n_categories)? };
        let names: Result<Vec<_>, _> = categories
            .iter()
            // SAFETY: promised by the caller.
            .map(|&category| unsafe { text("category", category) })
            .collect();
        Ok(instance.set_debug_logging(logging_on != 0, &names?)?)
    })
}

/// `fmi2SetupExperiment`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetupExperiment(
    c: fmi2Component,
    _tolerance_defined: fmi2Boolean,
    _tolerance: fmi2Real,
    start_time: fmi2Real,
    stop_time_defined: fmi2Boolean,
    stop_time: fmi2Real,
) -> fmi2Status {
    with_instance(c, "fmi2SetupExperiment", |instance| {
        let stop_time = (stop_time_defined != 0).then_some(stop_time);
        Ok(instance.setup_experiment(start_time, stop_time)?)
    })
}

/// `fmi2EnterInitializationMode`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterInitializationMode(c: fmi2Component) -> fmi2Status {
    with_instance(c, "fmi2EnterInitializationMode", |instance| {
        Ok(instance.enter_initialization_mode()?)
    })
}

/// `fmi2ExitInitializationMode`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2ExitInitializationMode(c: fmi2Component) -> fmi2Status {
    with_instance(c, "fmi2ExitInitializationMode", |instance| {
        Ok(instance.exit_initialization_mode()?)
    })
}

/// `fmi2Terminate`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Terminate(c: fmi2Component) -> fmi2Status {
    with_instance(c, "fmi2Terminate", |instance| Ok(instance.terminate()?))
}

/// `fmi2Reset`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Reset(c: fmi2Component) -> fmi2Status {
    with_instance(c, "fmi2Reset", |instance| Ok(instance.reset()?))
}

/// `fmi2GetReal`.
///
/// # Safety
///
/// As the standard has it: both arrays have `nvr` items.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Real,
) -> fmi2Status {
    with_instance(c, "fmi2GetReal", |instance| {
        // SAFETY: promised by the caller.
        let (vr, value) = unsafe { (slice("vr", vr, nvr)?, slice_mut("value", value, nvr)?) };
        Ok(instance.get_real(vr, value)?)
    })
}

/// `fmi2GetInteger`.
///
/// # Safety
///
/// As the standard has it: both arrays have `nvr` items.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Integer,
) -> fmi2Status {
    with_instance(c, "fmi2GetInteger", |instance| {
        // SAFETY: promised by the caller.
        let (vr, value) = unsafe { (slice("vr", vr, nvr)?, slice_mut("value", value, nvr)?) };
        Ok(instance.get_integer(vr, value)?)
    })
}

/// `fmi2SetReal`.
///
/// # Safety
///
/// As the standard has it: both arrays have `nvr` items.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Real,
) -> fmi2Status {
    with_instance(c, "fmi2SetReal", |instance| {
        // SAFETY: promised by the caller.
        let (vr, value) = unsafe { (slice("vr", vr, nvr)?, slice("value", value, nvr)?) };
        Ok(instance.set_real(vr, value)?)
    })
}

/// `fmi2SetInteger`.
///
/// # Safety
///
/// As the standard has it: both arrays have `nvr` items.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Integer,
) -> fmi2Status {
    with_instance(c, "fmi2SetInteger", |instance| {
        // SAFETY: promised by the caller.
        let (vr, value) = unsafe { (slice("vr", vr, nvr)?, slice("value", value, nvr)?) };
        Ok(instance.set_integer(vr, value)?)
    })
}

/// The access functions of types that no variable has: right for an empty list only.
macro_rules! without_variables {
    ($($(#[$doc:meta])* $function:ident($call:ident, $value:ty, $expected:literal);)*) => {
        $(
            $(#[$doc])*
            ///
            /// # Safety
            ///
            /// As the standard has it: `vr` has `nvr` items. `value` is not read.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                _value: $value,
            ) -> fmi2Status {
                with_instance(c, stringify!($function), |instance| {
                    // SAFETY: promised by the caller.
                    let vr = unsafe { slice("vr", vr, nvr)? };
                    Ok(instance.no_variables(Call::$call, $expected, vr)?)
                })
            }
        )*
    };
}

without_variables! {
    /// `fmi2GetBoolean`: there are no Boolean variables.
    fmi2GetBoolean(GetBoolean, *mut fmi2Boolean, "Boolean");
    /// `fmi2SetBoolean`: there are no Boolean variables.
    fmi2SetBoolean(SetBoolean, *const fmi2Boolean, "Boolean");
    /// `fmi2GetString`: there are no String variables.
    fmi2GetString(GetString, *mut fmi2String, "String");
    /// `fmi2SetString`: there are no String variables.
    fmi2SetString(SetString, *const fmi2String, "String");
}

/// `fmi2SetRealInputDerivatives`.
///
/// # Safety
///
/// As the standard has it: all three arrays have `nvr` items.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    order: *const fmi2Integer,
    value: *const fmi2Real,
) -> fmi2Status {
    with_instance(c, "fmi2SetRealInputDerivatives", |instance| {
        // SAFETY: promised by the caller.
        let (vr, order, value) = unsafe {
            (
                slice("vr", vr, nvr)?,
                slice("order", order, nvr)?,
                slice("value", value, nvr)?,
            )
        };
        Ok(instance.set_real_input_derivatives(vr, order, value)?)
    })
}

/// `fmi2DoStep`. State is never set back before a communication point that was completed, so
/// that `no_set_fmu_state_prior_to_current_point` makes no difference.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2DoStep(
    c: fmi2Component,
    current_communication_point: fmi2Real,
    communication_step_size: fmi2Real,
    _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
) -> fmi2Status {
    with_instance(c, "fmi2DoStep", |instance| {
        Ok(instance.do_step(current_communication_point, communication_step_size)?)
    })
}

/// `fmi2GetStatus`: how the last step ended.
///
/// # Safety
///
/// As the standard has it: `value` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(
    c: fmi2Component,
    kind: fmi2StatusKind,
    value: *mut fmi2Status,
) -> fmi2Status {
    with_instance(c, "fmi2GetStatus", |instance| {
        instance.allow(Call::GetStatus)?;
        match kind {
            // SAFETY: promised by the caller.
            fmi2StatusKind_fmi2DoStepStatus => unsafe {
                write("value", value, status_code(instance.step_status()))
            },
            _ => Err(CallError::NotAvailable),
        }
    })
}

/// `fmi2GetRealStatus`: the last successful time.
///
/// # Safety
///
/// As the standard has it: `value` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(
    c: fmi2Component,
    kind: fmi2StatusKind,
    value: *mut fmi2Real,
) -> fmi2Status {
    with_instance(c, "fmi2GetRealStatus", |instance| {
        instance.allow(Call::GetRealStatus)?;
        match kind {
            // SAFETY: promised by the caller.
            fmi2StatusKind_fmi2LastSuccessfulTime => unsafe {
                write("value", value, instance.last_successful_time())
            },
            _ => Err(CallError::NotAvailable),
        }
    })
}

/// `fmi2GetIntegerStatus`: the standard defines none.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetIntegerStatus(
    c: fmi2Component,
    _kind: fmi2StatusKind,
    _value: *mut fmi2Integer,
) -> fmi2Status {
    with_instance(c, "fmi2GetIntegerStatus", |instance| {
        instance.allow(Call::GetIntegerStatus)?;
        Err(CallError::NotAvailable)
    })
}

/// `fmi2GetBooleanStatus`: whether a step was discarded for good.
///
/// # Safety
///
/// As the standard has it: `value` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    c: fmi2Component,
    kind: fmi2StatusKind,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    with_instance(c, "fmi2GetBooleanStatus", |instance| {
        instance.allow(Call::GetBooleanStatus)?;
        match kind {
            // SAFETY: promised by the caller.
            fmi2StatusKind_fmi2Terminated => unsafe {
                write("value", value, fmi2Boolean::from(instance.is_terminated()))
            },
            _ => Err(CallError::NotAvailable),
        }
    })
}

/// `fmi2GetStringStatus`: nothing is ever pending.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetStringStatus(
    c: fmi2Component,
    _kind: fmi2StatusKind,
    _value: *mut fmi2String,
) -> fmi2Status {
    with_instance(c, "fmi2GetStringStatus", |instance| {
        instance.allow(Call::GetStringStatus)?;
        Err(CallError::NotAvailable)
    })
}

/// Functions behind a capability that this FMU declares not to have: they answer `fmi2Error`.
macro_rules! not_served {
    ($($why:literal { $($function:ident($($argument:ty),*);)* })*) => {
        $($(
            #[doc = concat!("`", stringify!($function), "`: ", $why, ".")]
            #[unsafe(no_mangle)]
            pub extern "C" fn $function(c: fmi2Component $(, _: $argument)*) -> fmi2Status {
                with_instance(c, stringify!($function), |_| {
                    Err(CallError::Argument($why.to_owned()))
                })
            }
        )*)*
    };
}

not_served! {
    "this FMU cannot get and set its state" {
        fmi2GetFMUstate(*mut fmi2FMUstate);
        fmi2SetFMUstate(fmi2FMUstate);
        fmi2FreeFMUstate(*mut fmi2FMUstate);
        fmi2SerializedFMUstateSize(fmi2FMUstate, *mut usize);
        fmi2SerializeFMUstate(fmi2FMUstate, *mut fmi2Byte, usize);
        fmi2DeSerializeFMUstate(*const fmi2Byte, usize, *mut fmi2FMUstate);
    }
    "this FMU provides no directional derivatives" {
        fmi2GetDirectionalDerivative(
            *const fmi2ValueReference, usize, *const fmi2ValueReference, usize, *const fmi2Real,
            *mut fmi2Real
        );
    }
    "this FMU provides no output derivatives" {
        fmi2GetRealOutputDerivatives(
            *const fmi2ValueReference, usize, *const fmi2Integer, *mut fmi2Real
        );
    }
    "this FMU does not run asynchronously, so that no step can be cancelled" {
        fmi2CancelStep();
    }
    "this FMU is for co-simulation only" {
        fmi2EnterEventMode();
        fmi2NewDiscreteStates(*mut fmi2EventInfo);
        fmi2EnterContinuousTimeMode();
        fmi2CompletedIntegratorStep(fmi2Boolean, *mut fmi2Boolean, *mut fmi2Boolean);
        fmi2SetTime(fmi2Real);
        fmi2SetContinuousStates(*const fmi2Real, usize);
        fmi2GetDerivatives(*mut fmi2Real, usize);
        fmi2GetEventIndicators(*mut fmi2Real, usize);
        fmi2GetContinuousStates(*mut fmi2Real, usize);
        fmi2GetNominalsOfContinuousStates(*mut fmi2Real, usize);
    }
}

//! From instantiation to freeing: what changes the state without moving the mechanism.

use std::ffi::c_char;
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::types::{
    fmi2Boolean, fmi2CallbackFunctions, fmi2CoSimulation, fmi2Component, fmi2ModelExchange,
    fmi2Real, fmi2Status, fmi2String, fmi2Type,
};

use super::host::HostLogger;
use crate::fmi::abi::Exported;
use crate::fmi::abi::arguments::{slice, text};
use crate::fmi::abi::component::{
    CallError, Component, panic_message, silence_panics, with_instance,
};
use crate::fmi::abi::floating_point::StandardEnvironment;
use crate::fmi::{Call, Category, Instance, Interface, Sink, Status};

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

/// `fmi2Instantiate`: reads the model in the resources.
///
/// Null if that fails; the reason has gone to the logger.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
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
    let _environment = StandardEnvironment::set();
    if functions.is_null() || !functions.is_aligned() {
        return std::ptr::null_mut();
    }
    // SAFETY: not null, aligned, and promised by the caller to be readable.
    let callbacks = unsafe { &*functions };
    let complain = |message: &str| {
        // SAFETY: the host's promise.
        let name = unsafe { text("instanceName", instance_name) };
        HostLogger::new(callbacks, name.unwrap_or_default()).write(
            Status::Error,
            Category::Error,
            &format!("fmi2Instantiate: {message}"),
        );
        std::ptr::null_mut()
    };
    let attempt = catch_unwind(AssertUnwindSafe(|| -> Result<_, CallError> {
        // SAFETY: the host's promise.
        let (name, guid, resources) = unsafe {
            (
                text("instanceName", instance_name)?,
                text("fmuGUID", fmu_guid)?,
                text("fmuResourceLocation", fmu_resource_location)?,
            )
        };
        if name.trim().is_empty() {
            let message = "`instanceName` is empty or blank".to_owned();
            return Err(CallError::Argument(message));
        }
        let interface = match fmu_type {
            fmi2ModelExchange => Interface::ModelExchange,
            fmi2CoSimulation => Interface::CoSimulation,
            other => {
                let message = format!("`fmuType` {other} is neither of the two interfaces");
                return Err(CallError::Argument(message));
            }
        };
        let sink = Box::new(HostLogger::new(callbacks, name));
        Ok(Instance::<Exported>::instantiate(
            guid,
            resources,
            interface,
            sink,
            logging_on != 0,
        )?)
    }));
    match attempt {
        Ok(Ok(instance)) => Component::hand_over(instance, None),
        Ok(Err(CallError::Argument(message))) => complain(&message),
        // The instance has told its sink already.
        Ok(Err(_)) => std::ptr::null_mut(),
        Err(payload) => complain(&format!("defect in biela: {}", panic_message(&*payload))),
    }
}

/// `fmi2FreeInstance`; nothing happens for null.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: fmi2Component) {
    // SAFETY: the host's promise.
    unsafe { Component::take_back(c) };
}

/// `fmi2SetDebugLogging`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: fmi2Component,
    logging_on: fmi2Boolean,
    n_categories: usize,
    categories: *const fmi2String,
) -> fmi2Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(c, "fmi2SetDebugLogging", |instance| {
            instance.allow(Call::SetDebugLogging)?;
            let categories = slice("categories", categories, n_categories)?;
            let names: Result<Vec<_>, _> = categories
                .iter()
                .map(|&category| text("category", category))
                .collect();
            Ok(instance.set_debug_logging(logging_on != 0, &names?)?)
        })
    }
}

/// `fmi2SetupExperiment`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    c: fmi2Component,
    _tolerance_defined: fmi2Boolean,
    _tolerance: fmi2Real,
    start_time: fmi2Real,
    stop_time_defined: fmi2Boolean,
    stop_time: fmi2Real,
) -> fmi2Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(c, "fmi2SetupExperiment", |instance| {
            let stop_time = (stop_time_defined != 0).then_some(stop_time);
            Ok(instance.setup_experiment(start_time, stop_time)?)
        })
    }
}

instance_calls! {
    fmi2Component => fmi2Status;
    /// `fmi2EnterInitializationMode`.
    fmi2EnterInitializationMode() = |instance| instance.enter_initialization_mode();
    /// `fmi2ExitInitializationMode`.
    fmi2ExitInitializationMode() = |instance| instance.exit_initialization_mode();
    /// `fmi2Terminate`.
    fmi2Terminate() = |instance| instance.terminate();
    /// `fmi2Reset`.
    fmi2Reset() = |instance| instance.reset();
}

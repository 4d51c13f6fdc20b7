//! From instantiation to freeing: what changes the state without moving the mechanism.

use std::ptr::null_mut;

use super::host::HostLogger;
use super::types::{
    fmi2Boolean, fmi2CallbackFunctions, fmi2CoSimulation, fmi2Component, fmi2ModelExchange,
    fmi2Real, fmi2String, fmi2Type,
};
use crate::fmi::abi::arguments::{refuse, text};
use crate::fmi::abi::calls::instance_calls;
use crate::fmi::abi::component::Component;
use crate::fmi::abi::instantiation::{instantiate, texts};
use crate::fmi::abi::message::set_debug_logging;
use crate::fmi::{Category, Error, Instance, Interface, Sink, Status, Version, resource_path};

/// `fmi2GetTypesPlatform`: always `"default"`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> fmi2String {
    c"default".as_ptr()
}

/// `fmi2GetVersion`: always `"2.0"`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> fmi2String {
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
    if functions.is_null() {
        return null_mut();
    }
    // SAFETY: not null, and promised by the caller to be readable.
    let callbacks = unsafe { functions.read_unaligned() };
    let make = || {
        let arguments = [
            ("instanceName", instance_name),
            ("fmuGUID", fmu_guid),
            ("fmuResourceLocation", fmu_resource_location),
        ];
        // SAFETY: the host's promise.
        let [name, guid, resources] = unsafe { texts(arguments)? };
        let interface = match fmu_type {
            fmi2ModelExchange => Interface::ModelExchange,
            fmi2CoSimulation => Interface::CoSimulation,
            other => {
                let why = format!("{other} is neither of the two interfaces");
                return Err(refuse("fmuType", why));
            }
        };
        let folder = resource_path(resources).map_err(Error::from)?;
        let sink = Box::new(HostLogger::new(&callbacks, name));
        let logging_on = logging_on != 0;
        let version = Version::Fmi2;
        let instance = Instance::instantiate(version, guid, &folder, interface, sink, logging_on)?;
        Ok((instance, None))
    };
    let complain = |message: &str| {
        // SAFETY: the host's promise.
        let name = unsafe { text("instanceName", instance_name) };
        let message = format!("fmi2Instantiate: {message}");
        let logger = HostLogger::new(&callbacks, name.unwrap_or_default());
        logger.write(Status::Error, Category::Error, &message);
    };
    instantiate(make, complain)
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

instance_calls! {
    /// `fmi2SetDebugLogging`.
    fmi2SetDebugLogging(
        logging_on: fmi2Boolean,
        n_categories: usize,
        categories: *const fmi2String,
    ) = |instance| {
        set_debug_logging(instance, logging_on != 0, categories, n_categories)
    };
    /// `fmi2SetupExperiment`.
    fmi2SetupExperiment(
        tolerance_defined: fmi2Boolean,
        tolerance: fmi2Real,
        start_time: fmi2Real,
        stop_time_defined: fmi2Boolean,
        stop_time: fmi2Real,
    ) = |instance| {
        let stop_time = (stop_time_defined != 0).then_some(stop_time);
        instance.setup_experiment(start_time, stop_time)?;
        if tolerance_defined != 0 {
            instance.set_tolerance(tolerance);
        }
        Ok(())
    };
    /// `fmi2EnterInitializationMode`.
    fmi2EnterInitializationMode() = |instance| instance.enter_initialization_mode();
    /// `fmi2ExitInitializationMode`.
    fmi2ExitInitializationMode() = |instance| instance.exit_initialization_mode();
    /// `fmi2Terminate`.
    fmi2Terminate() = |instance| instance.terminate();
    /// `fmi2Reset`.
    fmi2Reset() = |instance| instance.reset();
}

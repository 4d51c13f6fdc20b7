//! From instantiation to freeing: what changes the state without moving the mechanism.

use std::ffi::{c_char, c_void};
use std::path::Path;

use super::host::{HostLogger, LogMessage};
use crate::fmi::abi::arguments::{refuse, slice};
use crate::fmi::abi::calls::instance_calls;
use crate::fmi::abi::component::{Component, Handle, Instance};
use crate::fmi::abi::instantiation::{instantiate, texts};
use crate::fmi::abi::intermediate::{Callback, IntermediateUpdate};
use crate::fmi::abi::message::set_debug_logging;
use crate::fmi::{Call, Category, CoSimulation, Error, Interface, Sink, Status, Version};

/// `fmi3GetVersion`: always `"3.0"`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// The arguments that all functions have that instantiate.
struct Arguments {
    call: &'static str,
    /// Name of the instance, instantiation token and path of the resources.
    texts: [*const c_char; 3],
    logging_on: bool,
    logger: HostLogger,
}

impl Arguments {
    /// Makes an instance that `agree` accepts; null if that fails, and the reason has gone to the
    /// logger.
    ///
    /// # Safety
    ///
    /// The [host's promise](crate::fmi::abi#safety).
    unsafe fn instantiate(
        self,
        interface: Interface,
        intermediate_update: Option<IntermediateUpdate>,
        agree: impl FnOnce(&mut Instance) -> Result<(), Error>,
    ) -> Handle {
        let make = || {
            let [name, token, path] = self.texts;
            let arguments = [
                ("instanceName", name),
                ("instantiationToken", token),
                ("resourcePath", path),
            ];
            // SAFETY: promised by the caller.
            let [_, token, resources] = unsafe { texts(arguments)? };
            let (version, folder) = (Version::Fmi3, Path::new(resources));
            let sink = Box::new(self.logger);
            let mut instance =
                Instance::instantiate(version, token, folder, interface, sink, self.logging_on)?;
            agree(&mut instance)?;
            Ok((instance, intermediate_update))
        };
        instantiate(make, |message| self.complain(message))
    }

    /// Logs why there is no instance, if the host wants messages at all.
    fn complain(&self, message: &str) {
        if self.logging_on {
            let message = format!("{}: {message}", self.call);
            self.logger.write(Status::Error, Category::Error, &message);
        }
    }
}

/// `fmi3InstantiateModelExchange`: reads the model in the resources.
///
/// Null if that fails; the reason has gone to the logger.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    instance_name: *const c_char,
    instantiation_token: *const c_char,
    resource_path: *const c_char,
    _visible: bool,
    logging_on: bool,
    instance_environment: *mut c_void,
    log_message: LogMessage,
) -> Handle {
    let arguments = Arguments {
        call: "fmi3InstantiateModelExchange",
        texts: [instance_name, instantiation_token, resource_path],
        logging_on,
        logger: HostLogger::new(log_message, instance_environment),
    };
    // SAFETY: the host's promise.
    unsafe { arguments.instantiate(Interface::ModelExchange, None, |_| Ok(())) }
}

/// `fmi3InstantiateCoSimulation`: reads the model in the resources.
///
/// Null if that fails; the reason has gone to the logger.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    instance_name: *const c_char,
    instantiation_token: *const c_char,
    resource_path: *const c_char,
    _visible: bool,
    logging_on: bool,
    event_mode_used: bool,
    early_return_allowed: bool,
    required_intermediate_variables: *const u32,
    n_required_intermediate_variables: usize,
    instance_environment: *mut c_void,
    log_message: LogMessage,
    intermediate_update: Option<Callback>,
) -> Handle {
    let arguments = Arguments {
        call: "fmi3InstantiateCoSimulation",
        texts: [instance_name, instantiation_token, resource_path],
        logging_on,
        logger: HostLogger::new(log_message, instance_environment),
    };
    let intermediate_update = intermediate_update.map(|callback| IntermediateUpdate {
        callback,
        environment: instance_environment,
    });
    let agree = |instance: &mut Instance| {
        // SAFETY: the host's promise.
        let required = unsafe {
            slice(
                "requiredIntermediateVariables",
                required_intermediate_variables,
                n_required_intermediate_variables,
            )?
        };
        if !required.is_empty() && intermediate_update.is_none() {
            let why = "needs the callback `intermediateUpdate`, which is a null pointer";
            return Err(refuse("requiredIntermediateVariables", why));
        }
        instance.agree(CoSimulation {
            event_mode_used,
            early_return_allowed,
            intermediate_update: intermediate_update.is_some(),
            required_intermediate_variables: required.into_owned(),
        })
    };
    // SAFETY: the host's promise.
    unsafe { arguments.instantiate(Interface::CoSimulation, intermediate_update, agree) }
}

/// `fmi3InstantiateScheduledExecution`: always null, since there are no clocks.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    instance_name: *const c_char,
    instantiation_token: *const c_char,
    resource_path: *const c_char,
    _visible: bool,
    logging_on: bool,
    instance_environment: *mut c_void,
    log_message: LogMessage,
    _clock_update: Option<unsafe extern "C" fn(*mut c_void)>,
    _lock_preemption: Option<unsafe extern "C" fn()>,
    _unlock_preemption: Option<unsafe extern "C" fn()>,
) -> Handle {
    let arguments = Arguments {
        call: "fmi3InstantiateScheduledExecution",
        texts: [instance_name, instantiation_token, resource_path],
        logging_on,
        logger: HostLogger::new(log_message, instance_environment),
    };
    let why = "the FMU is for co-simulation and model exchange, and has no clocks to be scheduled";
    let make = || Err(Error::NotProvided { why });
    instantiate(make, |message| arguments.complain(message))
}

/// `fmi3FreeInstance`; nothing happens for null.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: Handle) {
    // SAFETY: the host's promise.
    unsafe { Component::take_back(instance) };
}

instance_calls! {
    /// `fmi3SetDebugLogging`.
    fmi3SetDebugLogging(
        logging_on: bool,
        n_categories: usize,
        categories: *const *const c_char,
    ) = |instance| {
        set_debug_logging(instance, logging_on, categories, n_categories)
    };
    /// `fmi3EnterInitializationMode`.
    fmi3EnterInitializationMode(
        tolerance_defined: bool,
        tolerance: f64,
        start_time: f64,
        stop_time_defined: bool,
        stop_time: f64,
    ) = |instance| {
        let stop_time = stop_time_defined.then_some(stop_time);
        instance.allow(Call::EnterInitializationMode)?;
        if tolerance_defined {
            instance.set_tolerance(tolerance);
        }
        instance.enter_initialization_mode_at(start_time, stop_time)
    };
    /// `fmi3ExitInitializationMode`.
    fmi3ExitInitializationMode() = |instance| instance.exit_initialization_mode();
    /// `fmi3EnterConfigurationMode`: always refused, since there are no structural parameters.
    fmi3EnterConfigurationMode() = |instance| instance.allow(Call::EnterConfigurationMode);
    /// `fmi3ExitConfigurationMode`: always refused, since there are no structural parameters.
    fmi3ExitConfigurationMode() = |instance| instance.allow(Call::ExitConfigurationMode);
    /// `fmi3EnterStepMode`.
    fmi3EnterStepMode() = |instance| instance.enter_step_mode();
    /// `fmi3Terminate`.
    fmi3Terminate() = |instance| instance.terminate();
    /// `fmi3Reset`.
    fmi3Reset() = |instance| instance.reset();
}

//! From instantiation to freeing: what changes the state without moving the mechanism.

use std::path::Path;

use super::host::HostLogger;
use super::types::{
    fmi3Boolean, fmi3ClockUpdateCallback, fmi3Float64, fmi3Instance, fmi3InstanceEnvironment,
    fmi3IntermediateUpdateCallback, fmi3LockPreemptionCallback, fmi3LogMessageCallback, fmi3String,
    fmi3UnlockPreemptionCallback, fmi3ValueReference,
};
use crate::fmi::abi::arguments::{refuse, slice};
use crate::fmi::abi::calls::instance_calls;
use crate::fmi::abi::component::{Component, Instance};
use crate::fmi::abi::instantiation::{instantiate, texts};
use crate::fmi::abi::intermediate::IntermediateUpdate;
use crate::fmi::abi::message::set_debug_logging;
use crate::fmi::{Call, Category, CoSimulation, Error, Interface, Sink, Status, Version};

/// `fmi3GetVersion`: always `"3.0"`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> fmi3String {
    c"3.0".as_ptr()
}

/// The arguments that all functions have that instantiate.
struct Arguments {
    call: &'static str,
    /// Name of the instance, instantiation token and path of the resources.
    texts: [fmi3String; 3],
    logging_on: fmi3Boolean,
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
    ) -> fmi3Instance {
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
    instance_name: fmi3String,
    instantiation_token: fmi3String,
    resource_path: fmi3String,
    _visible: fmi3Boolean,
    logging_on: fmi3Boolean,
    instance_environment: fmi3InstanceEnvironment,
    log_message: fmi3LogMessageCallback,
) -> fmi3Instance {
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
    instance_name: fmi3String,
    instantiation_token: fmi3String,
    resource_path: fmi3String,
    _visible: fmi3Boolean,
    logging_on: fmi3Boolean,
    event_mode_used: fmi3Boolean,
    early_return_allowed: fmi3Boolean,
    required_intermediate_variables: *const fmi3ValueReference,
    n_required_intermediate_variables: usize,
    instance_environment: fmi3InstanceEnvironment,
    log_message: fmi3LogMessageCallback,
    intermediate_update: fmi3IntermediateUpdateCallback,
) -> fmi3Instance {
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
    instance_name: fmi3String,
    instantiation_token: fmi3String,
    resource_path: fmi3String,
    _visible: fmi3Boolean,
    logging_on: fmi3Boolean,
    instance_environment: fmi3InstanceEnvironment,
    log_message: fmi3LogMessageCallback,
    _clock_update: fmi3ClockUpdateCallback,
    _lock_preemption: fmi3LockPreemptionCallback,
    _unlock_preemption: fmi3UnlockPreemptionCallback,
) -> fmi3Instance {
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
pub unsafe extern "C" fn fmi3FreeInstance(instance: fmi3Instance) {
    // SAFETY: the host's promise.
    unsafe { Component::take_back(instance) };
}

instance_calls! {
    /// `fmi3SetDebugLogging`.
    fmi3SetDebugLogging(
        logging_on: fmi3Boolean,
        n_categories: usize,
        categories: *const fmi3String,
    ) = |instance| {
        set_debug_logging(instance, logging_on, categories, n_categories)
    };
    /// `fmi3EnterInitializationMode`.
    fmi3EnterInitializationMode(
        tolerance_defined: fmi3Boolean,
        tolerance: fmi3Float64,
        start_time: fmi3Float64,
        stop_time_defined: fmi3Boolean,
        stop_time: fmi3Float64,
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

//! From instantiation to freeing: what changes the state without moving the mechanism.

use std::ffi::{c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::ptr::null_mut;

use super::host::HostLogger;
use super::types::{
    fmi3Boolean, fmi3ClockUpdateCallback, fmi3Float64, fmi3Instance, fmi3InstanceEnvironment,
    fmi3IntermediateUpdateCallback, fmi3LockPreemptionCallback, fmi3LogMessageCallback, fmi3Status,
    fmi3String, fmi3UnlockPreemptionCallback, fmi3ValueReference,
};
use crate::fmi::abi::Exported;
use crate::fmi::abi::arguments::{slice, text};
use crate::fmi::abi::component::{
    CallError, Component, panic_message, silence_panics, with_instance,
};
use crate::fmi::abi::floating_point::StandardEnvironment;
use crate::fmi::abi::intermediate::IntermediateUpdate;
use crate::fmi::{Call, Category, CoSimulation, Instance, Interface, Sink, Status};

/// `fmi3GetVersion`: always `"3.0"`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// The arguments that all functions have that instantiate.
struct Arguments {
    call: &'static str,
    instance_name: fmi3String,
    token: fmi3String,
    resource_path: fmi3String,
    logging_on: bool,
    environment: *mut c_void,
    log_message: fmi3LogMessageCallback,
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
        agree: impl FnOnce(&mut Instance<Exported>) -> Result<(), CallError>,
    ) -> fmi3Instance {
        silence_panics();
        let _environment = StandardEnvironment::set();
        let attempt = catch_unwind(AssertUnwindSafe(|| {
            // SAFETY: promised by the caller.
            let (name, token, resources) = unsafe {
                (
                    text("instanceName", self.instance_name)?,
                    text("instantiationToken", self.token)?,
                    text("resourcePath", self.resource_path)?,
                )
            };
            if name.trim().is_empty() {
                let message = "`instanceName` is empty or blank".to_owned();
                return Err(CallError::Argument(message));
            }
            let sink = Box::new(HostLogger::new(self.log_message, self.environment));
            let resources = Path::new(resources);
            let mut instance =
                Instance::instantiate_in(token, resources, interface, sink, self.logging_on)?;
            agree(&mut instance)?;
            Ok(instance)
        }));
        match attempt {
            Ok(Ok(instance)) => Component::hand_over(instance, intermediate_update),
            Ok(Err(CallError::Argument(message))) => self.complain(&message),
            Ok(Err(CallError::Refused(error))) => self.complain(&error.to_string()),
            Err(payload) => {
                self.complain(&format!("defect in biela: {}", panic_message(&*payload)))
            }
        }
    }

    /// Logs why there is no instance, if the host wants messages at all.
    fn complain(&self, message: &str) -> fmi3Instance {
        if self.logging_on {
            HostLogger::new(self.log_message, self.environment).write(
                Status::Error,
                Category::Error,
                &format!("{}: {message}", self.call),
            );
        }
        null_mut()
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
        instance_name,
        token: instantiation_token,
        resource_path,
        logging_on,
        environment: instance_environment,
        log_message,
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
        instance_name,
        token: instantiation_token,
        resource_path,
        logging_on,
        environment: instance_environment,
        log_message,
    };
    let callback = IntermediateUpdate::new(intermediate_update, instance_environment);
    let agree = |instance: &mut Instance<Exported>| {
        // SAFETY: the host's promise.
        let required = unsafe {
            slice(
                "requiredIntermediateVariables",
                required_intermediate_variables,
                n_required_intermediate_variables,
            )?
        };
        if !required.is_empty() && intermediate_update.is_none() {
            let message = "`requiredIntermediateVariables` needs the callback \
                           `intermediateUpdate`, which is a null pointer";
            return Err(CallError::Argument(message.to_owned()));
        }
        Ok(instance.agree(CoSimulation {
            event_mode_used,
            early_return_allowed,
            intermediate_update: intermediate_update.is_some(),
            required_intermediate_variables: required.to_vec(),
        })?)
    };
    // SAFETY: the host's promise.
    unsafe { arguments.instantiate(Interface::CoSimulation, Some(callback), agree) }
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
        instance_name,
        token: instantiation_token,
        resource_path,
        logging_on,
        environment: instance_environment,
        log_message,
    };
    let complain = AssertUnwindSafe(|| {
        arguments.complain(
            "the FMU is for co-simulation and model exchange, and has no clocks to be scheduled",
        )
    });
    catch_unwind(complain).unwrap_or(null_mut())
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

/// `fmi3SetDebugLogging`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: fmi3Instance,
    logging_on: fmi3Boolean,
    n_categories: usize,
    categories: *const fmi3String,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3SetDebugLogging", |instance| {
            instance.allow(Call::SetDebugLogging)?;
            let categories = slice("categories", categories, n_categories)?;
            let names: Result<Vec<_>, _> = categories
                .iter()
                .map(|&category| text("category", category))
                .collect();
            Ok(instance.set_debug_logging(logging_on, &names?)?)
        })
    }
}

/// `fmi3EnterInitializationMode`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: fmi3Instance,
    _tolerance_defined: fmi3Boolean,
    _tolerance: fmi3Float64,
    start_time: fmi3Float64,
    stop_time_defined: fmi3Boolean,
    stop_time: fmi3Float64,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3EnterInitializationMode", |instance| {
            let stop_time = stop_time_defined.then_some(stop_time);
            Ok(instance.enter_initialization_mode_at(start_time, stop_time)?)
        })
    }
}

instance_calls! {
    fmi3Instance => fmi3Status;
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

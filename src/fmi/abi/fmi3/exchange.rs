//! Events, and model exchange. There are no continuous or discrete states and no event indicators.

use super::types::{fmi3Boolean, fmi3Float64, fmi3Instance, fmi3Status};
use crate::fmi::Call;
use crate::fmi::abi::arguments::{Room, write};
use crate::fmi::abi::component::with_instance;

/// `fmi3EnterEventMode`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterEventMode(instance: fmi3Instance) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3EnterEventMode", |instance| {
            Ok(instance.enter_event_mode()?)
        })
    }
}

/// `fmi3EvaluateDiscreteStates`: there are none.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EvaluateDiscreteStates(instance: fmi3Instance) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3EvaluateDiscreteStates", |instance| {
            Ok(instance.evaluate_discrete_states()?)
        })
    }
}

/// `fmi3EnterContinuousTimeMode`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterContinuousTimeMode(instance: fmi3Instance) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3EnterContinuousTimeMode", |instance| {
            Ok(instance.enter_continuous_time_mode()?)
        })
    }
}

/// `fmi3UpdateDiscreteStates`: there are no discrete states. The simulation ends at an event for
/// whose values no pose exists.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3UpdateDiscreteStates(
    instance: fmi3Instance,
    discrete_states_need_update: *mut fmi3Boolean,
    terminate_simulation: *mut fmi3Boolean,
    nominals_of_continuous_states_changed: *mut fmi3Boolean,
    values_of_continuous_states_changed: *mut fmi3Boolean,
    next_event_time_defined: *mut fmi3Boolean,
    next_event_time: *mut fmi3Float64,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3UpdateDiscreteStates", |instance| {
            instance.allow(Call::NewDiscreteStates)?;
            let never = [
                Room::new("discreteStatesNeedUpdate", discrete_states_need_update, 1)?,
                Room::new(
                    "nominalsOfContinuousStatesChanged",
                    nominals_of_continuous_states_changed,
                    1,
                )?,
                Room::new(
                    "valuesOfContinuousStatesChanged",
                    values_of_continuous_states_changed,
                    1,
                )?,
                Room::new("nextEventTimeDefined", next_event_time_defined, 1)?,
            ];
            let terminate = Room::new("terminateSimulation", terminate_simulation, 1)?;
            let time = Room::new("nextEventTime", next_event_time, 1)?;
            let must_end = instance.new_discrete_states()?;
            for flag in never {
                flag.fill([false]);
            }
            terminate.fill([must_end]);
            time.fill([0.0]);
            Ok(())
        })
    }
}

/// `fmi3CompletedIntegratorStep`. Nothing is kept for going back, so that
/// `no_set_fmu_state_prior_to_current_point` makes no difference.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3CompletedIntegratorStep(
    instance: fmi3Instance,
    _no_set_fmu_state_prior_to_current_point: fmi3Boolean,
    enter_event_mode: *mut fmi3Boolean,
    terminate_simulation: *mut fmi3Boolean,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3CompletedIntegratorStep", |instance| {
            instance.allow(Call::CompletedIntegratorStep)?;
            let enter = Room::new("enterEventMode", enter_event_mode, 1)?;
            let terminate = Room::new("terminateSimulation", terminate_simulation, 1)?;
            let must_end = instance.completed_integrator_step()?;
            enter.fill([false]);
            terminate.fill([must_end]);
            Ok(())
        })
    }
}

/// `fmi3SetTime`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetTime(instance: fmi3Instance, time: fmi3Float64) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3SetTime", |instance| {
            Ok(instance.set_time(time)?)
        })
    }
}

/// The functions whose arrays are as long as there are continuous states or event indicators:
/// right for a length of zero only.
macro_rules! of_none {
    ($($(#[$doc:meta])* $function:ident($call:ident, $array:ty);)*) => {
        $(
            $(#[$doc])*
            ///
            /// # Safety
            ///
            /// The [host's promise](crate::fmi::abi#safety). The array is not touched.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(
                instance: fmi3Instance,
                _array: $array,
                count: usize,
            ) -> fmi3Status {
                // SAFETY: the host's promise.
                unsafe {
                    with_instance(instance, stringify!($function), |instance| {
                        Ok(instance.continuous(Call::$call, count)?)
                    })
                }
            }
        )*
    };
}

of_none! {
    /// `fmi3SetContinuousStates`: there are none.
    fmi3SetContinuousStates(SetContinuousStates, *const fmi3Float64);
    /// `fmi3GetContinuousStateDerivatives`: there are no continuous states.
    fmi3GetContinuousStateDerivatives(GetDerivatives, *mut fmi3Float64);
    /// `fmi3GetEventIndicators`: there are none.
    fmi3GetEventIndicators(GetEventIndicators, *mut fmi3Float64);
    /// `fmi3GetContinuousStates`: there are none.
    fmi3GetContinuousStates(GetContinuousStates, *mut fmi3Float64);
    /// `fmi3GetNominalsOfContinuousStates`: there are no continuous states.
    fmi3GetNominalsOfContinuousStates(GetNominalsOfContinuousStates, *mut fmi3Float64);
}

/// The functions that count continuous states or event indicators.
macro_rules! counts_of_none {
    ($($(#[$doc:meta])* $function:ident($call:ident, $count:literal);)*) => {
        $(
            $(#[$doc])*
            ///
            /// # Safety
            ///
            /// The [host's promise](crate::fmi::abi#safety).
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(
                instance: fmi3Instance,
                count: *mut usize,
            ) -> fmi3Status {
                // SAFETY: the host's promise.
                unsafe {
                    with_instance(instance, stringify!($function), |instance| {
                        instance.allow(Call::$call)?;
                        write($count, count, 0)
                    })
                }
            }
        )*
    };
}

counts_of_none! {
    /// `fmi3GetNumberOfEventIndicators`: always 0.
    fmi3GetNumberOfEventIndicators(GetNumberOfEventIndicators, "nEventIndicators");
    /// `fmi3GetNumberOfContinuousStates`: always 0.
    fmi3GetNumberOfContinuousStates(GetNumberOfContinuousStates, "nContinuousStates");
}

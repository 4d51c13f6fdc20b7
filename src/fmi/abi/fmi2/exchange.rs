//! Model exchange. There are no continuous states and no event indicators.

use super::types::{fmi2Boolean, fmi2Component, fmi2EventInfo, fmi2False, fmi2Real, fmi2Status};

use crate::fmi::Call;
use crate::fmi::abi::arguments::Room;
use crate::fmi::abi::component::with_instance;

instance_calls! {
    fmi2Component => fmi2Status;
    /// `fmi2EnterEventMode`.
    fmi2EnterEventMode() = |instance| instance.enter_event_mode();
    /// `fmi2EnterContinuousTimeMode`.
    fmi2EnterContinuousTimeMode() = |instance| instance.enter_continuous_time_mode();
    /// `fmi2SetTime`.
    fmi2SetTime(time: fmi2Real) = |instance| instance.set_time(time);
}

/// `fmi2NewDiscreteStates`: there are no discrete states. The simulation ends at an event for
/// whose values no pose exists.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(
    c: fmi2Component,
    event_info: *mut fmi2EventInfo,
) -> fmi2Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(c, "fmi2NewDiscreteStates", |instance| {
            instance.allow(Call::NewDiscreteStates)?;
            let to = Room::new("fmi2eventInfo", event_info, 1)?;
            let must_end = instance.new_discrete_states()?;
            to.fill([fmi2EventInfo {
                newDiscreteStatesNeeded: FALSE,
                terminateSimulation: must_end.into(),
                nominalsOfContinuousStatesChanged: FALSE,
                valuesOfContinuousStatesChanged: FALSE,
                nextEventTimeDefined: FALSE,
                nextEventTime: 0.0,
            }]);
            Ok(())
        })
    }
}

/// `fmi2CompletedIntegratorStep`. Nothing is kept for going back, so that
/// `no_set_fmu_state_prior_to_current_point` makes no difference.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    c: fmi2Component,
    _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
    enter_event_mode: *mut fmi2Boolean,
    terminate_simulation: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(c, "fmi2CompletedIntegratorStep", |instance| {
            instance.allow(Call::CompletedIntegratorStep)?;
            let enter = Room::new("enterEventMode", enter_event_mode, 1)?;
            let terminate = Room::new("terminateSimulation", terminate_simulation, 1)?;
            let must_end = instance.completed_integrator_step()?;
            enter.fill([FALSE]);
            terminate.fill([must_end.into()]);
            Ok(())
        })
    }
}

of_none! {
    fmi2Component => fmi2Status;
    /// `fmi2SetContinuousStates`: there are none.
    fmi2SetContinuousStates(SetContinuousStates, *const fmi2Real);
    /// `fmi2GetDerivatives`: there are no continuous states.
    fmi2GetDerivatives(GetDerivatives, *mut fmi2Real);
    /// `fmi2GetEventIndicators`: there are none.
    fmi2GetEventIndicators(GetEventIndicators, *mut fmi2Real);
    /// `fmi2GetContinuousStates`: there are none.
    fmi2GetContinuousStates(GetContinuousStates, *mut fmi2Real);
    /// `fmi2GetNominalsOfContinuousStates`: there are no continuous states.
    fmi2GetNominalsOfContinuousStates(GetNominalsOfContinuousStates, *mut fmi2Real);
}

const FALSE: fmi2Boolean = fmi2False as fmi2Boolean;

//! Model exchange. There are no continuous states and no event indicators.

use super::types::{fmi2Boolean, fmi2Component, fmi2EventInfo, fmi2False, fmi2Real, fmi2Status};

use crate::fmi::Call;
use crate::fmi::abi::arguments::Room;
use crate::fmi::abi::calls::{instance_calls, of_none};

instance_calls! {
    fmi2Component => fmi2Status;
    /// `fmi2EnterEventMode`.
    fmi2EnterEventMode() = |instance| Ok(instance.enter_event_mode()?);
    /// `fmi2EnterContinuousTimeMode`.
    fmi2EnterContinuousTimeMode() = |instance| Ok(instance.enter_continuous_time_mode()?);
    /// `fmi2SetTime`.
    fmi2SetTime(time: fmi2Real) = |instance| Ok(instance.set_time(time)?);
    /// `fmi2NewDiscreteStates`: there are no discrete states. The simulation ends at an event for
    /// whose values no pose exists.
    fmi2NewDiscreteStates(event_info: *mut fmi2EventInfo) = |instance| {
        instance.allow(Call::NewDiscreteStates)?;
        let to = Room::new("fmi2eventInfo", event_info, 1)?;
        let must_end = instance.new_discrete_states()?;
        to.fill([fmi2EventInfo {
            newDiscreteStatesNeeded: fmi2False,
            terminateSimulation: must_end.into(),
            nominalsOfContinuousStatesChanged: fmi2False,
            valuesOfContinuousStatesChanged: fmi2False,
            nextEventTimeDefined: fmi2False,
            nextEventTime: 0.0,
        }]);
        Ok(())
    };
    /// `fmi2CompletedIntegratorStep`. Nothing is kept for going back, so that
    /// `no_set_fmu_state_prior_to_current_point` makes no difference.
    fmi2CompletedIntegratorStep(
        _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
        enter_event_mode: *mut fmi2Boolean,
        terminate_simulation: *mut fmi2Boolean,
    ) = |instance| {
        instance.allow(Call::CompletedIntegratorStep)?;
        let enter = Room::new("enterEventMode", enter_event_mode, 1)?;
        let terminate = Room::new("terminateSimulation", terminate_simulation, 1)?;
        let must_end = instance.completed_integrator_step()?;
        enter.fill([fmi2False]);
        terminate.fill([must_end.into()]);
        Ok(())
    };
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

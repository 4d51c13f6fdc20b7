//! Model exchange.

use super::types::{fmi2Boolean, fmi2EventInfo, fmi2False, fmi2Real};
use crate::fmi::abi::arguments::{fill, room, slice};
use crate::fmi::abi::calls::instance_calls;
use crate::fmi::{Call, StateChange};

instance_calls! {
    /// `fmi2EnterEventMode`.
    fmi2EnterEventMode() = |instance| instance.enter_event_mode();
    /// `fmi2EnterContinuousTimeMode`.
    fmi2EnterContinuousTimeMode() = |instance| instance.enter_continuous_time_mode();
    /// `fmi2SetTime`.
    fmi2SetTime(time: fmi2Real) = |instance| instance.set_time(time);
    /// `fmi2NewDiscreteStates`: no discrete state needs another update. The continuous states may jump
    /// or be exchanged. The simulation ends at an event for whose values no pose exists.
    fmi2NewDiscreteStates(event_info: *mut fmi2EventInfo) = |instance| {
        instance.allow(Call::NewDiscreteStates)?;
        let to = room("fmi2eventInfo", event_info, 1)?;
        let event = instance.new_discrete_states()?;
        fill(to, [fmi2EventInfo {
            newDiscreteStatesNeeded: fmi2False,
            terminateSimulation: event.must_end.into(),
            nominalsOfContinuousStatesChanged: (event.states == StateChange::Exchange).into(),
            valuesOfContinuousStatesChanged: (event.states != StateChange::None).into(),
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
        let enter = room("enterEventMode", enter_event_mode, 1)?;
        let terminate = room("terminateSimulation", terminate_simulation, 1)?;
        let step = instance.completed_integrator_step()?;
        fill(enter, [step.has_event.into()]);
        fill(terminate, [step.must_end.into()]);
        Ok(())
    };
    /// `fmi2SetContinuousStates`.
    fmi2SetContinuousStates(states: *const fmi2Real, count: usize) = |instance| {
        instance.allow(Call::SetContinuousStates)?;
        instance.set_continuous_states(&slice("x", states, count)?)
    };
    /// `fmi2GetDerivatives`.
    fmi2GetDerivatives(derivatives: *mut fmi2Real, count: usize) = |instance| {
        instance.allow(Call::GetDerivatives)?;
        let to = room("derivatives", derivatives, count)?;
        fill(to, instance.derivatives_of_states(count)?);
        Ok(())
    };
    /// `fmi2GetEventIndicators`.
    fmi2GetEventIndicators(indicators: *mut fmi2Real, count: usize) = |instance| {
        instance.allow(Call::GetEventIndicators)?;
        let to = room("eventIndicators", indicators, count)?;
        fill(to, instance.event_indicators(count)?);
        Ok(())
    };
    /// `fmi2GetContinuousStates`.
    fmi2GetContinuousStates(states: *mut fmi2Real, count: usize) = |instance| {
        instance.allow(Call::GetContinuousStates)?;
        let to = room("x", states, count)?;
        fill(to, instance.continuous_states(count)?);
        Ok(())
    };
    /// `fmi2GetNominalsOfContinuousStates`.
    fmi2GetNominalsOfContinuousStates(nominals: *mut fmi2Real, count: usize) = |instance| {
        instance.allow(Call::GetNominalsOfContinuousStates)?;
        let to = room("x_nominal", nominals, count)?;
        fill(to, instance.nominals(count)?);
        Ok(())
    };
}

//! Events, and model exchange.

use super::types::{fmi3Boolean, fmi3Float64};
use crate::fmi::abi::arguments::{check_room, fill, room, slice, write};
use crate::fmi::abi::calls::instance_calls;
use crate::fmi::{Call, StateChange};

instance_calls! {
    /// `fmi3EnterEventMode`.
    fmi3EnterEventMode() = |instance| instance.enter_event_mode();
    /// `fmi3EvaluateDiscreteStates`: there are none.
    fmi3EvaluateDiscreteStates() = |instance| instance.allow(Call::EvaluateDiscreteStates);
    /// `fmi3EnterContinuousTimeMode`.
    fmi3EnterContinuousTimeMode() = |instance| instance.enter_continuous_time_mode();
    /// `fmi3SetTime`.
    fmi3SetTime(time: fmi3Float64) = |instance| instance.set_time(time);
    /// `fmi3UpdateDiscreteStates`: no discrete state needs another update. The continuous states may jump
    /// or be exchanged. The simulation ends at an event for whose values no pose exists.
    fmi3UpdateDiscreteStates(
        discrete_states_need_update: *mut fmi3Boolean,
        terminate_simulation: *mut fmi3Boolean,
        nominals_of_continuous_states_changed: *mut fmi3Boolean,
        values_of_continuous_states_changed: *mut fmi3Boolean,
        next_event_time_defined: *mut fmi3Boolean,
        next_event_time: *mut fmi3Float64,
    ) = |instance| {
        instance.allow(Call::NewDiscreteStates)?;
        let flags = [
            ("discreteStatesNeedUpdate", discrete_states_need_update),
            ("nominalsOfContinuousStatesChanged", nominals_of_continuous_states_changed),
            ("valuesOfContinuousStatesChanged", values_of_continuous_states_changed),
            ("nextEventTimeDefined", next_event_time_defined),
        ];
        // One after the other: a host may give the same place for results that it ignores.
        for (name, flag) in flags {
            check_room(name, flag)?;
        }
        check_room("terminateSimulation", terminate_simulation)?;
        check_room("nextEventTime", next_event_time)?;
        let event = instance.new_discrete_states()?;
        for (_, flag) in flags {
            flag.write(false);
        }
        nominals_of_continuous_states_changed.write(event.states == StateChange::Exchange);
        values_of_continuous_states_changed.write(event.states != StateChange::None);
        next_event_time.write_unaligned(0.0);
        terminate_simulation.write(event.must_end);
        Ok(())
    };
    /// `fmi3CompletedIntegratorStep`. Nothing is kept for going back, so that
    /// `no_set_fmu_state_prior_to_current_point` makes no difference.
    fmi3CompletedIntegratorStep(
        _no_set_fmu_state_prior_to_current_point: fmi3Boolean,
        enter_event_mode: *mut fmi3Boolean,
        terminate_simulation: *mut fmi3Boolean,
    ) = |instance| {
        instance.allow(Call::CompletedIntegratorStep)?;
        check_room("enterEventMode", enter_event_mode)?;
        check_room("terminateSimulation", terminate_simulation)?;
        let step = instance.completed_integrator_step()?;
        enter_event_mode.write(step.has_event);
        terminate_simulation.write(step.must_end);
        Ok(())
    };
    /// `fmi3GetNumberOfEventIndicators`.
    fmi3GetNumberOfEventIndicators(count: *mut usize) = |instance| {
        let indicators = instance.number_of_event_indicators()?;
        write("nEventIndicators", count, indicators)
    };
    /// `fmi3GetNumberOfContinuousStates`.
    fmi3GetNumberOfContinuousStates(count: *mut usize) = |instance| {
        let states = instance.number_of_states()?;
        write("nContinuousStates", count, states)
    };
    /// `fmi3SetContinuousStates`.
    fmi3SetContinuousStates(states: *const fmi3Float64, count: usize) = |instance| {
        instance.allow(Call::SetContinuousStates)?;
        instance.set_continuous_states(&slice("continuousStates", states, count)?)
    };
    /// `fmi3GetContinuousStateDerivatives`.
    fmi3GetContinuousStateDerivatives(derivatives: *mut fmi3Float64, count: usize) = |instance| {
        instance.allow(Call::GetDerivatives)?;
        let to = room("derivatives", derivatives, count)?;
        fill(to, instance.derivatives_of_states(count)?);
        Ok(())
    };
    /// `fmi3GetEventIndicators`.
    fmi3GetEventIndicators(indicators: *mut fmi3Float64, count: usize) = |instance| {
        instance.allow(Call::GetEventIndicators)?;
        let to = room("eventIndicators", indicators, count)?;
        fill(to, instance.event_indicators(count)?);
        Ok(())
    };
    /// `fmi3GetContinuousStates`.
    fmi3GetContinuousStates(states: *mut fmi3Float64, count: usize) = |instance| {
        instance.allow(Call::GetContinuousStates)?;
        let to = room("continuousStates", states, count)?;
        fill(to, instance.continuous_states(count)?);
        Ok(())
    };
    /// `fmi3GetNominalsOfContinuousStates`.
    fmi3GetNominalsOfContinuousStates(nominals: *mut fmi3Float64, count: usize) = |instance| {
        instance.allow(Call::GetNominalsOfContinuousStates)?;
        let to = room("nominals", nominals, count)?;
        fill(to, instance.nominals(count)?);
        Ok(())
    };
}

//! Steps, with the host's intermediate update.

use super::types::{fmi3Boolean, fmi3Float64, fmi3Instance, fmi3Status};
use crate::fmi::abi::arguments::check_room;
use crate::fmi::abi::component::{Component, with_instance};
use crate::fmi::{Call, StepProgress};

/// `fmi3DoStep`. Nothing is kept for going back, so that
/// `no_set_fmu_state_prior_to_current_point` makes no difference.
///
/// During intermediate update the host calls functions on the same instance: no reference to it
/// lives then.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: fmi3Instance,
    current_communication_point: fmi3Float64,
    communication_step_size: fmi3Float64,
    _no_set_fmu_state_prior_to_current_point: fmi3Boolean,
    event_handling_needed: *mut fmi3Boolean,
    terminate_simulation: *mut fmi3Boolean,
    early_return: *mut fmi3Boolean,
    last_successful_time: *mut fmi3Float64,
) -> fmi3Status {
    let mut progress = None;
    // SAFETY: the host's promise.
    let mut status = unsafe {
        with_instance(instance, "fmi3DoStep", |instance| {
            instance.allow(Call::DoStep)?;
            // One after the other: a host may give the same place for results that it ignores.
            check_room("eventHandlingNeeded", event_handling_needed)?;
            check_room("terminateSimulation", terminate_simulation)?;
            check_room("earlyReturn", early_return)?;
            check_room("lastSuccessfulTime", last_successful_time)?;
            let (point, size) = (current_communication_point, communication_step_size);
            progress = Some(instance.begin_step(point, size)?);
            Ok(())
        })
    };
    while let Some(StepProgress::Intermediate {
        time,
        can_return_early,
    }) = progress.take_if(|progress| matches!(progress, StepProgress::Intermediate { .. }))
    {
        // SAFETY: the step has begun, so that there is an instance; it stays while the host is
        // called back.
        let part = unsafe {
            let callback = Component::begin_callback(instance);
            let wish = callback.and_then(|callback| callback.call(time, can_return_early));
            Component::end_callback(instance);
            with_instance(instance, "fmi3DoStep", |instance| {
                progress = Some(instance.resume_step(wish)?);
                Ok(())
            })
        };
        // A warning in one part is one of the whole step.
        status = status.max(part);
    }
    if let Some(StepProgress::Done(outcome)) = progress {
        // SAFETY: the places were checked above.
        unsafe {
            event_handling_needed.write(outcome.event_handling_needed);
            terminate_simulation.write(outcome.terminate_simulation);
            early_return.write(outcome.early_return);
            last_successful_time.write_unaligned(outcome.last_successful_time);
        }
    }
    status
}

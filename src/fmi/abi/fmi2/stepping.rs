//! Steps: their inputs' derivatives, the step itself and how it ended.

use super::types::{
    fmi2Boolean, fmi2DoStepStatus, fmi2Integer, fmi2LastSuccessfulTime, fmi2Real, fmi2Status,
    fmi2StatusKind, fmi2String, fmi2Terminated, fmi2ValueReference,
};
use crate::fmi::abi::arguments::{fill, room, slice, write};
use crate::fmi::abi::calls::instance_calls;
use crate::fmi::abi::component::{Instance, status_code};
use crate::fmi::{Call, Error};

instance_calls! {
    /// `fmi2SetRealInputDerivatives`.
    fmi2SetRealInputDerivatives(
        vr: *const fmi2ValueReference,
        nvr: usize,
        order: *const fmi2Integer,
        value: *const fmi2Real,
    ) = |instance| {
        let vr = slice("vr", vr, nvr)?;
        let (order, value) = (slice("order", order, nvr)?, slice("value", value, nvr)?);
        instance.set_real_input_derivatives(&vr, &order, &value)
    };
    /// `fmi2GetRealOutputDerivatives`.
    fmi2GetRealOutputDerivatives(
        vr: *const fmi2ValueReference,
        nvr: usize,
        order: *const fmi2Integer,
        value: *mut fmi2Real,
    ) = |instance| {
        let (vr, order) = (slice("vr", vr, nvr)?, slice("order", order, nvr)?);
        let room = room("value", value, nvr)?;
        fill(room, instance.output_derivatives(&vr, &order)?);
        Ok(())
    };
    /// `fmi2DoStep`. Nothing is kept for going back, so that
    /// `no_set_fmu_state_prior_to_current_point` makes no difference.
    fmi2DoStep(
        current_communication_point: fmi2Real,
        communication_step_size: fmi2Real,
        _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
    ) = |instance| instance.do_step(current_communication_point, communication_step_size);
    /// `fmi2CancelStep`: no step is ever in progress when it could be called.
    fmi2CancelStep() = |instance| instance.allow(Call::CancelStep);
    /// `fmi2GetStatus`: how the last step ended.
    fmi2GetStatus(kind: fmi2StatusKind, value: *mut fmi2Status) = |instance| {
        check_kind(instance, Call::GetStatus, kind, Some(fmi2DoStepStatus))?;
        write("value", value, status_code(instance.step_status()))
    };
    /// `fmi2GetRealStatus`: the last successful time.
    fmi2GetRealStatus(kind: fmi2StatusKind, value: *mut fmi2Real) = |instance| {
        check_kind(instance, Call::GetRealStatus, kind, Some(fmi2LastSuccessfulTime))?;
        write("value", value, instance.last_successful_time())
    };
    /// `fmi2GetIntegerStatus`: the standard defines none.
    fmi2GetIntegerStatus(kind: fmi2StatusKind, _: *mut fmi2Integer) = |instance| {
        check_kind(instance, Call::GetIntegerStatus, kind, None)
    };
    /// `fmi2GetBooleanStatus`: whether a step was discarded for good.
    fmi2GetBooleanStatus(kind: fmi2StatusKind, value: *mut fmi2Boolean) = |instance| {
        check_kind(instance, Call::GetBooleanStatus, kind, Some(fmi2Terminated))?;
        write("value", value, instance.is_terminated().into())
    };
    /// `fmi2GetStringStatus`: nothing is ever pending.
    fmi2GetStringStatus(kind: fmi2StatusKind, _: *mut fmi2String) = |instance| {
        check_kind(instance, Call::GetStringStatus, kind, None)
    };
}

/// Checks that a status function is allowed, and that it is asked for the one kind that it knows.
fn check_kind(
    instance: &Instance,
    call: Call,
    kind: fmi2StatusKind,
    known: Option<u32>,
) -> Result<(), Error> {
    instance.allow(call)?;
    if Some(kind) == known {
        Ok(())
    } else {
        Err(Error::StatusKind { kind })
    }
}

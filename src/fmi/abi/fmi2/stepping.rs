//! Steps: their inputs' derivatives, the step itself and how it ended.

use super::types::{
    fmi2Boolean, fmi2Component, fmi2DoStepStatus, fmi2Integer, fmi2LastSuccessfulTime, fmi2Real,
    fmi2Status, fmi2StatusKind, fmi2String, fmi2Terminated, fmi2ValueReference,
};

use crate::fmi::abi::arguments::{Room, slice, write};
use crate::fmi::abi::calls::instance_calls;
use crate::fmi::abi::component::status_code;
use crate::fmi::{Call, Error};

instance_calls! {
    fmi2Component => fmi2Status;
    /// `fmi2SetRealInputDerivatives`.
    fmi2SetRealInputDerivatives(
        vr: *const fmi2ValueReference,
        nvr: usize,
        order: *const fmi2Integer,
        value: *const fmi2Real,
    ) = |instance| {
        let vr = slice("vr", vr, nvr)?;
        let (order, value) = (slice("order", order, nvr)?, slice("value", value, nvr)?);
        Ok(instance.set_real_input_derivatives(vr, order, value)?)
    };
    /// `fmi2GetRealOutputDerivatives`.
    fmi2GetRealOutputDerivatives(
        vr: *const fmi2ValueReference,
        nvr: usize,
        order: *const fmi2Integer,
        value: *mut fmi2Real,
    ) = |instance| {
        let (vr, order) = (slice("vr", vr, nvr)?, slice("order", order, nvr)?);
        let room = Room::new("value", value, nvr)?;
        room.fill(instance.output_derivatives(vr, order)?);
        Ok(())
    };
    /// `fmi2DoStep`. Nothing is kept for going back, so that
    /// `no_set_fmu_state_prior_to_current_point` makes no difference.
    fmi2DoStep(
        current_communication_point: fmi2Real,
        communication_step_size: fmi2Real,
        _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
    ) = |instance| Ok(instance.do_step(current_communication_point, communication_step_size)?);
    /// `fmi2CancelStep`: no step is ever in progress when it could be called.
    fmi2CancelStep() = |instance| Ok(instance.allow(Call::CancelStep)?);
}

/// Defines the status functions, each with the one kind, if any, that it can tell.
macro_rules! status {
    ($(
        $(#[$doc:meta])*
        $function:ident($call:ident): $type:ty $(, $kind:ident => |$instance:ident| $value:expr)?;
    )*) => {
        instance_calls! {
            fmi2Component => fmi2Status;
            $(
                $(#[$doc])*
                $function(kind: fmi2StatusKind, value: *mut $type) = |instance| {
                    instance.allow(Call::$call)?;
                    match (kind, value) {
                        $(($kind, value) => {
                            let $instance = instance;
                            write("value", value, $value)
                        })?
                        (kind, _) => Err(Error::StatusKind { kind: kind.into() }.into()),
                    }
                };
            )*
        }
    };
}

status! {
    /// `fmi2GetStatus`: how the last step ended.
    fmi2GetStatus(GetStatus): fmi2Status,
        fmi2DoStepStatus => |instance| status_code(instance.step_status());
    /// `fmi2GetRealStatus`: the last successful time.
    fmi2GetRealStatus(GetRealStatus): fmi2Real,
        fmi2LastSuccessfulTime => |instance| instance.last_successful_time();
    /// `fmi2GetIntegerStatus`: the standard defines none.
    fmi2GetIntegerStatus(GetIntegerStatus): fmi2Integer;
    /// `fmi2GetBooleanStatus`: whether a step was discarded for good.
    fmi2GetBooleanStatus(GetBooleanStatus): fmi2Boolean,
        fmi2Terminated => |instance| fmi2Boolean::from(instance.is_terminated());
    /// `fmi2GetStringStatus`: nothing is ever pending.
    fmi2GetStringStatus(GetStringStatus): fmi2String;
}

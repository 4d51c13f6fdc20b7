//! Setting and getting variables.

use super::types::{fmi2Boolean, fmi2Integer, fmi2Real, fmi2String, fmi2ValueReference};
use crate::fmi::Call;
use crate::fmi::abi::arguments::{fill, room, slice};
use crate::fmi::abi::calls::instance_calls;

instance_calls! {
    /// `fmi2GetReal`.
    fmi2GetReal(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Real) = |instance| {
        let vr = slice("vr", vr, nvr)?;
        let room = room("value", value, nvr)?;
        instance.reals(&vr)?.write_to(room);
        Ok(())
    };
    /// `fmi2SetReal`.
    fmi2SetReal(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Real) = |instance| {
        let vr = slice("vr", vr, nvr)?;
        instance.set_real(&vr, &slice("value", value, nvr)?)
    };
    /// `fmi2GetInteger`: counts of the solver, and the choices.
    fmi2GetInteger(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Integer) = |instance| {
        let vr = slice("vr", vr, nvr)?;
        let room = room("value", value, nvr)?;
        fill(room, instance.integers(&vr)?);
        Ok(())
    };
    /// `fmi2SetInteger`.
    fmi2SetInteger(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Integer) = |instance| {
        let vr = slice("vr", vr, nvr)?;
        instance.set_integer(&vr, &slice("value", value, nvr)?)
    };
    /// `fmi2GetBoolean`: there are no Boolean variables.
    fmi2GetBoolean(vr: *const fmi2ValueReference, nvr: usize, _: *mut fmi2Boolean) = |instance| {
        instance.no_variables(Call::GetBoolean, "Boolean", &slice("vr", vr, nvr)?)
    };
    /// `fmi2SetBoolean`: there are no Boolean variables.
    fmi2SetBoolean(vr: *const fmi2ValueReference, nvr: usize, _: *const fmi2Boolean) = |instance| {
        instance.no_variables(Call::SetBoolean, "Boolean", &slice("vr", vr, nvr)?)
    };
    /// `fmi2GetString`: there are no String variables.
    fmi2GetString(vr: *const fmi2ValueReference, nvr: usize, _: *mut fmi2String) = |instance| {
        instance.no_variables(Call::GetString, "String", &slice("vr", vr, nvr)?)
    };
    /// `fmi2SetString`: there are no String variables.
    fmi2SetString(vr: *const fmi2ValueReference, nvr: usize, _: *const fmi2String) = |instance| {
        instance.no_variables(Call::SetString, "String", &slice("vr", vr, nvr)?)
    };
    /// `fmi2GetDirectionalDerivative`.
    fmi2GetDirectionalDerivative(
        vr_unknown: *const fmi2ValueReference,
        n_unknown: usize,
        vr_known: *const fmi2ValueReference,
        n_known: usize,
        dv_known: *const fmi2Real,
        dv_unknown: *mut fmi2Real,
    ) = |instance| {
        let unknowns = slice("vUnknown_ref", vr_unknown, n_unknown)?;
        let knowns = slice("vKnown_ref", vr_known, n_known)?;
        let changes = slice("dvKnown", dv_known, n_known)?;
        let room = room("dvUnknown", dv_unknown, n_unknown)?;
        fill(room, instance.directional_derivative(&unknowns, &knowns, &changes)?);
        Ok(())
    };
}

//! Setting and getting variables.

use super::types::{
    fmi2Boolean, fmi2Component, fmi2Integer, fmi2Real, fmi2Status, fmi2String, fmi2ValueReference,
};

use crate::fmi::Call;
use crate::fmi::abi::arguments::{Room, slice};
use crate::fmi::abi::calls::instance_calls;

instance_calls! {
    fmi2Component => fmi2Status;
    /// `fmi2GetReal`.
    fmi2GetReal(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Real) = |instance| {
        let vr = slice("vr", vr, nvr)?;
        let room = Room::new("value", value, nvr)?;
        instance.reals(vr)?.write_to(room.items());
        Ok(())
    };
    /// `fmi2SetReal`.
    fmi2SetReal(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Real) = |instance| {
        let vr = slice("vr", vr, nvr)?;
        Ok(instance.set_real(vr, slice("value", value, nvr)?)?)
    };
    /// `fmi2GetInteger`: counts of the solver, and the choices.
    fmi2GetInteger(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Integer) = |instance| {
        let vr = slice("vr", vr, nvr)?;
        let room = Room::new("value", value, nvr)?;
        room.fill(instance.integers(vr)?);
        Ok(())
    };
    /// `fmi2SetInteger`.
    fmi2SetInteger(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Integer) = |instance| {
        let vr = slice("vr", vr, nvr)?;
        Ok(instance.set_integer(vr, slice("value", value, nvr)?)?)
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
        let room = Room::new("dvUnknown", dv_unknown, n_unknown)?;
        room.fill(instance.directional_derivative(unknowns, knowns, changes)?);
        Ok(())
    };
}

/// Defines the access functions of types that no variable has, which touch no values: right for an empty
/// list only.
macro_rules! without_variables {
    ($($function:ident($call:ident, $value:ty, $type:literal);)*) => {
        instance_calls! {
            fmi2Component => fmi2Status;
            $(
                #[doc = concat!("`", stringify!($function), "`: there are no ", $type, " variables.")]
                $function(vr: *const fmi2ValueReference, nvr: usize, _: $value) = |instance| {
                    Ok(instance.no_variables(Call::$call, $type, slice("vr", vr, nvr)?)?)
                };
            )*
        }
    };
}

without_variables! {
    fmi2GetBoolean(GetBoolean, *mut fmi2Boolean, "Boolean");
    fmi2SetBoolean(SetBoolean, *const fmi2Boolean, "Boolean");
    fmi2GetString(GetString, *mut fmi2String, "String");
    fmi2SetString(SetString, *const fmi2String, "String");
}

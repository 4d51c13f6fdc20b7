//! Setting and getting variables.

use super::types::{
    fmi2Boolean, fmi2Component, fmi2Integer, fmi2Real, fmi2Status, fmi2String, fmi2ValueReference,
};

use crate::fmi::Call;
use crate::fmi::abi::arguments::{Room, slice};
use crate::fmi::abi::component::with_instance;

/// The access functions of types that variables have: those that get, with what writes the
/// values, and those that set.
macro_rules! with_variables {
    ($(
        $(#[$doc:meta])*
        $get:ident(|$instance:ident, $vr:ident, $room:ident| $write:expr),
        $set:ident($take:ident): $type:ty;
    )*) => {
        $(
            $(#[$doc])*
            ///
            /// # Safety
            ///
            /// The [host's promise](crate::fmi::abi#safety).
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $get(
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                value: *mut $type,
            ) -> fmi2Status {
                // SAFETY: the host's promise.
                unsafe {
                    with_instance(c, stringify!($get), |$instance| {
                        let $vr = slice("vr", vr, nvr)?;
                        let $room = Room::new("value", value, nvr)?;
                        $write;
                        Ok(())
                    })
                }
            }

            #[doc = concat!("`", stringify!($set), "`.")]
            ///
            /// # Safety
            ///
            /// The [host's promise](crate::fmi::abi#safety).
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $set(
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                value: *const $type,
            ) -> fmi2Status {
                // SAFETY: the host's promise.
                unsafe {
                    with_instance(c, stringify!($set), |instance| {
                        let vr = slice("vr", vr, nvr)?;
                        Ok(instance.$take(vr, slice("value", value, nvr)?)?)
                    })
                }
            }
        )*
    };
}

with_variables! {
    /// `fmi2GetReal`.
    fmi2GetReal(|instance, vr, room| instance.reals(vr)?.write_to(room.items())),
    fmi2SetReal(set_real): fmi2Real;
    /// `fmi2GetInteger`: counts of the solver, and the choices.
    fmi2GetInteger(|instance, vr, room| room.fill(instance.integers(vr)?)),
    fmi2SetInteger(set_integer): fmi2Integer;
}

/// The access functions of types that no variable has: right for an empty list only.
macro_rules! without_variables {
    ($($(#[$doc:meta])* $function:ident($call:ident, $value:ty, $expected:literal);)*) => {
        $(
            $(#[$doc])*
            ///
            /// # Safety
            ///
            /// The [host's promise](crate::fmi::abi#safety). `value` is not touched.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                _value: $value,
            ) -> fmi2Status {
                // SAFETY: the host's promise.
                unsafe {
                    with_instance(c, stringify!($function), |instance| {
                        let vr = slice("vr", vr, nvr)?;
                        Ok(instance.no_variables(Call::$call, $expected, vr)?)
                    })
                }
            }
        )*
    };
}

without_variables! {
    /// `fmi2GetBoolean`: there are no Boolean variables.
    fmi2GetBoolean(GetBoolean, *mut fmi2Boolean, "Boolean");
    /// `fmi2SetBoolean`: there are no Boolean variables.
    fmi2SetBoolean(SetBoolean, *const fmi2Boolean, "Boolean");
    /// `fmi2GetString`: there are no String variables.
    fmi2GetString(GetString, *mut fmi2String, "String");
    /// `fmi2SetString`: there are no String variables.
    fmi2SetString(SetString, *const fmi2String, "String");
}

/// `fmi2GetDirectionalDerivative`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    c: fmi2Component,
    vr_unknown: *const fmi2ValueReference,
    n_unknown: usize,
    vr_known: *const fmi2ValueReference,
    n_known: usize,
    dv_known: *const fmi2Real,
    dv_unknown: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(c, "fmi2GetDirectionalDerivative", |instance| {
            let unknowns = slice("vUnknown_ref", vr_unknown, n_unknown)?;
            let knowns = slice("vKnown_ref", vr_known, n_known)?;
            let changes = slice("dvKnown", dv_known, n_known)?;
            let room = Room::new("dvUnknown", dv_unknown, n_unknown)?;
            room.fill(instance.directional_derivative(unknowns, knowns, changes)?);
            Ok(())
        })
    }
}

//! Functions of capabilities that the FMU does not have.

use fmi_sys::fmi2::{
    fmi2Boolean, fmi2Component, fmi2EventInfo, fmi2Real, fmi2Status, fmi2ValueReference,
};

use super::component::{CallError, with_instance};

/// Functions behind a capability that this FMU declares not to have: they answer `fmi2Error`.
macro_rules! not_served {
    ($($why:literal { $($function:ident($($argument:ty),*);)* })*) => {
        $($(
            #[doc = concat!("`", stringify!($function), "`: ", $why, ".")]
            ///
            /// # Safety
            ///
            /// The [host's promise](super#safety). The arguments are not touched.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(c: fmi2Component $(, _: $argument)*) -> fmi2Status {
                // SAFETY: the host's promise.
                unsafe {
                    with_instance(c, stringify!($function), |_| {
                        Err(CallError::Argument($why.to_owned()))
                    })
                }
            }
        )*)*
    };
}

not_served! {
    "this FMU provides no directional derivatives" {
        fmi2GetDirectionalDerivative(
            *const fmi2ValueReference, usize, *const fmi2ValueReference, usize, *const fmi2Real,
            *mut fmi2Real
        );
    }
    "this FMU is for co-simulation only" {
        fmi2EnterEventMode();
        fmi2NewDiscreteStates(*mut fmi2EventInfo);
        fmi2EnterContinuousTimeMode();
        fmi2CompletedIntegratorStep(fmi2Boolean, *mut fmi2Boolean, *mut fmi2Boolean);
        fmi2SetTime(fmi2Real);
        fmi2SetContinuousStates(*const fmi2Real, usize);
        fmi2GetDerivatives(*mut fmi2Real, usize);
        fmi2GetEventIndicators(*mut fmi2Real, usize);
        fmi2GetContinuousStates(*mut fmi2Real, usize);
        fmi2GetNominalsOfContinuousStates(*mut fmi2Real, usize);
    }
}

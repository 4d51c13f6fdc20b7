//! Clocks and model partitions. There are none.

use super::types::{
    fmi3Clock, fmi3Float64, fmi3Instance, fmi3IntervalQualifier, fmi3Status, fmi3UInt64,
    fmi3ValueReference,
};
use crate::fmi::Call;
use crate::fmi::abi::arguments::slice;
use crate::fmi::abi::component::with_instance;

/// The functions of clocks: right for an empty list only.
macro_rules! without_clocks {
    ($($(#[$doc:meta])* $function:ident($call:ident: $($array:ty),*);)*) => {
        $(
            $(#[$doc])*
            ///
            /// # Safety
            ///
            /// The [host's promise](crate::fmi::abi#safety). The arrays of values are not touched.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(
                instance: fmi3Instance,
                value_references: *const fmi3ValueReference,
                n_value_references: usize,
                $(_: $array,)*
            ) -> fmi3Status {
                // SAFETY: the host's promise.
                unsafe {
                    with_instance(instance, stringify!($function), |instance| {
                        let references =
                            slice("valueReferences", value_references, n_value_references)?;
                        Ok(instance.no_variables(Call::$call, "Clock", references)?)
                    })
                }
            }
        )*
    };
}

without_clocks! {
    /// `fmi3GetClock`: there are no clocks.
    fmi3GetClock(GetClock: *mut fmi3Clock);
    /// `fmi3SetClock`: there are no clocks.
    fmi3SetClock(SetClock: *const fmi3Clock);
    /// `fmi3GetIntervalDecimal`: there are no clocks.
    fmi3GetIntervalDecimal(GetIntervalDecimal: *mut fmi3Float64, *mut fmi3IntervalQualifier);
    /// `fmi3GetIntervalFraction`: there are no clocks.
    fmi3GetIntervalFraction(GetIntervalFraction: *mut fmi3UInt64, *mut fmi3UInt64, *mut fmi3IntervalQualifier);
    /// `fmi3GetShiftDecimal`: there are no clocks.
    fmi3GetShiftDecimal(GetShiftDecimal: *mut fmi3Float64);
    /// `fmi3GetShiftFraction`: there are no clocks.
    fmi3GetShiftFraction(GetShiftFraction: *mut fmi3UInt64, *mut fmi3UInt64);
    /// `fmi3SetIntervalDecimal`: there are no clocks.
    fmi3SetIntervalDecimal(SetIntervalDecimal: *const fmi3Float64);
    /// `fmi3SetIntervalFraction`: there are no clocks.
    fmi3SetIntervalFraction(SetIntervalFraction: *const fmi3UInt64, *const fmi3UInt64);
    /// `fmi3SetShiftDecimal`: there are no clocks.
    fmi3SetShiftDecimal(SetShiftDecimal: *const fmi3Float64);
    /// `fmi3SetShiftFraction`: there are no clocks.
    fmi3SetShiftFraction(SetShiftFraction: *const fmi3UInt64, *const fmi3UInt64);
}

/// `fmi3ActivateModelPartition`: always refused, since there are no clocks.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ActivateModelPartition(
    instance: fmi3Instance,
    _clock_reference: fmi3ValueReference,
    _activation_time: fmi3Float64,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3ActivateModelPartition", |instance| {
            Ok(instance.allow(Call::ActivateModelPartition)?)
        })
    }
}

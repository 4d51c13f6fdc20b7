//! Functions that differ in name and call alone, one line each.

/// Defines functions whose arguments besides the instance are values, not pointers.
macro_rules! instance_calls {
    (
        $handle:ty => $status:ty;
        $($(#[$doc:meta])* $function:ident($($argument:ident: $of:ty),*) = $call:expr;)*
    ) => {
        $(
            $(#[$doc])*
            ///
            /// # Safety
            ///
            /// The [host's promise](crate::fmi::abi#safety).
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(handle: $handle, $($argument: $of),*) -> $status {
                let call = $crate::fmi::abi::component::as_call($call);
                // SAFETY: the host's promise.
                unsafe {
                    $crate::fmi::abi::component::with_instance(handle, stringify!($function), |instance| Ok(call(instance)?))
                }
            }
        )*
    };
}

/// Defines functions whose arrays are as long as there are continuous states or event
/// indicators: right for a length of zero only.
macro_rules! of_none {
    (
        $handle:ty => $status:ty;
        $($(#[$doc:meta])* $function:ident($call:ident, $array:ty);)*
    ) => {
        $(
            $(#[$doc])*
            ///
            /// # Safety
            ///
            /// The [host's promise](crate::fmi::abi#safety). The array is not touched.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(
                handle: $handle,
                _array: $array,
                count: usize,
            ) -> $status {
                // SAFETY: the host's promise.
                unsafe {
                    $crate::fmi::abi::component::with_instance(handle, stringify!($function), |instance| {
                        Ok(instance.continuous($crate::fmi::Call::$call, count)?)
                    })
                }
            }
        )*
    };
}

//! Functions of the standard that are calls on an instance: their names, arguments and bodies.

/// Defines functions that find the instance behind their handle, run their body on it, and return the
/// status of the outcome.
macro_rules! instance_calls {
    ($(
        $(#[$doc:meta])*
        $function:ident($($argument:tt: $of:ty),* $(,)?) = |$instance:ident| $body:expr;
    )*) => {
        $(
            $(#[$doc])*
            ///
            /// # Safety
            ///
            /// The [host's promise](crate::fmi::abi#safety).
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(
                handle: $crate::fmi::abi::component::Handle,
                $($argument: $of),*
            ) -> $crate::fmi::abi::component::StatusCode {
                // SAFETY: the host's promise.
                unsafe {
                    $crate::fmi::abi::component::with_instance(
                        handle,
                        stringify!($function),
                        |$instance| $body,
                    )
                }
            }
        )*
    };
}
pub(super) use instance_calls;

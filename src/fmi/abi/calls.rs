//! Functions of the standard that are calls on an instance: their names, arguments and bodies.

/// Defines functions that find the instance behind their handle, run their body on it, and return the
/// status of the outcome.
macro_rules! instance_calls {
    (
        $handle:ty => $status:ty;
        $(
            $(#[$doc:meta])*
            $function:ident($($argument:tt: $of:ty),* $(,)?) = |$instance:ident| $body:expr;
        )*
    ) => {
        $(
            $(#[$doc])*
            ///
            /// # Safety
            ///
            /// The [host's promise](crate::fmi::abi#safety).
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(handle: $handle, $($argument: $of),*) -> $status {
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

/// Defines functions whose arrays, which they do not touch, are as long as there are continuous states
/// or event indicators: right for a length of zero only.
macro_rules! of_none {
    (
        $handle:ty => $status:ty;
        $($(#[$doc:meta])* $function:ident($call:ident, $array:ty);)*
    ) => {
        $crate::fmi::abi::calls::instance_calls! {
            $handle => $status;
            $(
                $(#[$doc])*
                $function(_: $array, count: usize) = |instance| {
                    Ok(instance.continuous($crate::fmi::Call::$call, count)?)
                };
            )*
        }
    };
}
pub(super) use of_none;

//! The host's part in a step of FMI 3.0.

use std::ffi::c_void;

/// The host's intermediate update: time, whether inputs may be set, outputs be read, whether the
/// solver has accepted the point, whether the step may end early; then the host's wish for that
/// and the time of the end.
pub(super) type Callback =
    unsafe extern "C" fn(*mut c_void, f64, bool, bool, bool, bool, *mut bool, *mut f64);

/// The host's intermediate update, with the environment that it wants to be called with.
#[derive(Clone, Copy)]
pub(super) struct IntermediateUpdate {
    pub(super) callback: Callback,
    pub(super) environment: *mut c_void,
}

impl IntermediateUpdate {
    /// Lets the host read outputs and set inputs at `time`. Returns the time at which it wants the
    /// step to end, if it wants that.
    pub(super) fn call(self, time: f64, can_return_early: bool) -> Option<f64> {
        let (mut requested, mut early_return_time) = (false, time);
        // SAFETY: the host promises a function with the signature of the header; the two results
        // live until it returns.
        unsafe {
            (self.callback)(
                self.environment,
                time,
                true,
                true,
                true,
                can_return_early,
                &raw mut requested,
                &raw mut early_return_time,
            );
        }
        (requested && can_return_early).then_some(early_return_time)
    }
}

//! Components, and the one door through which all calls on them go.

use std::any::Any;
use std::cell::UnsafeCell;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

use super::Exported;
use super::floating_point::StandardEnvironment;
use super::intermediate::IntermediateUpdate;
use crate::fmi::{Error, Status};

/// An instance as the host sees it, or an FMU state.
pub(super) type Handle = *mut c_void;

/// A status as the host sees it. The versions of the standard number them alike.
pub(super) type StatusCode = u32;

pub(super) type Instance = crate::fmi::Instance<Exported>;

/// Data behind a handle.
pub(super) struct Component {
    instance: UnsafeCell<Instance>,
    /// Whether a call is being served: only who has set it touches the instance.
    busy: AtomicBool,
    /// Whether another call came meanwhile and was refused.
    disturbed: AtomicBool,
    /// The host's intermediate update.
    intermediate_update: Option<IntermediateUpdate>,
    /// Whether a step has called back and waits for the host.
    calling_back: AtomicBool,
}

impl Component {
    /// Hands an instance over to the host.
    pub(super) fn hand_over(
        instance: Instance,
        intermediate_update: Option<IntermediateUpdate>,
    ) -> Handle {
        let component = Self {
            instance: UnsafeCell::new(instance),
            busy: AtomicBool::new(false),
            disturbed: AtomicBool::new(false),
            intermediate_update,
            calling_back: AtomicBool::new(false),
        };
        Box::into_raw(Box::new(component)).cast()
    }

    /// Reserves the instance for the caller. Returns whether it was free.
    ///
    /// The host has promised to call from one thread at a time, so that a load and a store are
    /// enough; they cost a fraction of an atomic exchange, of which each call would need two.
    fn seize(&self) -> bool {
        let free = !self.busy.load(Ordering::Acquire);
        if free {
            self.busy.store(true, Ordering::Relaxed);
        } else {
            self.disturbed.store(true, Ordering::Relaxed);
        }
        free
    }

    /// Returns the host's intermediate update, which is about to be called: until it has returned,
    /// the component stays.
    ///
    /// # Safety
    ///
    /// `c` is a component that has not been freed.
    pub(super) unsafe fn begin_callback(c: Handle) -> Option<IntermediateUpdate> {
        // SAFETY: promised by the caller.
        let component = unsafe { c.cast::<Self>().as_ref() }?;
        component.calling_back.store(true, Ordering::Relaxed);
        component.intermediate_update
    }

    /// Ends what [`begin_callback`](Self::begin_callback) began.
    ///
    /// # Safety
    ///
    /// `c` is a component that has not been freed.
    pub(super) unsafe fn end_callback(c: Handle) {
        // SAFETY: promised by the caller.
        if let Some(component) = unsafe { c.cast::<Self>().as_ref() } {
            component.calling_back.store(false, Ordering::Relaxed);
        }
    }

    /// Frees a component; while a call on it is being served, or a step waits for the host, it
    /// stays, as if not asked for.
    ///
    /// # Safety
    ///
    /// `c` is null or a component that has not been freed, and is not used any more.
    pub(super) unsafe fn take_back(c: Handle) {
        let component: *mut Self = c.cast();
        // SAFETY: promised by the caller.
        let seized = unsafe { component.as_ref() }.is_some_and(|component| {
            !component.calling_back.load(Ordering::Relaxed) && component.seize()
        });
        if seized {
            // SAFETY: the box was made in `hand_over`, and nobody uses the instance.
            let component = unsafe { Box::from_raw(component) };
            let _ = catch_unwind(AssertUnwindSafe(|| drop(component)));
        }
    }
}

/// Runs `f` on the instance behind `c`; its error goes to the host's logger, a panic becomes
/// a fatal status.
///
/// # Safety
///
/// `c` is null or a component that has not been freed, and no other thread uses it meanwhile.
pub(super) unsafe fn with_instance(
    c: Handle,
    call: &str,
    f: impl FnOnce(&mut Instance) -> Result<(), Error>,
) -> StatusCode {
    // SAFETY: promised by the caller.
    let Some(component) = (unsafe { c.cast::<Component>().as_ref() }) else {
        return status_code(Status::Error);
    };
    if !component.seize() {
        // The instance's logger cannot be reached now; the call that is being served reports it.
        return status_code(Status::Error);
    }
    let _environment = StandardEnvironment::set();
    // SAFETY: seized, and calls come from one thread at a time, so that this is the only reference
    // to the instance until `busy` is false again.
    let instance = unsafe { &mut *component.instance.get() };
    let status = serve(instance, call, f);
    if component.disturbed.load(Ordering::Relaxed) {
        component.disturbed.store(false, Ordering::Relaxed);
        let _ = catch_unwind(AssertUnwindSafe(|| {
            instance.report_disturbance(
                call,
                "another call on this instance came meanwhile, from the logger or from another \
                 thread, and was refused",
            );
        }));
        // The logger may have called back again: one report is enough.
        component.disturbed.store(false, Ordering::Relaxed);
    }
    component.busy.store(false, Ordering::Release);
    status_code(status)
}

fn serve(
    instance: &mut Instance,
    call: &str,
    f: impl FnOnce(&mut Instance) -> Result<(), Error>,
) -> Status {
    let outcome = catch_unwind(AssertUnwindSafe(|| match f(instance) {
        Ok(()) => instance.succeeded(),
        Err(error) => instance.report(call, &error),
    }));
    outcome.unwrap_or_else(|payload| {
        let what = format!("{call}: defect in biela: {}", panic_message(&*payload));
        // Should the logging be what panicked, a second panic must not escape either.
        let _ = catch_unwind(AssertUnwindSafe(|| instance.mark_fatal(&what)));
        Status::Fatal
    })
}

/// Returns the standard's number of a status.
#[inline]
pub(super) fn status_code(status: Status) -> StatusCode {
    status as StatusCode
}

/// Returns the message of a caught panic.
pub(super) fn panic_message(payload: &(dyn Any + Send)) -> &str {
    payload
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| payload.downcast_ref::<&str>().copied())
        .unwrap_or("no message")
}

//! Instantiation, as far as the versions of the standard share it.

use std::ffi::c_char;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;
use std::sync::Once;

use super::arguments::{refuse, text};
use super::component::{Component, Handle, Instance, panic_message};
use super::floating_point::StandardEnvironment;
use super::intermediate::IntermediateUpdate;
use crate::fmi::Error;

/// Hands over to the host the instance that `make` returns; null if there is none, after `complain` has
/// told the host why.
pub(super) fn instantiate(
    make: impl FnOnce() -> Result<(Instance, Option<IntermediateUpdate>), Error>,
    complain: impl FnOnce(&str),
) -> Handle {
    silence_panics();
    let _environment = StandardEnvironment::set();
    let message = match catch_unwind(AssertUnwindSafe(make)) {
        Ok(Ok((instance, intermediate_update))) => {
            return Component::hand_over(instance, intermediate_update);
        }
        Ok(Err(error)) => error.to_string(),
        Err(payload) => format!("defect in biela: {}", panic_message(&*payload)),
    };
    // Should the logging be what panicked, a second panic must not escape either.
    let _ = catch_unwind(AssertUnwindSafe(|| complain(&message)));
    null_mut()
}

/// Returns the texts behind the arguments that all functions have that instantiate, each with its name: the
/// instance's name, GUID and resources.
///
/// # Safety
///
/// The [host's promise](super#safety).
pub(super) unsafe fn texts<'a>(
    arguments: [(&'static str, *const c_char); 3],
) -> Result<[&'a str; 3], Error> {
    // SAFETY: promised by the caller.
    let [name, guid, resources] = arguments.map(|(name, pointer)| unsafe { text(name, pointer) });
    let texts = [name?, guid?, resources?];
    if texts[0].trim().is_empty() {
        return Err(refuse("instanceName", "is empty or blank"));
    }
    Ok(texts)
}

/// Keeps std from printing panics to stderr: a caught one reaches the host as a message. The library
/// has a copy of std of its own, so that no other panic in the process is silenced.
fn silence_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| std::panic::set_hook(Box::new(|_| {})));
}

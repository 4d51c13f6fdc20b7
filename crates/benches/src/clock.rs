//! The clock of all measurements, `yardstick/clock.h`.

#![allow(unsafe_code, reason = "calls into C")]

use std::ffi::c_longlong;
use std::time::Duration;

// SAFETY: the declaration is that of the header; the function has no arguments and reads a clock.
unsafe extern "C" {
    safe fn thread_time() -> c_longlong;
}

/// Runs a program. Returns what it returns, and the time that this thread has run for it.
pub fn timed<T>(program: impl FnOnce() -> T) -> (T, Duration) {
    let start = thread_time();
    let result = program();
    let time = thread_time() - start;
    let time = u64::try_from(time).expect("the clock runs forwards");
    (result, Duration::from_nanos(time))
}

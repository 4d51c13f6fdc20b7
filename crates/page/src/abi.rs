//! The functions that a page's scripts call, on top of the `Host` of the crate.
//!
//! A script writes a request of some length into the memory at [`biela_input`], calls
//! [`biela_answer`], and reads the answer of the returned length at [`biela_output`]. Numbers of
//! the picture stand in the list at [`biela_frame`]. After a panic, whose message is in the output,
//! the instance is not to be used any more.

#![allow(
    unsafe_code,
    reason = "a function that a browser calls by its name must not share it with another one"
)]

use std::cell::RefCell;

use crate::Host;

/// All that the functions share. A page has one thread.
#[derive(Default)]
struct Page {
    host: Host,
    input: Vec<u8>,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
    /// The answer, or the message of a panic; apart from the page, which is in use in a panic.
    static OUTPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Puts bytes into the output and returns their number.
fn put_out(bytes: &[u8]) -> usize {
    OUTPUT.with_borrow_mut(|output| {
        output.clear();
        output.extend_from_slice(bytes);
    });
    bytes.len()
}

/// Returns the place for a request of a length in bytes.
// SAFETY: no other function has this name.
#[unsafe(no_mangle)]
pub extern "C" fn biela_input(length: usize) -> *mut u8 {
    PAGE.with_borrow_mut(|page| {
        page.input.clear();
        page.input.resize(length, 0);
        page.input.as_mut_ptr()
    })
}

/// Answers the request in the input, JSON in UTF-8; returns the length of the answer. The output is
/// empty until then, so that it has no words of an earlier answer if the instance ends.
// SAFETY: no other function has this name.
#[unsafe(no_mangle)]
pub extern "C" fn biela_answer() -> usize {
    std::panic::set_hook(Box::new(|panic| {
        put_out(panic.to_string().as_bytes());
    }));
    put_out(b"");
    PAGE.with_borrow_mut(|page| {
        let Page { host, input } = page;
        let answer = match std::str::from_utf8(input) {
            Ok(request) => host.answer(request).to_string(),
            Err(error) => format!("{{\"error\":\"{error}\"}}"),
        };
        put_out(answer.as_bytes())
    })
}

/// Returns the place of the last answer, or of the message of a panic.
// SAFETY: no other function has this name.
#[unsafe(no_mangle)]
pub extern "C" fn biela_output() -> *const u8 {
    OUTPUT.with_borrow(Vec::as_ptr)
}

/// Returns the length of the last answer, or of the message of a panic.
// SAFETY: no other function has this name.
#[unsafe(no_mangle)]
pub extern "C" fn biela_output_length() -> usize {
    OUTPUT.with_borrow(Vec::len)
}

/// Moves a driver to a value \[m or rad\]; returns 1 if it is reached and 0 otherwise. The output is
/// empty then.
// SAFETY: no other function has this name.
#[unsafe(no_mangle)]
pub extern "C" fn biela_drive(driver: usize, value: f64) -> u32 {
    put_out(b"");
    PAGE.with_borrow_mut(|page| u32::from(page.host.drive(driver, value)))
}

/// Returns the place of the numbers of the picture.
// SAFETY: no other function has this name.
#[unsafe(no_mangle)]
pub extern "C" fn biela_frame() -> *const f64 {
    PAGE.with_borrow(|page| page.host.frame().as_ptr())
}

/// Returns how many numbers of the picture there are.
// SAFETY: no other function has this name.
#[unsafe(no_mangle)]
pub extern "C" fn biela_frame_length() -> usize {
    PAGE.with_borrow(|page| page.host.frame().len())
}

//! Messages to the host as C strings, and the categories that it wants.

use std::borrow::Cow;
use std::ffi::{CString, c_char};

use super::arguments::{slice, text};
use super::component::Instance;
use crate::fmi::{Call, Error};

/// Longest message \[bytes\]: some hosts have no room for more, which a mechanism of thousands of
/// bodies may need.
const LONGEST_MESSAGE: usize = 8000;

/// Switches the log categories whose names are in an array of the host.
///
/// # Safety
///
/// The [host's promise](super#safety).
pub(super) unsafe fn set_debug_logging(
    instance: &mut Instance,
    on: bool,
    categories: *const *const c_char,
    count: usize,
) -> Result<(), Error> {
    instance.allow(Call::SetDebugLogging)?;
    // SAFETY: promised by the caller.
    let categories = unsafe { slice("categories", categories, count)? };
    let names = categories.iter().map(|&category| {
        // SAFETY: promised by the caller.
        unsafe { text("category", category) }
    });
    let names: Vec<_> = names.collect::<Result<_, _>>()?;
    instance.set_debug_logging(on, &names)
}

/// Returns a message as the standard wants it: it reads `#12#` as a reference to a variable, and
/// `##` as one `#`.
pub(super) fn message_text(message: &str) -> CString {
    c_string(&shortened(message).replace('#', "##"))
}

/// Returns a C string; leaves out NUL characters inside, which it could not carry.
pub(super) fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', "")).unwrap_or_default()
}

/// Returns the beginning of a message that is too long.
fn shortened(message: &str) -> Cow<'_, str> {
    if message.len() <= LONGEST_MESSAGE {
        return message.into();
    }
    let end = message.floor_char_boundary(LONGEST_MESSAGE);
    let left = message.len() - end;
    format!("{}… ({left} bytes more)", &message[..end]).into()
}

#[cfg(test)]
mod tests {
    use super::{LONGEST_MESSAGE, shortened};

    #[test]
    fn long_messages_are_cut_between_characters() {
        assert_eq!(shortened("manivela"), "manivela");
        let long = "á".repeat(LONGEST_MESSAGE);
        let cut = shortened(&long);
        assert!(cut.len() < LONGEST_MESSAGE + 30);
        assert!(cut.ends_with("á… (8000 bytes more)"), "{cut}");
    }
}

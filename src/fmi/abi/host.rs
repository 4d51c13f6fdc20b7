//! The host's logger callback.

use std::ffi::{CString, c_void};

use super::types::{
    fmi2CallbackFunctions, fmi2CallbackLogger, fmi2Discard, fmi2Error, fmi2Fatal, fmi2OK,
    fmi2Status, fmi2Warning,
};

use crate::fmi::{Category, Sink, Status};

/// The host's logger, with what it wants to be called with.
pub(super) struct HostLogger {
    callback: fmi2CallbackLogger,
    environment: *mut c_void,
    instance_name: CString,
}

// SAFETY: the environment pointer is never read here, only handed back to the host, which uses an
// instance from one thread at a time and so gets its callback from one thread at a time.
unsafe impl Send for HostLogger {}

impl HostLogger {
    pub(super) fn new(callbacks: &fmi2CallbackFunctions, instance_name: &str) -> Self {
        Self {
            callback: callbacks.logger,
            environment: callbacks.componentEnvironment,
            instance_name: c_string(instance_name),
        }
    }
}

impl Sink for HostLogger {
    fn write(&self, status: Status, category: Category, message: &str) {
        let Some(callback) = self.callback else {
            return;
        };
        let message = shortened(message);
        // The standard reads `#r12#` in a message as a reference to a variable.
        let message = message.replace('#', "##");
        let (category, message) = (c_string(category.name()), c_string(&message));
        // SAFETY: the host promises a function with the signature of the header, all strings live
        // until it returns, and the format has exactly one argument, a string.
        unsafe {
            callback(
                self.environment,
                self.instance_name.as_ptr(),
                status_code(status),
                category.as_ptr(),
                c"%s".as_ptr(),
                message.as_ptr(),
            );
        }
    }
}

/// Longest message that hosts have room for: a mechanism of thousands of bodies may have as much to say.
const LONGEST_MESSAGE: usize = 8000;

/// The beginning of a message that is too long.
fn shortened(message: &str) -> std::borrow::Cow<'_, str> {
    if message.len() <= LONGEST_MESSAGE {
        return message.into();
    }
    let end = message.floor_char_boundary(LONGEST_MESSAGE);
    let left = message.len() - end;
    format!("{}… ({left} bytes more)", &message[..end]).into()
}

/// The standard's number of a status.
pub(super) fn status_code(status: Status) -> fmi2Status {
    match status {
        Status::Ok => fmi2OK,
        Status::Warning => fmi2Warning,
        Status::Discard => fmi2Discard,
        Status::Error => fmi2Error,
        Status::Fatal => fmi2Fatal,
    }
}

/// A C string; NUL characters inside, which it could not carry, are left out.
fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', "")).unwrap_or_default()
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

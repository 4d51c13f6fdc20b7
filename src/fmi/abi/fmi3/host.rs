//! The host's logger callback.

use super::types::{fmi3InstanceEnvironment, fmi3LogMessageCallback};
use crate::fmi::abi::component::status_code;
use crate::fmi::abi::message::{c_string, message_text};
use crate::fmi::{Category, Sink, Status};

/// The host's logger, with the environment that it wants to be called with.
#[derive(Clone, Copy)]
pub(super) struct HostLogger {
    callback: fmi3LogMessageCallback,
    environment: fmi3InstanceEnvironment,
}

// SAFETY: the environment pointer is never read here, only handed back to the host, which uses an
// instance from one thread at a time and so gets its callback from one thread at a time.
unsafe impl Send for HostLogger {}

impl HostLogger {
    pub(super) fn new(
        callback: fmi3LogMessageCallback,
        environment: fmi3InstanceEnvironment,
    ) -> Self {
        Self {
            callback,
            environment,
        }
    }
}

impl Sink for HostLogger {
    fn write(&self, status: Status, category: Category, message: &str) {
        let Some(callback) = self.callback else {
            return;
        };
        let (category, message) = (c_string(category.name()), message_text(message));
        // SAFETY: the host promises a function with the signature of the header, and all strings
        // live until it returns.
        unsafe {
            callback(
                self.environment,
                status_code(status),
                category.as_ptr(),
                message.as_ptr(),
            );
        }
    }
}

//! The host's logger callback.

use std::ffi::CString;

use super::types::{fmi2CallbackFunctions, fmi2CallbackLogger, fmi2ComponentEnvironment};
use crate::fmi::abi::component::status_code;
use crate::fmi::abi::message::{c_string, message_text};
use crate::fmi::{Category, Sink, Status};

/// The host's logger, with what it wants to be called with.
pub(super) struct HostLogger {
    callback: fmi2CallbackLogger,
    environment: fmi2ComponentEnvironment,
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
        let (category, message) = (c_string(category.name()), message_text(message));
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

//! A log that a test reads.

use std::sync::{Arc, Mutex};

use biela::fmi::{Category, Interface, MechanismModel, Sink, Status, Version};
use biela::mechanism::Mechanism;

use super::Instance;

/// A message of an instance.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Message {
    pub(crate) status: Status,
    pub(crate) category: Category,
    pub(crate) text: String,
}

/// Collects messages as they come.
#[derive(Clone, Default)]
pub(crate) struct Heard(Arc<Mutex<Vec<Message>>>);

impl Sink for Heard {
    fn write(&self, status: Status, category: Category, message: &str) {
        let mut heard = self.0.lock().expect("no test panics with it");
        heard.push(Message {
            status,
            category,
            text: message.to_owned(),
        });
    }
}

impl Heard {
    /// Creates an instance that writes to this log.
    pub(crate) fn instance(
        &self,
        mechanism: Arc<Mechanism>,
        interface: Interface,
        logging_on: bool,
    ) -> Instance {
        let model = MechanismModel::new(mechanism, interface).expect("the mechanism assembles");
        Instance::new(model, Box::new(self.clone()), logging_on)
    }

    /// Creates an instance of a version of FMI that writes all its messages to this log.
    pub(crate) fn instance_of(
        &self,
        version: Version,
        mechanism: Arc<Mechanism>,
        interface: Interface,
    ) -> Instance {
        let model = MechanismModel::new(mechanism, interface).expect("the mechanism assembles");
        Instance::of_version(version, model, Box::new(self.clone()), true)
    }

    /// Returns the messages of a category since the last call, and forgets all others.
    pub(crate) fn take(&self, wanted: Category) -> Vec<String> {
        let heard = self.take_all().into_iter();
        heard
            .filter(|message| message.category == wanted)
            .map(|message| message.text)
            .collect()
    }

    pub(crate) fn take_all(&self) -> Vec<Message> {
        std::mem::take(&mut self.0.lock().expect("no test panics with it"))
    }
}

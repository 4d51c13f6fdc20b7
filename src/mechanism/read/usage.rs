//! Warnings of parts without effect.

use crate::mechanism::diagnostic::code;
use crate::mechanism::wording::quoted;
use crate::mechanism::{MarkerId, Mechanism};

use super::context::Context;
use super::kind::Entry;

impl<'a> Context<'a> {
    /// Warns of parameters that nothing uses and of bodies that nothing holds.
    pub(super) fn warn_of_unused(
        &mut self,
        mechanism: &Mechanism,
        parameters: &[Entry<'a>],
        bodies: &[Entry<'a>],
    ) {
        let used = std::mem::take(&mut self.parameters_used);
        for (entry, _) in parameters.iter().zip(used).filter(|(_, used)| !used) {
            let message = format!("nothing uses the parameter {}", quoted(entry.name()));
            self.warn(code::UNUSED_PARAMETER, entry.key.span(), message);
        }
        let mut held = vec![false; mechanism.bodies.len()];
        let mut hold = |markers: &[MarkerId]| {
            for marker in markers {
                if let Some(body) = mechanism.markers[marker.index()].body {
                    held[body.index()] = true;
                }
            }
        };
        for joint in &mechanism.joints {
            joint.markers().for_each(|marker| hold(&[marker]));
        }
        let constraints = mechanism.constraints.iter().map(|c| c.coordinate);
        let drivers = mechanism.drivers.iter().map(|d| d.coordinate);
        for coordinate in constraints.chain(drivers) {
            hold(&coordinate.markers());
        }
        for (entry, _) in bodies.iter().zip(held).filter(|(_, held)| !held) {
            let name = quoted(entry.name());
            let message = format!("no joint, constraint or driver holds the body {name}");
            self.warn(code::FLOATING_BODY, entry.key.span(), message);
        }
    }

    /// Warns of inputs that nothing uses.
    pub(super) fn warn_of_unused_inputs(&mut self, inputs: &[Entry<'a>]) {
        let used = std::mem::take(&mut self.inputs_used);
        for (entry, _) in inputs.iter().zip(used).filter(|(_, used)| !used) {
            let message = format!("nothing uses the input {}", quoted(entry.name()));
            self.warn(code::UNUSED_INPUT, entry.key.span(), message);
        }
    }

    /// Warns of functions that nothing calls.
    pub(super) fn warn_of_uncalled(&mut self, functions: &[Entry<'a>]) {
        let used = std::mem::take(&mut self.functions_used);
        for (entry, _) in functions.iter().zip(used).filter(|(_, used)| !used) {
            let message = format!("nothing calls the function {}", quoted(entry.name()));
            self.warn(code::UNUSED_FUNCTION, entry.key.span(), message);
        }
    }
}

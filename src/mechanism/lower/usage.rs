//! Warnings of what is there without effect.

use crate::mechanism::diagnostic::code;
use crate::mechanism::names::quoted;
use crate::mechanism::{Diagnostic, MarkerId, Mechanism};

use super::context::Context;
use super::names::Sections;

impl<'a> Context<'a> {
    /// Warns of parameters that nothing uses and of bodies that nothing holds.
    pub(super) fn warn_of_unused(&mut self, mechanism: &Mechanism, sections: &Sections<'a>) {
        for (entry, used) in sections.parameters.iter().zip(&self.parameters_used) {
            if !used {
                let message = format!("nothing uses the parameter {}", quoted(entry.name()));
                let warning = Diagnostic::warning(code::UNUSED_PARAMETER, message);
                self.problems.push(warning.label(entry.key.span(), ""));
            }
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
            hold(&[joint.from, joint.to]);
        }
        let constraints = mechanism.constraints.iter().map(|c| c.coordinate);
        let drivers = mechanism.drivers.iter().map(|d| d.coordinate);
        for coordinate in constraints.chain(drivers) {
            hold(&[coordinate.from, coordinate.to, coordinate.axes]);
        }
        for (entry, held) in sections.bodies.iter().zip(held) {
            if !held {
                let name = quoted(entry.name());
                let message = format!("no joint, constraint or driver holds the body {name}");
                let warning = Diagnostic::warning(code::FLOATING_BODY, message);
                self.problems.push(warning.label(entry.key.span(), ""));
            }
        }
    }
}

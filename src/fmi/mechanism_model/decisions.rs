//! Decisions of an export by numbers. Another processor might decide otherwise, and value references
//! would shift: the FMU carries them.

use std::fs;
use std::io;
use std::path::Path;
use std::sync::Arc;

use crate::dynamics::keeps_coordinates;
use crate::fmi::error::Failure;
use crate::kinematics::{Origin, omitted_reactions};
use crate::mechanism::Mechanism;

/// Name of the mechanism's file in `resources/`.
pub const RESOURCE: &str = "mechanism.toml";

/// Name of the file in `resources/` that lists the joints and constraints whose reactions are no
/// variables, one name per line.
pub(super) const OMITTED_REACTIONS: &str = "omitted_reactions.txt";

/// Name of the file in `resources/` that lists the freedoms whose values and velocities are not the
/// states, one name per line.
pub(super) const LOCAL_STATES: &str = "local_states.txt";

/// The decisions of an export.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Decisions {
    /// Joints and constraints whose reactions are no variables.
    pub(super) omitted: Vec<Origin>,
    /// Whether the states are those of coordinates that change, and no outputs.
    pub(super) has_local_states: bool,
}

impl Decisions {
    /// Decides for a mechanism.
    pub(super) fn of(mechanism: &Arc<Mechanism>) -> Self {
        let is_free = mechanism.has_freedoms();
        Self {
            omitted: omitted_reactions(mechanism),
            has_local_states: is_free && !keeps_coordinates(mechanism),
        }
    }

    /// Reads the decisions from the folder of resources.
    pub(super) fn read(resources: &Path, mechanism: &Mechanism) -> Result<Self, Failure> {
        let joints = (0..mechanism.joints.len()).map(Origin::Joint);
        let constraints = (0..mechanism.constraints.len()).map(Origin::Constraint);
        let origins: Vec<_> = joints.chain(constraints).collect();
        let omitted = read_names(
            resources,
            OMITTED_REACTIONS,
            "joint or constraint",
            |name| {
                let mut origins = origins.iter();
                let found = origins.find(|origin| origin.name(mechanism) == name);
                found.copied()
            },
        )?;
        let freedoms = read_names(resources, LOCAL_STATES, "freedom", |name| {
            let mut drivers = mechanism.drivers.iter();
            drivers.find(|driver| driver.is_free() && driver.name == name)
        })?;
        Ok(Self {
            omitted,
            has_local_states: !freedoms.is_empty(),
        })
    }

    /// Returns the files in `resources/` that carry the decisions.
    pub(super) fn files(&self, mechanism: &Mechanism) -> Vec<(&'static str, String)> {
        let lines = |names: &[&str]| names.iter().map(|name| format!("{name}\n")).collect();
        let mut files = Vec::new();
        if !self.omitted.is_empty() {
            let omitted: Vec<_> = self.omitted.iter().map(|o| o.name(mechanism)).collect();
            files.push((OMITTED_REACTIONS, lines(&omitted)));
        }
        if self.has_local_states {
            let freedoms = mechanism.drivers.iter().filter(|driver| driver.is_free());
            let freedoms: Vec<_> = freedoms.map(|driver| &*driver.name).collect();
            files.push((LOCAL_STATES, lines(&freedoms)));
        }
        files
    }

    /// Returns the decisions as a part of the GUID.
    pub(super) fn canonical(&self, mechanism: &Mechanism) -> String {
        let omitted = self.omitted.iter();
        let mut content: String = omitted
            .map(|origin| format!("\nwithout {}", origin.name(mechanism)))
            .collect();
        if self.has_local_states {
            content += "\nlocal states";
        }
        content
    }
}

/// Reads the names in a file of the resources, one per line; none if there is no such file.
fn read_names<T>(
    resources: &Path,
    file: &str,
    kind: &str,
    find: impl Fn(&str) -> Option<T>,
) -> Result<Vec<T>, Failure> {
    let path = resources.join(file);
    let text = match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => {
            let path = path.display();
            return Err(Failure::Failed(format!("cannot read `{path}`: {error}")));
        }
    };
    let found = text.lines().map(|name| {
        find(name).ok_or_else(|| {
            Failure::Failed(format!(
                "`{file}` names `{name}`, which is no {kind} of `{RESOURCE}`: the resources do not \
                 belong together"
            ))
        })
    });
    found.collect()
}

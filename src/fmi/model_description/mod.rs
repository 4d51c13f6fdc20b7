//! `modelDescription.xml`: its content, and its writer for both versions of the standard.
//!
//! | file | subject |
//! |---|---|
//! | `xml` | helpers of the writers |
//! | `writer` | the elements of the file |
//! | `terminals` | terminals and icon |

pub(super) mod terminals;
mod writer;
mod xml;

use std::collections::BTreeMap;

pub use terminals::{Member, Terminal};

use super::state::Version;
use super::variable::Variable;

/// Content of `modelDescription.xml`.
#[derive(Clone, Debug)]
pub struct ModelDescription<'a, Q> {
    /// Version of the standard that the file follows.
    pub standard: Version,
    /// FMI modelName and modelIdentifier: a C identifier.
    pub name: &'a str,
    /// One line for people; may be empty.
    pub description: &'a str,
    /// Author of the model.
    pub author: Option<&'a str>,
    /// Version of the model.
    pub version: Option<&'a str>,
    /// Copyright notice of the model.
    pub copyright: Option<&'a str>,
    /// License of the model.
    pub license: Option<&'a str>,
    /// GUID, in FMI 3.0 the instantiation token, which the resources must have too.
    pub guid: String,
    /// Default experiment.
    pub experiment: Experiment,
    /// Capabilities of the model.
    pub capabilities: Capabilities,
    /// Variables in the order of their value references.
    pub variables: Vec<Variable<Q>>,
    /// All outputs.
    pub outputs: Vec<Unknown>,
    /// The derivatives of the continuous states, in the order of the states.
    pub derivatives: Vec<Unknown>,
    /// All outputs, but states, and calculated parameters.
    pub initial_unknowns: Vec<Unknown>,
    /// The event indicators.
    pub event_indicators: Vec<Unknown>,
    /// Groups of variables that are connected together.
    pub terminals: Vec<Terminal>,
}

/// A file in the archive that documents the FMU.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Document {
    /// Path in the archive: `model.png`, `documentation/index.html`.
    pub path: String,
    /// Content of the file.
    pub content: Vec<u8>,
}

/// The default experiment \[s, s, s, 1\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Experiment {
    /// Start time.
    pub start: f64,
    /// Stop time.
    pub stop: f64,
    /// Communication step size.
    pub step: f64,
    /// Relative tolerance of the host's solver.
    pub tolerance: f64,
}

/// Optional capabilities of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities {
    /// Whether input derivatives have an effect.
    pub interpolates_inputs: bool,
    /// Highest order of output derivatives.
    pub output_derivatives: i32,
    /// Whether the model provides directional derivatives.
    pub directional_derivatives: bool,
    /// Whether the model takes steps in parts.
    pub intermediate_update: bool,
}

/// A computed variable and its dependencies, by value reference.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// Value reference of the variable.
    pub value_reference: u32,
    /// Kinds of dependency on other variables.
    pub dependencies: BTreeMap<u32, DependencyKind>,
    /// Kinds of dependency on parameters after initialization, which FMI 3.0 counts among the
    /// dependencies of an output (2.4.8).
    pub parameters: BTreeMap<u32, DependencyKind>,
}

/// Kind of a dependency (FMI 2.0, 2.2.8).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DependencyKind {
    /// Without a particular structure.
    Dependent,
    /// With a constant factor.
    Constant,
}

impl DependencyKind {
    /// Returns the kind's name in the model description.
    fn name(self) -> &'static str {
        match self {
            Self::Dependent => "dependent",
            Self::Constant => "constant",
        }
    }
}

impl<Q> ModelDescription<'_, Q> {
    /// Returns the file's content.
    ///
    /// `generated` is the attribute `generationDateAndTime`. Without it the same model gives the
    /// same bytes.
    #[must_use]
    pub fn write(&self, generated: Option<&str>) -> Vec<u8> {
        xml::document(|xml| writer::write(xml, self, generated))
    }
}

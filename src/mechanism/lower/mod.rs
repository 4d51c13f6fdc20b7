//! Document to mechanism, collecting every problem on the way.
//!
//! First all names are declared, then the parameters get their values, then everything else is
//! read. What could not be read has left its error, and nothing that refers to it adds another.

mod bodies;
mod cams;
mod context;
mod coordinates;
mod header;
mod joints;
mod motions;
mod names;
mod parameters;
#[cfg(feature = "cli")]
mod schema;
mod settings;
mod tables;
mod usage;
mod wheels;

#[cfg(test)]
mod tests;

use context::Context;

pub use header::is_identifier;
#[cfg(feature = "cli")]
pub use schema::schema;

use super::{Diagnostic, Mechanism, Source, syntax};

impl Mechanism {
    /// Reads a mechanism file; with the mechanism come the warnings.
    ///
    /// # Errors
    ///
    /// All errors and warnings, in the order of the file; after a syntax error only that.
    ///
    /// # Example
    ///
    /// ```
    /// use biela::mechanism::{Mechanism, Source};
    ///
    /// let source = Source::new("pendulum.toml", r#"
    ///     format = 1
    ///     name = "pendulum"
    ///     ground.markers = { O = [0, 0] }
    ///     bodies.rod.markers = { O = ["-0.5*length", 0] }
    ///     parameters.length = 0.8
    ///     joints.O = { type = "revolute", markers = ["ground.O", "rod.O"] }
    ///     drivers.swing = { coordinate = "angle", markers = ["ground.O", "rodd.O"], start = 0 }
    /// "#);
    /// let problems = Mechanism::parse(&source).unwrap_err();
    /// assert_eq!(
    ///     problems[0].one_line(&source),
    ///     "pendulum.toml:8:69: error: no body `rodd`; did you mean `rod`?"
    /// );
    /// ```
    pub fn parse(source: &Source) -> Result<(Self, Vec<Diagnostic>), Vec<Diagnostic>> {
        let (document, duplicates) = syntax::parse(source).map_err(|error| vec![error])?;
        let mut context = Context::new(source, duplicates);
        let mechanism = context.lower(&document);
        let failed = context.problems.has_errors();
        let problems = context.problems.into_diagnostics();
        match mechanism {
            Some(mechanism) if !failed => Ok((mechanism, problems)),
            _ => Err(problems),
        }
    }
}

impl<'a> Context<'a> {
    /// The mechanism, or `None` after an error; an error may also leave a mechanism with something
    /// missing.
    fn lower(&mut self, document: &'a syntax::Table<'a>) -> Option<Mechanism> {
        let root = self.root(document);
        let header = self.lower_header(&root);
        let sections = self.declare(&root);
        let (parameters, derivation_order) = self.lower_parameters(&sections.parameters);
        let simulation = self.lower_simulation(&root);
        let markers = self.lower_markers(&sections);
        let bodies = self.lower_bodies(&sections.bodies);
        let joints = self.lower_joints(&sections.joints);
        let constraints = self.lower_constraints(&sections.constraints);
        let drivers = self.lower_drivers(&sections.drivers, simulation.start);
        let measures = self.lower_measures(&sections.measures);
        let outputs = self.lower_outputs(&root);
        let mechanism = Mechanism {
            name: header.name?,
            description: header.description,
            author: header.author,
            version: header.version,
            license: header.license,
            copyright: header.copyright,
            parameters,
            derivation_order,
            bodies,
            markers,
            joints,
            constraints,
            drivers,
            measures,
            outputs,
            simulation,
            canonical: syntax::canonical(document) + &self.file_tables,
            table_files: std::mem::take(&mut self.table_files),
        };
        if !self.problems.has_errors() {
            self.warn_of_unused(&mechanism, &sections);
        }
        Some(mechanism)
    }
}

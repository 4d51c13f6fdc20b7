//! The mechanism inside an FMU.

use std::io::{Seek, Write};
use std::path::Path;

use super::describe;
use crate::fmi::error::Failure;
use crate::fmi::model_description::Document;
use crate::fmi::package::{self, PackageError, RuntimeLibrary};
use crate::fmi::state::Version;
use crate::kinematics::Structure;
use crate::mechanism::{Diagnostic, Mechanism, Severity, Source};

/// Name of the mechanism's file in `resources/`.
pub const RESOURCE: &str = "mechanism.toml";

/// Reads the mechanism from the folder of resources.
pub(super) fn read(resources: &Path) -> Result<Mechanism, Failure> {
    let path = resources.join(RESOURCE);
    let source = Source::open(RESOURCE, &path).map_err(|error| {
        let path = path.display();
        Failure::Failed(format!("cannot read the mechanism `{path}`: {error}"))
    })?;
    let parsed = Mechanism::parse(&source);
    parsed
        .map(|(mechanism, _)| mechanism)
        .map_err(|diagnostics| {
            let errors: Vec<_> = diagnostics
                .iter()
                .filter(|diagnostic| diagnostic.severity == Severity::Error)
                .map(|diagnostic: &Diagnostic| diagnostic.one_line(&source))
                .collect();
            Failure::Failed(errors.join("; "))
        })
}

/// Writes the FMU of a mechanism for a version of the standard: its file, its model description, runtime libraries and
/// documents. The same input gives the same bytes.
///
/// # Errors
///
/// `out` cannot be written.
#[expect(
    clippy::too_many_arguments,
    reason = "the parts of an archive, which have no common owner"
)]
pub fn write_fmu(
    out: impl Write + Seek,
    source: &Source,
    mechanism: &Mechanism,
    structure: &Structure,
    version: Version,
    libraries: &[RuntimeLibrary],
    documents: &[Document],
    generated: Option<&str>,
) -> Result<(), PackageError> {
    let mut resources = vec![(RESOURCE, source.text().as_bytes())];
    for file in &mechanism.table_files {
        resources.push((file.name.as_str(), file.text.as_bytes()));
    }
    package::write(
        out,
        &describe(mechanism, structure, version),
        libraries,
        &resources,
        documents,
        generated,
    )
}

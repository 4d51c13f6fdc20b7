//! The mechanism inside an FMU.

use std::io::{self, Seek, Write};
use std::path::Path;

use super::variables::Quantity;
use crate::fmi::error::Failure;
use crate::fmi::model_description::{Document, ModelDescription};
use crate::fmi::package::{self, RuntimeLibrary};
use crate::mechanism::{Mechanism, Severity, Source};

/// Name of the mechanism's file in `resources/`.
pub const RESOURCE: &str = "mechanism.toml";

/// Reads the mechanism from the folder of resources.
pub(super) fn read(resources: &Path) -> Result<Mechanism, Failure> {
    let path = resources.join(RESOURCE);
    let source = Source::open(RESOURCE, &path).map_err(|error| {
        let path = path.display();
        Failure::Failed(format!("cannot read the mechanism `{path}`: {error}"))
    })?;
    match Mechanism::parse(&source) {
        Ok((mechanism, _)) => Ok(mechanism),
        Err(diagnostics) => {
            let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error);
            let errors: Vec<_> = errors.map(|d| d.one_line(&source)).collect();
            Err(Failure::Failed(errors.join("; ")))
        }
    }
}

/// Writes the FMU of a mechanism: its file, its model description, runtime libraries and documents.
/// The same input gives the same bytes.
///
/// # Errors
///
/// `out` cannot be written.
pub fn write_fmu(
    out: impl Write + Seek,
    source: &Source,
    mechanism: &Mechanism,
    description: &ModelDescription<'_, Quantity>,
    libraries: &[RuntimeLibrary],
    documents: &[Document],
    generated: Option<&str>,
) -> io::Result<()> {
    let mut resources = vec![(RESOURCE, source.text().as_bytes())];
    for file in &mechanism.table_files {
        resources.push((file.name.as_str(), file.text.as_bytes()));
    }
    package::write(
        out,
        description,
        libraries,
        &resources,
        documents,
        generated,
    )
}

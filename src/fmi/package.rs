//! The `.fmu` archive (FMI 2.0, 2.3).

use std::io::{Seek, Write};
use std::path::PathBuf;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::model_description::ModelDescription;

/// A platform by the standard's name of its folder in `binaries/`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Platform {
    /// `linux64`, `win64`, …
    pub name: &'static str,
    /// Extension of its shared libraries.
    pub extension: &'static str,
}

impl Platform {
    /// Platforms of the runtime library. `aarch64-linux` is a name of FMI 3.0, which FMI 2.0
    /// refers to (2.3).
    pub const ALL: [Self; 4] = [
        Self::new("linux64", "so"),
        Self::new("win64", "dll"),
        Self::new("darwin64", "dylib"),
        Self::new("aarch64-linux", "so"),
    ];

    const fn new(name: &'static str, extension: &'static str) -> Self {
        Self { name, extension }
    }

    /// Returns the platform that this program runs on.
    #[must_use]
    pub fn current() -> Option<Self> {
        let name = match (std::env::consts::OS, std::env::consts::ARCH) {
            ("linux", "x86_64") => "linux64",
            ("linux", "aarch64") => "aarch64-linux",
            ("windows", "x86_64") => "win64",
            ("macos", _) => "darwin64",
            _ => return None,
        };
        Self::ALL.into_iter().find(|platform| platform.name == name)
    }
}

/// A runtime library: this crate built as a shared library.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RuntimeLibrary {
    /// Platform of the library.
    pub platform: Platform,
    /// Path of the file.
    pub path: PathBuf,
}

/// The archive could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackageError {
    /// A runtime library cannot be read.
    #[error("cannot read the runtime library `{}`: {source}", path.display())]
    Library {
        /// Path of the library.
        path: PathBuf,
        /// Reason from the system.
        source: std::io::Error,
    },
    /// The archive cannot be written.
    #[error("cannot write the archive: {0}")]
    Archive(#[from] zip::result::ZipError),
    /// The archive's content cannot be written.
    #[error("cannot write the archive: {0}")]
    Write(#[from] std::io::Error),
}

/// A file in the archive that documents the FMU.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Document {
    /// Path in the archive: `model.png`, `documentation/index.html`.
    pub path: String,
    /// Content of the file.
    pub content: Vec<u8>,
}

/// Writes an FMU: model description, documents, runtime libraries and resources, each resource
/// with its name in `resources/`.
///
/// The same input gives the same bytes: entries have a fixed order and a fixed date.
///
/// # Errors
///
/// A library cannot be read, or `out` cannot be written.
pub fn write<Q>(
    out: impl Write + Seek,
    description: &ModelDescription<'_, Q>,
    libraries: &[RuntimeLibrary],
    resources: &[(&str, &[u8])],
    documents: &[Document],
    generated: Option<&str>,
) -> Result<(), PackageError> {
    let mut zip = ZipWriter::new(out);
    let text = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    let binary = text.unix_permissions(0o755);

    zip.start_file("modelDescription.xml", text)?;
    zip.write_all(&description.write(generated))?;
    for Document { path, content } in documents {
        zip.start_file(path.as_str(), text)?;
        zip.write_all(content)?;
    }
    let mut libraries = libraries.to_vec();
    libraries.sort();
    for RuntimeLibrary { platform, path } in libraries {
        let content = std::fs::read(&path).map_err(|source| PackageError::Library {
            path: path.clone(),
            source,
        })?;
        let name = format!(
            "binaries/{}/{}.{}",
            platform.name, description.name, platform.extension
        );
        zip.start_file(name, binary)?;
        zip.write_all(&content)?;
    }
    for (name, content) in resources {
        zip.start_file(format!("resources/{name}"), text)?;
        zip.write_all(content)?;
    }
    zip.finish()?;
    Ok(())
}

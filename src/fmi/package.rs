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
    /// The platforms that a runtime library may be built for. `aarch64-linux` has no folder in
    /// FMI 2.0; hosts there look into one of this name.
    pub const ALL: [Self; 4] = [
        Self::new("linux64", "so"),
        Self::new("win64", "dll"),
        Self::new("darwin64", "dylib"),
        Self::new("aarch64-linux", "so"),
    ];

    const fn new(name: &'static str, extension: &'static str) -> Self {
        Self { name, extension }
    }

    /// The platform this program was built for.
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
    /// The platform it was built for.
    pub platform: Platform,
    /// Where it is.
    pub path: PathBuf,
}

/// An archive that could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackageError {
    /// A runtime library cannot be read.
    #[error("cannot read the runtime library `{}`: {source}", path.display())]
    Library {
        /// The library.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The archive itself.
    #[error("cannot write the archive: {0}")]
    Archive(#[from] zip::result::ZipError),
    /// Its content.
    #[error("cannot write the archive: {0}")]
    Write(#[from] std::io::Error),
}

/// A file for people that goes into the archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Document {
    /// Where in the archive: `model.png`, `documentation/index.html`.
    pub path: String,
    /// Its content.
    pub content: Vec<u8>,
}

/// Writes an FMU: its model description, what documents it, the runtime libraries and its
/// resources, each with its name in `resources/`.
///
/// The same input gives the same bytes: entries have a fixed order and a fixed time.
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

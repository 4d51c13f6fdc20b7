//! The `.fmu` archive (FMI 2.0, 2.3; FMI 3.0, 2.5).

use std::borrow::Cow;
use std::io::{self, Seek, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

use super::model_description::{Document, ModelDescription, terminals};
use super::state::Version;

/// A platform that FMUs run on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Platform {
    /// Name of its folder in `binaries/` of FMI 2.0: one of the names of FMI 2.0, or else the
    /// platform tuple of FMI 3.0, as FMI 2.0.4 has it (section 2.3).
    pub name: &'static str,
    /// Name of its folder in `binaries/` of FMI 3.0: the platform tuple (2.5.1.4.1).
    pub tuple: &'static str,
    /// Extension of its shared libraries.
    pub extension: &'static str,
    /// Name of the system for people.
    pub system: &'static str,
}

impl Platform {
    /// All platforms that runtime libraries are built for. FMI 2.0 reserves `darwin64` for x86-64,
    /// but hosts on Apple silicon open it too: the library there serves both processors.
    pub const ALL: [Self; 5] = [
        Self::new("linux64", "x86_64-linux", "so", "Linux, x86-64"),
        Self::new("win64", "x86_64-windows", "dll", "Windows, x86-64"),
        Self::new(
            "darwin64",
            "x86_64-darwin",
            "dylib",
            "macOS, x86-64 and Apple silicon",
        ),
        Self::new("aarch64-linux", "aarch64-linux", "so", "Linux, ARM 64-bit"),
        Self::new(
            "aarch64-darwin",
            "aarch64-darwin",
            "dylib",
            "macOS, Apple silicon",
        ),
    ];

    const fn new(
        name: &'static str,
        tuple: &'static str,
        extension: &'static str,
        system: &'static str,
    ) -> Self {
        Self {
            name,
            tuple,
            extension,
            system,
        }
    }

    /// Returns the name of its folder in `binaries/`.
    #[must_use]
    pub fn folder(&self, version: Version) -> &'static str {
        match version {
            Version::Fmi2 => self.name,
            Version::Fmi3 => self.tuple,
        }
    }

    /// Returns the platform of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|platform| platform.name == name)
    }

    /// Returns the platform that this program was built for.
    #[must_use]
    pub fn current() -> Option<Self> {
        Self::named(match (std::env::consts::OS, std::env::consts::ARCH) {
            ("linux", "x86_64") => "linux64",
            ("linux", "aarch64") => "aarch64-linux",
            ("windows", "x86_64") => "win64",
            ("macos", _) => "darwin64",
            _ => return None,
        })
    }
}

/// Text in each runtime library that tells its version: a part of a message, which no linker leaves
/// out.
pub(super) const LIBRARY_MARK: &str = concat!("(biela runtime ", env!("CARGO_PKG_VERSION"), ")");

/// A runtime library: this crate built as a shared library.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RuntimeLibrary {
    /// Platform of the library.
    pub platform: Platform,
    /// Content of the file.
    pub content: Cow<'static, [u8]>,
}

impl RuntimeLibrary {
    /// Returns whether the library is of this version of biela.
    #[must_use]
    pub fn is_current(&self) -> bool {
        let mark = LIBRARY_MARK.as_bytes();
        self.content.windows(mark.len()).any(|text| text == mark)
    }
}

/// Writes an FMU: model description, terminals and icon if there are any, documents, runtime libraries
/// and resources, each resource with its name in `resources/`.
///
/// The same input gives the same bytes: entries have a fixed order and a fixed date.
///
/// # Errors
///
/// `out` cannot be written.
pub fn write<Q>(
    out: impl Write + Seek,
    description: &ModelDescription<'_, Q>,
    libraries: &[RuntimeLibrary],
    resources: &[(&str, &[u8])],
    documents: &[Document],
    generated: Option<&str>,
) -> io::Result<()> {
    let mut zip = ZipWriter::new(out);
    let text = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        // Otherwise each entry names the system on which the FMU is written.
        .system(System::Unix)
        .unix_permissions(0o644);
    let binary = text.unix_permissions(0o755);

    zip.start_file("modelDescription.xml", text)?;
    zip.write_all(&description.write(generated))?;
    if let Some(file) = terminals::write(&description.terminals, documents) {
        zip.start_file(terminals::PATH, text)?;
        zip.write_all(&file)?;
    }
    for Document { path, content } in documents {
        zip.start_file(path.as_str(), text)?;
        zip.write_all(content)?;
    }
    let mut libraries: Vec<&RuntimeLibrary> = libraries.iter().collect();
    libraries.sort();
    for RuntimeLibrary { platform, content } in libraries {
        let folder = platform.folder(description.standard);
        let name = format!(
            "binaries/{folder}/{}.{}",
            description.name, platform.extension
        );
        zip.start_file(name, binary)?;
        zip.write_all(content)?;
    }
    for (name, content) in resources {
        zip.start_file(format!("resources/{name}"), text)?;
        zip.write_all(content)?;
    }
    zip.finish()?;
    Ok(())
}

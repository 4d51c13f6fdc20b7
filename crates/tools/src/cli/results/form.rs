//! The form in which an FMU is packed.

use biela::fmi::Version;

/// Form of an FMU.
#[derive(Clone, Copy)]
pub(in crate::cli) struct Form {
    /// Version of FMI.
    pub(in crate::cli) version: Version,
    /// Whether it has terminals and an icon.
    pub(in crate::cli) terminals: bool,
}

impl Form {
    /// Returns the form for a version of FMI; FMI 3.0 has terminals, FMI 2.0 if they are wanted:
    /// hosts with FMI Library report a fatal error of FMI 2.0 for each archive that has them.
    pub(in crate::cli) fn new(version: Version, terminals: bool) -> Self {
        let terminals = terminals || version == Version::Fmi3;
        Self { version, terminals }
    }
}

//! The name of a unit, a short text.

use std::fmt;
use std::ops::Deref;

/// Length of the longest name \[bytes\].
pub(super) const LONGEST: usize = 31;

/// The name of a unit, as it is written. It is copied as a number is: units are parts of many lists, and
/// files name units of their own.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct UnitName {
    bytes: [u8; LONGEST],
    length: u8,
}

impl UnitName {
    /// Makes a name of a text, which is no longer than [`LONGEST`].
    pub(super) const fn new(text: &str) -> Self {
        let mut bytes = [0; LONGEST];
        let (own, _) = bytes.split_at_mut(text.len());
        own.copy_from_slice(text.as_bytes());
        Self {
            bytes,
            length: text.len() as u8,
        }
    }

    /// Returns the text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let own = &self.bytes[..usize::from(self.length)];
        std::str::from_utf8(own).expect("it was made of a text")
    }
}

impl Deref for UnitName {
    type Target = str;

    fn deref(&self) -> &str {
        self.as_str()
    }
}

impl fmt::Display for UnitName {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_str().fmt(out)
    }
}

impl fmt::Debug for UnitName {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), out)
    }
}

impl PartialEq<str> for UnitName {
    fn eq(&self, other: &str) -> bool {
        self.as_str() == other
    }
}

impl PartialEq<&str> for UnitName {
    fn eq(&self, other: &&str) -> bool {
        self.as_str() == *other
    }
}

//! Encoding of files: UTF-8, and what to report of others.

use std::fmt::{self, Display, Formatter};
use std::ops::Range;

/// Fault of bytes that are not UTF-8; displayed as the predicate of "the file".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NotUtf8 {
    /// A byte that begins no character, or begins one that is incomplete.
    Byte {
        offset: usize,
        /// From 1.
        line: usize,
        byte: u8,
    },
    /// The byte order mark of UTF-16.
    Utf16,
    /// The start of a ZIP archive.
    Zip,
}

impl NotUtf8 {
    /// Returns the place of the fault in the text of [`decode`].
    pub(super) fn span(self) -> Range<usize> {
        match self {
            Self::Byte { offset, .. } => offset..offset + char::REPLACEMENT_CHARACTER.len_utf8(),
            Self::Utf16 | Self::Zip => 0..0,
        }
    }
}

impl Display for NotUtf8 {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Byte { line, byte, .. } => write!(
                f,
                "is not UTF-8: on line {line} the byte 0x{byte:02X} begins no character of it"
            ),
            Self::Utf16 => write!(f, "is UTF-16, not UTF-8"),
            Self::Zip => write!(f, "is a ZIP archive, not text"),
        }
    }
}

impl NotUtf8 {
    /// Returns help.
    pub(super) fn help(self) -> &'static str {
        match self {
            Self::Byte { .. } | Self::Utf16 => "save it as UTF-8",
            Self::Zip => "an FMU has its mechanism file in its folder `resources`",
        }
    }
}

/// Returns the text of a file. With a fault the text is readable enough to show the place.
pub(super) fn decode(bytes: Vec<u8>) -> (String, Option<NotUtf8>) {
    let unit = match bytes[..] {
        [0xFF, 0xFE, ..] => Some(u16::from_le_bytes as fn([u8; 2]) -> u16),
        [0xFE, 0xFF, ..] => Some(u16::from_be_bytes as fn([u8; 2]) -> u16),
        _ => None,
    };
    if let Some(unit) = unit {
        let units = bytes[2..].chunks_exact(2);
        let units: Vec<u16> = units.map(|pair| unit([pair[0], pair[1]])).collect();
        return (String::from_utf16_lossy(&units), Some(NotUtf8::Utf16));
    }
    if bytes.starts_with(b"PK\x03\x04") {
        return (String::new(), Some(NotUtf8::Zip));
    }
    String::from_utf8(bytes).map_or_else(
        |error| {
            let (offset, bytes) = (error.utf8_error().valid_up_to(), error.as_bytes());
            let breaks = bytes[..offset].iter().filter(|byte| **byte == b'\n');
            let fault = NotUtf8::Byte {
                offset,
                line: breaks.count() + 1,
                byte: bytes[offset],
            };
            (String::from_utf8_lossy(bytes).into_owned(), Some(fault))
        },
        |text| (text, None),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utf_8_is_taken_as_it_is() {
        for text in ["", "a = 1\n", "\u{feff}a = 'á'", "\u{fffd}"] {
            assert_eq!(decode(text.into()), (text.to_owned(), None));
        }
    }

    #[test]
    fn the_first_wrong_byte_is_named_with_its_line() {
        // Latin-1; a character that ends with the file, one that is broken off, a stray end.
        for (bytes, text, offset, line, byte) in [
            (
                &b"a\n\nb\xe9 c\xff"[..],
                "a\n\nb\u{fffd} c\u{fffd}",
                4,
                3,
                0xe9,
            ),
            (b"a\xe2\x82", "a\u{fffd}", 1, 1, 0xe2),
            (b"\xe2\x82b", "\u{fffd}b", 0, 1, 0xe2),
            (b"\xc3\xa1\n\x80", "á\n\u{fffd}", 3, 2, 0x80),
        ] {
            let (found, fault) = decode(bytes.to_vec());
            assert_eq!(found, text);
            assert_eq!(fault, Some(NotUtf8::Byte { offset, line, byte }));
            assert_eq!(fault.map(|fault| &found[fault.span()]), Some("\u{fffd}"));
        }
    }

    #[test]
    fn utf_16_is_told_by_its_mark() {
        for bytes in [
            &b"\xff\xfea\0\xe1\0"[..],
            b"\xfe\xff\0a\0\xe1",
            b"\xff\xfea\0\xe1\0\0",
        ] {
            assert_eq!(
                decode(bytes.to_vec()),
                ("aá".to_owned(), Some(NotUtf8::Utf16))
            );
        }
        assert_eq!(
            decode(b"\xff\xfe".to_vec()),
            (String::new(), Some(NotUtf8::Utf16))
        );
    }
}

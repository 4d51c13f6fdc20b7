//! The envelope of a serialized FMU state, by which foreign, truncated and altered bytes are
//! told.
//!
//! | bytes | |
//! |---|---|
//! | 8 | what all begin with |
//! | 4 | version of all that follows |
//! | 8 | length of the whole |
//! | 4 | length of the FMU's GUID |
//! | … | that GUID |
//! | … | the state |
//! | 4 | CRC-32 of all before |

use super::codec::{Reader, Unreadable, Writer};
use super::error::StateError;

/// Not text, so that a file of them is not taken for any.
const BEGINNING: [u8; 8] = *b"\x8bbiela\x1a\n";

/// Raised whenever states are written in another way.
const VERSION: u32 = 2;

const CHECKSUM: usize = 4;
const SHORTEST: usize = BEGINNING.len() + 4 + 8 + 4 + CHECKSUM;

/// Puts the envelope round what `walk` writes.
pub(super) fn write(
    guid: &str,
    walk: impl FnOnce(&mut Writer<'_>) -> Result<(), Unreadable>,
) -> Vec<u8> {
    let mut bytes = BEGINNING.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    let length = bytes.len()..bytes.len() + 8;
    bytes.extend(0_u64.to_le_bytes());
    bytes.extend((guid.len() as u32).to_le_bytes());
    bytes.extend(guid.as_bytes());
    walk(&mut Writer(&mut bytes)).expect("writing to memory does not fail");
    let whole = (bytes.len() + CHECKSUM) as u64;
    bytes[length].copy_from_slice(&whole.to_le_bytes());
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

/// Takes the envelope off, and has `walk` read all that is in it.
///
/// # Errors
///
/// The bytes are not as [`write()`] wrote them for this GUID.
pub(super) fn read(
    guid: &str,
    bytes: &[u8],
    walk: impl FnOnce(&mut Reader<'_>) -> Result<(), Unreadable>,
) -> Result<(), StateError> {
    let foreign = StateError::Foreign {
        length: bytes.len(),
    };
    let Some(mut rest) = bytes.strip_prefix(&BEGINNING) else {
        return Err(foreign);
    };
    let mut number = |size: usize| {
        let (number, tail) = rest.split_at_checked(size)?;
        rest = tail;
        Some(
            number
                .iter()
                .rev()
                .fold(0, |sum, &byte| sum << 8 | u64::from(byte)),
        )
    };
    let (Some(version), Some(announced)) = (number(4), number(8)) else {
        return Err(foreign);
    };
    if version != u64::from(VERSION) {
        return Err(StateError::Version {
            given: version as u32,
            expected: VERSION,
        });
    }
    if announced != bytes.len() as u64 || bytes.len() < SHORTEST {
        return Err(StateError::Length {
            announced,
            given: bytes.len(),
        });
    }
    let (content, checksum) = bytes.split_at(bytes.len() - CHECKSUM);
    if crc32fast::hash(content).to_le_bytes() != checksum {
        return Err(StateError::Checksum);
    }
    let guid_length = number(4).and_then(|length| usize::try_from(length).ok());
    let content = &content[SHORTEST - CHECKSUM..];
    let parts = guid_length.and_then(|length| content.split_at_checked(length));
    let Some((given, state)) = parts else {
        return Err(StateError::Impossible {
            what: "its GUID is longer than itself".to_owned(),
        });
    };
    if given != guid.as_bytes() {
        return Err(StateError::Guid {
            given: String::from_utf8_lossy(given).into_owned(),
            expected: guid.to_owned(),
        });
    }
    let mut reader = Reader(state);
    match walk(&mut reader) {
        Ok(()) if reader.0.is_empty() => Ok(()),
        Ok(()) => Err(StateError::Impossible {
            what: format!("{} bytes too many", reader.0.len()),
        }),
        Err(Unreadable) => Err(StateError::Impossible {
            what: format!("a value {} bytes before its end", reader.0.len() + CHECKSUM),
        }),
    }
}

//! The envelope of a serialized FMU state. It detects foreign, truncated and altered bytes.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | signature |
//! | 4 | version of the format |
//! | 8 | total length |
//! | 4 | length of the FMU's GUID |
//! | … | the GUID |
//! | … | the state |
//! | 4 | CRC-32 of all preceding bytes |

use super::codec::{Codec as _, Reader, Unreadable, Writer};
use super::error::StateError;

/// First bytes of every serialized state. They are not valid UTF-8, so that no text file starts
/// with them.
const SIGNATURE: [u8; 8] = *b"\x8bbiela\x1a\n";

/// Version of the format, raised with every change of it.
const VERSION: u32 = 12;

/// Length of signature, version and total length.
const HEADER: usize = SIGNATURE.len() + 4 + 8;
const CHECKSUM: usize = 4;

/// Returns the bytes that `visit` writes, in their envelope.
pub(super) fn write(
    guid: &str,
    visit: impl FnOnce(&mut Writer<'_>) -> Result<(), Unreadable>,
) -> Vec<u8> {
    let mut bytes = SIGNATURE.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    let length = bytes.len()..bytes.len() + 8;
    bytes.extend(0_u64.to_le_bytes());
    bytes.extend((guid.len() as u32).to_le_bytes());
    bytes.extend(guid.as_bytes());
    visit(&mut Writer(&mut bytes)).expect("writing to memory does not fail");
    let whole = (bytes.len() + CHECKSUM) as u64;
    bytes[length].copy_from_slice(&whole.to_le_bytes());
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

/// Checks the envelope and lets `visit` read its content.
///
/// # Errors
///
/// The bytes differ from what [`write()`] wrote for this GUID.
pub(super) fn read(
    guid: &str,
    bytes: &[u8],
    visit: impl FnOnce(&mut Reader<'_>) -> Result<(), Unreadable>,
) -> Result<(), StateError> {
    let foreign = || StateError::Foreign {
        length: bytes.len(),
    };
    let mut header = Reader(bytes.strip_prefix(&SIGNATURE).ok_or_else(foreign)?);
    let version = header.bytes([0; 4]).map_err(|Unreadable| foreign())?;
    let announced = header.bytes([0; 8]).map_err(|Unreadable| foreign())?;
    let (version, announced) = (u32::from_le_bytes(version), u64::from_le_bytes(announced));
    if version != VERSION {
        return Err(StateError::Version {
            given: version,
            expected: VERSION,
        });
    }
    if announced != bytes.len() as u64 || bytes.len() < HEADER + CHECKSUM {
        return Err(StateError::Length {
            announced,
            given: bytes.len(),
        });
    }
    let (content, checksum) = bytes.split_at(bytes.len() - CHECKSUM);
    if crc32fast::hash(content).to_le_bytes() != checksum {
        return Err(StateError::Checksum);
    }
    let mut reader = Reader(&content[HEADER..]);
    let length = reader.bytes([0; 4]).map(u32::from_le_bytes);
    let parts = length.map(|length| reader.0.split_at_checked(length as usize));
    let Ok(Some((given, state))) = parts else {
        return Err(StateError::Impossible {
            why: "its GUID is longer than itself".to_owned(),
        });
    };
    if given != guid.as_bytes() {
        return Err(StateError::Guid {
            given: String::from_utf8_lossy(given).into_owned(),
            expected: guid.to_owned(),
        });
    }
    let mut reader = Reader(state);
    match visit(&mut reader) {
        Ok(()) if reader.0.is_empty() => Ok(()),
        Ok(()) => Err(StateError::Impossible {
            why: format!("it has {} bytes too many", reader.0.len()),
        }),
        Err(Unreadable) => Err(StateError::Impossible {
            why: format!(
                "a value {} bytes before its end is impossible",
                reader.0.len() + CHECKSUM
            ),
        }),
    }
}

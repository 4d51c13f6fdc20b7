//! JSON of pylinkage: a `Mechanism` with joints at positions and links through them.
//!
//! | file | subject |
//! |---|---|
//! | `read` | into a draft |
//! | `write` | from links through pins |

mod read;
mod write;

pub(super) use read::read;
pub use write::pylinkage_json;

//! `biela schema`

use std::path::PathBuf;

use clap::Args;

use super::error::Error;
use super::output::{STDOUT, write};
use crate::mechanism;

/// Print a JSON Schema (2020-12) of mechanism files, by which editors complete and check them.
///
/// In an editor with a TOML language server, a first line `#:schema biela.schema.json` in a
/// mechanism file turns it on.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela schema -o biela.schema.json")]
pub(super) struct Schema {
    /// The file to write [default: stdout].
    #[arg(
        short,
        long,
        value_name = "JSON",
        default_value = STDOUT,
        hide_default_value = true
    )]
    output: PathBuf,
}

impl Schema {
    pub(super) fn run(self) -> Result<(), Error> {
        let text = format!("{:#}\n", mechanism::schema());
        write(&self.output, text.as_bytes())
    }
}

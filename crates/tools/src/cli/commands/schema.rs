//! `biela schema`

use std::path::PathBuf;

use clap::Args;

use crate::cli::results::output::write;
use crate::cli::results::stdout::STDOUT;
use crate::cli::told::error::Error;
use biela::mechanism::Mechanism;

/// Print a JSON Schema (2020-12) of mechanism files; editors complete and check files with it.
///
/// In an editor with a TOML language server, the first line `#:schema biela.schema.json` of a
/// mechanism file turns it on.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela schema -o biela.schema.json")]
pub(in crate::cli) struct Schema {
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
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        let text = format!("{:#}\n", Mechanism::schema());
        write(&self.output, text.as_bytes())
    }
}

//! `biela convert`

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::cli::conditions::Conditions;
use crate::cli::error::Error;
use crate::cli::input::Input;
use crate::cli::input_files::InputFiles;
use crate::cli::message::Message;
use crate::cli::output::{tell_written, write};
use crate::cli::stdout::STDOUT;
use crate::exchange::{Pins, pmks_link, pylinkage_json};

/// Write a linkage for another program: as a link that opens in PMKS+, or as JSON of pylinkage.
///
/// Bodies are links through their pins at the start; rods, slides and slots on ground and points of
/// interest come over, and the first driver that turns a link about a pin on ground. A mechanism with
/// other joints is refused. For CAD and the workshop there is `biela draw -o x.dxf`, for systems of
/// FMUs `biela export --ssp`; `biela import` is the other way.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  \
        biela convert four_bar.toml --to pmks\n  \
        biela convert four_bar.toml --to pylinkage -o four_bar.json")]
pub(in crate::cli) struct Convert {
    /// The mechanism file.
    file: PathBuf,
    /// The program.
    #[arg(long, value_enum)]
    to: Program,
    /// The file to write [default: stdout].
    #[arg(short, long, value_name = "FILE", default_value = STDOUT, hide_default_value = true)]
    output: PathBuf,
    #[command(flatten)]
    conditions: Conditions,
}

/// Programs for linkages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Program {
    /// A link of PMKS+, in centimetres, to ten micrometres.
    Pmks,
    /// JSON of pylinkage, in metres.
    Pylinkage,
}

impl Convert {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        let input = Input::read(&self.file)?;
        InputFiles::new(&self.file, &input.mechanism).refuse_as_outputs(&[Some(&self.output)])?;
        let solver = self.conditions.solver_at_start(&input)?;
        let pins = Pins::new(&solver).map_err(|error| Error::Import {
            file: input.source.name().to_owned(),
            error,
        })?;
        let text = match self.to {
            Program::Pmks => pmks_link(&pins) + "\n",
            Program::Pylinkage => pylinkage_json(&pins),
        };
        for note in &pins.notes {
            Message::Note(note.to_string()).show();
        }
        write(&self.output, text.as_bytes())?;
        tell_written(&self.output);
        Ok(())
    }
}

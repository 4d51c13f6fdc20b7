//! `biela convert`

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::cli::given::assigning::unknown_name;
use crate::cli::given::conditions::Conditions;
use crate::cli::given::input::Input;
use crate::cli::given::input_files::InputFiles;
use crate::cli::results::output::{tell_written, write};
use crate::cli::results::stdout::STDOUT;
use crate::cli::told::error::Error;
use crate::cli::told::message::Message;
use crate::exchange::{
    self, AssemblyFile, Note, Pins, linkage_document, pmks_link, pylinkage_json,
};
use biela::kinematics::Solver;

/// Write a mechanism for another program: as a link that opens in PMKS+, JSON of pylinkage, a document
/// of Linkage, or an assembly of OndselSolver and FreeCAD.
///
/// Bodies are links through their pins at the start; rods, slides and slots on ground and points of
/// interest come over, and the drivers that turn links about pins on ground. An assembly has welds,
/// slots on moving bodies, gears, belts and racks too, and motions over time. A mechanism with other
/// joints is refused. For CAD and the workshop there is `biela draw -o x.dxf`, for systems of FMUs
/// `biela export --ssp`; `biela import` is the other way.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  \
        biela convert four_bar.toml --to pmks\n  \
        biela convert four_bar.toml --to pylinkage -o four_bar.json\n  \
        biela convert four_bar.toml --to linkage -o four_bar.linkage2\n  \
        biela convert four_bar.toml --to asmt --drive 'crank_angle=60*deg + 30*rpm*t' -o four_bar.asmt")]
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
    /// A document of Linkage (.linkage2), in millimetres.
    Linkage,
    /// An assembly of OndselSolver and FreeCAD (.asmt), in metres.
    Asmt,
}

impl Program {
    /// Returns the file for the program, with remarks.
    fn file(self, solver: &Solver) -> Result<(String, Vec<Note>), exchange::Error> {
        if let Self::Asmt = self {
            let assembly = AssemblyFile::new(solver)?;
            return Ok((assembly.text, assembly.notes));
        }
        let pins = Pins::new(solver)?;
        let text = match self {
            Self::Pmks => pmks_link(&pins) + "\n",
            Self::Pylinkage => pylinkage_json(&pins),
            _ => linkage_document(&pins),
        };
        Ok((text, pins.notes))
    }
}

/// Returns the file for the program of this name, with remarks.
///
/// # Errors
///
/// There is no such program, or it cannot have the mechanism.
pub(in crate::cli) fn converted(to: &str, solver: &Solver) -> Result<(String, Vec<Note>), String> {
    let program = Program::from_str(to, false).map_err(|_| {
        let programs = Program::value_variants().iter();
        let names =
            programs.filter_map(|program| Some(program.to_possible_value()?.get_name().to_owned()));
        let names: Vec<String> = names.collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        unknown_name("program", to, &names)
    })?;
    program.file(solver).map_err(|error| error.to_string())
}

impl Convert {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        let input = Input::read(&self.file)?;
        InputFiles::new(&self.file, &input.mechanism).refuse_as_outputs(&[Some(&self.output)])?;
        let solver = self.conditions.solver_at_start(&input)?;
        let (text, notes) = self.to.file(&solver).map_err(|error| Error::Import {
            file: input.source.name().to_owned(),
            error,
        })?;
        for note in &notes {
            Message::Note(note.to_string()).show();
        }
        write(&self.output, text.as_bytes())?;
        tell_written(&self.output);
        Ok(())
    }
}

//! `biela import`

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::PossibleValuesParser;

use crate::cli::given::assigning::unknown_name;
use crate::cli::given::input_files::InputFiles;
use crate::cli::render::render;
use crate::cli::results::new_file::{create, exists, tell_now_check};
use crate::cli::results::output::write;
use crate::cli::results::picture::extension;
use crate::cli::results::stdout::is_stdout;
use crate::cli::told::error::Error;
use crate::cli::told::message::{Message, tell};
use crate::exchange::{Draft, Format, LengthUnit};
use biela::mechanism::{Mechanism, Source};

/// Write a mechanism of another program as a mechanism file.
///
/// Assemblies of FreeCAD and OndselSolver (.asmt), documents of Linkage (.linkage2), links of PMKS+,
/// mechanisms of pylinkage (.json), and drawings (.dxf) in which a layer is a body, a circle a pin
/// and a text beside it the pin's name.
///
/// Names, units and speeds stay those of the source. Notes tell what is left out or was taken in
/// one of several ways; the file has them as comments.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  \
        biela import crank.asmt\n  \
        biela import sketch.dxf --length mm -o four_bar.toml\n  \
        biela import 'https://app.pmksplus.com/?0O.Ti.K,0.101.…'")]
pub(in crate::cli) struct Import {
    /// The file, or a link of PMKS+ itself.
    file: PathBuf,
    /// The mechanism file to write, `-` for stdout [default: the mechanism's name with .toml in the
    /// current folder, where no file is overwritten].
    #[arg(short, long, value_name = "TOML")]
    output: Option<PathBuf>,
    /// Unit of the lengths of a file that does not tell it [default for .asmt: mm if FreeCAD wrote
    /// the file, otherwise m; for .json: m].
    #[arg(long, value_name = "UNIT",
        value_parser = PossibleValuesParser::new(LengthUnit::ALL.map(LengthUnit::name)))]
    length: Option<String>,
}

impl Import {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        let (draft, text) = read(&self.file, self.length.as_deref())?;
        let usual = PathBuf::from(format!("{}.toml", draft.mechanism_name()));
        let path = self.output.clone().unwrap_or(usual);
        InputFiles::only("the imported file", &self.file).refuse_as_outputs(&[Some(&path)])?;
        if self.output.is_none() && path.exists() {
            return Err(exists(&path));
        }
        match self.output {
            Some(_) => write(&path, text.as_bytes())?,
            None => create(&path, &text)?,
        }
        for note in &draft.notes {
            Message::Note(note.to_string()).show();
        }
        answer(&path, &draft, text)
    }
}

/// Reads a file, or a link of PMKS+ itself, whose lengths have the unit of this name where it does not
/// tell it; returns what was read, and the text of a mechanism file.
pub(in crate::cli) fn read(file: &Path, length: Option<&str>) -> Result<(Draft, String), Error> {
    let units = LengthUnit::ALL.map(LengthUnit::name);
    let place = length.map(|name| {
        let place = units.iter().position(|unit| *unit == name);
        place.ok_or_else(|| Error::Usage(unknown_name("unit of lengths", name, &units)))
    });
    let length = place.transpose()?.map(|place| LengthUnit::ALL[place]);
    let argument = file.to_string_lossy();
    let is_link = argument.starts_with("https://") || argument.starts_with("http://");
    // A link has no extension behind its last point.
    let (name, content, extension, stem) = if is_link {
        let content = argument.as_bytes().to_vec();
        (
            "the link".into(),
            content,
            String::new(),
            "mechanism".into(),
        )
    } else {
        let content = std::fs::read(file).map_err(Error::read(file))?;
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        (argument, content, extension(file), stem)
    };
    let failed = |error| Error::Import {
        file: name.to_string(),
        error,
    };
    let format = Format::of(&extension, &content).map_err(failed)?;
    let stem = stem.trim_end_matches(".pmks");
    let stem = stem.trim_end_matches(".pylinkage");
    let draft = format.read(&content, stem, length).map_err(failed)?;
    let text = draft.write(&file_name(&name));
    Ok((draft, text))
}

/// Shows the reader's remarks on the written file, and names the next command.
fn answer(path: &Path, draft: &Draft, text: String) -> Result<(), Error> {
    let source = Source::new(path.display().to_string(), text);
    let (diagnostics, is_right) = match Mechanism::parse(&source) {
        Ok((_, warnings)) => (warnings, true),
        Err(errors) => (errors, false),
    };
    if !diagnostics.is_empty() {
        tell(render(&source, &diagnostics, true) + "\n");
    }
    if !is_stdout(path) {
        tell_now_check(path);
    }
    if is_right {
        return Ok(());
    }
    Err(Error::Imported {
        format: draft.format,
    })
}

/// Returns the last part of a path.
fn file_name(path: &str) -> String {
    let name = Path::new(path).file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

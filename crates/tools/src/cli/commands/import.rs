//! `biela import`

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::PossibleValuesParser;

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
        let length = LengthUnit::ALL
            .into_iter()
            .find(|unit| Some(unit.name()) == self.length.as_deref());
        let (name, content) = self.content()?;
        let failed = |error| Error::Import {
            file: name.clone(),
            error,
        };
        // A link has no extension behind its last point.
        let extension = match self.link() {
            Some(_) => String::new(),
            None => extension(&self.file),
        };
        let format = Format::of(&extension, &content).map_err(failed)?;
        let stem = match self.link() {
            Some(_) => OsStr::new("mechanism"),
            None => Path::new(&name).file_stem().unwrap_or_default(),
        };
        let stem = stem.to_string_lossy();
        let stem = stem
            .trim_end_matches(".pmks")
            .trim_end_matches(".pylinkage");
        let draft = format.read(&content, stem, length).map_err(failed)?;
        let usual = PathBuf::from(format!("{}.toml", draft.mechanism_name()));
        let path = self.output.clone().unwrap_or(usual);
        InputFiles::only("the imported file", &self.file).refuse_as_outputs(&[Some(&path)])?;
        if self.output.is_none() && path.exists() {
            return Err(exists(&path));
        }
        let text = draft.write(&file_name(&name));
        match self.output {
            Some(_) => write(&path, text.as_bytes())?,
            None => create(&path, &text)?,
        }
        for note in &draft.notes {
            Message::Note(note.to_string()).show();
        }
        answer(&path, &draft, text)
    }

    /// Returns the name and the bytes of the file, or a link itself.
    fn content(&self) -> Result<(String, Vec<u8>), Error> {
        if let Some(link) = self.link() {
            return Ok(("the link".to_owned(), link.into_bytes()));
        }
        let content = std::fs::read(&self.file).map_err(Error::read(&self.file))?;
        Ok((self.file.to_string_lossy().into_owned(), content))
    }

    /// Returns the argument if it is a link.
    fn link(&self) -> Option<String> {
        let argument = self.file.to_string_lossy();
        let is_link = argument.starts_with("https://") || argument.starts_with("http://");
        is_link.then(|| argument.into_owned())
    }
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

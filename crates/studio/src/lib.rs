//! `biela_tools::studio` for a browser, with what leaves and enters it: FMUs, pictures, mechanisms of other
//! programs.

#[path = "../../page/src/abi.rs"]
mod abi;

use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use biela::fmi::{Platform, RuntimeLibrary};
use biela::kinematics::{Path, Solver};
use biela::mechanism::{Mechanism, Severity, Source};
use biela_tools::cli::{archive_with, gif};
use biela_tools::drawing::{Scene, Sheet, svg};
use biela_tools::exchange::{
    AssemblyFile, Format, LengthUnit, Pins, WorkshopDrawing, linkage_document,
};
use biela_tools::page::assembled;
use serde::Deserialize;
use serde_json::{Value, json};

/// A request, in JSON with its name under `do`. Contents of files are in base64; a request that fails is
/// answered by `problems`, one per line.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
enum Request {
    /// Answers the `content` of an FMU for hosts of FMI `2` or `3`, with libraries for platforms, and
    /// maybe with a page, for which this is the solver.
    Export {
        name: String,
        text: String,
        #[serde(default)]
        files: Files,
        fmi: String,
        libraries: Files,
        page: Option<String>,
    },
    /// Answers the `content` of the drawing of the pose at the start, and `notes`.
    Dxf {
        name: String,
        text: String,
        #[serde(default)]
        files: Files,
    },
    /// Answers the `content` of an assembly for FreeCAD or OndselSolver, of the pose at the start, and
    /// `notes`.
    Asmt {
        name: String,
        text: String,
        #[serde(default)]
        files: Files,
    },
    /// Answers the `content` of a document of Linkage, of the pose at the start, and `notes`.
    Linkage2 {
        name: String,
        text: String,
        #[serde(default)]
        files: Files,
    },
    /// Answers `svg`: the drawing of the pose at the start.
    Svg {
        name: String,
        text: String,
        #[serde(default)]
        files: Files,
    },
    /// Answers the `content` of the moving picture.
    Gif {
        name: String,
        text: String,
        #[serde(default)]
        files: Files,
    },
    /// Reads the `content` of a file, or a link, of another program, whose lengths are in a unit; answers
    /// the `text` of the mechanism file, its `name` and `notes`.
    Import {
        name: String,
        content: String,
        length: Option<String>,
    },
    /// A request of the studio.
    #[serde(other)]
    OfStudio,
}

/// Names with contents.
type Files = Vec<(String, String)>;

/// A studio that also exports and imports.
#[derive(Default)]
struct Host {
    studio: biela_tools::studio::Host,
}

impl Host {
    fn answer(&mut self, request: &str) -> Value {
        let asked: Value = match serde_json::from_str(request) {
            Ok(asked) => asked,
            Err(error) => return json!({ "error": error.to_string() }),
        };
        let answer = match Request::deserialize(&asked) {
            Ok(request) => answer(&mut self.studio, &asked, request),
            Err(error) => return json!({ "error": error.to_string() }),
        };
        answer.unwrap_or_else(|problems| json!({ "problems": problems }))
    }

    fn drive(&mut self, driver: usize, value: f64) -> bool {
        self.studio.drive(driver, value)
    }

    fn frame(&self) -> &[f64] {
        self.studio.frame()
    }
}

/// Answers a request, which is one of the studio where `asked` is none of those here.
fn answer(
    studio: &mut biela_tools::studio::Host,
    asked: &Value,
    request: Request,
) -> Result<Value, String> {
    match request {
        Request::Export {
            name,
            text,
            files,
            fmi,
            libraries,
            page,
        } => {
            let (source, mechanism) = mechanism(name, text, files)?;
            export(&source, &mechanism, &fmi, libraries, page)
        }
        Request::Dxf { name, text, files } => dxf(mechanism(name, text, files)?.1),
        Request::Asmt { name, text, files } => {
            let solver = at_start(mechanism(name, text, files)?.1)?;
            let file = AssemblyFile::new(&solver).map_err(|error| error.to_string())?;
            Ok(with_notes(&file.text, &file.notes))
        }
        Request::Linkage2 { name, text, files } => {
            let solver = at_start(mechanism(name, text, files)?.1)?;
            let pins = Pins::new(&solver).map_err(|error| error.to_string())?;
            Ok(with_notes(linkage_document(&pins), &pins.notes))
        }
        Request::Svg { name, text, files } => still(&mechanism(name, text, files)?.1),
        Request::Gif { name, text, files } => {
            let (source, mechanism) = mechanism(name, text, files)?;
            Ok(json!({ "content": STANDARD.encode(gif(&source, &mechanism)?) }))
        }
        Request::Import {
            name,
            content,
            length,
        } => import(&name, &content, length.as_deref()),
        Request::OfStudio => Ok(studio.answer_to(asked)),
    }
}

fn unpacked(packed: &str) -> Result<Vec<u8>, String> {
    STANDARD.decode(packed).map_err(|error| error.to_string())
}

/// Reads the mechanism of a request.
fn mechanism(name: String, text: String, files: Files) -> Result<(Source, Arc<Mechanism>), String> {
    let source = Source::new(name, text).with_files(files);
    match Mechanism::parse(&source) {
        Ok((mechanism, _)) => Ok((source, Arc::new(mechanism))),
        Err(problems) => {
            let errors = problems
                .iter()
                .filter(|problem| problem.severity == Severity::Error);
            let errors: Vec<String> = errors.map(|error| error.one_line(&source)).collect();
            Err(errors.join("\n"))
        }
    }
}

fn export(
    source: &Source,
    mechanism: &Arc<Mechanism>,
    fmi: &str,
    libraries: Files,
    page: Option<String>,
) -> Result<Value, String> {
    let libraries = libraries.into_iter().map(|(name, packed)| {
        let platform = Platform::named(&name);
        let platform = platform.ok_or_else(|| format!("no platform is called `{name}`"))?;
        let content = unpacked(&packed)?.into();
        Ok(RuntimeLibrary { platform, content })
    });
    let libraries = libraries.collect::<Result<Vec<_>, String>>()?;
    let page = page.as_deref().map(unpacked).transpose()?;
    let fmu = archive_with(source, mechanism, fmi, &libraries, page.as_deref())?;
    Ok(json!({ "content": STANDARD.encode(fmu) }))
}

/// Returns the solver of a mechanism at its start.
fn at_start(mechanism: Arc<Mechanism>) -> Result<Solver, String> {
    let path = Path::new(&mechanism);
    Solver::assembled(mechanism, &path).map_err(|error| error.to_string())
}

fn with_notes<N: ToString>(content: impl AsRef<[u8]>, notes: &[N]) -> Value {
    let notes: Vec<String> = notes.iter().map(ToString::to_string).collect();
    json!({ "content": STANDARD.encode(content), "notes": notes })
}

fn dxf(mechanism: Arc<Mechanism>) -> Result<Value, String> {
    let mut solver = at_start(mechanism)?;
    let scene = Scene::new(&mut solver, true);
    let drawing = WorkshopDrawing::new(&scene, &solver);
    Ok(with_notes(drawing.text, &drawing.notes))
}

fn still(mechanism: &Arc<Mechanism>) -> Result<Value, String> {
    let mut solver = assembled(mechanism).map_err(|error| error.to_string())?;
    let scene = Scene::new(&mut solver, true);
    let sheet = Sheet::new(&scene, &solver.pose().q);
    Ok(json!({ "svg": svg::write(&sheet, sheet.width(), false) }))
}

fn import(name: &str, content: &str, length: Option<&str>) -> Result<Value, String> {
    let content = unpacked(content)?;
    let mut units = LengthUnit::ALL.into_iter();
    let length = units.find(|unit| Some(unit.name()) == length);
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
    let format = Format::of(&extension.to_lowercase(), &content);
    let draft = format.and_then(|format| format.read(&content, stem, length));
    let draft = draft.map_err(|error| error.to_string())?;
    let notes: Vec<String> = draft.notes.iter().map(ToString::to_string).collect();
    Ok(json!({
        "name": format!("{}.toml", draft.mechanism_name()),
        "text": draft.write(name),
        "notes": notes,
    }))
}

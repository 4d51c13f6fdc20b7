//! `biela::studio` for a browser, with what leaves and enters it: FMUs, pictures, mechanisms of other
//! programs.

#[path = "../../page/src/abi.rs"]
mod abi;

use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use biela::cli::{archive_with, gif};
use biela::drawing::{Scene, Sheet, svg};
use biela::exchange::{Format, LengthUnit, WorkshopDrawing};
use biela::fmi::{Platform, RuntimeLibrary};
use biela::kinematics::{Path, Solver};
use biela::mechanism::{Mechanism, Severity, Source};
use biela::page::assembled;
use serde_json::{Value, json};

/// A studio that also exports and imports. Contents of files are in base64; a request that fails is
/// answered by `problems`, one per line.
///
/// | `do` | further keys | answer |
/// |---|---|---|
/// | `export` | `name`, `text`, `files`, `fmi` (`2` or `3`), `libraries` (platforms with libraries), maybe `page` (the solver for pages) | `content` of the FMU |
/// | `dxf` | `name`, `text`, `files` | `content` of the drawing of the pose at the start, `notes` |
/// | `svg` | `name`, `text`, `files` | `svg`: the drawing of the pose at the start |
/// | `gif` | `name`, `text`, `files` | `content` of the moving picture |
/// | `import` | `name` of a file or a link, its `content`, maybe `length` (its unit) | `text` of the mechanism file, `name`, `notes` |
#[derive(Default)]
struct Host {
    studio: biela::studio::Host,
}

impl Host {
    fn answer(&mut self, request: &str) -> Value {
        const OWN: [&str; 5] = ["export", "dxf", "svg", "gif", "import"];
        // The word comes first, so that no other request is read twice.
        let word = request
            .strip_prefix("{\"do\":\"")
            .and_then(|rest| rest.split('"').next());
        let Some(word) = word.filter(|word| OWN.contains(word)) else {
            return self.studio.answer(request);
        };
        let request: Value = match serde_json::from_str(request) {
            Ok(request) => request,
            Err(error) => return json!({ "error": error.to_string() }),
        };
        let answer = match word {
            "import" => import(&request),
            _ => mechanism(&request).and_then(|(source, mechanism)| match word {
                "export" => export(&request, &source, &mechanism),
                "dxf" => dxf(mechanism),
                "svg" => still(&mechanism),
                _ => Ok(json!({ "content": STANDARD.encode(gif(&source, &mechanism)?) })),
            }),
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

/// Returns a text of a request, empty if there is none.
fn word<'a>(request: &'a Value, key: &str) -> &'a str {
    request[key].as_str().unwrap_or_default()
}

/// Returns pairs of texts of a request.
fn pairs(request: &Value, key: &str) -> Vec<(String, String)> {
    let list = request[key].as_array().map_or(&[][..], Vec::as_slice);
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    list.iter()
        .map(|pair| (text(&pair[0]), text(&pair[1])))
        .collect()
}

fn unpacked(packed: &str) -> Result<Vec<u8>, String> {
    STANDARD.decode(packed).map_err(|error| error.to_string())
}

/// Reads the mechanism of a request.
fn mechanism(request: &Value) -> Result<(Source, Arc<Mechanism>), String> {
    let source = Source::new(word(request, "name"), word(request, "text"));
    let source = source.with_files(pairs(request, "files"));
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

fn export(request: &Value, source: &Source, mechanism: &Arc<Mechanism>) -> Result<Value, String> {
    let libraries = pairs(request, "libraries")
        .into_iter()
        .map(|(name, packed)| {
            let platform = Platform::named(&name);
            let platform = platform.ok_or_else(|| format!("no platform is called `{name}`"))?;
            let content = unpacked(&packed)?.into();
            Ok(RuntimeLibrary { platform, content })
        });
    let libraries = libraries.collect::<Result<Vec<_>, String>>()?;
    let page = request["page"].as_str().map(unpacked).transpose()?;
    let fmi = word(request, "fmi");
    let fmu = archive_with(source, mechanism, fmi, &libraries, page.as_deref())?;
    Ok(json!({ "content": STANDARD.encode(fmu) }))
}

fn dxf(mechanism: Arc<Mechanism>) -> Result<Value, String> {
    let path = Path::new(&mechanism);
    let solver = Solver::assembled(mechanism, &path);
    let mut solver = solver.map_err(|error| error.to_string())?;
    let scene = Scene::new(&mut solver, true);
    let drawing = WorkshopDrawing::new(&scene, &solver);
    let notes: Vec<String> = drawing.notes.iter().map(ToString::to_string).collect();
    Ok(json!({ "content": STANDARD.encode(drawing.text), "notes": notes }))
}

fn still(mechanism: &Arc<Mechanism>) -> Result<Value, String> {
    let mut solver = assembled(mechanism).map_err(|error| error.to_string())?;
    let scene = Scene::new(&mut solver, true);
    let sheet = Sheet::new(&scene, &solver.pose().q);
    Ok(json!({ "svg": svg::write(&sheet, sheet.width(), false) }))
}

fn import(request: &Value) -> Result<Value, String> {
    let name = word(request, "name");
    let content = unpacked(word(request, "content"))?;
    let mut units = LengthUnit::ALL.into_iter();
    let length = units.find(|unit| unit.name() == word(request, "length"));
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

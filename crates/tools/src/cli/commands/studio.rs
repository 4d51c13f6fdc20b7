//! `biela studio`

use std::borrow::Cow;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::new::templates;
use crate::cli::pages::live;
use crate::cli::pages::page_solver::{self, Solver};
use crate::cli::pages::server::{
    Answer, JSON, Listening, PAGE, Request, SCRIPT, Server, TEXT, token,
};
use crate::cli::pages::studio_page::{Beginning, page, part};
use crate::cli::results::output::{print, tell_written, write};
use crate::cli::runtime;
use crate::cli::told::error::Error;
use crate::cli::told::message::{Message, tell};
use biela::mechanism::{Mechanism, Source, is_identifier};

/// Draw a mechanism in a browser, move it, and take the FMU home.
///
/// The page draws links, joints, drivers and forces with the mouse or a finger and writes the
/// mechanism file along: text and drawing are one. It exports FMUs, pictures and the file. Only this
/// machine can open it; with FILE, that file is written at each change. Ctrl-C ends the command.
///
/// With --write the studio becomes a folder for any web server, or for the disk.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela studio four_bar.toml")]
pub(in crate::cli) struct Studio {
    /// The mechanism file, which is made if it does not exist.
    file: Option<PathBuf>,
    /// Write the studio into this folder, with the runtime libraries of all platforms; its page is
    /// index.html.
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["file", "port"])]
    write: Option<PathBuf>,
    /// The studio's solver, compiled to WebAssembly [default: the one installed with this program].
    #[arg(long, value_name = "WASM")]
    solver: Option<PathBuf>,
    /// Folder of runtime libraries, one subfolder per platform [default: those installed with this
    /// program].
    #[arg(long, value_name = "FOLDER")]
    runtime: Option<PathBuf>,
    #[command(flatten)]
    listening: Listening,
}

/// Port of the studio: a browser keeps drafts by the address of a page.
const PORT: u16 = 7433;

/// The parts of a studio besides its page.
struct Parts {
    /// The element with the packed solver.
    solver: String,
    /// The mechanisms to begin from.
    templates: Vec<Value>,
    /// Names and contents of what goes into FMUs.
    packed: Vec<(String, Cow<'static, [u8]>)>,
}

impl Parts {
    fn find(solver: Option<&Path>, folder: Option<&Path>) -> Result<Self, Error> {
        let solver = match solver {
            Some(file) => page_solver::read(file)?,
            None => page_solver::demand(Solver::Studio)?,
        };
        let libraries = runtime::find(folder)?.into_iter().map(|found| {
            let library = found.library;
            (library.platform.name.to_owned(), library.content)
        });
        let page = page_solver::find(Solver::Page)?;
        let page = page.map(|solver| ("page".to_owned(), solver));
        Ok(Self {
            solver: live::solver(&solver),
            templates: shown_templates(),
            packed: libraries.chain(page).collect(),
        })
    }

    fn page(&self, file: Option<Value>, disk: Option<[String; 3]>) -> String {
        let parts = self.packed.iter().map(|(name, _)| name.clone());
        let beginning = Beginning {
            file,
            disk,
            parts: parts.collect(),
            templates: &self.templates,
        };
        page(&self.solver, &beginning)
    }

    fn script(&self, path: &str) -> Option<String> {
        let name = path.strip_prefix("/parts/")?.strip_suffix(".js")?;
        let mut parts = self.packed.iter();
        let (name, content) = parts.find(|(known, _)| known == name)?;
        Some(part(name, content))
    }
}

impl Studio {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        if let Some(file) = &self.file
            && file.extension().is_none_or(|extension| extension != "toml")
        {
            return Err(Error::Usage(format!(
                "`{}` is no name of a mechanism file: it must end in .toml",
                file.display()
            )));
        }
        let parts = Parts::find(self.solver.as_deref(), self.runtime.as_deref())?;
        if let Some(folder) = &self.write {
            return write_folder(&parts, folder);
        }
        if let Some(file) = &self.file {
            read(file).map_err(Error::read(file))?;
        }
        let server = Server::new(&self.listening, PORT)?;
        if server.port() != PORT && !self.listening.is_given() {
            tell(Message::Note(format!(
                "port {PORT} is taken, maybe by another studio: this one is on port {}, where the browser \
                 keeps other drafts",
                server.port()
            )));
        }
        let _ = print(&format!("{}\n", server.address()));
        let token = token();
        let read_all = |file: &Path| {
            let (content, version) = read(file)?;
            io::Result::Ok((content, [token.clone(), version, place(file)]))
        };
        server.serve(|request| match (&*request.method, &*request.path) {
            ("GET", "/") => {
                let read = self.file.as_deref().map(read_all).transpose();
                match read.map(Option::unzip) {
                    Ok((file, disk)) => Answer::new(PAGE, parts.page(file, disk)),
                    Err(error) => Answer::failure(error.to_string()),
                }
            }
            ("GET", "/file") => match self.file.as_deref().map(read_all) {
                Some(Ok((file, [token, version, _]))) => {
                    let told = json!({ "file": file, "token": token, "version": version });
                    Answer::new(JSON, told.to_string())
                }
                Some(Err(error)) => Answer::failure(error.to_string()),
                None => Answer::refusal("404 Not Found"),
            },
            ("GET", path) => match parts.script(path) {
                Some(script) => Answer::new(SCRIPT, script),
                None => Answer::refusal("404 Not Found"),
            },
            ("PUT", "/file") => match &self.file {
                Some(file) if request.token.as_deref() == Some(&*token) => put(file, request),
                _ => Answer::refusal("403 Forbidden"),
            },
            _ => Answer::refusal("404 Not Found"),
        })
    }
}

/// Returns the bytes of the file, none of one that does not exist yet.
fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    match std::fs::read(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        read => read,
    }
}

/// Returns the file as the page opens it, and its version; one that does not exist is a new
/// mechanism of its name.
///
/// # Errors
///
/// The file cannot be read, or is not UTF-8: the page would write over what it has not shown.
fn read(path: &Path) -> io::Result<(Value, String)> {
    let bytes = bytes(path)?;
    let version = version(&bytes);
    let mut text = String::from_utf8(bytes).map_err(|_| {
        let why = "it is not UTF-8: save it as UTF-8";
        io::Error::new(io::ErrorKind::InvalidData, why)
    })?;
    if text.is_empty() {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let name = if is_identifier(&stem) {
            &*stem
        } else {
            "mechanism"
        };
        text = format!("format = 1\nname = \"{name}\"\n");
    }
    let name = path.to_string_lossy();
    let source = Source::new(name, text).in_folder(path.parent().unwrap_or(Path::new("")));
    let mechanism = Mechanism::parse(&source).ok();
    let mechanism = mechanism.as_ref().map(|(mechanism, _)| mechanism);
    Ok((live::file(&source, mechanism), version))
}

/// Returns a word for the place of a file, which may not exist yet.
fn place(path: &Path) -> String {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new(".")).canonicalize();
    let place = folder.map(|folder| folder.join(path.file_name().unwrap_or_default()));
    let place = place.unwrap_or_else(|_| path.to_owned());
    version(place.to_string_lossy().as_bytes())
}

/// Returns a word that changes with the content of a file.
fn version(bytes: &[u8]) -> String {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

/// Writes the file, unless another program has changed it since the page read or wrote it.
fn put(path: &Path, request: &Request) -> Answer {
    let now = match bytes(path) {
        Ok(bytes) => version(&bytes),
        Err(error) => return Answer::failure(error.to_string()),
    };
    if request.version.as_deref() != Some(&*now) {
        return Answer::conflict(
            "another program has changed it; load this page again, or save under another name",
        );
    }
    match std::fs::write(path, &request.body) {
        Ok(()) => Answer::new(TEXT, version(request.body.as_bytes())),
        Err(error) => Answer::failure(error.to_string()),
    }
}

fn write_folder(parts: &Parts, folder: &Path) -> Result<(), Error> {
    let scripts = folder.join("parts");
    std::fs::create_dir_all(&scripts).map_err(Error::write(&scripts))?;
    for (name, content) in &parts.packed {
        let path = scripts.join(format!("{name}.js"));
        write(&path, part(name, content).as_bytes())?;
    }
    let page = folder.join("index.html");
    write(&page, parts.page(None, None).as_bytes())?;
    tell_written(&page);
    Ok(())
}

/// Returns the shipped mechanisms as the page offers them.
fn shown_templates() -> Vec<Value> {
    let shown = templates().map(|(name, text, files)| {
        let source = Source::new("", text).with_files(
            files
                .iter()
                .map(|(name, text)| ((*name).to_owned(), (*text).to_owned()))
                .collect(),
        );
        let mechanism = Mechanism::parse(&source).ok();
        let description = mechanism.map(|(mechanism, _)| mechanism.description);
        json!({ "name": name, "description": description, "text": text, "files": files })
    });
    shown.collect()
}

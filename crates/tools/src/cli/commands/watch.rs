//! `biela watch`

use std::borrow::Cow;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use clap::Args;

use crate::cli::given::conditions::Conditions;
use crate::cli::given::input::{Input, misfits};
use crate::cli::given::input_files::tables;
use crate::cli::pages::documentation::show;
use crate::cli::pages::live;
use crate::cli::pages::page_solver;
use crate::cli::pages::server::{Answer, Listening, PAGE, Request, Server, TEXT, token};
use crate::cli::render::render;
use crate::cli::results::output::print;
use crate::cli::told::error::Error;
use crate::cli::told::message::{Message, tell};
use crate::drawing::animation::{fill, page_with, player};
use crate::drawing::svg::escape;
use biela::mechanism::Mechanism;

const MAIN: &str = include_str!("watch/main.html");
const STYLE: &str = include_str!("watch/watch.css");

/// Show a mechanism moving in a browser, anew each time its file is saved.
///
/// Only this machine can open the page. It is the page of `biela page`, on which the mechanism is
/// moved by hand, and a button writes its parameters into the file. Without the solver for pages,
/// and with --set or --drive, it shows the prescribed motions or, if there are none, the range of
/// the first driver. While the file has an error, the page shows the error and the last
/// good picture. Ctrl-C ends the command.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela watch four_bar.toml")]
pub(in crate::cli) struct Watch {
    /// The mechanism file.
    file: PathBuf,
    #[command(flatten)]
    conditions: Conditions,
    #[command(flatten)]
    listening: Listening,
}

impl Watch {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        // An error in the file may be corrected while it is watched, one in the command not.
        if let Ok((input, _)) = read(&self.file)? {
            let start = input.mechanism.simulation.start;
            self.conditions.scenario(&input.mechanism, start, None)?;
        }
        // Options move the mechanism from where the file has it, which a hand would not respect.
        let solver = if self.conditions.is_empty() {
            page_solver::find(page_solver::Solver::Page)?
        } else {
            None
        };
        let server = Server::new(&self.listening, 0)?;
        if solver.is_none() && self.conditions.is_empty() {
            let note = "no solver for pages was found, so the page plays a motion and cannot be \
                        moved by hand: install the solver as docs/install.md says";
            Message::Note(note.to_owned()).show();
        }
        // With stdout closed the browser may have the address already.
        let _ = print(&format!("{}\n", server.address()));
        let mut view = View::new(self, solver);
        view.refresh();
        server.serve(|request| match (&*request.method, &*request.path) {
            ("GET", "/") => {
                view.refresh();
                Answer::new(PAGE, view.page())
            }
            ("GET", "/version") => {
                view.refresh();
                Answer::new(TEXT, view.version.to_string())
            }
            ("PUT", "/file") => view.write(request),
            _ => Answer::refusal("404 Not Found"),
        })
    }
}

/// The current view of a file.
struct View {
    watch: Watch,
    /// Number of changes seen.
    version: u64,
    /// Time and size of the file, then of the tables that it names.
    seen: Vec<Option<(SystemTime, u64)>>,
    tables: Vec<PathBuf>,
    /// The mechanism of the last good picture.
    mechanism: Option<Arc<Mechanism>>,
    /// The last good picture.
    player: String,
    /// Warnings on that picture, one per paragraph.
    warnings: Vec<String>,
    error: Option<String>,
    /// The element with the solver for pages, if there is one: the mechanism is moved by hand then.
    solver: Option<String>,
    /// Known to the page alone: other sites cannot write the file.
    token: String,
}

impl View {
    fn new(watch: Watch, solver: Option<Cow<'static, [u8]>>) -> Self {
        Self {
            solver: solver.map(|solver| live::solver(&solver)),
            token: token(),
            watch,
            version: 0,
            seen: Vec::new(),
            tables: Vec::new(),
            mechanism: None,
            player: String::new(),
            warnings: Vec::new(),
            error: None,
        }
    }

    /// Reads the files again if they have changed.
    fn refresh(&mut self) {
        let seen = self.stamps();
        if seen == self.seen {
            return;
        }
        self.version += 1;
        self.error = self.read().err();
        if let Some(error) = &self.error {
            tell(error);
        }
        // The file may name other tables now.
        self.seen = self.stamps();
    }

    fn stamps(&self) -> Vec<Option<(SystemTime, u64)>> {
        let stamp = |path: &PathBuf| {
            let data = path.metadata().ok()?;
            Some((data.modified().ok()?, data.len()))
        };
        std::iter::once(&self.watch.file)
            .chain(&self.tables)
            .map(stamp)
            .collect()
    }

    /// Reads the file and makes the picture.
    ///
    /// # Errors
    ///
    /// The message for the page.
    fn read(&mut self) -> Result<(), String> {
        let read = read(&self.watch.file).map_err(told)?;
        let (input, mut warnings) = read?;
        self.tables = tables(&self.watch.file, &input.mechanism).collect();
        let mut solver = input.assemble().map_err(told)?;
        if self.solver.is_none() {
            let (conditions, start) = (&self.watch.conditions, input.mechanism.simulation.start);
            let scenario = conditions.scenario(&input.mechanism, start, None);
            // The page names the file already.
            solver = scenario.map_err(told)?.solver(solver).map_err(told)?;
        }
        warnings.extend(misfits(&solver).iter().map(ToString::to_string));
        let player = if self.solver.is_some() {
            live::main(
                &input.source,
                &input.mechanism,
                &live::attribute("token", Some(&self.token)),
            )
        } else {
            let shown = show(&mut solver).map_err(told)?;
            let moving = escape(&shown.moving);
            format!("<p>{moving}</p>\n{}", player(&shown.animation))
        };
        self.warnings = warnings;
        self.mechanism = Some(input.mechanism);
        self.player = player;
        Ok(())
    }

    fn page(&self) -> String {
        let error = self.error.as_ref().map_or_else(String::new, |error| {
            format!(
                "<pre class=\"error\" role=\"alert\">{}</pre>",
                escape(error)
            )
        });
        let warnings = if self.error.is_some() || self.warnings.is_empty() {
            String::new()
        } else {
            format!(
                "<pre class=\"warnings\" role=\"status\">{}</pre>",
                escape(&self.warnings.join("\n\n"))
            )
        };
        let file = self.watch.file.display().to_string();
        let (name, description) = match &self.mechanism {
            Some(mechanism) => (&*mechanism.name, &*mechanism.description),
            None => (&*file, ""),
        };
        let main = fill(
            MAIN,
            &[
                ("error", &error),
                ("warnings", &warnings),
                ("player", &self.player),
                ("version", &self.version.to_string()),
            ],
        );
        match &self.solver {
            None => page_with(name, description, &main, STYLE),
            Some(solver) => {
                let main = main + solver + &live::script();
                let style = format!("{STYLE}{}", live::STYLE);
                page_with(name, description, &main, &style)
            }
        }
    }

    /// Writes the text that the page sends into the file.
    fn write(&self, request: &Request) -> Answer {
        if request.token.as_deref() != Some(&*self.token) {
            return Answer::refusal("403 Forbidden");
        }
        match std::fs::write(&self.watch.file, &request.body) {
            Ok(()) => Answer::new(TEXT, ""),
            Err(error) => Answer::failure(error.to_string()),
        }
    }
}

/// Reads a file and returns its warnings, or its errors as text; tells nothing on the terminal.
fn read(path: &Path) -> Result<Result<(Input, Vec<String>), String>, Error> {
    let mut shown = Vec::new();
    let input = Input::read_and(path, |source, diagnostics| {
        shown.push(render(source, diagnostics, false));
    });
    match input {
        Ok(input) => Ok(Ok((input, shown))),
        Err(Error::Diagnosed) => Ok(Err(shown.concat())),
        Err(error) => Err(error),
    }
}

/// Returns the message of an error.
fn told(error: impl Display) -> String {
    Message::Error(error.to_string()).to_string()
}

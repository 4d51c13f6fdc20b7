//! `biela watch`

mod server;

use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use clap::Args;

use super::conditions::Conditions;
use super::documentation::show;
use super::error::Error;
use super::input::{Input, misfits};
use super::message::{Message, tell};
use super::originals::tables;
use super::output::print;
use super::render::render;
use crate::drawing::animation::{fill, page_with, player};
use crate::drawing::svg::escape;
use crate::mechanism::{Mechanism, Source};
use server::{Answer, Server};

const MAIN: &str = include_str!("watch/main.html");
const STYLE: &str = include_str!("watch/watch.css");

/// Show a mechanism moving in a browser, anew each time its file is saved.
///
/// The page is served to this machine alone. It shows the prescribed motions or, if none moves,
/// the range of the first driver. While the file has an error, the page says which, with the
/// last good picture. Ctrl-C ends it.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela watch four_bar.toml")]
pub(super) struct Watch {
    /// The mechanism file.
    file: PathBuf,
    #[command(flatten)]
    conditions: Conditions,
    /// The port to listen on [default: a free one].
    #[arg(
        long,
        value_name = "PORT",
        default_value_t = 0,
        hide_default_value = true
    )]
    port: u16,
}

impl Watch {
    pub(super) fn run(self) -> Result<(), Error> {
        // What is wrong with the file may be mended while it is watched, the command not.
        if let Ok((input, _)) = read(&self.file)? {
            let start = input.mechanism.simulation.start;
            let parameters = self.conditions.parameters(&input.mechanism)?;
            self.conditions
                .driven(&input.mechanism, &parameters, start)?;
        }
        let server = Server::new(self.port)?;
        // A closed pipe is no reason to stop: the browser may have the address already.
        let _ = print(&format!("{}\n", server.address()));
        let mut view = View::new(self);
        view.look();
        server.serve(|path| match path {
            "/" => {
                view.look();
                Answer::page(view.page())
            }
            "/version" => {
                view.look();
                Answer::text(view.version.to_string())
            }
            _ => Answer::missing(),
        })
    }
}

/// What there is to see of a file.
struct View {
    watch: Watch,
    /// Counts what was seen.
    version: u64,
    /// Of the file and the tables that it names.
    seen: Vec<Option<(SystemTime, u64)>>,
    tables: Vec<PathBuf>,
    name: String,
    description: String,
    /// The last good picture.
    player: String,
    /// What is to be said of that, one paragraph after the other.
    warnings: Vec<String>,
    error: Option<String>,
}

impl View {
    fn new(watch: Watch) -> Self {
        Self {
            watch,
            version: 0,
            seen: Vec::new(),
            tables: Vec::new(),
            name: String::new(),
            description: String::new(),
            player: String::new(),
            warnings: Vec::new(),
            error: None,
        }
    }

    /// Looks at the files again if they have changed.
    fn look(&mut self) {
        let seen = self.stamps();
        if seen == self.seen {
            return;
        }
        self.version += 1;
        self.error = self.try_look().err();
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

    /// # Errors
    ///
    /// What is wrong, for people.
    fn try_look(&mut self) -> Result<(), String> {
        let read = read(&self.watch.file).map_err(told)?;
        let (input, mut warnings) = read?;
        self.tables = tables(&self.watch.file, &input.mechanism).collect();
        let started = self.watch.conditions.reach_start(&input);
        let mut solver = started.map_err(told)?.map_err(told)?;
        warnings.extend(misfits(&solver).iter().map(ToString::to_string));
        let shown = show(&mut solver).map_err(told)?;
        self.warnings = warnings;
        self.name.clone_from(&input.mechanism.name);
        self.description.clone_from(&input.mechanism.description);
        self.player = format!(
            "<p>{}</p>\n{}",
            escape(&shown.moving),
            player(&shown.animation)
        );
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
        let name = if self.name.is_empty() {
            &file
        } else {
            &self.name
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
        page_with(name, &self.description, &main, STYLE)
    }
}

/// Reads a file without telling the terminal; also what it warns of. Or else what is wrong in it,
/// for people.
fn read(path: &Path) -> Result<Result<(Input, Vec<String>), String>, Error> {
    let source = Source::open(path.display().to_string(), path).map_err(|source| Error::Read {
        path: path.to_owned(),
        source,
    })?;
    Ok(match Mechanism::parse(&source) {
        Ok((mechanism, warnings)) => {
            let warnings = match warnings[..] {
                [] => Vec::new(),
                _ => vec![render(&source, &warnings, false)],
            };
            let mechanism = Arc::new(mechanism);
            Ok((Input { source, mechanism }, warnings))
        }
        Err(diagnostics) => Err(render(&source, &diagnostics, false)),
    })
}

/// An error as people read it.
fn told(error: impl Display) -> String {
    Message::Error(error.to_string()).to_string()
}

//! The command line.
//!
//! Results go to stdout, messages to stderr. The exit status is 0 for success, 1 for an error in
//! the mechanism, 2 for an error in the command.
//!
//! | file | subject |
//! |---|---|
//! | `commands` | one file per command |
//! | `given` | mechanism, values and times as the user gives them |
//! | `motion`, `free` | a mechanism that moves through the rows of a run, or comes to rest |
//! | `results` | rows, charts, films and files |
//! | `pages` | pages for a browser, and their server |
//! | `told` | messages, errors, progress |
//! | `runtime` | the libraries that go into an FMU |
//! | `render` | a diagnostic beside the lines of its file |
//! | `library` | commands as functions, for programs without a command line |

mod at_rest;
mod commands;
mod given;
mod library;
mod motion;
mod pages;
pub mod render;
mod results;
mod runtime;
mod told;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

pub use library::{
    ArchiveOptions, Failed, PlatformRow, ToldRange, archive, archive_with, check, check_order,
    check_parameter, convert, describe_end, gif, import, model_description_of, new, page,
    parameter_value, picture, platforms, range, report, shipped, shipped_text, unknown_name,
};

/// Planar mechanisms as text files: check them, run them, export them as FMUs.
///
/// A mechanism file lists the bodies, the joints that connect them and the drivers that move them.
/// biela computes position, velocity and acceleration of every body, exact to
/// rounding, and exports the mechanism as an FMU (FMI 2.0 or 3.0) whose inputs are the drivers and whose
/// outputs are the motion of all bodies.
#[derive(Debug, Parser)]
#[command(name = "biela", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    New(commands::new::New),
    Import(commands::import::Import),
    Check(commands::check::Check),
    Run(commands::run::Run),
    Range(commands::range::Range),
    Balance(commands::balance::Balance),
    Linearize(commands::linearize::Linearize),
    Tolerance(commands::tolerance::Tolerance),
    Draw(commands::draw::Draw),
    Report(commands::report::Report),
    Page(commands::page::Page),
    Watch(commands::watch::Watch),
    Studio(commands::studio::Studio),
    Export(commands::export::Export),
    Convert(commands::convert::Convert),
    Platforms(commands::platforms::Platforms),
    Schema(commands::schema::Schema),
    Completions(commands::completions::Completions),
}

/// Runs the program with these arguments, the first being its own name.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    ExitCode::from(status(arguments))
}

/// Runs the program with these arguments and returns its exit status.
pub fn status(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // clap prints help to stdout and errors to stderr; a closed pipe is no error.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
    let outcome = match arguments.command {
        Command::New(command) => command.run(),
        Command::Import(command) => command.run(),
        Command::Check(command) => command.run(),
        Command::Run(command) => command.run(),
        Command::Range(command) => command.run(),
        Command::Balance(command) => command.run(),
        Command::Linearize(command) => command.run(),
        Command::Tolerance(command) => command.run(),
        Command::Draw(command) => command.run(),
        Command::Report(command) => command.run(),
        Command::Page(command) => command.run(),
        Command::Watch(command) => command.run(),
        Command::Studio(command) => command.run(),
        Command::Export(command) => command.run(),
        Command::Convert(command) => command.run(),
        Command::Platforms(command) => command.run(),
        Command::Schema(command) => command.run(),
        Command::Completions(command) => command.run(Arguments::command()),
    };
    match outcome {
        Ok(()) => 0,
        Err(error) => {
            error.show();
            error.exit_status()
        }
    }
}

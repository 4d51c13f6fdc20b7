//! `biela completions`

use clap::Args;
use clap_complete::Shell;

use crate::cli::results::output::print;
use crate::cli::told::error::Error;

/// Print a script with which a shell completes the arguments of biela.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  biela completions bash > ~/.local/share/bash-completion/completions/biela
  biela completions zsh > \"${fpath[1]}/_biela\"
  biela completions fish > ~/.config/fish/completions/biela.fish")]
pub(in crate::cli) struct Completions {
    /// The shell.
    shell: Shell,
}

impl Completions {
    /// Prints the script for `program`, the command line of biela.
    pub(in crate::cli) fn run(self, mut program: clap::Command) -> Result<(), Error> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut program, "biela", &mut script);
        print(&String::from_utf8_lossy(&script))
    }
}

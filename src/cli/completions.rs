//! `biela completions`

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::error::Error;
use super::output::print;

/// Print a script with which a shell completes the arguments of biela.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  biela completions bash > ~/.local/share/bash-completion/completions/biela
  biela completions zsh > \"${fpath[1]}/_biela\"
  biela completions fish > ~/.config/fish/completions/biela.fish")]
pub(super) struct Completions {
    /// The shell.
    shell: Shell,
}

impl Completions {
    pub(super) fn run(self) -> Result<(), Error> {
        let mut script = Vec::new();
        let mut command = super::Arguments::command();
        clap_complete::generate(self.shell, &mut command, "biela", &mut script);
        print(&String::from_utf8_lossy(&script))
    }
}

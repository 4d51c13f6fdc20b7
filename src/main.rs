//! The `biela` program; everything is in [`biela::cli`].

fn main() -> std::process::ExitCode {
    biela::cli::main(std::env::args_os())
}

//! The `biela` program; everything is in [`biela_tools::cli`].

fn main() -> std::process::ExitCode {
    biela_tools::cli::main(std::env::args_os())
}

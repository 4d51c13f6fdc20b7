//! Compiles the C host of the tests against the standard's own headers, so that a call that does
//! not fit them fails here.

use std::path::{Path, PathBuf};
use std::{env, process};

const HOST: &str = "tests/host.c";
const HEADERS: &str = "BIELA_FMI_HEADERS";

fn main() {
    println!("cargo::rerun-if-changed={HOST}");
    println!("cargo::rerun-if-env-changed={HEADERS}");
    let Some(headers) = headers() else {
        // Cargo shows it as an error of this package and fails.
        println!(
            "cargo::error=not set up: run `make setup` once in this folder, then build again \
             ({HEADERS} names no folder with fmi2Functions.h)"
        );
        return;
    };
    println!("cargo::rustc-check-cfg=cfg(c_host)");
    // The host loads the library the Unix way, and runs where it is compiled.
    let cross = env::var("HOST") != env::var("TARGET");
    if env::var_os("CARGO_CFG_UNIX").is_some() && !cross {
        compile_host(&headers);
    }
}

/// The folder of the standard's C headers, if set-up has left one.
fn headers() -> Option<PathBuf> {
    let folder = PathBuf::from(env::var_os(HEADERS)?);
    let header = folder.join("fmi2Functions.h");
    println!("cargo::rerun-if-changed={}", header.display());
    header.is_file().then_some(folder)
}

fn compile_host(headers: &Path) {
    let host = Path::new(&env::var_os("OUT_DIR").expect("cargo sets it")).join("host");
    let compiler = cc::Build::new().get_compiler();
    let mut command = compiler.to_command();
    if compiler.is_like_gnu() || compiler.is_like_clang() {
        command.args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic"]);
    }
    command.arg("-pthread").arg("-I").arg(headers);
    command.arg(HOST).arg("-o").arg(&host).arg("-ldl");
    match command.status() {
        Ok(status) if status.success() => {
            println!("cargo::rustc-cfg=c_host");
            println!("cargo::rustc-env=BIELA_C_HOST={}", host.display());
        }
        Ok(_) => process::exit(1),
        Err(error) => println!("cargo::error=cannot run the C compiler: {error}"),
    }
}

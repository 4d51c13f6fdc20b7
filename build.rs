//! Compiles the C host of the tests against the standard's own headers, so that a call that does
//! not fit them fails here. The program and the library need neither: without headers there is no
//! host, and the package `set-up` refuses to build the tests.

use std::path::{Path, PathBuf};
use std::{env, process};

const HOST: &str = "tests/host.c";

fn main() {
    println!("cargo::rerun-if-changed={HOST}");
    println!("cargo::rerun-if-env-changed=BIELA_FMI_HEADERS");
    println!("cargo::rustc-check-cfg=cfg(c_host)");
    // The host loads the library the Unix way, and runs where it is compiled.
    let cross = env::var("HOST") != env::var("TARGET");
    let headers = env::var_os("BIELA_FMI_HEADERS").map(PathBuf::from);
    if env::var_os("CARGO_CFG_UNIX").is_some()
        && !cross
        && let Some(headers) = headers.filter(|headers| headers.is_dir())
    {
        compile_host(&headers);
    }
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

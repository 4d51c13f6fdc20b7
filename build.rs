//! Compiles the C hosts of the tests.

use std::path::{Path, PathBuf};
use std::{env, process};

/// C hosts, each with the variable that names the program: of FMI 2.0 and of FMI 3.0.
const HOSTS: [(&str, &str); 2] = [
    ("tests/host.c", "BIELA_C_HOST"),
    ("tests/host3.c", "BIELA_C_HOST3"),
];

fn main() {
    for (source, _) in HOSTS {
        println!("cargo::rerun-if-changed={source}");
    }
    println!("cargo::rerun-if-env-changed=BIELA_FMI_HEADERS");
    println!("cargo::rustc-check-cfg=cfg(c_host)");
    let headers = env::var_os("BIELA_FMI_HEADERS").map(PathBuf::from);
    // The host loads the library the Unix way, and runs where it is compiled. Without headers,
    // which the program does not need, the package `set-up` refuses to build the tests.
    let cross = variable("HOST") != variable("TARGET");
    if env::var_os("CARGO_CFG_UNIX").is_some()
        && !cross
        && let Some(headers) = headers.filter(|headers| headers.is_dir())
    {
        for (source, variable) in HOSTS {
            compile_host(&headers, source, variable);
        }
        println!("cargo::rustc-cfg=c_host");
    }
}

fn variable(name: &str) -> String {
    env::var(name).unwrap_or_else(|_| panic!("cargo sets {name}"))
}

/// Compiles a C host against the standard's own headers: a call that does not fit them fails.
fn compile_host(headers: &Path, source: &str, name: &str) {
    let host = Path::new(&variable("OUT_DIR")).join(name.to_lowercase());
    let compiler = cc::Build::new().get_compiler();
    let mut command = compiler.to_command();
    if compiler.is_like_gnu() || compiler.is_like_clang() {
        command.args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic"]);
    }
    command.arg("-pthread");
    // No warnings about the headers, which declare `()` where newer compilers want `(void)`.
    command.arg("-isystem").arg(headers).arg(source);
    command.arg("-o").arg(&host).args(["-ldl", "-lm"]);
    match command.status() {
        Ok(status) if status.success() => {
            println!("cargo::rustc-env={name}={}", host.display());
        }
        Ok(_) => process::exit(1),
        Err(error) => println!("cargo::error=cannot run the C compiler: {error}"),
    }
}

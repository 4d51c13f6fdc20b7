//! Compiles the C hosts of the tests, and lists the runtime libraries and the solvers for browsers
//! that the program carries.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs, process};

/// C hosts, each with the variable that names the program: of FMI 2.0 and of FMI 3.0.
const HOSTS: [(&str, &str); 2] = [
    ("tests/host.c", "BIELA_C_HOST"),
    ("tests/host3.c", "BIELA_C_HOST3"),
];

/// Platforms with the extension of their libraries, as `Platform::ALL` has them.
const PLATFORMS: [(&str, &str); 5] = [
    ("linux64", "so"),
    ("win64", "dll"),
    ("darwin64", "dylib"),
    ("aarch64-linux", "so"),
    ("aarch64-darwin", "dylib"),
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
    if env::var_os("CARGO_FEATURE_CLI").is_some() {
        embed_libraries();
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

/// Writes the list of libraries that the program carries.
///
/// `BIELA_RUNTIMES` names a folder of them, one subfolder per platform; an empty value stands for
/// none, for a program that has them beside it. Without it a release build carries the library of
/// its own platform, which is built here: `cargo install` installs nothing but the program.
fn embed_libraries() {
    let out = PathBuf::from(variable("OUT_DIR"));
    let mut solvers: Vec<(&str, PathBuf)> = Vec::new();
    let mut libraries: Vec<(&str, PathBuf)> = Vec::new();
    // Debug builds have the library beside them, and are not built again for an environment.
    if variable("PROFILE") == "release" {
        println!("cargo::rerun-if-env-changed=BIELA_RUNTIMES");
        match env::var_os("BIELA_RUNTIMES") {
            Some(folder) if folder.is_empty() => {}
            Some(folder) => {
                println!("cargo::rerun-if-changed={}", folder.display());
                for (platform, extension) in PLATFORMS {
                    let file = format!("{platform}/biela.{extension}");
                    let library = Path::new(&folder).join(file);
                    if library.is_file() {
                        println!("cargo::rerun-if-changed={}", library.display());
                        libraries.push((platform, library));
                    }
                }
                for name in ["page.wasm", "studio.wasm"] {
                    let solver = Path::new(&folder).join(name);
                    if solver.is_file() {
                        println!("cargo::rerun-if-changed={}", solver.display());
                        solvers.push((name, solver));
                    }
                }
                assert!(
                    !libraries.is_empty(),
                    "BIELA_RUNTIMES: `{}` has no runtime library; run `make runtimes`",
                    folder.display()
                );
            }
            None => libraries.extend(build_library(&out)),
        }
    }
    write_list(
        &out.join("embedded_libraries.rs"),
        "/// The runtime libraries that the program carries, by the names of their platforms.\n\
         static EMBEDDED_LIBRARIES",
        libraries,
    );
    write_list(
        &out.join("embedded_solvers.rs"),
        "/// The solvers for browsers that the program carries, by the names of their files.\n\
         static EMBEDDED_SOLVERS",
        solvers,
    );
}

/// Writes the declaration of a list of files, by names.
fn write_list(to: &Path, declaration: &str, files: Vec<(&str, PathBuf)>) {
    let mut list = format!("{declaration}: &[(&str, &[u8])] = &[\n");
    for (name, path) in files {
        let path = fs::canonicalize(path).expect("the file was found");
        writeln!(list, "    ({name:?}, include_bytes!({path:?})),").expect("memory suffices");
    }
    list.push_str("];\n");
    fs::write(to, list).expect("OUT_DIR can be written");
}

/// Builds the library for the program's own platform.
fn build_library(out: &Path) -> Option<(&'static str, PathBuf)> {
    let (platform, file) = match (
        &*variable("CARGO_CFG_TARGET_OS"),
        &*variable("CARGO_CFG_TARGET_ARCH"),
    ) {
        ("linux", "x86_64") => ("linux64", "libbiela_runtime.so"),
        ("linux", "aarch64") => ("aarch64-linux", "libbiela_runtime.so"),
        ("windows", "x86_64") => ("win64", "biela_runtime.dll"),
        ("macos", _) => ("darwin64", "libbiela_runtime.dylib"),
        _ => return None,
    };
    for source in ["src", "runtime", "Cargo.toml", "Cargo.lock"] {
        println!("cargo::rerun-if-changed={source}");
    }
    let target = variable("TARGET");
    let folder = out.join("runtime");
    // Outside of the folder of this build, which cargo has locked.
    let status = Command::new(variable("CARGO"))
        .args(["build", "--release", "--package", "biela-runtime"])
        .args(["--target", &target, "--target-dir"])
        .arg(&folder)
        // Otherwise messages of panics in every FMU name folders of this machine.
        .env("CARGO_ENCODED_RUSTFLAGS", flags_of_library())
        // Cargo passes it on to the build script of the library, which would build itself again.
        .env_remove("CARGO_FEATURE_CLI")
        .status();
    assert!(
        status.is_ok_and(|status| status.success()),
        "cannot build the runtime library"
    );
    Some((platform, folder.join(target).join("release").join(file)))
}

/// Returns the flags of this build and those that shorten the paths of sources.
fn flags_of_library() -> String {
    let own = env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    let mut flags: Vec<String> = own.split('\u{1f}').map(str::to_owned).collect();
    flags.retain(|flag| !flag.is_empty());
    let home = env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| env::home_dir().map(|home| home.join(".cargo")));
    for (folder, name) in [
        (home.map(|home| home.join("registry").join("src")), "crates"),
        (Some(PathBuf::from(variable("CARGO_MANIFEST_DIR"))), "biela"),
    ] {
        let folder = folder.as_deref().and_then(Path::to_str);
        flags.extend(folder.map(|folder| format!("--remap-path-prefix={folder}={name}")));
    }
    flags.join("\u{1f}")
}

//! Lists the runtime libraries and the solvers for browsers that the program carries.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// Platforms with the extension of their libraries, as `Platform::ALL` has them.
const PLATFORMS: [(&str, &str); 5] = [
    ("linux64", "so"),
    ("win64", "dll"),
    ("darwin64", "dylib"),
    ("aarch64-linux", "so"),
    ("aarch64-darwin", "dylib"),
];

/// Writes the list of libraries that the program carries.
///
/// `BIELA_RUNTIMES` names a folder of them, one subfolder per platform; an empty value stands for
/// none, for a program that has them beside it. Without it a release build carries the library of
/// its own platform, which is built here: `cargo install` installs nothing but the program.
fn main() {
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

/// Returns the folder of the project.
fn root() -> PathBuf {
    let own = PathBuf::from(variable("CARGO_MANIFEST_DIR"));
    let root = own.ancestors().nth(2);
    root.expect("the package stands in `crates`").to_owned()
}

fn variable(name: &str) -> String {
    env::var(name).unwrap_or_else(|_| panic!("cargo sets {name}"))
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
    for source in ["src", "crates/runtime", "Cargo.toml", "Cargo.lock"] {
        println!("cargo::rerun-if-changed={}", root().join(source).display());
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
        (Some(root()), "biela"),
    ] {
        let folder = folder.as_deref().and_then(Path::to_str);
        flags.extend(folder.map(|folder| format!("--remap-path-prefix={folder}={name}")));
    }
    flags.join("\u{1f}")
}

//! Set-up of tests and benches: the program, the library and C code that they use.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

/// Returns the path of the runtime library that belongs to the running test or bench.
///
/// Cargo builds the library of a debug build together with all tests, but not with a single one:
/// then this function builds it, if there is none or only one that is older than its sources. The
/// library of a release build comes from `cargo build --release`.
///
/// # Panics
///
/// If there is no library, and it cannot be built.
#[must_use]
pub fn runtime_library() -> PathBuf {
    let program = std::env::current_exe().expect("this program runs from a file");
    let folder = program.parent().expect("a file is in a folder");
    let folder = match folder.file_name() {
        Some(name) if name == "deps" => folder.parent().expect("`deps` is in a folder"),
        _ => folder,
    };
    let name = format!(
        "{}biela_runtime{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    );
    if !cfg!(debug_assertions) {
        let library = folder.join(name);
        assert!(library.is_file(), "run `cargo build --release` first");
        return library;
    }
    let library = folder.join("examples").join(name);
    let sources = ["src", "crates/runtime", "Cargo.toml", "Cargo.lock"]
        .map(|name| newest(&root().join(name)));
    if modified(&library) < sources.into_iter().max().flatten() {
        build(folder);
        // Cargo leaves a library that needs no change as old as it is.
        File::options()
            .append(true)
            .open(&library)
            .and_then(|file| file.set_modified(SystemTime::now()))
            .unwrap_or_else(|error| panic!("{}: {error}", library.display()));
    }
    library
}

/// Returns the folder of the project.
#[must_use]
pub fn root() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = own.ancestors().nth(2);
    root.expect("the package stands in `crates`").to_owned()
}

/// Time of the last change of a file, or of any file in a folder.
fn newest(path: &Path) -> Option<SystemTime> {
    let Ok(entries) = path.read_dir() else {
        return modified(path);
    };
    entries.flatten().map(|entry| newest(&entry.path())).max()?
}

/// Time of the last change; none if there is no file.
fn modified(path: &Path) -> Option<SystemTime> {
    path.metadata().ok()?.modified().ok()
}

/// Builds the library in `folder`, `target/debug` or `target/TRIPLE/debug`.
fn build(folder: &Path) {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    command
        .current_dir(root())
        .args(["build", "--quiet", "--locked"])
        .args(["--package", "biela", "--example", "biela_runtime"]);
    let mut target = folder.parent().expect("cargo builds in `target`");
    // Cargo writes it into each target folder, its tag only into those that it made.
    if !target.join(".rustc_info.json").exists() {
        command.arg("--target").args(target.file_name());
        target = target.parent().expect("cargo builds in `target`");
    }
    let status = command.arg("--target-dir").arg(target).status();
    assert!(
        status.is_ok_and(|status| status.success()),
        "cannot build the runtime library"
    );
}

//! Where the runtime libraries are that go into an FMU.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::error::Error;
use crate::fmi::{Platform, RuntimeLibrary};

/// The runtime libraries to pack: those in `folder` if one is given, else those beside this
/// program.
///
/// A folder of libraries has one subfolder a platform, as an FMU's `binaries/` has:
/// `linux64/biela.so`, `win64/biela.dll`. Beside the program they are found where `make install`
/// puts them (`../lib/biela`) or where cargo builds them.
pub(super) fn find(folder: Option<&Path>) -> Result<Vec<RuntimeLibrary>, Error> {
    let found = match folder {
        Some(folder) => in_folder(folder),
        None => {
            let program = std::env::current_exe().map_err(|source| Error::Read {
                path: PathBuf::from("the running program"),
                source,
            })?;
            beside(&program)
        }
    };
    if !found.is_empty() {
        found.iter().try_for_each(check)?;
        return Ok(found);
    }
    let help = match folder {
        Some(folder) => format!(
            "`{}` has no runtime library; expected for example `linux64/biela.so` in it",
            folder.display()
        ),
        None => "no runtime library was found beside this program: run `make install`, or name \
                 their folder with --runtime"
            .to_owned(),
    };
    Err(Error::Usage(help))
}

fn in_folder(folder: &Path) -> Vec<RuntimeLibrary> {
    Platform::ALL
        .into_iter()
        .map(|platform| RuntimeLibrary {
            platform,
            path: folder
                .join(platform.name)
                .join(format!("biela.{}", platform.extension)),
        })
        .filter(|library| library.path.is_file())
        .collect()
}

/// Refuses what is no shared library of its platform, by the bytes with which these begin.
fn check(library: &RuntimeLibrary) -> Result<(), Error> {
    let mut start = Vec::new();
    let read = File::open(&library.path).and_then(|file| file.take(4).read_to_end(&mut start));
    if let Err(source) = read {
        return Err(Error::Read {
            path: library.path.clone(),
            source,
        });
    }
    let (kind, known): (_, &[&[u8]]) = match library.platform.extension {
        "dll" => ("PE", &[b"MZ"]),
        // Of one processor with 64 bits, or of several.
        "dylib" => ("Mach-O", &[b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe"]),
        _ => ("ELF", &[b"\x7fELF"]),
    };
    if known.iter().any(|known| start.starts_with(known)) {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "`{}` is no shared library for {}: it does not begin as {kind} files do",
        library.path.display(),
        library.platform.name
    )))
}

fn beside(program: &Path) -> Vec<RuntimeLibrary> {
    let Some(folder) = program.parent() else {
        return Vec::new();
    };
    let installed = in_folder(&folder.join("../lib/biela"));
    if !installed.is_empty() {
        return installed;
    }
    let Some(platform) = Platform::current() else {
        return Vec::new();
    };
    // Cargo builds the library beside the program, and for tests in `examples`.
    let name = format!(
        "{}biela_runtime{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    );
    [folder.join(&name), folder.join("examples").join(&name)]
        .into_iter()
        .find(|path| path.is_file())
        .map(|path| RuntimeLibrary { platform, path })
        .into_iter()
        .collect()
}

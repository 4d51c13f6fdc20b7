//! The runtime libraries that go into an FMU.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::told::error::Error;
use biela::fmi::{Platform, RuntimeLibrary};

include!(concat!(env!("OUT_DIR"), "/embedded_libraries.rs"));

/// A runtime library and the file that it comes from; none if the program carries it.
pub(super) struct FoundLibrary {
    pub(super) library: RuntimeLibrary,
    pub(super) path: Option<PathBuf>,
}

impl FoundLibrary {
    /// Returns the oldest version of glibc that the library runs with; `None` if it uses none.
    pub(super) fn glibc(&self) -> Option<String> {
        let version = glibc(&self.library.content);
        version.map(|[major, minor]| format!("{major}.{minor}"))
    }
}

/// Returns the runtime libraries in `folder` if one is given, otherwise those installed with this
/// program, in the order of the platforms.
///
/// A folder of libraries has one subfolder per platform, as an FMU's `binaries/` has:
/// `linux64/biela.so`, `win64/biela.dll`. Installed are those in `../lib/biela` beside the program,
/// and for other platforms those that the program carries; without any, the library that cargo
/// built together with the program.
pub(super) fn find(folder: Option<&Path>) -> Result<Vec<FoundLibrary>, Error> {
    let found = match folder {
        Some(folder) => in_folder(folder)?,
        None => {
            let program =
                std::env::current_exe().map_err(Error::read(Path::new("the running program")))?;
            installed(program.parent().unwrap_or(Path::new("")))?
        }
    };
    if !found.is_empty() {
        return Ok(found);
    }
    Err(Error::Usage(match folder {
        Some(folder) => format!(
            "`{}` has no runtime library; expected for example `linux64/biela.so` in it",
            folder.display()
        ),
        None => "no runtime library was found beside this program: install it as docs/install.md \
                 says, or name the folder of libraries with --runtime"
            .to_owned(),
    }))
}

/// Keeps the libraries of the platforms named; all if none is.
pub(super) fn narrow(
    found: Vec<FoundLibrary>,
    platforms: &[Platform],
) -> Result<Vec<FoundLibrary>, Error> {
    if platforms.is_empty() {
        return Ok(found);
    }
    let has = |platform: &Platform| found.iter().any(|f| f.library.platform == *platform);
    if let Some(missing) = platforms.iter().find(|platform| !has(platform)) {
        let names: Vec<&str> = found.iter().map(|f| f.library.platform.name).collect();
        return Err(Error::Usage(format!(
            "--platforms: no runtime library for {}; there are those for {}",
            missing.name,
            names.join(", ")
        )));
    }
    let is_wanted = |found: &FoundLibrary| platforms.contains(&found.library.platform);
    Ok(found.into_iter().filter(is_wanted).collect())
}

fn in_folder(folder: &Path) -> Result<Vec<FoundLibrary>, Error> {
    let paths = Platform::ALL.into_iter().map(|platform| {
        let file = format!("biela.{}", platform.extension);
        (platform, folder.join(platform.name).join(file))
    });
    let paths = paths.filter(|(_, path)| path.is_file());
    paths.map(|(platform, path)| read(platform, path)).collect()
}

/// Returns the libraries that belong to a program in the folder `programs`.
fn installed(programs: &Path) -> Result<Vec<FoundLibrary>, Error> {
    let mut found = in_folder(&programs.join("../lib/biela"))?;
    for (name, content) in EMBEDDED_LIBRARIES {
        let platform = Platform::named(name).expect("the build script knows the same names");
        if !found.iter().any(|found| found.library.platform == platform) {
            let content = Cow::Borrowed(*content);
            found.push(FoundLibrary {
                library: RuntimeLibrary { platform, content },
                path: None,
            });
        }
    }
    found.sort_by_key(|found| {
        let platform = found.library.platform;
        Platform::ALL.iter().position(|known| *known == platform)
    });
    if found.is_empty()
        && let Some(platform) = Platform::current()
    {
        // Cargo builds the library beside the program, and for tests in `examples`.
        let name = format!(
            "{}biela_runtime{}",
            std::env::consts::DLL_PREFIX,
            std::env::consts::DLL_SUFFIX
        );
        let paths = [programs.join(&name), programs.join("examples").join(&name)];
        let built = paths.into_iter().find(|path| path.is_file());
        found.extend(built.map(|path| read(platform, path)).transpose()?);
    }
    Ok(found)
}

/// Reads a library; refuses a file that is no shared library of its platform.
fn read(platform: Platform, path: PathBuf) -> Result<FoundLibrary, Error> {
    let content = std::fs::read(&path).map_err(Error::read(&path))?;
    let (format, starts): (_, &[&[u8]]) = match platform.extension {
        "dll" => ("PE", &[b"MZ"]),
        // For one processor with 64 bits, or for several.
        "dylib" => ("Mach-O", &[b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe"]),
        _ => ("ELF", &[b"\x7fELF"]),
    };
    if !starts.iter().any(|start| content.starts_with(start)) {
        return Err(Error::Usage(format!(
            "`{}` is no shared library for {}: it does not begin as {format} files do",
            path.display(),
            platform.name
        )));
    }
    let content = Cow::Owned(content);
    Ok(FoundLibrary {
        library: RuntimeLibrary { platform, content },
        path: Some(path),
    })
}

/// Returns the newest version of glibc whose symbols an ELF library names.
fn glibc(library: &[u8]) -> Option<[u32; 2]> {
    const MARK: &[u8] = b"\0GLIBC_";
    let versions = library.windows(MARK.len()).enumerate();
    let versions = versions.filter(|(_, window)| *window == MARK);
    let versions = versions.filter_map(|(at, _)| {
        let text = library[at + MARK.len()..].split(|byte| *byte == 0).next()?;
        let mut numbers = std::str::from_utf8(text).ok()?.split('.');
        let mut next = || numbers.next()?.parse().ok();
        Some([next()?, next()?])
    });
    versions.max()
}

#[cfg(test)]
mod tests {
    use super::glibc;

    #[test]
    fn the_newest_version_counts() {
        let names = b"\0GLIBC_2.2.5\0GLIBC_2.17\0puts\0GLIBC_2.4\0GLIBC_PRIVATE\0";
        assert_eq!(glibc(names), Some([2, 17]));
        assert_eq!(glibc(b"MZ"), None);
    }
}

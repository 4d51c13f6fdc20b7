//! `biela export`

use std::io::Read as _;

use crate::cli::program::{altered, biela, program, stderr, stdout};

#[test]
fn an_fmu_carries_its_picture_and_its_page() {
    let folder = tempfile::tempdir().unwrap();
    let hostile = "description = \"<script>alert('&')</script>";
    let file = altered(
        folder.path(),
        "tlv",
        &[("description = \"Variable", hostile)],
    );
    let path = folder.path().join("tlv.fmu");
    biela(&["export", &file, "-o", path.to_str().unwrap()]).success();
    let mut archive = zip::ZipArchive::new(std::fs::File::open(path).unwrap()).unwrap();
    let mut content = |name: &str| {
        let mut bytes = Vec::new();
        let mut entry = archive.by_name(name).unwrap();
        entry.read_to_end(&mut bytes).unwrap();
        bytes
    };
    assert!(content("model.png").starts_with(b"\x89PNG"));
    let page = String::from_utf8(content("documentation/index.html")).unwrap();
    let licences = String::from_utf8(content("documentation/licenses/license.txt")).unwrap();
    for wanted in [
        "biela, MIT",
        "nalgebra 0.",
        "Apache License",
        "Rust's standard library",
    ] {
        assert!(licences.contains(wanted), "{wanted}");
    }
    assert!(page.contains("&lt;script&gt;alert(") && !page.contains("<script>alert"));
    for wanted in [
        "down to 0.15 m: dead point, where body arm and body rod line up",
        "up to 0.65 m: dead point",
        ">arm_length</td><td data-what=\"Value\">0.25</td><td data-what=\"Unit\">m</td>",
        "<td data-what=\"Limits\">≥ 0.001</td>",
        ">arm.omega</td><td data-what=\"Causality\">output</td><td data-what=\"Unit\">rad/s</td>",
        ">rates</td>",
    ] {
        assert!(page.contains(wanted), "{wanted}");
    }
}

#[test]
fn a_page_shows_free_motion() {
    let folder = tempfile::tempdir().unwrap();
    let moving = |file: &str| {
        let path = folder.path().join("free.fmu");
        biela(&["export", file, "-o", path.to_str().unwrap()]).success();
        let mut archive = zip::ZipArchive::new(std::fs::File::open(path).unwrap()).unwrap();
        let mut page = String::new();
        let mut entry = archive.by_name("documentation/index.html").unwrap();
        entry.read_to_string(&mut page).unwrap();
        page
    };
    let page = moving("mechanisms/swinging_tip.toml");
    assert!(page.contains("Free motion from the start, until the stop time."));
    // Without inertia it stays, and the page tells why.
    let massless = [(
        "inertia = \"mass*length^2/12\"",
        "center = [\"-length/2\", 0]",
    )];
    let page = moving(&altered(folder.path(), "pendulum_free", &massless));
    assert!(page.contains("At its start: freedom `swing` cannot move by forces"));
}

#[test]
fn the_page_of_a_large_mechanism_shows_it_at_its_start() {
    let folder = tempfile::tempdir().unwrap();
    let page_of = |welded: usize| {
        let mut text = crate::common::text("mechanisms/pendulum.toml");
        for k in 0..welded {
            text += &format!(
                "[bodies.plate{k}]\nmarkers = {{ O = [0, 0] }}\nestimate = [{k}, 0, 0]\n\
                 [joints.weld{k}]\ntype = \"weld\"\nmarkers = [\"ground.O\", \"plate{k}.O\"]\n"
            );
        }
        let file = folder.path().join("large.toml");
        std::fs::write(&file, text).unwrap();
        let path = folder.path().join("large.fmu");
        let [file, fmu] = [&file, &path].map(|path| path.to_str().unwrap());
        biela(&["export", file, "-o", fmu]).success();
        let mut archive = zip::ZipArchive::new(std::fs::File::open(&path).unwrap()).unwrap();
        let mut page = String::new();
        let mut entry = archive.by_name("documentation/index.html").unwrap();
        entry.read_to_string(&mut page).unwrap();
        page
    };
    // With the pendulum itself two thousand.
    let moving = page_of(1_999);
    assert!(moving.contains("turns fully") && moving.contains(" over its range"));
    let still = page_of(2_000);
    assert!(!still.contains("turns fully") && !still.contains(" over its range"));
    assert!(
        still.contains("At its start: a mechanism of more than 2000 bodies is not moved here.")
    );
    assert!(still.contains("biela range --driver swing_angle finds them"));
}

#[test]
fn export_is_reproducible_and_dated_only_on_demand() {
    let folder = tempfile::tempdir().unwrap();
    let export = |name: &str, epoch: Option<&str>| {
        let path = folder.path().join(name);
        let mut command = program();
        command.envs(epoch.map(|epoch| ("SOURCE_DATE_EPOCH", epoch)));
        command
            .args(["export", "mechanisms/tlv.toml", "-o"])
            .arg(&path);
        command.assert().success();
        std::fs::read(path).unwrap()
    };
    let first = export("a.fmu", None);
    // An empty value counts as not set.
    assert!(first == export("b.fmu", Some("")));
    assert!(first != export("c.fmu", Some("1700000000")));
    assert!(export("d.fmu", Some("1700000000")) == export("e.fmu", Some("1700000000")));
    program()
        .env("SOURCE_DATE_EPOCH", "yesterday")
        .args(["export", "mechanisms/tlv.toml"])
        .assert()
        .code(2);
}

// A build for tests has no solver for pages.
#[test]
fn export_says_what_it_leaves_out() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = folder.path().join("tlv.fmu");
    let fmu = fmu.to_str().unwrap();
    let told = |options: &[&str]| {
        stderr(&biela(&[&["export", "mechanisms/tlv.toml", "-o", fmu], options].concat()).success())
    };
    let message = told(&[]);
    let end = "; no page to move by hand: no solver for pages is installed)\n";
    assert!(message.ends_with(end), "{message}");
    let message = told(&["--no-page"]);
    assert!(!message.contains("page"), "{message}");
    // The library of another version.
    let libraries = folder.path().join("libraries");
    std::fs::create_dir_all(libraries.join("win64")).unwrap();
    let library = libraries.join("win64/biela.dll");
    let export = |content: &str| {
        std::fs::write(&library, format!("MZ {content}")).unwrap();
        told(&["--runtime", libraries.to_str().unwrap()])
    };
    let warning = "warning: the library for win64 is of another version of biela";
    assert!(export("(biela runtime 0.0.1)").starts_with(warning));
    let own = concat!("(biela runtime ", env!("CARGO_PKG_VERSION"), ")");
    assert!(!export(own).contains("warning"));
}

// Each entry of an archive names the system that made it, which is to be the same everywhere.
#[test]
fn the_archive_does_not_name_its_system() {
    /// Signature of an entry in the directory of an archive; two bytes of version and system follow.
    const ENTRY: &[u8] = b"PK\x01\x02";
    const UNIX: u8 = 3;
    let folder = tempfile::tempdir().unwrap();
    let fmu = folder.path().join("tlv.fmu");
    biela(&["export", "mechanisms/tlv.toml", "-o", fmu.to_str().unwrap()]).success();
    let bytes = std::fs::read(fmu).unwrap();
    // The directory's place stands six bytes before the end; compressed bytes before it may be anything.
    let place = bytes[bytes.len() - 6..bytes.len() - 2].try_into().unwrap();
    let directory = &bytes[u32::from_le_bytes(place) as usize..];
    let entries = directory
        .windows(6)
        .filter(|window| window.starts_with(ENTRY));
    let systems: Vec<u8> = entries.map(|window| window[5]).collect();
    assert!(
        systems.len() > 3 && systems.iter().all(|system| *system == UNIX),
        "{systems:?}"
    );
}

#[test]
fn only_shared_libraries_of_their_platform_are_packed() {
    let folder = tempfile::tempdir().unwrap();
    let write = |library: &str, start: &[u8]| {
        let path = folder.path().join(library);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, start).unwrap();
    };
    let fmu = folder.path().join("tlv.fmu");
    let [fmu, libraries] = [fmu.as_path(), folder.path()].map(|path| path.to_str().unwrap());
    let export = || {
        let file = "mechanisms/tlv.toml";
        biela(&[
            "export",
            file,
            "-o",
            fmu,
            "--no-page",
            "--runtime",
            libraries,
        ])
    };
    // First bytes of files, by the standards of their formats.
    let kinds = [
        ("linux64/biela.so", &b"\x7fELF\x02\x01\x01"[..]),
        ("win64/biela.dll", b"MZ\x90\0"),
        ("darwin64/biela.dylib", b"\xcf\xfa\xed\xfe"),
    ];
    for (library, start) in kinds {
        write(library, start);
    }
    let message = stderr(&export().success());
    assert!(
        message.ends_with(" (linux64; win64; darwin64; not aarch64-linux, aarch64-darwin)\n"),
        "{message}"
    );
    for (library, start) in kinds {
        let others = kinds.iter().filter(|(other, _)| *other != library);
        let wrong = others.map(|(_, start)| *start);
        for wrong in wrong.chain([&b""[..], &start[..1], b"a text"]) {
            write(library, wrong);
            let message = stderr(&export().code(2));
            let platform = library.split('/').next().unwrap();
            let expected = format!("is no shared library for {platform}: ");
            assert!(message.contains(&expected), "{message}");
        }
        write(library, start);
    }
    // For several processors.
    write("darwin64/biela.dylib", b"\xca\xfe\xba\xbe");
    export().success();
}

#[test]
fn platforms_are_listed_and_narrow_the_export() {
    let folder = tempfile::tempdir().unwrap();
    // As far as biela looks into them.
    let glibc = b"\x7fELF\0GLIBC_2.2.5\0GLIBC_2.17\0";
    for (library, content) in [("linux64/biela.so", &glibc[..]), ("win64/biela.dll", b"MZ")] {
        let path = folder.path().join(library);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }
    let fmu = folder.path().join("tlv.fmu");
    let [fmu, libraries] = [fmu.as_path(), folder.path()].map(|path| path.to_str().unwrap());
    let list = stdout(&biela(&["platforms", "--runtime", libraries]).success());
    let lines: Vec<&str> = list.lines().collect();
    assert_eq!(lines.len(), 5, "{list}");
    for (line, [start, end]) in lines.iter().zip([
        ["linux64  ", "glibc 2.17         "],
        ["win64  ", "biela.dll"],
        ["darwin64  ", "  -"],
        ["aarch64-linux  ", "  -"],
        ["aarch64-darwin  ", "  -"],
    ]) {
        assert!(line.starts_with(start) && line.contains(end), "{line}");
    }
    let export = |platforms: &str| {
        let options = [
            "--no-page",
            "--runtime",
            libraries,
            "--platforms",
            platforms,
        ];
        biela(&[&["export", "mechanisms/tlv.toml", "-o", fmu][..], &options].concat())
    };
    let message = stderr(&export("win64").success());
    assert!(message.ends_with(" (win64)\n"), "{message}");
    let message = stderr(&export("win64,linux64").success());
    assert!(
        message.ends_with(" (linux64, glibc 2.17 or newer; win64)\n"),
        "{message}"
    );
    assert_eq!(
        stderr(&export("linux64,darwin64").code(2)),
        "error: --platforms: no runtime library for darwin64; there are those for linux64, win64\n"
    );
    let message = stderr(&export("win32").code(2));
    assert!(
        message.contains("expected one of linux64, win64, darwin64"),
        "{message}"
    );
}

/// Value and velocity of a freedom are states; nothing of it is an input.
#[test]
fn the_documentation_of_a_free_mechanism_tells_freedoms_and_states() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("free.fmu");
    let name = path.to_str().unwrap();
    biela(&["export", "mechanisms/pendulum_free.toml", "-o", name]).success();
    let mut archive = zip::ZipArchive::new(std::fs::File::open(&path).unwrap()).unwrap();
    let mut page = String::new();
    let mut entry = archive.by_name("documentation/index.html").unwrap();
    entry.read_to_string(&mut page).unwrap();
    for part in [
        "the forces move it from the starts of its freedoms",
        "<h2>Freedoms</h2>",
        ">swing.position</td><td data-what=\"Causality\">state<",
        ">swing.velocity</td><td data-what=\"Causality\">state<",
        "<code>logEvents</code>",
    ] {
        assert!(page.contains(part), "{part}");
    }
    for part in ["<h2>Drivers</h2>", "are its inputs", "input derivatives"] {
        assert!(!page.contains(part), "{part}");
    }
}

//! Notes, errors and texts of all samples, as reviewed.

use biela::mechanism::{Mechanism, Source};
use biela_tools::cli::render::render;
use biela_tools::exchange::Format;

use crate::{import, samples};

const FORMATS: [&str; 5] = ["asmt", "dxf", "linkage2", "pmks", "pylinkage"];

#[test]
fn each_sample_is_answered_as_reviewed() {
    for format in FORMATS {
        let paths = samples(format);
        assert!(paths.len() >= 5, "{format} has five samples at least");
        for path in paths {
            let name = path.file_name().expect("it has one").to_string_lossy();
            let answer = match import(&path) {
                Ok(draft) => draft.write(&name),
                Err(error) => format!("error: {error}"),
            };
            let stem = name.split('.').next().expect("it has a start");
            insta::assert_snapshot!(format!("{format}_{stem}"), answer);
        }
    }
}

#[test]
fn all_that_is_written_can_be_read() {
    for path in FORMATS.into_iter().flat_map(samples) {
        if let Ok(draft) = import(&path) {
            let source = Source::new("imported.toml", draft.write("sample"));
            let read = Mechanism::parse(&source);
            let problems = match &read {
                Ok((_, warnings)) => warnings,
                Err(errors) => errors,
            };
            let shown = render(&source, problems, false);
            assert!(problems.is_empty(), "{}:\n{shown}", path.display());
        }
    }
}

#[test]
fn the_content_tells_the_format_too() {
    for (folder, format) in FORMATS.into_iter().zip([
        Format::Asmt,
        Format::Dxf,
        Format::Linkage,
        Format::Pmks,
        Format::Pylinkage,
    ]) {
        for path in samples(folder) {
            let content = std::fs::read(&path).expect("it can be read");
            let found = Format::of("txt", &content).expect("it has a format");
            assert_eq!(found, format, "{}", path.display());
        }
    }
    let link = std::fs::read(&samples("pmks")[0]).expect("it can be read");
    assert_eq!(Format::of("pmks", &link).ok(), Some(Format::Pmks));
    // A table of numbers looks like a link; with an extension of its own it is none.
    assert!(Format::of("", b"0.1,2.3,4.5,6.7").is_ok());
    for extension in ["csv", "toml", "fmu"] {
        assert!(
            Format::of(extension, b"0.1,2.3,4.5,6.7").is_err(),
            "{extension}"
        );
        assert!(Format::of(extension, b"{}").is_err(), "{extension}");
    }
    for content in ["", "format = 1\nname = \"four_bar\"\n", "<svg/>", "a.b.c.d"] {
        assert!(Format::of("", content.as_bytes()).is_err(), "{content}");
    }
}

/// A limit of another kind, or with another sense, is no limit of an angle or a way: it is refused by its line.
#[test]
fn other_limits_are_refused() {
    let path = format!(
        "{}/tests/exchange/samples/asmt/dropped.asmt",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).expect("it can be read");
    assert!(Format::Asmt.read(text.as_bytes(), "dropped", None).is_ok());
    for (from, to) in [("RotationLimit", "DistanceLimit"), ("=<", "<")] {
        let changed = text.replacen(from, to, 1);
        let refused = Format::Asmt.read(changed.as_bytes(), "dropped", None);
        let message = refused.map(|_| ()).unwrap_err().to_string();
        assert!(message.contains(&format!("`{to}`")), "{message}");
    }
}

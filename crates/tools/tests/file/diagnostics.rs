//! Answers to bad mechanism files, message by message.
//!
//! Each file in `tests/file/diagnostics` is bad in one way; its name is the code of that problem, with
//! a word after an underscore where a code has several files.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use biela::mechanism::{Diagnostic, Mechanism, Severity, Source};
use biela_tools::cli::render::render;
use proptest::prelude::*;

fn directory(name: &str) -> PathBuf {
    set_up::root().join(name)
}

/// The TOML files of a directory by name, in order.
fn files(name: &str) -> Vec<(String, Source)> {
    let mut files: Vec<(String, Source)> = fs::read_dir(directory(name))
        .expect("the directory is there")
        .map(|entry| entry.expect("it can be read").path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "toml")
        })
        .map(|path| {
            let stem = path.file_stem().expect("it has a name").to_string_lossy();
            let source = Source::open(format!("{stem}.toml"), &path).expect("it is text");
            (stem.into_owned(), source)
        })
        .collect();
    files.sort_by(|(a, _), (b, _)| a.cmp(b));
    files
}

/// Everything said of a text; an `Err` has an error in it and an `Ok` has none.
fn diagnostics(source: &Source) -> Vec<Diagnostic> {
    let is_error = |diagnostic: &Diagnostic| diagnostic.severity == Severity::Error;
    match Mechanism::parse(source) {
        Ok((_, warnings)) => {
            assert!(!warnings.iter().any(is_error));
            warnings
        }
        Err(diagnostics) => {
            assert!(diagnostics.iter().any(is_error));
            diagnostics
        }
    }
}

/// A file in millimetres with angles in degrees has one warning for all lengths and one for all
/// angles, with a place for each.
#[test]
fn many_numbers_in_another_unit_make_one_warning() {
    let numbers = [150, 220, 310, 170, 180, 190, 210, 230];
    let markers = numbers.map(|x| format!("M{x} = [{x}, 0, 90]"));
    let text = format!(
        "format = 1\nname = \"many\"\n[ground.markers]\nO = [0.02, 0]\n{}\n\
         [bodies.a.markers]\nO = [0, 0]\n\
         [joints.O]\ntype = \"revolute\"\nmarkers = [\"ground.O\", \"a.O\"]\n",
        markers.join("\n")
    );
    let found = diagnostics(&Source::new("many.toml", text.as_str()));
    for code in ["large-length", "large-angle"] {
        let warnings: Vec<_> = found.iter().filter(|d| d.code == code).collect();
        assert_eq!(warnings.len(), 1, "{found:#?}");
        assert_eq!(warnings[0].labels.len(), numbers.len());
    }
}

#[test]
fn each_bad_file_is_answered_as_reviewed() {
    for (stem, source) in files("crates/tools/tests/file/diagnostics") {
        let diagnostics = diagnostics(&source);
        let code = stem.split('_').next().unwrap_or_default();
        assert!(
            diagnostics.iter().any(|diagnostic| diagnostic.code == code),
            "{stem}.toml has no `{code}`"
        );
        let shown = match diagnostics.as_slice() {
            // The last ones of very many tell enough.
            [.., last, end] if diagnostics.len() > 20 => &[last.clone(), end.clone()],
            all => all,
        };
        insta::assert_snapshot!(stem, render(&source, shown, false));
    }
}

#[test]
fn slips_of_syntax_are_answered_as_reviewed() {
    let slips = [
        "mass = 45*deg",
        "crank = { start = 60deg, mass = 1 }",
        "crank = { start = 30° }",
        "crank = { O = [0, 0], A = [length, 0] }",
        "crank = { O = [0, 0], A = [max(a, b)/2, 0] }",
        "crank = { coordinate = angle, start = 0 }",
        "mass = 0.5 kg",
        "mass = 0,05",
        "crank = { start = 0,05 }",
        "point = [0,05, 1]",
        "mass = .5",
        "mass = 05",
        "mass =",
        "tunable = True",
        "name = “bad”",
        r#"crank = { coordinate = "angle, markers = ["ground.O", "crank.O"], start = 0 }"#,
        r#"crank = { coordinate = angle", markers = ["ground.O", "crank.O"], start = 0 }"#,
        r#"crank = { O = ["length, 0], A = [0, 1] }"#,
        "crank = { O = ['length, 0] }",
        "crank = { O = [0, 0], A = [0.1, 0 }",
        "crank = { O = [0, 0], A = [0.1, 0]",
        "crank = { O = [0, 0] A = [0.1, 0] }",
        "crank = { O: [0, 0] }",
        "mass 0.5",
        "mass = 0.5; inertia = 2",
        "[bodies.crank",
        "[bodies.crank]\nmarkers = { O = [0, 0]  # pivot\n\nestimate = [0, 0, 0]",
        "[bodies.crank]\nestimate = [0, 0, 0\nmass = 1",
        "[bodies.crank]\nmarkers = { O = [0, 0],\n  A = [1, 0]\n  B = [2, 0] }",
        "// a comment",
        "% a comment",
        "[bodies.kürbel]",
        "kürbel = 1",
        "mass = 0.5;",
        "name = \"rod\";",
        "estimate = (0.05, 0.09, \"20*deg\")",
        "estimate = (0.05, 0.09, 0)",
        "mass = (1 + 2)*3",
        "tunable = yes",
        "start = \"60*deg'",
        "A = { markers = [\"ground.O\", \"crank.O] }\nB = { markers = [\"crank.B\", \"rod.B\"] }",
    ];
    let answers = slips.map(|slip| {
        let source = Source::new(
            "slip.toml",
            format!(
                "format = 1
{slip}
"
            ),
        );
        render(&source, &diagnostics(&source), false)
    });
    insta::assert_snapshot!(answers.join(
        "
"
    ));
}

#[test]
fn each_code_has_a_file() {
    let stems: BTreeSet<String> = files("crates/tools/tests/file/diagnostics")
        .into_iter()
        .map(|(stem, _)| stem)
        .collect();
    for code in Diagnostic::CODES {
        assert!(
            stems.contains(*code),
            "no tests/file/diagnostics/{code}.toml"
        );
    }
}

#[test]
fn no_problem_is_told_twice() {
    for (_, source) in files("crates/tools/tests/file/diagnostics") {
        let lines: Vec<String> = diagnostics(&source)
            .iter()
            .map(|diagnostic| diagnostic.one_line(&source))
            .collect();
        let distinct: BTreeSet<&String> = lines.iter().collect();
        assert_eq!(distinct.len(), lines.len(), "{lines:#?}");
    }
}

#[test]
fn the_shipped_mechanisms_have_no_problem() {
    for (_, source) in files("mechanisms") {
        let diagnostics = diagnostics(&source);
        assert!(
            diagnostics.is_empty(),
            "{}",
            render(&source, &diagnostics, false)
        );
    }
}

/// Reads and renders a text; what that gives is of no matter here.
fn survive(text: &str) {
    let source = Source::new("hostile.toml", text);
    let diagnostics = diagnostics(&source);
    for diagnostic in &diagnostics {
        for label in &diagnostic.labels {
            assert!(text.get(label.span.clone()).is_some(), "{diagnostic:?}");
        }
        assert!(!diagnostic.one_line(&source).is_empty());
    }
    let rendered = render(&source, &diagnostics, true);
    assert_eq!(rendered.is_empty(), diagnostics.is_empty());
}

#[test]
fn hostile_files_are_answered() {
    let texts = [
        String::new(),
        "\0".repeat(1000),
        "\u{feff}format = 1".to_owned(),
        "\u{fffe}\u{ffff}\u{10ffff} = 1".to_owned(),
        format!("a = {}", "[".repeat(100_000)),
        format!("a = {}", "{ a = ".repeat(100_000)),
        format!("{}a = 1", "a.".repeat(100_000)),
        format!("format = {}", "9".repeat(100_000)),
        format!("format = 0x{}", "f".repeat(100_000)),
        format!("format = 1e{}", "9".repeat(1000)),
        format!("name = \"{}\"", "n".repeat(1_000_000)),
        "garbage\r".repeat(100_000),
        "ø = ÿ\n".repeat(100_000),
        format!("[parameters]\na = \"{}1\"", "(".repeat(1_000_000)),
        format!("[parameters]\na = \"{}1\"", "1+".repeat(500_000)),
        format!("[parameters]\n{} = \"b\"", "a".repeat(1_000_000)),
    ];
    for text in texts {
        survive(&text);
    }
}

/// A file with as many bodies in a chain, each on a parameter derived from the one before.
fn chain(count: usize) -> String {
    let mut text = "format = 1\nname = \"chain\"\n[parameters]\nl0 = 1\n".to_owned();
    for link in 1..=count {
        text += &format!("l{link} = \"l{} + 1\"\n", link - 1);
    }
    text += "[ground.markers]\nB = [0, 0]\n";
    for link in 1..=count {
        text += &format!("[bodies.b{link}]\nmarkers = {{ A = [0, 0], B = [\"l{link}\", 0] }}\n");
    }
    text += "[joints]\nj1 = { type = \"revolute\", markers = [\"ground.B\", \"b1.A\"] }\n";
    for link in 2..=count {
        let before = link - 1;
        text += &format!(
            "j{link} = {{ type = \"revolute\", markers = [\"b{before}.B\", \"b{link}.A\"] }}\n"
        );
    }
    text
}

#[test]
fn a_long_file_is_read_to_its_end() {
    let source = Source::new("chain.toml", chain(10_000));
    let (mechanism, warnings) = Mechanism::parse(&source).expect("it is right");
    assert!(warnings.is_empty());
    assert_eq!(mechanism.bodies.len(), 10_000);
    assert_eq!(mechanism.derivation_order.len(), 10_000);
    let last = mechanism.parameters.last().expect("it has parameters");
    assert!((last.default - 10_001.0).abs() < f64::EPSILON);
    // And one in which every name is wrong, or every parameter waits for the last.
    survive(&chain(10_000).replace("\"b", "\"c"));
    survive(&chain(10_000).replace(" + 1", " + m"));
    survive(&chain(10_000).replace("l0 = 1", "l0 = \"l10000\""));
}

proptest! {
    // Each case reads a whole file: fewer of them, so that the test stays quick.
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn a_slip_anywhere_is_no_panic(
        file in 0_usize..100,
        slips in proptest::collection::vec(
            (any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..4_u8, any::<u8>()),
            1..6,
        ),
    ) {
        let files = files("mechanisms");
        let mut bytes = files[file % files.len()].1.text().as_bytes().to_vec();
        for (at, to, kind, byte) in slips {
            let (at, to) = (at.index(bytes.len()), to.index(bytes.len()));
            match kind {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte % 0x80),
                2 => bytes.swap(at, to),
                _ => {
                    bytes.drain(at.min(to)..at.max(to).min(at.min(to) + 8));
                }
            }
        }
        survive(&String::from_utf8_lossy(&bytes));
    }
}

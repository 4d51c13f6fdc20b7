//! The part of a page on which a mechanism is moved by hand: its solver, controls and scripts.

use std::fmt::Write as _;
use std::io::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::{Compression, GzBuilder};
use serde_json::{Value, json};

use crate::drawing::animation::{fill, page_with};
use crate::drawing::svg::escape;
use biela::mechanism::{Mechanism, Source};

const MAIN: &str = include_str!("../../../../page/scripts/live.html");
/// The licences of what is inside the solver.
const LICENCES: &str = include_str!("../../../../page/licenses.txt");
const SHARED: &str = include_str!("../../../../page/scripts/shared.js");
/// Style of the part.
pub(in crate::cli) const STYLE: &str = include_str!("../../../../page/scripts/live.css");
/// The scripts of a mechanism; each uses only those before it.
pub(in crate::cli) const SCRIPTS: [&str; 11] = [
    include_str!("../../../../page/scripts/solver.js"),
    include_str!("../../../../page/scripts/picture.js"),
    include_str!("../../../../page/scripts/hand.js"),
    include_str!("../../../../page/scripts/controls.js"),
    include_str!("../../../../page/scripts/play.js"),
    include_str!("../../../../page/scripts/axis.js"),
    include_str!("../../../../page/scripts/chart.js"),
    include_str!("../../../../page/scripts/course.js"),
    include_str!("../../../../page/scripts/files.js"),
    include_str!("../../../../page/scripts/link.js"),
    include_str!("../../../../page/scripts/live.js"),
];

/// The script that starts the mechanisms of a page.
const START: &str = include_str!("../../../../page/scripts/start.js");

/// Returns a page for a mechanism: one HTML file, with this element for the solver; see [`solver`].
/// Its *Edit* leads to a `studio`, if there is one.
pub(in crate::cli) fn page(
    source: &Source,
    mechanism: &Mechanism,
    solver: &str,
    studio: Option<&str>,
) -> String {
    let main = main(source, mechanism, &attribute("studio", studio)) + solver + &script();
    page_with(&mechanism.name, &mechanism.description, &main, STYLE)
}

/// Returns the part of a page for a mechanism; the page has the [`solver`] and the [`script`], too.
/// `attributes` are those of [`attribute`].
pub(in crate::cli) fn main(source: &Source, mechanism: &Mechanism, attributes: &str) -> String {
    let file = file(source, Some(mechanism));
    fill(
        MAIN,
        &[
            ("attributes", attributes),
            // A text in it may not end the script.
            ("file", &file.to_string().replace('<', "\\u003c")),
        ],
    )
}

/// Returns an attribute of the part, if it has a value: `token`, with which the page may write the file
/// of `biela watch`, or `studio`, the address of a studio.
pub(in crate::cli) fn attribute(name: &str, value: Option<&str>) -> String {
    value.map_or_else(String::new, |value| {
        format!(" data-{name}=\"{}\"", escape(value))
    })
}

/// Returns a file as pages open it: its name, its text and, of a file without errors, the tables that it
/// names.
pub(in crate::cli) fn file(source: &Source, mechanism: Option<&Mechanism>) -> Value {
    let files = mechanism.map_or(&[][..], |mechanism| &mechanism.table_files);
    let files: Vec<[&str; 2]> = (files.iter())
        .map(|file| [&*file.name, &*file.text])
        .collect();
    let name = source.name().rsplit(['/', '\\']).next().unwrap_or_default();
    json!({ "name": name, "text": source.text(), "files": files })
}

/// Returns the element with the packed solver. The same solver gives the same text.
pub(in crate::cli) fn solver(wasm: &[u8]) -> String {
    let packed = packed(wasm);
    format!("<script type=\"text/plain\" id=\"live-solver\">{packed}</script>")
}

/// Returns the element for a solver that stands in another file, the script of [`shared_solver`].
pub(in crate::cli) fn solver_in(script: &str) -> String {
    let script = escape(script);
    format!(
        "<script type=\"text/plain\" id=\"live-solver\"></script><script src=\"{script}\"></script>"
    )
}

/// Returns the script that gives the packed solver to a page.
pub(in crate::cli) fn shared_solver(wasm: &[u8]) -> String {
    fill(SHARED, &[("solver", &packed(wasm))])
}

/// Returns bytes as base64 of gzip; the same bytes give the same text.
pub(in crate::cli) fn packed(bytes: &[u8]) -> String {
    let mut packer = GzBuilder::new().write(Vec::new(), Compression::best());
    let packed = (packer.write_all(bytes)).and_then(|()| packer.finish());
    STANDARD.encode(packed.expect("memory takes all bytes"))
}

/// Returns the elements with the licences, packed, and with the scripts, as one module: imports and
/// exports between them fall away.
pub(in crate::cli) fn script() -> String {
    let scripts = SCRIPTS.into_iter().chain([START]);
    format!("{}\n{}", licences(LICENCES), module(scripts))
}

/// Returns the element with licences, packed.
pub(in crate::cli) fn licences(text: &str) -> String {
    let packed = packed(text.as_bytes());
    format!("<script type=\"text/plain\" id=\"live-licences\">{packed}</script>")
}

/// Returns scripts as one module.
pub(in crate::cli) fn module(scripts: impl IntoIterator<Item = &'static str>) -> String {
    let mut module = "<script type=\"module\">\n".to_owned();
    for line in scripts.into_iter().flat_map(str::lines) {
        if !line.starts_with("import ") {
            let _ = writeln!(module, "{}", line.strip_prefix("export ").unwrap_or(line));
        }
    }
    module + "</script>"
}

#[cfg(test)]
pub(in crate::cli) mod tests {
    use super::*;

    #[test]
    fn scripts_become_one_without_imports_and_exports() {
        let script = script();
        let lines = || script.lines();
        assert!(!lines().any(|line| line.starts_with("import ") || line.starts_with("export ")));
        assert!(lines().any(|line| line.starts_with("class Solver")));
    }

    #[test]
    fn scripts_do_not_declare_a_name_twice() {
        is_free_of_doubles(&script());
    }

    pub(in crate::cli) fn is_free_of_doubles(script: &str) {
        let names = script.lines().flat_map(|line| {
            let word = ["const ", "function ", "async function ", "class ", "let "]
                .iter()
                .find_map(|word| line.strip_prefix(word));
            let list = word.unwrap_or_default().trim_start_matches('[');
            let end = list.find(['=', '(', '{', ']']).unwrap_or(list.len());
            let names = list[..end].split(',').map(|name| name.trim().to_owned());
            names.filter(|name| !name.is_empty()).collect::<Vec<_>>()
        });
        let mut names: Vec<String> = names
            .map(|name| name.replace(" extends Error", ""))
            .collect();
        assert!(names.len() > 20, "{names:?}");
        names.sort();
        for pair in names.windows(2) {
            assert_ne!(pair[0], pair[1]);
        }
    }

    #[test]
    fn a_text_cannot_end_its_script() {
        let text = include_str!("../../../../../mechanisms/pendulum.toml");
        let source = Source::new("a/b.toml", format!("# </script>\n{text}"));
        let (mechanism, _) = Mechanism::parse(&source).expect("it is the example");
        let main = main(&source, &mechanism, "");
        assert!(!main.contains("# </script>") && main.contains("\"name\":\"b.toml\""));
    }
}

//! The page of the studio, and what stands beside it.

use serde_json::{Value, json};

use super::live::{SCRIPTS, licences, module, packed};
use crate::drawing::animation::{STYLE, fill, parts_script};
use biela::mechanism::Mechanism;

const PAGE: &str = include_str!("../../../../studio/scripts/studio.html");
const OWN_STYLE: &str = include_str!("../../../../studio/scripts/studio.css");
/// The licences of what is inside the solver, and inside the text editor.
const LICENCES: &str = include_str!("../../../../studio/licenses.txt");
const EDITOR_LICENCES: &str = include_str!("../../../../studio/editor/licenses.txt");
const EDITOR: &str = include_str!("../../../../studio/editor/bundle.js");
const LIVE: &str = include_str!("../../../../page/scripts/live.html");
/// The scripts, behind those of a mechanism that moves; each uses only those before it.
const OWN_SCRIPTS: [&str; 15] = [
    include_str!("../../../../studio/scripts/units.js"),
    include_str!("../../../../studio/scripts/dialogs.js"),
    include_str!("../../../../studio/scripts/disk.js"),
    include_str!("../../../../studio/scripts/drafts.js"),
    include_str!("../../../../studio/scripts/background.js"),
    include_str!("../../../../studio/scripts/sheet.js"),
    include_str!("../../../../studio/scripts/snap.js"),
    include_str!("../../../../studio/scripts/tools.js"),
    include_str!("../../../../studio/scripts/design.js"),
    include_str!("../../../../studio/scripts/inspector.js"),
    include_str!("../../../../studio/scripts/guide.js"),
    include_str!("../../../../studio/scripts/export.js"),
    include_str!("../../../../studio/scripts/caret.js"),
    include_str!("../../../../studio/scripts/complete.js"),
    include_str!("../../../../studio/scripts/studio.js"),
];

/// The beginning of a page.
pub(in crate::cli) struct Beginning<'a> {
    /// The file to open: `name`, `text` and `files`, names with contents.
    pub(in crate::cli) file: Option<Value>,
    /// With these the page may write the file on the disk: a token, the version of the file, and a word
    /// for its place.
    pub(in crate::cli) disk: Option<[String; 3]>,
    /// Names of the parts beside the page: platforms that have a library, and `page`.
    pub(in crate::cli) parts: Vec<String>,
    /// Mechanisms to begin from: `name`, `description`, `text` and `files`.
    pub(in crate::cli) templates: &'a [Value],
}

/// Returns the page with the element of the studio's solver in it; see [`solver`](super::live::solver).
pub(in crate::cli) fn page(solver: &str, beginning: &Beginning) -> String {
    let disk = beginning.disk.as_ref();
    let data = json!({
        "file": beginning.file,
        "token": disk.map(|[token, _, _]| token),
        "version": disk.map(|[_, version, _]| version),
        "place": disk.map(|[_, _, place]| place),
        "parts": beginning.parts,
        "templates": beginning.templates,
        "schema": Mechanism::schema(),
    });
    let live = fill(LIVE, &[("attributes", ""), ("file", "null")]);
    let all_licences = format!("{LICENCES}\n{EDITOR_LICENCES}");
    let scripts = SCRIPTS.into_iter().chain([EDITOR]).chain(OWN_SCRIPTS);
    fill(
        PAGE,
        &[
            (
                "style",
                &format!("{STYLE}{}{OWN_STYLE}", super::live::STYLE),
            ),
            ("live", &live),
            // A text in it may not end the script.
            ("data", &data.to_string().replace('<', "\\u003c")),
            ("solver", &format!("{solver}\n{}", licences(&all_licences))),
            ("script", parts_script()),
            ("module", &module(scripts)),
        ],
    )
}

/// Returns the script that gives a part to the page.
pub(in crate::cli) fn part(name: &str, content: &[u8]) -> String {
    let packed = packed(content);
    format!("(globalThis.bielaParts ??= {{}})[\"{name}\"] = \"{packed}\";\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::pages::live::tests::is_free_of_doubles;

    #[test]
    fn scripts_do_not_declare_a_name_twice() {
        let scripts = SCRIPTS.into_iter().chain(OWN_SCRIPTS);
        is_free_of_doubles(&module(scripts));
    }
}

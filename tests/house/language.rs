//! The language of comments: a comment opens with its subject or its verb.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Words with which no comment opens: the reader would learn the subject last.
const QUESTIONS: [&str; 5] = ["What", "How", "Where", "Of", "So"];

#[test]
fn comments_open_with_their_subject() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["src", "tests", "crates"];
    let files: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| rust_files(&root.join(folder)))
        .collect();
    assert!(files.len() > 200, "only {} files were found", files.len());
    let mut found = String::new();
    for file in &files {
        let text = std::fs::read_to_string(file).expect("a source is text");
        let mut before = None;
        for (number, line) in (1..).zip(text.lines()) {
            let comment = comment(line);
            if let Some(text) = comment
                && before.is_none_or(str::is_empty)
                && QUESTIONS.contains(&text.split(' ').next().unwrap_or_default())
            {
                let place = file.strip_prefix(root).expect("it is below").display();
                let _ = writeln!(found, "{place}:{number}: {text}");
            }
            before = comment;
        }
    }
    assert!(
        found.is_empty(),
        "begin with the subject or the verb:\n{found}"
    );
}

/// Returns the text of a line that is a comment, with or without documentation.
fn comment(line: &str) -> Option<&str> {
    let text = line.trim_start().strip_prefix("//")?;
    Some(text.trim_start_matches(['/', '!']).trim())
}

/// Returns the Rust files in a folder and the folders in it.
pub(super) fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("it can be read").path();
        if path.is_dir() {
            if path.file_name().is_none_or(|name| name != "target") {
                files.extend(rust_files(&path));
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

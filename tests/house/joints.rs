//! Joints are asked by role: only the files of the recipe name their kinds.

use std::path::Path;

use crate::language::rust_files;

/// Files and folders of both libraries that name kinds of joints, as the recipe in `docs/inside.md` lists them.
const RECIPE: [&str; 7] = [
    "mechanism/joint.rs",
    "mechanism/read/joint/",
    "mechanism/reaction.rs",
    "kinematics/system/joint/",
    "drawing/symbol/mod.rs",
    "drawing/symbol/joint_letter.rs",
    // The draft of an import has kinds of its own.
    "exchange/",
];

#[test]
fn only_the_files_of_the_recipe_name_kinds_of_joints() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let roots = ["src", "crates/tools/src"].map(|folder| project.join(folder));
    let files = roots
        .iter()
        .flat_map(|root| rust_files(root).into_iter().map(move |file| (root, file)));
    let mut listed = [false; RECIPE.len()];
    let mut others = Vec::new();
    for (root, file) in files {
        let text = std::fs::read_to_string(&file).expect("a source is text");
        let path = file.strip_prefix(root).expect("it is below");
        let path = path.to_str().expect("names are ASCII");
        if !text.contains("JointKind::") || path.ends_with("tests.rs") {
            continue;
        }
        match RECIPE.iter().position(|own| path.starts_with(own)) {
            Some(own) => listed[own] = true,
            None => others.push(path.to_owned()),
        }
    }
    assert!(
        others.is_empty(),
        "ask `Joint` by its role: {}",
        others.join(", ")
    );
    assert_eq!(listed, [true; RECIPE.len()], "all entries are needed");
}

//! The gallery of the shipped mechanisms.

use crate::common::{folder, stems};
use crate::drawing::pictures::picture;

#[test]
fn the_gallery_shows_what_is_drawn() {
    let names = stems("mechanisms", "toml");
    assert_eq!(
        stems("mechanisms/pictures", "svg"),
        names,
        "run `make refresh`"
    );
    let page = std::fs::read_to_string(folder("mechanisms/README.md")).unwrap_or_default();
    for name in names {
        let path = folder("mechanisms/pictures").join(format!("{name}.svg"));
        let kept = std::fs::read_to_string(path).unwrap_or_default();
        assert!(
            picture(&name) == kept,
            "the picture of {name} has changed: run `make refresh` and look at mechanisms/pictures/{name}.svg"
        );
        assert!(
            page.contains(&format!("]({name}.toml)"))
                && page.contains(&format!("(pictures/{name}.svg)")),
            "{name}: run `make refresh`"
        );
    }
}

#[test]
fn the_gallery_lists_nothing_else() {
    let names = stems("mechanisms", "toml");
    let page = std::fs::read_to_string(folder("mechanisms/README.md")).unwrap_or_default();
    let mut listed: Vec<&str> = page
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
        .filter_map(|link| link.strip_suffix(".toml"))
        .collect();
    // The page has them in groups.
    listed.sort_unstable();
    assert_eq!(listed, names, "run `make refresh`");
}

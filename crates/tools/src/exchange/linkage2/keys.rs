//! Elements and attributes of a document: those that are taken, and those that only concern the
//! picture.

use super::xml::Element;
use crate::exchange::draft::Draft;
use crate::exchange::others::Others;

/// Element, attributes and children that the reader takes, and those of the picture only.
struct Keys {
    element: &'static str,
    taken: &'static [&'static str],
    seen: &'static [&'static str],
}

/// All elements of a document.
const KEYS: [Keys; 9] = [
    Keys {
        element: "linkage2",
        taken: &["program", "connector", "Link", "element", "ratios"],
        seen: &["background", "selected"],
    },
    Keys {
        element: "program",
        taken: &["units"],
        seen: &[
            "zoom",
            "xoffset",
            "yoffset",
            "scalefactor",
            "viewlayers",
            "editlayers",
        ],
    },
    Keys {
        element: "connector",
        taken: &[
            "id",
            "name",
            "layer",
            "x",
            "y",
            "anchor",
            "input",
            "rpm",
            "limitangle",
            "startoffset",
            "alwaysmanual",
            "slider",
            "slidelimit",
            "slideradius",
            "draw",
            "fastenlink",
            "fastenconnector",
            "measurementelement",
        ],
        seen: &[
            "color",
            "usercolor",
            "linesize",
            "drawcircle",
            "shape",
            "labels",
            "angles",
        ],
    },
    Keys {
        element: "Link",
        taken: &[
            "id",
            "name",
            "layer",
            "connector",
            "actuator",
            "throw",
            "cpm",
            "startoffset",
            "alwaysmanual",
            "gear",
            "fastenlink",
            "fastenconnector",
            "measurementelement",
        ],
        seen: &[
            "color",
            "usercolor",
            "linesize",
            "solid",
            "locked",
            "shape",
            "labels",
            "angles",
            "measurementline",
        ],
    },
    Keys {
        element: "ratios",
        taken: &["ratio"],
        seen: &[],
    },
    Keys {
        element: "ratio",
        taken: &["type", "sizeassize", "link"],
        seen: &[],
    },
    Keys {
        element: "link",
        taken: &["id", "size"],
        seen: &[],
    },
    Keys {
        element: "slidelimit",
        taken: &["id"],
        seen: &[],
    },
    // A connector of a link, and what something is fastened to.
    Keys {
        element: "",
        taken: &["id"],
        seen: &[],
    },
];

/// Notes elements and attributes that do not change the mechanism, and those that are not known.
pub(super) fn note_others(root: &Element, draft: &mut Draft) {
    let mut others = Others::default();
    collect(&mut others, root, "");
    others.note(draft);
}

/// Collects the names below an element; `parent` is the name of the element above.
fn collect(others: &mut Others, element: &Element, parent: &str) {
    let name = match (&*element.name, parent) {
        ("connector", "Link" | "element") => "",
        ("element", _) => "Link",
        (name, _) => name,
    };
    let keys = KEYS.iter().find(|keys| keys.element == name);
    let keys = keys.unwrap_or(&KEYS[KEYS.len() - 1]);
    for (key, value) in &element.attributes {
        if !matches!(&**value, "" | "0" | "false") {
            others.sort(name, key, keys.taken, keys.seen);
        }
    }
    for child in &element.children {
        // The selection is empty as a rule.
        let is_empty = child.children.is_empty() && child.attributes.is_empty();
        if child.name != "selected" || !is_empty {
            others.sort(name, &child.name, keys.taken, keys.seen);
        }
        if !keys.seen.contains(&&*child.name) {
            collect(others, child, &element.name);
        }
    }
}

//! The page on which an animation plays.

use super::Animation;
use super::film::film;
use super::picture::picture;
use super::stage::Stage;
use crate::drawing::scene::Scene;
use crate::drawing::svg::escape;

const PAGE: &str = include_str!("page.html");
const PLAYER: &str = include_str!("player.html");
/// Style of pages with moving pictures.
pub const STYLE: &str = include_str!("player.css");
const SCRIPT: &str = concat!(include_str!("parts.js"), include_str!("player.js"));

/// Returns a page that plays an animation: one HTML file that needs no other.
///
/// The same animation gives the same bytes.
#[must_use]
pub fn page(animation: &Animation) -> String {
    let Scene {
        name, description, ..
    } = &animation.scene;
    page_with(name, description, &player(animation), "")
}

/// Returns a page with [`player`]s in it: one HTML file that needs no other. `main`, HTML with a
/// `style` of its own, follows the title and the description; modules in it find `Parts` and
/// `arrow` of `parts.js`.
#[must_use]
pub fn page_with(title: &str, description: &str, main: &str, style: &str) -> String {
    fill(
        PAGE,
        &[
            ("title", &escape(title)),
            ("description", &escape(description)),
            ("style", &format!("{STYLE}{style}")),
            ("main", main),
            ("script", SCRIPT),
        ],
    )
}

/// Returns the script with `Parts` and `arrow`, which draw moving pictures.
#[must_use]
pub fn parts_script() -> &'static str {
    include_str!("parts.js")
}

/// Returns the part of a page that plays an animation, without the style and the script that
/// players have in common.
#[must_use]
pub fn player(animation: &Animation) -> String {
    let poses: Vec<&[f64]> = animation.moments.iter().map(|m| m.q.as_slice()).collect();
    let mut stage = Stage::new(&animation.scene, &poses, None);
    let q = poses.first().copied().unwrap_or_default();
    let film = film(animation, &mut stage).to_string();
    let last = animation.moments.len().saturating_sub(1).to_string();
    fill(
        PLAYER,
        &[
            ("picture", &picture(&animation.scene, q, &stage)),
            ("last", &last),
            // A name in it may not end the script.
            ("film", &film.replace('<', "\\u003c")),
        ],
    )
}

/// Puts values in the places of a template, `{{name}}`; places in the values are left as they are.
///
/// # Panics
///
/// Panics if a place of the template has no value, which is a defect of the template.
#[must_use]
pub fn fill(template: &str, values: &[(&str, &str)]) -> String {
    let mut pieces = template.split("{{");
    let mut filled = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (name, rest) = piece.split_once("}}").expect("places of templates end");
        let value = values.iter().find(|(known, _)| *known == name);
        filled.push_str(value.expect("places of templates have values").1);
        filled.push_str(rest);
    }
    filled
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_in_values_stay_as_they_are() {
        let filled = fill("a {{x}} b {{y}} {{x}}", &[("x", "{{y}}"), ("y", "1")]);
        assert_eq!(filled, "a {{y}} b 1 {{y}}");
        assert_eq!(fill("nothing", &[]), "nothing");
    }

    #[test]
    fn templates_have_only_known_places() {
        for (template, known) in [
            (
                PAGE,
                &["title", "description", "style", "main", "script"][..],
            ),
            (PLAYER, &["picture", "last", "film"]),
        ] {
            let values: Vec<(&str, &str)> = known.iter().map(|name| (*name, "")).collect();
            assert!(!fill(template, &values).contains("{{"));
        }
    }
}

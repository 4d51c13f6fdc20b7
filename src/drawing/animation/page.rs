//! The page on which an animation plays.

use std::io;

use quick_xml::events::BytesText;
use quick_xml::writer::Writer;

use super::Animation;
use super::film::film;
use super::stage::{Placement, Stage};
use crate::drawing::scene::Scene;
use crate::drawing::sheet::{CAPITALS, Layer, Mark, WIDTH};
use crate::drawing::svg::{self, FONT_SIZE, FONTS, Xml, number};

/// What is wider than this, in units of the sheet, is moved to and fro on small screens.
const USUAL: f64 = 1.2 * WIDTH;

const PAGE: &str = include_str!("page.html");
const PLAYER: &str = include_str!("player.html");
const STYLE: &str = include_str!("player.css");
const SCRIPT: &str = include_str!("player.js");

/// A page that plays an animation: HTML with all that it needs in itself.
///
/// The same animation gives the same bytes.
#[must_use]
pub fn page(animation: &Animation) -> String {
    let Scene {
        name, description, ..
    } = &animation.scene;
    page_with(name, description, &player(animation), "")
}

/// A page with [`player`]s in it: HTML with all that it needs in itself. Below the title and the
/// description stands `main`, HTML with a `style` of its own.
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

/// The part of a page that plays an animation, without the style and the script that players
/// have in common.
#[must_use]
pub fn player(animation: &Animation) -> String {
    let stage = Stage::new(animation);
    let film = film(animation, &stage).to_string();
    let last = animation.moments.len().saturating_sub(1).to_string();
    fill(
        PLAYER,
        &[
            ("picture", &picture(animation, &stage)),
            ("last", &last),
            // A name in it may not end the script.
            ("film", &film.replace('<', "\\u003c")),
        ],
    )
}

/// Puts values in the places of a template, `{{name}}`; what they hold is not looked at again.
///
/// # Panics
///
/// If a place of the template has no value, which is a defect of the template.
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

/// A text as text or as the value of an attribute in HTML.
#[must_use]
pub fn escape(text: &str) -> String {
    quick_xml::escape::escape(text).into_owned()
}

/// The picture of the first moment, its parts marked with what they ride on.
fn picture(animation: &Animation, stage: &Stage) -> String {
    let mut xml = Writer::new(Vec::new());
    write_picture(&mut xml, animation, stage).expect("writing to memory does not fail");
    String::from_utf8(xml.into_inner()).expect("all that is written is text")
}

fn write_picture(xml: &mut Xml, animation: &Animation, stage: &Stage) -> io::Result<()> {
    let [corner, size] = stage.view;
    let view = [corner.x, corner.y, size.x, size.y].map(number).join(" ");
    let q = animation.moments.first().map_or(&[][..], |m| &m.q);
    let placements = stage.placements(q);
    let is_wide = size.x > USUAL;
    let class = if is_wide { "stage wide" } else { "stage" };
    xml.create_element("svg")
        .with_attributes([
            ("class", class),
            ("viewBox", &view),
            ("role", "img"),
            ("aria-label", &format!("{}, moving", animation.scene.name)),
        ])
        .write_inner_content(|xml| {
            for layer in Layer::ALL {
                write_layer(xml, layer, stage, &placements)?;
            }
            for driver in &stage.lengths {
                xml.create_element("g")
                    .with_attribute(("class", "length"))
                    .with_attribute(("data-rider", driver.rider.to_string().as_str()))
                    .write_empty()?;
            }
            for class in ["arrows acceleration", "arrows velocity"] {
                xml.create_element("g")
                    .with_attribute(("class", class))
                    .write_empty()?;
            }
            write_names(xml, stage)
        })?;
    Ok(())
}

fn write_layer(
    xml: &mut Xml,
    layer: Layer,
    stage: &Stage,
    placements: &[Placement],
) -> io::Result<()> {
    let marks = stage.marks.iter().filter(|(_, mark)| mark.layer == layer);
    let marks: Vec<&(usize, Mark)> = marks.collect();
    for together in marks.chunk_by(|a, b| a.0 == b.0) {
        let rider = together[0].0;
        let mut group = xml.create_element("g").with_attributes([
            ("class", layer.name()),
            ("stroke-linecap", "round"),
            ("stroke-linejoin", "round"),
        ]);
        // Ground is the first; it keeps its place.
        if rider > 0 {
            let Placement { origin, angle } = placements[rider];
            let [x, y, degrees] = [origin.x, origin.y, angle.to_degrees()].map(number);
            let transform = format!("translate({x} {y}) rotate({degrees})");
            group = group
                .with_attribute(("data-rider", rider.to_string().as_str()))
                .with_attribute(("transform", transform.as_str()));
        }
        group.write_inner_content(|xml| {
            let mut marks = together.iter();
            marks.try_for_each(|(_, mark)| svg::write_mark(xml, mark))
        })?;
    }
    Ok(())
}

/// The names, each with its middle at its place, and the text of the scale. Fonts are as wide as
/// they are: on small screens they are larger.
fn write_names(xml: &mut Xml, stage: &Stage) -> io::Result<()> {
    let size = number(CAPITALS * FONT_SIZE);
    let names = stage.labels.iter().map(|(_, label)| &label.text);
    for (class, texts, part, anchor) in [
        ("names", names.collect::<Vec<_>>(), 0.5, "middle"),
        ("scale-text", vec![&stage.scale_text], 0.0, "start"),
    ] {
        xml.create_element("g")
            .with_attributes([
                ("class", class),
                ("font-family", FONTS),
                ("font-size", &size),
                ("text-anchor", anchor),
            ])
            .write_inner_content(|xml| {
                texts.iter().try_for_each(|text| {
                    let x = text.start.x + part * text.width();
                    xml.create_element("text")
                        .with_attributes([
                            ("x", number(x).as_str()),
                            ("y", &number(text.start.y)),
                            ("fill", &text.colour.hex()),
                        ])
                        .write_text_content(BytesText::new(&text.content))
                        .map(|_| ())
                })
            })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_filled_in_is_not_looked_at_again() {
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

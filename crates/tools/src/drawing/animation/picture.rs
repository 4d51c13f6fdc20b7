//! The moving picture at one pose, as SVG whose parts name their attachments.

use super::stage::Stage;
use crate::drawing::attachment::Placement;
use crate::drawing::lettering::FONT_SIZE;
use crate::drawing::scene::Scene;
use crate::drawing::sheet::{CAPITALS, Layer, Mark, WIDTH};
use crate::drawing::svg::{FONTS, ROUND, escape, number, path, text_element};

/// Widest picture that fits a small screen, in units of the sheet; wider ones scroll there.
const USUAL: f64 = 1.2 * WIDTH;

/// Returns the picture at the pose q. Groups that move have `data-attachment`, elastic
/// lines `data-length` and `data-points`: x and y of each point at length zero, and their changes
/// per unit of length.
pub(super) fn picture(scene: &Scene, q: &[f64], stage: &Stage) -> String {
    let [corner, size] = stage.view;
    let view = [corner.x, corner.y, size.x, size.y].map(number).join(" ");
    let class = if size.x > USUAL {
        "stage wide"
    } else {
        "stage"
    };
    let name = escape(&scene.name);
    let mut svg = format!(
        "<svg class=\"{class}\" viewBox=\"{view}\" role=\"img\" aria-label=\"{name}, moving\">"
    );
    let moving = |attachment| [format!(" data-attachment=\"{attachment}\""), String::new()];
    let changing = |mark: &Mark| [elastic_data(mark, stage), String::new()];
    svg += &groups(q, stage, &moving, &changing);
    svg += "<g class=\"arrows force\"/><g class=\"arrows acceleration\"/>\
            <g class=\"arrows velocity\"/>";
    svg += &names(stage);
    svg + "</svg>"
}

/// Returns the marks at the pose q in groups of one layer and one frame each. `moving` gives
/// further attributes and content of a group that moves, `changing` those of a mark.
pub(super) fn groups(
    q: &[f64],
    stage: &Stage,
    moving: &dyn Fn(usize) -> [String; 2],
    changing: &dyn Fn(&Mark) -> [String; 2],
) -> String {
    let placements = stage.placements(q);
    let mut svg = String::new();
    for (layer, name) in Layer::ALL {
        let marks = stage.marks.iter().filter(|(_, mark)| mark.layer == layer);
        let marks: Vec<&(usize, Mark)> = marks.collect();
        for together in marks.chunk_by(|a, b| a.0 == b.0) {
            let attachment = together[0].0;
            svg += &format!("<g class=\"{name}\" {ROUND}");
            // The first attachment is ground, at rest.
            if attachment > 0 {
                let Placement { origin, angle } = placements[attachment];
                let [x, y, degrees] = [origin.x, origin.y, angle.to_degrees()].map(number);
                let [attributes, content] = moving(attachment);
                svg += &format!(
                    "{attributes} transform=\"translate({x} {y}) rotate({degrees})\">{content}"
                );
            } else {
                svg += ">";
            }
            for (_, mark) in together {
                let [attributes, content] = changing(mark);
                let path = path(mark, &attributes);
                match path.strip_suffix("/>") {
                    Some(open) if !content.is_empty() => svg += &format!("{open}>{content}</path>"),
                    _ => svg += &path,
                }
            }
            svg += "</g>";
        }
    }
    svg
}

/// Returns the attributes of an elastic line, or nothing.
fn elastic_data(mark: &Mark, stage: &Stage) -> String {
    let Some(elastic) = &mark.elastic else {
        return String::new();
    };
    let length = stage.lengths.iter().position(|l| *l == elastic.measure);
    let length = length.expect("all lengths are known");
    let points = elastic.points.iter().flatten();
    let points: Vec<String> = points.flat_map(|p| [p.x, p.y]).map(number).collect();
    let points = points.join(" ");
    format!(" data-length=\"{length}\" data-points=\"{points}\"")
}

/// Returns the names, each with its middle at its place, and the text of the scale. The letters
/// are larger on small screens.
fn names(stage: &Stage) -> String {
    let size = number(CAPITALS * FONT_SIZE);
    let names = stage.labels.iter().map(|(_, label)| &label.text);
    let mut svg = String::new();
    for (class, texts, part, anchor) in [
        ("names", names.collect::<Vec<_>>(), 0.5, "middle"),
        ("scale-text", vec![&stage.scale_text], 0.0, "start"),
    ] {
        svg += &format!(
            "<g class=\"{class}\" font-family=\"{FONTS}\" font-size=\"{size}\" \
             text-anchor=\"{anchor}\">"
        );
        for text in texts {
            svg += &text_element(text, text.start.x + part * text.width(), "");
        }
        svg += "</g>";
    }
    svg
}

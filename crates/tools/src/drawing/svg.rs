//! A sheet as SVG 1.1.

use std::fmt::Write as _;

use super::lettering::FONT_SIZE;
use super::outline::{Outline, Point, Segment};
use super::palette::Colour;
use super::sheet::{CAPITALS, Layer, Mark, Sheet, Text};

/// Fonts that browsers have or replace by one of theirs.
pub(super) const FONTS: &str = "Helvetica, Arial, sans-serif";
/// Ends and corners of lines.
pub(super) const ROUND: &str = r#"stroke-linecap="round" stroke-linejoin="round""#;

/// Returns the drawing as an SVG document `width` pixels wide, on white or transparent.
///
/// The same drawing gives the same bytes. Texts are texts, as wide as the space that the drawing
/// has left for them, whatever the font is.
#[must_use]
pub fn write(sheet: &Sheet, width: u32, transparent: bool) -> String {
    let height = number(f64::from(width) * sheet.height / sheet.width);
    let [w, h] = [sheet.width, sheet.height].map(number);
    let mut svg = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"{width}\" \
         height=\"{height}\" viewBox=\"0 0 {w} {h}\" role=\"img\">\n"
    );
    for (element, text) in [("title", &sheet.title), ("desc", &sheet.description)] {
        if !text.is_empty() {
            svg += &format!(" <{element}>{}</{element}>\n", escape(text));
        }
    }
    if !transparent {
        let white = Colour::WHITE.hex();
        svg += &format!(" <rect width=\"{w}\" height=\"{h}\" fill=\"{white}\"/>\n");
    }
    for (layer, name) in Layer::ALL {
        let marks: Vec<&Mark> = (sheet.marks.iter()).filter(|m| m.layer == layer).collect();
        if marks.is_empty() {
            continue;
        }
        svg += &format!(" <g class=\"{name}\" {ROUND}>\n");
        for mark in marks {
            svg += &format!("  {}\n", path(mark, ""));
        }
        svg += " </g>\n";
    }
    let size = number(CAPITALS * FONT_SIZE);
    svg += &format!(" <g class=\"labels\" font-family=\"{FONTS}\" font-size=\"{size}\">\n");
    for text in &sheet.texts {
        svg += &format!("  {}\n", fitted_text(text));
    }
    svg + " </g>\n</svg>\n"
}

/// Returns the element of a line or an area, with further attributes.
pub(super) fn path(mark: &Mark, attributes: &str) -> String {
    let mut path = format!("<path d=\"{}\"{attributes}", path_data(&mark.outline));
    match mark.fill {
        None => path += " fill=\"none\"",
        Some((colour, opacity)) => {
            path += &format!(" fill=\"{}\"", colour.hex());
            if opacity < 1.0 {
                path += &format!(" fill-opacity=\"{}\"", number(opacity));
            }
        }
    }
    if let Some(stroke) = mark.stroke {
        let (colour, width) = (stroke.colour.hex(), number(stroke.width));
        path += &format!(" stroke=\"{colour}\" stroke-width=\"{width}\"");
        if !stroke.dashes.is_empty() {
            let dashes: Vec<_> = stroke.dashes.iter().copied().map(number).collect();
            let dashes = dashes.join(" ");
            path += &format!(" stroke-dasharray=\"{dashes}\" stroke-linecap=\"butt\"");
        }
    }
    path + "/>"
}

/// Returns the element of a text that is as wide as the space left for it, whatever the font is: the
/// font's letters, closer together or farther apart.
pub(super) fn fitted_text(text: &Text) -> String {
    let width = number(text.width());
    text_element(text, text.start.x, &format!("textLength=\"{width}\""))
}

/// Returns the element of a text at a place along x, with further attributes.
pub(super) fn text_element(text: &Text, x: f64, attributes: &str) -> String {
    let [x, y] = [x, text.start.y].map(number);
    let gap = if attributes.is_empty() { "" } else { " " };
    let colour = text.colour.hex();
    let content = escape(&text.content);
    format!("<text x=\"{x}\" y=\"{y}\"{gap}{attributes} fill=\"{colour}\">{content}</text>")
}

/// Returns a text as text or as the value of an attribute in XML and HTML.
#[must_use]
pub fn escape(text: &str) -> String {
    quick_xml::escape::escape(text).into_owned()
}

/// Returns an outline as the data of a path.
pub(super) fn path_data(outline: &Outline) -> String {
    let mut data = String::new();
    let mut add = |command: &str, points: &[Point]| {
        data.push_str(command);
        for (index, point) in points.iter().enumerate() {
            let gap = if index > 0 { " " } else { "" };
            let _ = write!(data, "{gap}{} {}", number(point.x), number(point.y));
        }
    };
    for segment in &outline.0 {
        match segment {
            Segment::Move(to) => add("M", &[*to]),
            Segment::Line(to) => add("L", &[*to]),
            Segment::Curve(points) => add("C", points),
            Segment::Close => add("Z", &[]),
        }
    }
    data
}

/// Returns a number with at most two decimals; numbers that differ by rounding look the same.
pub(super) fn number(value: f64) -> String {
    // Rounding to millionths first restores a number half way between two hundredths.
    let millionths = (value * 1e6).round() / 1e6;
    let hundredths = (millionths * 1e2).round() / 1e2;
    // Adding zero makes a negative zero positive.
    format!("{}", hundredths + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_do_not_show_rounding() {
        for (value, expected) in [
            (0.1 + 0.2, "0.3"),
            (-1e-9, "0"),
            (12.0, "12"),
            (0.125 + 1e-12, "0.13"),
            (0.125 - 1e-12, "0.13"),
            (-3.456, "-3.46"),
            (640.0, "640"),
        ] {
            assert_eq!(number(value), expected);
        }
    }
}

//! A sheet as SVG 1.1.

use std::fmt::Write as _;
use std::io;

use quick_xml::events::{BytesDecl, BytesText, Event};
use quick_xml::writer::Writer;

use super::outline::{Outline, Point, Segment};
use super::palette::Colour;
use super::sheet::{CAPITALS, Layer, Mark, Sheet, Text};

pub(super) type Xml = Writer<Vec<u8>>;

/// Fonts that browsers have or replace by one of theirs.
pub(super) const FONTS: &str = "Helvetica, Arial, sans-serif";
/// Size of a font over the height of its capitals.
pub(super) const FONT_SIZE: f64 = 1.39;

/// The drawing as an SVG document `width` pixels wide, on white or on nothing.
///
/// The same drawing gives the same bytes. Texts are texts, as wide as the drawing has left room
/// for, whatever the font is.
#[must_use]
pub fn write(sheet: &Sheet, width: u32, transparent: bool) -> String {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 1);
    let written = write_document(&mut xml, sheet, width, transparent);
    written.expect("writing to memory does not fail");
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    String::from_utf8(bytes).expect("all that is written is text")
}

fn write_document(xml: &mut Xml, sheet: &Sheet, width: u32, transparent: bool) -> io::Result<()> {
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let height = number(f64::from(width) * sheet.height / sheet.width);
    let view_box = format!("0 0 {} {}", number(sheet.width), number(sheet.height));
    let width = width.to_string();
    xml.create_element("svg")
        .with_attributes([
            ("xmlns", "http://www.w3.org/2000/svg"),
            ("version", "1.1"),
            ("width", &width),
            ("height", &height),
            ("viewBox", &view_box),
            ("role", "img"),
        ])
        .write_inner_content(|xml| {
            for (element, text) in [("title", &sheet.title), ("desc", &sheet.description)] {
                if !text.is_empty() {
                    xml.create_element(element)
                        .write_text_content(BytesText::new(text))?;
                }
            }
            if !transparent {
                xml.create_element("rect")
                    .with_attributes([
                        ("width", number(sheet.width).as_str()),
                        ("height", &number(sheet.height)),
                        ("fill", &Colour::WHITE.hex()),
                    ])
                    .write_empty()?;
            }
            for layer in Layer::ALL {
                write_layer(xml, layer, &sheet.marks)?;
            }
            write_texts(xml, &sheet.texts)
        })?;
    Ok(())
}

fn write_layer(xml: &mut Xml, layer: Layer, marks: &[Mark]) -> io::Result<()> {
    let mut marks = marks.iter().filter(|mark| mark.layer == layer).peekable();
    if marks.peek().is_none() {
        return Ok(());
    }
    xml.create_element("g")
        .with_attributes([
            ("class", layer.name()),
            ("stroke-linecap", "round"),
            ("stroke-linejoin", "round"),
        ])
        .write_inner_content(|xml| marks.try_for_each(|mark| write_mark(xml, mark)))?;
    Ok(())
}

pub(super) fn write_mark(xml: &mut Xml, mark: &Mark) -> io::Result<()> {
    let mut element = xml
        .create_element("path")
        .with_attribute(("d", path_data(&mark.outline).as_str()));
    element = match mark.fill {
        None => element.with_attribute(("fill", "none")),
        Some((colour, opacity)) => {
            element = element.with_attribute(("fill", colour.hex().as_str()));
            if opacity < 1.0 {
                element = element.with_attribute(("fill-opacity", number(opacity).as_str()));
            }
            element
        }
    };
    if let Some(stroke) = mark.stroke {
        element = element
            .with_attribute(("stroke", stroke.colour.hex().as_str()))
            .with_attribute(("stroke-width", number(stroke.width).as_str()));
        if !stroke.dashes.is_empty() {
            let dashes: Vec<_> = stroke.dashes.iter().copied().map(number).collect();
            element = element
                .with_attribute(("stroke-dasharray", dashes.join(" ").as_str()))
                .with_attribute(("stroke-linecap", "butt"));
        }
    }
    element.write_empty()?;
    Ok(())
}

fn write_texts(xml: &mut Xml, texts: &[Text]) -> io::Result<()> {
    let size = number(CAPITALS * FONT_SIZE);
    xml.create_element("g")
        .with_attributes([
            ("class", "labels"),
            ("font-family", FONTS),
            ("font-size", &size),
        ])
        .write_inner_content(|xml| {
            texts.iter().try_for_each(|text| {
                xml.create_element("text")
                    .with_attributes([
                        ("x", number(text.start.x).as_str()),
                        ("y", &number(text.start.y)),
                        ("textLength", &number(text.width())),
                        ("lengthAdjust", "spacingAndGlyphs"),
                        ("fill", &text.colour.hex()),
                    ])
                    .write_text_content(BytesText::new(&text.content))
                    .map(|_| ())
            })
        })?;
    Ok(())
}

fn path_data(outline: &Outline) -> String {
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

/// A number with at most two decimals, and the same for numbers that rounding tells apart.
pub(super) fn number(value: f64) -> String {
    // Half way between two hundredths lies what is meant to be there: rounding to millionths
    // first brings back what computing has moved by less.
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

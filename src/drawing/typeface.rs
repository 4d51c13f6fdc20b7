//! The machine's typeface for texts.

use fontdb::{Database, Family, Query};
use ttf_parser::{Face, OutlineBuilder};

use super::outline::{Outline, Point, Segment};
use super::sheet::{CAPITALS, Text};
use super::svg::{FONT_SIZE, FONTS};

/// Families that systems use for the last one of an SVG's [`FONTS`], or in place of the others.
const SUBSTITUTES: [&str; 6] = [
    "Liberation Sans",
    "Nimbus Sans",
    "Arimo",
    "Noto Sans",
    "DejaVu Sans",
    "Open Sans",
];

/// A typeface that is installed on the machine.
pub struct Typeface {
    /// A font file.
    data: Vec<u8>,
    /// Index of the typeface in the file.
    index: u32,
}

impl Typeface {
    /// Returns the typeface in which a browser shows the texts of an SVG, `None` if the machine
    /// has none: the first one that is installed of the SVG's families, or else of those that
    /// usually replace them.
    #[must_use]
    pub fn of_machine() -> Option<Self> {
        let mut fonts = Database::new();
        fonts.load_system_fonts();
        let named = FONTS.split(", ").map(|name| match name {
            "sans-serif" => Family::SansSerif,
            name => Family::Name(name),
        });
        let families: Vec<Family> = named.chain(SUBSTITUTES.map(Family::Name)).collect();
        let id = fonts.query(&Query {
            families: &families,
            ..Query::default()
        })?;
        let typeface = fonts.with_face_data(id, |data, index| Self {
            data: data.to_vec(),
            index,
        })?;
        typeface.face().is_some().then_some(typeface)
    }

    /// Returns the typeface ready for use, `None` if its file is damaged.
    pub(super) fn face(&self) -> Option<Face<'_>> {
        Face::parse(&self.data, self.index).ok()
    }
}

/// Returns the areas of a text's letters, which are stretched to the text's width as those of an
/// SVG. A character that the typeface lacks is its sign for these, usually a box.
pub(super) fn letters(face: &Face, text: &Text) -> Outline {
    let glyphs: Vec<_> = (text.content.chars())
        .map(|character| face.glyph_index(character).unwrap_or_default())
        .collect();
    let advance = |glyph| f64::from(face.glyph_hor_advance(glyph).unwrap_or(0));
    let natural: f64 = glyphs.iter().map(|glyph| advance(*glyph)).sum();
    let mut tracer = Tracer {
        origin: text.start,
        unit: [
            text.width() / natural,
            CAPITALS * FONT_SIZE / f64::from(face.units_per_em()),
        ],
        at: text.start,
        outline: Outline::default(),
    };
    for glyph in glyphs {
        // A blank has no outline.
        let _ = face.outline_glyph(glyph, &mut tracer);
        tracer.origin.x += tracer.unit[0] * advance(glyph);
    }
    tracer.outline
}

/// The outline of a text as far as it is traced.
struct Tracer {
    /// Origin of the present letter.
    origin: Point,
    /// Size of the typeface's unit along x and y.
    unit: [f64; 2],
    /// End of the last segment.
    at: Point,
    outline: Outline,
}

impl Tracer {
    /// Returns a point of the present letter on the sheet, where y points down.
    fn place(&self, x: f32, y: f32) -> Point {
        let [across, up] = self.unit;
        self.origin + Point::new(across * f64::from(x), -up * f64::from(y))
    }

    fn add(&mut self, segment: Segment, end: Point) {
        self.outline.0.push(segment);
        self.at = end;
    }
}

impl OutlineBuilder for Tracer {
    fn move_to(&mut self, x: f32, y: f32) {
        let end = self.place(x, y);
        self.add(Segment::Move(end), end);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let end = self.place(x, y);
        self.add(Segment::Line(end), end);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let [control, end] = [self.place(x1, y1), self.place(x, y)];
        self.add(Segment::quadratic(self.at, control, end), end);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let points = [self.place(x1, y1), self.place(x2, y2), self.place(x, y)];
        self.add(Segment::Curve(points), points[2]);
    }

    fn close(&mut self) {
        self.outline.0.push(Segment::Close);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::palette::Colour;

    #[test]
    fn letters_keep_the_width_and_height_of_their_text() {
        let Some(typeface) = Typeface::of_machine() else {
            return;
        };
        let face = typeface.face().expect("it can be read");
        let text = |content: &str| Text {
            content: content.to_owned(),
            start: Point::new(3.0, 20.0),
            colour: Colour::INK,
        };
        let corners = |text: &Text| {
            let pieces = letters(&face, text).flattened();
            let points = || pieces.iter().flatten();
            let none = Point::repeat(f64::INFINITY);
            (
                points().fold(none, |low, p| low.inf(p)),
                points().fold(-none, |high, p| high.sup(p)),
            )
        };
        let text_of_letters = text("HOUSE");
        let (low, high) = corners(&text_of_letters);
        // Beside and above letters there is at most a fifth of a capital.
        let room = 0.2 * CAPITALS;
        assert!(low.x >= 3.0 - room && low.x <= 3.0 + room, "{low}");
        let end = 3.0 + text_of_letters.width();
        assert!(high.x <= end + room && high.x >= end - room, "{high}");
        assert!((20.0 - low.y - CAPITALS).abs() < room, "{low}");
        assert!((high.y - 20.0).abs() < room, "{high}");
        assert_eq!(letters(&face, &text("  ")), Outline::default());
        // A box for a character of no typeface.
        assert!(letters(&face, &text("\u{10fffd}")).0.len() < 1000);
    }
}

//! Letters made of strokes, as a plotter or a stencil draws them: no font is needed.
//!
//! The proportions are about those of lettering on technical drawings: capitals 10 units high,
//! small letters 7, descenders 3. Two digits are a point, the first its x, the second
//! (hexadecimal) its y above the descenders, so that the baseline is at 3. A point after `~` is
//! a control point of quadratic curves; between two of them the curve passes their middle.

use super::lettering::{CAPITALS, DESCENDERS, width};
use super::outline::{Outline, Point, Segment};

/// From a letter's end to the next one's beginning, in units.
const GAP: f64 = 2.6;
/// Width of a blank, in units.
const BLANK: f64 = 2.4;

/// The strokes of the characters that names, numbers and units are made of.
const GLYPHS: [(char, &str); 75] = [
    ('A', "03 3D 63|16 56"),
    ('B', "03 0D 3D ~5D ~58 38 08|38 ~68 ~63 33 03"),
    ('C', "6B ~6D 3D ~0D 08 ~03 33 ~63 65"),
    ('D', "03 0D 2D ~6D 68 ~63 23 03"),
    ('E', "5D 0D 03 53|08 48"),
    ('F', "5D 0D 03|08 48"),
    ('G', "6B ~6D 3D ~0D 08 ~03 33 ~63 66 68 48"),
    ('H', "0D 03|6D 63|08 68"),
    ('I', "0D 03"),
    ('J', "4D 46 ~43 23 ~03 05"),
    ('K', "0D 03|6D 07|29 63"),
    ('L', "0D 03 53"),
    ('M', "03 0D 35 6D 63"),
    ('N', "03 0D 63 6D"),
    ('O', "33 ~63 68 ~6D 3D ~0D 08 ~03 33"),
    ('P', "03 0D 3D ~6D ~67 37 07"),
    ('Q', "33 ~63 68 ~6D 3D ~0D 08 ~03 33|45 62"),
    ('R', "03 0D 3D ~6D ~67 37 07|37 63"),
    ('S', "6B ~6D 3D ~0D ~08 38 ~68 ~63 33 ~03 05"),
    ('T', "0D 6D|3D 33"),
    ('U', "0D 06 ~03 33 ~63 66 6D"),
    ('V', "0D 33 6D"),
    ('W', "0D 23 4B 63 8D"),
    ('X', "03 6D|0D 63"),
    ('Y', "0D 38 6D|38 33"),
    ('Z', "0D 6D 03 63"),
    ('a', "56 ~5A ~0A ~03 ~53 56|5A 53"),
    ('b', "06 ~0A ~5A ~53 ~03 06|0D 03"),
    ('c', "49 ~4A 2A ~0A ~03 23 ~43 44"),
    ('d', "56 ~5A ~0A ~03 ~53 56|5D 53"),
    ('e', "07 57 ~5A ~0A ~03 33 ~53 54"),
    ('f', "3D ~1D 1B 13|0A 3A"),
    ('g', "56 ~5A ~0A ~03 ~53 56|5A 52 ~50 30 10"),
    ('h', "0D 03|06 ~0A 3A ~5A 57 53"),
    ('i', "0A 03|0C 0D"),
    ('j', "2A 22 ~20 00|2C 2D"),
    ('k', "0D 03|4A 06|27 43"),
    ('l', "0D 05 ~03 23"),
    ('m', "0A 03|07 ~0A 2A ~4A 47 43|47 ~4A 6A ~8A 87 83"),
    ('n', "0A 03|06 ~0A 3A ~5A 57 53"),
    ('o', "56 ~5A ~0A ~03 ~53 56"),
    ('p', "06 ~0A ~5A ~53 ~03 06|0A 00"),
    ('q', "56 ~5A ~0A ~03 ~53 56|5A 50"),
    ('r', "0A 03|06 ~0A 3A"),
    ('s', "49 ~4A 2A ~0A ~07 27 ~47 ~43 23 ~03 04"),
    ('t', "1D 15 ~13 33|0A 3A"),
    ('u', "0A 06 ~03 23 ~53 57|5A 53"),
    ('v', "0A 23 4A"),
    ('w', "0A 23 49 63 8A"),
    ('x', "0A 43|4A 03"),
    ('y', "0A 23|4A 10"),
    ('z', "0A 4A 03 43"),
    ('0', "58 ~5D ~0D ~03 ~53 58"),
    ('1', "0B 2D 23"),
    ('2', "0B ~0D 2D ~5D 5A ~58 03 53"),
    ('3', "0D 5D 29 ~59 ~53 23 ~03 04"),
    ('4', "3D 06 56|49 43"),
    ('5', "5D 0D 09 29 ~59 ~53 23 ~03 04"),
    ('6', "4D ~0C 06 ~03 ~53 ~59 ~09 06"),
    ('7', "0D 5D 23"),
    ('8', "28 ~08 ~0D 2D ~4D ~48 28 ~08 ~03 23 ~43 ~48 28"),
    ('9', "13 ~54 5A ~5D ~0D ~07 ~57 5A"),
    ('_', "01 51"),
    ('.', "03 04"),
    (':', "03 04|08 09"),
    ('-', "07 47"),
    (',', "14 13 01"),
    (';', "14 13 01|18 19"),
    ('=', "06 56|09 59"),
    ('(', "2E ~0B ~04 21"),
    (')', "0E ~2B ~24 01"),
    ('/', "02 4D"),
    ('[', "2E 0E 01 21"),
    (']', "0E 2E 21 01"),
    ('²', "0C ~0D 1D ~3D 3B ~3A 08 38"),
];

/// Returns the width of the strokes of a text whose capitals are `height` high.
fn stroke_width(text: &str, height: f64) -> f64 {
    let units: f64 = text.chars().map(advance).sum();
    (units - GAP).max(0.0) * height / CAPITALS
}

/// Returns the strokes of a text in the middle of its [`width`], whose baseline starts at a point of
/// a sheet, where y points down, and whose capitals are `height` high.
pub(super) fn strokes(text: &str, start: Point, height: f64) -> Outline {
    let unit = height / CAPITALS;
    let mut outline = Outline::default();
    let mut x = start.x + 0.5 * (width(text, height) - stroke_width(text, height));
    for character in text.chars() {
        let place = |p: Point| Point::new(x + unit * p.x, start.y - unit * (p.y - DESCENDERS));
        for stroke in strokes_of(character) {
            outline.0.extend(curve(stroke).map(place).0);
        }
        x += unit * advance(character);
    }
    outline
}

fn strokes_of(character: char) -> impl Iterator<Item = &'static str> {
    let glyph = GLYPHS.iter().find(|(known, _)| *known == character);
    glyph
        .into_iter()
        .flat_map(|(_, strokes)| strokes.split('|'))
}

fn advance(character: char) -> f64 {
    let points = strokes_of(character).flat_map(points);
    let widest = points.map(|(point, _)| point.x).reduce(f64::max);
    widest.unwrap_or(BLANK) + GAP
}

/// Returns the points of a stroke, and whether each is a control point.
fn points(stroke: &str) -> impl Iterator<Item = (Point, bool)> {
    stroke.split(' ').map(|point| {
        let digits = point.trim_start_matches('~');
        let mut digits = digits.chars().filter_map(|digit| digit.to_digit(16));
        let mut next = || f64::from(digits.next().unwrap_or(0));
        (Point::new(next(), next()), point.starts_with('~'))
    })
}

fn curve(stroke: &str) -> Outline {
    let mut segments = Vec::new();
    let mut at = Point::zeros();
    let mut control: Option<Point> = None;
    for (point, is_control) in points(stroke) {
        let end = match (control, is_control) {
            (None, true) => {
                control = Some(point);
                continue;
            }
            (Some(control), true) => 0.5 * (control + point),
            _ => point,
        };
        segments.push(match control {
            _ if segments.is_empty() => Segment::Move(end),
            None => Segment::Line(end),
            Some(control) => quadratic(at, control, end),
        });
        at = end;
        control = is_control.then_some(point);
    }
    Outline(segments)
}

/// Returns a quadratic Bézier curve as a cubic one.
fn quadratic(start: Point, control: Point, end: Point) -> Segment {
    let towards = |from: Point| from + 2.0 / 3.0 * (control - from);
    Segment::Curve([towards(start), towards(end), end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_of_a_name_has_strokes() {
        let letters = ('A'..='Z').chain('a'..='z').chain('0'..='9');
        for character in letters.chain([
            '_', '.', ':', '-', ',', ';', '=', '(', ')', '/', '[', ']', '²',
        ]) {
            let strokes: Vec<_> = strokes_of(character).collect();
            assert!(!strokes.is_empty(), "{character}");
            for (point, _) in strokes.iter().flat_map(|stroke| points(stroke)) {
                assert!(point.x <= 8.0 && point.y <= CAPITALS + DESCENDERS + 1.0);
            }
        }
    }

    // The strokes of words are about as wide as those of the font.
    #[test]
    fn strokes_are_in_the_middle_of_their_width() {
        for text in ["AmZ_9", "crank_angle", "0.25", "stick", "lengths in mm"] {
            let pieces = strokes(text, Point::new(5.0, 0.0), 7.0).flattened();
            let points = || pieces.iter().flatten().map(|p| p.x - 5.0);
            let left = points().fold(f64::INFINITY, f64::min);
            let right = points().fold(f64::NEG_INFINITY, f64::max);
            let width = width(text, 7.0);
            assert!((left + right - width).abs() < 1e-12, "{text}");
            assert!(left > -0.1 * width, "{text}: {left} {width}");
        }
    }
}

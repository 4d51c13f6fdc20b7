//! A scene at one pose, fitted on a sheet.

use super::lettering;
use super::outline::{Outline, Point};
use super::palette::Colour;
use super::scene::Scene;
use super::sheet::{Bounds, CAPITALS, Layer, MARGIN, Mark, Sheet, Stroke, Text, WIDTH};
use super::symbol::{OtherPoses, Pen, Symbol, bounds};
use biela::mechanism::DisplayUnit;

/// Greatest height of a sheet as a part of the width.
const MOST_HEIGHT: f64 = 0.8125;
/// Width of a small sheet, whose lines and letters are large.
const SMALL_WIDTH: f64 = 480.0;
/// Least median length of bars, which leaves room between pins and for names.
const ROOMY: f64 = 64.0;
/// Most growth of a sheet for that reason.
const MOST_GROWTH: f64 = 2.5;
/// Distance of lines of text.
const LINE: f64 = 2.0 * CAPITALS;
/// Rounds of fitting: symbols and labels do not grow with the scale.
const ROUNDS: usize = 5;

impl Sheet {
    /// Draws a scene with its bodies at q, \[m, m, rad\] per body, as large as the sheet permits.
    /// A mechanism of many short bars gets a larger sheet.
    #[must_use]
    pub fn new(scene: &Scene, q: &[f64]) -> Self {
        fitted(scene, q, &[], WIDTH)
    }

    /// Draws a scene with its bodies at q, and faint outlines of the bodies at further poses.
    #[must_use]
    pub fn with_poses(scene: &Scene, q: &[f64], poses: &[Vec<f64>]) -> Self {
        fitted(scene, q, poses, WIDTH)
    }

    /// Draws a scene on a smaller sheet, with larger lines and letters: for icons and phones.
    #[must_use]
    pub fn small(scene: &Scene, q: &[f64]) -> Self {
        fitted(scene, q, &[], SMALL_WIDTH)
    }
}

fn fitted(scene: &Scene, q: &[f64], poses: &[Vec<f64>], width: f64) -> Sheet {
    let all = std::iter::once(q).chain(poses.iter().map(Vec::as_slice));
    let extent = extent(scene, all);
    let size = size(scene, q, extent, width);
    let room = size - Point::repeat(2.0 * MARGIN);
    let mut scale = fitting(room * 0.8, extent);
    let mut draft = Draft::new(scene, q, poses, scale);
    for _ in 0..ROUNDS {
        // Symbols and labels need this room around the mechanism.
        let around = (draft.bounds.size() - scale * extent).map(|size| size.max(0.0));
        let next = fitting((room - around).sup(&(0.2 * room)), extent);
        if (next / scale - 1.0).abs() < 1e-3 {
            break;
        }
        scale = next;
        draft = Draft::new(scene, q, poses, scale);
    }
    draft.finish(scene, scale, size.x)
}

/// Returns the size of a sheet: `width` wide for a mechanism of few bodies, larger where the bars
/// would be too short to tell apart.
pub(super) fn size(scene: &Scene, q: &[f64], extent: Point, width: f64) -> Point {
    let usual = Point::new(width, MOST_HEIGHT * width);
    let scale = fitting(usual - Point::repeat(2.0 * MARGIN), extent);
    let mut lengths: Vec<f64> = (scene.symbols.iter())
        .filter(|symbol| matches!(symbol, Symbol::Link(_) | Symbol::Rod(_)))
        .map(|symbol| scale * bounds([symbol], q).size().norm())
        .filter(|length| *length > 0.0)
        .collect();
    lengths.sort_by(f64::total_cmp);
    let Some(median) = lengths.get(lengths.len() / 2) else {
        return usual;
    };
    let growth = (ROOMY / median).clamp(1.0, MOST_GROWTH);
    Point::new((growth * usual.x).ceil(), growth * usual.y)
}

/// Returns the greatest scale at which an extent fits.
pub(super) fn fitting(room: Point, extent: Point) -> f64 {
    let scale = (room.x / extent.x).min(room.y / extent.y);
    if scale.is_finite() { scale } else { 1.0 }
}

/// Returns the size of everything drawn to scale over all poses \[m\].
pub(super) fn extent<'a>(scene: &Scene, poses: impl Iterator<Item = &'a [f64]>) -> Point {
    let mut all = Bounds::NONE;
    for q in poses {
        all.join(&bounds(&scene.symbols, q));
    }
    let size = all.size();
    // A mechanism without any length is drawn at some scale.
    size.map(|length| length.max(1e-6 * size.max()))
}

/// A sheet whose origin is the origin of the mechanism.
struct Draft {
    marks: Vec<Mark>,
    texts: Vec<Text>,
    bounds: Bounds,
}

impl Draft {
    fn new(scene: &Scene, q: &[f64], poses: &[Vec<f64>], scale: f64) -> Self {
        let poses = OtherPoses::Shown(poses);
        let (mut marks, labels) = Pen::draw(&scene.symbols, &scene.bodies, q, scale, poses);
        marks.sort_by_key(|mark| mark.layer);
        let texts = labels.into_iter().map(|label| label.text).collect();
        let mut draft = Self {
            bounds: Bounds::NONE,
            marks,
            texts,
        };
        draft.measure();
        draft
    }

    fn measure(&mut self) {
        for mark in &self.marks {
            for point in mark.outline.flattened().iter().flatten() {
                self.bounds.add(*point);
            }
        }
        for text in &self.texts {
            self.bounds.join(&text.bounds());
        }
    }

    /// Adds the scale bar and the notes below and moves everything to its place.
    fn finish(mut self, scene: &Scene, scale: f64, width: f64) -> Sheet {
        let corner = Point::new(self.bounds.low.x, self.bounds.high.y + 16.0);
        let (bar, text) = scale_bar(corner, scale, scene.length_unit);
        self.marks.push(bar);
        self.texts.push(text);
        let mut start = corner + Point::new(0.0, CAPITALS);
        for line in notes(&scene.notes, width - 2.0 * MARGIN) {
            start.y += LINE;
            self.texts.push(Text {
                content: line,
                start,
                colour: Colour::INK,
            });
        }
        self.measure();
        let size = self.bounds.size();
        let left = (0.5 * (width - size.x)).max(MARGIN);
        let shift = Point::new(left, MARGIN) - self.bounds.low;
        for mark in &mut self.marks {
            mark.outline = mark.outline.map(|point| point + shift);
        }
        for text in &mut self.texts {
            text.start += shift;
        }
        Sheet {
            title: scene.name.clone(),
            description: scene.description.clone(),
            width,
            height: (size.y + 2.0 * MARGIN).ceil(),
            marks: self.marks,
            texts: self.texts,
        }
    }
}

/// Returns sentences in lines of a width at most.
fn notes(sentences: &[String], width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for sentence in sentences {
        let mut line = String::new();
        for word in sentence.split(' ') {
            let longer = format!("{line}{}{word}", if line.is_empty() { "" } else { " " });
            if !line.is_empty() && lettering::width(&longer, CAPITALS) > width {
                lines.push(std::mem::replace(&mut line, word.to_owned()));
            } else {
                line = longer;
            }
        }
        lines.push(line);
    }
    lines
}

/// Returns a bar of a round length and its text, in a unit.
pub(super) fn scale_bar(corner: Point, scale: f64, unit: Option<DisplayUnit>) -> (Mark, Text) {
    const LONGEST: f64 = 110.0;
    const TICK: f64 = 4.0;
    let (length, name) = round_length(LONGEST / scale, unit);
    let [start, end] = [0.0, length * scale].map(|x| corner + Point::new(x, 0.0));
    let tick = Point::new(0.0, TICK);
    let mut outline = Outline::line(&[start - tick, start + tick]);
    outline.add_line(&[start, end]);
    outline.add_line(&[end - tick, end + tick]);
    let bar = Mark::line(Layer::Scale, outline, Stroke::solid(Colour::INK, 1.2));
    let text = Text {
        content: name,
        start: end + Point::new(8.0, 0.5 * CAPITALS),
        colour: Colour::INK,
    };
    (bar, text)
}

/// Returns the greatest length of 1, 2 or 5 times a power of ten of a unit up to `longest` \[m\], and
/// its name.
fn round_length(longest: f64, unit: Option<DisplayUnit>) -> (f64, String) {
    let of_unit = unit.map_or(1.0, |unit| unit.factor);
    let longest = longest * of_unit;
    let exponent = longest.log10().floor();
    // Rounding may make a length that fits exactly seem too long.
    let digit = [5.0, 2.0]
        .into_iter()
        .find(|digit| digit * 10_f64.powf(exponent) <= longest * (1.0 + 1e-9))
        .unwrap_or(1.0);
    let length = digit * 10_f64.powf(exponent);
    // Otherwise millimetres below a metre, as on drawings.
    let (name, shift) = match unit {
        Some(unit) => (unit.name, 0.0),
        None if exponent < 0.0 => (DisplayUnit::MILLIMETRE.name, 3.0),
        None => (DisplayUnit::METRE.name, 0.0),
    };
    let value = digit * 10_f64.powf(exponent + shift);
    let decimals = (-(exponent + shift)).max(0.0) as usize;
    (length / of_unit, format!("{value:.decimals$} {name}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_bars_are_round() {
        for (longest, expected) in [
            (0.1, "100 mm"),
            (0.19, "100 mm"),
            (0.2, "200 mm"),
            (0.999, "500 mm"),
            (1.0, "1 m"),
            (7.3, "5 m"),
            (30.0, "20 m"),
            (0.0075, "5 mm"),
            (0.00034, "0.2 mm"),
        ] {
            let (length, name) = round_length(longest, None);
            assert_eq!(name, expected);
            assert!(length <= longest * (1.0 + 1e-9) && length > 0.39 * longest);
        }
        // As the lengths beside it.
        let (length, name) = round_length(0.19, Some(DisplayUnit::METRE));
        assert_eq!((length, &*name), (0.1, "0.1 m"));
    }
}

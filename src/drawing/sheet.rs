//! A scene at one pose on a sheet of paper: lines, areas and texts, whatever they are written to.

use super::lettering;
use super::outline::{Outline, Point};
use super::palette::Colour;
use super::scene::{Scene, Symbol};
use super::symbols::Pen;

/// The width of a sheet, in its own units; a line is about one wide.
pub(super) const WIDTH: f64 = 640.0;
/// The greatest height, as a part of the width.
const MOST_HEIGHT: f64 = 0.8125;
/// The width of a small sheet, whose lines and letters are large.
const SMALL_WIDTH: f64 = 480.0;
/// Half of all bars are at least so long on a sheet: there is room between pins and for names.
const ROOMY: f64 = 64.0;
/// A sheet grows by no more than this for that.
const MOST_GROWTH: f64 = 2.5;
/// What stays free around everything.
pub(super) const MARGIN: f64 = 14.0;
/// Height of capitals.
pub(super) const CAPITALS: f64 = 8.6;
/// Rounds of fitting: symbols and labels do not grow with the scale, so that the first is off.
const ROUNDS: usize = 5;

/// A drawing: y points down, the origin is at the upper left.
#[derive(Clone, Debug)]
pub struct Sheet {
    pub(super) title: String,
    pub(super) description: String,
    pub(super) width: f64,
    pub(super) height: f64,
    /// In the order in which one covers the other.
    pub(super) marks: Vec<Mark>,
    pub(super) texts: Vec<Text>,
}

/// A line or an area.
#[derive(Clone, Debug)]
pub(super) struct Mark {
    pub(super) layer: Layer,
    pub(super) outline: Outline,
    /// Colour and opacity inside.
    pub(super) fill: Option<(Colour, f64)>,
    pub(super) stroke: Option<Stroke>,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub(super) colour: Colour,
    pub(super) width: f64,
    /// Lengths of dashes and gaps in turn, none for a solid line.
    pub(super) dashes: &'static [f64],
}

/// What a mark shows; later ones cover earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Layer {
    Grid,
    Ground,
    Slider,
    Plate,
    Bar,
    Wheel,
    Trace,
    Slot,
    Block,
    Joint,
    Driver,
    Point,
    Curve,
    Scale,
}

impl Layer {
    pub(super) const ALL: [Self; 14] = [
        Self::Grid,
        Self::Ground,
        Self::Slider,
        Self::Plate,
        Self::Bar,
        Self::Wheel,
        Self::Trace,
        Self::Slot,
        Self::Block,
        Self::Joint,
        Self::Driver,
        Self::Point,
        Self::Curve,
        Self::Scale,
    ];

    /// What it shows, in a word.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::Ground => "ground",
            Self::Slider => "sliders",
            Self::Plate => "plates",
            Self::Bar => "bars",
            Self::Trace => "traces",
            Self::Wheel => "wheels",
            Self::Slot => "slots",
            Self::Block => "blocks",
            Self::Joint => "joints",
            Self::Driver => "drivers",
            Self::Point => "points",
            Self::Curve => "curves",
            Self::Scale => "scale",
        }
    }
}

/// A text on one line.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub(super) content: String,
    /// Left end of the baseline.
    pub(super) start: Point,
    pub(super) colour: Colour,
}

impl Text {
    pub(super) fn width(&self) -> f64 {
        lettering::width(&self.content, CAPITALS)
    }

    fn bounds(&self) -> Bounds {
        let descent = CAPITALS * lettering::DESCENDERS / lettering::CAPITALS;
        let mut bounds = Bounds::NONE;
        bounds.add(self.start + Point::new(0.0, descent));
        bounds.add(self.start + Point::new(self.width(), -CAPITALS));
        bounds
    }
}

/// A rectangle along the axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) low: Point,
    pub(super) high: Point,
}

impl Bounds {
    pub(super) const NONE: Self = Self {
        low: Point::new(f64::INFINITY, f64::INFINITY),
        high: Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    pub(super) fn add(&mut self, point: Point) {
        self.low = self.low.inf(&point);
        self.high = self.high.sup(&point);
    }

    pub(super) fn size(&self) -> Point {
        (self.high - self.low).map(|size| size.max(0.0))
    }
}

impl Sheet {
    /// Draws a scene with its bodies at q, \[m, m, rad\] for each, as large as the sheet permits.
    /// A mechanism of many short bars gets a larger sheet.
    #[must_use]
    pub fn new(scene: &Scene, q: &[f64]) -> Self {
        Self::of_width(scene, q, WIDTH)
    }

    /// The same on a smaller sheet: for icons and telephones, with larger lines and letters.
    #[must_use]
    pub fn small(scene: &Scene, q: &[f64]) -> Self {
        Self::of_width(scene, q, SMALL_WIDTH)
    }

    fn of_width(scene: &Scene, q: &[f64], width: f64) -> Self {
        let extent = extent(scene, std::iter::once(q));
        let size = size(scene, q, extent, width);
        let room = size - Point::repeat(2.0 * MARGIN);
        let mut scale = fitting(room * 0.8, extent);
        let mut draft = Draft::new(scene, q, scale);
        for _ in 0..ROUNDS {
            // What symbols and labels add around the mechanism itself.
            let around = (draft.bounds.size() - scale * extent).map(|size| size.max(0.0));
            let next = fitting((room - around).sup(&(0.2 * room)), extent);
            if (next / scale - 1.0).abs() < 1e-3 {
                break;
            }
            scale = next;
            draft = Draft::new(scene, q, scale);
        }
        draft.finish(scene, scale, size.x)
    }

    /// How wide it is, in pixels of a screen on which lines and letters are of usual size.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width as u32
    }
}

/// The size of a sheet that would be `width` wide if the mechanism were of few bodies: larger
/// where bars were too short to be told apart.
pub(super) fn size(scene: &Scene, q: &[f64], extent: Point, width: f64) -> Point {
    let usual = Point::new(width, MOST_HEIGHT * width);
    let scale = fitting(usual - Point::repeat(2.0 * MARGIN), extent);
    let mut lengths: Vec<f64> = (scene.symbols.iter())
        .filter(|symbol| matches!(symbol, Symbol::Link { .. } | Symbol::Rod { .. }))
        .map(|symbol| {
            let mut bounds = Bounds::NONE;
            symbol.extremes(q).into_iter().for_each(|p| bounds.add(p));
            scale * bounds.size().norm()
        })
        .filter(|length| *length > 0.0)
        .collect();
    lengths.sort_by(f64::total_cmp);
    let Some(median) = lengths.get(lengths.len() / 2) else {
        return usual;
    };
    let growth = (ROOMY / median).clamp(1.0, MOST_GROWTH);
    Point::new((growth * usual.x).ceil(), growth * usual.y)
}

/// The greatest scale at which something fits.
pub(super) fn fitting(room: Point, extent: Point) -> f64 {
    let scale = (room.x / extent.x).min(room.y / extent.y);
    if scale.is_finite() { scale } else { 1.0 }
}

/// The size of everything that has one, over all poses \[m\].
pub(super) fn extent<'a>(scene: &Scene, poses: impl Iterator<Item = &'a [f64]>) -> Point {
    let mut bounds = Bounds::NONE;
    for q in poses {
        for symbol in &scene.symbols {
            for point in symbol.extremes(q) {
                bounds.add(point);
            }
        }
    }
    let size = bounds.size();
    // A mechanism without any length is drawn at some scale.
    size.map(|length| length.max(1e-6 * size.max()))
}

/// A sheet whose origin is that of the mechanism.
struct Draft {
    marks: Vec<Mark>,
    texts: Vec<Text>,
    bounds: Bounds,
}

impl Draft {
    fn new(scene: &Scene, q: &[f64], scale: f64) -> Self {
        let mut pen = Pen::new(scene, q, scale);
        for symbol in &scene.symbols {
            pen.draw(symbol);
        }
        let (mut marks, placed) = pen.finish();
        marks.sort_by_key(|mark| mark.layer);
        let texts = placed.into_iter().map(|label| label.text).collect();
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
            let Bounds { low, high } = text.bounds();
            self.bounds.add(low);
            self.bounds.add(high);
        }
    }

    /// Adds the scale bar below and moves everything to its place.
    fn finish(mut self, scene: &Scene, scale: f64, width: f64) -> Sheet {
        let corner = Point::new(self.bounds.low.x, self.bounds.high.y + 16.0);
        let (bar, text) = scale_bar(corner, scale);
        self.marks.push(bar);
        self.texts.push(text);
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

/// A bar of a round length and its text.
pub(super) fn scale_bar(corner: Point, scale: f64) -> (Mark, Text) {
    const LONGEST: f64 = 110.0;
    const TICK: f64 = 4.0;
    let (length, name) = round_length(LONGEST / scale);
    let [start, end] = [0.0, length * scale].map(|x| corner + Point::new(x, 0.0));
    let tick = Point::new(0.0, TICK);
    let mut outline = Outline::line(&[start - tick, start + tick]);
    outline.add_line(&[start, end]);
    outline.add_line(&[end - tick, end + tick]);
    let bar = Mark {
        layer: Layer::Scale,
        outline,
        fill: None,
        stroke: Some(Stroke {
            colour: Colour::INK,
            width: 1.2,
            dashes: &[],
        }),
    };
    let text = Text {
        content: name,
        start: end + Point::new(8.0, 0.5 * CAPITALS),
        colour: Colour::INK,
    };
    (bar, text)
}

/// The greatest length of 1, 2 or 5 times a power of ten up to `longest` \[m\], and its name.
fn round_length(longest: f64) -> (f64, String) {
    let exponent = longest.log10().floor();
    // Rounding may make a length that fits exactly seem too long.
    let digit = [5.0, 2.0]
        .into_iter()
        .find(|digit| digit * 10_f64.powf(exponent) <= longest * (1.0 + 1e-9))
        .unwrap_or(1.0);
    let length = digit * 10_f64.powf(exponent);
    // Millimetres below a metre, as on drawings.
    let (unit, shift) = if exponent < 0.0 {
        ("mm", 3.0)
    } else {
        ("m", 0.0)
    };
    let value = digit * 10_f64.powf(exponent + shift);
    let decimals = (-(exponent + shift)).max(0.0) as usize;
    (length, format!("{value:.decimals$} {unit}"))
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
            let (length, name) = round_length(longest);
            assert_eq!(name, expected);
            assert!(length <= longest * (1.0 + 1e-9) && length > 0.39 * longest);
        }
    }
}

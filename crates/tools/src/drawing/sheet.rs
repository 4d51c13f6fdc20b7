//! A sheet of paper: lines, areas and texts, whatever they are written to.

use super::attachment::{Attachment, Measure};
use super::lettering;
use super::outline::{Outline, Point};
use super::palette::Colour;

/// Usual width of a sheet in its own units; a line is about one unit wide.
pub(super) const WIDTH: f64 = 640.0;
/// Margin on all sides.
pub(super) const MARGIN: f64 = 14.0;
/// Height of capitals.
pub(super) const CAPITALS: f64 = 8.6;

/// A drawing: y points down, the origin is at the upper left.
#[derive(Clone, Debug)]
pub struct Sheet {
    pub(super) title: String,
    pub(super) description: String,
    pub(super) width: f64,
    pub(super) height: f64,
    /// The marks; later ones cover earlier ones.
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
    /// The frame that the mark moves with.
    pub(super) attachment: Attachment,
    /// The outline as a function of a length that changes with the pose.
    pub(super) elastic: Option<Elastic>,
}

/// A line in the frame of its attachment whose points are affine functions of a length.
#[derive(Clone, Debug)]
pub(super) struct Elastic {
    pub(super) measure: Measure,
    /// Each point at length zero, and its change per unit of length.
    pub(super) points: Vec<[Point; 2]>,
}

/// Colour, width and dashes of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub(super) colour: Colour,
    pub(super) width: f64,
    /// Lengths of dashes and gaps in turn, none for a solid line.
    pub(super) dashes: &'static [f64],
}

/// Kinds of marks; later kinds cover earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Layer {
    Grid,
    Ground,
    Pose,
    Shape,
    Slider,
    Plate,
    Bar,
    Wheel,
    Dimension,
    Trace,
    Slot,
    Block,
    Joint,
    Driver,
    Point,
    Force,
    Curve,
    Scale,
}

impl Layer {
    /// All layers with their names, in the order in which later ones cover earlier ones.
    pub(super) const ALL: [(Self, &'static str); 18] = [
        (Self::Grid, "grid"),
        (Self::Ground, "ground"),
        (Self::Pose, "poses"),
        (Self::Shape, "shapes"),
        (Self::Slider, "sliders"),
        (Self::Plate, "plates"),
        (Self::Bar, "bars"),
        (Self::Wheel, "wheels"),
        (Self::Dimension, "dimensions"),
        (Self::Trace, "traces"),
        (Self::Slot, "slots"),
        (Self::Block, "blocks"),
        (Self::Joint, "joints"),
        (Self::Driver, "drivers"),
        (Self::Point, "points"),
        (Self::Force, "forces"),
        (Self::Curve, "curves"),
        (Self::Scale, "scale"),
    ];
}

/// A text on one line.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub(super) content: String,
    /// Left end of the baseline.
    pub(super) start: Point,
    pub(super) colour: Colour,
}

/// A rectangle along the axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) low: Point,
    pub(super) high: Point,
}

impl Sheet {
    /// Returns the width in pixels of a screen on which lines and letters have their usual size.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width as u32
    }
}

impl Mark {
    /// Returns a line that does not move.
    pub(super) fn line(layer: Layer, outline: Outline, stroke: Stroke) -> Self {
        Self {
            layer,
            outline,
            fill: None,
            stroke: Some(stroke),
            attachment: Attachment::Ground,
            elastic: None,
        }
    }

    /// Returns a mark that is drawn at the pose `home`, at another pose.
    pub(super) fn moved(&self, home: &[f64], q: &[f64], scale: f64) -> Self {
        let [from, to] = [home, q].map(|q| self.attachment.placement(q, scale));
        let outline = match &self.elastic {
            Some(elastic) => {
                let outline = elastic.outline(q, scale);
                outline.map(|point| to.outside(point))
            }
            None => (self.outline.clone()).map(|point| to.outside(from.inside(point))),
        };
        Self {
            outline,
            ..self.clone()
        }
    }
}

impl Elastic {
    /// Returns the line on a sheet of `scale` units per metre at q, in the frame of its attachment.
    pub(super) fn outline(&self, q: &[f64], scale: f64) -> Outline {
        let length = self.measure.value(q, scale);
        let points = self.points.iter();
        let points = points.map(|[origin, change]| origin + length * change);
        Outline::line(&points.collect::<Vec<_>>())
    }
}

impl Stroke {
    /// Returns a solid line.
    pub(super) fn solid(colour: Colour, width: f64) -> Self {
        Self {
            colour,
            width,
            dashes: &[],
        }
    }
}

impl Text {
    pub(super) fn width(&self) -> f64 {
        lettering::width(&self.content, CAPITALS)
    }

    /// Returns the size of its capitals.
    pub(super) fn size(&self) -> Point {
        Point::new(self.width(), CAPITALS)
    }

    pub(super) fn bounds(&self) -> Bounds {
        let descent = CAPITALS * lettering::DESCENDERS / lettering::CAPITALS;
        let mut bounds = Bounds::NONE;
        bounds.add(self.start + Point::new(0.0, descent));
        bounds.add(self.start + Point::new(self.width(), -CAPITALS));
        bounds
    }
}

impl Bounds {
    pub(super) const NONE: Self = Self {
        low: Point::new(f64::INFINITY, f64::INFINITY),
        high: Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    /// Returns the rectangle of a size about a point.
    pub(super) fn about(center: Point, size: Point) -> Self {
        Self {
            low: center - 0.5 * size,
            high: center + 0.5 * size,
        }
    }

    pub(super) fn add(&mut self, point: Point) {
        self.low = self.low.inf(&point);
        self.high = self.high.sup(&point);
    }

    pub(super) fn join(&mut self, other: &Self) {
        self.low = self.low.inf(&other.low);
        self.high = self.high.sup(&other.high);
    }

    pub(super) fn size(&self) -> Point {
        (self.high - self.low).map(|size| size.max(0.0))
    }

    /// Returns whether two rectangles have an area in common.
    pub(super) fn meets(&self, other: &Self) -> bool {
        self.low.x < other.high.x
            && other.low.x < self.high.x
            && self.low.y < other.high.y
            && other.low.y < self.high.y
    }

    /// Returns the area that two rectangles have in common.
    pub(super) fn overlap(&self, other: &Self) -> f64 {
        let common = self.high.inf(&other.high) - self.low.sup(&other.low);
        common.x.max(0.0) * common.y.max(0.0)
    }
}

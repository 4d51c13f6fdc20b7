//! Frames that marks and labels move with.

use std::f64::consts::PI;

use nalgebra::Rotation2;

use super::anchor::{Anchor, Frame};
use super::outline::{Point, across, angle, direction, tangent, unit};
use biela::mechanism::BodyId;

/// The frame that a mark or a label moves with: it keeps its place in this frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Attachment {
    /// The frame of ground, at rest.
    Ground,
    /// The frame of a body.
    Body(BodyId),
    /// A point with fixed axes.
    Point(Anchor),
    /// A point with the axes of another anchor.
    Turned { at: Anchor, along: Anchor },
    /// One end of a line, with the x-axis towards the other end.
    Line { line: Line, end: End },
}

/// An end of a [`Line`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    First,
    Second,
}

/// A straight line on the sheet whose length changes with the pose: between two points, or along
/// an axis from the foot of the first point to the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    pub(super) points: [Anchor; 2],
    /// The axis that gives the direction, `None` for the direction from point to point.
    pub(super) axis: Option<Anchor>,
    /// Distance of the drawn line from the points, to the left of the direction seen upright, in
    /// units of the sheet.
    pub(super) offset: f64,
    /// A shorter line is drawn this long to both sides of the second point, in units of the sheet.
    pub(super) shortest: f64,
    /// Radii of circles round the points to which the line is a tangent \[m\], positive for a circle
    /// on its left; zero for a point.
    pub(super) radii: [f64; 2],
}

/// A frame on the sheet, where y points down and angles count clockwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    pub(super) origin: Point,
    /// Direction of the x-axis \[rad\], from -π to π.
    pub(super) angle: f64,
}

impl Attachment {
    /// Returns the frame of the body of an anchor.
    pub(super) fn of(anchor: Anchor) -> Self {
        anchor.body.map_or(Self::Ground, Self::Body)
    }

    /// Returns the frame at a point of a line between two points, towards the second.
    pub(super) fn between(points: [Anchor; 2]) -> Self {
        Self::Line {
            line: Line::between(points),
            end: End::First,
        }
    }

    /// Returns the frame on a sheet of `scale` units per metre at q.
    pub(super) fn placement(&self, q: &[f64], scale: f64) -> Placement {
        let on_sheet = |Frame { point, angle }| Placement {
            origin: on_sheet(point, scale),
            angle: wrapped(-angle),
        };
        match self {
            Self::Ground => on_sheet(Anchor::origin(None).placed(q)),
            Self::Body(body) => on_sheet(Anchor::origin(Some(*body)).placed(q)),
            Self::Point(anchor) => on_sheet(Frame {
                angle: 0.0,
                ..anchor.placed(q)
            }),
            Self::Turned { at, along } => on_sheet(Frame {
                angle: along.placed(q).angle,
                ..at.placed(q)
            }),
            Self::Line { line, end } => {
                let [first, second] = line.ends(q, scale);
                let (origin, other) = match end {
                    End::First => (first, second),
                    End::Second => (second, first),
                };
                Placement {
                    origin,
                    angle: angle(unit(other - origin)),
                }
            }
        }
    }
}

impl Line {
    /// Returns the line from one point to another.
    pub(super) fn between(points: [Anchor; 2]) -> Self {
        Self {
            points,
            axis: None,
            offset: 0.0,
            shortest: 0.0,
            radii: [0.0; 2],
        }
    }

    /// Returns the points and the unit vector of the direction, all on the sheet.
    pub(super) fn on_sheet(&self, q: &[f64], scale: f64) -> ([Point; 2], Point) {
        let points = tangent(self.points.map(|p| p.placed(q).point), self.radii);
        let points = points.map(|point| on_sheet(point, scale));
        let along = self.axis.map_or_else(
            || unit(points[1] - points[0]),
            |axis| direction(-axis.placed(q).angle),
        );
        (points, along)
    }

    /// Returns the ends of the line as it is drawn on the sheet.
    pub(super) fn ends(&self, q: &[f64], scale: f64) -> [Point; 2] {
        let ([from, to], along) = self.on_sheet(q, scale);
        let aside = self.offset * across(along);
        let foot = to - (to - from).dot(&along) * along;
        let ends = if (to - foot).norm() < self.shortest {
            [to - self.shortest * along, to + self.shortest * along]
        } else {
            [foot, to]
        };
        ends.map(|end| end + aside)
    }
}

/// A length that changes with the pose, in units of the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Measure {
    /// Length of the drawn line.
    Length(Line),
    /// The y-coordinate of the first point in the frame at the first end of the drawn line.
    Beside(Line),
}

impl Measure {
    /// Returns the length on a sheet of `scale` units per metre at q.
    pub(super) fn value(&self, q: &[f64], scale: f64) -> f64 {
        match self {
            Self::Length(line) => {
                let [first, second] = line.ends(q, scale);
                (second - first).norm()
            }
            Self::Beside(line) => {
                let ([first, _], _) = line.on_sheet(q, scale);
                let end = Attachment::Line {
                    line: *line,
                    end: End::First,
                };
                end.placement(q, scale).inside(first).y
            }
        }
    }
}

impl Placement {
    /// Returns the direction on the sheet of a direction in the frame.
    pub(super) fn turned(&self, v: Point) -> Point {
        Rotation2::new(self.angle) * v
    }

    /// Returns the direction in the frame of a direction on the sheet.
    pub(super) fn turned_back(&self, v: Point) -> Point {
        Rotation2::new(-self.angle) * v
    }

    /// Returns the place on the sheet of a point in the frame.
    pub(super) fn outside(&self, point: Point) -> Point {
        self.origin + self.turned(point)
    }

    /// Returns the place in the frame of a point on the sheet.
    pub(super) fn inside(&self, point: Point) -> Point {
        self.turned_back(point - self.origin)
    }
}

/// Returns a global point on a sheet of `scale` units per metre, where y points down.
pub(super) fn on_sheet(point: Point, scale: f64) -> Point {
    scale * Point::new(point.x, -point.y)
}

/// Returns an angle between -π and π.
fn wrapped(angle: f64) -> f64 {
    (PI + angle).rem_euclid(2.0 * PI) - PI
}

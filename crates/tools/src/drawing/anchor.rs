//! Frames fixed on bodies or on ground.

use nalgebra::{Rotation2, Vector2};

use super::outline::{Point, direction};
use biela::mechanism::{BodyId, Expression, MarkerId, Mechanism};

/// A frame on a body or on ground: a point and a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// The body, `None` for ground.
    pub body: Option<BodyId>,
    /// The point in the body's frame \[m\].
    pub position: [f64; 2],
    /// Direction of the x-axis in the body's frame \[rad\].
    pub angle: f64,
}

/// An [`Anchor`] in global coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The point \[m\].
    pub point: Vector2<f64>,
    /// Direction of the x-axis \[rad\].
    pub angle: f64,
}

/// A disc about a point of a body or of ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Disc {
    pub(super) center: Anchor,
    /// Radius \[m\].
    pub(super) radius: f64,
}

impl Disc {
    pub(super) fn new(center: Anchor, radius: f64) -> Self {
        Self { center, radius }
    }

    /// Returns whether a point of the body's frame lies in a disc that is more than a point, to
    /// within what cannot be seen.
    pub(super) fn covers(&self, point: Point) -> bool {
        let distance = (point - Point::from(self.center.position)).norm();
        self.radius > 0.0 && distance <= self.radius * 1.001
    }
}

impl From<Anchor> for Disc {
    fn from(point: Anchor) -> Self {
        Self::new(point, 0.0)
    }
}

impl Anchor {
    /// Returns the frame of a body or of ground.
    pub(super) fn origin(body: Option<BodyId>) -> Self {
        Self {
            body,
            position: [0.0; 2],
            angle: 0.0,
        }
    }

    /// Returns the frame of a marker.
    pub(super) fn of_marker(mechanism: &Mechanism, parameters: &[f64], marker: MarkerId) -> Self {
        let value = |expression: &Expression| expression.value(parameters);
        let marker = &mechanism.markers[marker.index()];
        Self {
            body: marker.body,
            position: marker.position.each_ref().map(value),
            angle: value(&marker.angle),
        }
    }

    /// Returns a point of a body with the axes of the body.
    pub(super) fn on_body(body: BodyId, position: [f64; 2]) -> Self {
        Self::origin(Some(body)).moved_to(position)
    }

    /// Returns this frame at another point of its body.
    pub(super) fn moved_to(self, position: [f64; 2]) -> Self {
        Self { position, ..self }
    }

    /// Returns this frame with another direction.
    pub(super) fn turned_to(self, angle: f64) -> Self {
        Self { angle, ..self }
    }

    /// Returns the point at `s` on the x-axis, in the body's frame \[m\].
    pub(super) fn on_axis(&self, s: f64) -> Point {
        Point::from(self.position) + s * direction(self.angle)
    }

    /// Returns the ends of a part of the x-axis \[m\].
    pub(super) fn part(&self, range: [f64; 2]) -> [Self; 2] {
        range.map(|s| self.moved_to(self.on_axis(s).into()))
    }

    /// Returns whether a point of the body's frame lies on a part of the x-axis, to within what
    /// cannot be seen.
    pub(super) fn has_on_axis(&self, range: [f64; 2], point: Point) -> bool {
        let near = 1e-3 * (range[1] - range[0]);
        let [s, aside] = self.coordinates(point);
        aside.abs() <= near && s >= range[0] - near && s <= range[1] + near
    }

    /// Returns the coordinates of a point of the body's frame along the anchor's axes \[m\].
    pub(super) fn coordinates(&self, point: Point) -> [f64; 2] {
        (Rotation2::new(-self.angle) * (point - Point::from(self.position))).into()
    }

    /// Returns whether two anchors on one body have the same point, made by the same expressions.
    pub(super) fn is_at(&self, other: &Self) -> bool {
        self.position.map(f64::to_bits) == other.position.map(f64::to_bits)
    }

    /// Returns the global frame for the generalized coordinates q, \[m, m, rad\] per body.
    #[must_use]
    pub fn placed(&self, q: &[f64]) -> Frame {
        let position = Vector2::from(self.position);
        match self.body {
            None => Frame {
                point: position,
                angle: self.angle,
            },
            Some(body) => {
                let [x, y, phi] = [0, 1, 2].map(|k| q[3 * body.index() + k]);
                Frame {
                    point: Vector2::new(x, y) + Rotation2::new(phi) * position,
                    angle: phi + self.angle,
                }
            }
        }
    }
}

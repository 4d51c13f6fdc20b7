//! Points on bodies that are already found.

use nalgebra::Vector2;

use crate::kinematics::configuration::{Configuration, perp};
use crate::kinematics::rates::Rates;
use crate::mechanism::{MarkerId, Mechanism};

/// A marker on ground or on a body that an earlier kernel has found.
#[derive(Clone, Debug)]
pub(super) struct Anchor {
    marker: MarkerId,
    /// Place of its body.
    place: usize,
    /// First of its body's unknowns, `None` on ground.
    column: Option<usize>,
    /// s, its point in the body's frame.
    s: Vector2<f64>,
    /// A s at the pose last located.
    arm: Vector2<f64>,
}

impl Anchor {
    pub(super) fn new(mechanism: &Mechanism, marker: MarkerId) -> Self {
        let body = mechanism.markers[marker.index()].body;
        Self {
            marker,
            place: body.map_or(mechanism.bodies.len(), |body| body.index()),
            column: body.map(|body| 3 * body.index()),
            s: Vector2::zeros(),
            arm: Vector2::zeros(),
        }
    }

    pub(super) fn set_parameters(&mut self, at: &Configuration) {
        self.s = at.local(self.marker).0;
    }

    /// Notes where the anchor is; returns P.
    #[inline]
    pub(super) fn locate(&mut self, at: &Configuration) -> Vector2<f64> {
        let frame = at.frame(self.place);
        self.arm = frame.rotate(self.s);
        frame.origin + self.arm
    }

    /// Ṗ and P̈ where it was located.
    #[inline]
    pub(super) fn rates(&self, flow: &Rates) -> [Vector2<f64>; 2] {
        let Some(column) = self.column else {
            return [Vector2::zeros(); 2];
        };
        let [v, a] = flow.body(column);
        let turned = perp(self.arm);
        [
            Vector2::new(v[0], v[1]) + turned * v[2],
            Vector2::new(a[0], a[1]) + turned * a[2] - self.arm * (v[2] * v[2]),
        ]
    }
}

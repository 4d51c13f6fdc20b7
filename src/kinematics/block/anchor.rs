//! Points on bodies that are already found.

use nalgebra::Vector2;

use crate::kinematics::certificate::{Tube, Tubes};
use crate::kinematics::configuration::{BodyPose, Configuration, perp, rotate};
use crate::mechanism::{MarkerId, Mechanism};

/// A marker on ground or on a body that an earlier kernel has found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Anchor {
    /// Place of its body, [`GROUND`] for none.
    place: u32,
    /// s, its point in the body's frame.
    s: Vector2<f64>,
    /// From the body's pivot to it, in the body's frame, and how far that is.
    lever: Vector2<f64>,
    length: f64,
}

const GROUND: u32 = u32::MAX;

/// Position, velocity and acceleration of a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moving {
    pub(super) velocity: Vector2<f64>,
    pub(super) acceleration: Vector2<f64>,
}

/// A point in two parts. Far from ground's origin the difference of two origins is all but
/// exact, while that of two points has the rounding of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) origin: Vector2<f64>,
    pub(super) arm: Vector2<f64>,
}

impl Place {
    /// The point.
    #[inline(always)]
    pub(super) fn point(self) -> Vector2<f64> {
        self.origin + self.arm
    }

    /// The point that is further by `arm`.
    #[inline(always)]
    pub(super) fn plus(self, arm: Vector2<f64>) -> Self {
        Self {
            origin: self.origin,
            arm: self.arm + arm,
        }
    }

    /// From another point to this one.
    #[inline(always)]
    pub(super) fn from(self, other: Self) -> Vector2<f64> {
        (self.origin - other.origin) + (self.arm - other.arm)
    }

    /// What the rounding of that difference comes from.
    #[inline(always)]
    pub(super) fn reach_from(self, other: Self) -> f64 {
        largest(self.origin - other.origin) + largest(self.arm) + largest(other.arm)
    }
}

/// The magnitude of the larger component.
#[inline(always)]
pub(super) fn largest(v: Vector2<f64>) -> f64 {
    larger(v.x.abs(), v.y.abs())
}

/// The larger of two numbers; the first where one is none. Unlike `f64::max` a single instruction.
#[inline(always)]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// The place of a body as kernels keep it.
///
/// # Panics
///
/// With more bodies than any memory holds.
pub(super) fn compact(place: usize) -> u32 {
    u32::try_from(place).expect("fewer than four thousand million bodies")
}

impl Anchor {
    pub(super) fn new(mechanism: &Mechanism, marker: MarkerId) -> Self {
        let body = mechanism.markers[marker.index()].body;
        Self {
            place: body.map_or(GROUND, |body| compact(body.index())),
            s: Vector2::zeros(),
            lever: Vector2::zeros(),
            length: 0.0,
        }
    }

    /// Takes over the place of its marker, and the pivot of its body.
    pub(super) fn set_parameters(&mut self, at: &Configuration, tubes: &Tubes, marker: MarkerId) {
        self.s = at.local(marker).0;
        if self.place != GROUND {
            self.lever = self.s - tubes.pivot(self.place as usize);
            self.length = self.lever.norm();
        }
    }

    /// How its body moves in a sub-step; `None` on ground.
    #[inline(always)]
    pub(super) fn carried<'a>(&self, tubes: &'a Tubes) -> Option<(&'a Tube, f64)> {
        (self.place != GROUND).then(|| (tubes.body(self.place as usize), self.length))
    }

    /// From its body's pivot to it, where the sub-step starts and where it ends. Not on ground.
    #[inline(always)]
    pub(super) fn levers(&self, tube: &Tube, frames: &[BodyPose]) -> [Vector2<f64>; 2] {
        [
            rotate(tube.cos, tube.sin, self.lever),
            frames[self.place as usize].rotate(self.lever),
        ]
    }

    /// How far it may be off the straight line between its two ends in a sub-step \[m\].
    #[inline(always)]
    pub(super) fn strays(&self, tubes: &Tubes) -> f64 {
        self.carried(tubes)
            .map_or(0.0, |(tube, length)| tube.stray + tube.arc(length))
    }

    /// P.
    #[inline(always)]
    pub(super) fn point(self, frames: &[BodyPose]) -> Vector2<f64> {
        self.place(frames).point()
    }

    /// P as the sum of the body's origin and the arm from there.
    #[inline(always)]
    pub(super) fn place(self, frames: &[BodyPose]) -> Place {
        if self.place == GROUND {
            return Place {
                origin: self.s,
                arm: Vector2::zeros(),
            };
        }
        let frame = &frames[self.place as usize];
        Place {
            origin: frame.origin,
            arm: frame.rotate(self.s),
        }
    }

    /// Ṗ and P̈.
    #[inline(always)]
    pub(super) fn rates(
        self,
        frames: &[BodyPose],
        velocity: &[f64],
        acceleration: &[f64],
    ) -> Moving {
        if self.place == GROUND {
            return Moving {
                velocity: Vector2::zeros(),
                acceleration: Vector2::zeros(),
            };
        }
        let place = self.place as usize;
        let arm = frames[place].rotate(self.s);
        let v = &velocity[3 * place..3 * place + 3];
        let a = &acceleration[3 * place..3 * place + 3];
        let turned = perp(arm);
        Moving {
            velocity: Vector2::new(v[0], v[1]) + turned * v[2],
            acceleration: Vector2::new(a[0], a[1]) + turned * a[2] - arm * (v[2] * v[2]),
        }
    }
}

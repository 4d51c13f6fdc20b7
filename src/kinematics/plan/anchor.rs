//! Points on bodies that are already found.

use nalgebra::Vector2;

use super::load::add_force;
use crate::kinematics::certificate::{Change, ChordBound, Pivots, Slide, StepBounds, sagitta};
use crate::kinematics::constraint::configuration::{BodyPose, Configuration, perp, rotate};
use crate::mechanism::{MarkerId, Mechanism};

/// A marker on ground or on a body that an earlier block has found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Anchor {
    /// Index of its body, or [`GROUND`].
    body: u32,
    /// s, its point in the body's frame.
    s: Vector2<f64>,
    /// Distance of the point from the body's pivot.
    length: f64,
}

const GROUND: u32 = u32::MAX;

/// Velocity and acceleration of a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moving {
    pub(super) velocity: Vector2<f64>,
    pub(super) acceleration: Vector2<f64>,
}

/// A point as the sum of an origin and an arm. Far from ground's origin the difference of two
/// origins is all but exact, while the difference of two points has the rounding of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct SplitPoint {
    pub(super) origin: Vector2<f64>,
    pub(super) arm: Vector2<f64>,
}

impl SplitPoint {
    /// Returns the point.
    #[inline(always)]
    pub(super) fn point(self) -> Vector2<f64> {
        self.origin + self.arm
    }

    /// Returns the point at the distance `arm` from this one.
    #[inline(always)]
    pub(super) fn plus(self, arm: Vector2<f64>) -> Self {
        Self {
            origin: self.origin,
            arm: self.arm + arm,
        }
    }

    /// Returns the vector from another point to this one.
    #[inline(always)]
    pub(super) fn from(self, other: Self) -> Vector2<f64> {
        (self.origin - other.origin) + (self.arm - other.arm)
    }

    /// Returns the magnitude of the numbers in that difference: its rounding is some eps of it.
    #[inline(always)]
    pub(super) fn reach_from(self, other: Self) -> f64 {
        largest(self.origin - other.origin) + largest(self.arm) + largest(other.arm)
    }
}

/// Returns the magnitude of the larger component.
#[inline(always)]
pub(super) fn largest(v: Vector2<f64>) -> f64 {
    larger(v.x.abs(), v.y.abs())
}

/// Returns the larger of two numbers, the first if one is no number. Unlike `f64::max` it is a
/// single instruction.
#[inline(always)]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// Returns the index of a body as block solvers keep it.
///
/// # Panics
///
/// With more bodies than any memory holds.
pub(super) fn compact(body: usize) -> u32 {
    u32::try_from(body).expect("fewer than four thousand million bodies")
}

impl Anchor {
    pub(super) fn new(mechanism: &Mechanism, marker: MarkerId) -> Self {
        let body = mechanism.markers[marker.index()].body;
        Self {
            body: body.map_or(GROUND, |body| compact(body.index())),
            s: Vector2::zeros(),
            length: 0.0,
        }
    }

    /// Takes over the point of its marker, and the pivot of its body.
    pub(super) fn set_parameters(&mut self, at: &Configuration, pivots: &Pivots, marker: MarkerId) {
        self.s = at.local(marker).0;
        if self.body != GROUND {
            self.length = (self.s - pivots.or_origin(self.body as usize)).norm();
        }
    }

    /// Returns the chord bound of its body and the length of its lever; `None` on ground.
    #[inline(always)]
    fn carrier<'a>(&self, bounds: &'a StepBounds) -> Option<(&'a ChordBound, f64)> {
        (self.body != GROUND).then(|| (bounds.body(self.body as usize), self.length))
    }

    /// Returns its largest deviation from the straight line between its two ends in a sub-step
    /// \[m\].
    #[inline(always)]
    pub(super) fn deviation(&self, bounds: &StepBounds, frames: &[BodyPose]) -> f64 {
        self.carrier(bounds).map_or(0.0, |(bound, length)| {
            bound.point_deviation + bound.arc_deviation(length) + self.rounding(frames)
        })
    }

    /// Bounds the further deviation that a change of its point in the body's frame makes \[m\].
    pub(super) fn moved(&self, change: Change, bounds: &StepBounds) -> f64 {
        match self.carrier(bounds) {
            Some((bound, _)) => bound.deviation_of(change),
            None => change.deviation(0.0),
        }
    }

    /// Returns the part of that deviation that is uncertain: of the pivot and of the angle \[m\].
    #[inline(always)]
    pub(super) fn uncertainty(&self, bounds: &StepBounds) -> f64 {
        self.carrier(bounds).map_or(0.0, |(bound, length)| {
            bound.point_deviation + length * bound.angle_deviation
        })
    }

    /// Bounds its deviation from that line along a unit vector that turns by `turn` from `ends[0]`
    /// to `ends[1]` \[m\].
    pub(super) fn deviation_along(
        &self,
        (ends, turn): ([Vector2<f64>; 2], f64),
        (bounds, pivots): (&StepBounds, &Pivots),
        frames: &[BodyPose],
    ) -> f64 {
        let Some((bound, length)) = self.carrier(bounds) else {
            return 0.0;
        };
        let body = self.body as usize;
        let pivot = bounds.slide(body).map_or(bound.point_deviation, |slide| {
            let parts = ends.map(|e| e.dot(&slide.direction).abs());
            slide.across + slide.along * (larger(parts[0], parts[1]) + sagitta(turn))
        });
        let lever = self.s - pivots.or_origin(body);
        let arms = [
            rotate(bound.cos, bound.sin, lever),
            frames[body].rotate(lever),
        ];
        // e · A′l runs as a sine of an angle that runs straight.
        let swings = [0, 1].map(|end: usize| ends[end].dot(&perp(arms[end])).abs());
        let swing = larger(swings[0], swings[1]) + length * sagitta(bound.turn - turn);
        let uncertain = bound.angle_deviation * (swing + 0.5 * length * bound.angle_deviation);
        pivot + length * sagitta(bound.turn) + uncertain + self.rounding(frames)
    }

    /// Returns whether it is on ground.
    pub(super) fn is_ground(&self) -> bool {
        self.body == GROUND
    }

    /// Returns the bounds of the pivot of its body if that slides, and of the rest of its
    /// deviation \[m\].
    pub(super) fn pivot_slide(&self, bounds: &StepBounds, frames: &[BodyPose]) -> (Slide, f64) {
        let slide = self.carrier(bounds).and_then(|(bound, length)| {
            let slide = *bounds.slide(self.body as usize)?;
            let rest = slide.across + bound.arc_deviation(length) + self.rounding(frames);
            Some((slide, rest))
        });
        slide.unwrap_or_else(|| (Slide::default(), self.deviation(bounds, frames)))
    }

    /// Returns the rounding of its body's stored origin \[m\]: half an eps of each coordinate,
    /// twice that for a start farther off. Zero for ground.
    #[inline(always)]
    pub(super) fn rounding(&self, frames: &[BodyPose]) -> f64 {
        if self.body == GROUND {
            return 0.0;
        }
        let origin = frames[self.body as usize].origin;
        f64::EPSILON * (origin.x.abs() + origin.y.abs())
    }

    /// Returns P.
    #[inline(always)]
    pub(super) fn point(self, frames: &[BodyPose]) -> Vector2<f64> {
        self.split_point(frames).point()
    }

    /// Returns P as the sum of the body's origin and the arm from there.
    #[inline(always)]
    pub(super) fn split_point(self, frames: &[BodyPose]) -> SplitPoint {
        if self.body == GROUND {
            return SplitPoint {
                origin: self.s,
                arm: Vector2::zeros(),
            };
        }
        let frame = &frames[self.body as usize];
        SplitPoint {
            origin: frame.origin,
            arm: frame.rotate(self.s),
        }
    }

    /// Adds a force at P, and its moment, to those on its body. Ground bears any.
    #[inline(always)]
    pub(super) fn load(self, frames: &[BodyPose], force: Vector2<f64>, side: &mut [f64]) {
        if self.body == GROUND {
            return;
        }
        let body = self.body as usize;
        add_force(side, body, frames[body].rotate(self.s), force);
    }

    /// Returns Ṗ and P̈.
    #[inline(always)]
    pub(super) fn rates(
        self,
        frames: &[BodyPose],
        velocity: &[f64],
        acceleration: &[f64],
    ) -> Moving {
        if self.body == GROUND {
            return Moving {
                velocity: Vector2::zeros(),
                acceleration: Vector2::zeros(),
            };
        }
        let body = self.body as usize;
        let arm = frames[body].rotate(self.s);
        let v = &velocity[3 * body..3 * body + 3];
        let a = &acceleration[3 * body..3 * body + 3];
        let turned = perp(arm);
        Moving {
            velocity: Vector2::new(v[0], v[1]) + turned * v[2],
            acceleration: Vector2::new(a[0], a[1]) + turned * a[2] - arm * (v[2] * v[2]),
        }
    }
}

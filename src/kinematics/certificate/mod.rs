//! The proof that one and only one continuous motion joins the two ends of a sub-step.
//!
//! Along a sub-step, s from 0 to 1, everything that moves a block from outside runs as p(s):
//! drivers, parameters, the bodies found before. The equations of the block are F(z, p) = 0 with
//! J = ∂F/∂z. Newton–Raphson gives the roots z0 and z1 at both ends; z̄(s) = z0 + s (z1 − z0) is
//! the *chord*. If there are radii r > 0, one per unknown, with
//!
//! > η + K r < r in every component,
//! >
//! > η ≥ |A(s) F(z̄(s), p(s))| and K ≥ |I − A(s) J(z, p(s))| for all s and |z − z̄(s)| ≤ r
//!
//! for some matrices A(s), then for each s the map z − A F(z, p(s)) takes the box around z̄(s)
//! into itself and contracts there. So the box has exactly one root, J is regular in it, the root
//! moves continuously with s, and it joins z0 to z1. Any A will do, and it may depend on s, as
//! the argument uses one s at a time.
//!
//! A chord whose ends are roots leaves F open by no more than an eighth of a bound of its second
//! derivative along it. The radii make a [`ChordBound`] in which the true motion stays: blocks
//! that come later take it as the uncertainty of their p(s). Each block solver of the plan tests
//! its own block in this way, right after Newton–Raphson; its file has the details. The rounding
//! of both ends is part of η.
//!
//! A test is *proved* unless [`StepBounds::checked`] says that some bound in it was an estimate:
//! the norm of an inverse that is too large to be written down, or a row set aside that depends on a
//! function of the file where pieces of this meet.

mod parameters;
#[cfg(test)]
mod tests;

use nalgebra::Vector2;

pub(super) use parameters::{Change, LARGEST_JUMP, PASSED_AT_ONCE, ParameterBounds};

use super::system::System;
use crate::kinematics::newton::Rejected;

/// Bounds of the motion of a body around its chord during a sub-step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChordBound {
    /// Cosine and sine of the body's angle at the start.
    pub(super) cos: f64,
    pub(super) sin: f64,
    /// Turn from one end to the other \[rad\].
    pub(super) turn: f64,
    /// Largest deviation of the angle from the chord \[rad\].
    pub(super) angle_deviation: f64,
    /// Largest deviation of the pivot from the straight line between its two ends \[m\].
    pub(super) point_deviation: f64,
}

/// Bounds of the deviation of a body's pivot from its chord, for a body that slides along a line
/// that rests.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slide {
    /// Unit vector along the line.
    pub(super) direction: Vector2<f64>,
    /// Largest deviation along the line, and across it \[m\].
    pub(super) along: f64,
    pub(super) across: f64,
}

/// The pivot of each body, in its frame: its point on the bodies found before. `None` for a body
/// that straight code does not place.
#[derive(Clone, Debug, Default)]
pub(super) struct Pivots(Vec<Option<Vector2<f64>>>);

/// The bounds of everything that moves during a sub-step, block by block, and the result of the
/// test.
#[derive(Debug)]
pub(super) struct StepBounds {
    bodies: Vec<ChordBound>,
    /// Largest deviation of the angle between each body and the other one of its dyad from its
    /// chord, where a later block reads it \[rad\].
    spreads: Vec<f64>,
    /// Bounds of the pivots of bodies that slide, with the number of their sub-step.
    slides: Vec<(u64, Slide)>,
    /// Number of the sub-step.
    number: u64,
    /// Largest deviation of the origin in x and in y, of bodies without a pivot \[m\].
    origins: Vec<[f64; 2]>,
    /// Largest deviation of each joint unknown \[rad\].
    joint_unknowns: Vec<f64>,
    /// Largest deviation of each driver's value from its chord \[m or rad\].
    pub(super) drivers: Vec<f64>,
    pub(super) parameters: ParameterBounds,
    step_ratio: f64,
    /// Whether some bound was an estimate.
    pub(super) checked: bool,
    /// Work space of [`Region`](super::constraint::Region)s: radius and chord of each unknown,
    /// zero between uses.
    pub(super) region: Vec<f64>,
    pub(super) chord: Vec<f64>,
}

/// A test is accepted up to this part of the largest step that it allows.
const ACCEPTED: f64 = 0.9;

impl Pivots {
    /// Returns the pivots of no body.
    pub(super) fn new(bodies: usize) -> Self {
        Self(vec![None; bodies])
    }

    /// Returns the pivot of a body; `None` if straight code does not place it.
    pub(super) fn of(&self, body: usize) -> Option<Vector2<f64>> {
        self.0[body]
    }

    /// Returns the pivot of a body, its origin if it has none.
    pub(super) fn or_origin(&self, body: usize) -> Vector2<f64> {
        self.0[body].unwrap_or_default()
    }

    /// Sets the pivot of a body.
    pub(super) fn set(&mut self, body: usize, pivot: Vector2<f64>) {
        self.0[body] = Some(pivot);
    }
}

impl StepBounds {
    /// Makes the storage for a system of equations.
    pub(super) fn new(system: &System) -> Self {
        let bodies = system.mechanism().bodies.len();
        let unknowns = system.unknowns();
        let drivers = system.mechanism().drivers.len();
        Self {
            bodies: vec![ChordBound::default(); bodies],
            spreads: vec![0.0; bodies],
            slides: vec![(0, Slide::default()); bodies],
            number: 0,
            origins: vec![[0.0; 2]; bodies],
            joint_unknowns: vec![0.0; unknowns - 3 * bodies],
            drivers: vec![0.0; drivers],
            parameters: ParameterBounds::new(system),
            step_ratio: 0.0,
            checked: false,
            region: vec![0.0; unknowns],
            chord: vec![0.0; unknowns],
        }
    }

    /// Begins a sub-step.
    pub(super) fn begin(&mut self) {
        self.number += 1;
        self.step_ratio = 0.0;
        self.checked = false;
    }

    /// Returns the bounds of the numbers in the equations; `None` while no parameter moves.
    pub(super) fn moving_parameters(&self) -> Option<&ParameterBounds> {
        self.parameters.moving.then_some(&self.parameters)
    }

    /// Returns the bound of a body.
    #[inline(always)]
    pub(super) fn body(&self, body: usize) -> &ChordBound {
        &self.bodies[body]
    }

    /// Returns the bound of a body, to be written.
    #[inline(always)]
    pub(super) fn body_mut(&mut self, body: usize) -> &mut ChordBound {
        &mut self.bodies[body]
    }

    /// Returns the largest deviation of the angle between a body and the other one of its dyad.
    pub(super) fn spread(&self, body: usize) -> f64 {
        self.spreads[body]
    }

    /// Sets the largest deviation of that angle; infinite where it is not bounded.
    pub(super) fn set_spread(&mut self, body: usize, deviation: f64) {
        self.spreads[body] = deviation;
    }

    /// Returns the bounds of the pivot of a body that slides; `None` if an earlier block of this
    /// sub-step has set none.
    pub(super) fn slide(&self, body: usize) -> Option<&Slide> {
        let (number, slide) = &self.slides[body];
        (*number == self.number).then_some(slide)
    }

    /// Sets the bounds of the pivot of a body that slides.
    pub(super) fn set_slide(&mut self, body: usize, slide: Slide) {
        self.slides[body] = (self.number, slide);
    }

    /// Returns the largest deviation of q\[column\] from its chord.
    pub(super) fn deviation(&self, column: usize, pivots: &Pivots) -> f64 {
        let body = column / 3;
        let Some(bound) = self.bodies.get(body) else {
            return self.joint_unknowns[column - 3 * self.bodies.len()];
        };
        match (column % 3, pivots.of(body)) {
            (2, _) => bound.angle_deviation,
            (component, None) => self.origins[body][component],
            (_, Some(pivot)) => bound.point_deviation + bound.arc_deviation(pivot.norm()),
        }
    }

    /// Sets the largest deviation of the origin of a body without a pivot, in x (0) or y (1).
    fn set_origin(&mut self, body: usize, component: usize, deviation: f64) {
        let origin = &mut self.origins[body];
        origin[component] = deviation;
        // Their squares do not vanish: each contains a rounding.
        let square = origin[0] * origin[0] + origin[1] * origin[1];
        self.bodies[body].point_deviation = square.sqrt();
    }

    /// Sets the largest deviation of a joint unknown, or of an unknown of a body without a pivot;
    /// an angle turns by `moved`.
    pub(super) fn set_unknown(&mut self, column: usize, moved: f64, deviation: f64) {
        let body = column / 3;
        match (self.bodies.get_mut(body), column % 3) {
            (None, _) => self.joint_unknowns[column - 3 * self.bodies.len()] = deviation,
            (Some(bound), 2) => (bound.turn, bound.angle_deviation) = (moved, deviation),
            (Some(_), component) => self.set_origin(body, component, deviation),
        }
    }

    /// Notes the squared ratio of this step to the longest step that a block can certify. Bounds
    /// of second derivatives grow with the square of the step.
    ///
    /// # Errors
    ///
    /// [`Rejected`] if the ratio is above one or not a number.
    #[inline(always)]
    pub(super) fn require(&mut self, step_ratio: f64) -> Result<(), Rejected> {
        if step_ratio > self.step_ratio {
            self.step_ratio = step_ratio;
        }
        if step_ratio <= 1.0 {
            Ok(())
        } else {
            self.step_ratio = step_ratio;
            Err(Rejected)
        }
    }

    /// Returns the largest squared step ratio of the sub-step so far; infinite or not a number
    /// where a block gave none.
    pub(super) fn step_ratio(&self) -> f64 {
        self.step_ratio
    }

    /// Rejects the sub-step for a block that found no root, or has no bound: no step ratio is
    /// known.
    pub(super) fn reject(&mut self) -> Rejected {
        self.step_ratio = f64::INFINITY;
        Rejected
    }
}

impl ChordBound {
    /// Returns the largest deviation of a point at the distance `length` from the pivot, beyond
    /// the deviation of the pivot: that of the arc, an eighth of its squared turn, and that of
    /// the angle.
    #[inline(always)]
    pub(super) fn arc_deviation(&self, length: f64) -> f64 {
        length * (sagitta(self.turn) + self.angle_deviation)
    }

    /// Bounds the deviation from its chord of a vector that changes so in the body's frame.
    pub(super) fn deviation_of(&self, change: Change) -> f64 {
        change.deviation(self.turn) + change.value * self.angle_deviation
    }
}

/// Returns a bound of the distance of a unit vector, turning evenly, from its chord.
#[inline(always)]
pub(super) fn sagitta(turn: f64) -> f64 {
    0.125 * turn * turn
}

/// A gap g > 0 with `open` + `linear` g + `square` g² < g, or none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    /// Squared step ratio for [`StepBounds::require`]: above one there may be no such gap.
    pub(super) step_ratio: f64,
    /// The gap, if the step ratio is at most one: somewhat larger than the least there is.
    pub(super) value: f64,
}

impl Gap {
    /// Solves for the gap. `open` is positive. With q = 4 `open` `square` / (1 − `linear`)² the
    /// least g is (`open` / (1 − `linear`)) · 2 (1 − √(1 − q)) / q, whose last factor lies below
    /// 1 + 0.6 q up to q = 0.9; the step ratio is never less than q / 0.9.
    #[inline(always)]
    pub(super) fn new(open: f64, linear: f64, square: f64) -> Self {
        let step_ratio = (4.0 * open * square + 2.0 * linear) * (1.0 / ACCEPTED);
        Self {
            step_ratio,
            value: open * (1.0 + 0.6 * step_ratio) / (1.0 - linear),
        }
    }
}

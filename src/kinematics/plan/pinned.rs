//! A body with a revolute to a body found before, its angle held or driven.

use nalgebra::Vector2;

use super::anchor::Anchor;
use super::load::{add_moment, load_about};
use super::solve::SolveBlock;
use super::step::{BlockState, Step};
use crate::kinematics::certificate::{ChordBound, Pivots, StepBounds};
use crate::kinematics::constraint::configuration::{BodyPose, Configuration, perp};
use crate::kinematics::newton::{Correction, Limits, Rejected};
use crate::kinematics::system::{EquationTarget, System, Targets};
use crate::mechanism::{Jet, MarkerId, Mechanism};

/// x, y and phi of one body: phi from an angle to a body found before, x and y from a point that
/// coincides with a point found before. All three are explicit.
#[derive(Debug)]
pub(in crate::kinematics) struct PinnedBody {
    parts: Parts,
    columns: [usize; 3],
    anchor: Anchor,
    /// s of the pin.
    s: Vector2<f64>,
    /// The body that the angle is measured from, `None` for ground.
    reference: Option<usize>,
    /// phi where that body's angle and the target are zero.
    zero: f64,
}

/// The rows and markers of a pinned body.
#[derive(Debug)]
pub(super) struct Parts {
    /// The x and y rows of the revolute, then the row of the angle.
    pub(super) rows: [usize; 3],
    pub(super) body: usize,
    /// The point of the body in the revolute, and its partner on the body found before.
    pub(super) pin: MarkerId,
    pub(super) anchor: MarkerId,
    /// The marker of the body whose angle is held or driven, the marker that it is measured
    /// from, and +1 where the angle counts from that marker to the body, otherwise −1.
    pub(super) angle: MarkerId,
    pub(super) reference: MarkerId,
    pub(super) sense: f64,
    /// +1 where the revolute counts from the anchor to the pin, otherwise −1.
    pub(super) pin_sense: f64,
}

impl PinnedBody {
    pub(super) fn new(mechanism: &Mechanism, parts: Parts) -> Self {
        Self {
            columns: [0, 1, 2].map(|k| 3 * parts.body + k),
            anchor: Anchor::new(mechanism, parts.anchor),
            s: Vector2::zeros(),
            reference: mechanism.markers[parts.reference.index()]
                .body
                .map(|body| body.index()),
            zero: 0.0,
            parts,
        }
    }

    /// Puts the body at the pose that the bodies before it and the target give.
    fn locate(&self, state: &mut BlockState<'_>) {
        let parts = &self.parts;
        let target = state
            .system
            .target(parts.rows[2], state.targets, state.drivers);
        let reference = self
            .reference
            .map_or(0.0, |body| state.at.frames()[body].phi);
        let phi = reference + parts.sense * target + self.zero;
        let frame = BodyPose::turned(phi);
        let point = self.anchor.point(state.at.frames());
        state.at.frames_mut()[parts.body] = BodyPose {
            origin: point - frame.rotate(self.s),
            ..frame
        };
    }
}

impl PinnedBody {
    /// Bounds the further deviations of the angle and of the pin by moving parameters, where the
    /// body turns by `turn` with this deviation of its angle \[rad, m\].
    #[cold]
    fn moved(&self, bounds: &StepBounds, turn: f64, angle_deviation: f64) -> [f64; 2] {
        let (parameters, parts) = (&bounds.parameters, &self.parts);
        let angle = parameters.angle(parts.angle)
            + parameters.angle(parts.reference)
            + parameters.target(parts.rows[2]);
        let turned = angle.deviation(0.0);
        let pin = parameters.position(parts.pin);
        let anchor = self.anchor.moved(parameters.position(parts.anchor), bounds);
        let swung = pin.value * (angle_deviation + turned);
        [turned, anchor + pin.deviation(turn) + swung]
    }
}

impl SolveBlock for PinnedBody {
    fn rows(&self) -> &[usize] {
        &self.parts.rows
    }

    fn columns(&self) -> &[usize] {
        &self.columns
    }

    fn set_parameters(
        &mut self,
        _system: &System,
        at: &Configuration,
        _targets: &Targets,
        pivots: &mut Pivots,
    ) {
        self.s = at.local(self.parts.pin).0;
        self.anchor.set_parameters(at, pivots, self.parts.anchor);
        pivots.set(self.parts.body, self.s);
        self.zero = at.local(self.parts.reference).1 - at.local(self.parts.angle).1;
    }

    /// Puts the body at its pose. Its equations are explicit, so that it deviates from its chord
    /// no more than the bodies and the target that it depends on.
    #[inline(always)]
    fn step(
        &mut self,
        state: &mut BlockState<'_>,
        step: &mut Step<'_>,
    ) -> Result<Correction, Rejected> {
        let parts = &self.parts;
        let before = state.at.frames()[parts.body];
        self.locate(state);
        let bounds = &mut *step.bounds;
        let phi = state.at.frames()[parts.body].phi;
        let mut angle_deviation = f64::EPSILON * (1.0 + phi.abs() + before.phi.abs());
        if let Some(body) = self.reference {
            angle_deviation += bounds.body(body).angle_deviation;
        }
        if let EquationTarget::Driver(driver) = state.system.equations()[parts.rows[2]].target {
            angle_deviation += bounds.drivers[driver.index()];
        }
        let mut point_deviation = self.anchor.deviation(bounds, state.at.frames());
        if bounds.parameters.moving {
            let [turned, moved] = self.moved(bounds, phi - before.phi, angle_deviation);
            angle_deviation += turned;
            point_deviation += moved;
        }
        *bounds.body_mut(parts.body) = ChordBound {
            cos: before.cos,
            sin: before.sin,
            turn: phi - before.phi,
            angle_deviation,
            point_deviation,
        };
        // One correction solves linear equations.
        Ok(Correction {
            iterations: 1,
            ..Correction::default()
        })
    }

    fn close(
        &mut self,
        state: &mut BlockState<'_>,
        _limits: Limits,
    ) -> Result<Correction, Rejected> {
        self.locate(state);
        Ok(Correction::default())
    }

    fn stretch(&self, state: &mut BlockState<'_>, _estimate: &[f64]) {
        self.locate(state);
    }

    fn solve_rates(&mut self, state: &mut BlockState<'_>, drivers: &[Jet]) {
        let parts = &self.parts;
        let frames = state.at.frames();
        let (velocity, acceleration) = state.tangent.both_mut();
        let [mut omega, mut alpha] = self.reference.map_or([0.0; 2], |body| {
            let phi = 3 * body + 2;
            [velocity[phi], acceleration[phi]]
        });
        if let EquationTarget::Driver(driver) = state.system.equations()[parts.rows[2]].target {
            let driver = drivers[driver.index()];
            omega += parts.sense * driver.first();
            alpha += parts.sense * driver.second();
        }
        let point = self.anchor.rates(frames, velocity, acceleration);
        let arm = frames[parts.body].rotate(self.s);
        let v = point.velocity - perp(arm) * omega;
        let a = point.acceleration - perp(arm) * alpha + arm * (omega * omega);
        let column = self.columns[0];
        velocity[column..column + 3].copy_from_slice(&[v.x, v.y, omega]);
        acceleration[column..column + 3].copy_from_slice(&[a.x, a.y, alpha]);
    }

    /// The pin bears the force and the angle's row the moment about the pin.
    fn solve_transposed(
        &self,
        _system: &System,
        at: &Configuration,
        side: &mut [f64],
        multipliers: &mut [f64],
    ) -> bool {
        let frames = at.frames();
        let parts = &self.parts;
        let arm = frames[parts.body].rotate(self.s);
        let (force, torque) = load_about(side, parts.body, arm);
        let [x, y, angle] = parts.rows;
        multipliers[x] = parts.pin_sense * force.x;
        multipliers[y] = parts.pin_sense * force.y;
        multipliers[angle] = parts.sense * torque;
        self.anchor.load(frames, force, side);
        if let Some(body) = self.reference {
            add_moment(side, body, torque);
        }
        true
    }
}

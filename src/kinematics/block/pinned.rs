//! A body that a revolute and an angle put in its place, such as a driven crank.

use nalgebra::Vector2;

use super::anchor::Anchor;
use super::work::{Substep, Work};
use crate::kinematics::certificate::{Tube, Tubes};
use crate::kinematics::configuration::{BodyPose, Configuration, perp};
use crate::kinematics::newton::Correction;
use crate::kinematics::system::Target;
use crate::mechanism::{Jet, MarkerId, Mechanism};

/// x, y and phi of one body: phi from an angle to a body already found, x and y from a point
/// that coincides with one already found. All three are explicit.
#[derive(Debug)]
pub(in crate::kinematics) struct Pinned {
    parts: Parts,
    columns: [usize; 3],
    anchor: Anchor,
    /// s of the pin.
    s: Vector2<f64>,
    /// The body that the angle is measured against, `None` for ground.
    reference: Option<usize>,
    /// phi where that body's angle and the target are zero.
    zero: f64,
}

/// What a body pinned by an angle is made of.
#[derive(Debug)]
pub(super) struct Parts {
    /// The x and y rows of the revolute, then that of the angle.
    pub(super) rows: [usize; 3],
    pub(super) body: usize,
    /// The point of the body in the revolute, and its partner on what is already found.
    pub(super) pin: MarkerId,
    pub(super) anchor: MarkerId,
    /// The marker of the body whose angle is held or driven, the one that it is measured
    /// against, and +1 where the angle counts from that one to the body, else −1.
    pub(super) angle: MarkerId,
    pub(super) reference: MarkerId,
    pub(super) sense: f64,
}

impl Pinned {
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

    pub(super) fn rows(&self) -> &[usize] {
        &self.parts.rows
    }

    pub(super) fn columns(&self) -> &[usize] {
        &self.columns
    }

    pub(super) fn set_parameters(&mut self, at: &Configuration, tubes: &mut Tubes) {
        self.s = at.local(self.parts.pin).0;
        self.anchor.set_parameters(at, tubes, self.parts.anchor);
        tubes.set_pivot(self.parts.body, self.s);
        self.zero = at.local(self.parts.reference).1 - at.local(self.parts.angle).1;
    }

    /// Puts the body where it belongs.
    pub(in crate::kinematics) fn locate(&self, work: &mut Work<'_>) {
        let parts = &self.parts;
        let target = work
            .system
            .target(parts.rows[2], work.targets, work.drivers);
        let reference = self
            .reference
            .map_or(0.0, |body| work.at.frames()[body].phi);
        let phi = reference + parts.sense * target + self.zero;
        let frame = BodyPose::turned(phi);
        let point = self.anchor.point(work.at.frames());
        work.at.frames_mut()[parts.body] = BodyPose {
            origin: point - frame.rotate(self.s),
            ..frame
        };
    }

    /// Puts the body where it belongs. There is nothing to solve, and so nothing to prove: it
    /// strays as far as what it hangs on does.
    #[inline(always)]
    pub(super) fn advance(&self, work: &mut Work<'_>, substep: &mut Substep<'_>) -> Correction {
        let parts = &self.parts;
        let place = parts.body;
        let before = work.at.frames()[place];
        self.locate(work);
        let tubes = &mut *substep.tubes;
        let phi = work.at.frames()[place].phi;
        let mut radius = f64::EPSILON * (1.0 + phi.abs() + before.phi.abs());
        if let Some(body) = self.reference {
            radius += tubes.body(body).radius;
        }
        if let Target::Driver(driver) = work.system.equations()[parts.rows[2]].target {
            radius += tubes.drivers[driver.index()];
        }
        let mut stray = self.anchor.strays(tubes);
        if let Some(slips) = tubes.slips() {
            let angle = slips.angle(parts.angle) + slips.angle(parts.reference);
            radius += 2.0 * (angle + slips.constant(parts.rows[2]));
            stray += 2.0 * (slips.position(parts.pin) + slips.position(parts.anchor));
        }
        *tubes.body_mut(place) = Tube {
            cos: before.cos,
            sin: before.sin,
            turn: phi - before.phi,
            radius,
            stray,
        };
        // Linear equations are solved by one.
        Correction {
            iterations: 1,
            ..Correction::default()
        }
    }

    pub(super) fn solve_rates(&self, work: &mut Work<'_>, drivers: &[Jet]) {
        let parts = &self.parts;
        let frames = work.at.frames();
        let (velocity, acceleration) = work.flow.both_mut();
        let [mut omega, mut alpha] = self.reference.map_or([0.0; 2], |body| {
            let phi = 3 * body + 2;
            [velocity[phi], acceleration[phi]]
        });
        if let Target::Driver(driver) = work.system.equations()[parts.rows[2]].target {
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
}

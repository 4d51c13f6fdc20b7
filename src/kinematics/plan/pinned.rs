//! A body that a revolute and an angle put in its place, such as a driven crank.

use nalgebra::Vector2;

use super::Work;
use super::anchor::Anchor;
use crate::kinematics::configuration::{BodyPose, Configuration, perp};
use crate::kinematics::system::Target;
use crate::mechanism::{Jet, MarkerId, Mechanism};

/// x, y and phi of one body: phi from an angle to a body already found, x and y from a point
/// that coincides with one already found. All three are explicit.
#[derive(Debug)]
pub(in crate::kinematics) struct Pinned {
    rows: [usize; 3],
    columns: [usize; 3],
    place: usize,
    /// The point of the body in the revolute.
    pin: MarkerId,
    anchor: Anchor,
    /// The marker of the body whose angle is held or driven, the one that it is measured
    /// against, and +1 where the angle counts from that one to the body, else −1.
    angle: MarkerId,
    reference: MarkerId,
    sense: f64,
    /// s of the pin.
    s: Vector2<f64>,
    /// A s of the pin at the pose last located.
    arm: Vector2<f64>,
}

/// What a body pinned by an angle is made of.
pub(super) struct Parts {
    /// The x and y rows of the revolute, then that of the angle.
    pub(super) rows: [usize; 3],
    pub(super) body: usize,
    pub(super) pin: MarkerId,
    pub(super) anchor: MarkerId,
    pub(super) angle: MarkerId,
    pub(super) reference: MarkerId,
    pub(super) sense: f64,
}

impl Pinned {
    pub(super) fn new(mechanism: &Mechanism, parts: &Parts) -> Self {
        Self {
            rows: parts.rows,
            columns: [0, 1, 2].map(|k| 3 * parts.body + k),
            place: parts.body,
            pin: parts.pin,
            anchor: Anchor::new(mechanism, parts.anchor),
            angle: parts.angle,
            reference: parts.reference,
            sense: parts.sense,
            s: Vector2::zeros(),
            arm: Vector2::zeros(),
        }
    }

    pub(super) fn rows(&self) -> &[usize] {
        &self.rows
    }

    pub(super) fn columns(&self) -> &[usize] {
        &self.columns
    }

    pub(super) fn set_parameters(&mut self, at: &Configuration) {
        self.s = at.local(self.pin).0;
        self.anchor.set_parameters(at);
    }

    /// Puts the body where it belongs.
    pub(in crate::kinematics) fn locate(&mut self, work: &mut Work<'_>) {
        let target = work.system.target(self.rows[2], work.targets, work.drivers);
        let reference = work.at.marker(self.reference).theta;
        let phi = reference + self.sense * target - work.at.local(self.angle).1;
        let (sin, cos) = phi.sin_cos();
        let point = self.anchor.locate(work.at);
        let mut frame = BodyPose {
            origin: Vector2::zeros(),
            phi,
            cos,
            sin,
        };
        self.arm = frame.rotate(self.s);
        frame.origin = point - self.arm;
        work.at.set_frame(self.place, frame);
    }

    /// Notes the arms at the pose.
    pub(super) fn factorise(&mut self, work: &Work<'_>) {
        self.anchor.locate(work.at);
        self.arm = work.at.frame(self.place).rotate(self.s);
    }

    pub(super) fn solve_rates(&self, work: &mut Work<'_>, drivers: &[Jet]) {
        let [mut omega, mut alpha] = work
            .at
            .marker(self.reference)
            .body
            .map_or([0.0; 2], |body| {
                let [v, a] = work.flow.body(3 * body.index());
                [v[2], a[2]]
            });
        if let Target::Driver(driver) = work.system.equations()[self.rows[2]].target {
            let driver = drivers[driver.index()];
            omega += self.sense * driver.first;
            alpha += self.sense * driver.second;
        }
        let [velocity, acceleration] = self.anchor.rates(work.flow);
        let turned = perp(self.arm);
        let v = velocity - turned * omega;
        let a = acceleration - turned * alpha + self.arm * (omega * omega);
        work.flow
            .set_body(self.columns[0], [[v.x, v.y, omega], [a.x, a.y, alpha]]);
    }
}

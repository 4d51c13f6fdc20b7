//! Relations of joints with play: no rows, but limits of a coordinate.

use std::sync::Arc;

use crate::kinematics::constraint::Constraint;
use crate::kinematics::constraint::configuration::{Configuration, perp};
use crate::mechanism::{CamFollower, Expression, Joint, Mechanism, Number, ParameterId, Play};

/// The relation between the two parts of a joint with play.
#[derive(Debug)]
pub struct OpenRelation {
    /// Index of the joint.
    pub(in crate::kinematics) joint: usize,
    /// c(q).
    pub(in crate::kinematics) relation: Arc<dyn Constraint>,
    /// The value at which a joint without play holds it.
    pub(super) target: Expression,
    /// The parameters that it uses besides those of markers and of the target.
    parameters: Vec<ParameterId>,
}

impl OpenRelation {
    pub(super) fn new(
        joint: usize,
        relation: Box<dyn Constraint>,
        target: Expression,
        parameters: Vec<ParameterId>,
    ) -> Self {
        Self {
            joint,
            relation: relation.into(),
            target,
            parameters,
        }
    }

    /// Returns the parameters on which the relation and its limits depend, besides those of markers.
    pub(super) fn parameters<'a>(
        &'a self,
        mechanism: &'a Mechanism,
    ) -> impl Iterator<Item = ParameterId> + 'a {
        let play = mechanism.joints[self.joint].kind.play().into_iter();
        let numbers = play.flat_map(Play::expressions).chain([&self.target]);
        let of_numbers = numbers.flat_map(Expression::parameters);
        self.parameters.iter().copied().chain(of_numbers)
    }

    /// Returns least and largest value \[m or rad\], infinite where the parts only push.
    pub(in crate::kinematics) fn limits<N: Number>(
        &self,
        mechanism: &Mechanism,
        parameter: &impl Fn(ParameterId) -> N,
        at: &Configuration,
    ) -> [N; 2] {
        let zero = N::constant(0.0);
        let held = self.target.evaluate(parameter, zero);
        let joint = &mechanism.joints[self.joint];
        let play = joint.kind.play();
        if let Some(backlash) = play.and_then(|play| play.backlash.as_ref()) {
            let half = backlash.evaluate(parameter, zero) * 0.5;
            return [held - half, held + half];
        }
        if opens_towards(joint, at) > 0.0 {
            [held, N::constant(f64::INFINITY)]
        } else {
            [N::constant(f64::NEG_INFINITY), held]
        }
    }
}

/// Returns 1 if the relation of a contact grows as it opens, and −1 if it falls, as that of a rope.
pub(in crate::kinematics) fn opens_towards(joint: &Joint, at: &Configuration) -> f64 {
    if joint.rope().is_some() {
        return -1.0;
    }
    match joint.cam() {
        Some((CamFollower::Flat, _)) => {
            // The row moves the face against its normal. The cam's pole is on the inner side of each
            // tangent of its contour.
            let (cam, face) = (at.marker(joint.from), at.marker(joint.to));
            -perp(face.axis).dot(&(face.point - cam.point)).signum()
        }
        // The distance of the two parts.
        _ => 1.0,
    }
}

//! The equations of each kind of joint.
//!
//! | file | joints |
//! |---|---|
//! | this one | those whose rows are coordinates |
//! | `wheels` | gears, belts, racks and pinions, wheels that roll |
//! | `cam` | followers on cams |
//! | `curve` | points on curves |
//! | `rope` | ropes |
//! | `coupling` | equations between coordinates |

mod cam;
mod coupling;
mod curve;
mod rope;
mod wheels;

use std::collections::BTreeSet;

use crate::kinematics::Origin;
use crate::kinematics::constraint::configuration::{
    CamProfile, Coefficient, CoefficientId, CouplingLaw, JointUnknownId, LawId,
    ParameterCoefficients, ProfileId,
};
use crate::kinematics::constraint::{Axis, Coincidence, Constraint, JointUnknown, of_coordinate};
use crate::mechanism::{
    CoordinateKind, Expression, Joint, JointKind, Mechanism, MotionInForce, ParameterId, Phase,
    PrescribedMotion, Profile, ProfileInForce,
};

/// A relation, and the value at which it is held.
type Held = (Box<dyn Constraint>, Expression);

/// Coefficients, profiles, laws and unknowns of joints.
#[derive(Debug, Default)]
pub(super) struct JointParts {
    pub(super) coefficients: Vec<Coefficient>,
    pub(super) profiles: Vec<CamProfile>,
    pub(super) laws: Vec<CouplingLaw>,
    /// The joint unknowns, behind those of the bodies, each with its joint.
    pub(super) unknowns: Vec<(Origin, Box<dyn JointUnknown>)>,
    /// Parameters of the joint whose equations are being written down.
    pub(super) parameters: Vec<ParameterId>,
}

impl JointParts {
    /// Adds a coefficient.
    pub(super) fn coefficient(
        &mut self,
        expression: &Expression,
        what: impl Into<String>,
    ) -> CoefficientId {
        self.parameters.extend(expression.parameters());
        self.coefficients.push(Coefficient {
            expression: expression.clone(),
            what: what.into(),
        });
        CoefficientId(self.coefficients.len() - 1)
    }

    /// Adds the parameters of expressions as coefficients.
    fn parameter_coefficients<const N: usize>(
        &mut self,
        expressions: [&Expression; N],
        what: &str,
    ) -> ParameterCoefficients {
        let used = expressions.into_iter().flat_map(Expression::parameters);
        let used: BTreeSet<ParameterId> = used.collect();
        let mut coefficient = |id| (id, self.coefficient(&Expression::parameter(id), what));
        ParameterCoefficients(used.into_iter().map(&mut coefficient).collect())
    }

    /// Adds a cam's profile.
    pub(super) fn profile(
        &mut self,
        profile: &Profile,
        mechanism: &Mechanism,
        what: impl Into<String>,
    ) -> ProfileId {
        self.parameters.extend(profile.parameters());
        self.profiles.push(CamProfile {
            in_force: ProfileInForce::new(profile, mechanism.parameters.len()),
            what: what.into(),
        });
        ProfileId(self.profiles.len() - 1)
    }

    /// Adds the law of a coupling.
    fn law(&mut self, law: &PrescribedMotion, mechanism: &Mechanism, what: String) -> LawId {
        self.parameters.extend(law.parameters());
        let parameters = mechanism.parameters.len();
        self.laws.push(CouplingLaw {
            law: law.clone(),
            in_force: MotionInForce::new(law, parameters),
            enclosed: MotionInForce::new(law, parameters),
            what,
        });
        LawId(self.laws.len() - 1)
    }

    /// Returns the id of the next joint unknown.
    pub(super) fn next_unknown(&self) -> JointUnknownId {
        JointUnknownId(self.unknowns.len())
    }

    /// Adds a joint unknown.
    pub(super) fn unknown(&mut self, origin: Origin, unknown: Box<dyn JointUnknown>) {
        self.unknowns.push((origin, unknown));
    }
}

/// Returns the relations of a joint. That between its two parts, which play opens, is the last one.
#[must_use]
pub(super) fn relations(
    mechanism: &Mechanism,
    origin: Origin,
    joint: &Joint,
    parts: &mut JointParts,
) -> Vec<Held> {
    let (from, to) = (joint.from, joint.to);
    let along = |kind| of_coordinate(&joint.coordinate(kind));
    let coincide = |axis| held_at_zero(Coincidence { from, to, axis });
    match &joint.kind {
        JointKind::Revolute => vec![coincide(Axis::X), coincide(Axis::Y)],
        JointKind::Translational => vec![
            (along(CoordinateKind::Y), zero()),
            (along(CoordinateKind::Angle), zero()),
        ],
        JointKind::Slot => vec![(along(CoordinateKind::Y), zero())],
        JointKind::Link { length } => vec![(along(CoordinateKind::Distance), length.clone())],
        JointKind::RevoluteTranslational { offset } => {
            vec![(along(CoordinateKind::Y), offset.clone())]
        }
        JointKind::Weld => vec![
            coincide(Axis::X),
            coincide(Axis::Y),
            (along(CoordinateKind::Angle), zero()),
        ],
        JointKind::Gear {
            sizes,
            internal,
            carrier,
            phase,
            ..
        } => vec![wheels::couple(
            joint, sizes, !internal, *carrier, phase, parts,
        )],
        JointKind::Belt {
            sizes,
            crossed,
            carrier,
            phase,
        } => vec![wheels::couple(
            joint, sizes, *crossed, *carrier, phase, parts,
        )],
        JointKind::RackAndPinion {
            radius,
            side,
            phase,
            ..
        } => vec![wheels::roll(joint, radius, *side, phase, parts)],
        JointKind::Rolling {
            radius,
            side,
            phase,
        } => vec![
            wheels::roll(joint, radius, *side, phase, parts),
            wheels::stay(joint, radius, *side),
        ],
        JointKind::Coupling(equation) => {
            let what = origin.describe(mechanism);
            vec![coupling::couple(mechanism, equation, &what, parts)]
        }
        JointKind::Cam {
            follower, profile, ..
        } => {
            let profile = parts.profile(profile, mechanism, origin.describe(mechanism));
            cam::follow(origin, joint, follower, profile, parts)
        }
        JointKind::Rope(rope) => vec![rope::run(joint, rope, parts)],
        JointKind::Curve(curve) => curve::lie(origin, joint, curve, parts),
    }
}

fn zero() -> Expression {
    Expression::constant(0.0)
}

fn held_at_zero(relation: impl Constraint + 'static) -> Held {
    (Box::new(relation), zero())
}

/// Returns the constant of a relation; zero until the [system](super::System) sets one that the
/// estimates give.
fn held_at(phase: &Phase) -> Expression {
    match phase {
        Phase::At(value) => value.clone(),
        Phase::Drawn => zero(),
    }
}

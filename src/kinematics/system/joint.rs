//! The equations of each kind of joint.

use std::collections::BTreeSet;

use crate::kinematics::Origin;
use crate::kinematics::constraint::configuration::{
    CamProfile, Coefficient, CoefficientId, CouplingLaw, JointUnknownId, LawId,
    ParameterCoefficients, ProfileId,
};
use crate::kinematics::constraint::{
    AlongCurve, Axis, Coincidence, Constraint, Contour, CoordinateRelation, CoupledExpression,
    CoupledFunction, Coupling, CurveContact, CurvePath, Dimension, FlatContact, FlatFace,
    FormulaPath, JointUnknown, KnifeEdge, OnCurve, Projection, RackAndPinion, Roller,
    RollerContact, RopeLength, Station, WheelPair, of_coordinate,
};
use crate::mechanism::{
    BodyId, CamFollower, Coordinate, CoordinateEquation, CoordinateKind, Curve, CurveShape,
    Expression, Joint, JointKind, LinearForm, Mechanism, Motion, MotionInForce, ParameterId, Phase,
    Profile, ProfileInForce, RackSide, Rope, WheelSizes,
};

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
    fn law(&mut self, law: &Motion, mechanism: &Mechanism, what: String) -> LawId {
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

/// Returns the relations of a joint, each with its target.
#[must_use]
pub(super) fn relations(
    mechanism: &Mechanism,
    origin: Origin,
    joint: &Joint,
    parts: &mut JointParts,
) -> Vec<(Box<dyn Constraint>, Expression)> {
    let (from, to) = (joint.from, joint.to);
    let zero = || Expression::constant(0.0);
    let along = |kind| of_coordinate(&joint.coordinate(kind));
    let coincide = |axis| -> (Box<dyn Constraint>, Expression) {
        (Box::new(Coincidence { from, to, axis }), zero())
    };
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
        } => vec![(
            couple(joint, sizes, !internal, *carrier, parts),
            held_at(phase),
        )],
        JointKind::Belt {
            sizes,
            crossed,
            carrier,
            phase,
        } => vec![(
            couple(joint, sizes, *crossed, *carrier, parts),
            held_at(phase),
        )],
        JointKind::RackAndPinion {
            radius,
            side,
            phase,
            ..
        } => {
            vec![(roll(joint, radius, *side, parts), held_at(phase))]
        }
        JointKind::Rolling {
            radius,
            side,
            phase,
        } => {
            let (track, wheel) = (to, from);
            // The distance from the track to the centre is positive on the side of the wheel.
            let (from, to) = match side {
                RackSide::Above => (track, wheel),
                RackSide::Below => (wheel, track),
            };
            let height = of_coordinate(&Coordinate {
                kind: CoordinateKind::Y,
                from,
                to,
                axes: track,
            });
            vec![
                (roll(joint, radius, *side, parts), held_at(phase)),
                (height, radius.clone()),
            ]
        }
        JointKind::Coupling(equation) => {
            let what = origin.describe(mechanism);
            let coupling = coupling(mechanism, equation, &what, parts);
            vec![(Box::new(coupling), held_at(&equation.phase))]
        }
        JointKind::Cam {
            follower, profile, ..
        } => {
            let profile = parts.profile(profile, mechanism, origin.describe(mechanism));
            let contour = Contour {
                cam: from,
                profile,
                contact: parts.next_unknown(),
            };
            match follower {
                CamFollower::Knife => {
                    let edge = KnifeEdge {
                        cam: from,
                        follower: to,
                        profile,
                    };
                    vec![(Box::new(edge), zero())]
                }
                CamFollower::Roller { radius } => {
                    let contact = RollerContact {
                        contour,
                        follower: to,
                    };
                    parts.unknown(origin, Box::new(contact));
                    let along = |axis| Roller {
                        contour,
                        follower: to,
                        axis,
                    };
                    vec![
                        (Box::new(along(Axis::X)), zero()),
                        (Box::new(along(Axis::Y)), radius.clone()),
                    ]
                }
                CamFollower::Flat => {
                    let contact = FlatContact {
                        contour,
                        follower: to,
                    };
                    parts.unknown(origin, Box::new(contact));
                    let face = FlatFace {
                        contour,
                        follower: to,
                    };
                    vec![(Box::new(contact), zero()), (Box::new(face), zero())]
                }
            }
        }
        JointKind::Rope(rope) => vec![(run(joint, rope, parts), rope.length.clone())],
        JointKind::Curve(curve) => lie(origin, joint, curve, parts),
    }
}

/// Returns the place, among the relations of a joint, of that between its two parts: the one that play
/// opens.
#[must_use]
pub(in crate::kinematics) fn contact_place(kind: &JointKind) -> usize {
    match kind {
        JointKind::Cam {
            follower: CamFollower::Roller { .. } | CamFollower::Flat,
            ..
        }
        | JointKind::Rolling { .. } => 1,
        _ => 0,
    }
}

/// Returns the constant of a relation; zero until the [system](super::System) sets one that the
/// estimates give.
fn held_at(phase: &Phase) -> Expression {
    match phase {
        Phase::At(value) => value.clone(),
        Phase::Drawn => Expression::constant(0.0),
    }
}

/// Returns the relations of a point on a curve.
fn lie(
    origin: Origin,
    joint: &Joint,
    curve: &Curve,
    parts: &mut JointParts,
) -> Vec<(Box<dyn Constraint>, Expression)> {
    let (from, to) = (joint.from, joint.to);
    let what = format!("a number of joint `{}`", joint.name);
    let offset = curve.offset.as_ref();
    let offset = offset.map(|offset| parts.coefficient(offset, what.clone()));
    let path = match &curve.shape {
        CurveShape::Points(path) => CurvePath::through_points(path.clone(), offset),
        CurveShape::Formula { x, y, ends } => {
            let formula = FormulaPath {
                components: [x.clone(), y.clone()],
                ends: ends
                    .each_ref()
                    .map(|end| parts.coefficient(end, what.clone())),
                parameters: parts.parameter_coefficients([x, y], &what),
            };
            CurvePath::of_formula(formula, offset, curve.closed)
        }
    };
    let place = parts.next_unknown();
    let contact = CurveContact {
        from,
        to,
        path: path.clone(),
    };
    parts.unknown(origin, Box::new(contact));
    let mut rows: Vec<Box<dyn Constraint>> = Vec::new();
    for axis in [Axis::X, Axis::Y] {
        rows.push(Box::new(OnCurve {
            coordinate: Projection {
                from,
                to,
                axes: from,
                axis,
            },
            path: path.clone(),
            place,
        }));
    }
    if curve.follow {
        rows.push(Box::new(AlongCurve {
            from,
            to,
            path,
            place,
        }));
    }
    let zero = || Expression::constant(0.0);
    rows.into_iter().map(|row| (row, zero())).collect()
}

/// Returns the relation of a rope.
fn run(joint: &Joint, rope: &Rope, parts: &mut JointParts) -> Box<dyn Constraint> {
    let stations = rope.points.iter().map(|point| Station {
        marker: point.marker,
        pulley: point.pulley.as_ref().map(|pulley| {
            let what = format!("a pulley's radius in joint `{}`", joint.name);
            let radius = parts.coefficient(&pulley.radius, what);
            (radius, pulley.side.sign())
        }),
    });
    let stations = stations.collect();
    let numbers = rope.parts.iter().map(|number| {
        let what = format!("a number of parts in joint `{}`", joint.name);
        parts.coefficient(number, what)
    });
    Box::new(RopeLength::new(stations, numbers.collect()))
}

/// Returns the relation of a wheel, which has marker i, that rolls on the x-axis of marker j.
fn roll(
    joint: &Joint,
    radius: &Expression,
    side: RackSide,
    parts: &mut JointParts,
) -> Box<dyn Constraint> {
    Box::new(RackAndPinion {
        pinion: joint.from,
        rack: joint.to,
        radius: parts.coefficient(radius, format!("the radius of joint `{}`", joint.name)),
        side,
    })
}

/// Returns the relation of an equation between coordinates.
fn coupling(
    mechanism: &Mechanism,
    equation: &CoordinateEquation,
    what: &str,
    parts: &mut JointParts,
) -> Coupling {
    let coordinates = equation.coordinates.iter();
    let coordinates: Vec<_> = coordinates
        .map(|(_, coordinate)| CoordinateRelation::of(coordinate))
        .collect();
    let function = match equation.difference.linear_form(coordinates.len()) {
        Some(LinearForm { factors, rest }) => CoupledFunction::Linear {
            is_fixed: factors
                .iter()
                .all(|factor| factor.literal().is_some_and(|literal| literal != 0.0)),
            factors: factors
                .iter()
                .map(|factor| parts.coefficient(factor, what))
                .collect(),
            rest: parts.coefficient(&rest, what),
        },
        None => CoupledFunction::Expression(CoupledExpression {
            expression: equation.difference.clone(),
            parameters: parts.parameter_coefficients([&equation.difference], what),
            jumps_by: match equation.difference.jumping_coordinates()[..] {
                [place] => Some(place),
                _ => None,
            },
            law: (equation.law.as_ref()).map(|law| parts.law(law, mechanism, what.to_owned())),
        }),
    };
    Coupling {
        coordinates,
        function,
        dimension: match equation.is_angle {
            true => Dimension::Angle,
            false => Dimension::Length,
        },
    }
}

/// Returns the relation of two wheels that turn in a fixed ratio.
fn couple(
    joint: &Joint,
    sizes: &WheelSizes,
    opposite: bool,
    carrier: Option<BodyId>,
    parts: &mut JointParts,
) -> Box<dyn Constraint> {
    let what = format!("a wheel's size in joint `{}`", joint.name);
    let [first, second] = sizes.expressions();
    Box::new(WheelPair {
        from: joint.from,
        to: joint.to,
        carrier,
        sizes: [
            parts.coefficient(first, what.clone()),
            parts.coefficient(second, what),
        ],
        opposite,
    })
}

//! The derivatives and bounds of every relation, against differences of its values.

use proptest::prelude::*;

use super::moving_configuration::{
    CurvesAlong, Enclosed, EnclosedCurves, Varied, VariedConfiguration, VariedMechanism,
};
use super::*;
use crate::kinematics::{
    CamProfile, Coefficient, CoefficientId, Configuration, CouplingLaw, JointUnknownId, LawId,
    ParameterCoefficients, ProfileId,
};
use crate::mechanism::{
    BodyId, CoordinateEquation, Curve, CurveShape, Dual, Expression, Interval, JointKind, MarkerId,
    Mechanism, MotionInForce, Number, PointPath, PrescribedMotion, ProfileInForce, RackSide,
    Source,
};

/// Three bodies and ground with markers in general position, one of them at its body's origin,
/// and a cam's profile.
const BODIES: &str = r#"
format = 1
name = "sample"
[ground.markers]
G = [0.3, -0.2, 0.4]
H = [0, 0]
[bodies.a]
markers = { A = [0.2, 0.1, 0.3], O = [0, 0] }
shapes.nose = { disc = "A", radius = 0.05 }
shapes.hub = { disc = "O", radius = 0.05 }
[bodies.b]
markers = { B = [-0.15, 0.25, -0.7] }
[bodies.c]
markers = { C = [0.05, -0.3, 1.1] }
shapes.bore = { hole = "C", radius = 0.03 }
shapes.plate = { disc = "C", radius = 0.04 }
[joints.cam]
type = "cam"
markers = ["a.A", "b.B"]
follower = "flat"
profile = "0.4 + 0.05*cos(theta) + 0.02*sin(3*theta)"
[joints.way]
type = "curve"
markers = ["a.A", "b.B"]
x = "0.4*s + 0.1*cos(2*s)"
y = "0.2*s - 0.3*sin(s)"
[joints]
line = { type = "coupling", equation = "2*turn - far = 0.5*near + 1" }
angles = { type = "coupling", equation = "2*turn = 3*lean" }
curve = { type = "coupling", equation = "lean = atan2(near*sin(turn), 9 + far) + near^2*far" }
law = { type = "coupling", equation = "far = law(turn)*near", law = { table = [[-20, 0.2], [20, 1.4]], law = "polynomial_4567" } }
[measures]
turn = { coordinate = "angle", markers = ["a.A", "b.B"] }
lean = { coordinate = "angle", markers = ["ground.G", "c.C"] }
near = { coordinate = "y", markers = ["a.A", "c.C"], axes = "b.B" }
far = { coordinate = "distance", markers = ["ground.G", "a.O"] }
noses = { coordinate = "clearance", shapes = ["a.nose", "c.plate"] }
pin = { coordinate = "clearance", shapes = ["c.bore", "a.hub"] }
"#;

/// Generalized coordinates of the three bodies, and the angle of a cam's contact.
const UNKNOWNS: usize = 10;

/// Returns every kind of relation, with ground on either side, and with axes on a third body. Add a
/// new relation here.
fn samples(mechanism: &Mechanism) -> Vec<Box<dyn Constraint>> {
    let id = |path: &str| {
        let ids = (0..mechanism.markers.len()).map(MarkerId);
        ids.into_iter()
            .find(|id| mechanism.marker_path(*id) == path)
            .expect("the marker is in the sample")
    };
    let mut samples: Vec<Box<dyn Constraint>> = Vec::new();
    for (from, to, axes) in [
        ("a.A", "b.B", "a.A"),
        ("a.A", "b.B", "b.B"),
        ("a.A", "b.B", "c.C"),
        ("a.O", "b.B", "ground.G"),
        ("a.A", "b.B", "ground.H"),
        ("ground.G", "c.C", "ground.G"),
        ("c.C", "ground.G", "c.C"),
        ("ground.H", "a.O", "ground.H"),
    ] {
        let (from, to, axes) = (id(from), id(to), id(axes));
        for kind in [
            CoordinateKind::Angle,
            CoordinateKind::X,
            CoordinateKind::Y,
            CoordinateKind::Distance,
        ] {
            samples.push(of_coordinate(&Coordinate {
                kind,
                from,
                to,
                axes,
            }));
        }
        for axis in [Axis::X, Axis::Y] {
            samples.push(Box::new(Coincidence { from, to, axis }));
        }
    }
    // Wheels of both senses, with centres on ground or on a body.
    for (from, to, carrier) in [
        ("a.A", "b.B", None),
        ("a.A", "b.B", Some(BodyId(2))),
        ("ground.G", "b.B", Some(BodyId(0))),
    ] {
        for opposite in [false, true] {
            samples.push(Box::new(WheelPair {
                from: id(from),
                to: id(to),
                carrier,
                sizes: [CoefficientId(0), CoefficientId(1)],
                opposite,
            }));
        }
    }
    for (pinion, rack) in [("a.A", "b.B"), ("a.A", "ground.G"), ("ground.H", "b.B")] {
        for side in [RackSide::Above, RackSide::Below] {
            samples.push(Box::new(RackAndPinion {
                pinion: id(pinion),
                rack: id(rack),
                radius: CoefficientId(0),
                side,
            }));
        }
    }
    for (cam, follower) in [("a.A", "b.B"), ("ground.G", "b.B"), ("c.C", "ground.H")] {
        let (cam, follower) = (id(cam), id(follower));
        let contour = Contour {
            cam,
            profile: ProfileId(0),
            contact: JointUnknownId(0),
        };
        samples.push(Box::new(KnifeEdge {
            cam,
            follower,
            profile: ProfileId(0),
        }));
        for axis in [Axis::X, Axis::Y] {
            samples.push(Box::new(Roller {
                contour,
                follower,
                axis,
            }));
        }
        samples.push(Box::new(FlatContact { contour, follower }));
        samples.push(Box::new(FlatFace { contour, follower }));
    }
    samples_of_curves(mechanism, &id, &mut samples);
    let clearances = mechanism.measures.iter().map(|measure| &measure.coordinate);
    let clearances = clearances.filter(|coordinate| coordinate.shapes().is_some());
    samples.extend(clearances.map(of_coordinate));
    for joint in &mechanism.joints {
        if let JointKind::Coupling(equation) = &joint.kind {
            samples.push(Box::new(coupling(equation)));
        }
    }
    // Ropes over points, round pulleys on both sides, and along one body. The way turns back on
    // pulleys, far from the angles at which arcs begin and end.
    let (left, right) = (
        Some((CoefficientId(0), 1.0)),
        Some((CoefficientId(0), -1.0)),
    );
    for way in [
        &[("a.A", None), ("b.B", None)][..],
        &[
            ("ground.G", None),
            ("a.A", None),
            ("b.B", None),
            ("ground.H", None),
        ],
        &[("a.A", None), ("a.O", None), ("c.C", None)],
        &[
            ("ground.G", None),
            ("c.C", left),
            ("a.A", None),
            ("b.B", None),
        ],
        &[
            ("ground.G", None),
            ("c.C", right),
            ("a.A", left),
            ("b.B", None),
        ],
        &[
            ("ground.G", None),
            ("ground.H", left),
            ("c.C", left),
            ("a.O", None),
        ],
    ] {
        let station = |&(marker, pulley)| Station {
            marker: id(marker),
            pulley,
        };
        let parts = (1..way.len()).map(|k| match way[k].1.or(way[k - 1].1) {
            Some(_) => CoefficientId(1),
            None => CoefficientId(k % 2),
        });
        let stations = way.iter().map(station).collect();
        samples.push(Box::new(RopeLength::new(stations, parts.collect())));
    }
    samples
}

/// Adds points on curves: by a formula, closed and with an offset, and through points.
fn samples_of_curves(
    mechanism: &Mechanism,
    id: &impl Fn(&str) -> MarkerId,
    samples: &mut Vec<Box<dyn Constraint>>,
) {
    let JointKind::Curve(Curve {
        shape: CurveShape::Formula { x, y, .. },
        ..
    }) = &mechanism.joints[1].kind
    else {
        panic!("the sample has a curve");
    };
    let (place, straight) = (
        JointUnknownId(0),
        PointPath::new(&[[0.1, 0.2], [0.5, -0.3]], false),
    );
    for (from, to) in [("a.A", "b.B"), ("ground.G", "b.B"), ("c.C", "ground.H")] {
        let (from, to) = (id(from), id(to));
        let formula = |offset, is_closed| {
            let formula = FormulaPath {
                components: [x.clone(), y.clone()],
                ends: [CoefficientId(0), CoefficientId(1)],
                parameters: ParameterCoefficients::default(),
            };
            CurvePath::of_formula(formula, offset, is_closed)
        };
        let straight = straight.clone().expect("two points make a path");
        for (path, is_bent) in [
            (formula(None, false), true),
            (formula(Some(CoefficientId(0)), true), true),
            (
                CurvePath::through_points(straight, Some(CoefficientId(1))),
                false,
            ),
        ] {
            for axis in [Axis::X, Axis::Y] {
                let on_curve = OnCurve {
                    coordinate: Projection {
                        from,
                        to,
                        axes: from,
                        axis,
                    },
                    path: path.clone(),
                    place,
                };
                samples.push(Box::new(on_curve.place()));
                samples.push(Box::new(on_curve));
            }
            if is_bent {
                samples.push(Box::new(AlongCurve {
                    from,
                    to,
                    path,
                    place,
                }));
            }
        }
    }
}

/// Returns the relation of an equation without parameters. One of linear terms is one with the
/// coefficients of the samples.
fn coupling(equation: &CoordinateEquation) -> Coupling {
    let linear = equation.difference.linear_form(equation.coordinates.len());
    let coordinates = equation.coordinates.iter();
    Coupling {
        coordinates: coordinates
            .map(|(_, coordinate)| CoordinateRelation::of(coordinate))
            .collect(),
        function: match linear {
            Some(linear) => CoupledFunction::Linear {
                factors: (0..linear.factors.len())
                    .map(|k| CoefficientId(k % 2))
                    .collect(),
                rest: CoefficientId(0),
                is_fixed: true,
            },
            None => CoupledFunction::Expression(CoupledExpression {
                expression: equation.difference.clone(),
                parameters: ParameterCoefficients::default(),
                law: equation.law.as_ref().map(|_| LawId(0)),
                jumps_by: None,
            }),
        },
        dimension: Dimension::Length,
    }
}

/// Returns the law of the sample's coupling.
fn law(mechanism: &Mechanism) -> PrescribedMotion {
    let mut laws = mechanism
        .joints
        .iter()
        .filter_map(|joint| match &joint.kind {
            JointKind::Coupling(equation) => equation.law.clone(),
            _ => None,
        });
    laws.next().expect("the sample has a law")
}

/// Returns the law of the sample on some type of numbers.
fn law_on<N: Number>(mechanism: &Mechanism) -> Vec<MotionInForce<N>> {
    let mut law = MotionInForce::new(&law(mechanism), 0);
    law.set_parameters(|_| N::constant(0.0));
    vec![law]
}

/// Returns the coefficients of the samples.
fn coefficients() -> Vec<Coefficient> {
    [0.3, 0.7]
        .map(|value| Coefficient {
            expression: Expression::constant(value),
            what: "a sample".to_owned(),
        })
        .to_vec()
}

fn configuration(mechanism: &Mechanism) -> Configuration {
    let JointKind::Cam { profile, .. } = &mechanism.joints[0].kind else {
        panic!("the sample has a cam");
    };
    let profiles = vec![CamProfile {
        in_force: ProfileInForce::new(profile, 0),
        what: "a sample".to_owned(),
    }];
    let law = law(mechanism);
    let laws = vec![CouplingLaw {
        in_force: MotionInForce::new(&law, 0),
        enclosed: MotionInForce::new(&law, 0),
        law,
        what: "a sample".to_owned(),
    }];
    let mut at = Configuration::new(mechanism, coefficients().len(), (profiles, laws), 1);
    at.set_parameters(mechanism, &coefficients(), &[])
        .expect("the sample has numbers only");
    at
}

/// Makes the sample on numbers with derivatives.
fn varied<N: Number>(mechanism: &Mechanism) -> VariedConfiguration<N> {
    VariedConfiguration::new(mechanism, &coefficients(), UNKNOWNS)
}

fn mechanism() -> Mechanism {
    Mechanism::parse(&Source::new("sample.toml", BODIES))
        .expect("the sample is right")
        .0
}

/// Draws a pose and a velocity. Bodies are at least 0.4 m from each other and from ground, and
/// markers at most 0.31 m from the origins, so that no distance is near zero, where it is not
/// smooth.
fn pose_and_velocity() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    let body = |x: f64| (x..x + 0.6, -0.3..0.3, -7.0..7.0);
    let pose = (body(1.5), body(3.5), body(5.5), -7.0..7.0);
    (pose, prop::collection::vec(-1.0..1.0, UNKNOWNS)).prop_map(|((a, b, c, contact), velocity)| {
        let bodies = [a, b, c].into_iter().flat_map(|q| [q.0, q.1, q.2]);
        (bodies.chain([contact]).collect(), velocity)
    })
}

/// Returns all entries of a row.
fn dense(row: &Gradient) -> [f64; UNKNOWNS] {
    let mut dense = [0.0; UNKNOWNS];
    row.entries()
        .for_each(|(column, value)| dense[column] += value);
    dense
}

fn moved(q: &[f64], direction: &[f64], s: f64) -> Vec<f64> {
    q.iter().zip(direction).map(|(q, d)| q + s * d).collect()
}

/// Returns the derivative of `f` at 0 by the central difference of fourth order. With h = 1e-3 its
/// truncation error h⁴ f⁽⁵⁾/30 and its rounding error eps f/h both stay below some 1e-12 for the
/// functions here, whose derivatives are of the order of one (|q̇| ≤ 1, lengths up to 7 m).
fn derivative(f: impl Fn(f64) -> f64) -> f64 {
    const H: f64 = 1e-3;
    (8.0 * (f(H) - f(-H)) - (f(2.0 * H) - f(-2.0 * H))) / (12.0 * H)
}

const DIFFERENCE: f64 = 1e-10;

proptest! {
    #[test]
    fn gradient_and_quadratic_term_agree_with_differences((q, q_dot) in pose_and_velocity()) {
        let mechanism = mechanism();
        let mut at = configuration(&mechanism);
        for constraint in samples(&mechanism) {
            let along = |at: &mut Configuration, s: f64| {
                at.set_pose(&mechanism, &moved(&q, &q_dot, s));
                let mut row = Gradient::new();
                constraint.gradient(at, &mut row);
                (constraint.value(at), row.dot(&q_dot), constraint.quadratic(at, &q_dot))
            };
            let at = std::cell::RefCell::new(&mut at);
            let (_, rate, quadratic) = along(&mut at.borrow_mut(), 0.0);
            if constraint.is_linear(&mechanism) {
                let (_, moved, quadratic) = along(&mut at.borrow_mut(), 1.0);
                prop_assert!(
                    (rate - moved).abs() < 1e-12 && quadratic.abs() < f64::EPSILON,
                    "{constraint:?}: {rate} {moved} {quadratic}"
                );
            }
            let difference = derivative(|s| along(&mut at.borrow_mut(), s).0);
            prop_assert!((rate - difference).abs() < DIFFERENCE, "{constraint:?}: {rate} {difference}");
            let difference = derivative(|s| along(&mut at.borrow_mut(), s).1);
            prop_assert!(
                (quadratic - difference).abs() < 10.0 * DIFFERENCE,
                "{constraint:?}: {quadratic} {difference}"
            );
        }
    }

    /// Value, gradient and quadratic term written by hand agree with those that follow from the
    /// formula.
    #[test]
    fn derivatives_by_hand_are_those_of_the_formula((q, q_dot) in pose_and_velocity()) {
        let mechanism = mechanism();
        let mut at = configuration(&mechanism);
        at.set_pose(&mechanism, &q);
        for constraint in samples(&mechanism) {
            let (mut by_hand, mut derived) = (Gradient::new(), Gradient::new());
            let values = [
                constraint.value(&at),
                constraint.value_and_gradient(&at, &mut by_hand),
                constraint.quadratic(&at, &q_dot),
            ];
            let of_formula = [
                definition::derived_value(&*constraint, &at),
                definition::derived_gradient(&*constraint, &at, &mut derived),
                definition::derived_quadratic(&*constraint, &at, &q_dot),
            ];
            let values = values.into_iter().chain(dense(&by_hand));
            let of_formula = of_formula.into_iter().chain(dense(&derived));
            for (by_hand, derived) in values.zip(of_formula) {
                // Rounding of sums of some products of lengths up to 7 m, angles and rates up to 1.
                prop_assert!(
                    (by_hand - derived).abs() < 1e-12 * (1.0 + by_hand.abs()),
                    "{constraint:?}: {by_hand} {derived}"
                );
            }
        }
    }

    /// For a motion, value, rate and acceleration agree with value, gradient and quadratic term,
    /// and their changes along a direction agree with differences.
    #[test]
    fn changes_along_a_direction_agree_with_differences(
        (q, q_dot) in pose_and_velocity(),
        q_ddot in prop::collection::vec(-1.0..1.0_f64, UNKNOWNS),
        changes in prop::array::uniform3(prop::collection::vec(-1.0..1.0_f64, UNKNOWNS)),
    ) {
        let mechanism = mechanism();
        let mut at = configuration(&mechanism);
        let mut varied = varied(&mechanism);
        for k in 0..UNKNOWNS {
            let [value, first, second] = [q[k], q_dot[k], q_ddot[k]].map(Dual::constant);
            varied.set_coordinate(k, Varied::new(value, [first, second]));
        }
        for (order, changes) in changes.iter().enumerate() {
            varied.change(order, changes);
        }
        let profiles = at.profiles().iter();
        let profiles: Vec<_> = profiles.map(|profile| profile.in_force.along(|_| 0.0)).collect();
        let curves = CurvesAlong { profiles, laws: law_on(&mechanism) };
        let varied = VariedMechanism { bodies: &varied, curves: &curves };
        for constraint in samples(&mechanism) {
            let mut motion = |s: f64| {
                let q = moved(&q, &changes[0], s);
                let q_dot = moved(&q_dot, &changes[1], s);
                let q_ddot = moved(&q_ddot, &changes[2], s);
                at.set_pose(&mechanism, &q);
                let mut row = Gradient::new();
                constraint.gradient(&at, &mut row);
                let acceleration = row.dot(&q_ddot) + constraint.quadratic(&at, &q_dot);
                [constraint.value(&at), row.dot(&q_dot), acceleration]
            };
            let along: Varied = constraint.along(&varied);
            let here = motion(0.0);
            let motion = std::cell::RefCell::new(motion);
            for (order, along) in [along.value, along.first(), along.second()].iter().enumerate() {
                // Sums of some products of lengths up to 7 m, angles and rates up to 1.
                prop_assert!(
                    (along.value - here[order]).abs() < 1e-12,
                    "{constraint:?} {order}: {} {}", along.value, here[order]
                );
                let difference = derivative(|s| motion.borrow_mut()(s)[order]);
                prop_assert!(
                    (along.first() - difference).abs() < 1e3 * DIFFERENCE,
                    "{constraint:?} {order}: {} {difference}", along.first()
                );
            }
        }
    }

    /// At points of the region the gradient changes by no more than its bound, by hand and by the
    /// formula, and the quadratic term is within its bound.
    #[test]
    fn bend_bounds_hold_in_their_region(
        (q, v) in pose_and_velocity(),
        radii in prop::collection::vec(0.0..0.4_f64, UNKNOWNS),
        line in prop::option::of(0.0..0.4_f64),
        width in prop::sample::select(vec![1.0, 0.1]),
        places in prop::collection::vec(prop::collection::vec(-1.0..1.0_f64, UNKNOWNS), 10),
        along in prop::collection::vec(-0.5..0.5_f64, 10),
    ) {
        let radii: Vec<_> = radii.iter().map(|radius| width * radius).collect();
        let v = moved(&[0.0; UNKNOWNS], &v, line.unwrap_or(1.0));
        let region = Region { radii: &radii, line: line.map(|_| &v[..]) };
        let mechanism = mechanism();
        let mut at = configuration(&mechanism);
        for constraint in samples(&mechanism) {
            at.set_pose(&mechanism, &q);
            let mut row = Gradient::new();
            constraint.gradient(&at, &mut row);
            let centre = dense(&row);
            row.clear();
            let by_hand = constraint.bend(&at, &region, &v, &mut row).map(|bound| (bound, dense(&row)));
            row.clear();
            let derived = definition::derived_bend(&*constraint, &at, &region, &v, &mut row);
            let derived = derived.map(|bound| (bound, dense(&row)));
            for (bound, change) in by_hand.into_iter().chain(derived) {
                for (place, along) in places.iter().zip(&along) {
                    let off: Vec<_> = place.iter().zip(&radii).map(|(p, r)| p * r).collect();
                    let here = line.map_or(q.clone(), |_| moved(&q, &v, *along));
                    at.set_pose(&mechanism, &moved(&here, &off, 1.0));
                    row.clear();
                    constraint.gradient(&at, &mut row);
                    let here = dense(&row);
                    for k in 0..UNKNOWNS {
                        let changed = (here[k] - centre[k]).abs();
                        // Rounding of values up to 7 m.
                        prop_assert!(
                            changed <= change[k] + 1e-13,
                            "{constraint:?} column {k}: {changed} > {}", change[k]
                        );
                    }
                    let quadratic = constraint.quadratic(&at, &v).abs();
                    prop_assert!(quadratic <= bound + 1e-13, "{constraint:?}: {quadratic} > {bound}");
                }
            }
        }
    }

    /// Along a chord, value, rate and acceleration of the formula lie in their enclosures; around it
    /// the gradient does.
    #[test]
    fn enclosures_hold_on_their_chord_and_around_it(
        (q, v) in pose_and_velocity(),
        radii in prop::collection::vec(0.0..0.1_f64, UNKNOWNS),
        length in prop::sample::select(vec![0.3, 0.03]),
        places in prop::collection::vec(prop::collection::vec(-1.0..1.0_f64, UNKNOWNS), 5),
        along in prop::collection::vec(0.0..1.0_f64, 5),
    ) {
        let v = moved(&[0.0; UNKNOWNS], &v, length);
        let mechanism = mechanism();
        let mut at = configuration(&mechanism);
        let mut chord = varied(&mechanism);
        let mut around = varied(&mechanism);
        for k in 0..UNKNOWNS {
            let way = Interval::new(q[k].min(q[k] + v[k]), q[k].max(q[k] + v[k]));
            chord.set_coordinate(k, Enclosed::linear(way, Interval::point(v[k])));
            let wider = Interval::new(way.low - radii[k], way.high + radii[k]);
            around.set_coordinate(k, Enclosed::fixed(wider));
        }
        let profiles = at.profiles().to_vec();
        let laws = law_on(&mechanism);
        let curves = EnclosedCurves { in_force: &profiles, moving: &[], laws: &laws };
        let chord = VariedMechanism { bodies: &chord, curves };
        for constraint in samples(&mechanism) {
            let on_chord: Enclosed = constraint.along(&chord);
            let motion = [on_chord.value, on_chord.first(), on_chord.second()];
            let gradient: Vec<_> = (0..UNKNOWNS)
                .map(|k| partial(&*constraint, &mut around, curves, k))
                .collect();
            for (place, s) in places.iter().zip(&along) {
                let here = moved(&q, &v, *s);
                at.set_pose(&mechanism, &here);
                let mut row = Gradient::new();
                constraint.gradient(&at, &mut row);
                let values = [constraint.value(&at), row.dot(&v), constraint.quadratic(&at, &v)];
                let off: Vec<_> = place.iter().zip(&radii).map(|(p, r)| p * r).collect();
                at.set_pose(&mechanism, &moved(&here, &off, 1.0));
                row.clear();
                constraint.gradient(&at, &mut row);
                let mut slopes = [0.0; UNKNOWNS];
                row.entries().for_each(|(column, value)| slopes[column] += value);
                let pairs = values.iter().zip(&motion).chain(slopes.iter().zip(&gradient));
                for (value, bounds) in pairs {
                    // Rounding of values up to 7 m. Where the angle of a knife edge may jump there
                    // is no enclosure.
                    let inside = bounds.low - 1e-13 <= *value && *value <= bounds.high + 1e-13;
                    prop_assert!(
                        inside || bounds.is_undefined() && constraint.has_given_function(),
                        "{constraint:?}: {value} {bounds:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn incidence_is_the_pattern_of_the_gradient((q, _) in pose_and_velocity()) {
        let mechanism = mechanism();
        let mut at = configuration(&mechanism);
        at.set_pose(&mechanism, &q);
        for constraint in samples(&mechanism) {
            let mut row = Gradient::new();
            constraint.gradient(&at, &mut row);
            let mut touched: Vec<_> = row
                .entries()
                .filter(|(_, value)| value.abs() > 1e-12)
                .map(|(column, _)| column)
                .collect();
            touched.sort_unstable();
            let mut incidence = Incidence::default();
            constraint.incidence(&mechanism, &mut incidence);
            incidence.unknowns.sort_unstable();
            incidence.unknowns.dedup();
            prop_assert_eq!(incidence.unknowns, touched, "{:?}", constraint);
        }
    }
}

#[test]
fn the_distance_of_coincident_points_has_a_gradient() {
    let mechanism = mechanism();
    let mut at = configuration(&mechanism);
    at.set_pose(&mechanism, &[0.0; UNKNOWNS]);
    // ground.H is the second marker, a.O the fourth; both are at the origin.
    let distance = Distance {
        from: MarkerId(1),
        to: MarkerId(3),
    };
    let mut row = Gradient::new();
    distance.gradient(&at, &mut row);
    assert_eq!(
        row.entries().collect::<Vec<_>>(),
        [(0, 1.0), (1, 0.0), (2, 0.0)]
    );
}

#[test]
fn a_distance_admits_positive_values_only() {
    let distance = Distance {
        from: MarkerId(0),
        to: MarkerId(1),
    };
    assert!(distance.admits(f64::MIN_POSITIVE));
    assert!(!distance.admits(0.0));
    assert!(!distance.admits(-1.0));
    assert!(!distance.admits(f64::NAN));
}

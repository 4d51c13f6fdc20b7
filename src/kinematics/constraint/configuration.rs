//! The configuration: the bodies at one q, and the markers on them.

use std::f64::consts::TAU;

use nalgebra::Vector2;

use crate::kinematics::Error;
use crate::kinematics::tolerances::NEGLIGIBLE_LENGTH;
use crate::mechanism::{
    BodyId, Core, Expression, FeatureKind, Interval, Jet, Jet3, MarkerId, Mechanism, MotionInForce,
    Number, ParameterId, PrescribedMotion, ProfileInForce, Shape, ShapeId,
};

/// Returns a vector turned by a quarter turn: the derivative of A(phi) s is `perp(A(phi) s)`.
#[must_use]
pub fn perp(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// Returns the unit vector in the direction `angle`. At a right angle such as `90*deg`, which is
/// one up to rounding only, it has exact zeros, as the structure of the equations has.
#[must_use]
pub(in crate::kinematics) fn axis(angle: f64) -> Vector2<f64> {
    let (sin, cos) = angle.sin_cos();
    let rounding = f64::EPSILON * angle.abs().max(1.0);
    if sin.abs() <= rounding {
        Vector2::new(cos.signum(), 0.0)
    } else if cos.abs() <= rounding {
        Vector2::new(0.0, sin.signum())
    } else {
        Vector2::new(cos, sin)
    }
}

/// Returns an angle on the turn nearest to `guess` \[rad\].
pub(in crate::kinematics) fn on_nearest_turn(angle: f64, guess: f64) -> f64 {
    angle + TAU * ((guess - angle) / TAU).round()
}

/// A marker in its body's frame, with the parameter values in force.
#[derive(Clone, Copy, Debug)]
struct LocalFrame {
    body: Option<BodyId>,
    /// s = (x', y').
    position: Vector2<f64>,
    /// The marker's x-axis.
    axis: Vector2<f64>,
    angle: f64,
}

/// A marker in global coordinates.
#[derive(Clone, Copy, Debug)]
pub struct MarkerPose {
    /// The body that carries it, `None` on ground.
    pub body: Option<BodyId>,
    /// A(phi) s: from the body's origin to the marker \[m\].
    pub arm: Vector2<f64>,
    /// P = r + A(phi) s \[m\].
    pub point: Vector2<f64>,
    /// u, the marker's x-axis.
    pub axis: Vector2<f64>,
    /// theta, its direction \[rad\], counting turns.
    pub theta: f64,
}

/// A body's frame in global coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::kinematics) struct BodyPose {
    /// r, its origin \[m\].
    pub(in crate::kinematics) origin: Vector2<f64>,
    /// phi \[rad\], counting turns.
    pub(in crate::kinematics) phi: f64,
    pub(in crate::kinematics) cos: f64,
    pub(in crate::kinematics) sin: f64,
}

impl BodyPose {
    /// Frame of ground.
    const GROUND: Self = Self {
        origin: Vector2::new(0.0, 0.0),
        phi: 0.0,
        cos: 1.0,
        sin: 0.0,
    };

    /// Returns a frame at the origin, turned by phi.
    #[inline(always)]
    pub(in crate::kinematics) fn turned(phi: f64) -> Self {
        let (sin, cos) = phi.sin_cos();
        Self {
            origin: Vector2::new(0.0, 0.0),
            phi,
            cos,
            sin,
        }
    }

    /// Returns A(phi) s.
    #[inline(always)]
    pub(in crate::kinematics) fn rotate(&self, s: Vector2<f64>) -> Vector2<f64> {
        rotate(self.cos, self.sin, s)
    }
}

/// Returns a vector turned by the angle with this cosine and sine.
#[inline(always)]
pub(in crate::kinematics) fn rotate(cos: f64, sin: f64, s: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(cos * s.x - sin * s.y, sin * s.x + cos * s.y)
}

/// A number in a relation that depends on parameters: index into the system's coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoefficientId(pub usize);

/// The coefficients that have the values of the parameters of an expression.
#[derive(Clone, Debug, Default)]
pub struct ParameterCoefficients(pub Vec<(ParameterId, CoefficientId)>);

impl ParameterCoefficients {
    /// Returns the coefficient of a parameter.
    ///
    /// # Panics
    ///
    /// If the expression does not use the parameter.
    #[must_use]
    pub fn of(&self, parameter: ParameterId) -> CoefficientId {
        let mut known = self.0.iter();
        let found = known.find(|(id, _)| *id == parameter);
        found.expect("all its parameters are coefficients").1
    }
}

/// A joint unknown, which belongs to no body: its index behind the unknowns of the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointUnknownId(pub usize);

/// The profile of a cam: index into the system's profiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProfileId(pub usize);

/// The law of a coupling: index into the system's laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LawId(pub usize);

/// The law of a coupling with the parameters in force, with the joint that it belongs to for
/// messages.
#[derive(Clone, Debug)]
pub struct CouplingLaw {
    /// The law, which is a function of one argument as a motion is of time.
    pub law: PrescribedMotion,
    /// On numbers with derivatives.
    pub in_force: MotionInForce,
    /// On ranges of the argument.
    pub enclosed: MotionInForce<Jet3<Interval>>,
    /// Kind and name of the joint.
    pub what: String,
}

/// The profile of a cam, with the joint that it belongs to for messages.
#[derive(Clone, Debug)]
pub struct CamProfile {
    /// The profile with the parameter values in force.
    pub in_force: ProfileInForce,
    /// Kind and name of the joint.
    pub what: String,
}

/// A coefficient of a relation.
#[derive(Clone, Debug)]
pub struct Coefficient {
    /// Its value as a function of the parameters.
    pub expression: Expression,
    /// The joint that it belongs to, for messages.
    pub what: String,
}

/// The core of a shape on its body, with the parameter values in force. Those of shapes that no clearance
/// names are empty.
#[derive(Clone, Debug)]
pub(in crate::kinematics) struct ShapeCore<N> {
    /// The body that has it, `None` on ground.
    pub(in crate::kinematics) body: Option<BodyId>,
    /// Core and radius in the body's frame.
    pub(in crate::kinematics) core: Core<N>,
    /// Radius of a circle about the body's origin that contains the core \[m\].
    pub(in crate::kinematics) reach: f64,
    is_watched: bool,
}

impl<N: Number> ShapeCore<N> {
    /// Makes the storage for all shapes of a mechanism.
    pub(super) fn all(mechanism: &Mechanism) -> Vec<Self> {
        let shapes = mechanism.shapes.iter().zip((0..).map(ShapeId));
        let cores = shapes.map(|(shape, id)| {
            let is_watched = mechanism.has_clearance_of(id);
            Self {
                body: shape.body,
                core: if is_watched {
                    Core::for_shape(shape)
                } else {
                    Core::default()
                },
                reach: 0.0,
                is_watched,
            }
        });
        cores.collect()
    }

    /// Takes over places of markers and numbers. Allocates nothing.
    pub(super) fn set(
        &mut self,
        shape: &Shape,
        point: &dyn Fn(MarkerId) -> [N; 2],
        number: &dyn Fn(&Expression) -> N,
    ) {
        if !self.is_watched {
            return;
        }
        self.core.set(shape, point, number);
        let distance = |[x, y]: [N; 2]| x.real().hypot(y.real());
        let reaches = self.core.features.iter().map(|feature| match feature.kind {
            FeatureKind::Place => distance(feature.center),
            FeatureKind::Edge => distance(feature.ends[0]).max(distance(feature.ends[1])),
            _ => distance(feature.center) + feature.radius.real(),
        });
        self.reach = reaches.fold(0.0, f64::max);
    }
}

/// The bodies of a mechanism at one q, and the markers on them.
///
/// Made once; [`set_parameters`](Self::set_parameters) and [`set_pose`](Self::set_pose) then
/// change it without allocating. A marker's pose is computed on demand.
#[derive(Clone, Debug)]
pub struct Configuration {
    frames: Vec<LocalFrame>,
    /// The bodies, then ground.
    bodies: Vec<BodyPose>,
    coefficients: Vec<f64>,
    profiles: Vec<CamProfile>,
    laws: Vec<CouplingLaw>,
    cores: Vec<ShapeCore<f64>>,
    /// The joint unknowns, behind those of the bodies.
    joint_unknowns: Vec<f64>,
    size: f64,
}

impl Configuration {
    /// Makes a configuration of all bodies at the origin; parameter values are still to be set.
    #[must_use]
    pub fn new(
        mechanism: &Mechanism,
        coefficients: usize,
        (profiles, laws): (Vec<CamProfile>, Vec<CouplingLaw>),
        joint_unknowns: usize,
    ) -> Self {
        let frames = mechanism
            .markers
            .iter()
            .map(|marker| LocalFrame {
                body: marker.body,
                position: Vector2::zeros(),
                axis: Vector2::x(),
                angle: 0.0,
            })
            .collect();
        Self {
            frames,
            bodies: vec![BodyPose::GROUND; mechanism.bodies.len() + 1],
            coefficients: vec![0.0; coefficients],
            profiles,
            laws,
            cores: ShapeCore::all(mechanism),
            joint_unknowns: vec![0.0; joint_unknowns],
            size: 0.0,
        }
    }

    /// Evaluates the markers' places on their bodies, coefficients and profiles for these parameter
    /// values.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] if an expression leaves its domain, [`Error::Profile`] for a profile
    /// that makes no contour; the configuration is then without use until valid values are set.
    pub fn set_parameters(
        &mut self,
        mechanism: &Mechanism,
        coefficients: &[Coefficient],
        parameters: &[f64],
    ) -> Result<(), Error> {
        let value = |p: ParameterId| parameters[p.index()];
        for (index, (frame, marker)) in self.frames.iter_mut().zip(&mechanism.markers).enumerate() {
            frame.position = Vector2::new(
                marker.position[0].evaluate(&value, 0.0),
                marker.position[1].evaluate(&value, 0.0),
            );
            frame.angle = marker.angle.evaluate(&value, 0.0);
            if !(frame.position.sum() + frame.angle).is_finite() {
                return Err(Error::NotFinite {
                    what: format!("marker `{}`", mechanism.marker_path(MarkerId(index))),
                });
            }
            frame.axis = axis(frame.angle);
        }
        let frames = &self.frames;
        for (core, shape) in self.cores.iter_mut().zip(&mechanism.shapes) {
            let point = |id: MarkerId| frames[id.index()].position.into();
            core.set(shape, &point, &|number| number.evaluate(&value, 0.0));
        }
        for (value_in_force, coefficient) in self.coefficients.iter_mut().zip(coefficients) {
            *value_in_force = coefficient.expression.evaluate(&value, 0.0);
            if !value_in_force.is_finite() {
                return Err(Error::NotFinite {
                    what: coefficient.what.clone(),
                });
            }
        }
        for profile in &mut self.profiles {
            let set = profile.in_force.set_parameters(value);
            set.map_err(|error| Error::Profile {
                what: profile.what.clone(),
                error,
            })?;
        }
        for law in &mut self.laws {
            law.in_force.set_parameters(|p| Jet::constant(value(p)));
            law.enclosed.set_parameters(|p| Jet3::constant(value(p)));
            if !law.in_force.evaluate(Jet::constant(0.0)).is_finite() {
                return Err(Error::NotFinite {
                    what: law.what.clone(),
                });
            }
        }
        self.size = size(mechanism, &self.frames, &self.profiles);
        Ok(())
    }

    /// Moves the bodies to q, \[m, m, rad\] for each body, then the joint unknowns.
    pub fn set_pose(&mut self, mechanism: &Mechanism, q: &[f64]) {
        let (bodies, joint_unknowns) = q.split_at(3 * mechanism.bodies.len());
        self.joint_unknowns.copy_from_slice(joint_unknowns);
        for (body, q) in self.bodies.iter_mut().zip(bodies.chunks_exact(3)) {
            *body = BodyPose {
                origin: Vector2::new(q[0], q[1]),
                ..BodyPose::turned(q[2])
            };
        }
    }

    /// Writes q in the order in which [`set_pose`](Self::set_pose) reads it.
    pub(in crate::kinematics) fn copy_pose(&self, q: &mut [f64]) {
        let (bodies, joint_unknowns) = q.split_at_mut(3 * (self.bodies.len() - 1));
        for (body, q) in self.bodies.iter().zip(bodies.chunks_exact_mut(3)) {
            q[0] = body.origin.x;
            q[1] = body.origin.y;
            q[2] = body.phi;
        }
        joint_unknowns.copy_from_slice(&self.joint_unknowns);
    }

    /// Returns the unknown q\[column\].
    pub(in crate::kinematics) fn coordinate(&self, column: usize) -> f64 {
        let place = column / 3;
        if place >= self.bodies.len() - 1 {
            return self.joint_unknowns[column - 3 * (self.bodies.len() - 1)];
        }
        let body = &self.bodies[place];
        match column % 3 {
            0 => body.origin.x,
            1 => body.origin.y,
            _ => body.phi,
        }
    }

    /// Sets the unknown q\[column\].
    pub(in crate::kinematics) fn set_coordinate(&mut self, column: usize, value: f64) {
        let place = column / 3;
        if place >= self.bodies.len() - 1 {
            self.joint_unknowns[column - 3 * (self.bodies.len() - 1)] = value;
            return;
        }
        let body = &mut self.bodies[place];
        match column % 3 {
            0 => body.origin.x = value,
            1 => body.origin.y = value,
            _ => {
                body.phi = value;
                (body.sin, body.cos) = value.sin_cos();
            }
        }
    }

    /// Returns the frames of the bodies, then that of ground.
    #[inline(always)]
    pub(in crate::kinematics) fn frames(&self) -> &[BodyPose] {
        &self.bodies
    }

    /// Returns the frames of the bodies, to be changed, then that of ground.
    #[inline(always)]
    pub(in crate::kinematics) fn frames_mut(&mut self) -> &mut [BodyPose] {
        &mut self.bodies
    }

    /// Returns the core of a shape with the parameter values in force.
    pub(in crate::kinematics) fn core(&self, shape: ShapeId) -> &ShapeCore<f64> {
        &self.cores[shape.index()]
    }

    /// Returns the frame of a body, that of ground for `None`.
    pub(in crate::kinematics) fn frame(&self, body: Option<BodyId>) -> &BodyPose {
        let place = body.map_or(self.bodies.len() - 1, BodyId::index);
        &self.bodies[place]
    }

    /// Returns a marker's place on its body: s, and its angle.
    pub(in crate::kinematics) fn local(&self, marker: MarkerId) -> (Vector2<f64>, f64) {
        let frame = &self.frames[marker.index()];
        (frame.position, frame.angle)
    }

    /// Returns a marker's pose.
    #[must_use]
    pub fn marker(&self, marker: MarkerId) -> MarkerPose {
        let frame = &self.frames[marker.index()];
        let body = self.frame(frame.body);
        let arm = body.rotate(frame.position);
        MarkerPose {
            body: frame.body,
            arm,
            point: body.origin + arm,
            axis: body.rotate(frame.axis),
            theta: body.phi + frame.angle,
        }
    }

    /// Returns a body's angle \[rad\], zero for ground.
    #[must_use]
    pub fn phi(&self, body: Option<BodyId>) -> f64 {
        self.frame(body).phi
    }

    /// Returns a coefficient with the parameter values in force.
    #[must_use]
    pub fn coefficient(&self, id: CoefficientId) -> f64 {
        self.coefficients[id.0]
    }

    /// Returns the value of a joint unknown.
    #[must_use]
    pub fn joint_unknown(&self, id: JointUnknownId) -> f64 {
        self.joint_unknowns[id.0]
    }

    /// Returns the index in q of a joint unknown.
    #[must_use]
    pub fn joint_unknown_column(&self, id: JointUnknownId) -> usize {
        3 * (self.bodies.len() - 1) + id.0
    }

    /// Returns a cam's profile with the parameter values in force.
    #[must_use]
    pub fn profile(&self, id: ProfileId) -> &ProfileInForce {
        &self.profiles[id.0].in_force
    }

    /// Returns the law of a coupling with the parameter values in force.
    #[must_use]
    pub fn law(&self, id: LawId) -> &CouplingLaw {
        &self.laws[id.0]
    }

    /// Returns all profiles.
    pub(in crate::kinematics) fn profiles(&self) -> &[CamProfile] {
        &self.profiles
    }

    /// Returns the mechanism's characteristic length \[m\], which makes metres and radians
    /// comparable.
    ///
    /// It is the extent of the largest body, the radius of the largest cam or the largest length
    /// that a joint holds, not the extent of the whole, so that a long chain of small loops is
    /// measured by its loops.
    #[must_use]
    pub fn size(&self) -> f64 {
        if self.size > 0.0 { self.size } else { 1.0 }
    }

    /// Makes the [size](Self::size) at least a length that a joint holds, unless it is rounding.
    pub(in crate::kinematics) fn enlarge(&mut self, length: f64) {
        if length > NEGLIGIBLE_LENGTH {
            self.size = self.size.max(length);
        }
    }
}

/// Returns the diagonal of the box around places; zero if rounding alone tells them apart, and
/// without any finite place.
pub(in crate::kinematics) fn extent(places: impl Iterator<Item = Vector2<f64>>) -> f64 {
    let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY].map(Vector2::repeat);
    for place in places {
        (low, high) = (low.inf(&place), high.sup(&place));
    }
    let diagonal = f64::hypot(high.x - low.x, high.y - low.y);
    let farthest = low.abs().sup(&high.abs()).max();
    if diagonal.is_finite() && diagonal > NEGLIGIBLE_LENGTH * farthest.max(1.0) {
        diagonal
    } else {
        0.0
    }
}

/// Returns the extent of the largest body or cam, or of ground's markers; zero if none has any.
fn size(mechanism: &Mechanism, frames: &[LocalFrame], profiles: &[CamProfile]) -> f64 {
    let bodies = (mechanism.bodies.iter())
        .map(|body| extent(body.markers.iter().map(|m| frames[m.index()].position)))
        .fold(0.0, f64::max);
    let cams = profiles.iter().map(|p| p.in_force.radius(0.0).value);
    let largest = cams.fold(bodies, f64::max);
    if largest > 0.0 {
        return largest;
    }
    let of_ground = frames.iter().filter(|frame| frame.body.is_none());
    extent(of_ground.map(|frame| frame.position))
}

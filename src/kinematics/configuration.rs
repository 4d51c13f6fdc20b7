//! Where every marker is, for a given q: what all constraints read.

use nalgebra::{Rotation2, Vector2};

use super::Error;
use crate::mechanism::{BodyId, Expression, MarkerId, Mechanism, ProfileInForce};

/// A vector turned by a quarter turn: the derivative of A(phi) s is `perp(A(phi) s)`.
#[must_use]
pub fn perp(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
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

/// A number in a relation that depends on parameters: index into the system's coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoefficientId(pub usize);

/// An unknown that a joint brings with it: its place behind the unknowns of the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointUnknownId(pub usize);

/// The profile of a cam: index into the system's profiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProfileId(pub usize);

/// What a relation needs besides markers, known when the equations are written down.
#[derive(Clone, Debug)]
pub struct Coefficient {
    /// Its value as a function of the parameters.
    pub expression: Expression,
    /// What it belongs to, for messages.
    pub what: String,
}

/// The markers of a mechanism at one q.
///
/// Made once; [`set_parameters`](Self::set_parameters) and [`set_pose`](Self::set_pose) then
/// change it without allocating.
#[derive(Clone, Debug)]
pub struct Configuration {
    frames: Vec<LocalFrame>,
    markers: Vec<MarkerPose>,
    phis: Vec<f64>,
    coefficients: Vec<f64>,
    profiles: Vec<ProfileInForce>,
    /// The unknowns behind those of the bodies, which joints bring with them.
    joint_unknowns: Vec<f64>,
    size: f64,
}

impl Configuration {
    /// A configuration of all bodies at the origin, for parameter values still to be set, with
    /// room for what the system's joints need.
    #[must_use]
    pub fn new(
        mechanism: &Mechanism,
        coefficients: usize,
        profiles: Vec<ProfileInForce>,
        joint_unknowns: usize,
    ) -> Self {
        let frames: Vec<_> = mechanism
            .markers
            .iter()
            .map(|marker| LocalFrame {
                body: marker.body,
                position: Vector2::zeros(),
                axis: Vector2::x(),
                angle: 0.0,
            })
            .collect();
        let markers = frames.iter().map(LocalFrame::on_ground).collect();
        Self {
            frames,
            markers,
            phis: vec![0.0; mechanism.bodies.len()],
            coefficients: vec![0.0; coefficients],
            profiles,
            joint_unknowns: vec![0.0; joint_unknowns],
            size: 0.0,
        }
    }

    /// Takes over the markers' places on their bodies and the coefficients for these parameter
    /// values.
    ///
    /// The pose has to be set anew afterwards.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] if an expression leaves its domain; the configuration is then
    /// without use until valid values are set.
    pub fn set_parameters(
        &mut self,
        mechanism: &Mechanism,
        coefficients: &[Coefficient],
        parameters: &[f64],
    ) -> Result<(), Error> {
        let value = |p: crate::mechanism::ParameterId| parameters[p.index()];
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
            frame.axis = Rotation2::new(frame.angle) * Vector2::x();
            if marker.body.is_none() {
                self.markers[index] = frame.on_ground();
            }
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
            profile.set_parameters(value);
        }
        self.size = size(mechanism, &self.frames);
        Ok(())
    }

    /// Moves the bodies to q, \[m, m, rad\] for each body, then the joints' own unknowns.
    pub fn set_pose(&mut self, mechanism: &Mechanism, q: &[f64]) {
        let (bodies, joint_unknowns) = q.split_at(3 * mechanism.bodies.len());
        self.joint_unknowns.copy_from_slice(joint_unknowns);
        for ((body, phi), q) in mechanism
            .bodies
            .iter()
            .zip(&mut self.phis)
            .zip(bodies.chunks_exact(3))
        {
            *phi = q[2];
            let origin = Vector2::new(q[0], q[1]);
            let rotation = Rotation2::new(q[2]);
            for marker in &body.markers {
                let frame = &self.frames[marker.index()];
                let arm = rotation * frame.position;
                self.markers[marker.index()] = MarkerPose {
                    body: frame.body,
                    arm,
                    point: origin + arm,
                    axis: rotation * frame.axis,
                    theta: q[2] + frame.angle,
                };
            }
        }
    }

    /// A marker's pose.
    #[must_use]
    pub fn marker(&self, marker: MarkerId) -> &MarkerPose {
        &self.markers[marker.index()]
    }

    /// A body's angle \[rad\], zero for ground.
    #[must_use]
    pub fn phi(&self, body: Option<BodyId>) -> f64 {
        body.map_or(0.0, |body| self.phis[body.index()])
    }

    /// A coefficient with the parameter values in force.
    #[must_use]
    pub fn coefficient(&self, id: CoefficientId) -> f64 {
        self.coefficients[id.0]
    }

    /// The value of a joint's own unknown.
    #[must_use]
    pub fn joint_unknown(&self, id: JointUnknownId) -> f64 {
        self.joint_unknowns[id.0]
    }

    /// The place in q of a joint's own unknown.
    #[must_use]
    pub fn joint_unknown_column(&self, id: JointUnknownId) -> usize {
        3 * self.phis.len() + id.0
    }

    /// A cam's profile with the parameter values in force.
    #[must_use]
    pub fn profile(&self, id: ProfileId) -> &ProfileInForce {
        &self.profiles[id.0]
    }

    /// The mechanism's characteristic length \[m\]: makes metres and radians comparable.
    ///
    /// It is the extent of the largest body or the largest length that a joint holds, not the
    /// extent of the whole, so that a long chain of small loops is measured by its loops.
    #[must_use]
    pub fn size(&self) -> f64 {
        if self.size > 0.0 { self.size } else { 1.0 }
    }

    /// Takes a length that a joint holds into account for the [size](Self::size).
    pub(super) fn enlarge(&mut self, length: f64) {
        self.size = self.size.max(length);
    }
}

impl LocalFrame {
    fn on_ground(&self) -> MarkerPose {
        MarkerPose {
            body: self.body,
            arm: self.position,
            point: self.position,
            axis: self.axis,
            theta: self.angle,
        }
    }
}

/// Extent of the largest body, else of ground's markers; zero if neither has any.
fn size(mechanism: &Mechanism, frames: &[LocalFrame]) -> f64 {
    let extent = |markers: &mut dyn Iterator<Item = &LocalFrame>| {
        let (low, high) = markers.fold(
            (
                Vector2::repeat(f64::INFINITY),
                Vector2::repeat(f64::NEG_INFINITY),
            ),
            |(low, high), frame| (low.inf(&frame.position), high.sup(&frame.position)),
        );
        if low.x <= high.x {
            (high - low).norm()
        } else {
            0.0
        }
    };
    let bodies = mechanism
        .bodies
        .iter()
        .map(|body| extent(&mut body.markers.iter().map(|m| &frames[m.index()])))
        .fold(0.0, f64::max);
    if bodies > 0.0 {
        return bodies;
    }
    extent(&mut frames.iter().filter(|frame| frame.body.is_none()))
}

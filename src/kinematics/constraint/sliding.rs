//! The way by which the two sides of a contact, or of a link's pin, have slid.
//!
//! Friction asks for its rates and gradient alone. The relative velocity at a contact is along the
//! tangent, in which it and the two places of contact move: with tangent and contact held in both
//! bodies, t · (P_j − P_i) has the rate, the acceleration and the gradient of sliding. Its value is zero.

use std::any::Any;

use super::cam::{Contour, FlatContact, KnifeEdge, Roller};
use super::configuration::{JointUnknownId, ProfileId};
use super::curve::{CurvePath, OnCurve};
use super::definition::{Constraint, Dimension, Formula, Incidence};
use super::moving_configuration::{
    Moving, VariedMarker, VariedMechanism, add, dot, quarter_turn, subtract,
};
use super::projection::Projection;
use crate::mechanism::{MarkerId, Mechanism, Number};

/// The way by which marker j, or the follower, has slid on the body of marker i.
#[derive(Clone, Debug)]
pub struct Sliding {
    /// Marker i.
    pub from: MarkerId,
    /// Marker j.
    pub to: MarkerId,
    /// Place at which they touch.
    pub contact: SlidingContact,
}

/// The place at which two bodies slide on each other.
#[derive(Clone, Debug)]
pub enum SlidingContact {
    /// The point j, on a curve.
    Curve(CurvePath, JointUnknownId),
    /// The point j, on the contour of a cam.
    Knife(ProfileId),
    /// The contact of a flat face.
    Face(Contour),
    /// The pin in the middle of a roller, which rolls on the contour: the angle by which it has turned.
    Roller(Contour),
    /// The pin at i of a rod to j: the angle of the rod.
    Rod,
}

impl Sliding {
    /// Returns the way along which the two sides of a joint slide with this relation; `None` for others.
    pub(in crate::kinematics) fn of(relation: &dyn Constraint) -> Option<Self> {
        let any: &dyn Any = relation;
        let (from, to, contact) = if let Some(own) = any.downcast_ref::<OnCurve>() {
            let Projection { from, to, .. } = own.coordinate;
            let contact = SlidingContact::Curve(own.path.clone(), own.place);
            (from, to, contact)
        } else if let Some(own) = any.downcast_ref::<KnifeEdge>() {
            (own.cam, own.follower, SlidingContact::Knife(own.profile))
        } else if let Some(own) = any.downcast_ref::<Roller>() {
            let contact = SlidingContact::Roller(own.contour);
            (own.contour.cam, own.follower, contact)
        } else {
            let own = any.downcast_ref::<FlatContact>()?;
            let contact = SlidingContact::Face(own.contour);
            (own.contour.cam, own.follower, contact)
        };
        Some(Self { from, to, contact })
    }

    fn markers(&self) -> [MarkerId; 2] {
        [self.from, self.to]
    }
}

/// Returns the point of a marker's body that is at a place now.
fn point_at<N: Number>(marker: &VariedMarker<N>, place: [N; 2]) -> [N; 2] {
    let (x, off) = (marker.axis, subtract(place, marker.point));
    let [along, across] = [dot(x, off), dot(quarter_turn(x), off)].map(Number::held);
    let y = quarter_turn(x);
    add(marker.point, [0, 1].map(|k| along * x[k] + across * y[k]))
}

impl Formula for Sliding {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let [i, j] = self.markers().map(|marker| at.marker(marker));
        let (place, tangent, radius) = match &self.contact {
            SlidingContact::Rod => {
                let off = subtract(j.point, i.point);
                let [x, y] = [dot(i.axis, off), dot(quarter_turn(i.axis), off)];
                // The half-line on which the angle jumps is nowhere near.
                let [cos, sin] = [x, y].map(Number::held);
                return (cos * y - sin * x).atan2(cos * x + sin * y);
            }
            SlidingContact::Curve(path, place) => {
                let slope = path.slope(at, at.joint_unknown(*place));
                let y = quarter_turn(i.axis);
                let along = [0, 1].map(|k| slope[0] * i.axis[k] + slope[1] * y[k]);
                let speed = slope[0].hypot(slope[1]);
                (j.point, along.map(|part| part / speed), None)
            }
            SlidingContact::Knife(profile) => {
                let arm = subtract(j.point, i.point);
                let theta = arm[1].atan2(arm[0]) - i.theta;
                let [radius, slope] = at.radius(*profile, theta);
                let speed = radius.hypot(slope);
                let distance = arm[0].hypot(arm[1]);
                let across = quarter_turn(arm);
                let tangent =
                    [0, 1].map(|k| (slope * arm[k] + radius * across[k]) / distance / speed);
                (j.point, tangent, None)
            }
            SlidingContact::Face(contour) => {
                let (cam, arm, tangent) = contour.along(at);
                (add(cam.point, arm), tangent, None)
            }
            SlidingContact::Roller(contour) => {
                let (cam, arm, tangent) = contour.along(at);
                let place = add(cam.point, arm);
                let [x, y] = subtract(j.point, place);
                (place, tangent, Some(x.hypot(y)))
            }
        };
        let off = subtract(point_at(&j, place), point_at(&i, place));
        let way = dot(tangent.map(Number::held), off);
        radius.map_or(way, |radius| way / radius.held())
    }
}

impl Constraint for Sliding {
    fn dimension(&self) -> Dimension {
        match self.contact {
            SlidingContact::Roller(_) | SlidingContact::Rod => Dimension::Angle,
            _ => Dimension::Length,
        }
    }

    fn has_given_function(&self) -> bool {
        !matches!(self.contact, SlidingContact::Rod)
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        for marker in self.markers() {
            incidence.point(mechanism, marker, [true, true]);
            incidence.direction(mechanism, marker);
        }
        match &self.contact {
            SlidingContact::Curve(_, place) => incidence.joint_unknown(mechanism, *place),
            SlidingContact::Face(contour) | SlidingContact::Roller(contour) => {
                incidence.joint_unknown(mechanism, contour.contact);
            }
            SlidingContact::Knife(_) | SlidingContact::Rod => {}
        }
    }
}

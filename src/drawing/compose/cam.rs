//! Cams and what of their followers touches them.

use nalgebra::Vector2;

use super::{Composer, Cover, is_same_point};
use crate::drawing::outline::{across, angle, direction};
use crate::drawing::scene::{Anchor, Symbol};
use crate::mechanism::{CamFollower, JointKind, Profile, ProfileInForce};

/// Every so many of the angles at which a profile is looked at is drawn: chords of 1.5°.
const CONTOUR_STRIDE: usize = 3;
/// Part of the length over which contact moves on a face that the face reaches beyond it.
const FACE_END: f64 = 0.25;

impl Composer<'_> {
    pub(super) fn cam(
        &mut self,
        [cam, follower]: [Anchor; 2],
        touch: &CamFollower,
        profile: &Profile,
    ) {
        let contour = self.contour(cam, profile);
        match touch {
            CamFollower::Knife => {
                let at = Anchor {
                    angle: self.inwards(follower, cam),
                    ..follower
                };
                self.add(Symbol::Knife { at });
            }
            CamFollower::Roller { radius } => {
                let radius = self.value(radius);
                let center = follower.position.into();
                let at = Anchor {
                    angle: 0.0,
                    ..follower
                };
                self.cover(follower.body, Cover::Wheel { center, radius });
                self.add(Symbol::Roller { at, radius });
                self.add(Symbol::Pin { at });
            }
            CamFollower::Flat => {
                let [_, aside] = self.from(follower, cam);
                let above = aside > 0.0;
                let range = self.face_range(follower, cam, above, &contour);
                let along = follower;
                self.cover(follower.body, Cover::Face { along, range });
                self.add(Symbol::Face {
                    along,
                    range,
                    above,
                });
            }
        }
        self.cover(cam.body, Cover::Contour(contour.clone()));
        self.add(Symbol::Cam { at: cam, contour });
    }

    /// A cam's contour in the frame of its body.
    fn contour(&self, cam: Anchor, profile: &Profile) -> Vec<[f64; 2]> {
        let mut in_force = ProfileInForce::new(profile, self.parameters.len());
        in_force
            .set_parameters(|p| self.parameters[p.index()])
            .expect("the mechanism was assembled with these parameters");
        let center = Vector2::from(cam.position);
        let point = |theta: f64| {
            let radius = in_force.radius(theta).value;
            center + radius * direction(cam.angle + theta)
        };
        let angles = ProfileInForce::sample_angles().step_by(CONTOUR_STRIDE);
        angles.map(|theta| point(theta).into()).collect()
    }

    /// The direction, in its body's frame, from a follower's marker into the follower: towards
    /// the middle of what else it has, away from the cam if that is nothing.
    fn inwards(&self, follower: Anchor, cam: Anchor) -> f64 {
        let edge = Vector2::from(follower.position);
        let spans = follower.body.map(|body| &self.spans[body.index()]);
        let others = self.positions(follower.body).into_iter();
        let offsets: Vector2<f64> = others
            .chain(spans.into_iter().flatten().copied())
            .map(|point| Vector2::from(point) - edge)
            .sum();
        if offsets.norm() > 0.0 {
            return angle(offsets);
        }
        follower.angle + angle(-Vector2::from(self.from(follower, cam)))
    }

    /// Coordinates of a point along an anchor's axes where the mechanism stands.
    pub(super) fn from(&self, axes: Anchor, point: Anchor) -> [f64; 2] {
        let (axes, point) = (axes.placed(self.q), point.placed(self.q).point);
        let axis = direction(axes.angle);
        [axis, across(axis)].map(|axis| axis.dot(&(point - axes.point)))
    }

    /// What is used of a face: where the contour reaches farthest towards it over the motion,
    /// and what markers its body has on it.
    fn face_range(&self, face: Anchor, cam: Anchor, above: bool, contour: &[[f64; 2]]) -> [f64; 2] {
        let poses = self.motion.iter().map(Vec::as_slice).chain([self.q]);
        let contacts = poses.filter_map(|q| {
            let (face, cam) = (
                face.placed(q),
                Anchor {
                    position: [0.0; 2],
                    angle: 0.0,
                    ..cam
                }
                .placed(q),
            );
            // The axes of the face in the cam's frame.
            let axis = direction(face.angle - cam.angle);
            let outwards = across(axis) * if above { -1.0 } else { 1.0 };
            let points = contour.iter().map(|&p| Vector2::from(p));
            let contact = points.max_by(|a, b| outwards.dot(a).total_cmp(&outwards.dot(b)))?;
            let origin = direction(face.angle).dot(&(face.point - cam.point));
            Some(axis.dot(&contact) - origin)
        });
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let [low, high] = contacts.fold(none, |[low, high], s| [low.min(s), high.max(s)]);
        let end = FACE_END * (high - low);
        self.with_markers(face, [low - end, high + end])
    }

    /// What a flat-faced follower spans besides its face: its other points, what turns in it, and
    /// where the face carries these.
    pub(super) fn behind_face(
        &self,
        along: Anchor,
        range: [f64; 2],
        points: &[[f64; 2]],
    ) -> Vec<[f64; 2]> {
        let face = Cover::Face { along, range };
        let is_pivot = |&position: &[f64; 2]| {
            let point = Anchor { position, ..along };
            self.mechanism.joints.iter().any(|joint| {
                let ends = [joint.from, joint.to].map(|marker| self.anchor(marker));
                matches!(joint.kind, JointKind::Revolute | JointKind::Link { .. })
                    && ends
                        .iter()
                        .any(|end| end.body == along.body && is_same_point(end, &point))
            })
        };
        let on_face = |point: &[f64; 2]| face.has(Vector2::from(*point));
        let behind: Vec<_> = points.iter().filter(|p| !on_face(p)).copied().collect();
        let mut kept: Vec<_> = points
            .iter()
            .filter(|p| on_face(p) && is_pivot(p))
            .copied()
            .collect();
        if !behind.is_empty() {
            let middle = behind
                .iter()
                .map(|&p| Vector2::from(p))
                .sum::<Vector2<f64>>()
                / behind.len() as f64;
            let [s, _] = along.coordinates(middle);
            let foot = Vector2::from(along.position)
                + s.clamp(range[0], range[1]) * direction(along.angle);
            kept.push(foot.into());
            kept.extend(behind);
        }
        kept
    }
}

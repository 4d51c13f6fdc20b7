//! Joints in the plane.

use std::f64::consts::FRAC_PI_2;

use super::Reader;
use super::assembly::{Joint, Marker};
use super::spatial_frame::dot;
use crate::exchange::draft::{BodyRef, Draft, GROUND, Held, JointKind, PointRef, Wheels};
use crate::exchange::error::Error;
use crate::exchange::note::Note;
use biela::mechanism::shown;

/// Difference of depths, in parts of a rod's length, that leaves it in the plane: it changes the length
/// by half its square.
pub(super) const DEPTH: f64 = 1e-6;

impl Reader<'_> {
    /// Adds a joint, or notes that the plane makes it superfluous.
    pub(super) fn joint(&mut self, joint: &Joint) -> Result<(), Error> {
        let [i, j] = &joint.markers;
        let bodies = [i, j].map(|marker| self.body(marker));
        if bodies[0] == bodies[1] {
            // A part that is fixed to the assembly has been told.
            if joint.class != "FixedJoint" {
                self.holds_nothing(joint);
            }
            return Ok(());
        }
        let axes = [i.place.z(), j.place.z()];
        let is_normal = axes.map(|axis| self.plane.is_normal(axis));
        let is_within = axes.map(|axis| self.plane.is_within(axis));
        let distance = joint.numbers.first().copied().unwrap_or(0.0);
        match &*joint.class {
            "RevoluteJoint" if is_normal[0] => self.join(joint, JointKind::Revolute),
            "SphericalJoint" => self.join(joint, JointKind::Revolute),
            "CylindricalJoint" if is_normal[0] => self.join(joint, JointKind::Revolute),
            "CylindricalJoint" | "TranslationalJoint" if is_within == [true; 2] => {
                let angle = self.plane.angle(axes[0]);
                self.slide(joint, angle, 0.0, true);
            }
            "FixedJoint" => self.weld(joint),
            "PointInLineJoint" if is_normal[0] => self.join(joint, JointKind::Revolute),
            "PointInLineJoint" if is_within[0] => {
                let angle = self.plane.angle(axes[0]);
                self.slide(joint, angle, 0.0, false);
            }
            "PlanarJoint" | "PointInPlaneJoint" | "LineInPlaneJoint" if is_normal[0] => {
                self.holds_nothing(joint);
            }
            "PointInPlaneJoint" | "PlanarJoint" if is_within[0] => {
                // The line that is left of the plane, to the left of which its normal points.
                let angle = self.plane.angle(axes[0]) - FRAC_PI_2;
                self.slide(joint, angle, distance, joint.class == "PlanarJoint");
            }
            "LineInPlaneJoint" if is_within[0] && (is_normal[1] || is_within[1]) => {
                let angle = self.plane.angle(axes[0]) - FRAC_PI_2;
                self.slide(joint, angle, distance, is_within[1]);
            }
            "SphSphJoint" => self.inclined(joint, distance)?,
            "RevRevJoint" if is_normal[0] => self.inclined(joint, distance)?,
            "CylSphJoint" | "RevCylJoint" if is_normal[0] => self.link(joint, distance)?,
            "ParallelAxesJoint" | "PerpendicularJoint" | "AngleJoint"
                if is_normal[0] || is_normal[1] =>
            {
                self.holds_nothing(joint);
            }
            "ParallelAxesJoint" | "PerpendicularJoint" | "AngleJoint" if is_within == [true; 2] => {
                self.note_other_angle(joint);
                self.hold(joint);
            }
            "NoRotationJoint" => self.hold(joint),
            "GearJoint" if is_normal == [true; 2] => self.gear(joint)?,
            "RackPinionJoint" if is_normal == [true; 2] => self.rack(joint, distance)?,
            "RevoluteJoint" | "CylindricalJoint" | "TranslationalJoint" | "PointInLineJoint"
            | "PointInPlaneJoint" | "PlanarJoint" | "LineInPlaneJoint" | "RevRevJoint"
            | "CylSphJoint" | "RevCylJoint" | "ParallelAxesJoint" | "PerpendicularJoint"
            | "AngleJoint" | "GearJoint" | "RackPinionJoint" => return Err(joint.out_of_plane()),
            _ => {
                return Err(Error::UnknownJoint {
                    joint: joint.name.clone(),
                    class: joint.class.clone(),
                });
            }
        }
        Ok(())
    }

    /// Notes an angle that is not the one drawn.
    fn note_other_angle(&mut self, joint: &Joint) {
        /// Difference of two cosines that is none: that of values written with seven digits.
        const SAME: f64 = 1e-6;
        let [i, j] = joint.markers.each_ref().map(|marker| marker.place.z());
        let cosine: f64 = i.iter().zip(&j).map(|(i, j)| i * j).sum();
        let angle = joint.numbers.first().copied().unwrap_or(0.0);
        if joint.class == "AngleJoint" && (cosine - angle.cos()).abs() > SAME {
            self.draft.note(Note::LeftOut {
                kind: "the angle of joint",
                name: joint.name.clone(),
                reason: "the parts are drawn at another one, at which they are held",
            });
        }
    }

    fn holds_nothing(&mut self, joint: &Joint) {
        self.draft.note(Note::HoldsNothing {
            joint: joint.name.clone(),
            class: joint.class.clone(),
        });
    }

    /// Returns the direction of a marker's x-axis, if it has one in the plane.
    fn x_axis(&self, marker: &Marker) -> Option<f64> {
        let [x, ..] = marker.place.axes;
        self.plane.is_within(x).then(|| self.plane.angle(x))
    }

    /// Returns the points of both markers.
    fn ends(&mut self, joint: &Joint) -> [PointRef; 2] {
        let markers = joint.markers.each_ref();
        markers.map(|marker| self.with_x_axis(marker))
    }

    /// Adds a joint that the markers' directions do not concern.
    fn join(&mut self, joint: &Joint, kind: JointKind) {
        let [from, to] = self.ends(joint);
        self.draft.join(&self.name(&joint.name), kind, from, to);
    }

    pub(super) fn with_x_axis(&mut self, marker: &Marker) -> PointRef {
        let angle = self.x_axis(marker);
        self.place(marker, angle)
    }

    /// Adds a joint along a line of the first body; `keeps` says whether the second does not turn.
    fn slide(&mut self, joint: &Joint, angle: f64, offset: f64, keeps: bool) {
        let [i, j] = &joint.markers;
        let mut from = self.place(i, Some(angle));
        // Without turning the second marker has the direction of the first one, as drawn.
        let to = if keeps {
            self.place(j, Some(angle))
        } else {
            self.with_x_axis(j)
        };
        let kind = match (keeps, offset != 0.0) {
            (true, true) => {
                let mut point = self.draft.point(from).clone();
                let (sin, cos) = angle.sin_cos();
                point.at = [point.at[0] - offset * sin, point.at[1] + offset * cos];
                from = self.draft.add_point(from.body, point);
                JointKind::Translational
            }
            (true, false) => JointKind::Translational,
            (false, true) => JointKind::Offset(offset),
            (false, false) => JointKind::Slot,
        };
        self.draft.join(&self.name(&joint.name), kind, from, to);
    }

    fn weld(&mut self, joint: &Joint) {
        let [i, j] = &joint.markers;
        // The same axis of both, which coincide.
        let axes = i.place.axes.iter().zip(j.place.axes);
        let mut axes = axes.filter(|(a, b)| self.plane.is_within(**a) && self.plane.is_within(*b));
        let angles = axes.next();
        let angles = angles.map(|(a, b)| [*a, b].map(|axis| self.plane.angle(axis)));
        let [a, b] = angles.map_or([None, None], |angles| angles.map(Some));
        let points = [self.place(i, a), self.place(j, b)];
        self.draft.join(
            &self.name(&joint.name),
            JointKind::Weld,
            points[0],
            points[1],
        );
    }

    /// Adds a rod whose ends stay at their depths: its projection.
    fn inclined(&mut self, joint: &Joint, distance: f64) -> Result<(), Error> {
        let [i, j] = joint.markers.each_ref().map(|marker| marker.place.at);
        let depth = dot([0, 1, 2].map(|k| j[k] - i[k]), self.plane.normal);
        if depth.abs() <= DEPTH * distance {
            return self.link(joint, distance);
        }
        let length = ((distance - depth) * (distance + depth)).max(0.0).sqrt();
        self.draft.note(Note::Inclined {
            name: self.name(&joint.name),
            length: shown(length),
        });
        self.link(joint, length)
    }

    fn link(&mut self, joint: &Joint, distance: f64) -> Result<(), Error> {
        if distance <= 0.0 {
            return Err(Error::UnknownJoint {
                joint: joint.name.clone(),
                class: format!("{} of length {distance}", joint.class),
            });
        }
        self.join(joint, JointKind::Link(distance));
        Ok(())
    }

    fn hold(&mut self, joint: &Joint) {
        let [from, to] = self.ends(joint);
        let name = self.name(&joint.name);
        self.draft.held.push(Held { name, from, to });
    }

    fn gear(&mut self, joint: &Joint) -> Result<(), Error> {
        let &[a, b] = &joint.numbers[..] else {
            return Err(Error::UnknownJoint {
                joint: joint.name.clone(),
                class: format!("{} without radii", joint.class),
            });
        };
        if a == 0.0 || b == 0.0 {
            return Err(Error::UnknownJoint {
                joint: joint.name.clone(),
                class: format!("{} of radius 0", joint.class),
            });
        }
        let [from, to] = self.ends(joint);
        let wheels = Wheels {
            sizes: [a.abs(), b.abs()],
            are_radii: true,
            carrier: carrier(self.draft, from.body, to.body),
        };
        // Radii of one sign turn against each other.
        let kind = if a * b > 0.0 {
            JointKind::Gear(wheels)
        } else {
            JointKind::Belt(wheels)
        };
        self.draft.join(&self.name(&joint.name), kind, from, to);
        Ok(())
    }

    fn rack(&mut self, joint: &Joint, radius: f64) -> Result<(), Error> {
        let [rack, pinion] = &joint.markers;
        let Some(along) = self.x_axis(rack).filter(|_| radius != 0.0) else {
            return Err(joint.out_of_plane());
        };
        // Way + radius·angle is constant, the angle about the rack's own z-axis.
        let radius = radius * self.plane.side(rack.place.z());
        let rack = self.place(rack, Some(along));
        let pinion = self.with_x_axis(pinion);
        self.draft.join(
            &self.name(&joint.name),
            JointKind::Rack(radius),
            pinion,
            rack,
        );
        Ok(())
    }
}

/// Returns the body on which both wheels have pins: ground if there is none.
fn carrier(draft: &Draft, a: BodyRef, b: BodyRef) -> BodyRef {
    let pinned = |body: BodyRef| {
        let pins = draft.joints.iter();
        let pins = pins.filter(|joint| matches!(joint.kind, JointKind::Revolute));
        pins.filter_map(move |joint| match [joint.from.body, joint.to.body] {
            [other, this] | [this, other] if this == body => Some(other),
            _ => None,
        })
    };
    let of_b: Vec<BodyRef> = pinned(b).chain([b]).collect();
    // A wheel that carries the other one has its pin on it.
    let mut both = pinned(a).chain([a]).filter(|body| of_b.contains(body));
    both.find(|body| *body != a && *body != b).unwrap_or(GROUND)
}

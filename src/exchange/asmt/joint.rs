//! Joints, motions and limits in the plane.

use std::f64::consts::FRAC_PI_2;

use super::Reader;
use super::assembly::{Joint, Limit, Marker, Motion};
use super::expression::translated;
use crate::exchange::draft::{
    BodyRef, Coordinate, Draft, Driver, DriverSource, GROUND, Held, JointKind, LengthUnit,
    PointRef, Stop, Wheels,
};
use crate::exchange::error::Error;
use crate::exchange::note::Note;

impl Reader<'_> {
    /// Adds a joint, or notes that the plane makes it superfluous.
    pub(super) fn joint(&mut self, joint: &Joint) -> Result<(), Error> {
        let [i, j] = &joint.markers;
        let bodies = [i, j].map(|marker| marker.part.map_or(GROUND, |part| self.bodies[part]));
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
            "SphSphJoint" => self.link(joint, distance)?,
            "RevRevJoint" | "CylSphJoint" | "RevCylJoint" if is_normal[0] => {
                self.link(joint, distance)?;
            }
            "ParallelAxesJoint" | "PerpendicularJoint" | "AngleJoint"
                if is_normal[0] || is_normal[1] =>
            {
                self.holds_nothing(joint);
            }
            "ParallelAxesJoint" | "PerpendicularJoint" | "AngleJoint" if is_within == [true; 2] => {
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

    fn with_x_axis(&mut self, marker: &Marker) -> PointRef {
        let angle = self.x_axis(marker);
        self.place(marker, angle)
    }

    /// Adds a joint along a line of the first body; `keeps` says whether the second does not turn.
    fn slide(&mut self, joint: &Joint, angle: f64, offset: f64, keeps: bool) {
        let [i, j] = &joint.markers;
        let mut from = self.place(i, Some(angle));
        // Without turning the second marker has the direction of the first one, as drawn.
        let to = match keeps {
            true => self.place(j, Some(angle)),
            false => self.with_x_axis(j),
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

    /// Adds a driver for a motion.
    pub(super) fn motion(&mut self, motion: &Motion) -> Result<(), Error> {
        let [i, j] = &motion.markers;
        let out_of_plane = || Error::OutOfPlane {
            joint: motion.name.clone(),
            class: motion.class.clone(),
        };
        let z = i.place.z();
        let (coordinate, side) = match &*motion.class {
            "RotationalMotion" if self.plane.is_normal(z) => {
                (Coordinate::Angle, self.plane.side(z))
            }
            "TranslationalMotion" if self.plane.is_within(z) => (Coordinate::X, 1.0),
            "RotationalMotion" | "TranslationalMotion" => return Err(out_of_plane()),
            class => {
                self.draft.note(Note::Motion {
                    name: motion.name.clone(),
                    text: class.to_owned(),
                });
                return Ok(());
            }
        };
        let (from, to) = self.measured(i, j, coordinate);
        let text = translated(&motion.text);
        let source = match text {
            Some(text) => DriverSource::Motion(self.scaled(text, coordinate, side)),
            None => {
                self.draft.note(Note::Motion {
                    name: motion.name.clone(),
                    text: motion.text.clone(),
                });
                DriverSource::Input
            }
        };
        let name = self.name(&motion.name);
        self.draft.drivers.push(Driver {
            name,
            coordinate,
            from,
            to,
            source,
            limits: None,
        });
        Ok(())
    }

    /// Returns the markers between which a coordinate of a joint is measured.
    fn measured(&mut self, i: &Marker, j: &Marker, coordinate: Coordinate) -> (PointRef, PointRef) {
        match coordinate {
            Coordinate::Angle => (self.with_x_axis(i), self.with_x_axis(j)),
            _ => {
                let angle = self.plane.angle(i.place.z());
                (self.place(i, Some(angle)), self.place(j, Some(angle)))
            }
        }
    }

    /// Returns an expression with the sense of the plane, in SI units.
    fn scaled(&self, text: String, coordinate: Coordinate, side: f64) -> String {
        let unit = self.draft.unit;
        let scaled = match coordinate {
            Coordinate::Angle => text,
            _ if unit == LengthUnit::Metre => text,
            _ if text.parse::<f64>().is_ok() => format!("{text}*{}", unit.name()),
            _ => format!("({text})*{}", unit.name()),
        };
        match side < 0.0 {
            true => format!("-({scaled})"),
            false => scaled,
        }
    }

    /// Adds a stop for a limit; two of one joint are one stop.
    pub(super) fn limit(&mut self, limit: &Limit) -> Result<(), Error> {
        let [i, j] = &limit.markers;
        let z = i.place.z();
        let note = |reason| Note::Limit {
            name: limit.name.clone(),
            reason,
        };
        let (coordinate, side) = if limit.turns && self.plane.is_normal(z) {
            (Coordinate::Angle, self.plane.side(z))
        } else if !limit.turns && self.plane.is_within(z) {
            (Coordinate::X, 1.0)
        } else {
            self.draft.note(note("it limits nothing in the plane"));
            return Ok(());
        };
        let value = translated(&limit.text).filter(|_| !limit.text.contains("time"));
        let Some(value) = value else {
            self.draft.note(note("its value has no counterpart"));
            return Ok(());
        };
        let value = self.scaled(value, coordinate, side);
        let at_least = (limit.kind == "=>") == (side > 0.0);
        let (from, to) = self.measured(i, j, coordinate);
        let mut stops = self.draft.stops.iter_mut();
        let same =
            stops.find(|stop| stop.coordinate == coordinate && stop.from == from && stop.to == to);
        let stop = match same {
            Some(stop) => stop,
            None => {
                let name = self.name(&limit.name);
                self.draft.stops.push(Stop {
                    name,
                    coordinate,
                    from,
                    to,
                    min: None,
                    max: None,
                });
                let last = self.draft.stops.len() - 1;
                &mut self.draft.stops[last]
            }
        };
        match at_least {
            true => stop.min = Some(value),
            false => stop.max = Some(value),
        }
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

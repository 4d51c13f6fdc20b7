//! Forces, and the motion that they make: freedoms with their start velocities.

use super::Reader;
use super::assembly::{ForceTorque, Marker, Part};
use super::expression;
use super::joint::DEPTH;
use super::spatial_frame::{SpatialFrame, Vector, dot};
use crate::exchange::draft::{Coordinate, Force, ForceKind, Freedom, GROUND, LengthUnit, PointRef};
use crate::exchange::error::Error;
use crate::exchange::freedom::undriven;
use crate::exchange::note::Note;

impl Reader<'_> {
    /// Adds a force, or notes why it is left out.
    pub(super) fn force(&mut self, force: &ForceTorque) {
        let kind = match &*force.class {
            _ if self.draft.unit != LengthUnit::Metre => {
                Err("its unit is known for lengths in metres only")
            }
            "InLineForceTorque" => self.in_line(force),
            "GeneralForceTorque" => self.general(force),
            _ => Err("its type is not known"),
        };
        let name = self.name(&force.name);
        match kind {
            Ok(kind) => self.draft.forces.push(Force { name, kind }),
            Err(reason) => self.draft.note(Note::LeftOut {
                kind: "force",
                name,
                reason,
            }),
        }
    }

    /// Returns a tension along the line of two markers.
    fn in_line(&mut self, force: &ForceTorque) -> Result<ForceKind, &'static str> {
        let [i, j] = &force.markers;
        let way = [0, 1, 2].map(|k| j.place.at[k] - i.place.at[k]);
        let depth = dot(way, self.plane.normal);
        let length = dot(way, way).sqrt();
        if depth.abs() > DEPTH * length || length == 0.0 {
            return Err("its ends have no line in the plane");
        }
        if !expression::is_zero(force.value("twist")) {
            return Err("its twist is not in the plane");
        }
        if self.body(i) == self.body(j) {
            return Err("both its ends are on one body");
        }
        let tension = expression::force(force.value("tension"));
        let tension = tension.ok_or("its expression has no counterpart")?;
        Ok(ForceKind::Along {
            coordinate: Coordinate::Distance,
            from: self.place(i, None),
            to: self.place(j, None),
            value: format!("-({tension})"),
        })
    }

    /// Returns a force and torque of ground on the body of one marker, along the axes of another; or a
    /// torque between two bodies.
    fn general(&mut self, force: &ForceTorque) -> Result<ForceKind, &'static str> {
        let [i, j] = force.markers.clone();
        let (on, axes) = (self.body(&i), force.value("MarkerK"));
        let along = match axes {
            "O" => None,
            "J" => Some(&j),
            _ => Some(&i),
        };
        let directions = along.map_or(SpatialFrame::ORIGIN.axes, |marker| marker.place.axes);
        // The two axes in the plane, and the third one's sense.
        let sides = directions.map(|axis| {
            let side = dot(axis, self.plane.normal);
            (self.plane.is_normal(axis), side.signum())
        });
        let normal = sides.iter().position(|(is_normal, _)| *is_normal);
        let normal = normal.ok_or("its axes are inclined to the plane")?;
        let [x, y] = match normal {
            0 => [1, 2],
            1 => [2, 0],
            _ => [0, 1],
        };
        let side = sides[normal].1;
        let forces = ["FxOnI", "FyOnI", "FzOnI"];
        let torques = ["TxOnI", "TyOnI", "TzOnI"];
        let torque = torques[normal];
        let others = [forces[normal], torques[x], torques[y]];
        if others
            .iter()
            .any(|key| !expression::is_zero(force.value(key)))
        {
            return Err("it has components out of the plane");
        }
        let value = |key: &str, side: f64| -> Result<String, &'static str> {
            let text = expression::motion(force.value(key));
            let text = text.ok_or("its expression has no counterpart")?;
            Ok(match text.as_str() {
                "0" => text,
                _ if side < 0.0 => format!("-({text})"),
                _ => text,
            })
        };
        let has_force = [x, y]
            .iter()
            .any(|axis| !expression::is_zero(force.value(forces[*axis])));
        if on != self.body(&j) && !has_force && axes == "I" && normal == 2 {
            return self.torsion(&i, &j, side, force.value(torque));
        }
        if on == GROUND || self.body(&j) != GROUND {
            return Err("it is not between ground and a body");
        }
        let direction = self.plane.angle(directions[x]);
        let (at, turned) = match along {
            Some(marker) if self.body(marker) == on => {
                let point = self.place(&i, Some(direction));
                (point, Some(point))
            }
            // Ground's axes, or those of a marker on it.
            along => {
                let point = self.place(&i, None);
                (
                    point,
                    along.map(|marker| self.place(marker, Some(direction))),
                )
            }
        };
        if along.is_none() && direction != 0.0 {
            return Err("the axes of the assembly are not those of its plane");
        }
        Ok(ForceKind::At {
            point: at,
            axes: turned,
            value: [value(forces[x], 1.0)?, value(forces[y], side)?],
            torque: value(torque, side)?,
        })
    }

    /// Returns a torque on the first marker's body, and its reaction on the second's.
    fn torsion(
        &mut self,
        i: &Marker,
        j: &Marker,
        side: f64,
        torque: &str,
    ) -> Result<ForceKind, &'static str> {
        let torque = expression::force(torque).ok_or("its expression has no counterpart")?;
        let ends = [self.with_x_axis(i), self.with_x_axis(j)];
        // The angle of the source is that of the plane, or that from the second marker to the first.
        let [from, to] = if side > 0.0 { ends } else { [ends[1], ends[0]] };
        Ok(ForceKind::Along {
            coordinate: Coordinate::Angle,
            from,
            to,
            value: format!("-({torque})"),
        })
    }

    /// Makes what nothing drives freedoms, if forces may move it.
    pub(super) fn freedoms(&mut self) {
        let has_masses = self.draft.bodies.iter().any(|body| body.mass.is_some());
        let free = if has_masses {
            undriven(self.draft)
        } else {
            Vec::new()
        };
        let parts = self.assembly.parts.iter();
        let is_moving = parts
            .clone()
            .flat_map(|part| part.velocity.iter().chain(&part.omega))
            .any(|rate| *rate != 0.0);
        if free.is_empty() && is_moving {
            self.draft.note(Note::StartVelocities {
                reason: if has_masses {
                    "the motions give them"
                } else {
                    "without masses no forces move it"
                },
            });
        }
        for (name, coordinate, from, to) in free {
            let velocity = self.rate(coordinate, from, to);
            self.draft.freedoms.push(Freedom {
                name,
                coordinate,
                from,
                to,
                velocity,
            });
        }
        if !self.draft.freedoms.is_empty() {
            let names = self
                .draft
                .freedoms
                .iter()
                .map(|freedom| freedom.name.clone());
            let names: Vec<String> = names.collect();
            self.draft.note(Note::Free {
                names: names.join("`, `"),
            });
        }
    }

    /// Returns how fast a coordinate changes with the velocities of the parts.
    fn rate(&self, coordinate: Coordinate, from: PointRef, to: PointRef) -> f64 {
        let [a, b] = [from, to].map(|point| self.motion_of(point));
        let [at_a, at_b] = [from, to].map(|point| self.draft.point(point).at);
        match coordinate {
            Coordinate::Angle => b.1 - a.1,
            _ => {
                let (sin, cos) = self.draft.direction(from).sin_cos();
                let way = [at_b[0] - at_a[0], at_b[1] - at_a[1]];
                let across = way[1] * cos - way[0] * sin;
                (b.0[0] - a.0[0]) * cos + (b.0[1] - a.0[1]) * sin + a.1 * across
            }
        }
    }

    /// Returns the velocity of a point and of its body's angle.
    fn motion_of(&self, point: PointRef) -> ([f64; 2], f64) {
        let part = self.bodies.iter().position(|body| *body == point.body);
        let Some(part) = part.filter(|_| point.body != GROUND) else {
            return ([0.0; 2], 0.0);
        };
        let part = &self.assembly.parts[part];
        let omega = dot(part.omega, self.plane.normal);
        let [x, y] = self.plane.vector(part.velocity);
        let origin = self.plane.point(part.place.at);
        let at = self.draft.point(point).at;
        let way = [at[0] - origin[0], at[1] - origin[1]];
        ([x - omega * way[1], y + omega * way[0]], omega)
    }

    /// Notes parts that joints do not keep in the plane: ball joints let them leave it.
    ///
    /// # Errors
    ///
    /// The joint of a part that leaves the plane by its forces or its start velocities.
    pub(super) fn projected(&mut self) -> Result<(), Error> {
        let normal = self.plane.normal;
        let is_flat = |v: Vector| dot(v, normal).abs() <= DEPTH * dot(v, v).sqrt();
        let leaves = |part: &Part| {
            let turns_in_plane =
                dot(part.omega, part.omega) == 0.0 || self.plane.is_normal(part.omega);
            let has_axis = part
                .mass
                .place
                .axes
                .iter()
                .any(|axis| self.plane.is_normal(*axis));
            !is_flat(part.velocity)
                || !turns_in_plane
                || !is_flat(self.assembly.gravity)
                || !has_axis
        };
        if !self.draft.freedoms.is_empty() {
            let joints = self.assembly.joints.iter();
            let mut joints = joints.filter(|joint| {
                joint.markers.iter().any(|marker| {
                    let part = marker.part.filter(|part| self.bodies[*part] != GROUND);
                    part.is_some_and(|index| {
                        let part = &self.assembly.parts[index];
                        // Weight beside the ball's depth tilts the part.
                        let way = [0, 1, 2].map(|k| part.mass.place.at[k] - marker.place.at[k]);
                        self.may_leave(index) && (leaves(part) || !is_flat(way))
                    })
                })
            });
            if let Some(joint) = joints.next() {
                return Err(joint.out_of_plane());
            }
        }
        let names: Vec<String> = self
            .assembly
            .parts
            .iter()
            .enumerate()
            .filter(|(part, _)| self.bodies[*part] != GROUND && self.may_leave(*part))
            .map(|(_, part)| self.name(&part.name))
            .collect();
        for name in names {
            self.draft.note(Note::Projected { name });
        }
        Ok(())
    }

    fn may_leave(&self, part: usize) -> bool {
        let has = |marker: &Marker| marker.part == Some(part);
        let mut joints = self.assembly.joints.iter();
        let is_ball = |class: &str| {
            matches!(
                class,
                "SphericalJoint"
                    | "SphSphJoint"
                    | "CylSphJoint"
                    | "PointInLineJoint"
                    | "PointInPlaneJoint"
            )
        };
        let mut on_part = joints
            .by_ref()
            .filter(|joint| joint.markers.iter().any(has))
            .peekable();
        on_part.peek().is_some() && on_part.all(|joint| is_ball(&joint.class))
    }
}

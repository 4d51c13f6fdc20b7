//! Forces that pictures show, and the places at which they act.

use std::f64::consts::FRAC_PI_2;

use super::anchor::Anchor;
use super::outline::{across, direction, tangent, unit};
use super::symbol::{ForceArrow, ForceKind, Symbol, TorqueArrow};
use biela::kinematics::{ForceQuantity, Forces, Origin, Solution, Solver};
use biela::mechanism::{
    Coordinate, CoordinateKind, DriverId, Indeterminate, Load, MarkerId, Mechanism, Rope, rounded,
};

/// A force or torque that a picture shows.
#[derive(Clone, Debug, PartialEq)]
pub struct ForcePlace {
    /// Its kind.
    pub kind: ForceKind,
    /// The point at which it acts, on the body that it acts on.
    pub at: Anchor,
    size: Size,
}

/// Results of which a force is made.
#[derive(Clone, Debug, PartialEq)]
enum Size {
    /// Reaction of a joint.
    Reaction(usize),
    /// Pull of the last leg of a rope, by its index, with a number of parts, towards a point or a
    /// pulley of this radius.
    Pull(usize, f64, Anchor, f64),
    /// A quantity along a coordinate.
    Along(ForceQuantity, Way),
    /// A force by its index, with components along the axes of an anchor.
    Components(usize, Anchor),
}

/// Direction in which a coordinate grows at its second marker.
#[derive(Clone, Debug, PartialEq)]
enum Way {
    Turn,
    Axis(Anchor),
    /// Away from an anchor.
    From(Anchor),
}

impl ForcePlace {
    /// Returns the forces of a mechanism: what its joints and drivers exert on the bodies of their
    /// second markers, and its springs, dampers and loads, but no pushes of contacts. Reactions that redundant constraints
    /// leave `indeterminate` are left out unless the file asks for those of least norm.
    #[must_use]
    pub fn all(mechanism: &Mechanism, parameters: &[f64], indeterminate: &[Origin]) -> Vec<Self> {
        let anchor = |marker| Anchor::of_marker(mechanism, parameters, marker);
        let along = |coordinate: &Coordinate, quantity| {
            let axes = anchor(coordinate.axes);
            let way = match coordinate.kind {
                CoordinateKind::Angle => Way::Turn,
                CoordinateKind::X => Way::Axis(axes),
                CoordinateKind::Y => Way::Axis(axes.turned_to(axes.angle + FRAC_PI_2)),
                CoordinateKind::Distance => Way::From(anchor(coordinate.from)),
                CoordinateKind::Clearance(..) => unreachable!("contacts have no arrows"),
            };
            (anchor(coordinate.to), Size::Along(quantity, way))
        };
        let is_omitted = |joint: usize| {
            mechanism.outputs.indeterminate == Indeterminate::Omit
                && indeterminate.contains(&Origin::Joint(joint))
        };
        let joints = mechanism.outputs.joints.iter().copied();
        let reactions = joints.filter(|joint| !is_omitted(*joint));
        let reactions = reactions.map(|joint| Self::reaction(mechanism, parameters, joint));
        let drivers = mechanism.drivers.iter().enumerate();
        let efforts = drivers.map(|(index, driver)| {
            let effort = ForceQuantity::Effort(DriverId(index));
            (ForceKind::Effort, along(&driver.coordinate, effort))
        });
        // Friction in cams, curves and links acts along no coordinate that a picture could point at, and
        // the place where shapes touch is at none of their markers.
        let is_shown = |load: &Load| {
            let coordinate = load.coordinate();
            let is_contact = coordinate.is_some_and(|coordinate| coordinate.shapes().is_some());
            load.slides().is_none() && !is_contact
        };
        let shown = mechanism.forces.iter().enumerate();
        let shown = shown.filter(|(_, force)| is_shown(&force.load));
        let loads = shown.map(|(index, force)| {
            let load = match &force.load {
                Load::Coordinate { coordinate, .. } | Load::Passive { coordinate, .. } => {
                    along(coordinate, ForceQuantity::Applied(index, 0))
                }
                Load::Marker { marker, axes, .. } => {
                    let axes = axes.map_or(Anchor::origin(None), anchor);
                    (anchor(*marker), Size::Components(index, axes))
                }
            };
            (ForceKind::Load, load)
        });
        let place = |(kind, (at, size))| Self { kind, at, size };
        reactions.chain(efforts.chain(loads).map(place)).collect()
    }

    /// Returns the force that a joint exerts on the body of its second marker; of a rope the pull of
    /// its last leg.
    #[must_use]
    pub fn reaction(mechanism: &Mechanism, parameters: &[f64], joint: usize) -> Self {
        let anchor = |marker| Anchor::of_marker(mechanism, parameters, marker);
        let definition = &mechanism.joints[joint];
        Self {
            kind: ForceKind::Reaction,
            at: anchor(definition.to),
            size: match definition.rope() {
                Some(rope) => pull(joint, rope, parameters, anchor),
                None => Size::Reaction(joint),
            },
        }
    }

    /// Returns [all](Self::all) forces of a solver's mechanism; none unless they are sought.
    pub fn sought(solver: &mut Solver, solution: &Solution) -> Vec<Self> {
        if solution.forces().is_none() {
            return Vec::new();
        }
        let indeterminate = solver.indeterminate();
        let parameters = &solver.pose().parameters;
        Self::all(solver.mechanism(), parameters, &indeterminate)
    }

    /// Returns the [values](Self::value) of forces at a solver's pose; none unless they are sought.
    #[must_use]
    pub fn values(places: &[Self], solver: &Solver, solution: &Solution) -> Vec<[f64; 3]> {
        let Some(forces) = solution.forces() else {
            return Vec::new();
        };
        let q = &solver.pose().q;
        places.iter().map(|place| place.value(forces, q)).collect()
    }

    /// Returns the force in ground axes \[N\] and the torque \[N m\] at the pose q.
    #[must_use]
    pub fn value(&self, forces: &Forces, q: &[f64]) -> [f64; 3] {
        match &self.size {
            Size::Reaction(joint) => {
                [0, 1, 2].map(|component| forces.value(ForceQuantity::Reaction(*joint, component)))
            }
            Size::Pull(joint, parts, from, radius) => {
                let tension = forces.value(ForceQuantity::Reaction(*joint, 0));
                let ends = [from.placed(q).point, self.at.placed(q).point];
                let [touched, end] = tangent(ends, [*radius, 0.0]);
                let [x, y]: [f64; 2] = (parts * tension * unit(touched - end)).into();
                [x, y, 0.0]
            }
            Size::Along(quantity, way) => {
                let size = forces.value(*quantity);
                let way = match way {
                    Way::Turn => return [0.0, 0.0, size],
                    Way::Axis(axis) => direction(axis.placed(q).angle),
                    Way::From(from) => (self.at.placed(q).point - from.placed(q).point).normalize(),
                };
                [size * way.x, size * way.y, 0.0]
            }
            Size::Components(force, axes) => {
                let [x, y, torque] =
                    [0, 1, 2].map(|k| forces.value(ForceQuantity::Applied(*force, k)));
                let axis = direction(axes.placed(q).angle);
                let force = x * axis + y * across(axis);
                [force.x, force.y, torque]
            }
        }
    }
}

/// Returns the pull of a rope's last leg.
fn pull(
    joint: usize,
    rope: &Rope,
    parameters: &[f64],
    anchor: impl Fn(MarkerId) -> Anchor,
) -> Size {
    let before = &rope.points[rope.points.len() - 2];
    let radius = before.radius(&|id| parameters[id.index()]);
    let parts = rope.parts[rope.parts.len() - 1].value(parameters);
    Size::Pull(joint, parts, anchor(before.marker), radius)
}

/// Returns arrows for forces with their values at one pose, as long as their parts of the largest
/// one, with their sizes in words.
pub(super) fn force_arrows(forces: &[(ForcePlace, [f64; 3])]) -> Vec<Symbol> {
    let [force, torque] = largest(forces.iter().map(|(_, value)| value));
    let mut symbols: Vec<Symbol> = Vec::new();
    for (ForcePlace { kind, at, .. }, [x, y, turning]) in forces {
        let size = x.hypot(*y);
        if size > SEEN * force {
            symbols.push(Symbol::from(ForceArrow {
                kind: *kind,
                at: *at,
                part: [x / force, y / force],
                size: in_words(size, "N"),
            }));
        }
        if turning.abs() > SEEN * torque {
            symbols.push(Symbol::from(TorqueArrow {
                kind: *kind,
                at: *at,
                part: turning / torque,
                size: in_words(turning.abs(), "N m"),
            }));
        }
    }
    symbols
}

/// Part of the largest force that is seen.
const SEEN: f64 = 0.02;
/// Force \[N\] and torque \[N m\] that are rounding.
const NONE: f64 = 1e-9;

/// Returns the largest force \[N\] and the largest torque \[N m\], infinity where all are rounding.
pub(super) fn largest<'a>(values: impl Iterator<Item = &'a [f64; 3]>) -> [f64; 2] {
    let most = values.fold([0.0_f64; 2], |[force, torque], [x, y, turning]| {
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        [
            force.max(finite(x.hypot(*y))),
            torque.max(finite(turning.abs())),
        ]
    });
    most.map(|most| if most > NONE { most } else { f64::INFINITY })
}

/// Returns a size with three digits, in thousands of its unit from 1000 on.
fn in_words(size: f64, unit: &str) -> String {
    let rounded = rounded(size, 3);
    let (size, prefix) = if rounded >= 1000.0 {
        (rounded / 1000.0, "k")
    } else {
        (rounded, "")
    };
    let digits = (2.0 - size.log10().floor()).clamp(0.0, 6.0);
    format!("{size:.*} {prefix}{unit}", digits as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_three_digits() {
        for (size, expected) in [
            (0.05, "0.0500 N"),
            (1.0, "1.00 N"),
            (12.34, "12.3 N"),
            (999.4, "999 N"),
            (999.6, "1.00 kN"),
            (282_797.0, "283 kN"),
        ] {
            assert_eq!(in_words(size, "N"), expected);
        }
    }
}

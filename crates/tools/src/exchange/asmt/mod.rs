//! Assemblies of FreeCAD and OndselSolver (`.asmt`): bodies in space, of which planar mechanisms are
//! taken.
//!
//! | file | subject |
//! |---|---|
//! | `tree` | lines that are indented by tabs |
//! | `keys` | entries that are taken, and those that do not change the mechanism |
//! | `place` | places in space, and the plane of the mechanism |
//! | `assembly` | parts, markers, joints and motions of the file |
//! | `joint` | joints in the plane |
//! | `motion` | motions and limits of joints |
//! | `force` | forces, and the motion that they make |
//! | `write` | assemblies that OndselSolver reads |
//! | `expression` | motions and forces as expressions of mechanism files |

mod assembly;
mod expression;
mod force;
mod joint;
mod keys;
mod motion;
mod spatial_frame;
mod tree;
mod write;

use std::collections::{HashMap, HashSet};

use super::draft::{Body, BodyRef, Draft, GROUND, LengthUnit, Mass, Point, PointRef};
use super::error::Error;
use super::note::Note;
use assembly::{Assembly, Part};
use spatial_frame::{Plane, dot};
use tree::Tree;
pub use write::AssemblyFile;

/// Length in a file of FreeCAD, which writes millimetres under this name of the assembly.
const FREECAD: &str = "OndselAssembly";

/// Reads a file.
pub(super) fn read(text: &str, length: Option<LengthUnit>, draft: &mut Draft) -> Result<(), Error> {
    let tree = Tree::read(text)?;
    let mut assembly = Assembly::read(&tree)?;
    let entries = std::mem::take(&mut assembly.others);
    draft.unit = match length {
        Some(unit) => unit,
        None => {
            let unit = if assembly.name == FREECAD {
                LengthUnit::Millimetre
            } else {
                LengthUnit::Metre
            };
            draft.note(Note::Unit { unit: unit.name() });
            unit
        }
    };
    if assembly.name != FREECAD && !assembly.name.is_empty() && assembly.name != "Assembly1" {
        draft.name.clone_from(&assembly.name);
    }
    let plane = assembly.plane()?;
    let mut reader = Reader {
        assembly: &assembly,
        document: assembly.document(),
        plane,
        draft,
        bodies: Vec::new(),
        placed: HashMap::new(),
    };
    reader.bodies();
    reader.masses();
    // Gears look for the pins of their wheels.
    let (gears, others): (Vec<_>, Vec<_>) = assembly
        .joints
        .iter()
        .partition(|joint| joint.class == "GearJoint");
    for joint in others.into_iter().chain(gears) {
        reader.joint(joint)?;
    }
    for motion in &assembly.motions {
        reader.motion(motion)?;
    }
    for limit in &assembly.limits {
        reader.limit(limit)?;
    }
    for force in &assembly.forces {
        reader.force(force);
    }
    reader.freedoms();
    reader.projected()?;
    reader.points();
    reader.draft.simulation = assembly.times;
    entries.note(reader.draft);
    Ok(())
}

/// Places of a body's markers that have a name already, by marker and direction.
type Placed = HashMap<(BodyRef, String, u64), PointRef>;

/// An assembly on its way into a draft.
struct Reader<'a> {
    assembly: &'a Assembly,
    /// Start of all names that is left out.
    document: &'a str,
    plane: Plane,
    draft: &'a mut Draft,
    /// Body of each part.
    bodies: Vec<BodyRef>,
    placed: Placed,
}

impl Reader<'_> {
    /// Returns a name without that of the document.
    fn name(&self, name: &str) -> String {
        let own = name.strip_prefix(self.document).unwrap_or(name);
        own.to_owned()
    }

    /// Adds a body for each part that is not fixed to the assembly.
    fn bodies(&mut self) {
        let grounded = self.assembly.grounded();
        for (index, part) in self.assembly.parts.iter().enumerate() {
            if grounded[index] {
                let name = self.name(&part.name);
                self.draft.note(Note::Grounded { name });
                self.bodies.push(GROUND);
                continue;
            }
            let [x, y] = self.plane.point(part.place.at);
            self.draft.bodies.push(Body {
                name: self.name(&part.name),
                pose: Some([x, y, self.plane.turn(&part.place)]),
                ..Body::default()
            });
            self.bodies.push(BodyRef(self.draft.bodies.len() - 1));
        }
    }

    fn body(&self, marker: &assembly::Marker) -> BodyRef {
        marker.part.map_or(GROUND, |part| self.bodies[part])
    }

    /// Adds the markers of moving bodies that no joint has.
    fn points(&mut self) {
        let known: HashSet<String> = self
            .placed
            .keys()
            .map(|(_, path, _)| path.clone())
            .collect();
        for marker in &self.assembly.markers {
            let body = self.body(marker);
            if body != GROUND && !marker.is_centre && !known.contains(&marker.path) {
                self.place(marker, None);
            }
        }
    }

    /// Takes over masses that are no placeholders.
    fn masses(&mut self) {
        let stands_for_none = |part: &Part| {
            part.mass.mass <= 0.0 || (part.mass.mass, part.mass.inertias) == (1.0, [1.0; 3])
        };
        let parts = self.assembly.parts.iter().zip(&self.bodies);
        let moving: Vec<(&Part, BodyRef)> = parts
            .filter(|(_, body)| **body != GROUND)
            .map(|(part, body)| (part, *body))
            .collect();
        let reason = if moving.iter().all(|(part, _)| stands_for_none(part)) {
            "they are the placeholders of the source, 1 and 1"
        } else if self.draft.unit != LengthUnit::Metre {
            "the unit of their inertias is known for lengths in metres only"
        } else {
            for (part, body) in moving {
                if part.mass.mass <= 0.0 {
                    continue;
                }
                let axes = part.mass.place.axes.iter().zip(part.mass.inertias);
                // Inertia about the normal, from the principal axes.
                let inertia = axes.map(|(axis, i)| dot(*axis, self.plane.normal).powi(2) * i);
                self.draft.bodies[body.0].mass = Some(Mass {
                    mass: part.mass.mass,
                    inertia: inertia.sum(),
                    center: self.plane.point(part.mass.place.at),
                });
            }
            self.draft.gravity = Some(self.plane.vector(self.assembly.gravity));
            return;
        };
        self.draft.note(Note::Masses { reason });
    }

    /// Returns the point of a marker with an x-axis in this direction, added if it is new.
    fn place(&mut self, marker: &assembly::Marker, angle: Option<f64>) -> PointRef {
        let body = self.body(marker);
        let at = self.plane.point(marker.place.at);
        let key = (
            body,
            marker.path.clone(),
            angle.unwrap_or(f64::NAN).to_bits(),
        );
        if let Some(&known) = self.placed.get(&key) {
            return known;
        }
        let point = Point {
            name: self.name(&marker.name),
            at,
            angle,
        };
        let placed = self.draft.add_point(body, point);
        self.placed.insert(key, placed);
        placed
    }
}

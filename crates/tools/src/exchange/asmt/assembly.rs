//! Parts, markers, joints and motions of the file.

use std::collections::HashMap;

use super::keys;
use super::spatial_frame::{Plane, SpatialFrame, Vector, are_parallel, are_perpendicular};
use super::tree::{Node, Tree};
use crate::exchange::error::Error;
use crate::exchange::others::Others;

pub(super) struct Assembly {
    pub(super) name: String,
    pub(super) parts: Vec<Part>,
    pub(super) markers: Vec<Marker>,
    /// Markers by their paths.
    by_path: HashMap<String, usize>,
    pub(super) joints: Vec<Joint>,
    pub(super) motions: Vec<AsmtMotion>,
    pub(super) limits: Vec<Limit>,
    pub(super) forces: Vec<ForceTorque>,
    /// Entries that are not taken.
    pub(super) others: Others,
    pub(super) gravity: Vector,
    /// Start, stop and step \[s\].
    pub(super) times: Option<[f64; 3]>,
}

pub(super) struct Part {
    pub(super) name: String,
    pub(super) place: SpatialFrame,
    pub(super) mass: PartMass,
    /// Velocity of its origin.
    pub(super) velocity: Vector,
    pub(super) omega: Vector,
}

pub(super) struct PartMass {
    pub(super) mass: f64,
    pub(super) inertias: [f64; 3],
    pub(super) place: SpatialFrame,
}

#[derive(Clone)]
pub(super) struct Marker {
    pub(super) path: String,
    pub(super) name: String,
    /// `None` on the assembly.
    pub(super) part: Option<usize>,
    pub(super) place: SpatialFrame,
    /// Whether it is the centre of mass.
    pub(super) is_centre: bool,
}

pub(super) struct Joint {
    pub(super) class: String,
    pub(super) name: String,
    pub(super) markers: [Marker; 2],
    /// Radii, distance, offset or pitch, as the class has them.
    pub(super) numbers: Vec<f64>,
}

pub(super) struct AsmtMotion {
    pub(super) class: String,
    pub(super) name: String,
    pub(super) markers: [Marker; 2],
    /// The expression of a rotation or translation.
    pub(super) text: String,
}

/// A force and torque between two markers, as texts by their keys.
pub(super) struct ForceTorque {
    pub(super) class: String,
    pub(super) name: String,
    pub(super) markers: [Marker; 2],
    values: Vec<(String, String)>,
}

impl ForceTorque {
    /// Returns the text of a key, `0` if it is empty or missing.
    pub(super) fn value(&self, key: &str) -> &str {
        let mut values = self.values.iter();
        let found = values.find(|(known, _)| known == key);
        let text = found.map_or("", |(_, text)| text.trim());
        if text.is_empty() { "0" } else { text }
    }
}

pub(super) struct Limit {
    pub(super) name: String,
    pub(super) turns: bool,
    pub(super) markers: [Marker; 2],
    pub(super) text: String,
    /// `=>` for a least value, `=<` for a greatest one.
    pub(super) kind: String,
}

impl Assembly {
    pub(super) fn read(tree: &Tree) -> Result<Self, Error> {
        let root = tree.assembly()?;
        let name = root.required_value("Name", "the assembly")?.to_owned();
        let mut assembly = Self {
            parts: Vec::new(),
            markers: Vec::new(),
            by_path: HashMap::new(),
            joints: Vec::new(),
            motions: Vec::new(),
            limits: Vec::new(),
            forces: Vec::new(),
            others: Others::default(),
            gravity: [0.0; 3],
            times: None,
            name,
        };
        let path = format!("/{}", assembly.name);
        let place = match root.child("Position3D") {
            Some(_) => read_place(root, "the assembly")?,
            None => SpatialFrame::ORIGIN,
        };
        assembly.read_markers(root, &path, None, &place)?;
        for part in root.required("Parts", "the assembly")?.children() {
            assembly.read_part(part, &path)?;
        }
        let sets = root.required("ConstraintSets", "the assembly")?;
        if let Some(joints) = sets.child("Joints") {
            for joint in joints.children() {
                assembly.read_joint(joint)?;
            }
        }
        let by_name: HashMap<String, [Marker; 2]> = assembly
            .joints
            .iter()
            .map(|joint| (format!("{path}/{}", joint.name), joint.markers.clone()))
            .collect();
        for motion in sets.child("Motions").into_iter().flat_map(Node::children) {
            let read = assembly.read_motion(motion, &by_name)?;
            assembly.motions.push(read);
        }
        for limit in sets.child("Limits").into_iter().flat_map(Node::children) {
            let read = assembly.read_limit(limit, &by_name)?;
            assembly.limits.push(read);
        }
        for list in ["ForceTorques", "ForcesTorques"] {
            for force in root.child(list).into_iter().flat_map(Node::children) {
                let read = assembly.read_force(force)?;
                assembly.forces.push(read);
            }
        }
        if root.child("ConstantGravity").is_some() {
            assembly.gravity = root.numbers("ConstantGravity", "the assembly")?;
        }
        if let Some(node) = root.child("SimulationParameters") {
            let time = |key| node.numbers::<1>(key, "SimulationParameters");
            let times = [time("tstart")?, time("tend")?, time("hout")?].map(|[t]| t);
            let [start, stop, step] = times;
            assembly.times = (stop > start && step > 0.0).then_some(times);
        }
        keys::sort(root, &mut assembly.others);
        Ok(assembly)
    }

    fn read_part(&mut self, node: Node, path: &str) -> Result<(), Error> {
        let name = node.required_value("Name", "a part")?.to_owned();
        let place_of = format!("part `{name}`");
        let place = read_place(node, &place_of)?;
        let mass = match node.child("PrincipalMassMarker") {
            None => PartMass {
                mass: 0.0,
                inertias: [0.0; 3],
                place,
            },
            Some(marker) => {
                let [mass] = marker.numbers("Mass", &place_of)?;
                PartMass {
                    mass,
                    inertias: marker.numbers("MomentOfInertias", &place_of)?,
                    place: place.then(&read_place(marker, &place_of)?),
                }
            }
        };
        let part = self.parts.len();
        let path = format!("{path}/{name}");
        if let Some(marker) = node.child("PrincipalMassMarker") {
            // Joints may be at the centre of mass.
            let name = marker.value("Name").unwrap_or_default().to_owned();
            let path = format!("{path}/{name}");
            self.by_path.insert(path.clone(), self.markers.len());
            self.markers.push(Marker {
                path,
                name,
                part: Some(part),
                place: mass.place,
                is_centre: true,
            });
        }
        let vector = |key| match node.child(key) {
            None => Ok([0.0; 3]),
            Some(_) => node.numbers(key, &place_of),
        };
        let (velocity, omega) = (vector("Velocity3D")?, vector("Omega3D")?);
        self.parts.push(Part {
            name,
            place,
            mass,
            velocity,
            omega,
        });
        self.read_markers(node, &path, Some(part), &place)
    }

    fn read_markers(
        &mut self,
        node: Node,
        path: &str,
        part: Option<usize>,
        place: &SpatialFrame,
    ) -> Result<(), Error> {
        for point in node.child("RefPoints").into_iter().flat_map(Node::children) {
            let place = place.then(&read_place(point, "a reference point")?);
            for marker in point.child("Markers").into_iter().flat_map(Node::children) {
                let name = marker.required_value("Name", "a marker")?.to_owned();
                let place = place.then(&read_place(marker, &format!("marker `{name}`"))?);
                let path = format!("{path}/{name}");
                let marker = Marker {
                    path: path.clone(),
                    name,
                    part,
                    place,
                    is_centre: false,
                };
                self.by_path.entry(path).or_insert(self.markers.len());
                self.markers.push(marker);
            }
        }
        Ok(())
    }

    fn read_joint(&mut self, node: Node) -> Result<(), Error> {
        let class = node.text().to_owned();
        let name = match node.required_value("Name", &class)? {
            "" => format!("{class}{}", self.joints.len() + 1),
            name => name.to_owned(),
        };
        let place = format!("joint `{name}`");
        let markers = [
            self.marker(node.required_value("MarkerI", &place)?, &place)?,
            self.marker(node.required_value("MarkerJ", &place)?, &place)?,
        ];
        let mut numbers = Vec::new();
        for key in keys::NUMBERS {
            if node.child(key).is_some() {
                let [number] = node.numbers(key, &place)?;
                numbers.push(number);
            }
        }
        self.joints.push(Joint {
            class,
            name,
            markers,
            numbers,
        });
        Ok(())
    }

    fn read_motion(
        &self,
        node: Node,
        joints: &HashMap<String, [Marker; 2]>,
    ) -> Result<AsmtMotion, Error> {
        let class = node.text().to_owned();
        let name = node.required_value("Name", &class)?.to_owned();
        let markers = self.of_joint_or_own(node, &format!("motion `{name}`"), joints)?;
        let text = node.value("RotationZ").or(node.value("TranslationZ"));
        let text = text.unwrap_or_default().to_owned();
        Ok(AsmtMotion {
            class,
            name,
            markers,
            text,
        })
    }

    fn read_force(&self, node: Node) -> Result<ForceTorque, Error> {
        let class = node.text().to_owned();
        let name = node.required_value("Name", &class)?.to_owned();
        let place = format!("force `{name}`");
        let values = node.children().filter_map(|child| {
            let text = child.children().next()?.text().to_owned();
            Some((child.text().to_owned(), text))
        });
        Ok(ForceTorque {
            class,
            markers: [
                self.marker(node.required_value("MarkerI", &place)?, &place)?,
                self.marker(node.required_value("MarkerJ", &place)?, &place)?,
            ],
            values: values.collect(),
            name,
        })
    }

    fn read_limit(
        &self,
        node: Node,
        joints: &HashMap<String, [Marker; 2]>,
    ) -> Result<Limit, Error> {
        let turns = match node.text() {
            "RotationLimit" => true,
            "TranslationLimit" => false,
            class => {
                let expected = "`RotationLimit` or `TranslationLimit`";
                return Err(Error::unexpected(node.line(), class, expected));
            }
        };
        let name = node.required_value("Name", "a limit")?.to_owned();
        let place = format!("limit `{name}`");
        let kind = node.required_value("Type", &place)?;
        if !matches!(kind, "=>" | "=<") {
            return Err(Error::unexpected(node.line(), kind, "`=>` or `=<`"));
        }
        Ok(Limit {
            turns,
            markers: self.of_joint_or_own(node, &place, joints)?,
            text: node.required_value("Limit", &place)?.to_owned(),
            kind: kind.to_owned(),
            name,
        })
    }

    /// Returns the markers of the joint that is named, or those of the node itself.
    fn of_joint_or_own(
        &self,
        node: Node,
        place: &str,
        joints: &HashMap<String, [Marker; 2]>,
    ) -> Result<[Marker; 2], Error> {
        match node.value("MotionJoint").filter(|name| !name.is_empty()) {
            Some(joint) => joints.get(joint).cloned().ok_or_else(|| Error::Unknown {
                place: place.to_owned(),
                kind: "joint",
                name: joint.to_owned(),
            }),
            None => Ok([
                self.marker(node.required_value("MarkerI", place)?, place)?,
                self.marker(node.required_value("MarkerJ", place)?, place)?,
            ]),
        }
    }

    fn marker(&self, path: &str, place: &str) -> Result<Marker, Error> {
        let index = self.by_path.get(path);
        let marker = index.map(|index| self.markers[*index].clone());
        marker.ok_or_else(|| Error::Unknown {
            place: place.to_owned(),
            kind: "marker",
            name: path.to_owned(),
        })
    }

    /// Returns for each part whether fixed joints tie it to the assembly, perhaps through others.
    pub(super) fn grounded(&self) -> Vec<bool> {
        let fixed = self
            .joints
            .iter()
            .filter(|joint| joint.class == "FixedJoint");
        let mut neighbours: HashMap<Option<usize>, Vec<usize>> = HashMap::new();
        for joint in fixed {
            let [a, b] = joint.markers.each_ref().map(|marker| marker.part);
            for (from, to) in [(a, b), (b, a)] {
                neighbours.entry(from).or_default().extend(to);
            }
        }
        let mut grounded = vec![false; self.parts.len()];
        let mut open = vec![None];
        while let Some(next) = open.pop() {
            for &part in neighbours.get(&next).into_iter().flatten() {
                if !grounded[part] {
                    grounded[part] = true;
                    open.push(Some(part));
                }
            }
        }
        grounded
    }

    /// Returns the name of the document that FreeCAD puts before all names of parts, with its `#`.
    pub(super) fn document(&self) -> &str {
        fn document(part: &Part) -> &str {
            part.name.find('#').map_or("", |end| &part.name[..=end])
        }
        let first = self.parts.first().map_or("", document);
        let is_shared = self.parts.iter().all(|part| part.name.starts_with(first));
        if is_shared { first } else { "" }
    }

    /// Returns the plane about whose normal most revolute joints turn; without one, the plane of the
    /// slides.
    pub(super) fn plane(&self) -> Result<Plane, Error> {
        let of_class = |wanted: &'static str| {
            let joints = self
                .joints
                .iter()
                .filter(move |joint| joint.class == wanted);
            joints.map(|joint| (joint, joint.markers[0].place.z()))
        };
        let axes: Vec<(&Joint, Vector)> = of_class("RevoluteJoint").collect();
        let alike = |axis: Vector| axes.iter().filter(|(_, a)| are_parallel(*a, axis)).count();
        /// Axes that are tried: more bring nothing new.
        const TRIED: usize = 100;
        let mut best: Option<(usize, Vector)> = None;
        for (_, axis) in axes.iter().take(TRIED) {
            let count = alike(*axis);
            if best.is_none_or(|(most, _)| count > most) {
                best = Some((count, *axis));
            }
        }
        let [x, y, z] = SpatialFrame::ORIGIN.axes;
        let normal = match best {
            Some((_, axis)) => axis,
            None => {
                let slides: Vec<Vector> = of_class("TranslationalJoint").map(|(_, z)| z).collect();
                let all = |n: &Vector| slides.iter().all(|slide| are_perpendicular(*slide, *n));
                [z, y, x].into_iter().find(all).unwrap_or(z)
            }
        };
        let plane = Plane::new(normal);
        match axes.iter().find(|(_, axis)| !plane.is_normal(*axis)) {
            Some((joint, _)) => Err(joint.out_of_plane()),
            None => Ok(plane),
        }
    }
}

impl Joint {
    pub(super) fn out_of_plane(&self) -> Error {
        Error::OutOfPlane {
            joint: self.name.clone(),
            class: self.class.clone(),
        }
    }
}

fn read_place(node: Node, place: &str) -> Result<SpatialFrame, Error> {
    let at = node.numbers("Position3D", place)?;
    Ok(SpatialFrame::new(
        at,
        node.numbers("RotationMatrix", place)?,
    ))
}

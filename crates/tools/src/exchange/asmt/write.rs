//! Assemblies that OndselSolver, and so FreeCAD, reads: bodies in the plane z = 0.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write as _;

use crate::exchange::error::Error;
use crate::exchange::note::Note;
use biela::kinematics::Solver;
use biela::mechanism::{
    BodyId, Coordinate, CoordinateKind, Driver, DriverId, Expression, Joint, JointKind, MarkerId,
    Mechanism, PrescribedMotion, RackSide,
};

/// A mechanism at a pose as an assembly, in metres.
#[derive(Debug)]
pub struct AssemblyFile {
    /// The file.
    pub text: String,
    /// Remarks on what does not come over.
    pub notes: Vec<Note>,
}

/// Directions of a marker's axes: of its x-axis with z up, or of its z-axis in the plane.
#[derive(Clone, Copy)]
enum Axes {
    Up(f64),
    Along(f64),
}

/// An assembly on its way.
struct Writer<'a> {
    mechanism: &'a Mechanism,
    solver: &'a Solver,
    /// Markers of ground, and of each body.
    ground: String,
    of_body: Vec<String>,
    joints: String,
    motions: String,
    /// Bodies that a joint keeps in the plane.
    kept: BTreeSet<BodyId>,
    notes: Vec<Note>,
}

impl AssemblyFile {
    /// Returns the assembly of a mechanism at the solver's pose.
    ///
    /// # Errors
    ///
    /// The first joint or constraint that OndselSolver does not have.
    pub fn new(solver: &Solver) -> Result<Self, Error> {
        let mechanism = solver.mechanism();
        let mut writer = Writer {
            mechanism,
            solver,
            ground: String::new(),
            of_body: vec![String::new(); mechanism.bodies.len()],
            joints: String::new(),
            motions: String::new(),
            kept: BTreeSet::new(),
            notes: Vec::new(),
        };
        for joint in &mechanism.joints {
            writer.joint(joint)?;
        }
        if let Some(constraint) = mechanism.constraints.first() {
            return Err(no_counterpart(&constraint.name));
        }
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            writer.motion(DriverId(index), driver);
        }
        writer.keep();
        writer.others();
        Ok(Self {
            text: writer.file(),
            notes: writer.notes,
        })
    }
}

fn no_counterpart(joint: &str) -> Error {
    Error::NoJoint {
        joint: joint.to_owned(),
    }
}

/// Writes a line at a depth.
fn line(text: &mut String, depth: usize, content: &str) {
    let _ = writeln!(text, "{}{content}", "\t".repeat(depth));
}

/// Writes a key and its value.
fn entry(text: &mut String, depth: usize, key: &str, value: &str) {
    line(text, depth, key);
    line(text, depth + 1, value);
}

/// Writes a place: a point and a matrix by its rows.
fn place(text: &mut String, depth: usize, [x, y]: [f64; 2], rows: [[f64; 3]; 3]) {
    entry(text, depth, "Position3D", &format!("{x}\t{y}\t0"));
    line(text, depth, "RotationMatrix");
    for [a, b, c] in rows {
        line(text, depth + 1, &format!("{a}\t{b}\t{c}"));
    }
}

/// Returns the matrix of a turn about z.
fn turned(angle: f64) -> [[f64; 3]; 3] {
    let (sin, cos) = angle.sin_cos();
    [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]
}

impl Axes {
    /// Returns the matrix whose columns are the axes.
    fn rows(self) -> [[f64; 3]; 3] {
        match self {
            Self::Up(angle) => turned(angle),
            Self::Along(angle) => {
                let (sin, cos) = angle.sin_cos();
                [[0.0, sin, cos], [0.0, -cos, sin], [1.0, 0.0, 0.0]]
            }
        }
    }
}

const UNTURNED: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Writer<'_> {
    fn value(&self, expression: &Expression) -> f64 {
        expression.value(&self.solver.pose().parameters)
    }

    /// Adds a marker at one of the mechanism's, and returns its path. `axes` turns it further.
    fn marker(&mut self, name: &str, at: MarkerId, axes: impl Fn(f64) -> Axes) -> String {
        let marker = &self.mechanism.markers[at.index()];
        let point = marker.position.each_ref().map(|e| self.value(e));
        let rows = axes(self.value(&marker.angle)).rows();
        let (text, depth, path) = match marker.body {
            None => (&mut self.ground, 2, String::new()),
            Some(body) => {
                let path = format!("/{}", self.mechanism.bodies[body.index()].name);
                (&mut self.of_body[body.index()], 4, path)
            }
        };
        line(text, depth, "RefPoint");
        place(text, depth + 1, [0.0; 2], UNTURNED);
        line(text, depth + 1, "Markers");
        line(text, depth + 2, "Marker");
        entry(text, depth + 3, "Name", name);
        place(text, depth + 3, point, rows);
        format!("/{}{path}/{name}", self.mechanism.name)
    }

    /// Adds a joint with markers of its own, with further values.
    fn join(
        &mut self,
        class: &str,
        name: &str,
        ends: [MarkerId; 2],
        axes: impl Fn(f64) -> Axes,
        values: &[(&str, f64)],
    ) {
        let [i, j] = [("i", ends[0]), ("j", ends[1])]
            .map(|(end, marker)| self.marker(&format!("{name}_{end}"), marker, &axes));
        let text = &mut self.joints;
        line(text, 3, class);
        entry(text, 4, "Name", name);
        entry(text, 4, "MarkerI", &i);
        entry(text, 4, "MarkerJ", &j);
        for (key, value) in values {
            entry(text, 4, key, &format!("{value}"));
        }
    }

    fn joint(&mut self, joint: &Joint) -> Result<(), Error> {
        let ends = [joint.from, joint.to];
        let name = &joint.name;
        let sizes_of = |sizes: &biela::mechanism::WheelSizes, side: f64| {
            let [i, j] = sizes.expressions().each_ref().map(|size| self.value(size));
            [("radiusI", i), ("radiusJ", side * j)]
        };
        let keeps = match &joint.kind {
            JointKind::Revolute => {
                self.join("RevoluteJoint", name, ends, Axes::Up, &[]);
                true
            }
            JointKind::Translational => {
                self.join("TranslationalJoint", name, ends, Axes::Along, &[]);
                true
            }
            JointKind::Weld => {
                self.join("FixedJoint", name, ends, Axes::Up, &[]);
                true
            }
            JointKind::Slot => {
                self.in_plane(name, ends, 0.0);
                false
            }
            JointKind::RevoluteTranslational { offset } => {
                let offset = self.value(offset);
                self.in_plane(name, ends, offset);
                false
            }
            JointKind::Link { length } => {
                let length = [("distanceIJ", self.value(length))];
                self.join("SphSphJoint", name, ends, Axes::Up, &length);
                false
            }
            JointKind::Gear {
                sizes,
                internal,
                carrier: None,
                ..
            } => {
                let sizes = sizes_of(sizes, if *internal { -1.0 } else { 1.0 });
                self.join("GearJoint", name, ends, Axes::Up, &sizes);
                false
            }
            JointKind::Belt {
                sizes,
                crossed,
                carrier: None,
                ..
            } => {
                let sizes = sizes_of(sizes, if *crossed { 1.0 } else { -1.0 });
                self.join("GearJoint", name, ends, Axes::Up, &sizes);
                false
            }
            JointKind::RackAndPinion { radius, side, .. } => {
                let radius = match side {
                    RackSide::Above => self.value(radius),
                    RackSide::Below => -self.value(radius),
                };
                let ends = [joint.to, joint.from];
                self.join(
                    "RackPinionJoint",
                    name,
                    ends,
                    Axes::Up,
                    &[("pitchRadius", radius)],
                );
                false
            }
            _ => return Err(no_counterpart(name)),
        };
        if keeps {
            let bodies = ends.map(|end| self.mechanism.markers[end.index()].body);
            self.kept.extend(bodies.into_iter().flatten());
        }
        Ok(())
    }

    /// Adds a point on a line: in the plane whose normal is to the left of the line.
    fn in_plane(&mut self, name: &str, ends: [MarkerId; 2], offset: f64) {
        let across = |angle: f64| Axes::Along(angle + FRAC_PI_2);
        self.join(
            "PointInPlaneJoint",
            name,
            ends,
            across,
            &[("offset", offset)],
        );
    }

    /// Adds a motion for a driver that follows time, or a value that is held for an input.
    fn motion(&mut self, id: DriverId, driver: &Driver) {
        let left_out = |reason| Note::LeftOut {
            kind: "driver",
            name: driver.name.clone(),
            reason,
        };
        if driver.is_free() {
            self.notes.push(left_out("forces move it"));
            return;
        }
        let (class, key) = match driver.coordinate.kind {
            CoordinateKind::Angle => ("RotationalMotion", "RotationZ"),
            CoordinateKind::X | CoordinateKind::Y => ("TranslationalMotion", "TranslationZ"),
            CoordinateKind::Distance | CoordinateKind::Clearance(..) => {
                self.notes.push(left_out("a distance has no motion there"));
                return;
            }
        };
        let coordinate = driver.coordinate;
        if coordinate.axes != coordinate.from {
            self.notes
                .push(left_out("its axes are those of a third marker"));
            return;
        }
        if coordinate.kind != CoordinateKind::Angle && !self.slides(coordinate) {
            // OndselSolver measures a way along markers that do not turn against each other.
            self.notes.push(left_out("it is not along a slide"));
            return;
        }
        let now = self.solver.pose().drivers[id.index()];
        let text = match driver.motion() {
            None => {
                self.notes.push(Note::Held {
                    name: driver.name.clone(),
                });
                Some(format!("{now}"))
            }
            Some(PrescribedMotion::Table(_)) => None,
            Some(PrescribedMotion::Expression(expression)) => {
                let parameters = &self.solver.pose().parameters;
                let parameter = |id: biela::mechanism::ParameterId| parameters[id.index()];
                expression.infix(&parameter, "time", &function)
            }
        };
        let Some(text) = text else {
            self.notes.push(left_out("its motion has no counterpart"));
            return;
        };
        let axes = |angle: f64| match coordinate.kind {
            CoordinateKind::Angle => Axes::Up(angle),
            CoordinateKind::Y => Axes::Along(angle + FRAC_PI_2),
            _ => Axes::Along(angle),
        };
        let [i, j] = [("i", coordinate.from), ("j", coordinate.to)]
            .map(|(end, at)| self.marker(&format!("{}_{end}", driver.name), at, axes));
        let out = &mut self.motions;
        line(out, 3, class);
        entry(out, 4, "Name", &driver.name);
        entry(out, 4, "MarkerI", &i);
        entry(out, 4, "MarkerJ", &j);
        entry(out, 4, "MotionJoint", "");
        entry(out, 4, key, &text);
    }

    /// Returns whether a slide keeps the bodies of a coordinate from turning against each other.
    fn slides(&self, coordinate: Coordinate) -> bool {
        let body = |marker: MarkerId| self.mechanism.markers[marker.index()].body;
        let bodies = [body(coordinate.from), body(coordinate.to)];
        self.mechanism.joints.iter().any(|joint| {
            let ends = [body(joint.from), body(joint.to)];
            matches!(joint.kind, JointKind::Translational)
                && (ends == bodies || [ends[1], ends[0]] == bodies)
        })
    }

    /// Keeps bodies in the plane that no pin or slide keeps there.
    fn keep(&mut self) {
        for (index, body) in self.mechanism.bodies.iter().enumerate() {
            if self.kept.contains(&BodyId(index)) {
                continue;
            }
            let Some(&marker) = body.markers.first() else {
                continue;
            };
            let name = format!("{}_plane", body.name);
            let on_ground = format!("/{}/{name}_i", self.mechanism.name);
            line(&mut self.ground, 2, "RefPoint");
            place(&mut self.ground, 3, [0.0; 2], UNTURNED);
            line(&mut self.ground, 3, "Markers");
            line(&mut self.ground, 4, "Marker");
            entry(&mut self.ground, 5, "Name", &format!("{name}_i"));
            place(&mut self.ground, 5, [0.0; 2], UNTURNED);
            let on_body = self.marker(&format!("{name}_j"), marker, Axes::Up);
            let text = &mut self.joints;
            line(text, 3, "PlanarJoint");
            entry(text, 4, "Name", &name);
            entry(text, 4, "MarkerI", &on_ground);
            entry(text, 4, "MarkerJ", &on_body);
            entry(text, 4, "offset", "0");
        }
    }

    /// Notes what an assembly has no place for.
    fn others(&mut self) {
        let mechanism = self.mechanism;
        let forces = mechanism.forces.iter().map(|force| ("force", &force.name));
        let stops = mechanism.stops.iter().map(|stop| ("stop", &stop.name));
        let notes = forces.chain(stops).map(|(kind, name)| Note::LeftOut {
            kind,
            name: name.clone(),
            reason: "an assembly has no place for it here",
        });
        self.notes.extend(notes.collect::<Vec<_>>());
    }

    fn file(&self) -> String {
        let mechanism = self.mechanism;
        let mut text = String::from("OndselSolver\nAssembly\n");
        let out = &mut text;
        entry(out, 1, "Notes", "");
        entry(out, 1, "Name", &mechanism.name);
        place(out, 1, [0.0; 2], UNTURNED);
        entry(out, 1, "Velocity3D", "0\t0\t0");
        entry(out, 1, "Omega3D", "0\t0\t0");
        line(out, 1, "RefPoints");
        out.push_str(&self.ground);
        line(out, 1, "RefCurves");
        line(out, 1, "RefSurfaces");
        line(out, 1, "Parts");
        // Without any masses all bodies have the placeholders of the other program.
        let has_masses = mechanism.bodies.iter().any(|body| body.mass.is_some());
        let none = if has_masses { 0.0 } else { 1.0 };
        for (index, body) in mechanism.bodies.iter().enumerate() {
            let q = &self.solver.pose().q[3 * index..];
            line(out, 2, "Part");
            entry(out, 3, "Name", &body.name);
            place(out, 3, [q[0], q[1]], turned(q[2]));
            entry(out, 3, "Velocity3D", "0\t0\t0");
            entry(out, 3, "Omega3D", "0\t0\t0");
            line(out, 3, "FeatureOrder");
            line(out, 3, "PrincipalMassMarker");
            entry(out, 4, "Name", "MassMarker");
            let center = body.center.as_ref();
            let center = center.map(|center| center.each_ref().map(|e| self.value(e)));
            place(out, 4, center.unwrap_or_default(), UNTURNED);
            let mass = body.mass.as_ref().map_or(none, |mass| self.value(mass));
            let inertia = body.inertia.as_ref().map(|inertia| self.value(inertia));
            let inertia = inertia.unwrap_or(none);
            entry(out, 4, "Mass", &format!("{mass}"));
            entry(
                out,
                4,
                "MomentOfInertias",
                &format!("{inertia}\t{inertia}\t{inertia}"),
            );
            entry(out, 4, "Density", "1");
            line(out, 3, "RefPoints");
            out.push_str(&self.of_body[index]);
            line(out, 3, "RefCurves");
            line(out, 3, "RefSurfaces");
        }
        line(out, 1, "KinematicIJs");
        line(out, 1, "ConstraintSets");
        line(out, 2, "Joints");
        out.push_str(&self.joints);
        line(out, 2, "Motions");
        out.push_str(&self.motions);
        line(out, 2, "GeneralConstraintSets");
        line(out, 1, "ForceTorques");
        let simulation = &mechanism.simulation;
        let [x, y] = simulation.gravity.each_ref().map(|e| self.value(e));
        entry(out, 1, "ConstantGravity", &format!("{x}\t{y}\t0"));
        line(out, 1, "SimulationParameters");
        let steps = ((simulation.stop - simulation.start) / simulation.step).round();
        for (key, value) in [
            ("tstart", simulation.start),
            ("tend", simulation.stop),
            ("hmin", 1e-9),
            ("hmax", 1.0),
            ("hout", simulation.step),
            ("errorTol", 1e-6),
        ] {
            entry(out, 2, key, &format!("{value}"));
        }
        line(out, 1, "AnimationParameters");
        let frames = format!("{}", steps + 1.0);
        for (key, value) in [
            ("nframe", &*frames),
            ("icurrent", "1"),
            ("istart", "1"),
            ("iend", &frames),
            ("isForward", "true"),
            ("framesPerSecond", "30"),
        ] {
            entry(out, 2, key, value);
        }
        text
    }
}

/// Returns the name of a function in OndselSolver.
fn function(name: &str) -> Option<&'static str> {
    const FUNCTIONS: [(&str, &str); 5] = [
        ("sin", "sin"),
        ("cos", "cos"),
        ("asin", "arcsin"),
        ("atan", "arctan"),
        ("abs", "abs"),
    ];
    let mut known = FUNCTIONS.iter();
    known
        .find(|(known, _)| *known == name)
        .map(|(_, theirs)| *theirs)
}

//! A mechanism as a file of another program has it: all points in the plane, as drawn.

use std::collections::BTreeSet;

use super::error::Error;
use super::note::Note;

/// Unit of the lengths of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// Metre.
    Metre,
    /// Centimetre.
    Centimetre,
    /// Millimetre.
    Millimetre,
    /// Inch.
    Inch,
}

impl LengthUnit {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Metre, Self::Centimetre, Self::Millimetre, Self::Inch];

    /// Returns its length \[m\].
    #[must_use]
    pub(super) fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 0.01,
            Self::Millimetre => 0.001,
            Self::Inch => 0.0254,
        }
    }

    /// Returns the name under which mechanism files and `--length` know the unit.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Centimetre => "cm",
            Self::Millimetre => "mm",
            Self::Inch => "inch",
        }
    }
}

/// A mechanism as a file of another program has it. Lengths are in the file's unit, angles in
/// radians; points lie in the plane of the mechanism, where they are drawn.
#[derive(Clone, Debug)]
pub struct Draft {
    /// Name of the mechanism.
    pub name: String,
    /// Name of the source's format.
    pub format: &'static str,
    /// Remarks on what did not come over, or came over changed.
    pub notes: Vec<Note>,
    pub(super) unit: LengthUnit,
    /// Significant digits of the source's lengths, by the size of the mechanism.
    pub(super) digits: i32,
    pub(super) parameters: Vec<Parameter>,
    /// Ground first, then the moving bodies.
    pub(super) bodies: Vec<Body>,
    pub(super) joints: Vec<Joint>,
    pub(super) held: Vec<Held>,
    pub(super) drivers: Vec<Driver>,
    pub(super) freedoms: Vec<Freedom>,
    pub(super) forces: Vec<Force>,
    pub(super) stops: Vec<Stop>,
    pub(super) outputs: Vec<PointRef>,
    /// Acceleration \[length/s²\].
    pub(super) gravity: Option<[f64; 2]>,
    /// Start, stop and step \[s\].
    pub(super) simulation: Option<[f64; 3]>,
}

/// Index of a body, 0 for ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct BodyRef(pub(super) usize);

/// Ground.
pub(super) const GROUND: BodyRef = BodyRef(0);

/// A point of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct PointRef {
    pub(super) body: BodyRef,
    pub(super) point: usize,
}

/// A number with a name.
#[derive(Clone, Debug)]
pub(super) struct Parameter {
    pub(super) name: &'static str,
    pub(super) value: String,
    pub(super) unit: &'static str,
    pub(super) display: &'static str,
    pub(super) description: &'static str,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Body {
    /// Name in the source.
    pub(super) name: String,
    /// Origin and angle of its frame; `None` for one at the first point, along the second.
    pub(super) pose: Option<[f64; 3]>,
    pub(super) points: Vec<Point>,
    pub(super) mass: Option<Mass>,
}

/// Mass \[kg\], inertia \[kg m²\] and centre of a body.
#[derive(Clone, Debug)]
pub(super) struct Mass {
    pub(super) mass: f64,
    pub(super) inertia: f64,
    pub(super) center: [f64; 2],
}

impl Mass {
    /// Returns the mass of two bodies that are fixed to each other; `metres` is the unit of the
    /// centres.
    pub(super) fn with(&self, other: &Self, metres: f64) -> Self {
        let mass = self.mass + other.mass;
        let center =
            [0, 1].map(|k| (self.mass * self.center[k] + other.mass * other.center[k]) / mass);
        let steiner = |part: &Self| {
            let off = [0, 1].map(|k| (part.center[k] - center[k]) * metres);
            part.inertia + part.mass * (off[0] * off[0] + off[1] * off[1])
        };
        Self {
            mass,
            inertia: steiner(self) + steiner(other),
            center,
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Point {
    /// Name in the source.
    pub(super) name: String,
    pub(super) at: [f64; 2],
    /// Direction of the marker's x-axis; `None` for that of the body.
    pub(super) angle: Option<f64>,
}

#[derive(Clone, Debug)]
pub(super) struct Joint {
    pub(super) name: String,
    pub(super) kind: JointKind,
    pub(super) from: PointRef,
    pub(super) to: PointRef,
}

#[derive(Clone, Debug)]
pub(super) enum JointKind {
    Revolute,
    Translational,
    Slot,
    /// Distance of the point j to the left of the x-axis of i.
    Offset(f64),
    Weld,
    /// Distance of the points.
    Link(f64),
    Gear(Wheels),
    Belt(Wheels),
    /// A pinion i on a rack j; its radius is negative below the rack.
    Rack(f64),
}

#[derive(Clone, Debug)]
pub(super) struct Wheels {
    pub(super) sizes: [f64; 2],
    /// Whether the sizes are lengths.
    pub(super) are_radii: bool,
    pub(super) carrier: BodyRef,
}

/// An angle that is held at its value as drawn.
#[derive(Clone, Debug)]
pub(super) struct Held {
    pub(super) name: String,
    pub(super) from: PointRef,
    pub(super) to: PointRef,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coordinate {
    Angle,
    X,
    Distance,
}

impl Coordinate {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::X => "x",
            Self::Distance => "distance",
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Driver {
    pub(super) name: String,
    pub(super) coordinate: Coordinate,
    pub(super) from: PointRef,
    pub(super) to: PointRef,
    pub(super) source: DriverSource,
    /// Limits in the coordinate's unit.
    pub(super) limits: Option<[f64; 2]>,
}

#[derive(Clone, Debug)]
pub(super) enum DriverSource {
    /// An input that starts at the value as drawn.
    Input,
    /// The value as drawn plus `shift`, in the coordinate's unit, plus this expression in `t`.
    Added { shift: f64, text: String },
    /// An expression in `t`, in SI units.
    Motion(String),
}

/// A coordinate that follows from the forces, from where it is drawn.
#[derive(Clone, Debug)]
pub(super) struct Freedom {
    pub(super) name: String,
    pub(super) coordinate: Coordinate,
    pub(super) from: PointRef,
    pub(super) to: PointRef,
    /// In the coordinate's unit per second.
    pub(super) velocity: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Force {
    pub(super) name: String,
    pub(super) kind: ForceKind,
}

/// Forces as expressions in SI units.
#[derive(Clone, Debug)]
pub(super) enum ForceKind {
    /// Along a coordinate: positive pushes two points apart, or turns the second against the first.
    Along {
        coordinate: Coordinate,
        from: PointRef,
        to: PointRef,
        value: String,
    },
    /// On a body at a point, along the axes of another one; without it of ground.
    At {
        point: PointRef,
        axes: Option<PointRef>,
        value: [String; 2],
        torque: String,
    },
}

/// Limits of a coordinate, as expressions in SI units.
#[derive(Clone, Debug)]
pub(super) struct Stop {
    pub(super) name: String,
    pub(super) coordinate: Coordinate,
    pub(super) from: PointRef,
    pub(super) to: PointRef,
    pub(super) min: Option<String>,
    pub(super) max: Option<String>,
}

impl Draft {
    pub(super) fn new(name: &str, format: &'static str) -> Self {
        Self {
            name: name.to_owned(),
            format,
            notes: Vec::new(),
            unit: LengthUnit::Metre,
            digits: 12,
            parameters: Vec::new(),
            bodies: vec![Body::default()],
            joints: Vec::new(),
            held: Vec::new(),
            drivers: Vec::new(),
            freedoms: Vec::new(),
            forces: Vec::new(),
            stops: Vec::new(),
            outputs: Vec::new(),
            gravity: None,
            simulation: None,
        }
    }

    pub(super) fn note(&mut self, note: Note) {
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    pub(super) fn add_body(&mut self, name: &str) -> BodyRef {
        self.bodies.push(Body {
            name: name.to_owned(),
            ..Body::default()
        });
        BodyRef(self.bodies.len() - 1)
    }

    pub(super) fn point(&self, point: PointRef) -> &Point {
        &self.bodies[point.body.0].points[point.point]
    }

    pub(super) fn add_point(&mut self, body: BodyRef, point: Point) -> PointRef {
        let points = &mut self.bodies[body.0].points;
        points.push(point);
        PointRef {
            body,
            point: points.len() - 1,
        }
    }

    pub(super) fn join(&mut self, name: &str, kind: JointKind, from: PointRef, to: PointRef) {
        self.joints.push(Joint {
            name: name.to_owned(),
            kind,
            from,
            to,
        });
    }

    /// Returns the source of an angle that turns at a speed; 0 is an input.
    pub(super) fn turning(&mut self, rpm: f64) -> DriverSource {
        if rpm == 0.0 {
            return DriverSource::Input;
        }
        self.run_for(60.0 / rpm.abs());
        DriverSource::Added {
            shift: 0.0,
            text: format!("{}*t", self.speed(rpm)),
        }
    }

    /// Returns a speed as an expression; the first one becomes a parameter.
    pub(super) fn speed(&mut self, rpm: f64) -> String {
        let value = format!("{rpm}*rpm");
        match self.parameters.first() {
            Some(known) if known.value != value => return value,
            Some(_) => {}
            None => self.parameters.push(Parameter {
                name: "input_speed",
                value,
                unit: "rad/s",
                display: "rpm",
                description: "of the driver",
            }),
        }
        "input_speed".to_owned()
    }

    /// Makes the simulation as long as one cycle \[s\], unless it has a length.
    pub(super) fn run_for(&mut self, cycle: f64) {
        if self.simulation.is_none() && (1e-6..1e6).contains(&cycle) {
            self.simulation = Some([0.0, cycle, cycle / 500.0]);
        }
    }

    /// Returns the frame of a body: its own, or one at the first point, along the second.
    pub(super) fn frame(&self, body: BodyRef) -> [f64; 3] {
        let body_data = &self.bodies[body.0];
        if body == GROUND {
            return [0.0; 3];
        }
        if let Some(pose) = body_data.pose {
            return pose;
        }
        let Some(first) = body_data.points.first() else {
            return [0.0; 3];
        };
        let mut apart = body_data.points.iter().map(|point| {
            let way = [point.at[0] - first.at[0], point.at[1] - first.at[1]];
            (way[0].hypot(way[1]), way[1].atan2(way[0]))
        });
        // Nearer points are one place, up to rounding.
        let smallest = 1e-9 * (first.at[0].abs() + first.at[1].abs());
        let angle = apart.find(|(length, _)| *length > smallest);
        [
            first.at[0],
            first.at[1],
            angle.map_or(0.0, |(_, angle)| angle),
        ]
    }

    /// Returns the direction of a point's x-axis in the plane.
    pub(super) fn direction(&self, point: PointRef) -> f64 {
        let own = self.point(point).angle;
        own.unwrap_or_else(|| self.frame(point.body)[2])
    }

    /// Returns the value of a coordinate as drawn.
    pub(super) fn drawn(&self, coordinate: Coordinate, from: PointRef, to: PointRef) -> f64 {
        let [a, b] = [from, to].map(|point| self.point(point).at);
        let way = [b[0] - a[0], b[1] - a[1]];
        match coordinate {
            Coordinate::Angle => turn_between(self.direction(from), self.direction(to)),
            Coordinate::Distance => way[0].hypot(way[1]),
            Coordinate::X => {
                let (sin, cos) = self.direction(from).sin_cos();
                way[0] * cos + way[1] * sin
            }
        }
    }

    /// Returns the greatest coordinate of a point.
    pub(super) fn size(&self) -> f64 {
        let points = self.bodies.iter().flat_map(|body| &body.points);
        points
            .flat_map(|point| point.at)
            .fold(0.0, |size: f64, x| size.max(x.abs()))
    }

    /// Drops bodies that nothing holds.
    pub(super) fn finish(&mut self) -> Result<(), Error> {
        let joined: BTreeSet<BodyRef> = self
            .joints
            .iter()
            .flat_map(|joint| [joint.from.body, joint.to.body])
            .collect();
        let loose = (1..self.bodies.len()).map(BodyRef);
        let loose: Vec<BodyRef> = loose.filter(|body| !joined.contains(body)).collect();
        if self.bodies.len() - loose.len() < 2 {
            return Err(Error::NoJoints);
        }
        if !joined.contains(&GROUND) {
            return Err(Error::NoGround);
        }
        for body in loose {
            let name = self.bodies[body.0].name.clone();
            self.note(Note::LooseBody { name });
            self.bodies[body.0].points.clear();
        }
        let dropped = |body: BodyRef| body != GROUND && !joined.contains(&body);
        self.outputs.retain(|point| !dropped(point.body));
        self.drivers
            .retain(|driver| !dropped(driver.from.body) && !dropped(driver.to.body));
        self.freedoms
            .retain(|freedom| !dropped(freedom.from.body) && !dropped(freedom.to.body));
        self.forces.retain(|force| match &force.kind {
            ForceKind::Along { from, to, .. } => !dropped(from.body) && !dropped(to.body),
            ForceKind::At { point, axes, .. } => {
                !dropped(point.body) && !axes.is_some_and(|axes| dropped(axes.body))
            }
        });
        Ok(())
    }
}

/// Returns the angle from one direction to another, above −π and up to π.
pub(super) fn turn_between(from: f64, to: f64) -> f64 {
    let (sin, cos) = (to - from).sin_cos();
    let turn = sin.atan2(cos);
    // Rounding decides between −π and π otherwise.
    if turn < -std::f64::consts::PI + 1e-12 {
        turn + std::f64::consts::TAU
    } else {
        turn
    }
}

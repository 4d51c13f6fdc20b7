//! The mechanism as data: bodies, markers, joints, drivers, measures and parameters.
//!
//! | file | subject |
//! |---|---|
//! | `source`, `encoding` | [`Source`]: the text, its lines and columns |
//! | `syntax` | TOML document in which each key and value knows its place |
//! | `read` | from the document to the [`Mechanism`], or to all its problems |
//! | `diagnostic` | [`Diagnostic`]: a problem with its places and its help |
//! | `expression` | [`Expression`]: a number as a function of the parameters |
//! | `joint` | [`Joint`]: its kinds, and what it is asked whatever its kind |
//! | `curve` | [`Curve`]: along which a point moves |
//! | `rope` | [`Rope`]: points and pulleys that a rope runs over |
//! | `motion`, `profile`, `spline`, `table` | functions of time and of an angle, and their files |
//! | `coordinate` | [`Coordinate`]: what is measured from one marker to another |
//! | `coupling` | [`CoordinateEquation`]: an equation between coordinates |
//! | `force` | [`Force`]: springs, dampers, actuators, loads |
//! | `input` | [`Input`], [`LoadInput`]: what a host gives while the mechanism moves |
//! | `force_quantity`, `reaction` | [`ForceQuantity`]: forces, energies and inertias, and their names |
//! | `signal` | [`Signal`]: what moves, and the names of its variables |
//! | `play` | [`Play`]: joints that open |
//! | `shape`, `body_shapes` | [`Shape`]: outlines of bodies and of ground, and what they weigh |
//! | `stop` | [`Stop`]: limits of a coordinate |
//! | `excursion` | [`Excursion`]: a driver or an input beyond its limits |
//! | `derived` | [`DerivedMeasure`]: functions of signals |
//! | `setting` | start values of the FMU's settings |
//! | `names`, `synonym`, `lookup`, `id` | names, other words for them, and what they stand for |
//! | `wording` | names and numbers in messages |
//! | `unit_slip` | numbers that look like ones in another unit |
//!
//! Nothing here computes a pose.

mod body_shapes;
mod coordinate;
mod coupling;
mod curve;
mod derived;
mod diagnostic;
mod encoding;
mod excursion;
mod expression;
mod force;
mod force_quantity;
mod friction;
mod id;
mod input;
mod joint;
mod lookup;
mod motion;
mod names;
mod number;
mod parameter;
mod play;
mod profile;
mod reaction;
mod read;
mod rope;
mod setting;
mod shape;
mod signal;
mod source;
mod spline;
mod stop;
mod synonym;
mod syntax;
mod table;
mod toml_error;
mod unit_slip;
mod wording;

pub use crate::unit::{Dimension, DisplayUnit, Unit, UnitName};
pub use coordinate::{Coordinate, CoordinateKind};
pub use coupling::{CoordinateEquation, MOST_COUPLED, Phase};
pub use curve::{Curve, CurveShape, PointPath};
pub use derived::DerivedMeasure;
pub use diagnostic::{Diagnostic, Label, Severity};
pub use excursion::{Excursion, Excursive};
pub(crate) use expression::MOST_MOVING_POINTS;
pub use expression::{
    BeyondPoints, CalledPoints, Corner, Expression, ExpressionError, Function, FunctionBody,
    Functions, Grid, Interpolation, LinearForm, MOST_ARGUMENTS, PointFunction, Table, Variable,
    constant, is_taken, names_in,
};
pub(crate) use expression::{Values, joins};
pub use force::{
    ElasticStop, Force, ForceComponent, ForceLaw, Load, PassiveCause, RegularisedFriction, Spring,
};
pub use force_quantity::ForceQuantity;
pub use friction::{Bearing, BearingShape, FrictionLaw, SlidingWay};
pub use id::{BodyId, DriverId, MarkerId, ParameterId, ShapeId};
pub use input::{Input, LoadInput, LoadTarget};
pub use joint::{CamFollower, Guide, Joint, JointKind, RackSide, WheelSizes, Wheels};
pub use motion::{Law, MotionInForce, PrescribedMotion, not_finite};
pub use names::{did_you_mean, help, is_identifier, similar_identifier};
pub use number::{Dual, Interval, Jet, Jet3, Number, Taylor};
pub use parameter::{DerivedParameter, Parameter};
pub use play::Play;
pub use profile::{
    ContourPoint, MovingProfile, Profile, ProfileAlong, ProfileBounds, ProfileError, ProfileInForce,
};
pub use reaction::{NamedForce, Reported};
pub(crate) use rope::MOST_BODIES;
pub use rope::{Pulley, PulleySide, Rope, RopePoint};
pub use setting::{Extrapolation, RateSource};
pub use shape::{
    Core, Feature, FeatureKind, FeatureRun, OutlineCorner, Piece, Section, Shape, ShapeFault,
    ShapeFaultKind, ShapeForm, Weight,
};
pub(crate) use signal::SUFFIXES;
pub use signal::{COMPONENTS, Order, Signal};
pub use source::{Position, Source, Span};
pub use spline::{Ends, Spline};
pub use stop::{Stop, StopContact};
pub use synonym::in_our_words;
pub use table::{Separated, TableFile, comma_hint};
pub use unit_slip::{
    is_plain, large_angle, large_angles, large_length, large_velocity, whole_angles,
};
pub use wording::{fixed, quoted, rounded, shortest, show_time, shown};
pub(crate) use wording::{fixed_apart, shown_apart};

/// Planar mechanism as its file describes it. Names, types and units are checked, assembly is not.
///
/// Lists are in file order. Every index ([`BodyId`], [`MarkerId`], …) is valid for the mechanism
/// it came from.
#[derive(Clone, Debug)]
pub struct Mechanism {
    /// FMI `modelName` and `modelIdentifier`: a C identifier.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// FMI attribute `author`.
    pub author: Option<String>,
    /// FMI attribute `version`: the mechanism's own version.
    pub version: Option<String>,
    /// FMI attribute `license`.
    pub license: Option<String>,
    /// FMI attribute `copyright`.
    pub copyright: Option<String>,
    /// Parameters, in file order.
    pub parameters: Vec<Parameter>,
    /// Parameters whose value uses other parameters, in an order in which each comes after those
    /// it uses.
    pub derivation_order: Vec<ParameterId>,
    /// Numbers from outside.
    pub inputs: Vec<Input>,
    /// Functions that expressions call.
    pub functions: Functions,
    /// Moving bodies.
    pub bodies: Vec<Body>,
    /// All markers: those of ground first, then body by body.
    pub markers: Vec<Marker>,
    /// All shapes: those of ground first, then body by body.
    pub shapes: Vec<Shape>,
    /// Joints.
    pub joints: Vec<Joint>,
    /// Coordinates held at values.
    pub constraints: Vec<Constraint>,
    /// Drivers: FMI inputs and prescribed motions.
    pub drivers: Vec<Driver>,
    /// Coordinates that are outputs.
    pub measures: Vec<Measure>,
    /// Outputs computed from signals.
    pub derived: Vec<DerivedMeasure>,
    /// Forces.
    pub forces: Vec<Force>,
    /// Limits that coordinates do not pass.
    pub stops: Vec<Stop>,
    /// Outputs of the FMU besides measures and solver quantities.
    pub outputs: Outputs,
    /// Default experiment.
    pub simulation: Simulation,
    /// CSV files that the mechanism file names, each once.
    pub table_files: Vec<TableFile>,
    /// Content of the file and of its CSV files without comments and layout. Two files have the
    /// same canonical form only if they have the same keys and values in the same order.
    pub canonical: String,
}

/// Rigid body with generalized coordinates q = \[x, y, phi\].
#[derive(Clone, Debug)]
pub struct Body {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// Its markers, in file order.
    pub markers: Vec<MarkerId>,
    /// Start of the search for the assembled pose: x, y \[m\], phi \[rad\].
    pub estimate: [Expression; 3],
    /// Mass \[kg\].
    pub mass: Option<Expression>,
    /// Moment of inertia about the centre of mass \[kg m²\].
    pub inertia: Option<Expression>,
    /// Centre of mass in the body's frame \[m\].
    pub center: Option<[Expression; 2]>,
    /// Whether shapes with a thickness and a density give it mass, centre and inertia instead.
    pub is_weighed: bool,
}

/// Frame fixed on a body or on ground: a point and a direction.
#[derive(Clone, Debug)]
pub struct Marker {
    /// Name, unique within its body.
    pub name: String,
    /// Body that carries it, `None` on ground.
    pub body: Option<BodyId>,
    /// Point s = (x', y') in the body's frame \[m\].
    pub position: [Expression; 2],
    /// Direction of the marker's x-axis in the body's frame \[rad\].
    pub angle: Expression,
}

impl Marker {
    /// Returns all its numbers: x', y' and the angle.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = &Expression> {
        self.position.iter().chain([&self.angle])
    }
}

/// Coordinate held at a value.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// Coordinate.
    pub coordinate: Coordinate,
    /// Value \[m or rad\].
    pub value: Expression,
}

/// Coordinate that moves: an FMI input or a prescribed motion.
#[derive(Clone, Debug)]
pub struct Driver {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// Coordinate that is driven.
    pub coordinate: Coordinate,
    /// Source of its value.
    pub source: DriverSource,
    /// The prescribed motion with inputs of the mechanism in it. `source` has the motion for what these are
    /// given, or for their values at the start.
    pub follows: Option<Expression>,
    /// Whether the file makes it an FMI input, whose acceleration is free, also where a run gives
    /// it another source.
    pub is_input: bool,
    /// Lower limit \[m or rad\], evaluated with the file's parameter values. A value beyond it is
    /// followed, and told.
    pub min: Option<f64>,
    /// Upper limit \[m or rad\], likewise.
    pub max: Option<f64>,
    /// Whether an input gives an angle modulo one turn: each value means the turn nearest the last
    /// value. Only for the coordinate `angle` and for inputs.
    pub wrapped: bool,
}

impl Driver {
    /// Returns the prescribed motion in force, `None` for a driver that follows given values.
    #[must_use]
    pub fn motion(&self) -> Option<&PrescribedMotion> {
        match &self.source {
            DriverSource::Input { .. } | DriverSource::Free { .. } => None,
            DriverSource::Motion(motion) => Some(motion),
        }
    }

    /// Returns whether the coordinate is a freedom: it moves by the forces.
    #[must_use]
    pub fn is_free(&self) -> bool {
        matches!(self.source, DriverSource::Free { .. })
    }

    /// Returns whether it follows values that are given from outside, as an FMI input does.
    #[must_use]
    pub fn is_given(&self) -> bool {
        matches!(self.source, DriverSource::Input { .. })
    }

    /// Returns whether no motion prescribes its acceleration: it is an FMI input of the file, or a
    /// freedom.
    #[must_use]
    pub fn has_open_acceleration(&self) -> bool {
        self.is_input || self.is_free()
    }

    /// Returns the value at the start \[m or rad\], `None` for a prescribed motion.
    #[must_use]
    pub fn start(&self) -> Option<f64> {
        match self.source {
            DriverSource::Input { start } | DriverSource::Free { start, .. } => Some(start),
            DriverSource::Motion(_) => None,
        }
    }

    /// Returns the velocity of a freedom at the start \[m/s or rad/s\], zero for other drivers.
    #[must_use]
    pub fn start_velocity(&self) -> f64 {
        match self.source {
            DriverSource::Free { velocity, .. } => velocity,
            DriverSource::Input { .. } | DriverSource::Motion(_) => 0.0,
        }
    }

    /// Returns the coordinate that the file drives or sets free, where the motion may be integrated in
    /// another one.
    #[must_use]
    pub fn named(&self) -> &Coordinate {
        match &self.source {
            DriverSource::Free {
                named: Some(named), ..
            } => named,
            _ => &self.coordinate,
        }
    }

    /// Returns the word for it in messages.
    #[must_use]
    pub fn noun(&self) -> &'static str {
        if self.is_free() { "freedom" } else { "driver" }
    }
}

/// Source of a driver's value.
#[derive(Clone, Debug)]
pub enum DriverSource {
    /// FMI input.
    Input {
        /// Value that defines the assembly mode \[m or rad\], evaluated with the file's
        /// parameter values.
        start: f64,
    },
    /// Prescribed motion.
    Motion(PrescribedMotion),
    /// The forces, of which it takes none: the coordinate is a freedom.
    Free {
        /// Value at the start, which defines the assembly mode \[m or rad\], evaluated with the
        /// file's parameter values.
        start: f64,
        /// Velocity at the start \[m/s or rad/s\].
        velocity: f64,
        /// The file's own coordinate, where the motion is integrated in another one.
        named: Option<Coordinate>,
    },
}

/// Coordinate that is an output.
#[derive(Clone, Debug)]
pub struct Measure {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// Coordinate.
    pub coordinate: Coordinate,
}

/// Outputs of the FMU besides measures and solver quantities.
#[derive(Clone, Debug)]
pub struct Outputs {
    /// Bodies, in mechanism order; all unless the file narrows them.
    pub bodies: Vec<BodyId>,
    /// Points of interest, in the order of the file's list.
    pub markers: Vec<MarkerId>,
    /// Joints whose reactions are outputs if the mechanism has dynamics, by their indices in
    /// [`Mechanism::joints`], ascending; all unless the file narrows them.
    pub joints: Vec<usize>,
    /// Constraints whose efforts are outputs, likewise.
    pub constraints: Vec<usize>,
    /// Treatment of reactions that redundant constraints leave indeterminate.
    pub indeterminate: Indeterminate,
}

/// Treatment of reactions that redundant constraints leave indeterminate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Indeterminate {
    /// They are no outputs.
    #[default]
    Omit,
    /// Outputs are the ones with the least sum of squares, in SI units.
    MinimumNorm,
}

/// FMI default experiment, and the default settings of a run.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// Start time \[s\].
    pub start: f64,
    /// Stop time \[s\].
    pub stop: f64,
    /// Communication step size \[s\].
    pub step: f64,
    /// Relative tolerance for the host; the solver itself works to rounding.
    pub tolerance: f64,
    /// Acceleration of gravity \[m/s²\], without effect on the motion.
    pub gravity: [Expression; 2],
    /// Start value of the FMU's parameter `rates`.
    pub rates: RateSource,
    /// Start value of the FMU's parameter `extrapolation`.
    pub extrapolation: Extrapolation,
}

impl Mechanism {
    /// Returns whether a prescribed motion depends on time.
    #[must_use]
    pub fn uses_time(&self) -> bool {
        let mut motions = self.drivers.iter().filter_map(Driver::motion);
        motions.any(PrescribedMotion::uses_time)
    }

    /// Returns a marker's name with its body's: `crank.A`, `ground.O2`.
    #[must_use]
    pub fn marker_path(&self, id: MarkerId) -> String {
        let marker = &self.markers[id.index()];
        let body = marker
            .body
            .map_or("ground", |body| &self.bodies[body.index()].name);
        format!("{body}.{}", marker.name)
    }

    /// Returns the unit in which the file shows lengths: that of its first parameter that is a
    /// length and has one; `None` for metres.
    #[must_use]
    pub fn length_display(&self) -> Option<DisplayUnit> {
        let units = self.parameters.iter().filter_map(|p| p.unit);
        let mut lengths = units.filter(|unit| unit.dimension == Unit::METRE.dimension);
        lengths.find_map(|unit| unit.display)
    }
}

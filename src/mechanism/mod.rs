//! The mechanism as data: bodies, markers, joints, drivers, measures and parameters.
//!
//! A mechanism file is read in three steps: [`Source`] keeps the text and its lines, the reader
//! (`syntax` and `lower`) turns it into a [`Mechanism`] or into every
//! [`Diagnostic`] that stands in the way, and [`Expression`]s keep each number as a function of
//! the parameters. Nothing here computes a pose.

mod diagnostic;
mod encoding;
mod expression;
mod id;
mod lookup;
mod lower;
mod motion;
mod names;
mod number;
mod parameter;
mod profile;
mod source;
mod spline;
mod syntax;
mod table;

pub use crate::unit::{Dimension, DisplayUnit, Unit};
pub use diagnostic::{Diagnostic, Label, Severity};
pub use expression::{Expression, ExpressionError, Variable};
pub use id::{BodyId, DriverId, MarkerId, ParameterId};
pub use lower::is_identifier;
#[cfg(feature = "cli")]
pub use lower::schema;
#[cfg(feature = "cli")]
pub(crate) use motion::not_finite;
pub use motion::{Interpolation, Law, Motion, MotionInForce, MotionTable};
pub(crate) use names::shown;
#[cfg(feature = "cli")]
pub(crate) use names::{help, quoted};
pub use number::{Dual, Interval, Jet, Jet3, Number, Taylor};
pub use parameter::Parameter;
pub use profile::{Profile, ProfileAlong, ProfileError, ProfileInForce};
pub use source::{Position, Source, Span};
pub use spline::{Ends, Spline};
#[cfg(feature = "cli")]
pub(crate) use table::{Separated, comma_hint};
pub use table::{Table, TableFile};

/// A planar mechanism as its file describes it, checked for names, types and units, not yet for
/// assembly.
///
/// Lists are in file order. Every index ([`BodyId`], [`MarkerId`], …) is valid for the mechanism
/// it came from.
#[derive(Clone, Debug)]
pub struct Mechanism {
    /// FMI `modelName` and `modelIdentifier`: a C identifier.
    pub name: String,
    /// One line for people, empty if the file gives none.
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
    /// The moving bodies.
    pub bodies: Vec<Body>,
    /// All markers: those of ground first, then body by body.
    pub markers: Vec<Marker>,
    /// The joints.
    pub joints: Vec<Joint>,
    /// Bare coordinates held at a value.
    pub constraints: Vec<Constraint>,
    /// The drivers: FMI inputs and prescribed motions.
    pub drivers: Vec<Driver>,
    /// Coordinates that are outputs.
    pub measures: Vec<Measure>,
    /// What the FMU gives out.
    pub outputs: Outputs,
    /// Default experiment.
    pub simulation: Simulation,
    /// The CSV files that the mechanism file names, each once.
    pub table_files: Vec<TableFile>,
    /// The content of the file and of its tables without comments and layout: equal only for
    /// files that describe the same mechanism with the same values and tables in the same order.
    pub canonical: String,
}

/// A rigid body with generalized coordinates q = \[x, y, phi\] (seed, 5.4.1).
#[derive(Clone, Debug)]
pub struct Body {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// One line for people, empty if the file gives none.
    pub description: String,
    /// Its markers, in file order.
    pub markers: Vec<MarkerId>,
    /// Where to look for the assembly: x, y \[m\], phi \[rad\].
    pub estimate: [Expression; 3],
    /// Mass \[kg\].
    pub mass: Option<Expression>,
    /// Moment of inertia about the centre of mass \[kg m²\].
    pub inertia: Option<Expression>,
    /// Centre of mass in the body's frame \[m\].
    pub center: Option<[Expression; 2]>,
}

/// A frame fixed on a body or on ground: a point and a direction.
#[derive(Clone, Debug)]
pub struct Marker {
    /// Name, unique within its body.
    pub name: String,
    /// The body that carries it, `None` on ground.
    pub body: Option<BodyId>,
    /// The point s = (x', y') in the body's frame \[m\].
    pub position: [Expression; 2],
    /// Direction of the marker's x-axis in the body's frame \[rad\].
    pub angle: Expression,
}

/// A scalar measured from one marker to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coordinate {
    /// What is measured.
    pub kind: CoordinateKind,
    /// Marker i, measured from.
    pub from: MarkerId,
    /// Marker j, measured to.
    pub to: MarkerId,
    /// Marker k on whose axes `x` and `y` are measured; marker i unless the file says otherwise.
    /// Without meaning for `angle` and `distance`.
    pub axes: MarkerId,
}

/// The four relative coordinates. theta is a marker's direction, P its point, u and n the x- and
/// y-axis of marker k.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CoordinateKind {
    /// `theta_j − theta_i` \[rad\], counting turns.
    Angle,
    /// `u_k · (P_j − P_i)` \[m\].
    X,
    /// `n_k · (P_j − P_i)` \[m\].
    Y,
    /// `‖P_j − P_i‖` \[m\].
    Distance,
}

impl CoordinateKind {
    /// A value of it for people, with its unit.
    #[must_use]
    pub fn show(self, value: f64) -> String {
        match self {
            Self::Angle => format!("{value:.9} rad ({:.6} deg)", value.to_degrees()),
            _ => format!("{value:.9} m"),
        }
    }
}

/// A named bundle of constraints between two markers.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// Which bundle.
    pub kind: JointKind,
    /// Marker i.
    pub from: MarkerId,
    /// Marker j.
    pub to: MarkerId,
}

/// The kinds of joint.
#[derive(Clone, Debug)]
pub enum JointKind {
    /// The points coincide: x = y = 0.
    Revolute,
    /// Marker j slides along the x-axis of marker i without turning: y = angle = 0.
    Translational,
    /// The point of marker j stays on the x-axis of marker i: y = 0.
    Slot,
    /// A massless rod between two revolutes (composite revolute–revolute): distance = length.
    Link {
        /// Distance between the points \[m\], positive.
        length: Expression,
    },
    /// The point of marker j stays at a distance from the x-axis of marker i (composite
    /// revolute–translational): y = offset.
    RevoluteTranslational {
        /// Signed distance \[m\].
        offset: Expression,
    },
    /// The markers coincide: x = y = angle = 0.
    Weld,
    /// Two toothed wheels that roll on each other. Marker angles set the phase.
    Gear {
        /// The wheels' sizes, that of marker i's wheel first.
        sizes: WheelSizes,
        /// Whether the smaller wheel runs inside the larger one: both turn the same way.
        internal: bool,
        /// The body that carries both centres, `None` for ground.
        carrier: Option<BodyId>,
    },
    /// Two wheels joined by a belt or chain. Marker angles set the phase.
    Belt {
        /// The wheels' sizes, that of marker i's wheel first.
        sizes: WheelSizes,
        /// Whether the belt crosses between the wheels: they then turn opposite ways.
        crossed: bool,
        /// The body that carries both centres, `None` for ground.
        carrier: Option<BodyId>,
    },
    /// A pinion, which has marker i, that rolls along the x-axis of marker j, the rack.
    RackAndPinion {
        /// The pinion's radius \[m\].
        radius: Expression,
        /// On which side of the rack the pinion is.
        side: RackSide,
    },
    /// A follower, which has marker j, on the contour of a cam, which has marker i.
    Cam {
        /// What touches the cam.
        follower: CamFollower,
        /// The contour.
        profile: Profile,
    },
}

/// What of a follower touches the cam, on the outer side of its contour.
#[derive(Clone, Debug)]
pub enum CamFollower {
    /// The marker's point.
    Knife,
    /// A roller round the marker's point.
    Roller {
        /// Its radius \[m\], positive.
        radius: Expression,
    },
    /// The marker's x-axis.
    Flat,
}

/// The sizes of two wheels. Their ratio decides how they turn.
#[derive(Clone, Debug)]
pub enum WheelSizes {
    /// Radii of the pitch circles \[m\].
    Radii([Expression; 2]),
    /// Numbers of teeth.
    Teeth([Expression; 2]),
}

impl WheelSizes {
    /// Both sizes, in metres or in teeth.
    #[must_use]
    pub fn expressions(&self) -> &[Expression; 2] {
        match self {
            Self::Radii(sizes) | Self::Teeth(sizes) => sizes,
        }
    }
}

/// The side of a rack on which its pinion rolls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RackSide {
    /// On the +y side of the rack's marker.
    Above,
    /// On the −y side of the rack's marker.
    Below,
}

/// A bare coordinate held at a value.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// The coordinate.
    pub coordinate: Coordinate,
    /// Its value \[m or rad\].
    pub value: Expression,
}

/// A coordinate whose value is given as a function of time.
#[derive(Clone, Debug)]
pub struct Driver {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// One line for people, empty if the file gives none.
    pub description: String,
    /// The coordinate it drives.
    pub coordinate: Coordinate,
    /// Where its value comes from.
    pub source: DriverSource,
}

impl Driver {
    /// The prescribed motion, `None` for an FMI input.
    #[must_use]
    pub fn motion(&self) -> Option<&Motion> {
        match &self.source {
            DriverSource::Input { .. } => None,
            DriverSource::Motion(motion) => Some(motion),
        }
    }
}

/// Where a driver's value comes from.
#[derive(Clone, Debug)]
pub enum DriverSource {
    /// An FMI input.
    Input {
        /// The value that defines the assembly mode \[m or rad\], evaluated with the file's
        /// parameter values.
        start: f64,
    },
    /// A prescribed motion.
    Motion(Motion),
}

/// A coordinate that is an output.
#[derive(Clone, Debug)]
pub struct Measure {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// One line for people, empty if the file gives none.
    pub description: String,
    /// The coordinate.
    pub coordinate: Coordinate,
}

/// What the FMU gives out besides measures and solver quantities.
#[derive(Clone, Debug)]
pub struct Outputs {
    /// The bodies, in mechanism order; all of them unless the file narrows them.
    pub bodies: Vec<BodyId>,
    /// Points of interest, in the order of the file's list.
    pub markers: Vec<MarkerId>,
}

/// The FMI default experiment, and what a run takes where nothing else is said.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// Start time \[s\].
    pub start: f64,
    /// Stop time \[s\].
    pub stop: f64,
    /// Communication step size \[s\].
    pub step: f64,
    /// Relative tolerance, handed on to the host; the solver itself works to rounding.
    pub tolerance: f64,
    /// Gravity \[m/s²\]; read and checked, without effect on the kinematics.
    pub gravity: [f64; 2],
}

impl Mechanism {
    /// How the file calls a marker: `crank.A`, `ground.O2`.
    #[must_use]
    pub fn marker_path(&self, id: MarkerId) -> String {
        let marker = &self.markers[id.index()];
        let body = marker
            .body
            .map_or("ground", |body| &self.bodies[body.index()].name);
        format!("{body}.{}", marker.name)
    }
}

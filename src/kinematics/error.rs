//! The errors of the kinematics.

use std::fmt;

use super::origin::Origin;
use super::stop_limit::StopLimit;
use crate::mechanism::{CoordinateKind, ProfileError, ShapeFault, show_time, shown, shown_apart};

/// A call of the kinematics that could not do its work.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// More or less is driven than is free to move.
    #[error("{}", structure_message(*.freedom, *.drivers, *.free, .loose, .remedy, .excess))]
    Structure {
        /// Degrees of freedom that joints and constraints leave.
        freedom: usize,
        /// The number of drivers.
        drivers: usize,
        /// Degrees of freedom that no driver drives.
        free: usize,
        /// The bodies that can move though no driver does: kind and name of each.
        loose: Vec<String>,
        /// The probable meaning.
        remedy: Box<Remedy>,
        /// Drivers of which one is too many, or joints and constraints that hold a coordinate that
        /// a driver drives: kind and name of each.
        excess: Vec<String>,
    },
    /// Constraints that cannot be satisfied together, whatever the mechanism's pose.
    #[error(
        "{}{}", contradiction_message(.origins, .open),
        .fit.as_ref().map(|fit| format!(": {fit}")).unwrap_or_default()
    )]
    Contradiction {
        /// The smallest set: kind and name of each; one alone if all others hold without it.
        origins: Vec<String>,
        /// The gap in the one declared last when the others are closed.
        open: OpenJoint,
        /// The length that would close it, if a length alone decides.
        fit: Option<Box<Fit>>,
        /// The pose with that gap.
        nearest: Box<OpenPose>,
    },
    /// An expression has no finite value for the parameter values in force.
    #[error("{what} has no finite value with these parameter values")]
    NotFinite {
        /// The quantity that the expression gives.
        what: String,
    },
    /// A parameter that follows from others is outside its limits.
    #[error(
        "`{name}` = {} is {beyond} = {}; it follows from other parameters",
        shown_apart(*.value, *.limit)[0], shown_apart(*.value, *.limit)[1]
    )]
    Limit {
        /// Name of the parameter.
        name: String,
        /// The value \[SI\].
        value: f64,
        /// The key of the limit, and on which side of it the value is.
        beyond: &'static str,
        /// The limit \[SI\].
        limit: f64,
    },
    /// The least value of a stop is not below its largest one.
    #[error(
        "stop `{stop}`: its `min` = {} is not below its `max` = {}",
        .kind.show_apart(*.min, *.max)[0], .kind.show_apart(*.min, *.max)[1]
    )]
    StopLimits {
        /// Name of the stop.
        stop: String,
        /// Kind of its coordinate.
        kind: CoordinateKind,
        /// The least value \[m or rad\].
        min: f64,
        /// The largest value \[m or rad\].
        max: f64,
    },
    /// A shape has no proper outline for the parameter values in force.
    #[error("{0}")]
    Shape(Box<ShapeFault>),
    /// A pose at which a motion is to start is beyond a stop, or beyond the end of a curve.
    #[error("the start pose is {}", .limit.describe_beyond(*.value))]
    BeyondStop {
        /// The limit.
        limit: Box<StopLimit>,
        /// The coordinate's value \[m or rad\].
        value: f64,
    },
    /// The motion of a driver has no finite value, or no finite rates.
    #[error("{driver} has no finite {quantity}")]
    NoMotion {
        /// The driver.
        driver: String,
        /// The non-finite quantity.
        quantity: &'static str,
    },
    /// A driver's rates are finite, but those of bodies are not.
    #[error("{driver} is too fast: velocities or accelerations of bodies are not finite")]
    TooFast {
        /// The driver.
        driver: String,
    },
    /// The target of a distance is not positive.
    #[error("{what} would hold a distance at {} m; a distance must be positive", shown(*.value))]
    NotPositive {
        /// The joint, constraint or driver.
        what: String,
        /// The value \[m\].
        value: f64,
    },
    /// A mass or a moment of inertia has a value that it cannot have.
    #[error("{what} is {}; it must {demand}", shown(*.value))]
    Mass {
        /// The quantity and its body.
        what: String,
        /// The value \[SI\].
        value: f64,
        /// The values that it can have.
        demand: &'static str,
    },
    /// A driver follows an input, whose rates a host of model exchange does not tell.
    #[error(
        "driver `{driver}` follows an input, which is possible in co-simulation only: rates of the driver \
         follow from the steps of the host there"
    )]
    FollowsInput {
        /// Name of the driver.
        driver: String,
    },
    /// A force has no direction or no finite size.
    #[error("force `{force}` {reason}")]
    NoForce {
        /// Name of the force.
        force: String,
        /// The reason, as the end of a sentence.
        reason: &'static str,
    },
    /// The profile of a cam has no valid contour for the parameter values in force.
    #[error("{what}: {error}")]
    Profile {
        /// The joint.
        what: String,
        /// The fault of the contour.
        error: ProfileError,
    },
    /// No pose satisfies all equations, or none was found.
    #[error("{}", not_assembled_message(verdict, open, fit.as_deref()))]
    NotAssembled {
        /// Proved impossible, or not found.
        verdict: Verdict,
        /// The joints that stay open in the nearest pose found.
        open: Vec<OpenJoint>,
        /// The length that would close it there, if one joint alone stays open.
        fit: Option<Box<Fit>>,
        /// q of that pose.
        nearest: Vec<f64>,
    },
    /// No continuous motion was found from a known pose to values at which the mechanism closes.
    #[error(
        "the mechanism closes at the start values, but the motion that leads there from the file's \
         own pose stops{}: {reason}; if the pose at the start values is meant, give the file \
         `start` values and estimates from which a motion leads there",
        stopped_with(.values)
    )]
    NoWay {
        /// The cause of the stop.
        reason: String,
        /// The drivers and parameters that move, with their values there.
        values: Vec<String>,
    },
    /// The equations can be satisfied, but the Jacobian is singular there.
    #[error("{}", singular_message(*.rcond, .bodies, .aside.as_deref()))]
    Singular {
        /// Scaled reciprocal condition of the Jacobian.
        rcond: f64,
        /// The bodies that can move there without any driver; empty if not determined.
        bodies: Vec<String>,
        /// A driver and a value of it beside a singular start, in words.
        aside: Option<String>,
    },
    /// Coordinates of an equation move in too large a ratio.
    #[error(
        "{origin}: `{far}` moves {} times as far as `{near}`, in radians and sizes of the mechanism; \
         the solver takes {} times and more for held: give them a coordinate in between, with an \
         equation to each of them",
        shown(*.ratio), shown(*.largest)
    )]
    Ratio {
        /// The joint.
        origin: String,
        /// Names of the coordinates that move farthest, and least far.
        far: String,
        /// Likewise.
        near: String,
        /// Ratio of their ways.
        ratio: f64,
        /// The least ratio that is too large.
        largest: f64,
    },
    /// The arc of a rope on a pulley comes to an angle beyond which it is not counted.
    #[error(
        "joint `{rope}`: the arc of the rope on its pulley at `{pulley}` is {:.1} deg; arcs are \
         counted from -45 to 315 deg", angle.to_degrees()
    )]
    RopeArc {
        /// Name of the rope's joint.
        rope: String,
        /// Marker at the pulley's centre, with its body.
        pulley: String,
        /// The angle \[rad\].
        angle: f64,
    },
    /// Values have no limit at a change point, or none that is known.
    #[error(
        "{of} have no limit at the change point with driver `{driver}` at {value}, where {geometry}: \
         they grow without bound next to it, or depend on how inputs go on"
    )]
    ChangePoint {
        /// The values.
        of: NoLimit,
        /// Name of the driver that moves the mechanism through the point.
        driver: String,
        /// Its value there, in words.
        value: String,
        /// The lines that meet there, in words.
        geometry: String,
    },
    /// An expression has no finite derivative.
    #[error("{what} has no finite derivative{} with these values", .by.as_ref().map(|name| format!(" with respect to {name}")).unwrap_or_default())]
    NoDerivative {
        /// The quantity that the expression gives.
        what: String,
        /// The parameter or variable that changes, if it is known.
        by: Option<String>,
    },
}

/// Values that a change point may leave without a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoLimit {
    /// Reactions of joints and constraints.
    Reactions,
    /// Derivatives along a direction.
    Derivatives,
}

impl fmt::Display for NoLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Reactions => "the reactions of joints",
            Self::Derivatives => "these derivatives",
        })
    }
}

impl Error {
    /// Describes the error of a motion that starts at `time` \[s\]: with the time, if a driver or a
    /// force has no value then.
    #[must_use]
    pub fn at_start(&self, time: f64) -> String {
        match self {
            Self::NoMotion { .. } | Self::TooFast { .. } | Self::NoForce { .. } => {
                format!("at t = {} s: {self}", show_time(time))
            }
            _ => self.to_string(),
        }
    }
}

/// The verdict on a mechanism that was not assembled.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// No pose satisfies all equations.
    Impossible {
        /// The proof, in the nearest pose.
        proof: Box<Proof>,
        /// Number of branches of the blocks before; each is excluded.
        ways: usize,
    },
    /// No pose was found; one may still exist.
    NotFound {
        /// Number of starts, the same ones each time.
        starts: usize,
    },
}

/// The proof that a block cannot close.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Proof {
    /// Two links do not reach from one point to another.
    Reach {
        /// The two links.
        bodies: [String; 2],
        /// The markers that they have to join.
        points: [String; 2],
        /// Distance of these markers \[m\].
        distance: f64,
        /// The least and the largest distance that the links span \[m\].
        span: [f64; 2],
    },
    /// A point does not reach its line, whatever the angle of a body.
    Line {
        /// The body.
        body: String,
    },
    /// All angles of some bodies are excluded, by bounds of the equations over intervals.
    Excluded {
        /// The bodies.
        bodies: Vec<String>,
        /// Number of boxes into which their angles were divided.
        boxes: usize,
    },
}

impl fmt::Display for Proof {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Reach {
                bodies: [a, b],
                points: [from, to],
                distance,
                span: [shortest, longest],
            } => {
                // As many digits as tell the distance from both ends of the span.
                let show = |digits| {
                    [distance, shortest, longest]
                        .map(|length| format!("{} mm", with_digits(length * 1e3, digits)))
                };
                let differ = |[distance, shortest, longest]: &[String; 3]| {
                    distance != shortest && distance != longest
                };
                let shown = (FEW_DIGITS..=17).map(show).find(differ);
                let [distance, shortest, longest] = shown.unwrap_or_else(|| show(FEW_DIGITS));
                write!(
                    f,
                    "`{from}` and `{to}` are {distance} apart, `{a}` and `{b}` together span \
                     {shortest} to {longest}"
                )
            }
            Self::Line { body } => write!(f, "whatever the angle of `{body}`"),
            Self::Excluded { bodies, .. } => {
                let bodies: Vec<_> = bodies.iter().map(|body| format!("`{body}`")).collect();
                write!(f, "bounds exclude all angles of {}", bodies.join(", "))
            }
        }
    }
}

/// Describes elements that contradict each other, or one that contradicts all others.
fn contradiction_message(origins: &[String], open: &OpenJoint) -> String {
    match origins {
        [alone] => format!(
            "{alone} contradicts all others: with these closed, it stays open by {}; move one of \
             its markers by as much, or remove it",
            open.measured()
        ),
        _ => format!(
            "{} contradict each other: all others closed, {open}; remove one of them, or make \
             them agree",
            origins.join(", ")
        ),
    }
}

/// The probable meaning of a mechanism whose drivers do not match its degrees of freedom.
#[derive(Clone, Debug, PartialEq)]
pub enum Remedy {
    /// Slots on whose points a body that is free to move may only turn, perhaps none: kind and name
    /// of each.
    Slots(Vec<String>),
    /// A coordinate of a body that is free to move, as a line of the mechanism file.
    Line(String),
    /// Drivers of coordinates that are fixed or driven already, beside bodies that are free to move.
    Elsewhere {
        /// Kind and name of each driver; of several on one motion, all of them.
        drivers: Vec<String>,
        /// The joints and constraints that fix their coordinates: kind and name of each.
        holders: Vec<String>,
        /// A coordinate of a body that is free to move, as keys of the mechanism file.
        keys: Option<String>,
    },
}

/// A joint, constraint or driver that cannot be satisfied together with the rest.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenJoint {
    /// Kind and name.
    pub origin: String,
    /// The gap between its points \[m\], zero if it has none.
    pub gap: f64,
    /// The error of its angle \[rad\], zero if it has none.
    pub angle: f64,
}

impl fmt::Display for OpenJoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} stays open by {}", self.origin, self.measured())
    }
}

impl OpenJoint {
    /// Returns the gap and the error of the angle, as far as it has one, in words.
    pub fn measured(&self) -> String {
        match (self.gap > 0.0, self.angle > 0.0) {
            (true, true) => format!("{} and {}", millimetres(self.gap), degrees(self.angle)),
            (false, true) => degrees(self.angle),
            _ => millimetres(self.gap),
        }
    }
}

/// A pose in which all joints, constraints and drivers but one are closed.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenPose {
    /// The one that is open.
    pub open: Origin,
    /// q.
    pub q: Vec<f64>,
}

/// A number that would let a mechanism close.
#[derive(Clone, Debug, PartialEq)]
pub enum Fit {
    /// A length.
    Length {
        /// The link, the rope or the body that has the length: kind and name.
        origin: String,
        /// The markers of the body between which it is measured; `None` for a link.
        between: Option<[String; 2]>,
        /// The length that closes \[m\].
        length: f64,
        /// The present length \[m\].
        present: f64,
    },
    /// The phase of wheels as they are drawn.
    Phase {
        /// The joint: kind and name.
        origin: String,
    },
}

impl fmt::Display for Fit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Phase { origin } => write!(f, "{origin} would close with `phase = \"drawn\"`"),
            Self::Length { origin, .. } => {
                write!(f, "{origin} would fit with {}", self.length("", f64::round))
            }
        }
    }
}

impl Fit {
    /// Says that lengths beyond this one let the mechanism close.
    fn or_beyond(&self) -> String {
        match self {
            Self::Phase { .. } => self.to_string(),
            Self::Length {
                origin,
                length,
                present,
                ..
            } => {
                let length = if length > present {
                    self.length("more than ", f64::ceil)
                } else {
                    self.length("less than ", f64::floor)
                };
                format!("{origin} would reach with {length}")
            }
        }
    }

    /// Returns the length, rounded by `round`, and the present one in words; nothing for a phase.
    fn length(&self, relation: &str, round: fn(f64) -> f64) -> String {
        let Self::Length {
            between,
            length,
            present,
            ..
        } = self
        else {
            return String::new();
        };
        // As many digits as tell the two apart; rounding decides about none.
        let apart = (1e3 * (length - present)).abs().log10() + 1e-3;
        let decimals = (1.0 - apart.floor()).clamp(1.0, 12.0) as usize;
        let unit = 10_f64.powi(decimals as i32);
        let length = round(1e3 * length * unit) / unit;
        let [length, present] =
            [length, 1e3 * present].map(|length| format!("{length:.decimals$} mm"));
        match between {
            Some([from, to]) => {
                format!("{relation}{length} from `{from}` to `{to}`, which is {present} now")
            }
            None => format!("a length of {relation}{length}, which is {present} now"),
        }
    }
}

/// Formats a length with four digits, for messages.
pub(super) fn millimetres(length: f64) -> String {
    format!("{} mm", four_digits(length * 1e3))
}

/// Formats an angle with four digits, for messages.
fn degrees(angle: f64) -> String {
    format!("{} deg", four_digits(angle.to_degrees()))
}

fn four_digits(value: f64) -> String {
    with_digits(value, FEW_DIGITS)
}

/// Digits of a length or an angle in a message, if they are enough.
const FEW_DIGITS: usize = 4;

fn with_digits(value: f64, digits: usize) -> String {
    let behind_first = digits as i32 - 1;
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        // A value that rounds up to a power of ten has the digits of that power.
        let rounded = value.abs().max(1e-3) * (1.0 + 0.5 * 10_f64.powi(-behind_first - 1));
        let decimals = behind_first - rounded.log10().floor() as i32;
        format!("{value:.*}", decimals.max(0) as usize)
    } else {
        format!("{value:.*e}", digits - 1)
    }
}

/// Lists names for a message, with `last` before the last one; of very many only the first.
pub(super) fn list(names: &[String], last: &str) -> String {
    const SHOWN: usize = 8;
    if names.len() > SHOWN + 1 {
        let others = names.len() - SHOWN;
        return format!("{} and {others} others", names[..SHOWN].join(", "));
    }
    match names {
        [names @ .., name] if !names.is_empty() => format!("{}{last}{name}", names.join(", ")),
        _ => names.concat(),
    }
}

/// Returns "with" and the values at which a motion stops, empty without values.
fn stopped_with(values: &[String]) -> String {
    if values.is_empty() {
        return String::new();
    }
    format!(" with {}", list(values, " and "))
}

fn not_assembled_message(verdict: &Verdict, open: &[OpenJoint], fit: Option<&Fit>) -> String {
    let open: Vec<_> = open.iter().map(OpenJoint::to_string).collect();
    let open = list(&open, ", ");
    let message = match verdict {
        Verdict::Impossible { proof, ways: 1 } => {
            format!("the mechanism cannot close: {open}; {proof}")
        }
        Verdict::Impossible { proof, ways } => format!(
            "the mechanism cannot close in any of the {ways} ways in which its other parts close; \
             in the nearest {open}; {proof}"
        ),
        Verdict::NotFound { starts } => format!(
            "the mechanism was not found to close from {starts} deterministic start{}, which is \
             no proof that it cannot; in the nearest pose found {open}",
            if *starts == 1 { "" } else { "s" }
        ),
    };
    match fit {
        Some(fit) => format!("{message}; {}", fit.or_beyond()),
        None => message,
    }
}

fn singular_message(rcond: f64, bodies: &[String], aside: Option<&str>) -> String {
    let mut message = format!(
        "the mechanism is in a singular position (a dead point or change point): the Jacobian has \
         a reciprocal condition of {rcond:.1e}"
    );
    if !bodies.is_empty() {
        message += &format!(
            "; {} can move there while all drivers stand still",
            bodies.join(", ")
        );
    }
    if let Some(aside) = aside {
        message += &format!("; start a little aside, such as with {aside}");
    }
    message
}

fn structure_message(
    freedom: usize,
    drivers: usize,
    free: usize,
    loose: &[String],
    remedy: &Remedy,
    excess: &[String],
) -> String {
    let count = |number: usize, singular: &str, plural: &str| match number {
        0 => format!("no {singular}"),
        1 => format!("1 {singular}"),
        _ => format!("{number} {plural}"),
    };
    let mut message = format!(
        "the mechanism has {} and {}",
        count(freedom, "degree of freedom", "degrees of freedom"),
        count(drivers, "driver", "drivers")
    );
    if let Remedy::Elsewhere {
        drivers,
        holders,
        keys,
    } = remedy
    {
        let hold = if holders.len() == 1 { "holds" } else { "hold" };
        let holders = list(holders, " and ");
        let names = list(drivers, " and ");
        message += &match (drivers.len(), holders.is_empty()) {
            (_, true) => {
                format!("; {names} drive one motion: give one of them a coordinate that is free")
            }
            (1, _) => format!(
                "; {names} drives what {holders} already {hold}: give it a coordinate that is free"
            ),
            (count, _) => {
                let rest = if count > free {
                    ", and remove the rest"
                } else {
                    ""
                };
                format!(
                    "; {names} drive what {holders} already {hold}: give one of them a coordinate \
                     that is free{rest}"
                )
            }
        };
        if let Some(keys) = keys {
            message += &format!(", such as `{keys}`");
        }
        return message + &format!("; free to move: {}", list(loose, ", "));
    }
    if free > 0 {
        let add = if free == 1 {
            "add a driver for one of them".to_owned()
        } else {
            format!("add {free} drivers for them")
        };
        message += &format!("; free to move: {}: {add}", list(loose, ", "));
    }
    if let Remedy::Slots(slots) = remedy
        && !slots.is_empty()
    {
        message += &format!(
            "; a `slot` holds a point, `translational` the angle too: {}",
            list(slots, ", ")
        );
    }
    if !excess.is_empty() {
        message += &format!("; too many: remove one of {}", list(excess, ", "));
    }
    if let Remedy::Line(line) = remedy {
        message += &format!(
            "; `{line}` under `[drivers]`, with a `start` or a `motion`, drives it, and under \
             `[freedoms]` the forces move it"
        );
    }
    message
}

//! What can go wrong in the kinematics.

use std::fmt;

use crate::mechanism::ProfileError;

/// A call of the kinematics that could not do its work.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// More or less is driven than is free to move.
    #[error("{}", structure_message(*.freedom, *.drivers, *.free, .loose, .excess))]
    Structure {
        /// Degrees of freedom that joints and constraints leave.
        freedom: usize,
        /// The number of drivers.
        drivers: usize,
        /// Degrees of freedom that no driver drives.
        free: usize,
        /// What can move though no driver does: kind and name of each body.
        loose: Vec<String>,
        /// Drivers of which one is too many, or joints and constraints that hold what a driver
        /// would drive: kind and name of each.
        excess: Vec<String>,
    },
    /// Constraints that cannot be satisfied together, whatever the mechanism's pose.
    #[error(
        "{} contradict each other: all others closed, {open}; remove one of them, or make them \
         agree",
        .elements.join(", ")
    )]
    Contradiction {
        /// The smallest set: kind and name of each.
        elements: Vec<String>,
        /// What stays open in the one declared last when the others are closed.
        open: OpenJoint,
    },
    /// An expression has no finite value for the parameter values in force.
    #[error("{what} has no finite value with these parameter values")]
    NotFinite {
        /// What the expression is for.
        what: String,
    },
    /// A distance is to be held at a value that no distance can have.
    #[error("{what} would hold a distance at {value} m; a distance must be positive")]
    NotPositive {
        /// The joint, constraint or driver.
        what: String,
        /// The value \[m\].
        value: f64,
    },
    /// Parameters make no contour of a cam.
    #[error("{what}: {error}")]
    Profile {
        /// The joint.
        what: String,
        /// What is wrong with the contour.
        error: ProfileError,
    },
    /// No pose was found that satisfies all equations.
    #[error(
        "the mechanism was not found to close, from {starts} starts at and near the estimates: {}",
        open_message(.open)
    )]
    NotAssembled {
        /// From how many starts it was tried.
        starts: usize,
        /// What stays open in the nearest pose found.
        open: Vec<OpenJoint>,
    },
    /// The equations can be satisfied, but the Jacobian is singular there.
    #[error("{}", singular_message(*.rcond, .bodies))]
    Singular {
        /// Scaled reciprocal condition of the Jacobian.
        rcond: f64,
        /// The bodies that can move there without any driver, as far as they were looked for.
        bodies: Vec<String>,
    },
}

/// A joint, constraint or driver that cannot be satisfied together with the rest.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenJoint {
    /// Kind and name.
    pub element: String,
    /// The gap between its points \[m\], zero if it asks for none.
    pub gap: f64,
    /// The error of its angle \[rad\], zero if it asks for none.
    pub angle: f64,
}

impl fmt::Display for OpenJoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} stays open by ", self.element)?;
        match (self.gap > 0.0, self.angle > 0.0) {
            (true, true) => write!(f, "{} and {}", millimetres(self.gap), degrees(self.angle)),
            (false, true) => f.write_str(&degrees(self.angle)),
            _ => f.write_str(&millimetres(self.gap)),
        }
    }
}

/// A length to four digits, for messages.
fn millimetres(length: f64) -> String {
    format!("{} mm", four_digits(length * 1e3))
}

/// An angle to four digits, for messages.
fn degrees(angle: f64) -> String {
    format!("{} deg", four_digits(angle.to_degrees()))
}

fn four_digits(value: f64) -> String {
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        // What rounds up to a power of ten has its digits.
        let rounded = value.abs().max(1e-3) * (1.0 + 5e-5);
        let decimals = 3 - rounded.log10().floor() as i32;
        format!("{value:.*}", decimals.max(0) as usize)
    } else {
        format!("{value:.3e}")
    }
}

fn open_message(open: &[OpenJoint]) -> String {
    let parts: Vec<_> = open.iter().map(OpenJoint::to_string).collect();
    parts.join(", ")
}

fn singular_message(rcond: f64, bodies: &[String]) -> String {
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
    message
}

fn structure_message(
    freedom: usize,
    drivers: usize,
    free: usize,
    loose: &[String],
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
    if free > 0 {
        let add = if free == 1 {
            "add a driver for one of them".to_owned()
        } else {
            format!("add {free} drivers for them")
        };
        message += &format!("; free to move: {}: {add}", loose.join(", "));
    }
    if !excess.is_empty() {
        message += &format!("; too many: remove one of {}", excess.join(", "));
    }
    message
}

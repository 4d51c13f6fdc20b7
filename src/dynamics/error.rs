//! Reasons for which a free motion stops.

use super::integrator;
use crate::kinematics::{self, StopLimit};
use crate::mechanism::{fixed, shown};

/// The reason for which a free motion stops.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// A singular position, a contradiction, a value without a mechanism.
    #[error("{0}")]
    Blocked(String),
    /// A stop.
    #[error("{limit} at t = {} s: the free motion cannot go on", fixed(*.time, 9))]
    Stop {
        /// The limit.
        limit: Box<StopLimit>,
        /// Time at which it is reached \[s\].
        time: f64,
    },
    /// Rates or forces do not exist.
    #[error(transparent)]
    Kinematics(#[from] kinematics::Error),
    /// Some freedoms move no mass.
    #[error(
        "{} cannot move by forces: no body with a mass moves along; give the bodies that move with \
         it `mass`, and `inertia` or a `center` off the pivot",
        .freedoms.join(", ")
    )]
    NoInertia {
        /// Kind and name of each.
        freedoms: Vec<String>,
    },
    /// Nothing moves by forces.
    #[error("the mechanism has no freedom: all that moves is driven")]
    NoFreedom,
    /// Derivatives along a motion end at an event behind which they do not exist.
    #[error(
        "the derivatives of the motion end at t = {} s, {reason}",
        fixed(*.time, 9)
    )]
    NoDerivatives {
        /// Time of the event \[s\].
        time: f64,
        /// The end of the sentence: where it is.
        reason: &'static str,
    },
    /// The [budget](kinematics::Budget) is spent.
    #[error(
        "t = {} s: the free motion takes more than {most} sub-steps, with {events} events on the way: \
         take shorter steps, or look for a force or a speed that is too large",
        fixed(*.time, 9)
    )]
    Spent {
        /// Number of sub-steps of the budget.
        most: u32,
        /// Time that was reached \[s\].
        time: f64,
        /// Number of events on the way.
        events: usize,
    },
    /// The impacts at one instant come to no end.
    #[error(
        "t = {} s: the free motion cannot go on: impacts at one instant come to no end, at {}",
        fixed(*.time, 9),
        .contacts.join(", ")
    )]
    EndlessImpacts {
        /// The instant \[s\].
        time: f64,
        /// Kind and name of each stop and joint that is struck.
        contacts: Vec<String>,
    },
    /// Contacts press on what none of the freedoms moves.
    #[error(
        "t = {} s: the free motion cannot go on: {} squeeze what is between them",
        fixed(*.time, 9),
        .contacts.join(" and ")
    )]
    Squeezed {
        /// The instant \[s\].
        time: f64,
        /// Kind and name of each stop, joint and contact of shapes.
        contacts: Vec<String>,
    },
    /// The energy of a step is not that of the work done, however short the step.
    #[error(
        "t = {} s: the free motion cannot go on: its energy changes by {} J without a cause, with {} J in \
         motion; a smaller `tolerance` or other coordinates for the freedoms may do",
        fixed(*.time, 9), shown(*.change), shown(*.kinetic)
    )]
    Energy {
        /// Time at the end of the step \[s\].
        time: f64,
        /// Energy gained \[J\].
        change: f64,
        /// Kinetic energy, the larger one of both ends of the step \[J\].
        kinetic: f64,
    },
    /// The mechanism comes to no rest.
    #[error("no stable equilibrium was found from the start: downhill motion comes to no rest")]
    NoEquilibrium,
    /// The freedoms are no coordinates at a pose.
    #[error(
        "the equilibrium is at a dead point of the freedoms' coordinates, which are no states there; \
         give the freedoms other coordinates"
    )]
    DeadPoint,
    /// The integrator finds no step.
    #[error("the free motion cannot go on: {0}")]
    Integrator(String),
}

impl Error {
    /// Returns the error of a budget that is spent at a time, without events.
    pub(super) fn spent(most: u32, time: f64) -> Self {
        Self::Spent {
            most,
            time,
            events: 0,
        }
    }
}

impl From<integrator::Error<Self>> for Error {
    fn from(error: integrator::Error<Self>) -> Self {
        match error {
            integrator::Error::Stopped { cause, .. } => cause,
            integrator::Error::Stuck {
                reason: integrator::Reason::Failed(cause),
                ..
            }
            | integrator::Error::NoDerivatives {
                reason: integrator::Reason::Failed(cause),
                ..
            } => cause,
            other => Self::Integrator(other.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Error;

    #[test]
    fn endless_impacts_name_what_is_struck() {
        let error = Error::EndlessImpacts {
            time: 0.25,
            contacts: ["stop `wall`", "joint `mesh`"].map(str::to_owned).into(),
        };
        assert_eq!(
            error.to_string(),
            "t = 0.250000000 s: the free motion cannot go on: impacts at one instant come to no end, \
             at stop `wall`, joint `mesh`"
        );
    }
}

//! How far a path was followed, and why not further.

use crate::kinematics::Error;
use crate::kinematics::error::OpenJoint;
use crate::kinematics::singular::SingularPoint;

/// Why a path could not be followed to its end.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// The Jacobian loses rank ahead: a dead point, or what is not crossed.
    Singular(Box<SingularPoint>),
    /// No continuous motion was found to lead on, nor a singular position: the motion jumps, or
    /// the part of the mechanism that stops is too large or moved by parameters.
    Lost,
    /// A value on the way is one for which the mechanism does not exist.
    Value(Error),
    /// Beyond here a constraint that was redundant so far contradicts the others: what it would
    /// be open by where it first was found open.
    Contradiction(OpenJoint),
    /// The path asks for more sub-steps than anyone would wait for.
    TooLong,
}

/// What following a path took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Newton corrections: the most that any part of the mechanism needed, summed over the
    /// sub-steps that succeeded.
    pub iterations: u32,
    /// Sub-steps, failed ones included; one for an ordinary step.
    pub substeps: u32,
    /// Change points passed; [`Solver::crossed`](crate::kinematics::Solver::crossed) has them.
    pub crossings: u32,
    /// How many of those that succeeded are *checked*, not proved: that one continuous motion
    /// joins their ends rests on an estimate. So it is for blocks of more than 32 torn unknowns,
    /// and while parameters move those of relations without straight code, or a motion's table.
    pub checked: u32,
}

/// The path could not be followed to its end: a dead point is in the way, or values for which
/// the mechanism does not exist.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocked {
    /// How far the mechanism came, from 0 to 1. It stands there.
    pub s: f64,
    /// What is in the way.
    pub reason: Reason,
    /// What it took.
    pub progress: Progress,
}

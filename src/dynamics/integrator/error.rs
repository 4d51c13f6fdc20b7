//! Failures of an evaluation, of a step and of the input.

use std::fmt::{Debug, Display};

/// An evaluation that gave no derivatives, with its cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure<C> {
    /// There are none at this trial point: the integrator tries a shorter step.
    Trial(C),
    /// No shorter step helps: the integrator returns [`Error::Stopped`].
    Hard(C),
    /// The step must end at this time or before, later than its start: an event lies there \[s\].
    Cut(f64),
    /// An event may lie between its ends: the integrator tries a shorter step.
    Unclear,
}

/// Reason for the refusal of a trial step.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Reason<C: Debug + Display> {
    /// The system failed at a trial point.
    #[error("{0}")]
    Failed(C),
    /// A derivative or the solution is infinite or not a number.
    #[error("the derivatives are not finite")]
    NotFinite,
    /// The error estimate is above the tolerance.
    #[error("the estimated error is {0:.3e} times the tolerance")]
    Inaccurate(f64),
    /// The matrix of the stiff method is singular.
    #[error("the matrix of the stiff method is singular")]
    Singular,
    /// An event may lie between the ends.
    #[error("events follow each other too fast")]
    Unclear,
}

/// A step that could not be made. The state stays at the last accepted step; the proposed step
/// keeps the last length tried.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error<C: Debug + Display> {
    /// The system reported a hard failure.
    #[error("the integration stopped at t = {t} s: {cause}")]
    Stopped {
        /// Time of the last accepted step \[s\].
        t: f64,
        /// The system's cause.
        cause: C,
    },
    /// Every trial step was refused, down to the smallest step or the largest number of trials.
    #[error("no step leads on from t = {t} s; the last of {trials} was {h:e} s long: {reason}")]
    Stuck {
        /// Time of the last accepted step \[s\].
        t: f64,
        /// Length of the last trial step \[s\].
        h: f64,
        /// Number of trial steps in a row.
        trials: u32,
        /// Reason for the last refusal.
        reason: Reason<C>,
    },
    /// There are no derivatives at a point that no shorter step can change: the start, or a stage
    /// of the dense output.
    #[error("there are no derivatives at t = {t} s: {reason}")]
    NoDerivatives {
        /// Time of the start, or of the end of the step with dense output \[s\].
        t: f64,
        /// Reason for the refusal.
        reason: Reason<C>,
    },
    /// Dense output was asked for before a step.
    #[error("there is no step to interpolate")]
    NoStep,
    /// The time to integrate to is not finite.
    #[error("the integration cannot end at {until} s")]
    Until {
        /// The time given \[s\].
        until: f64,
    },
}

/// An option or a state that cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Invalid {
    /// A tolerance outside of 0 to 1.
    #[error("the tolerance must be above 0 and below 1, not {0}")]
    Tolerance(f64),
    /// A scale that is not positive.
    #[error("scale {component} must be positive, not {scale}")]
    Scale {
        /// Index of the component.
        component: usize,
        /// The scale given.
        scale: f64,
    },
    /// A state of another size.
    #[error("the state has {given} components, not {expected}")]
    Length {
        /// Number of components given.
        given: usize,
        /// Number of scales.
        expected: usize,
    },
    /// A number that is not finite, or a step that is negative.
    #[error("the state has impossible numbers")]
    Number,
}

/// A trial step that was refused.
#[derive(Debug)]
pub(super) enum Refusal<C: Debug + Display> {
    /// A shorter step may succeed.
    Retry(Reason<C>),
    /// No step can succeed.
    Stop(C),
    /// The step must end at this time or before \[s\].
    Cut(f64),
}

impl<C: Debug + Display> Refusal<C> {
    /// Returns the error at a point that no shorter step can change.
    pub(super) fn at(self, t: f64) -> Error<C> {
        match self {
            Self::Retry(reason) => Error::NoDerivatives { t, reason },
            Self::Stop(cause) => Error::Stopped { t, cause },
            Self::Cut(_) => unreachable!("only steps are cut"),
        }
    }
}

impl<C: Debug + Display> From<Failure<C>> for Refusal<C> {
    fn from(failure: Failure<C>) -> Self {
        match failure {
            Failure::Trial(cause) => Self::Retry(Reason::Failed(cause)),
            Failure::Hard(cause) => Self::Stop(cause),
            Failure::Cut(time) => Self::Cut(time),
            Failure::Unclear => Self::Retry(Reason::Unclear),
        }
    }
}

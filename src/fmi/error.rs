//! Errors of calls.

use super::UriError;
use super::log::Category;
use super::package::LIBRARY_MARK;
use super::state::{Interface, State, Version};
use super::status::Status;
use crate::mechanism::shown;

/// A model's request failed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Failure {
    /// Not possible from here; the host may continue another way.
    #[error("{0}")]
    Discarded(String),
    /// Not possible at all.
    #[error("{0}")]
    Failed(String),
    /// Ended at an event, where the host handles [events](super::Model::end_steps_at_events).
    #[error("the step ends at an event")]
    Event,
}

/// A call was refused or failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An argument of a C function is unusable.
    #[error("`{name}` {why}")]
    Argument {
        /// The argument.
        name: &'static str,
        /// The fault, as the end of a sentence.
        why: String,
    },
    /// The call belongs to the other interface.
    #[error("not for {interface}, for which this instance was made")]
    Interface {
        /// The instance's interface.
        interface: Interface,
    },
    /// The call is not allowed in the present state.
    #[error("not allowed in state {state}, only in {}", list(allowed))]
    State {
        /// The present state.
        state: State,
        /// The states that allow the call.
        allowed: Vec<State>,
    },
    /// No variable has this value reference.
    #[error("there is no variable with value reference {value_reference}; expected 1 to {last}")]
    ValueReference {
        /// The value reference.
        value_reference: u32,
        /// The highest value reference.
        last: usize,
    },
    /// The variable has another type.
    #[error("`{name}` is {actual}, not {expected}")]
    Type {
        /// The variable.
        name: String,
        /// Its type.
        actual: &'static str,
        /// The type of the call.
        expected: &'static str,
    },
    /// The variable cannot be set, or not in this state.
    #[error("`{name}` cannot be set: it is {why}")]
    NotSettable {
        /// The variable.
        name: String,
        /// The reason, as a predicate.
        why: &'static str,
    },
    /// The value is NaN or infinite.
    #[error("`{name}` is {}: expected a finite number", shown(*.value))]
    NotFinite {
        /// The variable or argument.
        name: String,
        /// The value.
        value: f64,
    },
    /// The value is outside `min` and `max`.
    #[error("`{name}` cannot be set to {}: expected {}", shown(*.value), range(*.min, *.max))]
    Range {
        /// The variable.
        name: String,
        /// The value.
        value: f64,
        /// Smallest permitted value.
        min: Option<f64>,
        /// Largest permitted value.
        max: Option<f64>,
    },
    /// The value is no item of the enumeration.
    #[error("`{name}` cannot be set to {value}: expected 1 to {count}")]
    Item {
        /// The variable.
        name: String,
        /// The value.
        value: i64,
        /// The number of items.
        count: usize,
    },
    /// Inputs have derivatives of order 1 and 2 only.
    #[error("`{name}`: input derivatives of order {order} are not known; expected 1 or 2")]
    DerivativeOrder {
        /// The variable.
        name: String,
        /// The order.
        order: i32,
    },
    /// Only outputs have output derivatives.
    #[error("`{name}` is no output, and only outputs have output derivatives")]
    NotOutput {
        /// The variable.
        name: String,
    },
    /// Output derivatives have orders from 1 to `maxOutputDerivativeOrder`.
    #[error("`{name}`: an output derivative cannot be of order {order}; expected 1 to {highest}")]
    OutputDerivativeOrder {
        /// The output.
        name: String,
        /// The order.
        order: i32,
        /// The highest order.
        highest: i32,
    },
    /// The variable is no unknown or known of directional derivatives in this state.
    #[error("`{name}`: {role}")]
    NoDerivative {
        /// The variable.
        name: String,
        /// The permitted variables.
        role: &'static str,
    },
    /// The variable has no start value, and nothing is computed before initialization mode.
    #[error("`{name}` has no value before initialization mode")]
    NoStart {
        /// The variable.
        name: String,
    },
    /// Values were set in step mode, and outputs belong to them after the next step only.
    #[error(
        "`{name}` cannot be read after values were set: outputs belong to them after the next \
         step; in event mode they can be read at once"
    )]
    NotStepped {
        /// The variable.
        name: String,
    },
    /// The host did not announce the variable for intermediate update.
    #[error(
        "`{name}` is not among the required intermediate variables of the instance, or is no \
         continuous input or output"
    )]
    NotIntermediate {
        /// The variable.
        name: String,
    },
    /// A variable was read after one was set at the same point of intermediate update.
    #[error("variables are read before others are set in intermediate update")]
    ReadAfterSet,
    /// The call belongs to a capability that the FMU does not have.
    #[error("{why}")]
    NotProvided {
        /// The reason.
        why: &'static str,
    },
    /// The lists of a call do not fit each other.
    #[error("`{name}` is {given} for {expected} scalar variables")]
    Count {
        /// The argument.
        name: &'static str,
        /// The number of values.
        given: usize,
        /// The number of variables or dependencies.
        expected: usize,
    },
    /// The step was given up, since a call in intermediate update had failed.
    #[error("a call during intermediate update has failed")]
    StepAborted,
    /// The status function does not know this kind.
    #[error("this function has no status of kind {kind} while no step is pending")]
    StatusKind {
        /// The number of the kind.
        kind: u32,
    },
    /// The model has another number of continuous states or event indicators.
    #[error("called for {given} values, and there are {}", if *.expected == 0 { "none".to_owned() } else { .expected.to_string() })]
    Continuous {
        /// The number of values.
        given: usize,
        /// The number of states or indicators.
        expected: usize,
    },
    /// A communication point, step size, time or stop time is impossible.
    #[error("{message}")]
    Time {
        /// The whole message.
        message: String,
    },
    /// The name is no log category.
    #[error("there is no log category `{name}`; expected {}", categories())]
    LogCategory {
        /// The name.
        name: String,
    },
    /// The model failed or discards the call.
    #[error(transparent)]
    Model(#[from] Failure),
    /// The resource location is no folder on this machine.
    #[error(transparent)]
    Uri(#[from] UriError),
    /// The bytes or the state do not belong to this FMU.
    #[error(transparent)]
    FmuState(#[from] StateError),
    /// The resources do not belong to the model description.
    #[error(
        "the GUID `{given}` is not the GUID `{actual}` of the model in the FMU's resources: the \
         model description and the resources do not belong together {LIBRARY_MARK}"
    )]
    Guid {
        /// GUID from the host.
        given: String,
        /// GUID of the model.
        actual: String,
    },
}

impl Error {
    /// Returns the status of a call with this error.
    #[must_use]
    pub fn status(&self) -> Status {
        match self {
            Self::Model(Failure::Discarded(_))
            | Self::Range { .. }
            | Self::Item { .. }
            | Self::StatusKind { .. } => Status::Discard,
            _ => Status::Error,
        }
    }
}

/// Bytes are no state of this FMU, or a state does not fit this instance.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// The bytes do not start like a serialized state.
    #[error("these {length} bytes are no serialized FMU state of biela")]
    Foreign {
        /// The number of bytes.
        length: usize,
    },
    /// Another version of biela wrote the bytes.
    #[error("the serialized FMU state has version {given}; this FMU reads version {expected}")]
    Version {
        /// Version of the bytes.
        given: u32,
        /// Version that this FMU reads.
        expected: u32,
    },
    /// Bytes are missing or were appended.
    #[error(
        "the serialized FMU state was {announced} bytes long when it was written and is {given} now"
    )]
    Length {
        /// Length that the bytes announce.
        announced: u64,
        /// Actual length.
        given: usize,
    },
    /// The bytes were altered.
    #[error("the serialized FMU state was altered: its checksum does not fit")]
    Checksum,
    /// The state belongs to another model.
    #[error("the FMU state belongs to the FMU with GUID `{given}`; this FMU has `{expected}`")]
    Guid {
        /// GUID in the state.
        given: String,
        /// GUID of this FMU.
        expected: String,
    },
    /// The state belongs to an instance of another version of the standard.
    #[error("the FMU state belongs to an instance of {given}; this one is of {expected}")]
    Standard {
        /// Version of the state.
        given: Version,
        /// Version of the instance.
        expected: Version,
    },
    /// The state belongs to an instance that uses event mode; this one does not.
    #[error("the FMU state is in event mode, which this instance does not use")]
    EventMode,
    /// The state belongs to the other interface.
    #[error("the FMU state belongs to an instance for {given}; this one is for {expected}")]
    Interface {
        /// Interface of the state.
        given: Interface,
        /// Interface of the instance.
        expected: Interface,
    },
    /// The checksum is right, but no instance can be in this state.
    #[error("no instance can be in the serialized FMU state: {why}")]
    Impossible {
        /// The reason.
        why: String,
    },
    /// The host's array has another size than the state.
    #[error("the serialized FMU state takes {needed} bytes, and there is room for {given}")]
    Room {
        /// Size of the state.
        needed: usize,
        /// Size of the array.
        given: usize,
    },
}

fn list(states: &[State]) -> String {
    let names: Vec<_> = states.iter().map(State::to_string).collect();
    names.join(", ")
}

fn categories() -> String {
    let names = Category::ALL.map(|(category, _)| category.name());
    names.join(", ")
}

fn range(min: Option<f64>, max: Option<f64>) -> String {
    match (min, max) {
        (Some(min), Some(max)) => format!("{} to {}", shown(min), shown(max)),
        (Some(min), None) => format!("at least {}", shown(min)),
        (None, Some(max)) => format!("at most {}", shown(max)),
        (None, None) => "any number".to_owned(),
    }
}

/// Checks a value of a Real with these limits.
pub fn check_limits(name: &str, value: f64, [min, max]: [Option<f64>; 2]) -> Result<(), Error> {
    check_finite(name, value)?;
    if min.is_some_and(|min| value < min) || max.is_some_and(|max| value > max) {
        return Err(Error::Range {
            name: name.to_owned(),
            value,
            min,
            max,
        });
    }
    Ok(())
}

/// Checks that a value is finite.
pub(super) fn check_finite(name: &str, value: f64) -> Result<(), Error> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(Error::NotFinite {
            name: name.to_owned(),
            value,
        })
    }
}

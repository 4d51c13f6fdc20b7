//! How calls end, and why they are refused.

use super::UriError;
use super::log::Category;
use super::state::{Call, Interface, State};
use crate::mechanism::shown;

/// How a call ended, in the order of `fmi2Status`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// All well.
    Ok = 0,
    /// All well, and something to say.
    Warning = 1,
    /// Not possible from here; the host may go on another way.
    Discard = 2,
    /// Refused or failed.
    Error = 3,
    /// A defect: the instance is lost.
    Fatal = 4,
}

/// Why a model could not do what was asked of it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Failure {
    /// It cannot be done from here; the host may go on another way. The model has given a
    /// warning to the log that says why, so that hosts with default settings show it.
    #[error("{0}")]
    Discarded(String),
    /// It cannot be done at all.
    #[error("{0}")]
    Failed(String),
}

/// Why a call was refused or failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The call belongs to the other interface.
    #[error("not for {interface}, for which this instance was made")]
    Interface {
        /// The call.
        call: Call,
        /// That of the instance.
        interface: Interface,
    },
    /// The call is not allowed in the present state.
    #[error("not allowed in state {state}, only in {}", states(call.allowed_in(*interface)))]
    State {
        /// The call.
        call: Call,
        /// The instance's interface.
        interface: Interface,
        /// The present state.
        state: State,
    },
    /// No variable has this value reference.
    #[error("there is no variable with value reference {value_reference}; the last one is {last}")]
    ValueReference {
        /// The value reference.
        value_reference: u32,
        /// The highest one there is.
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
    /// The variable cannot be set, or not now.
    #[error("`{name}` cannot be set: it is {why}")]
    NotSettable {
        /// The variable.
        name: String,
        /// Why.
        why: &'static str,
    },
    /// NaN or infinity.
    #[error("`{name}` is {}: expected a finite number", shown(*.value))]
    NotFinite {
        /// The variable or argument.
        name: String,
        /// The value.
        value: f64,
    },
    /// Outside `min` and `max`.
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
    /// Not an item of the enumeration.
    #[error("`{name}` cannot be set to {value}: expected 1 to {count}")]
    Item {
        /// The variable.
        name: String,
        /// The value.
        value: i32,
        /// The number of items.
        count: usize,
    },
    /// An order of derivative that inputs do not have.
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
    /// An order of derivative that nothing has.
    #[error("`{name}`: an output derivative cannot be of order {order}; expected 1 or more")]
    OutputDerivativeOrder {
        /// The output.
        name: String,
        /// The order.
        order: i32,
    },
    /// A derivative that this output does not have.
    #[error("`{name}` has no derivative of order {order}")]
    NoOutputDerivative {
        /// The output.
        name: String,
        /// The order.
        order: i32,
    },
    /// A variable that directional derivatives are not taken of, or not by, or not now.
    #[error(
        "`{name}`: {role}, in initialization mode of calculated parameters and by parameters as \
         well"
    )]
    NoDerivative {
        /// The variable.
        name: String,
        /// What there are derivatives of, or by what.
        role: &'static str,
    },
    /// A kind of status that a status function does not tell.
    #[error("status kind {kind} is not told by this function, or not while no step is pending")]
    StatusKind {
        /// The number of the kind.
        kind: i64,
    },
    /// More continuous states or event indicators than there are.
    #[error("{call} was called for {given} of them; there are none", call = call.name())]
    Continuous {
        /// The call.
        call: Call,
        /// How many it was called for.
        given: usize,
    },
    /// A communication point, step size or stop time that makes no sense.
    #[error("{message}")]
    Time {
        /// What is wrong and what would be right.
        message: String,
    },
    /// A name that is no log category.
    #[error("there is no log category `{name}`; expected {}", categories())]
    LogCategory {
        /// The name.
        name: String,
    },
    /// The model failed, or discards what was asked.
    #[error(transparent)]
    Model(#[from] Failure),
    /// The resource location is no folder of this machine.
    #[error(transparent)]
    Uri(#[from] UriError),
    /// Bytes or a state that are none of this FMU.
    #[error(transparent)]
    FmuState(#[from] StateError),
    /// The resources are not those that the model description was made from.
    #[error(
        "the GUID `{given}` is not that of the model in the FMU's resources, `{actual}`: the \
         model description and the resources do not belong together"
    )]
    Guid {
        /// What the host gave.
        given: String,
        /// That of the model.
        actual: String,
    },
}

impl Error {
    /// The status that a call returns with this error.
    #[must_use]
    pub fn status(&self) -> Status {
        match self {
            Self::Model(Failure::Discarded(_))
            | Self::NoOutputDerivative { .. }
            | Self::StatusKind { .. } => Status::Discard,
            _ => Status::Error,
        }
    }
}

/// Why bytes are no FMU state of this FMU, or a state none of this instance.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// They do not begin like one.
    #[error("these {length} bytes are no serialized FMU state of biela")]
    Foreign {
        /// How many there are.
        length: usize,
    },
    /// Another biela wrote them.
    #[error("the serialized FMU state has version {given}; this FMU reads version {expected}")]
    Version {
        /// The version of the bytes.
        given: u32,
        /// The one that can be read.
        expected: u32,
    },
    /// Too few or too many.
    #[error(
        "the serialized FMU state was {announced} bytes long when it was written and is {given} now"
    )]
    Length {
        /// As the bytes say.
        announced: u64,
        /// As they are.
        given: usize,
    },
    /// They are not as they were written.
    #[error("the serialized FMU state was altered: its checksum does not fit")]
    Checksum,
    /// They belong to another model.
    #[error("the FMU state is of the FMU with GUID `{given}`, not of this one, `{expected}`")]
    Guid {
        /// The GUID in the state.
        given: String,
        /// That of this FMU.
        expected: String,
    },
    /// It belongs to the other interface.
    #[error("the FMU state is of an instance for {given}, and this one is for {expected}")]
    Interface {
        /// That of the state.
        given: Interface,
        /// That of the instance.
        expected: Interface,
    },
    /// Their checksum fits, but they describe no state that an instance could be in.
    #[error("the serialized FMU state is none that an instance could be in: {what}")]
    Impossible {
        /// What is wrong.
        what: String,
    },
    /// There is not the room that the state takes.
    #[error("the serialized FMU state takes {needed} bytes, and there is room for {given}")]
    Room {
        /// The size of the state.
        needed: usize,
        /// The room there is.
        given: usize,
    },
}

fn states(states: &[State]) -> String {
    let names: Vec<_> = states.iter().map(State::to_string).collect();
    names.join(", ")
}

fn categories() -> String {
    Category::ALL
        .map(|(category, _)| category.name())
        .join(", ")
}

fn range(min: Option<f64>, max: Option<f64>) -> String {
    match (min, max) {
        (Some(min), Some(max)) => format!("{} to {}", shown(min), shown(max)),
        (Some(min), None) => format!("at least {}", shown(min)),
        (None, Some(max)) => format!("at most {}", shown(max)),
        (None, None) => "any number".to_owned(),
    }
}

/// Refuses what a Real with these limits cannot be.
pub(crate) fn check_limits(
    name: &str,
    value: f64,
    [min, max]: [Option<f64>; 2],
) -> Result<(), Error> {
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

/// Refuses NaN and infinity.
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

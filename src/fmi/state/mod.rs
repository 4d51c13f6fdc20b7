//! The states of an instance and the calls allowed in each.
//!
//! | file | subject |
//! |---|---|
//! | `fmi2` | calls of FMI 2.0 (3.2.3 and 4.2.4) |
//! | `fmi3` | calls of FMI 3.0 (2.3, 3.2 and 4.2) |

mod fmi2;
mod fmi3;

use std::fmt;

/// Declares an enumeration, its list of values, and their names.
macro_rules! named {
    ($(#[$doc:meta])* $enum:ident { $($(#[$of_value:meta])* $value:ident = $name:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $enum {
            $($(#[$of_value])* $value,)*
        }

        impl $enum {
            /// All values.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$value),*];
        }

        impl fmt::Display for $enum {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self {
                    $(Self::$value => $name,)*
                })
            }
        }
    };
}

named! {
    /// Version of the standard.
    Version {
        /// FMI 2.0.
        Fmi2 = "FMI 2.0",
        /// FMI 3.0.
        Fmi3 = "FMI 3.0",
    }
}

named! {
    /// One of the two interfaces of an FMU.
    Interface {
        /// The host integrates and evaluates the model at any time.
        ModelExchange = "model exchange",
        /// The model steps from one communication point to the next.
        CoSimulation = "co-simulation",
    }
}

named! {
    /// A state of an instance.
    State {
        /// After instantiation or reset.
        Instantiated = "instantiated",
        /// Between entering and exiting initialization mode.
        InitializationMode = "initializationMode",
        /// Discrete values may change at a fixed time: model exchange and, in FMI 3.0,
        /// co-simulation.
        EventMode = "eventMode",
        /// Model exchange: the host integrates.
        ContinuousTimeMode = "continuousTimeMode",
        /// Co-simulation of FMI 3.0: ready for the next step.
        StepMode = "stepMode",
        /// Co-simulation of FMI 3.0: a step has called back at a point on its way.
        IntermediateUpdateMode = "intermediateUpdateMode",
        /// Co-simulation of FMI 2.0: ready for the next step.
        StepComplete = "stepComplete",
        /// Co-simulation: a step is under way. Never entered: `fmi2DoStep` returns at its end.
        StepInProgress = "stepInProgress",
        /// Co-simulation: the last step was discarded.
        StepFailed = "stepFailed",
        /// Co-simulation: the host has cancelled a step. Never entered, like `StepInProgress`.
        StepCanceled = "stepCanceled",
        /// After termination; in FMI 3.0 also after a call that has failed.
        Terminated = "terminated",
        /// Initialization failed in FMI 2.0; the host may read, reset, set an FMU state or free the
        /// instance.
        Error = "error",
        /// A defect was caught; the host may free the instance.
        Fatal = "fatal",
    }
}

impl State {
    /// Returns the phase of the model in this state.
    #[inline]
    pub(super) fn phase(self, interface: Interface) -> Phase {
        match self {
            Self::Instantiated | Self::InitializationMode => Phase::Initialization,
            Self::EventMode if interface == Interface::CoSimulation => Phase::Event,
            Self::EventMode
            | Self::ContinuousTimeMode
            | Self::StepMode
            | Self::IntermediateUpdateMode
            | Self::StepComplete => Phase::Running,
            _ => Phase::Halted,
        }
    }
}

/// Phase of a model, derived from its instance's state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The host sets start values.
    Initialization,
    /// The model goes on from the committed point.
    Running,
    /// Values may jump between two steps of co-simulation.
    Event,
    /// The host can set nothing; values belong to the committed point.
    Halted,
}

/// Declares the calls.
macro_rules! calls {
    ($($call:ident)*) => {
        /// A function of the C interfaces that is allowed in some states only, by the end of its name
        /// in FMI 2.0.
        ///
        /// Functions of FMI 3.0 under another name: `fmi3GetFloat64` and `fmi3SetFloat64` are
        /// `GetReal` and `SetReal`, those of Int64 `GetInteger` and `SetInteger`,
        /// `fmi3UpdateDiscreteStates` is `NewDiscreteStates`, `fmi3GetContinuousStateDerivatives`
        /// is `GetDerivatives`, and `fmi3GetOutputDerivatives` `GetRealOutputDerivatives`.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Call {
            $(#[doc = concat!("`", stringify!($call), "`.")] $call,)*
        }

        impl Call {
            /// All calls.
            pub const ALL: &'static [Self] = &[$(Self::$call),*];
        }
    };
}

calls! {
    SetDebugLogging SetupExperiment EnterInitializationMode ExitInitializationMode Terminate
    Reset GetReal GetInteger GetBoolean GetString SetReal SetInteger SetBoolean SetString
    GetFMUstate SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate
    DeSerializeFMUstate GetDirectionalDerivative EnterEventMode NewDiscreteStates
    EnterContinuousTimeMode CompletedIntegratorStep SetTime SetContinuousStates
    GetDerivatives GetEventIndicators GetContinuousStates GetNominalsOfContinuousStates
    SetRealInputDerivatives GetRealOutputDerivatives DoStep CancelStep GetStatus
    GetRealStatus GetIntegerStatus GetBooleanStatus GetStringStatus GetFloat32 SetFloat32
    GetInt8 SetInt8 GetUInt8 SetUInt8 GetInt16 SetInt16 GetUInt16 SetUInt16 GetInt32
    SetInt32 GetUInt32 SetUInt32 GetUInt64 SetUInt64 GetBinary SetBinary GetClock SetClock
    GetNumberOfVariableDependencies GetVariableDependencies GetAdjointDerivative
    EnterConfigurationMode ExitConfigurationMode GetIntervalDecimal GetIntervalFraction
    GetShiftDecimal GetShiftFraction SetIntervalDecimal SetIntervalFraction SetShiftDecimal
    SetShiftFraction EvaluateDiscreteStates GetNumberOfEventIndicators
    GetNumberOfContinuousStates EnterStepMode ActivateModelPartition
}

/// Sets of states that allow each call, one bit per state: every call looks here, and a bit is
/// quicker than a list.
pub(super) type Allowed = [u16; Call::ALL.len()];

/// Returns the calls that each state of an instance allows.
pub(super) fn allowed(version: Version, interface: Interface) -> &'static Allowed {
    let of_version = match version {
        Version::Fmi2 => &fmi2::ALLOWED,
        Version::Fmi3 => &fmi3::ALLOWED,
    };
    &of_version[interface as usize]
}

impl Call {
    /// Returns the states that allow the call; none if it belongs to the other interface or to
    /// another version.
    #[must_use]
    pub fn allowed_in(self, version: Version, interface: Interface) -> Vec<State> {
        let is_allowed = |state: &State| self.is_allowed_in(version, interface, *state);
        State::ALL.into_iter().filter(is_allowed).collect()
    }

    /// Returns whether a state allows the call.
    #[must_use]
    pub fn is_allowed_in(self, version: Version, interface: Interface, state: State) -> bool {
        is_allowed(allowed(version, interface), self, state)
    }

    /// Returns whether the call may end with a discard: in FMI 2.0 some calls (2.1.3), in FMI 3.0
    /// all (2.2.4).
    #[must_use]
    pub fn may_discard(self, version: Version, interface: Interface) -> bool {
        version == Version::Fmi3 || fmi2::may_discard(self, interface)
    }
}

/// Returns whether a state allows a call.
#[inline]
pub(super) fn is_allowed(allowed: &Allowed, call: Call, state: State) -> bool {
    allowed[call as usize] >> state as u16 & 1 != 0
}

/// Defines the table of one version: calls, and the states that allow them in model exchange and in
/// co-simulation.
macro_rules! table {
    ($($($call:ident)+: [$($me:ident)*] [$($cs:ident)*];)*) => {
        /// Sets of states by interface.
        pub(super) static ALLOWED: [Allowed; 2] = {
            let mut allowed = [[0; Call::ALL.len()]; 2];
            $(
                let exchange = 0 $(| 1 << State::$me as u16)*;
                let co_simulation = 0 $(| 1 << State::$cs as u16)*;
                $(
                    allowed[Interface::ModelExchange as usize][Call::$call as usize] = exchange;
                    allowed[Interface::CoSimulation as usize][Call::$call as usize] =
                        co_simulation;
                )+
            )*
            allowed
        };
    };
}
use table;

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

/// Declares the calls with the names of their C functions.
macro_rules! calls {
    ($($call:ident = $first:ident $(| $second:ident)?;)*) => {
        /// A function of the C interfaces that is allowed in some states only.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Call {
            $(#[doc = concat!("`", stringify!($first), "`" $(, ", `", stringify!($second), "`")?)]
            $call,)*
        }

        impl Call {
            /// All calls.
            pub const ALL: &'static [Self] = &[$(Self::$call),*];

            /// Returns the names of the C functions, at most one of each version.
            const fn functions(self) -> &'static [&'static str] {
                match self {
                    $(Self::$call => &[stringify!($first) $(, stringify!($second))?],)*
                }
            }
        }
    };
}

calls! {
    SetDebugLogging = fmi2SetDebugLogging | fmi3SetDebugLogging;
    SetupExperiment = fmi2SetupExperiment;
    EnterInitializationMode = fmi2EnterInitializationMode | fmi3EnterInitializationMode;
    ExitInitializationMode = fmi2ExitInitializationMode | fmi3ExitInitializationMode;
    Terminate = fmi2Terminate | fmi3Terminate;
    Reset = fmi2Reset | fmi3Reset;
    GetReal = fmi2GetReal | fmi3GetFloat64;
    GetInteger = fmi2GetInteger | fmi3GetInt64;
    GetBoolean = fmi2GetBoolean | fmi3GetBoolean;
    GetString = fmi2GetString | fmi3GetString;
    SetReal = fmi2SetReal | fmi3SetFloat64;
    SetInteger = fmi2SetInteger | fmi3SetInt64;
    SetBoolean = fmi2SetBoolean | fmi3SetBoolean;
    SetString = fmi2SetString | fmi3SetString;
    GetFMUstate = fmi2GetFMUstate | fmi3GetFMUState;
    SetFMUstate = fmi2SetFMUstate | fmi3SetFMUState;
    FreeFMUstate = fmi2FreeFMUstate | fmi3FreeFMUState;
    SerializedFMUstateSize = fmi2SerializedFMUstateSize | fmi3SerializedFMUStateSize;
    SerializeFMUstate = fmi2SerializeFMUstate | fmi3SerializeFMUState;
    DeSerializeFMUstate = fmi2DeSerializeFMUstate | fmi3DeserializeFMUState;
    GetDirectionalDerivative = fmi2GetDirectionalDerivative | fmi3GetDirectionalDerivative;
    EnterEventMode = fmi2EnterEventMode | fmi3EnterEventMode;
    NewDiscreteStates = fmi2NewDiscreteStates | fmi3UpdateDiscreteStates;
    EnterContinuousTimeMode = fmi2EnterContinuousTimeMode | fmi3EnterContinuousTimeMode;
    CompletedIntegratorStep = fmi2CompletedIntegratorStep | fmi3CompletedIntegratorStep;
    SetTime = fmi2SetTime | fmi3SetTime;
    SetContinuousStates = fmi2SetContinuousStates | fmi3SetContinuousStates;
    GetDerivatives = fmi2GetDerivatives | fmi3GetContinuousStateDerivatives;
    GetEventIndicators = fmi2GetEventIndicators | fmi3GetEventIndicators;
    GetContinuousStates = fmi2GetContinuousStates | fmi3GetContinuousStates;
    GetNominalsOfContinuousStates =
        fmi2GetNominalsOfContinuousStates | fmi3GetNominalsOfContinuousStates;
    SetRealInputDerivatives = fmi2SetRealInputDerivatives;
    GetRealOutputDerivatives = fmi2GetRealOutputDerivatives | fmi3GetOutputDerivatives;
    DoStep = fmi2DoStep | fmi3DoStep;
    CancelStep = fmi2CancelStep;
    GetStatus = fmi2GetStatus;
    GetRealStatus = fmi2GetRealStatus;
    GetIntegerStatus = fmi2GetIntegerStatus;
    GetBooleanStatus = fmi2GetBooleanStatus;
    GetStringStatus = fmi2GetStringStatus;
    GetFloat32 = fmi3GetFloat32;
    SetFloat32 = fmi3SetFloat32;
    GetInt8 = fmi3GetInt8;
    SetInt8 = fmi3SetInt8;
    GetUInt8 = fmi3GetUInt8;
    SetUInt8 = fmi3SetUInt8;
    GetInt16 = fmi3GetInt16;
    SetInt16 = fmi3SetInt16;
    GetUInt16 = fmi3GetUInt16;
    SetUInt16 = fmi3SetUInt16;
    GetInt32 = fmi3GetInt32;
    SetInt32 = fmi3SetInt32;
    GetUInt32 = fmi3GetUInt32;
    SetUInt32 = fmi3SetUInt32;
    GetUInt64 = fmi3GetUInt64;
    SetUInt64 = fmi3SetUInt64;
    GetBinary = fmi3GetBinary;
    SetBinary = fmi3SetBinary;
    GetClock = fmi3GetClock;
    SetClock = fmi3SetClock;
    GetNumberOfVariableDependencies = fmi3GetNumberOfVariableDependencies;
    GetVariableDependencies = fmi3GetVariableDependencies;
    GetAdjointDerivative = fmi3GetAdjointDerivative;
    EnterConfigurationMode = fmi3EnterConfigurationMode;
    ExitConfigurationMode = fmi3ExitConfigurationMode;
    GetIntervalDecimal = fmi3GetIntervalDecimal;
    GetIntervalFraction = fmi3GetIntervalFraction;
    GetShiftDecimal = fmi3GetShiftDecimal;
    GetShiftFraction = fmi3GetShiftFraction;
    SetIntervalDecimal = fmi3SetIntervalDecimal;
    SetIntervalFraction = fmi3SetIntervalFraction;
    SetShiftDecimal = fmi3SetShiftDecimal;
    SetShiftFraction = fmi3SetShiftFraction;
    EvaluateDiscreteStates = fmi3EvaluateDiscreteStates;
    GetNumberOfEventIndicators = fmi3GetNumberOfEventIndicators;
    GetNumberOfContinuousStates = fmi3GetNumberOfContinuousStates;
    EnterStepMode = fmi3EnterStepMode;
    ActivateModelPartition = fmi3ActivateModelPartition;
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
    /// Returns the name of the C function; that of the other version if this one has none.
    #[must_use]
    pub fn name(self, version: Version) -> &'static str {
        self.function(version).unwrap_or(self.functions()[0])
    }

    /// Returns the name of the C function of one version.
    fn function(self, version: Version) -> Option<&'static str> {
        let prefix = match version {
            Version::Fmi2 => "fmi2",
            Version::Fmi3 => "fmi3",
        };
        let mut functions = self.functions().iter().copied();
        functions.find(|function| function.starts_with(prefix))
    }

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

#[cfg(test)]
mod tests {
    use super::{Call, Interface, Version};

    #[test]
    fn every_call_that_a_version_allows_has_a_function_of_it() {
        for version in Version::ALL {
            for &call in Call::ALL {
                let is_allowed = |interface| !call.allowed_in(version, interface).is_empty();
                let is_known = Interface::ALL.into_iter().any(is_allowed);
                assert!(
                    !is_known || call.function(version).is_some(),
                    "{version}, {call:?}"
                );
            }
        }
    }
}

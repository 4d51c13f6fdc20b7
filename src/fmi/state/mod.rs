//! The states of an instance and the calls allowed in each.
//!
//! | file | subject |
//! |---|---|
//! | `fmi2` | calls of FMI 2.0 (3.2.3 and 4.2.4) |
//! | `fmi3` | calls of FMI 3.0 (2.3, 3.2 and 4.2) |

mod fmi2;
mod fmi3;

use std::fmt;

/// Version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Version {
    /// FMI 2.0.
    Fmi2,
    /// FMI 3.0.
    Fmi3,
}

impl Version {
    /// Both versions.
    pub const ALL: [Self; 2] = [Self::Fmi2, Self::Fmi3];
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Fmi2 => "FMI 2.0",
            Self::Fmi3 => "FMI 3.0",
        })
    }
}

/// One of the two interfaces of an FMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interface {
    /// The host integrates and evaluates the model at any time.
    ModelExchange,
    /// The model steps from one communication point to the next.
    CoSimulation,
}

impl Interface {
    /// Both interfaces.
    pub const ALL: [Self; 2] = [Self::ModelExchange, Self::CoSimulation];
}

impl fmt::Display for Interface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ModelExchange => "model exchange",
            Self::CoSimulation => "co-simulation",
        })
    }
}

/// A state of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum State {
    /// After instantiation or reset.
    Instantiated,
    /// Between entering and exiting initialization mode.
    InitializationMode,
    /// Discrete values may change at a fixed time: model exchange and, in FMI 3.0, co-simulation.
    EventMode,
    /// Model exchange: the host integrates.
    ContinuousTimeMode,
    /// Co-simulation of FMI 3.0: ready for the next step.
    StepMode,
    /// Co-simulation of FMI 3.0: a step has called back at a point on its way.
    IntermediateUpdateMode,
    /// Co-simulation of FMI 2.0: ready for the next step.
    StepComplete,
    /// Co-simulation: a step is under way. Never entered: `fmi2DoStep` returns at its end.
    StepInProgress,
    /// Co-simulation: the last step was discarded.
    StepFailed,
    /// Co-simulation: the host has cancelled a step. Never entered, like `StepInProgress`.
    StepCanceled,
    /// After termination; in FMI 3.0 also after a call that has failed.
    Terminated,
    /// Initialization failed in FMI 2.0; the host may read, reset, set an FMU state or free the instance.
    Error,
    /// A defect was caught; the host may free the instance.
    Fatal,
}

impl State {
    /// All states.
    pub const ALL: [Self; 13] = [
        Self::Instantiated,
        Self::InitializationMode,
        Self::EventMode,
        Self::ContinuousTimeMode,
        Self::StepMode,
        Self::IntermediateUpdateMode,
        Self::StepComplete,
        Self::StepInProgress,
        Self::StepFailed,
        Self::StepCanceled,
        Self::Terminated,
        Self::Error,
        Self::Fatal,
    ];

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

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Instantiated => "instantiated",
            Self::InitializationMode => "initializationMode",
            Self::EventMode => "eventMode",
            Self::ContinuousTimeMode => "continuousTimeMode",
            Self::StepMode => "stepMode",
            Self::IntermediateUpdateMode => "intermediateUpdateMode",
            Self::StepComplete => "stepComplete",
            Self::StepInProgress => "stepInProgress",
            Self::StepFailed => "stepFailed",
            Self::StepCanceled => "stepCanceled",
            Self::Terminated => "terminated",
            Self::Error => "error",
            Self::Fatal => "fatal",
        })
    }
}

/// Declares the calls.
macro_rules! calls {
    ($($(#[$doc:meta])* $name:ident,)*) => {
        /// A function of the C interfaces that is allowed in some states only.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Call {
            $($(#[$doc])* $name,)*
        }

        impl Call {
            /// All calls.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];
        }
    };
}

calls! {
    /// `fmi2SetDebugLogging`, `fmi3SetDebugLogging`
    SetDebugLogging,
    /// `fmi2SetupExperiment`
    SetupExperiment,
    /// `fmi2EnterInitializationMode`, `fmi3EnterInitializationMode`
    EnterInitializationMode,
    /// `fmi2ExitInitializationMode`, `fmi3ExitInitializationMode`
    ExitInitializationMode,
    /// `fmi2Terminate`, `fmi3Terminate`
    Terminate,
    /// `fmi2Reset`, `fmi3Reset`
    Reset,
    /// `fmi2GetReal`, `fmi3GetFloat64`
    GetReal,
    /// `fmi2GetInteger`, `fmi3GetInt64`
    GetInteger,
    /// `fmi2GetBoolean`, `fmi3GetBoolean`
    GetBoolean,
    /// `fmi2GetString`, `fmi3GetString`
    GetString,
    /// `fmi2SetReal`, `fmi3SetFloat64`
    SetReal,
    /// `fmi2SetInteger`, `fmi3SetInt64`
    SetInteger,
    /// `fmi2SetBoolean`, `fmi3SetBoolean`
    SetBoolean,
    /// `fmi2SetString`, `fmi3SetString`
    SetString,
    /// `fmi2GetFMUstate`, `fmi3GetFMUState`
    GetFMUstate,
    /// `fmi2SetFMUstate`, `fmi3SetFMUState`
    SetFMUstate,
    /// `fmi2FreeFMUstate`, `fmi3FreeFMUState`
    FreeFMUstate,
    /// `fmi2SerializedFMUstateSize`, `fmi3SerializedFMUStateSize`
    SerializedFMUstateSize,
    /// `fmi2SerializeFMUstate`, `fmi3SerializeFMUState`
    SerializeFMUstate,
    /// `fmi2DeSerializeFMUstate`, `fmi3DeserializeFMUState`
    DeSerializeFMUstate,
    /// `fmi2GetDirectionalDerivative`, `fmi3GetDirectionalDerivative`
    GetDirectionalDerivative,
    /// `fmi2EnterEventMode`, `fmi3EnterEventMode`
    EnterEventMode,
    /// `fmi2NewDiscreteStates`, `fmi3UpdateDiscreteStates`
    NewDiscreteStates,
    /// `fmi2EnterContinuousTimeMode`, `fmi3EnterContinuousTimeMode`
    EnterContinuousTimeMode,
    /// `fmi2CompletedIntegratorStep`, `fmi3CompletedIntegratorStep`
    CompletedIntegratorStep,
    /// `fmi2SetTime`, `fmi3SetTime`
    SetTime,
    /// `fmi2SetContinuousStates`, `fmi3SetContinuousStates`
    SetContinuousStates,
    /// `fmi2GetDerivatives`, `fmi3GetContinuousStateDerivatives`
    GetDerivatives,
    /// `fmi2GetEventIndicators`, `fmi3GetEventIndicators`
    GetEventIndicators,
    /// `fmi2GetContinuousStates`, `fmi3GetContinuousStates`
    GetContinuousStates,
    /// `fmi2GetNominalsOfContinuousStates`, `fmi3GetNominalsOfContinuousStates`
    GetNominalsOfContinuousStates,
    /// `fmi2SetRealInputDerivatives`
    SetRealInputDerivatives,
    /// `fmi2GetRealOutputDerivatives`, `fmi3GetOutputDerivatives`
    GetRealOutputDerivatives,
    /// `fmi2DoStep`, `fmi3DoStep`
    DoStep,
    /// `fmi2CancelStep`
    CancelStep,
    /// `fmi2GetStatus`
    GetStatus,
    /// `fmi2GetRealStatus`
    GetRealStatus,
    /// `fmi2GetIntegerStatus`
    GetIntegerStatus,
    /// `fmi2GetBooleanStatus`
    GetBooleanStatus,
    /// `fmi2GetStringStatus`
    GetStringStatus,
    /// `fmi3GetFloat32`
    GetFloat32,
    /// `fmi3SetFloat32`
    SetFloat32,
    /// `fmi3GetInt8`
    GetInt8,
    /// `fmi3SetInt8`
    SetInt8,
    /// `fmi3GetUInt8`
    GetUInt8,
    /// `fmi3SetUInt8`
    SetUInt8,
    /// `fmi3GetInt16`
    GetInt16,
    /// `fmi3SetInt16`
    SetInt16,
    /// `fmi3GetUInt16`
    GetUInt16,
    /// `fmi3SetUInt16`
    SetUInt16,
    /// `fmi3GetInt32`
    GetInt32,
    /// `fmi3SetInt32`
    SetInt32,
    /// `fmi3GetUInt32`
    GetUInt32,
    /// `fmi3SetUInt32`
    SetUInt32,
    /// `fmi3GetUInt64`
    GetUInt64,
    /// `fmi3SetUInt64`
    SetUInt64,
    /// `fmi3GetBinary`
    GetBinary,
    /// `fmi3SetBinary`
    SetBinary,
    /// `fmi3GetClock`
    GetClock,
    /// `fmi3SetClock`
    SetClock,
    /// `fmi3GetNumberOfVariableDependencies`
    GetNumberOfVariableDependencies,
    /// `fmi3GetVariableDependencies`
    GetVariableDependencies,
    /// `fmi3GetAdjointDerivative`
    GetAdjointDerivative,
    /// `fmi3EnterConfigurationMode`
    EnterConfigurationMode,
    /// `fmi3ExitConfigurationMode`
    ExitConfigurationMode,
    /// `fmi3GetIntervalDecimal`
    GetIntervalDecimal,
    /// `fmi3GetIntervalFraction`
    GetIntervalFraction,
    /// `fmi3GetShiftDecimal`
    GetShiftDecimal,
    /// `fmi3GetShiftFraction`
    GetShiftFraction,
    /// `fmi3SetIntervalDecimal`
    SetIntervalDecimal,
    /// `fmi3SetIntervalFraction`
    SetIntervalFraction,
    /// `fmi3SetShiftDecimal`
    SetShiftDecimal,
    /// `fmi3SetShiftFraction`
    SetShiftFraction,
    /// `fmi3EvaluateDiscreteStates`
    EvaluateDiscreteStates,
    /// `fmi3GetNumberOfEventIndicators`
    GetNumberOfEventIndicators,
    /// `fmi3GetNumberOfContinuousStates`
    GetNumberOfContinuousStates,
    /// `fmi3EnterStepMode`
    EnterStepMode,
    /// `fmi3ActivateModelPartition`
    ActivateModelPartition,
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
        let names = [fmi2::name(self), fmi3::name(self)];
        let [first, second] = match version {
            Version::Fmi2 => names,
            Version::Fmi3 => [names[1], names[0]],
        };
        first.or(second).unwrap_or_default()
    }

    /// Returns the states that allow the call; none if it belongs to the other interface or to
    /// another version.
    #[must_use]
    pub fn allowed_in(self, version: Version, interface: Interface) -> &'static [State] {
        match version {
            Version::Fmi2 => fmi2::allowed_in(self, interface),
            Version::Fmi3 => fmi3::allowed_in(self, interface),
        }
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

/// Defines the table of one version: calls with the names of their C functions, and the states that
/// allow them in model exchange and in co-simulation.
macro_rules! table {
    ($($($call:ident = $name:ident),+: [$($me:ident)*] [$($cs:ident)*];)*) => {
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

        /// Returns the name of the C function.
        pub(super) fn name(call: Call) -> Option<&'static str> {
            match call {
                $($(Call::$call => Some(stringify!($name)),)+)*
                _ => None,
            }
        }

        /// Returns the states that allow a call.
        pub(super) fn allowed_in(call: Call, interface: Interface) -> &'static [State] {
            match (call, interface) {
                $(
                    ($(Call::$call)|+, Interface::ModelExchange) => &[$(State::$me),*],
                    ($(Call::$call)|+, Interface::CoSimulation) => &[$(State::$cs),*],
                )*
                _ => &[],
            }
        }
    };
}
use table;

#[cfg(test)]
mod tests {
    use super::{Call, Interface, State, Version};

    #[test]
    fn bits_and_lists_agree() {
        for version in Version::ALL {
            for &call in Call::ALL {
                for interface in Interface::ALL {
                    for state in State::ALL {
                        assert_eq!(
                            call.is_allowed_in(version, interface, state),
                            call.allowed_in(version, interface).contains(&state),
                            "{version}, {call:?}, {interface}, {state}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn every_call_has_a_name() {
        for &call in Call::ALL {
            assert!(
                Version::ALL
                    .iter()
                    .any(|&version| !call.name(version).is_empty())
            );
        }
    }
}

//! The states of an instance and the calls allowed in each (FMI 2.0, 3.2.3 and 4.2.4).

use std::fmt;

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
    /// Model exchange: discrete values may change at a fixed time.
    EventMode,
    /// Model exchange: the host integrates.
    ContinuousTimeMode,
    /// Co-simulation: ready for the next step.
    StepComplete,
    /// Co-simulation: a step is under way. Never entered: `fmi2DoStep` returns at its end.
    StepInProgress,
    /// Co-simulation: the last step was discarded.
    StepFailed,
    /// Co-simulation: the host has cancelled a step. Never entered, like `StepInProgress`.
    StepCanceled,
    /// After `fmi2Terminate`.
    Terminated,
    /// Initialization failed; the host may read, reset, set an FMU state or free the instance.
    Error,
    /// A defect was caught; the host may free the instance.
    Fatal,
}

impl State {
    /// All states.
    pub const ALL: [Self; 11] = [
        Self::Instantiated,
        Self::InitializationMode,
        Self::EventMode,
        Self::ContinuousTimeMode,
        Self::StepComplete,
        Self::StepInProgress,
        Self::StepFailed,
        Self::StepCanceled,
        Self::Terminated,
        Self::Error,
        Self::Fatal,
    ];

    /// Returns the phase of the model in this state.
    pub(super) fn phase(self) -> Phase {
        match self {
            Self::Instantiated | Self::InitializationMode => Phase::Initialization,
            Self::EventMode | Self::ContinuousTimeMode | Self::StepComplete => Phase::Running,
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

macro_rules! calls {
    ($(
        $name:ident: [$($me:ident)*] [$($cs:ident)*];
    )*) => {
        /// A function of the C interface that is allowed in some states only.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Call {
            $(
                #[doc = concat!("`fmi2", stringify!($name), "`")]
                $name,
            )*
        }

        impl Call {
            /// All calls.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];

            /// Returns the name of the C function.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$name => concat!("fmi2", stringify!($name)),)*
                }
            }

            /// Returns the states that allow the call; none if it belongs to the other interface.
            #[must_use]
            pub fn allowed_in(self, interface: Interface) -> &'static [State] {
                match (self, interface) {
                    $(
                        (Self::$name, Interface::ModelExchange) => &[$(State::$me),*],
                        (Self::$name, Interface::CoSimulation) => &[$(State::$cs),*],
                    )*
                }
            }

            /// Returns whether a state allows the call.
            #[must_use]
            #[inline]
            pub fn is_allowed_in(self, interface: Interface, state: State) -> bool {
                // Every call asks. One bit per state is quicker than a list.
                let allowed: u16 = match (self, interface) {
                    $(
                        (Self::$name, Interface::ModelExchange) => 0 $(| 1 << State::$me as u16)*,
                        (Self::$name, Interface::CoSimulation) => 0 $(| 1 << State::$cs as u16)*,
                    )*
                };
                allowed >> state as u16 & 1 != 0
            }
        }
    };
}

// The states that allow each call: in model exchange, then in co-simulation.
calls! {
    SetDebugLogging:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepInProgress StepFailed
            StepCanceled Terminated Error
        ];
    SetupExperiment:
        [Instantiated]
        [Instantiated];
    EnterInitializationMode:
        [Instantiated]
        [Instantiated];
    ExitInitializationMode:
        [InitializationMode]
        [InitializationMode];
    Terminate:
        [EventMode ContinuousTimeMode]
        [StepComplete StepFailed];
    Reset:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    GetReal:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    GetInteger:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    GetBoolean:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    GetString:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    SetReal:
        [Instantiated InitializationMode EventMode ContinuousTimeMode]
        [Instantiated InitializationMode StepComplete];
    SetInteger:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode StepComplete];
    SetBoolean:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode StepComplete];
    SetString:
        [Instantiated InitializationMode EventMode]
        [Instantiated InitializationMode StepComplete];
    GetFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    SetFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    FreeFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    SerializedFMUstateSize:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    SerializeFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    DeSerializeFMUstate:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [
            Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated
            Error
        ];
    GetDirectionalDerivative:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    EnterEventMode:
        [EventMode ContinuousTimeMode]
        [];
    NewDiscreteStates:
        [EventMode]
        [];
    EnterContinuousTimeMode:
        [EventMode]
        [];
    CompletedIntegratorStep:
        [ContinuousTimeMode]
        [];
    SetTime:
        [EventMode ContinuousTimeMode]
        [];
    SetContinuousStates:
        [ContinuousTimeMode]
        [];
    GetDerivatives:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [];
    GetEventIndicators:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [];
    GetContinuousStates:
        [InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [];
    GetNominalsOfContinuousStates:
        [Instantiated InitializationMode EventMode ContinuousTimeMode Terminated Error]
        [];
    SetRealInputDerivatives:
        []
        [Instantiated InitializationMode StepComplete];
    GetRealOutputDerivatives:
        []
        [StepComplete StepFailed StepCanceled Terminated Error];
    DoStep:
        []
        [StepComplete];
    CancelStep:
        []
        [StepInProgress];
    GetStatus:
        []
        [StepComplete StepInProgress StepFailed Terminated];
    GetRealStatus:
        []
        [StepComplete StepInProgress StepFailed Terminated];
    GetIntegerStatus:
        []
        [StepComplete StepInProgress StepFailed Terminated];
    GetBooleanStatus:
        []
        [StepComplete StepInProgress StepFailed Terminated];
    GetStringStatus:
        []
        [StepComplete StepInProgress StepFailed Terminated];
}

impl Call {
    /// Returns whether the call may end with `fmi2Discard` (FMI 2.0, 2.1.3).
    #[must_use]
    pub fn may_discard(self, interface: Interface) -> bool {
        match self {
            Self::SetReal | Self::SetInteger | Self::SetBoolean | Self::SetString => true,
            Self::GetReal
            | Self::SetContinuousStates
            | Self::GetContinuousStates
            | Self::GetDerivatives
            | Self::GetEventIndicators => interface == Interface::ModelExchange,
            Self::DoStep
            | Self::GetStatus
            | Self::GetRealStatus
            | Self::GetIntegerStatus
            | Self::GetBooleanStatus
            | Self::GetStringStatus => interface == Interface::CoSimulation,
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Call, Interface, State};

    #[test]
    fn bits_and_lists_agree() {
        for &call in Call::ALL {
            for interface in Interface::ALL {
                for state in State::ALL {
                    assert_eq!(
                        call.is_allowed_in(interface, state),
                        call.allowed_in(interface).contains(&state),
                        "{call:?}, {interface}, {state}"
                    );
                }
            }
        }
    }
}

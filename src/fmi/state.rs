//! The states of an instance and the calls that each allows (FMI 2.0, 4.2.4).

use std::fmt;

/// A state of a co-simulation slave.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum State {
    /// After instantiation or reset.
    Instantiated,
    /// Between entering and exiting initialization mode.
    InitializationMode,
    /// Ready for the next step.
    StepComplete,
    /// A step is being taken. Never entered: steps have ended when `fmi2DoStep` returns.
    StepInProgress,
    /// The last step was discarded.
    StepFailed,
    /// A step was cancelled. Never entered, as there is none to be cancelled.
    StepCanceled,
    /// After terminating.
    Terminated,
    /// Initialization failed; only reading, going back and freeing are left.
    Error,
    /// A defect of biela was caught; nothing but freeing is left.
    Fatal,
}

impl State {
    /// All states.
    pub const ALL: [Self; 9] = [
        Self::Instantiated,
        Self::InitializationMode,
        Self::StepComplete,
        Self::StepInProgress,
        Self::StepFailed,
        Self::StepCanceled,
        Self::Terminated,
        Self::Error,
        Self::Fatal,
    ];

    /// Those in which an FMU state can be got.
    pub(super) const SAVED: [Self; 6] = [
        Self::Instantiated,
        Self::InitializationMode,
        Self::StepComplete,
        Self::StepFailed,
        Self::Terminated,
        Self::Error,
    ];
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Instantiated => "instantiated",
            Self::InitializationMode => "initializationMode",
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
    ($($(#[$doc:meta])* $name:ident: [$($state:ident)*];)*) => {
        /// A call of the C interface that the state decides about.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Call {
            $($(#[$doc])* $name,)*
        }

        impl Call {
            /// All calls.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];

            /// The C function's name.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$name => concat!("fmi2", stringify!($name)),)*
                }
            }

            /// The states in which the call is allowed.
            #[must_use]
            pub fn allowed_in(self) -> &'static [State] {
                match self {
                    $(Self::$name => &[$(State::$state),*],)*
                }
            }
        }
    };
}

calls! {
    /// `fmi2SetDebugLogging`
    SetDebugLogging: [
        Instantiated InitializationMode StepComplete StepInProgress StepFailed StepCanceled
        Terminated Error
    ];
    /// `fmi2SetupExperiment`
    SetupExperiment: [Instantiated];
    /// `fmi2EnterInitializationMode`
    EnterInitializationMode: [Instantiated];
    /// `fmi2ExitInitializationMode`
    ExitInitializationMode: [InitializationMode];
    /// `fmi2Terminate`
    Terminate: [StepComplete StepFailed];
    /// `fmi2Reset`
    Reset: [Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    /// `fmi2GetReal`
    GetReal: [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    /// `fmi2GetInteger`
    GetInteger: [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    /// `fmi2GetBoolean`
    GetBoolean: [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    /// `fmi2GetString`
    GetString: [InitializationMode StepComplete StepFailed StepCanceled Terminated Error];
    /// `fmi2SetReal`
    SetReal: [Instantiated InitializationMode StepComplete];
    /// `fmi2SetInteger`
    SetInteger: [Instantiated InitializationMode StepComplete];
    /// `fmi2SetBoolean`
    SetBoolean: [Instantiated InitializationMode StepComplete];
    /// `fmi2SetString`
    SetString: [Instantiated InitializationMode StepComplete];
    /// `fmi2GetFMUstate`
    GetFMUstate: [
        Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated Error
    ];
    /// `fmi2SetFMUstate`
    SetFMUstate: [
        Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated Error
    ];
    /// `fmi2FreeFMUstate`
    FreeFMUstate: [
        Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated Error
    ];
    /// `fmi2SerializedFMUstateSize`
    SerializedFMUstateSize: [
        Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated Error
    ];
    /// `fmi2SerializeFMUstate`
    SerializeFMUstate: [
        Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated Error
    ];
    /// `fmi2DeSerializeFMUstate`
    DeSerializeFMUstate: [
        Instantiated InitializationMode StepComplete StepFailed StepCanceled Terminated Error
    ];
    /// `fmi2SetRealInputDerivatives`
    SetRealInputDerivatives: [Instantiated InitializationMode StepComplete];
    /// `fmi2GetRealOutputDerivatives`
    GetRealOutputDerivatives: [StepComplete StepFailed StepCanceled Terminated Error];
    /// `fmi2DoStep`
    DoStep: [StepComplete];
    /// `fmi2CancelStep`
    CancelStep: [StepInProgress];
    /// `fmi2GetStatus`
    GetStatus: [StepComplete StepInProgress StepFailed Terminated];
    /// `fmi2GetRealStatus`
    GetRealStatus: [StepComplete StepInProgress StepFailed Terminated];
    /// `fmi2GetIntegerStatus`
    GetIntegerStatus: [StepComplete StepInProgress StepFailed Terminated];
    /// `fmi2GetBooleanStatus`
    GetBooleanStatus: [StepComplete StepInProgress StepFailed Terminated];
    /// `fmi2GetStringStatus`
    GetStringStatus: [StepComplete StepInProgress StepFailed Terminated];
}

//! The interface between an FMU's instance and the model inside it.
//!
//! An [`Instance`](super::Instance) knows the standard: the calls that each state allows, the
//! values that a variable accepts, the messages that a host receives. A [`Model`] knows its
//! equations and none of the standard's rules; it receives valid requests only.

use std::fmt::Debug;
use std::path::Path;

use super::codec::{Codec, Unreadable};
use super::error::Failure;
use super::log::Logger;
use super::model_description::{Capabilities, DependencyKind};
use super::state::{Interface, Phase};
use super::variable::Variable;

/// A model that an [`Instance`](super::Instance) turns into an FMU.
///
/// A model has a time, values set by the host, and a committed point from which it goes on.
/// Computed values depend on these three alone, not on what was set or read in between. Values
/// arrive checked: of the right type, finite, within their limits, at a permitted time.
///
/// ```
/// use biela::fmi::{
///     Causality, Codec, Failure, Groups, Instance, Interface, Kind, Logger, Model, Phase, Status,
///     Unreadable, Variability, Variable,
/// };
///
/// /// y = 2 u.
/// struct Double {
///     variables: Vec<Variable<char>>,
///     interface: Interface,
///     state: State,
/// }
///
/// #[derive(Clone, Debug, Default, PartialEq)]
/// struct State {
///     time: f64,
///     /// u and y.
///     reals: [f64; 2],
/// }
///
/// impl Model for Double {
///     type Quantity = char;
///     type State = State;
///
///     fn load(_: &std::path::Path, interface: Interface) -> Result<Self, Failure> {
///         let variable = |name, causality, start| Variable {
///             name: String::from(name),
///             description: String::new(),
///             quantity: name,
///             causality,
///             variability: Variability::Continuous,
///             kind: Kind::real(None, start),
///             derivative_of: None,
///         };
///         Ok(Self {
///             variables: vec![
///                 variable('u', Causality::Input, Some(0.0)),
///                 variable('y', Causality::Output, None),
///             ],
///             interface,
///             state: State::default(),
///         })
///     }
///     fn guid(&self) -> &str {
///         "double"
///     }
///     fn interface(&self) -> Interface {
///         self.interface
///     }
///     fn variables(&self) -> &[Variable<char>] {
///         &self.variables
///     }
///     fn time(&self) -> f64 {
///         self.state.time
///     }
///     fn set_time(&mut self, time: f64) {
///         self.state.time = time;
///     }
///     fn reset(&mut self) {
///         self.state = State::default();
///     }
///     fn set_reals(&mut self, values: impl Iterator<Item = (char, f64)>) {
///         values.for_each(|(_, value)| self.state.reals[0] = value);
///     }
///     fn groups(&self, quantity: char) -> Groups {
///         Groups::from(quantity == 'y')
///     }
///     fn refresh(&mut self, _: Groups, _: Phase, _: &Logger) -> Result<(), Failure> {
///         self.state.reals[1] = 2.0 * self.state.reals[0];
///         Ok(())
///     }
///     fn reals(&self) -> &[f64] {
///         &self.state.reals
///     }
///     fn commit(&mut self, _: Phase, _: &Logger) -> Result<(), Failure> {
///         Ok(())
///     }
///     fn step(&mut self, _: f64, end: f64, _: bool, _: &Logger) -> Result<(), Failure> {
///         self.state.time = end;
///         Ok(())
///     }
///     fn save(&mut self) -> State {
///         self.state.clone()
///     }
///     fn restore(&mut self, state: &State) {
///         self.state = state.clone();
///     }
///     fn visit(state: &mut State, codec: &mut impl Codec) -> Result<(), Unreadable> {
///         codec.finite(&mut state.time)?;
///         state.reals.iter_mut().try_for_each(|value| codec.finite(value))
///     }
/// }
///
/// # struct Silent;
/// # impl biela::fmi::Sink for Silent {
/// #     fn write(&self, _: Status, _: biela::fmi::Category, _: &str) {}
/// # }
/// # let sink = Box::new(Silent);
/// let model = Double::load("resources".as_ref(), Interface::CoSimulation)?;
/// let mut instance = Instance::new(model, sink, false);
/// instance.setup_experiment(0.0, None)?;
/// instance.enter_initialization_mode()?;
/// instance.exit_initialization_mode()?;
/// instance.set_real(&[1], &[21.0])?;
/// instance.do_step(0.0, 0.1)?;
/// assert_eq!(instance.reals(&[2])?.next(), Some(42.0));
/// // The instance keeps the standard's rules; the model does not know them.
/// assert!(instance.set_real(&[2], &[0.0]).is_err());
/// assert!(instance.do_step(0.0, 0.1).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Model: Sized {
    /// The model's own name for a variable.
    type Quantity: Copy + Debug + PartialEq;

    /// The optional methods of the trait that the model has: by default none.
    const CAPABILITIES: Capabilities = Capabilities {
        interpolates_inputs: false,
        output_derivatives: 0,
        directional_derivatives: false,
        intermediate_update: false,
    };

    /// Everything that decides how the model goes on, time included.
    type State: Clone + Debug + PartialEq;

    /// Reads the model from the resources of an FMU.
    ///
    /// # Errors
    ///
    /// The reason why the resources hold no such model.
    fn load(resources: &Path, interface: Interface) -> Result<Self, Failure>;

    /// Returns the GUID that the model description must have.
    fn guid(&self) -> &str;

    /// Returns the interface that the model was loaded for.
    fn interface(&self) -> Interface;

    /// Returns the variables in the order of their value references. The list never changes.
    fn variables(&self) -> &[Variable<Self::Quantity>];

    /// Returns the time \[s\]; after a discarded step the last time that was reached.
    fn time(&self) -> f64;

    /// Sets the time \[s\]: the start time, or any time in model exchange.
    fn set_time(&mut self, time: f64);

    /// Takes the host's relative tolerance, before initialization. Models that compute to rounding
    /// leave it aside.
    fn set_tolerance(&mut self, tolerance: f64, log: &Logger) {
        let _ = (tolerance, log);
    }

    /// Restores the model as it was loaded.
    fn reset(&mut self);

    /// Sets inputs and parameters of type Real.
    fn set_reals(&mut self, values: impl Iterator<Item = (Self::Quantity, f64)>);

    /// Sets Integers and Enumerations; the first item of an enumeration is 1.
    fn set_integers(&mut self, values: impl Iterator<Item = (Self::Quantity, i32)>) {
        debug_assert_eq!(values.count(), 0, "the model has none by default");
    }

    /// Sets derivatives of inputs, of order 1 or 2, for the next step.
    fn set_input_derivatives(
        &mut self,
        derivatives: impl Iterator<Item = (Self::Quantity, usize, f64)>,
    ) {
        derivatives.for_each(drop);
    }

    /// Returns the groups that the value of a Real belongs to, 0 for a value that is always up to
    /// date. The answer never changes.
    fn groups(&self, quantity: Self::Quantity) -> Groups;

    /// Brings the [values](Self::reals) of these groups up to date.
    ///
    /// # Errors
    ///
    /// The values do not exist for what the host has set.
    fn refresh(&mut self, groups: Groups, phase: Phase, log: &Logger) -> Result<(), Failure>;

    /// Returns the values of all variables by their places in the list. Values of groups that were not
    /// [refreshed](Self::refresh) since the last change, and of variables that are no Reals, have
    /// no meaning.
    fn reals(&self) -> &[f64];

    /// Returns the value of an Integer or an Enumeration. Such values change at communication
    /// points and events only, so that they are always up to date.
    fn integer(&self, quantity: Self::Quantity) -> i32 {
        unreachable!("{quantity:?} is a Real unless a model overrides this")
    }

    /// Returns the usual magnitude of a continuous state.
    fn nominal(&self, quantity: Self::Quantity) -> f64 {
        let _ = quantity;
        1.0
    }

    /// Returns the directional derivative of each unknown: the sum over `knowns` of
    /// ∂unknown/∂known times the known's change. Unknowns are outputs and, in initialization,
    /// calculated parameters; knowns are inputs and, in initialization, parameters.
    ///
    /// # Errors
    ///
    /// The derivative does not exist.
    fn directional_derivatives(
        &mut self,
        unknowns: &[Self::Quantity],
        knowns: &[(Self::Quantity, f64)],
        phase: Phase,
        log: &Logger,
    ) -> Result<Vec<f64>, Failure> {
        let _ = (unknowns, knowns, phase, log);
        let why = "this FMU provides no directional derivatives";
        Err(Failure::Failed(why.to_owned()))
    }

    /// Returns the variables on which an output or a calculated parameter depends, by value
    /// reference: in initialization mode, or otherwise after it, over all settings. None for other
    /// variables.
    fn dependencies(&self, value_reference: u32, initializing: bool) -> Vec<(u32, DependencyKind)> {
        let _ = (value_reference, initializing);
        Vec::new()
    }

    /// Makes the point of the values set the committed one: at the end of initialization, at an
    /// event between two steps, and in model exchange when the host has accepted a step of its own.
    ///
    /// # Errors
    ///
    /// No such point exists; the committed one stays.
    fn commit(&mut self, phase: Phase, log: &Logger) -> Result<(), Failure>;

    /// Brings discrete values up to date: at the end of initialization, and in model exchange at an
    /// event.
    fn update_discrete(&mut self) {}

    /// Returns whether the model has an event at the committed point, in model exchange.
    fn wants_event(&mut self) -> bool {
        false
    }

    /// Changes or exchanges the continuous states at an event at the committed point, in model exchange.
    ///
    /// # Errors
    ///
    /// The states have no derivatives there.
    fn change_states(&mut self, log: &Logger) -> Result<StateChange, Failure> {
        let _ = log;
        Ok(StateChange::None)
    }

    /// Takes a step of `size` \[s\] from the committed point, and commits its end, at time `end`
    /// \[s\]. The host's time of the committed point, `end - size`, may differ from the model's by
    /// rounding.
    ///
    /// # Errors
    ///
    /// [`Failure::Discarded`] if the model cannot reach the end: with `stays` it is then as before the
    /// call, otherwise it has committed the point that it reached. [`Failure::Failed`] if it has not
    /// moved.
    fn step(&mut self, size: f64, end: f64, stays: bool, log: &Logger) -> Result<(), Failure>;

    /// Has steps end at the first event on their way, with [`Failure::Event`], or go on beyond.
    fn end_steps_at_events(&mut self, _end: bool) {}

    /// Begins a step of `size` \[s\] to the time `end` \[s\] that is taken in parts.
    fn begin_step(&mut self, size: f64, end: f64, log: &Logger) {
        let _ = (size, end, log);
    }

    /// Goes on to `time` \[s\] in the step that was begun, and commits the point there.
    ///
    /// # Errors
    ///
    /// [`Failure::Discarded`] if the model cannot reach it; it has then committed the point that it
    /// reached.
    fn advance(&mut self, time: f64, log: &Logger) -> Result<(), Failure> {
        let _ = (time, log);
        unreachable!("the model takes no step in parts")
    }

    /// Lets the values that are set from now on hold from the present time on.
    fn split_step(&mut self, log: &Logger) {
        let _ = log;
    }

    /// Ends the step that was begun at the present time, with the values set last.
    ///
    /// # Errors
    ///
    /// As [`advance`](Self::advance).
    fn end_step(&mut self, log: &Logger) -> Result<(), Failure> {
        let _ = log;
        Ok(())
    }

    /// Restores the model as it was before the step was begun.
    fn abandon_step(&mut self) {}

    /// Moves the time on to the dead point in front of which the step has stopped.
    fn meet_dead_point(&mut self) {}

    /// Returns a copy of the state. This model, or another one with the same GUID, goes on from it
    /// with the same bits.
    fn save(&mut self) -> Self::State;

    /// Restores a saved state, or one that [`check`](Self::check) has accepted.
    fn restore(&mut self, state: &Self::State);

    /// Visits every field of a state with a codec, always in the same order. Reading starts from
    /// the present state of a model with the same GUID.
    ///
    /// # Errors
    ///
    /// The codec cannot read a field.
    fn visit(state: &mut Self::State, codec: &mut impl Codec) -> Result<(), Unreadable>;

    /// Checks that a state which was read can be [restored](Self::restore). May leave the model
    /// in any state.
    ///
    /// # Errors
    ///
    /// The reason why it cannot.
    fn check(&mut self, state: &mut Self::State) -> Result<(), String> {
        let _ = state;
        Ok(())
    }
}

/// The effect of an event on the continuous states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StateChange {
    /// They stay.
    #[default]
    None,
    /// They have other values.
    Values,
    /// They are others, with other values and other nominal values.
    Exchange,
}

/// A set of groups of Reals, one bit per group. The values of a group are computed together.
pub type Groups = u16;

//! What a model brings to become an FMU.
//!
//! An [`Instance`](super::Instance) knows the standard: which call is allowed when, what a
//! variable may be set to, what a host is told. A [`Model`] knows its equations and nothing of
//! the standard's rules; it is asked only for what makes sense.

use std::fmt::Debug;
use std::ops::Range;
use std::path::Path;

use super::codec::{Codec, Unreadable};
use super::error::Failure;
use super::log::Logger;
use super::state::{Interface, Phase};
use super::variable::Variable;

/// A model that an [`Instance`](super::Instance) makes an FMU of.
///
/// The model is at a time and has values in force: those last set. What it computes from them
/// belongs to them, whatever was set and read in between. What it was at when last committed, it
/// goes on from. The host's values arrive checked: of the right type, finite, within their limits
/// and at a time when they may be set.
///
/// ```
/// use biela::fmi::{
///     Causality, Codec, Failure, Instance, Interface, Kind, Logger, Model, Phase, Status,
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
///     u: f64,
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
///         values.for_each(|(_, value)| self.state.u = value);
///     }
///     fn real(&mut self, quantity: char) -> f64 {
///         if quantity == 'u' { self.state.u } else { 2.0 * self.state.u }
///     }
///     fn make_ready(&mut self, _: char, _: Phase, _: &Logger) -> Result<(), Failure> {
///         Ok(())
///     }
///     fn commit(&mut self, _: Phase, _: &Logger) -> Result<(), Failure> {
///         Ok(())
///     }
///     fn step(&mut self, _: f64, end: f64, _: &Logger) -> Result<(), Failure> {
///         self.state.time = end;
///         Ok(())
///     }
///     fn save(&mut self) -> State {
///         self.state.clone()
///     }
///     fn restore(&mut self, state: &State) {
///         self.state = state.clone();
///     }
///     fn walk(state: &mut State, codec: &mut impl Codec) -> Result<(), Unreadable> {
///         codec.finite(&mut state.time)?;
///         codec.finite(&mut state.u)
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
/// instance.set_real(&[0], &[21.0])?;
/// instance.do_step(0.0, 0.1)?;
/// assert_eq!(instance.reals(&[1])?.next(), Some(42.0));
/// // The standard's rules are none of the model's business.
/// assert!(instance.set_real(&[1], &[0.0]).is_err());
/// assert!(instance.do_step(0.0, 0.1).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Model: Sized {
    /// What a variable stands for.
    type Quantity: Copy + Debug + PartialEq;

    /// All that decides how the model goes on, time included.
    type State: Clone + Debug + PartialEq;

    /// Reads the model from the resources of an FMU.
    ///
    /// # Errors
    ///
    /// Why there is none, for people.
    fn load(resources: &Path, interface: Interface) -> Result<Self, Failure>;

    /// The GUID that its model description has to bear.
    fn guid(&self) -> &str;

    /// For which interface it was made.
    fn interface(&self) -> Interface;

    /// The variables, in the order of their value references. Always the same.
    fn variables(&self) -> &[Variable<Self::Quantity>];

    /// Where in time it is \[s\]: after a step that was discarded, the last time that was
    /// reached.
    fn time(&self) -> f64;

    /// Goes to a time \[s\], as the host says it: the start, or any time in model exchange.
    fn set_time(&mut self, time: f64);

    /// Back to what it was when loaded.
    fn reset(&mut self);

    /// Takes values of inputs and parameters.
    fn set_reals(&mut self, values: impl Iterator<Item = (Self::Quantity, f64)>);

    /// Takes values of whole numbers and of enumerations, whose first item is 1.
    fn set_integers(&mut self, values: impl Iterator<Item = (Self::Quantity, i32)>) {
        debug_assert_eq!(
            values.count(),
            0,
            "there are none unless this is overridden"
        );
    }

    /// Takes the derivatives of order 1 or 2 that inputs have during the next step.
    fn set_input_derivatives(
        &mut self,
        derivatives: impl Iterator<Item = (Self::Quantity, usize, f64)>,
    ) {
        derivatives.for_each(drop);
    }

    /// The value references of Reals whose values the model keeps side by side, in this order.
    /// Always the same; hosts that read some in a row get them from [there](Self::row_values) much
    /// faster than one by one.
    fn row(&self) -> Range<u32> {
        0..0
    }

    /// The values of these places of the [row](Self::row), of which there is one at least.
    ///
    /// # Errors
    ///
    /// They have no values for the values set.
    fn row_values(
        &mut self,
        places: Range<usize>,
        phase: Phase,
        log: &Logger,
    ) -> Result<&[f64], Failure> {
        let _ = (phase, log);
        unreachable!("places {places:?} are none unless this is overridden")
    }

    /// Computes what the value of a quantity is read from.
    ///
    /// # Errors
    ///
    /// It has no value for the values set.
    fn make_ready(
        &mut self,
        quantity: Self::Quantity,
        phase: Phase,
        log: &Logger,
    ) -> Result<(), Failure>;

    /// The value of a Real that is [ready](Self::make_ready).
    fn real(&mut self, quantity: Self::Quantity) -> f64;

    /// The value of a whole number or an enumeration that is [ready](Self::make_ready).
    fn integer(&mut self, quantity: Self::Quantity) -> i32 {
        unreachable!("{quantity:?} is no whole number unless this is overridden")
    }

    /// The quantity that is the derivative of another one with respect to time, of an order from
    /// 1 on; `None` where there is none.
    fn time_derivative(&self, quantity: Self::Quantity, order: u32) -> Option<Self::Quantity> {
        let _ = (quantity, order);
        None
    }

    /// How outputs, and in initialization calculated parameters, change along a direction in the
    /// space of inputs, and in initialization parameters: the sum over `knowns` of
    /// ∂unknown/∂known times the known's own change, for each of the unknowns, all of which are
    /// [ready](Self::make_ready).
    ///
    /// # Errors
    ///
    /// There is no derivative.
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

    /// Takes what belongs to the values set as the point to go on from: at the end of
    /// initialization, and in model exchange when the host has accepted a step of its own.
    ///
    /// # Errors
    ///
    /// Nothing belongs to them; the point stays what it was.
    fn commit(&mut self, phase: Phase, log: &Logger) -> Result<(), Failure>;

    /// Takes a step of `size` \[s\] from the point last committed, and commits its end, which is
    /// called `end` \[s\].
    ///
    /// # Errors
    ///
    /// [`Failure::Discarded`] where it cannot come to the end; it has then committed where it
    /// came to. [`Failure::Failed`] if it has stayed where it was.
    fn step(&mut self, size: f64, end: f64, log: &Logger) -> Result<(), Failure>;

    /// A copy of its state. A model that goes on from there, this one or another one with the
    /// same GUID, does so with the same bits.
    fn save(&mut self) -> Self::State;

    /// Goes back to a state that was saved, or that [`check`](Self::check) has passed.
    fn restore(&mut self, state: &Self::State);

    /// Takes a codec through a state: all of it, always in the same order. Reading starts from the
    /// present state of a model with the same GUID.
    ///
    /// # Errors
    ///
    /// A value that a codec could not read.
    fn walk(state: &mut Self::State, codec: &mut impl Codec) -> Result<(), Unreadable>;

    /// Makes sure that a state that was read is one that can be [restored](Self::restore).
    /// Leaves the model in any state.
    ///
    /// # Errors
    ///
    /// Why it is not.
    fn check(&mut self, state: &mut Self::State) -> Result<(), String> {
        let _ = state;
        Ok(())
    }
}

//! Setting and getting variables and their derivatives.

use std::mem::MaybeUninit;
use std::ops::Range;
use std::slice::Iter;

use super::{Error, Instance, check_finite};
use crate::fmi::error::check_limits;
use crate::fmi::model::{Groups, Model};
use crate::fmi::state::{Call, State, Version};
use crate::fmi::variable::{Causality, Kind, Variability, Variable, place};

/// Group of all variables that are not Real: the top bit, reserved, so that no model uses it.
const NO_REAL: Groups = 1 << (Groups::BITS - 1);

/// Returns the groups of a variable's value.
pub(super) fn groups_of<M: Model>(
    version: Version,
    model: &M,
    variable: &Variable<M::Quantity>,
) -> Groups {
    if variable.kind.is_real_in(version) {
        model.groups(variable.quantity)
    } else {
        NO_REAL
    }
}

/// Returns whether a variable is an input that accepts any finite value at any time. The limits of
/// an input are information for the host (FMI 2.0, 2.2.3); the model decides what follows.
pub(super) fn is_continuous_input<Q>(variable: &Variable<Q>) -> bool {
    variable.causality == Causality::Input && variable.variability == Variability::Continuous
}

impl<M: Model> Instance<M> {
    /// `fmi2SetReal`. Sets all values or none.
    ///
    /// # Errors
    ///
    /// A variable is unknown, no Real, or not settable in this state; a value is not finite, or
    /// that of a parameter is outside `min` and `max`.
    #[inline(always)]
    pub fn set_real(&mut self, value_references: &[u32], values: &[f64]) -> Result<(), Error> {
        self.allow(Call::SetReal)?;
        if self.lifecycle.state == State::IntermediateUpdateMode {
            self.check_intermediate(value_references)?;
        }
        for (&value_reference, &value) in value_references.iter().zip(values) {
            let is_input = self.continuous_inputs.get(place(value_reference));
            if !(is_input == Some(&true) && value.is_finite()) {
                self.check_real(value_reference, value)?;
            }
        }
        if self.version == Version::Fmi3 {
            self.note_values_set(value_references);
        }
        let quantities = &self.quantities;
        let values = value_references.iter().zip(values);
        self.model
            .set_reals(values.map(|(&vr, &value)| (quantities[place(vr)], value)));
        Ok(())
    }

    /// Checks that the host may set a Real to this value in the present state.
    #[cold]
    fn check_real(&self, value_reference: u32, value: f64) -> Result<(), Error> {
        check_value(self.settable(value_reference, "Real")?, value)
    }

    /// `fmi2SetInteger`, `fmi3SetInt64`: sets all values or none, of Enumerations as well.
    ///
    /// # Errors
    ///
    /// A variable is unknown, no Integer or Enumeration, or not settable in this state; a value is
    /// no item of its Enumeration.
    pub fn set_integer(
        &mut self,
        value_references: &[u32],
        values: &[impl Copy + Into<i64>],
    ) -> Result<(), Error> {
        self.allow(Call::SetInteger)?;
        let values = value_references.iter().zip(values);
        let values = values.map(|(&value_reference, &value)| (value_reference, value.into()));
        for (value_reference, value) in values.clone() {
            let variable = self.settable(value_reference, "Integer or Enumeration")?;
            if let Kind::Enumeration { choices, .. } = variable.kind {
                let count = choices.items.len();
                if !usize::try_from(value).is_ok_and(|value| (1..=count).contains(&value)) {
                    return Err(Error::Item {
                        name: variable.name.clone(),
                        value,
                        count,
                    });
                }
            }
        }
        let quantities = &self.quantities;
        self.model
            .set_integers(values.map(|(vr, value)| (quantities[place(vr)], value as i32)));
        Ok(())
    }

    /// Answers a getter or setter of a type that no variable has: legal for an empty list only.
    ///
    /// # Errors
    ///
    /// The list is not empty: no variable has such a type.
    pub fn no_variables(
        &self,
        call: Call,
        expected: &'static str,
        value_references: &[u32],
    ) -> Result<(), Error> {
        self.allow(call)?;
        match value_references {
            [] => Ok(()),
            [first, ..] => Err(self.wrong_type(self.variable(*first)?, expected)),
        }
    }

    /// `fmi2SetRealInputDerivatives`: derivatives of inputs for the next step. Sets all or none.
    ///
    /// # Errors
    ///
    /// A variable is no input, an order is not 1 or 2, or a value is not finite.
    pub fn set_real_input_derivatives(
        &mut self,
        value_references: &[u32],
        orders: &[i32],
        values: &[f64],
    ) -> Result<(), Error> {
        self.allow(Call::SetRealInputDerivatives)?;
        let entries = value_references.iter().zip(orders).zip(values);
        for ((&value_reference, &order), &value) in entries.clone() {
            let variable = self.variable(value_reference)?;
            let name = || variable.name.clone();
            if variable.causality != Causality::Input {
                let why = "no input, and only inputs have input derivatives";
                return Err(Error::NotSettable { name: name(), why });
            }
            if !(1..=2).contains(&order) {
                let name = name();
                return Err(Error::DerivativeOrder { name, order });
            }
            check_finite(&variable.name, value)?;
        }
        let quantities = &self.quantities;
        self.model.set_input_derivatives(
            entries.map(|((&vr, &order), &value)| (quantities[place(vr)], order as usize, value)),
        );
        Ok(())
    }

    /// `fmi2GetReal`. Writes all values or none.
    ///
    /// # Errors
    ///
    /// As [`reals`](Self::reals).
    pub fn get_real(&mut self, value_references: &[u32], values: &mut [f64]) -> Result<(), Error> {
        for (to, value) in values.iter_mut().zip(self.reals(value_references)?) {
            *to = value;
        }
        Ok(())
    }

    /// Returns the values of Real variables in the order of their references. Computes only the
    /// groups that are asked for.
    ///
    /// # Errors
    ///
    /// A variable is unknown or no Real; or it has no value for the values set.
    #[inline(always)]
    pub fn reals<'a>(&'a mut self, value_references: &'a [u32]) -> Result<Reals<'a>, Error> {
        self.allow(Call::GetReal)?;
        if self.request.references != value_references {
            self.note_request(value_references)?;
        }
        let groups = self.request.groups;
        if self.version == Version::Fmi3 {
            self.check_readable(value_references)?;
        }
        self.refresh(Call::GetReal, groups)?;
        let values = self.model.reals();
        Ok(Reals(match self.request.run.clone() {
            Some(run) => Places::Consecutive(values[run].iter()),
            None => Places::Scattered(value_references.iter(), values),
        }))
    }

    /// Notes a list of Reals that the host asks for.
    ///
    /// # Errors
    ///
    /// A variable is unknown or no Real.
    fn note_request(&mut self, value_references: &[u32]) -> Result<(), Error> {
        let group = |&vr: &u32| self.groups.get(place(vr)).copied().unwrap_or(NO_REAL);
        let groups = value_references.iter().map(group).fold(0, |a, b| a | b);
        if groups & NO_REAL != 0 {
            return Err(self.why_not_real(value_references));
        }
        let Request { references, .. } = &mut self.request;
        references.clear();
        references.extend_from_slice(value_references);
        self.request.groups = groups;
        self.request.run = consecutive(value_references);
        Ok(())
    }

    /// Returns the error for the first reference that is no Real.
    #[cold]
    fn why_not_real(&self, value_references: &[u32]) -> Error {
        let mut variables = value_references.iter().map(|&vr| self.variable(vr));
        let first = variables.find(|v| !v.as_ref().is_ok_and(|v| v.kind.is_real_in(self.version)));
        match first.expect("the caller has found one") {
            Ok(variable) => self.wrong_type(variable, "Real"),
            Err(unknown) => unknown,
        }
    }

    /// Returns the values of Integer and Enumeration variables in the order of their references.
    ///
    /// # Errors
    ///
    /// A variable is unknown, or neither Integer nor Enumeration.
    pub fn integers<'a>(
        &'a mut self,
        value_references: &'a [u32],
    ) -> Result<impl Iterator<Item = i32> + 'a, Error> {
        self.allow(Call::GetInteger)?;
        for &value_reference in value_references {
            let variable = self.variable(value_reference)?;
            if variable.kind.is_real_in(self.version) {
                return Err(self.wrong_type(variable, "Integer or Enumeration"));
            }
        }
        let (model, quantities) = (&self.model, &self.quantities);
        let values = value_references.iter();
        Ok(values.map(|&vr| model.integer(quantities[place(vr)])))
    }

    /// `fmi2GetRealOutputDerivatives`: returns time derivatives of outputs in the order of their
    /// references, 0 for a derivative that the model does not know (4.2.1).
    ///
    /// # Errors
    ///
    /// A variable is no output, an order is below 1 or above that of [`Model::CAPABILITIES`]; or
    /// the output has no value for the values set.
    pub fn output_derivatives<'a>(
        &'a mut self,
        value_references: &'a [u32],
        orders: &'a [i32],
    ) -> Result<impl Iterator<Item = f64> + 'a, Error> {
        self.allow(Call::GetRealOutputDerivatives)?;
        let entries = value_references.iter().zip(orders);
        let mut groups = 0;
        for (&value_reference, &order) in entries.clone() {
            let variable = self.variable(value_reference)?;
            let name = || variable.name.clone();
            if !variable.causality.is_output() {
                return Err(Error::NotOutput { name: name() });
            }
            let highest = M::CAPABILITIES.output_derivatives;
            if !(1..=highest).contains(&order) {
                return Err(Error::OutputDerivativeOrder {
                    name: name(),
                    order,
                    highest,
                });
            }
            if let Some(derivative) = self.derivative(value_reference, order) {
                groups |= self.groups[derivative];
            }
        }
        self.check_readable(value_references)?;
        self.refresh(Call::GetRealOutputDerivatives, groups)?;
        Ok(entries.map(|(&value_reference, &order)| {
            let derivative = self.derivative(value_reference, order);
            derivative.map_or(0.0, |place| self.model.reals()[place])
        }))
    }

    /// Returns the place of a variable's time derivative.
    fn derivative(&self, value_reference: u32, order: i32) -> Option<usize> {
        (0..order).try_fold(place(value_reference), |place, _| self.derivatives[place])
    }

    #[inline(always)]
    pub(super) fn refresh(&mut self, call: Call, groups: Groups) -> Result<(), Error> {
        let phase = self.lifecycle.state.phase(self.interface);
        self.model
            .refresh(groups, phase, &self.logger)
            .map_err(|failure| self.failed(call, failure))
    }

    pub(super) fn variable(&self, value_reference: u32) -> Result<&Variable<M::Quantity>, Error> {
        let variables = self.variables();
        variables
            .get(place(value_reference))
            .ok_or(Error::ValueReference {
                value_reference,
                last: variables.len(),
            })
    }

    /// Returns the error for a variable of another type than `expected`.
    #[cold]
    fn wrong_type(&self, variable: &Variable<M::Quantity>, expected: &'static str) -> Error {
        Error::Type {
            name: variable.name.clone(),
            actual: variable.kind.name(self.version),
            expected: match (self.version, expected) {
                (Version::Fmi3, "Real") => "Float64",
                (Version::Fmi3, "Integer or Enumeration") => "Enumeration",
                _ => expected,
            },
        }
    }

    /// Returns a variable that has this type and that the host may set in the present state.
    fn settable(
        &self,
        value_reference: u32,
        expected: &'static str,
    ) -> Result<&Variable<M::Quantity>, Error> {
        let variable = self.variable(value_reference)?;
        if variable.kind.is_real_in(self.version) != (expected == "Real") {
            return Err(self.wrong_type(variable, expected));
        }
        let initializing = matches!(
            self.lifecycle.state,
            State::Instantiated | State::InitializationMode
        );
        let why = match variable.causality {
            Causality::Input
                if variable.variability == Variability::Continuous
                    || self.lifecycle.state != State::ContinuousTimeMode =>
            {
                return Ok(variable);
            }
            Causality::Input => "a discrete input, which changes in event mode",
            Causality::Parameter | Causality::StartedOutput | Causality::State if initializing => {
                return Ok(variable);
            }
            Causality::Parameter if variable.variability == Variability::Fixed => {
                "a fixed parameter, and initialization has ended"
            }
            Causality::Parameter if self.lifecycle.state == State::ContinuousTimeMode => {
                "a tunable parameter, which changes in event mode"
            }
            Causality::Parameter => return Ok(variable),
            Causality::CalculatedParameter => "a parameter derived from others",
            Causality::Output => "an output",
            Causality::StartedOutput => "an output, and initialization has ended",
            Causality::State => "a state, and initialization has ended",
            Causality::LocalState => "a state, which initialization computes",
            Causality::Local => "about the solver",
            Causality::EventIndicator => "an event indicator",
            Causality::Independent => "the time",
        };
        Err(Error::NotSettable {
            name: variable.name.clone(),
            why,
        })
    }
}

/// Returns the range of places that follow one another, as nearly all hosts ask for them.
fn consecutive(value_references: &[u32]) -> Option<Range<usize>> {
    let first = place(*value_references.first()?);
    let run = first..first + value_references.len();
    let given = value_references.iter().map(|&vr| place(vr));
    given.eq(run.clone()).then_some(run)
}

/// The Reals that the host asked for last. Hosts ask for the same ones at every step.
#[derive(Debug)]
pub(super) struct Request {
    references: Vec<u32>,
    groups: Groups,
    /// The places as a range, if they follow one another.
    run: Option<Range<usize>>,
}

/// Values of Real variables in the order of their references.
#[derive(Debug)]
pub struct Reals<'a>(Places<'a>);

#[derive(Debug)]
enum Places<'a> {
    Consecutive(Iter<'a, f64>),
    /// References and the values of all variables.
    Scattered(Iter<'a, u32>, &'a [f64]),
}

impl Request {
    /// Makes the storage.
    pub(super) fn new(variables: usize) -> Self {
        Self {
            references: Vec::with_capacity(variables),
            groups: 0,
            run: None,
        }
    }
}

impl Reals<'_> {
    /// Writes the values from the first item on, as many as have room.
    #[inline]
    pub fn write_to(self, items: &mut [MaybeUninit<impl From<f64>>]) {
        // A loop for each variant, rather than a choice for each value.
        match self.0 {
            Places::Consecutive(values) => write_to(items, values.copied()),
            Places::Scattered(references, values) => {
                write_to(items, references.map(|&vr| values[place(vr)]));
            }
        }
    }
}

#[inline]
fn write_to(items: &mut [MaybeUninit<impl From<f64>>], values: impl Iterator<Item = f64>) {
    for (item, value) in items.iter_mut().zip(values) {
        item.write(value.into());
    }
}

impl Iterator for Reals<'_> {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        match &mut self.0 {
            Places::Consecutive(values) => values.next().copied(),
            Places::Scattered(references, values) => Some(values[place(*references.next()?)]),
        }
    }
}

/// Checks a value of a Real parameter.
pub(in crate::fmi) fn check_value<Q>(variable: &Variable<Q>, value: f64) -> Result<(), Error> {
    let limits = match variable.kind {
        Kind::Real { min, max, .. } => [min, max],
        Kind::Integer | Kind::Enumeration { .. } => [None; 2],
    };
    check_limits(&variable.name, value, limits)
}

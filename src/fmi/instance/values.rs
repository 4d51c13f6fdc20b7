//! Setting and getting variables, and their derivatives.

use std::ops::Range;
use std::slice::Iter;

use super::{Error, Instance, check_finite};
use crate::fmi::error::check_limits;
use crate::fmi::model::Model;
use crate::fmi::state::{Call, State};
use crate::fmi::variable::{Causality, Kind, Variability, Variable};

impl<M: Model> Instance<M> {
    /// `fmi2SetReal`. Either all values are taken or none.
    ///
    /// # Errors
    ///
    /// A variable is unknown, no Real, or not to be set now; a value is not finite or outside
    /// `min` and `max`.
    pub fn set_real(&mut self, value_references: &[u32], values: &[f64]) -> Result<(), Error> {
        self.allow(Call::SetReal)?;
        for (&value_reference, &value) in value_references.iter().zip(values) {
            let free = self.free_inputs.get(value_reference as usize);
            if !(free == Some(&true) && value.is_finite()) {
                let variable = self.settable(value_reference, "Real")?;
                check_value(variable, value)?;
            }
        }
        let quantities = &self.quantities;
        let values = value_references.iter().zip(values);
        self.model
            .set_reals(values.map(|(&vr, &value)| (quantities[vr as usize], value)));
        Ok(())
    }

    /// `fmi2SetInteger`, for enumerations as well. Either all values are taken or none.
    ///
    /// # Errors
    ///
    /// A variable is unknown, no Integer or Enumeration, or not to be set now; a value is no
    /// item of its enumeration.
    pub fn set_integer(&mut self, value_references: &[u32], values: &[i32]) -> Result<(), Error> {
        self.allow(Call::SetInteger)?;
        for (&value_reference, &value) in value_references.iter().zip(values) {
            let variable = self.settable(value_reference, "Integer or Enumeration")?;
            if let Kind::Enumeration(enumeration) = variable.kind
                && !(1..=enumeration.items.len()).contains(&(value as usize))
            {
                return Err(Error::Item {
                    name: variable.name.clone(),
                    value,
                    count: enumeration.items.len(),
                });
            }
        }
        let quantities = &self.quantities;
        let values = value_references.iter().zip(values);
        self.model
            .set_integers(values.map(|(&vr, &value)| (quantities[vr as usize], value)));
        Ok(())
    }

    /// `fmi2SetBoolean` and `fmi2SetString`: there are no such variables, so that only an empty
    /// list is right. The same holds for getting them.
    ///
    /// # Errors
    ///
    /// There is any value reference.
    pub fn no_variables(
        &self,
        call: Call,
        expected: &'static str,
        value_references: &[u32],
    ) -> Result<(), Error> {
        self.allow(call)?;
        match value_references {
            [] => Ok(()),
            [first, ..] => Err(wrong_type(self.variable(*first)?, expected)),
        }
    }

    /// `fmi2SetRealInputDerivatives`: derivatives of inputs for the next step.
    ///
    /// # Errors
    ///
    /// A variable is no input, an order is not 1 or 2, or a value is not finite; none is taken
    /// then.
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
            if variable.causality != Causality::Input {
                return Err(Error::NotSettable {
                    name: variable.name.clone(),
                    why: "no input, and only inputs have input derivatives",
                });
            }
            if !(1..=2).contains(&order) {
                return Err(Error::DerivativeOrder {
                    name: variable.name.clone(),
                    order,
                });
            }
            check_finite(&variable.name, value)?;
        }
        let quantities = &self.quantities;
        self.model.set_input_derivatives(
            entries.map(|((&vr, &order), &value)| (quantities[vr as usize], order as usize, value)),
        );
        Ok(())
    }

    /// `fmi2GetReal`. Computes what is asked for and not known yet.
    ///
    /// # Errors
    ///
    /// As [`reals`](Self::reals); nothing is written then.
    pub fn get_real(&mut self, value_references: &[u32], values: &mut [f64]) -> Result<(), Error> {
        for (to, value) in values.iter_mut().zip(self.reals(value_references)?) {
            *to = value;
        }
        Ok(())
    }

    /// The values of Real variables, in the order of their references.
    ///
    /// # Errors
    ///
    /// A variable is unknown or no Real; or it has no value for the values set.
    pub fn reals<'a>(
        &'a mut self,
        value_references: &'a [u32],
    ) -> Result<impl Iterator<Item = f64> + 'a, Error> {
        self.allow(Call::GetReal)?;
        if let Some(places) = self.places_in_row(value_references) {
            let phase = self.state.phase();
            let values = self.model.row_values(places, phase, &self.logger)?;
            return Ok(Reals::InRow(values.iter()));
        }
        for &value_reference in value_references {
            let variable = self.variable(value_reference)?;
            if !variable.kind.is_real() {
                return Err(wrong_type(variable, "Real"));
            }
            self.make_ready(variable.quantity)?;
        }
        Ok(Reals::OneByOne {
            model: &mut self.model,
            quantities: &self.quantities,
            left: value_references.iter(),
        })
    }

    /// The places in the model's row that are asked for, if they are next to each other.
    #[inline]
    fn places_in_row(&self, value_references: &[u32]) -> Option<Range<usize>> {
        let first = *value_references.first()?;
        let count = value_references.len();
        let end = (first as usize).checked_add(count)?;
        if first < self.row.start || end > self.row.end as usize {
            return None;
        }
        // No branch a reference: quicker, as nearly all hosts ask like this.
        let differences = (first..).zip(value_references);
        let differ = differences.fold(0, |differ, (expected, given)| differ | (expected ^ given));
        let start = (first - self.row.start) as usize;
        (differ == 0).then_some(start..start + count)
    }

    /// `fmi2GetInteger`, for enumerations as well.
    ///
    /// # Errors
    ///
    /// As [`integers`](Self::integers); nothing is written then.
    pub fn get_integer(
        &mut self,
        value_references: &[u32],
        values: &mut [i32],
    ) -> Result<(), Error> {
        for (to, value) in values.iter_mut().zip(self.integers(value_references)?) {
            *to = value;
        }
        Ok(())
    }

    /// The values of Integer and Enumeration variables, in the order of their references.
    ///
    /// # Errors
    ///
    /// A variable is unknown or neither Integer nor Enumeration; or it has no value for the
    /// values set.
    pub fn integers<'a>(
        &'a mut self,
        value_references: &'a [u32],
    ) -> Result<impl Iterator<Item = i32> + 'a, Error> {
        self.allow(Call::GetInteger)?;
        for &value_reference in value_references {
            let variable = self.variable(value_reference)?;
            if variable.kind.is_real() {
                return Err(wrong_type(variable, "Integer or Enumeration"));
            }
            self.make_ready(variable.quantity)?;
        }
        let (model, quantities) = (&mut self.model, &self.quantities);
        let values = value_references.iter();
        Ok(values.map(|&vr| model.integer(quantities[vr as usize])))
    }

    /// `fmi2GetRealOutputDerivatives`: derivatives of outputs with respect to time, in the order
    /// of their references.
    ///
    /// # Errors
    ///
    /// [`Error::NoOutputDerivative`] for one that does not exist; a variable is no output, an
    /// order is below 1; or it has no value for the values set.
    pub fn output_derivatives<'a>(
        &'a mut self,
        value_references: &'a [u32],
        orders: &'a [i32],
    ) -> Result<impl Iterator<Item = f64> + 'a, Error> {
        self.allow(Call::GetRealOutputDerivatives)?;
        let entries = value_references.iter().zip(orders);
        for (&value_reference, &order) in entries.clone() {
            let variable = self.variable(value_reference)?;
            let name = || variable.name.clone();
            if variable.causality != Causality::Output {
                return Err(Error::NotOutput { name: name() });
            }
            if order < 1 {
                let name = name();
                return Err(Error::OutputDerivativeOrder { name, order });
            }
            let derivative = self.model.time_derivative(variable.quantity, order as u32);
            let Some(derivative) = derivative else {
                let name = name();
                return Err(Error::NoOutputDerivative { name, order });
            };
            self.make_ready(derivative)?;
        }
        let (model, quantities) = (&mut self.model, &self.quantities);
        Ok(entries.map(|(&vr, &order)| {
            let derivative = model.time_derivative(quantities[vr as usize], order as u32);
            model.real(derivative.expect("checked above"))
        }))
    }

    /// `fmi2GetDirectionalDerivative`: how outputs change along a direction in the space of
    /// inputs; in initialization mode also calculated parameters, and along parameters.
    ///
    /// # Errors
    ///
    /// A variable is not one of these, or given twice; a change is not finite; or there is no
    /// derivative for the values set.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        changes: &[f64],
    ) -> Result<Vec<f64>, Error> {
        self.allow(Call::GetDirectionalDerivative)?;
        let initializing = self.state == State::InitializationMode;
        let refuse = |variable: &Variable<_>, role| {
            Err(Error::NoDerivative {
                name: variable.name.clone(),
                role,
            })
        };
        let mut directions = Vec::with_capacity(knowns.len());
        for (&value_reference, &change) in knowns.iter().zip(changes) {
            let variable = self.variable(value_reference)?;
            let known = match variable.causality {
                Causality::Input => true,
                Causality::Parameter => initializing && variable.kind.is_real(),
                _ => false,
            };
            if !known {
                return refuse(variable, "derivatives are taken by inputs");
            }
            check_finite(&variable.name, change)?;
            directions.push((variable.quantity, change));
        }
        let mut wanted = Vec::with_capacity(unknowns.len());
        for &value_reference in unknowns {
            let variable = self.variable(value_reference)?;
            let unknown = match variable.causality {
                Causality::Output => true,
                Causality::CalculatedParameter => initializing,
                _ => false,
            };
            if !unknown {
                return refuse(variable, "derivatives are taken of outputs");
            }
            wanted.push(variable.quantity);
        }
        for &quantity in &wanted {
            self.make_ready(quantity)?;
        }
        let phase = self.state.phase();
        let logger = &self.logger;
        Ok(self
            .model
            .directional_derivatives(&wanted, &directions, phase, logger)?)
    }

    fn make_ready(&mut self, quantity: M::Quantity) -> Result<(), Error> {
        let phase = self.state.phase();
        Ok(self.model.make_ready(quantity, phase, &self.logger)?)
    }

    fn variable(&self, value_reference: u32) -> Result<&Variable<M::Quantity>, Error> {
        let variables = self.variables();
        variables
            .get(value_reference as usize)
            .ok_or_else(|| Error::ValueReference {
                value_reference,
                last: variables.len().saturating_sub(1),
            })
    }

    /// The variable, if it has this type and can be set in the present state.
    fn settable(
        &self,
        value_reference: u32,
        expected: &'static str,
    ) -> Result<&Variable<M::Quantity>, Error> {
        let variable = self.variable(value_reference)?;
        if variable.kind.is_real() != (expected == "Real") {
            return Err(wrong_type(variable, expected));
        }
        let initializing = matches!(self.state, State::Instantiated | State::InitializationMode);
        let why = match variable.causality {
            Causality::Input
                if variable.variability == Variability::Continuous
                    || self.state != State::ContinuousTimeMode =>
            {
                return Ok(variable);
            }
            Causality::Input => "a discrete input, which changes in event mode",
            Causality::Parameter if initializing => return Ok(variable),
            Causality::Parameter if variable.variability == Variability::Fixed => {
                "a fixed parameter, and initialization has ended"
            }
            Causality::Parameter if self.state == State::ContinuousTimeMode => {
                "a tunable parameter, which changes in event mode"
            }
            Causality::Parameter => return Ok(variable),
            Causality::CalculatedParameter => "a parameter derived from others",
            Causality::Output => "an output",
            Causality::Local => "about the solver",
            Causality::Independent => "the time",
        };
        Err(Error::NotSettable {
            name: variable.name.clone(),
            why,
        })
    }
}

/// The values of Real variables that are ready, in the order of their references.
enum Reals<'a, M: Model> {
    InRow(Iter<'a, f64>),
    OneByOne {
        model: &'a mut M,
        quantities: &'a [M::Quantity],
        left: Iter<'a, u32>,
    },
}

impl<M: Model> Iterator for Reals<'_, M> {
    type Item = f64;

    #[inline]
    fn next(&mut self) -> Option<f64> {
        match self {
            Self::InRow(values) => values.next().copied(),
            Self::OneByOne {
                model,
                quantities,
                left,
            } => Some(model.real(quantities[*left.next()? as usize])),
        }
    }

    #[inline]
    fn fold<B, F: FnMut(B, f64) -> B>(self, start: B, f: F) -> B {
        match self {
            Self::InRow(values) => values.copied().fold(start, f),
            Self::OneByOne {
                model,
                quantities,
                left,
            } => left
                .map(|&vr| model.real(quantities[vr as usize]))
                .fold(start, f),
        }
    }
}

/// Whether a Real variable can have a value.
pub(in crate::fmi) fn check_value<Q>(variable: &Variable<Q>, value: f64) -> Result<(), Error> {
    let limits = match variable.kind {
        Kind::Real { min, max, .. } => [min, max],
        _ => [None; 2],
    };
    check_limits(&variable.name, value, limits)
}

fn wrong_type<Q>(variable: &Variable<Q>, expected: &'static str) -> Error {
    Error::Type {
        name: variable.name.clone(),
        actual: variable.kind.name(),
        expected,
    }
}

//! Setting and getting variables.

use std::slice::Iter;

use super::{Error, Freshness, Instance, check_finite};
use crate::fmi::inputs::{Extrapolation, RateSource};
use crate::fmi::state::{Call, State};
use crate::fmi::variables::{Causality, Kind, Order, Quantity, Variability, Variable, Variables};

impl Instance {
    /// `fmi2SetReal`. Either all values are taken or none.
    ///
    /// # Errors
    ///
    /// A variable is unknown, no Real, or not to be set now; a value is not finite or outside
    /// `min` and `max`.
    pub fn set_real(&mut self, value_references: &[u32], values: &[f64]) -> Result<(), Error> {
        self.allow(Call::SetReal)?;
        for (&value_reference, &value) in value_references.iter().zip(values) {
            // Inputs have no limits.
            let is_input = self.variables.input(value_reference).is_some();
            if !(is_input && value.is_finite()) {
                let variable = self.settable(value_reference, "Real")?;
                check_value(variable, value)?;
            }
        }
        let mut parameters_changed = false;
        for (&value_reference, &value) in value_references.iter().zip(values) {
            if let Some((driver, order)) = self.variables.input(value_reference) {
                self.inputs[driver.index()].set(order, value);
                continue;
            }
            match self.variables.list()[value_reference as usize].quantity {
                Quantity::Parameter(parameter) => {
                    self.settings.parameters[parameter.index()] = value;
                    parameters_changed = true;
                }
                _ => unreachable!("`settable` passes inputs and parameters only"),
            }
        }
        if parameters_changed {
            self.mechanism
                .derive_parameters(&mut self.settings.parameters);
        }
        if !value_references.is_empty() {
            self.freshness = Freshness::Stale;
        }
        Ok(())
    }

    /// `fmi2SetInteger`: the choices `rates` and `extrapolation`.
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
        for (&value_reference, &value) in value_references.iter().zip(values) {
            let item = value as usize - 1;
            match self.variables.list()[value_reference as usize].quantity {
                Quantity::RateSource => self.settings.rates = RateSource::ALL[item],
                Quantity::Extrapolation => self.settings.extrapolation = Extrapolation::ALL[item],
                _ => unreachable!("`settable` passes the two choices only"),
            }
            self.freshness = Freshness::Stale;
        }
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
            [first, ..] => {
                let variable = self.variable(*first)?;
                Err(Error::Type {
                    name: variable.name.clone(),
                    actual: type_name(variable),
                    expected,
                })
            }
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
        let entries = || value_references.iter().zip(orders).zip(values);
        for ((&value_reference, &order), &value) in entries() {
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
        for ((&value_reference, &order), &value) in entries() {
            let quantity = self.variables.list()[value_reference as usize].quantity;
            if let Quantity::Input(driver, input) = quantity {
                self.inputs[driver.index()].set_derivative(input, order as usize, value);
            }
        }
        if !value_references.is_empty() {
            self.freshness = Freshness::Stale;
        }
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
    /// A variable is unknown or no Real; or there is no pose, or no rates, for the values set.
    pub fn reals<'a>(
        &'a mut self,
        value_references: &'a [u32],
    ) -> Result<impl Iterator<Item = f64> + 'a, Error> {
        self.allow(Call::GetReal)?;
        // Coordinates of bodies and their rates are what most hosts ask for, and nothing else.
        let places = self.variables.places();
        let last = value_references.iter().map(|&value_reference| {
            let place = places.get(value_reference as usize);
            place.copied().unwrap_or(Variables::ELSEWHERE)
        });
        let last = last.fold(0, u32::max) as usize;
        let value_references_left = value_references.iter();
        if last < self.coordinates.len() && !value_references.is_empty() {
            let coordinates = 3 * self.mechanism.bodies.len();
            let values = if last < coordinates {
                self.refresh_pose()?;
                &self.solver.pose().q[..coordinates]
            } else {
                self.refresh_rates()?;
                &self.coordinates
            };
            return Ok(Reals::Coordinates {
                places: self.variables.places(),
                values,
                value_references: value_references_left,
            });
        }
        for &value_reference in value_references {
            let variable = self.variable(value_reference)?;
            if !matches!(variable.kind, Kind::Real { .. }) {
                return Err(Error::Type {
                    name: variable.name.clone(),
                    actual: type_name(variable),
                    expected: "Real",
                });
            }
            self.make_ready(variable.quantity)?;
        }
        Ok(Reals::Any {
            instance: self,
            value_references: value_references_left,
        })
    }

    /// `fmi2GetInteger`: counts of the last step, and the choices.
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
    /// A variable is unknown or neither Integer nor Enumeration; or there is no pose.
    pub fn integers<'a>(
        &'a mut self,
        value_references: &'a [u32],
    ) -> Result<impl Iterator<Item = i32> + 'a, Error> {
        self.allow(Call::GetInteger)?;
        for &value_reference in value_references {
            let variable = self.variable(value_reference)?;
            if matches!(variable.kind, Kind::Real { .. }) {
                return Err(Error::Type {
                    name: variable.name.clone(),
                    actual: type_name(variable),
                    expected: "Integer or Enumeration",
                });
            }
            self.make_ready(variable.quantity)?;
        }
        Ok(value_references.iter().map(|&value_reference| {
            self.integer(self.variables.list()[value_reference as usize].quantity)
        }))
    }

    /// `fmi2GetRealOutputDerivatives`: exact derivatives of outputs with respect to time, in the
    /// order of their references.
    ///
    /// # Errors
    ///
    /// [`Error::NoOutputDerivative`] for one that does not exist; a variable is no output, an
    /// order is below 1; or there is no pose, or no rates, for the values set.
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
            let Some(derivative) = variable.quantity.derivative(order as usize) else {
                let name = name();
                return Err(Error::NoOutputDerivative { name, order });
            };
            self.make_ready(derivative)?;
        }
        Ok(entries.map(|(&value_reference, &order)| {
            let output = self.variables.list()[value_reference as usize].quantity;
            let derivative = output.derivative(order as usize);
            self.real(derivative.expect("checked above"))
        }))
    }

    fn variable(&self, value_reference: u32) -> Result<&Variable, Error> {
        self.variables
            .get(value_reference)
            .ok_or_else(|| Error::ValueReference {
                value_reference,
                last: self.variables.list().len() - 1,
            })
    }

    /// The variable, if it has this type and can be set in the present state.
    fn settable(&self, value_reference: u32, expected: &'static str) -> Result<&Variable, Error> {
        let variable = self.variable(value_reference)?;
        let is_real = matches!(variable.kind, Kind::Real { .. });
        if is_real != (expected == "Real") {
            return Err(Error::Type {
                name: variable.name.clone(),
                actual: type_name(variable),
                expected,
            });
        }
        let why = match variable.causality {
            Causality::Input => return Ok(variable),
            Causality::Parameter
                if variable.variability == Variability::Tunable
                    || self.state != State::StepComplete =>
            {
                return Ok(variable);
            }
            Causality::Parameter => "a fixed parameter, and initialization has ended",
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

    /// Computes what the value of a variable is read from.
    fn make_ready(&mut self, quantity: Quantity) -> Result<(), Error> {
        match quantity {
            Quantity::Input(..)
            | Quantity::Parameter(_)
            | Quantity::RateSource
            | Quantity::Extrapolation
            | Quantity::Time => Ok(()),
            Quantity::Body(_, _, order)
            | Quantity::Marker(_, _, order)
            | Quantity::Measure(_, order)
            | Quantity::Motion(_, order)
                if order > Order::Position =>
            {
                self.refresh_rates()
            }
            _ => self.refresh_pose(),
        }
    }

    /// The value of a Real variable that is [ready](Self::make_ready).
    fn real(&mut self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Input(driver, order) => self.inputs[driver.index()].get(order),
            Quantity::Parameter(parameter) => self.settings.parameters[parameter.index()],
            Quantity::Time => self.time,
            Quantity::Residual => self.solver.residual(),
            Quantity::Rcond => self.solver.rcond(),
            output => output.read(&self.solver, &self.rates, &self.driver_rates),
        }
    }

    /// The value of an Integer or Enumeration variable that is [ready](Self::make_ready).
    fn integer(&self, quantity: Quantity) -> i32 {
        let count = match quantity {
            Quantity::RateSource => return self.settings.rates as i32,
            Quantity::Extrapolation => return self.settings.extrapolation as i32,
            Quantity::Iterations => self.progress.iterations,
            Quantity::Substeps => self.progress.substeps,
            _ => unreachable!("all other variables are Reals"),
        };
        i32::try_from(count).unwrap_or(i32::MAX)
    }
}

/// The values of Real variables that are ready, in the order of their references.
enum Reals<'a> {
    Coordinates {
        places: &'a [u32],
        values: &'a [f64],
        value_references: Iter<'a, u32>,
    },
    Any {
        instance: &'a mut Instance,
        value_references: Iter<'a, u32>,
    },
}

impl Iterator for Reals<'_> {
    type Item = f64;

    #[inline]
    fn next(&mut self) -> Option<f64> {
        match self {
            Self::Coordinates {
                places,
                values,
                value_references,
            } => {
                let place = places[*value_references.next()? as usize];
                Some(values[place as usize])
            }
            Self::Any {
                instance,
                value_references,
            } => {
                let index = *value_references.next()? as usize;
                Some(instance.real(instance.variables.list()[index].quantity))
            }
        }
    }
}

pub(super) fn check_value(variable: &Variable, value: f64) -> Result<(), Error> {
    check_finite(&variable.name, value)?;
    if let Kind::Real { min, max, .. } = variable.kind
        && (min.is_some_and(|min| value < min) || max.is_some_and(|max| value > max))
    {
        return Err(Error::Range {
            name: variable.name.clone(),
            value,
            min,
            max,
        });
    }
    Ok(())
}

fn type_name(variable: &Variable) -> &'static str {
    match variable.kind {
        Kind::Real { .. } => "a Real",
        Kind::Integer => "an Integer",
        Kind::Enumeration(_) => "an Enumeration",
    }
}

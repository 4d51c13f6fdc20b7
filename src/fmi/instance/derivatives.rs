//! Directional and adjoint derivatives, and the dependencies of variables.

use super::{Error, Instance, check_finite};
use crate::fmi::model::Model;
use crate::fmi::model_description::DependencyKind;
use crate::fmi::state::{Call, State, Version};
use crate::fmi::variable::{Causality, Variable};

impl<M: Model> Instance<M> {
    /// `fmi2GetDirectionalDerivative`, `fmi3GetDirectionalDerivative`: returns the directional
    /// derivatives of outputs by inputs and time, in FMI 3.0 by parameters as well; in
    /// initialization mode also of calculated parameters and by parameters.
    ///
    /// # Errors
    ///
    /// A variable is none of these; a change is not finite; or the derivative does not exist for
    /// the values set.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        changes: &[f64],
    ) -> Result<Vec<f64>, Error> {
        self.allow(Call::GetDirectionalDerivative)?;
        let directions = self.knowns(knowns, changes)?;
        let wanted = self.unknowns(unknowns)?;
        self.derivatives_along(Call::GetDirectionalDerivative, &wanted, &directions)
    }

    /// `fmi3GetAdjointDerivative`: returns, per known, the sum over the unknowns of ∂unknown/∂known
    /// times the unknown's weight (FMI 3.0, 2.2.11).
    ///
    /// # Errors
    ///
    /// As [`directional_derivative`](Self::directional_derivative).
    pub fn adjoint_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        weights: &[f64],
    ) -> Result<Vec<f64>, Error> {
        self.allow(Call::GetAdjointDerivative)?;
        let wanted = self.unknowns(unknowns)?;
        self.check_all_finite(unknowns, weights)?;
        let directions = self.knowns(knowns, &vec![1.0; knowns.len()])?;
        let sum = |direction| {
            let column =
                self.derivatives_along(Call::GetAdjointDerivative, &wanted, &[direction])?;
            Ok(column.iter().zip(weights).map(|(d, w)| d * w).sum())
        };
        directions.into_iter().map(sum).collect()
    }

    fn derivatives_along(
        &mut self,
        call: Call,
        unknowns: &[M::Quantity],
        directions: &[(M::Quantity, f64)],
    ) -> Result<Vec<f64>, Error> {
        let phase = self.lifecycle.state.phase(self.interface);
        let logger = &self.logger;
        self.model
            .directional_derivatives(unknowns, directions, phase, logger)
            .map_err(|failure| self.failed(call, failure))
    }

    /// Returns the knowns of derivatives with their changes.
    fn knowns(
        &self,
        value_references: &[u32],
        changes: &[f64],
    ) -> Result<Vec<(M::Quantity, f64)>, Error> {
        let initializing = self.lifecycle.state == State::InitializationMode;
        let (by_parameters, role) = match self.version {
            Version::Fmi2 => (
                initializing,
                "derivatives are taken by inputs and time, in initialization mode of calculated \
                 parameters and by parameters as well",
            ),
            Version::Fmi3 => (true, "derivatives are taken by inputs, parameters and time"),
        };
        let knowns = self.in_role(value_references, role, |variable| {
            match variable.causality {
                Causality::Input | Causality::State | Causality::LocalState => true,
                Causality::StartedOutput => initializing,
                Causality::Independent => true,
                Causality::Parameter => by_parameters && variable.kind.is_real(),
                _ => false,
            }
        })?;
        self.check_all_finite(value_references, changes)?;
        Ok(knowns.into_iter().zip(changes.iter().copied()).collect())
    }

    /// Returns the unknowns of derivatives.
    fn unknowns(&self, value_references: &[u32]) -> Result<Vec<M::Quantity>, Error> {
        let initializing = self.lifecycle.state == State::InitializationMode;
        let role = match self.version {
            Version::Fmi2 => {
                "derivatives are taken of outputs, in initialization mode of calculated \
                 parameters and by parameters as well"
            }
            Version::Fmi3 => {
                "derivatives are taken of outputs, in initialization mode of calculated \
                 parameters as well"
            }
        };
        self.check_readable(value_references)?;
        self.in_role(value_references, role, |variable| {
            match variable.causality {
                Causality::CalculatedParameter => initializing,
                _ => variable.is_unknown(),
            }
        })
    }

    /// Returns the quantities of variables, of which each may have a role in derivatives.
    fn in_role(
        &self,
        value_references: &[u32],
        role: &'static str,
        is_permitted: impl Fn(&Variable<M::Quantity>) -> bool,
    ) -> Result<Vec<M::Quantity>, Error> {
        let quantity = |&value_reference: &u32| {
            let variable = self.variable(value_reference)?;
            if is_permitted(variable) {
                Ok(variable.quantity)
            } else {
                let name = variable.name.clone();
                Err(Error::NoDerivative { name, role })
            }
        };
        value_references.iter().map(quantity).collect()
    }

    /// Checks the changes or the weights of variables.
    fn check_all_finite(&self, value_references: &[u32], values: &[f64]) -> Result<(), Error> {
        let mut values = value_references.iter().zip(values);
        values.try_for_each(|(vr, value)| check_finite(&self.variable(*vr)?.name, *value))
    }

    /// `fmi3GetNumberOfVariableDependencies`, `fmi3GetVariableDependencies`: returns the value
    /// references that a variable depends on, and the kind of each dependency: those of
    /// initialization mode before its end, and the others after it. None for variables that
    /// nothing computes.
    ///
    /// # Errors
    ///
    /// The variable is unknown.
    pub fn dependencies(
        &self,
        call: Call,
        value_reference: u32,
    ) -> Result<Vec<(u32, DependencyKind)>, Error> {
        self.allow(call)?;
        self.variable(value_reference)?;
        let initializing = matches!(
            self.lifecycle.state,
            State::Instantiated | State::InitializationMode
        );
        Ok(self.model.dependencies(value_reference, initializing))
    }
}

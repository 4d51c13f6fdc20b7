//! The model description of a mechanism's FMU.

use std::collections::BTreeSet;

use super::guid;
use super::variables::{Order, Quantity, variables};
use crate::fmi::model_description::{Capabilities, Experiment, ModelDescription, Unknown};
use crate::fmi::variable::{Causality, Variable};
use crate::kinematics::{Dependencies, Structure};
use crate::mechanism::Mechanism;

/// Capabilities of a [`MechanismModel`](super::MechanismModel).
const CAPABILITIES: Capabilities = Capabilities {
    interpolates_inputs: true,
    output_derivatives: 2,
    directional_derivatives: true,
};

/// Returns the model description of a mechanism's FMU.
#[must_use]
pub fn describe<'a>(
    mechanism: &'a Mechanism,
    structure: &Structure,
) -> ModelDescription<'a, Quantity> {
    let variables = variables(mechanism);
    let indices = Indices::new(mechanism, &variables);
    let mut outputs = Vec::new();
    let mut initial_unknowns = Vec::new();
    for (index, variable) in (1..).zip(&variables) {
        let order = match (variable.quantity, variable.causality) {
            (Quantity::Output(_, order), _) => order,
            (_, Causality::CalculatedParameter) => Order::Position,
            _ => continue,
        };
        let dependencies = variable.quantity.dependencies(mechanism, structure);
        if variable.causality == Causality::Output {
            outputs.push(Unknown {
                index,
                dependencies: indices.inputs(&dependencies, order),
            });
        }
        initial_unknowns.push(Unknown {
            index,
            dependencies: indices.initial(&dependencies, order),
        });
    }
    let simulation = &mechanism.simulation;
    ModelDescription {
        name: &mechanism.name,
        description: &mechanism.description,
        author: mechanism.author.as_deref(),
        version: mechanism.version.as_deref(),
        copyright: mechanism.copyright.as_deref(),
        license: mechanism.license.as_deref(),
        guid: guid(mechanism),
        experiment: Experiment {
            start: simulation.start,
            stop: simulation.stop,
            step: simulation.step,
            tolerance: simulation.tolerance,
        },
        capabilities: CAPABILITIES,
        variables,
        outputs,
        initial_unknowns,
    }
}

/// Indices of variables in the model description, counted from 1.
struct Indices {
    /// First of the three inputs of each driver that is an input.
    inputs: Vec<Option<usize>>,
    /// Each parameter.
    parameters: Vec<usize>,
    rate_source: Option<usize>,
    time: usize,
}

impl Indices {
    fn new(mechanism: &Mechanism, variables: &[Variable<Quantity>]) -> Self {
        let mut indices = Self {
            inputs: vec![None; mechanism.drivers.len()],
            parameters: vec![0; mechanism.parameters.len()],
            rate_source: None,
            time: 0,
        };
        for (index, variable) in (1..).zip(variables) {
            match variable.quantity {
                Quantity::Input(driver, Order::Position) => {
                    indices.inputs[driver.index()] = Some(index);
                }
                Quantity::Parameter(parameter) => indices.parameters[parameter.index()] = index,
                Quantity::RateSource => indices.rate_source = Some(index),
                Quantity::Time => indices.time = index,
                _ => {}
            }
        }
        indices
    }

    /// Returns the inputs and the time that a quantity of this order depends on, over all settings
    /// of `rates`: estimated rates depend on positions.
    fn inputs(&self, dependencies: &Dependencies, order: Order) -> BTreeSet<usize> {
        let mut indices = BTreeSet::new();
        for driver in &dependencies.drivers {
            match self.inputs[driver.index()] {
                Some(first) => indices.extend(first..=first + order as usize),
                None => {
                    indices.insert(self.time);
                }
            }
        }
        indices
    }

    /// Returns everything that a quantity of this order depends on in initialization mode:
    /// parameters as well.
    fn initial(&self, dependencies: &Dependencies, order: Order) -> BTreeSet<usize> {
        let mut indices = self.inputs(dependencies, order);
        // A quantity that no driver moves has rates of zero for any parameters.
        if order == Order::Position || !dependencies.drivers.is_empty() {
            let parameters = dependencies.parameters.iter();
            indices.extend(parameters.map(|id| self.parameters[id.index()]));
        }
        let mut drivers = dependencies.drivers.iter();
        if order > Order::Position && drivers.any(|id| self.inputs[id.index()].is_some()) {
            indices.extend(self.rate_source);
        }
        indices
    }
}

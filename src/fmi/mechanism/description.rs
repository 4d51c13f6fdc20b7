//! The model description of a mechanism's FMU.

use std::collections::BTreeSet;

use super::guid;
use super::variables::{Order, Quantity, dependencies, variables};
use crate::fmi::model_description::{Capabilities, Experiment, ModelDescription, Unknown};
use crate::fmi::variable::{Causality, Variable};
use crate::kinematics::{Dependencies, Structure};
use crate::mechanism::{Mechanism, ParameterId};

/// What a [`MechanismModel`](super::MechanismModel) can do.
const CAPABILITIES: Capabilities = Capabilities {
    interpolates_inputs: true,
    output_derivatives: 2,
    directional_derivatives: true,
};

/// The model description of a mechanism's FMU.
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
        let order = match variable.quantity.order() {
            Some(order) => order,
            None if variable.causality == Causality::CalculatedParameter => Order::Position,
            None => continue,
        };
        let dependencies = dependencies(mechanism, structure, variable.quantity);
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

/// Finds the places of variables in the model description, counted from 1.
struct Indices<'a> {
    mechanism: &'a Mechanism,
    /// Place of the first of the three inputs of each driver that is an input.
    inputs: Vec<Option<usize>>,
    /// Place of each parameter.
    parameters: Vec<usize>,
    rate_source: Option<usize>,
    time: usize,
}

impl<'a> Indices<'a> {
    fn new(mechanism: &'a Mechanism, variables: &[Variable<Quantity>]) -> Self {
        let mut indices = Self {
            mechanism,
            inputs: vec![None; mechanism.drivers.len()],
            parameters: vec![0; mechanism.parameters.len()],
            rate_source: None,
            time: 0,
        };
        for (place, variable) in (1..).zip(variables) {
            match variable.quantity {
                Quantity::Input(driver, Order::Position) => {
                    indices.inputs[driver.index()] = Some(place);
                }
                Quantity::Parameter(parameter) => indices.parameters[parameter.index()] = place,
                Quantity::RateSource => indices.rate_source = Some(place),
                Quantity::Time => indices.time = place,
                _ => {}
            }
        }
        indices
    }

    fn parameter(&self, parameter: ParameterId) -> usize {
        self.parameters[parameter.index()]
    }

    /// Inputs and time that a quantity of this order depends on, over all settings of `rates`:
    /// estimated rates come from positions.
    fn inputs(&self, dependencies: &Dependencies, order: Order) -> BTreeSet<usize> {
        let mut places = BTreeSet::new();
        for driver in &dependencies.drivers {
            match self.inputs[driver.index()] {
                Some(first) => places.extend(first..=first + order as usize),
                None => {
                    places.insert(self.time);
                }
            }
        }
        places
    }

    /// What a quantity of this order depends on at the start: parameters as well.
    fn initial(&self, dependencies: &Dependencies, order: Order) -> BTreeSet<usize> {
        let mut places = self.inputs(dependencies, order);
        // What no driver moves has rates of zero, whatever the parameters.
        if order == Order::Position || !dependencies.drivers.is_empty() {
            places.extend(dependencies.parameters.iter().map(|&p| self.parameter(p)));
        }
        let has_input = |driver: &crate::mechanism::DriverId| {
            self.mechanism.drivers[driver.index()].motion().is_none()
        };
        if order > Order::Position && dependencies.drivers.iter().any(has_input) {
            places.extend(self.rate_source);
        }
        places
    }
}

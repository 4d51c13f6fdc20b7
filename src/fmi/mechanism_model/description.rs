//! The model description of a mechanism's FMU.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::variables::{Quantity, variables};
use super::{MechanismModel, guid};
use crate::fmi::model::Model;
use crate::fmi::model_description::{
    Capabilities, DependencyKind, Experiment, Member, ModelDescription, Terminal, Unknown,
};
use crate::fmi::state::Version;
use crate::fmi::variable::{Causality, Kind, Variable};
use crate::kinematics::{Dependencies, ForceQuantity, Structure, System};
use crate::mechanism::{DriverId, Load, Mechanism, Order, Signal, Unit, Variable as Of, rounded};

/// Capabilities of a [`MechanismModel`](super::MechanismModel).
const CAPABILITIES: Capabilities = Capabilities {
    interpolates_inputs: true,
    output_derivatives: MechanismModel::OUTPUT_DERIVATIVES as u32,
    directional_derivatives: true,
    intermediate_update: MechanismModel::INTERMEDIATE_UPDATE,
};

/// Returns the model description of a mechanism's FMU of FMI 2.0. Its field `standard` makes it one
/// of FMI 3.0.
#[must_use]
pub fn describe<'a>(
    mechanism: &'a Mechanism,
    structure: &Structure,
) -> ModelDescription<'a, Quantity> {
    let mut variables = variables(mechanism);
    set_nominal(mechanism, &mut variables);
    let indices = Indices::new(mechanism, &variables);
    let mut outputs = Vec::new();
    let mut initial_unknowns = Vec::new();
    for (index, variable) in (1..).zip(&variables) {
        let Some(order) = order_of_unknown(variable) else {
            continue;
        };
        let dependencies = variable.quantity.dependencies(mechanism, structure);
        if variable.causality == Causality::Output {
            outputs.push(Unknown {
                index,
                dependencies: indices.outputs(mechanism, variable.quantity, &dependencies),
                parameters: indices.parameters_of_output(variable.quantity, &dependencies, order),
            });
        }
        initial_unknowns.push(Unknown {
            index,
            dependencies: indices.initial(mechanism, variable.quantity, &dependencies, order),
            parameters: BTreeMap::new(),
        });
    }
    let simulation = &mechanism.simulation;
    ModelDescription {
        standard: Version::Fmi2,
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
        terminals: terminals(mechanism, &variables),
        variables,
        outputs,
        initial_unknowns,
    }
}

/// Returns a terminal per driver, with all variables of the driver that cross the interface, and one
/// per marker among the outputs.
fn terminals(mechanism: &Mechanism, variables: &[Variable<Quantity>]) -> Vec<Terminal> {
    let drivers = mechanism.drivers.iter().map(|driver| {
        let description = if driver.description.is_empty() {
            format!("driver `{}`", driver.name)
        } else {
            driver.description.clone()
        };
        (driver.name.clone(), description)
    });
    let markers = mechanism.outputs.markers.iter().map(|&id| {
        let path = mechanism.marker_path(id);
        let description = format!("marker `{path}`");
        (path, description)
    });
    let terminals = drivers.chain(markers).map(|(name, description)| {
        let members = variables.iter().filter_map(|variable| {
            let member = variable.name.strip_prefix(&name)?.strip_prefix('.')?;
            let crosses = matches!(variable.causality, Causality::Input | Causality::Output);
            (crosses && !member.contains('.')).then(|| Member {
                name: member.to_owned(),
                variable: variable.name.clone(),
                is_flow: member == "effort",
            })
        });
        let members = members.collect();
        Terminal {
            name,
            description,
            members,
        }
    });
    terminals.collect()
}

impl MechanismModel {
    /// Returns the value references that an output or a calculated parameter depends on, in
    /// initialization mode or after it.
    pub(super) fn dependencies_of(
        &self,
        value_reference: u32,
        initializing: bool,
    ) -> Option<Vec<(u32, DependencyKind)>> {
        let variable = &self.variables[value_reference as usize];
        let order = order_of_unknown(variable)?;
        let mechanism = self.mechanism();
        let of_quantity = variable
            .quantity
            .dependencies(mechanism, self.solver.structure());
        let indices = Indices::new(mechanism, &self.variables);
        let is_output = variable.causality == Causality::Output;
        let found = if is_output && !initializing {
            let mut all = indices.outputs(mechanism, variable.quantity, &of_quantity);
            all.extend(indices.parameters_of_output(variable.quantity, &of_quantity, order));
            all
        } else {
            indices.initial(mechanism, variable.quantity, &of_quantity, order)
        };
        let found = found.into_iter();
        Some(
            found
                .map(|(index, kind)| (index as u32 - 1, kind))
                .collect(),
        )
    }
}

/// Returns the order of an output or a calculated parameter.
fn order_of_unknown(variable: &Variable<Quantity>) -> Option<Order> {
    match (variable.quantity, variable.causality) {
        (Quantity::Output(_, order) | Quantity::Derived(_, order), _) => Some(order),
        (Quantity::Force(quantity), _) => Some(order_of(quantity)),
        (_, Causality::CalculatedParameter) => Some(Order::Position),
        _ => None,
    }
}

/// Indices of variables in the model description, counted from 1.
struct Indices {
    /// First of the three inputs of each driver that is an input.
    inputs: Vec<Option<usize>>,
    /// Each input of a force.
    force_inputs: Vec<usize>,
    /// Each parameter.
    parameters: Vec<usize>,
    rate_source: Option<usize>,
    extrapolation: Option<usize>,
    time: usize,
}

impl Indices {
    fn new(mechanism: &Mechanism, variables: &[Variable<Quantity>]) -> Self {
        let mut indices = Self {
            inputs: vec![None; mechanism.drivers.len()],
            force_inputs: Vec::new(),
            parameters: vec![0; mechanism.parameters.len()],
            rate_source: None,
            extrapolation: None,
            time: 0,
        };
        for (index, variable) in (1..).zip(variables) {
            match variable.quantity {
                Quantity::Input(driver, Order::Position) => {
                    indices.inputs[driver.index()] = Some(index);
                }
                Quantity::ForceInput(_) => indices.force_inputs.push(index),
                Quantity::Parameter(parameter) => indices.parameters[parameter.index()] = index,
                Quantity::RateSource => indices.rate_source = Some(index),
                Quantity::Extrapolation => indices.extrapolation = Some(index),
                Quantity::Time => indices.time = index,
                _ => {}
            }
        }
        indices
    }

    /// Returns the inputs and the time that an output depends on, over all settings of `rates` and
    /// `extrapolation`: estimated rates depend on positions, extrapolated positions on rates.
    fn outputs(
        &self,
        mechanism: &Mechanism,
        quantity: Quantity,
        dependencies: &Dependencies,
    ) -> BTreeMap<usize, DependencyKind> {
        let mut indices = self.drivers(dependencies, Order::Acceleration);
        self.add_forces(mechanism, quantity, &mut indices);
        indices
    }

    /// Adds the inputs of forces, and the time if forces depend on it, for a force.
    fn add_forces(
        &self,
        mechanism: &Mechanism,
        quantity: Quantity,
        indices: &mut BTreeMap<usize, DependencyKind>,
    ) {
        let Quantity::Force(quantity) = quantity else {
            return;
        };
        let uses_time = |load: &Load| load.expressions().iter().any(|e| e.uses(Of::Time));
        let depends_on_time = match quantity {
            ForceQuantity::Applied(force, _) => uses_time(&mechanism.forces[force].load),
            ForceQuantity::Inertia(_)
            | ForceQuantity::KineticEnergy
            | ForceQuantity::PotentialEnergy => false,
            _ => {
                let inputs = self.force_inputs.iter();
                indices.extend(inputs.map(|&index| (index, DependencyKind::Dependent)));
                mechanism.forces.iter().any(|force| uses_time(&force.load))
            }
        };
        if depends_on_time {
            indices.insert(self.time, DependencyKind::Dependent);
        }
    }

    /// Returns the parameters that an output of this order depends on after initialization.
    fn parameters_of_output(
        &self,
        quantity: Quantity,
        dependencies: &Dependencies,
        order: Order,
    ) -> BTreeMap<usize, DependencyKind> {
        let mut indices = self.mechanism_parameters(quantity, dependencies, order);
        if self.has_input(dependencies) {
            let settings = [self.rate_source, self.extrapolation].into_iter().flatten();
            indices.extend(settings.map(|index| (index, DependencyKind::Dependent)));
        }
        indices
    }

    /// Returns the mechanism's own parameters that a quantity of this order depends on: a signal
    /// that no driver moves has rates of zero for any parameters.
    fn mechanism_parameters(
        &self,
        quantity: Quantity,
        dependencies: &Dependencies,
        order: Order,
    ) -> BTreeMap<usize, DependencyKind> {
        let is_signal = matches!(quantity, Quantity::Output(..));
        if order > Order::Position && is_signal && dependencies.drivers.is_empty() {
            return BTreeMap::new();
        }
        let parameters = dependencies.parameters.iter();
        parameters
            .map(|id| (self.parameters[id.index()], DependencyKind::Dependent))
            .collect()
    }

    /// Returns whether a driver among the dependencies is an input.
    fn has_input(&self, dependencies: &Dependencies) -> bool {
        let mut drivers = dependencies.drivers.iter();
        drivers.any(|id| self.inputs[id.index()].is_some())
    }

    /// Returns the inputs up to an order, and the time.
    fn drivers(
        &self,
        dependencies: &Dependencies,
        order: Order,
    ) -> BTreeMap<usize, DependencyKind> {
        let mut indices = BTreeMap::new();
        for driver in &dependencies.drivers {
            let of_driver = match self.inputs[driver.index()] {
                Some(first) => first..=first + order as usize,
                None => self.time..=self.time,
            };
            indices.extend(of_driver.map(|index| (index, DependencyKind::Dependent)));
        }
        indices
    }

    /// Returns everything that a quantity of this order depends on in initialization mode, where
    /// nothing is extrapolated: parameters as well.
    fn initial(
        &self,
        mechanism: &Mechanism,
        quantity: Quantity,
        dependencies: &Dependencies,
        order: Order,
    ) -> BTreeMap<usize, DependencyKind> {
        let mut indices = self.drivers(dependencies, order);
        self.add_forces(mechanism, quantity, &mut indices);
        if let Some(driver) = driver_angle(mechanism, quantity)
            && let Some(index) = self.inputs[driver.index()]
        {
            indices.insert(index, DependencyKind::Constant);
        }
        indices.extend(self.mechanism_parameters(quantity, dependencies, order));
        if order > Order::Position && self.has_input(dependencies) {
            let rate_source = self.rate_source.into_iter();
            indices.extend(rate_source.map(|index| (index, DependencyKind::Dependent)));
        }
        indices
    }
}

/// Returns the highest order of the motion on which a force depends.
fn order_of(quantity: ForceQuantity) -> Order {
    match quantity {
        ForceQuantity::Inertia(_) | ForceQuantity::PotentialEnergy => Order::Position,
        ForceQuantity::Bias(_) | ForceQuantity::Applied(..) | ForceQuantity::KineticEnergy => {
            Order::Velocity
        }
        ForceQuantity::Effort(_)
        | ForceQuantity::Power(_)
        | ForceQuantity::Reaction(..)
        | ForceQuantity::Held(_) => Order::Acceleration,
    }
}

/// Returns the driver whose value a quantity differs from by a constant only, up to its sign: the
/// angle of a body that the driver turns against ground.
fn driver_angle(mechanism: &Mechanism, quantity: Quantity) -> Option<DriverId> {
    let Quantity::Output(Signal::Body(body, 2), Order::Position) = quantity else {
        return None;
    };
    let drivers = mechanism.drivers.iter();
    let found = drivers
        .map(|driver| &driver.coordinate)
        .position(|coordinate| {
            let bodies =
                [coordinate.from, coordinate.to].map(|id| mechanism.markers[id.index()].body);
            coordinate.kind.is_angle()
                && (bodies == [None, Some(body)] || bodies == [Some(body), None])
        });
    found.map(DriverId)
}

/// Gives lengths among inputs and outputs the mechanism's size as their usual magnitude, rounded to
/// one digit. Angles have the order of 1, which is the default.
fn set_nominal(mechanism: &Mechanism, variables: &mut [Variable<Quantity>]) {
    let system = System::new(Arc::new(mechanism.clone()));
    let (mut at, mut targets) = (system.configuration(), system.targets());
    let parameters = mechanism.default_parameters();
    if system
        .set_parameters(&parameters, &mut at, &mut targets)
        .is_err()
    {
        return;
    }
    let size = rounded(at.size(), 1);
    for variable in variables {
        let is_position = matches!(
            variable.quantity,
            Quantity::Input(_, Order::Position) | Quantity::Output(_, Order::Position)
        );
        if let Kind::Real { unit, nominal, .. } = &mut variable.kind
            && unit.is_some_and(|unit| unit.name == Unit::METRE.name)
            && is_position
        {
            *nominal = Some(size);
        }
    }
}

//! Variables on which outputs and calculated parameters depend.

use std::collections::{BTreeMap, HashMap};

use super::MechanismModel;
use super::variables::{Quantity, has_local_states};
use crate::fmi::model_description::DependencyKind;
use crate::fmi::variable::{Causality, Variable, place, value_reference};
use crate::kinematics::{Dependencies, ForceQuantity, OutputSource, Structure};
use crate::mechanism::{
    BodyId, Coordinate, DriverId, Expression, Load, Mechanism, Order, Signal, Variable as Of,
};

/// Kinds of dependency by value reference.
pub(super) type Kinds = BTreeMap<u32, DependencyKind>;

/// The variables on which an output or a calculated parameter depends.
#[derive(Default)]
pub(super) struct KnownVariables {
    /// All of them in initialization mode.
    pub(super) initial: Kinds,
    /// Inputs and time after it, over all settings of `rates` and `extrapolation`.
    pub(super) inputs: Kinds,
    /// Parameters after it.
    pub(super) parameters: Kinds,
}

/// Dependencies of the variables of a mechanism's FMU, structurally exact.
pub(super) struct DependencyTable<'a> {
    mechanism: &'a Mechanism,
    structure: &'a Structure,
    /// Value references of all variables but those that are mere outputs.
    references: HashMap<Quantity, u32>,
    /// Whether the states are those of coordinates that change.
    has_local_states: bool,
}

impl<'a> DependencyTable<'a> {
    pub(super) fn new(
        mechanism: &'a Mechanism,
        structure: &'a Structure,
        variables: &[Variable<Quantity>],
    ) -> Self {
        let known = variables.iter().enumerate();
        let known = known.filter(|(_, variable)| variable.causality != Causality::Output);
        Self {
            mechanism,
            structure,
            has_local_states: has_local_states(variables),
            references: known
                .map(|(place, variable)| (variable.quantity, value_reference(place)))
                .collect(),
        }
    }

    /// Returns the variables on which an output or a calculated parameter depends; `None` for other
    /// variables.
    pub(super) fn of(&self, unknown: Quantity) -> Option<KnownVariables> {
        let order = self.order(unknown)?;
        let mut origins = self.origins(unknown);
        let mut force = unknown;
        if let Some(freedom) = self.accelerated(&origins, order) {
            // Its acceleration follows from all forces.
            let effort = ForceQuantity::Effort(freedom);
            force = Quantity::Output(OutputSource::Force(effort));
            self.add_origins(effort, &mut origins);
            origins
                .drivers
                .extend((0..self.mechanism.drivers.len()).map(DriverId));
        }
        let has_input =
            |origins: &Dependencies| origins.drivers.iter().any(|id| self.is_input(*id));
        let of_forces: Kinds = self.dependent(self.inputs_of_forces(force)).collect();
        let parameters = |origins: &_| -> Kinds {
            self.dependent(self.parameters(unknown, origins, order))
                .collect()
        };
        let own = parameters(&origins);

        // Nothing is extrapolated in initialization mode.
        let mut initial: Kinds = self.dependent(self.inputs(&origins, order)).collect();
        initial.extend(self.dependent(self.starts(&origins, order, unknown)));
        let angle = self.driver_angle(unknown);
        let angle = angle.and_then(|id| self.references.get(&Quantity::Input(id, Order::Position)));
        initial.extend(angle.map(|vr| (*vr, DependencyKind::Constant)));
        initial.extend(of_forces.iter().chain(&own));
        if has_input(&origins) && order > Order::Position {
            initial.extend(self.dependent([Quantity::RateSource]));
        }

        // In other coordinates all that moves freely depends on all that moves.
        let is_state = matches!(unknown, Quantity::State(_, order) if order < Order::Acceleration);
        if self.has_local_states && !is_state && self.freedoms(&origins).next().is_some() {
            for column in 0..3 * self.mechanism.bodies.len() {
                origins.extend(self.structure.dependencies(column));
            }
        }
        // Estimated rates depend on positions, extrapolated positions on rates.
        let mut inputs: Kinds = self
            .dependent(self.inputs(&origins, Order::Acceleration))
            .collect();
        inputs.extend(self.dependent(self.states(&origins, order, unknown)));
        inputs.extend(of_forces);
        let mut parameters = parameters(&origins);
        if has_input(&origins) {
            let settings = [Quantity::RateSource, Quantity::Extrapolation];
            parameters.extend(self.dependent(settings));
        }
        Some(KnownVariables {
            initial,
            inputs,
            parameters,
        })
    }

    /// Returns the order of an output or a calculated parameter, of a force the highest order of the
    /// motion on which it depends.
    fn order(&self, unknown: Quantity) -> Option<Order> {
        match unknown {
            Quantity::Output(OutputSource::Signal(_, order)) | Quantity::State(_, order) => {
                Some(order)
            }
            Quantity::Output(OutputSource::Derived(index)) => {
                Some(self.mechanism.derived[index].order())
            }
            Quantity::Output(OutputSource::Force(force)) => Some(match force {
                ForceQuantity::Inertia(_) | ForceQuantity::PotentialEnergy => Order::Position,
                ForceQuantity::Applied(force, _) | ForceQuantity::Pushes(force, _)
                    if self.is_passive(force) =>
                {
                    Order::Acceleration
                }
                ForceQuantity::Bias(_) if self.mechanism.has_joint_friction() => {
                    Order::Acceleration
                }
                ForceQuantity::Bias(_)
                | ForceQuantity::Applied(..)
                | ForceQuantity::Pushes(..)
                | ForceQuantity::KineticEnergy => Order::Velocity,
                ForceQuantity::Effort(_)
                | ForceQuantity::Power(_)
                | ForceQuantity::Reaction(..)
                | ForceQuantity::Share(..)
                | ForceQuantity::Held(_) => Order::Acceleration,
            }),
            Quantity::EventIndicator(_) => Some(Order::Acceleration),
            Quantity::Clearance(_) | Quantity::Weight(..) => Some(Order::Position),
            Quantity::Parameter(id) if self.mechanism.parameters[id.index()].derived => {
                Some(Order::Position)
            }
            _ => None,
        }
    }

    /// Returns whether a force follows from all others and the masses.
    fn is_passive(&self, force: usize) -> bool {
        let load = &self.mechanism.forces[force].load;
        let is_in_joint = load.friction().is_some_and(|law| law.bearing.is_some());
        load.cause().is_some() && self.mechanism.has_freedoms() || is_in_joint
    }

    /// Returns the dependencies on those of the quantities that are variables.
    fn dependent(
        &self,
        known: impl IntoIterator<Item = Quantity>,
    ) -> impl Iterator<Item = (u32, DependencyKind)> {
        let known = known.into_iter();
        let found = known.filter_map(|quantity| self.references.get(&quantity));
        found.map(|vr| (*vr, DependencyKind::Dependent))
    }

    /// Returns the first freedom whose acceleration a quantity of an order contains.
    fn accelerated(&self, origins: &Dependencies, order: Order) -> Option<DriverId> {
        let mut freedoms = self.freedoms(origins);
        freedoms.next().filter(|_| order == Order::Acceleration)
    }

    /// Returns the freedoms among the origins of a quantity.
    fn freedoms(&self, origins: &Dependencies) -> impl Iterator<Item = DriverId> {
        let drivers = origins.drivers.iter().copied();
        drivers.filter(|id| self.mechanism.drivers[id.index()].is_free())
    }

    /// Returns the starts of freedoms, up to an order, on which a quantity depends in initialization
    /// mode: values and velocities in the file's own coordinates.
    fn starts(&self, origins: &Dependencies, highest: Order, unknown: Quantity) -> Vec<Quantity> {
        let start = |id, order| Quantity::Output(OutputSource::Signal(Signal::Motion(id), order));
        match unknown {
            Quantity::State(id, order)
            | Quantity::Output(OutputSource::Signal(Signal::Motion(id), order))
                if self.mechanism.drivers[id.index()].is_free() && order < Order::Acceleration =>
            {
                vec![start(id, order)]
            }
            _ => both(self.freedoms(origins), highest, start),
        }
    }

    /// Returns the states, up to an order, on which a quantity depends after initialization.
    fn states(&self, origins: &Dependencies, highest: Order, unknown: Quantity) -> Vec<Quantity> {
        if !self.has_local_states {
            return self.starts(origins, highest, unknown);
        }
        match unknown {
            Quantity::State(_, Order::Position | Order::Velocity) => vec![unknown],
            _ => both(self.freedoms(origins), highest, Quantity::State),
        }
    }

    /// Returns the inputs of drivers up to an order, and the time for prescribed motions.
    fn inputs(&self, origins: &Dependencies, highest: Order) -> Vec<Quantity> {
        let mut inputs = Vec::new();
        for &id in &origins.drivers {
            let driver = &self.mechanism.drivers[id.index()];
            if let Some(follows) = &driver.follows {
                inputs.extend(self.loads_in(follows));
                inputs.push(Quantity::Time);
            } else if driver.is_given() {
                let orders = Order::ALL.into_iter().filter(|order| *order <= highest);
                inputs.extend(orders.map(|order| Quantity::Input(id, order)));
            } else if !driver.is_free() {
                inputs.push(Quantity::Time);
            }
        }
        inputs
    }

    fn is_input(&self, driver: DriverId) -> bool {
        let driver = &self.mechanism.drivers[driver.index()];
        driver.is_given() || driver.follows.is_some()
    }

    /// Returns the inputs of forces, and the time if forces depend on it, for a force or a measure that
    /// uses some.
    fn inputs_of_forces(&self, unknown: Quantity) -> Vec<Quantity> {
        let of = |force| self.inputs_of_force(force);
        match unknown {
            Quantity::Output(OutputSource::Force(force)) => of(force),
            Quantity::Output(OutputSource::Derived(index)) => self.mechanism.derived[index]
                .forces()
                .flat_map(of)
                .collect(),
            _ => Vec::new(),
        }
    }

    /// Returns the inputs of forces, and the time if forces depend on it, for a force.
    fn inputs_of_force(&self, force: ForceQuantity) -> Vec<Quantity> {
        let forces = &self.mechanism.forces;
        let uses_time = |load: &Load| load.expressions().iter().any(|e| e.uses(Of::Time));
        let mut own = Vec::new();
        let (count, depends_on_time) = match force {
            ForceQuantity::Applied(force, _) | ForceQuantity::Pushes(force, _)
                if !forces[force].load.is_input() && !self.is_passive(force) =>
            {
                own = self.inputs_of_load(&forces[force].load);
                (0, uses_time(&forces[force].load))
            }
            ForceQuantity::Inertia(_)
            | ForceQuantity::KineticEnergy
            | ForceQuantity::PotentialEnergy => (0, false),
            _ => (
                self.mechanism.load_inputs().len(),
                forces.iter().any(|force| uses_time(&force.load)),
            ),
        };
        let inputs = (0..count).map(Quantity::ForceInput);
        let time = depends_on_time.then_some(Quantity::Time);
        inputs.chain(own).chain(time).collect()
    }

    /// Returns the inputs of the file on which the size of a force depends.
    fn inputs_of_load(&self, load: &Load) -> Vec<Quantity> {
        load.moving_expressions()
            .flat_map(|size| self.loads_in(size))
            .collect()
    }

    /// Returns the inputs of the file in an expression.
    fn loads_in(&self, expression: &Expression) -> Vec<Quantity> {
        let ([places, _], _) = self.mechanism.load_places();
        let places = expression.inputs().filter_map(|index| places[index]);
        places.map(Quantity::ForceInput).collect()
    }

    /// Returns the mechanism's own parameters. A signal that no driver moves has rates of zero for any
    /// parameters.
    fn parameters(&self, unknown: Quantity, origins: &Dependencies, order: Order) -> Vec<Quantity> {
        let is_signal = matches!(unknown, Quantity::Output(OutputSource::Signal(..)));
        if order > Order::Position && is_signal && origins.drivers.is_empty() {
            return Vec::new();
        }
        let parameters = origins.parameters.iter();
        parameters.map(|id| Quantity::Parameter(*id)).collect()
    }

    /// Returns the driver whose value a quantity differs from by a constant only, up to its sign: the
    /// angle of a body that the driver turns against ground.
    fn driver_angle(&self, quantity: Quantity) -> Option<DriverId> {
        let Quantity::Output(OutputSource::Signal(Signal::Body(body, 2), Order::Position)) =
            quantity
        else {
            return None;
        };
        let turns = |coordinate: &Coordinate| {
            let markers = [coordinate.from, coordinate.to];
            let bodies = markers.map(|id| self.mechanism.markers[id.index()].body);
            coordinate.kind.is_angle()
                && (bodies == [None, Some(body)] || bodies == [Some(body), None])
        };
        let drivers = &self.mechanism.drivers;
        let found = drivers.iter().position(|driver| turns(&driver.coordinate));
        found.map(DriverId)
    }

    /// Returns the drivers and parameters on which an output or a calculated parameter depends.
    fn origins(&self, unknown: Quantity) -> Dependencies {
        let (mechanism, structure) = (self.mechanism, self.structure);
        let mut origins = Dependencies::default();
        match unknown {
            Quantity::Output(OutputSource::Signal(signal, _)) => match signal {
                Signal::Body(body, component) => {
                    origins.extend(structure.dependencies(3 * body.index() + component));
                }
                Signal::Marker(marker, component) => {
                    let of_point = structure.point_dependencies(mechanism, marker, component);
                    origins.extend(&of_point);
                }
                Signal::Measure(index) => {
                    let coordinate = &mechanism.measures[index].coordinate;
                    origins.extend(&structure.coordinate_dependencies(mechanism, coordinate));
                }
                Signal::Motion(driver) => {
                    origins.drivers.insert(driver);
                    if let Some(follows) = &mechanism.drivers[driver.index()].follows {
                        origins.add_expression(mechanism, follows);
                    }
                    if let Some(motion) = mechanism.drivers[driver.index()].motion() {
                        origins.add_motion(mechanism, motion);
                    }
                }
            },
            Quantity::Output(OutputSource::Derived(index)) => {
                let measure = &mechanism.derived[index];
                origins.add_expression(mechanism, &measure.value);
                for (signal, order) in measure.signals() {
                    let signal = Quantity::Output(OutputSource::Signal(signal, order));
                    origins.extend(&self.origins(signal));
                }
                for force in measure.forces() {
                    self.add_origins(force, &mut origins);
                }
            }
            Quantity::Output(OutputSource::Force(force)) => self.add_origins(force, &mut origins),
            Quantity::State(freedom, _) => {
                origins.drivers.insert(freedom);
            }
            Quantity::Clearance(stop) => {
                let coordinate = &mechanism.stops[stop].coordinate;
                origins.extend(&structure.coordinate_dependencies(mechanism, coordinate));
            }
            Quantity::EventIndicator(_) => {
                self.add_origins(ForceQuantity::KineticEnergy, &mut origins);
            }
            Quantity::Parameter(parameter) => origins.add_parameter(mechanism, parameter),
            Quantity::Weight(body, _) => {
                for number in mechanism.numbers_of_mass(body) {
                    origins.add_expression(mechanism, number);
                }
            }
            _ => {}
        }
        origins
    }

    /// Adds the drivers and parameters on which a force depends: a force along a coordinate on that,
    /// all others on the whole mechanism.
    fn add_origins(&self, force: ForceQuantity, origins: &mut Dependencies) {
        let (mechanism, structure) = (self.mechanism, self.structure);
        if let ForceQuantity::Applied(force, _) | ForceQuantity::Pushes(force, _) = force
            && !self.is_passive(force)
        {
            let load = &mechanism.forces[force].load;
            if let Some(coordinate) = load.coordinate() {
                origins.extend(&structure.coordinate_dependencies(mechanism, coordinate));
            }
            for (signal, order) in load.signals() {
                let signal = Quantity::Output(OutputSource::Signal(signal, order));
                origins.extend(&self.origins(signal));
            }
            for expression in load.expressions() {
                origins.add_expression(mechanism, expression);
            }
            return;
        }
        for column in 0..3 * mechanism.bodies.len() {
            origins.extend(structure.dependencies(column));
        }
        for (index, body) in mechanism.bodies.iter().enumerate() {
            for expression in mechanism.numbers_of_mass(BodyId(index)) {
                origins.add_expression(mechanism, expression);
            }
            // Points of forces and reactions.
            for marker in &body.markers {
                let marker = &mechanism.markers[marker.index()];
                for expression in marker.numbers() {
                    origins.add_expression(mechanism, expression);
                }
            }
        }
        let loads = mechanism.forces.iter().flat_map(|f| f.load.expressions());
        for expression in mechanism.simulation.gravity.iter().chain(loads) {
            origins.add_expression(mechanism, expression);
        }
        for parameter in structure.parameters_of_play() {
            origins.add_parameter(mechanism, *parameter);
        }
    }
}

/// Returns the values of freedoms and, if an order needs them, their velocities.
fn both(
    freedoms: impl Iterator<Item = DriverId>,
    highest: Order,
    quantity: impl Fn(DriverId, Order) -> Quantity,
) -> Vec<Quantity> {
    let count = if highest == Order::Position { 1 } else { 2 };
    let orders = [Order::Position, Order::Velocity];
    let all = freedoms.flat_map(|id| orders[..count].iter().map(move |order| (id, *order)));
    all.map(|(id, order)| quantity(id, order)).collect()
}

impl MechanismModel {
    /// Returns the dependencies of an output or a calculated parameter, in initialization mode or
    /// after it; none of other variables.
    pub(super) fn dependencies_of(
        &self,
        value_reference: u32,
        initializing: bool,
    ) -> Vec<(u32, DependencyKind)> {
        let solver = &self.motion.solver;
        let own = self.motion.free().map(|free| free.own(solver));
        let structure = own.unwrap_or(solver).structure();
        let table = DependencyTable::new(&self.mechanism, structure, &self.variables);
        let variable = &self.variables[place(value_reference)];
        let mut known = table.of(variable.quantity).unwrap_or_default();
        if variable.is_unknown() && !initializing {
            known.inputs.extend(known.parameters);
            known.inputs.into_iter().collect()
        } else {
            known.initial.into_iter().collect()
        }
    }
}

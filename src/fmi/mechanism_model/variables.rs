//! The table of variables of a mechanism's FMU. Getters, setters and `modelDescription.xml` read
//! it.

use std::sync::Arc;

use super::decisions::Decisions;
use super::rule::{EXTRAPOLATION, RATES};
use crate::dynamics::{self, KeptStart};
use crate::fmi::variable::{Causality, Kind, Variability, Variable};
use crate::kinematics::{Budget, Dependencies, Output, OutputSource};
use crate::mechanism::{
    BodyId, Driver, DriverId, DriverSource, LoadTarget, Mechanism, Order, ParameterId, Signal, Unit,
};

/// Version of the table, part of the GUID. A change of the table for the same mechanism raises it.
pub const TABLE_VERSION: u32 = 4;
/// Version of the variables of forces, part of the GUID of mechanisms with dynamics.
pub(super) const FORCE_TABLE_VERSION: u32 = 1;

/// A variable's meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Value, velocity or acceleration of a driver that is an input.
    Input(DriverId, Order),
    /// An input of the file, or the size of a force that is an input, by its place among all such inputs.
    ForceInput(usize),
    /// A parameter of the mechanism.
    Parameter(ParameterId),
    /// The source of the drivers' rates.
    RateSource,
    /// The extrapolation of inputs during a step.
    Extrapolation,
    /// An output of a run.
    Output(OutputSource),
    /// Value, velocity or acceleration of the coordinate in use for a freedom.
    State(DriverId, Order),
    /// An event indicator, by its index.
    EventIndicator(usize),
    /// Clearance of a contact, by the index of its stop.
    Clearance(usize),
    /// Number of places at which a contact touches, by the index of its stop.
    Touching(usize),
    /// A number of the mass that its shapes give a body, by its place among all
    /// [numbers](crate::mechanism::Weight::numbers).
    Weight(BodyId, usize),
    /// Largest scaled residual of the constraint equations.
    Residual,
    /// Scaled reciprocal condition of the Jacobian.
    Rcond,
    /// Newton iterations of the last step.
    Iterations,
    /// Sub-steps of the last step.
    Substeps,
    /// Most sub-steps of a call.
    Budget,
    /// Whether the last step was proved throughout.
    Proved,
    /// Time.
    Time,
}

/// Returns the variables of a mechanism's FMU in the order of their value references: inputs,
/// inputs of forces, parameters, settings, bodies, markers, measures, motions, measures computed
/// from others, forces, solver, time, states that are no outputs, event indicators; in the file's
/// order within each group; the solver's budget, the inputs of the file, the contacts, and the masses that
/// shapes give at the end.
#[must_use]
pub fn variables(mechanism: &Arc<Mechanism>) -> Vec<Variable<Quantity>> {
    let kept = KeptStart::of(mechanism);
    let started = kept.map_or_else(|| Arc::clone(mechanism), |kept| kept.mechanism);
    variables_of(&started, &Decisions::of(mechanism))
}

/// Returns the variables that follow from the decisions of an export, for a mechanism with the start that
/// its motion [keeps](KeptStart).
pub(super) fn variables_of(
    mechanism: &Mechanism,
    decisions: &Decisions,
) -> Vec<Variable<Quantity>> {
    let mut table = Table::default();
    table.add_inputs(mechanism);
    table.add_load_inputs(mechanism, |target| matches!(target, LoadTarget::Force(..)));
    table.add_parameters(mechanism);
    let is_moved = |driver: &Driver| driver.is_given() || driver.follows.is_some();
    if mechanism.drivers.iter().any(is_moved) {
        table.add_settings(mechanism);
    }
    table.add_outputs(mechanism, decisions);
    table.add_solver();
    table.add(
        "time",
        "",
        Quantity::Time,
        (Causality::Independent, Variability::Continuous),
        Kind::real(Some(Unit::SECOND), None),
    );
    if decisions.has_local_states {
        table.add_local_states(mechanism);
    }
    table.add_event_indicators(mechanism);
    table.add_budget(mechanism);
    table.add_load_inputs(mechanism, |target| matches!(target, LoadTarget::Input(_)));
    table.add_contacts(mechanism);
    table.add_weights(mechanism);
    table.list
}

/// Returns whether some of the variables are states that are no outputs.
pub(super) fn has_local_states(variables: &[Variable<Quantity>]) -> bool {
    let mut variables = variables.iter();
    variables.any(|variable| variable.causality == Causality::LocalState)
}

/// Returns whether a value that depends on parameters may change between steps.
fn variability_of(mechanism: &Mechanism, roots: &Dependencies) -> Variability {
    let mut roots = roots.parameters.iter();
    if roots.any(|root| mechanism.parameters[root.index()].tunable) {
        Variability::Tunable
    } else {
        Variability::Fixed
    }
}

#[derive(Default)]
struct Table {
    list: Vec<Variable<Quantity>>,
}

impl Table {
    fn add(
        &mut self,
        name: impl Into<String>,
        description: impl Into<String>,
        quantity: Quantity,
        (causality, variability): (Causality, Variability),
        kind: Kind,
    ) {
        self.list.push(Variable {
            name: name.into(),
            description: description.into(),
            quantity,
            causality,
            variability,
            kind,
            derivative_of: None,
        });
    }

    /// Adds a variable with the name of an output of a run.
    fn add_named(&mut self, name: Output, quantity: Quantity, causality: Causality, kind: Kind) {
        let traits = (causality, Variability::Continuous);
        let place = self.list.len();
        self.add(name.name, name.description, quantity, traits, kind);
        let of = name.derivative_of.map(|distance| place - distance);
        self.list[place].derivative_of = of;
    }

    fn add_inputs(&mut self, mechanism: &Mechanism) {
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            let DriverSource::Input { start } = driver.source else {
                continue;
            };
            if driver.follows.is_some() {
                continue;
            }
            let id = DriverId(index);
            let names = Output::of_driver(mechanism, id);
            for (order, name) in Order::ALL.into_iter().zip(names) {
                let [start, min, max] = match order {
                    Order::Position => [Some(start), driver.min, driver.max],
                    _ => [Some(0.0), None, None],
                };
                let kind = Kind::Real {
                    unit: Some(name.unit),
                    start,
                    min,
                    max,
                    nominal: None,
                };
                self.add_named(name, Quantity::Input(id, order), Causality::Input, kind);
            }
        }
    }

    fn add_load_inputs(&mut self, mechanism: &Mechanism, wanted: impl Fn(LoadTarget) -> bool) {
        let inputs = mechanism.load_inputs().into_iter().enumerate();
        for (place, input) in inputs.filter(|(_, input)| wanted(input.target)) {
            let [min, max] = input.limits;
            let kind = Kind::Real {
                unit: input.unit,
                start: Some(input.start),
                min,
                max,
                nominal: None,
            };
            let traits = (Causality::Input, Variability::Continuous);
            let quantity = Quantity::ForceInput(place);
            self.add(input.name, input.description, quantity, traits, kind);
        }
    }

    fn add_parameters(&mut self, mechanism: &Mechanism) {
        for (index, parameter) in mechanism.parameters.iter().enumerate() {
            let id = ParameterId(index);
            let causality = if parameter.derived {
                Causality::CalculatedParameter
            } else {
                Causality::Parameter
            };
            let mut roots = Dependencies::default();
            roots.add_parameter(mechanism, id);
            self.add(
                parameter.name.clone(),
                parameter.description.clone(),
                Quantity::Parameter(id),
                (causality, variability_of(mechanism, &roots)),
                Kind::Real {
                    unit: parameter.unit,
                    start: (!parameter.derived).then_some(parameter.default),
                    min: parameter.min,
                    max: parameter.max,
                    nominal: None,
                },
            );
        }
    }

    fn add_settings(&mut self, mechanism: &Mechanism) {
        let traits = (Causality::Parameter, Variability::Fixed);
        self.add(
            "rates",
            "source of the velocity and acceleration of the inputs",
            Quantity::RateSource,
            traits,
            Kind::Enumeration {
                choices: RATES,
                start: mechanism.simulation.rates as i32,
            },
        );
        self.add(
            "extrapolation",
            "path of inputs without input derivatives during a step",
            Quantity::Extrapolation,
            traits,
            Kind::Enumeration {
                choices: EXTRAPOLATION,
                start: mechanism.simulation.extrapolation as i32,
            },
        );
    }

    fn add_outputs(&mut self, mechanism: &Mechanism, decisions: &Decisions) {
        for output in Output::of_host(mechanism, &decisions.omitted) {
            let quantity = Quantity::Output(output.source);
            let unit = match output.source {
                // It may have none.
                OutputSource::Derived(index) => mechanism.derived[index].unit,
                _ => Some(output.unit),
            };
            let start = start_of_freedom(mechanism, output.source);
            let causality = match start {
                Some(_) if decisions.has_local_states => Causality::StartedOutput,
                Some(_) => Causality::State,
                None => Causality::Output,
            };
            self.add_named(output, quantity, causality, Kind::real(unit, start));
        }
    }

    /// Adds value, velocity and acceleration of the coordinates in use. They have no unit: an angle may
    /// take the place of a length.
    fn add_local_states(&mut self, mechanism: &Mechanism) {
        let drivers = mechanism.drivers.iter().enumerate();
        let freedoms = drivers.filter(|(_, driver)| driver.is_free());
        for (count, (index, _)) in freedoms.enumerate() {
            let (value, velocity) = (2 * count + 1, 2 * count + 2);
            let names = [
                (format!("state[{value}]"), "value"),
                (format!("state[{velocity}]"), "velocity"),
                (format!("der(state[{velocity}])"), "acceleration"),
            ];
            for (order, (name, of)) in Order::ALL.into_iter().zip(names) {
                let place = self.list.len();
                let quantity = Quantity::State(DriverId(index), order);
                let description = format!("{of} of a coordinate in use for the free motion [SI]");
                let causality = match order {
                    Order::Acceleration => Causality::Local,
                    _ => Causality::LocalState,
                };
                let traits = (causality, Variability::Continuous);
                self.add(name, description, quantity, traits, Kind::real(None, None));
                self.list[place].derivative_of = (order > Order::Position).then(|| place - 1);
            }
        }
    }

    /// Adds the event indicators of passive forces.
    fn add_event_indicators(&mut self, mechanism: &Mechanism) {
        let indicators = dynamics::event_indicators(mechanism);
        for (index, watched) in indicators.into_iter().enumerate() {
            self.add(
                format!("event_indicator[{}]", index + 1),
                watched,
                Quantity::EventIndicator(index),
                (Causality::EventIndicator, Variability::Continuous),
                Kind::real(None, None),
            );
        }
    }

    /// Adds the clearances of contacts, and in free motion the numbers of places that touch.
    fn add_contacts(&mut self, mechanism: &Mechanism) {
        let stops = mechanism.stops.iter().enumerate();
        for (index, stop) in stops.filter(|(_, stop)| stop.coordinate.shapes().is_some()) {
            let name = &stop.name;
            self.add(
                format!("{name}.clearance"),
                stop.coordinate.describe(mechanism),
                Quantity::Clearance(index),
                (Causality::Output, Variability::Continuous),
                Kind::real(Some(Unit::METRE), None),
            );
            if mechanism.has_freedoms() {
                self.add(
                    format!("{name}.touching"),
                    format!("number of places at which contact `{name}` touches"),
                    Quantity::Touching(index),
                    (Causality::Local, Variability::Discrete),
                    Kind::Integer,
                );
            }
        }
    }

    /// Adds the masses, centres and inertias that follow from shapes.
    fn add_weights(&mut self, mechanism: &Mechanism) {
        let numbers = [
            ("mass", Unit::KILOGRAM, "mass"),
            (
                "center_x",
                Unit::METRE,
                "x of the centre of mass, in the body's frame,",
            ),
            (
                "center_y",
                Unit::METRE,
                "y of the centre of mass, in the body's frame,",
            ),
            (
                "inertia",
                Unit::KILOGRAM_METRE_SQUARED,
                "moment of inertia about the centre of mass",
            ),
        ];
        let bodies = mechanism.bodies.iter().enumerate();
        for (index, body) in bodies.filter(|(_, body)| body.is_weighed) {
            let mut roots = Dependencies::default();
            for number in mechanism.numbers_of_mass(BodyId(index)) {
                roots.add_expression(mechanism, number);
            }
            let variability = variability_of(mechanism, &roots);
            for (place, (name, unit, what)) in numbers.into_iter().enumerate() {
                self.add(
                    format!("{}.{name}", body.name),
                    format!("{what} of the shapes of `{}`", body.name),
                    Quantity::Weight(BodyId(index), place),
                    (Causality::CalculatedParameter, variability),
                    Kind::real(Some(unit), None),
                );
            }
        }
    }

    /// Adds the number of sub-steps that a call may take. It is tunable: a host may repeat a step with a
    /// larger one.
    fn add_budget(&mut self, mechanism: &Mechanism) {
        self.add(
            "solver.budget",
            "most sub-steps of a call, those to trial poses of a free motion included; a step that \
             needs more is discarded",
            Quantity::Budget,
            (Causality::Parameter, Variability::Tunable),
            Kind::Real {
                unit: Some(Unit::ONE),
                start: Some(Budget::usual(mechanism).most().into()),
                min: Some(1.0),
                max: None,
                nominal: None,
            },
        );
    }

    fn add_solver(&mut self) {
        for (name, description, quantity) in [
            (
                "solver.residual",
                "largest residual of the constraint equations, in characteristic lengths and radians",
                Quantity::Residual,
            ),
            (
                "solver.rcond",
                "scaled reciprocal condition of the Jacobian: 1 is best, 0 a singular position",
                Quantity::Rcond,
            ),
        ] {
            let kind = Kind::real(Some(Unit::ONE), None);
            let traits = (Causality::Local, Variability::Continuous);
            self.add(name, description, quantity, traits, kind);
        }
        for (name, description, quantity) in [
            (
                "solver.iterations",
                "Newton iterations of the last step",
                Quantity::Iterations,
            ),
            (
                "solver.substeps",
                "sub-steps of the last step, 1 for an ordinary one",
                Quantity::Substeps,
            ),
            (
                "solver.proved",
                "1 if the last step was proved throughout to stay on its branch, 0 if parts were checked",
                Quantity::Proved,
            ),
        ] {
            let traits = (Causality::Local, Variability::Discrete);
            self.add(name, description, quantity, traits, Kind::Integer);
        }
    }
}

/// Returns the start of value and velocity of a freedom.
fn start_of_freedom(mechanism: &Mechanism, output: OutputSource) -> Option<f64> {
    let OutputSource::Signal(Signal::Motion(driver), order) = output else {
        return None;
    };
    match (&mechanism.drivers[driver.index()].source, order) {
        (DriverSource::Free { start, .. }, Order::Position) => Some(*start),
        (DriverSource::Free { velocity, .. }, Order::Velocity) => Some(*velocity),
        _ => None,
    }
}

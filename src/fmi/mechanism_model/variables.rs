//! The table of variables of a mechanism's FMU. Getters, setters and `modelDescription.xml` read
//! it.

use crate::fmi::variable::{Causality, Enumeration, Kind, Variability, Variable};
use crate::kinematics::{Dependencies, ForceQuantity, Output, OutputSource};
use crate::mechanism::{DriverId, DriverSource, Mechanism, Order, ParameterId, Signal, Unit};

/// Version of the table, part of the GUID. A change of the table for the same mechanism raises it.
pub const TABLE_VERSION: u32 = 2;
/// Version of the variables of forces, part of the GUID of mechanisms with dynamics.
pub(super) const FORCE_TABLE_VERSION: u32 = 1;

/// A variable's meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Value, velocity or acceleration of a driver that is an input.
    Input(DriverId, Order),
    /// Size of a force that is an input, by its place among all such inputs.
    ForceInput(usize),
    /// A parameter of the mechanism.
    Parameter(ParameterId),
    /// The source of the drivers' rates.
    RateSource,
    /// The extrapolation of inputs during a step.
    Extrapolation,
    /// A signal of the mechanism, or a time derivative of it.
    Output(Signal, Order),
    /// A measure that is computed from others, by its index in [`Mechanism::derived`], and the
    /// highest order of the signals that it uses.
    Derived(usize, Order),
    /// A force, an energy or an inertia.
    Force(ForceQuantity),
    /// Largest scaled residual of the constraint equations.
    Residual,
    /// Scaled reciprocal condition of the Jacobian.
    Rcond,
    /// Newton iterations of the last step.
    Iterations,
    /// Sub-steps of the last step.
    Substeps,
    /// Whether the last step was proved throughout.
    Proved,
    /// Time.
    Time,
}

/// Choices of the source of the drivers' rates.
pub static RATE_SOURCES: Enumeration = Enumeration {
    name: "biela.Rates",
    items: &[
        (
            "auto",
            "each rate input once it was set to other than zero after initialization, otherwise \
             input derivatives, otherwise an estimate",
        ),
        ("inputs", "the rate inputs, always"),
        (
            "estimated",
            "input derivatives, otherwise an estimate from the last three positions",
        ),
    ],
};

/// Choices of the extrapolation of inputs during a step.
pub static EXTRAPOLATIONS: Enumeration = Enumeration {
    name: "biela.Extrapolation",
    items: &[
        (
            "hold",
            "held over a step: outputs lag the inputs by one step",
        ),
        ("taylor", "extrapolated by velocity and acceleration"),
    ],
};

/// Returns the variables of a mechanism's FMU in the order of their value references: inputs,
/// inputs of forces, parameters, settings, bodies, markers, measures, motions, measures computed
/// from others, forces, solver, time; in the file's order within each group.
#[must_use]
pub fn variables(mechanism: &Mechanism) -> Vec<Variable<Quantity>> {
    let mut table = Table::default();
    table.add_inputs(mechanism);
    table.add_force_inputs(mechanism);
    table.add_parameters(mechanism);
    if has_inputs(mechanism) {
        table.add_settings();
    }
    table.add_outputs(mechanism);
    table.add_solver();
    table.add(
        "time",
        "",
        Quantity::Time,
        (Causality::Independent, Variability::Continuous),
        Kind::real(Some(Unit::SECOND), None),
    );
    table.list
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

    fn add_inputs(&mut self, mechanism: &Mechanism) {
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            let DriverSource::Input { start } = driver.source else {
                continue;
            };
            let driver_id = DriverId(index);
            let outputs = Output::of_driver(mechanism, driver_id).into_iter();
            for (order, output) in Order::ALL.into_iter().zip(outputs) {
                let [start, min, max] = match order {
                    Order::Position => [Some(start), driver.min, driver.max],
                    _ => [Some(0.0), None, None],
                };
                self.list.push(Variable {
                    derivative_of: self.place_before(output.derivative_of),
                    name: output.name,
                    description: output.description,
                    quantity: Quantity::Input(driver_id, order),
                    causality: Causality::Input,
                    variability: Variability::Continuous,
                    kind: Kind::Real {
                        unit: Some(output.unit),
                        start,
                        min,
                        max,
                        nominal: None,
                    },
                });
            }
        }
    }

    /// Returns the place at a distance before the next one.
    fn place_before(&self, distance: Option<usize>) -> Option<u32> {
        distance.map(|distance| (self.list.len() - distance) as u32)
    }

    fn add_parameters(&mut self, mechanism: &Mechanism) {
        for (index, parameter) in mechanism.parameters.iter().enumerate() {
            let id = ParameterId(index);
            let (causality, tunable) = if parameter.derived {
                let tunable = derived_from_tunable(mechanism, id);
                (Causality::CalculatedParameter, tunable)
            } else {
                (Causality::Parameter, parameter.tunable)
            };
            let variability = if tunable {
                Variability::Tunable
            } else {
                Variability::Fixed
            };
            self.add(
                parameter.name.clone(),
                parameter.description.clone(),
                Quantity::Parameter(id),
                (causality, variability),
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

    fn add_settings(&mut self) {
        self.add(
            "rates",
            "source of the velocity and acceleration of the inputs",
            Quantity::RateSource,
            (Causality::Parameter, Variability::Fixed),
            Kind::Enumeration(&RATE_SOURCES),
        );
        self.add(
            "extrapolation",
            "path of inputs without input derivatives during a step",
            Quantity::Extrapolation,
            (Causality::Parameter, Variability::Fixed),
            Kind::Enumeration(&EXTRAPOLATIONS),
        );
    }

    fn add_outputs(&mut self, mechanism: &Mechanism) {
        for output in Output::of_host(mechanism) {
            let (quantity, unit) = match output.source {
                OutputSource::Signal(signal, order) => {
                    (Quantity::Output(signal, order), Some(output.unit))
                }
                OutputSource::Derived(index) => {
                    let measure = &mechanism.derived[index];
                    (Quantity::Derived(index, measure.order()), measure.unit)
                }
                OutputSource::Force(force) => (Quantity::Force(force), Some(output.unit)),
            };
            self.list.push(Variable {
                derivative_of: self.place_before(output.derivative_of),
                name: output.name,
                description: output.description,
                quantity,
                causality: Causality::Output,
                variability: Variability::Continuous,
                kind: Kind::real(unit, None),
            });
        }
    }

    fn add_force_inputs(&mut self, mechanism: &Mechanism) {
        for (place, input) in mechanism.force_inputs().into_iter().enumerate() {
            self.add(
                input.name,
                input.description,
                Quantity::ForceInput(place),
                (Causality::Input, Variability::Continuous),
                Kind::real(Some(input.unit), Some(0.0)),
            );
        }
    }

    fn add_solver(&mut self) {
        let mut add = |name, description, quantity, variability, kind| {
            let traits = (Causality::Local, variability);
            self.add(name, description, quantity, traits, kind);
        };
        let real = Kind::real(Some(Unit::ONE), None);
        add(
            "solver.residual",
            "largest residual of the constraint equations, in characteristic lengths and radians",
            Quantity::Residual,
            Variability::Continuous,
            real.clone(),
        );
        add(
            "solver.rcond",
            "scaled reciprocal condition of the Jacobian: 1 is best, 0 a singular position",
            Quantity::Rcond,
            Variability::Continuous,
            real,
        );
        add(
            "solver.iterations",
            "Newton iterations of the last step",
            Quantity::Iterations,
            Variability::Discrete,
            Kind::Integer,
        );
        add(
            "solver.substeps",
            "sub-steps of the last step, 1 for an ordinary one",
            Quantity::Substeps,
            Variability::Discrete,
            Kind::Integer,
        );
        add(
            "solver.proved",
            "1 if the last step was proved throughout to stay on its branch, 0 if parts were checked",
            Quantity::Proved,
            Variability::Discrete,
            Kind::Integer,
        );
    }
}

/// Returns whether any driver is an FMI input.
#[must_use]
pub fn has_inputs(mechanism: &Mechanism) -> bool {
    let mut drivers = mechanism.drivers.iter();
    drivers.any(|driver| driver.motion().is_none())
}

fn derived_from_tunable(mechanism: &Mechanism, parameter: ParameterId) -> bool {
    let mut roots = Dependencies::default();
    roots.add_parameter(mechanism, parameter);
    let mut roots = roots.parameters.iter();
    roots.any(|root| mechanism.parameters[root.index()].tunable)
}

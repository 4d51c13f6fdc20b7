//! The table of variables of a mechanism's FMU. Getters, setters and `modelDescription.xml` read
//! it.

use std::sync::Arc;

use crate::fmi::variable::{Causality, Enumeration, Kind, Variability, Variable};
use crate::kinematics::{Dependencies, Element, ForceQuantity, Path, Reported, Solver, System};
use crate::mechanism::{
    COMPONENTS, Coordinate, CoordinateKind, DriverId, DriverSource, Indeterminate, Load, Mechanism,
    ParameterId, SUFFIXES, Unit,
};
pub use crate::mechanism::{Order, Signal};

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
    table.add_derived(mechanism);
    if mechanism.has_dynamics() {
        table.add_forces(mechanism);
    }
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

/// A signal's entry in the table.
struct SignalEntry {
    signal: Signal,
    /// Last part of the variables' names, by order.
    names: [&'static str; 3],
    description: String,
    /// Units by order.
    units: [Unit; 3],
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

    /// Makes the last variable the time derivative of the one `distance` before it.
    fn derives(&mut self, order: Order, distance: usize) {
        if order > Order::Position
            && let Some(last) = self.list.len().checked_sub(1)
        {
            self.list[last].derivative_of = Some((last - distance) as u32);
        }
    }

    fn add_inputs(&mut self, mechanism: &Mechanism) {
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            let DriverSource::Input { start } = driver.source else {
                continue;
            };
            let description = describe(mechanism, &driver.description, &driver.coordinate);
            let units = driver.coordinate.kind.units();
            for order in Order::ALL {
                let [start, min, max] = match order {
                    Order::Position => [Some(start), driver.min, driver.max],
                    _ => [Some(0.0), None, None],
                };
                self.add(
                    format!("{}.{}", driver.name, order.suffix()),
                    of_order(order, &description),
                    Quantity::Input(DriverId(index), order),
                    (Causality::Input, Variability::Continuous),
                    Kind::Real {
                        unit: Some(units[order as usize]),
                        start,
                        min,
                        max,
                        nominal: None,
                    },
                );
                self.derives(order, 1);
            }
        }
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

    /// Adds the signals of one owner: all values, then all velocities, then all accelerations.
    fn add_signals(&mut self, owner: &str, entries: &[SignalEntry]) {
        for order in Order::ALL {
            for entry in entries {
                self.add(
                    format!("{owner}.{}", entry.names[order as usize]),
                    of_order(order, &entry.description),
                    Quantity::Output(entry.signal, order),
                    (Causality::Output, Variability::Continuous),
                    Kind::real(Some(entry.units[order as usize]), None),
                );
                self.derives(order, entries.len());
            }
        }
    }

    fn add_outputs(&mut self, mechanism: &Mechanism) {
        let [x, y, phi] = COMPONENTS;
        for &id in &mechanism.outputs.bodies {
            let body = &mechanism.bodies[id.index()].name;
            let entry = |component, names: [&'static str; 3], units, what: &str| SignalEntry {
                signal: Signal::Body(id, component),
                names,
                description: format!("{what} of `{body}`"),
                units,
            };
            let entries = [
                entry(0, x, CoordinateKind::LENGTHS, "x of the origin"),
                entry(1, y, CoordinateKind::LENGTHS, "y of the origin"),
                entry(2, phi, CoordinateKind::ANGLES, "the angle"),
            ];
            self.add_signals(body, &entries);
        }
        for &id in &mechanism.outputs.markers {
            let marker = mechanism.marker_path(id);
            let entries = [x, y].into_iter().enumerate().map(|(component, names)| {
                let signal = Signal::Marker(id, component);
                SignalEntry {
                    signal,
                    names,
                    description: format!("{} of marker `{marker}`", names[0]),
                    units: CoordinateKind::LENGTHS,
                }
            });
            self.add_signals(&marker, &entries.collect::<Vec<_>>());
        }
        let mut add_coordinate = |signal, name: &str, description: &str, coordinate| {
            let entry = SignalEntry {
                signal,
                names: SUFFIXES,
                description: describe(mechanism, description, coordinate),
                units: coordinate.kind.units(),
            };
            self.add_signals(name, &[entry]);
        };
        for (index, measure) in mechanism.measures.iter().enumerate() {
            let signal = Signal::Measure(index);
            add_coordinate(
                signal,
                &measure.name,
                &measure.description,
                &measure.coordinate,
            );
        }
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            if driver.motion().is_some() {
                let signal = Signal::Motion(DriverId(index));
                add_coordinate(
                    signal,
                    &driver.name,
                    &driver.description,
                    &driver.coordinate,
                );
            }
        }
    }

    fn add_derived(&mut self, mechanism: &Mechanism) {
        for (index, measure) in mechanism.derived.iter().enumerate() {
            self.add(
                &*measure.name,
                &*measure.description,
                Quantity::Derived(index, measure.order()),
                (Causality::Output, Variability::Continuous),
                Kind::real(measure.unit, None),
            );
        }
    }

    fn add_force_inputs(&mut self, mechanism: &Mechanism) {
        let mut place = 0;
        for force in mechanism
            .forces
            .iter()
            .filter(|force| force.load.is_input())
        {
            let description = describe_load(mechanism, &force.description, &force.load);
            for (suffix, unit) in force.load.variables() {
                self.add(
                    format!("{}.{suffix}", force.name),
                    of_component(suffix, &description),
                    Quantity::ForceInput(place),
                    (Causality::Input, Variability::Continuous),
                    Kind::real(Some(unit), Some(0.0)),
                );
                place += 1;
            }
        }
    }

    /// Adds the outputs of a mechanism with dynamics.
    fn add_forces(&mut self, mechanism: &Mechanism) {
        let mut add = |owner: &str, suffix: &str, description: String, quantity, unit| {
            self.add(
                format!("{owner}.{suffix}"),
                description,
                Quantity::Force(quantity),
                (Causality::Output, Variability::Continuous),
                Kind::real(Some(unit), None),
            );
        };
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            let (id, kind) = (DriverId(index), driver.coordinate.kind);
            let (name, effort, inertia) = (&driver.name, kind.effort_unit(), kind.inertia_unit());
            let word = if kind.is_angle() { "torque" } else { "force" };
            let exerted = format!("{word} that driver `{name}` exerts");
            add(
                name,
                "effort",
                exerted.clone(),
                ForceQuantity::Effort(id),
                effort,
            );
            let power = format!("power of driver `{name}`");
            add(name, "power", power, ForceQuantity::Power(id), Unit::WATT);
            if driver.motion().is_none() {
                let felt = format!("inertia that driver `{name}` feels");
                add(name, "inertia", felt, ForceQuantity::Inertia(id), inertia);
                let bias = format!("{exerted} if no input accelerates");
                add(name, "bias", bias, ForceQuantity::Bias(id), effort);
            }
        }
        let omitted = match mechanism.outputs.indeterminate {
            Indeterminate::Omit => indeterminate(mechanism),
            Indeterminate::MinimumNorm => Vec::new(),
        };
        for &index in &mechanism.outputs.joints {
            let joint = &mechanism.joints[index];
            if omitted.contains(&Element::Joint(index)) {
                continue;
            }
            let reported = Reported::of(&joint.kind);
            let body = mechanism.markers[joint.to.index()].body;
            let body = body.map_or("ground", |body| &mechanism.bodies[body.index()].name);
            for (component, suffix) in Load::COMPONENTS.into_iter().enumerate() {
                if reported.has(component) {
                    let (word, unit) = match component {
                        0 => ("force along x", Unit::NEWTON),
                        1 => ("force along y", Unit::NEWTON),
                        _ => ("torque", Unit::NEWTON_METRE),
                    };
                    let description = format!("{word} of joint `{}` on `{body}`", joint.name);
                    let quantity = ForceQuantity::Reaction(index, component);
                    add(&joint.name, suffix, description, quantity, unit);
                }
            }
        }
        for &index in &mechanism.outputs.constraints {
            let held = &mechanism.constraints[index];
            if !omitted.contains(&Element::Constraint(index)) {
                let kind = held.coordinate.kind;
                let word = if kind.is_angle() { "torque" } else { "force" };
                let description = format!("{word} that constraint `{}` exerts", held.name);
                let quantity = ForceQuantity::Held(index);
                add(
                    &held.name,
                    "effort",
                    description,
                    quantity,
                    kind.effort_unit(),
                );
            }
        }
        for (index, force) in mechanism.forces.iter().enumerate() {
            if !force.load.is_input() {
                let description = describe_load(mechanism, &force.description, &force.load);
                for (component, (suffix, unit)) in force.load.variables().into_iter().enumerate() {
                    let description = of_component(suffix, &description);
                    let quantity = ForceQuantity::Applied(index, component);
                    add(&force.name, suffix, description, quantity, unit);
                }
            }
        }
        for (suffix, description, quantity) in [
            (
                "kinetic",
                "kinetic energy of all bodies",
                ForceQuantity::KineticEnergy,
            ),
            (
                "potential",
                "potential energy of gravity, zero at ground's origin, and of springs",
                ForceQuantity::PotentialEnergy,
            ),
        ] {
            add(
                "energy",
                suffix,
                description.to_owned(),
                quantity,
                Unit::JOULE,
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

/// Returns the joints and constraints whose reactions redundant constraints leave indeterminate,
/// at the file's own values; none if the mechanism does not assemble there.
#[must_use]
pub fn indeterminate(mechanism: &Mechanism) -> Vec<Element> {
    let system = System::new(Arc::new(mechanism.clone()));
    if system.equations().len() <= system.unknowns() {
        return Vec::new();
    }
    let Ok(mut solver) = Solver::new(Arc::clone(system.mechanism())) else {
        return Vec::new();
    };
    match solver.assemble(&Path::new(mechanism)) {
        Ok(_) => solver.indeterminate(),
        Err(_) => Vec::new(),
    }
}

fn derived_from_tunable(mechanism: &Mechanism, parameter: ParameterId) -> bool {
    let mut roots = Dependencies::default();
    roots.add_parameter(mechanism, parameter);
    let mut roots = roots.parameters.iter();
    roots.any(|root| mechanism.parameters[root.index()].tunable)
}

/// Returns whether a coordinate is an angle.
pub(super) fn is_angle(coordinate: &Coordinate) -> bool {
    coordinate.kind.is_angle()
}

/// Returns the file's own description of a coordinate, or else what it measures.
fn describe(mechanism: &Mechanism, own: &str, coordinate: &Coordinate) -> String {
    if !own.is_empty() {
        return own.to_owned();
    }
    let [from, to, axes] =
        [coordinate.from, coordinate.to, coordinate.axes].map(|id| mechanism.marker_path(id));
    let on_axes = if axes == from {
        String::new()
    } else {
        format!(" on the axes of `{axes}`")
    };
    match coordinate.kind {
        CoordinateKind::Angle => format!("the angle from `{from}` to `{to}`"),
        CoordinateKind::X => format!("x from `{from}` to `{to}`{on_axes}"),
        CoordinateKind::Y => format!("y from `{from}` to `{to}`{on_axes}"),
        CoordinateKind::Distance => format!("the distance from `{from}` to `{to}`"),
    }
}

/// Returns the file's own description of a force, or else the place where it acts.
fn describe_load(mechanism: &Mechanism, own: &str, load: &Load) -> String {
    match load {
        _ if !own.is_empty() => own.to_owned(),
        Load::Coordinate { coordinate, .. } => {
            let word = if coordinate.kind.is_angle() {
                "torque"
            } else {
                "force"
            };
            format!("{word} along {}", describe(mechanism, "", coordinate))
        }
        Load::Marker { marker, .. } => {
            format!("force and torque at `{}`", mechanism.marker_path(*marker))
        }
    }
}

/// Returns the description of a component of a force.
fn of_component(suffix: &str, description: &str) -> String {
    match suffix {
        "effort" => description.to_owned(),
        component => format!("{component}: {description}"),
    }
}

/// Returns the description of a signal's derivative.
fn of_order(order: Order, description: &str) -> String {
    match order {
        Order::Position => description.to_owned(),
        Order::Velocity => format!("velocity: {description}"),
        Order::Acceleration => format!("acceleration: {description}"),
    }
}

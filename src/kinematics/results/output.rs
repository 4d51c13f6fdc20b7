//! The quantities that a mechanism's run gives, by name.

use std::sync::Arc;

use crate::kinematics::analysis::Sensitivity;
use crate::kinematics::error::Error;
use crate::kinematics::forces::{ForceQuantity, Reported};
use crate::kinematics::origin::Origin;
use crate::kinematics::path::{Path, Rates};
use crate::kinematics::solver::Solver;
use crate::kinematics::system::System;
use crate::mechanism::{
    COMPONENTS, Coordinate, CoordinateEquation, CoordinateKind, DriverId, Indeterminate, Jet,
    Joint, JointKind, Load, Mechanism, Order, SUFFIXES, Signal, Unit,
};

/// A quantity that a run gives, such as `rod.omega`.
#[derive(Clone, Debug)]
pub struct Output {
    /// Name, unique in the mechanism.
    pub name: String,
    /// One line for people, empty if the file gives none.
    pub description: String,
    /// Meaning of the values.
    pub source: OutputSource,
    /// Unit of the values, [`Unit::ONE`] if the file gives none.
    pub unit: Unit,
    /// The distance to the output before this one whose time derivative it is.
    pub derivative_of: Option<usize>,
}

/// Meaning of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OutputSource {
    /// A signal or a time derivative of it.
    Signal(Signal, Order),
    /// A measure that is computed from others, by its index.
    Derived(usize),
    /// A force, an energy or an inertia.
    Force(ForceQuantity),
}

impl OutputSource {
    /// Returns the change of the value along the direction of a sensitivity of this mechanism
    /// \[SI\], not a number for a force and for a measure without a value.
    ///
    /// # Errors
    ///
    /// [`Error::NoDerivative`] where an expression has none, [`Error::ChangePoint`] where it has no
    /// limit at a change point.
    pub fn change(
        self,
        mechanism: &Mechanism,
        sensitivity: &Sensitivity<'_>,
    ) -> Result<f64, Error> {
        let change = match self {
            Self::Signal(signal, order) => order.of(sensitivity.signal(signal)),
            Self::Derived(index) => {
                let measure = &mechanism.derived[index];
                let value = sensitivity.derived_value(measure);
                if !value.value.is_finite() {
                    return Ok(f64::NAN);
                }
                let mut signals = measure.signals();
                let exist = |(signal, order): (Signal, Order)| {
                    order.of(sensitivity.signal(signal)).is_finite()
                };
                let mut parameters = measure.value.parameters();
                if !value.first().is_finite()
                    && signals.all(exist)
                    && parameters.all(|p| sensitivity.parameter(p).is_finite())
                {
                    let what = format!("measure `{}`", measure.name);
                    let expressions = std::iter::once(&measure.value);
                    return Err(sensitivity.no_derivative(what, expressions));
                }
                value.first()
            }
            Self::Force(_) => return Ok(f64::NAN),
        };
        if change.is_finite() {
            Ok(change)
        } else {
            Err(sensitivity.fault())
        }
    }

    /// Returns whether two outputs belong to one signal.
    #[must_use]
    pub fn is_akin(self, other: Self) -> bool {
        match (self, other) {
            (Self::Signal(one, _), Self::Signal(other, _)) => one == other,
            (one, other) => one == other,
        }
    }
}

impl Output {
    /// Returns value, velocity and acceleration of every driver, then all others.
    #[must_use]
    pub fn all(mechanism: &Arc<Mechanism>) -> Vec<Self> {
        let mut list = List::default();
        for index in 0..mechanism.drivers.len() {
            list.add_driver(mechanism, DriverId(index));
        }
        list.add_places(mechanism);
        let omitted = omitted_reactions(mechanism);
        list.add_derived_and_forces(mechanism, &omitted);
        list.0
    }

    /// Returns value, velocity and acceleration of a driver.
    #[must_use]
    pub fn of_driver(mechanism: &Mechanism, driver: DriverId) -> Vec<Self> {
        let mut list = List::default();
        list.add_driver(mechanism, driver);
        list.0
    }

    /// Returns the outputs of a mechanism whose input drivers a host moves: bodies, markers,
    /// measures, prescribed motions and freedoms, measures computed from others, forces without the
    /// [omitted reactions](omitted_reactions); in the file's order within each group.
    #[must_use]
    pub fn of_host(mechanism: &Mechanism, omitted: &[Origin]) -> Vec<Self> {
        let mut list = List::default();
        list.add_places(mechanism);
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            if !driver.is_given() {
                list.add_driver(mechanism, DriverId(index));
            }
        }
        list.add_derived_and_forces(mechanism, omitted);
        list.0
    }

    /// Returns the value at the solver's pose \[SI\], not a number for a force. See
    /// [`Solver::signal`].
    #[inline]
    #[must_use]
    pub fn value(&self, solver: &Solver, rates: &Rates, driver_rates: &[Jet]) -> f64 {
        match self.source {
            OutputSource::Signal(signal, order) => {
                order.of(solver.signal(signal, rates, driver_rates))
            }
            OutputSource::Derived(index) => solver.derived(index, rates, driver_rates),
            OutputSource::Force(_) => f64::NAN,
        }
    }

    /// Returns whether a film tells it in numbers by default: positions of drivers, points of
    /// interest and measures.
    #[must_use]
    pub fn is_told(&self) -> bool {
        match self.source {
            OutputSource::Signal(Signal::Body(..), _) | OutputSource::Force(_) => false,
            OutputSource::Signal(_, order) => order == Order::Position,
            OutputSource::Derived(_) => true,
        }
    }

    /// Returns whether it is a reaction of a joint or a constraint.
    #[must_use]
    pub fn is_reaction(&self) -> bool {
        matches!(self.source, OutputSource::Force(quantity) if quantity.needs_reactions())
    }

    /// Returns whether it is a force.
    #[must_use]
    pub fn is_force(&self) -> bool {
        matches!(self.source, OutputSource::Force(_))
    }
}

/// A signal with what its outputs are called.
struct NamedSignal {
    signal: Signal,
    /// Last part of the outputs' names, by order.
    names: [&'static str; 3],
    description: String,
    /// Units by order.
    units: [Unit; 3],
}

#[derive(Default)]
struct List(Vec<Output>);

impl List {
    /// Adds the signals of one owner: all values, then all velocities, then all accelerations.
    fn add_signals(&mut self, owner: &str, signals: &[NamedSignal]) {
        for order in Order::ALL {
            for named in signals {
                self.0.push(Output {
                    name: format!("{owner}.{}", named.names[order as usize]),
                    description: of_order(order, &named.description),
                    source: OutputSource::Signal(named.signal, order),
                    unit: named.units[order as usize],
                    derivative_of: (order > Order::Position).then_some(signals.len()),
                });
            }
        }
    }

    fn add_driver(&mut self, mechanism: &Mechanism, id: DriverId) {
        let driver = &mechanism.drivers[id.index()];
        let named = NamedSignal {
            signal: Signal::Motion(id),
            names: SUFFIXES,
            description: describe(mechanism, &driver.description, &driver.coordinate),
            units: driver.coordinate.kind.units(),
        };
        self.add_signals(&driver.name, &[named]);
    }

    /// Adds bodies, markers and measures.
    fn add_places(&mut self, mechanism: &Mechanism) {
        let [x, y, phi] = COMPONENTS;
        for &id in &mechanism.outputs.bodies {
            let body = &mechanism.bodies[id.index()].name;
            let named = |component, names: [&'static str; 3], units, what: &str| NamedSignal {
                signal: Signal::Body(id, component),
                names,
                description: format!("{what} of `{body}`"),
                units,
            };
            let signals = [
                named(0, x, CoordinateKind::LENGTHS, "x of the origin"),
                named(1, y, CoordinateKind::LENGTHS, "y of the origin"),
                named(2, phi, CoordinateKind::ANGLES, "the angle"),
            ];
            self.add_signals(body, &signals);
        }
        for &id in &mechanism.outputs.markers {
            let marker = mechanism.marker_path(id);
            let signals = [x, y].into_iter().enumerate();
            let signals = signals.map(|(component, names)| NamedSignal {
                signal: Signal::Marker(id, component),
                names,
                description: format!("{} of marker `{marker}`", names[0]),
                units: CoordinateKind::LENGTHS,
            });
            self.add_signals(&marker, &signals.collect::<Vec<_>>());
        }
        for (index, measure) in mechanism.measures.iter().enumerate() {
            let named = NamedSignal {
                signal: Signal::Measure(index),
                names: SUFFIXES,
                description: describe(mechanism, &measure.description, &measure.coordinate),
                units: measure.coordinate.kind.units(),
            };
            self.add_signals(&measure.name, &[named]);
        }
    }

    fn add_derived_and_forces(&mut self, mechanism: &Mechanism, omitted: &[Origin]) {
        let derived = mechanism.derived.iter().enumerate();
        self.0.extend(derived.map(|(index, measure)| Output {
            name: measure.name.clone(),
            description: measure.description.clone(),
            source: OutputSource::Derived(index),
            unit: measure.unit.unwrap_or(Unit::ONE),
            derivative_of: None,
        }));
        if mechanism.has_dynamics() {
            self.add_driver_forces(mechanism);
            self.add_reactions(mechanism, omitted);
            let given = mechanism.given_forces().into_iter();
            self.0.extend(given.map(|given| Output {
                name: given.name,
                description: given.description,
                source: OutputSource::Force(ForceQuantity::Applied(given.force, given.component)),
                unit: given.unit,
                derivative_of: None,
            }));
            self.add_energies();
        }
    }

    fn add_force(
        &mut self,
        owner: &str,
        suffix: &str,
        description: String,
        quantity: ForceQuantity,
        unit: Unit,
    ) {
        self.0.push(Output {
            name: format!("{owner}.{suffix}"),
            description,
            source: OutputSource::Force(quantity),
            unit,
            derivative_of: None,
        });
    }

    fn add_driver_forces(&mut self, mechanism: &Mechanism) {
        let drivers = mechanism.drivers.iter().enumerate();
        for (index, driver) in drivers.filter(|(_, driver)| !driver.is_free()) {
            let (id, kind) = (DriverId(index), driver.coordinate.kind);
            let (name, effort) = (&driver.name, kind.effort_unit());
            let exerted = format!("{} that driver `{name}` exerts", kind.effort_word());
            let quantity = ForceQuantity::Effort(id);
            self.add_force(name, "effort", exerted.clone(), quantity, effort);
            let power = format!("power of driver `{name}`");
            self.add_force(name, "power", power, ForceQuantity::Power(id), Unit::WATT);
            if driver.is_input {
                let felt = format!("inertia that driver `{name}` feels");
                let quantity = ForceQuantity::Inertia(id);
                self.add_force(name, "inertia", felt, quantity, kind.inertia_unit());
                let bias = format!("{exerted} if no input accelerates");
                self.add_force(name, "bias", bias, ForceQuantity::Bias(id), effort);
            }
        }
    }

    /// Adds the reactions of joints and constraints but the omitted ones.
    fn add_reactions(&mut self, mechanism: &Mechanism, omitted: &[Origin]) {
        for &index in &mechanism.outputs.joints {
            let joint = &mechanism.joints[index];
            if omitted.contains(&Origin::Joint(index)) {
                continue;
            }
            let reported = Reported::of(&joint.kind);
            let body = mechanism.markers[joint.to.index()].body;
            let body = body.map_or("ground", |body| &mechanism.bodies[body.index()].name);
            if let JointKind::Coupling(equation) = &joint.kind {
                self.add_efforts(index, joint, equation);
                continue;
            }
            for (component, suffix) in Load::COMPONENTS.into_iter().enumerate() {
                if reported.has(component) {
                    let (word, unit) = match component {
                        0 => ("force along x", Unit::NEWTON),
                        1 => ("force along y", Unit::NEWTON),
                        _ => ("torque", Unit::NEWTON_METRE),
                    };
                    let description = format!("{word} of joint `{}` on `{body}`", joint.name);
                    let quantity = ForceQuantity::Reaction(index, component);
                    self.add_force(&joint.name, suffix, description, quantity, unit);
                }
            }
        }
        for &index in &mechanism.outputs.constraints {
            if omitted.contains(&Origin::Constraint(index)) {
                continue;
            }
            let held = &mechanism.constraints[index];
            let kind = held.coordinate.kind;
            let word = kind.effort_word();
            let description = format!("{word} that constraint `{}` exerts", held.name);
            let (quantity, unit) = (ForceQuantity::Held(index), kind.effort_unit());
            self.add_force(&held.name, "effort", description, quantity, unit);
        }
    }

    /// Adds the effort of a coupling, and its efforts along its coordinates.
    fn add_efforts(&mut self, index: usize, joint: &Joint, equation: &CoordinateEquation) {
        let name = &joint.name;
        let description =
            format!("effort of coupling `{name}`, conjugate to left - right of its equation");
        let kind = match equation.is_angle {
            true => CoordinateKind::Angle,
            false => CoordinateKind::Distance,
        };
        let quantity = ForceQuantity::Reaction(index, 2);
        self.add_force(name, "effort", description, quantity, kind.effort_unit());
        for (place, (coordinate, Coordinate { kind, .. })) in
            equation.coordinates.iter().enumerate()
        {
            let word = kind.effort_word();
            let description = format!("{word} that coupling `{name}` exerts along `{coordinate}`");
            let owner = format!("{name}.{coordinate}");
            let quantity = ForceQuantity::Share(index, place);
            self.add_force(&owner, "effort", description, quantity, kind.effort_unit());
        }
    }

    fn add_energies(&mut self) {
        let (unit, kinetic) = (Unit::JOULE, "kinetic energy of all bodies");
        let quantity = ForceQuantity::KineticEnergy;
        self.add_force("energy", "kinetic", kinetic.to_owned(), quantity, unit);
        let potential =
            "potential energy of gravity, zero at ground's origin, and of springs".to_owned();
        let quantity = ForceQuantity::PotentialEnergy;
        self.add_force("energy", "potential", potential, quantity, unit);
    }
}

/// Returns the joints and constraints whose reactions are no outputs, since redundant constraints leave
/// them indeterminate. A rank decides, at the file's own values, which rounding may change; no joint is
/// omitted if the mechanism does not assemble there.
#[must_use]
pub fn omitted_reactions(mechanism: &Arc<Mechanism>) -> Vec<Origin> {
    let omits = mechanism.outputs.indeterminate == Indeterminate::Omit;
    let system = System::new(Arc::clone(mechanism));
    if !mechanism.has_dynamics() || !omits || system.equations().len() <= system.unknowns() {
        return Vec::new();
    }
    let solver = Solver::assembled(Arc::clone(mechanism), &Path::new(mechanism));
    solver.map_or_else(|_| Vec::new(), |mut solver| solver.indeterminate())
}

/// Returns the file's own description of a coordinate, or else what it measures.
fn describe(mechanism: &Mechanism, own: &str, coordinate: &Coordinate) -> String {
    if own.is_empty() {
        coordinate.describe(mechanism)
    } else {
        own.to_owned()
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

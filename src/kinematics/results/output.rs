//! The quantities that a mechanism's run gives, by name.

use std::sync::Arc;

use crate::kinematics::analysis::Sensitivity;
use crate::kinematics::error::Error;
use crate::kinematics::forces::{ForceQuantity, ForceSensitivity, Forces};
use crate::kinematics::origin::Origin;
use crate::kinematics::path::{Path, Rates};
use crate::kinematics::solver::Solver;
use crate::kinematics::system::System;
use crate::mechanism::{
    COMPONENTS, Coordinate, CoordinateKind, DriverId, Dual, Indeterminate, Jet, Mechanism,
    NamedForce, Order, SUFFIXES, Signal, Unit,
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
    /// The forces that it needs.
    pub needs: ForceNeed,
    /// The distance to the output before this one whose time derivative it is.
    pub derivative_of: Option<usize>,
}

/// Forces that an output needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ForceNeed {
    /// None.
    None,
    /// Those that are known without reactions of joints.
    Efforts,
    /// Reactions too.
    Reactions,
}

impl ForceNeed {
    /// Returns the need of these forces.
    fn of(forces: impl Iterator<Item = ForceQuantity>) -> Self {
        let need = forces.map(|force| {
            if force.needs_reactions() {
                Self::Reactions
            } else {
                Self::Efforts
            }
        });
        need.max().unwrap_or(Self::None)
    }
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
    /// An input of the file, by its index.
    Input(usize),
}

impl OutputSource {
    /// Returns the change of the value along the direction of a sensitivity of this mechanism
    /// \[SI\], not a number for a measure without a value. A force, and a measure that uses one, have
    /// one if `forces` are there with their changes along this direction.
    ///
    /// # Errors
    ///
    /// [`Error::NoDerivative`] where an expression has none, [`Error::ChangePoint`] where it has no
    /// limit at a change point.
    pub fn change(
        self,
        mechanism: &Mechanism,
        sensitivity: &Sensitivity<'_>,
        forces: Option<(&Forces, &ForceSensitivity)>,
    ) -> Result<f64, Error> {
        let change = match self {
            Self::Signal(signal, order) => order.of(sensitivity.signal(signal)),
            Self::Derived(index) => {
                let measure = &mechanism.derived[index];
                let force = |quantity| match forces {
                    Some((forces, changes)) => {
                        Dual::new(forces.value(quantity), [changes.raw_change(quantity)])
                    }
                    None => Dual::constant(f64::NAN),
                };
                let value = sensitivity.derived_value(measure, &force);
                if !value.value.is_finite() {
                    return Ok(f64::NAN);
                }
                let mut signals = measure.signals();
                let exist = |(signal, order): (Signal, Order)| {
                    order.of(sensitivity.signal(signal)).is_finite()
                };
                if let Some((_, changes)) = forces {
                    for force in measure.forces() {
                        changes.change(force)?;
                    }
                }
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
            Self::Force(quantity) => {
                return forces.map_or(Ok(f64::NAN), |(_, changes)| changes.change(quantity));
            }
            Self::Input(index) => sensitivity.input(index),
        };
        if change.is_finite() {
            Ok(change)
        } else {
            Err(sensitivity.fault())
        }
    }

    /// Returns whether it is a force, or a measure that uses one.
    #[must_use]
    pub fn uses_forces(self, mechanism: &Mechanism) -> bool {
        match self {
            Self::Signal(..) | Self::Input(_) => false,
            Self::Derived(index) => mechanism.derived[index].uses_forces(),
            Self::Force(_) => true,
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
    /// Returns value, velocity and acceleration of every driver, then those of a
    /// [host](Self::of_host), then the sizes of forces that are inputs, and last the inputs of the file.
    #[must_use]
    pub fn all(mechanism: &Arc<Mechanism>) -> Vec<Self> {
        let mut list = List::default();
        for index in 0..mechanism.drivers.len() {
            list.add_driver(mechanism, DriverId(index));
        }
        list.add_places(mechanism);
        let omitted = omitted_reactions(mechanism);
        list.add_derived_and_forces(mechanism, &omitted);
        let inputs = mechanism.force_inputs().into_iter();
        list.add_forces(inputs.map(|input| NamedForce::of(input, mechanism)));
        let inputs = mechanism.inputs.iter().enumerate();
        list.0.extend(inputs.map(|(index, input)| Self {
            name: input.name.clone(),
            description: input.description.clone(),
            source: OutputSource::Input(index),
            unit: input.unit.unwrap_or(Unit::ONE),
            needs: ForceNeed::None,
            derivative_of: None,
        }));
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
            if !driver.is_given() || driver.follows.is_some() {
                list.add_driver(mechanism, DriverId(index));
            }
        }
        list.add_derived_and_forces(mechanism, omitted);
        list.0
    }

    /// Returns the value at the solver's pose \[SI\], not a number for a force, and for a measure that
    /// uses one, unless `forces` are there. Inputs are among `loads`. See
    /// [`Solver::signal`].
    #[inline]
    #[must_use]
    pub fn value(
        &self,
        solver: &Solver,
        rates: &Rates,
        driver_rates: &[Jet],
        forces: Option<&Forces>,
        loads: &[f64],
    ) -> f64 {
        match self.source {
            OutputSource::Signal(signal, order) => {
                order.of(solver.signal(signal, rates, driver_rates))
            }
            OutputSource::Derived(index) => solver.derived(index, rates, driver_rates, forces),
            OutputSource::Force(quantity) => {
                forces.map_or(f64::NAN, |forces| forces.value(quantity))
            }
            OutputSource::Input(index) => {
                let pose = solver.pose();
                (solver.mechanism()).input_value(index, &pose.parameters, loads, pose.time)
            }
        }
    }

    /// Returns whether a film tells it in numbers by default: positions of drivers, points of
    /// interest and measures.
    #[must_use]
    pub fn is_told(&self) -> bool {
        match self.source {
            OutputSource::Signal(Signal::Body(..), _)
            | OutputSource::Force(_)
            | OutputSource::Input(_) => false,
            OutputSource::Signal(_, order) => order == Order::Position,
            OutputSource::Derived(_) => true,
        }
    }

    /// Returns whether it is a force or a measure that uses one.
    #[must_use]
    pub fn uses_forces(&self) -> bool {
        self.needs > ForceNeed::None
    }

    /// Returns whether it is a reaction of a joint or a constraint or a measure that uses one.
    #[must_use]
    pub fn uses_reactions(&self) -> bool {
        self.needs == ForceNeed::Reactions
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
                    needs: ForceNeed::None,
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
        let derived = derived.filter(|(_, measure)| {
            let mut forces = measure.forces();
            !forces.any(|force| is_among(omitted, force))
        });
        self.0.extend(derived.map(|(index, measure)| Output {
            name: measure.name.clone(),
            description: measure.description.clone(),
            source: OutputSource::Derived(index),
            unit: measure.unit.unwrap_or(Unit::ONE),
            needs: ForceNeed::of(measure.forces()),
            derivative_of: None,
        }));
        let is_wanted = |quantity| match quantity {
            ForceQuantity::Reaction(joint, _) | ForceQuantity::Share(joint, _) => {
                mechanism.outputs.joints.contains(&joint)
            }
            ForceQuantity::Held(held) => mechanism.outputs.constraints.contains(&held),
            _ => true,
        };
        let forces = mechanism.named_forces().into_iter();
        self.add_forces(
            forces.filter(|force| is_wanted(force.quantity) && !is_among(omitted, force.quantity)),
        );
    }

    fn add_forces(&mut self, forces: impl Iterator<Item = NamedForce>) {
        self.0.extend(forces.map(|force| Output {
            name: force.name,
            description: force.description,
            source: OutputSource::Force(force.quantity),
            unit: force.unit,
            needs: ForceNeed::of(std::iter::once(force.quantity)),
            derivative_of: None,
        }));
    }
}

/// Returns whether a quantity is a reaction of one of these joints and constraints.
fn is_among(origins: &[Origin], quantity: ForceQuantity) -> bool {
    match quantity {
        ForceQuantity::Reaction(joint, _) | ForceQuantity::Share(joint, _) => {
            origins.contains(&Origin::Joint(joint))
        }
        ForceQuantity::Held(held) => origins.contains(&Origin::Constraint(held)),
        _ => false,
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

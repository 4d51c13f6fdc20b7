//! Measures that are computed from others.

use super::signal::{COMPONENTS, SUFFIXES};
use super::{
    BodyId, DriverId, Expression, ForceQuantity, MarkerId, Mechanism, Number, Order, ParameterId,
    Signal, Unit, Variable,
};

/// Output that is a function of signals, forces and parameters, such as a ratio of velocities.
#[derive(Clone, Debug)]
pub struct DerivedMeasure {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// The function.
    pub value: Expression,
    /// Unit of the value, `None` if the file gives none.
    pub unit: Option<Unit>,
}

impl DerivedMeasure {
    /// Evaluates it for the given parameters, signals and forces. Not finite where the function has no
    /// value, such as a ratio of velocities at rest. Allocates nothing.
    pub fn evaluate<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        signal: &impl Fn(Signal, Order) -> N,
        force: &impl Fn(ForceQuantity) -> N,
    ) -> N {
        self.value
            .evaluate_at(parameter, &|variable| match variable {
                Variable::Signal(of, order) => signal(of, order),
                Variable::Force(quantity) => force(quantity),
                _ => unreachable!("the reader admits signals and forces alone"),
            })
    }

    /// Returns the highest order of the signals that it uses; forces depend on accelerations.
    #[must_use]
    pub fn order(&self) -> Order {
        if self.uses_forces() {
            return Order::Acceleration;
        }
        let orders = self.signals().map(|(_, order)| order);
        orders.max().unwrap_or(Order::Position)
    }

    /// Returns the forces that it uses.
    pub fn forces(&self) -> impl Iterator<Item = ForceQuantity> {
        self.value
            .variables()
            .filter_map(|variable| match variable {
                Variable::Force(quantity) => Some(quantity),
                _ => None,
            })
    }

    /// Returns whether it uses a force.
    #[must_use]
    pub fn uses_forces(&self) -> bool {
        self.forces().next().is_some()
    }

    /// Returns whether it uses reactions of joints or constraints.
    #[must_use]
    pub fn needs_reactions(&self) -> bool {
        self.forces().any(ForceQuantity::needs_reactions)
    }

    /// Returns the signals that it uses.
    pub fn signals(&self) -> impl Iterator<Item = (Signal, Order)> {
        self.value
            .variables()
            .filter_map(|variable| match variable {
                Variable::Signal(signal, order) => Some((signal, order)),
                _ => None,
            })
    }
}

impl Mechanism {
    /// Returns all signals and their derivatives under the names of their FMU variables, whether
    /// outputs or not.
    pub(super) fn signals(&self) -> Vec<(String, Signal, Order)> {
        let mut signals = Vec::new();
        let mut add = |owner: &str, signal, names: [&str; 3]| {
            let named = Order::ALL.into_iter().zip(names);
            signals.extend(named.map(|(order, name)| (format!("{owner}.{name}"), signal, order)));
        };
        for (index, body) in self.bodies.iter().enumerate() {
            for (component, names) in COMPONENTS.into_iter().enumerate() {
                add(&body.name, Signal::Body(BodyId(index), component), names);
            }
        }
        for id in (0..self.markers.len()).map(MarkerId) {
            let path = self.marker_path(id);
            for (component, names) in COMPONENTS[..2].iter().enumerate() {
                add(&path, Signal::Marker(id, component), *names);
            }
        }
        for (index, measure) in self.measures.iter().enumerate() {
            add(&measure.name, Signal::Measure(index), SUFFIXES);
        }
        for (index, driver) in self.drivers.iter().enumerate() {
            add(&driver.name, Signal::Motion(DriverId(index)), SUFFIXES);
        }
        signals
    }
}

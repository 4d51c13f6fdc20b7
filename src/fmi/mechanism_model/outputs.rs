//! Values of Reals, computed in groups.

use super::MechanismModel;
use super::variables::Quantity;
use crate::fmi::error::Failure;
use crate::fmi::log::Logger;
use crate::fmi::model::Groups;
use crate::fmi::state::Phase;
use crate::fmi::variable::{Variable, derivatives};
use crate::kinematics::{ForceParts, OutputSource};
use crate::mechanism::{ForceQuantity, Jet, Mechanism, Order, Signal};

/// Inputs, parameters, time, and counts of the last step.
const SETTINGS: Groups = 1;
/// Residual and condition at the pose.
const SOLVER: Groups = 1 << 1;
/// Coordinates of bodies. Here and below, the group of the rates is one bit higher.
const BODIES: Groups = 1 << 2;
const BODIES_AND_RATES: Groups = BODIES | BODIES << 1;
/// Points of markers.
const MARKERS: Groups = 1 << 4;
/// Measures and prescribed motions.
const COORDINATES: Groups = 1 << 6;

/// Sizes of forces, and energies.
const LOADS: Groups = 1 << 8;
/// Efforts, powers and inertias of drivers.
const EFFORTS: Groups = 1 << 9;
/// Reactions of joints and efforts of constraints.
const REACTIONS: Groups = 1 << 10;

/// Measures computed from positions; one bit higher those that use rates.
const DERIVED: Groups = 1 << 11;

const FORCES: Groups = LOADS | EFFORTS | REACTIONS;
const POSES: Groups = BODIES | MARKERS | COORDINATES | DERIVED;
const RATES: Groups = POSES << 1;

/// Values of all variables by their places.
#[derive(Debug)]
pub(super) struct Reals {
    values: Box<[f64]>,
    /// Groups whose values are up to date.
    current: Groups,
    bodies: Box<[BodyPlace]>,
    /// All signals but those of bodies.
    signals: Box<[SignalPlace]>,
    /// Places, groups and quantities of all other Reals.
    others: Box<[(usize, Groups, Quantity)]>,
}

/// A body among the outputs. Its nine values follow one another: x, y, phi, then their velocities,
/// then their accelerations.
#[derive(Clone, Copy, Debug)]
struct BodyPlace {
    /// Its index.
    body: usize,
    /// Place of its x.
    first: usize,
}

/// A signal and the places of its values by order.
#[derive(Clone, Copy, Debug)]
struct SignalPlace {
    signal: Signal,
    places: [usize; 3],
}

/// Returns the group of a quantity; 0 for a choice among items.
pub(super) fn group(mechanism: &Mechanism, quantity: Quantity) -> Groups {
    let (group, order) = match quantity {
        Quantity::RateSource | Quantity::Extrapolation => return 0,
        Quantity::Input(..)
        | Quantity::ForceInput(_)
        | Quantity::Parameter(_)
        | Quantity::Weight(..)
        | Quantity::Budget
        | Quantity::Time
        | Quantity::Iterations
        | Quantity::Substeps
        | Quantity::Proved => return SETTINGS,
        Quantity::Residual | Quantity::Rcond => return SOLVER,
        Quantity::Output(OutputSource::Force(force)) => return group_of_force(force),
        Quantity::Output(OutputSource::Derived(index)) => {
            let measure = &mechanism.derived[index];
            // The largest one, for which the others are solved too.
            if let Some(group) = measure.forces().map(group_of_force).max() {
                return group;
            }
            (DERIVED, measure.order())
        }
        Quantity::Output(OutputSource::Signal(signal, order)) => (group_of(signal), order),
        Quantity::Output(OutputSource::Input(_)) => unreachable!("a host has inputs already"),
        Quantity::State(_, order) => (COORDINATES, order),
        Quantity::Clearance(_) => (COORDINATES, Order::Position),
        Quantity::EventIndicator(_) | Quantity::Touching(_) => (COORDINATES, Order::Acceleration),
    };
    if order == Order::Position {
        group
    } else {
        group << 1
    }
}

/// Returns the group of a force.
fn group_of_force(force: ForceQuantity) -> Groups {
    match force {
        _ if force.needs_efforts() => EFFORTS,
        _ if force.needs_reactions() => REACTIONS,
        _ => LOADS,
    }
}

/// Returns the group of a signal's value.
fn group_of(signal: Signal) -> Groups {
    match signal {
        Signal::Body(..) => BODIES,
        Signal::Marker(..) => MARKERS,
        Signal::Measure(_) | Signal::Motion(_) => COORDINATES,
    }
}

impl Reals {
    pub(super) fn new(mechanism: &Mechanism, variables: &[Variable<Quantity>]) -> Self {
        let derivatives = derivatives(variables);
        let mut bodies = Vec::new();
        let mut signals = Vec::new();
        let mut others = Vec::new();
        for (place, variable) in variables.iter().enumerate() {
            match variable.quantity {
                Quantity::Output(OutputSource::Signal(signal, Order::Position)) => match signal {
                    Signal::Body(body, 0) => bodies.push(BodyPlace {
                        body: body.index(),
                        first: place,
                    }),
                    Signal::Body(..) => {}
                    _ => {
                        let next = |of: usize| derivatives[of].expect("signals have two");
                        let places = [place, next(place), next(next(place))];
                        signals.push(SignalPlace { signal, places });
                    }
                },
                Quantity::Output(OutputSource::Signal(..)) => {}
                quantity => others.push((place, group(mechanism, quantity), quantity)),
            }
        }
        Self {
            values: vec![0.0; variables.len()].into(),
            current: 0,
            bodies: bodies.into(),
            signals: signals.into(),
            others: others.into(),
        }
    }

    /// Returns the values.
    #[inline]
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Marks all values as out of date.
    #[inline]
    pub(super) fn invalidate(&mut self) {
        self.current = 0;
    }
}

impl MechanismModel {
    /// Brings the values of these groups up to date. Allocates nothing.
    ///
    /// # Errors
    ///
    /// No pose exists for the values set, or no rates exist at that pose.
    #[inline(always)]
    pub(super) fn refresh_groups(
        &mut self,
        groups: Groups,
        phase: Phase,
        log: &Logger,
    ) -> Result<(), Failure> {
        let missing = groups & !self.reals.current;
        if missing == 0 {
            return Ok(());
        }
        if missing & (POSES | RATES | SOLVER | FORCES) != 0 {
            self.refresh_pose(phase, log)?;
        }
        if missing & (RATES | FORCES) != 0 {
            self.refresh_rates()?;
        }
        if missing & FORCES != 0 {
            self.solve_forces(ForceParts {
                efforts: missing & EFFORTS != 0,
                reactions: missing & REACTIONS != 0,
            })?;
        }
        if missing & BODIES_AND_RATES != 0 {
            self.fill_bodies(missing);
        }
        if missing & !BODIES_AND_RATES != 0 {
            self.fill_others(missing);
        }
        self.reals.current |= missing;
        Ok(())
    }

    /// Fills in the values of bodies. Most hosts read these at every step: no match per value.
    fn fill_bodies(&mut self, groups: Groups) {
        let Reals { values, bodies, .. } = &mut self.reals;
        let (q, _) = self.motion.solver.pose().q.as_chunks();
        let (velocities, _) = self.motion.solution.rates.velocity().as_chunks();
        let (accelerations, _) = self.motion.solution.rates.acceleration().as_chunks();
        for &BodyPlace { body, first } in bodies.iter() {
            let (to, _) = values[first..first + 9].as_chunks_mut::<3>();
            if groups & BODIES != 0 {
                to[0] = q[body];
            }
            if groups & BODIES << 1 != 0 {
                to[1] = velocities[body];
                to[2] = accelerations[body];
            }
        }
    }

    /// Fills in all values but those of bodies.
    #[inline(never)]
    fn fill_others(&mut self, groups: Groups) {
        let Reals {
            values,
            signals,
            others,
            ..
        } = &mut self.reals;
        let (solver, solution) = (&mut self.motion.solver, &self.motion.solution);
        let (rates, driver_rates) = (&solution.rates, &solution.driver_rates);
        for SignalPlace { signal, places } in signals.iter() {
            let group = group_of(*signal);
            let [pose, derivatives] = [group, group << 1].map(|group| groups & group != 0);
            if pose || derivatives {
                let jet = solver.signal(*signal, rates, driver_rates);
                if pose {
                    values[places[0]] = jet.value;
                }
                if derivatives {
                    values[places[1]] = jet.first();
                    values[places[2]] = jet.second();
                }
            }
        }
        for &(place, group, quantity) in others.iter() {
            if groups & group == 0 {
                continue;
            }
            if let Quantity::EventIndicator(index) = quantity {
                let free = self.motion.free();
                values[place] = free.map_or(1.0, |free| free.event_indicator(index));
                continue;
            }
            if let Quantity::Touching(stop) = quantity {
                values[place] = f64::from(self.motion.touching(stop));
                continue;
            }
            let (solver, solution) = (&mut self.motion.solver, &self.motion.solution);
            let (rates, driver_rates) = (&solution.rates, &solution.driver_rates);
            values[place] = match quantity {
                Quantity::Input(driver, order) => self.course.inputs[driver.index()].get(order),
                Quantity::ForceInput(place) => self.course.force_inputs[place].get(),
                Quantity::Parameter(parameter) => self.course.parameters[parameter.index()],
                Quantity::Weight(body, place) => {
                    let weight = self.mechanism.weight_at(body, &self.course.parameters);
                    weight.map_or(f64::NAN, |weight| weight.numbers()[place])
                }
                Quantity::Budget => self.course.budget,
                Quantity::Time => self.course.time,
                Quantity::Residual => solver.residual(),
                Quantity::Rcond => solver.rcond(),
                Quantity::Iterations => f64::from(self.course.progress.iterations),
                Quantity::Substeps => f64::from(self.course.progress.substeps),
                Quantity::Proved => f64::from(u8::from(self.course.progress.checked == 0)),
                Quantity::State(freedom, order) => order.of(Jet {
                    value: solver.pose().drivers[freedom.index()],
                    ..driver_rates[freedom.index()]
                }),
                Quantity::Clearance(stop) => {
                    let shapes = self.mechanism.stops[stop].coordinate.shapes();
                    let found = shapes.and_then(|shapes| solver.clearance(shapes));
                    found.map_or(f64::NAN, |(clearance, _)| clearance)
                }
                Quantity::Output(OutputSource::Derived(index)) => {
                    solver.derived(index, rates, driver_rates, solution.forces())
                }
                Quantity::Output(OutputSource::Force(force)) => solution.force(force),
                _ => unreachable!("the list has no other quantities"),
            };
        }
    }
}

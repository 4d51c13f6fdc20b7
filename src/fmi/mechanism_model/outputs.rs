//! Values of Reals by value reference, computed in groups.

use super::MechanismModel;
use super::variables::Quantity;
use crate::fmi::error::Failure;
use crate::fmi::log::Logger;
use crate::fmi::model::Groups;
use crate::fmi::state::Phase;
use crate::fmi::variable::{Variable, derivatives};
use crate::kinematics::{ForceParts, ForceQuantity};
use crate::mechanism::{Order, Signal};

/// Inputs, parameters, time, and counts of the last step.
const SETTINGS: Groups = 1;
/// Residual and condition at the pose.
const SOLVER: Groups = 1 << 1;
/// Coordinates of bodies. Here and below, the group of the rates is one bit higher.
const BODIES: Groups = 1 << 2;
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

/// Values of all variables by value reference.
#[derive(Debug)]
pub(super) struct Reals {
    values: Box<[f64]>,
    /// Groups whose values are up to date.
    current: Groups,
    bodies: Box<[BodyPlace]>,
    /// All signals but those of bodies.
    signals: Box<[SignalPlace]>,
    /// Value references of all other Reals.
    others: Box<[(u32, Quantity)]>,
    /// Value references and groups of measures computed from others.
    derived: Box<[(u32, Groups)]>,
    /// Value references of forces.
    forces: Box<[(u32, ForceQuantity)]>,
}

/// A body among the outputs. Its nine values have consecutive references: x, y, phi, then their
/// velocities, then their accelerations.
#[derive(Clone, Copy, Debug)]
struct BodyPlace {
    /// Its index.
    body: usize,
    /// Value reference of its x.
    reference: usize,
}

/// A signal and its value references by order.
#[derive(Clone, Copy, Debug)]
struct SignalPlace {
    signal: Signal,
    references: [u32; 3],
}

impl Signal {
    /// Returns the group of the signal's value.
    fn group(self) -> Groups {
        match self {
            Self::Body(..) => BODIES,
            Self::Marker(..) => MARKERS,
            Self::Measure(_) | Self::Motion(_) => COORDINATES,
        }
    }
}

/// Returns the group of a quantity; 0 for a choice among items.
pub(super) fn group(quantity: Quantity) -> Groups {
    match quantity {
        Quantity::Input(..)
        | Quantity::ForceInput(_)
        | Quantity::Parameter(_)
        | Quantity::Time
        | Quantity::Iterations
        | Quantity::Substeps
        | Quantity::Proved => SETTINGS,
        Quantity::Force(force) if force.needs_efforts() => EFFORTS,
        Quantity::Force(force) if force.needs_reactions() => REACTIONS,
        Quantity::Force(_) => LOADS,
        Quantity::Residual | Quantity::Rcond => SOLVER,
        Quantity::Derived(_, Order::Position) => DERIVED,
        Quantity::Derived(..) => DERIVED << 1,
        Quantity::Output(signal, Order::Position) => signal.group(),
        Quantity::Output(signal, _) => signal.group() << 1,
        Quantity::RateSource | Quantity::Extrapolation => 0,
    }
}

impl Reals {
    pub(super) fn new(variables: &[Variable<Quantity>]) -> Self {
        let derivatives = derivatives(variables);
        let mut bodies = Vec::new();
        let mut signals = Vec::new();
        let mut others = Vec::new();
        let mut derived = Vec::new();
        let mut forces = Vec::new();
        for (vr, variable) in (0_u32..).zip(variables) {
            match variable.quantity {
                Quantity::Output(Signal::Body(body, 0), Order::Position) => {
                    bodies.push(BodyPlace {
                        body: body.index(),
                        reference: vr as usize,
                    });
                }
                Quantity::Output(Signal::Body(..), _) => {}
                Quantity::Output(signal, Order::Position) => {
                    let derivative = |of: u32| derivatives[of as usize].expect("signals have two");
                    let references = [vr, derivative(vr), derivative(derivative(vr))];
                    signals.push(SignalPlace { signal, references });
                }
                Quantity::Derived(..) => derived.push((vr, group(variable.quantity))),
                Quantity::Force(force) => forces.push((vr, force)),
                quantity if group(quantity) & (SETTINGS | SOLVER) != 0 => {
                    others.push((vr, quantity));
                }
                _ => {}
            }
        }
        Self {
            values: vec![0.0; variables.len()].into(),
            current: 0,
            bodies: bodies.into(),
            signals: signals.into(),
            others: others.into(),
            derived: derived.into(),
            forces: forces.into(),
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
        if missing & FORCES != 0 {
            self.fill_forces(missing, phase, log)?;
        }
        if missing & RATES != 0 {
            self.refresh_rates(phase, log)?;
        } else if missing & (POSES | SOLVER) != 0 {
            self.refresh_pose(phase, log)?;
        }
        if missing & (BODIES | BODIES << 1) != 0 {
            self.fill_bodies(missing);
        }
        if missing & !(BODIES | BODIES << 1 | FORCES) != 0 {
            self.fill_others(missing);
        }
        self.reals.current |= missing;
        Ok(())
    }

    /// Fills in the values of forces.
    #[inline(never)]
    fn fill_forces(&mut self, groups: Groups, phase: Phase, log: &Logger) -> Result<(), Failure> {
        let parts = ForceParts {
            efforts: groups & EFFORTS != 0,
            reactions: groups & REACTIONS != 0,
        };
        self.refresh_forces(parts, phase, log)?;
        let Reals { values, forces, .. } = &mut self.reals;
        if let Some(solved) = self.forces.as_deref() {
            let is_asked = |force: ForceQuantity| groups & group(Quantity::Force(force)) != 0;
            for &(vr, force) in forces.iter().filter(|(_, force)| is_asked(*force)) {
                values[vr as usize] = solved.value(force);
            }
        }
        Ok(())
    }

    /// Fills in the values of bodies. Most hosts read these at every step: no match per value.
    fn fill_bodies(&mut self, groups: Groups) {
        let Reals { values, bodies, .. } = &mut self.reals;
        let (q, _) = self.solver.pose().q.as_chunks();
        let (velocities, _) = self.rates.velocity().as_chunks();
        let (accelerations, _) = self.rates.acceleration().as_chunks();
        for &BodyPlace { body, reference } in bodies.iter() {
            let (to, _) = values[reference..reference + 9].as_chunks_mut::<3>();
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
        let reals = &mut self.reals;
        let values = &mut reals.values;
        for SignalPlace { signal, references } in &reals.signals {
            let [pose, rates] = [signal.group(), signal.group() << 1].map(|g| groups & g != 0);
            if pose || rates {
                let jet = self.solver.signal(*signal, &self.rates, &self.driver_rates);
                if pose {
                    values[references[0] as usize] = jet.value;
                }
                if rates {
                    values[references[1] as usize] = jet.first();
                    values[references[2] as usize] = jet.second();
                }
            }
        }
        if groups & (DERIVED | DERIVED << 1) != 0 {
            for (index, &(vr, group)) in reals.derived.iter().enumerate() {
                if groups & group != 0 {
                    values[vr as usize] =
                        self.solver.derived(index, &self.rates, &self.driver_rates);
                }
            }
        }
        if groups & (SETTINGS | SOLVER) == 0 {
            return;
        }
        for &(vr, quantity) in reals.others.iter().filter(|(_, q)| groups & group(*q) != 0) {
            values[vr as usize] = match quantity {
                Quantity::Input(driver, order) => self.course.inputs[driver.index()].get(order),
                Quantity::ForceInput(place) => self.course.force_inputs[place].get(),
                Quantity::Parameter(parameter) => self.settings.parameters[parameter.index()],
                Quantity::Time => self.course.time,
                Quantity::Residual => self.solver.residual(),
                Quantity::Rcond => self.solver.rcond(),
                Quantity::Iterations => f64::from(self.course.progress.iterations),
                Quantity::Substeps => f64::from(self.course.progress.substeps),
                Quantity::Proved => f64::from(u8::from(self.course.progress.checked == 0)),
                _ => unreachable!("the list has no other quantities"),
            };
        }
    }
}

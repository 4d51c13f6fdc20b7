//! Values of Reals by value reference, computed in groups.

use super::MechanismModel;
use super::variables::{Order, Quantity, Signal};
use crate::fmi::error::Failure;
use crate::fmi::log::Logger;
use crate::fmi::model::Groups;
use crate::fmi::state::Phase;
use crate::fmi::variable::{Variable, derivatives};

/// Inputs, parameters and time.
const SETTINGS: Groups = 1;
/// Residual and condition at the pose.
const SOLVER: Groups = 1 << 1;
/// Groups of values of each kind of signal; the group of its rates is one bit higher.
const KINDS: [Groups; 3] = [1 << 2, 1 << 4, 1 << 6];
const VALUES: Groups = KINDS[0] | KINDS[1] | KINDS[2];
const RATES: Groups = VALUES << 1;

/// Values of all variables by value reference.
#[derive(Debug)]
pub(super) struct Reals {
    values: Box<[f64]>,
    /// Groups whose values are up to date.
    current: Groups,
    /// Signals of each kind.
    signals: [Box<[SignalPlace]>; 3],
    /// Value references of all other Reals.
    others: Box<[(u32, Quantity)]>,
}

/// A signal and its value references by order.
#[derive(Clone, Copy, Debug)]
struct SignalPlace {
    signal: Signal,
    references: [u32; 3],
}

impl Signal {
    /// Returns the index of the signal's kind.
    fn kind(self) -> usize {
        match self {
            Self::Body(..) => 0,
            Self::Marker(..) => 1,
            Self::Measure(_) | Self::Motion(_) => 2,
        }
    }
}

/// Returns the group of a quantity; 0 for a quantity that is no Real.
pub(super) fn group(quantity: Quantity) -> Groups {
    match quantity {
        Quantity::Input(..) | Quantity::Parameter(_) | Quantity::Time => SETTINGS,
        Quantity::Residual | Quantity::Rcond => SOLVER,
        Quantity::Output(signal, Order::Position) => KINDS[signal.kind()],
        Quantity::Output(signal, _) => KINDS[signal.kind()] << 1,
        Quantity::RateSource
        | Quantity::Extrapolation
        | Quantity::Iterations
        | Quantity::Substeps => 0,
    }
}

impl Reals {
    pub(super) fn new(variables: &[Variable<Quantity>]) -> Self {
        let derivatives = derivatives(variables);
        let mut signals = [Vec::new(), Vec::new(), Vec::new()];
        let mut others = Vec::new();
        for (vr, variable) in (0_u32..).zip(variables) {
            match variable.quantity {
                Quantity::Output(signal, Order::Position) => {
                    let derivative = |of: u32| derivatives[of as usize].expect("signals have two");
                    let references = [vr, derivative(vr), derivative(derivative(vr))];
                    signals[signal.kind()].push(SignalPlace { signal, references });
                }
                quantity if group(quantity) & (SETTINGS | SOLVER) != 0 => {
                    others.push((vr, quantity));
                }
                _ => {}
            }
        }
        Self {
            values: vec![0.0; variables.len()].into(),
            current: 0,
            signals: signals.map(Vec::into_boxed_slice),
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
    #[inline]
    pub(super) fn refresh_groups(
        &mut self,
        groups: Groups,
        phase: Phase,
        log: &Logger,
    ) -> Result<(), Failure> {
        let missing = groups & !self.reals.current;
        if missing & RATES != 0 {
            self.refresh_rates(phase, log)?;
        } else if missing & (VALUES | SOLVER) != 0 {
            self.refresh_pose(phase, log)?;
        }
        if missing != 0 {
            self.fill(missing);
        }
        Ok(())
    }

    fn fill(&mut self, groups: Groups) {
        let Reals {
            values,
            current,
            signals,
            others,
        } = &mut self.reals;
        *current |= groups;
        for (value_group, places) in KINDS.into_iter().zip(&*signals) {
            let rate_group = value_group << 1;
            if groups & (value_group | rate_group) == 0 {
                continue;
            }
            *current |= value_group;
            for SignalPlace { signal, references } in places {
                let jet = signal.jet(&self.solver, &self.rates, &self.driver_rates);
                values[references[0] as usize] = jet.value;
                if groups & rate_group != 0 {
                    values[references[1] as usize] = jet.first;
                    values[references[2] as usize] = jet.second;
                }
            }
        }
        if groups & (SETTINGS | SOLVER) == 0 {
            return;
        }
        for &(vr, quantity) in others.iter().filter(|(_, q)| groups & group(*q) != 0) {
            values[vr as usize] = match quantity {
                Quantity::Input(driver, order) => self.inputs[driver.index()].get(order),
                Quantity::Parameter(parameter) => self.settings.parameters[parameter.index()],
                Quantity::Time => self.time,
                Quantity::Residual => self.solver.residual(),
                Quantity::Rcond => self.solver.rcond(),
                _ => unreachable!("the list has no other quantities"),
            };
        }
    }
}

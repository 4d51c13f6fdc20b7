//! The quantities of a run, as columns of its results.

use super::variables::{Order, Quantity, Signal, variables};
use crate::fmi::variable::Kind;
use crate::kinematics::{Rates, Sensitivity, Solver};
use crate::mechanism::{Jet, Mechanism, Unit};

/// One quantity of a run.
#[derive(Clone, Debug)]
pub struct Column {
    /// Name of the FMU's variable.
    pub name: String,
    /// Signal of the mechanism.
    pub signal: Signal,
    /// Order of its time derivative.
    pub order: Order,
    /// Unit of its values.
    pub unit: Unit,
}

impl Column {
    /// Returns value, velocity and acceleration of every driver, then all outputs of the FMU.
    #[must_use]
    pub fn all(mechanism: &Mechanism) -> Vec<Self> {
        let variables = variables(mechanism).into_iter();
        let mut columns: Vec<Self> = variables
            .filter_map(|variable| {
                let Kind::Real { unit, .. } = variable.kind else {
                    return None;
                };
                let (signal, order) = match variable.quantity {
                    // In a run an input follows a motion.
                    Quantity::Input(driver, order) => (Signal::Motion(driver), order),
                    Quantity::Output(signal, order) => (signal, order),
                    _ => return None,
                };
                Some(Self {
                    name: variable.name,
                    signal,
                    order,
                    unit: unit.unwrap_or(Unit::ONE),
                })
            })
            .collect();
        columns.sort_by_key(|column| match column.signal {
            Signal::Motion(driver) => driver.index(),
            _ => usize::MAX,
        });
        columns
    }

    /// Returns the value at the solver's pose \[SI\]. See [`Signal::jet`].
    #[inline]
    #[must_use]
    pub fn value(&self, solver: &Solver, rates: &Rates, driver_rates: &[Jet]) -> f64 {
        self.order.of(self.signal.jet(solver, rates, driver_rates))
    }

    /// Returns the change of the value along the direction of a sensitivity \[SI\].
    #[must_use]
    pub fn change(&self, sensitivity: &Sensitivity<'_>) -> f64 {
        self.order.of(self.signal.change(sensitivity))
    }

    /// Returns whether a film tells the column in numbers by default: positions of drivers, points
    /// of interest and measures.
    #[must_use]
    pub fn is_told(&self) -> bool {
        self.order == Order::Position && !matches!(self.signal, Signal::Body(..))
    }
}

//! The quantities of a run, as columns of its results.

use super::variables::{Order, Quantity, Signal, variables};
use crate::fmi::variable::Kind;
use crate::kinematics::{ForceQuantity, Rates, Sensitivity, Solver};
use crate::mechanism::{Jet, Mechanism, Unit};

/// One quantity of a run.
#[derive(Clone, Debug)]
pub struct Column {
    /// Name of the FMU's variable.
    pub name: String,
    /// Meaning of the values.
    pub source: ColumnSource,
    /// Unit of the values.
    pub unit: Unit,
}

/// Meaning of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnSource {
    /// A signal or a time derivative of it.
    Signal(Signal, Order),
    /// A measure that is computed from others, by its index.
    Derived(usize),
    /// A force, an energy or an inertia.
    Force(ForceQuantity),
}

impl ColumnSource {
    /// Returns whether two columns belong to one signal.
    #[must_use]
    pub fn is_akin(self, other: Self) -> bool {
        match (self, other) {
            (Self::Signal(one, _), Self::Signal(other, _)) => one == other,
            (one, other) => one == other,
        }
    }
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
                let source = match variable.quantity {
                    // In a run an input follows a motion.
                    Quantity::Input(driver, order) => {
                        ColumnSource::Signal(Signal::Motion(driver), order)
                    }
                    Quantity::Output(signal, order) => ColumnSource::Signal(signal, order),
                    Quantity::Derived(index, _) => ColumnSource::Derived(index),
                    Quantity::Force(force) => ColumnSource::Force(force),
                    _ => return None,
                };
                Some(Self {
                    name: variable.name,
                    source,
                    unit: unit.unwrap_or(Unit::ONE),
                })
            })
            .collect();
        columns.sort_by_key(|column| match column.source {
            ColumnSource::Signal(Signal::Motion(driver), _) => driver.index(),
            _ => usize::MAX,
        });
        columns
    }

    /// Returns the value at the solver's pose \[SI\], not a number for a force. See
    /// [`Solver::signal`].
    #[inline]
    #[must_use]
    pub fn value(&self, solver: &Solver, rates: &Rates, driver_rates: &[Jet]) -> f64 {
        match self.source {
            ColumnSource::Signal(signal, order) => {
                order.of(solver.signal(signal, rates, driver_rates))
            }
            ColumnSource::Derived(index) => solver.derived(index, rates, driver_rates),
            ColumnSource::Force(_) => f64::NAN,
        }
    }

    /// Returns the change of the value along the direction of a sensitivity of this mechanism
    /// \[SI\], not a number for a force.
    #[must_use]
    pub fn change(&self, mechanism: &Mechanism, sensitivity: &Sensitivity<'_>) -> f64 {
        match self.source {
            ColumnSource::Signal(signal, order) => order.of(sensitivity.signal(signal)),
            ColumnSource::Derived(index) => sensitivity.derived(&mechanism.derived[index]),
            ColumnSource::Force(_) => f64::NAN,
        }
    }

    /// Returns whether a film tells the column in numbers by default: positions of drivers, points
    /// of interest and measures.
    #[must_use]
    pub fn is_told(&self) -> bool {
        match self.source {
            ColumnSource::Signal(Signal::Body(..), _) | ColumnSource::Force(_) => false,
            ColumnSource::Signal(_, order) => order == Order::Position,
            ColumnSource::Derived(_) => true,
        }
    }

    /// Returns whether it shows a force.
    #[must_use]
    pub fn is_force(&self) -> bool {
        matches!(self.source, ColumnSource::Force(_))
    }
}

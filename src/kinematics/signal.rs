//! Values and rates of signals.

use super::path::Rates;
use super::solver::Solver;
use crate::mechanism::{Jet, Signal};

impl Signal {
    /// Returns value, velocity and acceleration at the solver's pose. Velocity and acceleration
    /// have a meaning only if `rates` and `driver_rates` belong to that pose. Allocates nothing.
    #[inline]
    #[must_use]
    pub fn jet(self, solver: &Solver, rates: &Rates, driver_rates: &[Jet]) -> Jet {
        match self {
            Self::Body(body, component) => {
                let column = 3 * body.index() + component;
                let derivatives = [rates.velocity()[column], rates.acceleration()[column]];
                Jet::new(solver.pose().q[column], derivatives)
            }
            Self::Marker(marker, component) => solver.marker(marker, rates)[component],
            Self::Measure(measure) => solver.measure(measure, rates),
            Self::Motion(driver) => Jet {
                value: solver.pose().drivers[driver.index()],
                ..driver_rates[driver.index()]
            },
        }
    }
}

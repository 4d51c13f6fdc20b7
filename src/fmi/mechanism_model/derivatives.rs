//! Directional derivatives of outputs and calculated parameters.

use super::variables::Order;
use super::{MechanismModel, Quantity, Signal, failed};
use crate::fmi::error::Failure;
use crate::fmi::log::Logger;
use crate::fmi::state::Phase;
use crate::kinematics::{Direction, Sensitivity};
use crate::mechanism::{DriverId, Jet};

impl MechanismModel {
    /// Returns the derivatives of outputs and calculated parameters along a direction.
    ///
    /// Value, velocity and acceleration of a driver count as independent of each other: an
    /// estimated rate is not differentiated. Where the rates have extrapolated the value in the
    /// last step, it depends on them.
    ///
    /// # Errors
    ///
    /// The pose is singular, or does not exist for the values set.
    pub(super) fn derivatives_along(
        &mut self,
        unknowns: &[Quantity],
        knowns: &[(Quantity, f64)],
        phase: Phase,
        log: &Logger,
    ) -> Result<Vec<f64>, Failure> {
        if unknowns.is_empty() {
            return Ok(Vec::new());
        }
        self.refresh_rates(phase, log)?;
        let mut direction = Direction {
            drivers: vec![Jet::constant(0.0); self.inputs.len()],
            parameters: vec![0.0; self.settings.parameters.len()],
            time: 0.0,
        };
        for &(known, change) in knowns {
            match known {
                Quantity::Input(driver, order) => {
                    let h = self.extrapolated_over(driver);
                    let driver = &mut direction.drivers[driver.index()];
                    match order {
                        Order::Position => driver.value += change,
                        Order::Velocity => {
                            driver.value += h * change;
                            driver.derivatives[0] += change;
                        }
                        Order::Acceleration => {
                            driver.value += 0.5 * h * h * change;
                            driver.derivatives[0] += h * change;
                            driver.derivatives[1] += change;
                        }
                    }
                }
                Quantity::Parameter(parameter) => {
                    direction.parameters[parameter.index()] += change;
                }
                Quantity::Time => direction.time += change,
                _ => unreachable!("knowns are inputs, parameters and time"),
            }
        }
        let sensitivity = self
            .solver
            .sensitivity(&self.rates, &self.driver_rates, &direction)
            .map_err(failed)?;
        let change = |&unknown: &Quantity| match unknown {
            Quantity::Output(signal, order) => order.of(signal.change(&sensitivity)),
            Quantity::Parameter(parameter) => sensitivity.parameter(parameter),
            _ => unreachable!("unknowns are outputs and parameters"),
        };
        Ok(unknowns.iter().map(change).collect())
    }

    /// Returns the time \[s\] over which the rates have extrapolated a driver's value.
    fn extrapolated_over(&self, driver: DriverId) -> f64 {
        if self.at_committed {
            self.inputs[driver.index()].extrapolated_over()
        } else {
            0.0
        }
    }
}

impl Signal {
    /// Returns the changes of value, velocity and acceleration.
    fn change(self, sensitivity: &Sensitivity<'_>) -> Jet {
        match self {
            Self::Body(body, component) => sensitivity.coordinate(3 * body.index() + component),
            Self::Marker(marker, component) => sensitivity.marker(marker)[component],
            Self::Measure(measure) => sensitivity.measure(measure),
            Self::Motion(driver) => sensitivity.driver(driver),
        }
    }
}

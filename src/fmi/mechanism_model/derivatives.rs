//! Directional derivatives of outputs and calculated parameters.

use super::{MechanismModel, Quantity, without_value};
use crate::fmi::error::Failure;
use crate::fmi::log::Logger;
use crate::fmi::state::Phase;
use crate::kinematics::constraint::of_coordinate;
use crate::kinematics::{Direction, OutputSource, Solution};
use crate::mechanism::{DriverId, Order, ParameterId, Signal};

impl MechanismModel {
    /// Returns the derivatives of outputs and calculated parameters along a direction.
    ///
    /// After a step they are those of the step: an estimated rate depends on the position, a
    /// position that the rates have extrapolated on these.
    ///
    /// # Errors
    ///
    /// The pose is singular, or does not exist for the values set; a derivative does not exist.
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
        self.refresh_pose(phase, log)?;
        self.refresh_rates()?;
        // Also after outputs at other points.
        self.solve_freedoms()?;
        let mut direction = Direction::zero(&self.mechanism);
        for &(known, change) in knowns {
            match known {
                Quantity::Input(driver, order) => {
                    let [position, velocity, acceleration] =
                        self.derivatives_by(driver, order, phase);
                    let driver = &mut direction.drivers[driver.index()];
                    driver.value += position * change;
                    driver.derivatives[0] += velocity * change;
                    driver.derivatives[1] += acceleration * change;
                }
                Quantity::ForceInput(place) => direction.loads[place] += change,
                Quantity::Parameter(parameter) => {
                    direction.parameters[parameter.index()] += change;
                }
                Quantity::Time => direction.time += change,
                // No value depends on it.
                Quantity::Budget => {}
                Quantity::Output(OutputSource::Signal(Signal::Motion(freedom), order))
                | Quantity::State(freedom, order) => {
                    let state = &mut direction.drivers[freedom.index()];
                    match order {
                        Order::Position => state.value += change,
                        _ => state.derivatives[0] += change,
                    }
                }
                _ => unreachable!("knowns are inputs, states, parameters and time"),
            }
        }
        self.follow_along(&mut direction, phase);
        self.accelerate_freedoms(&mut direction)?;
        let uses_forces = |unknown: &Quantity| match unknown {
            Quantity::Output(source) => source.uses_forces(&self.mechanism),
            _ => false,
        };
        let of_forces = if unknowns.iter().any(uses_forces) {
            self.set_loads();
            let changes = (self.motion.solution).force_changes(&mut self.motion.solver, &direction);
            changes.map_err(without_value)?
        } else {
            None
        };
        let Solution {
            rates,
            driver_rates,
            ..
        } = &self.motion.solution;
        let sensitivity = self
            .motion
            .solver
            .sensitivity(rates, driver_rates, &direction);
        let sensitivity = sensitivity.map_err(without_value)?;
        let forces = self.motion.solution.forces().zip(of_forces.as_ref());
        let parameter = |id: ParameterId| sensitivity.parameter_value(id);
        let change = |&unknown: &Quantity| match unknown {
            Quantity::Parameter(parameter) => Some(sensitivity.parameter(parameter))
                .filter(|change| change.is_finite())
                .ok_or_else(|| sensitivity.fault()),
            Quantity::Weight(body, place) => (self.mechanism.weight(body, &parameter))
                .map(|weight| weight.numbers()[place].first())
                .filter(|change| change.is_finite())
                .ok_or_else(|| sensitivity.fault()),
            Quantity::Output(source) => source.change(&self.mechanism, &sensitivity, forces),
            Quantity::State(freedom, order) => Ok(order.of(direction.drivers[freedom.index()])),
            Quantity::Clearance(stop) => {
                let relation = of_coordinate(&self.mechanism.stops[stop].coordinate);
                Ok(sensitivity.coordinate(&*relation).value)
            }
            _ => unreachable!("unknowns are outputs, states and parameters"),
        };
        let changes: Result<_, _> = unknowns.iter().map(change).collect();
        changes.map_err(without_value)
    }

    /// Completes a direction by the changes of the freedoms' accelerations: their efforts stay zero.
    fn accelerate_freedoms(&mut self, direction: &mut Direction) -> Result<(), Failure> {
        let Some((free, solver, solution)) = self.motion.parts() else {
            return Ok(());
        };
        let completed = free.complete(solver, &solution.rates, direction);
        completed.map_err(without_value)
    }

    /// Returns the derivatives of a driver's value, velocity and acceleration in force by one of its
    /// inputs.
    pub(super) fn derivatives_by(&self, driver: DriverId, order: Order, phase: Phase) -> [f64; 3] {
        let input = &self.course.inputs[driver.index()];
        let rates = self.rule().rates;
        if phase == Phase::Event {
            input.change_at_event(rates, self.course.time, order)
        } else if self.course.at_committed && input.has_stepped() {
            input.change_by_step(rates, self.course.monitors[driver.index()].sources, order)
        } else {
            input.change_by_value(rates, self.course.time, order)
        }
    }
}

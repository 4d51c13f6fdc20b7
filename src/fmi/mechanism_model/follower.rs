//! Drivers whose motions follow inputs of the file.
//!
//! In co-simulation they move as drivers that are inputs do: towards the value for the inputs that the host
//! sets, with rates by the parameters `rates` and `extrapolation`, and by input derivatives.

use std::sync::Arc;

use super::{Interface, MechanismModel};
use crate::fmi::state::Phase;
use crate::kinematics::{Direction, Error};
use crate::mechanism::{DriverId, Dual, Expression, Jet, Mechanism, Number, Order, ParameterId};

/// Returns a mechanism whose drivers that follow inputs are given, with their values at the start.
///
/// # Errors
///
/// [`Error::FollowsInput`] in model exchange.
pub(super) fn with_followers(
    mechanism: Arc<Mechanism>,
    interface: Interface,
) -> Result<Arc<Mechanism>, Error> {
    let mut followers = mechanism.drivers.iter();
    let Some(first) = followers.find(|driver| driver.follows.is_some()) else {
        return Ok(mechanism);
    };
    if interface == Interface::ModelExchange {
        let driver = first.name.clone();
        return Err(Error::FollowsInput { driver });
    }
    let mut given = Mechanism::clone(&mechanism);
    let parameters = mechanism.default_parameters();
    given.give_followers(|_| true, &parameters, mechanism.simulation.start);
    Ok(Arc::new(given))
}

impl MechanismModel {
    /// Returns whether drivers follow inputs.
    pub(super) fn has_followers(&self) -> bool {
        let mut drivers = self.mechanism.drivers.iter();
        drivers.any(|driver| driver.follows.is_some())
    }

    /// Sets the drivers that follow inputs to their values for these, as the host has set them at `time`.
    /// Allocates nothing.
    pub(super) fn set_followers(&mut self, time: f64) {
        for (index, driver) in self.mechanism.drivers.iter().enumerate() {
            let Some(follows) = &driver.follows else {
                continue;
            };
            let (parameters, loads) = (&self.course.parameters, &self.course.force_inputs);
            let parameter = |p: ParameterId| Jet::constant(parameters[p.index()]);
            // Inputs come first among the loads.
            let path = |input: usize| loads[input].path();
            let Some(jet) = driver.followed(&parameter, &path, Jet::variable(time)) else {
                continue;
            };
            let has_rates = follows.inputs().any(|input| loads[input].path().varies());
            let input = &mut self.course.inputs[index];
            input.set(Order::Position, jet.value);
            if has_rates {
                input.set_derivative(Order::Position, 1, jet.first());
                input.set_derivative(Order::Position, 2, jet.second());
            }
        }
    }

    /// Adds to a direction the changes of drivers that follow inputs, for those of parameters, time and inputs
    /// in it.
    pub(super) fn follow_along(&self, direction: &mut Direction, phase: Phase) {
        if !self.has_followers() {
            return;
        }
        let now = self.course.parameters.iter().zip(&direction.parameters);
        let mut parameters: Vec<Dual> = now.map(|(&is, &by)| Dual::new(is, [by])).collect();
        for id in &self.mechanism.derivation_order {
            let expression: &Expression = &self.mechanism.parameters[id.index()].expression;
            let value = |p: ParameterId| parameters[p.index()];
            parameters[id.index()] = expression.evaluate(&value, Dual::constant(0.0));
        }
        for (index, driver) in self.mechanism.drivers.iter().enumerate() {
            let parameter = |p: ParameterId| parameters[p.index()];
            let present = |input: usize| {
                let value = self.course.force_inputs[input].present();
                Dual::new(value, [direction.loads[input]])
            };
            let time = Dual::new(self.course.time, [direction.time]);
            let Some(followed) = driver.followed(&parameter, &present, time) else {
                continue;
            };
            let change = followed.first();
            let by = self.derivatives_by(DriverId(index), Order::Position, phase);
            let own = &mut direction.drivers[index];
            own.value += by[0] * change;
            own.derivatives[0] += by[1] * change;
            own.derivatives[1] += by[2] * change;
        }
    }
}

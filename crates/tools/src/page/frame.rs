//! The numbers of one picture, in one list that a script reads without copying.

use serde_json::{Value, json};

use super::session::Session;
use crate::drawing::ForcePlace;
use biela::kinematics::Rates;
use biela::mechanism::DriverId;

/// Number of values before the drivers: time, residual, reciprocal condition, whether rates exist.
const HEAD: usize = 4;
/// Number of values of the spring from the hand: x and y of its ends.
const SPRING: usize = 4;
/// Number of values of the traced point: place and velocity.
const TRACED: usize = 4;

impl Session {
    /// Returns the places in the list of numbers: `drivers` (value, velocity and acceleration
    /// each), `parameters`, `variables`, `joints` (point and force of each joint, in the picture
    /// and in newtons, y down), `spring` (in the picture, from the body to the hand; not numbers
    /// without one), `traced` (place \[m\] and velocity \[m/s\] of the traced point in ground axes, not
    /// numbers without one), then `attachments` (x, y and angle each), `lengths` and `points`
    /// (velocity and acceleration each) of the picture.
    #[must_use]
    pub fn layout(&self) -> Value {
        let mechanism = self.mechanism();
        let drivers = HEAD;
        let parameters = drivers + 3 * mechanism.drivers.len();
        let variables = parameters + mechanism.parameters.len();
        let joints = variables + self.variables();
        let spring = joints + 4 * self.reactions();
        let traced = spring + SPRING;
        let attachments = traced + TRACED;
        let [frames, lengths] = self.picture.parts();
        json!({
            "time": 0,
            "residual": 1,
            "rcond": 2,
            "has_rates": 3,
            "drivers": drivers,
            "parameters": parameters,
            "variables": variables,
            "joints": joints,
            "joint_count": self.reactions(),
            "spring": spring,
            "traced": traced,
            "attachments": attachments,
            "lengths": attachments + 3 * frames,
            "points": attachments + 3 * frames + lengths,
        })
    }

    /// Returns the number of joints whose reactions are known.
    fn reactions(&self) -> usize {
        match self.motion.solution.forces() {
            Some(_) => self.mechanism().outputs.joints.len(),
            None => 0,
        }
    }

    /// Writes the numbers of the present pose.
    pub fn write_frame(&mut self, out: &mut Vec<f64>) {
        out.clear();
        let rcond = self.motion.solver.rcond();
        let pose = self.motion.solver.pose();
        out.extend([pose.time, self.motion.solver.residual(), rcond]);
        out.push(f64::from(u8::from(self.has_rates)));
        for index in 0..pose.drivers.len() {
            let driver = self.driver(DriverId(index));
            out.extend([driver.value, driver.first(), driver.second()]);
        }
        out.extend_from_slice(&pose.parameters);
        out.extend((0..self.variables()).map(|index| self.variable(index)));
        if let Some(forces) = self.motion.solution.forces() {
            let none = Rates::new(pose.q.len());
            for &joint in &self.mechanism().outputs.joints {
                let at = self
                    .motion
                    .solver
                    .marker(self.mechanism().joints[joint].to, &none);
                out.extend(self.picture.place(at.map(|jet| jet.value)));
                let place = ForcePlace::reaction(self.mechanism(), &pose.parameters, joint);
                let force = place.value(forces, &pose.q);
                let known = |value: f64| if self.has_rates { value } else { f64::NAN };
                out.extend([known(force[0]), -known(force[1])]);
            }
        }
        let ends = self.spring.as_ref().map(|spring| {
            let held = self.point(spring.body, spring.grip);
            [held.into(), spring.hand].map(|end| self.picture.place(end))
        });
        out.extend(ends.unwrap_or([[f64::NAN; 2]; 2]).as_flattened());
        out.extend(self.traced().as_flattened());
        self.picture.add_places(&pose.q, out);
        let rates = &self.motion.solution.rates;
        let rates = [rates.velocity(), rates.acceleration()];
        let first = out.len();
        self.picture.add_rates(&pose.q, rates, out);
        if !self.has_rates {
            out[first..].fill(f64::NAN);
        }
    }
}

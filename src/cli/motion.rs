//! A mechanism that moves along the motions of its drivers.

use std::sync::Arc;

use super::conditions::Scenario;
use super::message::Message;
use super::signals::Signals;
use crate::drawing::ForcePlace;
use crate::kinematics::{
    Blocked, Curve, Direction, Error, ForceParts, ForceQuantity, Forces, KnownMotion, Output,
    OutputSource, Path, Rates, Solver,
};
use crate::mechanism::{DriverId, Jet};

/// A mechanism that moves from one time to the next.
pub(super) struct Motion {
    pub(super) solver: Solver,
    pub(super) rates: Rates,
    /// Value, velocity and acceleration of each driver.
    pub(super) driver_rates: Vec<Jet>,
    forces: Option<ActingForces>,
    /// Singular positions that are near or were passed, contacts that pull, drivers beyond their
    /// limits: not told yet.
    pub(super) notices: Vec<Message>,
    path: Path,
    signals: Signals,
    /// Whether a notice told of the singular position that is near.
    near_singular: bool,
    /// Whether each driver is beyond its limits.
    beyond: Vec<bool>,
}

/// Forces of a run; inputs of forces that no option sets are zero.
struct ActingForces {
    forces: Forces,
    inputs: Vec<f64>,
    /// Whether each contact pulls.
    lifted: Vec<bool>,
}

impl Motion {
    /// Moves from the file's pose, which `home_solver` has, to the scenario's start.
    pub(super) fn start(home_solver: Solver, scenario: Scenario) -> Result<Self, Error> {
        let solver = scenario.solver(home_solver)?;
        Self::from(solver, scenario.signals, scenario.start)
    }

    /// Starts from a solver's pose, at a time at which the drivers have its values.
    pub(super) fn from(solver: Solver, signals: Signals, time: f64) -> Result<Self, Error> {
        let start = solver.pose();
        let mut path = Path::new(solver.mechanism());
        start.set_path(&mut path);
        path.start = time;
        let mut motion = Self {
            rates: Rates::new(start.q.len()),
            driver_rates: start.drivers.iter().map(|u| Jet::constant(*u)).collect(),
            beyond: vec![false; start.drivers.len()],
            solver,
            notices: Vec::new(),
            forces: None,
            path,
            signals,
            near_singular: false,
        };
        motion.watch_limits();
        motion.solve_rates()?;
        Ok(motion)
    }

    /// Solves forces too, from now on.
    pub(super) fn with_forces(mut self) -> Result<Self, Error> {
        let forces = self.solver.forces();
        self.forces = Some(ActingForces {
            inputs: vec![0.0; forces.inputs()],
            lifted: vec![false; forces.contacts()],
            forces,
        });
        self.solve_forces()?;
        Ok(self)
    }

    /// Returns a force at the present time, not a number without [forces](Self::with_forces).
    pub(super) fn force(&self, quantity: ForceQuantity) -> f64 {
        let acting = self.forces.as_ref();
        acting.map_or(f64::NAN, |acting| acting.forces.value(quantity))
    }

    /// Returns the changes of outputs along a direction, those of forces only
    /// [with forces](Self::with_forces); inputs of forces stay.
    pub(super) fn changes(
        &mut self,
        outputs: &[Output],
        direction: &Direction,
    ) -> Result<Vec<f64>, Error> {
        let (solver, rates, driver_rates) = (&mut self.solver, &self.rates, &self.driver_rates);
        let of_forces = match &mut self.forces {
            None => None,
            Some(ActingForces { forces, inputs, .. }) => {
                let motion = KnownMotion {
                    rates,
                    driver_rates,
                    inputs,
                };
                let still = vec![0.0; inputs.len()];
                Some(solver.force_sensitivity(motion, direction, &still, forces)?)
            }
        };
        let mechanism = Arc::clone(solver.mechanism());
        let change = solver.sensitivity(rates, driver_rates, direction)?;
        let changes = outputs
            .iter()
            .map(|output| match (output.source, &of_forces) {
                (OutputSource::Force(quantity), Some(forces)) => forces.change(quantity),
                _ => output.change(&mechanism, &change),
            });
        Ok(changes.collect())
    }

    /// Returns the forces that a picture shows; none without [forces](Self::with_forces).
    pub(super) fn force_places(&mut self) -> Vec<ForcePlace> {
        if self.forces.is_none() {
            return Vec::new();
        }
        let indeterminate = self.solver.indeterminate();
        let parameters = &self.solver.pose().parameters;
        ForcePlace::all(self.solver.mechanism(), parameters, &indeterminate)
    }

    /// Returns components in ground axes \[N\] and torque \[N m\] of forces at the present time.
    pub(super) fn values(&self, places: &[ForcePlace]) -> Vec<[f64; 3]> {
        let Some(acting) = &self.forces else {
            return Vec::new();
        };
        let q = &self.solver.pose().q;
        let values = places.iter().map(|place| place.value(&acting.forces, q));
        values.collect()
    }

    /// Moves on to `time`, from one point of the signals to the next.
    ///
    /// # Errors
    ///
    /// Cause of the mechanism's stop, and its place.
    pub(super) fn advance(&mut self, time: f64) -> Result<(), String> {
        while self.solver.pose().time < time {
            let start = self.solver.pose().time;
            self.follow(self.signals.next_point(start).min(time))?;
            // A signal that jumps here moves its driver at once.
            if self.aim() {
                self.follow(self.solver.pose().time)?;
            }
        }
        let solved = self.solve_rates().and_then(|()| self.solve_forces());
        solved.map_err(|error| format!("at t = {time} s: {error}"))
    }

    fn solve_forces(&mut self) -> Result<(), Error> {
        let Some(acting) = &mut self.forces else {
            return Ok(());
        };
        let time = self.solver.pose().time;
        self.signals.write_forces(time, &mut acting.inputs);
        let motion = KnownMotion {
            rates: &self.rates,
            driver_rates: &self.driver_rates,
            inputs: &acting.inputs,
        };
        let forces = &mut acting.forces;
        self.solver.solve_forces(motion, ForceParts::ALL, forces)?;
        let lift_offs = self.solver.lift_offs(forces, &mut acting.lifted);
        let notices = lift_offs.map(|lift_off| Message::Warning(lift_off.to_string()));
        self.notices.extend(notices);
        Ok(())
    }

    /// Sets the curves of the drivers that follow signals, from the current time on. Returns
    /// whether a driver is off its signal.
    fn aim(&mut self) -> bool {
        let pose = self.solver.pose();
        let mut is_off = false;
        let curves = self.path.curves.iter_mut().zip(&pose.drivers);
        for (driver, (curve, value)) in curves.enumerate() {
            let Some(signal) = self.signals.line(DriverId(driver), pose.time) else {
                continue;
            };
            *curve = Curve::Input {
                position: signal.value,
                velocity: signal.first(),
                acceleration: 0.0,
                jump: value - signal.value,
            };
            // Far less than any mechanism moves by, far more than rounding.
            is_off |= (value - signal.value).abs() > 1e-12 * (1.0 + value.abs());
        }
        is_off
    }

    /// Follows the drivers' curves until `time`.
    fn follow(&mut self, time: f64) -> Result<(), String> {
        self.aim();
        self.path.start = self.solver.pose().time;
        self.path.duration = time - self.path.start;
        if let Err(blocked) = self.solver.track(&self.path) {
            return Err(self.describe(&blocked));
        }
        if let Some(approach) = self.solver.approach(&mut self.near_singular) {
            let notice = format!("t = {time} s: {approach}");
            self.notices.push(Message::Warning(notice));
        }
        for crossing in self.solver.crossed() {
            let passed = self.solver.describe_crossing(crossing);
            let notice = format!("t = {time} s: {passed}");
            self.notices.push(Message::Note(notice));
        }
        self.watch_limits();
        Ok(())
    }

    /// Notes drivers that go beyond their limits.
    fn watch_limits(&mut self) {
        let pose = self.solver.pose();
        let drivers = self.solver.mechanism().drivers.iter();
        for ((driver, value), beyond) in drivers.zip(&pose.drivers).zip(&mut self.beyond) {
            let excursion = driver.excursion(*value, pose.time, beyond);
            self.notices.extend(excursion.map(Message::Warning));
        }
    }

    /// Says what stops the mechanism, when, and at which values of the moving drivers.
    fn describe(&self, blocked: &Blocked) -> String {
        let mechanism = self.solver.mechanism();
        let pose = self.solver.pose();
        blocked.describe(mechanism, pose, Some(pose.time), |driver| {
            mechanism.drivers[driver.index()].motion().is_some() || self.signals.has(driver)
        })
    }

    fn solve_rates(&mut self) -> Result<(), Error> {
        let time = self.solver.pose().time;
        let drivers = self.solver.mechanism().drivers.iter().enumerate();
        for (rates, (index, driver)) in self.driver_rates.iter_mut().zip(drivers) {
            if driver.motion().is_some() {
                *rates = self.solver.motion(DriverId(index), time);
            } else if let Some(signal) = self.signals.at(DriverId(index), time) {
                *rates = signal;
            }
        }
        let driver_rates = &self.driver_rates;
        self.solver
            .solve_rates(|driver| driver_rates[driver.index()], &mut self.rates)
    }
}

//! Free motion: time goes on, the hand pulls by a spring, and what the reader sets lets go anew.

use super::outcome::{Obstacle, Outcome};
use super::session::Session;
use super::spring::{Spring, mobility};
use biela::dynamics::{Error, Given, GivenByPath, Motion, Notice, Stop};
use biela::kinematics::{Budget, DriverPath, Path, Pose};
use biela::mechanism::{BodyId, DriverId, Jet, Signal, show_time};

impl Session {
    /// Returns value, velocity and acceleration of a driver, in the file's own coordinates.
    pub(super) fn driver(&self, driver: DriverId) -> Jet {
        let Motion {
            solver, solution, ..
        } = &self.motion;
        solver.signal(
            Signal::Motion(driver),
            &solution.rates,
            &solution.driver_rates,
        )
    }

    /// Returns the pose in the file's own coordinates.
    pub(super) fn own_pose(&self) -> Pose {
        let mut pose = self.pose().clone();
        for (index, value) in pose.drivers.iter_mut().enumerate() {
            *value = self.driver(DriverId(index)).value;
        }
        pose
    }

    /// Hangs the point `grip` of a body, in its frame, on a spring from the hand at a global point, or
    /// moves the hand: freedoms follow while time goes on.
    pub fn hold(&mut self, body: BodyId, grip: [f64; 2], hand: [f64; 2]) -> Outcome {
        if !grip.iter().chain(&hand).all(|x| x.is_finite()) {
            return Outcome::Refused(Obstacle::new("no freedom moves this body"));
        }
        let is_same = |spring: &Spring| {
            spring.body == body && spring.grip.map(f64::to_bits) == grip.map(f64::to_bits)
        };
        if !self.spring.as_ref().is_some_and(is_same) {
            self.let_go();
            if let Err(message) = self.hang(body, grip, hand) {
                return Outcome::Refused(Obstacle::new(message));
            }
        }
        if let Some(spring) = &mut self.spring {
            spring.hand = hand;
            spring.load(&mut self.motion.solution.loads);
        }
        self.fly_on();
        self.refresh();
        Outcome::Reached
    }

    /// Takes the spring away, if a body hangs on one.
    pub fn let_go(&mut self) {
        if let Some(spring) = self.spring.take() {
            let mut other = spring.other;
            self.carry_on(&mut other);
            self.refresh();
        }
    }

    fn hang(&mut self, body: BodyId, grip: [f64; 2], hand: [f64; 2]) -> Result<(), String> {
        let point = self.point(body, grip);
        let [x, y, _] = self.place_of(body);
        let arm = [point.x - x, point.y - y];
        if self.motion.free().is_none() {
            return Err("nothing moves by forces".to_owned());
        }
        let mobility = mobility(&mut self.motion, body, arm);
        let mobility = mobility.ok_or("no freedom moves this body")?;
        let held = (body, grip, hand);
        let mut spring = Spring::new(&self.motion.solver, &self.mechanism, mobility, held)?;
        self.carry_on(&mut spring.other);
        self.spring = Some(spring);
        self.refresh();
        Ok(())
    }

    /// Exchanges the mechanism for one with other forces, which goes on from here.
    fn carry_on(&mut self, other: &mut Motion) {
        self.motion.carry(other);
        std::mem::swap(&mut self.motion, other);
    }

    /// Moves on to a time; before the present one, from where the motion was let go.
    pub(super) fn fly_to(&mut self, time: f64) -> Outcome {
        let mut outcome = Outcome::Reached;
        if time < self.pose().time {
            self.let_go();
            if let Err(obstacle) = self.return_to_start() {
                return Outcome::Refused(obstacle);
            }
            let first = self.start.pose.time;
            if time < first {
                let message = format!("the motion was let go at t = {} s", show_time(first));
                outcome = Outcome::Stopped(Obstacle::new(message));
            }
        }
        if outcome == Outcome::Reached {
            outcome = self.fly(time);
        }
        self.refresh();
        outcome
    }

    /// Moves on to a time that is not before the present one, with the inputs as they are now and the
    /// budget of a step. Rates are not solved.
    pub(super) fn fly(&mut self, time: f64) -> Outcome {
        let flown = self.release().map_err(Stop::Free).and_then(|()| {
            self.set_path_on();
            let loads = self.motion.solution.loads.clone();
            let given = inputs(&self.path, &loads);
            self.motion.renew_budget();
            let flown = self.motion.advance(&self.path, &given, time);
            self.motion.solver.set_budget(Budget::UNLIMITED);
            self.motion.take_rates();
            flown
        });
        for notice in self.motion.happenings() {
            match notice {
                Notice::Overlap(overlap, _) => self.overlaps.push(overlap),
                Notice::Event(event, _) => self.events.iter_mut().for_each(|all| all.push(event)),
                _ => {}
            }
        }
        match flown {
            Ok(()) => Outcome::Reached,
            Err(stop) => Outcome::Stopped(Obstacle::new(stop.describe(&self.motion, |_| false))),
        }
    }

    /// Prepares the path on which drivers go on from the pose with their rates.
    fn set_path_on(&mut self) {
        self.path_here();
        let rates = &self.motion.solution.driver_rates;
        for (driver_path, rates) in self.path.driver_paths.iter_mut().zip(rates) {
            if let DriverPath::Input {
                velocity,
                acceleration,
                ..
            } = driver_path
            {
                [*velocity, *acceleration] = rates.derivatives;
            }
        }
    }

    /// Takes over inputs of forces that have changed. Rates are not solved.
    pub(super) fn fly_on(&mut self) {
        if self.motion.free().is_some() {
            // A motion that cannot go on says so when time does.
            self.fly(self.pose().time);
            self.start = self.motion.state();
        }
    }

    /// Lets freedoms move by the forces, from the pose on with the rates in force.
    pub(super) fn release(&mut self) -> Result<(), Error> {
        if self.motion.free().is_none() {
            return Ok(());
        }
        let begins = !self.motion.is_released();
        if begins {
            self.set_path_on();
            let loads = self.motion.solution.loads.clone();
            let rates = self.motion.solution.driver_rates.clone();
            let velocity = |freedom: DriverId| rates[freedom.index()].first();
            let given = inputs(&self.path, &loads);
            self.motion.release_with(&given, velocity)?;
        }
        self.motion.take_rates();
        if begins {
            self.start = self.motion.state();
        }
        Ok(())
    }

    /// Prepares a move by hand: without a spring, in the file's own coordinates.
    pub(super) fn take(&mut self) {
        self.let_go();
        if self.motion.free().is_none() {
            return;
        }
        let mut pose = self.own_pose();
        let rates = (0..pose.drivers.len()).map(|index| self.driver(DriverId(index)));
        let rates: Vec<Jet> = rates.collect();
        if self.motion.take_own() {
            pose.crossings.clear();
            self.motion.solver.restore(&pose);
            self.motion.solution.driver_rates = rates;
        }
    }

    /// Lets go after a move by hand: of freedoms that `rest`, or with the velocities that they have.
    pub(super) fn release_moved(&mut self, rest: bool) {
        self.motion.hold();
        if let Some((free, _, solution)) = self.motion.parts().filter(|_| rest) {
            for freedom in free.freedoms() {
                solution.driver_rates[freedom.index()] = Jet::constant(0.0);
            }
        }
        self.refresh();
    }

    /// Does what moves the mechanism, and returns to where it was. Others than freedoms return by
    /// themselves.
    pub(super) fn apart<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> T {
        if self.motion.free().is_none() {
            return act(self);
        }
        let (here, start) = (self.motion.state(), self.start.clone());
        let done = act(self);
        self.motion.resume(&here);
        self.start = start;
        self.refresh();
        done
    }

    /// Does what moves the mechanism [by hand](Self::take), and returns to where it was.
    pub(super) fn apart_by_hand<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> T {
        self.let_go();
        self.apart(|session| {
            session.take();
            act(session)
        })
    }
}

/// Returns the inputs on a path, with forces that stay.
fn inputs<'a>(path: &'a Path, loads: &'a [f64]) -> impl Given + 'a {
    GivenByPath {
        path,
        load: |input: usize, _| loads[input],
    }
}

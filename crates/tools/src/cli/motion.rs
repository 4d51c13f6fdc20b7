//! A mechanism that moves along the motions and signals of its drivers.

use super::given::conditions::Scenario;
use super::given::input::warn_of_misfits;
use super::given::signals::Signals;
use super::told::message::Message;
use biela::dynamics::{self, Event, Given, Motion, Notice};
use biela::kinematics::{DriverPath, Error, Path, Solver};
use biela::mechanism::{DriverId, Jet, show_time};

/// A mechanism in motion, the signals that move it, and what is told of it.
pub(super) struct SignalledMotion {
    pub(super) motion: Motion,
    /// Notices that were not told yet.
    pub(super) notices: Vec<Message>,
    /// All events of the free motion.
    pub(super) events: Vec<Event>,
    path: Path,
    signals: Signals,
}

impl SignalledMotion {
    /// Moves from the file's pose, which `home_solver` has, to the scenario's start.
    pub(super) fn start(home_solver: Solver, scenario: Scenario) -> Result<Self, Error> {
        let solver = scenario.solver(home_solver)?;
        warn_of_misfits(&solver);
        Self::from(solver, scenario.signals, scenario.start)
    }

    /// Starts from a solver's pose, at a time at which the drivers have its values.
    pub(super) fn from(solver: Solver, signals: Signals, time: f64) -> Result<Self, Error> {
        let mut path = Path::new(solver.mechanism());
        solver.pose().set_path(&mut path);
        path.start = time;
        let mut moving = Self {
            motion: Motion::new(solver),
            notices: Vec::new(),
            events: Vec::new(),
            path,
            signals,
        };
        moving.solve()?;
        Ok(moving)
    }

    /// Lets freedoms, if there are some, move by the forces; they would be held otherwise.
    pub(super) fn with_freedoms(mut self) -> Result<Self, dynamics::Error> {
        release(&mut self.motion, &self.signals)?;
        if self.motion.free().is_some() {
            self.solve()?;
        }
        Ok(self)
    }

    /// Describes the work and the error of the integration of freedoms, if there are some.
    pub(super) fn describe_integration(&self) -> Option<String> {
        let free = self.motion.free()?;
        let steps = free.statistics().accepted;
        let error = free.energy_error();
        Some(format!(
            "free motion: {steps} steps, error of the energy {error:.1e} J"
        ))
    }

    /// Solves forces too, from now on, and reactions where they are wanted.
    pub(super) fn with_forces(mut self, reactions: bool) -> Result<Self, Error> {
        self.motion.seek_forces();
        if !reactions {
            self.motion.solution.leave_out_reactions();
        }
        self.solve()?;
        Ok(self)
    }

    /// Watches contacts, which tell where they pull though nobody asks for forces.
    pub(super) fn with_contacts_watched(mut self) -> Result<Self, Error> {
        if self.motion.watch_contacts() {
            self.solve()?;
        }
        Ok(self)
    }

    /// Moves on to `time`, from one point of the signals to the next, with the budget of a step.
    ///
    /// # Errors
    ///
    /// Cause of the mechanism's stop, and its place.
    pub(super) fn advance(&mut self, time: f64) -> Result<(), String> {
        self.motion.renew_budget();
        while self.motion.pose().time < time {
            let start = self.motion.pose().time;
            self.go(self.signals.next_point(start).min(time))?;
            // A signal that jumps here moves its driver at once.
            if self.motion.free().is_none() && self.aim(self.motion.pose().time) {
                self.go(self.motion.pose().time)?;
            }
        }
        self.solve()
            .map_err(|error| format!("at t = {} s: {error}", show_time(time)))
    }

    /// Moves on to a time that is not beyond the next point of the signals.
    fn go(&mut self, until: f64) -> Result<(), String> {
        self.aim(until);
        let pose = self.motion.pose();
        self.path.start = pose.time;
        self.path.duration = until - pose.time;
        let held = pose.drivers.clone();
        let part = self.signals.part(pose.time, &held);
        let advanced = self.motion.advance(&self.path, &part, until);
        self.note();
        advanced.map_err(|stop| stop.describe(&self.motion, |driver| self.signals.has(driver)))
    }

    /// Solves rates and forces at the present time.
    fn solve(&mut self) -> Result<(), Error> {
        let Self {
            motion, signals, ..
        } = self;
        let time = motion.pose().time;
        let rates = motion.solution.driver_rates.iter_mut().enumerate();
        for (driver, rates) in rates {
            if let Some(signal) = signals.at(DriverId(driver), time) {
                *rates = signal;
            }
        }
        motion.take_rates();
        signals.write_loads(time, &mut motion.solution.loads);
        motion.solve()?;
        self.note();
        Ok(())
    }

    /// Notes what is worth knowing.
    fn note(&mut self) {
        let Self {
            motion,
            events,
            notices,
            ..
        } = self;
        motion.tell_notices(|notice| {
            if let Notice::Event(event, _) = &notice {
                events.push(*event);
            }
            notices.push(notice.into());
        });
    }

    /// Sets the curves of the drivers that follow signals, from the current time on up to another. Returns
    /// whether a driver is off its signal.
    fn aim(&mut self, until: f64) -> bool {
        let pose = self.motion.pose();
        let mut is_off = false;
        let h = until - pose.time;
        let part = self.signals.part(pose.time, &pose.drivers);
        let driver_paths = self.path.driver_paths.iter_mut().zip(&pose.drivers);
        for (driver, (driver_path, value)) in driver_paths.enumerate() {
            let Some(signal) = self.signals.line(DriverId(driver), pose.time) else {
                continue;
            };
            *driver_path = DriverPath::Input {
                position: signal.value,
                velocity: signal.first(),
                acceleration: 0.0,
                jump: value - signal.value,
            };
            if h > 0.0 && self.signals.moves_by_inputs(DriverId(driver)) {
                // Exact at both ends, and between them where it follows lines by a polynomial.
                let end = part.driver(DriverId(driver), until);
                let by_part =
                    |value: f64, at: Jet| Jet::new(value, [h * at.first(), h * h * at.second()]);
                *driver_path =
                    DriverPath::through(by_part(*value, signal), by_part(end.value, end));
            }
            // Far less than any mechanism moves by, far more than rounding.
            is_off |= (value - signal.value).abs() > 1e-12 * (1.0 + value.abs());
        }
        is_off
    }
}

/// Lets the freedoms of a mechanism, if it has some, move by the forces from its pose on.
pub(super) fn release(motion: &mut Motion, signals: &Signals) -> Result<(), dynamics::Error> {
    motion.prepare_freedoms(Vec::new())?;
    let (time, held) = (motion.pose().time, motion.pose().drivers.clone());
    motion.release(&signals.part(time, &held))
}

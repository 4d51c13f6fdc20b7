//! A mechanism that moves along the motions of its drivers.

use super::conditions::Scenario;
use super::free::release;
use super::message::Message;
use super::signals::Signals;
use crate::dynamics::{self, FreeMotion};
use crate::kinematics::{
    Blocked, Budget, Curve, Error, ForceParts, Output, Path, Solution, Solver,
};
use crate::mechanism::{DriverId, show_time};

/// A mechanism that moves from one time to the next.
pub(super) struct Motion {
    pub(super) solver: Solver,
    pub(super) solution: Solution,
    /// Singular positions that are near or were passed, contacts that pull, drivers beyond their
    /// limits, ropes off their pulleys, parts that overlapped: not told yet.
    pub(super) notices: Vec<Message>,
    /// Times of all events of the free motion \[s\].
    pub(super) events: Vec<f64>,
    path: Path,
    signals: Signals,
    free: Option<FreeMotion>,
    /// Whether forces are solved for the sake of contacts that pull alone.
    watches_contacts: bool,
    /// Whether a notice told of the singular position that is near.
    near_singular: bool,
    /// Whether each driver is beyond its limits.
    beyond: Vec<bool>,
    /// Whether a rope has left each pulley.
    off_pulleys: Vec<bool>,
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
            solution: Solution::new(&solver),
            beyond: vec![false; start.drivers.len()],
            off_pulleys: vec![false; solver.mechanism().pulleys()],
            solver,
            notices: Vec::new(),
            events: Vec::new(),
            path,
            signals,
            free: None,
            watches_contacts: false,
            near_singular: false,
        };
        // Those at the start are told with the mechanism.
        motion.solver.off_pulleys(&mut motion.off_pulleys).count();
        motion.watch_limits();
        motion.solve()?;
        Ok(motion)
    }

    /// Lets freedoms, if there are some, move by the forces; they would be held otherwise.
    pub(super) fn with_freedoms(mut self) -> Result<Self, dynamics::Error> {
        self.free = release(&mut self.solver, &self.signals)?;
        if self.free.is_some() {
            self.tell_overlaps();
            self.note_events();
            self.solve()?;
        }
        Ok(self)
    }

    /// Notes the events of the free motion.
    fn note_events(&mut self) {
        let mechanism = self.solver.mechanism();
        for event in self.free.iter_mut().flat_map(FreeMotion::events) {
            self.events.push(event.time);
            self.notices.push(Message::Note(event.describe(mechanism)));
        }
    }

    /// Describes the work and the error of the integration of freedoms, if there are some.
    pub(super) fn describe_integration(&self) -> Option<String> {
        let free = self.free.as_ref()?;
        let steps = free.statistics().accepted;
        let error = free.energy_error();
        Some(format!(
            "free motion: {steps} steps, error of the energy {error:.1e} J"
        ))
    }

    /// Solves forces too, from now on, and reactions where they are wanted.
    pub(super) fn with_forces(mut self, reactions: bool) -> Result<Self, Error> {
        self.solution.seek_forces(&self.solver);
        if !reactions {
            self.solution.leave_out_reactions();
        }
        self.solve()?;
        Ok(self)
    }

    /// Watches contacts, which tell where they pull though nobody asks for forces.
    pub(super) fn with_contacts_watched(mut self) -> Result<Self, Error> {
        let has_dynamics = self.solver.mechanism().has_dynamics();
        if has_dynamics && self.solver.forces().contacts() > 0 {
            self.solution.seek_forces(&self.solver);
            self.watches_contacts = true;
            self.solve()?;
        }
        Ok(self)
    }

    /// Returns the current value of an output \[SI\], not a number for forces unless the motion is
    /// [with them](Self::with_forces).
    pub(super) fn value(&self, output: &Output) -> f64 {
        self.solution.value(&self.solver, output)
    }

    /// Moves on to `time`, from one point of the signals to the next, with the budget of a step.
    ///
    /// # Errors
    ///
    /// Cause of the mechanism's stop, and its place.
    pub(super) fn advance(&mut self, time: f64) -> Result<(), String> {
        let budget = Budget::usual(self.solver.mechanism());
        self.solver.set_budget(budget);
        if self.free.is_some() {
            return self.advance_free(time);
        }
        while self.solver.pose().time < time {
            let start = self.solver.pose().time;
            self.follow(self.signals.next_point(start).min(time))?;
            // A signal that jumps here moves its driver at once.
            if self.aim() {
                self.follow(self.solver.pose().time)?;
            }
        }
        self.solve()
            .map_err(|error| format!("at t = {} s: {error}", show_time(time)))
    }

    /// Moves a mechanism with freedoms on to `time`, from one point of the signals to the next.
    fn advance_free(&mut self, time: f64) -> Result<(), String> {
        while self.solver.pose().time < time {
            let Self {
                solver,
                solution,
                signals,
                free: Some(free),
                ..
            } = self
            else {
                break;
            };
            let start = solver.pose().time;
            let held = solver.pose().drivers.clone();
            let parameters = solver.pose().parameters.clone();
            let part = signals.part(start, &held);
            let moved = free.jump(solver, &part, &parameters).and_then(|()| {
                let until = signals.next_point(start).min(time);
                free.advance(solver, solution, &part, until)
            });
            self.note_events();
            let moved = moved.map_err(|stop| stop.to_string());
            self.tell_overlaps();
            moved?;
            self.tell_passed(time);
        }
        self.solve()
            .map_err(|error| format!("at t = {} s: {error}", show_time(time)))
    }

    /// Solves rates and forces at the present time.
    fn solve(&mut self) -> Result<(), Error> {
        let time = self.solver.pose().time;
        self.solution.follow_motions(&self.solver);
        for (driver, rates) in self.solution.driver_rates.iter_mut().enumerate() {
            if let Some(signal) = self.signals.at(DriverId(driver), time) {
                *rates = signal;
            }
        }
        if let Some(free) = &self.free {
            free.tell(&mut self.solution);
        }
        if self.solution.forces().is_some() {
            self.signals.write_forces(time, &mut self.solution.loads);
        }
        if self.watches_contacts {
            self.solution.solve_rates(&mut self.solver)?;
            let solved = self
                .solution
                .solve_forces(&mut self.solver, ForceParts::REACTIONS);
            if solved.is_err() {
                return Ok(());
            }
        } else {
            self.solution.solve(&mut self.solver)?;
        }
        let lift_offs = self.solution.lift_offs(&self.solver);
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
        self.tell_passed(time);
        Ok(())
    }

    /// Notes singular positions that are near or were passed, and drivers beyond their limits.
    fn tell_passed(&mut self, time: f64) {
        if let Some(approach) = self.solver.approach(&mut self.near_singular) {
            let notice = format!("t = {} s: {approach}", show_time(time));
            self.notices.push(Message::Warning(notice));
        }
        for crossing in self.solver.crossed() {
            let passed = self.solver.describe_crossing(crossing);
            let notice = format!("t = {} s: {passed}", show_time(time));
            self.notices.push(Message::Note(notice));
        }
        self.watch_limits();
    }

    /// Notes parts that overlapped at the start or where inputs jumped.
    fn tell_overlaps(&mut self) {
        let mechanism = self.solver.mechanism();
        let overlaps = self.free.iter_mut().flat_map(FreeMotion::overlaps);
        let overlaps = overlaps.map(|overlap| Message::Warning(overlap.describe(mechanism)));
        self.notices.extend(overlaps);
    }

    /// Notes drivers that go beyond their limits, and ropes that leave their pulleys.
    fn watch_limits(&mut self) {
        let pose = self.solver.pose();
        let drivers = self.solver.mechanism().drivers.iter();
        for ((driver, value), beyond) in drivers.zip(&pose.drivers).zip(&mut self.beyond) {
            let excursion = driver.excursion(*value, pose.time, beyond);
            self.notices.extend(excursion.map(Message::Warning));
        }
        let left = self.solver.off_pulleys(&mut self.off_pulleys);
        let left = left.map(|left| Message::Warning(left.to_string()));
        self.notices.extend(left);
    }

    /// Says what stops the mechanism, when, and at which values of the moving drivers.
    fn describe(&self, blocked: &Blocked) -> String {
        let mechanism = self.solver.mechanism();
        let pose = self.solver.pose();
        blocked.describe(mechanism, pose, Some(pose.time), |driver| {
            mechanism.drivers[driver.index()].motion().is_some() || self.signals.has(driver)
        })
    }
}

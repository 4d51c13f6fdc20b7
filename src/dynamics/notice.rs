//! Notices: sentences about a motion, each found and written once.

use std::fmt;

use super::event::Event;
use super::moving::{Free, Motion, Way};
use super::overlap::Overlap;
use crate::kinematics::{Approach, Crossing, LiftOff, OffPulley, Solution, Solver};
use crate::mechanism::{
    BeyondPoints, Excursion, Mechanism, ParameterId, PrescribedMotion, Variable, show_time, shown,
};

/// Something worth knowing of a motion, told once: its text is the sentence that all hosts tell.
#[derive(Clone, Debug)]
pub enum Notice<'a> {
    /// Parts overlapped at the start or where inputs jumped.
    Overlap(Overlap, &'a Mechanism),
    /// An event of the free motion.
    Event(Event, &'a Mechanism),
    /// A singular position is near; with the time \[s\].
    Approach(Approach, f64),
    /// A change point was passed before a time \[s\].
    Crossing(&'a Crossing, &'a Solver, f64),
    /// A driver or an input is beyond a limit.
    Excursion(Excursion<'a>),
    /// A rope leaves a pulley.
    OffPulley(OffPulley<'a>),
    /// A contact begins to pull.
    LiftOff(LiftOff<'a>),
    /// A function is called beyond its points, at a time \[s\].
    Beyond(BeyondPoints, &'a Mechanism, f64),
}

impl fmt::Display for Notice<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = |time: &f64| format!("t = {} s", show_time(*time));
        match self {
            Self::Overlap(overlap, mechanism) => out.write_str(&overlap.describe(mechanism)),
            Self::Event(event, mechanism) => out.write_str(&event.describe(mechanism)),
            Self::Approach(approach, time) => write!(out, "{}: {approach}", at(time)),
            Self::Crossing(crossing, solver, time) => {
                write!(out, "{}: {}", at(time), solver.describe_crossing(crossing))
            }
            Self::Excursion(excursion) => excursion.fmt(out),
            Self::OffPulley(left) => left.fmt(out),
            Self::LiftOff(lift_off) => lift_off.fmt(out),
            Self::Beyond(beyond, mechanism, time) => {
                let name = &mechanism.functions.list()[beyond.function].name;
                let [start, end] = beyond.ends.map(shown);
                write!(
                    out,
                    "{}: function `{name}` is called at {}, beyond its points from {start} to {end}: its \
                     `ends` give the value",
                    at(time),
                    shown(beyond.argument)
                )
            }
        }
    }
}

impl Motion {
    /// Tells what is worth knowing and was not told yet: overlaps, events, then what holds at the pose.
    /// The host asks after each [advance](Self::advance) and after each [solution](Self::solve).
    pub fn tell_notices<'a>(&'a mut self, mut tell: impl FnMut(Notice<'a>)) {
        self.find_beyond();
        let (has_passed, goes_on) = (self.way == Way::Passed, self.way != Way::Stopped);
        if has_passed {
            self.way = Way::Told;
        }
        let Self {
            solver,
            solution,
            told,
            free,
            beyond,
            knows_contacts,
            ..
        } = self;
        let approach = has_passed.then(|| solver.approach(&mut told.near_singular));
        let solver = &*solver;
        let (mechanism, pose) = (&**solver.mechanism(), solver.pose());
        happenings(free.as_mut(), mechanism).for_each(&mut tell);
        if let Some(approach) = approach.flatten() {
            tell(Notice::Approach(approach, pose.time));
        }
        if has_passed {
            crossings(solver).for_each(&mut tell);
        }
        if goes_on {
            let values = mechanism.drivers.iter().zip(&pose.drivers);
            for ((driver, value), beyond) in values.zip(&mut told.beyond) {
                let excursion = driver.excursion(*value, pose.time, beyond);
                excursion.map(Notice::Excursion).map(&mut tell);
            }
            let (parameters, loads) = (&pose.parameters, &solution.loads);
            let inputs = mechanism.inputs.iter().zip(&mut told.inputs_beyond);
            for (index, (input, beyond)) in inputs.enumerate() {
                let value = mechanism.input_value(index, parameters, loads, pose.time);
                let excursion = input.excursion(value, pose.time, beyond);
                excursion.map(Notice::Excursion).map(&mut tell);
            }
            let left = solver.off_pulleys(&mut told.off_pulleys);
            left.map(Notice::OffPulley).for_each(&mut tell);
        }
        if let Some(forces) = solution.forces().filter(|_| *knows_contacts) {
            let lift_offs = solver.lift_offs(forces, &mut told.lifted);
            lift_offs.map(Notice::LiftOff).for_each(&mut tell);
        }
        let found = beyond.iter_mut().zip(&mut told.beyond_points);
        for (found, is_told) in found {
            if let Some((time, found)) = found.take().filter(|_| !*is_told) {
                *is_told = true;
                tell(Notice::Beyond(found, mechanism, time));
            }
        }
    }

    /// Finds functions that forces, prescribed motions and computed measures have called beyond their
    /// points.
    fn find_beyond(&mut self) {
        let (mechanism, pose) = (&**self.solver.mechanism(), self.solver.pose());
        if mechanism.functions.list().is_empty() || self.way == Way::Stopped {
            return;
        }
        if let Some(free) = self.free.as_mut().filter(|free| free.is_released) {
            free.motion.take_beyond(&mut self.beyond);
        }
        let all = &mut self.beyond;
        let mut meet = |found: BeyondPoints| {
            all[found.function].get_or_insert((pose.time, found));
        };
        let parameter = |id: ParameterId| pose.parameters[id.index()];
        for driver in &mechanism.drivers {
            if let Some(PrescribedMotion::Expression(motion)) = driver.motion() {
                motion.visit_beyond(&parameter, &|_| pose.time, &mut meet);
            }
        }
        if !self.knows_contacts {
            return;
        }
        let Solution {
            rates,
            driver_rates,
            loads,
            ..
        } = &self.solution;
        if let Some(forces) = self.solution.forces() {
            forces.visit_beyond(pose, loads, &mut meet);
        }
        let followers = (mechanism.drivers.iter()).filter(|driver| driver.is_moved_by_inputs());
        for follows in followers.filter_map(|driver| driver.follows.as_ref()) {
            let variable = |variable| match variable {
                Variable::Input(index) => {
                    mechanism.input_value(index, &pose.parameters, loads, pose.time)
                }
                _ => pose.time,
            };
            follows.visit_beyond(&parameter, &variable, &mut meet);
        }
        for measure in &mechanism.derived {
            let variable = |variable| match variable {
                Variable::Signal(signal, order) => {
                    order.of(self.solver.signal(signal, rates, driver_rates))
                }
                Variable::Force(quantity) => self.solution.force(quantity),
                _ => f64::NAN,
            };
            measure.value.visit_beyond(&parameter, &variable, &mut meet);
        }
    }

    /// Returns the overlaps and events among the [notices](Self::tell_notices).
    pub fn happenings(&mut self) -> impl Iterator<Item = Notice<'_>> {
        happenings(self.free.as_mut(), self.solver.mechanism())
    }

    /// Returns the change points on the path followed last, whether they were told or not.
    pub fn crossings(&self) -> impl Iterator<Item = Notice<'_>> {
        crossings(&self.solver)
    }
}

/// Returns the overlaps and events of which nobody has been told.
fn happenings<'a>(
    free: Option<&'a mut Free>,
    mechanism: &'a Mechanism,
) -> impl Iterator<Item = Notice<'a>> {
    free.into_iter().flat_map(|free| {
        let (overlaps, events) = free.motion.news();
        let overlaps = overlaps.map(|overlap| Notice::Overlap(overlap, mechanism));
        overlaps.chain(events.map(|event| Notice::Event(event, mechanism)))
    })
}

/// Returns the change points on the path that a solver has followed last.
fn crossings(solver: &Solver) -> impl Iterator<Item = Notice<'_>> {
    let time = solver.pose().time;
    let crossed = solver.crossed().iter();
    crossed.map(move |crossing| Notice::Crossing(crossing, solver, time))
}

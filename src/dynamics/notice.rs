//! Notices: sentences about a motion, each found and written once.

use std::fmt;

use super::event::Event;
use super::moving::{Free, Motion, Way};
use super::overlap::Overlap;
use crate::kinematics::{Approach, Crossing, LiftOff, OffPulley, Solver};
use crate::mechanism::{Excursion, Mechanism, show_time};

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
        }
    }
}

impl Motion {
    /// Returns what is worth knowing and was not told yet: overlaps, events, then what holds at the pose.
    /// The host asks after each [advance](Self::advance) and after each [solution](Self::solve).
    pub fn notices(&mut self) -> impl Iterator<Item = Notice<'_>> {
        let Self {
            solver,
            solution,
            told,
            free,
            way,
            knows_contacts,
            ..
        } = self;
        let (has_passed, goes_on) = (*way == Way::Passed, *way != Way::Stopped);
        let mut approach = None;
        if has_passed {
            *way = Way::Told;
            approach = solver.approach(&mut told.near_singular);
        }
        let solver = &*solver;
        let (mechanism, pose) = (&**solver.mechanism(), solver.pose());
        let happenings = happenings(free.as_mut(), mechanism);
        let crossings = crossings(solver).filter(move |_| has_passed);
        let values = mechanism.drivers.iter().zip(&pose.drivers);
        let values = values.filter(move |_| goes_on).zip(&mut told.beyond);
        let excursions = values
            .filter_map(|((driver, value), beyond)| driver.excursion(*value, pose.time, beyond));
        let inputs = mechanism.inputs.iter();
        let inputs = inputs.filter(move |input| goes_on && input.given.is_none());
        let inputs = inputs.zip(&solution.loads).zip(&mut told.inputs_beyond);
        let of_inputs = inputs
            .filter_map(|((input, value), beyond)| input.excursion(*value, pose.time, beyond));
        let off_pulleys = goes_on.then(|| solver.off_pulleys(&mut told.off_pulleys));
        let forces = solution.forces().filter(|_| *knows_contacts);
        let lift_offs = forces.map(|forces| solver.lift_offs(forces, &mut told.lifted));
        happenings
            .chain(approach.map(|approach| Notice::Approach(approach, pose.time)))
            .chain(crossings)
            .chain(excursions.chain(of_inputs).map(Notice::Excursion))
            .chain(off_pulleys.into_iter().flatten().map(Notice::OffPulley))
            .chain(lift_offs.into_iter().flatten().map(Notice::LiftOff))
    }

    /// Returns the overlaps and events among the [notices](Self::notices).
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

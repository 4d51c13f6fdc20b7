//! What is worth knowing of a motion, in words.

use std::fmt;

use super::event::Event;
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
    /// A driver is beyond a limit.
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

/// What has been told of a motion, so that it is told once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Told {
    /// Whether the singular position nearby was told.
    pub near_singular: bool,
    /// Whether each driver is beyond a limit.
    pub beyond: Vec<bool>,
    /// Whether a rope has left each pulley.
    pub off_pulleys: Vec<bool>,
    /// Whether each contact pulls.
    pub lifted: Vec<bool>,
}

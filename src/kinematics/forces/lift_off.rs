//! Contacts that would lift off, and ropes that would be slack.

use std::fmt;

use super::solve::Forces;
use crate::kinematics::state::State;
use crate::mechanism::{show_time, shown};

/// A part of the largest reaction below which a pulling force is rounding.
const PULLS: f64 = 1e-9;

/// A joint that can only push and begins to pull, or a rope that begins to push.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiftOff<'a> {
    /// Time \[s\].
    pub time: f64,
    /// Name of the joint.
    pub joint: &'a str,
    /// Force by which its parts would have to pull each other, or the rope to push \[N\]; a torque \[N m\]
    /// between angles.
    pub pull: f64,
    /// Whether its parts are the sides of an equation between angles.
    pub is_angle: bool,
    /// Whether it is a rope.
    pub is_rope: bool,
}

impl fmt::Display for LiftOff<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = if self.is_angle { "N.m" } else { "N" };
        let (time, joint) = (show_time(self.time), self.joint);
        let pull = format!("{} {unit}", shown(self.pull));
        if self.is_rope {
            write!(
                out,
                "t = {time} s: rope `{joint}` would be slack: it would have to push with {pull}; \
                 the mechanism keeps its length"
            )
        } else {
            write!(
                out,
                "t = {time} s: joint `{joint}` would lift off: its parts would have to pull each \
                 other with {pull}; the mechanism keeps them together"
            )
        }
    }
}

impl Forces {
    /// Returns the contacts that begin to pull and the ropes that begin to push, and sets in `lifted`
    /// which contacts pull.
    pub(in crate::kinematics) fn lift_offs<'a>(
        &'a self,
        state: &'a State,
        lifted: &'a mut [bool],
    ) -> impl Iterator<Item = LiftOff<'a>> {
        let least = PULLS * self.largest_reaction();
        let contacts = self.contacts.iter().zip(lifted);
        contacts.filter_map(move |(contact, lifted)| {
            let force = contact.force(&self.mechanism, &state.at, &self.results.multipliers);
            let pulls = force < -least;
            let begins = pulls && !*lifted;
            *lifted = pulls;
            let joint = &self.mechanism.joints[contact.joint];
            begins.then(|| LiftOff {
                time: state.pose.time,
                joint: &joint.name,
                pull: -force,
                is_angle: joint.equation().is_some_and(|own| own.is_angle),
                is_rope: joint.rope().is_some(),
            })
        })
    }

    /// Returns the largest component of a reaction \[N or N m\].
    fn largest_reaction(&self) -> f64 {
        let components = self.results.reactions.as_flattened().iter();
        components.fold(0.0, |most: f64, component| most.max(component.abs()))
    }
}

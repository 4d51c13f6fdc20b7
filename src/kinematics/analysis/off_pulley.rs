//! Ropes that leave their pulleys.

use std::fmt;

use crate::kinematics::state::State;
use crate::kinematics::system::System;
use crate::mechanism::{MarkerId, show_time};

/// Angle of an arc below zero that is rounding \[rad\].
const EMPTY_ARC: f64 = 1e-9;

/// A rope that begins to leave a pulley: straight, it would pass on the other side.
#[derive(Clone, Debug, PartialEq)]
pub struct OffPulley<'a> {
    /// Time \[s\].
    pub time: f64,
    /// Name of the rope.
    pub rope: &'a str,
    /// Marker at the pulley's centre, with its body.
    pub pulley: String,
}

impl fmt::Display for OffPulley<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { time, rope, pulley } = self;
        write!(
            out,
            "t = {} s: rope `{rope}` would leave its pulley at `{pulley}`: the angle of the arc on \
             it is below zero; the mechanism goes on with such an arc",
            show_time(*time)
        )
    }
}

/// Returns the pulleys of all ropes: the joint of the rope, the marker at the pulley's centre, and the
/// angle of the arc \[rad\].
pub(in crate::kinematics) fn arcs<'a>(
    system: &'a System,
    state: &'a State,
) -> impl Iterator<Item = (usize, MarkerId, f64)> + 'a {
    system.ropes().flat_map(|(joint, rope)| {
        let arcs = rope.arcs(&state.at);
        arcs.map(move |(marker, angle)| (joint, marker, angle))
    })
}

/// Returns the pulleys that ropes begin to leave at the pose, and sets in `off`, one entry per pulley,
/// which ones they have left.
pub(in crate::kinematics) fn off_pulleys<'a>(
    system: &'a System,
    state: &'a State,
    off: &'a mut [bool],
) -> impl Iterator<Item = OffPulley<'a>> {
    let mechanism = system.mechanism();
    let pulleys = arcs(system, state).zip(off);
    pulleys.filter_map(move |((joint, marker, angle), off)| {
        let is_off = angle < -EMPTY_ARC;
        let begins = is_off && !*off;
        *off = is_off;
        begins.then(|| OffPulley {
            time: state.pose.time,
            rope: &mechanism.joints[joint].name,
            pulley: mechanism.marker_path(marker),
        })
    })
}

//! Relation of a rope.

use super::{Held, JointParts};
use crate::kinematics::constraint::{RopeLength, Station};
use crate::mechanism::{Joint, Rope};

/// Returns the relation of a rope.
pub(super) fn run(joint: &Joint, rope: &Rope, parts: &mut JointParts) -> Held {
    let stations = rope.points.iter().map(|point| Station {
        marker: point.marker,
        pulley: point.pulley.as_ref().map(|pulley| {
            let what = format!("a pulley's radius in joint `{}`", joint.name);
            let radius = parts.coefficient(&pulley.radius, what);
            (radius, pulley.side.sign())
        }),
    });
    let stations = stations.collect();
    let numbers = rope.parts.iter().map(|number| {
        let what = format!("a number of parts in joint `{}`", joint.name);
        parts.coefficient(number, what)
    });
    let relation = RopeLength::new(stations, numbers.collect());
    (Box::new(relation), rope.length.clone())
}

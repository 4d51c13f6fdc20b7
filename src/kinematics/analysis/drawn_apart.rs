//! Markers of joints that were drawn apart.
//!
//! Parts without estimates may be drawn in one pose, with the coordinates of a sketch: the markers of
//! each joint are then in one place, and a joint whose markers are far apart is a slip. Parts whose
//! frames are at their own pins are drawn apart everywhere, and estimates are rough: neither says
//! anything of coordinates.

use std::fmt;

use crate::kinematics::assembly::estimate::estimate;
use crate::kinematics::constraint::Dimension;
use crate::kinematics::error::millimetres;
use crate::kinematics::origin::Origin;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;
use crate::mechanism::MarkerId;

/// Largest distance of markers that were drawn in one place, in sizes of the mechanism: a sketch is
/// measured to that.
const TOGETHER: f64 = 0.01;
/// Least distance that is told, and least distance from the origin at which a pin shows that its
/// parts were drawn in one pose: a few times as much.
const APART: f64 = 0.05;

/// A joint whose markers were drawn apart.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnApart {
    /// Paths of the markers.
    pub markers: [String; 2],
    /// Distance of the markers, or of the second one from the line of the first one \[m\].
    pub distance: f64,
    /// Whether the joint holds a point on a line.
    pub is_line: bool,
}

impl fmt::Display for DrawnApart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            markers: [from, to],
            ..
        } = self;
        let distance = millimetres(self.distance);
        if self.is_line {
            write!(
                f,
                "`{to}` was drawn {distance} off the line of `{from}`: a slip in a coordinate?"
            )
        } else {
            write!(
                f,
                "`{from}` and `{to}` were drawn {distance} apart: a slip in a coordinate?"
            )
        }
    }
}

/// Returns the joints whose markers were drawn far apart, if as many pins are in place.
///
/// Before: the mechanism is assembled.
pub(in crate::kinematics) fn drawn_apart(
    compiled: &CompiledMechanism,
    state: &State,
) -> Vec<DrawnApart> {
    let system = &compiled.system;
    let mechanism = system.mechanism();
    let Ok(drawn) = estimate(system, &state.pose.parameters) else {
        return Vec::new();
    };
    let mut at = state.at.clone();
    at.set_pose(mechanism, &drawn);
    let size = at.size();
    let is_in_place = |marker: MarkerId| {
        let body = mechanism.markers[marker.index()].body;
        body.is_none_or(|body| drawn[3 * body.index()..][..3].iter().all(|q| *q == 0.0))
    };
    let mut distances = vec![None; mechanism.joints.len()];
    for (row, equation) in system.equations().iter().enumerate() {
        if let Origin::Joint(joint) = equation.origin
            && equation.constraint.dimension() == Dimension::Length
        {
            let target = system.target(row, &state.targets, &state.pose.drivers);
            let error = equation.constraint.value(&at) - target;
            let distance = distances[joint].get_or_insert(0.0_f64);
            *distance = distance.hypot(error);
        }
    }
    let mut pins_in_place = 0;
    let mut apart = Vec::new();
    for (joint, distance) in mechanism.joints.iter().zip(distances) {
        let is_line = (joint.guide()).is_some_and(|guide| guide.aside.is_none());
        if !(is_line || joint.is_point()) {
            continue;
        }
        let ends = [joint.from, joint.to];
        let Some(distance) = distance.filter(|_| ends.into_iter().all(is_in_place)) else {
            continue;
        };
        if distance <= TOGETHER * size {
            // Frames at their own pins have them at the origin.
            let is_away = at.marker(joint.from).point.norm() >= APART * size;
            pins_in_place += usize::from(is_away && !is_line);
        } else {
            apart.push(DrawnApart {
                markers: ends.map(|marker| mechanism.marker_path(marker)),
                distance,
                is_line,
            });
        }
    }
    if pins_in_place < apart.len() {
        return Vec::new();
    }
    apart.retain(|joint| joint.distance >= APART * size);
    apart
}

//! Relations of wheels.

use super::{Held, JointParts, held_at};
use crate::kinematics::constraint::{RackAndPinion, WheelPair, of_coordinate};
use crate::mechanism::{
    BodyId, Coordinate, CoordinateKind, Expression, Joint, Phase, RackSide, WheelSizes,
};

/// Returns the relation of two wheels that turn in a fixed ratio.
pub(super) fn couple(
    joint: &Joint,
    sizes: &WheelSizes,
    opposite: bool,
    carrier: Option<BodyId>,
    phase: &Phase,
    parts: &mut JointParts,
) -> Held {
    let what = format!("a wheel's size in joint `{}`", joint.name);
    let [first, second] = sizes.expressions();
    let relation = WheelPair {
        from: joint.from,
        to: joint.to,
        carrier,
        sizes: [
            parts.coefficient(first, what.clone()),
            parts.coefficient(second, what),
        ],
        opposite,
    };
    (Box::new(relation), held_at(phase))
}

/// Returns the relation of a wheel, which has marker i, that rolls on the x-axis of marker j.
pub(super) fn roll(
    joint: &Joint,
    radius: &Expression,
    side: RackSide,
    phase: &Phase,
    parts: &mut JointParts,
) -> Held {
    let relation = RackAndPinion {
        pinion: joint.from,
        rack: joint.to,
        radius: parts.coefficient(radius, format!("the radius of joint `{}`", joint.name)),
        side,
    };
    (Box::new(relation), held_at(phase))
}

/// Returns the relation that holds a wheel's centre at its radius above the track.
pub(super) fn stay(joint: &Joint, radius: &Expression, side: RackSide) -> Held {
    let (track, wheel) = (joint.to, joint.from);
    // The distance from the track to the centre is positive on the side of the wheel.
    let (from, to) = match side {
        RackSide::Above => (track, wheel),
        RackSide::Below => (wheel, track),
    };
    let height = of_coordinate(&Coordinate {
        kind: CoordinateKind::Y,
        from,
        to,
        axes: track,
    });
    (height, radius.clone())
}

//! The crossings of a pose.

use std::sync::Arc;

use crate::kinematics::newton::Limits;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::plan::{BlockPlan, Crossing, SEAM};
use crate::kinematics::state::{Pose, State};
use crate::mechanism::Jet;

/// Largest distance of q from a crossing of the pose.
const ON: f64 = 1e-9;
/// Largest distance of a pose from the crossing that it enters, in radians and characteristic
/// lengths: rounding moves a pose next to a change point by less. A crossing of other poses, behind
/// a dead point, is farther away.
const OFF_THE_POSE: f64 = 1e-4;
/// The part of a crossing next to its end that counts as the end.
pub(in crate::kinematics) const CROSSING_END: f64 = 1e-6;

/// Returns the message for a change point that was passed.
pub(in crate::kinematics) fn describe_crossing(
    compiled: &CompiledMechanism,
    crossing: &Crossing,
) -> String {
    let mechanism = compiled.system.mechanism();
    let driver = &mechanism.drivers[crossing.driver.index()];
    format!(
        "change point passed on the smooth motion, with driver `{}` at {}: {} there",
        driver.name,
        driver.coordinate.kind.show(crossing.center),
        crossing.alignment.describe(mechanism, "")
    )
}

/// Returns whether this mechanism could have come to the crossings of a pose that was read from
/// outside, and q lies on them. Compiles the plan for the rows of the crossings.
pub(in crate::kinematics) fn admits_crossings(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    pose: &Pose,
) -> bool {
    let Some(Crossing { set_aside, .. }) = pose.crossings.first().map(|first| &**first) else {
        return true;
    };
    if !state.set_aside(compiled, set_aside) {
        return false;
    }
    let mut blocks: Vec<_> = pose.crossings.iter().map(|c| c.block).collect();
    blocks.sort_unstable();
    blocks.dedup();
    blocks.len() == pose.crossings.len()
        && pose.crossings.iter().all(|crossing| {
            let Some(block) = compiled.plan.blocks.get(crossing.block) else {
                return false;
            };
            let columns = block.columns();
            let Some(driver) = compiled.only_driver(crossing.block) else {
                return false;
            };
            let value = pose.drivers[driver.index()];
            crossing.set_aside == *set_aside
                && crossing.driver == driver
                && crossing.half_width > 0.0
                && crossing.place(value).abs() <= SEAM
                && crossing.coefficients.len() == columns.len()
                && crossing.free.len() == columns.len()
                && (crossing.alignment.members.iter())
                    .all(|member| member.is_of(compiled.system.mechanism()))
                && columns.iter().enumerate().all(|(local, &column)| {
                    let [there, ..] = crossing.evaluate(local, value);
                    (there - pose.q[column]).abs() <= ON * (1.0 + there.abs())
                })
        })
}

/// Lets a block's unknowns come from a crossing that the pose is within, and closes the blocks
/// behind it; at the end of the crossing, or if they do not close, the pose stays as it was. Returns
/// false if the crossing is one of other poses.
pub(super) fn enter_crossing(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    crossing: Crossing,
) -> bool {
    if crossing
        .place(state.pose.drivers[crossing.driver.index()])
        .abs()
        >= 1.0 - CROSSING_END
    {
        return true;
    }
    if !passes_through_pose(compiled, state, &crossing) {
        return false;
    }
    let first = crossing.block;
    state.add_crossing(compiled, &Arc::new(crossing));
    state.move_to_pose(&compiled.system);
    let CompiledMechanism {
        system,
        plan: BlockPlan { blocks, .. },
        ..
    } = &mut *compiled;
    let mut block_state = state.block_state(system);
    let closed = blocks[first..]
        .iter_mut()
        .all(|block| block.close(&mut block_state, Limits::STEP).is_ok());
    if closed {
        state.accept_bodies();
    } else {
        let last = state.pose.crossings.len() - 1;
        state.remove_crossing(compiled, last);
        state.move_to_pose(&compiled.system);
    }
    true
}

/// Returns whether the block's unknowns are on a crossing, up to rounding.
fn passes_through_pose(compiled: &CompiledMechanism, state: &State, crossing: &Crossing) -> bool {
    let pose = &state.pose;
    let size = state.at.size();
    let value = pose.drivers[crossing.driver.index()];
    let columns = compiled.plan.blocks[crossing.block].columns();
    columns.iter().enumerate().all(|(local, &column)| {
        let [there, ..] = crossing.evaluate(local, value);
        let off = (there - pose.q[column]).abs();
        off <= OFF_THE_POSE * compiled.system.column_scale(column, size)
    })
}

/// Removes the crossings at whose end the drivers, with these derivatives along the path, lead out
/// of them.
pub(in crate::kinematics) fn leave_crossings(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    drivers: &[Jet],
) {
    let mut left = false;
    for index in (0..state.pose.crossings.len()).rev() {
        let crossing = &state.pose.crossings[index];
        let driver = crossing.driver.index();
        let place = crossing.place(state.pose.drivers[driver]);
        let jet = drivers[driver];
        let direction = if jet.first() == 0.0 {
            jet.second()
        } else {
            jet.first()
        };
        if place.abs() >= 1.0 - CROSSING_END && direction * place > 0.0 {
            state.remove_crossing(compiled, index);
            left = true;
        }
    }
    if left {
        state.move_to_pose(&compiled.system);
        // The ends of a crossing are regular.
        let _ = state.refresh(compiled);
    }
}

//! The change points near a pose, and the singular position that stops the motion along a path.

use std::fmt;

use nalgebra::DVector;

use super::crossings::enter_crossing;
use super::fold::find_fold;
use super::interpolate::{REACH, crossing_of};
use super::lines::{LOCATED, find_lines};
use super::locate::{EPSILON_ROUNDING, Finding, SingularKind, find};
use super::near::{NEAR, block_jacobian, near_singular};
use super::reduced::{ReducedEquation, ReducedPoint};
use super::upstream::{Line, Workspace};
use crate::kinematics::alignment::Alignment;
use crate::kinematics::path::Path;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::redundancy::{are_rows_fit, change_rows};
use crate::kinematics::state::State;
use crate::kinematics::tolerances::SAME_PLACE_ON_PATH;
use crate::mechanism::{DriverId, Jet};

/// [`REACH`] of the position that stops the motion: near a dead point all unknowns are fast.
const REACH_TO_END: f64 = 0.5;
/// A motion is stopped within this distance of a position that it cannot pass.
const STOPPED: f64 = 0.02;
/// Singular positions whose distances ahead differ by less than this part count as one.
const ALIKE: f64 = 0.01;
/// Ratio of regularities up to which two blocks are nearly singular for the same reason.
const SAME_ORDER: f64 = 100.0;
/// Singular values below this part of the largest one count as lost, some 1e-12 of the path in
/// front of a singular position.
const LOST: f64 = 1e-4;

/// A singular position on a path, located to rounding.
#[derive(Clone, Debug, PartialEq)]
pub struct SingularPoint {
    /// Its kind.
    pub kind: SingularKind,
    /// Its place on the path; beyond one if the path ends before it.
    pub s: f64,
    /// The values of all drivers there: the limit \[m or rad\].
    pub drivers: Vec<f64>,
    /// q there, as far as the block and those that it reads determine it.
    pub q: Vec<f64>,
    /// The null vector of the Jacobian there over all of q, zero outside of the block, scaled so
    /// that metres and radians compare and the largest entry is one: the motion that is free, or
    /// infinitely fast.
    pub free: Vec<f64>,
    /// Kind and name of the bodies and connections in `geometry`.
    pub bodies: Vec<String>,
    /// The lines that meet there, in words.
    pub geometry: String,
}

impl fmt::Display for SingularPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, where {}", self.kind, self.geometry)
    }
}

/// A limit of the next sub-step in front of a position that cannot be passed.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) struct DriverLimit {
    pub(in crate::kinematics) driver: DriverId,
    /// The largest change of the driver \[m or rad\].
    pub(in crate::kinematics) way: f64,
}

/// Searches for singular positions that found none: the regularity of each block at its last one,
/// zero without one. A block is searched again once its regularity has changed by a factor of two;
/// in a block that is nearly singular all along the motion each search would find nothing again.
#[derive(Debug, Default)]
pub(in crate::kinematics) struct FruitlessSearches(Vec<f64>);

impl FruitlessSearches {
    /// Forgets all searches.
    pub(in crate::kinematics) fn clear(&mut self) {
        self.0.clear();
    }

    /// Returns whether a block of this regularity was searched at about the same regularity.
    fn contain(&self, block: usize, regularity: f64) -> bool {
        let searched = self.0.get(block).copied().unwrap_or(0.0);
        regularity > 0.5 * searched && regularity < 2.0 * searched
    }

    /// Notes a search of a block of this regularity; zero if it was not fruitless.
    fn note(&mut self, block: usize, regularity: f64) {
        if self.0.len() <= block {
            self.0.resize(block + 1, 0.0);
        }
        self.0[block] = regularity;
    }
}

/// Takes fitter rows, or adds the crossings of change points near the pose. Returns the limit of the
/// next sub-step in front of a position that cannot be passed; the mechanism is at `s` of the path,
/// with these derivatives of the drivers along it. Allocates where something may be near.
///
/// # Errors
///
/// A position that cannot be passed, right ahead.
pub(in crate::kinematics) fn look_ahead(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    drivers: &[Jet],
    (path, s): (&Path, f64),
    fruitless: &mut FruitlessSearches,
) -> Result<Option<DriverLimit>, Box<SingularPoint>> {
    let ahead = enter_near_crossings(compiled, state, Some(drivers), fruitless);
    let Some(Ahead {
        block,
        limit,
        is_next,
    }) = ahead
    else {
        return Ok(None);
    };
    if is_next {
        let mut work = Workspace::new(state);
        let point = singular_point(compiled, state, (path, s), block, &mut work);
        return_to_regular_pose(compiled, state);
        if let Some(point) = point {
            return Err(Box::new(point));
        }
    }
    Ok(Some(limit))
}

/// Adds the crossings of change points near the pose, at which all blocks are factorised.
pub(in crate::kinematics) fn settle(compiled: &mut CompiledMechanism, state: &mut State) {
    if state.regularity < NEAR {
        enter_near_crossings(compiled, state, None, &mut FruitlessSearches::default());
    }
}

/// A position ahead that cannot be passed.
struct Ahead {
    block: usize,
    limit: DriverLimit,
    /// Whether it is so near that the motion stops here.
    is_next: bool,
}

/// Adds the crossings of change points near the pose. Returns the first position that drivers with
/// these derivatives run into and cannot pass.
///
/// A mechanism that moves takes fitter rows first, if there are any: the rows in use depend on each
/// other in more places than all rows do, and rounding decides how wide a crossing there may be.
fn enter_near_crossings(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    drivers: Option<&[Jet]>,
    fruitless: &mut FruitlessSearches,
) -> Option<Ahead> {
    let mut near = near_singular(compiled);
    near.retain(|&block| !fruitless.contain(block, compiled.plan.blocks[block].regularity()));
    if near.is_empty() {
        return None;
    }
    match drivers {
        Some(_) if change_rows(compiled, state) => {
            // Blocks are others now. At one pose rows change once at the most.
            fruitless.clear();
            return_to_regular_pose(compiled, state);
            return enter_near_crossings(compiled, state, drivers, fruitless);
        }
        None if !are_rows_fit(compiled, state) => return None,
        _ => {}
    }
    let mut ahead = None;
    let mut work = Workspace::new(state);
    for &block in &near {
        let Some(driver) = compiled.only_driver(block) else {
            continue;
        };
        let regularity = compiled.plan.blocks[block].regularity();
        fruitless.note(block, regularity);
        let value = state.pose.drivers[driver.index()];
        let direction = drivers.map_or(0.0, |drivers| drivers[driver.index()].first());
        let line = Line::Driver(driver);
        let equation = ReducedEquation::new(compiled, state, block, line, value, &mut work);
        let Some((mut equation, start)) = equation else {
            continue;
        };
        let finding = match find(&mut equation, start, REACH) {
            // The place found is the singular position of that block.
            _ if equation.reads_singular() => Finding::Nothing,
            finding => finding,
        };
        if !matches!(finding, Finding::Nothing) {
            fruitless.note(block, 0.0);
        }
        if let Finding::End(kind, point) = &finding
            && !matches!(kind, SingularKind::DeadPoint | SingularKind::Cusp)
            && (point.tau - value) * direction > 0.0
        {
            let way = (point.tau - value).abs();
            ahead.get_or_insert(Ahead {
                block,
                limit: DriverLimit {
                    driver,
                    // Closer to it than to anything behind the mechanism.
                    way: 0.75 * way,
                },
                is_next: way * equation.speed < STOPPED,
            });
        }
        let there = match &finding {
            Finding::Crossing(point, _) => Some(equation.pose(point)),
            _ => None,
        };
        let crossing = crossing_of(&mut equation, finding, block, driver);
        if let (Some(mut crossing), Some(q)) = (crossing, there) {
            let columns = compiled.plan.blocks[block].columns();
            let free = (columns, &crossing.free[..]);
            crossing.alignment = alignment_at(compiled, state, &q, free, LOCATED);
            if !enter_crossing(compiled, state, crossing) {
                fruitless.note(block, regularity);
            }
        }
    }
    return_to_regular_pose(compiled, state);
    ahead
}

/// Brings the plan back to the pose, after blocks have been elsewhere.
fn return_to_regular_pose(compiled: &mut CompiledMechanism, state: &mut State) {
    state.move_to_pose(&compiled.system);
    // The pose was regular when it was reached.
    let _ = state.refresh(compiled);
}

/// Returns the position that stops the motion along a path, at whose `s` the mechanism is; `None`
/// if no singular position was found: the motion jumps, or a block is too large.
pub(in crate::kinematics) fn find_end(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    path: &Path,
    s: f64,
) -> Option<Box<SingularPoint>> {
    let mut near = near_singular(compiled);
    let regularity = |block: usize| compiled.plan.blocks[block].regularity();
    // A block that reads one that runs ever faster is as near to singular as that one.
    let least = near.iter().map(|&block| regularity(block));
    let least = least.fold(f64::INFINITY, f64::min);
    near.retain(|&block| regularity(block) <= SAME_ORDER * least);
    let mut work = Workspace::new(state);
    let mut located: Vec<(usize, f64)> = Vec::new();
    for &block in &near {
        let line = Line::Path(path);
        let equation = ReducedEquation::new(compiled, state, block, line, s, &mut work);
        let place = equation.and_then(|(mut equation, start)| place_ahead(&mut equation, start));
        located.extend(place.map(|(_, point)| (block, point.tau - s)));
    }
    // A block and those that read it lose rank at the same place: the first of them counts.
    let nearest = located.iter().map(|(_, off)| *off);
    let nearest = nearest.fold(f64::INFINITY, f64::min);
    let farthest = nearest + ALIKE * nearest.abs() + SAME_PLACE_ON_PATH;
    let first = located.iter().find(|(_, off)| *off <= farthest);
    let found =
        first.and_then(|(block, _)| singular_point(compiled, state, (path, s), *block, &mut work));
    return_to_regular_pose(compiled, state);
    let found = found.or_else(|| {
        near.iter()
            .find_map(|&block| loss_of_ranks(compiled, state, s, block))
    });
    if found.is_some() {
        return found.map(Box::new);
    }
    let fold = near
        .iter()
        .find_map(|&block| located_point(compiled, state, (path, s), block, &mut work, fold_ahead));
    return_to_regular_pose(compiled, state);
    fold.map(Box::new)
}

/// The kind and the place of a singular position.
type Located = (SingularKind, Box<ReducedPoint>);

/// Returns the dead point ahead of the start on a path at which a block loses several ranks.
fn fold_ahead(equation: &mut ReducedEquation<'_>, start: ReducedPoint) -> Option<Located> {
    let point = find_fold(equation, start, REACH_TO_END)?;
    Some((SingularKind::DeadPoint, Box::new(point)))
}

/// Returns the kind and the place of the singular position ahead of the start on a path.
fn place_ahead(equation: &mut ReducedEquation<'_>, start: ReducedPoint) -> Option<Located> {
    let s = start.tau;
    let (kind, point) = match find(equation, start, REACH_TO_END) {
        Finding::End(kind, point) => (kind, point),
        Finding::Crossing(point, _) => (SingularKind::ChangePoint, point),
        Finding::Nothing => return None,
    };
    // Rounding may overshoot the point by as much as the residual can resolve: Newton–Raphson
    // accepts a residual that has stopped falling at a hundred times its rounding.
    let behind = s - point.tau;
    let is_behind =
        behind > SAME_PLACE_ON_PATH && behind * point.first[1].abs() > 4.0 * EPSILON_ROUNDING;
    (!is_behind).then_some((kind, point))
}

/// Returns the singular position of a block ahead on a path.
fn singular_point(
    compiled: &mut CompiledMechanism,
    state: &State,
    (path, s): (&Path, f64),
    block: usize,
    work: &mut Workspace,
) -> Option<SingularPoint> {
    located_point(compiled, state, (path, s), block, work, place_ahead)
}

/// Returns the singular position of a block ahead on a path that `locate` finds.
fn located_point(
    compiled: &mut CompiledMechanism,
    state: &State,
    (path, s): (&Path, f64),
    block: usize,
    work: &mut Workspace,
    locate: fn(&mut ReducedEquation<'_>, ReducedPoint) -> Option<Located>,
) -> Option<SingularPoint> {
    let line = Line::Path(path);
    let (mut equation, start) = ReducedEquation::new(compiled, state, block, line, s, work)?;
    let (kind, point) = locate(&mut equation, start)?;
    let (q, drivers) = (equation.pose(&point), equation.drivers().to_vec());
    let place = (kind, point.tau);
    let free = &point.tangents[0];
    Some(point_at(
        compiled,
        state,
        block,
        place,
        (q, drivers),
        free,
        LOCATED,
    ))
}

/// Returns a singular position of more than one rank, at which the search for others fails, as the
/// pose at which the mechanism has stopped in front of it.
fn loss_of_ranks(
    compiled: &CompiledMechanism,
    state: &State,
    s: f64,
    block: usize,
) -> Option<SingularPoint> {
    let svd = block_jacobian(compiled, state, block).svd(false, true);
    let values = &svd.singular_values;
    // In descending order.
    let last_but_one = values.len().checked_sub(2)?;
    if values[last_but_one] > LOST * values[0] {
        return None;
    }
    let free = svd.v_t?.row(last_but_one + 1).transpose();
    let place = (SingularKind::HigherRank, s);
    let pose = (state.pose.q.clone(), state.pose.drivers.clone());
    Some(point_at(compiled, state, block, place, pose, &free, LOST))
}

/// Returns a singular point with a null vector of a block; its lines meet to `tolerance`.
fn point_at(
    compiled: &CompiledMechanism,
    state: &State,
    block: usize,
    (kind, s): (SingularKind, f64),
    (q, drivers): (Vec<f64>, Vec<f64>),
    free: &DVector<f64>,
    tolerance: f64,
) -> SingularPoint {
    let columns = compiled.plan.blocks[block].columns();
    let free = free / free[free.icamax()];
    let mut over_all = vec![0.0; state.pose.q.len()];
    for (&column, value) in columns.iter().zip(free.iter()) {
        over_all[column] = *value;
    }
    let alignment = alignment_at(compiled, state, &q, (columns, free.as_slice()), tolerance);
    let mechanism = compiled.system.mechanism();
    SingularPoint {
        kind,
        s,
        drivers,
        q,
        bodies: alignment.names(mechanism),
        geometry: alignment.describe(mechanism, ""),
        free: over_all,
    }
}

/// Returns the lines that meet at q, for a null vector in these unknowns.
fn alignment_at(
    compiled: &CompiledMechanism,
    state: &State,
    q: &[f64],
    free: (&[usize], &[f64]),
    tolerance: f64,
) -> Alignment {
    let mut at = state.at.clone();
    at.set_pose(compiled.system.mechanism(), q);
    find_lines(compiled, &at, free, tolerance)
}

#[cfg(test)]
mod tests {
    use super::FruitlessSearches;

    #[test]
    fn blocks_are_searched_again_where_their_regularity_has_changed() {
        let mut searches = FruitlessSearches::default();
        assert!(!searches.contain(3, 1e-3));
        searches.note(3, 1e-3);
        for (regularity, known) in [(1e-3, true), (6e-4, true), (1.9e-3, true), (4e-4, false)] {
            assert_eq!(searches.contain(3, regularity), known, "{regularity}");
        }
        assert!(!searches.contain(3, 2.1e-3) && !searches.contain(2, 1e-3));
        searches.note(3, 0.0);
        assert!(!searches.contain(3, 1e-3));
    }
}

//! Reactions that redundant constraints leave indeterminate.
//!
//! A self-stress is a set of λ that exerts nothing: Phi_qᵀ λ = 0. It has no part in the rows of
//! drivers, because they are independent of the constraints. A reaction is indeterminate if it
//! changes with a self-stress.

use std::collections::BTreeSet;

use crate::kinematics::continuation::PathTracker;
use crate::kinematics::linear::Echelon;
use crate::kinematics::origin::Origin;
use crate::kinematics::path::{DriverPath, Path};
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::redundancy::{drivers_first, jacobian_rows};
use crate::kinematics::state::State;
use crate::kinematics::tolerances::{DEPENDENT, LEAST_COEFFICIENT};
use crate::mechanism::DriverId;

/// Distances of the other poses \[rad, characteristic lengths\] at which self-stresses are sought:
/// a reaction may have no part in one at a single pose.
const OTHER_POSES: [f64; 4] = [0.03, -0.03, 0.11, -0.11];

/// Returns the joints and constraints whose reactions are indeterminate, at poses near the present
/// one, which is restored.
pub(in crate::kinematics) fn indeterminate(
    compiled: &mut CompiledMechanism,
    state: &mut State,
    tracker: &mut PathTracker,
) -> Vec<Origin> {
    if compiled.redundant.is_empty() {
        return Vec::new();
    }
    let home = state.pose.clone();
    let mut stressed = vec![self_stressed(compiled, state)];
    for away in OTHER_POSES {
        let mechanism = compiled.system.mechanism();
        let mut path = Path::new(mechanism);
        home.set_path(&mut path);
        let driver_paths = path.driver_paths.iter_mut().enumerate();
        for ((index, driver_path), &now) in driver_paths.zip(&home.drivers) {
            let row = compiled.system.driver_row(DriverId(index));
            *driver_path = DriverPath::held(now + away / row.row_scale(&state.at), now);
        }
        if tracker.track(compiled, state, &path, false).is_ok() {
            stressed.push(self_stressed(compiled, state));
        }
        state.restore(compiled, &home);
    }
    // At a singular position there are more self-stresses than elsewhere.
    let fewest = stressed.iter().map(|(count, _)| *count).min();
    let generic = stressed
        .into_iter()
        .filter(|(count, _)| Some(*count) == fewest);
    let origins: BTreeSet<Origin> = generic.flat_map(|(_, origins)| origins).collect();
    origins.into_iter().collect()
}

/// Returns the number of self-stresses at the present places of the bodies, and the origins with
/// a part in one.
fn self_stressed(compiled: &CompiledMechanism, state: &State) -> (usize, BTreeSet<Origin>) {
    let rows = jacobian_rows(compiled, state);
    let mut echelon = Echelon::new(compiled.system.unknowns(), &rows);
    let mut count = 0;
    let mut origins = BTreeSet::new();
    let equations = compiled.system.equations();
    for row in drivers_first(&compiled.system) {
        let Some(dependent) = echelon.offer(row, &rows[row], DEPENDENT) else {
            continue;
        };
        count += 1;
        // The row itself has the part one.
        let combination = echelon.combination(&dependent, LEAST_COEFFICIENT);
        let others = combination.iter().map(|(row, _)| *row);
        let is_held = |origin: &Origin| !matches!(origin, Origin::Driver(_));
        let stressed = others.chain([row]).map(|row| equations[row].origin);
        origins.extend(stressed.filter(is_held));
    }
    (count, origins)
}

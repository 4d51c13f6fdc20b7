//! The coordinates that would hold a mechanism whose drivers are too few.

use std::sync::Arc;

use super::rank::jacobian_rows;
use crate::kinematics::assembly::estimate::go_to_estimate;
use crate::kinematics::assembly::least_squares::LeastSquares;
use crate::kinematics::linear::Echelon;
use crate::kinematics::path::Path;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;
use crate::kinematics::tolerances::DEPENDENT;
use crate::mechanism::{BodyId, Mechanism};

/// Least remainder of a coordinate that holds a motion well; one that holds it badly is taken only
/// where no better one is left.
const HOLDS_WELL: f64 = 0.2;

/// A generalized coordinate of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Undriven {
    /// The body.
    pub body: BodyId,
    /// Its coordinate: 0 for x, 1 for y, 2 for phi.
    pub component: usize,
    /// The value where joints and drivers are closed near the estimates \[m or rad\].
    pub value: f64,
}

/// Returns generalized coordinates that hold the motions which joints, constraints and drivers leave
/// free, as many as there are; of a body rather its angle than its place. Empty for a mechanism that
/// is fully driven, and for one without a value at its estimates.
#[must_use]
pub fn undriven(mechanism: &Arc<Mechanism>) -> Vec<Undriven> {
    let path = Path::new(mechanism);
    let (mut compiled, _) = CompiledMechanism::new(Arc::clone(mechanism));
    let mut state = State::new(&compiled.system);
    let Ok(estimate) = go_to_estimate(&mut compiled, &mut state, &path) else {
        return Vec::new();
    };
    let all: Vec<_> = (0..compiled.system.equations().len()).collect();
    let open = LeastSquares::of_all(&compiled.system, &all)
        .close(&mut state.block_state(&compiled.system));
    if open.is_some() {
        // The drawn pose tells as much as one halfway to nowhere.
        state.at.set_pose(mechanism, &estimate);
    }
    let rows = jacobian_rows(&compiled, &state);
    let unknowns = compiled.system.unknowns();
    let mut echelon = Echelon::new(unknowns, &rows);
    for (row, entries) in rows.iter().enumerate() {
        echelon.offer(row, entries, DEPENDENT);
    }
    let mut held = Vec::new();
    for (components, least) in [
        (&[2][..], HOLDS_WELL),
        (&[0, 1], HOLDS_WELL),
        (&[2, 0, 1], DEPENDENT),
    ] {
        for (body, &component) in (0..mechanism.bodies.len())
            .flat_map(|body| components.iter().map(move |component| (body, component)))
        {
            let column = 3 * body + component;
            if echelon.kept().len() < unknowns
                && echelon
                    .offer(rows.len(), &vec![(column, 1.0)], least)
                    .is_none()
            {
                held.push(Undriven {
                    body: BodyId(body),
                    component,
                    value: state.at.coordinate(column),
                });
            }
        }
    }
    held
}

//! The estimate for large blocks accepts no step onto another branch.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::kinematics::certificate::{Pivots, StepBounds};
use crate::kinematics::plan::{BlockSolver, BlockState, Extrapolation, SolveBlock, Step};
use crate::kinematics::reference::assembled;
use crate::kinematics::reference::generated::{BAR, scissor_lift};
use crate::kinematics::solver::Solver;
use crate::mechanism::Source;

/// Number of cells with which the one block has more than 32 torn unknowns.
const CELLS: usize = 20;

/// Returns q of a lift whose bars are at ±`theta` to the ground; a cell with −1 is folded down.
fn pose(theta: f64, signs: &[f64; CELLS]) -> Vec<f64> {
    let mut y = 0.0;
    let mut q = Vec::new();
    for sign in signs {
        let turned = sign * theta;
        q.extend([0.0, y, turned, BAR * theta.cos(), y, PI - turned]);
        y += BAR * turned.sin();
    }
    q
}

/// Returns the height of its end.
fn height(theta: f64, signs: &[f64; CELLS]) -> f64 {
    signs.iter().sum::<f64>() * BAR * theta.sin()
}

/// Returns whether a sub-step from one root of the equations to another one is accepted.
fn accepts(solver: &mut Solver, from: (f64, &[f64; CELLS]), to: (f64, &[f64; CELLS])) -> bool {
    let ends = [from, to].map(|(theta, signs)| (pose(theta, signs), height(theta, signs)));
    let [(start, low), (end, high)] = ends;
    let Solver {
        compiled, state, ..
    } = solver;
    state.pose.q.copy_from_slice(&start);
    state.pose.drivers[0] = low;
    state.move_to_pose(&compiled.system);
    let mut bounds = StepBounds::new(&compiled.system);
    bounds.begin();
    bounds.drivers[0] = f64::EPSILON * (low + high);
    let mut state = BlockState {
        drivers: &[high],
        ..state.block_state(&compiled.system)
    };
    let mut step = Step {
        extrapolation: Extrapolation {
            first: 0.0,
            second: 0.0,
        },
        from: &start,
        pivots: &Pivots::new(2 * CELLS),
        bounds: &mut bounds,
    };
    let mut blocks = compiled.plan.blocks.iter_mut();
    let large = blocks.find_map(|block| match block {
        BlockSolver::CoupledBlock(block) if block.test.inverse.is_empty() => Some(block),
        _ => None,
    });
    let large = large.expect("all bars are in one block");
    large.note_start(&mut state, &mut step);
    state.at.set_pose(state.system.mechanism(), &end);
    large.factorise(&mut state).expect("the end is regular");
    assert!(large.excess < 100.0, "the end is a root");
    large.certify(&mut state, &mut step).is_ok()
}

/// The branch to which a sub-step leads.
#[derive(Clone, Copy, PartialEq)]
enum Branch {
    Same,
    /// The bars lean the other way.
    OtherSide,
    /// Other cells are folded down.
    Folded,
}

#[test]
fn no_step_leads_onto_another_branch() {
    let (mut solver, _) = assembled(&Source::new("lift", scissor_lift(CELLS)));
    let up = [1.0; CELLS];
    let folded = |cells: &[usize]| {
        let mut signs = up;
        cells.iter().for_each(|&cell| signs[cell] = -1.0);
        signs
    };
    let (mut right, mut wrong) = (0, 0);
    // From nearly flat to nearly upright, where branches are near each other.
    for theta in [
        1e-3,
        0.01,
        0.1,
        0.5,
        1.0,
        1.4,
        FRAC_PI_2 - 0.01,
        FRAC_PI_2 - 1e-3,
    ] {
        for ratio in [1.0, 1.0 + 1e-4, 1.0 - 1e-3, 1.01, 0.9, 1.3] {
            for (from, to, branch) in [
                (up, up, Branch::Same),
                (up, up, Branch::OtherSide),
                (up, folded(&[0]), Branch::Folded),
                (up, folded(&[CELLS - 1]), Branch::Folded),
                (up, folded(&[3, 8]), Branch::Folded),
                (folded(&[3]), folded(&[8]), Branch::Folded),
                (folded(&[3]), folded(&[4]), Branch::Folded),
            ] {
                let sine = ratio * height(theta, &from) / (height(FRAC_PI_2, &to));
                if sine >= 1.0 {
                    continue;
                }
                let end = match branch {
                    Branch::OtherSide => PI - sine.asin(),
                    _ => sine.asin(),
                };
                let accepted = accepts(&mut solver, (theta, &from), (end, &to));
                let same = branch == Branch::Same;
                assert!(same || !accepted, "{theta} to {end}, {from:?} to {to:?}");
                right += u32::from(accepted);
                wrong += u32::from(!same);
            }
        }
    }
    // Short steps on the branch itself are accepted.
    assert!(right >= 8 && wrong > 200, "{right} {wrong}");
}

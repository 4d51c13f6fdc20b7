//! The estimate for large blocks accepts no step onto another branch; tubes serve turn by turn.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};

use crate::kinematics::certificate::{Pivots, StepBounds};
use crate::kinematics::path::Curve;
use crate::kinematics::plan::{BlockSolver, BlockState, Extrapolation, SolveBlock, Step};
use crate::kinematics::reference::generated::{BAR, scissor_lift};
use crate::kinematics::reference::{assembled, shipped};
use crate::kinematics::solver::Solver;
use crate::mechanism::Source;

/// Most cells with which the one block has no more than 32 torn unknowns.
const MOST_PROVED_CELLS: usize = 16;
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
    bounds.begin(false);
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

/// Returns the number of tubes that all blocks keep.
fn kept_tubes(solver: &Solver) -> usize {
    let blocks = solver.compiled.plan.blocks.iter();
    let coupled = blocks.filter_map(|block| match block {
        BlockSolver::CoupledBlock(block) => Some(block.tubes.count()),
        _ => None,
    });
    coupled.sum()
}

#[test]
fn later_turns_take_the_tubes_of_the_first_one() {
    for name in ["cam_roller", "cam_flat", "cam_knife"] {
        let (mut solver, mut path) = assembled(&shipped(name));
        let start = solver.pose().drivers[0];
        let mut turn = |degrees: &mut dyn Iterator<Item = u32>| {
            for degree in degrees {
                let now = solver.pose().drivers[0];
                let angle = start + f64::from(degree).to_radians();
                path.curves[0] = Curve::held(angle, now);
                let progress = solver.track(&path).expect("a cam turns");
                assert_eq!(
                    (progress.substeps, progress.checked),
                    (1, 0),
                    "{name} at {degree}"
                );
            }
            kept_tubes(&solver)
        };
        // The last tube of the first turn reaches into the second one.
        let first = turn(&mut (1..=380));
        assert!((20..200).contains(&first), "{name}: {first} tubes");
        assert_eq!(turn(&mut (381..3600)), first, "{name} goes on");
        assert_eq!(turn(&mut (0..3599).rev()), first, "{name} comes back");
    }
}

/// Small moves at the bottom of a lift make large ones of its upper bars, so that its tubes are
/// short; one for each step would cost more than none.
#[test]
fn a_tube_of_a_lift_serves_several_steps() {
    for cells in [4, 8, MOST_PROVED_CELLS] {
        let (mut solver, mut path) = assembled(&Source::new("lift", scissor_lift(cells)));
        let height = |step: u32| cells as f64 * BAR * (FRAC_PI_6 + 5e-5 * f64::from(step)).sin();
        // The block that makes tubes as it moves.
        let place = |solver: &Solver| {
            let blocks = solver.compiled.plan.blocks.iter();
            let coupled = blocks.filter_map(|block| match block {
                BlockSolver::CoupledBlock(block) => Some(block),
                _ => None,
            });
            let largest = coupled.max_by_key(|block| block.equations.columns.len());
            largest.expect("cells are coupled").tubes.next_place()
        };
        let steps = 60;
        let mut made = 0;
        for step in 1..=steps {
            let before = place(&solver);
            let now = solver.pose().drivers[0];
            path.curves[0] = Curve::held(height(step), now);
            let progress = solver.track(&path).expect("a lift rises");
            assert_eq!((progress.substeps, progress.checked), (1, 0), "{cells}");
            made += u32::from(place(&solver) != before);
        }
        assert!(
            (1..=steps / 3).contains(&made),
            "{cells} cells: {made} tubes"
        );
    }
}

//! Storage and limits of the contraction test η + K r < r of a block.

use super::equations::{ColumnOwner, ENTRIES, Jacobian};
use crate::kinematics::constraint::configuration::BodyPose;
use crate::kinematics::linear::{Condition, Lu};
use crate::kinematics::plan::elimination::EliminationOrder;
use crate::kinematics::plan::step::BlockState;
use crate::kinematics::system::System;

/// Most torn unknowns of a block whose inverse A is computed entry by entry.
pub(super) const MOST_TORN: usize = 32;
/// Safety factor on the next trial radii, where those tried were too small.
pub(super) const LARGER_RADII: f64 = 1.25;
/// Most radii that are tried.
pub(super) const MOST_TRIES: u32 = 4;
/// Norm of K above which larger radii cannot pass: smaller ones are tried once, then the sub-step
/// is rejected.
pub(super) const LARGEST_CONTRACTION: f64 = 0.9;
/// Largest accepted ratio of η + K r to r. The rounding of A changes the ratio by less than 0.001.
pub(super) const STRICTLY: f64 = 0.999;

/// Storage of the contraction test of a block.
#[derive(Debug)]
pub(super) struct ContractionTest {
    /// Unknowns of earlier blocks in the rows.
    pub(super) known: Vec<usize>,
    /// Bodies with unknowns in the rows, and their frames at the end of the sub-step.
    bodies: Vec<usize>,
    ends: Vec<BodyPose>,
    /// Joint unknowns in the rows, and their values at the end of the sub-step.
    joint_unknowns: Vec<usize>,
    joint_ends: Vec<f64>,
    /// The Jacobian in the middle of the chord.
    pub(super) middle: Jacobian,
    /// A, row by row; empty if the block is too large for it.
    pub(super) inverse: Vec<f64>,
    /// Storage of the estimate, used where `inverse` is empty.
    pub(super) estimate: Estimate,
    pub(super) condition: Condition,
    /// Bound of each row's value on the chord, and the part of it that is rounding.
    pub(super) open: Vec<f64>,
    pub(super) slack: Vec<f64>,
    /// Whether parameters move numbers in the rows.
    pub(super) moves: bool,
    /// Estimate of each row's value on the chord while parameters move, if `inverse` is empty.
    pub(super) moved: Vec<f64>,
    /// Bounds of the change of the Jacobian's entries: row, column, scaled value.
    pub(super) changes: Vec<(usize, usize, f64)>,
    /// Scaled: radii of `known`, trial radii r, η, and η + K r.
    pub(super) known_radii: Vec<f64>,
    pub(super) radii: Vec<f64>,
    pub(super) eta: Vec<f64>,
    pub(super) next: Vec<f64>,
    /// Work space.
    pub(super) row: Vec<f64>,
}

/// Storage of the estimate that replaces the inverse of a large block.
#[derive(Debug, Default)]
pub(super) struct Estimate {
    /// J where the rows were evaluated last minus J where the block is factorised: row, column,
    /// value.
    pub(super) drift: Vec<(usize, usize, f64)>,
    /// F where the rows were evaluated last.
    pub(super) gap: Vec<f64>,
    /// The rows that contain a function of the file, with their unknowns.
    pub(super) functions: Vec<(usize, Vec<usize>)>,
}

/// Returns the rows of a block that contain a function of the file, with their unknowns.
fn function_rows(system: &System, rows: &[usize]) -> Vec<(usize, Vec<usize>)> {
    let functions = rows
        .iter()
        .enumerate()
        .filter(|(_, row)| system.equations()[**row].constraint.has_given_function());
    let with_unknowns = functions.map(|(local, &row)| {
        let mut unknowns = system.incidence(row).unknowns;
        unknowns.sort_unstable();
        unknowns.dedup();
        (local, unknowns)
    });
    with_unknowns.collect()
}

impl ContractionTest {
    /// Makes the storage for the block with index `block`.
    pub(super) fn new(
        system: &System,
        order: &EliminationOrder,
        lu: &Lu,
        owners: &[ColumnOwner],
        block: usize,
    ) -> Self {
        let n = order.rows.len();
        let rows = order.rows.iter();
        let mut known: Vec<_> = rows
            .flat_map(|&row| system.incidence(row).unknowns)
            .filter(|&column| owners[column].block != block)
            .collect();
        known.sort_unstable();
        known.dedup();
        let of_bodies = 3 * system.mechanism().bodies.len();
        let moving = || order.columns.iter().chain(&known).copied();
        let mut bodies: Vec<_> = moving().filter(|&k| k < of_bodies).map(|k| k / 3).collect();
        bodies.sort_unstable();
        bodies.dedup();
        let joint_unknowns: Vec<_> = moving().filter(|&k| k >= of_bodies).collect();
        let (inverse, estimate) = if order.torn() <= MOST_TORN {
            (n * n, Estimate::default())
        } else {
            let estimate = Estimate {
                drift: Vec::with_capacity(ENTRIES * n),
                gap: vec![0.0; n],
                functions: function_rows(system, &order.rows),
            };
            (0, estimate)
        };
        Self {
            known_radii: vec![0.0; known.len()],
            known,
            ends: Vec::with_capacity(bodies.len()),
            bodies,
            joint_ends: vec![0.0; joint_unknowns.len()],
            joint_unknowns,
            middle: Jacobian::new(lu.clone()),
            inverse: vec![0.0; inverse],
            estimate,
            condition: Condition::new(n),
            open: vec![0.0; n],
            slack: vec![0.0; n],
            moves: false,
            moved: vec![0.0; n],
            changes: Vec::with_capacity(ENTRIES * n),
            radii: vec![0.0; n],
            eta: vec![0.0; n],
            next: vec![0.0; n],
            row: vec![0.0; n],
        }
    }

    pub(super) fn forget_pivots(&mut self) {
        self.middle.lu.forget_pivots();
    }

    /// Takes over the pivots of the block's own matrix.
    pub(super) fn choose_pivots(&mut self, lu: &Lu) {
        self.middle.lu.clone_from(lu);
    }

    /// Notes the ends of the bodies and joint unknowns.
    pub(super) fn note_ends(&mut self, state: &BlockState<'_>) {
        let frames = state.at.frames();
        self.ends.clear();
        self.ends
            .extend(self.bodies.iter().map(|&body| frames[body]));
        for (end, &column) in self.joint_ends.iter_mut().zip(&self.joint_unknowns) {
            *end = state.at.coordinate(column);
        }
    }

    /// Puts the bodies and joint unknowns back to their ends.
    pub(super) fn return_to_ends(&self, state: &mut BlockState<'_>) {
        for (&body, &end) in self.bodies.iter().zip(&self.ends) {
            state.at.frames_mut()[body] = end;
        }
        for (&column, &end) in self.joint_unknowns.iter().zip(&self.joint_ends) {
            state.at.set_coordinate(column, end);
        }
    }

    /// Adds |A| b to `sum`, b ≥ 0 having one entry per row.
    pub(super) fn apply(&self, b: &[f64], sum: &mut [f64]) {
        let rows = self.inverse.chunks_exact(b.len());
        for (sum, row) in sum.iter_mut().zip(rows) {
            let parts = row.iter().zip(b).map(|(a, b)| a.abs() * b);
            *sum += parts.sum::<f64>();
        }
    }
}

//! One proof for many small steps of a block.
//!
//! In a *certified box* around a pose c each unknown of the rows, upstream ones included, differs
//! from c by no more than its width B. With A = J(c)⁻¹ and the changes δ of the gradients in the
//! box, the numbers
//!
//! > H = |A| δ B, M = |A ∂F/∂p| B + |A| δ B, h = max H / B, m = max M / B
//!
//! belong to the box. Let a chord in the box move each unknown by at most λ widths. F is zero at
//! both ends of the chord, so that on it F is at most half the change of its gradient: η ≤ λ H / 2,
//! plus μ M for upstream radii of μ widths, and K r ≤ λ′ H for radii of λ′ widths. The test of
//! [`certify`](super::certify) becomes
//!
//! > λ h / 2 + μ m + λ′ h < λ′, and chord and radii lie in the box.
//!
//! Its radii are of first order in the step, those of `certify` of second order. A step that fails
//! here is tested there, and a step that passes here passes there too: the accepted steps do not
//! depend on the box.

use super::CoupledBlock;
use crate::kinematics::block::step::{BlockState, Step};
use crate::kinematics::certificate::StepBounds;
use crate::kinematics::newton::STALLED;
use crate::kinematics::system::Target;

/// Largest norm of K of a single step after which a box is made: the box then serves several steps.
const WORTH_A_BOX: f64 = 0.05;
/// The h that a box is made for.
const GOOD_CONTRACTION: f64 = 0.25;
/// Largest h of a box.
const LARGEST_CONTRACTION: f64 = 0.4;
/// Largest width, in radians and lengths of the block.
const LARGEST_WIDTH: f64 = 0.2;
/// Ratio of the least width to the largest.
const LEAST_PART: f64 = 0.25;

/// A box around a pose in which a block is proved regular.
#[derive(Debug, Default)]
pub(super) struct CertifiedBox {
    holds: bool,
    /// c of the block's own unknowns, then of the upstream ones.
    centre: Vec<f64>,
    /// 1/B in the same order.
    inverse_width: Vec<f64>,
    /// h.
    contraction: f64,
    /// m.
    upstream: f64,
    /// Increase of λ′ per unit of a driver's deviation from its chord.
    driver: f64,
    /// Increase of λ′ by rounding.
    rounding: f64,
}

impl CertifiedBox {
    /// Makes the storage for this number of unknowns, own and upstream.
    pub(super) fn new(unknowns: usize) -> Self {
        Self {
            centre: vec![0.0; unknowns],
            inverse_width: vec![0.0; unknowns],
            ..Self::default()
        }
    }

    /// Forgets the box.
    pub(super) fn forget(&mut self) {
        self.holds = false;
    }
}

impl CoupledBlock {
    /// Proves by the box that one motion joins the two ends of a sub-step, and writes its bound to
    /// `next`. Returns false without a proof.
    pub(super) fn certify_in_box(&mut self, state: &BlockState<'_>, step: &mut Step<'_>) -> bool {
        let Self {
            equations,
            test,
            certified_box: area,
            ..
        } = self;
        let columns = &equations.columns;
        if !area.holds {
            return false;
        }
        let (mut moved, mut far, mut uncertain) = (0.0_f64, 0.0_f64, 0.0_f64);
        let all = columns.iter().chain(&test.known);
        for ((&column, centre), scale) in all.zip(&area.centre).zip(&area.inverse_width) {
            let (from, to) = (step.from[column], state.at.coordinate(column));
            moved = moved.max((to - from).abs() * scale);
            far = far.max((to - centre).abs().max((from - centre).abs()) * scale);
        }
        for (&column, scale) in test.known.iter().zip(&area.inverse_width[columns.len()..]) {
            uncertain = uncertain.max(step.deviation(column) * scale);
        }
        let mut driven = 0.0_f64;
        for &driver in &test.drivers {
            driven = driven.max(step.bounds.drivers[driver]);
        }
        let open = 0.5 * moved * area.contraction
            + uncertain * area.upstream
            + driven * area.driver
            + area.rounding;
        // The test asks for a strict inequality.
        let radius = 1.001 * open / (1.0 - area.contraction);
        let reach = far + radius.max(uncertain);
        if reach > 1.0 || reach.is_nan() {
            return false;
        }
        let size = state.at.size();
        for (k, &column) in columns.iter().enumerate() {
            let width = 1.0 / area.inverse_width[k];
            test.next[k] = radius * width / state.system.column_scale(column, size);
        }
        step.bounds.reused = true;
        true
    }

    /// Makes a box around the end of a sub-step that was certified with this norm of K, if it will
    /// serve several steps. The block is factorised there.
    pub(super) fn make_box(
        &mut self,
        state: &BlockState<'_>,
        step: &mut Step<'_>,
        contraction: f64,
    ) {
        self.certified_box.holds = false;
        if contraction > WORTH_A_BOX {
            return;
        }
        let size = state.at.size();
        let largest = self
            .equations
            .columns
            .iter()
            .chain(&self.test.known)
            .map(|&column| {
                let moved = (state.at.coordinate(column) - step.from[column]).abs();
                moved / state.system.column_scale(column, self.length * size)
            })
            .fold(0.0, f64::max);
        // Also a block at rest gets a box.
        let largest = largest.max(f64::EPSILON);
        let test = &mut *self.test;
        self.jacobian.invert(&mut test.inverse, &mut test.row);
        // The region of the single step was about half as wide as the step.
        let mut width = (0.5 * largest * GOOD_CONTRACTION / contraction).min(LARGEST_WIDTH);
        for _ in 0..2 {
            if !self.measure_box(state, step, largest, width) {
                return;
            }
            let found = self.certified_box.contraction;
            if found <= LARGEST_CONTRACTION {
                // Discard a box smaller than two steps: the next step would leave it.
                self.certified_box.holds = width > 2.0 * largest;
                return;
            }
            width *= GOOD_CONTRACTION / found;
        }
    }

    /// Computes the numbers of a box of this width. Returns false if a relation is not smooth in
    /// it.
    fn measure_box(
        &mut self,
        state: &BlockState<'_>,
        step: &mut Step<'_>,
        largest: f64,
        width: f64,
    ) -> bool {
        let bounds = &mut *step.bounds;
        let size = state.at.size();
        let all = || self.equations.columns.iter().chain(&self.test.known);
        let length = self.length * size;
        let scale = |column: usize| state.system.column_scale(column, length);
        let area = &mut self.certified_box;
        for (k, &column) in all().enumerate() {
            let end = state.at.coordinate(column);
            let moved = (end - step.from[column]).abs() / scale(column);
            let width = width * (moved / largest).max(LEAST_PART) * scale(column);
            bounds.region[column] = width;
            area.centre[k] = end;
            area.inverse_width[k] = 1.0 / width;
        }
        let smooth = self.bend_rows_in_box(state, bounds);
        if smooth {
            self.gather_rows(state, bounds);
        }
        for &column in self.equations.columns.iter().chain(&self.test.known) {
            bounds.region[column] = 0.0;
        }
        self.test.slack.fill(0.0);
        smooth
    }

    /// Writes for each row: δ B to `open`, its upstream part to `slack`, the rounding to `eta`, and
    /// the row scale of a driver's row to `radii`. Returns false if a relation is not smooth in the
    /// box.
    fn bend_rows_in_box(&mut self, state: &BlockState<'_>, bounds: &StepBounds) -> bool {
        let Self {
            equations, test, ..
        } = self;
        for (local, &row) in equations.rows.iter().enumerate() {
            let Some(bend) = equations.bend(local, state, bounds, false) else {
                return false;
            };
            let (mut own, mut known) = (0.0, 0.0);
            for (column, value) in bend.changes() {
                let part = value * bounds.region[column];
                if equations.own(column).is_some() {
                    own += part;
                } else {
                    known += part;
                }
            }
            test.open[local] = own + known;
            test.slack[local] = known;
            let rounding = state
                .system
                .evaluate_row(row, state.values(), |_, _| {})
                .rounding;
            test.eta[local] = 2.0 * STALLED * rounding;
            test.radii[local] = match state.system.equations()[row].target {
                Target::Driver(_) => bend.row_scale,
                Target::Constant(_) => 0.0,
            };
        }
        true
    }

    /// Computes the numbers of the box from those of the rows.
    fn gather_rows(&mut self, state: &BlockState<'_>, bounds: &StepBounds) {
        let Self {
            equations,
            jacobian,
            test,
            certified_box: area,
            ..
        } = self;
        let size = state.at.size();
        let scaled =
            |column: usize| bounds.region[column] / state.system.column_scale(column, size);
        (area.contraction, area.upstream) = (0.0, 0.0);
        (area.driver, area.rounding) = (0.0, 0.0);
        let rows = test.inverse.chunks_exact(equations.rows.len());
        for (row, &column) in rows.zip(&equations.columns) {
            let apply = |b: &[f64]| row.iter().zip(b).map(|(a, b)| a.abs() * b).sum::<f64>();
            let width = scaled(column);
            let mut known = apply(&test.slack);
            for &column in &test.known {
                known += jacobian.upstream_product(row, column).abs() * scaled(column);
            }
            area.contraction = area.contraction.max(apply(&test.open) / width);
            area.upstream = area.upstream.max(known / width);
            area.rounding = area.rounding.max(apply(&test.eta) / width);
            area.driver = area.driver.max(apply(&test.radii) / width);
        }
    }
}

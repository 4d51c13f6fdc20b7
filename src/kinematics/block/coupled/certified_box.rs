//! One proof for many small steps of a block.
//!
//! Around a pose c each unknown of the rows, those found before included, may differ by its width
//! B. With A = J(c)⁻¹ and the changes δ of the gradients in that box,
//!
//! > H = |A| δ B, M = |A ∂F/∂p| B + |A| δ B, h = max H / B, m = max M / B
//!
//! are known once and for all. A chord in the box, each unknown moving by λ of its width at the
//! most, leaves F open by half of what its gradient changes, as it is closed at both ends: so
//! η ≤ λ H / 2, besides μ M for radii of μ widths upstream, and K r ≤ λ′ H for radii of λ′ widths.
//! The test of [`certify`](super::certify) becomes
//!
//! > λ h / 2 + μ m + λ′ h < λ′, and nothing leaves the box.
//!
//! Its radii are of first order in the step, where those of that test are of second; while steps
//! are small that does no harm, and where it does that test follows. It decides alone whether a
//! step is accepted, so that nothing depends on where the last box was: whatever passes here
//! passes there.

use super::CoupledBlock;
use crate::kinematics::block::step::{BlockState, Step};
use crate::kinematics::certificate::StepBounds;
use crate::kinematics::newton::STALLED;
use crate::kinematics::system::Target;

/// A box is made where the certificate of a single step has a norm of K below this: then it holds
/// for several.
const WORTH_A_BOX: f64 = 0.05;
/// The h that a box is made for, and the largest it may have.
const GOOD_CONTRACTION: f64 = 0.25;
const LARGEST_CONTRACTION: f64 = 0.4;
/// The largest width, in radians and characteristic lengths.
const LARGEST_WIDTH: f64 = 0.2;
/// The least width as a part of the largest.
const LEAST_PART: f64 = 0.25;

/// A box around a pose in which a block is known to be regular.
#[derive(Debug, Default)]
pub(super) struct CertifiedBox {
    holds: bool,
    /// c and 1/B of the block's own unknowns, then of those found before.
    centre: Vec<f64>,
    inverse_width: Vec<f64>,
    /// h and m.
    contraction: f64,
    upstream: f64,
    /// What a driver off its chord by one adds to λ′, and what rounding adds.
    driver: f64,
    rounding: f64,
}

impl CertifiedBox {
    pub(super) fn new(unknowns: usize) -> Self {
        Self {
            centre: vec![0.0; unknowns],
            inverse_width: vec![0.0; unknowns],
            ..Self::default()
        }
    }

    pub(super) fn forget(&mut self) {
        self.holds = false;
    }
}

impl CoupledBlock {
    /// Proves by the box that one motion joins the two ends of a sub-step, and writes its bound to
    /// `next`; false if that cannot be had.
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
        // A little more than there has to be, as strictly as it is asked for.
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

    /// Makes a box around the end of a sub-step that was certified with this norm of K, where that
    /// is worth it. The block is factorised there.
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
                moved / state.system.column_scale(column, size)
            })
            .fold(0.0, f64::max);
        // What stands still is given some room, too.
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
                // One that the next step leaves is no use, and whatever holds there holds again.
                self.certified_box.holds = width > 2.0 * largest;
                return;
            }
            width *= GOOD_CONTRACTION / found;
        }
    }

    /// Finds h, m and what goes with them for a box of this width; false if a relation is not
    /// smooth in it.
    fn measure_box(
        &mut self,
        state: &BlockState<'_>,
        step: &mut Step<'_>,
        largest: f64,
        width: f64,
    ) -> bool {
        let area = &mut self.certified_box;
        let bounds = &mut *step.bounds;
        let size = state.at.size();
        let scale = |column: usize| state.system.column_scale(column, size);
        let all = || self.equations.columns.iter().chain(&self.test.known);
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

    /// Writes of each row: δ B to `open`, δ B upstream alone to `slack`, its rounding to `eta`, a
    /// driver's one to `radii`. False if a relation is not smooth in the box.
    fn bend_rows_in_box(&mut self, state: &BlockState<'_>, bounds: &StepBounds) -> bool {
        let Self {
            equations, test, ..
        } = self;
        for (local, &row) in equations.rows.iter().enumerate() {
            let Some(bend) = equations.bend(local, state, bounds) else {
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
            let rounding = state.evaluate_row(row, |_, _| {}).rounding;
            test.eta[local] = 2.0 * STALLED * rounding;
            test.radii[local] = match state.system.equations()[row].target {
                Target::Driver(_) => bend.row_scale,
                Target::Constant(_) => 0.0,
            };
        }
        true
    }

    /// Finds h, m and what goes with them from what is known of each row.
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

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

use super::Coupled;
use crate::kinematics::constraint::{Gradient, Region};
use crate::kinematics::factor::Factors;
use crate::kinematics::newton::STALLED;
use crate::kinematics::plan::{Substep, Work};
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
pub(super) struct Neighbourhood {
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

impl Neighbourhood {
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

impl Coupled {
    /// Proves by the box that one motion joins the two ends of a sub-step, and writes its tube to
    /// `next`; false if that cannot be had.
    pub(super) fn certify_in_box(&mut self, work: &Work<'_>, substep: &mut Substep<'_>) -> bool {
        let Self {
            columns,
            proof,
            neighbourhood: area,
            ..
        } = self;
        if !area.holds {
            return false;
        }
        let (mut moved, mut far, mut uncertain) = (0.0_f64, 0.0_f64, 0.0_f64);
        let all = columns.iter().chain(&proof.known);
        for ((&column, centre), scale) in all.zip(&area.centre).zip(&area.inverse_width) {
            let (from, to) = (substep.from[column], work.at.coordinate(column));
            moved = moved.max((to - from).abs() * scale);
            far = far.max((to - centre).abs().max((from - centre).abs()) * scale);
        }
        for (&column, scale) in proof.known.iter().zip(&area.inverse_width[columns.len()..]) {
            uncertain = uncertain.max(substep.tubes.radius(column) * scale);
        }
        let mut driven = 0.0_f64;
        for &driver in &proof.drivers {
            driven = driven.max(substep.tubes.drivers[driver]);
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
        let size = work.at.size();
        for (k, &column) in columns.iter().enumerate() {
            let width = 1.0 / area.inverse_width[k];
            proof.next[k] = radius * width / work.system.column_scale(column, size);
        }
        substep.tubes.relied_on_box = true;
        true
    }

    /// Makes a box around the end of a sub-step that was certified with this norm of K, where that
    /// is worth it. The block is factorised there.
    pub(super) fn make_box(
        &mut self,
        work: &Work<'_>,
        substep: &mut Substep<'_>,
        contraction: f64,
    ) {
        self.neighbourhood.holds = false;
        if self.proof.inverse.is_empty() || contraction > WORTH_A_BOX {
            return;
        }
        let size = work.at.size();
        let largest = self
            .columns
            .iter()
            .chain(&self.proof.known)
            .map(|&column| {
                let moved = (work.at.coordinate(column) - substep.from[column]).abs();
                moved / work.system.column_scale(column, size)
            })
            .fold(0.0, f64::max);
        // What stands still is given some room, too.
        let largest = largest.max(f64::EPSILON);
        self.invert();
        // The region of the single step was about half as wide as the step.
        let mut width = (0.5 * largest * GOOD_CONTRACTION / contraction).min(LARGEST_WIDTH);
        for _ in 0..2 {
            if !self.measure_box(work, substep, largest, width) {
                return;
            }
            let found = self.neighbourhood.contraction;
            if found <= LARGEST_CONTRACTION {
                // One that the next step leaves is no use, and whatever holds there holds again.
                self.neighbourhood.holds = width > 2.0 * largest;
                return;
            }
            width *= GOOD_CONTRACTION / found;
        }
    }

    /// Writes down A at the pose.
    fn invert(&mut self) {
        let order = self.rows.len();
        let proof = &mut *self.proof;
        for column in 0..order {
            proof.row.fill(0.0);
            proof.row[column] = 1.0;
            self.lu.solve(&mut proof.row);
            for (row, value) in proof.row.iter().enumerate() {
                proof.inverse[row * order + column] = *value;
            }
        }
    }

    /// Finds h, m and what goes with them for a box of this width; false if a relation is not
    /// smooth in it.
    fn measure_box(
        &mut self,
        work: &Work<'_>,
        substep: &mut Substep<'_>,
        largest: f64,
        width: f64,
    ) -> bool {
        let Self {
            index,
            rows,
            columns,
            places,
            upstream,
            proof,
            neighbourhood: area,
            ..
        } = self;
        let proof = &mut **proof;
        let tubes = &mut *substep.tubes;
        let size = work.at.size();
        let scale = |column: usize| work.system.column_scale(column, size);
        let order = rows.len();
        for (k, &column) in columns.iter().chain(&proof.known).enumerate() {
            let end = work.at.coordinate(column);
            let moved = (end - substep.from[column]).abs() / scale(column);
            let width = width * (moved / largest).max(LEAST_PART) * scale(column);
            tubes.region[column] = width;
            area.centre[k] = end;
            area.inverse_width[k] = 1.0 / width;
        }
        let scaled = |column: usize, tubes: &crate::kinematics::certificate::Tubes| {
            tubes.region[column] / scale(column)
        };
        // Of each row: δ B in `open`, δ B upstream alone in `slack`, its rounding in `eta`; a
        // driver's one in `radii`.
        let mut smooth = true;
        for (local, &row) in rows.iter().enumerate() {
            let equation = &work.system.equations()[row];
            let row_scale = equation.row_scale(work.at);
            let region = Region {
                radii: &tubes.region,
            };
            let mut change = Gradient::new();
            let bend = equation
                .constraint
                .bend(work.at, &region, &tubes.chord, &mut change);
            smooth &= bend.is_some();
            let (mut own, mut known) = (0.0, 0.0);
            for (column, value) in change.entries() {
                let part = value * row_scale * tubes.region[column];
                if places[column].kernel == *index {
                    own += part;
                } else {
                    known += part;
                }
            }
            proof.open[local] = own + known;
            proof.slack[local] = known;
            let rounding = work
                .system
                .evaluate_row(row, work.at, work.targets, work.drivers, |_, _| {})
                .rounding;
            proof.eta[local] = 2.0 * STALLED * rounding;
            proof.radii[local] = match equation.target {
                Target::Driver(_) => row_scale,
                Target::Constant(_) => 0.0,
            };
        }
        (area.contraction, area.upstream) = (0.0, 0.0);
        (area.driver, area.rounding) = (0.0, 0.0);
        for (k, row) in proof.inverse.chunks_exact(order).enumerate() {
            let apply = |b: &[f64]| row.iter().zip(b).map(|(a, b)| a.abs() * b).sum::<f64>();
            let width = scaled(columns[k], tubes);
            let mut known = apply(&proof.slack);
            for &column in &proof.known {
                let entries = upstream.iter().filter(|entry| entry.1 == column);
                let turned: f64 = entries.map(|(local, _, value)| row[*local] * value).sum();
                known += turned.abs() * scaled(column, tubes);
            }
            area.contraction = area.contraction.max(apply(&proof.open) / width);
            area.upstream = area.upstream.max(known / width);
            area.rounding = area.rounding.max(apply(&proof.eta) / width);
            area.driver = area.driver.max(apply(&proof.radii) / width);
        }
        for &column in columns.iter().chain(&proof.known) {
            tubes.region[column] = 0.0;
        }
        proof.slack.fill(0.0);
        smooth
    }
}

//! What stands in for the certificate of blocks whose inverse is too large to be written down.
//!
//! Here A(s) is the inverse of the Jacobian on the chord itself, so that K holds what the Jacobian
//! changes by within the radii alone, which are of second order in the sub-step. How it changes
//! along the chord only tells how much larger A(s) may be than A, the inverse in the middle:
//!
//! > |A(s) x| ≤ |A x| / (1 − c) with c ≥ |A (J(z̄(s)) − J(z̄(½)))|, in the largest norm.
//!
//! The links of a long row of loops all turn alike: their changes in A J have signs and cancel,
//! while bounds of them would add up with the square of the row's length. So c is found from the
//! Jacobian at the end, and what the chord leaves the rows open by from their values in its
//! middle, where that is largest. One radius r serves all unknowns, and the test is
//!
//! > η / (1 − c) + k / (1 − c) < r, k ≥ |A| δ(r), η ≥ |A F(z̄(½))| + |A| (all else that is open).
//!
//! Norms are estimated from below and two places stand for the whole way, so what they give is
//! taken larger by [`MARGIN`], and the sub-step is *checked*.

use super::certify::{LARGEST_CONTRACTION, MOST_TRIES, ROOM, STRICTLY};
use super::{Coupled, Proof};
use crate::kinematics::factor::Factors;
use crate::kinematics::newton::Rejected;
use crate::kinematics::plan::{Substep, Work};
use crate::kinematics::system::Target;

/// What estimates are taken larger by.
const MARGIN: f64 = 2.0;

/// What the estimate of a block needs besides.
#[derive(Debug, Default)]
pub(super) struct Estimate {
    /// J at the end minus J in the middle, as a sum: row, column, value.
    drift: Vec<(usize, usize, f64)>,
    /// F in the middle.
    gap: Vec<f64>,
}

impl Estimate {
    pub(super) fn new(order: usize, entries: usize) -> Self {
        Self {
            drift: Vec::with_capacity(2 * entries),
            gap: vec![0.0; order],
        }
    }
}

impl Coupled {
    /// Looks for a radius that passes the test; leaves what it makes of it in `next`. Returns c
    /// and the norm of K together. The bodies are at the end of the sub-step, and then in its
    /// middle.
    ///
    /// # Errors
    ///
    /// There is none; with c and the norm of K, if they are known.
    pub(super) fn estimate_radii(
        &mut self,
        work: &mut Work<'_>,
        substep: &mut Substep<'_>,
    ) -> Result<f64, Option<f64>> {
        substep.tubes.checked = true;
        self.proof.estimate.drift.clear();
        self.note_jacobian(work, 1.0);
        self.lay_chord(work, substep);
        self.factorise_middle(work).map_err(|Rejected| None)?;
        self.note_jacobian(work, -1.0);
        let drift = {
            let Proof {
                condition,
                middle,
                estimate,
                ..
            } = &mut *self.proof;
            MARGIN * condition.largest_row_of_product(&mut middle.lu, &estimate.drift)
        };
        if drift.is_nan() {
            return Err(None);
        }
        if drift >= LARGEST_CONTRACTION {
            return Err(Some(drift));
        }
        let larger = 1.0 / (1.0 - drift);
        let gap = larger * MARGIN * self.gap();
        let mut radius = ROOM * gap + f64::EPSILON;
        let mut last = None;
        for _ in 0..MOST_TRIES {
            let [open, change] = self.bend_around(work, substep, radius).ok_or(last)?;
            let next = gap + larger * (open + change);
            let contraction = drift + larger * change / radius;
            if contraction.is_nan() {
                return Err(None);
            }
            if next <= STRICTLY * radius {
                self.proof.next.fill(next);
                return Ok(contraction);
            }
            if contraction >= LARGEST_CONTRACTION {
                return Err(Some(contraction));
            }
            last = Some(contraction);
            radius = ROOM * next / (1.0 - contraction);
        }
        Err(Some(1.0))
    }

    /// Adds the block's Jacobian at the pose in `work`, times `sign`, to the drift, and notes how
    /// far its rows are open.
    fn note_jacobian(&mut self, work: &Work<'_>, sign: f64) {
        let Self { block, proof, .. } = self;
        let Estimate { drift, gap } = &mut proof.estimate;
        for (local, gap) in gap.iter_mut().enumerate() {
            let value = block.evaluate_row(local, work, |column, value| {
                if let Some(own) = block.own(column) {
                    drift.push((local, own, sign * value));
                }
            });
            let target = &work.system.equations()[block.rows[local]].target;
            *gap = match target {
                Target::Constant(_) => value.value,
                // Its driver is at the end; `bend_around` has it.
                Target::Driver(_) => 0.0,
            };
        }
    }

    /// The largest component of A F(z̄(½)).
    fn gap(&mut self) -> f64 {
        let Proof {
            middle, estimate, ..
        } = &mut *self.proof;
        middle.lu.solve(&mut estimate.gap);
        let gap = estimate.gap.iter();
        gap.fold(0.0, |most, value| most.max(value.abs()))
    }

    /// The largest components of |A| times what rows are open by apart from F in the middle, and
    /// of |A| times what their gradients change by within this radius, times the radius.
    fn bend_around(
        &mut self,
        work: &Work<'_>,
        substep: &mut Substep<'_>,
        radius: f64,
    ) -> Option<[f64; 2]> {
        let Self { block, proof, .. } = self;
        let tubes = &mut *substep.tubes;
        let size = work.at.size();
        let scale = |column: usize| work.system.column_scale(column, size);
        for &column in &block.columns {
            tubes.region[column] = radius * scale(column);
        }
        for (&column, radius) in proof.known.iter().zip(&proof.known_radii) {
            tubes.region[column] = radius * scale(column);
        }
        for local in 0..block.rows.len() {
            let bend = block.bend(local, work, tubes)?;
            let (mut open, mut change) = (proof.slack[local], 0.0);
            if let Target::Driver(driver) = work.system.equations()[block.rows[local]].target {
                open += 0.125 * bend.along + tubes.drivers[driver.index()] * bend.row_scale;
            }
            for (column, value) in bend.changes() {
                let value = value * scale(column);
                if block.own(column).is_some() {
                    change += value * radius;
                } else if let Ok(place) = proof.known.binary_search(&column) {
                    open += value * proof.known_radii[place];
                }
            }
            (proof.open[local], proof.row[local]) = (open, change);
        }
        for &(local, column, value) in &proof.middle.upstream {
            if let Ok(place) = proof.known.binary_search(&column) {
                proof.open[local] += value.abs() * proof.known_radii[place];
            }
        }
        let Proof {
            condition,
            middle,
            open,
            row,
            ..
        } = &mut **proof;
        Some([&*open, &*row].map(|b| MARGIN * condition.largest_row(&mut middle.lu, b)))
    }
}

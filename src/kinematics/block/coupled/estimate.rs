//! What stands in for the certificate of blocks whose inverse is too large to be written down.
//!
//! Here A(s) is the inverse of the Jacobian on the chord itself, so that K holds what the Jacobian
//! changes by within the radii alone, which are of second order in the sub-step. How it changes
//! along the chord only tells how much larger A(s) may be than A = J⁻¹ at the end of the sub-step:
//!
//! > |A(s) x| ≤ |A x| / (1 − c) with c ≥ |A (J(z̄(s)) − J)|, in the largest norm.
//!
//! The links of a long row of loops all turn alike: their changes in A J have signs and cancel,
//! while bounds of them would add up with the square of the row's length. So c is taken from the
//! Jacobian itself where that differs most, at the far end of the chord, and what the chord leaves
//! the rows open by from their values in its middle. One radius r serves all unknowns, and the
//! test is
//!
//! > η + k < (1 − c) r, k ≥ |A| δ(r), η ≥ |A F(z̄(½))| + |A| (all else that is open).
//!
//! Norms are estimated from below and one place stands for the whole way, so what they give is
//! taken larger by [`MARGIN`], and the sub-step is *checked*.

use super::Coupled;
use super::proof::{Estimate, LARGEST_CONTRACTION, MOST_TRIES, Proof, ROOM, STRICTLY};
use crate::kinematics::block::work::{Substep, Work};
use crate::kinematics::linear::{Factors, nan_or_larger};
use crate::kinematics::newton::STALLED;
use crate::kinematics::system::Target;

/// What estimates are taken larger by.
const MARGIN: f64 = 2.0;

/// How the test was passed.
pub(super) struct Passed {
    /// r, and what the test makes of it, both scaled.
    pub(super) radius: f64,
    pub(super) next: f64,
    /// c and the norm of K together.
    pub(super) contraction: f64,
}

impl Coupled {
    /// Looks for a radius that passes the test and leaves it in `next`. Returns c and the norm of
    /// K together. The bodies go from the end of the sub-step, where the block is factorised, to
    /// its middle.
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
        self.lay_chord(work, substep);
        self.stand_on_chord(work, substep, 0.0);
        self.evaluate_rows(work);
        let drift = self.drift();
        let passed = self.test_chord(work, substep, [drift, 0.0], ROOM)?;
        self.proof.next.fill(passed.next);
        Ok(passed.contraction)
    }

    /// The test for the chord in `substep`, to whose middle the bodies go. `drift` is the norm of A
    /// times what the Jacobian differs by at its far end, `astray` how far off the motion that end
    /// may be, scaled; the radius tried first is `room` times what the chord is off.
    ///
    /// # Errors
    ///
    /// It is not passed; with c and the norm of K, if they are known.
    pub(super) fn test_chord(
        &mut self,
        work: &mut Work<'_>,
        substep: &mut Substep<'_>,
        [drift, astray]: [f64; 2],
        room: f64,
    ) -> Result<Passed, Option<f64>> {
        let drift = MARGIN * drift;
        if drift.is_nan() {
            return Err(None);
        }
        if drift >= LARGEST_CONTRACTION {
            return Err(Some(drift));
        }
        self.stand_on_chord(work, substep, 0.5);
        self.evaluate_rows(work);
        let proof = &mut *self.proof;
        for (slack, rounding) in proof.slack.iter_mut().zip(&proof.row) {
            *slack += rounding;
        }
        let larger = 1.0 / (1.0 - drift);
        let gap = larger * MARGIN * (self.farthest() + astray);
        let mut radius = room * gap + f64::EPSILON;
        let mut last = None;
        for _ in 0..MOST_TRIES {
            let [open, change] = self.bend_around(work, substep, radius).ok_or(last)?;
            let next = gap + larger * (open + change);
            let contraction = drift + larger * change / radius;
            if contraction.is_nan() {
                return Err(None);
            }
            if next <= STRICTLY * radius {
                return Ok(Passed {
                    radius,
                    next,
                    contraction,
                });
            }
            if contraction >= LARGEST_CONTRACTION {
                return Err(Some(contraction));
            }
            last = Some(contraction);
            radius = ROOM * next / (1.0 - contraction);
        }
        Err(Some(1.0))
    }

    /// Evaluates the rows at the pose in `work`, leaving alone what is factorised; what rounding
    /// may have left of them goes to `row`.
    pub(super) fn evaluate_rows(&mut self, work: &Work<'_>) {
        let Self { block, proof, .. } = self;
        let Proof {
            middle,
            estimate: Estimate { gap, .. },
            row: rounding,
            ..
        } = &mut **proof;
        block.evaluate(work, middle, |local, value| {
            let target = &work.system.equations()[block.rows[local]].target;
            gap[local] = match target {
                Target::Constant(_) => value.value,
                // Its driver is at the end; `bend_around` has it.
                Target::Driver(_) => 0.0,
            };
            // What it leaves of the rows at both ends of a chord.
            rounding[local] = 2.0 * STALLED * value.rounding;
        });
    }

    /// Moves all unknowns of the rows to a place on the chord in `substep`, from 0 to 1.
    pub(super) fn stand_on_chord(&self, work: &mut Work<'_>, substep: &Substep<'_>, s: f64) {
        for &column in self.block.columns.iter().chain(&self.proof.known) {
            let place = substep.from[column] + s * substep.tubes.chord[column];
            work.at.set_coordinate(column, place);
        }
    }

    /// The norm of A times what the Jacobian differs by where the rows were evaluated last.
    pub(super) fn drift(&mut self) -> f64 {
        let Proof {
            condition,
            middle,
            estimate: Estimate { drift, .. },
            ..
        } = &mut *self.proof;
        drift.clear();
        drift.extend(middle.lu.differences(&self.jacobian.lu));
        condition.largest_row_of_product(&mut self.jacobian.lu, drift)
    }

    /// The largest component of A F, with F where the rows were evaluated.
    pub(super) fn farthest(&mut self) -> f64 {
        let gap = &mut self.proof.estimate.gap;
        self.jacobian.lu.solve(gap);
        gap.iter()
            .fold(0.0, |most, value| nan_or_larger(most, value.abs()))
    }

    /// The largest components of |A| times what rows are open by apart from F in the middle, and
    /// of |A| times what their gradients change by within this radius, times the radius.
    fn bend_around(
        &mut self,
        work: &Work<'_>,
        substep: &mut Substep<'_>,
        radius: f64,
    ) -> Option<[f64; 2]> {
        let Self {
            block,
            proof,
            jacobian,
            ..
        } = self;
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
            open,
            row,
            ..
        } = &mut **proof;
        let lu = &mut jacobian.lu;
        Some([&*open, &*row].map(|b| MARGIN * condition.largest_row(lu, b)))
    }
}

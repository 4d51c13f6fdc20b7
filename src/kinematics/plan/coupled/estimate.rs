//! The estimate that replaces the certificate of a block whose inverse is too large to be written
//! down.
//!
//! The certificate takes A in the middle of the chord; here A(s) is the inverse of the Jacobian at
//! each place s of the chord. K then contains only the change of the Jacobian within the radii,
//! which are of second order in the sub-step. A(s) itself is not computed: A = J⁻¹ at the end of
//! the sub-step bounds it by
//!
//! > |A(s) x| ≤ |A x| / (1 − c) with c ≥ |A (J(z̄(s)) − J)|, in the largest norm.
//!
//! In a long row of loops all links turn alike. The signed changes of A J then cancel, but their
//! bounds would add up with the square of the row's length. Therefore c is computed from the
//! Jacobian at the far end of the chord, where it differs most, and the values of the rows on the
//! chord are taken from the middle of the chord. All unknowns share one radius r. The test is
//!
//! > η + k < (1 − c) r, k ≥ |A| δ(r), η ≥ |A F(z̄(½))| + |A| (all other bounds of the rows).
//!
//! Two things are not bounds: norms are estimated from below, and one place represents the whole
//! chord. The factor [`ALLOWANCE`] allows for both. The sub-step is *checked*, not proved.
//!
//! A function of the file, such as a contour, may have a lobe or a notch between two places, so rows
//! that contain one are bounded over the whole chord. Their values on the chord are at most an eighth of the bound of
//! the second derivative along it. Their gradients differ from those at its end by at most twice
//! the bound of their change around its middle.

use super::CoupledBlock;
use super::contraction::{
    ContractionTest, Estimate, LARGER_RADII, LARGEST_CONTRACTION, MOST_TRIES, STRICTLY,
};
use crate::kinematics::linear::{Factors, nan_or_larger};
use crate::kinematics::plan::step::{BlockState, Step};
use crate::kinematics::system::EquationTarget;
use crate::kinematics::tolerances::STALLED;

/// Factor on estimates in place of a bound.
const ALLOWANCE: f64 = 2.0;

impl CoupledBlock {
    /// Looks for a radius that passes the test and writes it to `next`. Returns the sum of c and
    /// the norm of K.
    ///
    /// Before: the bodies are at the end of the sub-step, where the block is factorised. After:
    /// they are in the middle of the chord.
    ///
    /// # Errors
    ///
    /// The sum of c and the norm of K, if they are known, where no radius passes the test.
    pub(super) fn estimate_radii(
        &mut self,
        state: &mut BlockState<'_>,
        step: &mut Step<'_>,
    ) -> Result<f64, Option<f64>> {
        step.bounds.checked = true;
        self.lay_chord(state, step);
        self.move_to_chord(state, step, 0.0);
        self.evaluate_rows(state);
        let drift = ALLOWANCE * self.drift();
        if drift.is_nan() {
            return Err(None);
        }
        if drift >= LARGEST_CONTRACTION {
            return Err(Some(drift));
        }
        self.move_to_chord(state, step, 0.5);
        self.evaluate_rows(state);
        let test = &mut *self.test;
        for ((slack, rounding), moved) in test.slack.iter_mut().zip(&test.row).zip(&test.moved) {
            *slack += rounding + moved;
        }
        let larger = 1.0 / (1.0 - drift);
        let gap = larger * ALLOWANCE * self.farthest();
        let mut radius = LARGER_RADII * gap + f64::EPSILON;
        let mut last = None;
        for _ in 0..MOST_TRIES {
            let [open, change] = self.bend_around(state, step, radius).ok_or(last)?;
            let next = gap + larger * (open + change);
            let contraction = drift + larger * change / radius;
            if contraction.is_nan() {
                return Err(None);
            }
            if next <= STRICTLY * radius {
                self.test.next.fill(next);
                return Ok(contraction);
            }
            if contraction >= LARGEST_CONTRACTION {
                return Err(Some(contraction));
            }
            last = Some(contraction);
            radius = LARGER_RADII * next / (1.0 - contraction);
        }
        Err(Some(1.0))
    }

    /// Evaluates the rows at the pose in `state` without touching the factors; bounds of their
    /// rounding go to `row`.
    fn evaluate_rows(&mut self, state: &BlockState<'_>) {
        let Self {
            equations, test, ..
        } = self;
        let ContractionTest {
            middle,
            estimate: Estimate { gap, .. },
            row: rounding,
            ..
        } = &mut **test;
        equations.evaluate(state, middle, |local, value| {
            let target = &state.system.equations()[equations.rows[local]].target;
            gap[local] = match target {
                EquationTarget::Constant(_) => value.value,
                // The driver is at its end; `bend_around` adds its chord.
                EquationTarget::Driver(_) => 0.0,
            };
            // The rounding of the rows at both ends of a chord.
            rounding[local] = 2.0 * STALLED * value.rounding;
        });
    }

    /// Returns the norm of A times the change of the Jacobian where the rows were evaluated last.
    fn drift(&mut self) -> f64 {
        let ContractionTest {
            condition,
            middle,
            estimate: Estimate { drift, .. },
            ..
        } = &mut *self.test;
        drift.clear();
        drift.extend(middle.lu.differences(&self.jacobian.lu));
        condition.largest_row_of_product(&mut self.jacobian.lu, drift)
    }

    /// Returns the largest component of A F where the rows were evaluated last.
    fn farthest(&mut self) -> f64 {
        let gap = &mut self.test.estimate.gap;
        self.jacobian.lu.solve(gap);
        gap.iter()
            .fold(0.0, |most, value| nan_or_larger(most, value.abs()))
    }

    /// Returns bounds of |A| times the values of the rows apart from F in the middle, and of |A|
    /// times the change of their gradients within this radius, times the radius.
    fn bend_around(
        &mut self,
        state: &BlockState<'_>,
        step: &mut Step<'_>,
        radius: f64,
    ) -> Option<[f64; 2]> {
        let Self {
            equations,
            test,
            jacobian,
            ..
        } = self;
        let bounds = &mut *step.bounds;
        let size = state.at.size();
        let scale = |column: usize| state.system.column_scale(column, size);
        for &column in &equations.columns {
            bounds.region[column] = radius * scale(column);
        }
        for (&column, radius) in test.known.iter().zip(&test.known_radii) {
            bounds.region[column] = radius * scale(column);
        }
        let around = |column: usize| match test.known.binary_search(&column) {
            Ok(place) => test.known_radii[place] * scale(column),
            Err(_) => radius * scale(column),
        };
        let mut functions = test.estimate.functions.iter().peekable();
        for local in 0..equations.rows.len() {
            let function = functions.next_if(|(row, _)| *row == local);
            let (mut open, mut change) = (test.slack[local], 0.0);
            let bend = match function {
                None => equations.bend(local, state, bounds, false)?,
                Some((_, columns)) => {
                    for &column in columns {
                        bounds.region[column] = around(column) + 0.5 * bounds.chord[column].abs();
                    }
                    let bend = equations.bend(local, state, bounds, false);
                    for &column in columns {
                        bounds.region[column] = around(column);
                    }
                    let bend = bend?;
                    open += 0.125 * bend.along;
                    bend
                }
            };
            let differs = if function.is_some() { 2.0 } else { 1.0 };
            if let EquationTarget::Driver(driver) =
                state.system.equations()[equations.rows[local]].target
            {
                open += 0.125 * bend.along + bounds.drivers[driver.index()] * bend.row_scale;
            }
            for (column, value) in bend.changes() {
                let value = differs * value * scale(column);
                if equations.own(column).is_some() {
                    change += value * radius;
                } else if let Ok(place) = test.known.binary_search(&column) {
                    open += value * test.known_radii[place];
                }
            }
            (test.open[local], test.row[local]) = (open, change);
        }
        for entry in &test.middle.upstream {
            if let Ok(place) = test.known.binary_search(&entry.column) {
                test.open[entry.row] += entry.value.abs() * test.known_radii[place];
            }
        }
        let ContractionTest {
            condition,
            open,
            row,
            ..
        } = &mut **test;
        let lu = &mut jacobian.lu;
        Some([&*open, &*row].map(|b| ALLOWANCE * condition.largest_row(lu, b)))
    }
}

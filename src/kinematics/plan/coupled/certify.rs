//! The certificate of any block; see [`crate::kinematics::certificate`].
//!
//! A is the inverse of the Jacobian in the middle of the chord. Each relation bounds, over the
//! region of the chord and the radii, its second derivative along the chord and the change of its
//! gradient ([`Constraint::bend`]): an eighth of the first is the value that the chord leaves its
//! row, the second makes K. Unknowns of earlier blocks are part of chord and region; their radii
//! open the rows by the gradient in the middle, whose effect on the block's unknowns adds up with
//! its signs, and by the change of the gradient.
//!
//! Rows and unknowns are scaled as for Newton–Raphson. The inverse is written down for blocks of
//! up to [`MOST_TORN`](super::contraction::MOST_TORN) torn unknowns; beyond, an
//! [estimate](super::estimate) takes the place of the proof, and the sub-step is *checked*.
//!
//! While parameters move, rows with their numbers are enclosed as functions of the place on the
//! sub-step ([`ParameterBounds`]): the second derivative along the chord and the gradients around
//! it include all that the numbers do.
//!
//! [`ParameterBounds`]: crate::kinematics::certificate::ParameterBounds
//!
//! [`Constraint::bend`]: crate::kinematics::constraint::Constraint::bend

use super::CoupledBlock;
use super::contraction::{
    ContractionTest, LARGER_RADII, LARGEST_CONTRACTION, MOST_TRIES, STRICTLY,
};
use crate::kinematics::newton::Rejected;
use crate::kinematics::plan::step::{BlockState, Step};
use crate::kinematics::system::EquationTarget;
use crate::kinematics::tolerances::AT_ROUNDING;

/// First trial radii, as a multiple of the square of the largest move of an unknown: a motion that
/// turns by φ deviates from its chord by φ²/8 in radians, and rarely by twenty times that.
const FIRST_RADIUS: f64 = 2.5;
/// Least and largest ratio of the first trial radii to that move.
const FIRST_PART: [f64; 2] = [0.1, 0.2];
/// Second trial radii, as a multiple of η, if the first ones are too large.
const SMALLER_RADIUS: f64 = 2.0;
/// The norm of K that the next sub-step aims at.
const GOOD_CONTRACTION: f64 = 0.6;

impl CoupledBlock {
    /// Stores the residuals and angles at the start of the sub-step and, for a block without an
    /// inverse, the effect of moving parameters on its rows.
    ///
    /// Before: the block was evaluated last at the start of the sub-step, where its own unknowns
    /// still are; upstream unknowns are at the end.
    pub(super) fn note_start(&mut self, state: &mut BlockState<'_>, step: &mut Step<'_>) {
        self.start_excess = self.excess;
        let bodies = 3 * state.system.mechanism().bodies.len();
        for &column in &self.equations.columns {
            if column < bodies && column % 3 == 2 {
                let frame = &state.at.frames()[column / 3];
                let bound = step.bounds.body_mut(column / 3);
                (bound.cos, bound.sin) = (frame.cos, frame.sin);
            }
        }
        let rows = &self.equations.rows;
        let test = &mut *self.test;
        test.slack.fill(0.0);
        test.moves = rows.iter().any(|&row| step.bounds.parameters.moves(row));
        test.moved.fill(0.0);
        if test.moves && test.inverse.is_empty() {
            self.note_moved(state, step);
        }
    }

    /// Stores 2 |c(q at the start) − target| of each row with the parameters at the end of the
    /// sub-step, for rows that have no enclosure.
    #[cold]
    fn note_moved(&mut self, state: &mut BlockState<'_>, step: &mut Step<'_>) {
        self.test.note_ends(state);
        for &column in &self.test.known {
            state.at.set_coordinate(column, step.from[column]);
        }
        let test = &mut *self.test;
        for (moved, &row) in test.moved.iter_mut().zip(&self.equations.rows) {
            let equation = &state.system.equations()[row];
            if step.bounds.parameters.moves(row) {
                // A driver's chord begins at its value at the start.
                let drivers = &step.bounds.parameters.drivers_before;
                let target = state.system.target(row, state.targets, drivers);
                let open = equation.constraint.value(state.at) - target;
                *moved = 2.0 * open.abs() * equation.row_scale(state.at);
            }
        }
        self.test.return_to_ends(state);
    }

    /// Proves that one motion joins the two ends of a sub-step, and writes its chord bounds.
    ///
    /// # Errors
    ///
    /// [`Rejected`] without such a proof.
    pub(super) fn certify(
        &mut self,
        state: &mut BlockState<'_>,
        step: &mut Step<'_>,
    ) -> Result<(), Rejected> {
        self.test.note_ends(state);
        let tried = if self.test.inverse.is_empty() {
            self.estimate_radii(state, step)
        } else {
            self.find_radii(state, step)
        };
        self.test.return_to_ends(state);
        self.clear_region(step);
        // Chord and radii both grow with the sub-step, so K grows about as its square.
        let step_ratio = |contraction: f64| contraction / GOOD_CONTRACTION;
        let contraction = match tried {
            Ok(contraction) => contraction,
            Err(None) => return Err(step.bounds.reject()),
            Err(Some(contraction)) => {
                // Above one in any case.
                let refused = step.bounds.require(step_ratio(contraction).max(1.5));
                debug_assert!(refused.is_err());
                return Err(Rejected);
            }
        };
        self.write_bounds(state, step);
        step.bounds.require(step_ratio(contraction).min(1.0))
    }

    /// Returns the largest sum of a row's residuals at both ends of the sub-step, in multiples of its
    /// rounding error, with the rounding of these residuals themselves.
    pub(super) fn roundings(&self) -> f64 {
        self.start_excess + self.excess + 2.0 * AT_ROUNDING
    }

    /// Clears the region and the chord in the work space.
    fn clear_region(&self, step: &mut Step<'_>) {
        for &column in self.equations.columns.iter().chain(&self.test.known) {
            step.bounds.region[column] = 0.0;
            step.bounds.chord[column] = 0.0;
        }
    }

    /// Writes the chord and the radii of known unknowns, and goes to the middle. Returns the first
    /// trial radius, in radians and lengths of the block.
    pub(super) fn lay_chord(&mut self, state: &mut BlockState<'_>, step: &mut Step<'_>) -> f64 {
        let size = state.at.size();
        let own = |column: usize| state.system.column_scale(column, self.length * size);
        let (mut largest, mut uncertain) = (0.0_f64, 0.0_f64);
        let known = self.test.known.iter().zip(&mut self.test.known_radii);
        for (&column, radius) in known {
            let deviation = step.deviation(column);
            *radius = deviation / state.system.column_scale(column, size);
            uncertain = uncertain.max(deviation / own(column));
        }
        for &column in self.equations.columns.iter().chain(&self.test.known) {
            let end = state.at.coordinate(column);
            let chord = end - step.from[column];
            step.bounds.chord[column] = chord;
            largest = largest.max(chord.abs() / own(column));
        }
        self.move_to_chord(state, step, 0.5);
        let [least, most] = FIRST_PART;
        (FIRST_RADIUS * largest).clamp(least, most) * largest + 2.0 * uncertain + f64::EPSILON
    }

    /// Moves all unknowns of the rows to a place on the chord, from 0 to 1.
    pub(super) fn move_to_chord(&self, state: &mut BlockState<'_>, step: &Step<'_>, s: f64) {
        for &column in self.equations.columns.iter().chain(&self.test.known) {
            let value = step.from[column] + s * step.bounds.chord[column];
            state.at.set_coordinate(column, value);
        }
    }

    /// Looks for radii that pass the test and writes the smallest ones found to `next`. Returns the
    /// norm of K for them.
    ///
    /// # Errors
    ///
    /// The norm of K, if it is known, where no radii pass the test.
    fn find_radii(
        &mut self,
        state: &mut BlockState<'_>,
        step: &mut Step<'_>,
    ) -> Result<f64, Option<f64>> {
        let first = self.lay_chord(state, step);
        let columns = self.equations.columns.iter();
        for (radius, &column) in self.test.radii.iter_mut().zip(columns) {
            // Lengths scale with the block's arms, not with the whole part of the mechanism.
            let is_angle = state.system.is_angle(column);
            *radius = if is_angle { first } else { first * self.length };
        }
        self.factorise_middle(state).map_err(|Rejected| None)?;
        let (mut last, mut shrunk) = (None, false);
        for _ in 0..MOST_TRIES {
            self.bend_rows(state, step).ok_or(last)?;
            self.open_rows();
            let contraction = self.contract(true);
            if contraction.is_nan() {
                return Err(None);
            }
            let test = &mut self.test;
            let pairs = || test.radii.iter().zip(&test.next);
            if pairs().all(|(radius, next)| *next <= STRICTLY * radius) {
                // A map of a box into a smaller one has its root in the smaller one.
                self.contract(false);
                return Ok(contraction);
            }
            if contraction >= LARGEST_CONTRACTION {
                if shrunk {
                    return Err(Some(contraction));
                }
                // Far smaller radii are enough where the motion is nearly straight.
                shrunk = true;
                for (radius, eta) in test.radii.iter_mut().zip(&test.eta) {
                    *radius = radius.min((SMALLER_RADIUS * eta).max(f64::EPSILON * *radius));
                }
                continue;
            }
            last = Some(contraction);
            for (radius, next) in test.radii.iter_mut().zip(&test.next) {
                *radius = radius.max(LARGER_RADII * next / (1.0 - contraction));
            }
        }
        Err(Some(1.0))
    }

    /// Computes A.
    fn factorise_middle(&mut self, state: &BlockState<'_>) -> Result<(), Rejected> {
        let roundings = self.roundings();
        let Self {
            equations, test, ..
        } = self;
        let ContractionTest {
            middle,
            inverse,
            slack,
            row: unit,
            ..
        } = &mut **test;
        equations.evaluate(state, middle, |local, value| {
            slack[local] += roundings * value.rounding;
        });
        middle.lu.factorise(0.0).map_err(|_| Rejected)?;
        middle.invert(inverse, unit);
        Ok(())
    }

    /// Bounds the bend of the rows in the region of the radii around the chord.
    fn bend_rows(&mut self, state: &BlockState<'_>, step: &mut Step<'_>) -> Option<()> {
        let Self {
            equations, test, ..
        } = self;
        let bounds = &mut *step.bounds;
        let size = state.at.size();
        let scale = |column: usize| state.system.column_scale(column, size);
        let own = equations.columns.iter().zip(&test.radii);
        let known = test.known.iter().zip(&test.known_radii);
        for (&column, radius) in own.chain(known) {
            let radius = radius * scale(column);
            bounds.region[column] = radius;
            if test.moves {
                let from = step.from[column];
                let ends = [from, from + bounds.chord[column]];
                bounds.parameters.set_chord(column, ends, radius);
            }
        }
        test.changes.clear();
        for (local, &row) in equations.rows.iter().enumerate() {
            let bend = equations.bend_on_chord(local, state, bounds)?;
            let mut open = 0.125 * bend.along;
            if let EquationTarget::Driver(driver) = state.system.equations()[row].target {
                open += bounds.drivers[driver.index()] * bend.row_scale;
            }
            for (column, value) in bend.changes() {
                let value = value * scale(column);
                if value == 0.0 {
                } else if let Some(own) = equations.own(column) {
                    test.changes.push((local, own, value));
                } else if let Ok(place) = test.known.binary_search(&column) {
                    open += value * test.known_radii[place];
                }
            }
            test.open[local] = open + test.slack[local];
        }
        Some(())
    }

    /// Computes η: |A| times the values of the rows, and the effect of the radii of known unknowns.
    fn open_rows(&mut self) {
        let test = &mut *self.test;
        let order = self.equations.rows.len();
        let mut eta = std::mem::take(&mut test.eta);
        eta.fill(0.0);
        test.apply(&test.open, &mut eta);
        for (&column, radius) in test.known.iter().zip(&test.known_radii) {
            for (eta, a) in eta.iter_mut().zip(test.inverse.chunks_exact(order)) {
                *eta += test.middle.upstream_product(a, column).abs() * radius;
            }
        }
        test.eta = eta;
    }

    /// Writes η + K r to `next`; r are the trial radii if `tried`, otherwise the present `next`.
    /// Returns the norm of K, weighted by the trial radii.
    fn contract(&mut self, tried: bool) -> f64 {
        let test = &mut *self.test;
        let mut row = std::mem::take(&mut test.row);
        row.fill(0.0);
        let radii = if tried { &test.radii } else { &test.next };
        for &(local, column, value) in &test.changes {
            row[local] += value * radii[column];
        }
        let mut next = std::mem::take(&mut test.next);
        next.fill(0.0);
        test.apply(&row, &mut next);
        let mut contraction = 0.0;
        for ((next, eta), radius) in next.iter_mut().zip(&test.eta).zip(&test.radii) {
            let part = *next / radius;
            if part > contraction || part.is_nan() {
                contraction = part;
            }
            *next += eta;
        }
        test.next = next;
        test.row = row;
        contraction
    }

    /// Writes the chord bounds of the block's unknowns. The bodies are at their ends.
    fn write_bounds(&mut self, state: &BlockState<'_>, step: &mut Step<'_>) {
        for ((&column, scale), radius) in self.equations.scaled_columns().zip(&self.test.next) {
            let moved = state.at.coordinate(column) - step.from[column];
            step.bounds.set_unknown(column, moved, radius * scale);
        }
    }
}

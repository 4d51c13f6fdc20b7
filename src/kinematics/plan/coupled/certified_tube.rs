//! One proof for many small steps of a block.
//!
//! In a *certified tube* each unknown of the rows, upstream ones included, differs by no more than
//! its width B from one place, the same for all unknowns, on a line c + s t, |s| ≤ 1, through a
//! pose c. With A = J(c)⁻¹, the changes δ of the gradients in the tube and V = |t| + B, the numbers
//!
//! > h = max |A| δ B / B, g = max |A| δ V / B, m = max (|A ∂F/∂p| B + |A| δ B) / B
//!
//! belong to the tube. Let a chord in it move each unknown by at most λ V. F is zero at both ends
//! of the chord, so that on it F is at most half the change of its gradient: η ≤ λ g B / 2, plus
//! μ m B for upstream radii of μ widths, and K r ≤ λ′ h B for radii of λ′ widths. The test of
//! [`certify`](super::certify) becomes
//!
//! > λ g / 2 + μ m + λ′ h < λ′, and chord and radii lie in the tube.
//!
//! Its radii are of first order in the step, those of `certify` of second order. A step that fails
//! here is tested there, and a step that passes here, no longer than twice the one that the tube
//! was made after, passes there too: the accepted steps do not depend on the tube.
//!
//! Tubes are kept, so that a motion that comes back, or goes on turn by turn, is proved once. Rows
//! contain angles in sines, cosines and contours, or linearly: a gradient does not change when an
//! angle changes by a whole turn, and a tube holds at every such angle.

use std::f64::consts::TAU;

use super::CoupledBlock;
use crate::kinematics::certificate::StepBounds;
use crate::kinematics::plan::anchor::larger;
use crate::kinematics::plan::step::{BlockState, Step};
use crate::kinematics::system::Target;

/// Largest norm of K of a single step after which a tube is made: it then serves several steps.
const WORTH_A_TUBE: f64 = 0.05;
/// Norm of K of a single step times the steps that a tube is tried for, and the h that one is made
/// for.
const FIRST_CONTRACTION: f64 = 0.1;
const GOOD_CONTRACTION: f64 = 0.2;
/// Largest h of a tube.
const LARGEST_CONTRACTION: f64 = 0.4;
/// Largest radius of a step as long as the one that the tube was made after, in widths.
const LARGEST_RADIUS: f64 = 0.5;
/// Largest move along half of a tube, in radians and lengths of the block.
const LARGEST_MOVE: f64 = 0.2;
/// Ratios of the least widths to that move, of a block's own unknowns and of upstream ones. The
/// move counts as at least the third number: a block at rest has a tube too.
const LEAST_WIDTH: f64 = 0.04;
const LEAST_UPSTREAM_WIDTH: f64 = 0.02;
const LEAST_MOVE: f64 = 1e-3;
/// Ratio of the width of an upstream unknown to its largest radius in a tube of its own block.
const UPSTREAM_ROOM: f64 = 1.2;
/// Weight of an upstream unknown's move in the choice of the one that measures the place on the
/// line: upstream ones run more evenly.
const UPSTREAM_LEADS: f64 = 10.0;
/// Most steps that half of a tube is made for.
const MOST_STEPS: f64 = 1e4;
/// Ratio of a width to the deviation of the motion from the line.
const ROOM: f64 = 2.0;
/// Length of a step that a tube may serve, in steps like the one that it was made after.
const LONGEST_STEP: f64 = 2.0;
/// Most tubes that a block keeps, and most unknowns of all of them: a turn of a cam takes about a
/// hundred.
const MOST_KEPT: usize = 128;
const MOST_UNKNOWNS: usize = 2048;

/// The tubes that a block keeps.
#[derive(Debug)]
pub(super) struct CertifiedTubes {
    /// In the order in which they were made, from `next` on.
    kept: Box<[CertifiedTube]>,
    /// Number of places in which a tube was made, from the first one on.
    used: usize,
    /// The tube that served last.
    last: usize,
    /// The place of the next one.
    next: usize,
}

/// A tube along a line in which a block is proved regular.
#[derive(Clone, Debug, Default)]
struct CertifiedTube {
    holds: bool,
    /// c, t, 1/B and 1/V of the block's own unknowns, then of the upstream ones.
    unknowns: Vec<Reach>,
    /// The unknown that measures the place on the line.
    leading: usize,
    /// h.
    contraction: f64,
    /// g.
    opening: f64,
    /// m.
    upstream: f64,
    /// Increase of λ′ per unit of a driver's deviation from its chord.
    driver: f64,
    /// Increase of λ′ per rounding of the rows.
    rounding: f64,
    /// Largest λ.
    longest: f64,
}

/// Reach of one unknown in a tube.
#[derive(Clone, Copy, Debug, Default)]
struct Reach {
    /// c where the tube was made.
    origin: f64,
    /// c where the motion was last, whole turns away.
    centre: f64,
    way: f64,
    inverse_width: f64,
    inverse_move: f64,
}

impl CertifiedTubes {
    /// Makes the storage for this number of unknowns, own and upstream.
    pub(super) fn new(unknowns: usize) -> Self {
        let tube = CertifiedTube {
            unknowns: vec![Reach::default(); unknowns],
            ..CertifiedTube::default()
        };
        let count = (MOST_UNKNOWNS / unknowns.max(1)).clamp(1, MOST_KEPT);
        Self {
            kept: vec![tube; count].into(),
            used: 0,
            last: 0,
            next: 0,
        }
    }

    /// Forgets all tubes.
    pub(super) fn forget(&mut self) {
        for tube in &mut self.kept[..self.used] {
            tube.holds = false;
        }
        (self.used, self.last, self.next) = (0, 0, 0);
    }

    /// Returns the number of tubes.
    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.kept.iter().filter(|tube| tube.holds).count()
    }

    /// Returns the place of the tube to be made next.
    #[cfg(test)]
    pub(super) fn next_place(&self) -> usize {
        self.next
    }

    /// Returns the tube to be made next, in the place of the oldest one.
    fn next(&mut self) -> &mut CertifiedTube {
        &mut self.kept[self.next]
    }

    /// Keeps the tube that was made.
    fn keep_next(&mut self) {
        self.kept[self.next].holds = true;
        self.last = self.next;
        self.used = self.used.max(self.next + 1);
        self.next = (self.next + 1) % self.kept.len();
    }

    /// Returns the places of the other tubes, those made shortly after or before the last one first.
    fn others(&self) -> impl Iterator<Item = usize> + use<> {
        let (last, count) = (self.last, self.used);
        (1..count).map(move |k| {
            let apart = k.div_ceil(2);
            let apart = if k % 2 == 1 { apart } else { count - apart };
            let place = last + apart;
            if place < count { place } else { place - count }
        })
    }
}

impl CertifiedTube {
    /// Returns the place on the line for a value of the leading unknown. A block at rest has a line
    /// of length zero.
    fn place(&self, leading: f64) -> f64 {
        let Reach { centre, way, .. } = self.unknowns[self.leading];
        if way == 0.0 {
            0.0
        } else {
            (leading - centre) / way
        }
    }
}

/// Returns the whole turns from one angle to another \[rad\].
fn whole_turns(from: f64, to: f64) -> f64 {
    let turns = (to - from) / TAU;
    // Rounded to the nearest.
    (turns + 0.5_f64.copysign(turns)) as i64 as f64 * TAU
}

impl CoupledBlock {
    /// Returns the unknown with this place in a tube.
    fn tube_column(&self, place: usize) -> usize {
        let own = &self.equations.columns;
        own.get(place)
            .copied()
            .unwrap_or_else(|| self.test.known[place - own.len()])
    }

    /// Proves by one of the tubes that one motion joins the two ends of a sub-step, and writes its
    /// bound to `next`. Returns false without a proof.
    pub(super) fn certify_in_tubes(&mut self, state: &BlockState<'_>, step: &mut Step<'_>) -> bool {
        self.certify_in_tube(self.tubes.last, state, step)
            || self.tubes.others().any(|tube| {
                self.reaches(tube, state, step) && self.certify_in_tube(tube, state, step)
            })
    }

    /// Returns whether the leading unknown passes through a tube, which is turned to where the
    /// sub-step starts.
    fn reaches(&mut self, tube: usize, state: &BlockState<'_>, step: &Step<'_>) -> bool {
        let CertifiedTube { holds, leading, .. } = self.tubes.kept[tube];
        let leading = self.tube_column(leading);
        if !holds {
            return false;
        }
        let columns = self.equations.columns.iter().chain(&self.test.known);
        let tube = &mut self.tubes.kept[tube];
        let reach = &tube.unknowns[tube.leading];
        let turns = if state.system.is_angle(leading) {
            whole_turns(reach.centre, step.from[leading])
        } else {
            0.0
        };
        let inside = |end: f64| tube.place(end - turns).abs() <= 1.0;
        if !inside(step.from[leading]) || !inside(state.at.coordinate(leading)) {
            return false;
        }
        for (reach, &column) in tube.unknowns.iter_mut().zip(columns) {
            if state.system.is_angle(column) {
                reach.centre = reach.origin + whole_turns(reach.origin, step.from[column]);
            }
        }
        true
    }

    /// Proves by a tube that one motion joins the two ends of a sub-step, and writes its bound to
    /// `next`. Returns false without a proof.
    fn certify_in_tube(
        &mut self,
        index: usize,
        state: &BlockState<'_>,
        step: &mut Step<'_>,
    ) -> bool {
        let leading = self.tube_column(self.tubes.kept[index].leading);
        let roundings = self.roundings();
        let Self {
            equations,
            test,
            tubes,
            ..
        } = self;
        let tube = &tubes.kept[index];
        if !tube.holds {
            return false;
        }
        let columns = &equations.columns;
        let from = tube.place(step.from[leading]);
        let to = tube.place(state.at.coordinate(leading));
        let (mut moved, mut far, mut uncertain) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (&column, reach) in columns.iter().chain(&test.known).zip(&tube.unknowns) {
            let ends = [step.from[column], state.at.coordinate(column)];
            moved = larger(moved, (ends[1] - ends[0]).abs() * reach.inverse_move);
            let off = |end: f64, s: f64| (end - (reach.centre + s * reach.way)).abs();
            let farther = larger(off(ends[0], from), off(ends[1], to));
            far = larger(far, farther * reach.inverse_width);
        }
        for (&column, reach) in test.known.iter().zip(&tube.unknowns[columns.len()..]) {
            uncertain = larger(uncertain, step.deviation(column) * reach.inverse_width);
        }
        let mut driven = 0.0_f64;
        for &driver in &test.drivers {
            driven = driven.max(step.bounds.drivers[driver]);
        }
        let open = 0.5 * moved * tube.opening
            + uncertain * tube.upstream
            + driven * tube.driver
            + roundings * tube.rounding;
        // The test asks for a strict inequality.
        let radius = 1.001 * open / (1.0 - tube.contraction);
        let inside = from.abs() <= 1.0 && to.abs() <= 1.0 && moved <= tube.longest;
        if !inside || far + radius.max(uncertain) > 1.0 || (far + radius).is_nan() {
            return false;
        }
        let scales = &equations.column_scales;
        for ((next, scale), reach) in test.next.iter_mut().zip(scales).zip(&tube.unknowns) {
            *next = radius / (reach.inverse_width * scale);
        }
        tubes.last = index;
        step.bounds.reused = true;
        true
    }

    /// Makes a tube around the motion ahead of a sub-step that was certified with this norm of K, if
    /// it will serve several steps. The block is factorised at the end of the sub-step.
    pub(super) fn make_tube(
        &mut self,
        state: &BlockState<'_>,
        step: &mut Step<'_>,
        contraction: f64,
    ) {
        if contraction > WORTH_A_TUBE {
            return;
        }
        self.tubes.next().holds = false;
        let length = self.length * state.at.size();
        let all = || self.equations.columns.iter().chain(&self.test.known);
        let own = self.equations.columns.len();
        let (mut largest, mut leading) = (f64::EPSILON, (0.0, 0));
        for (place, &column) in all().enumerate() {
            let moved = (state.at.coordinate(column) - step.from[column]).abs();
            let moved = moved / state.system.column_scale(column, length);
            largest = largest.max(moved);
            let leads = if place < own {
                moved
            } else {
                UPSTREAM_LEADS * moved
            };
            if leads > leading.0 {
                leading = (leads, place);
            }
        }
        let test = &mut *self.test;
        self.jacobian.invert(&mut test.inverse, &mut test.row);
        let furthest = (LARGEST_MOVE / largest).min(MOST_STEPS);
        let mut steps = (FIRST_CONTRACTION / contraction).min(furthest);
        for _ in 0..3 {
            // Discard a tube of less than one step.
            if steps < 1.0 || !self.measure_tube(state, step, largest, steps) {
                return;
            }
            let tube = self.tubes.next();
            let radius = 0.5 * tube.opening / (steps * (1.0 - tube.contraction));
            if tube.contraction <= LARGEST_CONTRACTION && radius <= LARGEST_RADIUS {
                tube.longest = LONGEST_STEP / steps;
                tube.leading = leading.1;
                for (&column, reach) in self.equations.columns.iter().zip(&tube.unknowns) {
                    step.bounds.tube_radii[column] = radius / reach.inverse_width;
                }
                self.tubes.keep_next();
                return;
            }
            let excess = tube.contraction / GOOD_CONTRACTION;
            steps /= excess.max(radius / LARGEST_RADIUS).max(1.5);
        }
    }

    /// Computes the numbers of a tube that reaches this number of steps ahead, in which the
    /// unknowns move by at most `largest` per step. Returns false if a relation is not smooth in
    /// it.
    fn measure_tube(
        &mut self,
        state: &BlockState<'_>,
        step: &mut Step<'_>,
        largest: f64,
        steps: f64,
    ) -> bool {
        let length = self.length * state.at.size();
        let all = self.equations.columns.iter().chain(&self.test.known);
        let Step {
            extrapolation,
            from,
            ..
        } = *step;
        let bounds = &mut *step.bounds;
        let own = self.equations.columns.len();
        let unknowns = self.tubes.next().unknowns.iter_mut();
        for (place, (reach, &column)) in unknowns.zip(all).enumerate() {
            let end = state.at.coordinate(column);
            // The change from one step to the next.
            let second = 2.0 * extrapolation.second * state.tangent.acceleration()[column];
            let way = steps * (end - from[column]) + 0.5 * steps * (steps + 1.0) * second;
            let off = ROOM * 0.125 * steps * steps * second.abs();
            let scale = state.system.column_scale(column, length);
            let (least, uncertain) = if place < own {
                // A step has room for radii of first order.
                (LEAST_WIDTH.max(1.0 / steps), 0.0)
            } else {
                (LEAST_UPSTREAM_WIDTH, bounds.tube_radii[column])
            };
            let least = least * (steps * largest).max(LEAST_MOVE) * scale;
            let width = off + UPSTREAM_ROOM * uncertain + least;
            bounds.region[column] = width;
            bounds.chord[column] = 2.0 * way;
            *reach = Reach {
                origin: end,
                centre: end,
                way,
                inverse_width: 1.0 / width,
                inverse_move: 1.0 / (way.abs() + width),
            };
        }
        let smooth = self.bend_rows_in_tube(state, bounds);
        if smooth {
            self.gather_rows(state, bounds);
        }
        self.clear_region(step);
        self.test.slack.fill(0.0);
        smooth
    }

    /// Writes for each row: δ B to `open`, its upstream part to `slack`, δ V to `row`, the rounding
    /// to `eta`, and the row scale of a driver's row to `radii`. Returns false if a relation is not
    /// smooth in the tube.
    fn bend_rows_in_tube(&mut self, state: &BlockState<'_>, bounds: &StepBounds) -> bool {
        let Self {
            equations, test, ..
        } = self;
        for (local, &row) in equations.rows.iter().enumerate() {
            let Some(bend) = equations.bend(local, state, bounds, true) else {
                return false;
            };
            let (mut own, mut known, mut moved) = (0.0, 0.0, 0.0);
            for (column, value) in bend.changes() {
                let width = value * bounds.region[column];
                moved += width + 0.5 * value * bounds.chord[column].abs();
                if equations.own(column).is_some() {
                    own += width;
                } else {
                    known += width;
                }
            }
            test.open[local] = own + known;
            test.slack[local] = known;
            test.row[local] = moved;
            let rounding = state
                .system
                .evaluate_row(row, state.values(), |_, _| {})
                .rounding;
            test.eta[local] = rounding;
            test.radii[local] = match state.system.equations()[row].target {
                Target::Driver(_) => bend.row_scale,
                Target::Constant(_) => 0.0,
            };
        }
        true
    }

    /// Computes the numbers of the tube from those of the rows.
    fn gather_rows(&mut self, state: &BlockState<'_>, bounds: &StepBounds) {
        let Self {
            equations,
            jacobian,
            test,
            tubes,
            ..
        } = self;
        let tube = tubes.next();
        let size = state.at.size();
        let scaled =
            |column: usize| bounds.region[column] / state.system.column_scale(column, size);
        (tube.contraction, tube.opening, tube.upstream) = (0.0, 0.0, 0.0);
        (tube.driver, tube.rounding) = (0.0, 0.0);
        let rows = test.inverse.chunks_exact(equations.rows.len());
        for (row, &column) in rows.zip(&equations.columns) {
            let apply = |b: &[f64]| row.iter().zip(b).map(|(a, b)| a.abs() * b).sum::<f64>();
            let width = scaled(column);
            let mut known = apply(&test.slack);
            for &column in &test.known {
                known += jacobian.upstream_product(row, column).abs() * scaled(column);
            }
            tube.contraction = tube.contraction.max(apply(&test.open) / width);
            tube.opening = tube.opening.max(apply(&test.row) / width);
            tube.upstream = tube.upstream.max(known / width);
            tube.rounding = tube.rounding.max(apply(&test.eta) / width);
            tube.driver = tube.driver.max(apply(&test.radii) / width);
        }
    }
}

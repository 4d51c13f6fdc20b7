//! The proof that no gap closes and opens again between the ends of a step.
//!
//! The accepted step is tracked once more: prescribed motions as they are, other drivers and freedoms on
//! polynomials through both ends. Over each certified sub-step the certificate bounds the deviation of a
//! gap from the straight line between its ends, so that narrow lobes of a cam and fast motions count
//! wherever the stages of the step are. Where the gap may be closed the sub-step is shortened, down to a
//! place at which the step has to end.
//!
//! The bound of a gap between bodies that move together is that of the motion of both, and not zero. So a
//! gap counts as open down to [`DEPTH`]: it is the [stages](super::stages) that tell apart what is touched
//! from what is not.

use super::function::FUNCTIONS;
use super::passive::{Passive, PassiveForces, TOUCHED};
use super::stages::Stages;
use crate::kinematics::{PathWatch, Solver, SubStep};
use crate::mechanism::CoordinateKind;

/// Shortest sub-step, as a part of the step: beside a limit a shorter step of the integrator is cheaper
/// than ever shorter sub-steps. Halved, a motion that comes close to a limit ends steps half as often.
const SHORTEST: f64 = 1.0 / 256.0;
/// Depth to which a gap may be closed between stages, in gaps that are rounding: 1e-8 radians or sizes of
/// the mechanism. Halved, steps beside a contact that is left slowly are shorter by a third. Doubled, lobes
/// twice as high may pass unseen between the stages of a step.
const DEPTH: f64 = 1e6;

/// A gap over a step.
#[derive(Clone, Copy, Debug)]
struct Gap {
    /// Index of the passive force.
    force: usize,
    /// 1 if it grows with its coordinate, −1 if it falls.
    sign: f64,
    /// The gap at the pose, less that of the relation.
    offset: f64,
    /// The gap at the pose.
    here: f64,
    /// Depth to which it may be closed.
    depth: f64,
}

/// The watch over all gaps along a step.
#[derive(Debug, Default)]
pub(super) struct Gaps {
    list: Vec<Gap>,
    most: f64,
    /// The place at which the step must end, as a part of it.
    pub(super) end: Option<f64>,
}

impl Gaps {
    /// Lists the gaps of a step between two times and points, at whose start the solver is. What stays
    /// touched all the time is held by others.
    pub(super) fn begin(
        &mut self,
        forces: &PassiveForces,
        solver: &Solver,
        stages: &Stages,
        (times, [from, to]): ([f64; 2], [&[Passive]; 2]),
    ) {
        (self.most, self.end) = (f64::INFINITY, None);
        self.list.clear();
        for (force, at) in from.iter().enumerate() {
            for side in 0..FUNCTIONS {
                let function = |at: &[Passive]| forces.function(force, &at[force], side);
                let gap = |at: &[Passive]| function(at).map(|function| function.value);
                let Some((here, sign)) = function(from).and_then(|f| Some((f.value, f.gap?)))
                else {
                    continue;
                };
                let touched = TOUCHED * at.gap_rounding();
                let is_touched = |gap: f64| gap.abs() <= touched;
                if is_touched(here)
                    && gap(to).is_some_and(is_touched)
                    && stages.tell_closed(times, touched, gap)
                {
                    continue;
                }
                self.list.push(Gap {
                    force,
                    sign,
                    offset: here - sign * solver.place(&*forces.list[force].relation),
                    here,
                    depth: DEPTH * at.gap_rounding(),
                });
            }
        }
    }
}

/// Gaps of the passive forces along a path.
pub(super) struct GapWatch<'a> {
    pub(super) forces: &'a PassiveForces,
    pub(super) gaps: &'a mut Gaps,
}

impl PathWatch for GapWatch<'_> {
    fn most(&self) -> f64 {
        self.gaps.most
    }

    fn admits(&mut self, sub_step: &mut SubStep<'_>) -> bool {
        let Self { forces, gaps } = self;
        let [start, end] = sub_step.part;
        let length = end - start;
        if gaps.end.is_some() {
            // The rest of the path is no part of the motion.
            return true;
        }
        for index in 0..gaps.list.len() {
            let gap = gaps.list[index];
            let own = &forces.list[gap.force];
            let is_distance = own.coordinate.kind == CoordinateKind::Distance;
            let coordinate = is_distance.then_some(&own.coordinate);
            let ahead = gap.sign * sub_step.value(&*own.relation) + gap.offset;
            let sagitta = sub_step.deviation(&*own.relation, &own.columns, coordinate);
            if least([gap.here, ahead], sagitta) >= -gap.depth {
                continue;
            }
            if length > SHORTEST {
                gaps.most = start + 0.5 * length;
                return false;
            }
            let part = if ahead < -gap.depth && gap.here > 0.0 {
                gap.here / (gap.here - ahead)
            } else {
                0.5
            };
            (gaps.most, gaps.end) = (f64::INFINITY, Some(start + part * length));
            return true;
        }
        for gap in &mut gaps.list {
            let relation = &*forces.list[gap.force].relation;
            gap.here = gap.sign * sub_step.value(relation) + gap.offset;
        }
        gaps.most = if gaps.most.is_finite() {
            end + 2.0 * length
        } else {
            f64::INFINITY
        };
        true
    }
}

/// Returns the least value of a gap with these values at the ends of a sub-step, which at a part σ of it
/// deviates from the straight line between them by at most 4 σ (1 − σ) of a sagitta.
fn least([before, after]: [f64; 2], sagitta: f64) -> f64 {
    let rise = after - before;
    let lowest = 0.5 - rise / (8.0 * sagitta);
    if 0.0 < lowest && lowest < 1.0 {
        before + lowest * rise - 4.0 * lowest * (1.0 - lowest) * sagitta
    } else {
        before.min(after)
    }
}

#[cfg(test)]
mod tests {
    use super::least;

    /// The least value is that of a dense scan of the parabola.
    #[test]
    fn the_least_gap_is_that_of_a_scan() {
        for (ends, sagitta) in [
            ([1.0, 2.0], 0.1),
            ([1.0, 2.0], 0.5),
            ([0.0, 1.0], 0.25),
            ([0.0, 1.0], 0.3),
            ([0.4, 0.3], 2.0),
            ([0.4, 0.3], 0.0),
        ] {
            let at = |s: f64| ends[0] + s * (ends[1] - ends[0]) - 4.0 * s * (1.0 - s) * sagitta;
            let scan = (0..=10_000).map(|k| at(f64::from(k) / 10_000.0));
            let scan = scan.fold(f64::INFINITY, f64::min);
            let found = least(ends, sagitta);
            assert!(found <= scan && scan - found < 1e-7, "{found} {scan}");
        }
    }
}

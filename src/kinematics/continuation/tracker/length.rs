//! The length of the next sub-step, and where it ends.

use std::sync::Arc;

use super::Run;
use crate::kinematics::singular::CROSSING_END;
use crate::kinematics::tolerances::SMALLEST_SUBSTEP;
use crate::mechanism::DriverId;

/// Least ratio of a sub-step to the rejected one before it: the ratio that the certificate of a
/// much too long sub-step suggests is not reliable.
const LEAST_RATIO: f64 = 0.1;
/// Ratio of a sub-step to the rejected one before it if the certificate suggests none.
pub(super) const HALF: f64 = 0.5;
/// Largest ratio of a sub-step to the accepted one before it.
const LARGEST_RATIO: f64 = 4.0;
/// Safety factor on the length that the certificate of another sub-step suggests.
const SAFETY: f64 = 0.85;
/// [`SMALLEST_SUBSTEP`] of the first sub-step, which may lead away from a dead point, from as near as
/// the motion came to it. The motion slows down there as it has come on.
const SMALLEST_FIRST_SUBSTEP: f64 = 1e-15;
/// Minimum sub-step of a search that gives up early: a pose that needs shorter ones is next to a
/// singular position.
const SMALLEST_WITHOUT_SEARCH: f64 = 1e-4;

/// The end of a sub-step.
#[derive(Clone, Copy)]
pub(super) struct Goal {
    pub(super) s: f64,
    /// Whether the path alone, not the length of the sub-step, decides it.
    pub(super) cut_short: bool,
}

impl Run<'_> {
    /// Returns the smallest length of the next sub-step.
    #[inline]
    pub(super) fn smallest(&self) -> f64 {
        if self.gives_up {
            SMALLEST_WITHOUT_SEARCH
        } else {
            (0.01 * self.s).clamp(SMALLEST_FIRST_SUBSTEP, SMALLEST_SUBSTEP)
        }
    }

    /// Returns the end of the next sub-step, no further than `most`.
    pub(super) fn goal(&mut self, most: f64) -> Goal {
        let start = self.s;
        let mut goal = if start + self.length < most {
            Goal {
                s: start + self.length,
                cut_short: false,
            }
        } else {
            Goal {
                s: most,
                cut_short: true,
            }
        };
        if let Some(limit) = self.limit {
            let end = self.end_within(limit.driver, limit.way, goal.s);
            goal.cut_short &= end >= goal.s;
            goal.s = end;
        }
        if !self.state.pose.crossings.is_empty() {
            let end = self.end_within_crossings(goal.s);
            goal.cut_short |= end < goal.s;
            goal.s = end;
        }
        goal
    }

    /// Returns the ratio of the next sub-step to the rejected one, if the certificate gives one.
    pub(super) fn ratio_to_rejected(&self) -> Option<f64> {
        let ratio = self.bounds.step_ratio();
        let is_known = ratio.is_finite() && ratio > 1.0;
        is_known.then(|| (SAFETY / ratio.sqrt()).max(LEAST_RATIO))
    }

    /// Returns the length to try after a sub-step of length `h` was accepted. After a rejection
    /// without a ratio it is no longer than `h`: the certificate of the accepted sub-step says
    /// nothing of the obstacle behind its end.
    pub(super) fn lengthened(&mut self, h: f64) -> f64 {
        let largest = if std::mem::take(&mut self.is_halved) {
            1.0
        } else {
            LARGEST_RATIO
        };
        h * (SAFETY / self.bounds.step_ratio().sqrt()).min(largest)
    }

    /// Returns an end of the sub-step, no further than `end`, up to which a driver moves by `most`
    /// or less.
    fn end_within(&self, driver: DriverId, most: f64, mut end: f64) -> f64 {
        let from = self.drivers.here[driver.index()];
        let way = |h: f64| h * (from.first().abs() + 0.5 * h * from.second().abs());
        while way(end - self.s) > most {
            end = self.s + 0.5 * (end - self.s);
        }
        end
    }

    /// Returns the place where a sub-step to `end` first leaves a crossing; `end` if it leaves
    /// none.
    fn end_within_crossings(&mut self, mut end: f64) -> f64 {
        for index in 0..self.state.pose.crossings.len() {
            let crossing = Arc::clone(&self.state.pose.crossings[index]);
            let driver = crossing.driver.index();
            // No further than from one end of the crossing to the other.
            end = self.end_within(crossing.driver, 2.0 * crossing.half_width, end);
            let (mut inside, mut outside) = (self.s, end);
            let mut place = |s: f64| {
                self.evaluate_drivers(s);
                crossing.place(self.drivers.ahead[driver].value).abs()
            };
            if place(end) <= 1.0 {
                continue;
            }
            // Bisection ends at the end of the crossing.
            for _ in 0..100 {
                let middle = 0.5 * (inside + outside);
                let there = place(middle);
                if there <= 1.0 {
                    inside = middle;
                } else {
                    outside = middle;
                }
                if (1.0 - 0.5 * CROSSING_END..=1.0).contains(&there) {
                    break;
                }
            }
            end = inside;
        }
        end
    }
}

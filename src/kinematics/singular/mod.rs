//! Singular positions: dead points, change points, and what is refused.
//!
//! Where the Jacobian of a block of equations loses rank, Newton–Raphson neither converges nor
//! knows where the motion goes on. [`reduced`] makes of the block's equations one function of two
//! numbers that is smooth there, [`locate`] finds in it the singular position to rounding and
//! tells its kind, [`interpolate`] carries the motion through where two motions cross: on the smooth
//! continuation, so that what was parallel stays parallel.
//!
//! A crossing belongs to the pose: while the driver's value is within its ends, the block's
//! unknowns and their rates come from it. Blocks that several drivers move, and those with more
//! than [`LARGEST_BLOCK`] unknowns, are not crossed; nor is anything while parameters move, or
//! where redundant rows are set aside.

mod approach;
mod interpolate;
mod locate;
mod reduced;

use std::fmt;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

pub use approach::Approach;
pub use locate::SingularKind;

use super::block::{Crossing, Interpolated, Kernel, SEAM};
use super::error::in_line;
use super::newton::MAX_ITERATIONS;
use super::path::Path;
use super::solver::{Pose, Solver};
use crate::mechanism::DriverId;
use interpolate::{crossing_of, replace};
use locate::{Finding, ROUNDING, find};
use reduced::{Ground, Line, Reduced};

/// The most unknowns of a block whose singular positions are looked for, by dense matrices.
pub const LARGEST_BLOCK: usize = 120;

/// The regularity below which a singular position may be near.
pub(super) const NEAR: f64 = 0.05;
/// How far it is looked for, in radians and characteristic lengths of the fastest unknown.
const REACH: f64 = 0.25;
/// What stops the motion is looked for further: near a dead point everything runs fast.
const REACH_TO_END: f64 = 0.5;
/// A motion that would meet what it cannot pass within this way is stopped.
const STOPPED: f64 = 0.02;
/// Entries of a null vector above this part of its largest are what is free to move.
const FREE: f64 = 1e-3;
/// A singular position so little before the place on the path where the mechanism stands is the
/// one that it has come to.
const JUST_BEYOND: f64 = 1e-9;
/// Kernels whose regularities differ by less are near to singular for one and the same reason.
const SAME_ORDER: f64 = 100.0;
/// The part of the largest singular value below which those count as lost in front of a singular
/// position, to which the mechanism has come within some 1e-12 of its way.
const LOST: f64 = 1e-4;
/// How far q may be off a crossing that it is on.
const ON: f64 = 1e-9;
/// The part of a crossing next to its end that counts as the end.
const END: f64 = 1e-6;

/// A singular position on the way of a motion, located to rounding.
#[derive(Clone, Debug, PartialEq)]
pub struct SingularPoint {
    /// What it is.
    pub kind: SingularKind,
    /// Where on the path it is; beyond one if the path ends before it.
    pub s: f64,
    /// The values of all drivers there: the limit \[m or rad\].
    pub drivers: Vec<f64>,
    /// q there, as far as the block and what it reads determine it.
    pub q: Vec<f64>,
    /// The null vector of the Jacobian there over all of q, zero outside of the block, scaled so
    /// that metres and radians compare and the largest entry is one: the motion that is free, or
    /// infinitely fast.
    pub free: Vec<f64>,
    /// The bodies that line up: those that the null vector moves.
    pub bodies: Vec<String>,
}

/// How far the next sub-step may take a driver, as something is ahead that cannot be passed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Careful {
    driver: DriverId,
    /// \[m or rad\]
    way: f64,
    /// Whether it is so near that the motion stops here.
    at_once: bool,
}

impl fmt::Display for SingularPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, where {}", self.kind, in_line(&self.bodies, ""))
    }
}

impl Solver {
    /// The change points that the last call of [`follow`](Self::follow) passed, in order.
    #[must_use]
    pub fn crossed(&self) -> &[Arc<Crossing>] {
        &self.crossed
    }

    /// The bodies that line up at a change point of this mechanism.
    #[must_use]
    pub fn bodies_in_line(&self, crossing: &Crossing) -> Vec<String> {
        let columns = self.plan.kernels[crossing.kernel].columns();
        self.bodies_of(columns, &crossing.free)
    }

    /// What a user is told of a change point that was passed.
    #[must_use]
    pub fn describe_crossing(&self, crossing: &Crossing) -> String {
        let driver = &self.mechanism().drivers[crossing.driver.index()];
        format!(
            "change point passed on the smooth motion, with driver `{}` at {}: {} there",
            driver.name,
            driver.coordinate.kind.show(crossing.center),
            in_line(&self.bodies_in_line(crossing), "")
        )
    }

    /// Whether the crossings of a pose are ones that this mechanism could have come to, and q
    /// lies on them: a pose may have been read from outside.
    #[must_use]
    pub fn admits_crossings(&self, pose: &Pose) -> bool {
        let mut kernels: Vec<_> = pose.crossings.iter().map(|c| c.kernel).collect();
        kernels.sort_unstable();
        kernels.dedup();
        kernels.len() == pose.crossings.len()
            && pose.crossings.iter().all(|crossing| {
                let Some(kernel) = self.plan.kernels.get(crossing.kernel) else {
                    return false;
                };
                let columns = kernel.columns();
                let Some(driver) = self.only_driver(crossing.kernel) else {
                    return false;
                };
                let value = pose.drivers[driver.index()];
                crossing.driver == driver
                    && crossing.half_width > 0.0
                    && crossing.place(value).abs() <= SEAM
                    && crossing.coefficients.len() == columns.len()
                    && crossing.free.len() == columns.len()
                    && columns.iter().enumerate().all(|(local, &column)| {
                        let [there, ..] = crossing.evaluate(local, value);
                        (there - pose.q[column]).abs() <= ON * (1.0 + there.abs())
                    })
            })
    }

    fn bodies_of(&self, columns: &[usize], free: &[f64]) -> Vec<String> {
        let mut moved: Vec<_> = columns
            .iter()
            .zip(free)
            .filter(|(_, free)| free.abs() > FREE)
            .map(|(&column, _)| (column / 3, column))
            .collect();
        moved.sort_unstable();
        let mut names: Vec<_> = moved
            .into_iter()
            .map(|(_, column)| self.system.describe_unknown(column))
            .collect();
        names.dedup();
        names
    }

    /// The kernels near a singular position, where all of them are factorised.
    fn near_singular(&self) -> Vec<usize> {
        let kernels = self.plan.kernels.iter().enumerate();
        kernels
            .filter(|(_, kernel)| {
                kernel.regularity() < NEAR && kernel.columns().len() <= LARGEST_BLOCK
            })
            .map(|(index, _)| index)
            .collect()
    }

    /// The reduced equation of a kernel from the pose, which is at `start` of the line.
    fn reduced<'a>(&'a mut self, kernel: usize, line: Line<'a>, start: f64) -> Option<Reduced<'a>> {
        let ground = Ground {
            system: &self.system,
            targets: &self.targets,
            motions: &self.motions,
            at: &self.at,
            pose: &self.pose,
            kernels: &mut self.plan.kernels[..=kernel],
        };
        Reduced::new(ground, line, start)
    }

    /// The one driver that moves what a kernel solves and all that it reads; `None` if there are
    /// more or none.
    fn only_driver(&self, kernel: usize) -> Option<DriverId> {
        let structure = self.structure();
        let mut seen = vec![false; structure.blocks().len()];
        let columns = self.plan.kernels[kernel].columns();
        let mut open: Vec<_> = columns.iter().map(|&c| structure.block_of(c)).collect();
        let mut only = None;
        while let Some(block) = open.pop() {
            if std::mem::replace(&mut seen[block], true) {
                continue;
            }
            let block = &structure.blocks()[block];
            for &row in &block.rows {
                if let super::Target::Driver(driver) = self.system.equations()[row].target
                    && only.replace(driver).is_some_and(|other| other != driver)
                {
                    return None;
                }
            }
            open.extend(&block.reads);
        }
        only
    }

    /// Looks for change points so near that the pose is within their crossing, and takes it over.
    /// Where something is ahead on the path, at whose `s` the mechanism stands, that cannot be
    /// passed, it tells how far the next sub-step may go. Allocates where something may be near.
    ///
    /// # Errors
    ///
    /// What cannot be passed is right ahead.
    pub(super) fn take_crossings(
        &mut self,
        path: &Path,
        s: f64,
    ) -> Result<Option<Careful>, Box<SingularPoint>> {
        if !self.may_cross() {
            return Ok(None);
        }
        let near = self.near_singular();
        let mut ahead: Option<(usize, Careful)> = None;
        for &kernel in &near {
            let Some(driver) = self.only_driver(kernel) else {
                continue;
            };
            let value = self.pose.drivers[driver.index()];
            let direction = self.path_drivers[driver.index()].first();
            let Some(mut block) = self.reduced(kernel, Line::Driver(driver), value) else {
                continue;
            };
            let finding = find(&mut block, REACH);
            if let Finding::End(kind, sheet) = &finding
                && *kind != SingularKind::DeadPoint
                && (sheet.tau - value) * direction > 0.0
            {
                let way = (sheet.tau - value).abs();
                let careful = Careful {
                    driver,
                    // Closer to it than to what is behind it.
                    way: 0.75 * way,
                    at_once: way * block.speed < STOPPED,
                };
                ahead = ahead.or(Some((kernel, careful)));
            }
            if let Some(crossing) = crossing_of(&mut block, finding, kernel, driver)
                && crossing.place(value).abs() < 1.0 - END
            {
                self.enter(Arc::new(crossing));
            }
        }
        if !near.is_empty() {
            // The kernels before have been elsewhere.
            self.stand_at_pose();
            // They were regular at this pose.
            let _ = self.refresh();
        }
        let Some((kernel, careful)) = ahead else {
            return Ok(None);
        };
        if careful.at_once
            && let Some(point) = self.singular_point(path, s, kernel)
        {
            self.stand_at_pose();
            let _ = self.refresh();
            return Err(Box::new(point));
        }
        Ok(Some(careful))
    }

    /// Takes over the crossings of change points near the pose, at which all is factorised.
    pub(super) fn settle(&mut self) {
        if self.regularity < NEAR {
            let held = self.held_path();
            // On a path on which nothing moves nothing is ahead.
            let _ = self.take_crossings(&held, 0.0);
        }
    }

    /// Lets a kernel's unknowns come from a crossing, and those behind follow.
    fn enter(&mut self, crossing: Arc<Crossing>) {
        let kernel = crossing.kernel;
        self.bridge(Arc::clone(&crossing));
        self.stand_at_pose();
        let (plan, mut work) = self.work();
        let closed = plan.kernels[kernel..]
            .iter_mut()
            .all(|kernel| kernel.close(&mut work, MAX_ITERATIONS).is_ok());
        if closed {
            self.at.copy_pose(&mut self.pose.q);
            self.pose.crossings.push(crossing);
        } else {
            self.release(kernel);
            self.stand_at_pose();
        }
    }

    fn bridge(&mut self, crossing: Arc<Crossing>) {
        replace(&mut self.plan.kernels, crossing.kernel, |kernel| {
            Kernel::Interpolated(Box::new(Interpolated::new(kernel, Arc::clone(&crossing))))
        });
    }

    fn release(&mut self, kernel: usize) {
        replace(&mut self.plan.kernels, kernel, |kernel| match kernel {
            Kernel::Interpolated(bridged) => bridged.kernel,
            kernel => kernel,
        });
    }

    /// Lets go of all crossings of the present pose.
    pub(super) fn release_crossings(&mut self) {
        while let Some(crossing) = self.pose.crossings.pop() {
            self.release(crossing.kernel);
        }
    }

    /// Takes over those of a pose.
    pub(super) fn bridge_all(&mut self, crossings: &[Arc<Crossing>]) {
        for crossing in crossings {
            self.bridge(Arc::clone(crossing));
            self.pose.crossings.push(Arc::clone(crossing));
        }
    }

    /// Lets go of the crossings at whose end the path, at whose `path_drivers` the mechanism
    /// stands, leads out of them.
    pub(super) fn leave_crossings(&mut self) {
        let mut left = false;
        for index in (0..self.pose.crossings.len()).rev() {
            let crossing = &self.pose.crossings[index];
            let driver = crossing.driver.index();
            let place = crossing.place(self.pose.drivers[driver]);
            let jet = self.path_drivers[driver];
            let direction = if jet.first() == 0.0 {
                jet.second()
            } else {
                jet.first()
            };
            if place.abs() >= 1.0 - END && direction * place > 0.0 {
                let crossing = self.pose.crossings.remove(index);
                self.release(crossing.kernel);
                left = true;
            }
        }
        if left {
            self.stand_at_pose();
            // The ends of a crossing are regular.
            let _ = self.refresh();
        }
    }

    /// Where a sub-step from `start` to `end` has to end to take a driver no further than it may go.
    pub(super) fn within_way(&self, careful: Careful, start: f64, end: f64) -> f64 {
        self.held_back(careful.driver, careful.way, start, end)
    }

    /// `end` so near to `start` that a driver goes no further than `most` in between.
    fn held_back(&self, driver: DriverId, most: f64, start: f64, mut end: f64) -> f64 {
        let from = self.origin_drivers[driver.index()];
        let way = |h: f64| h * (from.first().abs() + 0.5 * h * from.second().abs());
        while way(end - start) > most {
            end = start + 0.5 * (end - start);
        }
        end
    }

    /// Where a sub-step from `start` to `end` leaves the crossing that it leaves first; `end` if
    /// it leaves none.
    pub(super) fn within_crossings(&mut self, path: &Path, start: f64, end: f64) -> f64 {
        let mut end = end;
        for index in 0..self.pose.crossings.len() {
            let crossing = Arc::clone(&self.pose.crossings[index]);
            let driver = crossing.driver.index();
            // No further than from one end to the other.
            end = self.held_back(crossing.driver, 2.0 * crossing.half_width, start, end);
            let mut place = |s: f64| {
                self.drive(path, s);
                crossing.place(self.path_drivers[driver].value).abs()
            };
            if place(end) <= 1.0 {
                continue;
            }
            let (mut inside, mut outside) = (start, end);
            // Halved until the inner one is at the end of the crossing.
            for _ in 0..100 {
                let middle = 0.5 * (inside + outside);
                let there = place(middle);
                if there <= 1.0 {
                    inside = middle;
                } else {
                    outside = middle;
                }
                if (1.0 - 0.5 * END..=1.0).contains(&there) {
                    break;
                }
            }
            end = inside;
        }
        end
    }

    /// Notes the change points between the start of a sub-step and the pose.
    pub(super) fn note_crossings(&mut self) -> u32 {
        let mut passed = 0;
        for crossing in &self.pose.crossings {
            let driver = crossing.driver.index();
            let before = self.origin_drivers[driver].value - crossing.center;
            let now = self.pose.drivers[driver] - crossing.center;
            // Reached counts as passed; so setting out from it does not.
            if before != 0.0 && before * now <= 0.0 {
                passed += 1;
                self.crossed.push(Arc::clone(crossing));
            }
        }
        passed
    }

    /// What stops the motion along a path, at whose `s` the mechanism stands; `None` if no
    /// singular position was found: the motion jumps, a block is too large, parameters move.
    pub(super) fn find_end(&mut self, path: &Path, s: f64) -> Option<Box<SingularPoint>> {
        if self.parameters_move {
            return None;
        }
        let mut near = self.near_singular();
        let regularity = |kernel: usize| self.plan.kernels[kernel].regularity();
        // What reads a part that runs ever faster is as near to singular as that.
        let least = near.iter().map(|&kernel| regularity(kernel));
        let least = least.fold(f64::INFINITY, f64::min);
        near.retain(|&kernel| regularity(kernel) <= SAME_ORDER * least);
        let located = near
            .iter()
            .find_map(|&kernel| self.singular_point(path, s, kernel));
        self.stand_at_pose();
        // The pose was regular when it was reached.
        let _ = self.refresh();
        let found = located.or_else(|| {
            near.iter()
                .find_map(|&kernel| self.loss_of_ranks(s, kernel))
        });
        found.map(Box::new)
    }

    /// A singular position of more than one rank, at which the search for others fails, taken to
    /// be where the mechanism has come to a stop in front of it.
    fn loss_of_ranks(&self, s: f64, kernel: usize) -> Option<SingularPoint> {
        let svd = self.block_jacobian(kernel).svd(false, true);
        let values = &svd.singular_values;
        // In descending order.
        let last_but_one = values.len().checked_sub(2)?;
        if values[last_but_one] > LOST * values[0] {
            return None;
        }
        let free = svd.v_t?.row(last_but_one + 1).transpose();
        Some(self.point(kernel, SingularKind::HigherRank, s, &free))
    }

    /// The point where the mechanism stands, with a null vector of a kernel.
    fn point(
        &self,
        kernel: usize,
        kind: SingularKind,
        s: f64,
        free: &DVector<f64>,
    ) -> SingularPoint {
        let columns = self.plan.kernels[kernel].columns();
        let free = free / free[free.icamax()];
        let mut over_all = vec![0.0; self.pose.q.len()];
        for (&column, value) in columns.iter().zip(free.iter()) {
            over_all[column] = *value;
        }
        SingularPoint {
            kind,
            s,
            drivers: self.pose.drivers.clone(),
            q: self.pose.q.clone(),
            bodies: self.bodies_of(columns, free.as_slice()),
            free: over_all,
        }
    }

    /// The Jacobian of a kernel's rows in its own unknowns at the pose, scaled.
    fn block_jacobian(&self, kernel: usize) -> DMatrix<f64> {
        let kernel = &self.plan.kernels[kernel];
        let (rows, columns) = (kernel.rows(), kernel.columns());
        let mut jacobian = DMatrix::zeros(rows.len(), columns.len());
        for (place, &row) in rows.iter().enumerate() {
            self.system.evaluate_row(
                row,
                &self.at,
                &self.targets,
                &self.pose.drivers,
                |column, value| {
                    if let Some(local) = columns.iter().position(|&own| own == column) {
                        jacobian[(place, local)] += value;
                    }
                },
            );
        }
        jacobian
    }

    /// The singular position of a kernel ahead on a path.
    fn singular_point(&mut self, path: &Path, s: f64, kernel: usize) -> Option<SingularPoint> {
        let mut block = self.reduced(kernel, Line::Path(path), s)?;
        let (kind, sheet) = match find(&mut block, REACH_TO_END) {
            Finding::End(kind, sheet) => (kind, sheet),
            Finding::Crossing(sheet, _) => (SingularKind::ChangePoint, sheet),
            Finding::Nothing => return None,
        };
        // Rounding may have let the mechanism come a little beyond it: by so much that the
        // equations cannot tell: Newton takes a residual for zero that has stopped falling at a
        // hundred times its rounding.
        let beyond = s - sheet.tau;
        if beyond > JUST_BEYOND && beyond * sheet.first[1].abs() > 4.0 * ROUNDING {
            return None;
        }
        let (q, drivers) = (block.pose(), block.drivers().to_vec());
        Some(SingularPoint {
            drivers,
            q,
            ..self.point(kernel, kind, sheet.tau, &sheet.tangents[0])
        })
    }
}

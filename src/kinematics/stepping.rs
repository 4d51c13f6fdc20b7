//! Following a path from one pose to the next without changing the assembly mode.
//!
//! The mechanism is carried along the path in sub-steps. Each starts from the tangent and
//! curvature of the motion, ends with Newton–Raphson, and is halved unless it shows that it
//! stayed on its motion: Newton contracts, the correction is small, the Jacobian is regular and
//! its determinant keeps its sign, as it must while no singular position is crossed.

use super::Error;
use super::newton::{Outcome, SINGULAR};
use super::path::Path;
use super::solver::Solver;
use crate::mechanism::Jet;

/// Why a path could not be followed to its end.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// No continuous motion leads on: a dead point, a change point, or a motion that jumps.
    DeadPoint,
    /// A value on the way is one for which the mechanism does not exist.
    Value(Error),
    /// The path asks for more sub-steps than anyone would wait for.
    TooLong,
}

/// What following a path took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Newton corrections, failed sub-steps included.
    pub iterations: u32,
    /// Sub-steps, failed ones included; one for an ordinary step.
    pub substeps: u32,
}

/// The path could not be followed to its end: a dead point is in the way, or values for which
/// the mechanism does not exist.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocked {
    /// How far the mechanism came, from 0 to 1. It stands there.
    pub s: f64,
    /// What is in the way.
    pub reason: Reason,
    /// What it took.
    pub progress: Progress,
}

/// The largest turn of a body in one sub-step \[rad\]. A four-bar's sub-steps can be proved safe
/// up to 0.66–1.13 rad, depending on the pose.
const LARGEST_TURN: f64 = 0.5;
/// The largest correction of a prediction, in radians and characteristic lengths.
const LARGEST_CORRECTION: f64 = 0.1;
/// Newton has to shrink its corrections at least by this factor from one to the next.
const CONTRACTION: f64 = 0.25;
/// Newton converges quadratically from a good prediction; one that needs more is halved.
const MAX_ITERATIONS: u32 = 8;
/// Some thousand turns; a path that asks for more is a slip, and the host waits.
const MOST_SUBSTEPS: u32 = 100_000;
/// Where a sub-step looks whether a prescribed motion does what its start foretells: at places
/// that no simple period hits all.
const LOOK_AT: [f64; 3] = [0.29, 0.53, 0.83];
/// A sub-step of this part of the path that still fails means that the path is blocked.
const SMALLEST_SUBSTEP: f64 = 1e-12;

impl Solver {
    /// Moves the mechanism along `path`, at whose start it must stand. Allocates nothing.
    ///
    /// # Errors
    ///
    /// [`Blocked`] if the end cannot be reached on the continuous motion. The mechanism then
    /// stands at the last pose reached on the way, which is a valid one.
    pub fn follow(&mut self, path: &Path) -> Result<Progress, Blocked> {
        let mut progress = Progress::default();
        let mut s = 0.0;
        let mut substep: f64 = 1.0;
        let blocked = |s, reason, progress| {
            Err(Blocked {
                s,
                reason,
                progress,
            })
        };
        if self.refresh().is_err() {
            return blocked(s, Reason::DeadPoint, progress);
        }
        if let Err(error) = self.set_path(path, 0.0) {
            return blocked(s, Reason::Value(error), progress);
        }
        let orientation = self.lu.determinant_is_negative();
        while s < 1.0 {
            self.predict();
            substep = substep.min(LARGEST_TURN / self.turn_along_path());
            let start = s;
            if substep < SMALLEST_SUBSTEP || progress.substeps >= MOST_SUBSTEPS {
                return blocked(s, Reason::TooLong, progress);
            }
            loop {
                let next = if start + substep < 1.0 {
                    start + substep
                } else {
                    1.0
                };
                progress.substeps = progress.substeps.saturating_add(1);
                let reached = self.try_substep(path, [start, next], orientation, &mut progress);
                if reached == Ok(true) {
                    s = next;
                    break;
                }
                substep = 0.5 * (next - start);
                if substep < SMALLEST_SUBSTEP {
                    self.stand_at(path, start);
                    let reason = reached.map_or_else(Reason::Value, |_| Reason::DeadPoint);
                    return blocked(start, reason, progress);
                }
                self.pose.q.copy_from_slice(&self.origin.q);
            }
            // Twice the sub-step that was possible here.
            substep = 2.0 * (s - start);
        }
        Ok(progress)
    }

    /// Computes tangent and curvature of the motion along the path where the mechanism stands,
    /// and remembers the pose.
    fn predict(&mut self) {
        let drivers = &self.path_drivers;
        self.tangent
            .solve(&self.system, &self.at, &self.lu, |driver| {
                drivers[driver.index()]
            });
        self.origin.q.copy_from_slice(&self.pose.q);
        self.origin_drivers.copy_from_slice(&self.path_drivers);
    }

    /// The fastest turn of a body along the tangent, in radians for the whole path.
    fn turn_along_path(&self) -> f64 {
        let tangent = self.tangent.velocity().iter().enumerate();
        let turns = tangent.filter(|(column, _)| self.system.is_angle(*column));
        turns.fold(0.0, |fastest: f64, (_, turn)| fastest.max(turn.abs()))
    }

    /// Whether the prescribed motions between the two ends go where their value, velocity and
    /// acceleration at the start lead: only then do the ends tell of the way between them.
    fn is_as_foretold(&mut self, path: &Path, [start, end]: [f64; 2]) -> Result<bool, Error> {
        if !path.has_motions() {
            return Ok(true);
        }
        for part in LOOK_AT {
            let h = part * (end - start);
            self.set_path(path, start + h)?;
            let size = self.at.size();
            let foretold = self
                .origin_drivers
                .iter()
                .zip(&self.path_drivers)
                .all(|(from, at)| {
                    let value = from.value + h * (from.first + 0.5 * h * from.second);
                    (value - at.value).abs() <= LARGEST_CORRECTION * size.min(1.0)
                });
            if !foretold {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Goes from the remembered pose to the end of a sub-step; true if that kept to the motion.
    ///
    /// # Errors
    ///
    /// A value on the way is one for which the mechanism does not exist.
    fn try_substep(
        &mut self,
        path: &Path,
        [start, end]: [f64; 2],
        orientation: bool,
        progress: &mut Progress,
    ) -> Result<bool, Error> {
        if !self.is_as_foretold(path, [start, end])? {
            return Ok(false);
        }
        let h = end - start;
        let (first, second) = (self.tangent.velocity(), self.tangent.acceleration());
        for (k, q) in self.pose.q.iter_mut().enumerate() {
            *q += h * (first[k] + 0.5 * h * second[k]);
        }
        self.set_path(path, end)?;
        let Outcome {
            converged,
            iterations,
            contraction,
        } = self.correct(MAX_ITERATIONS);
        progress.iterations = progress.iterations.saturating_add(iterations);
        Ok(converged
            && contraction <= CONTRACTION
            && self.lu.determinant_is_negative() == orientation
            && self.largest_correction(h) <= LARGEST_CORRECTION
            && !self.lu.is_singular(SINGULAR))
    }

    /// How far the corrected pose is from the predicted one, scaled.
    fn largest_correction(&self, h: f64) -> f64 {
        let (first, second) = (self.tangent.velocity(), self.tangent.acceleration());
        let size = self.at.size();
        (0..self.pose.q.len()).fold(0.0, |worst: f64, k| {
            let predicted = self.origin.q[k] + h * (first[k] + 0.5 * h * second[k]);
            worst.max((self.pose.q[k] - predicted).abs() / self.system.column_scale(k, size))
        })
    }

    /// Takes time, parameters and drivers from the path at s, leaving q as it is.
    pub(super) fn set_path(&mut self, path: &Path, s: f64) -> Result<(), Error> {
        let Self {
            system,
            pose,
            motions,
            path_motions,
            path_parameters,
            path_drivers,
            ..
        } = self;
        let mechanism = system.mechanism();
        pose.time = path.time(s);
        let moves = path.moves_parameters();
        if moves {
            path.parameters(mechanism, s, path_parameters);
            for (value, jet) in pose.parameters.iter_mut().zip(path_parameters.iter()) {
                *value = jet.value;
            }
            path_motions.set_parameters(|p| path_parameters[p.index()]);
            path.drivers(s, path_motions, path_drivers);
        } else {
            path.drivers(s, motions, path_drivers);
        }
        for (value, jet) in pose.drivers.iter_mut().zip(path_drivers.iter()) {
            *value = jet.value;
        }
        if moves {
            self.take_over_parameters()?;
        }
        self.system.check_drivers(&self.pose.drivers)
    }

    /// The drivers' values at the end of a path.
    pub fn drivers_at_end(&mut self, path: &Path) -> Vec<f64> {
        self.path_motions
            .set_parameters(|p| Jet::constant(path.to[p.index()]));
        path.drivers(1.0, &self.path_motions, &mut self.path_drivers);
        self.path_drivers
            .iter()
            .map(|driver| driver.value)
            .collect()
    }

    /// Returns to the remembered pose, which was reached at s.
    fn stand_at(&mut self, path: &Path, s: f64) {
        self.pose.q.copy_from_slice(&self.origin.q);
        self.set_path(path, s)
            .expect("the path was valid where the mechanism has been");
        self.evaluate();
    }
}

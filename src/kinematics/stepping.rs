//! Following a path from one pose to the next without changing the assembly mode.
//!
//! The mechanism is carried along the path in sub-steps. Each starts from the tangent and
//! curvature of the motion, ends with Newton–Raphson, and is accepted with the
//! [certificate](super::certificate) that one and only one continuous motion joins its two ends;
//! else it is shortened by as much as the certificate finds it too long.

use super::Error;
use super::error::OpenJoint;
use super::newton::Correction;
use super::path::Path;
use super::plan::{Advance, Substep, Work};
use super::singular::{Careful, NEAR, SingularPoint};
use super::solver::{Solver, UNIT};
use crate::mechanism::Jet;

/// Why a path could not be followed to its end.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// The Jacobian loses rank ahead: a dead point, or what is not crossed.
    Singular(Box<SingularPoint>),
    /// No continuous motion was found to lead on, nor a singular position: the motion jumps, or
    /// the part of the mechanism that stops is too large or moved by parameters.
    Lost,
    /// A value on the way is one for which the mechanism does not exist.
    Value(Error),
    /// Beyond here a constraint that was redundant so far contradicts the others: what it would
    /// be open by where it first was found open.
    Contradiction(OpenJoint),
    /// The path asks for more sub-steps than anyone would wait for.
    TooLong,
}

/// What following a path took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Newton corrections: the most that any part of the mechanism needed, summed over the
    /// sub-steps that succeeded.
    pub iterations: u32,
    /// Sub-steps, failed ones included; one for an ordinary step.
    pub substeps: u32,
    /// Change points passed; [`Solver::crossed`] has them.
    pub crossings: u32,
    /// How many of those that succeeded are *checked*, not proved: that one continuous motion
    /// joins their ends rests on an estimate. So it is for blocks of more than 32 torn unknowns,
    /// and while parameters move those of relations without straight code, or a motion's table.
    pub checked: u32,
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

/// Some thousand turns; a path that asks for more is a slip, and the host waits.
const MOST_SUBSTEPS: u32 = 100_000;
/// Drivers that still move by more than this in such a sub-step \[m or rad\] tell nothing of what
/// is ahead: the path is too long.
const TELLS_NOTHING: f64 = 1e-6;
/// A value that makes no mechanism this near on the path is what it has come to.
const JUST_AHEAD: f64 = 1e-9;
/// A sub-step that fails is shortened to no less than this part, one that nothing is known of to
/// half: what the certificate tells of a much too long one is not to be relied on.
const SHORTEN: f64 = 0.1;
const HALVE: f64 = 0.5;
/// A sub-step follows one that succeeded at no more than this many times its length.
const LENGTHEN: f64 = 4.0;
/// What a sub-step is chosen shorter by than the certificate of another one suggests.
const ROOM: f64 = 0.85;
/// A sub-step of this part of the path that still fails means that the path is blocked.
const SMALLEST_SUBSTEP: f64 = 1e-12;
/// The same for the first sub-step: away from a dead point, from as near as the way there ended.
/// From there on the motion slows down as it has come on.
const SMALLEST_FIRST_SUBSTEP: f64 = 1e-15;

impl Solver {
    /// Moves the mechanism along `path`, at whose start it must stand. Change points on the way are
    /// crossed on the smooth continuation of the motion. Allocates nothing, unless a part of the
    /// mechanism comes near a singular position.
    ///
    /// # Errors
    ///
    /// [`Blocked`] if the end cannot be reached on the continuous motion. The mechanism then
    /// stands at the last pose reached on the way, which is a valid one.
    pub fn follow(&mut self, path: &Path) -> Result<Progress, Blocked> {
        let mut progress = Progress::default();
        let mut s = 0.0;
        let mut substep: f64 = 1.0;
        // What a redundant constraint would have been open by, and where.
        let mut opened: Option<(f64, OpenJoint)> = None;
        // Whether the last sub-step was as small as one may be.
        let mut crawls = false;
        let blocked = |s, reason, progress| {
            Err(Blocked {
                s,
                reason,
                progress,
            })
        };
        self.crossed.clear();
        self.parameters_move = path.moves_parameters();
        if self.parameters_move && !self.pose.crossings.is_empty() {
            // A crossing is one for these parameters.
            self.release_crossings();
            self.stand_at_pose();
        }
        if self.refresh().is_err() {
            return blocked(s, Reason::Lost, progress);
        }
        self.pose.time = path.time(0.0);
        self.drive(path, 0.0);
        let mut careful = match self.look_ahead(path, s) {
            Ok(careful) => careful,
            Err(end) => return blocked(s, Reason::Singular(end), progress),
        };
        while s < 1.0 {
            if !self.pose.crossings.is_empty() {
                self.leave_crossings();
            }
            self.predict();
            let smallest = (0.01 * s).clamp(SMALLEST_FIRST_SUBSTEP, SMALLEST_SUBSTEP);
            self.origin_time = self.pose.time;
            if self.parameters_move {
                self.origin_parameters
                    .copy_from_slice(&self.pose.parameters);
            }
            let start = s;
            if progress.substeps >= MOST_SUBSTEPS {
                return blocked(s, Reason::TooLong, progress);
            }
            // What is too small to go on with is tried once more, to tell what is in the way.
            let small = substep < smallest;
            if small {
                let reason = self.reason_to_stop(path, s, substep);
                if crawls || matches!(reason, Reason::Singular(_)) {
                    return blocked(s, reason, progress);
                }
                substep = smallest;
            }
            crawls = small;
            // Between its points a motion given by a table tells at its ends where it has been.
            let most = path.next_point(start, &self.motions);
            let mut reaches_point = false;
            loop {
                let mut next = if start + substep < most {
                    start + substep
                } else {
                    reaches_point = true;
                    most
                };
                if let Some(careful) = careful {
                    let end = self.within_way(careful, start, next);
                    reaches_point &= end >= next;
                    next = end;
                }
                if !self.pose.crossings.is_empty() {
                    let end = self.within_crossings(path, start, next);
                    reaches_point |= end < next;
                    next = end;
                }
                progress.substeps = progress.substeps.saturating_add(1);
                let reached = self.try_substep(path, [start, next], &mut progress);
                if reached == Ok(true) {
                    s = next;
                    break;
                }
                self.stand_at(path, start);
                reaches_point = false;
                if let Err(Reason::Contradiction(joint)) = &reached {
                    opened.get_or_insert_with(|| (next, joint.clone()));
                }
                if self.change_rows() {
                    self.stand_at(path, start);
                    continue;
                }
                substep = match reached {
                    // The rows that are solved have nothing against it.
                    Err(Reason::Contradiction(_)) => HALVE * (next - start),
                    _ => self.shortened(next - start),
                };
                if substep < smallest {
                    let reason = match (reached, opened) {
                        // Next to a singular position nothing holds to rounding.
                        (Err(Reason::Contradiction(_)), Some((_, joint)))
                            if !self.is_nearly_singular() =>
                        {
                            Reason::Contradiction(joint)
                        }
                        (Err(Reason::Value(error)), _) => Reason::Value(error),
                        _ => self.reason_to_stop(path, start, substep),
                    };
                    return blocked(start, reason, progress);
                }
            }
            opened.take_if(|(place, _)| *place <= s);
            progress.crossings += self.note_crossings();
            careful = match self.look_ahead(path, s) {
                Ok(careful) => careful,
                Err(end) => return blocked(s, Reason::Singular(end), progress),
            };
            if s < 1.0 {
                let suggested = self.lengthened(s - start);
                // What a point cut short was possible as well.
                let possible = if reaches_point { substep } else { 0.0 };
                substep = suggested.max(possible);
            }
        }
        Ok(progress)
    }

    /// Why not even a sub-step of length `h` leads on from where the mechanism stands, which is at
    /// `s`.
    fn reason_to_stop(&mut self, path: &Path, s: f64, h: f64) -> Reason {
        if let Some(end) = self.find_end(path, s) {
            return Reason::Singular(end);
        }
        // Steps may become ever shorter in front of a value that makes no mechanism.
        let ahead = self.set_path(path, (s + JUST_AHEAD).min(1.0));
        self.stand_at(path, s);
        if let Err(error) = ahead {
            return Reason::Value(error);
        }
        // However small a part of the path it is.
        let far = |driver: &Jet| (h * driver.first).abs() > TELLS_NOTHING;
        if self.origin_drivers.iter().any(far) {
            Reason::TooLong
        } else {
            Reason::Lost
        }
    }

    /// Takes over the crossings of change points that are near, once a sub-step has ended.
    ///
    /// # Errors
    ///
    /// What cannot be passed is right ahead.
    fn look_ahead(&mut self, path: &Path, s: f64) -> Result<Option<Careful>, Box<SingularPoint>> {
        if self.regularity < NEAR && !self.parameters_move {
            self.take_crossings(path, s)
        } else {
            Ok(None)
        }
    }

    /// Computes tangent and curvature of the motion along the path where the mechanism stands,
    /// which is where `path_drivers` are from.
    fn predict(&mut self) {
        std::mem::swap(&mut self.origin_drivers, &mut self.path_drivers);
        if !self.has_unit() {
            let drivers = std::mem::take(&mut self.origin_drivers);
            let (plan, mut work) = self.work();
            plan.solve_rates(&mut work, &drivers);
            self.origin_drivers = drivers;
        }
    }

    /// How far along the flow the part `h` of the path leads: q + h q′ + ½ h² q″, where with a
    /// single driver q′ = q_u u′ and q″ = q_u u″ + q_uu u′².
    fn advance_of(&self, h: f64) -> Advance {
        match self.origin_drivers[..] {
            [u] => Advance {
                first: h * (u.first + 0.5 * h * u.second),
                second: 0.5 * (h * u.first).powi(2),
            },
            _ => Advance {
                first: h,
                second: 0.5 * h * h,
            },
        }
    }

    /// How long to try instead of a sub-step of length `h` that failed.
    fn shortened(&self, h: f64) -> f64 {
        let load = self.tubes.load();
        if load.is_finite() && load > 1.0 {
            h * (ROOM / load.sqrt()).max(SHORTEN)
        } else {
            h * HALVE
        }
    }

    /// How long to try after a sub-step of length `h` that succeeded.
    fn lengthened(&self, h: f64) -> f64 {
        h * (ROOM / self.tubes.load().sqrt()).min(LENGTHEN)
    }

    /// Goes from the pose to the end of a sub-step; true if that kept to the motion. If not, the
    /// mechanism is neither here nor there, the pose apart.
    ///
    /// # Errors
    ///
    /// A value on the way is one for which the mechanism does not exist, or a redundant
    /// constraint is one no longer.
    fn try_substep(
        &mut self,
        path: &Path,
        [start, end]: [f64; 2],
        progress: &mut Progress,
    ) -> Result<bool, Reason> {
        // What holds for several steps is for steps that are taken as a whole: how a longer way is
        // divided depends on its own proofs alone.
        let boxes = start <= 0.0 && end >= 1.0 && !self.parameters_move;
        let reached = self.reach(path, [start, end], boxes);
        let mut reached = reached.map_err(Reason::Value)?;
        if reached.is_none() && self.tubes.relied_on_box {
            self.stand_at(path, start);
            let again = self.reach(path, [start, end], false);
            reached = again.map_err(Reason::Value)?;
        }
        let Some(correction) = reached else {
            return Ok(false);
        };
        if let Some(joint) = self.opened() {
            return Err(Reason::Contradiction(joint));
        }
        // The pose takes the new values with the new q, or keeps both as they are.
        std::mem::swap(&mut self.pose.drivers, &mut self.next_drivers);
        self.at.copy_pose(&mut self.pose.q);
        self.regularity = correction.regularity;
        progress.iterations = progress.iterations.saturating_add(correction.iterations);
        progress.checked = progress.checked.saturating_add(self.tubes.checked.into());
        Ok(true)
    }

    /// Moves the bodies to the end of a sub-step, the pose apart; `None` if that is not proved.
    fn reach(
        &mut self,
        path: &Path,
        [start, end]: [f64; 2],
        boxes: bool,
    ) -> Result<Option<Correction>, Error> {
        self.set_path(path, end)?;
        self.tubes.begin(boxes);
        if !self.bound_course(path, [start, end])? {
            return Ok(None);
        }
        let advance = self.advance_of(end - start);
        let unit = self.has_unit().then_some(&UNIT[..]);
        let mut work = Work {
            system: &self.system,
            targets: &self.targets,
            drivers: &self.next_drivers,
            at: &mut self.at,
            flow: &mut self.flow,
        };
        let mut substep = Substep {
            advance,
            from: &self.pose.q,
            tubes: &mut self.tubes,
        };
        Ok(self.plan.advance(&mut work, &mut substep, unit).ok())
    }

    /// Takes time, parameters and drivers from the path at s, leaving q and the pose's drivers,
    /// which go with it, as they are.
    pub(super) fn set_path(&mut self, path: &Path, s: f64) -> Result<(), Error> {
        self.drive(path, s);
        self.pose.time = path.time(s);
        for (value, jet) in self.next_drivers.iter_mut().zip(&self.path_drivers) {
            *value = jet.value;
        }
        if self.parameters_move {
            let parameters = self.pose.parameters.iter_mut();
            for (value, jet) in parameters.zip(&self.path_parameters) {
                *value = jet.value;
            }
            self.take_over_parameters()?;
        }
        self.system.check_drivers(&self.next_drivers)
    }

    /// The drivers along the path at s, with their derivatives.
    pub(super) fn drive(&mut self, path: &Path, s: f64) {
        let Self {
            system,
            motions,
            path_motions,
            path_parameters,
            parameters_move,
            path_drivers,
            ..
        } = self;
        let mechanism = system.mechanism();
        if *parameters_move {
            path.parameters(mechanism, s, path_parameters);
            path_motions.set_parameters(|p| path_parameters[p.index()]);
            path.drivers(s, path_motions, path_drivers);
        } else {
            path.drivers(s, motions, path_drivers);
        }
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

    /// Returns from a sub-step that failed to the pose, which was reached at s.
    fn stand_at(&mut self, path: &Path, s: f64) {
        self.pose.time = self.origin_time;
        if self.parameters_move {
            self.pose
                .parameters
                .copy_from_slice(&self.origin_parameters);
            self.take_over_parameters()
                .expect("these parameters were in force before");
        }
        self.drive(path, s);
        self.stand_at_pose();
        self.refresh()
            .expect("the pose was regular when it was reached");
        self.predict();
    }
}

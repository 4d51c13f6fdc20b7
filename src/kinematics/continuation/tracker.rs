//! The tracker of a path: chooses the length of each sub-step and carries the mechanism along.

use super::outcome::{Blocked, Progress, Reason};
use crate::kinematics::error::OpenJoint;
use crate::kinematics::path::Path;
use crate::kinematics::singular::{Careful, NEAR};
use crate::kinematics::solver::Solver;
use crate::mechanism::Jet;

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
        let mut walk = Walk {
            solver: self,
            path,
            s: 0.0,
            substep: 1.0,
            careful: None,
            opened: None,
            crawls: false,
            progress: Progress::default(),
        };
        match walk.run() {
            Ok(()) => Ok(walk.progress),
            Err(reason) => Err(Blocked {
                s: walk.s,
                reason,
                progress: walk.progress,
            }),
        }
    }
}

/// A mechanism on its way along a path.
struct Walk<'a> {
    solver: &'a mut Solver,
    path: &'a Path,
    /// Where it stands.
    s: f64,
    /// How long a sub-step to try.
    substep: f64,
    /// How far that may go because of what is ahead.
    careful: Option<Careful>,
    /// What a redundant constraint would have been open by, and where.
    opened: Option<(f64, OpenJoint)>,
    /// Whether the last sub-step was as small as one may be.
    crawls: bool,
    progress: Progress,
}

/// Where a sub-step is to end.
#[derive(Clone, Copy)]
struct Goal {
    s: f64,
    /// Whether something on the path is there, without which it would have been further on.
    cut_short: bool,
}

impl Walk<'_> {
    /// Goes to the end of the path.
    ///
    /// # Errors
    ///
    /// Why it went no further than `s`.
    fn run(&mut self) -> Result<(), Reason> {
        self.set_out()?;
        self.look_ahead()?;
        while self.s < 1.0 {
            let smallest = (0.01 * self.s).clamp(SMALLEST_FIRST_SUBSTEP, SMALLEST_SUBSTEP);
            self.prepare(smallest)?;
            let start = self.s;
            let cut_short = self.advance(smallest)?;
            self.opened.take_if(|(place, _)| *place <= self.s);
            self.progress.crossings += self.solver.note_crossings();
            self.look_ahead()?;
            if self.s < 1.0 {
                let suggested = self.solver.lengthened(self.s - start);
                // What was cut short was possible as well.
                let possible = if cut_short { self.substep } else { 0.0 };
                self.substep = suggested.max(possible);
            }
        }
        Ok(())
    }

    /// Makes sure that the solver stands at the start of the path.
    fn set_out(&mut self) -> Result<(), Reason> {
        let Self { solver, path, .. } = self;
        solver.crossed.clear();
        solver.parameters_move = path.moves_parameters();
        if solver.parameters_move && !solver.pose.crossings.is_empty() {
            // A crossing is one for these parameters.
            solver.release_crossings();
            solver.stand_at_pose();
        }
        solver.refresh().map_err(|_| Reason::Lost)?;
        solver.pose.time = path.time(0.0);
        solver.drive(path, 0.0);
        Ok(())
    }

    /// Takes over the crossings of change points that are near where the mechanism stands.
    ///
    /// # Errors
    ///
    /// What cannot be passed is right ahead.
    fn look_ahead(&mut self) -> Result<(), Reason> {
        let Self { solver, path, .. } = self;
        self.careful = if solver.regularity < NEAR && !solver.parameters_move {
            let taken = solver.take_crossings(path, self.s);
            taken.map_err(Reason::Singular)?
        } else {
            None
        };
        Ok(())
    }

    /// Gets ready for the next sub-step, from where the mechanism stands.
    ///
    /// # Errors
    ///
    /// There is none, `smallest` being the least that is worth trying.
    fn prepare(&mut self, smallest: f64) -> Result<(), Reason> {
        let solver = &mut *self.solver;
        if !solver.pose.crossings.is_empty() {
            solver.leave_crossings();
        }
        solver.set_origin();
        if self.progress.substeps >= MOST_SUBSTEPS {
            return Err(Reason::TooLong);
        }
        // What is too small to go on with is tried once more, to tell what is in the way.
        let small = self.substep < smallest;
        if small {
            let reason = self.reason_to_stop();
            if self.crawls || matches!(reason, Reason::Singular(_)) {
                return Err(reason);
            }
            self.substep = smallest;
        }
        self.crawls = small;
        Ok(())
    }

    /// Takes a sub-step, shortened until one succeeds. Returns whether something on the path cut
    /// it short.
    ///
    /// # Errors
    ///
    /// Not even one of length `smallest` does.
    fn advance(&mut self, smallest: f64) -> Result<bool, Reason> {
        // Between its points a motion given by a table tells at its ends where it has been.
        let most = self.path.next_point(self.s, &self.solver.motions);
        loop {
            let goal = self.goal(most);
            self.progress.substeps = self.progress.substeps.saturating_add(1);
            let part = [self.s, goal.s];
            let reached = self.solver.try_substep(self.path, part, &mut self.progress);
            if reached == Ok(true) {
                self.s = goal.s;
                return Ok(goal.cut_short);
            }
            self.shorten(reached, goal.s, smallest)?;
        }
    }

    /// Where the next sub-step has to end, no further than `most`.
    fn goal(&mut self, most: f64) -> Goal {
        let Self { solver, path, .. } = self;
        let start = self.s;
        let mut goal = if start + self.substep < most {
            Goal {
                s: start + self.substep,
                cut_short: false,
            }
        } else {
            Goal {
                s: most,
                cut_short: true,
            }
        };
        if let Some(careful) = self.careful {
            let end = solver.within_way(careful, start, goal.s);
            goal.cut_short &= end >= goal.s;
            goal.s = end;
        }
        if !solver.pose.crossings.is_empty() {
            let end = solver.within_crossings(path, start, goal.s);
            goal.cut_short |= end < goal.s;
            goal.s = end;
        }
        goal
    }

    /// Returns to the start of a sub-step that failed, and chooses a shorter one or other rows.
    ///
    /// # Errors
    ///
    /// That would be shorter than `smallest`.
    fn shorten(
        &mut self,
        failed: Result<bool, Reason>,
        end: f64,
        smallest: f64,
    ) -> Result<(), Reason> {
        let Self { solver, path, .. } = self;
        solver.stand_at(path, self.s);
        if let Err(Reason::Contradiction(joint)) = &failed {
            self.opened.get_or_insert_with(|| (end, joint.clone()));
        }
        if solver.change_rows() {
            solver.stand_at(path, self.s);
            return Ok(());
        }
        self.substep = match failed {
            // The rows that are solved have nothing against it.
            Err(Reason::Contradiction(_)) => HALVE * (end - self.s),
            _ => solver.shortened(end - self.s),
        };
        if self.substep >= smallest {
            return Ok(());
        }
        match (failed, self.opened.take()) {
            // Next to a singular position nothing holds to rounding.
            (Err(Reason::Contradiction(_)), Some((_, joint))) if !solver.is_nearly_singular() => {
                Err(Reason::Contradiction(joint))
            }
            (Err(Reason::Value(error)), _) => Err(Reason::Value(error)),
            _ => Err(self.reason_to_stop()),
        }
    }

    /// Why not even the present sub-step leads on from where the mechanism stands.
    fn reason_to_stop(&mut self) -> Reason {
        let Self { solver, path, .. } = self;
        if let Some(end) = solver.find_end(path, self.s) {
            return Reason::Singular(end);
        }
        // Steps may become ever shorter in front of a value that makes no mechanism.
        let ahead = solver.set_path(path, (self.s + JUST_AHEAD).min(1.0));
        solver.stand_at(path, self.s);
        if let Err(error) = ahead {
            return Reason::Value(error);
        }
        // However small a part of the path it is.
        let far = |driver: &Jet| (self.substep * driver.first()).abs() > TELLS_NOTHING;
        if solver.origin_drivers.iter().any(far) {
            Reason::TooLong
        } else {
            Reason::Lost
        }
    }
}

impl Solver {
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
}

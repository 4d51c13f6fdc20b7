//! A mechanism in motion.

use std::borrow::Cow;
use std::sync::Arc;

use super::balance::Equilibrium;
use super::error::Error;
use super::free_state::FreeState;
use super::given::Given;
use super::linear::StateSpace;
use super::motion::FreeMotion;
use super::told::Told;
use crate::kinematics::{
    self, Blocked, Budget, Direction, ForceParts, Forces, Output, Path, Pose, Progress, Solution,
    Solver, SolverChoices,
};
use crate::mechanism::{BeyondPoints, DriverId, Mechanism};

/// A mechanism that moves from one time to the next: along the paths of its drivers, and by forces where
/// it has freedoms that were [released](Self::release).
///
/// ```
/// use biela::dynamics::Motion;
/// use biela::kinematics::{DriverPath, Path, Solver};
/// use biela::mechanism::{Mechanism, Source};
///
/// let text = include_str!("../../mechanisms/four_bar.toml");
/// let (mechanism, _) = Mechanism::parse(&Source::new("four_bar.toml", text)).unwrap();
/// let mut path = Path::new(&mechanism);
/// let mut motion = Motion::new(Solver::assembled(mechanism.into(), &path).unwrap());
/// // The crank turns by 0.1 rad in 0.01 s.
/// let now = motion.pose().drivers[0];
/// path.driver_paths[0] = DriverPath::held(now + 0.1, now);
/// path.duration = 0.01;
/// motion.follow(&path).unwrap();
/// assert_eq!(motion.pose().drivers[0], now + 0.1);
/// motion.tell_notices(|notice| panic!("{notice}"));
/// ```
#[derive(Debug)]
pub struct Motion {
    /// The solver, at the pose; of a free motion maybe in other coordinates than the file's.
    pub solver: Solver,
    /// Rates and forces at the pose where they were [solved](Self::solve) last; what is given of them
    /// is the host's.
    pub solution: Solution,
    /// Memory of the notices that were told.
    pub told: Told,
    /// Whether a free motion ends at events: [`advance`](Self::advance) may then not reach its time.
    pub ends_at_events: bool,
    pub(super) free: Option<Free>,
    /// Calls of functions beyond their points that were found and not told.
    pub(super) beyond: Vec<Option<(f64, BeyondPoints)>>,
    pub(super) way: Way,
    /// Whether forces are solved for the sake of contacts that pull alone.
    watches_contacts: bool,
    /// Whether the reactions of contacts were solved at the pose.
    pub(super) knows_contacts: bool,
}

/// The path that a mechanism has followed last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// It was told.
    Told,
    /// It was followed to its end, of which nobody has been told.
    Passed,
    /// The mechanism has stopped on it; the pose is told with the reason.
    Stopped,
}

/// The motion of freedoms.
#[derive(Debug)]
pub(super) struct Free {
    pub(super) motion: FreeMotion,
    /// Its state before it begins, in the file's own coordinates.
    fresh: FreeState,
    /// Whether it has begun; freedoms are held on the path otherwise.
    pub(super) is_released: bool,
}

/// A pose of a motion, to which it can return.
#[derive(Clone, Debug)]
pub struct MotionState {
    /// The pose.
    pub pose: Pose,
    /// The solver's choices and the free motion there; nothing where freedoms are held.
    free: Option<(SolverChoices, FreeState)>,
}

/// The reason for which a mechanism stops.
#[derive(Clone, Debug)]
pub enum Stop {
    /// The path cannot be followed to its end.
    Blocked(Blocked),
    /// The free motion cannot go on.
    Free(Error),
}

impl Motion {
    /// Makes the motion of a mechanism at a solver's pose, with its freedoms held.
    #[must_use]
    pub fn new(solver: Solver) -> Self {
        Self {
            solution: Solution::new(&solver),
            told: Told::new(&solver, 0),
            beyond: vec![None; solver.mechanism().functions.list().len()],
            solver,
            ends_at_events: false,
            free: None,
            way: Way::Told,
            watches_contacts: false,
            knows_contacts: false,
        }
    }

    /// Prepares the free motion of the mechanism, if it has freedoms, with its derivatives along
    /// directions.
    ///
    /// # Errors
    ///
    /// Those of [`FreeMotion::along`].
    pub fn prepare_freedoms(&mut self, directions: Vec<Direction>) -> Result<(), Error> {
        let tolerance = self.mechanism().simulation.tolerance;
        let free = FreeMotion::along(&self.solver, tolerance, directions)?;
        self.free = free.map(|motion| Free {
            fresh: motion.state(),
            motion,
            is_released: false,
        });
        Ok(())
    }

    /// Returns the mechanism.
    #[must_use]
    pub fn mechanism(&self) -> &Arc<Mechanism> {
        self.solver.mechanism()
    }

    /// Returns the pose.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        self.solver.pose()
    }

    /// Returns the motion of freedoms, if it was [prepared](Self::prepare_freedoms) and there are some.
    #[must_use]
    pub fn free(&self) -> Option<&FreeMotion> {
        self.free.as_ref().map(|free| &free.motion)
    }

    /// Returns the number of places at which a contact touches, by the index of its stop; zero where all is
    /// driven.
    #[must_use]
    pub fn touching(&self, stop: usize) -> u32 {
        self.free()
            .map_or(0, |free| free.touching(self.solver.mechanism(), stop))
    }

    /// Returns the motion of freedoms, if there are some, with the solver that it moves and the solution.
    pub fn parts(&mut self) -> Option<(&mut FreeMotion, &mut Solver, &mut Solution)> {
        let free = self.free.as_mut()?;
        Some((&mut free.motion, &mut self.solver, &mut self.solution))
    }

    /// Returns the state of the free motion before it begins, in the file's own coordinates.
    #[must_use]
    pub fn fresh(&self) -> Option<&FreeState> {
        self.free.as_ref().map(|free| &free.fresh)
    }

    /// Solves forces too, from now on.
    pub fn seek_forces(&mut self) {
        self.solution.seek_forces(&self.solver);
        self.told.lifted = vec![false; self.contacts()];
    }

    /// Watches contacts, which tell where they pull though nobody asks for forces. Returns whether there
    /// are some to watch.
    pub fn watch_contacts(&mut self) -> bool {
        let has_dynamics = self.mechanism().has_dynamics();
        let asks_forces = self.solution.forces().is_some();
        if asks_forces || !has_dynamics || self.solver.forces().contacts() == 0 {
            return false;
        }
        self.seek_forces();
        self.watches_contacts = true;
        true
    }

    /// Returns the number of joints that can only push, zero unless forces are sought.
    #[must_use]
    pub fn contacts(&self) -> usize {
        self.solution.forces().map_or(0, Forces::contacts)
    }

    /// Goes to a pose in the file's own coordinates, with the solver's choices there, and holds freedoms.
    /// Nothing of an earlier motion has been told then.
    pub fn begin(&mut self, pose: &Pose, choices: &SolverChoices) {
        self.take_own();
        self.hold();
        self.return_to(pose, choices, None);
        self.told = Told::new(&self.solver, self.contacts());
    }

    /// Goes to a pose with the solver's choices there and in the coordinates of a free motion there. That
    /// motion [goes on](Self::resume_free) from its state.
    pub fn return_to(&mut self, pose: &Pose, choices: &SolverChoices, free: Option<&FreeState>) {
        if let (Some((motion, solver, solution)), Some(state)) = (self.parts(), free) {
            let selected = motion.select(solver, solution, state);
            debug_assert!(selected.is_ok(), "the coordinates were in use");
        }
        let resumed = self.solver.resume(pose, choices);
        debug_assert!(resumed, "the choices are those of this mechanism");
        self.arrive(Way::Told);
    }

    /// Goes on with the free motion from a state of it, at the pose that belongs to it.
    ///
    /// # Errors
    ///
    /// Those of [`FreeMotion::resume`].
    pub fn resume_free(&mut self, state: &FreeState) -> Result<(), Error> {
        let Some(free) = &mut self.free else {
            return Ok(());
        };
        free.is_released = true;
        free.motion.resume(&self.solver, state)
    }

    /// Lets freedoms, if there are some, move by the forces from the pose on, with the velocities of the
    /// file.
    ///
    /// # Errors
    ///
    /// Accelerations do not exist there.
    pub fn release(&mut self, given: &impl Given) -> Result<(), Error> {
        let mechanism = Arc::clone(self.mechanism());
        self.release_with(given, |freedom| {
            mechanism.drivers[freedom.index()].start_velocity()
        })
    }

    /// As [`release`](Self::release), with these velocities of the freedoms.
    ///
    /// # Errors
    ///
    /// As [`release`](Self::release).
    pub fn release_with(
        &mut self,
        given: &impl Given,
        velocity: impl Fn(DriverId) -> f64,
    ) -> Result<(), Error> {
        if let Some(free) = &mut self.free {
            // Nothing is left of a motion before, such as the length of its steps.
            free.motion.resume(&self.solver, &free.fresh)?;
            free.motion.restart(&mut self.solver, given, velocity)?;
            free.is_released = true;
            self.arrive(Way::Told);
        }
        Ok(())
    }

    /// Returns whether freedoms move by the forces.
    #[must_use]
    pub fn is_released(&self) -> bool {
        self.free.as_ref().is_some_and(|free| free.is_released)
    }

    /// Holds freedoms, which move along paths as drivers do, until they are [released](Self::release).
    pub fn hold(&mut self) {
        if let Some(free) = &mut self.free {
            free.is_released = false;
        }
    }

    /// Takes the solver of the file's own coordinates, which is at any pose then, and holds freedoms if
    /// others were in use. Returns whether they were.
    pub fn take_own(&mut self) -> bool {
        let Some(free) = &mut self.free else {
            return false;
        };
        let is_other = free.motion.charts.current() != free.fresh.coordinates;
        if is_other {
            let selected = (free.motion).select(&mut self.solver, &mut self.solution, &free.fresh);
            debug_assert!(selected.is_ok(), "the file's own coordinates");
            free.is_released = false;
        }
        is_other
    }

    /// Returns a copy of the state.
    #[must_use]
    pub fn state(&self) -> MotionState {
        let free = self.free.as_ref().filter(|free| free.is_released);
        MotionState {
            pose: self.pose().clone(),
            free: free.map(|free| {
                let mut choices = SolverChoices::default();
                self.solver.copy_choices(&mut choices);
                (choices, free.motion.state())
            }),
        }
    }

    /// Goes on from a state of the same mechanism; a free motion with the same bits.
    pub fn resume(&mut self, state: &MotionState) {
        if let Some((choices, free)) = &state.free {
            self.return_to(&state.pose, choices, Some(free));
            let resumed = self.resume_free(free);
            debug_assert!(resumed.is_ok(), "it was there before");
            self.take_rates();
        } else {
            self.take_own();
            self.hold();
            self.solver.restore(&state.pose);
            self.arrive(Way::Told);
        }
    }

    /// Brings the motion of the same mechanism with other forces to where this one is, with the same rates;
    /// its freedoms are held there.
    pub fn carry(&self, other: &mut Self) {
        let free = self.free().map(FreeMotion::state);
        // Crossings belong to a solver.
        let mut pose = self.pose().clone();
        pose.crossings.clear();
        let mut choices = SolverChoices::default();
        self.solver.copy_choices(&mut choices);
        other.return_to(&pose, &choices, free.as_ref());
        other.hold();
        let (from, to) = (&self.solution, &mut other.solution);
        to.driver_rates.clone_from(&from.driver_rates);
        let common = from.loads.len().min(to.loads.len());
        to.loads[..common].copy_from_slice(&from.loads[..common]);
    }

    /// Gives the solver the usual budget of a step.
    pub fn renew_budget(&mut self) {
        let budget = Budget::usual(self.mechanism());
        self.solver.set_budget(budget);
    }

    /// Follows a path from the pose to its end, without freedoms that move.
    ///
    /// # Errors
    ///
    /// [`Blocked`] if the path cannot be followed to its end; the pose is then the last one reached.
    pub fn follow(&mut self, path: &Path) -> Result<Progress, Blocked> {
        self.follow_by(|solver| solver.track(path))
    }

    /// As [`follow`](Self::follow), by another way of tracking.
    ///
    /// # Errors
    ///
    /// As [`follow`](Self::follow).
    #[inline]
    pub fn follow_by(
        &mut self,
        track: impl FnOnce(&mut Solver) -> Result<Progress, Blocked>,
    ) -> Result<Progress, Blocked> {
        let followed = track(&mut self.solver);
        self.arrive(match followed {
            Ok(_) => Way::Passed,
            Err(_) => Way::Stopped,
        });
        followed
    }

    /// Moves on to a time. While freedoms are held, the mechanism follows `path`, which ends at that time.
    /// Once they are released, the mechanism first jumps to the inputs `given` at the present time and to
    /// the parameters at the end of the path; then the forces move it, up to the first event if it
    /// [ends](Self::ends_at_events) there.
    ///
    /// # Errors
    ///
    /// The reason for which it stops; the mechanism is then at the last pose reached.
    pub fn advance(&mut self, path: &Path, given: &impl Given, until: f64) -> Result<(), Stop> {
        let Some(free) = self.free.as_mut().filter(|free| free.is_released) else {
            return self.follow(path).map(drop).map_err(Stop::Blocked);
        };
        let (free, solver, solution) = (&mut free.motion, &mut self.solver, &mut self.solution);
        let advance = if self.ends_at_events {
            FreeMotion::advance_to_event
        } else {
            FreeMotion::advance
        };
        let advanced = free
            .jump(solver, given, &path.to)
            .and_then(|()| advance(free, solver, solution, given, until));
        self.arrive(match advanced {
            Ok(()) => Way::Passed,
            Err(_) => Way::Stopped,
        });
        advanced.map_err(Stop::Free)
    }

    /// Notes that the pose is another one.
    #[inline]
    fn arrive(&mut self, way: Way) {
        self.way = way;
        self.knows_contacts = false;
    }

    /// Takes over the rates of prescribed motions at the pose, and those of a free motion with its passive
    /// forces.
    pub fn take_rates(&mut self) {
        self.solution.follow_motions(&self.solver);
        if let Some(free) = self.free.as_ref().filter(|free| free.is_released) {
            free.motion.tell(&mut self.solution);
        }
    }

    /// Solves rates and forces at the pose, for the rates of drivers and the loads in the solution.
    ///
    /// # Errors
    ///
    /// They do not exist at a singular position.
    pub fn solve(&mut self) -> Result<(), kinematics::Error> {
        if self.watches_contacts {
            self.solution.solve_rates(&mut self.solver)?;
            // Forces may exist at fewer poses than the values that are asked for.
            let _ = self.solve_forces(ForceParts::REACTIONS);
            return Ok(());
        }
        self.solution.solve(&mut self.solver)?;
        self.knows_contacts = true;
        Ok(())
    }

    /// Solves these parts of the forces at the pose, for the rates there and the loads in the solution.
    ///
    /// # Errors
    ///
    /// Those of [`Solution::solve_forces`].
    pub fn solve_forces(&mut self, parts: ForceParts) -> Result<(), kinematics::Error> {
        let solved = self.solution.solve_forces(&mut self.solver, parts);
        self.knows_contacts = parts.reactions && solved.is_ok();
        solved
    }

    /// Returns the value of an output \[SI\], not a number for a force unless forces are sought.
    #[must_use]
    pub fn value(&self, output: &Output) -> f64 {
        self.solution.value(&self.solver, output)
    }

    /// Returns the directions at the pose: those of a free motion have changed with it.
    ///
    /// # Errors
    ///
    /// They do not exist, as at a singular position.
    pub fn directions<'a>(&mut self, own: &'a [Direction]) -> Result<Cow<'a, [Direction]>, Error> {
        let Some((free, solver, solution)) = self.parts() else {
            return Ok(Cow::Borrowed(own));
        };
        let varied = free.varied(solver, solution);
        varied.map(Cow::Owned)
    }

    /// Moves to the stable equilibrium downhill; see [`FreeMotion::balance`].
    ///
    /// # Errors
    ///
    /// [`Error::NoFreedom`] without freedoms, and those of [`FreeMotion::balance`].
    pub fn balance(&mut self, given: &impl Given) -> Result<Equilibrium, Error> {
        let (free, solver, solution) = self.parts().ok_or(Error::NoFreedom)?;
        free.balance(solver, solution, given)
    }

    /// Finds the stable equilibria downhill from places all over the range of the freedoms; see
    /// [`FreeMotion::balances`].
    ///
    /// # Errors
    ///
    /// As [`balance`](Self::balance).
    pub fn balances(&mut self, given: &impl Given) -> Result<Vec<Equilibrium>, Error> {
        let (free, solver, solution) = self.parts().ok_or(Error::NoFreedom)?;
        free.balances(solver, solution, given)
    }

    /// Linearizes the motion at the pose, for the rates and loads in the solution; see
    /// [`FreeMotion::linearize`].
    ///
    /// # Errors
    ///
    /// As [`balance`](Self::balance).
    pub fn linearize(&mut self, outputs: &[Output]) -> Result<StateSpace, Error> {
        let (free, solver, solution) = self.parts().ok_or(Error::NoFreedom)?;
        free.linearize(solver, solution, outputs)
    }
}

impl Stop {
    /// Describes what stops a mechanism, when, and at which values of the moving drivers: those with a
    /// prescribed motion and those that are `fed`.
    #[must_use]
    pub fn describe(&self, motion: &Motion, fed: impl Fn(DriverId) -> bool) -> String {
        let (mechanism, pose) = (motion.mechanism(), motion.pose());
        match self {
            Self::Blocked(blocked) => {
                blocked.describe(mechanism, pose, Some(pose.time), |driver| {
                    mechanism.drivers[driver.index()].motion().is_some() || fed(driver)
                })
            }
            Self::Free(error) => error.to_string(),
        }
    }
}

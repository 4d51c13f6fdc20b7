//! The free motion of a session, and its states.

use crate::dynamics::{Error, Event, FreeMotion, FreeState, Given, Overlap};
use crate::kinematics::{Budget, Pose, Solution, Solver, SolverChoices};
use crate::mechanism::{DriverId, Jet, Mechanism};

/// The motion of the freedoms.
pub(super) struct Freedoms {
    pub(super) motion: FreeMotion,
    /// The state of a motion that has not begun, in the file's own coordinates.
    fresh: FreeState,
    /// Whether the motion is at the solver's pose; otherwise it begins there.
    pub(super) is_released: bool,
    /// The events of the motion, while a chart is computed.
    pub(super) events: Option<Vec<Event>>,
    /// Parts that overlapped, not told yet.
    overlaps: Vec<Overlap>,
}

impl Freedoms {
    /// Makes the motion of a solver's mechanism; `None` without freedoms.
    pub(super) fn new(solver: &Solver) -> Result<Option<Self>, Error> {
        let tolerance = solver.mechanism().simulation.tolerance;
        let motion = FreeMotion::new(solver, tolerance)?;
        Ok(motion.map(|motion| Self {
            fresh: motion.state(),
            motion,
            is_released: false,
            events: None,
            overlaps: Vec::new(),
        }))
    }

    /// Begins the motion at the solver's pose, unless it is there; returns whether it has begun. A
    /// motion that begins has nothing of an earlier one.
    pub(super) fn release(
        &mut self,
        solver: &mut Solver,
        solution: &Solution,
    ) -> Result<bool, Error> {
        if self.is_released {
            return Ok(false);
        }
        let inputs = Inputs::new(solver.pose(), solution);
        self.motion.resume(solver, &self.fresh)?;
        let velocity = |freedom: DriverId| inputs.drivers[freedom.index()].first();
        self.motion.restart(solver, &inputs, velocity)?;
        self.overlaps.extend(self.motion.overlaps());
        self.is_released = true;
        Ok(true)
    }

    /// Moves on to a time, with the inputs as they are now and the budget of a step.
    pub(super) fn advance(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        time: f64,
    ) -> Result<(), Error> {
        solver.set_budget(Budget::usual(solver.mechanism()));
        let advanced = self.go_on(solver, solution, time);
        solver.set_budget(Budget::UNLIMITED);
        advanced
    }

    fn go_on(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        time: f64,
    ) -> Result<(), Error> {
        let inputs = Inputs::new(solver.pose(), solution);
        let parameters = solver.pose().parameters.clone();
        self.motion.jump(solver, &inputs, &parameters)?;
        self.overlaps.extend(self.motion.overlaps());
        let advanced = self.motion.advance(solver, solution, &inputs, time);
        let events = self.motion.events();
        match &mut self.events {
            Some(known) => known.extend(events),
            None => events.for_each(drop),
        }
        advanced
    }

    /// Returns descriptions of what has overlapped since the last call.
    pub(super) fn overlaps(&mut self, mechanism: &Mechanism) -> Vec<String> {
        let overlaps = self.overlaps.drain(..);
        overlaps
            .map(|overlap| overlap.describe(mechanism))
            .collect()
    }

    /// Makes the solver that of the file's own coordinates, anywhere. Returns whether it was another
    /// one.
    pub(super) fn take_own(&mut self, solver: &mut Solver, solution: &mut Solution) -> bool {
        let is_other = self.motion.state().coordinates != self.fresh.coordinates;
        let selected = self.motion.select(solver, solution, &self.fresh);
        debug_assert!(selected.is_ok(), "they were in use");
        is_other
    }
}

/// A solver of a mechanism with freedoms, with all that moves along.
pub(super) struct Carrier {
    pub(super) solver: Solver,
    pub(super) solution: Solution,
    pub(super) freedoms: Freedoms,
}

impl Freedoms {
    /// Brings another carrier of the same mechanism, but for its forces, to where this one is. The
    /// motion begins anew there, with the rates that it has.
    pub(super) fn carry(&self, solver: &Solver, solution: &Solution, to: &mut Carrier) {
        let Carrier {
            solver: other,
            solution: others,
            freedoms,
        } = to;
        let selected = freedoms.motion.select(other, others, &self.motion.state());
        debug_assert!(selected.is_ok(), "forces change no coordinates");
        // Crossings belong to a solver.
        let mut pose = solver.pose().clone();
        pose.crossings.clear();
        let mut choices = SolverChoices::default();
        solver.copy_choices(&mut choices);
        let resumed = other.resume(&pose, &choices);
        debug_assert!(resumed, "forces change no equations");
        others.driver_rates.clone_from(&solution.driver_rates);
        let common = solution.loads.len().min(others.loads.len());
        others.loads[..common].copy_from_slice(&solution.loads[..common]);
        freedoms.is_released = false;
    }
}

/// A pose, and the free motion there.
#[derive(Clone)]
pub(super) struct Moment {
    pub(super) pose: Pose,
    /// Nothing where no motion is, or where it has not begun.
    motion: Option<(SolverChoices, FreeState)>,
}

impl Moment {
    /// Notes where a solver is.
    pub(super) fn of(solver: &Solver, freedoms: Option<&Freedoms>) -> Self {
        let released = freedoms.filter(|freedoms| freedoms.is_released);
        Self {
            pose: solver.pose().clone(),
            motion: released.map(|freedoms| {
                let mut choices = SolverChoices::default();
                solver.copy_choices(&mut choices);
                (choices, freedoms.motion.state())
            }),
        }
    }

    /// Puts a solver of the same mechanism back: the motion goes on with the same bits.
    pub(super) fn restore(
        &self,
        solver: &mut Solver,
        solution: &mut Solution,
        freedoms: Option<&mut Freedoms>,
    ) {
        let Some(freedoms) = freedoms else {
            solver.restore(&self.pose);
            return;
        };
        let Some((choices, state)) = &self.motion else {
            freedoms.take_own(solver, solution);
            solver.restore(&self.pose);
            freedoms.is_released = false;
            return;
        };
        let motion = &mut freedoms.motion;
        let selected = motion.select(solver, solution, state);
        let resumed = solver.resume(&self.pose, choices);
        let goes_on = motion.resume(solver, state);
        debug_assert!(
            selected.is_ok() && resumed && goes_on.is_ok(),
            "it was there before"
        );
        freedoms.is_released = true;
        motion.tell(solution);
    }
}

/// The inputs from a pose on: drivers go on with their rates, forces stay.
struct Inputs {
    time: f64,
    drivers: Vec<Jet>,
    loads: Vec<f64>,
}

impl Inputs {
    fn new(pose: &Pose, solution: &Solution) -> Self {
        let drivers = pose.drivers.iter().zip(&solution.driver_rates);
        let drivers = drivers.map(|(value, rates)| Jet::new(*value, rates.derivatives));
        Self {
            time: pose.time,
            drivers: drivers.collect(),
            loads: solution.loads.clone(),
        }
    }
}

impl Given for Inputs {
    fn driver(&self, driver: DriverId, time: f64) -> Jet {
        let Jet { value, derivatives } = self.drivers[driver.index()];
        let [velocity, acceleration] = derivatives;
        let tau = time - self.time;
        Jet::new(
            value + tau * (velocity + 0.5 * tau * acceleration),
            [velocity + tau * acceleration, acceleration],
        )
    }

    fn loads(&self, _: f64, loads: &mut [f64]) {
        loads.copy_from_slice(&self.loads[..loads.len()]);
    }
}

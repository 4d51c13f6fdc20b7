//! The free motion of a mechanism.

#[cfg(test)]
mod tests;

use std::sync::Arc;

use nalgebra::DMatrix;

use super::charts::Charts;
use super::equations::Equations;
use super::error::Error;
use super::event::Event;
use super::event::EventKind;
use super::free_state::FreeState;
use super::function::FUNCTIONS;
use super::given::Given;
use super::integrator::{ErrorControl, Integrator, Invalid, Method, Statistics};
use super::overlap::Overlap;
use super::trials::Trials;
use crate::kinematics::{Direction, Pose, Rates, Solution, Solver};
use crate::mechanism::{BeyondPoints, DriverId, Jet};

/// Time to the end of a curve at which the motion is there, as a part of the time or of the way to go:
/// some roundings.
const AT_END: f64 = 1e-14;
/// Part of the time to the end of a curve by which a step ends in front of it: the motion between the
/// ends of a step is known less well than the ends, and a step that ends beyond is in vain.
const SHORT_OF_END: f64 = 1e-4;
/// Distance of a held coordinate from its place at which a host's integration is corrected, in gaps that
/// are rounding: 1e-10 radians or sizes of the mechanism.
const DRIFT: f64 = 1e4;

/// The motion of a mechanism with freedoms: their values and velocities, and the integrator.
///
/// It moves a [`Solver`] of the mechanism, whose pose it expects where it left it.
#[derive(Debug)]
pub struct FreeMotion {
    pub(super) equations: Equations,
    integrator: Integrator,
    tolerance: f64,
    /// The mechanism's size at the start \[m\].
    size: f64,
    pub(super) charts: Charts,
    /// Values and velocities of the freedoms, and the work done since the energy was noted.
    pub(super) x: Vec<f64>,
    /// Energy of the bodies without that of springs when the work was zero \[J\].
    energy: f64,
    /// Events that nobody has read.
    events: Vec<Event>,
    /// Parts that overlapped, of which nobody has read.
    overlaps: Vec<Overlap>,
}

impl FreeMotion {
    /// Makes the motion of a mechanism at a solver's pose, with the velocities of its file. `None`
    /// for a mechanism without freedoms.
    ///
    /// # Errors
    ///
    /// [`Error::Integrator`] for a tolerance that is none.
    pub fn new(solver: &Solver, tolerance: f64) -> Result<Option<Self>, Error> {
        Self::along(solver, tolerance, Vec::new())
    }

    /// Makes the motion with its derivatives along directions, in which the changes of freedoms are
    /// those at the start. It is integrated by the explicit method then.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn along(
        solver: &Solver,
        tolerance: f64,
        directions: Vec<Direction>,
    ) -> Result<Option<Self>, Error> {
        let method = if directions.is_empty() {
            Method::Automatic
        } else {
            Method::Explicit
        };
        let equations = Equations::new(solver, directions);
        if equations.freedoms.is_empty() {
            return Ok(None);
        }
        let count = equations.freedoms.len();
        let mut x = vec![0.0; 2 * count + 1 + equations.variations()];
        write_start(&equations.freedoms, solver.pose(), &mut x);
        let (charts, size) = (
            Charts::new(solver.mechanism(), &equations.freedoms),
            solver.size(),
        );
        let control = ErrorControl::new(tolerance, charts.scales(size, x.len()));
        let control = control.map_err(unusable)?;
        let start = solver.pose().time;
        let integrator = Integrator::new(method, control, start, x.clone());
        let integrator = integrator.map_err(unusable)?;
        Ok(Some(Self {
            tolerance,
            size,
            charts,
            equations,
            integrator,
            x,
            energy: 0.0,
            events: Vec::new(),
            overlaps: Vec::new(),
        }))
    }

    /// Returns the freedoms among the drivers, ascending.
    #[must_use]
    pub fn freedoms(&self) -> &[DriverId] {
        &self.equations.freedoms
    }

    /// Returns value, velocity and acceleration of each driver at the present time \[SI\].
    #[must_use]
    pub fn drivers(&self) -> &[Jet] {
        &self.equations.accepted.drivers
    }

    /// Returns the energy that the motion has gained without a cause \[J\]: kinetic and potential
    /// energy, less the work of all that acts on the bodies, since the start or the last jump.
    #[must_use]
    pub fn energy_error(&self) -> f64 {
        let work = self.integrator.state().x[2 * self.freedoms().len()];
        self.equations.accepted.energy - self.energy - work
    }

    /// Sets the relative tolerance.
    ///
    /// # Errors
    ///
    /// [`Error::Integrator`] unless it is above 0 and below 1.
    pub fn set_tolerance(&mut self, tolerance: f64) -> Result<(), Error> {
        if tolerance.to_bits() != self.tolerance.to_bits() {
            self.set_control(tolerance)?;
            self.tolerance = tolerance;
        }
        Ok(())
    }

    /// Controls errors with a tolerance in the coordinates in use.
    fn set_control(&mut self, tolerance: f64) -> Result<(), Error> {
        let control = ErrorControl::new(tolerance, self.charts.scales(self.size, self.x.len()));
        control
            .and_then(|control| self.integrator.set_control(control))
            .map_err(unusable)
    }

    /// Controls errors in the coordinates in use, after a change of these.
    pub(super) fn renew_control(&mut self) -> Result<(), Error> {
        self.set_control(self.tolerance)
    }

    /// Returns the natural size of each freedom's value.
    pub(super) fn scales(&self) -> Vec<f64> {
        self.charts.scales(self.size, self.freedoms().len())
    }

    /// Returns J of the freedoms at the last point at which accelerations were solved.
    #[must_use]
    pub fn inertia(&self) -> DMatrix<f64> {
        let inertia = &self.equations.motion().inertia;
        let index = |k: usize| self.freedoms()[k].index();
        let count = self.freedoms().len();
        DMatrix::from_fn(count, count, |i, j| inertia[(index(i), index(j))])
    }

    /// Returns the integrator's work.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        self.integrator.state().statistics
    }

    /// Returns the velocities of the freedoms \[m/s or rad/s\].
    pub fn velocities(&self) -> impl Iterator<Item = f64> {
        let count = self.freedoms().len();
        self.integrator.state().x[count..2 * count].iter().copied()
    }

    /// Returns a copy of the state.
    #[must_use]
    pub fn state(&self) -> FreeState {
        let accepted = &self.equations.accepted;
        FreeState {
            integrator: self.integrator.state().clone(),
            tolerance: self.tolerance,
            coordinates: self.charts.current().to_vec(),
            drivers: accepted.drivers.clone(),
            loads: accepted.loads.clone(),
            modes: self.equations.passive.state().collect(),
            passive: accepted.passive.clone(),
            corners: self.equations.turns.accepted.clone(),
            energies: self.energies(),
        }
    }

    /// Writes the state over one of the same mechanism. Allocates nothing.
    pub fn save(&self, state: &mut FreeState) {
        let accepted = &self.equations.accepted;
        state.integrator.copy_from(self.integrator.state());
        state.tolerance = self.tolerance;
        state.coordinates.copy_from_slice(self.charts.current());
        state.drivers.copy_from_slice(&accepted.drivers);
        state.loads.copy_from_slice(&accepted.loads);
        let modes = state.modes.iter_mut().zip(self.equations.passive.state());
        modes.for_each(|(to, mode)| *to = mode);
        state.passive.copy_from_slice(&accepted.passive);
        state.corners.clone_from(&self.equations.turns.accepted);
        state.energies = self.energies();
    }

    /// Returns the energies of a state.
    fn energies(&self) -> [f64; 3] {
        let accepted = &self.equations.accepted;
        [accepted.energy, accepted.kinetic_energy, self.energy]
    }

    /// Makes the solver that of the coordinates of a state, at any pose, gives the solution its forces,
    /// and takes over the modes of passive forces.
    ///
    /// # Errors
    ///
    /// [`Error::Integrator`] for coordinates that are none of the mechanism.
    pub fn select(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        state: &FreeState,
    ) -> Result<(), Error> {
        self.equations.passive.resume(&state.modes);
        if self.charts.current() == state.coordinates {
            return Ok(());
        }
        let forces = &mut self.equations.forces;
        if !(self.charts).select(solver, forces, solution, &state.coordinates) {
            let why = "its coordinates are none of this mechanism";
            return Err(Error::Integrator(why.to_owned()));
        }
        self.renew_control()
    }

    /// Goes on from a state of the same mechanism, with the solver [of its coordinates](Self::select)
    /// at the pose that belongs to it.
    ///
    /// # Errors
    ///
    /// [`Error::Integrator`] for a state that no motion of this mechanism can have.
    pub fn resume(&mut self, solver: &Solver, state: &FreeState) -> Result<(), Error> {
        self.set_tolerance(state.tolerance)?;
        let restored = self.integrator.restore(&state.integrator);
        restored.map_err(unusable)?;
        self.energy = state.energies[2];
        self.equations.resume(solver, state);
        Ok(())
    }

    /// Writes the accelerations of the freedoms and the passive forces at the solver's pose into a
    /// solution that [seeks forces](Solution::seek_forces), for its rates and inputs of forces. The
    /// motion itself stays. Allocates nothing.
    ///
    /// # Errors
    ///
    /// They do not exist there.
    pub fn solve_accelerations(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
    ) -> Result<(), Error> {
        self.equations.solve_at(solver, solution)
    }

    /// Completes a direction by the changes of the freedoms' accelerations, at the pose at which they
    /// were [solved](Self::solve_accelerations) last: their efforts stay zero; and by those of passive
    /// forces. `rates` are those of q there.
    ///
    /// # Errors
    ///
    /// Those of [`Solver::force_sensitivity`].
    pub fn complete(
        &mut self,
        solver: &mut Solver,
        rates: &Rates,
        direction: &mut Direction,
    ) -> Result<(), Error> {
        self.equations.complete(solver, rates, direction)
    }

    /// Returns the changes of the motion along its directions at the pose and for the rates and loads of
    /// a solution, which belong to the accepted point.
    ///
    /// # Errors
    ///
    /// They do not exist there.
    pub fn varied(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
    ) -> Result<Vec<Direction>, Error> {
        self.solve_accelerations(solver, solution)?;
        let mut rates = Rates::new(solver.pose().q.len());
        let x = &self.integrator.state().x;
        self.equations.varied(solver, x, &mut rates)
    }

    /// Begins at the solver's pose, with the velocities of the file. Parts that overlap there are moved
    /// [apart](Self::overlaps).
    ///
    /// # Errors
    ///
    /// Accelerations do not exist there.
    pub fn start(&mut self, solver: &mut Solver, given: &impl Given) -> Result<(), Error> {
        let mechanism = Arc::clone(solver.mechanism());
        self.restart(solver, given, |freedom| {
            mechanism.drivers[freedom.index()].start_velocity()
        })
    }

    /// Begins at the solver's pose, with these velocities of the freedoms.
    ///
    /// # Errors
    ///
    /// Accelerations do not exist there.
    pub fn restart(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        velocity: impl Fn(DriverId) -> f64,
    ) -> Result<(), Error> {
        self.equations.passive.reset();
        self.equations.beyond.fill(None);
        self.events.clear();
        self.go_on_with(solver, given, velocity)?;
        // Rest, sticking and the push of an elastic stop have begun before the start.
        let Equations {
            passive, accepted, ..
        } = &self.equations;
        let is_inside = |event: &Event| {
            let mut all = accepted.passive.iter().enumerate();
            all.any(|(k, at)| passive.told(k) == event.force && at.is_inside())
        };
        self.events
            .retain(|event| matches!(event.kind, EventKind::Impact { .. }) && is_inside(event));
        Ok(())
    }

    /// Goes on from the solver's pose with these velocities of the freedoms, after an event.
    ///
    /// # Errors
    ///
    /// Accelerations do not exist there.
    pub fn go_on_with(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        velocity: impl Fn(DriverId) -> f64,
    ) -> Result<(), Error> {
        let count = self.freedoms().len();
        write_start(&self.equations.freedoms, solver.pose(), &mut self.x);
        let velocities = self.x[count..].iter_mut();
        for (x, freedom) in velocities.zip(&self.equations.freedoms) {
            *x = velocity(*freedom);
        }
        self.equations.write_variations(&mut self.x);
        self.renew(solver, given)
    }

    /// Moves the mechanism at once to the inputs at the present time and to `parameters`, while the
    /// freedoms keep their values and velocities, unless parts overlap then and are moved
    /// [apart](Self::overlaps).
    ///
    /// # Errors
    ///
    /// No continuous motion leads there; the mechanism stays at its pose.
    pub fn jump(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        parameters: &[f64],
    ) -> Result<(), Error> {
        let time = solver.pose().time;
        self.x.copy_from_slice(&self.integrator.state().x);
        self.equations.set_drivers(solver, given, time, &self.x);
        let pose = solver.pose();
        if pose.parameters == parameters && self.equations.is_at_point(pose) {
            return if self.equations.goes_on(solver.mechanism()) {
                Ok(())
            } else {
                self.renew(solver, given)
            };
        }
        if let Err(error) = self.equations.go(solver, time, Some(parameters)) {
            self.equations.return_to_accepted(solver);
            return Err(error);
        }
        self.renew(solver, given)
    }

    /// Moves the mechanism on to a time. Near a dead point of the coordinates in use it goes on in
    /// others: the solver is another one then, and the solution has its forces.
    ///
    /// # Errors
    ///
    /// The reason for which it stops; the mechanism is then where the last step of the integrator
    /// has left it, at the end of a curve to rounding.
    pub fn advance(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
        until: f64,
    ) -> Result<(), Error> {
        self.go(solver, solution, given, until, false)
    }

    /// As [`advance`](Self::advance), to the first event on the way if there is one: the time of the
    /// solver's pose tells. Contacts have bounced then, and friction has changed.
    ///
    /// # Errors
    ///
    /// As [`advance`](Self::advance).
    pub fn advance_to_event(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
        until: f64,
    ) -> Result<(), Error> {
        self.go(solver, solution, given, until, true)
    }

    /// Moves the mechanism on to a time, or to the first event.
    fn go(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
        until: f64,
        ends_at_event: bool,
    ) -> Result<(), Error> {
        // In front of the end of a curve a step ends at the time at which the end is expected.
        let mut end_of_curve = None;
        let start = self.integrator.state().t;
        let resolution = AT_END * start.abs().max((until - start).abs());
        let known = self.events.len();
        let mut corner = solver.next_corner(start, until);
        loop {
            let now = self.integrator.state().t;
            if now.to_bits() == until.to_bits() {
                // A motion that is restored here goes on with the same steps.
                self.equations.watch.begin();
                return Ok(());
            }
            if let Some([_, behind]) = corner.filter(|[before, _]| now >= *before) {
                self.pass_corner(solver, given, behind)?;
                if ends_at_event {
                    return Ok(());
                }
                corner = solver.next_corner(behind, until);
                continue;
            }
            end_of_curve = end_of_curve.filter(|end| *end > now);
            let expected = end_of_curve.or_else(|| self.equations.expected(now));
            let smooth_until = corner.map_or(until, |[before, _]| before);
            let goal = expected.map_or(smooth_until, |goal| goal.min(smooth_until));
            let mut trials = Trials {
                solver,
                equations: &mut self.equations,
                given,
                tolerance: self.tolerance,
                is_stiff: false,
            };
            match self
                .integrator
                .advance(&mut trials, goal)
                .map_err(Error::from)
            {
                Ok(_) if self.equations.is_at_event() => {
                    self.x.copy_from_slice(&self.integrator.state().x);
                    let delays = self.equations.reach_event(solver, given, &mut self.x)?;
                    self.equations.turns.begin();
                    self.settle(solver, given)?;
                    self.equations
                        .leave_event(solver, given, &delays, &mut self.x)?;
                    self.go_on(solver, given)?;
                    if ends_at_event {
                        return Ok(());
                    }
                }
                Ok(_) => {
                    self.exchange(solver, solution, given)?;
                }
                Err(error) => {
                    self.equations.return_to_accepted(solver);
                    match error {
                        Error::Stop { time, .. } if time - now > resolution => {
                            end_of_curve = Some(now + (1.0 - SHORT_OF_END) * (time - now));
                        }
                        Error::Spent { most, .. } => {
                            return Err(Error::Spent {
                                most,
                                time: now,
                                events: self.events.len() - known,
                            });
                        }
                        _ => return Err(error),
                    }
                }
            }
        }
    }

    /// Passes a corner of prescribed motions, to the time behind it.
    fn pass_corner(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        time: f64,
    ) -> Result<(), Error> {
        if !self.equations.directions.is_empty() {
            let reason = "where the velocity of a driver jumps";
            return Err(Error::NoDerivatives { time, reason });
        }
        self.x.copy_from_slice(&self.integrator.state().x);
        self.equations
            .pass_corner(solver, given, time, &mut self.x)?;
        self.settle(solver, given)?;
        self.go_on(solver, given)
    }

    /// Moves parts that overlap apart, and decides which stops are touched and which friction sticks, from
    /// the values in `x`.
    fn settle(&mut self, solver: &mut Solver, given: &impl Given) -> Result<(), Error> {
        let Self {
            equations,
            x,
            events,
            overlaps,
            ..
        } = self;
        // Between the velocities before and after an impact no motion can end.
        solver.overdraw(|solver| equations.settle(solver, given, x, events, overlaps))
    }

    /// Returns whether stops or friction act on the freedoms.
    #[must_use]
    pub fn has_passive_forces(&self) -> bool {
        !self.equations.passive.is_empty()
    }

    /// Returns an event indicator at the last point at which accelerations were solved: positive while
    /// the modes of passive forces last.
    #[must_use]
    pub fn event_indicator(&self, index: usize) -> f64 {
        let Equations {
            passive,
            point,
            turns,
            forces,
            ..
        } = &self.equations;
        let (place, side) = (index / FUNCTIONS, index % FUNCTIONS);
        let Some(group) = passive.groups().nth(place) else {
            let turn = index - passive.groups().count() * FUNCTIONS;
            return turns.indicator(turn, forces.corners());
        };
        let functions = group.filter_map(|k| passive.function(k, &point.passive[k], side));
        let indicators = functions.map(|function| function.indicator());
        indicators.reduce(f64::min).unwrap_or(1.0)
    }

    /// Returns whether held coordinates are off the places where they are held, at the last point at
    /// which accelerations were solved.
    #[must_use]
    pub fn has_drifted(&self) -> bool {
        let Equations { passive, point, .. } = &self.equations;
        let off = |k: usize| {
            let at = &point.passive[k];
            let off = at.coordinate.value - passive.anchors[k];
            let slow = DRIFT * at.gap_rounding().max(at.speed_rounding());
            !at.is_dependent && off.abs().max(at.coordinate.first().abs()) > slow
        };
        (0..point.passive.len()).any(|k| passive.is_held(k) && off(k))
    }

    /// Returns the events since the last call.
    pub fn events(&mut self) -> impl Iterator<Item = Event> {
        self.events.drain(..)
    }

    /// Returns what has overlapped since the last call, at the start or where inputs or parameters jumped.
    pub fn overlaps(&mut self) -> impl Iterator<Item = Overlap> {
        self.overlaps.drain(..)
    }

    /// Returns what has overlapped and the events since the last call.
    pub(super) fn news(&mut self) -> (impl Iterator<Item = Overlap>, impl Iterator<Item = Event>) {
        (self.overlaps.drain(..), self.events.drain(..))
    }

    /// Moves the calls of functions beyond their points since the last call to where they are told.
    pub(super) fn take_beyond(&mut self, told: &mut [Option<(f64, BeyondPoints)>]) {
        for (told, found) in told.iter_mut().zip(&mut self.equations.beyond) {
            *told = told.or(found.take());
        }
    }

    /// Gives a solution the rates of all drivers and the passive forces at the accepted point. Those that
    /// are inputs stay.
    pub fn tell(&self, solution: &mut Solution) {
        let accepted = &self.equations.accepted;
        solution.driver_rates.copy_from_slice(&accepted.drivers);
        let passive = accepted.loads.iter().rev();
        let passive = passive.take(self.equations.passive.loads());
        for (load, passive) in solution.loads.iter_mut().rev().zip(passive) {
            *load = *passive;
        }
    }

    /// Returns the solver whose coordinates are the file's freedoms, given the one in use.
    #[must_use]
    pub fn own<'a>(&'a self, solver: &'a Solver) -> &'a Solver {
        self.charts.own(solver)
    }

    /// Returns whether the motion goes on better in other coordinates, from the pose at which
    /// accelerations were [solved](Self::solve_accelerations) last.
    pub fn wants_exchange(&mut self, solver: &Solver) -> bool {
        let better = self.charts.better(solver, self.equations.motion());
        better.is_some()
    }

    /// Goes on in other coordinates if the motion [goes on better](Self::wants_exchange) in them, and
    /// returns whether it does: the solver is another one then, and the solution has its forces.
    ///
    /// # Errors
    ///
    /// Accelerations do not exist there.
    pub fn exchange(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
    ) -> Result<bool, Error> {
        let better = self.charts.better(solver, self.equations.motion());
        let Some(coordinates) = better else {
            return Ok(false);
        };
        let Self {
            equations,
            integrator,
            charts,
            x,
            ..
        } = self;
        x.copy_from_slice(&integrator.state().x);
        if !charts.exchange(solver, equations, solution, coordinates, x)? {
            return Ok(false);
        }
        self.renew_control()?;
        self.go_on(solver, given)?;
        Ok(true)
    }

    /// Begins a smooth part of the motion at the solver's pose, with the values in `x`.
    fn renew(&mut self, solver: &mut Solver, given: &impl Given) -> Result<(), Error> {
        let count = self.freedoms().len();
        self.settle(solver, given)?;
        self.x[2 * count] = 0.0;
        self.go_on(solver, given)?;
        self.energy = self.equations.accepted.energy;
        Ok(())
    }

    /// Accepts the solver's pose with the values in `x`, from which the integrator goes on.
    fn go_on(&mut self, solver: &mut Solver, given: &impl Given) -> Result<(), Error> {
        let time = solver.pose().time;
        let restarted = self.integrator.restart_at(time, &self.x);
        restarted.map_err(unusable)?;
        self.equations.set_drivers(solver, given, time, &self.x);
        self.equations.write(solver, &mut self.x)?;
        self.equations.accept(solver);
        Ok(())
    }
}

/// Writes the values of the freedoms at a pose.
pub(super) fn write_start(freedoms: &[DriverId], pose: &Pose, x: &mut [f64]) {
    for (x, freedom) in x.iter_mut().zip(freedoms) {
        *x = pose.drivers[freedom.index()];
    }
}

/// Returns the error of what the integrator refuses.
fn unusable(invalid: Invalid) -> Error {
    Error::Integrator(invalid.to_string())
}

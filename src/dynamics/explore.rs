//! The search for several equilibria: from places all over the range of the freedoms.

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use nalgebra::DVector;

use super::balance::{Equilibrium, LONGEST};
use super::error::Error;
use super::given::Given;
use super::motion::FreeMotion;
use super::statics::longest;
use crate::kinematics::{Blocked, Pose, Reason, Solution, Solver};

/// A pose, with the coordinates of its solver.
#[derive(Clone)]
struct PoseInChart {
    coordinates: Vec<usize>,
    pose: Pose,
}

impl FreeMotion {
    /// Finds the stable equilibria to which the mechanism comes down, with all inputs held, from places
    /// all over the range of its freedoms that it reaches from the solver's pose. A single freedom goes
    /// round once, or as far as it can: there is a place for each minimum of the energy that is not
    /// narrower than a step. Several go around each angle, and as far along each length, in a grid of
    /// places. Friction holds at the first place alone, the solver's pose. There may be other equilibria.
    ///
    /// # Errors
    ///
    /// [`Error::NoEquilibrium`] if none is found.
    pub fn balances(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
    ) -> Result<Vec<Equilibrium>, Error> {
        let home = self.here(solver);
        let places = match self.freedoms().len() {
            1 => self.valleys(solver, solution, given, &home)?,
            _ => self.grid(solver, solution, given, &home)?,
        };
        let mut found: Vec<(Pose, Equilibrium)> = Vec::new();
        for (number, place) in places.iter().enumerate() {
            self.return_to(solver, solution, place)?;
            let balanced = match number {
                0 => self.balance(solver, solution, given),
                _ => self.balance_with(solver, solution, given, Vec::new()),
            };
            let Ok(equilibrium) = balanced else {
                continue;
            };
            if !found.iter().any(|(pose, _)| solver.is_near(pose)) {
                found.push((solver.pose().clone(), equilibrium));
            }
        }
        if found.is_empty() {
            Err(Error::NoEquilibrium)
        } else {
            Ok(found.into_iter().map(|(_, found)| found).collect())
        }
    }

    /// Returns places in front of which and behind which the only freedom is driven towards each other,
    /// and those in front of obstacles, once round or as far as it can; first the place at home.
    fn valleys(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
        home: &PoseInChart,
    ) -> Result<Vec<PoseInChart>, Error> {
        /// Step in radians or sizes of the mechanism: three degrees.
        const STEP: f64 = 0.05;
        /// Longest way to one side: two turns, as other coordinates than a crank's angle may be slower.
        const MOST_WAY: f64 = 2.0 * TAU;
        let mut places = vec![(0.0, home.clone())];
        let mut end = f64::INFINITY;
        for sign in [1.0, -1.0] {
            self.return_to(solver, solution, home)?;
            let way = DVector::from_vec(self.scales()) * sign * MOST_WAY;
            let (mut length, mut before, mut led_on) = (0.0, home.clone(), false);
            let mut round = None;
            let blocked = self.walk(
                solver,
                solution,
                given,
                &way,
                STEP,
                |motion, solver, step| {
                    length += step.dot(&(motion.inertia() * step)).sqrt();
                    let (force, _) = motion.forces_at_rest(solver, &[])?;
                    let leads_on = force.dot(step) > 0.0;
                    if led_on && !leads_on {
                        places.push((length, before.clone()));
                    }
                    led_on = leads_on;
                    before = motion.here(solver);
                    if motion.comes_home(solver, step, &home.pose) {
                        round = Some(length);
                        return Ok(ControlFlow::Break(()));
                    }
                    Ok(if length > end {
                        ControlFlow::Break(())
                    } else {
                        ControlFlow::Continue(())
                    })
                },
            )?;
            if blocked {
                places.push((length, self.here(solver)));
            }
            if let Some(round) = round.filter(|_| sign > 0.0) {
                // Half way round to each side.
                end = 0.5 * round;
                places.retain(|(length, _)| *length <= end);
            }
        }
        Ok(places.into_iter().map(|(_, place)| place).collect())
    }

    /// Returns whether the next step of the only freedom leads over the pose at home, but for whole turns.
    fn comes_home(&self, solver: &mut Solver, step: &DVector<f64>, home: &Pose) -> bool {
        /// Difference from the pose at home, in radians and sizes of the mechanism, within a step, in which
        /// bodies move by some times it.
        const WITHIN_A_STEP: f64 = 0.5;
        /// The same at home: far above rounding, far below another pose with the same value of the
        /// freedom.
        const SAME: f64 = 1e-6;
        if !is_near_but_for_turns(solver, home, WITHIN_A_STEP) {
            return false;
        }
        let start = solver.pose().clone();
        solver.restore(home);
        let there = self.charts.values(solver)[0];
        solver.restore(&start);
        let driver = self.freedoms()[0].index();
        let mut ahead = there - start.drivers[driver];
        if solver.mechanism().drivers[driver]
            .coordinate
            .kind
            .is_angle()
        {
            ahead -= TAU * (ahead / TAU).round();
        }
        if !(0.0..1.0).contains(&(ahead / step[0])) {
            return false;
        }
        let goes = self.go_by(solver, &DVector::from_element(1, ahead), false);
        let is_same = goes.is_ok() && is_near_but_for_turns(solver, home, SAME);
        solver.restore(&start);
        is_same
    }

    /// Returns places in a grid round that at home, which is the first.
    fn grid(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
        home: &PoseInChart,
    ) -> Result<Vec<PoseInChart>, Error> {
        /// Places along one freedom: a maximum of the energy, or a dead point, stands between two
        /// equilibria, and three of each in a turn are many.
        const MOST_PLACES: usize = 6;
        /// Places in all.
        const MOST_STARTS: usize = 6 * 6 * 6;
        let scales = self.scales();
        let freedoms = u32::try_from(scales.len()).unwrap_or(u32::MAX);
        let fits = |places: &usize| {
            let starts = places.checked_pow(freedoms);
            starts.is_some_and(|starts| starts <= MOST_STARTS)
        };
        let places = (2..=MOST_PLACES).rev().find(fits).unwrap_or(1);
        let starts = places.checked_pow(freedoms).unwrap_or(1);
        let mut found = vec![home.clone()];
        for start in 1..starts {
            self.return_to(solver, solution, home)?;
            let mut rest = start;
            // One after the other: a stop in front of one leaves the way of the others.
            for freedom in 0..scales.len() {
                let place = rest % places;
                rest /= places;
                // From the middle alternately to both sides.
                let steps = place.div_ceil(2) as f64 * if place % 2 == 0 { 1.0 } else { -1.0 };
                let mut way = DVector::zeros(scales.len());
                way[freedom] = TAU / places as f64 * self.scales()[freedom] * steps;
                let goes_on =
                    |_: &mut Self, _: &mut Solver, _: &DVector<f64>| Ok(ControlFlow::Continue(()));
                self.walk(solver, solution, given, &way, LONGEST, goes_on)?;
            }
            found.push(self.here(solver));
        }
        Ok(found)
    }

    /// Moves the mechanism by changes of the freedoms' values in steps, in good coordinates all the way,
    /// and calls `each` at the end of each step with the equations at rest there and the step; it may end
    /// the way. Returns whether an obstacle ends it.
    fn walk(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
        changes: &DVector<f64>,
        most: f64,
        mut each: impl FnMut(&mut Self, &mut Solver, &DVector<f64>) -> Result<ControlFlow<()>, Error>,
    ) -> Result<bool, Error> {
        let count = changes.len();
        let way = longest(changes, &self.scales());
        let steps = (way / most).ceil();
        let mut step = changes / steps;
        for _ in 0..steps as usize {
            let start = solver.pose().clone();
            if let Err(Blocked { reason, .. }) = self.go_by(solver, &step, true) {
                if !matches!(reason, Reason::Stop(_)) {
                    solver.restore(&start);
                }
                return Ok(true);
            }
            if self.stand(solver, given).is_err() {
                solver.restore(&start);
                return Ok(true);
            }
            if each(self, solver, &step)?.is_break() {
                break;
            }
            if let Some(coordinates) = self.charts.better(solver, self.equations.motion()) {
                // The direction as a velocity, which is exchanged as well.
                self.place(solver, given, step.as_slice())?;
                if self.change_chart(solver, solution, coordinates)? {
                    step.copy_from_slice(&self.x[count..2 * count]);
                    step *= way / steps / longest(&step, &self.scales());
                }
            }
        }
        Ok(false)
    }

    /// Returns the place at which the solver is.
    fn here(&self, solver: &Solver) -> PoseInChart {
        PoseInChart {
            coordinates: self.charts.current().to_vec(),
            pose: solver.pose().clone(),
        }
    }

    /// Puts the solver to a place, in the coordinates that it had there.
    fn return_to(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        place: &PoseInChart,
    ) -> Result<(), Error> {
        let forces = &mut self.equations.forces;
        let is_chart = (self.charts).select(solver, forces, solution, &place.coordinates);
        debug_assert!(is_chart, "these coordinates were in use");
        solver.restore(&place.pose);
        self.equations.accept(solver);
        self.renew_control()
    }
}

/// Returns whether all bodies are where they are at another pose, up to whole turns and a distance in radians
/// and sizes of the mechanism.
fn is_near_but_for_turns(solver: &Solver, pose: &Pose, distance: f64) -> bool {
    let size = solver.size();
    let pairs = solver.pose().q.iter().zip(&pose.q);
    let mut bodies = pairs.take(3 * solver.mechanism().bodies.len()).enumerate();
    bodies.all(|(k, (now, then))| match k % 3 {
        2 => ((now - then + PI).rem_euclid(TAU) - PI).abs() < distance,
        _ => (now - then).abs() < distance * size,
    })
}

//! Linearisation at a pose, and static equilibrium.

use std::f64::consts::TAU;

use nalgebra::{Cholesky, DMatrix, DVector};

use super::error::Error;
use super::given::Given;
use super::motion::FreeMotion;
use crate::kinematics::{Curve, Direction, Output, Path, Pose, Solution, Solver};
use crate::mechanism::{DriverId, Mechanism, Order};

/// The linear equations of small motions about a pose: δẋ = A δx + B δu, δy = C δx + D δu.
#[derive(Clone, Debug)]
pub struct StateSpace {
    /// Names of the states: value and velocity of each freedom.
    pub states: Vec<String>,
    /// Names of the inputs: sizes of forces, then value, velocity and acceleration of each driver that
    /// is an input.
    pub inputs: Vec<String>,
    /// Names of the outputs.
    pub outputs: Vec<String>,
    /// ∂ẋ/∂x \[SI\].
    pub a: DMatrix<f64>,
    /// ∂ẋ/∂u \[SI\].
    pub b: DMatrix<f64>,
    /// ∂y/∂x \[SI\].
    pub c: DMatrix<f64>,
    /// ∂y/∂u \[SI\].
    pub d: DMatrix<f64>,
}

impl StateSpace {
    /// Returns A, B, C and D by rows.
    #[must_use]
    pub fn matrices(&self) -> [Vec<Vec<f64>>; 4] {
        [&self.a, &self.b, &self.c, &self.d].map(|matrix| {
            let rows = matrix.row_iter();
            rows.map(|row| row.iter().copied().collect()).collect()
        })
    }
}

/// A direction in which states or inputs change.
#[derive(Clone, Copy, Debug)]
enum Change {
    Driver(DriverId, Order),
    Force(usize),
}

impl FreeMotion {
    /// Linearises the motion at the solver's pose, for the rates of the drivers and the loads of a
    /// solution that [seeks forces](Solution::seek_forces). Exact to rounding.
    ///
    /// # Errors
    ///
    /// Accelerations or derivatives do not exist there.
    pub fn linearize(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        outputs: &[Output],
    ) -> Result<StateSpace, Error> {
        self.solve_accelerations(solver, solution)?;
        solution.solve(solver)?;
        let mechanism = solver.mechanism().clone();
        let (states, inputs) = (self.states(), inputs(&mechanism));
        let mut space = StateSpace {
            states: names(&mechanism, &states),
            inputs: names(&mechanism, &inputs),
            outputs: outputs.iter().map(|output| output.name.clone()).collect(),
            a: DMatrix::zeros(states.len(), states.len()),
            b: DMatrix::zeros(states.len(), inputs.len()),
            c: DMatrix::zeros(outputs.len(), states.len()),
            d: DMatrix::zeros(outputs.len(), inputs.len()),
        };
        for (column, change) in states.iter().enumerate() {
            let (rates, seen) = self.respond(solver, solution, outputs, *change)?;
            space.a.set_column(column, &rates);
            space.c.set_column(column, &seen);
        }
        for (column, change) in inputs.iter().enumerate() {
            let (rates, seen) = self.respond(solver, solution, outputs, *change)?;
            space.b.set_column(column, &rates);
            space.d.set_column(column, &seen);
        }
        Ok(space)
    }

    /// Returns value and velocity of each freedom.
    fn states(&self) -> Vec<Change> {
        let freedoms = self.freedoms().iter();
        let orders = [Order::Position, Order::Velocity];
        let states = freedoms.flat_map(|id| orders.map(|order| Change::Driver(*id, order)));
        states.collect()
    }

    /// Returns the changes of the states' derivatives and of outputs for a unit change.
    fn respond(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        outputs: &[Output],
        change: Change,
    ) -> Result<(DVector<f64>, DVector<f64>), Error> {
        let mechanism = solver.mechanism().clone();
        let mut direction = Direction::zero(&mechanism);
        let mut loads = vec![0.0; solution.loads.len()];
        match change {
            Change::Force(place) => loads[place] = 1.0,
            Change::Driver(driver, Order::Position) => {
                direction.drivers[driver.index()].value = 1.0;
            }
            Change::Driver(driver, order) => {
                direction.drivers[driver.index()].derivatives[order as usize - 1] = 1.0;
            }
        }
        self.complete(solver, &solution.rates, &mut direction, &mut loads)?;
        let freedoms = self.freedoms().iter();
        let rates = freedoms.flat_map(|id| direction.drivers[id.index()].derivatives);
        let rates = DVector::from_vec(rates.collect());
        let of_forces = solution.force_changes(solver, &direction, &loads)?;
        let sensitivity =
            solver.sensitivity(&solution.rates, &solution.driver_rates, &direction)?;
        let forces = solution.forces().zip(of_forces.as_ref());
        let outputs = outputs.iter();
        let seen = outputs.map(|output| output.source.change(&mechanism, &sensitivity, forces));
        let seen: Result<Vec<f64>, _> = seen.collect();
        Ok((rates, DVector::from_vec(seen?)))
    }

    /// Moves the mechanism, with all inputs held, from the solver's pose to a stable equilibrium, downhill
    /// in steps of Newton's method. The freedoms are at rest there.
    ///
    /// # Errors
    ///
    /// [`Error::NoEquilibrium`] if none is found.
    pub fn balance(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
    ) -> Result<(), Error> {
        /// Steps far beyond those of any mechanism that has an equilibrium.
        const MOST_STEPS: usize = 200;
        /// Longest change of an angle \[rad\] or of a length, in sizes of the mechanism.
        const LONGEST: f64 = 0.3;
        /// A step below this is rounding.
        const AT_REST: f64 = 1e-13;
        /// Part of the scales by which the mechanism leaves an unstable equilibrium.
        const ASIDE: f64 = 0.01;
        let scales = self.scales();
        let aside = ASIDE * DVector::from_column_slice(&scales);
        let count = scales.len();
        for _ in 0..MOST_STEPS {
            self.restart(solver, given, |_| 0.0)?;
            self.tell(solution);
            let space = self.linearize(solver, solution, &[])?;
            let inertia = self.inertia();
            let accelerations = self.accelerations();
            let slopes = DMatrix::from_fn(count, count, |i, j| space.a[(2 * i + 1, 2 * j)]);
            let stiffness = -(&inertia * slopes);
            let stiffness = 0.5 * (&stiffness + stiffness.transpose());
            let force = &inertia * accelerations;
            let step = downhill(&stiffness, &inertia, &force);
            let longest = step
                .iter()
                .zip(&scales)
                .fold(0.0, |longest: f64, (step, scale)| {
                    longest.max((step / scale).abs())
                });
            if longest <= AT_REST {
                match way_down(&stiffness) {
                    Some(way) => self.go_by(solver, &(way.component_mul(&aside)))?,
                    None => return Ok(()),
                }
                continue;
            }
            let part = (LONGEST / longest).min(1.0);
            self.go_by(solver, &(step * part))?;
        }
        Err(Error::NoEquilibrium)
    }

    /// Finds the stable equilibria to which the mechanism comes down, with all inputs held, from places
    /// all over the range of its freedoms that it reaches from the solver's pose: around each angle,
    /// and as far along each length. There may be others.
    ///
    /// # Errors
    ///
    /// [`Error::NoEquilibrium`] if none is found.
    pub fn balances(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        given: &impl Given,
    ) -> Result<Vec<Pose>, Error> {
        /// Places along one freedom: a maximum of the energy, or a dead point, stands between two
        /// equilibria, and three of each in a turn are many.
        const MOST_PLACES: usize = 6;
        /// Places in all.
        const MOST_STARTS: usize = 6 * 6 * 6;
        let home = solver.pose().clone();
        let scales = self.scales();
        let freedoms = u32::try_from(scales.len()).unwrap_or(u32::MAX);
        let fits = |places: &usize| {
            let starts = places.checked_pow(freedoms);
            starts.is_some_and(|starts| starts <= MOST_STARTS)
        };
        let places = (2..=MOST_PLACES).rev().find(fits).unwrap_or(1);
        let starts = places.checked_pow(freedoms).unwrap_or(1);
        let mut found: Vec<Pose> = Vec::new();
        for start in 0..starts {
            solver.restore(&home);
            let mut rest = start;
            let changes = scales.iter().map(|scale| {
                let place = rest % places;
                rest /= places;
                // From the middle alternately to both sides.
                let steps = place.div_ceil(2) as f64 * if place % 2 == 0 { 1.0 } else { -1.0 };
                TAU / places as f64 * scale * steps
            });
            let changes = DVector::from_iterator(scales.len(), changes);
            // A way that is blocked ends in front of the obstacle.
            let _ = self.go_by(solver, &changes);
            if self.balance(solver, solution, given).is_ok()
                && !found.iter().any(|pose| solver.is_near(pose))
            {
                found.push(solver.pose().clone());
            }
        }
        match found.is_empty() {
            true => Err(Error::NoEquilibrium),
            false => Ok(found),
        }
    }

    /// Moves the mechanism by changes of the freedoms' values.
    fn go_by(&self, solver: &mut Solver, changes: &DVector<f64>) -> Result<(), Error> {
        let mut path = Path::new(solver.mechanism());
        let pose = solver.pose();
        path.start = pose.time;
        path.from.copy_from_slice(&pose.parameters);
        path.to.copy_from_slice(&pose.parameters);
        for (curve, now) in path.curves.iter_mut().zip(&pose.drivers) {
            *curve = Curve::held(*now, *now);
        }
        for (freedom, change) in self.freedoms().iter().zip(changes) {
            let now = pose.drivers[freedom.index()];
            path.curves[freedom.index()] = Curve::held(now + change, now);
        }
        solver.track(&path).map(|_| ()).map_err(|blocked| {
            let pose = solver.pose();
            Error::Blocked(blocked.describe(solver.mechanism(), pose, None, |_| true))
        })
    }
}

/// Returns the direction in which an equilibrium with this stiffness is unstable most, if it is.
fn way_down(stiffness: &DMatrix<f64>) -> Option<DVector<f64>> {
    /// A negative stiffness of this part of the largest is rounding: the equilibrium is neutral.
    const NEUTRAL: f64 = 1e-9;
    let eigen = stiffness.clone().symmetric_eigen();
    let (least, value) = eigen.eigenvalues.argmin();
    let unstable = value < -NEUTRAL * eigen.eigenvalues.amax();
    unstable.then(|| eigen.eigenvectors.column(least).into_owned())
}

/// Returns the step that solves (K + μ M) δ = Q with the least μ of a few for which the matrix is
/// positive definite: downhill also where the equilibrium nearby is unstable.
fn downhill(
    stiffness: &DMatrix<f64>,
    inertia: &DMatrix<f64>,
    force: &DVector<f64>,
) -> DVector<f64> {
    /// Shifts by factors of four lead from rounding to far beyond the stiffness.
    const MOST_SHIFTS: usize = 60;
    let ratio = (stiffness.amax() / inertia.amax()).max(1e-9);
    let mut shift = 0.0;
    for _ in 0..MOST_SHIFTS {
        if let Some(factor) = Cholesky::new(stiffness + inertia * shift) {
            return factor.solve(force);
        }
        shift = f64::max(4.0 * shift, 1e-3 * ratio);
    }
    force / (shift * inertia.amax())
}

/// Returns the inputs: sizes of forces, then those of drivers.
fn inputs(mechanism: &Mechanism) -> Vec<Change> {
    let forces = (0..mechanism.force_inputs().len()).map(Change::Force);
    let drivers = mechanism.drivers.iter().enumerate();
    let drivers = drivers.filter(|(_, driver)| driver.is_given());
    let of_drivers = drivers
        .flat_map(|(index, _)| Order::ALL.map(|order| Change::Driver(DriverId(index), order)));
    forces.chain(of_drivers).collect()
}

/// Returns the names that the variables have in the FMU.
fn names(mechanism: &Mechanism, changes: &[Change]) -> Vec<String> {
    let forces = mechanism.force_inputs();
    let name = |change: &Change| match *change {
        Change::Force(place) => forces[place].name.clone(),
        Change::Driver(driver, order) => {
            format!(
                "{}.{}",
                mechanism.drivers[driver.index()].name,
                order.suffix()
            )
        }
    };
    changes.iter().map(name).collect()
}

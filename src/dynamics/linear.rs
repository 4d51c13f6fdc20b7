//! Linearisation at a pose.
//!
//! Closed contacts and friction that sticks hold their coordinates c: c̈ = 0, and the only velocities
//! are those with ċ = 0 (Haug's coordinate partitioning once more): one freedom per held coordinate
//! depends on the others, that which moves the coordinate most. Its velocity follows from theirs and from
//! the drivers', and a change of its own counts for nothing. A held coordinate stays wherever it is,
//! which gives A two zero eigenvalues.

use nalgebra::{DMatrix, DVector};

use super::error::Error;
use super::held::Held;
use super::motion::FreeMotion;
use crate::kinematics::{Direction, Output, Rates, Solution, Solver};
use crate::mechanism::{DriverId, Mechanism, Order};

/// The linear equations of small motions about a pose: δẋ = A δx + B δu, δy = C δx + D δu.
#[derive(Clone, Debug)]
pub struct StateSpace {
    /// Names of the states: value and velocity of each freedom.
    pub states: Vec<String>,
    /// Names of the inputs: those of the file, sizes of forces, then value, velocity and acceleration of each driver that
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
    /// Contacts and friction that hold coordinates at the pose, and in these equations.
    pub held: Vec<Held>,
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
    /// Accelerations or derivatives do not exist there; [`Error::DeadPoint`] at a dead point of the
    /// freedoms' coordinates.
    pub fn linearize(
        &mut self,
        solver: &mut Solver,
        solution: &mut Solution,
        outputs: &[Output],
    ) -> Result<StateSpace, Error> {
        if !self.charts.uses_own() {
            return Err(Error::DeadPoint);
        }
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
            held: self.held(),
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
        match change {
            Change::Force(place) => direction.loads[place] = 1.0,
            Change::Driver(driver, Order::Position) => {
                direction.drivers[driver.index()].value = 1.0;
            }
            Change::Driver(driver, order) => {
                direction.drivers[driver.index()].derivatives[order as usize - 1] = 1.0;
            }
        }
        self.hold_velocities(solver, &solution.rates, &mut direction)?;
        self.complete(solver, &solution.rates, &mut direction)?;
        let freedoms = self.freedoms().iter();
        let rates = freedoms.flat_map(|id| direction.drivers[id.index()].derivatives);
        let rates = DVector::from_vec(rates.collect());
        let of_forces = solution.force_changes(solver, &direction)?;
        let sensitivity =
            solver.sensitivity(&solution.rates, &solution.driver_rates, &direction)?;
        let forces = solution.forces().zip(of_forces.as_ref());
        let outputs = outputs.iter();
        let seen = outputs.map(|output| output.source.change(&mechanism, &sensitivity, forces));
        let seen: Result<Vec<f64>, _> = seen.collect();
        Ok((rates, DVector::from_vec(seen?)))
    }

    /// Changes the velocities of dependent freedoms in a direction so that held coordinates rest.
    fn hold_velocities(
        &self,
        solver: &mut Solver,
        rates: &Rates,
        direction: &mut Direction,
    ) -> Result<(), Error> {
        /// A pivot of this part of the largest partial derivative is rounding: the coordinate depends
        /// on others that are held.
        const DEPENDENT: f64 = 1e-9;
        let (passive, freedoms) = (&self.equations.passive, self.freedoms());
        let held = (0..passive.list.len()).filter(|k| passive.is_held(*k));
        let held: Vec<usize> = held.collect();
        if held.is_empty() {
            return Ok(());
        }
        let sensitivity = solver.sensitivity(rates, self.drivers(), direction)?;
        let change = |k: usize| sensitivity.coordinate(&*passive.list[k].relation).first();
        let (count, scales) = (freedoms.len(), self.scales());
        // ∂c/∂u by scales, and the rates that are to be taken out.
        let mut rows = DMatrix::from_fn(held.len(), count + 1, |row, column| {
            match freedoms.get(column) {
                Some(id) => passive.rows[(held[row], id.index())] * scales[column],
                None => -change(held[row]),
            }
        });
        let rounding = DEPENDENT * rows.columns(0, count).amax();
        let mut is_used = vec![false; held.len()];
        let mut dependent = Vec::new();
        for _ in 0..held.len() {
            let places = (0..held.len()).filter(|row| !is_used[*row]);
            let places = places.flat_map(|row| (0..count).map(move |column| (row, column)));
            let size = |place: (usize, usize)| rows[place].abs();
            let Some(pivot) = places.max_by(|a, b| size(*a).total_cmp(&size(*b))) else {
                break;
            };
            if size(pivot) <= rounding {
                break;
            }
            let (row, column) = pivot;
            is_used[row] = true;
            let of_row = rows.row(row) / rows[pivot];
            for other in (0..held.len()).filter(|other| *other != row) {
                let factor = rows[(other, column)];
                let mut others = rows.row_mut(other);
                others -= &of_row * factor;
            }
            rows.set_row(row, &of_row);
            dependent.push(pivot);
        }
        for (row, column) in dependent {
            let velocity = &mut direction.drivers[freedoms[column].index()].derivatives[0];
            *velocity += rows[(row, count)] * scales[column];
        }
        Ok(())
    }
}

/// Returns the inputs: sizes of forces, then those of drivers.
fn inputs(mechanism: &Mechanism) -> Vec<Change> {
    let forces = (0..mechanism.load_inputs().len()).map(Change::Force);
    let drivers = mechanism.drivers.iter().enumerate();
    let drivers = drivers.filter(|(_, driver)| driver.is_given());
    let of_drivers = drivers
        .flat_map(|(index, _)| Order::ALL.map(|order| Change::Driver(DriverId(index), order)));
    forces.chain(of_drivers).collect()
}

/// Returns the names that the variables have in the FMU.
fn names(mechanism: &Mechanism, changes: &[Change]) -> Vec<String> {
    let forces = mechanism.load_inputs();
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

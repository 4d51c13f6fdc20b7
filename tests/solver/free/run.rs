//! A mechanism that moves freely, and its comparison with a truth.

use std::sync::Arc;

use biela::dynamics::integrator::Statistics;
use biela::dynamics::{Error, FreeMotion, Given};
use biela::kinematics::{Budget, Solution, Solver};
use biela::mechanism::{DriverId, Jet, Mechanism, Signal};

use super::minimal::Minimal;
use crate::common::assembled;

/// Tolerances with the largest error of values and velocities, relative to 1 + |value|: the
/// contract's marks.
pub(super) const MARKS: [(f64, f64); 2] = [(1e-10, 1e-8), (1e-6, 1e-4)];
/// Largest relative error of accelerations at a given state: rounding times the condition of the
/// mass matrix and of the loops, some thousands.
pub(super) const ACCELERATION: f64 = 1e-11;
/// Largest residual of the joints' equations, in the mechanism's size.
pub(super) const CLOSED: f64 = 1e-12;
/// Largest error of the energy in the largest kinetic energy, at the tolerance 1e-10.
pub(super) const ENERGY: f64 = 1e-9;

/// The inputs of a mechanism.
#[derive(Clone, Copy)]
pub(super) struct Fed {
    pub(super) driver: fn(usize, f64) -> Jet,
    pub(super) loads: fn(f64, &mut [f64]),
}

impl Default for Fed {
    fn default() -> Self {
        Self {
            driver: |_, _| unreachable!("no driver is an input"),
            loads: |_, loads| assert!(loads.is_empty()),
        }
    }
}

impl Given for Fed {
    fn driver(&self, driver: DriverId, time: f64) -> Jet {
        (self.driver)(driver.index(), time)
    }

    fn loads(&self, time: f64, loads: &mut [f64]) {
        (self.loads)(time, loads);
    }
}

/// A mechanism that moves freely.
pub(super) struct Run {
    pub(super) solver: Solver,
    pub(super) solution: Solution,
    pub(super) free: FreeMotion,
    pub(super) fed: Fed,
    /// Largest residual of the joints and largest error of the energy so far.
    pub(super) residual: f64,
    pub(super) energy_error: f64,
}

impl Run {
    pub(super) fn new(mechanism: &Arc<Mechanism>, tolerance: f64, fed: Fed) -> Self {
        Self::try_new(mechanism, tolerance, fed).expect("it starts")
    }

    pub(super) fn try_new(
        mechanism: &Arc<Mechanism>,
        tolerance: f64,
        fed: Fed,
    ) -> Result<Self, Error> {
        let (mut solver, _) = assembled(mechanism);
        let free = FreeMotion::new(&solver, tolerance)?;
        let mut free = free.expect("it has freedoms");
        free.start(&mut solver, &fed)?;
        let mut run = Self::of(solver, free, fed);
        run.solve();
        Ok(run)
    }

    /// A motion with its solver, wherever they are.
    pub(super) fn of(solver: Solver, free: FreeMotion, fed: Fed) -> Self {
        Self {
            solution: Solution::new(&solver),
            solver,
            free,
            fed,
            residual: 0.0,
            energy_error: 0.0,
        }
    }

    /// Solves the rates of all bodies.
    pub(super) fn solve(&mut self) {
        let rates = &mut self.solution.driver_rates;
        rates.copy_from_slice(self.free.drivers());
        let solved = self.solution.solve_rates(&mut self.solver);
        solved.expect("the pose is regular");
    }

    /// Moves on to a time, with the budget of a step: no honest motion meets it.
    pub(super) fn try_to(&mut self, time: f64) -> Result<(), Error> {
        let Self {
            solver,
            solution,
            free,
            fed,
            ..
        } = self;
        solver.set_budget(Budget::usual(solver.mechanism()));
        free.advance(solver, solution, fed, time)?;
        self.solve();
        self.residual = self.residual.max(self.solver.residual());
        self.energy_error = self.energy_error.max(self.free.energy_error().abs());
        Ok(())
    }

    pub(super) fn to(&mut self, time: f64) {
        if let Err(error) = self.try_to(time) {
            panic!("on the way to {time} s: {error}");
        }
    }

    /// Values, velocities and accelerations of the file's freedoms, whatever coordinates are
    /// integrated.
    pub(super) fn freedoms(&self) -> [Vec<f64>; 3] {
        let jets = || {
            let freedoms = self.free.freedoms().iter();
            freedoms.map(|freedom| {
                let rates = (&self.solution.rates, &self.solution.driver_rates);
                (self.solver).signal(Signal::Motion(*freedom), rates.0, rates.1)
            })
        };
        [
            jets().map(|jet| jet.value).collect(),
            jets().map(|jet| jet.first()).collect(),
            jets().map(|jet| jet.second()).collect(),
        ]
    }

    /// Values, then velocities.
    pub(super) fn state(&self) -> Vec<f64> {
        let [mut values, velocities, _] = self.freedoms();
        values.extend(velocities);
        values
    }

    pub(super) fn statistics(&self) -> Statistics {
        self.free.statistics()
    }
}

/// Largest error relative to 1 + |exact|.
pub(super) fn error(found: &[f64], exact: &[f64]) -> f64 {
    error_in([1.0; 2], found, exact)
}

/// Largest error relative to unit + |exact|, with units of the values in the first half and of the
/// velocities in the second.
fn error_in(units: [f64; 2], found: &[f64], exact: &[f64]) -> f64 {
    assert_eq!(found.len(), exact.len());
    let half = found.len().div_ceil(2);
    let pairs = found.iter().zip(exact).enumerate();
    let errors = pairs.map(|(index, (found, exact))| {
        let unit = if index < half { units[0] } else { units[1] };
        (found - exact).abs() / (unit + exact.abs())
    });
    errors.fold(0.0, f64::max)
}

/// Equal steps from 0 to a time.
pub(super) fn times(until: f64, steps: u32) -> Vec<f64> {
    let time = |step| until * f64::from(step) / f64::from(steps);
    (0..=steps).map(time).collect()
}

/// Compares values and velocities over a motion with exact ones, at both marks, and the energy's
/// error with the largest kinetic energy.
pub(super) fn assert_follows(
    name: &str,
    mechanism: &Arc<Mechanism>,
    fed: Fed,
    times: &[f64],
    exact: impl Fn(usize) -> Vec<f64>,
    kinetic_energy: f64,
) {
    assert_follows_in([1.0; 2], name, mechanism, fed, times, exact, kinetic_energy);
}

/// Compares as above, errors being relative to these units of values and velocities.
pub(super) fn assert_follows_in(
    units: [f64; 2],
    name: &str,
    mechanism: &Arc<Mechanism>,
    fed: Fed,
    times: &[f64],
    exact: impl Fn(usize) -> Vec<f64>,
    kinetic_energy: f64,
) {
    for (tolerance, mark) in MARKS {
        let mut run = Run::new(mechanism, tolerance, fed);
        let mut largest = 0.0_f64;
        for (index, time) in times.iter().enumerate() {
            run.to(*time);
            largest = largest.max(error_in(units, &run.state(), &exact(index)));
        }
        let energy = run.energy_error / kinetic_energy;
        assert!(largest < mark, "{name} at {tolerance}: {largest}");
        assert!(run.residual < CLOSED, "{name}: {}", run.residual);
        if tolerance <= 1e-10 {
            assert!(energy < ENERGY, "{name}: energy {energy}");
        }
    }
}

/// Compares a motion with Lagrange's equations in minimal coordinates.
pub(super) fn assert_lagrange(
    name: &str,
    mechanism: &Arc<Mechanism>,
    fed: Fed,
    truth: &Minimal,
    times: &[f64],
) {
    let mut run = Run::new(mechanism, 1e-8, fed);
    let exact = truth.motion(&run.state(), times);
    // Accelerations at the states through which the motion goes.
    let (mut largest, mut magnitude) = (0.0_f64, 0.0_f64);
    let mut energy = 0.0_f64;
    for (time, exact) in times.iter().zip(&exact) {
        run.to(*time);
        let [values, velocities, accelerations] = run.freedoms();
        let expected = truth.accelerations(*time, &values, &velocities);
        for (found, expected) in accelerations.iter().zip(&expected) {
            largest = largest.max((found - expected).abs());
            magnitude = magnitude.max(expected.abs());
        }
        let (z, rates) = exact.split_at(values.len());
        energy = energy.max(truth.kinetic_energy(*time, z, rates));
    }
    let relative = largest / magnitude;
    assert!(relative < ACCELERATION, "{name}: {relative}");
    assert_follows(
        name,
        mechanism,
        fed,
        times,
        |index| exact[index].clone(),
        energy,
    );
}

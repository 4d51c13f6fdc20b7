//! Animations of motions that are recorded moment by moment.

use super::{Animation, Clock, Moment, Reading};
use crate::drawing::{ForcePlace, Scene};
use biela::kinematics::{Output, Solution, Solver};
use biela::mechanism::Mechanism;

/// Largest number of moments of an animation; of more rows it shows every second, third and so on.
const MOST_MOMENTS: usize = 10_000;
/// Largest number of poses that the paths of the points of interest are made from.
const MOST_POSES: usize = 2000;

impl Animation {
    /// Returns how many rows of a run there are to each recorded moment.
    #[must_use]
    pub fn stride(rows: usize) -> usize {
        rows.div_ceil(MOST_MOMENTS).max(1)
    }

    /// Makes the animation of moments, at least one, that show `forces` and tell `columns` in
    /// numbers.
    #[must_use]
    pub fn of_moments(
        mechanism: &Mechanism,
        parameters: &[f64],
        columns: &[Output],
        forces: Vec<ForcePlace>,
        clock: Clock,
        moments: Vec<Moment>,
    ) -> Self {
        let stride = moments.len().div_ceil(MOST_POSES).max(1);
        let poses = moments.iter().step_by(stride).chain(moments.last());
        let poses: Vec<Vec<f64>> = poses.map(|moment| moment.q.clone()).collect();
        let home = poses.first().map_or(&[][..], Vec::as_slice);
        Self {
            scene: Scene::along(mechanism, parameters, home, &poses, true),
            clock,
            readings: columns.iter().map(Reading::of).collect(),
            forces,
            moments,
        }
    }
}

impl Reading {
    /// Returns the reading of an output.
    fn of(output: &Output) -> Self {
        Self {
            name: output.name.trim_end_matches(".position").to_owned(),
            unit: output.unit.display_name().replace('2', "²"),
        }
    }
}

impl Moment {
    /// Records the pose of a solver, with rates, forces and outputs.
    #[must_use]
    pub fn record(
        solver: &Solver,
        solution: &Solution,
        columns: &[Output],
        forces: &[ForcePlace],
    ) -> Self {
        let rates = [solution.rates.velocity(), solution.rates.acceleration()];
        let readings = columns
            .iter()
            .map(|column| solution.value(solver, column) * column.unit.display_factor());
        Self {
            q: solver.pose().q.clone(),
            rates: rates.map(<[f64]>::to_vec),
            readings: readings.collect(),
            forces: ForcePlace::values(forces, solver, solution),
        }
    }
}

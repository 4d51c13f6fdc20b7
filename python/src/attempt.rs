//! Unknowns that least squares improve.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use biela::kinematics::Pose;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use crate::error::Failure;
use crate::follower::{Fit, Follower, Refused};
use crate::least_squares::{Limits, Outer, Point, Residuals};

/// A mechanism whose unknowns are improved. It keeps its assembly mode: each evaluation moves it
/// continuously from the best unknowns so far.
#[pyclass(frozen)]
pub(crate) struct Attempt {
    moving: Mutex<Moving>,
}

/// The mechanism of an attempt, and the best unknowns so far.
struct Moving {
    trial: Trial,
    point: Point,
}

/// A mechanism that tries unknowns.
struct Trial {
    follower: Follower,
    /// Pose from which an evaluation starts: at the first row, for the unknowns kept last, before
    /// their timing was improved.
    base: Pose,
    /// Pose at the first row for the unknowns tried last, before their timing was improved.
    first: Pose,
    /// Poses at all rows for the unknowns tried last.
    poses: Vec<Pose>,
    /// Number of evaluations by improvements.
    evaluations: usize,
}

/// Residuals by target, then by variable, then by pose; and their derivatives, by residual, then by
/// unknown.
type Linearised<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

#[pymethods]
impl Attempt {
    /// The free parameters, then the free values of drivers.
    #[getter]
    fn unknowns(&self) -> Vec<f64> {
        self.moving().point.unknowns.clone()
    }

    /// Returns the free values of the driver of each target; `None` for prescribed timing.
    #[getter]
    fn timing<'py>(&self, py: Python<'py>) -> Vec<Option<Bound<'py, PyArray1<f64>>>> {
        let Moving { trial, point } = &*self.moving();
        let targets = trial.follower.fit.targets.iter();
        let values = targets.map(|target| {
            let free = target.free_driver.as_ref();
            free.map(|_| {
                point.unknowns[target.unknowns.clone()]
                    .to_vec()
                    .into_pyarray(py)
            })
        });
        values.collect()
    }

    /// Sum of squared residuals; infinite before the first improvement.
    #[getter]
    fn cost(&self) -> f64 {
        self.moving().point.cost
    }

    /// Number of evaluations of the residuals by improvements; those of `evaluate` do not count.
    #[getter]
    fn evaluations(&self) -> usize {
        self.moving().trial.evaluations
    }

    /// Returns the residuals and their derivatives at unknowns, and moves there. Returns `None` and
    /// stays where the mechanism does not reach the unknowns, or has no derivatives there.
    fn evaluate<'py>(&self, py: Python<'py>, unknowns: Vec<f64>) -> Option<Linearised<'py>> {
        let found = py.detach(|| {
            let Moving { trial, point } = &mut *self.moving();
            let mut residuals = vec![0.0; point.residuals()];
            let mut derivatives = vec![0.0; residuals.len() * unknowns.len()];
            let mut at = unknowns;
            trial.go(&mut at, false, &mut residuals).ok()?;
            let kept = trial.keep(&at, &mut derivatives);
            kept.then_some((residuals, derivatives))
        });
        let (residuals, derivatives) = found?;
        Some((residuals.into_pyarray(py), derivatives.into_pyarray(py)))
    }
}

impl Attempt {
    /// Begins an attempt: in the assembly mode of this index, or on the continuous motion from the
    /// file's own pose.
    pub(crate) fn begin(
        fit: &Arc<Fit>,
        values: Vec<f64>,
        mode: Option<usize>,
    ) -> Result<Self, Failure> {
        let mut follower = Follower::new(fit)?;
        let refused = || Failure::Assembly("the mechanism does not reach all targets".to_owned());
        let parameters = follower.parameters(&values);
        let parameters =
            parameters.map_err(|error| Failure::Usage(format!("parameters: {error}")))?;
        let base = match mode {
            Some(mode) => {
                let poses = follower.runner.poses(0, &parameters);
                poses.into_iter().nth(mode).ok_or_else(refused)?
            }
            None => {
                follower.runner.start(&parameters)?;
                follower.runner.solver.pose().clone()
            }
        };
        follower.runner.return_to(&base);
        let (_, timing) = follower.place().map_err(|Refused| refused())?;
        let mut unknowns = values;
        unknowns.extend(timing);
        let residuals = fit.targets.last().map_or(0, |target| target.residuals.end);
        let rows = fit.scenario.times.len();
        Ok(Self {
            moving: Mutex::new(Moving {
                point: Point::new(unknowns, residuals),
                trial: Trial {
                    follower,
                    poses: vec![base.clone(); rows],
                    first: base.clone(),
                    base,
                    evaluations: 0,
                },
            }),
        })
    }

    /// Improves the unknowns by least squares.
    pub(crate) fn improve(&self, outer: &Outer, limits: Limits) {
        let Moving { trial, point } = &mut *self.moving();
        trial.evaluations += point.improve(trial, outer, limits);
    }

    /// Returns the pose for the unknowns kept last: at the file's start values of the drivers if
    /// the mechanism reaches them, otherwise at the first row.
    pub(crate) fn home(&self) -> Pose {
        let Trial { follower, base, .. } = &mut self.moving().trial;
        follower.at_home(base)
    }

    /// Returns the mechanism once no other thread moves it. Each evaluation begins anew, also after
    /// one that has panicked.
    fn moving(&self) -> MutexGuard<'_, Moving> {
        self.moving.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Trial {
    /// Moves from the base to unknowns and sets the residuals there. With `nearest`, free values of
    /// drivers become those of the nearest poses in their range.
    fn go(
        &mut self,
        unknowns: &mut [f64],
        nearest: bool,
        residuals: &mut [f64],
    ) -> Result<(), Refused> {
        let Self {
            follower,
            base,
            first,
            poses,
            ..
        } = self;
        let fit = Arc::clone(&follower.fit);
        let count = fit.free.len();
        let parameters = follower.parameters(&unknowns[..count]);
        let parameters = parameters.map_err(|_| Refused)?;
        follower.set_timing(unknowns);
        follower.runner.return_to(base);
        let changed = follower.runner.change(0, &parameters);
        changed.map_err(|_| Refused)?;
        follower.check_turn()?;
        follower.runner.solver.save(first);
        for target in &fit.targets {
            let residuals = &mut residuals[target.residuals.clone()];
            let free_values = &mut unknowns[target.unknowns.clone()];
            let ascend = free_values.last() >= free_values.first();
            for (pose, row) in target.rows.clone().enumerate() {
                match &target.free_driver {
                    Some(free) if nearest => {
                        let range = free.range(&free_values[..pose], ascend);
                        let value = free_values[pose].clamp(range[0], range[1]);
                        follower.set_value(row, free.driver, value);
                        follower.go(row)?;
                        free_values[pose] =
                            follower.go_nearer(target, free, pose, (value, range))?;
                    }
                    _ => follower.go(row)?,
                }
                for (column, value) in follower.values(target).into_iter().enumerate() {
                    let index = target.index(column, pose);
                    residuals[index] = target.residual(column, pose, value);
                }
                follower.runner.solver.save(&mut poses[row]);
            }
        }
        Ok(())
    }

    /// Sets the derivatives of the residuals at the unknowns tried last.
    fn differentiate(&mut self, unknowns: &[f64], derivatives: &mut [f64]) -> Result<(), Refused> {
        let Self {
            follower, poses, ..
        } = self;
        let fit = Arc::clone(&follower.fit);
        let count = fit.free.len();
        follower.set_timing(unknowns);
        derivatives.fill(0.0);
        let mut changes = Vec::new();
        for target in &fit.targets {
            let columns = target.columns.len();
            let mut directions = fit.directions.clone();
            directions.extend(target.free_driver.iter().map(|free| free.direction.clone()));
            for (pose, row) in target.rows.clone().enumerate() {
                follower.runner.return_to(&poses[row]);
                follower.runner.solve(row).map_err(|_| Refused)?;
                changes.clear();
                let runner = &mut follower.runner;
                let differentiated =
                    runner.differentiate(&target.columns, &directions, &mut changes);
                differentiated.map_err(|_| Refused)?;
                for column in 0..columns {
                    let residual = target.residuals.start + target.index(column, pose);
                    let row = residual * unknowns.len();
                    for (direction, changes) in changes.chunks_exact(columns).enumerate() {
                        // Behind the parameters comes the value of this pose.
                        let unknown = if direction < count {
                            direction
                        } else {
                            target.unknowns.start + pose
                        };
                        derivatives[row + unknown] = target.weight * changes[column];
                    }
                }
            }
        }
        Ok(())
    }
}

impl Residuals for Trial {
    fn try_at(&mut self, unknowns: &mut [f64], residuals: &mut [f64]) -> bool {
        self.go(unknowns, true, residuals).is_ok()
    }

    fn keep(&mut self, unknowns: &[f64], derivatives: &mut [f64]) -> bool {
        let kept = self.differentiate(unknowns, derivatives).is_ok();
        if kept {
            self.base.clone_from(&self.first);
        }
        kept
    }
}

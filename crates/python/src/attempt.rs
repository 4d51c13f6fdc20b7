//! Unknowns that a fit improves.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use biela::kinematics::Pose;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use crate::call::apart;
use crate::error::Failure;
use crate::follower::{Fit, Follower, Refused};

/// A mechanism that tries unknowns: the free parameters, then the free values of drivers. It keeps
/// its assembly mode: each trial moves it continuously from the unknowns kept last.
#[pyclass(frozen)]
pub(crate) struct Attempt {
    /// The unknowns at which it begins.
    #[pyo3(get)]
    start: Vec<f64>,
    trial: Mutex<Trial>,
}

/// The mechanism of an attempt.
struct Trial {
    follower: Follower,
    /// Pose from which a trial starts: at the first row, for the unknowns kept last, before their
    /// timing was improved.
    base: Pose,
    /// Pose at the first row for the unknowns tried last, before their timing was improved.
    first: Pose,
    /// Poses at all rows for the unknowns tried last.
    poses: Vec<Pose>,
    /// The unknowns tried last.
    unknowns: Vec<f64>,
    /// The index of the free value that each free value of a driver follows, its own unless it is at
    /// the end of its range; `None` at a limit of the driver. For the unknowns tried last.
    leaders: Vec<Option<usize>>,
    /// Second derivatives of half the gaps by the free values of drivers; zero or less where none
    /// is known. For the unknowns tried last.
    curvatures: Vec<f64>,
    /// Residuals of the unknowns tried last, by target, then by variable, then by pose.
    residuals: Vec<f64>,
}

/// The unknowns, the leaders of their timing, its second derivatives, and the residuals by target,
/// then by variable, then by pose.
type Tried<'py> = (
    Bound<'py, PyArray1<f64>>,
    Vec<Option<usize>>,
    Vec<f64>,
    Bound<'py, PyArray1<f64>>,
);

#[pymethods]
impl Attempt {
    /// Tries unknowns. With `nearest`, free values of drivers become those of the nearest poses in
    /// their range. Returns `None` where the mechanism does not reach the unknowns, or the sum of
    /// squared residuals is not finite.
    fn go<'py>(
        &self,
        py: Python<'py>,
        unknowns: Vec<f64>,
        nearest: bool,
    ) -> Result<Option<Tried<'py>>, Failure> {
        let tried = apart(py, || {
            let trial = &mut *self.trial();
            trial.unknowns = unknowns;
            let went = trial.go(nearest);
            Ok(went.ok().map(|()| {
                let (leaders, curvatures) = (trial.leaders.clone(), trial.curvatures.clone());
                let (unknowns, residuals) = (trial.unknowns.clone(), trial.residuals.clone());
                (unknowns, leaders, curvatures, residuals)
            }))
        })?;
        Ok(tried.map(|(unknowns, leaders, curvatures, residuals)| {
            let (unknowns, residuals) = (unknowns.into_pyarray(py), residuals.into_pyarray(py));
            (unknowns, leaders, curvatures, residuals)
        }))
    }

    /// Returns the derivatives of the residuals at the unknowns tried last, by residual, then by
    /// unknown, and keeps these unknowns. Returns `None` and keeps none where there are no
    /// finite derivatives.
    fn keep<'py>(&self, py: Python<'py>) -> Result<Option<Bound<'py, PyArray1<f64>>>, Failure> {
        let derivatives = apart(py, || Ok(self.trial().keep().ok()))?;
        Ok(derivatives.map(|derivatives| derivatives.into_pyarray(py)))
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
                follower.runner.motion.solver.pose().clone()
            }
        };
        follower.runner.return_to(&base);
        let (_, timing) = follower.place().map_err(|Refused| refused())?;
        let mut unknowns = values;
        unknowns.extend(timing);
        let residuals = fit.targets.last().map_or(0, |target| target.residuals.end);
        let rows = fit.scenario.times.len();
        Ok(Self {
            start: unknowns.clone(),
            trial: Mutex::new(Trial {
                follower,
                poses: vec![base.clone(); rows],
                first: base.clone(),
                base,
                leaders: Vec::new(),
                curvatures: Vec::new(),
                residuals: vec![0.0; residuals],
                unknowns,
            }),
        })
    }

    /// Returns the pose for the unknowns kept last: at the file's start values of the drivers if
    /// the mechanism reaches them, otherwise at the first row.
    pub(crate) fn home(&self) -> Pose {
        let Trial { follower, base, .. } = &mut *self.trial();
        follower.at_home(base)
    }

    /// Returns the mechanism once no other thread moves it. Each trial begins anew, also after one
    /// that has panicked.
    fn trial(&self) -> MutexGuard<'_, Trial> {
        self.trial.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Trial {
    /// Moves from the base to the unknowns and sets the residuals there. With `nearest`, free values
    /// of drivers become those of the nearest poses in their range. Refuses residuals whose squares
    /// are beyond all numbers.
    fn go(&mut self, nearest: bool) -> Result<(), Refused> {
        let Self {
            follower,
            base,
            first,
            poses,
            unknowns,
            leaders,
            curvatures,
            residuals,
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
        follower.runner.motion.solver.save(first);
        leaders.clear();
        curvatures.clear();
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
                        let (value, curvature) =
                            follower.go_nearer(target, free, pose, (value, range))?;
                        free_values[pose] = value;
                        curvatures.push(curvature);
                    }
                    _ => follower.go(row)?,
                }
                for (column, value) in follower.values(target).into_iter().enumerate() {
                    let index = target.index(column, pose);
                    residuals[index] = target.residual(column, pose, value);
                }
                follower.runner.motion.solver.save(&mut poses[row]);
            }
            if let Some(free) = &target.free_driver {
                let start = target.unknowns.start - count;
                let followed = free.leaders(free_values).into_iter();
                leaders.extend(followed.map(|leader| Some(start + leader?)));
            }
        }
        let cost: f64 = residuals.iter().map(|residual| residual * residual).sum();
        if cost.is_finite() {
            Ok(())
        } else {
            Err(Refused)
        }
    }

    /// Returns the derivatives of the residuals at the unknowns tried last, by residual, then by
    /// unknown, and keeps these unknowns.
    fn keep(&mut self) -> Result<Vec<f64>, Refused> {
        let Self {
            follower,
            poses,
            unknowns,
            residuals,
            ..
        } = self;
        let fit = Arc::clone(&follower.fit);
        let count = fit.free.len();
        follower.set_timing(unknowns);
        let mut derivatives = vec![0.0; residuals.len() * unknowns.len()];
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
        if derivatives.iter().any(|derivative| !derivative.is_finite()) {
            return Err(Refused);
        }
        self.base.clone_from(&self.first);
        Ok(derivatives)
    }
}

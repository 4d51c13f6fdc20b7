//! Targets of a fit: residuals with their derivatives, and costs of many variants.

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use biela::cli::check_parameter;
use biela::kinematics::{Direction, Output, Pose};
use biela::mechanism::{DriverId, Jet, Mechanism, ParameterId};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::error::Failure;
use crate::runner::Runner;
use crate::scenario::Scenario;

/// Number of steps along the motion of a driver, at whose ends the nearest pose to each target is
/// looked for.
const STEPS: usize = 36;
/// Number of variants that one solver takes in turn: far more work than making the solver.
const TURN: usize = 32;

/// Values that variables shall take at rows of a motion.
pub(crate) struct Target {
    /// The rows of the scenario, one per pose.
    pub(crate) rows: Range<usize>,
    /// The driver whose values at these rows are free; those of the scenario are where the search
    /// for them begins.
    pub(crate) timing: Option<FreeDriver>,
    pub(crate) columns: Vec<Output>,
    /// The values wanted, by column, then by row.
    pub(crate) wanted: Vec<f64>,
    /// Factor of the residuals.
    pub(crate) weight: f64,
}

/// A driver whose values at the rows of a target are free.
pub(crate) struct FreeDriver {
    driver: DriverId,
    /// Range in which the nearest poses are looked for, and distance between two of them.
    bounds: [f64; 2],
    step: f64,
}

impl FreeDriver {
    /// Returns the driver of this name.
    ///
    /// # Errors
    ///
    /// It is a length without limits.
    pub(crate) fn new(mechanism: &Mechanism, id: DriverId) -> Result<Self, Failure> {
        let driver = &mechanism.drivers[id.index()];
        let bounds = [driver.min, driver.max];
        let (bounds, range) = match (driver.coordinate.kind.is_angle(), bounds) {
            (true, [min, max]) => {
                let bounds = [min.unwrap_or(-f64::INFINITY), max.unwrap_or(f64::INFINITY)];
                (bounds, TAU)
            }
            (false, [Some(min), Some(max)]) => ([min, max], max - min),
            (false, _) => {
                return Err(Failure::Usage(format!(
                    "target: driver `{}` is a length without `min` and `max`; its values are free \
                     between limits only",
                    driver.name
                )));
            }
        };
        Ok(Self {
            driver: id,
            bounds,
            step: range / STEPS as f64,
        })
    }
}

/// All targets of a fit. The unknowns are the free parameters, then the free values of drivers.
pub(crate) struct Fit {
    pub(crate) scenario: Scenario,
    pub(crate) targets: Vec<Target>,
    pub(crate) free: Vec<ParameterId>,
    /// The directions in which each of these grows.
    directions: Vec<Direction>,
    /// The driver that shall turn fully.
    pub(crate) turns: Option<DriverId>,
}

impl Fit {
    pub(crate) fn new(
        scenario: Scenario,
        targets: Vec<Target>,
        free: Vec<ParameterId>,
        turns: Option<DriverId>,
    ) -> Self {
        let directions = free
            .iter()
            .map(|p| Direction::by_parameter(&scenario.own, *p));
        Self {
            directions: directions.collect(),
            scenario,
            targets,
            free,
            turns,
        }
    }
}

/// The cause why a variant has no residuals.
struct Refused;

/// A mechanism that follows the targets.
struct Follower {
    fit: Arc<Fit>,
    runner: Runner<Box<Scenario>>,
}

/// Targets of a fit, for Python.
#[pyclass(frozen)]
pub(crate) struct Targets {
    fit: Arc<Fit>,
}

impl Targets {
    pub(crate) fn new(fit: Fit) -> Self {
        Self { fit: Arc::new(fit) }
    }
}

#[pymethods]
impl Targets {
    /// Returns the costs of variants, whose free parameters are by variant, then by parameter: the
    /// index of the variant, that of its assembly mode, and the sum of squared residuals. Free
    /// timing is that of the nearest poses. Variants that do not reach all targets are left out.
    fn costs(&self, py: Python<'_>, values: Vec<f64>) -> PyResult<Vec<(usize, usize, f64)>> {
        let costs = py.detach(|| {
            let size = self.fit.free.len();
            let turns = values.par_chunks(TURN * size).enumerate();
            let costs: Vec<Vec<_>> = turns
                .map(|(turn, values)| {
                    let mut follower = Follower::new(&self.fit)?;
                    let variants = values.chunks_exact(size).enumerate();
                    Ok(variants
                        .flat_map(|(index, values)| {
                            let costs = follower.costs(values).into_iter();
                            costs.map(move |(mode, cost)| (TURN * turn + index, mode, cost))
                        })
                        .collect())
                })
                .collect::<Result<_, Failure>>()?;
            Ok(costs.into_iter().flatten().collect())
        });
        costs.map_err(|failure: Failure| failure.raise(py))
    }

    /// Begins an attempt at the free parameters `values`: in the assembly mode of this index, or on
    /// the continuous motion from the file's own pose.
    #[pyo3(signature = (values, mode=None))]
    fn attempt(&self, py: Python<'_>, values: Vec<f64>, mode: Option<usize>) -> PyResult<Attempt> {
        py.detach(|| {
            let mut follower = Follower::new(&self.fit)?;
            let refused =
                || Failure::Assembly("the mechanism does not reach all targets".to_owned());
            let parameters = follower.parameters(&values).map_err(Failure::Usage)?;
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
            Ok(Attempt {
                moving: Mutex::new(Moving { follower, base }),
                timing,
            })
        })
        .map_err(|failure: Failure| failure.raise(py))
    }
}

/// A mechanism whose unknowns an optimiser changes. It keeps its assembly mode: each evaluation
/// moves it continuously from where the last one left it.
#[pyclass(frozen)]
pub(crate) struct Attempt {
    moving: Mutex<Moving>,
    /// Free values of drivers at the beginning.
    #[pyo3(get)]
    timing: Vec<f64>,
}

/// The mechanism of an attempt, and the pose at the first row of its last evaluation.
struct Moving {
    follower: Follower,
    base: Pose,
}

/// Residuals by target, then by variable, then by pose; and their derivatives, by residual, then by
/// unknown.
type Linearised<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

#[pymethods]
impl Attempt {
    /// Returns the residuals and their derivatives; `None` for unknowns that the mechanism does not
    /// reach.
    fn evaluate<'py>(&self, py: Python<'py>, unknowns: Vec<f64>) -> Option<Linearised<'py>> {
        let found = py.detach(|| {
            let Moving { follower, base } = &mut *self.moving();
            follower.evaluate(base, &unknowns)
        });
        let (residuals, derivatives) = found.ok()?;
        Some((residuals.into_pyarray(py), derivatives.into_pyarray(py)))
    }
}

impl Attempt {
    /// Returns the pose of the last evaluation: at the file's start values of the drivers if the
    /// mechanism reaches them, otherwise at the first row.
    pub(crate) fn home(&self) -> Pose {
        let Moving { follower, base } = &mut *self.moving();
        follower.at_home(base)
    }

    /// Returns the mechanism once no other thread moves it. Each evaluation begins anew, also after
    /// one that has panicked.
    fn moving(&self) -> MutexGuard<'_, Moving> {
        self.moving.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Follower {
    fn new(fit: &Arc<Fit>) -> Result<Self, Failure> {
        let targets = fit.targets.iter();
        let columns: Vec<Output> = targets.flat_map(|t| t.columns.iter().cloned()).collect();
        let scenario = Box::new(fit.scenario.clone());
        let mut runner = Runner::new(scenario, &columns)?;
        runner.gives_up = true;
        Ok(Self {
            fit: Arc::clone(fit),
            runner,
        })
    }

    /// Returns all parameters in force for values of the free ones.
    fn parameters(&self, values: &[f64]) -> Result<Vec<f64>, String> {
        let own = &self.fit.scenario.own;
        let mut parameters = own.default_parameters();
        for (&id, &value) in self.fit.free.iter().zip(values) {
            check_parameter(own, id, value)?;
            parameters[id.index()] = value;
        }
        own.derive_parameters(&mut parameters);
        Ok(parameters)
    }

    /// Returns the costs of a variant in each of its assembly modes that reach all targets.
    fn costs(&mut self, values: &[f64]) -> Vec<(usize, f64)> {
        let Ok(parameters) = self.parameters(values) else {
            return Vec::new();
        };
        self.forget_timing();
        let poses = self.runner.poses(0, &parameters);
        let mut costs = Vec::with_capacity(poses.len());
        for (mode, pose) in poses.iter().enumerate() {
            self.forget_timing();
            self.runner.return_to(pose);
            if let Ok((cost, _)) = self.place()
                && cost.is_finite()
            {
                costs.push((mode, cost));
            }
        }
        costs
    }

    /// Sets the free values of drivers to where the search for them begins.
    fn forget_timing(&mut self) {
        let Self { fit, runner } = self;
        runner.scenario.samples.clone_from(&fit.scenario.samples);
    }

    /// Follows the targets from the present pose. Returns the sum of squared residuals, and the
    /// free values of drivers, which are those of the nearest poses.
    fn place(&mut self) -> Result<(f64, Vec<f64>), Refused> {
        let fit = Arc::clone(&self.fit);
        self.check_turn()?;
        let mut cost = 0.0;
        let mut free_values = Vec::new();
        for target in &fit.targets {
            match &target.timing {
                None => {
                    for (pose, row) in target.rows.clone().enumerate() {
                        self.go(row)?;
                        cost += target.gap(pose, &self.values(target));
                    }
                }
                Some(timing) => {
                    let curve = self.scan(target, timing)?;
                    for pose in 0..target.rows.len() {
                        let gaps = curve
                            .iter()
                            .map(|(at, values)| (target.gap(pose, values), at));
                        let nearest = gaps.min_by(|a, b| a.0.total_cmp(&b.0));
                        let (gap, at) = nearest.ok_or(Refused)?;
                        cost += gap;
                        free_values.push(*at);
                    }
                }
            }
        }
        Ok((cost, free_values))
    }

    /// Returns the values of a target's variables along the motion of its free driver, from the
    /// present pose both ways: over a turn, or between the driver's limits.
    fn scan(
        &mut self,
        target: &Target,
        timing: &FreeDriver,
    ) -> Result<Vec<(f64, Vec<f64>)>, Refused> {
        let row = target.rows.start;
        self.go(row)?;
        let middle = self.runner.solver.pose().clone();
        let start = middle.drivers[timing.driver.index()];
        let [low, high] = timing.bounds;
        let mut curve = vec![(start, self.values(target))];
        for step in [timing.step, -timing.step] {
            self.runner.return_to(&middle);
            let mut at = start + step;
            while curve.len() <= STEPS && (low..=high).contains(&at) {
                self.set_value(row, timing.driver, at);
                if self.go(row).is_err() {
                    break;
                }
                curve.push((at, self.values(target)));
                at += step;
            }
        }
        Ok(curve)
    }

    /// Sets the value of a driver at a row.
    fn set_value(&mut self, row: usize, driver: DriverId, value: f64) {
        let samples = self.runner.scenario.samples.iter_mut();
        for samples in samples.filter(|samples| samples.driver == driver) {
            samples.set(row, value);
        }
    }

    /// Moves on to a row, and solves the rates there.
    fn go(&mut self, row: usize) -> Result<(), Refused> {
        self.runner.advance_to(row).map_err(|_| Refused)?;
        self.runner.solve(row).map_err(|_| Refused)
    }

    /// Returns the values of a target's variables.
    fn values(&self, target: &Target) -> Vec<f64> {
        let columns = target.columns.iter();
        columns.map(|column| self.runner.value(column)).collect()
    }

    /// Refuses a mechanism whose driver does not turn fully; goes back to the present pose.
    fn check_turn(&mut self) -> Result<(), Refused> {
        let Some(driver) = self.fit.turns else {
            return Ok(());
        };
        let pose = self.runner.solver.pose().clone();
        let turns = self.runner.turns(driver);
        self.runner.return_to(&pose);
        if turns { Ok(()) } else { Err(Refused) }
    }

    /// Returns the residuals and their derivatives. Moves there from `base`, which becomes the pose
    /// at the first row.
    fn evaluate(
        &mut self,
        base: &mut Pose,
        unknowns: &[f64],
    ) -> Result<(Vec<f64>, Vec<f64>), Refused> {
        let fit = Arc::clone(&self.fit);
        let count = fit.free.len();
        let parameters = self.parameters(&unknowns[..count]).map_err(|_| Refused)?;
        let mut place = count;
        for target in &fit.targets {
            if let Some(timing) = &target.timing {
                for row in target.rows.clone() {
                    self.set_value(row, timing.driver, unknowns[place]);
                    place += 1;
                }
            }
        }
        self.runner.return_to(base);
        self.runner.change(0, &parameters).map_err(|_| Refused)?;
        self.check_turn()?;
        let first = self.runner.solver.pose().clone();
        let size = fit.targets.iter().map(|t| t.wanted.len()).sum();
        let mut residuals = vec![0.0; size];
        let mut derivatives = vec![0.0; size * unknowns.len()];
        let (mut before, mut timing) = (0, count);
        let mut changes = Vec::new();
        for target in &fit.targets {
            let columns = target.columns.len();
            let mut directions = fit.directions.clone();
            if let Some(free) = &target.timing {
                let mut by_value = Direction::zero(&fit.scenario.own);
                by_value.drivers[free.driver.index()] = Jet::constant(1.0);
                directions.push(by_value);
            }
            for (pose, row) in target.rows.clone().enumerate() {
                self.go(row)?;
                changes.clear();
                let differentiated =
                    (self.runner).differentiate(&target.columns, &directions, &mut changes);
                differentiated.map_err(|_| Refused)?;
                for (column, value) in self.values(target).into_iter().enumerate() {
                    let index = target.index(column, pose);
                    residuals[before + index] = target.weight * (value - target.wanted[index]);
                    let row = (before + index) * unknowns.len();
                    for (direction, changes) in changes.chunks_exact(columns).enumerate() {
                        // Behind the parameters comes the value of this pose.
                        let unknown = if direction < count {
                            direction
                        } else {
                            timing + pose
                        };
                        derivatives[row + unknown] = target.weight * changes[column];
                    }
                }
            }
            before += target.wanted.len();
            if target.timing.is_some() {
                timing += target.rows.len();
            }
        }
        base.clone_from(&first);
        Ok((residuals, derivatives))
    }

    /// Returns the pose at the file's start values of the drivers, or `base` if they cannot be
    /// reached.
    fn at_home(&mut self, base: &Pose) -> Pose {
        self.runner.return_to(base);
        let home = self.fit.scenario.home.0.drivers.clone();
        for (index, value) in home.into_iter().enumerate() {
            self.set_value(0, DriverId(index), value);
        }
        let reached = self.runner.advance_to(0);
        self.forget_timing();
        match reached {
            Ok(()) => self.runner.solver.pose().clone(),
            Err(_) => base.clone(),
        }
    }
}

impl Target {
    /// Returns the index of a value wanted.
    fn index(&self, column: usize, pose: usize) -> usize {
        column * self.rows.len() + pose
    }

    /// Returns the sum of squared residuals at a pose.
    fn gap(&self, pose: usize, values: &[f64]) -> f64 {
        let squares = values.iter().enumerate().map(|(column, value)| {
            let residual = self.weight * (value - self.wanted[self.index(column, pose)]);
            residual * residual
        });
        squares.sum()
    }
}

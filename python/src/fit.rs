//! Targets of a fit: residuals with their derivatives, costs of many variants, and attempts that
//! least squares improve.

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
use crate::least_squares::{Limits, Outer, Point, Residuals};
use crate::runner::Runner;
use crate::scenario::Scenario;

/// Number of steps along the motion of a driver, at whose ends the nearest pose to each target is
/// looked for.
const STEPS: usize = 36;
/// Number of variants that one solver takes in turn: far more work than making the solver.
const TURN: usize = 32;
/// Largest number of steps to the nearest pose to a target.
const NEARER: usize = 2;
/// Decrease of the gap to a target, as part of it, that is worth a step.
const WORTH: f64 = 1e-3;

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
    /// Whether its values at the rows ascend or descend, within a turn or its range.
    in_order: bool,
}

impl FreeDriver {
    /// Returns the driver of this name.
    ///
    /// # Errors
    ///
    /// It is a length without limits.
    pub(crate) fn new(
        mechanism: &Mechanism,
        id: DriverId,
        in_order: bool,
    ) -> Result<Self, Failure> {
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
            in_order,
        })
    }

    /// Returns the range of the value at a pose, whose predecessors have these values. Values in
    /// order ascend or descend.
    fn range(&self, before: &[f64], ascend: bool) -> [f64; 2] {
        let [low, high] = self.bounds;
        match before {
            [first, .., last] | [first @ last] if self.in_order => {
                let turn = self.step * STEPS as f64;
                if ascend {
                    [low.max(*last), high.min(first + turn)]
                } else {
                    [low.max(first - turn), high.min(*last)]
                }
            }
            _ => [low, high],
        }
    }

    /// Chooses a point of a curve for each pose, so that the sum of gaps is smallest. The points of
    /// the curve are in the order of the driver's values, `gaps` by pose, then by point. Returns the
    /// sum and the values.
    fn nearest(&self, curve: &[f64], gaps: &[Vec<f64>]) -> (f64, Vec<f64>) {
        if !self.in_order {
            let nearest = gaps.iter().map(|gaps| {
                let points = gaps.iter().zip(curve);
                points.fold((f64::INFINITY, f64::NAN), |best, (gap, at)| {
                    if *gap < best.0 { (*gap, *at) } else { best }
                })
            });
            let (gaps, values): (Vec<f64>, Vec<f64>) = nearest.unzip();
            return (gaps.iter().sum(), values);
        }
        let count = curve.len();
        // On a curve that closes, the first pose may be at any point.
        let closes = count > STEPS && self.bounds == [-f64::INFINITY, f64::INFINITY];
        let turn = self.step * STEPS as f64;
        let point = |place: usize| {
            if closes {
                (place % STEPS, (place / STEPS) as f64 * turn)
            } else {
                (place, 0.0)
            }
        };
        let mut best = (f64::INFINITY, vec![f64::NAN; gaps.len()]);
        for start in 0..if closes { STEPS } else { 1 } {
            let mut places: Vec<usize> = (start..start + count).collect();
            for _ in ["ascending", "descending"] {
                let gap = |pose: usize, index: usize| gaps[pose][point(places[index]).0];
                let (sum, chosen) = in_order(gaps.len(), count, gap);
                if sum < best.0 {
                    let values = chosen.iter().map(|&index| {
                        let (index, laps) = point(places[index]);
                        curve[index] + laps
                    });
                    best = (sum, values.collect());
                }
                places.reverse();
            }
        }
        best
    }
}

/// Chooses an index for each pose, none smaller than the one before, so that the sum of gaps is
/// smallest. Returns the sum and the indices.
fn in_order(poses: usize, count: usize, gap: impl Fn(usize, usize) -> f64) -> (f64, Vec<usize>) {
    // The smallest sum up to a pose with each index, and the index before it.
    let mut sums = vec![0.0; count];
    let mut before = vec![0; poses * count];
    for pose in 0..poses {
        let mut least = 0;
        for index in 0..count {
            if sums[index] < sums[least] {
                least = index;
            }
            before[pose * count + index] = least;
        }
        let indices = 0..count;
        sums = indices
            .map(|index| sums[before[pose * count + index]] + gap(pose, index))
            .collect();
    }
    let last = (0..count).min_by(|&a, &b| sums[a].total_cmp(&sums[b]));
    let Some(mut index) = last else {
        return (f64::INFINITY, Vec::new());
    };
    let sum = sums[index];
    let mut chosen = vec![index; poses];
    for pose in (0..poses).rev() {
        chosen[pose] = index;
        index = before[pose * count + index];
    }
    (sum, chosen)
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

    /// Begins attempts at free parameters, which are by attempt, then by parameter: each in the
    /// assembly mode of this index.
    fn attempts(
        &self,
        py: Python<'_>,
        values: Vec<f64>,
        modes: Vec<usize>,
    ) -> PyResult<Vec<Attempt>> {
        py.detach(|| {
            let values = values.par_chunks(self.fit.free.len());
            let begun = values.zip(modes.par_iter());
            let begun = begun.map(|(values, &mode)| self.begin(values.to_vec(), Some(mode)));
            begun.collect::<Result<_, _>>()
        })
        .map_err(|failure: Failure| failure.raise(py))
    }

    /// Begins an attempt at the free parameters `values`, on the continuous motion from the file's
    /// own pose.
    fn attempt(&self, py: Python<'_>, values: Vec<f64>) -> PyResult<Attempt> {
        py.detach(|| self.begin(values, None))
            .map_err(|failure| failure.raise(py))
    }

    /// Improves attempts by least squares, on all cores. The free parameters have bounds, and sizes
    /// by which steps are scaled. An attempt ends after so many evaluations, or where the cost falls
    /// by a smaller part than `tolerance`, or at a cost of `stop_at`.
    fn improve(
        &self,
        py: Python<'_>,
        attempts: Vec<Py<Attempt>>,
        bounds: (Vec<f64>, Vec<f64>, Vec<f64>),
        evaluations: usize,
        tolerance: f64,
        stop_at: f64,
    ) {
        let (low, high, size) = bounds;
        let outer = Outer { low, high, size };
        let limits = Limits {
            evaluations,
            tolerance,
            cost: stop_at,
        };
        py.detach(|| {
            attempts.par_iter().for_each(|attempt| {
                let Moving { trial, point, .. } = &mut *attempt.get().moving();
                trial.evaluations += point.improve(trial, &outer, limits);
            });
        });
    }
}

impl Targets {
    /// Begins an attempt: in the assembly mode of this index, or on the continuous motion from the
    /// file's own pose.
    fn begin(&self, values: Vec<f64>, mode: Option<usize>) -> Result<Attempt, Failure> {
        let mut follower = Follower::new(&self.fit)?;
        let refused = || Failure::Assembly("the mechanism does not reach all targets".to_owned());
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
        let mut unknowns = values;
        unknowns.extend(timing);
        let residuals = self.fit.targets.iter().map(|t| t.wanted.len()).sum();
        let rows = self.fit.scenario.times.len();
        Ok(Attempt {
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
}

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
    /// Pose at the first row for the best unknowns so far.
    base: Pose,
    /// Poses for the unknowns tried last: at the first row before its timing was improved, and at
    /// all rows.
    first: Pose,
    poses: Vec<Pose>,
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

    /// Sum of squared residuals; infinite before the first improvement.
    #[getter]
    fn cost(&self) -> f64 {
        self.moving().point.cost
    }

    /// Number of times that residuals were computed.
    #[getter]
    fn evaluations(&self) -> usize {
        self.moving().trial.evaluations
    }

    /// Returns the residuals and their derivatives at unknowns, and moves there; `None` for unknowns
    /// that the mechanism does not reach.
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
    /// Returns the pose for the unknowns evaluated last: at the file's start values of the drivers if
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
                    let mut curve = self.scan(target, timing)?;
                    curve.sort_by(|a, b| a.0.total_cmp(&b.0));
                    let gaps = (0..target.rows.len()).map(|pose| {
                        let gaps = curve.iter().map(|(_, values)| target.gap(pose, values));
                        gaps.collect()
                    });
                    let gaps: Vec<Vec<f64>> = gaps.collect();
                    let values: Vec<f64> = curve.iter().map(|(at, _)| *at).collect();
                    let (sum, timing) = timing.nearest(&values, &gaps);
                    cost += sum;
                    free_values.extend(timing);
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

    /// Sets the timing of all targets, which stands behind the free parameters.
    fn set_timing(&mut self, unknowns: &[f64]) {
        let fit = Arc::clone(&self.fit);
        let mut values = unknowns[fit.free.len()..].iter();
        for target in &fit.targets {
            if let Some(timing) = &target.timing {
                for (row, value) in target.rows.clone().zip(&mut values) {
                    self.set_value(row, timing.driver, *value);
                }
            }
        }
    }

    /// Goes to the pose that is nearest to a target's pose, by steps of Gauss and Newton from the
    /// pose at its row, within a range of the free driver. Returns its value there.
    fn go_nearer(
        &mut self,
        target: &Target,
        timing: &FreeDriver,
        pose: usize,
        (start, [low, high]): (f64, [f64; 2]),
    ) -> Result<f64, Refused> {
        let row = target.rows.start + pose;
        let mut value = start;
        let mut values = self.values(target);
        let mut gap = target.gap(pose, &values);
        let mut changes = Vec::with_capacity(values.len());
        let mut along = Direction::zero(&self.fit.scenario.own);
        along.drivers[timing.driver.index()] = Jet::constant(1.0);
        for _ in 0..NEARER {
            changes.clear();
            let along = std::slice::from_ref(&along);
            let differentiated = (self.runner).differentiate(&target.columns, along, &mut changes);
            differentiated.map_err(|_| Refused)?;
            let (mut slope, mut steepness) = (0.0, 0.0);
            for (column, (value, change)) in values.iter().zip(&changes).enumerate() {
                let weight = target.weight * target.weight;
                slope += weight * change * (value - target.wanted[target.index(column, pose)]);
                steepness += weight * change * change;
            }
            // The driver may have no effect.
            if slope * slope <= WORTH * gap * steepness {
                break;
            }
            let step = (-slope / steepness).clamp(-timing.step, timing.step);
            let next = (value + step).clamp(low, high);
            let before = self.runner.solver.pose().clone();
            self.set_value(row, timing.driver, next);
            if self.go(row).is_ok() {
                let tried = self.values(target);
                let nearer = target.gap(pose, &tried);
                if nearer < gap {
                    (value, values, gap) = (next, tried, nearer);
                    continue;
                }
            }
            self.runner.return_to(&before);
            self.set_value(row, timing.driver, value);
            self.runner.solve(row).map_err(|_| Refused)?;
            break;
        }
        Ok(value)
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
        let (mut before, mut place) = (0, count);
        for target in &fit.targets {
            let rows = target.rows.clone();
            let ascend = unknowns.get(place + rows.len().saturating_sub(1)) >= unknowns.get(place);
            for (pose, row) in rows.enumerate() {
                match &target.timing {
                    Some(timing) if nearest => {
                        let range = timing.range(&unknowns[place..place + pose], ascend);
                        let value = unknowns[place + pose].clamp(range[0], range[1]);
                        follower.set_value(row, timing.driver, value);
                        follower.go(row)?;
                        unknowns[place + pose] =
                            follower.go_nearer(target, timing, pose, (value, range))?;
                    }
                    _ => follower.go(row)?,
                }
                for (column, value) in follower.values(target).into_iter().enumerate() {
                    let index = target.index(column, pose);
                    residuals[before + index] = target.weight * (value - target.wanted[index]);
                }
                follower.runner.solver.save(&mut poses[row]);
            }
            before += target.wanted.len();
            if target.timing.is_some() {
                place += target.rows.len();
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
        let (mut before, mut place) = (0, count);
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
                follower.runner.return_to(&poses[row]);
                follower.runner.solve(row).map_err(|_| Refused)?;
                changes.clear();
                let runner = &mut follower.runner;
                let differentiated =
                    runner.differentiate(&target.columns, &directions, &mut changes);
                differentiated.map_err(|_| Refused)?;
                for column in 0..columns {
                    let row = (before + target.index(column, pose)) * unknowns.len();
                    for (direction, changes) in changes.chunks_exact(columns).enumerate() {
                        // Behind the parameters comes the value of this pose.
                        let unknown = if direction < count {
                            direction
                        } else {
                            place + pose
                        };
                        derivatives[row + unknown] = target.weight * changes[column];
                    }
                }
            }
            before += target.wanted.len();
            if target.timing.is_some() {
                place += target.rows.len();
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
        self.base.clone_from(&self.first);
        self.differentiate(unknowns, derivatives).is_ok()
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

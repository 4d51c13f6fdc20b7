//! A mechanism that follows targets.

use std::ops::Range;
use std::sync::Arc;

use biela::kinematics::{Direction, Output, Pose};
use biela::mechanism::{DriverId, ParameterId};
use biela_tools::cli::check_parameter;

use crate::error::Failure;
use crate::runner::Runner;
use crate::scenario::Scenario;
use crate::timing::{FreeDriver, MOST_STEPS, SampledVariables};

/// Largest number of steps to the nearest pose to a target.
const NEARER: usize = 2;
/// Decrease of the gap to a target, as part of it, that is worth a step.
const WORTH: f64 = 1e-3;
/// Shortest step, as part of the longest one, whose secant is above rounding.
const SECANT: f64 = 1e-7;

/// Values that variables shall take at rows of a motion.
pub(crate) struct WantedValues {
    /// The rows of the scenario, one per pose.
    pub(crate) rows: Range<usize>,
    /// The driver whose values at these rows are free; those of the scenario are where the search
    /// for them begins.
    pub(crate) free_driver: Option<FreeDriver>,
    pub(crate) columns: Vec<Output>,
    /// The values wanted, by column, then by row.
    pub(crate) wanted: Vec<f64>,
    /// Factor of the residuals.
    pub(crate) weight: f64,
    /// Indices of its residuals among those of all targets.
    pub(crate) residuals: Range<usize>,
    /// Indices of the free values of its driver among the unknowns; none for prescribed timing.
    pub(crate) unknowns: Range<usize>,
}

/// All targets of a fit. The unknowns are the free parameters, then the free values of drivers.
pub(crate) struct Fit {
    pub(crate) scenario: Scenario,
    pub(crate) targets: Vec<WantedValues>,
    pub(crate) free: Vec<ParameterId>,
    /// The directions in which each of these grows.
    pub(crate) directions: Vec<Direction>,
    /// The driver that shall turn fully.
    pub(crate) turns: Option<DriverId>,
}

impl Fit {
    /// Prepares a fit, and gives each target its places among residuals and unknowns.
    pub(crate) fn new(
        scenario: Scenario,
        mut targets: Vec<WantedValues>,
        free: Vec<ParameterId>,
        turns: Option<DriverId>,
    ) -> Self {
        let (mut residuals, mut unknowns) = (0, free.len());
        for target in &mut targets {
            let values = target.free_driver.as_ref().map_or(0, |_| target.rows.len());
            target.residuals = residuals..residuals + target.wanted.len();
            target.unknowns = unknowns..unknowns + values;
            (residuals, unknowns) = (target.residuals.end, target.unknowns.end);
        }
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
pub(crate) struct Refused;

/// A mechanism that follows the targets.
pub(crate) struct Follower {
    pub(crate) fit: Arc<Fit>,
    pub(crate) runner: Runner,
}

impl Follower {
    pub(crate) fn new(fit: &Arc<Fit>) -> Result<Self, Failure> {
        let targets = fit.targets.iter();
        let columns: Vec<Output> = targets.flat_map(|t| t.columns.iter().cloned()).collect();
        let mut drivers = fit.scenario.driven.drivers.iter();
        if let Some(freedom) = drivers.find(|driver| driver.is_free()) {
            return Err(Failure::Usage(format!(
                "drive: say how `{}` moves; a synthesis does not follow free motion",
                freedom.name
            )));
        }
        let runner = Runner::new(&fit.scenario, &columns)?;
        Ok(Self {
            fit: Arc::clone(fit),
            runner,
        })
    }

    /// Returns all parameters in force for values of the free ones.
    pub(crate) fn parameters(&self, values: &[f64]) -> Result<Vec<f64>, String> {
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
    pub(crate) fn costs(&mut self, values: &[f64]) -> Vec<(usize, f64)> {
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
    pub(crate) fn place(&mut self) -> Result<(f64, Vec<f64>), Refused> {
        let fit = Arc::clone(&self.fit);
        self.check_turn()?;
        let mut cost = 0.0;
        let mut free_values = Vec::new();
        for target in &fit.targets {
            match &target.free_driver {
                None => {
                    for (pose, row) in target.rows.clone().enumerate() {
                        self.go(row)?;
                        cost += target.gap(pose, &self.values(target));
                    }
                }
                Some(free) => {
                    let curve = self.scan(target, free)?;
                    let gaps = (0..target.rows.len()).map(|pose| {
                        let points = curve.points.iter();
                        points.map(|(_, values)| target.gap(pose, values)).collect()
                    });
                    let gaps: Vec<Vec<f64>> = gaps.collect();
                    let (sum, timing) = free.nearest(&curve, &gaps);
                    cost += sum;
                    free_values.extend(timing);
                }
            }
        }
        Ok((cost, free_values))
    }

    /// Returns the values of a target's variables along the motion of its free driver, from the
    /// present pose both ways: until the curve closes, as far as the driver goes, or by
    /// [`MOST_STEPS`].
    fn scan(
        &mut self,
        target: &WantedValues,
        free: &FreeDriver,
    ) -> Result<SampledVariables, Refused> {
        let row = target.rows.start;
        self.go(row)?;
        let middle = self.runner.motion.solver.pose().clone();
        let start = middle.drivers[free.driver.index()];
        let [low, high] = free.bounds;
        let mut curve = SampledVariables::new(start, self.values(target));
        for step in [free.step, -free.step] {
            self.runner.return_to(&middle);
            let mut at = start;
            for _ in 0..MOST_STEPS {
                at += step;
                if curve.closes || !(low..=high).contains(&at) {
                    break;
                }
                self.set_value(row, free.driver, at);
                if self.go(row).is_err() {
                    break;
                }
                curve.points.push((at, self.values(target)));
                if free.is_unlimited() && step > 0.0 {
                    curve.close();
                }
            }
        }
        curve.points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(curve)
    }

    /// Sets the value of a driver at a row.
    pub(crate) fn set_value(&mut self, row: usize, driver: DriverId, value: f64) {
        let samples = self.runner.scenario.samples.iter_mut();
        for samples in samples.filter(|samples| samples.driver == driver) {
            samples.set(row, value);
        }
    }

    /// Moves on to a row, and solves the rates there.
    pub(crate) fn go(&mut self, row: usize) -> Result<(), Refused> {
        self.runner.advance_to(row).map_err(|_| Refused)?;
        self.runner.solve(row).map_err(|_| Refused)
    }

    /// Returns the values of a target's variables.
    pub(crate) fn values(&self, target: &WantedValues) -> Vec<f64> {
        let columns = target.columns.iter();
        columns.map(|column| self.runner.value(column)).collect()
    }

    /// Refuses a mechanism whose driver does not turn fully; goes back to the present pose.
    pub(crate) fn check_turn(&mut self) -> Result<(), Refused> {
        let Some(driver) = self.fit.turns else {
            return Ok(());
        };
        let pose = self.runner.motion.solver.pose().clone();
        let turns = self.runner.turns(driver);
        self.runner.return_to(&pose);
        if turns { Ok(()) } else { Err(Refused) }
    }

    /// Sets the timing of all targets, which stands behind the free parameters.
    pub(crate) fn set_timing(&mut self, unknowns: &[f64]) {
        let fit = Arc::clone(&self.fit);
        for target in &fit.targets {
            if let Some(free) = &target.free_driver {
                let values = &unknowns[target.unknowns.clone()];
                for (row, value) in target.rows.clone().zip(values) {
                    self.set_value(row, free.driver, *value);
                }
            }
        }
    }

    /// Goes to the pose that is nearest to a target's pose, from the pose at its row, within a range of
    /// the free driver: by steps of Gauss and Newton, and by secants where the path bends. Returns its
    /// value there, and the second derivative of half the gap by it from the last secant, zero without
    /// one.
    pub(crate) fn go_nearer(
        &mut self,
        target: &WantedValues,
        free: &FreeDriver,
        pose: usize,
        (start, [low, high]): (f64, [f64; 2]),
    ) -> Result<(f64, f64), Refused> {
        let row = target.rows.start + pose;
        let mut value = start;
        let mut gap = target.gap(pose, &self.values(target));
        let (mut slope, mut steepness) = self.slope(target, free, pose)?;
        let mut curvature = 0.0_f64;
        for _ in 0..NEARER {
            // Gauss and Newton's steps converge up to twice their second derivative.
            let second = if curvature > 2.0 * steepness {
                curvature
            } else {
                steepness
            };
            // The driver may have no effect, or be at its limit.
            let step = (-slope / second).clamp(-free.step, free.step);
            let next = (value + step).clamp(low, high);
            if slope * slope <= WORTH * gap * second || [value].contains(&next) {
                break;
            }
            // A quarter of the step if it leads too far; a short one fails by rounding.
            let is_long = step.abs() > SECANT * free.step;
            curvature = if is_long {
                4.0 * (slope / step).abs()
            } else {
                0.0
            };
            let before = self.runner.motion.solver.pose().clone();
            self.set_value(row, free.driver, next);
            if self.go(row).is_ok()
                && let Ok((slope_there, steepness_there)) = self.slope(target, free, pose)
            {
                let secant = (slope_there - slope) / (next - value);
                let nearer = target.gap(pose, &self.values(target));
                if is_long && (nearer < gap || slope_there * slope < 0.0) {
                    curvature = secant;
                }
                if nearer < gap {
                    (value, gap) = (next, nearer);
                    (slope, steepness) = (slope_there, steepness_there);
                    continue;
                }
            }
            self.runner.return_to(&before);
            self.set_value(row, free.driver, value);
            self.runner.solve(row).map_err(|_| Refused)?;
        }
        Ok((value, curvature))
    }

    /// Returns the first derivative of half the gap at the present pose by the free driver, and the
    /// second one without the curvature of the path.
    fn slope(
        &mut self,
        target: &WantedValues,
        free: &FreeDriver,
        pose: usize,
    ) -> Result<(f64, f64), Refused> {
        let mut changes = Vec::with_capacity(target.columns.len());
        let along = std::slice::from_ref(&free.direction);
        let differentiated = (self.runner).differentiate(&target.columns, along, &mut changes);
        differentiated.map_err(|_| Refused)?;
        let values = self.values(target);
        let (mut slope, mut steepness) = (0.0, 0.0);
        for (column, (value, change)) in values.iter().zip(&changes).enumerate() {
            let change = target.weight * change;
            slope += change * target.residual(column, pose, *value);
            steepness += change * change;
        }
        Ok((slope, steepness))
    }

    /// Returns the pose at the file's start values of the drivers, or `base` if they cannot be
    /// reached.
    pub(crate) fn at_home(&mut self, base: &Pose) -> Pose {
        self.runner.return_to(base);
        let home = self.fit.scenario.home.0.drivers.clone();
        for (index, value) in home.into_iter().enumerate() {
            self.set_value(0, DriverId(index), value);
        }
        let reached = self.runner.advance_to(0);
        self.forget_timing();
        match reached {
            Ok(()) => self.runner.motion.solver.pose().clone(),
            Err(_) => base.clone(),
        }
    }
}

impl WantedValues {
    /// Returns the index of a value wanted.
    pub(crate) fn index(&self, column: usize, pose: usize) -> usize {
        column * self.rows.len() + pose
    }

    /// Returns the residual of a value at a pose.
    pub(crate) fn residual(&self, column: usize, pose: usize, value: f64) -> f64 {
        self.weight * (value - self.wanted[self.index(column, pose)])
    }

    /// Returns the sum of squared residuals at a pose.
    pub(crate) fn gap(&self, pose: usize, values: &[f64]) -> f64 {
        let squares = values.iter().enumerate().map(|(column, value)| {
            let residual = self.residual(column, pose, *value);
            residual * residual
        });
        squares.sum()
    }
}

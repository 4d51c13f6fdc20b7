//! A mechanism that moves along the samples and motions of its drivers.

use std::borrow::Cow;
use std::f64::consts::TAU;

use biela::dynamics::{self, Equilibrium, Event, Given, Motion, Notice, StateSpace, on_cubic};
use biela::kinematics::{
    Blocked, Direction, DriverPath, Error, Output, OutputSource, Path, Pose, Solver, SolverChoices,
};
use biela::mechanism::{Driver, DriverId, Dual, Jet, Order, show_time};

use crate::call::Interrupt;
use crate::error::Failure;
use crate::scenario::Scenario;

/// Number of variants that one solver runs in a batch: far more work than making the solver.
pub(crate) const BATCH: usize = 32;

/// A mechanism in motion, and the samples that move it.
pub(crate) struct Runner {
    pub(crate) scenario: Scenario,
    /// At the file's own values, from which each motion starts.
    home: Solver,
    pub(crate) motion: Motion,
    path: Path,
    choices: SolverChoices,
    /// The drivers' values at the start, at which those without samples stay.
    held: Vec<f64>,
    /// The row whose rates were solved last.
    solved: usize,
}

impl Runner {
    /// Makes a runner; with a column of forces it solves them too.
    pub(crate) fn new(scenario: &Scenario, columns: &[Output]) -> Result<Self, Failure> {
        Self::along(scenario, columns, &[])
    }

    /// Makes a runner whose free motion is followed with its changes along directions.
    pub(crate) fn along(
        scenario: &Scenario,
        columns: &[Output],
        directions: &[Direction],
    ) -> Result<Self, Failure> {
        let mut drivers = scenario.driven.drivers.iter();
        if let Some(driver) = drivers.find(|driver| driver.is_moved_by_inputs())
            && scenario.driven.has_freedoms()
            && !directions.is_empty()
        {
            return Err(Failure::Usage(format!(
                "gradient: driver `{}` follows an input with an array, along which a free motion has none; \
                 give the input an expression",
                driver.name
            )));
        }
        let home = Solver::new(scenario.own.clone())?;
        let mut motion = Motion::new(Solver::new(scenario.driven.clone())?);
        if columns.iter().any(Output::uses_forces) {
            motion.seek_forces();
        }
        let prepared = motion.prepare_freedoms(directions.to_vec());
        prepared.map_err(stopped)?;
        Ok(Self {
            home,
            scenario: scenario.clone(),
            path: Path::new(motion.mechanism()),
            choices: SolverChoices::default(),
            motion,
            held: Vec::new(),
            solved: 0,
        })
    }

    /// Moves from the file's own pose to the start, with these parameters. The result depends
    /// on them alone, not on motions before.
    ///
    /// # Errors
    ///
    /// No continuous motion leads there, or the mechanism does not close there.
    pub(crate) fn start(&mut self, parameters: &[f64]) -> Result<(), Failure> {
        let time = self.scenario.start;
        self.begin(parameters)
            .map_err(|error| Failure::Assembly(error.at_start(time)))?;
        self.release()
    }

    /// Moves freely from the start to the first row, in steps of the file.
    ///
    /// # Errors
    ///
    /// Those of [`advance`](Self::advance), as reasons of variants; [`Failure::Raised`] after Ctrl-C.
    pub(crate) fn lead(&mut self, interrupt: &mut Interrupt) -> Result<(), Failure> {
        let (end, step) = (self.scenario.times[0], self.scenario.own.simulation.step);
        while self.motion.pose().time < end {
            interrupt.check()?;
            let now = self.motion.pose().time;
            let next = (now + step).min(end);
            let until = if next > now { next } else { end };
            self.go(0, until).map_err(Failure::Assembly)?;
        }
        Ok(())
    }

    /// Lets freedoms move by the forces from the present pose on, with the velocities of the file.
    fn release(&mut self) -> Result<(), Failure> {
        let part = Part {
            scenario: &self.scenario,
            held: &self.held,
            parameters: &self.path.to,
            row: 1,
        };
        self.motion.release(&part).map_err(stopped)?;
        if self.motion.free().is_some() {
            self.solve(0)?;
        }
        Ok(())
    }

    fn begin(&mut self, parameters: &[f64]) -> Result<(), Error> {
        let Scenario { driven, home, .. } = &self.scenario;
        self.home.resume(&home.0, &home.1);
        let home = &home.0;
        let value = |driver| Some(self.scenario.sample(driver, 0, parameters)?.value);
        let path = (self.home).path_to_start(driven, parameters, self.scenario.start, value);
        self.home.start(home, &path)?;
        self.home.copy_choices(&mut self.choices);
        self.motion.begin(self.home.pose(), &self.choices);
        self.path.from.copy_from_slice(parameters);
        self.path.to.copy_from_slice(parameters);
        self.held.clone_from(&self.motion.pose().drivers);
        self.solve(0)
    }

    /// Moves on to a row's time.
    ///
    /// # Errors
    ///
    /// Cause of the mechanism's stop, and its place.
    pub(crate) fn advance(&mut self, row: usize) -> Result<(), String> {
        self.go(row, self.scenario.times[row])
    }

    /// Moves on to a time on the way to a row.
    fn go(&mut self, row: usize, time: f64) -> Result<(), String> {
        self.motion.renew_budget();
        self.head_for(row);
        let part = Part {
            scenario: &self.scenario,
            held: &self.held,
            parameters: &self.path.to,
            row,
        };
        let advanced = self.motion.advance(&self.path, &part, time);
        advanced.map_err(|stop| {
            stop.describe(&self.motion, |driver| self.sample(driver, row).is_some())
        })?;
        self.solve(row)
            .map_err(|error| format!("at t = {} s: {error}", show_time(time)))
    }

    /// Moves on to a row's time, without rates; gives up early where that fails.
    ///
    /// # Errors
    ///
    /// The motion cannot go on; the pose is the last one reached.
    pub(crate) fn advance_to(&mut self, row: usize) -> Result<(), Blocked> {
        self.head_for(row);
        self.track()
    }

    fn track(&mut self) -> Result<(), Blocked> {
        let tracked = self.motion.solver.track_or_give_up(&self.path);
        tracked.map(drop)
    }

    /// Moves on to a row's time and to other parameters, without rates.
    ///
    /// # Errors
    ///
    /// The motion cannot go on; the pose is the last one reached.
    pub(crate) fn change(&mut self, row: usize, parameters: &[f64]) -> Result<(), Blocked> {
        self.path.to.copy_from_slice(parameters);
        let changed = self.advance_to(row);
        self.path.from.copy_from_slice(parameters);
        changed
    }

    /// Returns whether a driver can go on by one turn while the others stay; moves there.
    pub(crate) fn turns(&mut self, driver: DriverId) -> bool {
        let pose = self.motion.pose();
        self.path.duration = 0.0;
        for (driver_path, now) in self.path.driver_paths.iter_mut().zip(&pose.drivers) {
            if *driver_path != DriverPath::Motion {
                *driver_path = DriverPath::held(*now, *now);
            }
        }
        let now = pose.drivers[driver.index()];
        self.path.driver_paths[driver.index()] = DriverPath::held(now + TAU, now);
        self.track().is_ok()
    }

    /// Returns to a pose.
    pub(crate) fn return_to(&mut self, pose: &Pose) {
        self.motion.solver.restore(pose);
        self.path.from.copy_from_slice(&pose.parameters);
        self.path.to.copy_from_slice(&pose.parameters);
    }

    /// Returns poses at a row's time with these parameters, in any assembly mode. The runner is
    /// then without a valid pose until it [returns](Self::return_to) to one.
    pub(crate) fn poses(&mut self, row: usize, parameters: &[f64]) -> Vec<Pose> {
        self.head_for(row);
        self.path.to.copy_from_slice(parameters);
        self.motion.solver.poses(&self.path).unwrap_or_default()
    }

    /// Leads the path from the present pose to a row's time.
    fn head_for(&mut self, row: usize) {
        let pose = self.motion.pose();
        self.path.start = pose.time;
        self.path.duration = self.scenario.times[row] - pose.time;
        for (index, driver_path) in self.path.driver_paths.iter_mut().enumerate() {
            if *driver_path == DriverPath::Motion {
                continue;
            }
            let now = pose.drivers[index];
            let sample = self.scenario.sample(DriverId(index), row, &self.path.to);
            let value = sample.map_or(now, |sample| sample.value);
            *driver_path = DriverPath::held(value, now);
        }
    }

    /// Linearizes the free motion at the start, or at the stable equilibrium downhill from it.
    ///
    /// # Errors
    ///
    /// There is no freedom, no equilibrium or no derivative.
    pub(crate) fn linearize(
        &mut self,
        outputs: &[Output],
        balance: bool,
    ) -> Result<StateSpace, Failure> {
        if self.motion.free().is_none() {
            return Err(Failure::Usage(dynamics::Error::NoFreedom.to_string()));
        }
        let (motion, part) = self.at_start();
        if balance {
            motion.balance(&part).map_err(stopped)?;
        }
        part.loads(part.scenario.times[0], &mut motion.solution.loads);
        motion.take_rates();
        motion.linearize(outputs).map_err(stopped)
    }

    /// Adds what is worth knowing and was not told yet, with the events of free motion apart.
    pub(crate) fn tell(&mut self, notices: &mut Vec<String>, events: &mut Vec<Event>) {
        self.motion.tell_notices(|notice| match notice {
            Notice::Event(event, _) => events.push(event),
            other => notices.push(other.to_string()),
        });
    }

    /// Adds the events of free motion that were not told yet.
    pub(crate) fn tell_events(&mut self, events: &mut Vec<Event>) {
        for notice in self.motion.happenings() {
            if let Notice::Event(event, _) = notice {
                events.push(event);
            }
        }
    }

    /// Returns the motion, which seeks forces, and what is given at the start.
    fn at_start(&mut self) -> (&mut Motion, Part<'_>) {
        if self.motion.solution.forces().is_none() {
            self.motion.seek_forces();
        }
        let part = Part {
            scenario: &self.scenario,
            held: &self.held,
            parameters: &self.path.to,
            row: 0,
        };
        (&mut self.motion, part)
    }

    /// Moves to the stable equilibrium downhill from the start, or with `all` finds those downhill from
    /// places all over the range of the freedoms.
    ///
    /// # Errors
    ///
    /// There is no freedom, or no equilibrium is found.
    pub(crate) fn balance(&mut self, all: bool) -> Result<Vec<Equilibrium>, Failure> {
        let (motion, part) = self.at_start();
        let found = if all {
            motion.balances(&part)
        } else {
            motion.balance(&part).map(|equilibrium| vec![equilibrium])
        };
        found.map_err(stopped)
    }

    /// Watches contacts, which tell where they pull though nobody asks for forces.
    ///
    /// # Errors
    ///
    /// Rates do not exist at the pose, that of the first row.
    pub(crate) fn watch_contacts(&mut self) -> Result<(), Error> {
        if self.motion.watch_contacts() {
            self.solve(0)?;
        }
        Ok(())
    }

    fn sample(&self, driver: DriverId, row: usize) -> Option<Jet> {
        self.scenario.sample(driver, row, &self.path.to)
    }

    /// Returns the value of a column \[SI\].
    pub(crate) fn value(&self, column: &Output) -> f64 {
        self.motion.value(column)
    }

    /// Returns the directions at the pose: those of a free motion have changed with it.
    ///
    /// # Errors
    ///
    /// They do not exist, as at a singular position.
    pub(crate) fn directions<'a>(
        &mut self,
        own: &'a [Direction],
    ) -> Result<Cow<'a, [Direction]>, Failure> {
        self.motion.directions(own).map_err(stopped)
    }

    /// Adds the derivatives of columns along directions, by direction, then by column.
    ///
    /// # Errors
    ///
    /// They do not exist, as at a singular position.
    pub(crate) fn differentiate(
        &mut self,
        columns: &[Output],
        directions: &[Direction],
        derivatives: &mut Vec<f64>,
    ) -> Result<(), Error> {
        let directions = &*self.with_followers(directions);
        let Motion {
            solver, solution, ..
        } = &mut self.motion;
        if columns.iter().any(Output::uses_forces) {
            for direction in directions {
                derivatives.extend(solution.changes(solver, columns, direction)?);
            }
            return Ok(());
        }
        let orders = columns.iter().map(|column| match column.source {
            OutputSource::Signal(_, order) => order,
            OutputSource::Input(_) => Order::Position,
            OutputSource::Derived(_) | OutputSource::Force(_) => Order::Acceleration,
        });
        let highest = orders.max();
        let own = &self.scenario.own;
        solver.sensitivities(
            &solution.rates,
            &solution.driver_rates,
            directions,
            highest.unwrap_or(Order::Position),
            |change| {
                for column in columns {
                    derivatives.push(column.source.change(own, change, None)?);
                }
                Ok(())
            },
        )
    }

    /// Returns directions with the changes of drivers that follow inputs.
    fn with_followers<'a>(&self, directions: &'a [Direction]) -> Cow<'a, [Direction]> {
        let Scenario { own, driven, .. } = &self.scenario;
        let mut all = driven.drivers.iter();
        if !all.any(Driver::is_moved_by_inputs) {
            return Cow::Borrowed(directions);
        }
        let completed = directions.iter().map(|direction| {
            let mut direction = direction.clone();
            let now = self.path.to.iter().zip(&direction.parameters);
            let mut parameters: Vec<Dual> = now.map(|(&is, &by)| Dual::new(is, [by])).collect();
            own.derive_parameters(&mut parameters);
            for (driver, change) in direction.drivers.iter_mut().enumerate() {
                let followed = (self.scenario).change(DriverId(driver), self.solved, &parameters);
                *change = followed.unwrap_or(*change);
            }
            direction
        });
        Cow::Owned(completed.collect())
    }

    /// Solves rates and forces at the pose of a row.
    ///
    /// # Errors
    ///
    /// They do not exist at a singular position.
    pub(crate) fn solve(&mut self, row: usize) -> Result<(), Error> {
        let Self {
            motion,
            scenario,
            path,
            solved,
            ..
        } = self;
        motion.take_rates();
        for (place, [sizes, ..]) in &scenario.loads {
            if let Some(load) = motion.solution.loads.get_mut(*place) {
                *load = sizes[row];
            }
        }
        let rates = motion.solution.driver_rates.iter_mut().enumerate();
        for (driver, rates) in rates {
            if let Some(sample) = scenario.sample(DriverId(driver), row, &path.to) {
                *rates = sample;
            }
        }
        *solved = row;
        motion.solve()
    }
}

/// The inputs between two rows: drivers on cubics that have their values and velocities there, sizes of
/// forces on straight lines.
struct Part<'a> {
    scenario: &'a Scenario,
    held: &'a [f64],
    parameters: &'a [f64],
    /// The later row.
    row: usize,
}

impl Part<'_> {
    /// Returns the earlier and the later row, the time between them, and the place of a time on it.
    fn rows(&self, time: f64) -> ([usize; 2], f64, f64) {
        let times = &self.scenario.times;
        let later = self.row.min(times.len() - 1);
        let earlier = later.saturating_sub(1);
        let h = times[later] - times[earlier];
        let s = if h > 0.0 {
            (time - times[earlier]) / h
        } else {
            1.0
        };
        ([earlier, later], h, s)
    }
}

impl Given for Part<'_> {
    fn driver(&self, driver: DriverId, time: f64) -> Jet {
        let (rows, h, s) = self.rows(time);
        let [Some(from), Some(to)] =
            rows.map(|row| self.scenario.sample(driver, row, self.parameters))
        else {
            return Jet::constant(self.held[driver.index()]);
        };
        on_cubic(from, to, h, s)
    }

    fn loads(&self, time: f64, loads: &mut [f64]) {
        let ([earlier, later], _, s) = self.rows(time);
        for (place, [sizes, ..]) in &self.scenario.loads {
            loads[*place] = sizes[earlier] + s * (sizes[later] - sizes[earlier]);
        }
    }
}

/// Returns the failure of a free motion.
fn stopped(error: dynamics::Error) -> Failure {
    Failure::Assembly(error.to_string())
}

//! A mechanism that moves along the samples and motions of its drivers.

use std::borrow::Cow;
use std::f64::consts::TAU;

use biela::dynamics::{self, FreeMotion, FreeState, Given, StateSpace};
use biela::kinematics::{
    Blocked, Budget, Curve, Direction, Error, ForceParts, Output, OutputSource, Path, Pose,
    Solution, Solver, SolverChoices,
};
use biela::mechanism::{DriverId, Jet, Order, show_time};

use crate::error::Failure;
use crate::scenario::Scenario;

/// Number of variants that one solver runs in a batch: far more work than making the solver.
pub(crate) const BATCH: usize = 32;

/// A mechanism that moves from one time to the next.
pub(crate) struct Runner {
    pub(crate) scenario: Scenario,
    /// At the file's own values, from which each motion starts.
    home: Solver,
    pub(crate) solver: Solver,
    pub(crate) solution: Solution,
    path: Path,
    choices: SolverChoices,
    near_singular: bool,
    /// The drivers' values at the start, at which those without samples stay.
    held: Vec<f64>,
    /// The motion of freedoms and its state at the file's own values, if the mechanism has some.
    free: Option<(FreeMotion, FreeState)>,
    /// Whether motions that stop do so without a reason, which is cheaper.
    pub(crate) gives_up: bool,
    /// Whether forces are solved for the sake of contacts that pull alone.
    watches_contacts: bool,
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
        let home = Solver::new(scenario.own.clone())?;
        let solver = Solver::new(scenario.driven.clone())?;
        let mut solution = Solution::new(&solver);
        if columns.iter().any(Output::uses_forces) {
            solution.seek_forces(&solver);
        }
        let tolerance = solver.mechanism().simulation.tolerance;
        let free = FreeMotion::along(&solver, tolerance, directions.to_vec()).map_err(stopped)?;
        Ok(Self {
            free: free.map(|free| {
                let state = free.state();
                (free, state)
            }),
            home,
            solution,
            scenario: scenario.clone(),
            path: Path::new(solver.mechanism()),
            choices: SolverChoices::default(),
            solver,
            near_singular: false,
            held: Vec::new(),
            gives_up: false,
            watches_contacts: false,
        })
    }

    /// Moves from the file's own pose to the first time, with these parameters. The result depends
    /// on them alone, not on motions before.
    ///
    /// # Errors
    ///
    /// No continuous motion leads there, or the mechanism does not close there.
    pub(crate) fn start(&mut self, parameters: &[f64]) -> Result<(), Failure> {
        let time = self.scenario.times[0];
        self.begin(parameters)
            .map_err(|error| Failure::Assembly(error.at_start(time)))?;
        self.release()
    }

    /// Lets freedoms move by the forces from the present pose on, with the velocities of the file.
    fn release(&mut self) -> Result<(), Failure> {
        if let Some((free, _)) = &mut self.free {
            let (scenario, held) = (&self.scenario, &self.held);
            let part = Part {
                scenario,
                held,
                row: 1,
            };
            free.start(&mut self.solver, &part).map_err(stopped)?;
            self.solve(0)?;
        }
        Ok(())
    }

    fn begin(&mut self, parameters: &[f64]) -> Result<(), Error> {
        let Scenario { driven, home, .. } = &self.scenario;
        self.home.resume(&home.0, &home.1);
        let home = &home.0;
        let value = |driver| Some(self.sample(driver, 0)?.value);
        let path = (self.home).path_to_start(driven, parameters, self.scenario.times[0], value);
        self.home.start(home, &path)?;
        self.home.copy_choices(&mut self.choices);
        if let Some((free, state)) = &mut self.free {
            let selected = free.select(&mut self.solver, &mut self.solution, state);
            debug_assert!(selected.is_ok(), "the file's own freedoms");
        }
        self.solver.resume(self.home.pose(), &self.choices);
        self.path.from.copy_from_slice(parameters);
        self.path.to.copy_from_slice(parameters);
        self.near_singular = false;
        self.held.clone_from(&self.solver.pose().drivers);
        self.solve(0)
    }

    /// Moves on to a row's time.
    ///
    /// # Errors
    ///
    /// Cause of the mechanism's stop, and its place.
    pub(crate) fn advance(&mut self, row: usize) -> Result<(), String> {
        let budget = Budget::usual(self.solver.mechanism());
        self.solver.set_budget(budget);
        if self.free.is_some() {
            return self.advance_freely(row);
        }
        self.advance_to(row).map_err(|blocked| {
            let mechanism = self.solver.mechanism();
            let pose = self.solver.pose();
            blocked.describe(mechanism, pose, Some(pose.time), |driver| {
                mechanism.drivers[driver.index()].motion().is_some()
                    || self.sample(driver, row).is_some()
            })
        })?;
        self.solve(row).map_err(|error| {
            let time = self.scenario.times[row];
            format!("at t = {} s: {error}", show_time(time))
        })
    }

    /// Moves a mechanism with freedoms on to a row's time.
    fn advance_freely(&mut self, row: usize) -> Result<(), String> {
        let Self {
            free: Some((free, _)),
            solver,
            solution,
            scenario,
            held,
            ..
        } = self
        else {
            return Ok(());
        };
        let part = Part {
            scenario,
            held,
            row,
        };
        let parameters = solver.pose().parameters.clone();
        let time = scenario.times[row];
        free.jump(solver, &part, &parameters)
            .and_then(|()| free.advance(solver, solution, &part, time))
            .map_err(|stop| stop.to_string())?;
        self.solve(row)
            .map_err(|error| format!("at t = {} s: {error}", show_time(time)))
    }

    /// Moves on to a row's time, without rates.
    ///
    /// # Errors
    ///
    /// The motion cannot go on; the pose is the last one reached.
    pub(crate) fn advance_to(&mut self, row: usize) -> Result<(), Blocked> {
        self.head_for(row);
        self.track()
    }

    fn track(&mut self) -> Result<(), Blocked> {
        let tracked = if self.gives_up {
            self.solver.track_or_give_up(&self.path)
        } else {
            self.solver.track(&self.path)
        };
        tracked.map(|_| ())
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
        let pose = self.solver.pose();
        self.path.duration = 0.0;
        for (curve, now) in self.path.curves.iter_mut().zip(&pose.drivers) {
            if *curve != Curve::Motion {
                *curve = Curve::held(*now, *now);
            }
        }
        let now = pose.drivers[driver.index()];
        self.path.curves[driver.index()] = Curve::held(now + TAU, now);
        self.track().is_ok()
    }

    /// Returns to a pose.
    pub(crate) fn return_to(&mut self, pose: &Pose) {
        self.solver.restore(pose);
        self.path.from.copy_from_slice(&pose.parameters);
        self.path.to.copy_from_slice(&pose.parameters);
    }

    /// Returns poses at a row's time with these parameters, in any assembly mode. The runner is
    /// then without a valid pose until it [returns](Self::return_to) to one.
    pub(crate) fn poses(&mut self, row: usize, parameters: &[f64]) -> Vec<Pose> {
        self.head_for(row);
        self.path.to.copy_from_slice(parameters);
        self.solver.poses(&self.path).unwrap_or_default()
    }

    /// Leads the path from the present pose to a row's time.
    fn head_for(&mut self, row: usize) {
        let pose = self.solver.pose();
        self.path.start = pose.time;
        self.path.duration = self.scenario.times[row] - pose.time;
        for (index, curve) in self.path.curves.iter_mut().enumerate() {
            if *curve == Curve::Motion {
                continue;
            }
            let now = pose.drivers[index];
            let driver = DriverId(index);
            let samples = self.scenario.samples.iter().find(|s| s.driver == driver);
            let value = samples.map_or(now, |samples| samples.at(row).value);
            *curve = Curve::held(value, now);
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
        let Self {
            free,
            solver,
            solution,
            scenario,
            held,
            ..
        } = self;
        let Some((free, _)) = free else {
            let why = "the mechanism has no freedom: all that moves is driven";
            return Err(Failure::Usage(why.to_owned()));
        };
        if solution.forces().is_none() {
            solution.seek_forces(solver);
        }
        let part = Part {
            scenario,
            held,
            row: 0,
        };
        if balance {
            free.balance(solver, solution, &part).map_err(stopped)?;
        }
        part.loads(scenario.times[0], &mut solution.loads);
        free.tell(solution);
        free.linearize(solver, solution, outputs).map_err(stopped)
    }

    /// Returns what is worth knowing of the last [`advance`](Self::advance): singular positions
    /// that are near or were passed.
    pub(crate) fn notices(&mut self) -> Vec<String> {
        let time = self.solver.pose().time;
        let approach = self.solver.approach(&mut self.near_singular);
        let crossed = self.solver.crossed().iter();
        let crossed = crossed.map(|crossing| self.solver.describe_crossing(crossing));
        let texts = approach.map(|approach| approach.to_string()).into_iter();
        let texts = texts.chain(crossed);
        let texts = texts.map(|text| format!("t = {} s: {text}", show_time(time)));
        let mut notices: Vec<String> = texts.collect();
        notices.extend(self.events());
        notices
    }

    /// Returns the events of a free motion since the last call.
    pub(crate) fn events(&mut self) -> Vec<String> {
        let mechanism = self.solver.mechanism();
        let events = self.free.iter_mut().flat_map(|(free, _)| free.events());
        let mut notices: Vec<_> = events.map(|event| event.describe(mechanism)).collect();
        notices.extend(self.overlaps());
        notices
    }

    /// Returns what has overlapped since the last call, at the start or where inputs jumped.
    fn overlaps(&mut self) -> Vec<String> {
        let mechanism = self.solver.mechanism();
        let overlaps = self.free.iter_mut().flat_map(|(free, _)| free.overlaps());
        overlaps
            .map(|overlap| overlap.describe(mechanism))
            .collect()
    }

    /// Watches contacts, which tell where they pull though nobody asks for forces.
    ///
    /// # Errors
    ///
    /// Rates do not exist at the pose, that of the first row.
    pub(crate) fn watch_contacts(&mut self) -> Result<(), Error> {
        let has_dynamics = self.solver.mechanism().has_dynamics();
        let asks_forces = self.solution.forces().is_some();
        if has_dynamics && !asks_forces && self.solver.forces().contacts() > 0 {
            self.solution.seek_forces(&self.solver);
            self.watches_contacts = true;
            self.solve(0)?;
        }
        Ok(())
    }

    /// Returns what is worth knowing of the forces at the pose: contacts that begin to pull.
    pub(crate) fn lift_offs(&mut self) -> Vec<String> {
        let lift_offs = self.solution.lift_offs(&self.solver);
        lift_offs.map(|lift_off| lift_off.to_string()).collect()
    }

    fn sample(&self, driver: DriverId, row: usize) -> Option<Jet> {
        let samples = self.scenario.samples.iter().find(|s| s.driver == driver)?;
        Some(samples.at(row))
    }

    /// Returns the value of a column \[SI\].
    pub(crate) fn value(&self, column: &Output) -> f64 {
        self.solution.value(&self.solver, column)
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
        let Some((free, _)) = &mut self.free else {
            return Ok(Cow::Borrowed(own));
        };
        let varied = free.varied(&mut self.solver, &mut self.solution);
        varied.map(Cow::Owned).map_err(stopped)
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
        let Self {
            solver, solution, ..
        } = self;
        if columns.iter().any(Output::uses_forces) {
            for direction in directions {
                derivatives.extend(solution.changes(solver, columns, direction)?);
            }
            return Ok(());
        }
        let orders = columns.iter().map(|column| match column.source {
            OutputSource::Signal(_, order) => order,
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

    /// Solves rates and forces at the pose of a row.
    ///
    /// # Errors
    ///
    /// They do not exist at a singular position.
    pub(crate) fn solve(&mut self, row: usize) -> Result<(), Error> {
        if let Some((free, _)) = &self.free {
            free.tell(&mut self.solution);
        }
        for (place, sizes) in &self.scenario.loads {
            if let Some(load) = self.solution.loads.get_mut(*place) {
                *load = sizes[row];
            }
        }
        self.solution.follow_motions(&self.solver);
        for samples in &self.scenario.samples {
            self.solution.driver_rates[samples.driver.index()] = samples.at(row);
        }
        if !self.watches_contacts {
            return self.solution.solve(&mut self.solver);
        }
        self.solution.solve_rates(&mut self.solver)?;
        // Forces may exist at fewer poses than the values that are asked for.
        let _ = self
            .solution
            .solve_forces(&mut self.solver, ForceParts::REACTIONS);
        Ok(())
    }
}

/// The inputs between two rows: drivers on cubics that have their values and velocities there, sizes of
/// forces on straight lines.
struct Part<'a> {
    scenario: &'a Scenario,
    held: &'a [f64],
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
        let Some(samples) = self.scenario.samples.iter().find(|s| s.driver == driver) else {
            return Jet::constant(self.held[driver.index()]);
        };
        let (rows, h, s) = self.rows(time);
        let [from, to] = rows.map(|row| samples.at(row));
        if h <= 0.0 {
            return to;
        }
        let [before, after] = [from, to].map(|jet| h * jet.first());
        let rise = to.value - from.value;
        // Coefficients of s² and s³.
        let [square, cube] = [
            3.0 * rise - 2.0 * before - after,
            before + after - 2.0 * rise,
        ];
        Jet::new(
            from.value + s * (before + s * (square + s * cube)),
            [
                (before + s * (2.0 * square + 3.0 * s * cube)) / h,
                (2.0 * square + 6.0 * s * cube) / (h * h),
            ],
        )
    }

    fn loads(&self, time: f64, loads: &mut [f64]) {
        let ([earlier, later], _, s) = self.rows(time);
        for (place, sizes) in &self.scenario.loads {
            loads[*place] = sizes[earlier] + s * (sizes[later] - sizes[earlier]);
        }
    }
}

/// Returns the failure of a free motion.
fn stopped(error: dynamics::Error) -> Failure {
    Failure::Assembly(error.to_string())
}

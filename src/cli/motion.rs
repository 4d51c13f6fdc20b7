//! A mechanism on its way along the motions of its drivers.

use std::sync::Arc;

use super::conditions;
use super::message::Message;
use super::signals::Signals;
use crate::kinematics::{Curve, Path, Rates, Reason, Solver};
use crate::mechanism::{DriverId, Jet, Mechanism};

/// A mechanism that moves from one time to the next.
pub(super) struct Motion {
    pub(super) solver: Solver,
    pub(super) rates: Rates,
    /// Value, velocity and acceleration of each driver.
    pub(super) driver_rates: Vec<Jet>,
    /// What people should know of the way: singular positions that are near, or passed.
    pub(super) notices: Vec<Message>,
    path: Path,
    signals: Signals,
    /// Whether a notice told of the singular position that is near.
    near_singular: bool,
}

impl Motion {
    /// Moves from the file's pose to the values at the start, in the file's assembly mode.
    pub(super) fn start(
        home_solver: Solver,
        driven: Arc<Mechanism>,
        signals: Signals,
        parameters: Vec<f64>,
        time: f64,
    ) -> Result<Self, crate::kinematics::Error> {
        let given = |driver| Some(signals.at(driver, time)?.value);
        let solver = conditions::start(home_solver, &driven, &parameters, time, given)?;
        Self::from(solver, signals, parameters, time)
    }

    /// From where a solver stands, at a time at which its drivers are there.
    pub(super) fn from(
        solver: Solver,
        signals: Signals,
        parameters: Vec<f64>,
        time: f64,
    ) -> Result<Self, crate::kinematics::Error> {
        let start = solver.pose();
        let mut path = Path::new(solver.mechanism());
        path.start = time;
        path.from.clone_from(&parameters);
        path.to = parameters;
        for (curve, value) in path.curves.iter_mut().zip(&start.drivers) {
            if let Curve::Input { position, .. } = curve {
                *position = *value;
            }
        }
        let mut motion = Self {
            rates: Rates::new(start.q.len()),
            driver_rates: start.drivers.iter().map(|u| Jet::constant(*u)).collect(),
            solver,
            notices: Vec::new(),
            path,
            signals,
            near_singular: false,
        };
        motion.solve_rates()?;
        Ok(motion)
    }

    /// Goes on to `time`, from one point of the signals to the next.
    ///
    /// # Errors
    ///
    /// Why it cannot, and where that is.
    pub(super) fn advance(&mut self, time: f64) -> Result<(), String> {
        while self.solver.pose().time < time {
            let start = self.solver.pose().time;
            self.go(self.signals.next_point(start).min(time))?;
            // Where a signal jumps.
            if self.aim() {
                self.go(self.solver.pose().time)?;
            }
        }
        self.solve_rates()
            .map_err(|error| format!("at t = {time} s: {error}"))
    }

    /// Directs the drivers that follow signals to where these lead from here; whether any of
    /// them is elsewhere now.
    fn aim(&mut self) -> bool {
        let pose = self.solver.pose();
        let mut off = false;
        let curves = self.path.curves.iter_mut().zip(&pose.drivers);
        for (driver, (curve, value)) in curves.enumerate() {
            let Some(signal) = self.signals.line(DriverId(driver), pose.time) else {
                continue;
            };
            *curve = Curve::Input {
                position: signal.value,
                velocity: signal.first(),
                acceleration: 0.0,
                jump: value - signal.value,
            };
            // Far less than any mechanism moves by, far more than rounding.
            off |= (value - signal.value).abs() > 1e-12 * (1.0 + value.abs());
        }
        off
    }

    /// Follows the drivers' curves until `time`.
    fn go(&mut self, time: f64) -> Result<(), String> {
        self.aim();
        self.path.start = self.solver.pose().time;
        self.path.duration = time - self.path.start;
        let Err(blocked) = self.solver.follow(&self.path) else {
            if let Some(approach) = self.solver.approach(&mut self.near_singular) {
                let notice = format!("t = {time} s: {approach}");
                self.notices.push(Message::Warning(notice));
            }
            for crossing in self.solver.crossed() {
                let passed = self.solver.describe_crossing(crossing);
                let notice = format!("t = {time} s: {passed}");
                self.notices.push(Message::Note(notice));
            }
            return Ok(());
        };
        let why = match &blocked.reason {
            Reason::Value(error) => error.to_string(),
            Reason::Contradiction(open) => format!("beyond, {open}, redundant up to here"),
            Reason::TooLong => "the motion is too fast for the steps".to_owned(),
            Reason::Singular(point) => point.to_string(),
            _ => "no continuous motion".to_owned(),
        };
        let pose = self.solver.pose();
        let limits = match &blocked.reason {
            Reason::Singular(point) => &point.drivers,
            _ => &pose.drivers,
        };
        let drivers = self.solver.mechanism().drivers.iter().zip(limits);
        let moving: Vec<_> = drivers
            .enumerate()
            .filter(|(index, (driver, _))| {
                driver.motion().is_some() || self.signals.has(DriverId(*index))
            })
            .map(|(_, (driver, value))| {
                format!(
                    "`{}` at {}",
                    driver.name,
                    driver.coordinate.kind.show(*value)
                )
            })
            .collect();
        Err(format!(
            "{why} at t = {:.9} s: the mechanism cannot go on, with {}",
            pose.time,
            moving.join(", ")
        ))
    }

    fn solve_rates(&mut self) -> Result<(), crate::kinematics::Error> {
        let time = self.solver.pose().time;
        let drivers = self.solver.mechanism().drivers.iter().enumerate();
        for (rates, (index, driver)) in self.driver_rates.iter_mut().zip(drivers) {
            if driver.motion().is_some() {
                *rates = self.solver.motion(DriverId(index), time);
            } else if let Some(signal) = self.signals.at(DriverId(index), time) {
                *rates = signal;
            }
        }
        let driver_rates = &self.driver_rates;
        self.solver
            .solve_rates(|driver| driver_rates[driver.index()], &mut self.rates)
    }
}

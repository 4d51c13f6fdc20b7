//! Values of drivers and of inputs of forces over time.

mod file;

use std::f64::consts::TAU;
use std::sync::Arc;

use biela::dynamics::Given;
use biela::mechanism::{DriverId, DriverSource, Jet, Mechanism, Order, ParameterId};

/// Values of drivers and of inputs of forces over time: linear between two points, constant before
/// the first and after the last. At a time that occurs twice the value jumps to that of the later
/// row. Wrapped angles count turns here.
#[derive(Debug, Default)]
pub(in crate::cli) struct Signals {
    times: Vec<f64>,
    /// Values of each column; a driver with a column has one of positions.
    columns: Vec<(ColumnInput, Vec<f64>)>,
    /// The mechanism, if drivers of it follow inputs that have a column, and the parameters in force.
    followers: Option<(Arc<Mechanism>, Vec<f64>)>,
}

/// The input that a column gives.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ColumnInput {
    Driver(DriverId, Order),
    /// An input of a force, by its index among all.
    Force(usize),
}

/// Largest difference of two times that count as one, relative or in seconds.
const SAME: f64 = 1e-9;

impl Signals {
    /// Puts each position of a wrapped angle on the turn nearest the last value, the first on that
    /// nearest the file's start, as the FMU does.
    fn unwrap(&mut self, mechanism: &Mechanism) {
        for (target, values) in &mut self.columns {
            if let ColumnInput::Driver(id, Order::Position) = *target
                && let driver = &mechanism.drivers[id.index()]
                && let DriverSource::Input { start } = driver.source
                && driver.wrapped
            {
                let mut last = start;
                for value in values {
                    *value += TAU * ((last - *value) / TAU).round();
                    last = *value;
                }
            }
        }
    }

    /// Turns the drivers that follow signals into inputs.
    pub(in crate::cli) fn make_inputs(&self, mechanism: &mut Mechanism) {
        for (target, values) in &self.columns {
            if let ColumnInput::Driver(id, Order::Position) = *target {
                let start = values[0];
                let driver = &mut mechanism.drivers[id.index()];
                driver.source = DriverSource::Input { start };
                driver.follows = None;
            }
        }
    }

    /// Returns the mechanism whose drivers that follow inputs with a column are given, from a time on.
    pub(super) fn with_followers(
        &mut self,
        mut mechanism: Mechanism,
        parameters: &[f64],
        time: f64,
    ) -> Arc<Mechanism> {
        let inputs = mechanism.inputs.iter().enumerate();
        let has_column = |index| self.load(mechanism.input_place(index)).is_some();
        let has_column: Vec<bool> = inputs
            .map(|(index, input)| input.given.is_none() && has_column(index))
            .collect();
        mechanism.give_followers(|input| has_column[input], parameters, time);
        let mechanism = Arc::new(mechanism);
        let mut drivers = mechanism.drivers.iter();
        self.followers = drivers
            .any(|driver| driver.is_moved_by_inputs())
            .then(|| (Arc::clone(&mechanism), parameters.to_vec()));
        mechanism
    }

    /// Returns whether some driver follows a signal.
    pub(in crate::cli) fn has_drivers(&self) -> bool {
        let mut targets = self.columns.iter().map(|(target, _)| target);
        targets.any(|target| target.driver().is_some()) || self.followers.is_some()
    }

    /// Returns whether a driver follows a signal, its own or through inputs of the file.
    pub(in crate::cli) fn has(&self, driver: DriverId) -> bool {
        self.of(driver, Order::Position).is_some() || self.moves_by_inputs(driver)
    }

    /// Returns whether inputs with a column move a driver that follows them.
    pub(in crate::cli) fn moves_by_inputs(&self, driver: DriverId) -> bool {
        let mut mechanisms = self.followers.iter().map(|(mechanism, _)| mechanism);
        mechanisms.any(|mechanism| mechanism.drivers[driver.index()].is_moved_by_inputs())
    }

    /// Returns value, velocity and acceleration at a time of a driver that follows inputs, for the
    /// `signal` of a column.
    fn followed(&self, driver: DriverId, time: f64, signal: impl Fn(&[f64]) -> Jet) -> Option<Jet> {
        let (mechanism, parameters) = self.followers.as_ref()?;
        let driver = &mechanism.drivers[driver.index()];
        if !driver.is_moved_by_inputs() {
            return None;
        }
        let parameter = |id: ParameterId| Jet::constant(parameters[id.index()]);
        let input = |index: usize| match self.load(mechanism.input_place(index)) {
            Some(values) => signal(values),
            None => Jet::constant(mechanism.inputs[index].start),
        };
        driver.followed(&parameter, &input, Jet::variable(time))
    }

    /// Returns the column of a load, by its place.
    fn load(&self, place: usize) -> Option<&[f64]> {
        let mut columns = self.columns.iter();
        let found = columns.find(|(target, _)| *target == ColumnInput::Force(place));
        found.map(|(_, values)| &values[..])
    }

    fn of(&self, driver: DriverId, order: Order) -> Option<&[f64]> {
        let wanted = ColumnInput::Driver(driver, order);
        let found = self.columns.iter().find(|(target, _)| *target == wanted);
        found.map(|(_, values)| &values[..])
    }

    /// Returns a driver's value, with the slope from this time on as velocity, or with the rates of what
    /// follows inputs.
    pub(in crate::cli) fn line(&self, driver: DriverId, time: f64) -> Option<Jet> {
        let signal = |values: &[f64]| self.interpolate(values, time);
        let positions = self.of(driver, Order::Position);
        positions
            .map(signal)
            .or_else(|| self.followed(driver, time, signal))
    }

    /// Returns a driver's value, velocity and acceleration. Without a column of velocities the
    /// velocity is the slope from this time on, without one of accelerations these are zero.
    pub(in crate::cli) fn at(&self, driver: DriverId, time: f64) -> Option<Jet> {
        let mut jet = self.line(driver, time)?;
        let orders = [Order::Velocity, Order::Acceleration];
        for (rate, order) in jet.derivatives.iter_mut().zip(orders) {
            if let Some(rates) = self.of(driver, order) {
                *rate = self.interpolate(rates, time).value;
            }
        }
        Some(jet)
    }

    /// Writes the inputs at a time, those of forces too; those without a signal are left as they are.
    pub(in crate::cli) fn write_loads(&self, time: f64, inputs: &mut [f64]) {
        for (target, values) in &self.columns {
            if let ColumnInput::Force(input) = *target {
                inputs[input] = self.interpolate(values, time).value;
            }
        }
    }

    /// Returns the values from `start`, a time or a point, up to the next point; drivers without a
    /// signal stay at these values.
    pub(in crate::cli) fn part<'a>(&'a self, start: f64, held: &'a [f64]) -> Part<'a> {
        Part {
            signals: self,
            start,
            held,
        }
    }

    /// Returns the time of the first point after `time`; infinity after the last.
    pub(in crate::cli) fn next_point(&self, time: f64) -> f64 {
        let after = self.points_until(time);
        self.times.get(after).copied().unwrap_or(f64::INFINITY)
    }

    /// Returns how many points are not after `time`.
    fn points_until(&self, time: f64) -> usize {
        self.times
            .partition_point(|point| *point <= time || same(*point, time))
    }

    fn interpolate(&self, values: &[f64], time: f64) -> Jet {
        let after = self.points_until(time);
        let Some(before) = after.checked_sub(1) else {
            return Jet::constant(values[0]);
        };
        let Some(end) = self.times.get(after) else {
            return Jet::constant(values[before]);
        };
        let start = self.times[before];
        let slope = (values[after] - values[before]) / (end - start);
        let elapsed = if same(time, start) { 0.0 } else { time - start };
        Jet::new(values[before] + elapsed * slope, [slope, 0.0])
    }
}

/// The values between two points, continued at both as they are between them.
pub(in crate::cli) struct Part<'a> {
    signals: &'a Signals,
    start: f64,
    held: &'a [f64],
}

impl Part<'_> {
    fn line(&self, values: &[f64], time: f64) -> Jet {
        let line = self.signals.interpolate(values, self.start);
        Jet::new(
            line.value + (time - self.start) * line.first(),
            line.derivatives,
        )
    }
}

impl Given for Part<'_> {
    fn driver(&self, driver: DriverId, time: f64) -> Jet {
        let Some(positions) = self.signals.of(driver, Order::Position) else {
            let signal = |values: &[f64]| self.line(values, time);
            let followed = self.signals.followed(driver, time, signal);
            return followed.unwrap_or(Jet::constant(self.held[driver.index()]));
        };
        let mut jet = self.line(positions, time);
        let orders = [Order::Velocity, Order::Acceleration];
        for (rate, order) in jet.derivatives.iter_mut().zip(orders) {
            if let Some(rates) = self.signals.of(driver, order) {
                *rate = self.line(rates, time).value;
            }
        }
        jet
    }

    fn loads(&self, time: f64, loads: &mut [f64]) {
        for (target, values) in &self.signals.columns {
            if let ColumnInput::Force(input) = *target {
                loads[input] = self.line(values, time).value;
            }
        }
    }
}

impl ColumnInput {
    /// Returns the input of this name.
    fn named(name: &str, mechanism: &Mechanism) -> Option<Self> {
        let mut inputs = mechanism.load_inputs().into_iter();
        if let Some(input) = inputs.position(|input| input.name == name) {
            return Some(Self::Force(input));
        }
        let split = Order::ALL.into_iter().find_map(|order| {
            let driver = name.strip_suffix(order.suffix())?.strip_suffix('.')?;
            Some((driver, order))
        });
        let (driver, order) = split.unwrap_or((name, Order::Position));
        let driver = mechanism.driver_id(driver)?;
        Some(Self::Driver(driver, order))
    }

    fn driver(self) -> Option<DriverId> {
        match self {
            Self::Driver(driver, _) => Some(driver),
            Self::Force(_) => None,
        }
    }
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs()).max(1.0)
}

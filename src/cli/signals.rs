//! Values of drivers and of inputs of forces over time from a CSV file.

use std::f64::consts::TAU;
use std::path::Path;

use super::error::Error;
use crate::mechanism::{
    DriverId, DriverSource, Jet, Mechanism, Order, Separated, comma_hint, help, quoted, shown,
};

/// Values of drivers and of inputs of forces over time: linear between two points, constant before
/// the first and after the last. At a time that occurs twice the value jumps to that of the later
/// row. Wrapped angles count turns here.
#[derive(Debug, Default)]
pub(super) struct Signals {
    times: Vec<f64>,
    /// Values of each column; a driver with a column has one of positions.
    columns: Vec<(Target, Vec<f64>)>,
}

/// The variable that a column gives.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Target {
    Driver(DriverId, Order),
    /// An input of a force, by its index among all.
    Force(usize),
}

/// Largest difference of two times that count as one, relative or in seconds.
const SAME: f64 = 1e-9;

impl Signals {
    /// Reads a file as FMPy does: the first column is `time`, the others are variables of drivers,
    /// `crank_angle.position` or `crank_angle` for short, and inputs of forces. Columns are
    /// separated as in the tables of a mechanism file.
    pub(super) fn read(path: &Path, mechanism: &Mechanism) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(Error::read(path))?;
        Self::parse(&text, mechanism)
            .map_err(|message| Error::Usage(format!("--input: `{}`: {message}", path.display())))
    }

    fn parse(text: &str, mechanism: &Mechanism) -> Result<Self, String> {
        let separated = Separated::new(text);
        let mut rows = separated.rows();
        let Some((_, header)) = rows.next() else {
            return Err("it is empty; expected a line of column names, `time` first".to_owned());
        };
        let header = without_empty_end(&header, 0);
        if header.first() != Some(&"time") {
            let found = header.first().unwrap_or(&"");
            return Err(format!("the first column is `{found}`; expected `time`"));
        }
        let mut signals = Self::default();
        for name in &header[1..] {
            let target = Target::named(name, mechanism)?;
            let columns = &mut signals.columns;
            if let Some(first) = columns.iter().position(|(known, _)| *known == target) {
                let [first, second] = [first, columns.len()].map(|after_time| after_time + 2);
                return Err(format!(
                    "two columns for `{name}`: column {first} and column {second}"
                ));
            }
            columns.push((target, Vec::new()));
        }
        if signals.columns.is_empty() {
            return Err("it has no column besides `time`".to_owned());
        }
        for (line, record) in rows {
            let fields = without_empty_end(&record, header.len());
            if fields.len() != header.len() {
                let found = fields.len();
                let columns = if found == 1 { "column" } else { "columns" };
                return Err(format!(
                    "line {line} has {found} {columns}; the first has names for {}",
                    header.len()
                ));
            }
            let mut numbers = fields.iter().map(|field| {
                let number = field.parse().ok().filter(|number: &f64| number.is_finite());
                number.ok_or_else(|| {
                    let (shown, hint) = (quoted(field), comma_hint(field));
                    format!("line {line}: {shown} is not a finite number{hint}")
                })
            });
            let time = numbers.next().expect("a row is as long as the header")?;
            if signals.times.last().is_some_and(|last| time < *last) {
                return Err(format!("line {line}: time goes back to {}", shown(time)));
            }
            signals.times.push(time);
            for ((_, values), value) in signals.columns.iter_mut().zip(numbers) {
                values.push(value?);
            }
        }
        if signals.times.is_empty() {
            return Err("it has no rows of numbers".to_owned());
        }
        let mut drivers = signals
            .columns
            .iter()
            .filter_map(|(target, _)| target.driver());
        if let Some(driver) = drivers.find(|driver| !signals.has(*driver)) {
            let name = &mechanism.drivers[driver.index()].name;
            return Err(format!(
                "it has rates of `{name}` but no column `{name}.position`"
            ));
        }
        signals.unwrap(mechanism);
        Ok(signals)
    }

    /// Puts each position of a wrapped angle on the turn nearest the last value, the first on that
    /// nearest the file's start, as the FMU does.
    fn unwrap(&mut self, mechanism: &Mechanism) {
        for (target, values) in &mut self.columns {
            if let Target::Driver(id, Order::Position) = *target
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
    pub(super) fn make_inputs(&self, mechanism: &mut Mechanism) {
        for (target, values) in &self.columns {
            if let Target::Driver(id, Order::Position) = *target {
                let start = values[0];
                mechanism.drivers[id.index()].source = DriverSource::Input { start };
            }
        }
    }

    /// Returns whether some driver follows a signal.
    pub(super) fn has_drivers(&self) -> bool {
        let mut targets = self.columns.iter().map(|(target, _)| target);
        targets.any(|target| target.driver().is_some())
    }

    /// Returns whether a driver follows a signal.
    pub(super) fn has(&self, driver: DriverId) -> bool {
        self.of(driver, Order::Position).is_some()
    }

    fn of(&self, driver: DriverId, order: Order) -> Option<&[f64]> {
        let wanted = Target::Driver(driver, order);
        let found = self.columns.iter().find(|(target, _)| *target == wanted);
        found.map(|(_, values)| &values[..])
    }

    /// Returns a driver's value, with the slope from this time on as velocity.
    pub(super) fn line(&self, driver: DriverId, time: f64) -> Option<Jet> {
        let positions = self.of(driver, Order::Position)?;
        Some(self.interpolate(positions, time))
    }

    /// Returns a driver's value, velocity and acceleration. Without a column of velocities the
    /// velocity is the slope from this time on, without one of accelerations these are zero.
    pub(super) fn at(&self, driver: DriverId, time: f64) -> Option<Jet> {
        let mut jet = self.line(driver, time)?;
        let orders = [Order::Velocity, Order::Acceleration];
        for (rate, order) in jet.derivatives.iter_mut().zip(orders) {
            if let Some(rates) = self.of(driver, order) {
                *rate = self.interpolate(rates, time).value;
            }
        }
        Some(jet)
    }

    /// Writes the inputs of forces at a time; those without a signal are left as they are.
    pub(super) fn write_forces(&self, time: f64, inputs: &mut [f64]) {
        for (target, values) in &self.columns {
            if let Target::Force(input) = *target {
                inputs[input] = self.interpolate(values, time).value;
            }
        }
    }

    /// Returns the time of the first point after `time`; infinity after the last.
    pub(super) fn next_point(&self, time: f64) -> f64 {
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

impl Target {
    /// Returns the variable of a column of this name.
    fn named(name: &str, mechanism: &Mechanism) -> Result<Self, String> {
        let mut inputs = mechanism.force_inputs().into_iter();
        if let Some(input) = inputs.position(|input| input.name == name) {
            return Ok(Self::Force(input));
        }
        let split = Order::ALL.into_iter().find_map(|order| {
            let driver = name.strip_suffix(order.suffix())?.strip_suffix('.')?;
            Some((driver, order))
        });
        let (driver, order) = split.unwrap_or((name, Order::Position));
        let driver = mechanism.driver_id(driver);
        driver
            .map(|driver| Self::Driver(driver, order))
            .ok_or_else(|| unknown(name, mechanism))
    }

    fn driver(self) -> Option<DriverId> {
        match self {
            Self::Driver(driver, _) => Some(driver),
            Self::Force(_) => None,
        }
    }
}

/// Says that a column is neither a variable of a driver nor an input of a force, and which one may
/// be meant.
fn unknown(name: &str, mechanism: &Mechanism) -> String {
    let given = mechanism.given_forces();
    if let Some(given) = given.iter().find(|given| given.name == name) {
        let force = &mechanism.forces[given.force].name;
        return format!(
            "column `{name}` is no input: the file or --drive gives `{force}` its size"
        );
    }
    let drivers = || mechanism.drivers.iter().map(|driver| driver.name.as_str());
    let inputs = mechanism.force_inputs();
    let variables = |order: Order| drivers().map(move |d| format!("{d}.{}", order.suffix()));
    let positions: Vec<String> = variables(Order::Position).collect();
    let main = positions
        .iter()
        .chain(inputs.iter().map(|input| &input.name));
    let main: Vec<&str> = main.map(String::as_str).collect();
    let rates = [Order::Velocity, Order::Acceleration];
    let rates: Vec<String> = rates.into_iter().flat_map(variables).collect();
    let further: Vec<&str> = drivers().chain(rates.iter().map(String::as_str)).collect();
    let help = help(name, &main, &further);
    let help = help.map_or_else(String::new, |help| format!("; {help}"));
    let forces = if inputs.is_empty() {
        ""
    } else {
        " and no input of a force"
    };
    format!(
        "column {} is no variable of a driver{forces}{help}",
        quoted(name)
    )
}

/// Returns the fields of a row without the empty ones at its end, which separators leave there,
/// but at least `kept`.
fn without_empty_end(record: &csv::StringRecord, kept: usize) -> Vec<&str> {
    let mut fields: Vec<&str> = record.iter().collect();
    while fields.len() > kept && fields.last() == Some(&"") {
        fields.pop();
    }
    fields
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs()).max(1.0)
}

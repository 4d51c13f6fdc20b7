//! Values of drivers and of inputs of forces over time from a CSV file.

use std::f64::consts::TAU;
use std::path::Path;

use super::error::Error;
use crate::mechanism::Order;
use crate::mechanism::{
    DriverId, DriverSource, Jet, Mechanism, Separated, comma_hint, help, quoted, shown,
};

/// Values of drivers and of inputs of forces over time: linear between two points, constant before
/// the first and after the last. At a time that occurs twice the value jumps to that of the later
/// row. Wrapped angles count turns here.
#[derive(Debug, Default)]
pub(super) struct Signals {
    times: Vec<f64>,
    signals: Vec<Signal>,
    forces: Vec<ForceSignal>,
}

/// The columns of one driver.
#[derive(Debug)]
struct Signal {
    driver: DriverId,
    /// Position, velocity and acceleration; after reading the position is always there.
    columns: [Option<Vec<f64>>; 3],
}

/// The column of one input of a force.
#[derive(Debug)]
struct ForceSignal {
    /// Index among all inputs of forces.
    input: usize,
    values: Vec<f64>,
}

/// Place of a column, by the indices of its signal and its order.
#[derive(PartialEq)]
enum Place {
    Driver(usize, usize),
    Force(usize),
}

/// Largest difference of two times that count as one, relative or in seconds.
const SAME: f64 = 1e-9;

impl Signals {
    /// Reads a file as FMPy does: the first column is `time`, the others are variables of drivers,
    /// `crank_angle.position` or `crank_angle` for short, and inputs of forces. Columns are separated as in the tables
    /// of a mechanism file.
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
        let mut places: Vec<Place> = Vec::new();
        for name in &header[1..] {
            let place = signals.add_column(name, mechanism)?;
            if let Some(first) = places.iter().position(|known| *known == place) {
                let [first, second] = [first, places.len()].map(|after_time| after_time + 2);
                return Err(format!(
                    "two columns for `{name}`: column {first} and column {second}"
                ));
            }
            places.push(place);
        }
        if places.is_empty() {
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
            for (place, value) in places.iter().zip(numbers) {
                match *place {
                    Place::Driver(signal, order) => {
                        let column = signals.signals[signal].columns[order].as_mut();
                        column.expect("the header has made it").push(value?);
                    }
                    Place::Force(signal) => signals.forces[signal].values.push(value?),
                }
            }
        }
        if signals.times.is_empty() {
            return Err("it has no rows of numbers".to_owned());
        }
        if let Some(signal) = signals.signals.iter().find(|s| s.columns[0].is_none()) {
            let name = &mechanism.drivers[signal.driver.index()].name;
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
        for signal in &mut self.signals {
            let driver = &mechanism.drivers[signal.driver.index()];
            let DriverSource::Input { start } = driver.source else {
                continue;
            };
            if driver.wrapped {
                let mut last = start;
                for value in signal.columns[0].iter_mut().flatten() {
                    *value += TAU * ((last - *value) / TAU).round();
                    last = *value;
                }
            }
        }
    }

    /// Adds an empty column, unless it is there; returns its place.
    fn add_column(&mut self, name: &str, mechanism: &Mechanism) -> Result<Place, String> {
        let inputs = mechanism.force_inputs();
        if let Some(input) = inputs.iter().position(|input| input.name == name) {
            let known = self.forces.iter().position(|signal| signal.input == input);
            let signal = known.unwrap_or_else(|| {
                let values = Vec::new();
                self.forces.push(ForceSignal { input, values });
                self.forces.len() - 1
            });
            return Ok(Place::Force(signal));
        }
        let split = Order::ALL.into_iter().find_map(|order| {
            let driver = name.strip_suffix(order.suffix())?.strip_suffix('.')?;
            Some((driver, order as usize))
        });
        let (driver, order) = split.unwrap_or((name, 0));
        let driver = (mechanism.driver_id(driver)).ok_or_else(|| unknown(name, mechanism))?;
        let known = self.signals.iter().position(|s| s.driver == driver);
        let signal = known.unwrap_or_else(|| {
            let columns = [const { None }; 3];
            self.signals.push(Signal { driver, columns });
            self.signals.len() - 1
        });
        self.signals[signal].columns[order] = Some(Vec::new());
        Ok(Place::Driver(signal, order))
    }

    /// Turns the drivers that follow signals into inputs.
    pub(super) fn make_inputs(&self, mechanism: &mut Mechanism) {
        for signal in &self.signals {
            let start = signal.position()[0];
            mechanism.drivers[signal.driver.index()].source = DriverSource::Input { start };
        }
    }

    /// Returns whether some driver follows a signal.
    pub(super) fn has_drivers(&self) -> bool {
        !self.signals.is_empty()
    }

    /// Returns whether a driver follows a signal.
    pub(super) fn has(&self, driver: DriverId) -> bool {
        self.of(driver).is_some()
    }

    fn of(&self, driver: DriverId) -> Option<&Signal> {
        self.signals.iter().find(|signal| signal.driver == driver)
    }

    /// Returns a driver's value, with the slope from this time on as velocity.
    pub(super) fn line(&self, driver: DriverId, time: f64) -> Option<Jet> {
        Some(self.interpolate(self.of(driver)?.position(), time))
    }

    /// Returns a driver's value, velocity and acceleration. Without a column of velocities the
    /// velocity is the slope from this time on, without one of accelerations these are zero.
    pub(super) fn at(&self, driver: DriverId, time: f64) -> Option<Jet> {
        let signal = self.of(driver)?;
        let mut jet = self.interpolate(signal.position(), time);
        let [_, velocity, acceleration] = &signal.columns;
        if let Some(velocity) = velocity {
            jet.derivatives[0] = self.interpolate(velocity, time).value;
        }
        if let Some(acceleration) = acceleration {
            jet.derivatives[1] = self.interpolate(acceleration, time).value;
        }
        Some(jet)
    }

    /// Writes the inputs of forces at a time; those without a signal are left as they are.
    pub(super) fn write_forces(&self, time: f64, inputs: &mut [f64]) {
        for signal in &self.forces {
            inputs[signal.input] = self.interpolate(&signal.values, time).value;
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

impl Signal {
    fn position(&self) -> &[f64] {
        self.columns[0].as_deref().unwrap_or_default()
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

//! Drivers' values over time from a CSV file.

use std::path::Path;

use super::error::Error;
use crate::fmi::Order;
use crate::mechanism::{
    DriverId, DriverSource, Jet, Mechanism, Separated, comma_hint, help, quoted, shown,
};

/// Values of drivers over time, straight from each point to the next; before the first and after
/// the last they hold. At a time that stands twice the value jumps: there and afterwards counts
/// the later row.
#[derive(Debug, Default)]
pub(super) struct Signals {
    times: Vec<f64>,
    signals: Vec<Signal>,
}

/// What the file has of one driver.
#[derive(Debug)]
struct Signal {
    driver: DriverId,
    /// Position, velocity and acceleration; the first is always there in the end.
    columns: [Option<Vec<f64>>; 3],
}

/// Two times this near, as a part of their size or in seconds, are one.
const SAME: f64 = 1e-9;

impl Signals {
    /// Reads a file as FMPy does: the first column is `time`, the others are the drivers'
    /// variables, `crank_angle.position` or `crank_angle` for short. Columns are separated as in
    /// the tables of a mechanism file.
    pub(super) fn read(path: &Path, mechanism: &Mechanism) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(|source| Error::Read {
            path: path.to_owned(),
            source,
        })?;
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
        let mut places = Vec::new();
        for name in &header[1..] {
            places.push(signals.add(name, mechanism)?);
        }
        if places.is_empty() {
            return Err("it has no column besides `time`".to_owned());
        }
        for (line, record) in rows {
            let fields = without_empty_end(&record, header.len());
            if fields.len() != header.len() {
                let columns = if fields.len() == 1 {
                    "column"
                } else {
                    "columns"
                };
                return Err(format!(
                    "line {line} has {} {columns}; the first has names for {}",
                    fields.len(),
                    header.len()
                ));
            }
            let number = |index: usize| {
                let field = fields[index];
                let number = field.parse().ok().filter(|number: &f64| number.is_finite());
                number.ok_or_else(|| {
                    let hint = comma_hint(field);
                    format!(
                        "line {line}: {} is not a finite number{hint}",
                        quoted(field)
                    )
                })
            };
            let time = number(0)?;
            if signals.times.last().is_some_and(|last| time < *last) {
                return Err(format!("line {line}: time goes back to {}", shown(time)));
            }
            signals.times.push(time);
            for (index, (signal, order)) in places.iter().enumerate() {
                let value = number(index + 1)?;
                if let Some(column) = &mut signals.signals[*signal].columns[*order] {
                    column.push(value);
                }
            }
        }
        if signals.times.is_empty() {
            return Err("it has no rows of numbers".to_owned());
        }
        for signal in &signals.signals {
            if signal.columns[0].is_none() {
                let name = &mechanism.drivers[signal.driver.index()].name;
                return Err(format!(
                    "it has rates of `{name}` but no column `{name}.position`"
                ));
            }
        }
        Ok(signals)
    }

    /// Makes room for a column; says where it is.
    fn add(&mut self, name: &str, mechanism: &Mechanism) -> Result<(usize, usize), String> {
        let (driver_name, order) = Order::ALL
            .iter()
            .find_map(|order| {
                let own = name.strip_suffix(order.suffix())?.strip_suffix('.')?;
                Some((own, *order as usize))
            })
            .unwrap_or((name, 0));
        let driver = mechanism.driver_id(driver_name).ok_or_else(|| {
            let names = || mechanism.drivers.iter().map(|driver| driver.name.as_str());
            let of = |order: Order| names().map(move |name| format!("{name}.{}", order.suffix()));
            let variables: Vec<String> = Order::ALL.into_iter().flat_map(of).collect();
            let variables: Vec<&str> = variables.iter().map(String::as_str).collect();
            let (positions, rates) = variables.split_at(mechanism.drivers.len());
            let further: Vec<&str> = names().chain(rates.iter().copied()).collect();
            let help = help(name, positions, &further);
            let help = help.map_or_else(String::new, |help| format!("; {help}"));
            format!("column {} is no variable of a driver{help}", quoted(name))
        })?;
        let known = self
            .signals
            .iter()
            .position(|signal| signal.driver == driver);
        let signal = known.unwrap_or_else(|| {
            self.signals.push(Signal {
                driver,
                columns: [const { None }; 3],
            });
            self.signals.len() - 1
        });
        let column = &mut self.signals[signal].columns[order];
        if column.is_some() {
            return Err(format!("two columns for `{name}`"));
        }
        *column = Some(Vec::new());
        Ok((signal, order))
    }

    /// Makes inputs of the drivers that follow signals.
    pub(super) fn take_over(&self, mechanism: &mut Mechanism) {
        for signal in &self.signals {
            let start = signal.position()[0];
            mechanism.drivers[signal.driver.index()].source = DriverSource::Input { start };
        }
    }

    /// Whether a driver follows a signal.
    pub(super) fn has(&self, driver: DriverId) -> bool {
        self.signals.iter().any(|signal| signal.driver == driver)
    }

    /// A driver's value with the slope of the line from there on.
    pub(super) fn line(&self, driver: DriverId, time: f64) -> Option<Jet> {
        let signal = self.signals.iter().find(|signal| signal.driver == driver)?;
        Some(self.interpolate(signal.position(), time))
    }

    /// A driver's value, velocity and acceleration: where the file has no velocity, the slope of
    /// the line from there on; where it has no acceleration, zero.
    pub(super) fn at(&self, driver: DriverId, time: f64) -> Option<Jet> {
        let signal = self.signals.iter().find(|signal| signal.driver == driver)?;
        let mut jet = self.interpolate(signal.position(), time);
        let [_, velocity, acceleration] = &signal.columns;
        if let Some(column) = velocity {
            jet.derivatives[0] = self.interpolate(column, time).value;
        }
        if let Some(column) = acceleration {
            jet.derivatives[1] = self.interpolate(column, time).value;
        }
        Some(jet)
    }

    /// The first time after `time` at which a signal has a point.
    pub(super) fn next_point(&self, time: f64) -> f64 {
        let after = self
            .times
            .partition_point(|point| *point <= time || same(*point, time));
        self.times.get(after).copied().unwrap_or(f64::INFINITY)
    }

    fn interpolate(&self, values: &[f64], time: f64) -> Jet {
        let after = self
            .times
            .partition_point(|point| *point <= time || same(*point, time));
        let Some(before) = after.checked_sub(1) else {
            return Jet::constant(values[0]);
        };
        let Some(end) = self.times.get(after) else {
            return Jet::constant(values[before]);
        };
        let slope = (values[after] - values[before]) / (end - self.times[before]);
        let elapsed = if same(time, self.times[before]) {
            0.0
        } else {
            time - self.times[before]
        };
        Jet::new(values[before] + elapsed * slope, [slope, 0.0])
    }
}

/// The fields of a row without empty ones at its end, which separators leave there; so many are
/// kept.
fn without_empty_end(record: &csv::StringRecord, kept: usize) -> Vec<&str> {
    let mut fields: Vec<&str> = record.iter().collect();
    while fields.len() > kept && fields.last() == Some(&"") {
        fields.pop();
    }
    fields
}

impl Signal {
    fn position(&self) -> &[f64] {
        self.columns[0].as_deref().unwrap_or_default()
    }
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs()).max(1.0)
}

//! The CSV file of `--input`.

use std::path::Path;
use std::sync::Arc;

use super::{ColumnInput, Signals};
use crate::cli::told::error::Error;
use crate::cli::told::message::Message;
use biela::kinematics::Output;
use biela::mechanism::{
    DisplayUnit, Mechanism, Order, Separated, Unit, comma_hint, did_you_mean, help, large_angles,
    quoted, show_time,
};

/// Most names of columns in a notice.
const MAX_NAMED: usize = 3;

impl Signals {
    /// Reads a file with a column of times and columns of inputs: variables of drivers,
    /// `crank_angle.position` or `crank_angle` for short, and inputs of forces. Other columns are
    /// ignored with a notice, so that a run's own output can be read. Columns are separated as in the
    /// tables of a mechanism file.
    ///
    /// # Errors
    ///
    /// The file has no input, a name near that of an input without a column, or an input among those
    /// that --drive gives.
    pub(in crate::cli) fn read(
        path: &Path,
        mechanism: &Mechanism,
        driven: &[&str],
    ) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(Error::read(path))?;
        let about = |message| format!("--input: `{}`: {message}", path.display());
        let (signals, notices) = Self::parse(&text, mechanism, driven)
            .map_err(|message| Error::Usage(about(message)))?;
        for notice in notices {
            notice.map_text(about).show();
        }
        Ok(signals)
    }

    fn parse(
        text: &str,
        mechanism: &Mechanism,
        driven: &[&str],
    ) -> Result<(Self, Vec<Message>), String> {
        let separated = Separated::new(text);
        let mut rows = separated.rows().peekable();
        let Some((_, header)) = rows.next() else {
            return Err("it is empty; expected a line of column names with `time`".to_owned());
        };
        let header = separated.names(&header);
        let names = without_empty_end(&header, 0);
        let mut header = Header::read(&names, mechanism, driven)?;
        let is_units = |(line, record): &(u64, csv::StringRecord)| {
            header.is_row_of_units(&separated, record).then_some(*line)
        };
        if let Some(line) = rows.peek().and_then(is_units) {
            let (_, units) = rows.next().expect("it was looked at");
            header
                .set_units(&units)
                .map_err(|message| format!("line {line}: {message}"))?;
        }
        let mut values = vec![Vec::new(); header.columns.len()];
        let mut times: Vec<f64> = Vec::new();
        for (line, record) in rows {
            let fields = without_empty_end(&record, names.len());
            if fields.len() != names.len() {
                let found = fields.len();
                let columns = if found == 1 { "column" } else { "columns" };
                return Err(format!(
                    "line {line} has {found} {columns}; the first has names for {}",
                    names.len()
                ));
            }
            let number = |place: usize| {
                let field = fields[place];
                separated.number(field).ok_or_else(|| {
                    let (shown, hint) = (quoted(field), comma_hint(field));
                    format!("line {line}: {shown} is not a finite number{hint}")
                })
            };
            let time = number(header.time)?;
            if times.last().is_some_and(|last| time < *last) {
                return Err(format!(
                    "line {line}: time goes back to {}",
                    show_time(time)
                ));
            }
            times.push(time);
            for (values, column) in values.iter_mut().zip(&header.columns) {
                values.push(number(column.place)? / column.factor);
            }
        }
        if times.is_empty() {
            return Err("it has no rows of numbers".to_owned());
        }
        let mut notices: Vec<Message> = header.notice_of_ignored().into_iter().collect();
        for (column, values) in header.columns.iter().zip(&values) {
            notices.extend(column.warning_of_degrees(values));
        }
        let targets = header.columns.iter().map(|column| column.target);
        let mut signals = Self {
            times,
            columns: targets.zip(values).collect(),
            followers: None,
        };
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
        Ok((signals, notices))
    }
}

/// The columns of a file.
struct Header<'a> {
    /// Place of the times.
    time: usize,
    /// Columns of inputs.
    columns: Vec<Column<'a>>,
    /// Names of the columns that are no inputs.
    ignored: Vec<String>,
}

/// A column of an input.
struct Column<'a> {
    place: usize,
    name: &'a str,
    target: ColumnInput,
    /// Unit of the input.
    unit: Unit,
    /// Factor from an SI value to the values of the column.
    factor: f64,
    /// Whether the file says in which unit the values are.
    has_unit: bool,
}

impl<'a> Header<'a> {
    fn read(names: &[&'a str], mechanism: &Mechanism, driven: &[&str]) -> Result<Self, String> {
        let labels: Vec<_> = names.iter().map(|text| label(text)).collect();
        let is_time = |(name, _): &(&str, _)| is_time(name);
        let Some(time) = labels.iter().position(is_time) else {
            let found = names.first().unwrap_or(&"");
            return Err(format!(
                "it has no column `time`; the first is {}",
                quoted(found)
            ));
        };
        if let Some(second) = labels[time + 1..].iter().position(is_time) {
            let [first, second] = [time + 1, time + second + 2];
            return Err(format!(
                "two columns for `time`: column {first} and column {second}"
            ));
        }
        if let Some(unit) = labels[time].1 {
            check_time_unit(unit)?;
        }
        let mut header = Self {
            time,
            columns: Vec::new(),
            ignored: Vec::new(),
        };
        let others = || {
            labels
                .iter()
                .enumerate()
                .filter(|(place, _)| *place != time)
        };
        if others().next().is_none() {
            return Err("it has no column besides `time`".to_owned());
        }
        let outputs = Output::all(&Arc::new(mechanism.clone()));
        let targets = others().filter_map(|(_, (name, _))| ColumnInput::named(name, mechanism));
        let given: Vec<ColumnInput> = targets.collect();
        // Message on the first column that is neither an input nor an output.
        let mut foreign = None;
        for (place, &(name, unit)) in others() {
            if driven.contains(&name) {
                return Err(format!("both --drive and --input give `{name}`"));
            }
            if let Some(target) = ColumnInput::named(name, mechanism) {
                header.add(Column::new(place, name, target, mechanism), unit)?;
                continue;
            }
            if outputs.iter().all(|output| output.name != name) {
                let unknown = Unknown::new(name, mechanism, &given);
                if unknown.is_near_an_input {
                    return Err(unknown.message);
                }
                foreign.get_or_insert(unknown.message);
            }
            header.ignored.push(match name {
                "" => format!("column {}", place + 1),
                _ => quoted(name),
            });
        }
        if header.columns.is_empty() {
            let (_, (name, _)) = others().next().expect("there is one");
            return Err(foreign.unwrap_or_else(|| Unknown::new(name, mechanism, &given).message));
        }
        Ok(header)
    }

    fn add(&mut self, mut column: Column<'a>, unit: Option<&str>) -> Result<(), String> {
        let mut columns = self.columns.iter();
        if let Some(first) = columns.find(|known| known.target == column.target) {
            let [first, second] = [first.place, column.place].map(|place| place + 1);
            return Err(format!(
                "two columns for `{}`: column {first} and column {second}",
                column.name
            ));
        }
        if let Some(unit) = unit {
            column.set_unit(unit)?;
        }
        self.columns.push(column);
        Ok(())
    }

    /// Returns whether a row has units in place of numbers, as some programs write below the names.
    fn is_row_of_units(&self, separated: &Separated<'_>, row: &csv::StringRecord) -> bool {
        let time = row.get(self.time).unwrap_or_default();
        let places = self.columns.iter().map(|column| column.place);
        let mut fields = places.map(|place| row.get(place).unwrap_or_default());
        !time.contains(|c: char| c.is_ascii_digit())
            && fields.all(|text| separated.number(text).is_none())
    }

    /// Takes the units of the columns from a row.
    fn set_units(&mut self, row: &csv::StringRecord) -> Result<(), String> {
        let unit = |place| bare(row.get(place).unwrap_or_default());
        check_time_unit(unit(self.time))?;
        for column in &mut self.columns {
            column.set_unit(unit(column.place))?;
        }
        Ok(())
    }

    fn notice_of_ignored(&self) -> Option<Message> {
        let (named, more) = self.ignored.split_at(MAX_NAMED.min(self.ignored.len()));
        let more = match more.len() {
            0 => String::new(),
            count => format!(" and {count} more"),
        };
        let names = named.join(", ");
        let text = match self.ignored.len() {
            0 => return None,
            1 => format!("{names} is no input and is ignored"),
            _ => format!("columns that are no inputs are ignored: {names}{more}"),
        };
        Some(Message::Note(text))
    }
}

impl<'a> Column<'a> {
    fn new(place: usize, name: &'a str, target: ColumnInput, mechanism: &Mechanism) -> Self {
        let unit = match target {
            ColumnInput::Driver(id, order) => Output::of_driver(mechanism, id)[order as usize].unit,
            ColumnInput::Force(input) => mechanism.load_inputs()[input].unit.unwrap_or(Unit::ONE),
        };
        Self {
            place,
            name,
            target,
            unit,
            factor: 1.0,
            has_unit: false,
        }
    }

    /// Sets the unit of the values by its symbol; nothing changes without one.
    fn set_unit(&mut self, symbol: &str) -> Result<(), String> {
        if matches!(symbol, "" | "-") {
            return Ok(());
        }
        let others = || self.unit.display_units();
        let factor = if self.unit.name == symbol {
            Some(1.0)
        } else {
            let unit = DisplayUnit::read(symbol).ok();
            unit.filter(|unit| unit.dimension == self.unit.dimension)
                .map(|unit| unit.factor)
        };
        self.factor = factor.ok_or_else(|| {
            let others: String = others()
                .map(|unit| format!(" or `{}`", unit.name))
                .collect();
            let (name, symbol) = (self.name, quoted(symbol));
            format!(
                "column `{name}` is in {symbol}; expected `{}`{others}",
                self.unit.name
            )
        })?;
        self.has_unit = true;
        Ok(())
    }

    /// Warns of angles that look like degrees.
    fn warning_of_degrees(&self, values: &[f64]) -> Option<Message> {
        let is_angle = matches!(self.target, ColumnInput::Driver(_, Order::Position))
            && self.unit.name == Unit::RADIAN.name;
        if self.has_unit || !is_angle {
            return None;
        }
        let message = large_angles(values)?;
        let name = self.name;
        Some(Message::Warning(format!(
            "column `{name}`: {message}; a column of degrees is called `{name} [deg]`"
        )))
    }
}

/// Returns a column's name, and its unit if that follows in brackets: `time [s]`.
fn label(text: &str) -> (&str, Option<&str>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, unit)) = text
            .strip_suffix(close)
            .and_then(|text| text.rsplit_once(open))
        {
            return (name.trim_end(), Some(unit.trim()));
        }
    }
    (text, None)
}

/// Returns a unit without brackets.
fn bare(text: &str) -> &str {
    match label(text) {
        ("", Some(unit)) => unit,
        _ => text,
    }
}

/// Returns whether a column of this name has the times.
fn is_time(name: &str) -> bool {
    ["time", "t"]
        .iter()
        .any(|time| name.eq_ignore_ascii_case(time))
}

fn check_time_unit(unit: &str) -> Result<(), String> {
    if matches!(unit, "" | "-") || Unit::SECOND.name == unit {
        return Ok(());
    }
    Err(format!(
        "the times are in {}; expected `{}`",
        quoted(unit),
        Unit::SECOND.name
    ))
}

/// A column that is no input.
struct Unknown {
    /// Says so, and which input may be meant.
    message: String,
    /// Whether the name is near that of an input without a column.
    is_near_an_input: bool,
}

impl Unknown {
    /// Describes a column of a file whose columns give the inputs `given`.
    fn new(name: &str, mechanism: &Mechanism, given: &[ColumnInput]) -> Self {
        let forces = mechanism.given_forces();
        if let Some(given) = forces.iter().find(|given| given.name == name) {
            let force = &mechanism.forces[given.force].name;
            let message = format!(
                "column `{name}` is no input: the file or --drive gives `{force}` its size"
            );
            return Self {
                message,
                is_near_an_input: false,
            };
        }
        let drivers = || mechanism.drivers.iter().map(|driver| driver.name.as_str());
        let inputs = mechanism.load_inputs();
        let variables = |order: Order| drivers().map(move |d| format!("{d}.{}", order.suffix()));
        let is_left = |name: &&str| {
            let target = ColumnInput::named(name, mechanism);
            target.is_none_or(|target| !given.contains(&target))
        };
        let positions: Vec<String> = variables(Order::Position).collect();
        let main = positions
            .iter()
            .chain(inputs.iter().map(|input| &input.name));
        let main: Vec<&str> = main.map(String::as_str).filter(is_left).collect();
        let rates = [Order::Velocity, Order::Acceleration];
        let rates: Vec<String> = rates.into_iter().flat_map(variables).collect();
        let further = drivers().chain(rates.iter().map(String::as_str));
        let further: Vec<&str> = further.filter(is_left).collect();
        let near = did_you_mean(name, &[&main[..], &further].concat());
        let is_near_an_input = near.is_some();
        let help = near.or_else(|| help(name, &main, &further));
        let help = help.map_or_else(String::new, |help| format!("; {help}"));
        let forces = if inputs.is_empty() {
            ""
        } else {
            " and no input of a force"
        };
        let message = format!(
            "column {} is no variable of a driver{forces}{help}",
            quoted(name)
        );
        Self {
            message,
            is_near_an_input,
        }
    }
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

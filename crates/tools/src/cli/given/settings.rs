//! Parameters and starts of freedoms as the command line sets them.

use std::path::Path;

use clap::Args;

use super::assigning::{Assigning, refuse, warn_of_degrees};
use super::input::{Input, has_errors, show_diagnostics};
use crate::cli::told::error::Error;
use crate::cli::told::message::Message;
use crate::page::change_values;
use biela::fmi;
use biela::mechanism::{
    Dimension, Driver, DriverId, DriverSource, Jet, Mechanism, Order, Parameter, Source, Unit,
    is_plain, large_length, quoted, shown,
};

/// The option for other values than the file's.
#[derive(Args, Debug)]
pub(in crate::cli) struct Settings {
    /// Change a parameter, such as 'crank_length=120*mm', or the start of a freedom, such as
    /// 'swing.velocity=3'; may be given for several. The file stays.
    #[arg(short, long, value_name = "PARAMETER=VALUE")]
    set: Vec<String>,
}

impl Settings {
    /// Returns whether nothing is set.
    pub(in crate::cli) fn is_empty(&self) -> bool {
        self.set.is_empty()
    }

    /// Reads a file, as if it had the values that are set. Shows its errors and warnings on stderr.
    pub(in crate::cli) fn read(&self, path: &Path) -> Result<Input, Error> {
        if self.is_empty() {
            return Input::read(path);
        }
        let Input { source, mechanism } = Input::read_and(path, |source, diagnostics| {
            // Warnings are those of the file with the values that are set.
            if has_errors(diagnostics) {
                show_diagnostics(source, diagnostics);
            }
        })?;
        Input::parse(self.changed(source, &mechanism)?, show_diagnostics)
    }

    /// Returns the source of a mechanism with the values that are set.
    pub(in crate::cli) fn changed(
        &self,
        source: Source,
        mechanism: &Mechanism,
    ) -> Result<Source, Error> {
        if self.is_empty() {
            return Ok(source);
        }
        let values = self.parameters(mechanism)?;
        let settings = self.settings(mechanism)?;
        let set = settings.iter().filter_map(|(index, _)| {
            let parameter = mechanism.parameters.get(*index)?;
            Some((&*parameter.name, values[*index]))
        });
        let starts = self.starts(mechanism)?;
        let starts = starts.iter().map(|(freedom, order, value)| {
            let key = match order {
                Order::Position => "start",
                Order::Velocity | Order::Acceleration => "velocity",
            };
            (&*mechanism.drivers[freedom.index()].name, key, *value)
        });
        let text = change_values(source.text(), set, starts);
        Ok(source.with_text(text.expect("the text of a mechanism is that of a mechanism file")))
    }

    /// Returns the value of an expression over the parameters in force, given by `option`. Warns of
    /// an angle that looks like degrees.
    pub(super) fn value(
        &self,
        mechanism: &Mechanism,
        option: &str,
        text: &str,
        is_angle: bool,
    ) -> Result<f64, Error> {
        let parameters = self.parameters(mechanism)?;
        let expression = mechanism.parse_expression(text, None);
        let expression = expression.map_err(|error| refuse(option, text, &error))?;
        let value = expression.value(&parameters);
        if !value.is_finite() {
            let text = quoted(text);
            return Err(Error::Usage(format!("{option}: {text} is not finite")));
        }
        if is_angle {
            warn_of_degrees(option, text, Jet::constant(value));
        }
        Ok(value)
    }

    /// Splits each assignment of --set into the place among parameters and starts of freedoms, and the
    /// expression.
    fn settings(&self, mechanism: &Mechanism) -> Result<Vec<(usize, &str)>, Error> {
        let starts = mechanism.starts_of_freedoms();
        let names = mechanism.parameters.iter().map(|p| p.name.as_str());
        let names = names.chain(starts.iter().map(|(name, ..)| name.as_str()));
        let is_driven = |driver: &&Driver| !matches!(driver.source, DriverSource::Free { .. });
        let drivers = mechanism.drivers.iter().filter(is_driven);
        let drivers = drivers.map(|driver| driver.name.as_str());
        SET.assignments(
            &self.set,
            &names.collect::<Vec<_>>(),
            &drivers.collect::<Vec<_>>(),
        )
    }

    /// Returns the starts of freedoms that are set \[SI\].
    pub(super) fn starts(
        &self,
        mechanism: &Mechanism,
    ) -> Result<Vec<(DriverId, Order, f64)>, Error> {
        let starts = mechanism.starts_of_freedoms();
        let settings = self.settings(mechanism)?;
        let set = settings.into_iter().filter_map(|(index, text)| {
            let (_, freedom, order) = starts.get(index.checked_sub(mechanism.parameters.len())?)?;
            Some((*freedom, *order, text))
        });
        let value = |(freedom, order, text): (DriverId, Order, &str)| {
            let kind = mechanism.drivers[freedom.index()].coordinate.kind;
            let is_angle = kind.is_angle() && order == Order::Position;
            Ok((
                freedom,
                order,
                self.value(mechanism, SET.option, text, is_angle)?,
            ))
        };
        set.map(value).collect()
    }

    /// Returns the parameters in force \[SI\].
    pub(super) fn parameters(&self, mechanism: &Mechanism) -> Result<Vec<f64>, Error> {
        let defaults = mechanism.default_parameters();
        let mut values = defaults.clone();
        for (index, text) in self.settings(mechanism)? {
            let Some(parameter) = mechanism.parameters.get(index) else {
                continue;
            };
            parameter
                .check_settable()
                .map_err(|error| Error::Usage(format!("--set: {error}")))?;
            values[index] = mechanism
                .parse_expression(text, None)
                .map_err(|error| SET.refuse(text, &error))?
                .value(&defaults);
            match parameter.unit {
                Some(unit) if unit.dimension == Dimension::ANGLE => {
                    warn_of_degrees(SET.option, text, Jet::constant(values[index]));
                }
                Some(unit) if unit.dimension == Dimension::LENGTH => {
                    warn_of_length(text, [values[index], defaults[index]], unit);
                }
                _ => {}
            }
            check_limits(parameter, values[index])
                .map_err(|message| Error::Usage(format!("--set: {message}")))?;
        }
        mechanism.derive_parameters(&mut values);
        Ok(values)
    }
}

const SET: Assigning = Assigning {
    option: "--set",
    kind: "parameter",
    example: "crank_length=120*mm",
    other: ["driver", "--drive"],
};
/// Warns of a length of --set made of plain numbers that looks like millimetres beside the file's.
fn warn_of_length(text: &str, [value, usual]: [f64; 2], unit: Unit) {
    let suspect = large_length(value, usual, unit.display);
    if let Some((message, name)) = suspect.filter(|_| is_plain(text)) {
        let number = shown(value);
        let warning = format!("{}: {message}; write `{number}*{name}`", SET.option);
        Message::Warning(warning).show();
    }
}

/// Refuses a value that the FMU refuses, in its words.
pub(in crate::cli) fn check_limits(parameter: &Parameter, value: f64) -> Result<(), String> {
    let limits = [parameter.min, parameter.max];
    fmi::check_limits(&parameter.name, value, limits).map_err(|error| {
        let unit = match error {
            fmi::Error::Range { .. } => parameter.unit,
            _ => None,
        };
        format!("{error}{}", unit.map_or_else(String::new, Unit::suffix))
    })
}

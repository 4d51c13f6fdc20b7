//! Parameters and motions of drivers as the command line sets them.

use std::path::Path;
use std::sync::Arc;

use clap::Args;

use super::input::{Input, warn_of_misfits};
use super::signals::Signals;
use crate::cli::told::error::Error;
use crate::cli::told::message::Message;
use biela::fmi;
use biela::kinematics::{self, Solver};
use biela::mechanism::{
    Dimension, Driver, DriverId, DriverSource, ExpressionError, Jet, Mechanism, Order, Parameter,
    ParameterId, PrescribedMotion, Unit, Variable, help, is_plain, large_angle, large_length,
    large_velocity, not_finite, quoted, shown,
};

/// Options of all commands that move a mechanism away from its file's values.
#[derive(Args, Debug)]
pub(in crate::cli) struct Conditions {
    /// Move a driver by an expression in t and the parameters, such as
    /// 'crank_angle=60*deg + 10*t', or set the input of a force, such as 'cylinder.effort=500*t';
    /// may be given several times.
    #[arg(short, long, value_name = "DRIVER=MOTION")]
    drive: Vec<String>,
    /// Change a parameter for this run, such as 'crank_length=120*mm', or the start of a freedom, such
    /// as 'swing.velocity=3'; may be given for several.
    #[arg(short, long, value_name = "PARAMETER=VALUE")]
    set: Vec<String>,
}

/// A mechanism under the conditions of a command line.
pub(in crate::cli) struct Scenario {
    /// The mechanism with the motions of --drive; drivers that follow signals are inputs.
    pub(in crate::cli) mechanism: Arc<Mechanism>,
    /// Parameters in force \[SI\].
    pub(in crate::cli) parameters: Vec<f64>,
    pub(in crate::cli) signals: Signals,
    /// Start time \[s\].
    pub(in crate::cli) start: f64,
}

impl Conditions {
    /// Returns whether no option is given.
    pub(in crate::cli) fn is_empty(&self) -> bool {
        self.drive.is_empty() && self.set.is_empty()
    }

    /// Applies the options to a mechanism whose run starts at `start`; the CSV file `signals`
    /// moves further drivers and sets further inputs of forces.
    pub(in crate::cli) fn scenario(
        &self,
        mechanism: &Mechanism,
        start: f64,
        signals: Option<&Path>,
    ) -> Result<Scenario, Error> {
        let parameters = self.parameters(mechanism)?;
        let mut driven = mechanism.clone();
        let mut driven_by_option = Vec::new();
        let mut forces_by_option = Vec::new();
        let drivers = mechanism.drivers.len();
        let force_inputs = mechanism.load_inputs();
        let names = mechanism.drivers.iter().map(|driver| driver.name.as_str());
        let names = names.chain(force_inputs.iter().map(|input| input.name.as_str()));
        let others: Vec<&str> = mechanism
            .parameters
            .iter()
            .map(|p| p.name.as_str())
            .collect();
        let assignments = DRIVE.assignments(&self.drive, &names.collect::<Vec<_>>(), &others)?;
        for (index, text) in assignments {
            if let Some(input) = index.checked_sub(drivers).map(|k| &force_inputs[k]) {
                let size = mechanism.parse_expression(text, Some(Variable::Time));
                let size = size.map_err(|error| DRIVE.refuse(text, &error))?;
                if !driven.give_load(input.target, size) {
                    let name = &input.name;
                    return Err(Error::Usage(format!(
                        "--drive: the motion that follows `{name}` is nested too deeply with it"
                    )));
                }
                forces_by_option.push(input.name.as_str());
                continue;
            }
            let motion = motion(mechanism, text, &parameters, start)?;
            if mechanism.drivers[index].coordinate.kind.is_angle()
                && let PrescribedMotion::Expression(expression) = &motion
            {
                let at_start = expression.evaluate(
                    &|p: ParameterId| Jet::constant(parameters[p.index()]),
                    Jet::variable(start),
                );
                warn_of_degrees(DRIVE.option, text, at_start);
            }
            driven.drivers[index].source = DriverSource::Motion(motion);
            driven.drivers[index].follows = None;
            driven_by_option.push(DriverId(index));
        }
        for (freedom, order, value) in self.starts(mechanism)? {
            driven.set_start(freedom, order, value);
        }
        let signals = match signals {
            Some(path) => Signals::read(path, &driven, &forces_by_option)?,
            None => Signals::default(),
        };
        for (place, input) in driven.load_inputs().into_iter().enumerate() {
            if let (true, Some(driver)) = (signals.has_load(place), driven.follower(input.target)) {
                return Err(Error::Usage(format!(
                    "driver `{}` follows the input `{}`, for which --input is not possible: give it \
                     by --drive",
                    driver.name, input.name
                )));
            }
        }
        if let Some(driver) = driven_by_option.iter().find(|d| signals.has(**d)) {
            let name = &mechanism.drivers[driver.index()].name;
            return Err(Error::Usage(format!(
                "both --drive and --input say how `{name}` moves; \
                 leave out the columns of `{name}`"
            )));
        }
        signals.make_inputs(&mut driven);
        Ok(Scenario {
            mechanism: Arc::new(driven),
            parameters,
            signals,
            start,
        })
    }

    /// Returns a solver of the driven mechanism at the start of the simulation.
    pub(in crate::cli) fn solver_at_start(&self, input: &Input) -> Result<Solver, Error> {
        let start = input.mechanism.simulation.start;
        let scenario = self.scenario(&input.mechanism, start, None)?;
        let solver = scenario.solver(input.assemble()?);
        solver.map_err(|error| input.error(error))
    }

    /// Returns the value of an expression over the parameters in force, given by `option`. Warns of
    /// an angle that looks like degrees.
    pub(in crate::cli) fn value(
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
    fn starts(&self, mechanism: &Mechanism) -> Result<Vec<(DriverId, Order, f64)>, Error> {
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
    fn parameters(&self, mechanism: &Mechanism) -> Result<Vec<f64>, Error> {
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

/// Warns of an angle of more than a turn, or of a velocity of whole right angles, that is made of
/// plain numbers: it looks like degrees.
pub(in crate::cli) fn warn_of_degrees(option: &str, text: &str, angle: Jet) {
    let of_angle = large_angle(angle.value).map(|message| (message, angle.value));
    let of_velocity = || Some((large_velocity(angle.first())?, angle.first()));
    let suspect = of_angle.or_else(of_velocity);
    if let Some((message, number)) = suspect.filter(|_| is_plain(text)) {
        let number = shown(number);
        let warning = format!("{option}: {message}; degrees are written `{number}*deg`");
        Message::Warning(warning).show();
    }
}

/// Warns of a length of --set made of plain numbers that looks like millimetres beside the file's.
fn warn_of_length(text: &str, [value, usual]: [f64; 2], unit: Unit) {
    let suspect = large_length(value, usual, unit.display);
    if let Some((message, name)) = suspect.filter(|_| is_plain(text)) {
        let number = shown(value);
        let warning = format!("{}: {message}; write `{number}*{name}`", SET.option);
        Message::Warning(warning).show();
    }
}

/// Reads a motion of --drive, whose value and rates must be finite at the start.
fn motion(
    mechanism: &Mechanism,
    text: &str,
    parameters: &[f64],
    start: f64,
) -> Result<PrescribedMotion, Error> {
    let motion = mechanism
        .parse_expression(text, Some(Variable::Time))
        .map_err(|error| DRIVE.refuse(text, &error))?;
    let at_start = motion.evaluate(
        &|p: ParameterId| Jet::constant(parameters[p.index()]),
        Jet::variable(start),
    );
    if let Some(what) = not_finite(at_start) {
        let (time, whole) = (shown(start), quoted(text));
        let error = ExpressionError {
            message: format!("at t = {time}, {what} of {whole} is not finite"),
            span: 0..text.len(),
            help: None,
        };
        return Err(DRIVE.refuse(text, &error));
    }
    Ok(PrescribedMotion::Expression(motion))
}

impl Scenario {
    /// Returns a solver of the driven mechanism at the start, in the assembly mode of
    /// `home_solver`, which has the file's own pose and moves from there.
    ///
    /// # Errors
    ///
    /// Those of [`Solver::start`].
    pub(in crate::cli) fn solver(
        &self,
        mut home_solver: Solver,
    ) -> Result<Solver, kinematics::Error> {
        let home = home_solver.pose().clone();
        let value = |driver| Some(self.signals.at(driver, self.start)?.value);
        let path = home_solver.path_to_start(&self.mechanism, &self.parameters, self.start, value);
        home_solver.start(&home, &path)?;
        let mut solver = Solver::new(Arc::clone(&self.mechanism))?;
        solver.restore(home_solver.pose());
        warn_of_misfits(&solver);
        Ok(solver)
    }
}

/// An option that assigns expressions to names.
struct Assigning {
    option: &'static str,
    kind: &'static str,
    example: &'static str,
    /// Kind of the names that another option assigns to, and that option.
    other: [&'static str; 2],
}

const SET: Assigning = Assigning {
    option: "--set",
    kind: "parameter",
    example: "crank_length=120*mm",
    other: ["driver", "--drive"],
};
const DRIVE: Assigning = Assigning {
    option: "--drive",
    kind: "driver",
    example: "crank_angle=60*deg + 10*t",
    other: ["parameter", "--set"],
};

impl Assigning {
    /// Splits each `NAME=EXPRESSION` into the name's index in `names` and the expression; another
    /// option assigns to the names `others`.
    fn assignments<'a>(
        &self,
        given: &'a [String],
        names: &[&str],
        others: &[&str],
    ) -> Result<Vec<(usize, &'a str)>, Error> {
        let (option, example) = (self.option, self.example);
        let mut assignments: Vec<(usize, &str)> = Vec::new();
        for assignment in given {
            let Some((name, text)) = assignment.split_once('=') else {
                return Err(Error::Usage(format!(
                    "{option}: `{assignment}` has no `=`; expected for example '{example}'"
                )));
            };
            let name = name.trim();
            let index = names.iter().position(|known| *known == name);
            let index = index.ok_or_else(|| self.unknown(name, names, others))?;
            if assignments.iter().any(|(known, _)| *known == index) {
                return Err(Error::Usage(format!("{option}: `{name}` is given twice")));
            }
            assignments.push((index, text.trim()));
        }
        Ok(assignments)
    }

    /// Returns the error of an unknown name, which may belong to another option.
    fn unknown(&self, name: &str, names: &[&str], others: &[&str]) -> Error {
        let (option, kind, [other, right]) = (self.option, self.kind, self.other);
        let owner = name.split('.').next().unwrap_or(name);
        if others.contains(&owner) {
            let message =
                format!("{option}: no {kind} `{name}`; `{owner}` is a {other}: use {right}");
            return Error::Usage(message);
        }
        unknown(option, kind, name, names)
    }

    fn refuse(&self, text: &str, error: &ExpressionError) -> Error {
        refuse(self.option, text, error)
    }
}

/// Returns the error of an expression, with a mark under its place.
fn refuse(option: &str, text: &str, error: &ExpressionError) -> Error {
    let column = text[..error.span.start].chars().count();
    let help = (error.help.as_ref()).map_or_else(String::new, |help| format!("; {help}"));
    let mut message = format!("{option}: {}{help}", error.message);
    if !text.is_empty() {
        message += &format!("\n  {text}\n  {:column$}^", "");
    }
    Error::Usage(message)
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

/// Returns the error of an unknown name, with the known name that may be meant.
pub(in crate::cli) fn unknown(option: &str, kind: &str, name: &str, names: &[&str]) -> Error {
    Error::Usage(format!("{option}: {}", unknown_name(kind, name, names)))
}

/// Says that a name is unknown, with the known name that may be meant.
pub(in crate::cli) fn unknown_name(kind: &str, name: &str, names: &[&str]) -> String {
    let help = match names {
        [] => Some("the mechanism has none".to_owned()),
        _ => help(name, names, &[]),
    };
    let help = help.map_or_else(String::new, |help| format!("; {help}"));
    format!("no {kind} `{name}`{help}")
}

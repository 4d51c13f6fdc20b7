//! Parameters and drivers as the command line sets them.

use std::sync::Arc;

use clap::Args;

use super::error::Error;
use super::input::{Input, warn_of_misfits};
use super::message::Message;
use super::signals::Signals;
use crate::fmi;
use crate::kinematics::{self, Curve, Path, Solver, Start};
use crate::mechanism::{
    DriverId, DriverSource, ExpressionError, Jet, Mechanism, Motion, Parameter, ParameterId, Unit,
    Variable, help, not_finite, quoted, shown,
};

/// Options of all commands that move a mechanism away from its file's values.
#[derive(Args, Debug)]
pub(super) struct Conditions {
    /// Move a driver by an expression in t and the parameters, such as
    /// 'crank_angle=60*deg + 10*t'; may be given for several drivers.
    #[arg(short, long, value_name = "DRIVER=MOTION")]
    drive: Vec<String>,
    /// Change a parameter for this run, such as 'crank_length=120*mm'; may be given for several.
    #[arg(short, long, value_name = "PARAMETER=VALUE")]
    set: Vec<String>,
}

impl Conditions {
    /// The parameters in force.
    pub(super) fn parameters(&self, mechanism: &Mechanism) -> Result<Vec<f64>, Error> {
        let mut values = mechanism.default_parameters();
        let mut given = vec![false; values.len()];
        for assignment in &self.set {
            let (name, text) = split(assignment, "--set", "crank_length=120*mm")?;
            let id = mechanism.parameter_id(name).ok_or_else(|| {
                let names = mechanism.parameters.iter().map(|p| p.name.as_str());
                unknown("--set", "parameter", name, names)
            })?;
            once("--set", name, &mut given[id.index()])?;
            let parameter = &mechanism.parameters[id.index()];
            if parameter.derived {
                return Err(Error::Usage(format!(
                    "--set: `{name}` is derived from other parameters; set those"
                )));
            }
            let value = mechanism
                .parse_expression(text, None)
                .map_err(|error| in_argument("--set", text, &error))?
                .evaluate(&|p| mechanism.parameters[p.index()].default, 0.0);
            check_limits(parameter, value)?;
            values[id.index()] = value;
        }
        mechanism.derive_parameters(&mut values);
        Ok(values)
    }

    /// The mechanism with the motions of --drive prescribed, whose values and rates are finite at
    /// the time `start` with these parameters.
    pub(super) fn driven(
        &self,
        mechanism: &Mechanism,
        parameters: &[f64],
        start: f64,
    ) -> Result<Mechanism, Error> {
        let mut driven = mechanism.clone();
        let mut given = vec![false; driven.drivers.len()];
        for assignment in &self.drive {
            let (name, text) = split(assignment, "--drive", "crank_angle=60*deg + 10*t")?;
            let id = mechanism.driver_id(name).ok_or_else(|| {
                let names = mechanism.drivers.iter().map(|d| d.name.as_str());
                unknown("--drive", "driver", name, names)
            })?;
            once("--drive", name, &mut given[id.index()])?;
            let motion = mechanism
                .parse_expression(text, Some(Variable::Time))
                .map_err(|error| in_argument("--drive", text, &error))?;
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
                return Err(in_argument("--drive", text, &error));
            }
            driven.drivers[id.index()].source = DriverSource::Motion(Motion::Expression(motion));
        }
        Ok(driven)
    }

    /// A solver of the driven mechanism at the start of the simulation.
    pub(super) fn solver_at_start(&self, input: &Input) -> Result<Solver, Error> {
        self.reach_start(input)?.map_err(|error| input.error(error))
    }

    /// The same, or else what is in the way from the file's own pose to the start, for those who
    /// have named the file already.
    ///
    /// # Errors
    ///
    /// What is wrong with the options, or with the file's own pose.
    pub(super) fn reach_start(
        &self,
        input: &Input,
    ) -> Result<Result<Solver, kinematics::Error>, Error> {
        let parameters = self.parameters(&input.mechanism)?;
        let time = input.mechanism.simulation.start;
        let driven = Arc::new(self.driven(&input.mechanism, &parameters, time)?);
        let home_solver = input.assemble()?;
        Ok(start(home_solver, &driven, &parameters, time, |_| None))
    }

    /// No driver follows both --drive and the signals of --input.
    pub(super) fn refuse_twice(
        &self,
        signals: &Signals,
        mechanism: &Mechanism,
    ) -> Result<(), Error> {
        for assignment in &self.drive {
            let (name, _) = split(assignment, "--drive", "crank_angle=60*deg + 10*t")?;
            if mechanism
                .driver_id(name)
                .is_some_and(|driver| signals.has(driver))
            {
                return Err(Error::Usage(format!(
                    "both --drive and --input say how `{name}` moves"
                )));
            }
        }
        Ok(())
    }
}

/// A solver of the driven mechanism at the start, in the file's assembly mode: moved there from
/// the file's pose, where `home_solver` stands. `given` has the values of drivers that are set
/// from elsewhere.
pub(super) fn start(
    mut home_solver: Solver,
    driven: &Arc<Mechanism>,
    parameters: &[f64],
    time: f64,
    given: impl Fn(DriverId) -> Option<f64>,
) -> Result<Solver, kinematics::Error> {
    let home = home_solver.pose().clone();
    let mut path = Path::new(home_solver.mechanism());
    path.duration = time - home.time;
    path.to.copy_from_slice(parameters);
    let drivers = home_solver.mechanism().drivers.iter().zip(&driven.drivers);
    for (index, (curve, (own, driver))) in path.curves.iter_mut().zip(drivers).enumerate() {
        let kept = match (own.motion(), driver.motion()) {
            (Some(Motion::Expression(own)), Some(Motion::Expression(given))) => own == given,
            (Some(Motion::Table(_)), Some(Motion::Table(_))) | (None, None) => true,
            _ => false,
        };
        let position = match (given(DriverId(index)), driver.motion()) {
            (Some(position), _) => Some(position),
            (None, Some(Motion::Expression(motion))) if !kept => {
                Some(motion.evaluate(&|p: ParameterId| parameters[p.index()], time))
            }
            _ => None,
        };
        if let Some(position) = position {
            *curve = Curve::Input {
                position,
                velocity: 0.0,
                acceleration: 0.0,
                jump: home.drivers[index] - position,
            };
        }
    }
    if let Start::Reassembled(_) = home_solver.start(&home, &path)? {
        let warning = "no continuous motion leads from the file's own pose to these values: \
                       assembled there from the estimates, possibly in another assembly mode";
        Message::Warning(warning.to_owned()).show();
    }
    let mut solver = Solver::new(Arc::clone(driven))?;
    solver.restore(home_solver.pose());
    warn_of_misfits(&solver);
    Ok(solver)
}

fn split<'a>(
    assignment: &'a str,
    option: &str,
    example: &str,
) -> Result<(&'a str, &'a str), Error> {
    assignment
        .split_once('=')
        .map(|(name, text)| (name.trim(), text.trim()))
        .ok_or_else(|| {
            Error::Usage(format!(
                "{option}: `{assignment}` has no `=`; expected for example '{example}'"
            ))
        })
}

/// Refuses a second value for what has one.
fn once(option: &str, name: &str, given: &mut bool) -> Result<(), Error> {
    if std::mem::replace(given, true) {
        return Err(Error::Usage(format!("{option}: `{name}` is given twice")));
    }
    Ok(())
}

/// Refuses what the FMU refuses, in its words.
fn check_limits(parameter: &Parameter, value: f64) -> Result<(), Error> {
    let limits = [parameter.min, parameter.max];
    fmi::error::check_limits(&parameter.name, value, limits).map_err(|error| {
        let unit = parameter.unit.filter(|unit| *unit != Unit::ONE);
        let unit = match (&error, unit) {
            (fmi::Error::Range { .. }, Some(unit)) => format!(" {}", unit.name),
            _ => String::new(),
        };
        Error::Usage(format!("--set: {error}{unit}"))
    })
}

/// What to say of a name that stands for nothing.
pub(super) fn unknown<'a>(
    option: &str,
    what: &str,
    name: &str,
    names: impl Iterator<Item = &'a str>,
) -> Error {
    let names: Vec<_> = names.collect();
    let help = match names[..] {
        [] => Some("the mechanism has none".to_owned()),
        _ => help(name, &names, &[]),
    };
    let help = help.map_or_else(String::new, |help| format!("; {help}"));
    Error::Usage(format!("{option}: no {what} `{name}`{help}"))
}

fn in_argument(option: &str, text: &str, error: &ExpressionError) -> Error {
    let column = text[..error.span.start].chars().count();
    let help = error
        .help
        .as_ref()
        .map_or_else(String::new, |help| format!("; {help}"));
    let mut message = format!("{option}: {}{help}", error.message);
    if !text.is_empty() {
        message += &format!("\n  {text}\n  {:column$}^", "");
    }
    Error::Usage(message)
}

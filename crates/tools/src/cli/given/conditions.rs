//! Motions of drivers, and other values than the file's, as the command line sets them.

use std::path::Path;
use std::sync::Arc;

use clap::Args;

use super::assigning::{Assigning, warn_of_degrees};
use super::input::{Input, warn_of_misfits};
use super::settings::Settings;
use super::signals::Signals;
use crate::cli::told::error::Error;
use biela::kinematics::{self, Solver};
use biela::mechanism::{
    DriverId, DriverSource, ExpressionError, Jet, Mechanism, ParameterId, PrescribedMotion,
    Variable, not_finite, quoted, shown,
};

/// Options of all commands that move a mechanism away from its file's values.
#[derive(Args, Debug)]
pub(in crate::cli) struct Conditions {
    /// Move a driver by an expression in t and the parameters, such as
    /// 'crank_angle=60*deg + 10*t', or set the input of a force, such as 'cylinder.effort=500*t';
    /// may be given several times.
    #[arg(short, long, value_name = "DRIVER=MOTION")]
    drive: Vec<String>,
    #[command(flatten)]
    settings: Settings,
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
        self.drive.is_empty() && self.settings.is_empty()
    }

    /// Applies the options to a mechanism whose run starts at `start`; the CSV file `signals`
    /// moves further drivers and sets further inputs of forces.
    pub(in crate::cli) fn scenario(
        &self,
        mechanism: &Mechanism,
        start: f64,
        signals: Option<&Path>,
    ) -> Result<Scenario, Error> {
        let parameters = self.settings.parameters(mechanism)?;
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
        for (freedom, order, value) in self.settings.starts(mechanism)? {
            driven.set_start(freedom, order, value);
        }
        let mut signals = match signals {
            Some(path) => Signals::read(path, &driven, &forces_by_option)?,
            None => Signals::default(),
        };
        if let Some(driver) = driven_by_option.iter().find(|d| signals.has(**d)) {
            let name = &mechanism.drivers[driver.index()].name;
            return Err(Error::Usage(format!(
                "both --drive and --input say how `{name}` moves; \
                 leave out the columns of `{name}`"
            )));
        }
        signals.make_inputs(&mut driven);
        let mechanism = signals.with_followers(driven, &parameters, start);
        Ok(Scenario {
            mechanism,
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
        let solver = solver.map_err(|error| input.error(error))?;
        warn_of_misfits(&solver);
        Ok(solver)
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
        self.settings.value(mechanism, option, text, is_angle)
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
        Ok(solver)
    }
}

const DRIVE: Assigning = Assigning {
    option: "--drive",
    kind: "driver",
    example: "crank_angle=60*deg + 10*t",
    other: ["parameter", "--set"],
};

//! `biela linearize`

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use crate::cli::at_rest::AtRest;
use crate::cli::given::conditions::Conditions;
use crate::cli::results::column::{self, Output};
use crate::cli::results::output::write;
use crate::cli::results::stdout::STDOUT;
use crate::cli::told::error::Error;
use crate::cli::told::message::Message;

/// Linearize the motion of a mechanism with freedoms at its start, or at its equilibrium.
///
/// Writes the names of states, inputs and outputs and the matrices A, B, C and D of
/// dx/dt = A x + B u, y = C x + D u in SI units, exact to rounding, as JSON. States are value and
/// velocity of each freedom. Closed contacts and friction that sticks hold their coordinates in these
/// equations; they are told, and listed under `held` with their forces.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela linearize pendulum_free.toml --balance -v rod")]
pub(in crate::cli) struct Linearize {
    /// The mechanism file.
    file: PathBuf,
    #[command(flatten)]
    conditions: Conditions,
    /// Go to the stable equilibrium first, as `biela balance` does.
    #[arg(short, long)]
    balance: bool,
    /// Outputs, separated by commas: one such as crank.phi, or all variables of a body, marker,
    /// driver, measure, joint or force by its name [default: all].
    #[arg(short, long, value_name = "NAMES", value_delimiter = ',')]
    variables: Vec<String>,
    /// The file to write [default: stdout].
    #[arg(
        short,
        long,
        value_name = "JSON",
        default_value = STDOUT,
        hide_default_value = true
    )]
    output: PathBuf,
}

impl Linearize {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        let mut at = AtRest::read(&self.file, &self.conditions)?;
        if self.balance {
            at.balance()?;
        }
        let mechanism = at.motion.mechanism().clone();
        let mut outputs = Output::all(&mechanism);
        if !self.variables.is_empty() {
            outputs = column::named(&outputs, &self.variables, &mechanism)?;
        }
        let space = at.linearize(&outputs)?;
        for held in &space.held {
            let what = held.describe(&mechanism);
            Message::Note(format!(
                "{what}: what is held does not move in these equations"
            ))
            .show();
        }
        let held = space.held.iter();
        let held = held.map(|held| (held.name(&mechanism).to_owned(), json!(held.size)));
        let drivers = mechanism.drivers.iter().zip(&at.motion.pose().drivers);
        let values = drivers.map(|(driver, value)| (driver.name.clone(), json!(value)));
        let [a, b, c, d] = space.matrices();
        let text = json!({
            "values": Value::Object(values.collect()),
            "states": space.states,
            "inputs": space.inputs,
            "outputs": space.outputs,
            "held": Value::Object(held.collect()),
            "A": a,
            "B": b,
            "C": c,
            "D": d,
        });
        write(&self.output, format!("{text:#}\n").as_bytes())
    }
}

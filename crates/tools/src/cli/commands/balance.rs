//! `biela balance`

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::check::{estimates, with_unit};
use crate::cli::at_rest::AtRest;
use crate::cli::given::conditions::Conditions;
use crate::cli::results::output::print;
use crate::cli::told::error::Error;
use biela::dynamics::Equilibrium;
use biela::mechanism::Mechanism;

/// Find the stable equilibrium to which a mechanism with freedoms comes down from its start.
///
/// Drivers and inputs of forces stay at their start values, unless --drive sets them. The mechanism
/// moves downhill, without a swing, and may come to rest on stops, ropes and cams, which are told with
/// their forces. Friction that holds the start keeps it there; what gives way is left out, and told.
/// The pose is written as estimates, to paste into the file. With --all it does so from other places
/// as well: no proof that there are no others.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela balance four_bar_free.toml")]
pub(in crate::cli) struct Balance {
    /// The mechanism file.
    file: PathBuf,
    /// Find the equilibria downhill from places all over the range of the freedoms, too.
    #[arg(long)]
    all: bool,
    #[command(flatten)]
    conditions: Conditions,
}

impl Balance {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        let mut at = AtRest::read(&self.file, &self.conditions)?;
        let mechanism = at.motion.mechanism().clone();
        if !self.all {
            let equilibrium = at.balance()?;
            return print(&describe(&mechanism, &equilibrium));
        }
        let all = at.balances()?;
        let count = all.len();
        for (number, equilibrium) in (1..).zip(&all) {
            let text = describe(&mechanism, equilibrium);
            print(&format!("{number} of {count}: {text}\n"))?;
        }
        Ok(())
    }
}

/// Tells the values of all drivers in an equilibrium, what holds there, and the pose as estimates.
fn describe(mechanism: &Mechanism, equilibrium: &Equilibrium) -> String {
    let mut out = "balanced at\n".to_owned();
    for (driver, value) in mechanism.drivers.iter().zip(&equilibrium.drivers) {
        let value = with_unit(driver.coordinate.kind, *value);
        let _ = writeln!(out, "  {} = {value}", driver.name);
    }
    for held in &equilibrium.held {
        let _ = writeln!(out, "  {}", held.describe(mechanism));
    }
    for force in &equilibrium.left_out {
        let name = &mechanism.forces[*force].name;
        let _ = writeln!(out, "  friction `{name}` is left out");
    }
    out + &estimates(mechanism, &equilibrium.q)
}

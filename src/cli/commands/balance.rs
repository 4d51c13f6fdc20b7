//! `biela balance`

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::check::{estimates, with_unit};
use crate::cli::conditions::Conditions;
use crate::cli::error::Error;
use crate::cli::free::AtRest;
use crate::cli::output::print;
use crate::kinematics::Solver;

/// Find the stable equilibrium to which a mechanism with freedoms comes down from its start.
///
/// Drivers and inputs of forces stay at their start values, unless --drive sets them. The mechanism
/// moves downhill, without a swing. The pose is written as estimates, to paste into the file. With
/// --all it does so from other places as well: no proof that there are no others.
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
        if !self.all {
            at.balance()?;
            return print(&describe(&at.solver));
        }
        let balances = at.balances()?;
        let count = balances.len();
        for (number, pose) in (1..).zip(&balances) {
            at.solver.restore(pose);
            print(&format!("{number} of {count}: {}\n", describe(&at.solver)))?;
        }
        Ok(())
    }
}

/// Tells the values of all drivers at a pose, and the pose as estimates.
fn describe(solver: &Solver) -> String {
    let mut out = "balanced at\n".to_owned();
    let drivers = &solver.mechanism().drivers;
    for (driver, value) in drivers.iter().zip(&solver.pose().drivers) {
        let value = with_unit(driver.coordinate.kind, *value);
        let _ = writeln!(out, "  {} = {value}", driver.name);
    }
    out + &estimates(solver)
}

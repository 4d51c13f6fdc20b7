//! `biela balance`

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::check::{estimates, with_unit};
use crate::cli::conditions::Conditions;
use crate::cli::error::Error;
use crate::cli::free::AtRest;
use crate::cli::output::print;

/// Find the stable equilibrium to which a mechanism with freedoms comes down from its start.
///
/// Drivers and inputs of forces stay at their start values, unless --drive sets them. The mechanism
/// moves downhill, without a swing. The pose is written as estimates, to paste into the file.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela balance four_bar_free.toml")]
pub(in crate::cli) struct Balance {
    /// The mechanism file.
    file: PathBuf,
    #[command(flatten)]
    conditions: Conditions,
}

impl Balance {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        let mut at = AtRest::read(&self.file, &self.conditions)?;
        at.balance()?;
        let mechanism = at.solver.mechanism();
        let mut out = "balanced at\n".to_owned();
        for (driver, value) in mechanism.drivers.iter().zip(&at.solver.pose().drivers) {
            let value = with_unit(driver.coordinate.kind, *value);
            let _ = writeln!(out, "  {} = {value}", driver.name);
        }
        print(&(out + &estimates(&at.solver)))
    }
}

//! Values of a driver between which it is followed.

use clap::Args;

use super::assigning::unknown;
use super::conditions::Conditions;
use crate::cli::told::error::Error;
use biela::mechanism::{DriverId, Mechanism, shown};

/// Options of the commands that follow a driver.
#[derive(Args, Debug)]
pub(in crate::cli) struct Bounds {
    /// The value of the driver from which it is followed, such as '30*deg' or 0.4 [m or rad].
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true)]
    from: Option<String>,
    /// The value of the driver up to which it is followed.
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true)]
    to: Option<String>,
}

impl Bounds {
    /// Returns whether no option is given.
    pub(in crate::cli) fn is_empty(&self) -> bool {
        self.from.is_none() && self.to.is_none()
    }

    /// Returns the values of a driver [m or rad], none where the options are left out. Warns of
    /// angles that look like degrees.
    pub(in crate::cli) fn of(
        &self,
        conditions: &Conditions,
        mechanism: &Mechanism,
        driver: DriverId,
    ) -> Result<[Option<f64>; 2], Error> {
        let is_angle = mechanism.drivers[driver.index()].coordinate.kind.is_angle();
        let value = |option, text: &Option<String>| {
            let text = text.as_deref();
            text.map(|text| conditions.value(mechanism, option, text, is_angle))
                .transpose()
        };
        let bounds = [value("--from", &self.from)?, value("--to", &self.to)?];
        check_order(bounds, ["--from", "--to"])?;
        Ok(bounds)
    }
}

/// Checks that the first of two values, which have these names, is less than the second.
pub(in crate::cli) fn check_order(bounds: [Option<f64>; 2], names: [&str; 2]) -> Result<(), Error> {
    let ([Some(from), Some(to)], [first, second]) = (bounds, names) else {
        return Ok(());
    };
    if from < to {
        return Ok(());
    }
    let [from, to] = [from, to].map(shown);
    let message = format!("{first}, {from}, must be less than {second}, {to}");
    Err(Error::Usage(message))
}

/// Returns the error for an option or a command that needs a driver, in a mechanism without any.
pub(in crate::cli) fn no_driver(what: &str) -> Error {
    Error::Usage(format!("{what}: the mechanism has no driver"))
}

/// Returns the driver of this name.
pub(in crate::cli) fn driver_named(mechanism: &Mechanism, name: &str) -> Result<DriverId, Error> {
    mechanism.driver_id(name).ok_or_else(|| {
        let names = mechanism.drivers.iter().map(|d| d.name.as_str());
        unknown("--driver", "driver", name, &names.collect::<Vec<_>>())
    })
}

//! The outputs that are shown, and the units of their values.

use biela::kinematics::{ForceQuantity, Output, OutputSource};
use biela::mechanism::{DisplayUnit, Unit};

/// Returns whether an output's value is shown from the start: what a film tells, and what drivers
/// have to give.
pub(super) fn is_told(output: &Output) -> bool {
    let is_given = matches!(
        output.source,
        OutputSource::Force(ForceQuantity::Effort(_) | ForceQuantity::Power(_))
    );
    is_given || output.is_told()
}

/// Returns the name of the unit in which values of a unit are shown, and its factor from SI.
pub(super) fn shown_in(unit: Unit, length: Option<DisplayUnit>) -> (String, f64) {
    let own = unit.display;
    let display = own.or_else(|| length.filter(|l| l.dimension == unit.dimension));
    match display {
        Some(display) => (display.name.to_string(), display.factor),
        None if unit == Unit::ONE => (String::new(), 1.0),
        None => (unit.name.to_string(), 1.0),
    }
}

//! Values of outputs at a pose, and the units in which they are shown.

use crate::kinematics::{ForceQuantity, Forces, Output, OutputSource, Rates, Solver};
use crate::mechanism::{DisplayUnit, Jet, Order, Unit};

/// All that values are read from.
pub(super) struct Moment<'a> {
    pub(super) solver: &'a Solver,
    pub(super) rates: &'a Rates,
    pub(super) driver_rates: &'a [Jet],
    pub(super) forces: Option<&'a Forces>,
    /// Whether rates exist at the pose.
    pub(super) has_rates: bool,
}

impl Moment<'_> {
    /// Returns the value of an output \[SI\], not a number where there is none.
    pub(super) fn value(&self, output: &Output) -> f64 {
        let needs_rates = match output.source {
            OutputSource::Signal(_, order) => order != Order::Position,
            OutputSource::Derived(index) => {
                let derived = &self.solver.mechanism().derived[index];
                derived.order() != Order::Position
            }
            OutputSource::Force(force) => {
                return self.forces.map_or(f64::NAN, |forces| forces.value(force));
            }
        };
        if needs_rates && !self.has_rates {
            return f64::NAN;
        }
        output.value(self.solver, self.rates, self.driver_rates)
    }
}

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
pub(super) fn shown_in(unit: Unit, length: Option<DisplayUnit>) -> (&'static str, f64) {
    let own = unit.display;
    let display = own.or_else(|| length.filter(|l| l.dimension == unit.dimension));
    match display {
        Some(display) => (display.name, display.factor),
        None if unit == Unit::ONE => ("", 1.0),
        None => (unit.name, 1.0),
    }
}

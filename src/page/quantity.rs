//! The variables of a mechanism: names, units, values.

use crate::kinematics::{ForceQuantity, Forces, Rates, Reported, Solver};
use crate::mechanism::{
    COMPONENTS, CoordinateKind, DisplayUnit, DriverId, Jet, Load, Mechanism, Order, SUFFIXES,
    Signal, Unit,
};

/// A variable under the name of the FMU's variable.
#[derive(Clone, Debug)]
pub(super) struct Quantity {
    pub(super) name: String,
    pub(super) unit: Unit,
    /// Whether its value is shown from the start.
    pub(super) is_told: bool,
    source: Source,
}

/// Meaning of a variable.
#[derive(Clone, Copy, Debug)]
enum Source {
    Signal(Signal, Order),
    /// A measure computed from others, by its index.
    Derived(usize),
    Force(ForceQuantity),
}

/// All that values are read from.
pub(super) struct Moment<'a> {
    pub(super) solver: &'a Solver,
    pub(super) rates: &'a Rates,
    pub(super) driver_rates: &'a [Jet],
    pub(super) forces: Option<&'a Forces>,
    /// Whether rates exist at the pose.
    pub(super) has_rates: bool,
}

impl Quantity {
    /// Returns the variables of a mechanism: drivers, measures, points of interest, bodies, forces.
    pub(super) fn all(mechanism: &Mechanism) -> Vec<Self> {
        let mut all = Vec::new();
        let mut add = |owner: &str, signal, names: [&str; 3], units: [Unit; 3], is_told: bool| {
            for ((order, suffix), unit) in Order::ALL.into_iter().zip(names).zip(units) {
                all.push(Self {
                    name: format!("{owner}.{suffix}"),
                    unit,
                    is_told: is_told && order == Order::Position,
                    source: Source::Signal(signal, order),
                });
            }
        };
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            let signal = Signal::Motion(DriverId(index));
            let units = driver.coordinate.kind.units();
            add(&driver.name, signal, SUFFIXES, units, true);
        }
        for (index, measure) in mechanism.measures.iter().enumerate() {
            let units = measure.coordinate.kind.units();
            add(&measure.name, Signal::Measure(index), SUFFIXES, units, true);
        }
        for &marker in &mechanism.outputs.markers {
            let path = mechanism.marker_path(marker);
            for (component, names) in COMPONENTS[..2].iter().enumerate() {
                let signal = Signal::Marker(marker, component);
                add(&path, signal, *names, CoordinateKind::LENGTHS, true);
            }
        }
        for &body in &mechanism.outputs.bodies {
            let name = &mechanism.bodies[body.index()].name;
            for (component, names) in COMPONENTS.into_iter().enumerate() {
                let units = match component {
                    2 => CoordinateKind::ANGLES,
                    _ => CoordinateKind::LENGTHS,
                };
                add(name, Signal::Body(body, component), names, units, false);
            }
        }
        for (index, derived) in mechanism.derived.iter().enumerate() {
            all.push(Self {
                name: derived.name.clone(),
                unit: derived.unit.unwrap_or(Unit::ONE),
                is_told: true,
                source: Source::Derived(index),
            });
        }
        if mechanism.has_dynamics() {
            all.extend(forces(mechanism));
        }
        all
    }

    /// Returns the value \[SI\], not a number where there is none.
    pub(super) fn value(&self, moment: &Moment) -> f64 {
        let Moment {
            solver,
            rates,
            driver_rates,
            forces,
            has_rates,
        } = *moment;
        match self.source {
            Source::Signal(_, order) if order != Order::Position && !has_rates => f64::NAN,
            Source::Signal(signal, order) => order.of(solver.signal(signal, rates, driver_rates)),
            Source::Derived(index) => {
                let derived = &solver.mechanism().derived[index];
                if derived.order() != Order::Position && !has_rates {
                    return f64::NAN;
                }
                solver.derived(index, rates, driver_rates)
            }
            Source::Force(force) => forces.map_or(f64::NAN, |forces| forces.value(force)),
        }
    }

    /// Returns the unit in which the value is shown; lengths are shown in `length`.
    pub(super) fn shown_in(&self, length: Option<DisplayUnit>) -> (&'static str, f64) {
        shown_in(self.unit, length)
    }
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

/// Returns the variables of forces.
fn forces(mechanism: &Mechanism) -> Vec<Quantity> {
    let mut all = Vec::new();
    let mut add = |name: String, quantity, unit, is_told| {
        all.push(Quantity {
            name,
            unit,
            is_told,
            source: Source::Force(quantity),
        });
    };
    for (index, driver) in mechanism.drivers.iter().enumerate() {
        let (id, kind, name) = (DriverId(index), driver.coordinate.kind, &driver.name);
        let effort = kind.effort_unit();
        add(
            format!("{name}.effort"),
            ForceQuantity::Effort(id),
            effort,
            true,
        );
        add(
            format!("{name}.power"),
            ForceQuantity::Power(id),
            Unit::WATT,
            true,
        );
    }
    for &index in &mechanism.outputs.joints {
        let joint = &mechanism.joints[index];
        let reported = Reported::of(&joint.kind);
        for (component, suffix) in Load::COMPONENTS.into_iter().enumerate() {
            if reported.has(component) {
                let unit = [Unit::NEWTON, Unit::NEWTON, Unit::NEWTON_METRE][component];
                let quantity = ForceQuantity::Reaction(index, component);
                add(format!("{}.{suffix}", joint.name), quantity, unit, false);
            }
        }
    }
    for &index in &mechanism.outputs.constraints {
        let held = &mechanism.constraints[index];
        let unit = held.coordinate.kind.effort_unit();
        add(
            format!("{}.effort", held.name),
            ForceQuantity::Held(index),
            unit,
            false,
        );
    }
    for (index, force) in mechanism.forces.iter().enumerate() {
        if !force.load.is_input() {
            for (component, (suffix, unit)) in force.load.variables().into_iter().enumerate() {
                let quantity = ForceQuantity::Applied(index, component);
                add(format!("{}.{suffix}", force.name), quantity, unit, false);
            }
        }
    }
    for (name, quantity) in [
        ("energy.kinetic", ForceQuantity::KineticEnergy),
        ("energy.potential", ForceQuantity::PotentialEnergy),
    ] {
        add(name.to_owned(), quantity, Unit::JOULE, false);
    }
    all
}

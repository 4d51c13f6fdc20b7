//! The forces of a mechanism at rest.

use std::fmt::Write as _;
use std::sync::Arc;

use crate::fmi::{Kind, Quantity, variables};
use crate::kinematics::{Error, ForceParts, ForceQuantity, KnownMotion, Rates, Solver};
use crate::mechanism::{Expression, Indeterminate, Jet, Mechanism, shown};

/// Magnitude below which a force of a few newtons is rounding.
const ROUNDING: f64 = 1e-12;

/// The forces of a mechanism at rest, all inputs of forces being zero.
pub(super) struct Forces {
    /// Name, mass \[kg\] and inertia \[kg m²\] of each body with mass.
    masses: Vec<(String, f64, f64)>,
    /// Name, value and unit of each output, those that are zero or trivial at rest left out.
    pub(super) values: Vec<(String, f64, &'static str)>,
    /// Joints and constraints with indeterminate reactions.
    pub(super) indeterminate: Vec<String>,
}

impl Forces {
    /// Solves the forces at the solver's pose.
    ///
    /// # Errors
    ///
    /// Those of [`Solver::solve_forces`].
    pub(super) fn at_rest(solver: &mut Solver) -> Result<Self, Error> {
        let mechanism = Arc::clone(solver.mechanism());
        let still = Rates::new(solver.pose().q.len());
        let rates = vec![Jet::constant(0.0); mechanism.drivers.len()];
        let mut forces = solver.forces();
        let inputs = vec![0.0; forces.inputs()];
        let motion = KnownMotion {
            rates: &still,
            driver_rates: &rates,
            inputs: &inputs,
        };
        solver.solve_forces(motion, ForceParts::ALL, &mut forces)?;
        let parameters = &solver.pose().parameters;
        let value = |expression: &Expression| expression.value(parameters);
        let masses = mechanism.bodies.iter().filter_map(|body| {
            let inertia = body.inertia.as_ref().map_or(0.0, value);
            Some((body.name.clone(), value(body.mass.as_ref()?), inertia))
        });
        let masses = masses.collect();
        let values = variables(&mechanism).into_iter().filter_map(|variable| {
            let (Quantity::Force(force), Kind::Real { unit, .. }) =
                (variable.quantity, variable.kind)
            else {
                return None;
            };
            let trivial = matches!(
                force,
                ForceQuantity::Power(_) | ForceQuantity::Bias(_) | ForceQuantity::KineticEnergy
            );
            let value = forces.value(force);
            let rounding = match force {
                ForceQuantity::Effort(driver) => solver.effort_rounding(&still, driver, &forces),
                _ => 0.0,
            };
            let is_rounding = value.abs() < ROUNDING || value.abs() <= rounding;
            let value = if is_rounding { 0.0 } else { value };
            (!trivial).then_some((variable.name, value, unit?.name))
        });
        let values = values.collect();
        let indeterminate = solver.indeterminate();
        let names = indeterminate
            .iter()
            .map(|element| element.describe(&mechanism));
        Ok(Self {
            masses,
            values,
            indeterminate: names.collect(),
        })
    }

    /// Returns the text of the report.
    pub(super) fn describe(&self, mechanism: &Mechanism) -> String {
        let mut out = String::from("\nforces at rest\n");
        for (body, mass, inertia) in &self.masses {
            let (mass, inertia) = (shown(*mass), shown(*inertia));
            let _ = writeln!(out, "  {body}: mass {mass} kg, inertia {inertia} kg.m2");
        }
        for (name, value, unit) in &self.values {
            let _ = writeln!(out, "  {name} = {} {unit}", shown(*value));
        }
        if !self.indeterminate.is_empty() {
            let treatment = match mechanism.outputs.indeterminate {
                Indeterminate::Omit => "they are no outputs",
                Indeterminate::MinimumNorm => "outputs are those with the least sum of squares",
            };
            let _ = writeln!(
                out,
                "  redundant constraints leave the reactions of {} indeterminate: {treatment}",
                self.indeterminate.join(", ")
            );
        }
        out
    }
}

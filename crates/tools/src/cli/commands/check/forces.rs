//! The forces of a mechanism at rest.

use std::fmt::Write as _;
use std::sync::Arc;

use biela::kinematics::{Error, ForceQuantity, Output, OutputSource, Solution, Solver};
use biela::mechanism::{BodyId, DriverId, Indeterminate, Jet, Mechanism, Unit, UnitName, shown};

/// Magnitude below which a force of a few newtons is rounding.
const NO_FORCE: f64 = 1e-12;

/// The forces of a mechanism at rest, all inputs of forces being zero.
pub(in crate::cli) struct Forces {
    /// Name, mass \[kg\] and inertia \[kg m²\] of each body with mass.
    pub(in crate::cli) masses: Vec<(String, f64, f64)>,
    /// Name, value and unit of each output, those that are zero or trivial at rest left out.
    pub(in crate::cli) values: Vec<(String, f64, UnitName)>,
    /// Joints and constraints with indeterminate reactions.
    pub(super) indeterminate: Vec<String>,
    /// Efforts of drivers against friction.
    pub(super) slow: Vec<SlowMotion>,
}

/// Effort of a driver that moves slowly, against friction and the load.
pub(super) struct SlowMotion {
    /// Name of the driver.
    pub(super) driver: String,
    /// Efforts as the coordinate grows and as it falls \[N or N m\]; `None` where the mechanism jams.
    pub(super) efforts: [Option<f64>; 2],
    unit: Unit,
}

impl SlowMotion {
    /// Solves the effort of each driver at the solver's pose, with all others at rest.
    fn of_drivers(solver: &mut Solver, solution: &mut Solution) -> Vec<Self> {
        /// Speed \[rad/s\], or in sizes of the mechanism per second, whose square is rounding.
        const SLOW: f64 = 1e-9;
        let mechanism = Arc::clone(solver.mechanism());
        if mechanism.has_freedoms() || mechanism.frictions().next().is_none() {
            return Vec::new();
        }
        let rates = solution.driver_rates.clone();
        let drivers = mechanism.drivers.iter().enumerate();
        let all = drivers.map(|(index, driver)| {
            let kind = driver.coordinate.kind;
            let speed = SLOW * if kind.is_angle() { 1.0 } else { solver.size() };
            let efforts = [speed, -speed].map(|speed| {
                solution.driver_rates.fill(Jet::constant(0.0));
                solution.driver_rates[index].derivatives[0] = speed;
                solution.solve(solver).ok()?;
                Some(solution.force(ForceQuantity::Effort(DriverId(index))))
            });
            Self {
                driver: driver.name.clone(),
                efforts,
                unit: kind.effort_unit(),
            }
        });
        let all = all.collect();
        solution.driver_rates = rates;
        all
    }

    /// Returns whether the driver stays where it is without an effort, as the load does not overcome
    /// friction.
    pub(super) fn is_self_locking(&self) -> bool {
        let [grows, falls] = self.efforts;
        grows.is_none_or(|effort| effort >= 0.0) && falls.is_none_or(|effort| effort <= 0.0)
    }
}

impl Forces {
    /// Solves the forces at the solver's pose.
    ///
    /// # Errors
    ///
    /// Those of [`Solution::solve`].
    pub(in crate::cli) fn at_rest(solver: &mut Solver) -> Result<Self, Error> {
        let mechanism = Arc::clone(solver.mechanism());
        let mut solution = Solution::new(solver);
        solution.seek_forces(solver);
        solution.solve(solver)?;
        let parameters = &solver.pose().parameters;
        let bodies = mechanism.bodies.iter().zip((0..).map(BodyId));
        let masses = bodies.filter_map(|(body, id)| {
            let weight = mechanism.weight_at(id, parameters)?;
            Some((body.name.clone(), weight.mass, weight.inertia))
        });
        let masses = masses.collect();
        let values = Output::all(&mechanism).into_iter().filter_map(|output| {
            let OutputSource::Force(force) = output.source else {
                return None;
            };
            let trivial = match force {
                ForceQuantity::Power(_) | ForceQuantity::Bias(_) | ForceQuantity::KineticEnergy => {
                    true
                }
                ForceQuantity::Applied(force, _) => mechanism.forces[force].load.is_input(),
                _ => false,
            };
            let value = solution.force(force);
            let rounding = match force {
                ForceQuantity::Effort(driver) => solution.effort_rounding(solver, driver),
                _ => 0.0,
            };
            let is_rounding = value.abs() < NO_FORCE || value.abs() <= rounding;
            let value = if is_rounding { 0.0 } else { value };
            (!trivial).then_some((output.name, value, output.unit.name))
        });
        let values = values.collect();
        let slow = SlowMotion::of_drivers(solver, &mut solution);
        let indeterminate = solver.indeterminate();
        let names = indeterminate
            .iter()
            .map(|element| element.describe(&mechanism));
        Ok(Self {
            masses,
            values,
            indeterminate: names.collect(),
            slow,
        })
    }

    /// Returns the text of the report.
    pub(super) fn describe(&self, mechanism: &Mechanism) -> String {
        let held = if mechanism.has_freedoms() {
            ", with the freedoms held"
        } else {
            ""
        };
        let mut out = format!("\nforces at rest{held}\n");
        for (body, mass, inertia) in &self.masses {
            let (mass, inertia) = (shown(*mass), shown(*inertia));
            let _ = writeln!(out, "  {body}: mass {mass} kg, inertia {inertia} kg.m2");
        }
        for (name, value, unit) in &self.values {
            let _ = writeln!(out, "  {name} = {} {unit}", shown(*value));
        }
        for slow in &self.slow {
            let [grows, falls] = slow.efforts.map(|effort| {
                let effort =
                    effort.map(|effort| format!("{}{}", shown(effort), slow.unit.suffix()));
                effort.unwrap_or_else(|| "jams".to_owned())
            });
            let locks = if slow.is_self_locking() {
                ": self-locking"
            } else {
                ""
            };
            let _ = writeln!(
                out,
                "  {}.effort in slow motion: {grows} as it grows, {falls} as it falls{locks}",
                slow.driver
            );
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

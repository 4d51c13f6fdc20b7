//! Rates and forces at the pose of a solver.

use std::sync::Arc;

use super::output::Output;
use crate::kinematics::analysis::Direction;
use crate::kinematics::constraint::Constraint;
use crate::kinematics::error::Error;
use crate::kinematics::forces::{
    ForceParts, ForceQuantity, ForceSensitivity, Forces, Friction, KnownMotion,
};
use crate::kinematics::path::Rates;
use crate::kinematics::solver::Solver;
use crate::mechanism::{DerivedMeasure, DriverId, Dual, Jet, Load, ParameterId, PassiveCause};

/// The rates at the pose of a [`Solver`] and, where they are [sought](Self::seek_forces), the
/// forces.
///
/// ```
/// use biela::kinematics::{ForceQuantity, Path, Solution, Solver};
/// use biela::mechanism::{DriverId, Mechanism, Source};
///
/// // An arm of 2 kg that lies level, its centre of mass 0.3 m from the pivot.
/// let text = r#"
/// format = 1
/// name = "arm"
/// [bodies.arm]
/// mass = 2
/// center = [0.3, 0]
/// markers = { O = [0, 0] }
/// [ground.markers]
/// O = [0, 0]
/// [joints.pivot]
/// type = "revolute"
/// markers = ["ground.O", "arm.O"]
/// [drivers.theta]
/// coordinate = "angle"
/// markers = ["ground.O", "arm.O"]
/// start = 0
/// "#;
/// let (mechanism, _) = Mechanism::parse(&Source::new("arm.toml", text)).unwrap();
/// let path = Path::new(&mechanism);
/// let mut solver = Solver::assembled(mechanism.into(), &path).unwrap();
/// let mut solution = Solution::new(&solver);
/// solution.seek_forces(&solver);
/// solution.solve(&mut solver).unwrap();
/// let torque = solution.force(ForceQuantity::Effort(DriverId(0)));
/// assert!((torque - 2.0 * 9.81 * 0.3).abs() < 1e-14);
/// ```
#[derive(Debug)]
pub struct Solution {
    /// Rates of q.
    pub rates: Rates,
    /// Value, velocity and acceleration of each driver, for which rates and forces are solved.
    pub driver_rates: Vec<Jet>,
    /// Inputs, and sizes of the forces without a law \[SI\]: [inputs and passive forces](Forces::loads).
    pub loads: Vec<f64>,
    forces: Option<Forces>,
    /// The parts of the forces that are sought.
    parts: ForceParts,
    /// Friction of a mechanism without freedoms, whose motion would tell the loads.
    friction: Friction,
    /// Place of each, in its order.
    rubbed: Vec<Rubbed>,
}

/// Place of friction in a mechanism without freedoms.
#[derive(Debug)]
struct Rubbed {
    /// Index of its load.
    load: usize,
    relation: Arc<dyn Constraint>,
    /// Index of the joint, for friction in one.
    joint: Option<usize>,
}

impl Solution {
    /// Makes the storage for a solver's mechanism; all drivers are at rest.
    #[must_use]
    pub fn new(solver: &Solver) -> Self {
        let (pose, mechanism) = (solver.pose(), solver.mechanism());
        let mut loads = vec![0.0; mechanism.load_places().1];
        mechanism.write_load_starts(&mut loads);
        Self {
            rates: Rates::new(pose.q.len()),
            driver_rates: pose.drivers.iter().map(|u| Jet::constant(*u)).collect(),
            loads,
            forces: None,
            parts: ForceParts::ALL,
            friction: Friction::default(),
            rubbed: Vec::new(),
        }
    }

    /// Seeks forces too, from the next [`solve`](Self::solve) on.
    pub fn seek_forces(&mut self, solver: &Solver) {
        self.forces = Some(solver.forces());
        if !solver.mechanism().has_freedoms() {
            self.friction = solver.friction();
            self.rubbed = rubbed(solver);
        }
        let outputs = &solver.mechanism().outputs;
        let mut measures = solver.mechanism().derived.iter();
        if outputs.joints.is_empty()
            && outputs.constraints.is_empty()
            && !measures.any(DerivedMeasure::needs_reactions)
        {
            self.leave_out_reactions();
        }
    }

    /// Exchanges the forces with those of a solver of the same mechanism in other coordinates.
    pub fn exchange_forces(&mut self, forces: &mut Option<Forces>) {
        std::mem::swap(&mut self.forces, forces);
    }

    /// Leaves out reactions, unless contacts may pull: efforts exist where reactions have no limit.
    pub fn leave_out_reactions(&mut self) {
        self.parts.reactions = self.forces().is_some_and(|forces| forces.contacts() > 0);
    }

    /// Returns the forces, if they are sought.
    #[must_use]
    pub fn forces(&self) -> Option<&Forces> {
        self.forces.as_ref()
    }

    /// Takes over the rates of the drivers with prescribed motions at the time of the pose.
    pub fn follow_motions(&mut self, solver: &Solver) {
        let drivers = solver.mechanism().drivers.iter().enumerate();
        for (rates, (index, driver)) in self.driver_rates.iter_mut().zip(drivers) {
            if driver.motion().is_some() {
                *rates = solver.motion(DriverId(index), solver.pose().time);
            }
        }
    }

    /// Solves the rates at the pose for the rates of the drivers, then the forces.
    ///
    /// # Errors
    ///
    /// Those of [`Solver::solve_rates`] and [`Solver::solve_forces`].
    pub fn solve(&mut self, solver: &mut Solver) -> Result<(), Error> {
        self.solve_rates(solver)?;
        self.solve_forces(solver, self.parts)
    }

    /// Solves the rates at the pose for the rates of the drivers.
    ///
    /// # Errors
    ///
    /// Those of [`Solver::solve_rates`].
    pub fn solve_rates(&mut self, solver: &mut Solver) -> Result<(), Error> {
        let driver_rates = &self.driver_rates;
        solver.solve_rates(|driver| driver_rates[driver.index()], &mut self.rates)
    }

    /// Solves these parts of the forces, if they are sought, for the rates at the pose.
    ///
    /// # Errors
    ///
    /// Those of [`Solver::solve_forces`].
    pub fn solve_forces(&mut self, solver: &mut Solver, parts: ForceParts) -> Result<(), Error> {
        let Self {
            rates,
            driver_rates,
            loads,
            forces: Some(forces),
            friction,
            rubbed,
            ..
        } = self
        else {
            return Ok(());
        };
        friction.set_parameters(&solver.pose().parameters);
        for (place, Rubbed { relation, .. }) in rubbed.iter().enumerate() {
            let rate = solver.coordinate(&**relation, rates).first();
            let [_, rounding, _] = solver.coordinate_roundings(&**relation, rates);
            let rests = rate.abs() <= rounding;
            friction.set_motion(place, rate, if rests { 0.0 } else { rate.signum() });
        }
        let mut solve = |loads: &[f64], forces: &mut Forces, parts| {
            let motion = KnownMotion {
                rates,
                driver_rates,
                inputs: loads,
            };
            solver.solve_forces(motion, parts, forces)
        };
        if friction.is_empty() {
            return solve(loads, forces, parts);
        }
        let parts = ForceParts {
            reactions: parts.reactions || rubbed.iter().any(|rubbed| rubbed.joint.is_some()),
            ..parts
        };
        friction.solve(|sizes, reactions| {
            for (Rubbed { load, .. }, size) in rubbed.iter().zip(sizes) {
                loads[*load] = *size;
            }
            solve(loads, forces, parts)?;
            for (Rubbed { joint, .. }, reaction) in rubbed.iter().zip(reactions) {
                if let Some(joint) = joint {
                    *reaction = forces.reaction(*joint);
                }
            }
            Ok(())
        })
    }

    /// Returns a force, not a number unless forces are sought.
    #[must_use]
    pub fn force(&self, quantity: ForceQuantity) -> f64 {
        let forces = self.forces();
        forces.map_or(f64::NAN, |forces| forces.value(quantity))
    }

    /// Returns the value of an output \[SI\], not a number for a force that is not sought.
    #[must_use]
    pub fn value(&self, solver: &Solver, output: &Output) -> f64 {
        let Self {
            rates,
            driver_rates,
            loads,
            ..
        } = self;
        output.value(solver, rates, driver_rates, self.forces(), loads)
    }

    /// Returns the changes of outputs along a direction \[SI\], not a number for forces that are
    /// not sought.
    ///
    /// # Errors
    ///
    /// Those of [`Solver::sensitivity`], [`Solver::force_sensitivity`] and [`OutputSource::change`](super::OutputSource::change).
    pub fn changes(
        &mut self,
        solver: &mut Solver,
        outputs: &[Output],
        direction: &Direction,
    ) -> Result<Vec<f64>, Error> {
        let of_forces = self.force_changes(solver, direction)?;
        let mechanism = solver.mechanism().clone();
        let change = solver.sensitivity(&self.rates, &self.driver_rates, direction)?;
        let forces = self.forces().zip(of_forces.as_ref());
        let outputs = outputs.iter();
        let changes = outputs.map(|output| output.source.change(&mechanism, &change, forces));
        changes.collect()
    }

    /// Returns the changes of forces along a direction, in which those of friction are not read without
    /// freedoms; `None` unless forces are sought.
    ///
    /// # Errors
    ///
    /// Those of [`Solver::force_sensitivity`].
    pub fn force_changes(
        &mut self,
        solver: &mut Solver,
        direction: &Direction,
    ) -> Result<Option<ForceSensitivity>, Error> {
        if !self.friction.is_empty() {
            // Friction is that of the pose.
            self.solve_forces(solver, ForceParts::ALL)?;
        }
        let Self {
            rates,
            driver_rates,
            loads: inputs,
            forces: Some(forces),
            friction,
            rubbed,
            ..
        } = self
        else {
            return Ok(None);
        };
        let mut direction = direction.clone();
        let motion = KnownMotion {
            rates,
            driver_rates,
            inputs,
        };
        if !friction.is_empty() {
            let mut change = |solver: &mut Solver, direction: &mut Direction, stays: Option<&_>| {
                let along = solver.sensitivity(rates, driver_rates, direction)?;
                let value = |id: ParameterId| along.parameter_value(id);
                let rates = rubbed.iter().map(|rubbed| along.rate(&*rubbed.relation));
                let rates: Vec<Dual> = rates.collect();
                let changes = friction.changes(&value, &rates, stays);
                for (Rubbed { load, .. }, change) in rubbed.iter().zip(changes) {
                    direction.loads[*load] = *change;
                }
                Ok::<_, Error>(friction.slides_in_joints())
            };
            if change(solver, &mut direction, None)? {
                let stays = solver.force_sensitivity(motion, &direction, forces)?;
                change(solver, &mut direction, Some(&stays))?;
            }
        }
        let changes = solver.force_sensitivity(motion, &direction, forces)?;
        Ok(Some(changes))
    }

    /// Returns the rounding error of a driver's effort \[N or N m\], zero unless forces are sought.
    #[must_use]
    pub fn effort_rounding(&self, solver: &Solver, driver: DriverId) -> f64 {
        let forces = self.forces();
        forces.map_or(0.0, |forces| {
            solver.effort_rounding(&self.rates, driver, forces)
        })
    }
}

/// Returns the places of the friction of a mechanism without freedoms.
fn rubbed(solver: &Solver) -> Vec<Rubbed> {
    let mechanism = solver.mechanism();
    let loads = mechanism.load_inputs().len()..;
    let forces = mechanism.forces.iter();
    let frictions = forces.filter_map(|force| match &force.load {
        Load::Passive {
            coordinate,
            cause: PassiveCause::Friction(law),
        } => Some((solver.relation_of(&force.load, coordinate), law)),
        _ => None,
    });
    let rubbed = loads.zip(frictions).map(|(load, (relation, law))| Rubbed {
        load,
        relation,
        joint: law.bearing.as_ref().map(|bearing| bearing.joint),
    });
    rubbed.collect()
}

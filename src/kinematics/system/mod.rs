//! The mechanism as a system of equations Phi(q, t) = 0 (Eq. 3.6.3).
//!
//! This is one side of the seam to the linear algebra: here are the equations, their rows and
//! their scales, and nothing about how a linear system is solved.

mod joint;

use std::f64::consts::TAU;
use std::sync::Arc;

use joint::JointParts;

use crate::kinematics::configuration::{CamProfile, Configuration};
use crate::kinematics::constraint::{self, Constraint, Dimension, Gradient, Incidence, TurnEffect};
use crate::kinematics::linear::{Row, nan_or_larger};
use crate::kinematics::variation::{Varied, VariedConfiguration};
use crate::kinematics::{Element, Error};
use crate::mechanism::{DriverId, Expression, Jet, Mechanism, ParameterId};

/// What c(q) is held at.
#[derive(Clone, Debug)]
pub enum Target {
    /// A number that depends on parameters only.
    Constant(Expression),
    /// The value of a driver.
    Driver(DriverId),
}

/// One row of Phi: c(q) − target = 0.
#[derive(Debug)]
pub struct Equation {
    /// The joint, constraint or driver that it belongs to.
    pub element: Element,
    /// c(q).
    pub constraint: Box<dyn Constraint>,
    /// What it is held at.
    pub target: Target,
    /// The parameters that it uses besides those of markers and of the target.
    pub parameters: Vec<ParameterId>,
}

/// The equations of a mechanism: kinematic constraints (Eq. 3.6.1), then drivers (Eq. 3.6.2).
#[derive(Debug)]
pub struct System {
    mechanism: Arc<Mechanism>,
    equations: Vec<Equation>,
    /// The row of each driver.
    driver_rows: Vec<usize>,
    joint_parts: JointParts,
}

/// The right-hand sides in force: what each c(q) is held at.
#[derive(Clone, Debug)]
pub struct Targets {
    /// Values of the constants, zero for drivers.
    constants: Vec<f64>,
    /// Whole turns by which an angle row differs from its constant.
    pub turns: Vec<i32>,
}

impl Targets {
    /// What a row that no driver moves is held at, whole turns apart.
    pub(in crate::kinematics) fn constant(&self, row: usize) -> f64 {
        self.constants[row]
    }
}

/// One entry of Phi, scaled, with the rounding error that it carries anyhow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::kinematics) struct RowValue {
    pub(in crate::kinematics) value: f64,
    /// Estimated rounding error of the value.
    pub(in crate::kinematics) rounding: f64,
}

impl System {
    /// Writes down the equations of a mechanism.
    #[must_use]
    pub fn new(mechanism: Arc<Mechanism>) -> Self {
        let mut equations = Vec::new();
        let mut joint_parts = JointParts::default();
        for (index, joint) in mechanism.joints.iter().enumerate() {
            let element = Element::Joint(index);
            joint_parts.parameters.clear();
            for (constraint, target) in
                joint::relations(&mechanism, element, joint, &mut joint_parts)
            {
                equations.push(Equation {
                    element,
                    constraint,
                    target: Target::Constant(target),
                    parameters: joint_parts.parameters.clone(),
                });
            }
        }
        for (index, held) in mechanism.constraints.iter().enumerate() {
            equations.push(Equation {
                element: Element::Constraint(index),
                constraint: constraint::of_coordinate(&held.coordinate),
                target: Target::Constant(held.value.clone()),
                parameters: Vec::new(),
            });
        }
        let mut driver_rows = Vec::with_capacity(mechanism.drivers.len());
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            driver_rows.push(equations.len());
            equations.push(Equation {
                element: Element::Driver(DriverId(index)),
                constraint: constraint::of_coordinate(&driver.coordinate),
                target: Target::Driver(DriverId(index)),
                parameters: Vec::new(),
            });
        }
        Self {
            mechanism,
            equations,
            driver_rows,
            joint_parts,
        }
    }

    /// The mechanism these are the equations of.
    #[must_use]
    pub fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    /// The rows of Phi.
    #[must_use]
    pub fn equations(&self) -> &[Equation] {
        &self.equations
    }

    /// The number of unknowns: three generalized coordinates a body, and what joints bring.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        3 * self.mechanism.bodies.len() + self.joint_parts.unknowns.len()
    }

    /// What an unknown belongs to, for messages: a body, or the joint that brought it.
    #[must_use]
    pub fn describe_unknown(&self, column: usize) -> String {
        match self.mechanism.bodies.get(column / 3) {
            Some(body) => format!("body `{}`", body.name),
            None => {
                let place = column - 3 * self.mechanism.bodies.len();
                self.joint_parts.unknowns[place].0.describe(&self.mechanism)
            }
        }
    }

    /// Returns the names of what moves by more than `least` among these unknowns: bodies, and joints
    /// with unknowns of their own.
    pub(in crate::kinematics) fn describe_moved(
        &self,
        motion: impl Iterator<Item = (usize, f64)>,
        least: f64,
    ) -> Vec<String> {
        let moved = motion.filter(|(_, value)| value.abs() > least);
        let mut columns: Vec<_> = moved.map(|(column, _)| column).collect();
        columns.sort_unstable();
        let mut names: Vec<_> = columns
            .into_iter()
            .map(|k| self.describe_unknown(k))
            .collect();
        // The unknowns of a body are next to each other.
        names.dedup();
        names
    }

    /// Returns the rows of some elements, ascending.
    pub(in crate::kinematics) fn rows_of(&self, elements: &[Element]) -> Vec<usize> {
        let equations = self.equations.iter().enumerate();
        let theirs = equations.filter(|(_, e)| elements.contains(&e.element));
        theirs.map(|(row, _)| row).collect()
    }

    /// The unknowns and parameters in row `row`, each unknown once, ascending.
    pub(in crate::kinematics) fn incidence(&self, row: usize) -> Incidence {
        let mut incidence = Incidence::default();
        let constraint = &self.equations[row].constraint;
        constraint.incidence(&self.mechanism, &mut incidence);
        incidence.unknowns.sort_unstable();
        incidence.unknowns.dedup();
        incidence
    }

    /// A configuration for this system, its parameter values still to be set.
    #[must_use]
    pub fn configuration(&self) -> Configuration {
        Configuration::new(
            &self.mechanism,
            self.joint_parts.coefficients.len(),
            self.joint_parts.profiles.clone(),
            self.joint_parts.unknowns.len(),
        )
    }

    /// The mechanism in motion, for [`Sensitivity`](super::Sensitivity).
    pub(in crate::kinematics) fn varied(
        &self,
        parameter: impl Fn(ParameterId) -> Varied,
        motion: impl Iterator<Item = [f64; 3]>,
        profiles: &[CamProfile],
    ) -> VariedConfiguration {
        let coefficients = &self.joint_parts.coefficients;
        VariedConfiguration::new(&self.mechanism, coefficients, profiles, parameter, motion)
    }

    /// Targets of which [`set_parameters`](Self::set_parameters) has still to give the values.
    #[must_use]
    pub fn targets(&self) -> Targets {
        Targets {
            constants: vec![0.0; self.equations.len()],
            turns: vec![0; self.equations.len()],
        }
    }

    /// Takes over all that depends on the parameters alone. Allocates nothing unless it fails.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] where an expression leaves its domain, [`Error::NotPositive`] where a
    /// distance is held at a value that is not positive. Configuration and targets are then
    /// without use until valid values are set.
    pub fn set_parameters(
        &self,
        parameters: &[f64],
        at: &mut Configuration,
        targets: &mut Targets,
    ) -> Result<(), Error> {
        at.set_parameters(&self.mechanism, &self.joint_parts.coefficients, parameters)?;
        for (equation, constant) in self.equations.iter().zip(&mut targets.constants) {
            let Target::Constant(expression) = &equation.target else {
                continue;
            };
            *constant = expression.evaluate(&|p| parameters[p.index()], 0.0);
            if !constant.is_finite() {
                return Err(Error::NotFinite {
                    what: equation.element.describe(&self.mechanism),
                });
            }
            if !equation.constraint.admits(*constant) {
                return Err(Error::NotPositive {
                    what: equation.element.describe(&self.mechanism),
                    value: *constant,
                });
            }
            if equation.constraint.dimension() == Dimension::Length {
                at.enlarge(constant.abs());
            }
        }
        Ok(())
    }

    /// Whether every driver's value is one that its coordinate can take.
    ///
    /// # Errors
    ///
    /// [`Error::NoMotion`] or [`Error::NotPositive`], naming the driver.
    pub fn check_drivers(&self, drivers: &[f64]) -> Result<(), Error> {
        for (&row, &value) in self.driver_rows.iter().zip(drivers) {
            let equation = &self.equations[row];
            let what = || equation.element.describe(&self.mechanism);
            if !value.is_finite() {
                return Err(Error::NoMotion {
                    driver: what(),
                    quantity: "value",
                });
            }
            if !equation.constraint.admits(value) {
                return Err(Error::NotPositive {
                    what: what(),
                    value,
                });
            }
        }
        Ok(())
    }

    /// A driver as messages name it.
    pub(in crate::kinematics) fn describe_driver(&self, driver: DriverId) -> String {
        let row = self.driver_rows[driver.index()];
        self.equations[row].element.describe(&self.mechanism)
    }

    /// Fixes the whole turns of each angle row that is not a driver: the ones nearest the present
    /// configuration.
    pub fn fix_turns(&self, at: &Configuration, targets: &mut Targets) {
        for (row, equation) in self.equations.iter().enumerate() {
            if equation.holds_any_turn() {
                let excess = equation.constraint.value(at) - targets.constants[row];
                // A saturating cast: nobody turns two thousand million times before assembly.
                targets.turns[row] = (excess / TAU).round() as i32;
            }
        }
    }

    /// Where to look for the unknown q\[column\] if a joint brought it, the bodies being where
    /// `at` has them \[rad\].
    #[must_use]
    pub fn estimate_joint_unknown(&self, column: usize, at: &Configuration) -> Option<f64> {
        let place = column.checked_sub(3 * self.mechanism.bodies.len())?;
        let (_, unknown) = self.joint_parts.unknowns.get(place)?;
        Some(unknown.estimate(at))
    }

    /// What row `row` is held at, `drivers` being the values u of all drivers.
    #[must_use]
    pub fn target(&self, row: usize, targets: &Targets, drivers: &[f64]) -> f64 {
        match self.equations[row].target {
            Target::Constant(_) => targets.constants[row] + TAU * f64::from(targets.turns[row]),
            Target::Driver(driver) => drivers[driver.index()],
        }
    }

    /// Evaluates row `row` of Phi and its gradient, scaled so that metres and radians compare:
    /// rows in metres are divided by the mechanism's size, columns multiplied by
    /// [`column_scale`](Self::column_scale).
    ///
    /// `entry(column, value)` is called for each entry of the row of the Jacobian (Eq. 3.6.4);
    /// two calls for the same column add up.
    pub(in crate::kinematics) fn evaluate_row(
        &self,
        row: usize,
        at: &Configuration,
        targets: &Targets,
        drivers: &[f64],
        mut entry: impl FnMut(usize, f64),
    ) -> RowValue {
        let equation = &self.equations[row];
        let size = at.size();
        let row_scale = equation.row_scale(at);
        let target = self.target(row, targets, drivers);
        let value = (equation.constraint.value(at) - target) * row_scale;
        // To first order each coordinate's own rounding moves the value by gradient times
        // q eps; the sines and products inside add some eps of the size.
        let mut magnitude = target.abs() * row_scale + 1.0;
        let mut gradient = Gradient::new();
        equation.constraint.gradient(at, &mut gradient);
        for (column, partial) in gradient.entries() {
            magnitude += (partial * at.coordinate(column)).abs() * row_scale;
            entry(
                column,
                partial * row_scale * self.column_scale(column, size),
            );
        }
        RowValue {
            value,
            rounding: magnitude * f64::EPSILON,
        }
    }

    /// Evaluates row `row` of Phi and writes the entries of its gradient, scaled, each column once.
    pub(in crate::kinematics) fn sparse_row(
        &self,
        row: usize,
        at: &Configuration,
        targets: &Targets,
        drivers: &[f64],
        entries: &mut Row,
    ) -> RowValue {
        entries.clear();
        self.evaluate_row(row, at, targets, drivers, |column, value| {
            match entries.iter_mut().find(|(c, _)| *c == column) {
                Some((_, sum)) => *sum += value,
                None if value != 0.0 => entries.push((column, value)),
                None => {}
            }
        })
    }

    /// The magnitude of the largest entry of Phi, scaled; NaN if any entry is.
    #[must_use]
    pub fn largest_residual(&self, at: &Configuration, targets: &Targets, drivers: &[f64]) -> f64 {
        let rows = self.equations.iter().enumerate();
        rows.map(|(row, equation)| {
            let error = equation.constraint.value(at) - self.target(row, targets, drivers);
            (error * equation.row_scale(at)).abs()
        })
        .fold(0.0, nan_or_larger)
    }

    /// Whether an unknown is an angle; what joints bring with them is.
    #[must_use]
    pub fn is_angle(&self, column: usize) -> bool {
        column % 3 == 2 || column >= 3 * self.mechanism.bodies.len()
    }

    /// Returns the difference of two values of an unknown, scaled, without whole turns.
    #[must_use]
    pub(in crate::kinematics) fn difference(
        &self,
        column: usize,
        size: f64,
        a: f64,
        b: f64,
    ) -> f64 {
        let difference = (a - b) / self.column_scale(column, size);
        if self.is_angle(column) {
            difference - TAU * (difference / TAU).round()
        } else {
            difference
        }
    }

    /// The unknown in metres or radians that a scaled unknown of one stands for.
    #[must_use]
    pub fn column_scale(&self, column: usize, size: f64) -> f64 {
        if self.is_angle(column) { 1.0 } else { size }
    }
}

impl Equation {
    /// Returns the rates of the target, for these rates of the drivers: zero for a constant.
    pub(in crate::kinematics) fn target_rates(&self, drivers: &[Jet]) -> Jet {
        match self.target {
            Target::Constant(_) => Jet::constant(0.0),
            Target::Driver(driver) => drivers[driver.index()],
        }
    }

    /// Whether a joint or constraint holds an angle here, at whatever whole turn it was
    /// assembled. A driver's angle counts turns.
    #[must_use]
    pub fn holds_any_turn(&self) -> bool {
        matches!(self.target, Target::Constant(_))
            && self.constraint.turn_effect() == TurnEffect::Whole
    }

    /// A row in metres is divided by the mechanism's size, one in radians is left as it is.
    pub(in crate::kinematics) fn row_scale(&self, at: &Configuration) -> f64 {
        match self.constraint.dimension() {
            Dimension::Length => 1.0 / at.size(),
            Dimension::Angle => 1.0,
        }
    }
}

//! The mechanism as a system of equations Phi(q, t) = 0 (Eq. 3.6.3).
//!
//! The system knows the equations, their rows and their scales; the linear algebra knows numbers
//! only.

mod joint;
mod linearise;
mod parts;
mod play;
pub(super) mod structure;

use std::any::Any;
use std::f64::consts::TAU;
use std::sync::Arc;

use joint::JointParts;
pub(super) use linearise::{RowValue, Values};
pub(super) use play::{OpenRelation, opens_towards};

use super::constraint::configuration::{Configuration, on_nearest_turn};
use super::constraint::moving_configuration::VariedConfiguration;
use crate::kinematics::constraint::{
    self, Constraint, Dimension, Incidence, OnCurve, RopeLength, Sliding, SlidingContact,
    TurnEffect,
};
use crate::kinematics::linear::{nan_or_larger, spread};
use crate::kinematics::{Error, Origin};
use crate::mechanism::{
    Bearing, Coordinate, DriverId, Expression, Jet, Joint, Load, Mechanism, MotionInForce,
    MovingProfile, Number, ParameterId, Phase, PrescribedMotion, SlidingWay,
};

/// The target of c(q).
#[derive(Clone, Debug)]
pub enum EquationTarget {
    /// A number that depends on parameters only.
    Constant(Expression),
    /// The value of a driver.
    Driver(DriverId),
}

/// One row of Phi: c(q) − target = 0.
#[derive(Debug)]
pub struct Equation {
    /// The joint, constraint or driver that it belongs to.
    pub origin: Origin,
    /// c(q).
    pub constraint: Box<dyn Constraint>,
    /// The target.
    pub target: EquationTarget,
    /// The parameters that it uses besides those of markers and of the target.
    pub parameters: Vec<ParameterId>,
    /// Size of its [part](parts) of the mechanism, relative to the mechanism's size.
    part: f64,
}

/// The equations of a mechanism: kinematic constraints (Eq. 3.6.1), then drivers (Eq. 3.6.2).
#[derive(Debug)]
pub struct System {
    mechanism: Arc<Mechanism>,
    equations: Vec<Equation>,
    /// The row of each driver.
    driver_rows: Vec<usize>,
    /// The joints that are ropes, with their rows.
    ropes: Vec<(usize, usize)>,
    /// The joints that are curves, with their first rows.
    curves: Vec<(usize, usize)>,
    /// The relations of joints with play, which are no rows.
    open: Vec<OpenRelation>,
    joint_parts: JointParts,
    /// Size of each body's [part](parts), relative to the mechanism's size.
    part_sizes: Vec<f64>,
}

/// The targets in force.
#[derive(Clone, Debug)]
pub struct Targets {
    /// Values of the constants, zero for drivers.
    constants: Vec<f64>,
    /// Whole turns by which an angle row differs from its constant.
    pub turns: Vec<i32>,
}

impl Targets {
    /// Returns the constant of a row that no driver moves, without whole turns.
    pub(in crate::kinematics) fn constant(&self, row: usize) -> f64 {
        self.constants[row]
    }
}

impl System {
    /// Writes down the equations of a mechanism.
    #[must_use]
    pub fn new(mechanism: Arc<Mechanism>) -> Self {
        let mut equations = Vec::new();
        let mut joint_parts = JointParts::default();
        let (mut ropes, mut curves) = (Vec::new(), Vec::new());
        let mut open = Vec::new();
        for (index, joint) in mechanism.joints.iter().enumerate() {
            let origin = Origin::Joint(index);
            joint_parts.parameters.clear();
            let mut relations = joint::relations(&mechanism, origin, joint, &mut joint_parts);
            if mechanism.play(index).is_some()
                && let Some((constraint, target)) = relations.pop()
            {
                let parameters = joint_parts.parameters.clone();
                open.push(OpenRelation::new(index, constraint, target, parameters));
            } else if joint.rope().is_some() {
                ropes.push((index, equations.len()));
            }
            if joint.curve().is_some() {
                curves.push((index, equations.len()));
            }
            for (constraint, target) in relations {
                equations.push(Equation {
                    origin,
                    constraint,
                    target: EquationTarget::Constant(target),
                    parameters: joint_parts.parameters.clone(),
                    part: 1.0,
                });
            }
        }
        for (index, held) in mechanism.constraints.iter().enumerate() {
            equations.push(Equation {
                origin: Origin::Constraint(index),
                constraint: constraint::of_coordinate(&held.coordinate),
                target: EquationTarget::Constant(held.value.clone()),
                parameters: Vec::new(),
                part: 1.0,
            });
        }
        let mut driver_rows = Vec::with_capacity(mechanism.drivers.len());
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            driver_rows.push(equations.len());
            equations.push(Equation {
                origin: Origin::Driver(DriverId(index)),
                constraint: constraint::of_coordinate(&driver.coordinate),
                target: EquationTarget::Driver(DriverId(index)),
                parameters: Vec::new(),
                part: 1.0,
            });
        }
        let part_sizes = parts::part_sizes(&mechanism, &equations);
        for equation in &mut equations {
            let mut incidence = Incidence::default();
            equation.constraint.incidence(&mechanism, &mut incidence);
            let mut unknowns = incidence.unknowns.iter();
            let part = unknowns.find_map(|column| part_sizes.get(column / 3));
            equation.part = part.copied().unwrap_or(1.0);
        }
        let mut system = Self {
            mechanism,
            equations,
            driver_rows,
            ropes,
            curves,
            open,
            joint_parts,
            part_sizes,
        };
        system.take_drawn_phases();
        system
    }

    /// Holds the relations whose phase is as drawn at the values that the estimates give with the
    /// file's parameters. Values that are not finite are told when these parameters are set.
    fn take_drawn_phases(&mut self) {
        let joints = self.mechanism.joints.iter().enumerate();
        let drawn = joints.filter(|(_, joint)| matches!(joint.kind.phase(), Some(Phase::Drawn)));
        let rows =
            drawn.flat_map(|(joint, _)| self.rows_of(&[Origin::Joint(joint)]).first().copied());
        let rows: Vec<usize> = rows.collect();
        let is_drawn = |joint: usize| {
            let phase = self.mechanism.joints[joint].kind.phase();
            matches!(phase, Some(Phase::Drawn))
        };
        if rows.is_empty() && !self.open.iter().any(|open| is_drawn(open.joint)) {
            return;
        }
        let parameters = self.mechanism.default_parameters();
        let (mut at, mut targets) = (self.configuration(), self.targets());
        if self
            .set_parameters(&parameters, &mut at, &mut targets)
            .is_err()
        {
            return;
        }
        let estimates = self.mechanism.bodies.iter().flat_map(|body| &body.estimate);
        let mut q: Vec<f64> = estimates.map(|e| e.value(&parameters)).collect();
        q.resize(self.unknowns(), 0.0);
        at.set_pose(&self.mechanism, &q);
        for row in rows {
            let value = self.equations[row].constraint.value(&at);
            self.equations[row].target = EquationTarget::Constant(Expression::constant(value));
        }
        for open in self.open.iter_mut().filter(|open| is_drawn(open.joint)) {
            open.target = Expression::constant(open.relation.value(&at));
        }
    }

    /// Returns the joints that are ropes, with their relations.
    pub(in crate::kinematics) fn ropes(&self) -> impl Iterator<Item = (usize, &RopeLength)> {
        let held = self.ropes.iter();
        let held = held.map(|&(joint, row)| (joint, &*self.equations[row].constraint));
        let open = self.open.iter().map(|open| (open.joint, &*open.relation));
        held.chain(open).filter_map(|(joint, constraint)| {
            let constraint: &dyn Any = constraint;
            Some((joint, constraint.downcast_ref()?))
        })
    }

    /// Returns the parameters on which the relations of joints with play depend, besides those of
    /// markers.
    pub fn parameters_of_play(&self) -> impl Iterator<Item = ParameterId> {
        let all = self.open.iter();
        all.flat_map(|open| open.parameters(&self.mechanism))
    }

    /// Returns the relation along which a force acts that has this coordinate: of a joint with play its
    /// own, of friction in some joints that of their sliding, or else that of the coordinate.
    pub(in crate::kinematics) fn relation_of(
        &self,
        load: &Load,
        coordinate: &Coordinate,
    ) -> Arc<dyn Constraint> {
        let open = load.play().and_then(|joint| self.open_relation(joint));
        if let Some(open) = open {
            return Arc::clone(&open.relation);
        }
        match load.slides().and_then(|bearing| self.sliding(bearing)) {
            Some(sliding) => Arc::new(sliding),
            None => constraint::of_coordinate(coordinate).into(),
        }
    }

    /// Returns the way along which the two sides of a joint slide that is no coordinate.
    fn sliding(&self, bearing: &Bearing) -> Option<Sliding> {
        let Joint { from, to, .. } = self.mechanism.joints[bearing.joint];
        if let SlidingWay::Rod(end) = bearing.way {
            let [from, to] = if end == 0 { [from, to] } else { [to, from] };
            let contact = SlidingContact::Rod;
            return Some(Sliding { from, to, contact });
        }
        let rows = self.rows_of(&[Origin::Joint(bearing.joint)]).into_iter();
        let held = rows.map(|row| &*self.equations[row].constraint);
        let open = self.open_relation(bearing.joint);
        let mut relations = held.chain(open.map(|open| &*open.relation));
        relations.find_map(Sliding::of)
    }

    /// Returns the relation of a joint with play.
    pub(in crate::kinematics) fn open_relation(&self, joint: usize) -> Option<&OpenRelation> {
        self.open.iter().find(|open| open.joint == joint)
    }

    /// Returns the joints that are curves, with the relation of their x.
    pub(in crate::kinematics) fn curves(&self) -> impl Iterator<Item = (usize, &OnCurve)> {
        self.curves.iter().filter_map(|&(joint, row)| {
            let constraint: &dyn Any = &*self.equations[row].constraint;
            Some((joint, constraint.downcast_ref()?))
        })
    }

    /// Returns the mechanism.
    #[must_use]
    pub fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    /// Returns the rows of Phi.
    #[must_use]
    pub fn equations(&self) -> &[Equation] {
        &self.equations
    }

    /// Returns the number of unknowns: three generalized coordinates per body, and joint unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        3 * self.mechanism.bodies.len() + self.joint_parts.unknowns.len()
    }

    /// Returns the name of the body or joint that an unknown belongs to, for messages.
    #[must_use]
    pub fn describe_unknown(&self, column: usize) -> String {
        match self.mechanism.bodies.get(column / 3) {
            Some(body) => format!("body `{}`", body.name),
            None => self.origin_of(column).describe(&self.mechanism),
        }
    }

    /// Returns the joint that a joint unknown belongs to.
    pub(in crate::kinematics) fn origin_of(&self, column: usize) -> Origin {
        let place = column - 3 * self.mechanism.bodies.len();
        self.joint_parts.unknowns[place].0
    }

    /// Returns the names of the bodies and joints whose unknowns move by more than `least`.
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

    /// Returns the rows of some origins, ascending.
    pub(in crate::kinematics) fn rows_of(&self, origins: &[Origin]) -> Vec<usize> {
        let equations = self.equations.iter().enumerate();
        let theirs = equations.filter(|(_, e)| origins.contains(&e.origin));
        theirs.map(|(row, _)| row).collect()
    }

    /// Returns the unknowns and parameters in a row, each unknown once, ascending.
    pub(in crate::kinematics) fn incidence(&self, row: usize) -> Incidence {
        let mut incidence = Incidence::default();
        let constraint = &self.equations[row].constraint;
        constraint.incidence(&self.mechanism, &mut incidence);
        incidence.unknowns.sort_unstable();
        incidence.unknowns.dedup();
        incidence
    }

    /// Makes a configuration for this system; its parameter values are still to be set.
    #[must_use]
    pub fn configuration(&self) -> Configuration {
        Configuration::new(
            &self.mechanism,
            self.joint_parts.coefficients.len(),
            (
                self.joint_parts.profiles.clone(),
                self.joint_parts.laws.clone(),
            ),
            self.joint_parts.unknowns.len(),
        )
    }

    /// Returns a configuration that belongs to no motion, at which nothing is in line or at right
    /// angles.
    pub(in crate::kinematics) fn anywhere(&self, at: &Configuration) -> Configuration {
        let q: Vec<_> = (0..self.unknowns())
            .map(|column| {
                let scale = self
                    .column_part(column)
                    .map_or(at.size(), |part| at.size() * part);
                let k = column + 1;
                scale * spread(k) + (k % 3) as f64
            })
            .collect();
        let mut anywhere = at.clone();
        anywhere.set_pose(&self.mechanism, &q);
        anywhere
    }

    /// Makes the mechanism on numbers with derivatives, at rest at the origin, its parameters being
    /// zero.
    pub(in crate::kinematics) fn varied<N: Number>(&self) -> VariedConfiguration<N> {
        let coefficients = &self.joint_parts.coefficients;
        VariedConfiguration::new(&self.mechanism, coefficients, self.unknowns())
    }

    /// Sets the numbers in the relations to those that `value` gives; the others stay. Allocates
    /// nothing.
    pub(in crate::kinematics) fn vary_numbers<N: Number>(
        &self,
        at: &mut VariedConfiguration<N>,
        value: &dyn Fn(&Expression) -> Option<N>,
    ) {
        at.set_numbers(&self.mechanism, &self.joint_parts.coefficients, value);
    }

    /// Returns the profiles of all cams, for parameters that move.
    pub(in crate::kinematics) fn moving_profiles(&self) -> Vec<MovingProfile> {
        let profiles = self.joint_parts.profiles.iter();
        profiles.map(|profile| profile.in_force.moving()).collect()
    }

    /// Makes the laws of all couplings on another type of numbers; their parameters are still to be
    /// set.
    pub(in crate::kinematics) fn laws<N: Number>(&self) -> Vec<MotionInForce<N>> {
        let laws = self.joint_parts.laws.iter();
        let parameters = self.mechanism.parameters.len();
        laws.map(|own| MotionInForce::new(&own.law, parameters))
            .collect()
    }

    /// Makes targets; [`set_parameters`](Self::set_parameters) gives them their values.
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
    /// [`Error::Limit`] if a derived parameter is outside its limits, [`Error::StopLimits`] where
    /// those of a stop leave no room, [`Error::Shape`] for a shape without an outline, [`Error::NotFinite`] where an expression leaves its domain,
    /// [`Error::NotPositive`] where a distance is held at a value that is not positive.
    /// Configuration and targets are then without use until valid values are set.
    pub fn set_parameters(
        &self,
        parameters: &[f64],
        at: &mut Configuration,
        targets: &mut Targets,
    ) -> Result<(), Error> {
        self.check_derived(parameters)?;
        self.check_stops(parameters)?;
        at.set_parameters(&self.mechanism, &self.joint_parts.coefficients, parameters)?;
        if let Some(fault) = self.mechanism.shape_fault(parameters) {
            return Err(Error::Shape(Box::new(fault)));
        }
        for (equation, constant) in self.equations.iter().zip(&mut targets.constants) {
            let EquationTarget::Constant(expression) = &equation.target else {
                continue;
            };
            *constant = expression.value(parameters);
            if !constant.is_finite() {
                return Err(Error::NotFinite {
                    what: equation.origin.describe(&self.mechanism),
                });
            }
            if !equation.constraint.admits(*constant) {
                return Err(Error::NotPositive {
                    what: equation.origin.describe(&self.mechanism),
                    value: *constant,
                });
            }
            if equation.constraint.dimension() == Dimension::Length {
                at.enlarge(constant.abs());
            }
        }
        Ok(())
    }

    /// Checks the limits of derived parameters; those of others are checked where they are set.
    fn check_derived(&self, parameters: &[f64]) -> Result<(), Error> {
        /// Rounding of a value between two others, in parts of a limit.
        const LIMIT_ROUNDING: f64 = 4.0 * f64::EPSILON;
        let all = self.mechanism.parameters.iter().zip(parameters);
        for (parameter, &value) in all.filter(|(parameter, _)| parameter.derived) {
            let limits = [
                (parameter.min, "below `min`", 1.0),
                (parameter.max, "above `max`", -1.0),
            ];
            for (limit, beyond, inwards) in limits {
                if let Some(limit) = limit
                    && inwards * (value - limit) < -LIMIT_ROUNDING * limit.abs()
                {
                    return Err(Error::Limit {
                        name: parameter.name.clone(),
                        value,
                        beyond,
                        limit,
                    });
                }
            }
        }
        Ok(())
    }

    /// Checks that the limits of stops leave room between them.
    fn check_stops(&self, parameters: &[f64]) -> Result<(), Error> {
        for stop in &self.mechanism.stops {
            let [min, max] = stop.limits(&|id| parameters[id.index()]);
            if min.is_nan() || max.is_nan() {
                let what = format!("a limit of stop `{}`", stop.name);
                return Err(Error::NotFinite { what });
            }
            if min >= max {
                return Err(Error::StopLimits {
                    stop: stop.name.clone(),
                    kind: stop.coordinate.kind,
                    min,
                    max,
                });
            }
        }
        Ok(())
    }

    /// Checks that every driver's value is one that its coordinate can take.
    ///
    /// # Errors
    ///
    /// [`Error::NoMotion`] or [`Error::NotPositive`], naming the driver.
    pub fn check_drivers(&self, drivers: &[f64]) -> Result<(), Error> {
        let rows = self.driver_rows.iter().zip(&self.mechanism.drivers);
        for ((&row, driver), &value) in rows.zip(drivers) {
            let equation = &self.equations[row];
            let what = || equation.origin.describe(&self.mechanism);
            if !value.is_finite() {
                let quantity = match driver.motion() {
                    Some(PrescribedMotion::Table(_)) => "value: the times of its table must rise",
                    _ => "value",
                };
                return Err(Error::NoMotion {
                    driver: what(),
                    quantity,
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

    /// Returns the row of a driver.
    pub(in crate::kinematics) fn driver_row(&self, driver: DriverId) -> &Equation {
        &self.equations[self.driver_rows[driver.index()]]
    }

    /// Returns a driver as messages name it.
    pub(in crate::kinematics) fn describe_driver(&self, driver: DriverId) -> String {
        self.driver_row(driver).origin.describe(&self.mechanism)
    }

    /// Fixes the whole turns of each angle row that is not a driver: those nearest the present
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

    /// Returns an estimate of q\[column\], if it is a joint unknown, for these places of the bodies
    /// \[rad\].
    #[must_use]
    pub fn estimate_joint_unknown(&self, column: usize, at: &Configuration) -> Option<f64> {
        let place = column.checked_sub(3 * self.mechanism.bodies.len())?;
        let (_, unknown) = self.joint_parts.unknowns.get(place)?;
        Some(unknown.estimate(at))
    }

    /// Returns the target of a row, for these values u of all drivers.
    #[must_use]
    pub fn target(&self, row: usize, targets: &Targets, drivers: &[f64]) -> f64 {
        match self.equations[row].target {
            EquationTarget::Constant(_) => {
                targets.constants[row] + TAU * f64::from(targets.turns[row])
            }
            EquationTarget::Driver(driver) => drivers[driver.index()],
        }
    }

    /// Returns the magnitude of the largest entry of Phi, scaled; NaN if any entry is.
    #[must_use]
    pub fn largest_residual(&self, at: &Configuration, targets: &Targets, drivers: &[f64]) -> f64 {
        let rows = self.equations.iter().enumerate();
        rows.map(|(row, equation)| {
            let error = equation.constraint.value(at) - self.target(row, targets, drivers);
            (error * equation.row_scale(at)).abs()
        })
        .fold(0.0, nan_or_larger)
    }

    /// Returns whether an unknown is an angle; joint unknowns are.
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
            on_nearest_turn(difference, 0.0)
        } else {
            difference
        }
    }

    /// Returns the scale factor of an unknown \[m or rad\], for this size of the mechanism: for a
    /// place the size of the body's part.
    #[must_use]
    pub fn column_scale(&self, column: usize, size: f64) -> f64 {
        self.column_part(column).map_or(1.0, |part| size * part)
    }

    /// Returns the relative size of the [part](parts) that scales an unknown, `None` for an angle.
    pub(in crate::kinematics) fn column_part(&self, column: usize) -> Option<f64> {
        (!self.is_angle(column)).then(|| self.part_sizes[column / 3])
    }
}

impl Equation {
    /// Returns the rates of the target, for these rates of the drivers: zero for a constant.
    pub(in crate::kinematics) fn target_rates(&self, drivers: &[Jet]) -> Jet {
        match self.target {
            EquationTarget::Constant(_) => Jet::constant(0.0),
            EquationTarget::Driver(driver) => drivers[driver.index()],
        }
    }

    /// Returns whether the row holds an angle at the whole turn at which it was assembled. A
    /// driver's angle counts turns.
    #[must_use]
    pub fn holds_any_turn(&self) -> bool {
        matches!(self.target, EquationTarget::Constant(_))
            && self.constraint.turn_effect() == TurnEffect::Whole
    }

    /// Returns the size of the row's [part](parts) of the mechanism, relative to the mechanism's size.
    pub(in crate::kinematics) fn part(&self) -> f64 {
        self.part
    }

    /// Returns the size of the row's [part](parts) of the mechanism \[m\].
    pub(in crate::kinematics) fn size(&self, at: &Configuration) -> f64 {
        at.size() * self.part
    }

    /// Returns the scale factor of the row: rows in metres are divided by the size of their part.
    pub(in crate::kinematics) fn row_scale(&self, at: &Configuration) -> f64 {
        match self.constraint.dimension() {
            Dimension::Length => 1.0 / self.size(at),
            Dimension::Angle => 1.0,
        }
    }
}

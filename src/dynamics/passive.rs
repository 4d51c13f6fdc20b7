//! Forces that follow from the motion: those of rigid stops and of friction.
//!
//! Each acts along a coordinate c. While its [`Mode`] lasts the motion is smooth: a stop that nothing
//! touches exerts nothing, friction that slides exerts what its law says, and a stop that is touched and
//! friction that sticks hold their coordinate, c̈ = 0, by the force that this takes.

use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::DMatrix;

use super::triangular::{ascend, descend, factorise};

use crate::kinematics::constraint::Constraint;
use crate::kinematics::{EquationsOfMotion, ForceSensitivity, JointFriction, Sensitivity, Solver};
use crate::mechanism::{
    DriverId, Dual, ElasticStop, FrictionLaw, Jet, Load, Order, ParameterId, PassiveCause,
};

/// Gap and speed up to which a coordinate is at a stop and at rest, in radians or sizes of the
/// mechanism, and those per second: some hundred roundings.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// The state of a passive force while the motion is smooth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Nothing touches the stop.
    Free,
    /// The coordinate rests at the least value of its stop, or is beyond that of an elastic one.
    AtMin,
    /// The same at the largest value.
    AtMax,
    /// The coordinate is beyond the least value of an elastic stop, whose damper holds the spring off.
    LooseAtMin,
    /// The same at the largest value.
    LooseAtMax,
    /// Friction sticks.
    Sticking,
    /// Friction while the coordinate grows.
    Growing,
    /// Friction while the coordinate falls.
    Falling,
}

impl Mode {
    /// All modes; their places are those of a saved state.
    pub const ALL: [Self; 8] = [
        Self::Free,
        Self::AtMin,
        Self::AtMax,
        Self::LooseAtMin,
        Self::LooseAtMax,
        Self::Sticking,
        Self::Growing,
        Self::Falling,
    ];

    /// Returns the direction in which the coordinate slides, or in which its stop pushes.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::AtMin | Self::LooseAtMin | Self::Growing => 1.0,
            Self::AtMax | Self::LooseAtMax | Self::Falling => -1.0,
            Self::Free | Self::Sticking => 0.0,
        }
    }
}

/// A passive force at a point of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passive {
    /// Value, rate and acceleration of its coordinate \[SI\].
    pub coordinate: Jet,
    /// The force along it \[N or N m\]; that of an elastic stop may pull where it is loose.
    pub force: f64,
    /// Least and largest value of a stop \[m or rad\], infinite without one; the bounds of friction
    /// that sticks \[N or N m\].
    pub bounds: [f64; 2],
    /// Gap, or speed, that is rounding \[m or rad, or those per second\].
    pub rounding: f64,
    /// Force of an elastic stop that is rounding: that of its spring in such a gap \[N or N m\].
    pub force_rounding: f64,
}

impl Passive {
    pub(super) const NONE: Self = Self {
        coordinate: Jet {
            value: 0.0,
            derivatives: [0.0; 2],
        },
        force: 0.0,
        bounds: [f64::NEG_INFINITY, f64::INFINITY],
        rounding: 0.0,
        force_rounding: 0.0,
    };

    /// Returns the mode of an elastic stop.
    pub(super) fn elastic_mode(&self) -> Mode {
        let [value, rate] = [self.coordinate.value, self.coordinate.first()];
        let [least, most] = self.bounds;
        // At a limit it is touched if the coordinate goes beyond.
        let is_beyond = |beyond: f64, rate: f64| {
            beyond > self.rounding || beyond.abs() <= self.rounding && rate > 0.0
        };
        let touched = if is_beyond(least - value, -rate) {
            Mode::AtMin
        } else if is_beyond(value - most, rate) {
            Mode::AtMax
        } else {
            return Mode::Free;
        };
        let is_inside = (least..=most).contains(&value);
        match is_inside || touched.sign() * self.force > 0.0 {
            true => touched,
            false if touched == Mode::AtMin => Mode::LooseAtMin,
            false => Mode::LooseAtMax,
        }
    }
}

/// The passive forces of a mechanism.
#[derive(Debug)]
pub(super) struct PassiveForces {
    /// Those without a law, then elastic stops.
    pub(super) list: Vec<PassiveForce>,
    loads: usize,
    pub(super) modes: Vec<Mode>,
    /// Whether drivers alone move the coordinate of friction.
    pub(super) is_driven: Vec<bool>,
    /// The values at which coordinates are held.
    pub(super) anchors: Vec<f64>,
    /// ∂c/∂u: a row per force, a column per driver.
    pub(super) rows: DMatrix<f64>,
    /// The forces that hold.
    holding: Vec<usize>,
    /// L⁻¹ (∂c/∂u)ᵀ of the freedoms: a column per force that holds.
    columns: DMatrix<f64>,
    /// The factor of W = ∂c/∂u J⁻¹ (∂c/∂u)ᵀ of the forces that hold.
    factor: DMatrix<f64>,
    /// The forces that hold, or impulses.
    forces: Vec<f64>,
    /// Accelerations of the coordinates where no driver accelerates.
    coasting: Vec<f64>,
    pub(super) joint_friction: JointFriction,
    /// Friction in joints, in their order there: its index here, and that of the joint.
    pub(super) bearings: Vec<(usize, usize)>,
}

/// One passive force.
#[derive(Debug)]
pub(super) struct PassiveForce {
    /// Index of the force in the mechanism.
    pub(super) index: usize,
    relation: Arc<dyn Constraint>,
    is_angle: bool,
    pub(super) cause: Cause,
}

/// Cause of a passive force.
#[derive(Clone, Debug)]
pub(super) enum Cause {
    /// One without a law.
    Lawless(PassiveCause),
    /// An elastic stop: its force has a law, which changes where it is touched.
    Elastic(ElasticStop),
}

impl Cause {
    /// Returns whether it is a contact that holds its coordinate at a limit.
    pub(super) fn is_contact(&self) -> bool {
        matches!(self, Self::Lawless(cause) if cause.is_contact())
    }

    /// Returns the law of friction.
    pub(super) fn friction(&self) -> Option<&FrictionLaw> {
        match self {
            Self::Lawless(PassiveCause::Friction(law)) => Some(law),
            _ => None,
        }
    }
}

impl PassiveForces {
    pub(super) fn new(solver: &Solver, freedoms: usize) -> Self {
        let mechanism = solver.mechanism();
        let forces = mechanism.forces.iter().enumerate();
        let all = forces.filter_map(|(index, force)| {
            let (coordinate, cause) = match &force.load {
                Load::Passive { coordinate, cause } => (coordinate, Cause::Lawless(cause.clone())),
                Load::Coordinate { coordinate, law } => {
                    let stop = law.as_ref().and_then(|law| law.stop.clone());
                    (coordinate, Cause::Elastic(*stop?))
                }
                Load::Marker { .. } => return None,
            };
            Some(PassiveForce {
                index,
                relation: solver.relation_of(&force.load, coordinate),
                is_angle: coordinate.kind.is_angle(),
                cause,
            })
        });
        let (mut list, elastic): (Vec<_>, Vec<_>) =
            all.partition(|passive| !matches!(passive.cause, Cause::Elastic(_)));
        let loads = list.len();
        list.extend(elastic);
        let (count, drivers) = (list.len(), mechanism.drivers.len());
        let bearings = list.iter().enumerate().filter_map(|(k, passive)| {
            Some((k, passive.cause.friction()?.bearing.as_ref()?.joint))
        });
        Self {
            coasting: vec![0.0; count],
            joint_friction: solver.joint_friction(),
            bearings: bearings.collect(),
            modes: vec![Mode::Free; count],
            is_driven: vec![false; count],
            anchors: vec![0.0; count],
            rows: DMatrix::zeros(count, drivers),
            holding: Vec::with_capacity(count),
            columns: DMatrix::zeros(freedoms, count),
            factor: DMatrix::zeros(count, count),
            forces: vec![0.0; count],
            loads,
            list,
        }
    }

    /// Forgets what is touched and what sticks.
    pub(super) fn reset(&mut self) {
        self.modes.fill(Mode::Free);
    }

    /// Returns how many of them have no law: their sizes are loads.
    pub(super) fn loads(&self) -> usize {
        self.loads
    }

    /// Returns whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Returns the mode of each force, and the value at which its coordinate is held.
    pub(super) fn state(&self) -> impl Iterator<Item = (Mode, f64)> {
        let modes = self.modes.iter().zip(&self.anchors);
        modes.map(|(mode, anchor)| (*mode, *anchor))
    }

    /// Goes on from a state.
    pub(super) fn resume(&mut self, state: &[(Mode, f64)]) {
        let own = self.modes.iter_mut().zip(&mut self.anchors);
        for ((mode, anchor), state) in own.zip(state) {
            (*mode, *anchor) = *state;
        }
    }

    /// Returns whether some coordinate is held.
    pub(super) fn holds(&self) -> bool {
        (0..self.list.len()).any(|k| self.is_held(k))
    }

    /// Returns whether a coordinate is held.
    pub(super) fn is_held(&self, force: usize) -> bool {
        match self.modes[force] {
            Mode::AtMin | Mode::AtMax => self.list[force].cause.is_contact(),
            mode => mode == Mode::Sticking,
        }
    }

    /// Reads coordinates and their partial derivatives at the solver's pose, and adds the friction that
    /// slides, but in joints, to the equations of motion, which are those of the pose.
    pub(super) fn begin(
        &mut self,
        solver: &Solver,
        freedoms: &[DriverId],
        motion: &mut EquationsOfMotion,
        point: &mut [Passive],
    ) {
        let parameters = &solver.pose().parameters;
        let value = |id: ParameterId| parameters[id.index()];
        self.joint_friction.set_parameters(parameters);
        let mut place = 0;
        for (k, (passive, to)) in self.list.iter().zip(point).enumerate() {
            let relation = &*passive.relation;
            to.coordinate = solver.coordinate(relation, motion.coasting());
            self.coasting[k] = to.coordinate.second();
            for driver in 0..self.rows.ncols() {
                let unit = motion.unit(DriverId(driver));
                self.rows[(k, driver)] = solver.coordinate(relation, unit).first();
            }
            if let Cause::Lawless(PassiveCause::Play(joint)) = passive.cause {
                to.bounds = solver.limits_of_play(joint);
                if passive.is_angle {
                    // The bodies' whole turns are no play.
                    let middle = 0.5 * (to.bounds[0] + to.bounds[1]);
                    let turns = ((to.coordinate.value - middle) / TAU).round();
                    to.coordinate.value -= TAU * turns;
                }
            }
            let scale = if passive.is_angle { 1.0 } else { solver.size() };
            to.rounding = ROUNDINGS * scale.max(to.coordinate.value.abs());
            to.force = 0.0;
            let rate = to.coordinate.first();
            match &passive.cause {
                Cause::Lawless(PassiveCause::Stop(stop)) => {
                    to.bounds = solver.mechanism().stops[*stop].limits(parameters);
                }
                Cause::Lawless(PassiveCause::Play(_)) => {}
                Cause::Lawless(PassiveCause::Friction(law)) => {
                    let limit = law.sticking(&value);
                    to.bounds = [-limit, limit];
                    self.is_driven[k] = freedoms.iter().all(|id| self.rows[(k, id.index())] == 0.0);
                    let sign = self.sliding(k, rate);
                    if law.bearing.is_some() {
                        self.joint_friction.set_motion(place, rate, sign);
                        place += 1;
                    } else if sign != 0.0 {
                        to.force = law.along(&value, 1.0, rate, sign);
                        motion.exert(self.rows.row(k).iter().copied(), to.force, rate);
                    }
                }
                Cause::Elastic(stop) => {
                    to.bounds = stop.limits(parameters);
                    let push = stop.push(&value, [to.coordinate.value, rate]);
                    to.force = push.map_or(0.0, |(push, sign)| push * sign);
                    to.force_rounding = stop.stiffness.value(parameters) * to.rounding;
                }
            }
        }
    }

    /// Returns the direction in which the coordinate of friction slides at this rate: one that is driven, as
    /// the drivers have it.
    fn sliding(&self, force: usize, rate: f64) -> f64 {
        match self.is_driven[force] {
            true => FrictionLaw::direction(rate),
            false => self.modes[force].sign(),
        }
    }

    /// Prepares the forces that hold, for L of J = L Lᵀ.
    pub(super) fn prepare(&mut self, freedoms: &[DriverId], lower: &DMatrix<f64>) {
        self.holding.clear();
        for k in 0..self.list.len() {
            if self.is_held(k) {
                self.holding.push(k);
            }
        }
        for column in 0..self.holding.len() {
            let row = (&self.rows, self.holding[column]);
            let mut to = self.columns.column_mut(column);
            write_column(row, freedoms, lower, to.as_mut_slice());
        }
        let count = self.holding.len();
        for i in 0..count {
            for j in 0..=i {
                self.factor[(i, j)] = self.columns.column(i).dot(&self.columns.column(j));
            }
        }
        factorise(&mut self.factor, count);
    }

    /// Has the friction of the joints that slide act with these sizes.
    pub(super) fn slide(&self, sizes: &[f64], at: &mut [Passive], motion: &mut EquationsOfMotion) {
        for (&(k, _), size) in self.bearings.iter().zip(sizes) {
            if !self.is_held(k) {
                let at = &mut at[k];
                let partials = self.rows.row(k).into_iter().copied();
                motion.exert(partials, size - at.force, at.coordinate.first());
                at.force = *size;
            }
        }
    }

    /// Writes the bounds of the friction in joints, for their reactions.
    pub(super) fn bound(&self, at: &mut [Passive]) {
        for (place, &(k, _)) in self.bearings.iter().enumerate() {
            let limit = self.joint_friction.limit(place);
            at[k].bounds = [-limit, limit];
        }
    }

    /// Adds the accelerations of the drivers to those of coordinates.
    pub(super) fn accelerate(
        &self,
        at: &mut [Passive],
        accelerations: impl Iterator<Item = f64> + Clone,
    ) {
        for (k, at) in at.iter_mut().enumerate() {
            let parts = self.rows.row(k).into_iter().zip(accelerations.clone());
            let sum: f64 = parts.map(|(partial, second)| partial * second).sum();
            at.coordinate.derivatives[1] = self.coasting[k] + sum;
        }
    }

    /// Adds changes of the freedoms' accelerations to those of coordinates; those that are held have
    /// none.
    pub(super) fn accelerate_freedoms(
        &self,
        at: &mut [Passive],
        freedoms: &[DriverId],
        changes: &[f64],
    ) {
        for (k, at) in at.iter_mut().enumerate() {
            let second = &mut at.coordinate.derivatives[1];
            if self.is_held(k) {
                *second = 0.0;
                continue;
            }
            for (freedom, change) in freedoms.iter().zip(changes) {
                *second += self.rows[(k, freedom.index())] * change;
            }
        }
    }

    /// Writes the forces that hold.
    pub(super) fn write_holding(&self, at: &mut [Passive]) {
        for (&k, &force) in self.holding.iter().zip(&self.forces) {
            at[k].force = force;
        }
    }

    /// Adds the forces that hold to the equations of motion.
    pub(super) fn exert(&self, at: &[Passive], motion: &mut EquationsOfMotion) {
        for (k, at) in at.iter().enumerate().filter(|(k, _)| self.is_held(*k)) {
            let rate = at.coordinate.first();
            motion.exert(self.rows.row(k).iter().copied(), at.force, rate);
        }
    }

    /// Finds the forces or impulses that bring value, velocity or acceleration of the held coordinates to
    /// what they are held at, and adds the changes of the freedoms that they make to `changes`, before
    /// [`ascend`].
    pub(super) fn correct(&mut self, at: &[Passive], order: Order, changes: &mut [f64]) {
        let wanted = |k: usize| match order {
            Order::Position => self.anchors[k] - at[k].coordinate.value,
            Order::Velocity => -at[k].coordinate.first(),
            Order::Acceleration => -at[k].coordinate.second(),
        };
        for (force, k) in self.forces.iter_mut().zip(&self.holding) {
            *force = wanted(*k);
        }
        self.exert_on(changes);
    }

    /// Finds the forces that make the changes that stand in their places, and adds those of the freedoms
    /// to `changes`.
    fn exert_on(&mut self, changes: &mut [f64]) {
        let forces = &mut self.forces[..self.holding.len()];
        descend(&self.factor, forces);
        ascend(&self.factor, forces);
        for (column, force) in forces.iter().enumerate() {
            let column = self.columns.column(column);
            for (change, entry) in changes.iter_mut().zip(&column) {
                *change += entry * *force;
            }
        }
    }

    /// Returns the changes of all coordinates along a direction, and writes those of forces that slide,
    /// but in joints.
    pub(super) fn changes(&self, sensitivity: &Sensitivity<'_>, changes: &mut [f64]) -> Vec<Jet> {
        let parameter = |id: ParameterId| sensitivity.parameter_value(id);
        let passive = self.list.iter().enumerate().zip(changes);
        let coordinates = passive.map(|((k, passive), change)| {
            let rate = sensitivity.rate(&*passive.relation);
            let sign = self.sliding(k, rate.value);
            *change = match passive.cause.friction() {
                Some(law) if sign != 0.0 && law.bearing.is_none() => {
                    let one = Dual::new(1.0, [0.0]);
                    law.along(&parameter, one, rate, sign).first()
                }
                _ => 0.0,
            };
            sensitivity.coordinate(&*passive.relation)
        });
        coordinates.collect()
    }

    /// Returns the changes of the friction in joints along a direction, from those of the forces where
    /// this friction stays as it is.
    pub(super) fn joint_changes(
        &mut self,
        sensitivity: &Sensitivity<'_>,
        forces: &ForceSensitivity,
    ) -> &[f64] {
        let parameter = |id: ParameterId| sensitivity.parameter_value(id);
        let rates = self.bearings.iter();
        let rates = rates.map(|(k, _)| sensitivity.rate(&*self.list[*k].relation));
        let rates: Vec<Dual> = rates.collect();
        self.joint_friction.changes(&parameter, &rates, forces)
    }

    /// Finds the changes of the forces that hold, so that held coordinates do not accelerate, where
    /// these accelerate as `coordinates` without the changes of the freedoms, L⁻¹ δQ, in `changes`;
    /// completes those.
    pub(super) fn hold_changes(
        &mut self,
        coordinates: &[Jet],
        changes: &mut [f64],
        forces: &mut [f64],
    ) {
        if !self.holds() {
            return;
        }
        for (column, &k) in self.holding.iter().enumerate() {
            let of_freedoms = self.columns.column(column);
            let of_freedoms = of_freedoms.iter().zip(&*changes).map(|(c, x)| c * x);
            self.forces[column] = -coordinates[k].second() - of_freedoms.sum::<f64>();
        }
        self.exert_on(changes);
        for (&k, &force) in self.holding.iter().zip(&self.forces) {
            forces[k] = force;
        }
    }

    /// Returns L⁻¹ (∂c/∂u)ᵀ of some forces, by columns, for L of J = L Lᵀ.
    pub(super) fn columns(
        &self,
        some: &[usize],
        freedoms: &[DriverId],
        lower: &DMatrix<f64>,
    ) -> DMatrix<f64> {
        let mut columns = DMatrix::zeros(freedoms.len(), some.len());
        for (column, &k) in some.iter().enumerate() {
            let mut to = columns.column_mut(column);
            write_column((&self.rows, k), freedoms, lower, to.as_mut_slice());
        }
        columns
    }
}

/// Writes L⁻¹ (∂c/∂u)ᵀ of a row, which has a column per driver.
fn write_column(
    (rows, row): (&DMatrix<f64>, usize),
    freedoms: &[DriverId],
    lower: &DMatrix<f64>,
    to: &mut [f64],
) {
    for (entry, freedom) in to.iter_mut().zip(freedoms) {
        *entry = rows[(row, freedom.index())];
    }
    descend(lower, to);
}

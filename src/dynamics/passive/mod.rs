//! Forces that follow from the motion: those of stops, of joints with play and of friction.
//!
//! Each acts along a coordinate c. While its [`Mode`] lasts the motion is smooth: a stop that nothing
//! touches exerts nothing, friction that slides exerts what its law says, and a stop that is touched and
//! friction that sticks hold their coordinate, c̈ = 0, by the force that this takes.
//!
//! | file | cause |
//! |---|---|
//! | `contact` | a rigid stop, the parts of a joint with play |
//! | `elastic` | an elastic stop |
//! | `friction` | friction along a coordinate or in a joint |

mod contact;
mod elastic;
mod friction;

use std::fmt::Debug;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::DMatrix;

use super::event::EventKind;
use super::function::{FUNCTIONS, Function};
use super::triangular::{ascend, descend, factorise};
use crate::kinematics::constraint::{Constraint, Incidence};
use crate::kinematics::{EquationsOfMotion, ForceSensitivity, Friction, Sensitivity, Solver};
use crate::mechanism::{
    Coordinate, DriverId, Dual, Jet, Load, Mechanism, Order, ParameterId, PassiveCause,
};
use contact::Contact;
pub(super) use contact::TOUCHED;
use friction::Rubbing;

/// Least gap, speed and acceleration that are rounding, in radians or sizes of the mechanism: some
/// hundred roundings.
pub(super) const PLACE_ROUNDING: f64 = 64.0 * f64::EPSILON;
/// A speed, or an acceleration, of so many roundings may be rest: 1e-8 radians or sizes of the mechanism
/// per second. The instant of an event is not known much better.
pub(super) const SLOW: f64 = 1e6;

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
    /// Gap, speed and acceleration that are rounding \[m or rad, and those per second\].
    pub roundings: [f64; 3],
    /// Force that is rounding \[N or N m\]. For an elastic stop: the force of its spring at the gap that is
    /// rounding. For a held coordinate: the force that makes the acceleration that is rounding.
    pub force_rounding: f64,
    /// Whether other forces hold the coordinate already, or drivers alone move it. A force that holds such a
    /// coordinate is zero.
    pub is_dependent: bool,
}

impl Passive {
    pub(super) const NONE: Self = Self {
        coordinate: Jet {
            value: 0.0,
            derivatives: [0.0; 2],
        },
        force: 0.0,
        bounds: [f64::NEG_INFINITY, f64::INFINITY],
        roundings: [0.0; 3],
        force_rounding: 0.0,
        is_dependent: false,
    };

    /// Returns the gap that is rounding \[m or rad\].
    pub(super) fn gap_rounding(&self) -> f64 {
        self.roundings[0]
    }

    /// Returns the speed that is rounding \[m/s or rad/s\].
    pub(super) fn speed_rounding(&self) -> f64 {
        self.roundings[1]
    }

    /// Returns the distance of the coordinate from a limit, which grows with it for a sign of 1.
    fn place(&self, sign: f64, limit: f64) -> Function {
        Function {
            value: sign * (self.coordinate.value - limit),
            rates: self.coordinate.derivatives.map(|rate| Some(sign * rate)),
            rounding: self.gap_rounding(),
            gap: Some(sign),
        }
    }

    /// Returns the rate of the coordinate, or its opposite for a sign of −1.
    fn speed(&self, sign: f64) -> Function {
        Function {
            value: sign * self.coordinate.first(),
            rates: [Some(sign * self.coordinate.second()), None],
            rounding: self.speed_rounding(),
            gap: None,
        }
    }

    /// Returns a force, or its distance from a limit.
    fn push(&self, value: f64) -> Function {
        Function {
            value,
            rates: [None; 2],
            rounding: self.force_rounding,
            gap: None,
        }
    }

    /// Returns the speed up to which the coordinate may rest \[m/s or rad/s\], or the acceleration up to
    /// which its rate may stay.
    pub(super) fn slow(&self, order: Order) -> f64 {
        SLOW * self.roundings[order as usize]
    }
}

/// Cause of a passive force. A contact that nothing touches and friction that is not decided yet have the
/// mode [`Mode::Free`].
pub(super) trait Cause: Debug + Send + Sync {
    /// Reads the limits of its coordinate at the solver's pose, and the force if its law says it.
    fn read(&self, solver: &Solver, mode: Mode, at: &mut Passive);

    /// Returns the limits of its coordinate at the solver's pose with their changes along a direction, along
    /// which parameters change.
    fn limits(&self, _: &Solver, _: &dyn Fn(ParameterId) -> Dual) -> [Dual; 2] {
        [f64::NEG_INFINITY, f64::INFINITY].map(Dual::constant)
    }

    /// Returns how much more it exerts in a mode than its law says at this place: where a trial step goes
    /// beyond the end of the mode.
    fn beyond_law(&self, _: &Solver, _: Mode, _: &Passive) -> f64 {
        0.0
    }

    /// Returns whether its force is a law of the coordinate, so that it is no load.
    fn has_law(&self) -> bool {
        false
    }

    /// Returns whether it holds its coordinate in a mode.
    fn holds(&self, mode: Mode) -> bool;

    /// Returns its mode at a point at which nothing holds, before that is chosen.
    fn released(&self, solver: &Solver, at: &Passive) -> Mode;

    /// Returns the sides on which a contact is touched.
    fn touched(&self, _: &Passive) -> [Option<Mode>; 2] {
        [None; 2]
    }

    /// Returns whether it is a contact, which pushes.
    fn is_contact(&self) -> bool {
        false
    }

    /// Returns its place among all friction.
    fn friction(&self) -> Option<usize> {
        None
    }

    /// Returns the part of the velocity with which a contact bounces, for these parameters.
    fn restitution(&self, _: &Mechanism, _: &dyn Fn(ParameterId) -> Dual) -> Dual {
        Dual::constant(0.0)
    }

    /// Returns a function of the motion that is positive while the mode lasts; `None` if that cannot end
    /// the mode. Each force has [`FUNCTIONS`] of them.
    fn function(&self, mode: Mode, at: &Passive, side: usize) -> Option<Function>;

    /// Returns whether the force, or the acceleration of the coordinate, is one that belongs to the mode.
    fn agrees(&self, mode: Mode, at: &Passive) -> bool;

    /// Returns the event of a change between two modes.
    fn event(&self, before: Mode, after: Mode, at: &Passive) -> Option<EventKind>;
}

/// One passive force.
#[derive(Debug)]
pub(super) struct PassiveForce {
    /// Index of the force in the mechanism.
    pub(super) index: usize,
    /// Places of the forces of its contact in the list; its own alone without one.
    pub(super) group: Range<usize>,
    pub(super) relation: Arc<dyn Constraint>,
    /// The unknowns in the relation, each once.
    pub(super) columns: Vec<usize>,
    pub(super) coordinate: Coordinate,
    pub(super) cause: Box<dyn Cause>,
}

/// The passive forces of a mechanism.
#[derive(Debug)]
pub(super) struct PassiveForces {
    /// Those without a law, then elastic stops.
    pub(super) list: Vec<PassiveForce>,
    loads: usize,
    pub(super) modes: Vec<Mode>,
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
    pub(super) friction: Friction,
    /// The forces that are friction, in its order, each with its joint if it is in one.
    pub(super) rubbing: Vec<(usize, Option<usize>)>,
}

impl PassiveForces {
    pub(super) fn new(solver: &Solver, freedoms: usize) -> Self {
        let mechanism = solver.mechanism();
        let mut frictions = 0..;
        let forces = mechanism.forces.iter().enumerate();
        let all = forces.filter_map(|(index, force)| {
            let (coordinate, cause): (_, Box<dyn Cause>) = match &force.load {
                Load::Passive { coordinate, cause } => match cause {
                    PassiveCause::Friction(_) => (coordinate, Box::new(Rubbing(frictions.next()?))),
                    PassiveCause::Stop(_) | PassiveCause::Play(_) => {
                        let is_angle = coordinate.kind.is_angle();
                        let cause = cause.clone();
                        (coordinate, Box::new(Contact { cause, is_angle }))
                    }
                },
                Load::Coordinate { coordinate, law } => {
                    let stop = law.as_ref().and_then(|law| law.stop.clone());
                    (coordinate, stop?)
                }
                Load::Marker { .. } => return None,
            };
            let relation = solver.relation_of(&force.load, coordinate);
            let mut incidence = Incidence::default();
            relation.incidence(mechanism, &mut incidence);
            let mut columns = incidence.unknowns;
            columns.sort_unstable();
            columns.dedup();
            Some(PassiveForce {
                index,
                group: 0..0,
                relation,
                columns,
                coordinate: *coordinate,
                cause,
            })
        });
        let (mut list, elastic): (Vec<_>, Vec<_>) = all.partition(|own| !own.cause.has_law());
        let loads = list.len();
        list.extend(elastic);
        for (k, own) in list.iter_mut().enumerate() {
            let elements = mechanism.elements_with(own.index);
            let first = k + elements.start - own.index;
            own.group = first..first + elements.len();
        }
        let (count, drivers) = (list.len(), mechanism.drivers.len());
        let friction = solver.friction();
        let mut rubbing: Vec<_> = list.iter().enumerate().collect();
        rubbing.retain(|(_, own)| own.cause.friction().is_some());
        let mut rubbing: Vec<(usize, Option<usize>)> =
            rubbing.into_iter().map(|(k, _)| (k, None)).collect();
        for (place, joint) in friction.joints() {
            rubbing[place].1 = Some(joint);
        }
        Self {
            coasting: vec![0.0; count],
            friction,
            rubbing,
            modes: vec![Mode::Free; count],
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

    /// Returns the places of the forces of each contact, and of each other force.
    pub(super) fn groups(&self) -> impl Iterator<Item = Range<usize>> {
        let all = self.list.iter().enumerate();
        let first = all.filter(|(k, own)| own.group.start == *k);
        first.map(|(_, own)| own.group.clone())
    }

    /// Returns the index of a force in the mechanism, of a contact that of its first element.
    pub(super) fn told(&self, force: usize) -> usize {
        self.list[self.list[force].group.start].index
    }

    /// Returns whether some coordinate is held.
    pub(super) fn holds(&self) -> bool {
        (0..self.list.len()).any(|k| self.is_held(k))
    }

    /// Returns whether a coordinate is held.
    pub(super) fn is_held(&self, force: usize) -> bool {
        self.list[force].cause.holds(self.modes[force])
    }

    /// Returns a function of a passive force at a point; `None` if it cannot end the mode.
    pub(super) fn function(&self, force: usize, at: &Passive, side: usize) -> Option<Function> {
        self.list[force].cause.function(self.modes[force], at, side)
    }

    /// Returns whether there are gaps at a point.
    pub(super) fn has_gaps(&self, at: &[Passive]) -> bool {
        let all = at.iter().enumerate();
        let mut functions = all.flat_map(|(force, at)| {
            (0..FUNCTIONS).filter_map(move |side| self.function(force, at, side))
        });
        functions.any(|function| function.gap.is_some())
    }

    /// Reads coordinates and their partial derivatives at the solver's pose, where the equations of motion
    /// are evaluated. Friction is still to be [rubbed](Self::rub).
    pub(super) fn begin(
        &mut self,
        solver: &Solver,
        motion: &mut EquationsOfMotion,
        point: &mut [Passive],
    ) {
        self.friction.set_parameters(&solver.pose().parameters);
        for (k, (passive, to)) in self.list.iter().zip(point).enumerate() {
            let relation = &*passive.relation;
            to.coordinate = solver.coordinate(relation, motion.coasting());
            self.coasting[k] = to.coordinate.second();
            for driver in 0..self.rows.ncols() {
                let unit = motion.unit(DriverId(driver));
                self.rows[(k, driver)] = solver.coordinate(relation, unit).first();
            }
            let is_angle = passive.coordinate.kind.is_angle();
            let least = PLACE_ROUNDING * if is_angle { 1.0 } else { solver.size() };
            let own = solver.coordinate_roundings(relation, motion.coasting());
            to.roundings = own.map(|rounding| rounding.max(least));
            (to.force, to.force_rounding) = (0.0, 0.0);
            to.is_dependent = false;
            let mode = self.modes[k];
            passive.cause.read(solver, mode, to);
            let more = passive.cause.beyond_law(solver, mode, to);
            if more != 0.0 {
                let partials = self.rows.row(k).into_iter().copied();
                motion.exert(partials, more, to.coordinate.first());
            }
            if let Some(place) = passive.cause.friction() {
                self.friction
                    .set_motion(place, to.coordinate.first(), mode.sign());
            }
        }
    }

    /// Prepares the forces that hold, for L of J = L Lᵀ, and finds the sliding friction whose coordinate
    /// other forces hold.
    pub(super) fn prepare(
        &mut self,
        freedoms: &[DriverId],
        lower: &DMatrix<f64>,
        at: &mut [Passive],
    ) {
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
        for (column, &k) in self.holding.iter().enumerate() {
            at[k].force_rounding = at[k].roundings[2] / self.factor[(column, column)];
        }
        factorise(&mut self.factor, count);
        for (column, &k) in self.holding.iter().enumerate() {
            at[k].is_dependent = self.factor[(column, column)].is_infinite();
        }
        for place in 0..self.rubbing.len() {
            let (k, _) = self.rubbing[place];
            if !self.is_held(k) {
                at[k].is_dependent = self.is_held_by_others(k, freedoms, lower);
            }
        }
    }

    /// Returns whether a coordinate depends on held coordinates alone, so that it rests with them.
    fn is_held_by_others(&mut self, k: usize, freedoms: &[DriverId], lower: &DMatrix<f64>) -> bool {
        /// Part of a row that is rounding, beside bodies of very different masses.
        const DEPENDENT_ROW: f64 = 1e-6;
        let count = self.holding.len();
        let (columns, mut own) = self.columns.columns_range_pair_mut(..count, count);
        write_column((&self.rows, k), freedoms, lower, own.as_mut_slice());
        let parts = &mut self.forces[..count];
        for (part, column) in parts.iter_mut().zip(columns.column_iter()) {
            *part = column.dot(&own);
        }
        descend(&self.factor, parts);
        ascend(&self.factor, parts);
        let row = self.rows.row(k);
        let largest = row.amax();
        (0..row.len()).all(|driver| {
            let held = self.holding.iter().zip(&*parts);
            let of_held = held.map(|(&k, part)| part * self.rows[(k, driver)]);
            (row[driver] - of_held.sum::<f64>()).abs() <= DEPENDENT_ROW * largest
        })
    }

    /// Has the friction that slides act with these sizes, in its order.
    pub(super) fn rub(&self, sizes: &[f64], at: &mut [Passive], motion: &mut EquationsOfMotion) {
        for (&(k, _), size) in self.rubbing.iter().zip(sizes) {
            if !self.is_held(k) {
                let at = &mut at[k];
                let partials = self.rows.row(k).into_iter().copied();
                motion.exert(partials, size - at.force, at.coordinate.first());
                at.force = *size;
            }
        }
    }

    /// Writes the bounds of the friction that sticks, in joints for their reactions.
    pub(super) fn bound(&self, at: &mut [Passive]) {
        for (place, &(k, _)) in self.rubbing.iter().enumerate() {
            let limit = self.friction.limit(place);
            at[k].bounds = [-limit, limit];
        }
    }

    /// Returns the change of the bound of a friction along a direction.
    pub(super) fn bound_change(
        &self,
        force: usize,
        parameter: &impl Fn(ParameterId) -> Dual,
        forces: &ForceSensitivity,
    ) -> f64 {
        let place = self.rubbing.iter().position(|(k, _)| *k == force);
        place.map_or(0.0, |place| {
            self.friction.limit_change(place, parameter, forces)
        })
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

    /// Adds changes of the freedoms' accelerations to those of coordinates; those that are held by their
    /// own force have none.
    pub(super) fn accelerate_freedoms(
        &self,
        at: &mut [Passive],
        freedoms: &[DriverId],
        changes: &[f64],
    ) {
        for (k, at) in at.iter_mut().enumerate() {
            let second = &mut at.coordinate.derivatives[1];
            if self.is_held(k) && !at.is_dependent {
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

    /// Returns the changes of all coordinates along a direction, and writes those of friction, that in
    /// joints from those of the forces where it stays as it is: without these it does.
    pub(super) fn changes(
        &mut self,
        sensitivity: &Sensitivity<'_>,
        forces: Option<&ForceSensitivity>,
        changes: &mut [f64],
    ) -> Vec<Jet> {
        let Self {
            list,
            friction,
            rubbing,
            ..
        } = self;
        let parameter = |id: ParameterId| sensitivity.parameter_value(id);
        let rates = rubbing.iter();
        let rates = rates.map(|(k, _)| sensitivity.rate(&*list[*k].relation));
        let rates: Vec<Dual> = rates.collect();
        let of_friction = friction.changes(&parameter, &rates, forces);
        for ((k, _), change) in rubbing.iter().zip(of_friction) {
            changes[*k] = *change;
        }
        let coordinates = list.iter();
        let coordinates = coordinates.map(|own| sensitivity.coordinate(&*own.relation));
        coordinates.collect()
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

//! Bounds of the numbers in the equations while parameters move.
//!
//! Parameters run straight along the path. Each number in the equations is enclosed over a
//! sub-step as a function of the place on it, 0 at its start and 1 at its end, with two
//! derivatives. So numbers bend the equations as unknowns do: by an eighth of a second derivative
//! between ends at which the equations hold. A number with a corner deviates from its chord by no
//! more than a quarter of the range of its first derivative. One that is as steep as a root at zero,
//! or made of parts that jump together, does so by no more than its own range; over a sub-step of
//! the smallest length this lies between its values at both ends.

use std::ops::Add;

use nalgebra::Vector2;

use crate::kinematics::constraint::configuration::{CamProfile, Configuration};
use crate::kinematics::constraint::moving_configuration::{
    Bodies, Enclosed, EnclosedCurves, VariedConfiguration, VariedMechanism, bend, evaluate,
};
use crate::kinematics::constraint::{Constraint, CoreMotion, Dimension, partial};
use crate::kinematics::path::Path;
use crate::kinematics::system::{Equation, EquationTarget, System, Targets};
use crate::kinematics::tolerances::SMALLEST_SUBSTEP;
use crate::mechanism::{
    Coordinate, DriverId, Expression, Interval, Joint, Marker, MarkerId, Mechanism, MotionInForce,
    MovingProfile, Number, ParameterId, ShapeId,
};

/// Largest deviation of a number or a prescribed motion that is not known to be continuous, in
/// radians and characteristic lengths; a motion that jumps by more is refused where it jumps.
pub(in crate::kinematics) const LARGEST_JUMP: f64 = 0.1;
/// Part of a path in which a number that is not known to be continuous counts as lying between its
/// values at both ends: the smallest sub-steps are less than twice [`SMALLEST_SUBSTEP`].
pub(in crate::kinematics) const PASSED_AT_ONCE: f64 = 2.0 * SMALLEST_SUBSTEP;
/// Change of each parameter up to which that holds as well, in units of the parameter, or of its
/// magnitude where that is more: parts of a number jump together within some roundings, from which a
/// short path may not lead away. Halved or doubled, it is still many roundings, and no motion.
const PASSED_BY_ROUNDING: f64 = 1e-12;

/// Bounds of the numbers in the equations over a sub-step.
#[derive(Debug, Default)]
pub(in crate::kinematics) struct ParameterBounds {
    /// Whether parameters move.
    pub(in crate::kinematics) moving: bool,
    /// All parameters as functions of the place on the sub-step, and space for the next ones.
    local: Vec<Enclosed>,
    next: Vec<Enclosed>,
    /// The motions with these parameters; `None` for an input.
    motions: Vec<Option<MotionInForce<Enclosed>>>,
    /// The profiles along the sub-step, and at rest anywhere on it.
    profiles: [Vec<MovingProfile>; 2],
    /// The laws of couplings, likewise.
    laws: [Vec<MotionInForce<Enclosed>>; 2],
    /// Those that move, or that differ from the sub-step before: numbers without them stay as they
    /// are.
    changed: Vec<bool>,
    /// The mechanism along the sub-step: its numbers, and the chords of unknowns.
    along: VariedConfiguration<Enclosed>,
    /// The mechanism at rest anywhere on the sub-step, and in a region around it.
    around: VariedConfiguration<Enclosed>,
    markers: Vec<MarkerChange>,
    rows: Vec<Row>,
    /// The drivers' values at the start of the sub-step \[m or rad\].
    pub(in crate::kinematics) drivers_before: Vec<f64>,
}

/// The changes of a marker in its body's frame.
#[derive(Clone, Copy, Debug, Default)]
struct MarkerChange {
    /// s at the start of the sub-step less s at its end \[m\].
    start: Vector2<f64>,
    position: Change,
    angle: Change,
    /// Whether an equation contains the marker.
    is_used: bool,
}

/// A row and the numbers in it.
#[derive(Debug)]
struct Row {
    /// All parameters in it.
    parameters: Vec<ParameterId>,
    /// Whether one of them moves.
    moves: bool,
    /// Change of its target, zero for drivers \[m or rad\].
    target: Change,
    /// Largest deviation of its value if that is not known to be continuous \[m or rad\].
    largest_jump: f64,
}

/// Bounds of the difference of a number or vector from its value at the end of a sub-step, and of
/// its first two derivatives with respect to the place on the sub-step; at a corner, of those of its
/// chord, and eight times the distance from there.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::kinematics) struct Change {
    pub(in crate::kinematics) value: f64,
    pub(in crate::kinematics) first: f64,
    pub(in crate::kinematics) second: f64,
}

impl Change {
    /// Bounds the change of components in quadrature; infinite if one of them may jump by more than
    /// `largest_jump`.
    fn of<const N: usize>(
        components: [Enclosed; N],
        in_force: [f64; N],
        largest_jump: f64,
    ) -> Self {
        let mut change = Self::default();
        for (component, in_force) in components.into_iter().zip(in_force) {
            let value = (component.value - Interval::point(in_force)).magnitude();
            let first = component.first().magnitude();
            // The slope of the chord.
            let first = if first.is_finite() {
                first
            } else {
                2.0 * value
            };
            change.value = change.value.hypot(value);
            change.first = change.first.hypot(first);
            change.second = (change.second).hypot(bend_within(&component, largest_jump));
        }
        change
    }

    /// Returns the change of a vector in the ground frame that changes so in the frame of a body
    /// which turns evenly by `turn`.
    pub(in crate::kinematics) fn turning(self, turn: f64) -> Self {
        let turn = turn.abs();
        Self {
            value: self.value,
            first: self.first + turn * self.value,
            second: self.second + turn * (2.0 * self.first + turn * self.value),
        }
    }

    /// Returns the change of a unit vector whose direction changes so in the frame of such a body.
    pub(in crate::kinematics) fn of_direction(self, turn: f64) -> Self {
        let mut change = self.turning(turn);
        change.second += self.first * self.first;
        change
    }

    /// Returns the change of a vector that is `length` times as long.
    pub(in crate::kinematics) fn scaled(self, length: f64) -> Self {
        Self {
            value: length * self.value,
            first: length * self.first,
            second: length * self.second,
        }
    }

    /// Bounds the deviation of such a vector from its chord.
    pub(in crate::kinematics) fn deviation(self, turn: f64) -> f64 {
        0.125 * self.turning(turn).second
    }

    fn is_finite(self) -> bool {
        (self.value + self.first + self.second).is_finite()
    }
}

impl Add for Change {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }
}

/// Returns the [bend](bend()) of a quantity, infinite if it may jump by more than `largest_jump`.
fn bend_within(quantity: &Enclosed, largest_jump: f64) -> f64 {
    let Interval { low, high } = quantity.value;
    if quantity.first().is_finite() || high - low <= largest_jump {
        bend(quantity)
    } else {
        f64::INFINITY
    }
}

/// Returns whether a number counts as lying between its values at both ends of a part of a path.
fn is_passed_at_once(path: &Path, [start, end]: [f64; 2]) -> bool {
    let mut ends = path.from.iter().zip(&path.to);
    let unit = |from: f64, to: f64| 1.0_f64.max(from.abs()).max(to.abs());
    end - start <= PASSED_AT_ONCE
        || ends.all(|(from, to)| {
            (to - from).abs() * (end - start) <= PASSED_BY_ROUNDING * unit(*from, *to)
        })
}

/// Returns the bounds of a number over a part of the path that is passed at once: between its values
/// at both ends, unless it is known to be continuous. Those of a wider part stay.
fn between_ends(
    number: Enclosed,
    is_passed_at_once: bool,
    ends: impl FnOnce() -> [f64; 2],
) -> Enclosed {
    if !is_passed_at_once || number.first().is_finite() {
        return number;
    }
    let [from, to] = ends().map(Enclosed::constant);
    from.either(to)
}

/// Returns whether each marker is in an equation.
fn used_markers(mechanism: &Mechanism) -> Vec<bool> {
    let mut used = vec![false; mechanism.markers.len()];
    let held = mechanism.constraints.iter().map(|held| &held.coordinate);
    let driven = mechanism.drivers.iter().map(|driver| &driver.coordinate);
    let coordinates = held.chain(driven).flat_map(Coordinate::markers);
    let joints = mechanism.joints.iter().flat_map(Joint::markers);
    for marker in coordinates.chain(joints) {
        used[marker.index()] = true;
    }
    used
}

/// Returns s of a marker for these parameters.
fn evaluated(marker: &Marker, parameters: &[f64]) -> Vector2<f64> {
    let [x, y] = marker.position.each_ref().map(|s| s.value(parameters));
    Vector2::new(x, y)
}

impl ParameterBounds {
    /// Makes the storage; a mechanism without parameters needs next to none.
    pub(super) fn new(system: &System) -> Self {
        let mechanism = system.mechanism();
        let parameters = mechanism.parameters.len();
        let drivers_before = vec![0.0; mechanism.drivers.len()];
        if parameters == 0 {
            return Self {
                drivers_before,
                ..Self::default()
            };
        }
        let equations = system.equations().iter().enumerate();
        let rows = equations.map(|(row, equation)| {
            let mut parameters = system.incidence(row).parameters;
            parameters.extend_from_slice(&equation.parameters);
            if let EquationTarget::Constant(target) = &equation.target {
                parameters.extend(target.parameters());
            }
            Row {
                parameters,
                moves: false,
                target: Change::default(),
                largest_jump: 0.0,
            }
        });
        let markers = used_markers(mechanism)
            .into_iter()
            .map(|is_used| MarkerChange {
                is_used,
                ..MarkerChange::default()
            });
        let drivers = mechanism.drivers.iter();
        let motions = drivers.map(|driver| Some(MotionInForce::new(driver.motion()?, parameters)));
        Self {
            moving: false,
            local: vec![Enclosed::constant(0.0); parameters],
            next: vec![Enclosed::constant(0.0); parameters],
            motions: motions.collect(),
            profiles: [(); 2].map(|()| system.moving_profiles()),
            laws: [(); 2].map(|()| system.laws()),
            changed: vec![false; parameters],
            along: system.varied(),
            around: system.varied(),
            markers: markers.collect(),
            rows: rows.collect(),
            drivers_before,
        }
    }

    /// Returns the change of a marker's point in its body's frame \[m\].
    pub(in crate::kinematics) fn position(&self, marker: MarkerId) -> Change {
        self.markers[marker.index()].position
    }

    /// Returns the change of a marker's angle \[rad\].
    pub(in crate::kinematics) fn angle(&self, marker: MarkerId) -> Change {
        self.markers[marker.index()].angle
    }

    /// Returns the point of a marker at the start of the sub-step less that at its end, in the
    /// frame of its body \[m\].
    pub(in crate::kinematics) fn start(&self, marker: MarkerId) -> Vector2<f64> {
        self.markers[marker.index()].start
    }

    /// Returns whether a number in a row moves.
    pub(in crate::kinematics) fn moves(&self, row: usize) -> bool {
        self.moving && self.rows[row].moves
    }

    /// Returns the change of a row's target, and the largest deviation that may be a jump.
    pub(in crate::kinematics) fn change_of(&self, row: usize) -> (Change, f64) {
        (self.rows[row].target, self.rows[row].largest_jump)
    }

    /// Returns the change of a row's target; zero for a driver's \[m or rad\].
    pub(in crate::kinematics) fn target(&self, row: usize) -> Change {
        self.rows[row].target
    }

    /// Bounds all numbers over a part of `path`, at whose start the parameters are `before` and at
    /// whose end they are `now`, in force in `at` and `targets`. Returns false if a number is not
    /// bounded. Allocates nothing.
    #[inline(never)]
    pub(in crate::kinematics) fn bound(
        &mut self,
        system: &System,
        (at, targets): (&Configuration, &Targets),
        [before, now]: [&[f64]; 2],
        path: &Path,
        part: [f64; 2],
    ) -> bool {
        let mechanism = system.mechanism();
        let is_passed_at_once = is_passed_at_once(path, part);
        self.move_parameters(mechanism, [before, now], path, part);
        let Self {
            local,
            changed,
            along,
            around,
            markers,
            rows,
            ..
        } = self;
        let changed = |p: ParameterId| changed[p.index()];
        let number = |expression: &Expression| {
            let ends = || [before, now].map(|end| expression.value(end));
            between_ends(evaluate(expression, local), is_passed_at_once, ends)
        };
        let changed_number = |expression: &Expression| {
            let mut used = expression.parameters();
            used.any(changed).then(|| number(expression))
        };
        system.vary_numbers(along, &changed_number);
        around.rest_at_numbers_of(along);
        let largest_move = LARGEST_JUMP * at.size();
        let mut finite = true;
        for (index, change) in markers.iter_mut().enumerate() {
            let marker = &mechanism.markers[index];
            let mut used = marker.numbers().flat_map(Expression::parameters);
            if change.is_used && used.any(changed) {
                let id = MarkerId(index);
                let (point, turned) = at.local(id);
                let (position, angle) = along.local(id);
                change.start = evaluated(marker, before) - point;
                change.position = Change::of(position, [point.x, point.y], largest_move);
                change.angle = Change::of([angle], [turned], LARGEST_JUMP);
            }
            finite &= change.position.is_finite() && change.angle.is_finite();
        }
        let rows = rows.iter_mut().zip(system.equations());
        for (index, (row, equation)) in rows.enumerate() {
            row.moves = row.parameters.iter().any(|p| local[p.index()].varies());
            row.largest_jump = match equation.constraint.dimension() {
                Dimension::Length => LARGEST_JUMP * equation.size(at),
                Dimension::Angle => LARGEST_JUMP,
            };
            if let EquationTarget::Constant(target) = &equation.target
                && target.parameters().any(changed)
            {
                let in_force = [targets.constant(index)];
                row.target = Change::of([number(target)], in_force, row.largest_jump);
            }
            finite &= row.target.is_finite();
        }
        finite
    }

    /// Lets parameters, motions and profiles move along a part of `path`, from one list of values
    /// to the other.
    fn move_parameters(
        &mut self,
        mechanism: &Mechanism,
        [before, after]: [&[f64]; 2],
        path: &Path,
        [start, end]: [f64; 2],
    ) {
        let value = |s: f64, from: f64, to: f64| if s < 1.0 { from + s * (to - from) } else { to };
        let h = Interval::point(end) - Interval::point(start);
        let mut now = std::mem::take(&mut self.next);
        let branches = path.from.iter().zip(&path.to);
        for (parameter, (&from, &to)) in now.iter_mut().zip(branches) {
            let ends = [value(start, from, to), value(end, from, to)];
            let range = Interval::new(ends[0].min(ends[1]), ends[0].max(ends[1]));
            let slope = (Interval::point(to) - Interval::point(from)) * h;
            *parameter = Enclosed::linear(range, slope);
        }
        mechanism.derive_parameters(&mut now);
        let is_passed_at_once = is_passed_at_once(path, [start, end]);
        for (now, (from, to)) in now.iter_mut().zip(before.iter().zip(after)) {
            *now = between_ends(*now, is_passed_at_once, || [*from, *to]);
        }
        for ((local, changed), now) in self.local.iter_mut().zip(&mut self.changed).zip(&now) {
            *changed = now.varies() || now != local;
            *local = *now;
        }
        self.next = now;
        let local = |p: ParameterId| self.local[p.index()];
        for motion in self.motions.iter_mut().flatten() {
            motion.set_parameters(local);
        }
        let [along, around] = &mut self.profiles;
        for (along, around) in along.iter_mut().zip(around) {
            along.set_parameters(local);
            around.set_parameters(|p| Enclosed::fixed(local(p).value));
        }
        let [along, around] = &mut self.laws;
        for (along, around) in along.iter_mut().zip(around) {
            along.set_parameters(local);
            around.set_parameters(|p| Enclosed::fixed(local(p).value));
        }
    }

    /// Encloses a driver's prescribed motion over the sub-step, on which time runs as `t`; see
    /// [`MotionInForce::enclose`].
    pub(in crate::kinematics) fn motion(&self, driver: DriverId, t: Enclosed) -> Option<Enclosed> {
        let motion = self.motions[driver.index()].as_ref();
        motion.and_then(|motion| motion.enclose(t))
    }

    /// Lets an unknown run straight between these values; in the region it deviates from there by
    /// up to `radius`.
    pub(in crate::kinematics) fn set_chord(&mut self, column: usize, ends: [f64; 2], radius: f64) {
        let [from, to] = ends;
        let way = Interval::new(from.min(to), from.max(to));
        let slope = Interval::point(to) - Interval::point(from);
        self.along
            .set_coordinate(column, Enclosed::linear(way, slope));
        let region = way + Interval::new(-radius, radius);
        self.around.set_coordinate(column, Enclosed::fixed(region));
    }

    /// Bounds the [bend](bend()) of c − target of a row along the chords of its unknowns. `None`
    /// without a bound. A linear row needs no chords.
    pub(in crate::kinematics) fn bend(
        &self,
        row: usize,
        equation: &Equation,
        profiles: &[CamProfile],
    ) -> Option<f64> {
        let row = &self.rows[row];
        let along = self.bend_along(&*equation.constraint, profiles, row.largest_jump);
        let bend = along + row.target.second;
        bend.is_finite().then_some(bend)
    }

    /// Bounds the [bend](bend()) of a relation along the chords of its unknowns; infinite without a
    /// bound, and where it may jump by more than `largest_jump`.
    pub(in crate::kinematics) fn bend_along(
        &self,
        relation: &dyn Constraint,
        profiles: &[CamProfile],
        largest_jump: f64,
    ) -> f64 {
        let mechanism = VariedMechanism {
            bodies: &self.along,
            curves: EnclosedCurves {
                in_force: profiles,
                moving: &self.profiles[0],
                laws: &self.laws[0],
            },
        };
        let enclosed: Enclosed = relation.along(&mechanism);
        bend_within(&enclosed, largest_jump)
    }

    /// Bounds the motion of a shape's core on its body while parameters move. A place on an arc keeps its
    /// part of the arc's angle, which moves with the ends.
    pub(in crate::kinematics) fn core_motion(&self, shape: ShapeId) -> CoreMotion {
        let mut motion = CoreMotion::default();
        if !self.moving {
            return motion;
        }
        let size = |of: fn(&Enclosed) -> Interval, numbers: &[Enclosed]| {
            let sizes = numbers.iter().map(|number| of(number).magnitude());
            sizes.sum::<f64>()
        };
        let first = |number: &Enclosed| number.first();
        let second = |number: &Enclosed| number.second();
        for k in 0..self.along.features(shape) {
            let feature = self.along.feature(shape, k);
            let of_ends = |of| size(of, &feature.ends[0]).max(size(of, &feature.ends[1]));
            let own = |of| size(of, &feature.center) + size(of, &[feature.radius]);
            let mut way = own(first) + of_ends(first);
            let mut bend = own(second) + of_ends(second);
            let radius = feature.radius.value;
            if !feature.radius.is_zero() && way > 0.0 {
                bend += way * way / radius.low.max(0.0);
                way += size(first, &feature.center);
            }
            motion.way = motion.way.max(way);
            motion.bend = motion.bend.max(bend);
        }
        motion.bend += self.along.core_radius(shape).second().magnitude();
        motion
    }

    /// Bounds the [bend](bend()) of a number; infinite where it may jump.
    pub(in crate::kinematics) fn bend_of(&self, number: &Expression) -> f64 {
        bend_within(&evaluate(number, &self.local), 0.0)
    }

    /// Encloses the derivative of a relation by an unknown in the region around the chords.
    pub(in crate::kinematics) fn partial(
        &mut self,
        relation: &dyn Constraint,
        profiles: &[CamProfile],
        column: usize,
    ) -> Interval {
        let curves = EnclosedCurves {
            in_force: profiles,
            moving: &self.profiles[1],
            laws: &self.laws[1],
        };
        partial(relation, &mut self.around, curves, column)
    }
}

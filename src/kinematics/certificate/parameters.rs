//! Bounds of the numbers in the equations while parameters move.
//!
//! Parameters run straight along the path. Each number in the equations is enclosed over a
//! sub-step as a function of the place on it, 0 at its start and 1 at its end, with two
//! derivatives. So numbers bend the equations as unknowns do: by an eighth of a second derivative
//! between ends at which the equations hold.

use std::ops::Add;

use nalgebra::Vector2;

use crate::kinematics::configuration::{CamProfile, Configuration};
use crate::kinematics::constraint::partial;
use crate::kinematics::path::Path;
use crate::kinematics::system::{Equation, System, Target, Targets};
use crate::kinematics::variation::{Enclosed, VariedConfiguration, VariedMechanism, evaluate};
use crate::mechanism::{Expression, Interval, Marker, MarkerId, Number, ParameterId};

/// Bounds of the numbers in the equations over a sub-step.
#[derive(Debug, Default)]
pub(in crate::kinematics) struct ParameterBounds {
    /// Whether parameters move.
    pub(in crate::kinematics) moving: bool,
    /// All parameters as functions of the place on the path.
    pub(in crate::kinematics) parameters: Vec<Enclosed>,
    /// The same as functions of the place on the sub-step, and at rest anywhere on it.
    local: Vec<Enclosed>,
    resting: Vec<Enclosed>,
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
}

/// Bounds of the difference of a number or vector from its value at the end of a sub-step, and of
/// its first two derivatives with respect to the place on the sub-step.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::kinematics) struct Change {
    pub(in crate::kinematics) value: f64,
    pub(in crate::kinematics) first: f64,
    pub(in crate::kinematics) second: f64,
}

impl Change {
    /// Bounds the change of components in quadrature.
    fn of<const N: usize>(components: [Enclosed; N], in_force: [f64; N]) -> Self {
        let mut change = Self::default();
        for (component, in_force) in components.into_iter().zip(in_force) {
            let value = (component.value - Interval::point(in_force)).magnitude();
            change.value = change.value.hypot(value);
            change.first = change.first.hypot(component.first().magnitude());
            change.second = change.second.hypot(component.second().magnitude());
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
            if let Target::Constant(target) = &equation.target {
                parameters.extend(target.parameters());
            }
            Row {
                parameters,
                moves: false,
                target: Change::default(),
            }
        });
        Self {
            moving: false,
            parameters: vec![Enclosed::constant(0.0); parameters],
            local: vec![Enclosed::constant(0.0); parameters],
            resting: vec![Enclosed::constant(0.0); parameters],
            changed: vec![false; parameters],
            along: system.varied(),
            around: system.varied(),
            markers: vec![MarkerChange::default(); mechanism.markers.len()],
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

    /// Returns the change of a row's target; zero for a driver's \[m or rad\].
    pub(in crate::kinematics) fn target(&self, row: usize) -> Change {
        self.rows[row].target
    }

    /// Bounds all numbers over a part of `path`, at whose start the parameters are `before` and at
    /// whose end those in `at` and `targets`. Returns false if a number is not bounded. Allocates nothing.
    #[inline(never)]
    pub(in crate::kinematics) fn bound(
        &mut self,
        system: &System,
        (at, targets): (&Configuration, &Targets),
        before: &[f64],
        path: &Path,
        [start, end]: [f64; 2],
    ) -> bool {
        let mechanism = system.mechanism();
        let value = |s: f64, from: f64, to: f64| if s < 1.0 { from + s * (to - from) } else { to };
        let branches = path.from.iter().zip(&path.to);
        for (parameter, (&from, &to)) in self.parameters.iter_mut().zip(branches) {
            let ends = [value(start, from, to), value(end, from, to)];
            let range = Interval::new(ends[0].min(ends[1]), ends[0].max(ends[1]));
            *parameter = Enclosed::linear(range, Interval::point(to) - Interval::point(from));
        }
        mechanism.derive_parameters(&mut self.parameters);
        let h = Interval::point(end) - Interval::point(start);
        let locals = self.local.iter_mut().zip(&mut self.resting);
        let locals = locals.zip(&mut self.changed).zip(&self.parameters);
        for (((local, resting), changed), parameter) in locals {
            let now = Enclosed::new(
                parameter.value,
                [
                    parameter.first() * h,
                    parameter.second() * h.square(),
                    parameter.third() * h.cube(),
                ],
            );
            *changed = now.varies() || now != *local;
            *local = now;
            *resting = Enclosed::fixed(now.value);
        }
        system.vary_parameters(&mut self.along, &self.local, Some(&self.changed));
        system.vary_parameters(&mut self.around, &self.resting, Some(&self.changed));
        let local = &self.local;
        let changed = |p: ParameterId| self.changed[p.index()];
        let mut finite = true;
        for (index, change) in self.markers.iter_mut().enumerate() {
            let marker = &mechanism.markers[index];
            let mut used = marker.numbers().flat_map(Expression::parameters);
            if used.any(changed) {
                let id = MarkerId(index);
                let (point, turned) = at.local(id);
                let (position, angle) = self.along.local(id);
                *change = MarkerChange {
                    start: evaluated(marker, before) - point,
                    position: Change::of(position, [point.x, point.y]),
                    angle: Change::of([angle], [turned]),
                };
            }
            finite &= change.position.is_finite() && change.angle.is_finite();
        }
        let rows = self.rows.iter_mut().zip(system.equations());
        for (index, (row, equation)) in rows.enumerate() {
            row.moves = row.parameters.iter().any(|p| local[p.index()].varies());
            if let Target::Constant(target) = &equation.target
                && target.parameters().any(changed)
            {
                let target = evaluate(target, local);
                row.target = Change::of([target], [targets.constant(index)]);
            }
            finite &= row.target.is_finite();
        }
        finite
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

    /// Bounds the second derivative of c − target of a row along the chords of its unknowns. `None`
    /// without a bound, as for a contour that parameters move. A linear row needs no chords.
    pub(in crate::kinematics) fn bend(
        &self,
        row: usize,
        equation: &Equation,
        profiles: &[CamProfile],
    ) -> Option<f64> {
        let moves = |p: &ParameterId| self.local[p.index()].varies();
        if equation.constraint.has_contour() && equation.parameters.iter().any(moves) {
            return None;
        }
        let mechanism = VariedMechanism {
            bodies: &self.along,
            profiles,
        };
        let enclosed: Enclosed = equation.constraint.along(&mechanism);
        let bend = enclosed.second().magnitude() + self.rows[row].target.second;
        bend.is_finite().then_some(bend)
    }

    /// Encloses the derivative of a relation by an unknown in the region around the chords.
    pub(in crate::kinematics) fn partial(
        &mut self,
        equation: &Equation,
        profiles: &[CamProfile],
        column: usize,
    ) -> Interval {
        partial(&*equation.constraint, &mut self.around, profiles, column)
    }
}

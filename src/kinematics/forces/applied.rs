//! Springs, dampers, actuators and loads.

use std::sync::Arc;

use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::constraint::{Constraint, Gradient, of_coordinate};
use crate::kinematics::error::Error;
use crate::kinematics::system::System;
use crate::mechanism::{
    BeyondPoints, BodyId, Coordinate, CoordinateKind, Corner, Expression, ForceLaw, Load, MarkerId,
    Mechanism, Number, ParameterId, Signal, Variable,
};

/// The forces of a mechanism, ready to be evaluated.
#[derive(Debug)]
pub(super) struct AppliedForces {
    pub(super) list: Vec<AppliedForce>,
    /// Coordinates elsewhere on which the sizes depend.
    pub(super) seen: Vec<Seen>,
    /// Sources of the mechanism's inputs.
    pub(super) sources: Vec<Source>,
    /// Value and rate of each.
    seen_values: Vec<[f64; 2]>,
    /// Arguments of functions with corners or jumps, at the last pose.
    pub(super) corners: Vec<Corner>,
    /// Work space.
    gradient: Gradient,
}

/// A coordinate on which the sizes of forces depend.
#[derive(Debug)]
pub(super) struct Seen {
    pub(super) signal: Signal,
    pub(super) relation: Box<dyn Constraint>,
}

/// One force.
#[derive(Debug)]
pub(super) struct AppliedForce {
    pub(super) place: ActsAt,
    /// Index of its first load among all [`loads`](super::Forces::loads), if it has no law.
    pub(super) input: Option<usize>,
    /// Whether functions have corners or jumps in its size.
    has_corners: bool,
    /// Value and rate of its coordinate at the last pose, not numbers at a marker.
    coordinate: [f64; 2],
}

/// Place of a force.
#[derive(Debug)]
pub(super) enum ActsAt {
    /// Along a coordinate.
    Coordinate(Arc<dyn Constraint>),
    /// At a marker, along the axes of another one or of ground.
    Marker(MarkerId, Option<MarkerId>),
}

/// The numbers on which the sizes of forces depend, apart from the coordinates.
pub(super) struct Circumstances<'a, N, P> {
    pub(super) parameter: &'a P,
    pub(super) time: N,
    /// All loads.
    pub(super) inputs: &'a [N],
    /// Sources of the mechanism's inputs.
    pub(super) sources: &'a [Source],
    /// Coordinates elsewhere, with value and rate.
    pub(super) seen: &'a [Seen],
    pub(super) seen_values: &'a [[N; 2]],
}

impl<N: Number, P: Fn(ParameterId) -> N> Circumstances<'_, N, P> {
    /// Returns the value of a variable that is no coordinate of the force itself.
    fn variable(&self, which: Variable) -> N {
        match which {
            Variable::Time => self.time,
            Variable::Signal(signal, order) => {
                let mut all = self.seen.iter().zip(self.seen_values);
                let found = all.find(|(seen, _)| seen.signal == signal);
                found.map_or_else(N::unknown, |(_, values)| values[order as usize])
            }
            Variable::Input(index) => match &self.sources[index] {
                Source::Load(place) => self.inputs[*place],
                Source::Given(size) => size.evaluate(self.parameter, self.time),
            },
            _ => N::unknown(),
        }
    }

    /// Returns the value of a variable of a force with this value and rate of its coordinate.
    fn variable_at(&self, [position, velocity]: [N; 2], which: Variable) -> N {
        match which {
            Variable::Position => position,
            Variable::Velocity => velocity,
            other => self.variable(other),
        }
    }
}

/// Source of an input of the mechanism.
#[derive(Debug)]
pub(super) enum Source {
    /// A load, by its place.
    Load(usize),
    /// An expression in t and the parameters.
    Given(Expression),
}

impl AppliedForce {
    /// Returns the size of a force along a coordinate with this value and rate, and the potential
    /// energy of its springs.
    pub(super) fn along<N: Number, P: Fn(ParameterId) -> N>(
        &self,
        law: Option<&ForceLaw>,
        coordinate: [N; 2],
        around: &Circumstances<'_, N, P>,
    ) -> [N; 2] {
        let zero = N::constant(0.0);
        let Some(law) = law else {
            return [self.input.map_or(zero, |first| around.inputs[first]), zero];
        };
        let variable = |which| around.variable(which);
        let size = law.evaluate(around.parameter, &variable, coordinate);
        let mut energy = law.spring.as_ref().map_or(zero, |spring| {
            let [stiffness, extension] = spring.evaluate(around.parameter, coordinate[0]);
            stiffness * extension.square() * 0.5
        });
        if let (true, Some(value)) = (law.is_constant, &law.value) {
            energy -= value.evaluate(around.parameter, zero) * coordinate[0];
        }
        if let Some(stop) = &law.stop {
            energy += stop.energy(around.parameter, coordinate[0]);
        }
        [size, energy]
    }

    /// Returns the components of a force at a marker and its torque.
    pub(super) fn at_marker<N: Number, P: Fn(ParameterId) -> N>(
        &self,
        law: Option<&[crate::mechanism::Expression; 3]>,
        around: &Circumstances<'_, N, P>,
    ) -> [N; 3] {
        match (law, self.input) {
            (Some(law), _) => law.each_ref().map(|component| {
                let variable = |which| around.variable(which);
                component.evaluate_at(around.parameter, &variable)
            }),
            (None, Some(first)) => [0, 1, 2].map(|k| around.inputs[first + k]),
            (None, None) => [N::constant(0.0); 3],
        }
    }
}

/// Returns the force and the torque about the body's origin of a force at the end of an `arm`, with
/// components along the x-axis `axis`.
pub(super) fn about_origin<N: Number>(
    [fx, fy, torque]: [N; 3],
    [ux, uy]: [N; 2],
    arm: [N; 2],
) -> [N; 3] {
    let (x, y) = (ux * fx - uy * fy, uy * fx + ux * fy);
    [x, y, torque + arm[0] * y - arm[1] * x]
}

/// Returns the body on which a force at a marker acts, with the force and the torque about its
/// origin; `None` on ground.
pub(super) fn on_body(
    size: [f64; 3],
    at: &Configuration,
    marker: MarkerId,
    axes: Option<MarkerId>,
) -> Option<(BodyId, [f64; 3])> {
    let marker = at.marker(marker);
    let axis = axes.map_or([1.0, 0.0], |axes| at.marker(axes).axis.into());
    Some((marker.body?, about_origin(size, axis, marker.arm.into())))
}

/// Returns whether a force acts along the distance of two markers, which is below its rounding error: any
/// direction is possible.
pub(super) fn is_at_zero(load: &Load, at: &Configuration) -> bool {
    /// Roundings of a point: its body's origin and angle, which Newton–Raphson leaves with two or
    /// three, the sine and cosine, and the sum.
    const POINT_ROUNDINGS: f64 = 8.0;
    let coordinate = load.coordinate().filter(|_| load.play().is_none());
    let Some(Coordinate { from, to, .. }) =
        coordinate.filter(|own| own.kind == CoordinateKind::Distance)
    else {
        return false;
    };
    let [from, to] = [*from, *to].map(|marker| at.marker(marker));
    let size = [from, to].map(|marker| marker.point.norm() + marker.arm.norm());
    (to.point - from.point).norm() <= POINT_ROUNDINGS * f64::EPSILON * (size[0] + size[1])
}

impl AppliedForces {
    pub(super) fn new(system: &System) -> Self {
        let mechanism = system.mechanism();
        let ([of_inputs, of_forces], _) = mechanism.load_places();
        let inputs = mechanism.inputs.iter().zip(of_inputs);
        let sources = inputs.map(|(input, place)| match (place, &input.given) {
            (Some(place), _) => Source::Load(place),
            (None, given) => Source::Given(given.clone().expect("it is given")),
        });
        let forces = mechanism.forces.iter().zip(of_forces);
        let list = forces.map(|(force, input)| AppliedForce {
            place: match &force.load {
                Load::Coordinate { coordinate, .. } | Load::Passive { coordinate, .. } => {
                    ActsAt::Coordinate(system.relation_of(&force.load, coordinate))
                }
                Load::Marker { marker, axes, .. } => ActsAt::Marker(*marker, *axes),
            },
            input,
            has_corners: force.load.moving_expressions().any(Expression::has_corners),
            coordinate: [f64::NAN; 2],
        });
        let seen = seen(mechanism);
        Self {
            sources: sources.collect(),
            list: list.collect(),
            seen_values: vec![[0.0; 2]; seen.len()],
            seen,
            corners: Vec::new(),
            gradient: Gradient::new(),
        }
    }

    /// Subtracts all forces from what bodies demand, one entry per unknown, and writes their sizes.
    /// Returns the potential energy of all springs. Allocates nothing unless it fails.
    ///
    /// # Errors
    ///
    /// [`Error::NoForce`] for a force without direction or finite size.
    pub(super) fn apply<P: Fn(ParameterId) -> f64>(
        &mut self,
        mechanism: &Mechanism,
        at: &Configuration,
        q_dot: &[f64],
        (parameter, time, inputs): (&P, f64, &[f64]),
        sizes: &mut [[f64; 3]],
        demand: &mut [f64],
    ) -> Result<f64, Error> {
        let mut energy = 0.0;
        for (Seen { relation, .. }, values) in self.seen.iter().zip(&mut self.seen_values) {
            self.gradient.clear();
            let value = relation.value_and_gradient(at, &mut self.gradient);
            *values = [value, self.gradient.dot(q_dot)];
        }
        self.corners.clear();
        let around = &Circumstances {
            parameter,
            time,
            inputs,
            sources: &self.sources,
            seen: &self.seen,
            seen_values: &self.seen_values,
        };
        let list = self.list.iter_mut().zip(&mechanism.forces);
        for ((applied, definition), size) in list.zip(sizes) {
            let fault = |reason| {
                Err(Error::NoForce {
                    force: definition.name.clone(),
                    reason,
                })
            };
            match (&applied.place, &definition.load) {
                (ActsAt::Coordinate(relation), Load::Coordinate { .. } | Load::Passive { .. }) => {
                    let law = definition.load.law();
                    let value = relation.value(at);
                    if is_at_zero(&definition.load, at)
                        && !law.is_some_and(|law| law.is_through_zero(parameter))
                    {
                        return fault("has no direction: the distance of its markers is zero");
                    }
                    self.gradient.clear();
                    relation.gradient(at, &mut self.gradient);
                    let coordinate = [value, self.gradient.dot(q_dot)];
                    applied.coordinate = coordinate;
                    if applied.has_corners {
                        note_corners(&definition.load, coordinate, around, &mut self.corners);
                    }
                    let [force, stored] = applied.along(law, coordinate, around);
                    if !(force + stored).is_finite() {
                        return fault("has no finite value here");
                    }
                    *size = [force, 0.0, 0.0];
                    energy += stored;
                    for (column, partial) in self.gradient.entries() {
                        demand[column] -= force * partial;
                    }
                }
                (ActsAt::Marker(marker, axes), Load::Marker { law, .. }) => {
                    *size = applied.at_marker(law.as_ref(), around);
                    if applied.has_corners {
                        let none = [f64::NAN; 2];
                        note_corners(&definition.load, none, around, &mut self.corners);
                    }
                    if !size.iter().sum::<f64>().is_finite() {
                        return fault("has no finite value here");
                    }
                    if let Some((body, force)) = on_body(*size, at, *marker, *axes) {
                        let k = 3 * body.index();
                        for (demand, force) in demand[k..k + 3].iter_mut().zip(force) {
                            *demand -= force;
                        }
                    }
                }
                _ => unreachable!("places are made of these definitions"),
            }
        }
        Ok(energy)
    }

    /// Shows `meet` the functions that sizes of forces have called beyond their points, at the pose of the
    /// last application. Allocates nothing.
    pub(super) fn visit_beyond<P: Fn(ParameterId) -> f64>(
        &self,
        mechanism: &Mechanism,
        (parameter, time, inputs): (&P, f64, &[f64]),
        meet: &mut dyn FnMut(BeyondPoints),
    ) {
        if mechanism.functions.list().is_empty() {
            return;
        }
        let around = &Circumstances {
            parameter,
            time,
            inputs,
            sources: &self.sources,
            seen: &self.seen,
            seen_values: &self.seen_values,
        };
        for (applied, definition) in self.list.iter().zip(&mechanism.forces) {
            let variable = |which| around.variable_at(applied.coordinate, which);
            for expression in definition.load.moving_expressions() {
                expression.visit_beyond(parameter, &variable, meet);
            }
        }
    }
}

/// Adds the arguments of functions with corners or jumps in the size of a force.
fn note_corners<P: Fn(ParameterId) -> f64>(
    load: &Load,
    coordinate: [f64; 2],
    around: &Circumstances<'_, f64, P>,
    corners: &mut Vec<Corner>,
) {
    let variable = |which| around.variable_at(coordinate, which);
    for expression in load.moving_expressions() {
        let parameter = around.parameter;
        expression.visit_corners(parameter, &variable, &mut |corner| corners.push(corner));
    }
}

/// Returns the coordinates of the signals on which sizes of forces depend, each once.
fn seen(mechanism: &Mechanism) -> Vec<Seen> {
    let mut seen: Vec<Seen> = Vec::new();
    for (signal, _) in mechanism
        .forces
        .iter()
        .flat_map(|force| force.load.signals())
    {
        if seen.iter().any(|known| known.signal == signal) {
            continue;
        }
        let coordinate = match signal {
            Signal::Measure(index) => &mechanism.measures[index].coordinate,
            Signal::Motion(driver) => mechanism.drivers[driver.index()].named(),
            Signal::Body(..) | Signal::Marker(..) => {
                unreachable!("the reader admits coordinates alone")
            }
        };
        let relation = of_coordinate(coordinate);
        seen.push(Seen { signal, relation });
    }
    seen
}

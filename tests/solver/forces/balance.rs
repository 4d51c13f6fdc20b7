//! Free bodies: Newton's and Euler's laws for each body of every shipped mechanism, with all forces
//! on it, each by the textbook's rule for its joint.
//!
//! Together with the directions in which a joint cannot exert a force, which are tested too, the
//! laws determine all reactions.

use std::sync::Arc;

use biela::kinematics::{ForceQuantity, Reported};
use biela::mechanism::{
    Body, BodyId, CamFollower, Coordinate, CoordinateKind, DriverId, Expression, Joint, JointKind,
    Load, MarkerId, Mechanism, Pulley, PulleySide, Rope, RopePoint,
};
use nalgebra::{Rotation2, Vector2};

use crate::common::stems;
use crate::forces::loaded::{Loaded, loaded};

/// Error of a balance relative to the largest force in it and to the condition: a few rounding
/// errors for each of the digits that the condition loses.
const ROUNDING: f64 = 1e-14;

/// Force and torque about ground's origin on each body.
struct Balance<'a> {
    loaded: &'a Loaded,
    sums: Vec<[f64; 3]>,
    largest: f64,
}

impl Balance<'_> {
    fn mechanism(&self) -> &Mechanism {
        self.loaded.solver.mechanism()
    }

    fn body(&self, marker: MarkerId) -> Option<BodyId> {
        self.mechanism().markers[marker.index()].body
    }

    fn phi(&self, body: Option<BodyId>) -> f64 {
        body.map_or(0.0, |body| {
            self.loaded.solver.pose().q[3 * body.index() + 2]
        })
    }

    fn point(&self, marker: MarkerId) -> Vector2<f64> {
        let [x, y] = self.loaded.solver.marker(marker, &self.loaded.rates);
        Vector2::new(x.value, y.value)
    }

    /// The x-axis of a marker.
    fn axis(&self, marker: MarkerId) -> Vector2<f64> {
        let parameters = &self.loaded.solver.pose().parameters;
        let angle = &self.mechanism().markers[marker.index()].angle;
        let own = angle.evaluate(&|p| parameters[p.index()], 0.0);
        Rotation2::new(self.phi(self.body(marker)) + own) * Vector2::x()
    }

    fn add(&mut self, body: Option<BodyId>, at: Vector2<f64>, force: Vector2<f64>, torque: f64) {
        self.largest = self.largest.max(force.norm()).max(torque.abs());
        if let Some(body) = body {
            let sum = &mut self.sums[body.index()];
            sum[0] += force.x;
            sum[1] += force.y;
            sum[2] += torque + at.perp(&force);
        }
    }

    /// Adds an effort along a coordinate.
    fn add_effort(&mut self, coordinate: &Coordinate, effort: f64) {
        let Coordinate {
            kind,
            from,
            to,
            axes,
        } = *coordinate;
        let (i, j) = (self.point(from), self.point(to));
        let (body_i, body_j) = (self.body(from), self.body(to));
        let u = self.axis(axes);
        let direction = match kind {
            CoordinateKind::Angle => {
                self.add(body_j, j, Vector2::zeros(), effort);
                self.add(body_i, i, Vector2::zeros(), -effort);
                return;
            }
            CoordinateKind::X => u,
            CoordinateKind::Y => Vector2::new(-u.y, u.x),
            CoordinateKind::Distance => (j - i).normalize(),
            CoordinateKind::Clearance(..) => unreachable!("a clearance has no force"),
        };
        self.add(body_j, j, direction * effort, 0.0);
        self.add(body_i, i, -direction * effort, 0.0);
        // The two forces make a couple unless they are in line: the third body closes it.
        let couple = -(j - i).perp(&(direction * effort));
        if kind != CoordinateKind::Distance {
            self.add(self.body(axes), i, Vector2::zeros(), couple);
        }
    }

    fn value(&self, quantity: ForceQuantity) -> f64 {
        self.loaded.forces.value(quantity)
    }

    /// Adds what a joint exerts on its bodies.
    fn add_joint(&mut self, index: usize, joint: &Joint) {
        let (i, j) = (self.body(joint.from), self.body(joint.to));
        let at = self.point(joint.to);
        let (force, torque) = self.reaction(index);
        if let JointKind::Rope(rope) = &joint.kind {
            return self.add_rope(rope, force.x);
        }
        if let JointKind::Coupling(equation) = &joint.kind {
            for (place, (_, coordinate)) in equation.coordinates.iter().enumerate() {
                let effort = self.value(ForceQuantity::Share(index, place));
                self.add_effort(coordinate, effort);
            }
            return;
        }
        let (JointKind::Gear { sizes, carrier, .. } | JointKind::Belt { sizes, carrier, .. }) =
            &joint.kind
        else {
            self.add(j, at, force, torque);
            self.add(i, at, -force, -torque);
            return;
        };
        let parameters = &self.loaded.solver.pose().parameters;
        let [first, second] = sizes
            .expressions()
            .each_ref()
            .map(|size: &Expression| size.evaluate(&|p| parameters[p.index()], 0.0));
        let same_sense = match joint.kind {
            JointKind::Gear { internal, .. } => internal,
            JointKind::Belt { crossed, .. } => !crossed,
            _ => unreachable!(),
        };
        let k = if same_sense {
            first / second
        } else {
            -first / second
        };
        for (body, torque) in [
            (j, torque),
            (i, -k * torque),
            (*carrier, (k - 1.0) * torque),
        ] {
            self.add(body, at, Vector2::zeros(), torque);
        }
    }

    /// Adds the pulls of a rope along its tangents, at the points at which it leaves its pulleys.
    fn add_rope(&mut self, rope: &Rope, tension: f64) {
        let parameters = self.loaded.solver.pose().parameters.clone();
        let number = |e: &Expression| e.evaluate(&|p| parameters[p.index()], 0.0);
        let circle = |balance: &Self, point: &RopePoint| {
            let radius = |pulley: &Pulley| match pulley.side {
                PulleySide::Left => number(&pulley.radius),
                PulleySide::Right => -number(&pulley.radius),
            };
            let radius = point.pulley.as_ref().map_or(0.0, radius);
            (balance.point(point.marker), radius)
        };
        for (pair, part) in rope.points.windows(2).zip(&rope.parts) {
            let ((p, r), (q, s)) = (circle(self, &pair[0]), circle(self, &pair[1]));
            // The normal of both circles is inclined to the line of their centres.
            let inclined = ((s - r) / (q - p).norm()).acos();
            let normal = Rotation2::new(inclined) * (q - p).normalize();
            let (start, end) = (p - normal * r, q - normal * s);
            let pull = (end - start).normalize() * number(part) * tension;
            self.add(self.body(pair[0].marker), start, pull, 0.0);
            self.add(self.body(pair[1].marker), end, -pull, 0.0);
        }
    }

    /// Returns the force and the torque of a joint on the body of its second marker.
    fn reaction(&self, joint: usize) -> (Vector2<f64>, f64) {
        let [x, y, torque] = [0, 1, 2].map(|k| self.value(ForceQuantity::Reaction(joint, k)));
        (Vector2::new(x, y), torque)
    }

    /// Returns what a joint exerts where it cannot: its torque, and its force along the direction
    /// in which it is free.
    fn impossible(&self, index: usize, joint: &Joint) -> [f64; 2] {
        let (force, torque) = self.reaction(index);
        let across = |axis: Vector2<f64>| Vector2::new(-axis.y, axis.x);
        let free = match &joint.kind {
            JointKind::Slot
            | JointKind::RevoluteTranslational { .. }
            | JointKind::Translational => Some(self.axis(joint.from)),
            JointKind::Link { .. } => Some(across(self.point(joint.to) - self.point(joint.from))),
            JointKind::Cam {
                follower: CamFollower::Flat,
                ..
            } => Some(self.axis(joint.to)),
            // Along the teeth there is a force.
            JointKind::RackAndPinion { .. } => Some(across(self.axis(joint.to))),
            _ => None,
        };
        let along = free.map_or(0.0, |free| free.normalize().dot(&force));
        let has_torque = Reported::of(&joint.kind).has(2);
        [if has_torque { 0.0 } else { torque }, along]
    }

    /// Adds the efforts of drivers and constraints, and all forces of the file.
    fn add_applied(&mut self) {
        let mechanism = Arc::clone(self.loaded.solver.mechanism());
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            let effort = self.value(ForceQuantity::Effort(DriverId(index)));
            self.add_effort(&driver.coordinate, effort);
        }
        for (index, constraint) in mechanism.constraints.iter().enumerate() {
            self.add_effort(
                &constraint.coordinate,
                self.value(ForceQuantity::Held(index)),
            );
        }
        for (index, force) in mechanism.forces.iter().enumerate() {
            let [x, y, torque] = [0, 1, 2].map(|k| self.value(ForceQuantity::Applied(index, k)));
            match &force.load {
                Load::Coordinate { coordinate, .. } | Load::Passive { coordinate, .. } => {
                    self.add_effort(coordinate, x);
                }
                Load::Marker { marker, axes, .. } => {
                    let axis = axes.map_or(Vector2::x(), |axes| self.axis(axes));
                    let across = Vector2::new(-axis.y, axis.x);
                    let (body, at) = (self.body(*marker), self.point(*marker));
                    self.add(body, at, axis * x + across * y, torque);
                }
            }
        }
    }

    /// Adds weight and inertia of a body: Newton's and Euler's laws.
    fn add_inertia(&mut self, index: usize, body: &Body) {
        let pose = self.loaded.solver.pose();
        let of = |e: &Expression| e.evaluate(&|p| pose.parameters[p.index()], 0.0);
        let gravity = self.mechanism().simulation.gravity.each_ref().map(of);
        let k = 3 * index;
        let rates = &self.loaded.rates;
        let (v, a) = (rates.velocity(), rates.acceleration());
        let (omega, alpha) = (v[k + 2], a[k + 2]);
        let center = body.center.as_ref().expect("it has one");
        let [x, y] = center.each_ref().map(of);
        let arm = Rotation2::new(pose.q[k + 2]) * Vector2::new(x, y);
        let center = Vector2::new(pose.q[k], pose.q[k + 1]) + arm;
        let across = Vector2::new(-arm.y, arm.x);
        let acceleration = Vector2::new(a[k], a[k + 1]) + across * alpha - arm * omega * omega;
        let mass = of(body.mass.as_ref().expect("it has one"));
        let inertia = of(body.inertia.as_ref().expect("it has one"));
        let force = (acceleration - Vector2::from(gravity)) * mass;
        self.add(Some(BodyId(index)), center, -force, -inertia * alpha);
    }
}

#[test]
fn every_body_is_in_balance() {
    for name in stems("mechanisms", "toml") {
        let mut mechanism = loaded(&name);
        mechanism.outputs.indeterminate = biela::mechanism::Indeterminate::MinimumNorm;
        check(&name, Loaded::new(mechanism));
    }
}

fn check(name: &str, mut loaded: Loaded) {
    let rcond = loaded.solver.rcond();
    let mechanism = Arc::clone(loaded.solver.mechanism());
    let mut balance = Balance {
        loaded: &loaded,
        sums: vec![[0.0; 3]; mechanism.bodies.len()],
        largest: 0.0,
    };
    for (index, joint) in mechanism.joints.iter().enumerate() {
        balance.add_joint(index, joint);
        let (force, torque) = balance.reaction(index);
        // A part of the mechanism's own lengths [m]: torques next to forces.
        let slack = 1e-12 / rcond * (force.norm() + torque.abs());
        let impossible = balance.impossible(index, joint);
        assert!(
            impossible.iter().all(|part| part.abs() <= slack),
            "{name}.{}: torque and force {impossible:?}",
            joint.name
        );
    }
    balance.add_applied();
    for (index, body) in mechanism.bodies.iter().enumerate() {
        balance.add_inertia(index, body);
    }
    let limit = ROUNDING / rcond * balance.largest * (1.0 + mechanism.bodies.len() as f64);
    for (body, sum) in mechanism.bodies.iter().zip(&balance.sums) {
        for component in sum {
            assert!(
                component.abs() <= limit,
                "{name}.{}: {sum:?} of {}",
                body.name,
                balance.largest
            );
        }
    }
}

//! The transmission angle.
//!
//! Let the two sides of a joint come apart at unit speed, with all drivers and other joints held.
//! The points of the joint then move at speeds of at most 1/sin μ over all directions of the gap;
//! or, which is the same by virtual work, a unit force on one of these points loads the joint with
//! 1/sin μ at most:
//!
//! sin μ = min over joints and both of their points P of 1 / ‖P_q Φ_q⁺ e‖,
//!
//! with the largest singular value for ‖ ‖, the columns of e the unit gaps of the joint's rows, P_q
//! the derivative of its point by q, and Φ_q⁺ the inverse of the Jacobian or, with redundant rows,
//! its pseudo-inverse. For a dyad of two links μ is the angle between them, for a link that pushes a
//! slide the angle between the link and the normal of the guide, for a cam the complement of the
//! pressure angle. At a dead point μ = 0: its null vector moves the point of a joint that transmits force
//! there, because otherwise no force would do work on the bend of the motion.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix2, Vector2};

use crate::kinematics::constraint::configuration::{Configuration, MarkerPose, perp};
use crate::kinematics::constraint::{Axis, Gradient, Relation, point_velocity};
use crate::kinematics::linear::{dot, nan_or_larger, subtract};
use crate::kinematics::origin::Origin;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::plan::{BlockSolver, JacobianFactors};
use crate::kinematics::state::State;
use crate::kinematics::system::System;
use crate::mechanism::{BodyId, CoordinateKind, MarkerId};

/// Distance of a sine from 1 that is rounding: the angle has half of its digits there.
const RIGHT: f64 = 1e-12;

/// A joint that transmits force at points.
#[derive(Clone, Copy, Debug)]
enum Passage {
    /// Points of two markers that coincide, by these rows.
    Point([usize; 2], [MarkerId; 2]),
    /// Points of two markers at a distance.
    Bar(usize, [MarkerId; 2]),
    /// A line of action that passes through a marker or, on a flat face, beside it.
    Line(usize, MarkerId),
    /// A point of the second marker's body on a curve of the first one's, by its two rows.
    Curve([usize; 2], [MarkerId; 2]),
    /// A rope, by its row; its pulls on each body together have a line of action.
    Rope(usize),
}

/// The joints of a mechanism that transmit force.
#[derive(Debug)]
pub(super) struct Passages(Vec<Passage>);

impl Passages {
    /// Lists the joints of a mechanism that has a loop or a group of bodies that are solved
    /// together; all others transmit nothing.
    pub(super) fn new(compiled: &CompiledMechanism) -> Self {
        let system = &compiled.system;
        let mechanism = system.mechanism();
        let is_group = |block: &BlockSolver| {
            !matches!(
                block,
                BlockSolver::PinnedBody(_) | BlockSolver::ExplicitUnknown(_)
            )
        };
        let kinds = mechanism.constraints.iter().map(|held| &held.coordinate);
        let kinds = kinds.chain(mechanism.drivers.iter().map(|driver| &driver.coordinate));
        let cylinders = kinds.filter(|own| own.kind == CoordinateKind::Distance);
        let has_loop = mechanism.joints.len() + cylinders.count() > mechanism.bodies.len();
        if !has_loop && !compiled.plan.blocks.iter().any(is_group) {
            return Self(Vec::new());
        }
        let rows = 0..system.equations().len();
        Self(rows.filter_map(|row| passage(system, row)).collect())
    }

    /// Returns the smallest transmission angle at the pose \[rad\], `None` without any joint.
    pub(super) fn smallest(&self, compiled: &CompiledMechanism, state: &mut State) -> Option<f64> {
        if self.0.is_empty() {
            return None;
        }
        let mut factors = state.take_factors(compiled);
        let system = &compiled.system;
        let sine = match factors.factorise(system, &state.at) {
            Ok(()) => {
                let mut response = Response::new(compiled, &state.at, &mut factors);
                let speeds = self.0.iter().map(|passage| response.fastest(passage));
                // Infinite speeds, or such that are not numbers, are those of a singular pose.
                let fastest = speeds.fold(1.0, nan_or_larger);
                if fastest.is_finite() {
                    1.0 / fastest
                } else {
                    0.0
                }
            }
            Err(_) => 0.0,
        };
        state.keep_factors(compiled, factors);
        Some(if sine > 1.0 - RIGHT {
            FRAC_PI_2
        } else {
            sine.asin()
        })
    }
}

/// Returns the joint whose first row, or row of force, this is.
fn passage(system: &System, row: usize) -> Option<Passage> {
    let equations = system.equations();
    let equation = &equations[row];
    match Relation::of(&*equation.constraint) {
        Relation::Coincidence(x) => match Relation::of(&*equations.get(row + 1)?.constraint) {
            Relation::Coincidence(y) if (x.axis, y.axis) == (Axis::X, Axis::Y) => {
                Some(Passage::Point([row, row + 1], [x.from, x.to]))
            }
            _ => None,
        },
        Relation::Distance(d) => Some(Passage::Bar(row, [d.from, d.to])),
        Relation::Projection(p) => Some(Passage::Line(row, p.to)),
        Relation::Angle(_) => None,
        Relation::Other => {
            let Origin::Joint(joint) = equation.origin else {
                return None;
            };
            let joint = &system.mechanism().joints[joint];
            if joint.rope().is_some() {
                return Some(Passage::Rope(row));
            }
            if joint.curve().is_some() {
                let before = row.checked_sub(1).map(|before| equations[before].origin);
                let is_first = before != Some(equation.origin);
                let markers = [joint.from, joint.to];
                return is_first.then_some(Passage::Curve([row, row + 1], markers));
            }
            // The last row of a cam holds the distance of the two parts.
            let next = equations.get(row + 1).map(|next| next.origin);
            let is_contact = joint.cam().is_some() && next != Some(equation.origin);
            is_contact.then_some(Passage::Line(row, joint.to))
        }
    }
}

/// The motion that gaps of joints bring about.
struct Response<'a> {
    system: &'a System,
    at: &'a Configuration,
    factors: &'a mut JacobianFactors,
    /// Forces that redundant rows let bodies exert on each other, scaled, orthonormal.
    self_stresses: Vec<Vec<f64>>,
    side: Vec<f64>,
    q_dot: Vec<f64>,
}

impl<'a> Response<'a> {
    fn new(
        compiled: &'a CompiledMechanism,
        at: &'a Configuration,
        factors: &'a mut JacobianFactors,
    ) -> Self {
        let system = &compiled.system;
        let (rows, unknowns) = (system.equations().len(), system.unknowns());
        let mut self_stresses: Vec<Vec<f64>> = Vec::new();
        for &row in &compiled.redundant.now {
            let mut side = vec![0.0; unknowns];
            for (column, partial) in factors.gradient(row).entries() {
                side[column] -= partial;
            }
            let mut stress = vec![0.0; rows];
            factors.solve_transposed(system, at, &mut side, &mut stress);
            stress[row] = 1.0;
            for (entry, equation) in stress.iter_mut().zip(system.equations()) {
                *entry /= equation.row_scale(at);
            }
            // Twice, which leaves rounding only.
            for other in self_stresses.iter().chain(&self_stresses) {
                let part = dot(&stress, other);
                subtract(&mut stress, part, other);
            }
            let norm = dot(&stress, &stress).sqrt();
            stress.iter_mut().for_each(|entry| *entry /= norm);
            self_stresses.push(stress);
        }
        Self {
            system,
            at,
            factors,
            self_stresses,
            side: vec![0.0; rows],
            q_dot: vec![0.0; unknowns],
        }
    }

    /// Solves for the rates of q that open a row at unit speed; those nearest to it in the sense of
    /// least squares if redundant rows forbid that.
    fn open(&mut self, row: usize) -> &[f64] {
        let Self {
            system,
            at,
            factors,
            self_stresses,
            side,
            q_dot,
        } = self;
        side.fill(0.0);
        side[row] = 1.0;
        let scale = |row: usize| system.equations()[row].row_scale(at);
        for stress in &*self_stresses {
            let part = stress[row] * scale(row);
            for (other, (entry, stress)) in side.iter_mut().zip(stress).enumerate() {
                *entry -= part * stress / scale(other);
            }
        }
        factors.solve(system, at, side, q_dot);
        q_dot
    }

    /// Returns the largest speed of the points of a joint for unit speeds of its gap.
    fn fastest(&mut self, passage: &Passage) -> f64 {
        match *passage {
            Passage::Point(rows, markers) => {
                let poses = markers.map(|marker| self.at.marker(marker));
                self.fastest_of(rows, poses)
            }
            Passage::Curve(rows, markers) => {
                let [mut from, to] = markers.map(|marker| self.at.marker(marker));
                // The point of the first body that is at the contact.
                from.arm += to.point - from.point;
                self.fastest_of(rows, [from, to])
            }
            Passage::Bar(row, markers) => {
                let [from, to] = markers.map(|marker| self.at.marker(marker));
                let along = to.point - from.point;
                let along = along.try_normalize(0.0).unwrap_or_else(Vector2::x);
                let q_dot = self.open(row);
                let speeds = [from, to].map(|pose| point_velocity(pose, q_dot));
                // The ends of the bar itself follow across it.
                let [from, to] = speeds.map(|speed| speed * along.transpose());
                let one = Matrix2::identity();
                largest_of(&[from, to, from + one, to - one])
            }
            Passage::Line(row, marker) => {
                let point = self.at.marker(marker).point;
                self.fastest_on_lines(row, |_| point)
            }
            Passage::Rope(row) => {
                let (system, at) = (self.system, self.at);
                let mut ropes = system.ropes();
                let rope = ropes
                    .find(|(joint, _)| system.equations()[row].origin == Origin::Joint(*joint));
                let (_, rope) = rope.expect("the row of a rope");
                self.fastest_on_lines(row, |body| {
                    let mut markers = rope.markers();
                    let own = markers.find(|&m| at.marker(m).body.map(BodyId::index) == Some(body));
                    own.map_or(at.frames()[body].origin, |marker| at.marker(marker).point)
                })
            }
        }
    }

    /// Returns the largest speed of two points for unit speeds of the gap of two rows in any direction.
    fn fastest_of(&mut self, rows: [usize; 2], points: [MarkerPose; 2]) -> f64 {
        let mut speeds = [Matrix2::zeros(); 2];
        for (axis, row) in rows.into_iter().enumerate() {
            let q_dot = self.open(row);
            for (speed, &pose) in speeds.iter_mut().zip(&points) {
                speed.set_column(axis, &point_velocity(pose, q_dot));
            }
        }
        largest_of(&speeds)
    }

    /// Returns the largest speed of the feet, on the lines of action of the forces that a row exerts
    /// on bodies, of the points that `point` returns for them, times the force.
    fn fastest_on_lines(&mut self, row: usize, point: impl Fn(usize) -> Vector2<f64>) -> f64 {
        let mut gradient = Gradient::new();
        let constraint = &self.system.equations()[row].constraint;
        constraint.gradient(self.at, &mut gradient);
        let at = self.at;
        let q_dot = self.open(row);
        let mut largest = 0.0;
        for &(body, [x, y, moment]) in gradient.bodies() {
            let force = Vector2::new(x, y);
            let square = force.norm_squared();
            if square > 0.0 {
                let arm = point(body) - at.frames()[body].origin;
                let torque = moment - arm.perp(&force);
                let arm = arm - perp(force) * (torque / square);
                let [vx, vy, omega] = [0, 1, 2].map(|k| q_dot[3 * body + k]);
                let speed = (Vector2::new(vx, vy) + perp(arm) * omega).norm();
                largest = nan_or_larger(largest, speed * square.sqrt());
            }
        }
        largest
    }
}

/// Returns the largest singular value of some matrices.
fn largest_of(matrices: &[Matrix2<f64>]) -> f64 {
    let largest = |m: &Matrix2<f64>| {
        let turning = f64::hypot(m.m11 + m.m22, m.m21 - m.m12);
        let mirroring = f64::hypot(m.m11 - m.m22, m.m21 + m.m12);
        0.5 * (turning + mirroring)
    };
    matrices.iter().map(largest).fold(0.0, nan_or_larger)
}

//! Force and torque that a joint exerts on the body of its second marker.

use std::any::Any;
use std::sync::Arc;

use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::constraint::{Constraint, Coupling, Gradient};
use crate::kinematics::origin::Origin;
use crate::kinematics::system::{System, opens_towards};
use crate::mechanism::{BearingShape, BodyId, Joint, Mechanism, Number, Reported};

/// The sum of the generalized forces that rows exert on a joint's second body, or on ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wrench<N> {
    /// The second marker's body.
    body: Option<BodyId>,
    /// Force, and torque about the body's origin or ground's.
    sum: [N; 3],
}

impl<N: Number> Wrench<N> {
    pub(super) fn new(body: Option<BodyId>) -> Self {
        Self {
            body,
            sum: [N::constant(0.0); 3],
        }
    }

    /// Adds the force at an unknown, λ times an entry of a row; `origin` returns x and y of a body.
    ///
    /// Rows that bodies and ground move together leave unchanged exert nothing on all of them
    /// together: ground bears the opposite of all others.
    pub(super) fn add(
        &mut self,
        column: usize,
        force: N,
        bodies: usize,
        origin: impl Fn(usize) -> [N; 2],
    ) {
        let (body, component) = (column / 3, column % 3);
        if body >= bodies {
            return;
        }
        match self.body {
            Some(own) if own.index() == body => self.sum[component] += force,
            Some(_) => {}
            None => {
                self.sum[component] -= force;
                let [x, y] = origin(body);
                match component {
                    0 => self.sum[2] += y * force,
                    1 => self.sum[2] -= x * force,
                    _ => {}
                }
            }
        }
    }

    /// Returns the force and the torque about the second marker's point; `arm` leads there from the
    /// body's origin, or ground's.
    pub(super) fn about(self, arm: [N; 2]) -> [N; 3] {
        let [fx, fy, torque] = self.sum;
        [fx, fy, torque - (arm[0] * fy - arm[1] * fx)]
    }
}

/// The rows of joints and constraints, and the reactions that λ makes.
#[derive(Debug)]
pub(super) struct ReactionRows {
    /// Rows of each joint.
    pub(super) joints: Vec<Vec<usize>>,
    /// Revolute joints with their two rows, whose λ are the force: their entries at the point of the
    /// second marker are one.
    pins: Vec<(usize, [usize; 2])>,
    /// The other joints.
    others: Vec<usize>,
    /// Those of them that are couplings.
    couplings: Vec<usize>,
    /// The forces that a joint exerts besides those of its rows, by the joint: along its relation if it has
    /// play, and friction on the pins of a link or a roller, which they bear as well.
    pub(super) more: Vec<Vec<OwnForce>>,
    /// Row of each constraint.
    pub(super) constraints: Vec<usize>,
    /// Row of each driver.
    pub(super) drivers: Vec<usize>,
}

/// A force of a joint along a relation that is no row.
#[derive(Debug)]
pub(super) struct OwnForce {
    /// Index of the force in the mechanism.
    pub(super) force: usize,
    pub(super) relation: Arc<dyn Constraint>,
}

impl ReactionRows {
    pub(super) fn new(system: &System) -> Self {
        let mechanism = system.mechanism();
        let mut rows = Self {
            joints: vec![Vec::new(); mechanism.joints.len()],
            pins: Vec::new(),
            others: Vec::new(),
            couplings: Vec::new(),
            more: mechanism.joints.iter().map(|_| Vec::new()).collect(),
            constraints: vec![0; mechanism.constraints.len()],
            drivers: vec![0; mechanism.drivers.len()],
        };
        for (row, equation) in system.equations().iter().enumerate() {
            match equation.origin {
                Origin::Joint(joint) => rows.joints[joint].push(row),
                Origin::Constraint(held) => rows.constraints[held] = row,
                Origin::Driver(driver) => rows.drivers[driver.index()] = row,
            }
        }
        for (joint, definition) in mechanism.joints.iter().enumerate() {
            match rows.joints[joint][..] {
                [x, y] if definition.is_pin() => rows.pins.push((joint, [x, y])),
                _ => rows.others.push(joint),
            }
            if definition.equation().is_some() {
                rows.couplings.push(joint);
            }
        }
        for (force, definition) in mechanism.forces.iter().enumerate() {
            let load = &definition.load;
            let pin = load.slides();
            let pin = pin.filter(|own| matches!(own.shape, BearingShape::Pin { .. }));
            if let (Some(joint), Some(coordinate)) =
                (load.play().or_else(|| Some(pin?.joint)), load.coordinate())
            {
                let relation = system.relation_of(load, coordinate);
                rows.more[joint].push(OwnForce { force, relation });
            }
        }
        rows
    }

    /// Returns the couplings: the index of the joint, its row and its relation.
    pub(super) fn couplings<'a>(
        &'a self,
        system: &'a System,
    ) -> impl Iterator<Item = (usize, usize, &'a Coupling)> {
        self.couplings.iter().filter_map(|&joint| {
            let row = *self.joints[joint].first()?;
            let relation: &dyn Any = &*system.equations()[row].constraint;
            Some((joint, row, relation.downcast_ref()?))
        })
    }

    /// Returns the couplings with play: the index of the joint, that of its force, and its relation.
    pub(super) fn open_couplings(&self) -> impl Iterator<Item = (usize, usize, &Coupling)> {
        self.couplings.iter().filter_map(|&joint| {
            let open = self.more[joint].first()?;
            let relation: &dyn Any = &*open.relation;
            Some((joint, open.force, relation.downcast_ref()?))
        })
    }

    /// Returns the number of reactions that [`report`](Self::report) writes.
    pub(super) fn reported_len(&self) -> usize {
        3 * self.joints.len() + self.constraints.len()
    }

    /// Writes the force and the torque that each joint exerts on its second body for these λ and these
    /// sizes of forces, without which joints with play exert none. Returns whether all are finite.
    #[inline]
    pub(super) fn write_reactions(
        &self,
        system: &System,
        at: &Configuration,
        multipliers: &[f64],
        sizes: &[[f64; 3]],
        reactions: &mut [[f64; 3]],
    ) -> bool {
        let mut sum = 0.0;
        for &(joint, [x, y]) in &self.pins {
            let force = [multipliers[x], multipliers[y]];
            reactions[joint] = [force[0], force[1], 0.0];
            sum += force[0] + force[1];
        }
        for &joint in &self.others {
            let reaction = self.gather_reaction(system, at, joint, multipliers, sizes);
            reactions[joint] = reaction;
            sum += reaction[0] + reaction[1] + reaction[2];
        }
        sum.is_finite()
    }

    /// Returns the reaction of a joint that is no pin.
    #[inline(never)]
    fn gather_reaction(
        &self,
        system: &System,
        at: &Configuration,
        joint: usize,
        multipliers: &[f64],
        sizes: &[[f64; 3]],
    ) -> [f64; 3] {
        let mechanism = system.mechanism();
        let Joint { kind, to, .. } = &mechanism.joints[joint];
        let rows = &self.joints[joint];
        let more = self.more[joint].iter();
        let more = more.filter_map(|own| Some((&*own.relation, sizes.get(own.force)?[0])));
        let along = match &rows[..] {
            &[row] => multipliers[row],
            _ => more.clone().next().map_or(0.0, |(_, size)| size),
        };
        match Reported::of(kind) {
            // The row has the entry one at the second wheel, or the equation.
            Reported::Torque | Reported::Effort => return [0.0, 0.0, along],
            // A force that lengthens a rope pushes.
            Reported::Tension => return [-along, 0.0, 0.0],
            _ => {}
        }
        let to = at.marker(*to);
        let mut wrench = Wrench::new(to.body);
        let origin = |body: usize| at.frames()[body].origin.into();
        let mut gradient = Gradient::new();
        let rows = rows.iter();
        let rows = rows.map(|&row| (&*system.equations()[row].constraint, multipliers[row]));
        for (constraint, size) in rows.chain(more) {
            gradient.clear();
            constraint.gradient(at, &mut gradient);
            for (column, partial) in gradient.entries() {
                let force = size * partial;
                wrench.add(column, force, mechanism.bodies.len(), origin);
            }
        }
        wrench.about(to.arm.into())
    }

    /// Writes the reactions that λ makes, three per joint and one per constraint; components that a
    /// joint does not exert are zero.
    pub(super) fn report(
        &self,
        system: &System,
        at: &Configuration,
        multipliers: &[f64],
        to: &mut [f64],
    ) {
        let (of_joints, of_constraints) = to.split_at_mut(3 * self.joints.len());
        let (of_joints, _) = of_joints.as_chunks_mut();
        self.write_reactions(system, at, multipliers, &[], of_joints);
        for (joint, to) in system.mechanism().joints.iter().zip(of_joints) {
            let reported = Reported::of(&joint.kind);
            for (component, value) in to.iter_mut().enumerate() {
                if !reported.has(component) {
                    *value = 0.0;
                }
            }
        }
        for (to, row) in of_constraints.iter_mut().zip(&self.constraints) {
            *to = multipliers[*row];
        }
    }
}

/// A contact that can only push, or a rope, which can only pull.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// Index of the joint.
    pub(super) joint: usize,
    /// Row of the force between the two parts.
    row: usize,
}

impl Contact {
    /// Returns the contacts of a mechanism.
    pub(super) fn all(mechanism: &Mechanism, rows: &ReactionRows) -> Vec<Self> {
        let joints = mechanism.joints.iter().enumerate();
        let closed = joints.filter(|(joint, definition)| {
            definition.is_one_sided() && mechanism.play(*joint).is_none()
        });
        let contact = |(joint, _): (usize, &Joint)| {
            let row = *rows.joints[joint].last()?;
            Some(Self { joint, row })
        };
        closed.filter_map(contact).collect()
    }

    /// Returns the force between the two parts \[N\], positive if they push each other; the tension
    /// of a rope.
    pub(super) fn force(
        &self,
        mechanism: &Mechanism,
        at: &Configuration,
        multipliers: &[f64],
    ) -> f64 {
        multipliers[self.row] * opens_towards(&mechanism.joints[self.joint], at)
    }
}

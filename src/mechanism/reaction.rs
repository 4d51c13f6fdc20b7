//! The names of forces, energies and inertias, and the components of reactions.

use super::force_quantity::ForceQuantity;
use super::{
    CamFollower, Coordinate, CoordinateEquation, CoordinateKind, DriverId, ForceComponent, Joint,
    JointKind, Load, Mechanism, Unit,
};

/// Components of a reaction that a joint can exert.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reported {
    /// A force at the second marker's point.
    Force,
    /// A force at the second marker's point and a torque.
    ForceAndTorque,
    /// A couple.
    Torque,
    /// The effort of an equation between coordinates, in place of the torque.
    Effort,
    /// The tension of a rope, in place of a force along x.
    Tension,
}

impl Reported {
    /// Returns the components of a type of joint.
    #[must_use]
    pub fn of(kind: &JointKind) -> Self {
        match kind {
            JointKind::Revolute
            | JointKind::Slot
            | JointKind::Link { .. }
            | JointKind::RevoluteTranslational { .. }
            | JointKind::Cam {
                follower: CamFollower::Knife | CamFollower::Roller { .. },
                ..
            } => Self::Force,
            JointKind::Translational
            | JointKind::Weld
            | JointKind::RackAndPinion { .. }
            | JointKind::Rolling { .. }
            | JointKind::Cam {
                follower: CamFollower::Flat,
                ..
            } => Self::ForceAndTorque,
            JointKind::Gear { .. } | JointKind::Belt { .. } => Self::Torque,
            JointKind::Coupling(_) => Self::Effort,
            JointKind::Rope(_) => Self::Tension,
            JointKind::Curve(curve) if curve.follow => Self::ForceAndTorque,
            JointKind::Curve(_) => Self::Force,
        }
    }

    /// Returns whether fx (component 0), fy (1) or torque (2) is among them.
    #[must_use]
    pub fn has(self, component: usize) -> bool {
        match self {
            Self::Force => component < 2,
            Self::ForceAndTorque => true,
            Self::Torque | Self::Effort => component == 2,
            Self::Tension => component == 0,
        }
    }
}

/// A force, an energy or an inertia under the name of its variable.
#[derive(Clone, Debug)]
pub struct NamedForce {
    /// Name, such as `crank_angle.effort` or `A.fx`.
    pub name: String,
    /// Description in one line.
    pub description: String,
    /// Unit of its values.
    pub unit: Unit,
    /// The quantity.
    pub quantity: ForceQuantity,
}

impl NamedForce {
    /// Names the component of a force, of a contact the sum over all its elements.
    #[must_use]
    pub fn of(component: ForceComponent, mechanism: &Mechanism) -> Self {
        let elements = mechanism.elements_with(component.force);
        let quantity = if elements.len() > 1 {
            ForceQuantity::Pushes(elements.start, elements.end)
        } else {
            ForceQuantity::Applied(component.force, component.component)
        };
        Self {
            name: component.name,
            description: component.description,
            unit: component.unit,
            quantity,
        }
    }
}

impl Mechanism {
    /// Returns all forces, energies and inertias of a mechanism with dynamics, whether outputs or
    /// not, but the forces that are inputs: of drivers, reactions of joints and constraints, given sizes
    /// of forces, energies.
    #[must_use]
    pub fn named_forces(&self) -> Vec<NamedForce> {
        let mut list = List(Vec::new());
        if self.has_dynamics() {
            list.add_drivers(self);
            list.add_reactions(self);
            let given = self.given_forces().into_iter();
            list.0.extend(given.map(|own| NamedForce::of(own, self)));
            list.add_energies();
        }
        list.0
    }
}

struct List(Vec<NamedForce>);

impl List {
    fn add(
        &mut self,
        owner: &str,
        suffix: &str,
        description: String,
        quantity: ForceQuantity,
        unit: Unit,
    ) {
        self.0.push(NamedForce {
            name: format!("{owner}.{suffix}"),
            description,
            unit,
            quantity,
        });
    }

    fn add_drivers(&mut self, mechanism: &Mechanism) {
        let drivers = mechanism.drivers.iter().enumerate();
        for (index, driver) in drivers.filter(|(_, driver)| !driver.is_free()) {
            let (id, kind) = (DriverId(index), driver.coordinate.kind);
            let (name, effort) = (&driver.name, kind.effort_unit());
            let exerted = format!("{} that driver `{name}` exerts", kind.effort_word());
            let quantity = ForceQuantity::Effort(id);
            self.add(name, "effort", exerted.clone(), quantity, effort);
            let power = format!("power of driver `{name}`");
            self.add(name, "power", power, ForceQuantity::Power(id), Unit::WATT);
            if driver.is_input {
                let felt = format!("inertia that driver `{name}` feels");
                let quantity = ForceQuantity::Inertia(id);
                self.add(name, "inertia", felt, quantity, kind.inertia_unit());
                let bias = format!("{exerted} if no input accelerates");
                self.add(name, "bias", bias, ForceQuantity::Bias(id), effort);
            }
        }
    }

    /// Adds the reactions of joints and constraints.
    fn add_reactions(&mut self, mechanism: &Mechanism) {
        for (index, joint) in mechanism.joints.iter().enumerate() {
            let reported = Reported::of(&joint.kind);
            let body = mechanism.markers[joint.to.index()].body;
            let body = body.map_or("ground", |body| &mechanism.bodies[body.index()].name);
            if let Some(equation) = joint.equation() {
                self.add_efforts(index, joint, equation);
                continue;
            }
            if reported == Reported::Tension {
                let tension = format!("tension of rope `{}`", joint.name);
                let quantity = ForceQuantity::Reaction(index, 0);
                self.add(&joint.name, "tension", tension, quantity, Unit::NEWTON);
                continue;
            }
            for (component, suffix) in Load::COMPONENTS.into_iter().enumerate() {
                if reported.has(component) {
                    let (word, unit) = match component {
                        0 => ("force along x", Unit::NEWTON),
                        1 => ("force along y", Unit::NEWTON),
                        _ => ("torque", Unit::NEWTON_METRE),
                    };
                    let description = format!("{word} of joint `{}` on `{body}`", joint.name);
                    let quantity = ForceQuantity::Reaction(index, component);
                    self.add(&joint.name, suffix, description, quantity, unit);
                }
            }
        }
        for (index, held) in mechanism.constraints.iter().enumerate() {
            let kind = held.coordinate.kind;
            let word = kind.effort_word();
            let description = format!("{word} that constraint `{}` exerts", held.name);
            let (quantity, unit) = (ForceQuantity::Held(index), kind.effort_unit());
            self.add(&held.name, "effort", description, quantity, unit);
        }
    }

    /// Adds the effort of a coupling, and its efforts along its coordinates.
    fn add_efforts(&mut self, index: usize, joint: &Joint, equation: &CoordinateEquation) {
        let name = &joint.name;
        let description =
            format!("effort of coupling `{name}`, conjugate to left - right of its equation");
        let kind = if equation.is_angle {
            CoordinateKind::Angle
        } else {
            CoordinateKind::Distance
        };
        let quantity = ForceQuantity::Reaction(index, 2);
        self.add(name, "effort", description, quantity, kind.effort_unit());
        for (place, (coordinate, Coordinate { kind, .. })) in
            equation.coordinates.iter().enumerate()
        {
            let word = kind.effort_word();
            let description = format!("{word} that coupling `{name}` exerts along `{coordinate}`");
            let owner = format!("{name}.{coordinate}");
            let quantity = ForceQuantity::Share(index, place);
            self.add(&owner, "effort", description, quantity, kind.effort_unit());
        }
    }

    fn add_energies(&mut self) {
        let (unit, kinetic) = (Unit::JOULE, "kinetic energy of all bodies");
        let quantity = ForceQuantity::KineticEnergy;
        self.add("energy", "kinetic", kinetic.to_owned(), quantity, unit);
        let potential =
            "potential energy of gravity, zero at ground's origin, and of springs".to_owned();
        let quantity = ForceQuantity::PotentialEnergy;
        self.add("energy", "potential", potential, quantity, unit);
    }
}

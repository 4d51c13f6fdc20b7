//! The geometry that lets bodies move with all drivers held, in words.

use super::error::list;
use super::origin::Origin;
use crate::mechanism::{BodyId, Mechanism};

/// The geometry of a group of bodies that can move, to first order, with all drivers held.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Alignment {
    /// The relation of its members.
    pub relation: LineRelation,
    /// The bodies, joints, constraints and drivers in the relation.
    pub members: Vec<Member>,
}

/// A relation of lines. The line of a link leads through its ends; that of a slide or a cam is
/// the normal at its contact, along which it transmits force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LineRelation {
    /// None that is known: the members are all that moves.
    #[default]
    Free,
    /// Links that lie in one line.
    InLine,
    /// Lines that pass through a pin, the last member.
    ThroughPin,
    /// Lines that meet in one point.
    Concurrent,
    /// Parallel lines.
    Parallel,
}

impl LineRelation {
    /// All relations, in the order of their numbers in a serialized state.
    pub const ALL: [Self; 5] = [
        Self::Free,
        Self::InLine,
        Self::ThroughPin,
        Self::Concurrent,
        Self::Parallel,
    ];
}

/// A body or a connection of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Member {
    /// A body.
    Body(BodyId),
    /// A joint, constraint or driver.
    Origin(Origin),
}

impl Member {
    /// Returns whether a mechanism has this member.
    pub(in crate::kinematics) fn is_of(self, mechanism: &Mechanism) -> bool {
        match self {
            Self::Body(body) => body.index() < mechanism.bodies.len(),
            Self::Origin(Origin::Joint(joint)) => joint < mechanism.joints.len(),
            Self::Origin(Origin::Constraint(held)) => held < mechanism.constraints.len(),
            Self::Origin(Origin::Driver(driver)) => driver.index() < mechanism.drivers.len(),
        }
    }

    /// Returns kind and name: ``joint `B` ``.
    fn describe(self, mechanism: &Mechanism) -> String {
        match self {
            Self::Body(body) => format!("body `{}`", mechanism.bodies[body.index()].name),
            Self::Origin(origin) => origin.describe(mechanism),
        }
    }

    /// Returns whether its line is the normal of a contact.
    pub(in crate::kinematics) fn is_contact(self, mechanism: &Mechanism) -> bool {
        let Self::Origin(Origin::Joint(joint)) = self else {
            return false;
        };
        let joint = &mechanism.joints[joint];
        joint.rod().is_none() && !joint.is_pin()
    }

    /// Returns its line in words; `of_link` stands before the name of a link.
    fn describe_line(self, mechanism: &Mechanism, of_link: &str) -> String {
        let name = self.describe(mechanism);
        let of = if self.is_contact(mechanism) {
            "the normal of "
        } else {
            of_link
        };
        format!("{of}{name}")
    }
}

impl Alignment {
    /// Returns kind and name of each member.
    #[must_use]
    pub fn names(&self, mechanism: &Mechanism) -> Vec<String> {
        let members = self.members.iter();
        members.map(|member| member.describe(mechanism)).collect()
    }

    /// Returns the relation in words, with `almost` before its verb.
    pub(crate) fn describe(&self, mechanism: &Mechanism, almost: &str) -> String {
        let lines = |members: &[Member], of_link: &str| {
            let lines = members.iter();
            let lines = lines.map(|line| line.describe_line(mechanism, of_link));
            list(&lines.collect::<Vec<_>>(), " and ")
        };
        let all = || lines(&self.members, "");
        match (self.relation, &self.members[..]) {
            (LineRelation::InLine, _) => format!("{} {almost}line up", all()),
            (LineRelation::ThroughPin, [passing @ .., pin]) => {
                let passes = if passing.len() == 1 { "passes" } else { "pass" };
                let passing = lines(passing, "the line of ");
                let pin = pin.describe(mechanism);
                format!("{passing} {almost}{passes} through {pin}")
            }
            (LineRelation::Concurrent, _) => format!("{} {almost}meet in one point", all()),
            (LineRelation::Parallel, _) => format!("{} are {almost}parallel", all()),
            (LineRelation::Free | LineRelation::ThroughPin, _) => {
                let moved = list(&self.names(mechanism), " and ");
                format!("{moved} can {almost}move with all drivers held")
            }
        }
    }
}

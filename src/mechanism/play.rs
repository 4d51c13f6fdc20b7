//! Joints that open in free motion.

use super::{CoordinateKind, Expression, Force, Joint, JointKind, Load, Mechanism, PassiveCause};

/// Play of a joint: in free motion its relation may leave the value at which it is held.
///
/// The two parts meet like the two sides of a stop. Where all is driven they stay in touch.
#[derive(Clone, Debug)]
pub struct Play {
    /// Width of the gap between the flanks, in the unit of the relation \[m or rad\]; `None` for a contact
    /// that only pushes, or a rope that only pulls.
    pub backlash: Option<Expression>,
    /// Part of the velocity with which the parts bounce, from 0 to 1; `None` for zero.
    pub restitution: Option<Expression>,
}

impl Play {
    /// Returns its expressions.
    pub fn expressions(&self) -> impl Iterator<Item = &Expression> {
        self.backlash.iter().chain(&self.restitution)
    }
}

impl JointKind {
    /// Returns the play that the file gives.
    #[must_use]
    pub fn play(&self) -> Option<&Play> {
        match self {
            Self::Gear { play, .. } | Self::RackAndPinion { play, .. } | Self::Cam { play, .. } => {
                play.as_deref()
            }
            Self::Coupling(equation) => equation.play.as_deref(),
            Self::Rope(rope) => rope.play.as_deref(),
            _ => None,
        }
    }
}

impl Mechanism {
    /// Returns the play of a joint, `None` where all is driven: its parts stay in touch there.
    #[must_use]
    pub fn play(&self, joint: usize) -> Option<&Play> {
        let play = self.joints[joint].kind.play();
        play.filter(|_| self.has_freedoms())
    }
}

impl Joint {
    /// Returns the force along the relation of the joint, which has this index, if it has play.
    pub(super) fn force_of_play(&self, index: usize) -> Option<Force> {
        self.kind.play()?;
        let kind = match &self.kind {
            JointKind::Gear { .. } => CoordinateKind::Angle,
            JointKind::Coupling(equation) if equation.is_angle => CoordinateKind::Angle,
            _ => CoordinateKind::Distance,
        };
        Some(Force {
            name: self.name.clone(),
            description: String::new(),
            load: Load::Passive {
                coordinate: self.coordinate(kind),
                cause: PassiveCause::Play(index),
            },
        })
    }
}

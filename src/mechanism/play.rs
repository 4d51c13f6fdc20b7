//! Joints that open in free motion.

use super::{Expression, Mechanism};

/// Play of a joint: in free motion its relation may leave the value at which it is held.
///
/// The two parts meet like the two sides of a stop. Where all is driven they stay in touch.
#[derive(Clone, Debug)]
pub struct Play {
    /// Width of the gap between the flanks, in the unit of the relation \[m or rad\]; `None` for a contact
    /// that only pushes, a rope that only pulls, or an equation of which one side is the larger one.
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

impl Mechanism {
    /// Returns the play of a joint, `None` where all is driven: its parts stay in touch there.
    #[must_use]
    pub fn play(&self, joint: usize) -> Option<&Play> {
        let play = self.joints[joint].kind.play();
        play.filter(|_| self.has_freedoms())
    }
}

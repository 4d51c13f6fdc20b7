//! Equations between coordinates.

use super::{Coordinate, Expression, Play, PrescribedMotion, Variable};

/// Most coordinates in one equation.
pub const MOST_COUPLED: usize = 8;

/// An equation between coordinates, left − right = 0: that of a coupling.
#[derive(Clone, Debug)]
pub struct CoordinateEquation {
    /// As the file writes it.
    pub text: String,
    /// Its coordinates, each with the name of the driver or measure by which the equation calls
    /// it; one at least, [`MOST_COUPLED`] at most.
    pub coordinates: Vec<(String, Coordinate)>,
    /// left − right, over [`Variable::Coordinate`]s by their places in the list.
    pub difference: Expression,
    /// The table that it calls as the function `law`.
    pub law: Option<PrescribedMotion>,
    /// Value at which left − right is held.
    pub phase: Phase,
    /// Range in which left − right is free, in free motion: a gap, or from its value up.
    pub play: Option<Box<Play>>,
    /// Whether both sides are angles; lengths otherwise.
    pub is_angle: bool,
}

impl CoordinateEquation {
    /// Returns the places of the coordinates in the equation, in the order in which they occur.
    pub(super) fn places(difference: &Expression) -> Vec<usize> {
        let mut places = Vec::new();
        for variable in difference.variables() {
            if let Variable::Coordinate(place) = variable
                && !places.contains(&place)
            {
                places.push(place);
            }
        }
        places
    }
}

/// Constant of a relation between wheels, or of an equation between coordinates.
#[derive(Clone, Debug)]
pub enum Phase {
    /// A value \[m or rad\]; zero if the file gives none.
    At(Expression),
    /// The value that the bodies' estimates give with the file's parameters: wheels mesh as they are
    /// drawn.
    Drawn,
}

//! Mechanisms as symbols, in the frames of their bodies.

use super::sweep::sweep;
use super::symbol::{Symbol, compose};
use biela::kinematics::{Pose, Solver};
use biela::mechanism::{DisplayUnit, Mechanism};

/// A mechanism as symbols that are fixed on its bodies or on ground, or that reach from one to
/// another. The same scene is drawn at any pose of the motion that it was made for.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The mechanism's name.
    pub name: String,
    /// Description of the mechanism in one line; may be empty.
    pub description: String,
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// The symbols, in no particular order.
    pub symbols: Vec<Symbol>,
    /// Sentences that stand below the drawing.
    pub notes: Vec<String>,
    /// The unit of the bar that shows the scale; millimetres or metres, by its length, without one.
    pub length_unit: Option<DisplayUnit>,
}

impl Scene {
    /// Returns the scene of a mechanism at the solver's pose, to which the solver returns.
    ///
    /// Ways and slots are as long as the motion needs, and points of interest leave traces along
    /// it. The motion follows the prescribed motions until the file's stop time. If nothing is
    /// prescribed, the first driver of an angle turns: as many turns, up to eight, as bring the
    /// mechanism back, or one turn, or as far both ways as it gets or its limits permit; without an
    /// angle, and with points of interest, the first driver moves between its limits. Other drivers
    /// keep their values. `traces` false leaves the traces out.
    #[must_use]
    pub fn new(solver: &mut Solver, traces: bool) -> Self {
        let motion = sweep(solver);
        let Pose { q, parameters, .. } = solver.pose();
        Self::along(solver.mechanism(), parameters, q, &motion, traces)
    }

    /// Returns the scene of a mechanism at the pose q, \[m, m, rad\] per body, for a motion
    /// along poses: ways and slots are as long as it needs, points of interest leave traces.
    #[must_use]
    pub fn along(
        mechanism: &Mechanism,
        parameters: &[f64],
        q: &[f64],
        motion: &[Vec<f64>],
        traces: bool,
    ) -> Self {
        Self {
            name: mechanism.name.clone(),
            description: mechanism.description.clone(),
            bodies: mechanism.bodies.iter().map(|b| b.name.clone()).collect(),
            symbols: compose(mechanism, parameters, q, motion, traces),
            notes: Vec::new(),
            length_unit: None,
        }
    }

    /// Adds symbols, with sentences about them.
    pub(super) fn add(&mut self, (symbols, notes): (Vec<Symbol>, Vec<String>)) {
        self.symbols.extend(symbols);
        self.notes.extend(notes);
    }
}

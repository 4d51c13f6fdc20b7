//! The other positions in which the mechanism closes.

use std::sync::Arc;

use serde_json::{Value, json};

use super::outcome::{Obstacle, Outcome};
use super::session::Session;
use crate::drawing::{Scene, Sheet, svg};
use biela::kinematics::Solver;
use biela::mechanism::{Expression, Mechanism};

/// Width of the small pictures.
const WIDTH: u32 = 240;

impl Session {
    /// Finds the other assembly modes for the parameters and drivers in force. Returns their small
    /// pictures, and whether there are no others.
    pub fn assemblies(&mut self) -> Value {
        let modes = match self.apart_by_hand(|session| session.motion.solver.modes()) {
            Ok(modes) => modes,
            Err(error) => return json!({ "error": error.to_string() }),
        };
        self.refresh();
        self.modes = modes.others.into_iter().map(|mode| mode.q).collect();
        let mechanism = Arc::clone(self.mechanism());
        let parameters = &self.pose().parameters;
        let pictures: Vec<String> = (self.modes.iter())
            .map(|q| {
                let scene = Scene::along(&mechanism, parameters, q, std::slice::from_ref(q), false);
                svg::write(&Sheet::small(&scene, q), WIDTH, true)
            })
            .collect();
        json!({ "pictures": pictures, "complete": modes.complete })
    }

    /// Moves the mechanism into an assembly mode, by its place in the list that
    /// [`assemblies`](Self::assemblies) made last.
    pub fn choose(&mut self, index: usize) -> Outcome {
        let Some(q) = self.modes.get(index).cloned() else {
            return Outcome::Refused(Obstacle::new("the list of positions is out of date"));
        };
        let own = self.mechanism();
        let bodies = own.bodies.iter().zip(q.chunks_exact(3));
        let bodies = bodies.map(|(body, q)| {
            let mut body = body.clone();
            body.estimate = [0, 1, 2].map(|k| Expression::constant(q[k]));
            body
        });
        let mechanism = Arc::new(Mechanism {
            bodies: bodies.collect(),
            ..Mechanism::clone(own)
        });
        self.take();
        let path = self.path_here().clone();
        match Solver::assembled(mechanism, &path) {
            Ok(solver) => {
                self.adopt(solver);
                Outcome::Reached
            }
            Err(error) => Outcome::Refused(Obstacle::of_assembly(&error, &self.motion.solver)),
        }
    }
}

//! The drivers along a path, and the parameters if they move.

use super::{Motions, Path};
use crate::mechanism::{Jet, Mechanism};

/// Drivers and parameters at two places of a path: where the mechanism is, and where a sub-step is
/// to end. Derivatives are those with respect to s.
#[derive(Debug)]
pub(in crate::kinematics) struct PathDrivers {
    /// The drivers where the mechanism is.
    pub(in crate::kinematics) here: Vec<Jet>,
    /// The drivers at the place evaluated last.
    pub(in crate::kinematics) ahead: Vec<Jet>,
    /// The values of the drivers at the end of the sub-step.
    pub(in crate::kinematics) values: Vec<f64>,
    /// Whether the parameters differ between the ends of the path.
    pub(in crate::kinematics) parameters_move: bool,
    /// The parameters at the place evaluated last, if they move.
    pub(in crate::kinematics) parameters: Vec<f64>,
    parameter_jets: Vec<Jet>,
    /// The motions with parameters that move.
    motions: Motions,
}

impl PathDrivers {
    /// Makes the storage.
    pub(in crate::kinematics) fn new(mechanism: &Mechanism) -> Self {
        let drivers = mechanism.drivers.len();
        let parameters = mechanism.parameters.len();
        Self {
            here: vec![Jet::constant(0.0); drivers],
            ahead: vec![Jet::constant(0.0); drivers],
            values: vec![0.0; drivers],
            parameters_move: false,
            parameters: vec![0.0; parameters],
            parameter_jets: vec![Jet::constant(0.0); parameters],
            motions: Motions::new(mechanism),
        }
    }

    /// Evaluates drivers and parameters at s; `motions` are those with parameters that rest.
    pub(in crate::kinematics) fn evaluate(
        &mut self,
        mechanism: &Mechanism,
        path: &Path,
        s: f64,
        motions: &Motions,
    ) {
        if self.parameters_move {
            path.parameters(mechanism, s, &mut self.parameter_jets);
            for (value, jet) in self.parameters.iter_mut().zip(&self.parameter_jets) {
                *value = jet.value;
            }
            let jets = &self.parameter_jets;
            self.motions.set_parameters(|p| jets[p.index()]);
            path.drivers(s, &self.motions, &mut self.ahead);
        } else {
            path.drivers(s, motions, &mut self.ahead);
        }
    }

    /// Takes over the values of the place evaluated last, where a sub-step is to end.
    pub(in crate::kinematics) fn take_values(&mut self) {
        for (value, jet) in self.values.iter_mut().zip(&self.ahead) {
            *value = jet.value;
        }
    }

    /// Makes the place evaluated last the place where the mechanism is.
    pub(in crate::kinematics) fn arrive(&mut self) {
        std::mem::swap(&mut self.here, &mut self.ahead);
    }
}

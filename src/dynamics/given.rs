//! Inputs from outside during a free motion.

use crate::mechanism::{DriverId, Jet};

/// The inputs of a mechanism as functions of time.
pub trait Given {
    /// Returns value, velocity and acceleration of a driver that is an input \[SI\].
    fn driver(&self, driver: DriverId, time: f64) -> Jet;

    /// Writes the sizes of the forces that are inputs \[SI\], in the order of their variables.
    fn loads(&self, time: f64, loads: &mut [f64]);
}

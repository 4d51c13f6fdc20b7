//! The start that a free motion keeps.

use std::sync::Arc;

use super::apart::TOLD;
use super::event::Event;
use super::given::Given;
use super::motion::FreeMotion;
use super::overlap::Overlap;
use super::passive::PLACE_ROUNDING;
use crate::kinematics::{Path, Pose, Solver};
use crate::mechanism::{DriverId, Expression, Jet, Mechanism, Order};

/// Inputs at their starts.
struct AtStart<'a>(&'a Mechanism);

impl Given for AtStart<'_> {
    fn driver(&self, driver: DriverId, _: f64) -> Jet {
        let start = self.0.drivers[driver.index()].start();
        Jet::constant(start.expect("a driver without a motion is an input"))
    }

    fn loads(&self, _: f64, loads: &mut [f64]) {
        loads.fill(0.0);
    }
}

/// The start that a free motion keeps, where it is another one than that of the file.
#[derive(Clone, Debug)]
pub struct KeptStart {
    /// The mechanism with the values and velocities of freedoms after parts have been moved apart and
    /// have met, and with the bodies there as estimates.
    pub mechanism: Arc<Mechanism>,
    /// The pose there.
    pub pose: Pose,
    /// Overlaps at the start of the file.
    pub overlaps: Vec<Overlap>,
    /// Impacts there.
    pub events: Vec<Event>,
}

impl KeptStart {
    /// Begins the free motion of a mechanism, with all inputs at their starts. `None` where it keeps the
    /// start of the file, and where it does not begin.
    #[must_use]
    pub fn of(mechanism: &Arc<Mechanism>) -> Option<Self> {
        let mut forces = mechanism.forces.iter();
        if !(mechanism.has_freedoms() && forces.any(|force| force.load.is_contact())) {
            return None;
        }
        let mut solver = Solver::assembled(Arc::clone(mechanism), &Path::new(mechanism)).ok()?;
        let mut free = FreeMotion::new(&solver, mechanism.simulation.tolerance).ok()??;
        free.start(&mut solver, &AtStart(mechanism)).ok()?;
        let mut kept = Mechanism::clone(mechanism);
        let mut is_other = false;
        let freedoms = free.freedoms().iter().zip(free.scales());
        for ((freedom, scale), velocity) in freedoms.zip(free.velocities()) {
            let driver = &mechanism.drivers[freedom.index()];
            let own = driver.start().expect("a freedom has a start");
            let value = solver.pose().drivers[freedom.index()];
            for (order, own, kept_value) in [
                (Order::Position, own, value),
                (Order::Velocity, driver.start_velocity(), velocity),
            ] {
                if (kept_value - own).abs() > TOLD * PLACE_ROUNDING * scale {
                    kept.set_start(*freedom, order, kept_value);
                    is_other = true;
                }
            }
        }
        let bodies = kept.bodies.iter_mut().zip(solver.pose().q.chunks_exact(3));
        for (body, q) in bodies {
            body.estimate = [0, 1, 2].map(|k| Expression::constant(q[k]));
        }
        is_other.then(|| Self {
            mechanism: Arc::new(kept),
            pose: solver.pose().clone(),
            overlaps: free.overlaps().collect(),
            events: free.events().collect(),
        })
    }
}

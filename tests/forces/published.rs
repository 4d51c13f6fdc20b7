//! Published figures.

use biela::kinematics::{ForceParts, ForceQuantity, KnownMotion, Path, Rates, Solver};
use biela::mechanism::{DriverId, Jet};

use crate::common::shipped;

/// Test Set for Initial Value Problem Solvers (CWI, Bari), problem "andrews", at t = 0: the
/// multipliers of the first loop, that of K3, and the torque that gives the published
/// acceleration. The published digits beyond the 14th are below rounding.
#[test]
fn andrews_mechanism_has_the_published_forces_at_the_start() {
    let mechanism = shipped("andrews");
    let joint = mechanism.joints.iter().position(|joint| joint.name == "E1");
    let joint = joint.expect("the file has it");
    let mut solver = Solver::new(mechanism).expect("the drivers match");
    let path = Path::new(solver.mechanism());
    solver.assemble(&path).expect("it assembles");
    let mut rates = Rates::new(solver.pose().q.len());
    let driver_rates = [Jet::new(0.0, [0.0, 14_222.443_919_954_114])];
    solver
        .solve_rates(|_| driver_rates[0], &mut rates)
        .expect("it is regular");
    let mut forces = solver.forces();
    let motion = KnownMotion {
        rates: &rates,
        driver_rates: &driver_rates,
        inputs: &[],
    };
    solver
        .solve_forces(motion, ForceParts::ALL, &mut forces)
        .expect("it has forces");
    for (quantity, published) in [
        (ForceQuantity::Reaction(joint, 0), 98.566_870_396_241_09),
        (ForceQuantity::Reaction(joint, 1), -6.122_688_344_255_663),
        (ForceQuantity::Effort(DriverId(0)), 0.033),
    ] {
        let value = forces.value(quantity);
        // The published angles have fifteen digits, and the condition of the pose is 1e-2.
        let error = (value - published).abs() / published.abs();
        assert!(error < 1e-11, "{quantity:?}: {value}, not {published}");
    }
}

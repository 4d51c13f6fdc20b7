//! Redundant constraints: reactions that they leave indeterminate, and efforts that they do not.

use std::sync::Arc;

use biela::kinematics::{
    ForceParts, ForceQuantity, Forces, KnownMotion, Origin, Path, Rates, Solver,
};
use biela::mechanism::{DriverId, Indeterminate, Jet, Mechanism, Source};

/// A slab on two parallel slides, of which the second is redundant, turned by a crank and a rod.
const SLAB: &str = r#"
    format = 1
    name = "slab"
    ground.markers = { O = [0, 0], S = [0, 0], T = [0, 1] }
    bodies.crank = { markers = { O = [0, 0], A = [0.3, 0] }, estimate = [0, 0, 0.5], mass = 1, inertia = 0.1, center = [0.1, 0.05] }
    bodies.rod = { markers = { A = [0, 0], B = [1, 0] }, estimate = [0.3, 0.1, 0], mass = 2, inertia = 0.2, center = [0.5, 0] }
    bodies.slab = { markers = { B = [0, 0], T = [0, 1] }, estimate = [1.2, 0, 0], mass = 3, inertia = 0.3, center = [0.2, 0.4] }
    joints.O = { type = "revolute", markers = ["ground.O", "crank.O"] }
    joints.A = { type = "revolute", markers = ["crank.A", "rod.A"] }
    joints.B = { type = "revolute", markers = ["rod.B", "slab.B"] }
    joints.S = { type = "translational", markers = ["ground.S", "slab.B"] }
    joints.T = { type = "translational", markers = ["ground.T", "slab.T"] }
    drivers.turn = { coordinate = "angle", markers = ["ground.O", "crank.O"], start = 0.5 }
"#;

fn solved(mechanism: Mechanism) -> (Solver, Forces) {
    let mut solver = Solver::new(Arc::new(mechanism)).expect("the drivers match");
    let path = Path::new(solver.mechanism());
    solver.assemble(&path).expect("it assembles");
    let driver_rates = [Jet::new(0.0, [2.0, 3.0])];
    let mut rates = Rates::new(solver.pose().q.len());
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
    (solver, forces)
}

fn parse(text: &str) -> Mechanism {
    Mechanism::parse(&Source::new("test.toml", text))
        .expect("the file is right")
        .0
}

fn reaction(forces: &Forces, joint: usize) -> [f64; 3] {
    [0, 1, 2].map(|component| forces.value(ForceQuantity::Reaction(joint, component)))
}

#[test]
fn indeterminate_reactions_are_found_and_efforts_are_exact() {
    let (mut solver, forces) = solved(parse(SLAB));
    // The two slides can press against each other and twist each other.
    assert_eq!(solver.indeterminate(), [Origin::Joint(3), Origin::Joint(4)]);
    let (_, single) = solved(parse(&SLAB.replace("joints.T =", "# ")));
    let mut same = vec![
        (ForceQuantity::Effort(DriverId(0)), 0.0),
        (ForceQuantity::Inertia(DriverId(0)), 0.0),
        (ForceQuantity::Bias(DriverId(0)), 0.0),
    ];
    for joint in 0..3 {
        same.extend([0, 1, 2].map(|component| (ForceQuantity::Reaction(joint, component), 0.0)));
    }
    for (quantity, _) in same {
        let (with, without) = (forces.value(quantity), single.value(quantity));
        assert!(
            (with - without).abs() < 1e-12,
            "{quantity:?}: {with} and {without}"
        );
    }
}

/// The slides share force F along y and moment M about B: with the forces f_S, f_T and torques
/// t_S, t_T, f_S + f_T = F and t_S + t_T + x (f) = M have their least squares at equal parts, as
/// both points have the same x.
#[test]
fn reactions_of_least_norm_are_equal_parts() {
    let mut mechanism = parse(SLAB);
    mechanism.outputs.indeterminate = Indeterminate::MinimumNorm;
    let (_, forces) = solved(mechanism);
    let (_, single) = solved(parse(&SLAB.replace("joints.T =", "# ")));
    let whole = reaction(&single, 3);
    for joint in [3, 4] {
        for (part, whole) in reaction(&forces, joint).into_iter().zip(whole) {
            assert!((part - 0.5 * whole).abs() < 1e-12, "{part} of {whole}");
        }
    }
}

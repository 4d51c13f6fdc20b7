//! Published figures.

use std::sync::Arc;

use biela::kinematics::{DriverPath, ForceParts, ForceQuantity, KnownMotion, Path, Rates, Solver};
use biela::mechanism::{DriverId, Jet, Mechanism, Source};
use nalgebra::{Matrix2, Vector2};

use crate::common::shipped;
use crate::forces::loaded::Loaded;

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

/// Test Set for Initial Value Problem Solvers (CWI, Bari), problem "caraxis": an axle of length 1
/// between two wheels, each with half the mass of 10 eps² and on a spring of stiffness 1 and free
/// length 1/2 that stands on the road. The left wheel moves at right angles to the road, whose
/// right end goes up and down by sin(10 t)/10.
const CAR_AXIS: &str = r#"
    format = 1
    name = "car_axis"
    parameters = { mass = "10*0.01^2/2" }
    ground.markers = { O = [0, 0] }
    bodies.road = { markers = { O = [0, 0], B = [1, 0], way = [0, 0, "90*deg"] }, estimate = [0, 0, -0.1] }
    bodies.left = { markers = { C = [0, 0] }, mass = "mass", estimate = [0.05, 0.5, 0] }
    bodies.right = { markers = { C = [0, 0] }, mass = "mass", estimate = [1.04, 0.37, 0] }
    joints.O = { type = "revolute", markers = ["ground.O", "road.O"] }
    joints.guide = { type = "slot", markers = ["road.way", "left.C"] }
    joints.axle = { type = "link", markers = ["left.C", "right.C"], length = 1 }
    constraints.left_turn = { coordinate = "angle", markers = ["ground.O", "left.C"], value = 0 }
    constraints.right_turn = { coordinate = "angle", markers = ["ground.O", "right.C"], value = 0 }
    drivers.road_angle = { coordinate = "angle", markers = ["ground.O", "road.O"], motion = "asin(0.1*sin(10*t))" }
    drivers.left_height = { coordinate = "y", markers = ["ground.O", "left.C"], start = 0.5 }
    drivers.right_height = { coordinate = "y", markers = ["ground.O", "right.C"], start = 0.37 }
    forces.left_spring = { coordinate = "distance", markers = ["road.O", "left.C"], stiffness = 1, free = 0.5 }
    forces.right_spring = { coordinate = "distance", markers = ["road.B", "right.C"], stiffness = 1, free = 0.5 }
    simulation.gravity = [0, -1]
"#;

/// The reference solution at t = 3: positions and velocities of the wheels give the multipliers.
/// The wheels move freely, so that their drivers have the accelerations at which these exert
/// nothing; efforts are linear in accelerations.
#[test]
fn a_car_axis_has_the_published_multipliers_at_the_end() {
    const XL: f64 = 0.049_345_578_427_540_28;
    const YL: f64 = 0.496_989_460_230_171_15;
    const XR: f64 = 1.041_742_524_885_421_5;
    const YR: f64 = 0.373_911_027_265_361_26;
    const VELOCITIES: [f64; 4] = [
        -0.077_058_368_404_097_24,
        0.007_446_866_587_237_786,
        0.017_556_815_753_723_222,
        0.770_341_043_779_252,
    ];
    const LAMBDA: [f64; 2] = [-0.004_736_886_590_848_933, -0.001_104_680_331_257_343_7];
    // The published digits beyond these are below rounding; the pose has a condition of 0.1.
    const LIMIT: f64 = 1e-13;

    let (mechanism, _) =
        Mechanism::parse(&Source::new("car_axis.toml", CAR_AXIS)).expect("it is right");
    let mut solver = Solver::new(Arc::new(mechanism)).expect("the drivers match");
    let mut path = Path::new(solver.mechanism());
    path.start = 3.0;
    for (driver_path, height) in path.driver_paths[1..].iter_mut().zip([YL, YR]) {
        *driver_path = DriverPath::held(height, height);
    }
    solver.assemble(&path).expect("it assembles");
    let road = solver.motion(DriverId(0), 3.0);
    let at = |left: f64, right: f64| {
        vec![
            road,
            Jet::new(YL, [VELOCITIES[1], left]),
            Jet::new(YR, [VELOCITIES[3], right]),
        ]
    };
    let mut loaded = Loaded::solved(solver, at(0.0, 0.0), Vec::new());
    let q = &loaded.solver.pose().q;
    assert!(
        (q[3] - XL).abs() < LIMIT && (q[6] - XR).abs() < LIMIT,
        "{q:?}"
    );
    let v = loaded.rates.velocity();
    assert!(
        (v[3] - VELOCITIES[0]).abs() < LIMIT && (v[6] - VELOCITIES[2]).abs() < LIMIT,
        "{v:?}"
    );

    let mut efforts = |left: f64, right: f64| {
        loaded.driver_rates = at(left, right);
        loaded.solve();
        let of = |driver| loaded.forces.value(ForceQuantity::Effort(DriverId(driver)));
        Vector2::new(of(1), of(2))
    };
    let bias = efforts(0.0, 0.0);
    let inertia = Matrix2::from_columns(&[efforts(1.0, 0.0) - bias, efforts(0.0, 1.0) - bias]);
    let free = inertia.lu().solve(&-bias).expect("masses are positive");
    let rest = efforts(free.x, free.y);
    assert!(rest.norm() < LIMIT * bias.norm(), "{rest}");

    // The constraints xb xl + yb yl = 0 and |left - right|² = 1 with their multipliers; the
    // mechanism's joints exert their forces on the left wheel, and on the right one.
    let (sin, cos) = road.value.sin_cos();
    let guide = LAMBDA[0] * Vector2::new(cos, sin);
    let axle = -2.0 * LAMBDA[1] * Vector2::new(XL - XR, YL - YR);
    for (joint, published) in [(1, guide), (2, axle)] {
        let [x, y] = [0, 1].map(|k| loaded.forces.value(ForceQuantity::Reaction(joint, k)));
        let error = (Vector2::new(x, y) - published).norm() / published.norm();
        assert!(
            error < LIMIT / published.norm(),
            "joint {joint}: {x}, {y}, not {published}"
        );
    }
}

//! Mechanisms whose forces have a closed form.

use std::sync::Arc;

use biela::kinematics::{
    Error, ForceParts, ForceQuantity, Forces, KnownMotion, Path, Rates, Solver,
};
use biela::mechanism::{DriverId, Jet, Mechanism, Source};

/// A few rounding errors of sines and sums.
const ROUNDING: f64 = 1e-14;

const PENDULUM: &str = r#"
    format = 1
    name = "pendulum"
    [ground.markers]
    O = [0, 0]
    [bodies.rod]
    markers = { O = [0, 0], A = [0.8, 0] }
    mass = 2
    inertia = 0.05
    center = [0.5, 0]
    [joints]
    O = { type = "revolute", markers = ["ground.O", "rod.O"] }
    [drivers]
    swing = { coordinate = "angle", markers = ["ground.O", "rod.O"], start = 0.3 }
"#;

fn parse(text: &str) -> Mechanism {
    let source = Source::new("test.toml", text);
    Mechanism::parse(&source).expect("the file is right").0
}

/// Returns a mechanism at its start, with these rates of its drivers and these inputs of forces.
fn at_start(text: &str, rates: &[[f64; 2]], inputs: &[f64]) -> Result<(Solver, Forces), Error> {
    let mut solver = Solver::new(Arc::new(parse(text)))?;
    let path = Path::new(solver.mechanism());
    solver.assemble(&path)?;
    let driver_rates: Vec<Jet> = rates.iter().map(|&rates| Jet::new(0.0, rates)).collect();
    let mut rates = Rates::new(solver.pose().q.len());
    solver.solve_rates(|driver| driver_rates[driver.index()], &mut rates)?;
    let mut forces = solver.forces();
    let motion = KnownMotion {
        rates: &rates,
        driver_rates: &driver_rates,
        inputs,
    };
    solver.solve_forces(motion, ForceParts::ALL, &mut forces)?;
    Ok((solver, forces))
}

#[track_caller]
fn assert_forces(forces: &Forces, expected: &[(ForceQuantity, f64)]) {
    let largest = expected
        .iter()
        .fold(1.0, |most: f64, (_, v)| most.max(v.abs()));
    for &(quantity, expected) in expected {
        let value = forces.value(quantity);
        let error = (value - expected).abs();
        assert!(
            error <= ROUNDING * largest,
            "{quantity:?}: {value}, not {expected}"
        );
    }
}

const SWING: DriverId = DriverId(0);

/// τ = (J + m l²) α + m g l cos φ; the pin bears m (a − g).
#[test]
fn a_pendulum_follows_its_equation_of_motion() {
    let (omega, alpha) = (1.7, -2.3);
    let (_, forces) = at_start(PENDULUM, &[[omega, alpha]], &[]).expect("it has forces");
    let (m, j, l, g, phi) = (2.0, 0.05, 0.5, 9.81, 0.3_f64);
    let inertia = j + m * l * l;
    let bias = m * g * l * phi.cos();
    let effort = inertia * alpha + bias;
    let (sin, cos) = phi.sin_cos();
    let ax = -l * (alpha * sin + omega * omega * cos);
    let ay = l * (alpha * cos - omega * omega * sin);
    assert_forces(
        &forces,
        &[
            (ForceQuantity::Effort(SWING), effort),
            (ForceQuantity::Power(SWING), effort * omega),
            (ForceQuantity::Inertia(SWING), inertia),
            (ForceQuantity::Bias(SWING), bias),
            (ForceQuantity::Reaction(0, 0), m * ax),
            (ForceQuantity::Reaction(0, 1), m * (ay + g)),
            (ForceQuantity::Reaction(0, 2), 0.0),
            (ForceQuantity::KineticEnergy, 0.5 * inertia * omega * omega),
            (ForceQuantity::PotentialEnergy, m * g * l * sin),
        ],
    );
}

/// The same with ground as second body: the reaction is the opposite one.
#[test]
fn ground_bears_the_opposite_reaction() {
    let exchanged = PENDULUM.replace(
        r#"markers = ["ground.O", "rod.O"] }
    [drivers]"#,
        r#"markers = ["rod.O", "ground.O"] }
    [drivers]"#,
    );
    assert_ne!(exchanged, PENDULUM);
    let rates = [[1.7, -2.3]];
    let (_, forces) = at_start(PENDULUM, &rates, &[]).expect("it has forces");
    let (_, opposite) = at_start(&exchanged, &rates, &[]).expect("it has forces");
    let reactions = [0, 1, 2].map(|component| {
        let quantity = ForceQuantity::Reaction(0, component);
        (quantity, -forces.value(quantity))
    });
    assert_forces(&opposite, &reactions);
}

/// A spring, a damper, a torque that depends on the angle, and inputs, on the pendulum at rest or
/// in motion: each adds −f ∂c/∂φ to the effort.
#[test]
fn each_force_adds_its_generalized_force() {
    let phi = 0.3_f64;
    let (sin, cos) = phi.sin_cos();
    let base = 2.0 * 9.81 * 0.5 * cos;
    let omega = 1.7;
    // From (0, 0.1) to the end of the rod, (0.8 cos φ, 0.8 sin φ).
    let (dx, dy) = (0.8 * cos, 0.8 * sin - 0.1);
    let d = dx.hypot(dy);
    let d_phi = (dx * -0.8 * sin + dy * 0.8 * cos) / d;
    let cases = [
        (
            r#"s = { coordinate = "angle", markers = ["ground.O", "rod.O"], stiffness = 3, free = 0.1 }"#,
            -3.0 * (phi - 0.1),
            0,
        ),
        (
            r#"s = { coordinate = "angle", markers = ["ground.O", "rod.O"], damping = 0.7 }"#,
            -0.7 * omega,
            0,
        ),
        (
            r#"s = { coordinate = "angle", markers = ["ground.O", "rod.O"], value = "2*position - velocity*abs(velocity)" }"#,
            2.0 * phi - omega * omega,
            0,
        ),
        (
            r#"s = { coordinate = "distance", markers = ["ground.P", "rod.A"], stiffness = 40, free = 0.2 }"#,
            -40.0 * (d - 0.2) * d_phi,
            0,
        ),
        (
            r#"s = { coordinate = "distance", markers = ["ground.P", "rod.A"] }"#,
            5.0 * d_phi,
            1,
        ),
        (
            r#"s = { coordinate = "y", markers = ["ground.O", "rod.A"], value = "12 + t" }"#,
            12.0 * 0.8 * cos,
            0,
        ),
        // On the rod's own axes the coordinate is constant, whatever the force.
        (
            r#"s = { coordinate = "x", markers = ["ground.O", "rod.A"], axes = "rod.O", value = 12 }"#,
            0.0,
            0,
        ),
        (
            r#"s = { marker = "rod.A", value = [3, "-7 + t"], torque = 0.4 }"#,
            3.0 * -0.8 * sin - 7.0 * 0.8 * cos + 0.4,
            0,
        ),
        // A follower force across the rod.
        (
            r#"s = { marker = "rod.A", axes = "rod.A", value = [100, 6] }"#,
            6.0 * 0.8,
            0,
        ),
        (
            r#"s = { marker = "rod.A" }"#,
            5.0 * -0.8 * sin + 6.0 * 0.8 * cos + 7.0,
            3,
        ),
    ];
    for (line, generalized, inputs) in cases {
        let text = format!("{PENDULUM}\n[forces]\n{line}\n")
            .replace("O = [0, 0]\n", "O = [0, 0]\nP = [0, 0.1]\n");
        let inputs = &[5.0, 6.0, 7.0][..inputs];
        let (_, forces) = at_start(&text, &[[omega, 0.0]], inputs).expect(line);
        let effort = forces.value(ForceQuantity::Effort(SWING));
        let expected = base - generalized;
        assert!(
            (effort - expected).abs() < 1e-12,
            "{line}: {effort}, not {expected}"
        );
    }
}

#[test]
fn a_spring_without_length_has_no_direction() {
    let text = format!(
        "{PENDULUM}\n[forces]\ns = {{ coordinate = \"distance\", markers = [\"ground.O\", \
         \"rod.O\"], stiffness = 3, free = 0.1 }}\n"
    );
    let error = at_start(&text, &[[0.0, 0.0]], &[])
        .err()
        .map(|error| error.to_string());
    let expected = "force `s` has no direction: the distance of its markers is zero";
    assert_eq!(error.as_deref(), Some(expected));
}

/// Bodies that are still bear weights: a beam on a pin and a link, by the law of the lever.
#[test]
fn a_beam_at_rest_is_in_static_balance() {
    let text = r#"
        format = 1
        name = "beam"
        ground.markers = { O = [0, 0], C = [1.5, 2] }
        [bodies.beam]
        markers = { O = [0, 0], B = [1.5, 0], E = [2, 0] }
        [joints]
        O = { type = "revolute", markers = ["ground.O", "beam.O"] }
        [drivers]
        rope = { coordinate = "distance", markers = ["ground.C", "beam.B"], start = 2 }
        [forces]
        weight = { marker = "beam.E", value = [0, -100] }
    "#;
    let (_, forces) = at_start(text, &[[0.0, 0.0]], &[]).expect("it has forces");
    assert_forces(
        &forces,
        &[
            // The rope pulls upwards, which shortens it.
            (ForceQuantity::Effort(DriverId(0)), -100.0 * 2.0 / 1.5),
            (ForceQuantity::Reaction(0, 0), 0.0),
            (ForceQuantity::Reaction(0, 1), 100.0 - 100.0 * 2.0 / 1.5),
            (ForceQuantity::Inertia(DriverId(0)), 0.0),
        ],
    );
}

/// The reader warns of them. The spring alone gives the effort 3 φ, with any inertia and centre.
#[test]
fn inertia_and_centre_have_no_effect_without_mass() {
    let spring = "[forces]\n\
                  s = { coordinate = \"angle\", markers = [\"ground.O\", \"rod.O\"], stiffness = 3, free = 0 }\n";
    let text = PENDULUM.replace("mass = 2", "") + spring;
    let (_, forces) = at_start(&text, &[[1.7, -0.6]], &[]).expect("it has forces");
    assert_forces(
        &forces,
        &[
            (ForceQuantity::Effort(SWING), 3.0 * 0.3),
            (ForceQuantity::Inertia(SWING), 0.0),
            (ForceQuantity::Bias(SWING), 3.0 * 0.3),
            (ForceQuantity::Reaction(0, 0), 0.0),
            (ForceQuantity::Reaction(0, 1), 0.0),
            (ForceQuantity::KineticEnergy, 0.0),
        ],
    );
}

#[test]
fn masses_that_parameters_make_negative_are_refused() {
    let text = PENDULUM.replace("mass = 2", "mass = \"1 + m\"") + "\n[parameters]\nm = 1\n";
    let mut solver = Solver::new(Arc::new(parse(&text))).expect("the drivers match");
    let mut path = Path::new(solver.mechanism());
    path.to[0] = -3.0;
    path.from[0] = -3.0;
    solver.assemble(&path).expect("it assembles");
    let mut forces = solver.forces();
    let rates = Rates::new(3);
    let motion = KnownMotion {
        rates: &rates,
        driver_rates: &[Jet::constant(0.0)],
        inputs: &[],
    };
    let refused = solver.solve_forces(motion, ForceParts::ALL, &mut forces);
    let message = refused.expect_err("a mass is negative").to_string();
    assert_eq!(message, "the mass of body `rod` is -2; it must be positive");
}

/// Points that a joint holds together are apart by rounding, which has any direction.
#[test]
fn a_distance_of_rounding_has_no_direction() {
    let text = std::fs::read_to_string("mechanisms/four_bar.toml").expect("it is shipped")
        + "\n[forces]\npull = { coordinate = \"distance\", markers = [\"coupler.B\", \"rocker.B\"] }\n";
    for degrees in 0..36 {
        let text = text.replace("\"60*deg\" }", &format!("\"{}*deg\" }}", 10 * degrees));
        let error = at_start(&text, &[[1.0, 0.0]], &[100.0]).err();
        let error = error.map(|error| error.to_string());
        let expected = "force `pull` has no direction: the distance of its markers is zero";
        assert_eq!(error.as_deref(), Some(expected), "at {degrees}0 deg");
    }
}

//! Friction of what is driven: it adds to the effort of the driver.

use biela::kinematics::{Direction, ForceQuantity, OutputSource, Solution};
use biela::mechanism::DriverId;

use crate::common::{assembled, parse};

/// A body of 2 kg that is pushed along a level guide, against friction of all kinds.
const SLIDER: &str = r#"
format = 1
name = "slider"
[parameters]
coulomb = 3
[ground.markers]
O = [0, 0]
[bodies.slider]
mass = 2
markers = { P = [0, 0] }
[joints]
guide = { type = "translational", markers = ["ground.O", "slider.P"] }
[drivers]
way = { coordinate = "x", markers = ["ground.O", "slider.P"], start = 0 }
[friction]
rail = { of = "way", force = "coulomb", static = "coulomb + 1", stribeck = 0.1, viscous = 5 }
"#;

const EFFORT: ForceQuantity = ForceQuantity::Effort(DriverId(0));

/// Friction at a speed in its direction.
fn friction(speed: f64) -> f64 {
    3.0 + (-(speed / 0.1) * (speed / 0.1)).exp() + 5.0 * speed
}

#[test]
fn friction_adds_to_the_effort_against_the_motion() {
    let (mut solver, _) = assembled(&parse(SLIDER));
    let mut solution = Solution::new(&solver);
    solution.seek_forces(&solver);
    for velocity in [-0.3, -0.05, 0.0, 1e-9, 0.05, 0.3] {
        solution.driver_rates[0].derivatives = [velocity, 0.7];
        solution.solve(&mut solver).expect("it is regular");
        let wanted = match velocity == 0.0 {
            true => 1.4,
            false => 1.4 + velocity.signum() * friction(velocity.abs()),
        };
        assert!(
            (solution.force(EFFORT) - wanted).abs() < 1e-14,
            "{velocity}"
        );
        let own = solution.force(ForceQuantity::Applied(0, 0));
        assert!((own - (1.4 - wanted)).abs() < 1e-14, "{velocity}");
    }
}

#[test]
fn the_effort_changes_with_velocity_and_parameter() {
    let mechanism = parse(SLIDER);
    let (mut solver, _) = assembled(&mechanism);
    let mut solution = Solution::new(&solver);
    solution.seek_forces(&solver);
    solution.driver_rates[0].derivatives = [-0.08, 0.0];
    solution.solve(&mut solver).expect("it is regular");
    let mut by_velocity = Direction::zero(&mechanism);
    by_velocity.drivers[0].derivatives[0] = 1.0;
    let coulomb = mechanism.parameter_id("coulomb").expect("it is there");
    let by_parameter = Direction::by_parameter(&mechanism, coulomb);
    let stay = vec![0.0; solution.loads.len()];
    // ∂/∂v of exp(−(v / 0.1)²) + 5 |v| against the motion, and 1 for each kind of friction.
    let slope = -2.0 * 0.08 / 0.01 * (-0.64_f64).exp() + 5.0;
    for (direction, wanted) in [(by_velocity, slope), (by_parameter, -1.0)] {
        let changes = solution.force_changes(&mut solver, &direction, &stay);
        let changes = changes.expect("they exist").expect("forces are sought");
        let change = changes.change(EFFORT).expect("it exists");
        assert!((change - wanted).abs() < 1e-13, "{change} {wanted}");
    }
    assert!(OutputSource::Force(EFFORT).uses_forces(&mechanism));
}

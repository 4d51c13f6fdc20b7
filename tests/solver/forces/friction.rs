//! Friction of what is driven: it adds to the effort of the driver.

use biela::kinematics::{Direction, DriverPath, ForceQuantity, OutputSource, Path, Solution};
use biela::mechanism::{DriverId, Jet};

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
        let wanted = if velocity == 0.0 {
            1.4
        } else {
            1.4 + velocity.signum() * friction(velocity.abs())
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
    // ∂/∂v of exp(−(v / 0.1)²) + 5 |v| against the motion, and 1 for each kind of friction.
    let slope = -2.0 * 0.08 / 0.01 * (-0.64_f64).exp() + 5.0;
    for (direction, wanted) in [(by_velocity, slope), (by_parameter, -1.0)] {
        let changes = solution.force_changes(&mut solver, &direction);
        let changes = changes.expect("they exist").expect("forces are sought");
        let change = changes.change(EFFORT).expect("it exists");
        assert!((change - wanted).abs() < 1e-13, "{change} {wanted}");
    }
    assert!(OutputSource::Force(EFFORT).uses_forces(&mechanism));
}

/// With an exponent n the force falls as exp(−|v / v_s|ⁿ): the effort, and its changes with the velocity
/// and with n, at speeds of both directions. At n = 1 the slope at rest is finite from each side.
#[test]
fn friction_falls_by_its_exponent() {
    let text = SLIDER
        .replace("coulomb = 3", "coulomb = 3\nn = 1")
        .replace("stribeck = 0.1", "stribeck = 0.1, exponent = \"n\"");
    for exponent in [1.0, 1.37, 2.0, 5.0] {
        let mechanism = parse(&text.replace("n = 1", &format!("n = {exponent}")));
        let (mut solver, _) = assembled(&mechanism);
        let mut solution = Solution::new(&solver);
        solution.seek_forces(&solver);
        for velocity in [-0.17_f64, 1e-9, 0.08] {
            solution.driver_rates[0].derivatives = [velocity, 0.0];
            solution.solve(&mut solver).expect("it is regular");
            let (sign, ratio) = (velocity.signum(), velocity.abs() / 0.1);
            let power = ratio.powf(exponent);
            let wanted = sign * (3.0 + (-power).exp()) + 5.0 * velocity;
            assert!((solution.force(EFFORT) - wanted).abs() < 1e-14);
            let mut by_velocity = Direction::zero(&mechanism);
            by_velocity.drivers[0].derivatives[0] = 1.0;
            let id = mechanism.parameter_id("n").expect("it is there");
            let by_exponent = Direction::by_parameter(&mechanism, id);
            let slope = -exponent * ratio.powf(exponent - 1.0) / 0.1 * (-power).exp() + 5.0;
            let bend = -sign * power * ratio.ln() * (-power).exp();
            for (direction, wanted) in [(by_velocity, slope), (by_exponent, bend)] {
                let changes = solution.force_changes(&mut solver, &direction);
                let changes = changes.expect("they exist").expect("forces are sought");
                let change = changes.change(EFFORT).expect("it exists");
                assert!((change - wanted).abs() < 1e-13, "{change} {wanted}");
            }
        }
    }
}

/// Two arms on pins with friction and a third one that is held at an angle to the second: while the first
/// turns, its pin alone rubs. The rate of the others is the rounding of two angular velocities.
#[test]
fn a_pin_that_does_not_turn_has_no_friction() {
    let text = |friction: &str| {
        format!(
            r#"
format = 1
name = "arms"
[ground.markers]
O = [0, 0]
D = [0, 0.3]
[bodies.a]
mass = 3
inertia = 0.05
center = [0.2, 0]
markers = {{ O = [0, 0], T = [0.4, 0], C = [0.1, 0.2] }}
[bodies.b]
mass = 2
inertia = 0.03
center = [0.15, 0]
markers = {{ O = [0, 0], T = [0.3, 0.1], C = [0.2, 0.1] }}
estimate = [0.4, 0, 0.5]
[joints]
o = {{ type = "revolute", markers = ["ground.O", "a.O"] }}
elbow = {{ type = "revolute", markers = ["a.T", "b.O"] }}
[drivers]
turn = {{ coordinate = "angle", markers = ["ground.O", "a.O"], start = 0.3 }}
hold = {{ coordinate = "distance", markers = ["a.C", "b.C"], start = 0.35 }}
{friction}
"#
        )
    };
    let rubbed = parse(&text(
        "[friction]\nrub = { joint = \"elbow\", coefficient = 0.15, radius = 0.02 }",
    ));
    let plain = parse(&text(""));
    for step in 0..40 {
        let turn = Jet::new(0.3 + 0.05 * f64::from(step), [0.7, 0.1]);
        let efforts = [&rubbed, &plain].map(|mechanism| {
            let (mut solver, _) = assembled(mechanism);
            let mut path = Path::new(mechanism);
            let hold = solver.pose().drivers[1];
            path.driver_paths = vec![
                DriverPath::held(turn.value, 0.3),
                DriverPath::held(hold, hold),
            ];
            solver.track(&path).expect("the arms turn");
            let mut solution = Solution::new(&solver);
            solution.seek_forces(&solver);
            solution.driver_rates = vec![turn, Jet::constant(hold)];
            solution.solve(&mut solver).expect("rates and forces exist");
            [0, 1].map(|driver| solution.force(ForceQuantity::Effort(DriverId(driver))))
        });
        assert_eq!(
            efforts[0].map(f64::to_bits),
            efforts[1].map(f64::to_bits),
            "at {}",
            turn.value
        );
    }
}

/// At the turning point of a driver, whose rate is the rounding of its motion, friction is zero.
#[test]
fn friction_is_zero_at_a_turning_point() {
    let mechanism = parse(
        r#"
format = 1
name = "reversal"
[ground.markers]
O = [0, 0]
[bodies.slider]
mass = 2
markers = { P = [0, 0] }
[joints]
guide = { type = "translational", markers = ["ground.O", "slider.P"] }
[drivers]
way = { coordinate = "x", markers = ["ground.O", "slider.P"], motion = "0.2*sin(3*t)" }
[friction]
rub = { of = "way", force = 50 }
[simulation]
gravity = [0, 0]
"#,
    );
    for turn in 0..20 {
        let time = (f64::from(turn) + 0.5) * std::f64::consts::PI / 3.0;
        let (mut solver, _) = assembled(&mechanism);
        let mut path = Path::new(&mechanism);
        path.duration = time;
        solver.track(&path).expect("the slider moves");
        let mut solution = Solution::new(&solver);
        solution.seek_forces(&solver);
        solution.follow_motions(&solver);
        solution.solve(&mut solver).expect("rates and forces exist");
        let inertia = 2.0 * solution.driver_rates[0].second();
        let effort = solution.force(ForceQuantity::Effort(DriverId(0)));
        assert!(
            (effort - inertia).abs() < 1e-12,
            "{time} s: {effort} {inertia}"
        );
    }
}

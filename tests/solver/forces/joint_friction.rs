//! Friction in the joints of what is driven, against closed forms and finite differences.

use std::sync::Arc;

use biela::kinematics::{Direction, Error, ForceQuantity, Solution};
use biela::mechanism::{DriverId, Mechanism};

use crate::common::{assembled, parse};

const EFFORT: ForceQuantity = ForceQuantity::Effort(DriverId(0));

/// A slider–crank of crank 0.1 m and massless rod 0.3 m that pushes a slider of 2 kg against a load.
fn slider_crank(angle: f64, load: f64, friction: &str) -> Arc<Mechanism> {
    parse(&format!(
        r#"
format = 1
name = "slider_crank"
[parameters]
coefficient = 0.2
[ground.markers]
O = [0, 0]
[bodies.crank]
markers = {{ O = [0, 0], A = [0.1, 0] }}
estimate = [0, 0, {angle}]
[bodies.slider]
mass = 2
markers = {{ B = [0, 0] }}
estimate = [0.35, 0, 0]
[joints]
O = {{ type = "revolute", markers = ["ground.O", "crank.O"] }}
rod = {{ type = "link", markers = ["crank.A", "slider.B"], length = 0.3 }}
guide = {{ type = "translational", markers = ["ground.O", "slider.B"] }}
[drivers]
turn = {{ coordinate = "angle", markers = ["ground.O", "crank.O"], start = {angle} }}
[forces]
push = {{ marker = "slider.B", value = [{load}, 0] }}
[friction]
{friction}
[simulation]
gravity = [0, 0]
"#
    ))
}

fn solved(mechanism: &Arc<Mechanism>, velocity: f64) -> Result<Solution, Error> {
    let (mut solver, _) = assembled(mechanism);
    let mut solution = Solution::new(&solver);
    solution.seek_forces(&solver);
    solution.driver_rates[0].derivatives = [velocity, 0.0];
    solution.solve(&mut solver)?;
    Ok(solution)
}

/// The rod bears S at an angle β to the guide: S cos β = load ± μ S sin β.
#[test]
fn the_rod_presses_the_slider_on_its_guide() {
    let (angle, load, coefficient) = (0.9_f64, 300.0, 0.2);
    let rail = "rail = { joint = \"guide\", coefficient = \"coefficient\" }";
    let mechanism = slider_crank(angle, load, rail);
    let sine = 0.1 * angle.sin() / 0.3;
    let cosine = (1.0 - sine * sine).sqrt();
    // The mass makes no difference so slowly; the slider moves towards the crank as the angle grows.
    for velocity in [1e-9, -1e-9] {
        let solution = solved(&mechanism, velocity).expect("it does not jam");
        let direction = -velocity.signum();
        // Both the load and the rod's force S point outwards along x: S cos β + load = ∓ friction.
        let friction = |rod: f64| coefficient * (rod * sine).abs();
        // Fixed point of a contraction: μ tan β < 1.
        let mut force = -load / cosine;
        for _ in 0..200 {
            force = (-load + direction * friction(force)) / cosine;
        }
        // Torque of the rod's force on the crank, by its arm about O.
        let torque = -0.1 * (angle.sin() * cosine + angle.cos() * sine) * force;
        let found = solution.force(EFFORT);
        assert!(
            (found - torque).abs() < 1e-12 * load,
            "{velocity}: {found} {torque}"
        );
        let size = solution.force(ForceQuantity::Applied(1, 0));
        assert!(
            (size.abs() - friction(force)).abs() < 1e-12 * load,
            "{size}"
        );
        assert!(size * direction < 0.0, "{size} {direction}");
    }
    let still = solved(&mechanism, 0.0).expect("it does not jam");
    assert!(still.force(ForceQuantity::Applied(1, 0)).abs() < f64::MIN_POSITIVE);
}

/// At β the guide has no answer where μ tan β is one or more.
#[test]
fn a_rod_across_its_guide_jams() {
    let angle = std::f64::consts::FRAC_PI_2;
    // tan β = 1 / √8 = 0.354.
    let rail =
        |coefficient: f64| format!("rail = {{ joint = \"guide\", coefficient = {coefficient} }}");
    assert!(solved(&slider_crank(angle, 300.0, &rail(2.8)), 1.0).is_ok());
    let error = solved(&slider_crank(angle, 300.0, &rail(2.9)), 1.0).expect_err("it jams");
    assert_eq!(
        error.to_string(),
        "force `rail` jams here: the reaction that it makes has it grow without end"
    );
}

/// The friction of a pin is a torque of the coefficient, the radius and the force.
#[test]
fn a_pin_resists_by_its_radius() {
    let pin = "pin = { joint = \"O\", coefficient = 0.3, radius = 0.02 }";
    let [free, slow] = [0.0, 1e-9]
        .map(|velocity| solved(&slider_crank(0.9, 300.0, pin), velocity).expect("it does not jam"));
    let sine = 0.1 * 0.9_f64.sin() / 0.3;
    let rod = 300.0 / (1.0 - sine * sine).sqrt();
    let torque = slow.force(EFFORT) - free.force(EFFORT);
    assert!((torque - 0.3 * 0.02 * rod).abs() < 1e-11, "{torque}");
}

/// Efforts change with the velocity, the coefficient and the acceleration as finite differences say.
#[test]
fn the_effort_changes_as_differences_say() {
    let friction = "pin = { joint = \"O\", coefficient = \"coefficient\", static = 0.5, stribeck = 4, radius = 0.02 }\n\
                    rail = { joint = \"guide\", coefficient = \"coefficient\", viscous = 3 }";
    let mechanism = slider_crank(0.9, 300.0, friction);
    let id = mechanism.parameter_id("coefficient").expect("it is there");
    let (mut solver, _) = assembled(&mechanism);
    let mut solution = Solution::new(&solver);
    solution.seek_forces(&solver);
    let effort = |velocity: f64, acceleration: f64, coefficient: f64| {
        let mut other = (*mechanism).clone();
        other.parameters[id.index()].default = coefficient;
        let other = Arc::new(other);
        let (mut solver, _) = assembled(&other);
        let mut solution = Solution::new(&solver);
        solution.seek_forces(&solver);
        solution.driver_rates[0].derivatives = [velocity, acceleration];
        solution.solve(&mut solver).expect("it does not jam");
        solution.force(EFFORT)
    };
    let at = [3.0, 2.0, 0.2];
    solution.driver_rates[0].derivatives = [at[0], at[1]];
    solution.solve(&mut solver).expect("it does not jam");
    for place in 0..3 {
        let mut direction = Direction::zero(&mechanism);
        match place {
            0 | 1 => direction.drivers[0].derivatives[place] = 1.0,
            _ => direction = Direction::by_parameter(&mechanism, id),
        }
        let changes = solution.force_changes(&mut solver, &direction);
        let changes = changes.expect("they exist").expect("forces are sought");
        let found = changes.change(EFFORT).expect("it exists");
        let difference = |h: f64| {
            let [above, below] = [h, -h].map(|h| {
                let mut at = at;
                at[place] += h;
                effort(at[0], at[1], at[2])
            });
            (above - below) / (2.0 * h)
        };
        let wanted = (4.0 * difference(5e-3) - difference(1e-2)) / 3.0;
        // Differences of order 4 over 0.01.
        assert!(
            (found - wanted).abs() < 1e-8 * (1.0 + wanted.abs()),
            "{place}: {found} {wanted}"
        );
    }
}

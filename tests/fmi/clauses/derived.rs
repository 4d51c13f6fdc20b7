//! Measures that are computed from others.

use std::sync::Arc;

use biela::fmi::{Interface, Version, describe};
use biela::mechanism::Mechanism;

use crate::clauses::{get, set, started, vr};
use crate::common::{Instance, assembled, instance_of, parse};

/// The four-bar linkage with a transmission angle folded to 90° and a ratio of velocities.
fn mechanism() -> Arc<Mechanism> {
    let text = include_str!("../../../mechanisms/four_bar.toml");
    let measures = "[measures]\n\
        folded = { value = \"min(transmission.position, pi - transmission.position)\", unit = \"rad\" }\n\
        ratio = { value = \"rocker.omega/crank_angle.velocity\", unit = \"1\", description = \"ratio\" }\n\
        scaled = { value = \"coupler.P.x/crank_length\" }\n";
    parse(&text.replace("[measures]\n", measures))
}

/// Returns an instance after a step with the crank at `angle`, at `speed` and with `acceleration`.
fn moved(angle: f64, speed: f64, acceleration: f64) -> Instance {
    let mut instance = started(instance_of(mechanism(), Interface::CoSimulation));
    set(
        &mut instance,
        [
            ("crank_angle.position", angle),
            ("crank_angle.velocity", speed),
            ("crank_angle.acceleration", acceleration),
        ],
    );
    instance.do_step(0.0, 0.1).expect("it moves");
    instance
}

#[test]
fn their_values_are_functions_of_the_other_outputs() {
    for angle in [1.2, 2.5, 4.0, 5.5] {
        let mut instance = moved(angle, 3.0, 0.7);
        let [folded, ratio, scaled, transmission, omega, x] = get(
            &mut instance,
            [
                "folded",
                "ratio",
                "scaled",
                "transmission.position",
                "rocker.omega",
                "coupler.P.x",
            ],
        );
        assert_eq!(
            folded,
            transmission.min(std::f64::consts::PI - transmission)
        );
        assert_eq!(ratio, omega / 3.0);
        assert_eq!(scaled, x / 0.1);
    }
}

/// With ω4 = r(φ) ω2: α4 = r′ ω2² + r α2. Rounding of some quotients.
#[test]
fn their_directional_derivatives_are_exact() {
    let (speed, acceleration) = (3.0, 0.7);
    let mut instance = moved(2.5, speed, acceleration);
    let [ratio, alpha] = get(&mut instance, ["ratio", "rocker.alpha"]);
    let unknown = [vr(&instance, "ratio")];
    let mut along = |name: &str| {
        let known = [vr(&instance, name)];
        let found = instance.directional_derivative(&unknown, &known, &[1.0]);
        found.expect("it exists")[0]
    };
    let slope = (alpha - ratio * acceleration) / (speed * speed);
    assert!((along("crank_angle.position") - slope).abs() < 1e-14);
    assert!(along("crank_angle.velocity").abs() < 1e-15);
    assert_eq!(along("crank_angle.acceleration"), 0.0);
}

#[test]
fn they_depend_on_the_inputs_of_what_they_use() {
    let (solver, _) = assembled(&mechanism());
    let description = describe(solver.mechanism(), solver.structure(), Version::Fmi2);
    let reference = |name: &str| {
        let mut variables = description.variables.iter();
        let found = variables.position(|v| v.name == name);
        biela::fmi::value_reference(found.expect("it is there"))
    };
    let of = |name: &str| {
        let mut unknowns = description.initial_unknowns.iter();
        let unknown = unknowns.find(|unknown| unknown.value_reference == reference(name));
        &unknown.expect("it is an unknown").dependencies
    };
    let [position, velocity, crank] = [
        "crank_angle.position",
        "crank_angle.velocity",
        "crank_length",
    ]
    .map(reference);
    for (name, needs_velocity) in [("folded", false), ("ratio", true), ("scaled", false)] {
        let dependencies = of(name);
        assert!(dependencies.contains_key(&position) && dependencies.contains_key(&crank));
        assert_eq!(
            dependencies.contains_key(&velocity),
            needs_velocity,
            "{name}"
        );
    }
}

/// A ratio of velocities has no value at rest.
#[test]
fn a_ratio_at_rest_is_no_number() {
    let mut instance = started(instance_of(mechanism(), Interface::CoSimulation));
    let [ratio, folded] = get(&mut instance, ["ratio", "folded"]);
    assert!(ratio.is_nan());
    assert!(folded > 0.0);
}

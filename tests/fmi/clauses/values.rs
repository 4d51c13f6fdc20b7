//! Values of variables: output derivatives (4.2.1), limits (2.2.3), names of types (2.2.3).

use std::collections::BTreeSet;

use biela::fmi::{Causality, Error, Interface, Status, Variability, Version, describe};

use crate::clauses::{get, running, set, started, vr};
use crate::common::mechanisms::crank;
use crate::common::{
    Instance, assembled, co_simulation, folder, instance_of, parse, shipped, stems,
};

/// "If the actual order is lower, the retrieved value is 0", with `fmi2OK`.
#[test]
fn output_derivatives_beyond_the_known_ones_are_zero() {
    let mut instance = running("four_bar");
    set(
        &mut instance,
        [
            ("crank_angle.velocity", 3.0),
            ("crank_angle.acceleration", -4.0),
        ],
    );
    instance.do_step(0.0, 0.1).expect("the crank stands");
    let [omega, alpha] = get(&mut instance, ["rocker.omega", "rocker.alpha"]);
    let asked = [
        ("rocker.phi", 1, omega),
        ("rocker.phi", 2, alpha),
        ("rocker.omega", 1, alpha),
        ("rocker.omega", 2, 0.0),
        ("rocker.alpha", 1, 0.0),
        ("rocker.alpha", 2, 0.0),
    ];
    let references = asked.map(|(name, ..)| vr(&instance, name));
    let orders = asked.map(|(_, order, _)| order);
    let found = instance.output_derivatives(&references, &orders);
    let found: Vec<_> = found.expect("up to the declared order").collect();
    assert_eq!(found, asked.map(|(.., expected)| expected));
    for order in [0, 3, -1] {
        let orders = [order];
        let refused = instance.output_derivatives(&references[..1], &orders);
        let error = refused.map(|_| ()).expect_err("orders are 1 and 2");
        assert_eq!(error.status(), Status::Error);
        let expected = format!("cannot be of order {order}; expected 1 to 2");
        assert!(error.to_string().ends_with(&expected), "{error}");
    }
}

/// The file gives the settings their start values (2.2.7), which a reset restores.
#[test]
fn the_file_gives_the_settings_their_start_values() {
    let text = std::fs::read_to_string(folder("mechanisms").join("four_bar.toml"));
    let text = text.expect("it is shipped");
    let settings = "[simulation]\nrates = 'inputs'\nextrapolation = 'taylor'\n";
    let mechanism = parse(&text.replace("[simulation]\n", settings));
    let mut instance = instance_of(mechanism, Interface::CoSimulation);
    let settings = ["rates", "extrapolation"].map(|name| vr(&instance, name));
    let values = |instance: &mut Instance| -> Vec<i32> {
        instance.integers(&settings).expect("legal").collect()
    };
    instance.set_integer(&settings, &[1, 1]).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    assert_eq!(values(&mut instance), [1, 1]);
    instance.reset().expect("legal");
    let mut instance = started(instance);
    assert_eq!(values(&mut instance), [2, 2]);
    // `auto` would estimate the velocity, which nobody has set.
    set(&mut instance, [("crank_angle.position", 1.3)]);
    instance.do_step(0.0, 0.1).expect("the crank turns freely");
    assert_eq!(get(&mut instance, ["crank.phi", "crank.omega"]), [1.3, 0.0]);
    // `hold` would leave the angle.
    set(&mut instance, [("crank_angle.velocity", 3.0)]);
    instance.do_step(0.1, 0.1).expect("the crank turns freely");
    let [phi, omega] = get(&mut instance, ["crank.phi", "crank.omega"]);
    // Rounding of an angle of the order of one.
    assert!((phi - (1.3 + 0.1 * 3.0)).abs() < 1e-14, "{phi}");
    assert_eq!(omega, 3.0);
}

/// "On a fixed or tunable parameter `fmi2Status = fmi2Discard` is returned"; so the instance can be
/// used on, which it could not after an error (2.1.3, 2.1.6).
#[test]
fn a_parameter_outside_its_limits_is_discarded() {
    let mut instance = co_simulation("four_bar");
    let length = vr(&instance, "crank_length");
    let rates = vr(&instance, "rates");
    let error = instance.set_real(&[length], &[0.0]).expect_err("too short");
    assert!(matches!(error, Error::Range { .. }));
    assert_eq!(error.status(), Status::Discard);
    let error = instance.set_integer(&[rates], &[4]).expect_err("no item");
    assert_eq!(error.status(), Status::Discard);
    // A value that no limit concerns is an error still.
    let error = instance.set_real(&[length], &[f64::NAN]).expect_err("NaN");
    assert_eq!(error.status(), Status::Error);
    let mut instance = started(instance);
    assert_eq!(get(&mut instance, ["crank_length"]), [0.1]);
    instance.terminate().expect("nothing has failed");
}

/// A calculated parameter keeps to its limits too, judged with all values set.
#[test]
fn derived_parameters_keep_to_their_limits() {
    let parameters = "[parameters]\n\
        half = { value = 0.3, unit = 'm', tunable = true }\n\
        whole = { value = '2*half', unit = 'm', min = 0.5, max = 0.8 }\n";
    let mechanism = parse(&(crank("start = 0") + parameters));
    let mut instance = instance_of(mechanism.clone(), Interface::CoSimulation);
    set(&mut instance, [("half", 0.2)]);
    instance.setup_experiment(0.0, None).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    let refused = instance.exit_initialization_mode().unwrap_err().to_string();
    let expected = "`whole` = 0.4 is below `min` = 0.5; it follows from other parameters";
    assert!(refused.contains(expected), "{refused}");

    let mut instance = started(instance_of(mechanism, Interface::CoSimulation));
    // The limit itself is a value.
    set(&mut instance, [("half", 0.4)]);
    instance.do_step(0.0, 0.1).expect("it may be 0.8");
    set(&mut instance, [("half", 0.41)]);
    let refused = instance.do_step(0.1, 0.1).unwrap_err();
    assert_eq!(refused.status(), Status::Discard);
    assert!(
        refused.to_string().contains("is above `max` = 0.8"),
        "{refused}"
    );
}

/// A plate of w by h: its mass is m = 20 w h, its centre at half its sides, its inertia m (w² + h²)/12.
#[test]
fn masses_of_shapes_are_calculated_parameters() {
    let mechanism = parse(
        "format = 1\nname = 'plate'\n\
         [parameters]\nw = { value = 0.3, unit = 'm', tunable = true }\n\
         h = { value = 0.2, unit = 'm' }\n\
         [ground.markers]\nO = [0, 0]\n\
         [bodies.plate]\nthickness = 0.01\ndensity = 2000\n\
         markers = { O = [0, 0], B = ['w', 0], C = ['w', 'h'], D = [0, 'h'] }\n\
         shapes.all = { outline = ['O', 'B', 'C', 'D'] }\n\
         [joints]\nO = { type = 'revolute', markers = ['ground.O', 'plate.O'] }\n\
         [drivers]\nturn = { coordinate = 'angle', markers = ['ground.O', 'plate.O'], start = 0 }\n",
    );
    let names = ["mass", "center_x", "center_y", "inertia"].map(|name| format!("plate.{name}"));
    let names = names.each_ref().map(String::as_str);
    let of = |w: f64, h: f64| {
        let mass = 20.0 * w * h;
        [mass, w / 2.0, h / 2.0, mass * (w * w + h * h) / 12.0]
    };
    // The largest number is 1.6; each is a sum over four edges.
    let assert_near = |found: &[f64], truth: [f64; 4]| {
        let off = found
            .iter()
            .zip(truth)
            .map(|(found, truth)| (found - truth).abs());
        assert!(
            off.fold(0.0, f64::max) < 20.0 * f64::EPSILON,
            "{found:?} {truth:?}"
        );
    };
    let mut instance = instance_of(mechanism, Interface::CoSimulation);
    set(&mut instance, [("h", 0.1)]);
    instance.setup_experiment(0.0, None).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    assert_near(&get(&mut instance, names), of(0.3, 0.1));
    let references = names.map(|name| vr(&instance, name));
    let w = vr(&instance, "w");
    let found = instance.directional_derivative(&references, &[w], &[1.0]);
    let inertia = 20.0 * 0.1 * (3.0 * 0.3 * 0.3 + 0.1 * 0.1) / 12.0;
    assert_near(&found.expect("it exists"), [2.0, 0.5, 0.0, inertia]);
    instance.exit_initialization_mode().expect("it starts");
    set(&mut instance, [("w", 0.8)]);
    instance.do_step(0.0, 0.1).expect("it stands");
    assert_near(&get(&mut instance, names), of(0.8, 0.1));
    let refused = instance.set_real(&references[..1], &[1.0]).unwrap_err();
    assert!(
        refused.to_string().contains("`plate.mass` cannot be set"),
        "{refused}"
    );
    let kinds = instance.variables().iter();
    let kinds = kinds.filter(|variable| variable.causality == Causality::CalculatedParameter);
    let tunable: Vec<_> = kinds
        .map(|kind| (kind.name.as_str(), kind.variability))
        .collect();
    assert_eq!(tunable, names.map(|name| (name, Variability::Tunable)));
}

/// The names of types and variables of a mechanism.
fn names(xml: &str, element: &str) -> BTreeSet<String> {
    let start = format!("<{element} name=\"");
    let found = xml.split(&start).skip(1);
    let name = |rest: &str| {
        rest.split('"')
            .next()
            .expect("the attribute ends")
            .to_owned()
    };
    found.map(name).collect()
}

/// "`name` of a `SimpleType` must be different to all `name` attributes of `ScalarVariable`s."
#[test]
fn no_variable_has_the_name_of_a_type() {
    let text = std::fs::read_to_string(folder("mechanisms").join("four_bar.toml"));
    let mut text = text.expect("it is shipped");
    // Parameters and bodies that are called as types might be.
    for (own, name) in [
        ("crank_length", "Length"),
        ("rocker_length", "Angle"),
        ("coupler_length", "Rates"),
        ("base", "Extrapolation"),
        ("crank_angle", "biela"),
        ("rocker", "Velocity"),
    ] {
        text = text.replace(own, name);
    }
    let mut mechanisms: Vec<_> = stems("mechanisms", "toml")
        .iter()
        .map(|name| shipped(name))
        .collect();
    mechanisms.push(parse(&text));
    for mechanism in mechanisms {
        let (solver, _) = assembled(&mechanism);
        let xml = describe(solver.mechanism(), solver.structure(), Version::Fmi2).write(None);
        let xml = String::from_utf8(xml).expect("XML is text");
        let (types, variables) = (names(&xml, "SimpleType"), names(&xml, "ScalarVariable"));
        assert!(!types.is_empty() && !variables.is_empty());
        let both: Vec<_> = types.intersection(&variables).collect();
        assert!(both.is_empty(), "{}: {both:?}", mechanism.name);
    }
}

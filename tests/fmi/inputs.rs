//! Inputs of the file, and forces with corners, as hosts see them.

use std::sync::Arc;

use biela::fmi::{Call, Causality, Interface, MechanismModel, StepProgress, Version};
use biela::mechanism::Mechanism;

use crate::clauses::{get, set, started, vr};
use crate::common::log::Heard;
use crate::common::{Instance, instance_of, parse, shipped};

/// A block of 2 kg, pushed by a force of 3 N per unit of an input and held back by a damper.
fn block() -> Arc<Mechanism> {
    parse(
        r#"
format = 1
name = "block"
[inputs]
push = { start = 1, max = 4, unit = "N" }
[ground.markers]
O = [0, 0]
[bodies.block]
markers = { B = [0, 0] }
mass = 2
[joints]
guide = { type = "translational", markers = ["ground.O", "block.B"] }
[freedoms]
x = { coordinate = "x", markers = ["ground.O", "block.B"] }
[forces]
motor = { coordinate = "x", markers = ["ground.O", "block.B"], value = "3*push - 0.5*x.velocity" }
idle = { coordinate = "x", markers = ["ground.O", "block.B"] }
"#,
    )
}

fn begun(version: Version) -> Instance {
    if version == Version::Fmi2 {
        return started(instance_of(block(), Interface::CoSimulation));
    }
    let model = MechanismModel::new(block(), Interface::CoSimulation).expect("it assembles");
    let sink = Box::new(Heard::default());
    let mut instance = Instance::of_version(version, model, sink, false);
    instance
        .enter_initialization_mode_at(0.0, None)
        .expect("legal");
    instance.exit_initialization_mode().expect("it starts");
    instance
}

/// The input holds during a step, and acts from its step on: 2 v′ = 3 u − v/2 in closed form.
#[test]
fn an_input_acts_during_its_steps() {
    for version in [Version::Fmi2, Version::Fmi3] {
        let mut instance = begun(version);
        let (mut x, mut v) = (0.0_f64, 0.0_f64);
        let rate: f64 = 0.25;
        for (step, push) in (0..).zip([None, Some(3.0), Some(-1.0), Some(0.0)]) {
            if let Some(push) = push {
                set(&mut instance, [("push", push)]);
            }
            let push = push.unwrap_or(1.0);
            let [found] = get(&mut instance, ["push"]);
            assert_eq!(found.to_bits(), push.to_bits());
            if version == Version::Fmi2 {
                let [acceleration] = get(&mut instance, ["x.acceleration"]);
                assert!((acceleration - (1.5 * push - rate * v)).abs() < 1e-8);
            }
            let (t, h) = (0.5 * f64::from(step), 0.5);
            match version {
                Version::Fmi2 => instance.do_step(t, h).expect("it moves"),
                _ => {
                    let progress = instance.begin_step(t, h).expect("it moves");
                    assert!(matches!(progress, StepProgress::Done(_)), "{progress:?}");
                }
            }
            let (last, decay) = (1.5 * push / rate, (-rate * h).exp());
            x += last * h + (v - last) * (1.0 - decay) / rate;
            v = last + (v - last) * decay;
            let found = get(&mut instance, ["x.position", "x.velocity"]);
            assert!(
                (found[0] - x).abs() < 1e-8 && (found[1] - v).abs() < 1e-8,
                "{found:?}"
            );
        }
    }
}

/// Its value reference stands behind those of all other variables, which keep theirs.
#[test]
fn value_references_of_inputs_stand_at_the_end() {
    let text_of = |with: bool| {
        let mut mechanism = (*block()).clone();
        if !with {
            mechanism.inputs.clear();
            for force in &mut mechanism.forces {
                let zero = biela::mechanism::Expression::constant(0.0);
                force.load.set_component(0, zero);
            }
            mechanism.forces.pop();
        }
        Arc::new(mechanism)
    };
    let names = |mechanism| {
        let instance = instance_of(mechanism, Interface::CoSimulation);
        let names = instance
            .variables()
            .iter()
            .map(|variable| variable.name.clone());
        names.collect::<Vec<_>>()
    };
    let all = names(text_of(true));
    assert_eq!(all.last().map(String::as_str), Some("push"));
    let before: Vec<_> = all
        .iter()
        .filter(|name| !name.starts_with("idle"))
        .collect();
    let without = names(text_of(false));
    assert!(
        without
            .iter()
            .eq(before[..before.len() - 1].iter().copied())
    );
}

#[test]
fn accelerations_depend_on_inputs() {
    let mut instance = begun(Version::Fmi3);
    let place = vr(&instance, "push");
    let variable = &instance.variables()[place as usize - 1];
    assert_eq!(variable.causality, Causality::Input);
    for name in ["x.acceleration", "motor.effort"] {
        let of = vr(&instance, name);
        let known = instance
            .dependencies(Call::GetVariableDependencies, of)
            .expect("legal");
        assert!(
            known.iter().any(|(vr, _)| *vr == place),
            "{name}: {known:?}"
        );
    }
    let of = [vr(&instance, "x.acceleration")];
    let found = instance
        .directional_derivative(&of, &[place], &[1.0])
        .expect("it exists");
    assert!((found[0] - 1.5).abs() < 1e-12);
}

/// A value beyond a limit acts, and is told once.
#[test]
fn a_value_beyond_its_limit_is_told() {
    let heard = Heard::default();
    let mut instance = started(heard.instance(block(), Interface::CoSimulation, true));
    for step in 0..3 {
        set(&mut instance, [("push", 5.0)]);
        instance
            .do_step(0.1 * f64::from(step), 0.1)
            .expect("it moves");
    }
    let told = heard.take(biela::fmi::Category::Warning);
    let told: Vec<_> = told
        .iter()
        .filter(|text| text.contains("input `push`"))
        .collect();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(
        told[0].contains("is at 5 N, beyond its `max` = 4 N"),
        "{told:?}"
    );
}

/// A function that leaves its points is told once, with its instant; not where its points repeat.
#[test]
fn a_function_beyond_its_points_is_advice() {
    let told = |ends: &str| {
        let mechanism = parse(&format!(
            r#"
format = 1
name = "block"
[inputs]
level = {{ start = 0 }}
[functions]
curve = {{ table = [[0, 0], [0.25, 1], [0.5, 3]]{ends} }}
[ground.markers]
O = [0, 0]
[bodies.block]
markers = {{ B = [0, 0] }}
mass = 2
[joints]
guide = {{ type = "translational", markers = ["ground.O", "block.B"] }}
[freedoms]
x = {{ coordinate = "x", markers = ["ground.O", "block.B"] }}
[forces]
motor = {{ coordinate = "x", markers = ["ground.O", "block.B"], value = "curve(t)" }}
"#
        ));
        let heard = Heard::default();
        let mut instance = started(heard.instance(mechanism, Interface::CoSimulation, true));
        for step in 0..10 {
            instance
                .do_step(0.1 * f64::from(step), 0.1)
                .expect("it moves");
        }
        let told = heard.take(biela::fmi::Category::Warning);
        let told = told
            .into_iter()
            .filter(|text| text.contains("function `curve`"));
        told.collect::<Vec<_>>()
    };
    let once = told("");
    assert_eq!(once.len(), 1, "{once:?}");
    assert!(
        once[0].contains("beyond its points from 0 to 0.5"),
        "{once:?}"
    );
    let time = once[0]
        .strip_prefix("t = ")
        .and_then(|told| told.split(' ').next());
    let time: f64 = time
        .and_then(|time| time.parse().ok())
        .expect("it begins with the time");
    assert!(0.5 < time && time <= 0.6, "{once:?}");
    assert!(told(", ends = \"periodic\"").is_empty());
}

/// A saved state goes on with the same bits, also beside a corner of a force and behind the bounce at a stop.
#[test]
fn a_servo_goes_on_from_a_saved_state() {
    let begun = || started(instance_of(shipped("servo_arm"), Interface::CoSimulation));
    let go_on = |instance: &mut Instance, from: u32, to: u32| {
        let steps = (from..to).map(|step| {
            instance
                .do_step(0.01 * f64::from(step), 0.01)
                .expect("it moves");
            get(
                instance,
                ["angle.position", "angle.velocity", "angle.acceleration"],
            )
            .map(f64::to_bits)
        });
        steps.collect::<Vec<_>>()
    };
    // The voltage leaves its limit in the twelfth step, the arm meets its stop in the sixteenth.
    for saved in [5, 11, 12, 15, 16] {
        let mut straight = begun();
        go_on(&mut straight, 0, saved);
        let state = straight.fmu_state().expect("legal");
        let bytes = straight.serialize_fmu_state(&state).expect("its own");
        let expected = go_on(&mut straight, saved, 20);
        let mut other = begun();
        go_on(&mut other, 0, 3);
        let read = other.deserialize_fmu_state(&bytes).expect("untouched");
        other.set_fmu_state(&read).expect("the same mechanism");
        assert_eq!(go_on(&mut other, saved, 20), expected, "{saved}");
    }
}

/// In model exchange the instant at which a force bends is a zero of an event indicator.
#[test]
fn an_event_indicator_tells_a_corner() {
    let mut instance = started(instance_of(shipped("servo_arm"), Interface::ModelExchange));
    // Two of the stop, two of the voltage's table.
    let mut at = |angle: f64, velocity: f64| {
        instance
            .set_continuous_states(&[angle, velocity])
            .expect("legal");
        let indicators = instance.event_indicators(4).expect("they exist");
        indicators.collect::<Vec<f64>>()
    };
    // 90 V/rad (60° − φ) − 0.3 V s/rad ω against 24 V.
    let goal = 60_f64.to_radians();
    let beyond = at(0.2, 0.0);
    let inside = at(goal - 0.1, 0.0);
    let signs = |values: &[f64]| values[2..].iter().map(|v| *v > 0.0).collect::<Vec<_>>();
    assert_eq!(signs(&beyond), [true, true], "{beyond:?}");
    assert_ne!(signs(&inside), signs(&beyond), "{inside:?}");
    let asked = 90.0 * 0.1;
    assert!(
        inside[2..]
            .iter()
            .any(|value| (value - (asked - 24.0)).abs() < 1e-9),
        "{inside:?}"
    );
}

/// A slider that a driver moves: by the height of a level and by time, or as an FMI input.
fn slider(driver: &str) -> Arc<Mechanism> {
    parse(&format!(
        r#"
format = 1
name = "slider"
[inputs]
level = {{ start = 0.5 }}
[parameters]
share = {{ value = 0.2, tunable = true }}
base = "share/2"
[ground.markers]
O = [0, 0]
[bodies.block]
markers = {{ B = [0, 0] }}
mass = 2
[joints]
guide = {{ type = "translational", markers = ["ground.O", "block.B"] }}
[drivers]
x = {{ coordinate = "x", markers = ["ground.O", "block.B"], {driver} }}
[forces]
wind = {{ coordinate = "x", markers = ["ground.O", "block.B"], value = "-level*x.velocity" }}
"#
    ))
}

const FOLLOWING: &str = r#"motion = "share*level^2 + base + 0.1*t""#;
const DRIVEN: &str = "start = 0.15";

/// The value of the motion for a level.
fn followed(level: f64, t: f64) -> f64 {
    0.2 * level * level + 0.1 + 0.1 * t
}

/// A driver that follows an input moves as one does that the host sets to the same values: positions, rates
/// and efforts, for each source of rates and each extrapolation, and with input derivatives.
#[test]
fn a_driver_that_follows_an_input_moves_as_an_input() {
    for (rates, extrapolation) in [(1, 1), (3, 1), (1, 2)] {
        let [mut follower, mut driven] = [FOLLOWING, DRIVEN].map(|driver| {
            let mut instance = instance_of(slider(driver), Interface::CoSimulation);
            instance.setup_experiment(0.0, None).expect("legal");
            let settings = ["rates", "extrapolation"].map(|name| vr(&instance, name));
            instance
                .set_integer(&settings, &[rates, extrapolation])
                .expect("legal");
            instance.enter_initialization_mode().expect("legal");
            instance.exit_initialization_mode().expect("it starts");
            instance
        });
        let h = 0.1;
        for step in 0..20 {
            let t = h * f64::from(step);
            let (level, rate) = (0.5 + (2.0 * t).sin(), 2.0 * (2.0 * t).cos());
            set(&mut follower, [("level", level)]);
            set(
                &mut driven,
                [("level", level), ("x.position", followed(level, t))],
            );
            if step > 10 {
                let reference = [vr(&follower, "level")];
                follower
                    .set_real_input_derivatives(&reference, &[1], &[rate])
                    .expect("legal");
                let reference = [vr(&driven, "level")];
                driven
                    .set_real_input_derivatives(&reference, &[1], &[rate])
                    .expect("legal");
                let reference = [vr(&driven, "x.position"); 2];
                let path = [0.4 * level * rate + 0.1, 0.4 * rate * rate];
                driven
                    .set_real_input_derivatives(&reference, &[1, 2], &path)
                    .expect("legal");
            }
            follower.do_step(t, h).expect("it moves");
            driven.do_step(t, h).expect("it moves");
            let names = ["block.x", "block.vx", "block.ax", "x.effort", "wind.effort"];
            let pairs = get(&mut follower, names)
                .into_iter()
                .zip(get(&mut driven, names));
            for ((found, expected), name) in pairs.zip(names) {
                let off = (found - expected).abs() / (1.0 + expected.abs());
                assert!(
                    off < 1e-11,
                    "{rates} {extrapolation} {t} {name}: {found} {expected}"
                );
            }
        }
    }
}

/// Derivatives by the input and by parameters, against differences, and the dependencies.
#[test]
fn derivatives_of_what_follows_an_input_are_those_of_differences() {
    let mut instance = instance_of(slider(FOLLOWING), Interface::CoSimulation);
    instance.setup_experiment(0.0, None).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    set(&mut instance, [("level", 0.8)]);
    let unknowns = ["block.x", "block.vx", "x.effort"].map(|name| vr(&instance, name));
    for (known, slope) in [("level", 0.4 * 0.8), ("share", 0.64 + 0.5)] {
        let known = vr(&instance, known);
        let exact = instance
            .directional_derivative(&unknowns, &[known], &[1.0])
            .expect("it exists");
        let found = crate::differences::differences(&mut instance, &unknowns, known);
        assert!((exact[0] - slope).abs() < 1e-12, "{exact:?}");
        for (exact, found) in exact.iter().zip(&found) {
            assert!((exact - found).abs() < 1e-7, "{exact} {found}");
        }
        let known_of = instance.dependencies(Call::GetVariableDependencies, unknowns[0]);
        assert!(known_of.is_err() || known_of.expect("legal").iter().any(|(vr, _)| *vr == known));
    }
    let names: Vec<_> = instance
        .variables()
        .iter()
        .map(|v| v.name.clone())
        .collect();
    assert!(
        names.contains(&"x.position".to_owned()),
        "it is an output: {names:?}"
    );
}

/// In model exchange no step tells the rates.
#[test]
fn following_an_input_is_refused_in_model_exchange() {
    let refused = MechanismModel::new(slider(FOLLOWING), Interface::ModelExchange);
    let error = refused.map(|_| ()).expect_err("no rates").to_string();
    assert!(error.starts_with("driver `x` follows an input"), "{error}");
}

//! Forces as variables of an FMU.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use biela::fmi::{
    Category, Causality, Instance, Interface, Kind, MechanismModel, Quantity, Sink, Status,
};
use biela::kinematics::{ForceQuantity, OutputSource};
use biela::mechanism::{DriverId, Indeterminate, Mechanism};

use crate::common::{instance_of, parse, shipped, stems};
use crate::differences::{DIFFERENCE, differences, move_inputs, references};
use crate::forces::loaded::loaded;

/// Returns an instance in initialization mode, with all inputs moved on.
fn moving(mechanism: Mechanism) -> crate::common::Instance {
    let mut instance = instance_of(Arc::new(mechanism), Interface::CoSimulation);
    move_inputs(&mut instance);
    instance
}

/// Errors are relative to the largest derivative or value of the same unit.
#[test]
fn every_derivative_of_a_force_agrees_with_differences() {
    for name in stems("mechanisms", "toml") {
        let mut mechanism = loaded(&name);
        mechanism.outputs.indeterminate = Indeterminate::MinimumNorm;
        let mut instance = moving(mechanism);
        let unknowns = references(&instance, |v| {
            matches!(v.quantity, Quantity::Output(OutputSource::Force(_)))
        });
        let knowns = references(&instance, |variable| {
            variable.causality == Causality::Input
                || variable.causality == Causality::Parameter && variable.kind.is_real()
        });
        let values: Vec<f64> = instance.reals(&unknowns).expect("it closes").collect();
        let unit = |instance: &crate::common::Instance, place: usize| match instance.variables()
            [unknowns[place] as usize]
            .kind
        {
            Kind::Real { unit, .. } => unit.expect("forces have units").name,
            _ => unreachable!("forces are Reals"),
        };
        for known in knowns {
            let exact = instance
                .directional_derivative(&unknowns, &[known], &[1.0])
                .unwrap_or_else(|error| panic!("{name}: {error}"));
            let differences = differences(&mut instance, &unknowns, known);
            let mut largest: BTreeMap<String, f64> = BTreeMap::new();
            for (place, exact) in exact.iter().enumerate() {
                let largest = largest
                    .entry(unit(&instance, place).to_string())
                    .or_insert(1.0);
                *largest = largest.max(exact.abs()).max(values[place].abs());
            }
            for (place, (exact, difference)) in exact.iter().zip(differences).enumerate() {
                assert!(
                    (exact - difference).abs() <= DIFFERENCE * largest[&*unit(&instance, place)],
                    "{name}: `{}` by `{}`: {exact} and {difference}",
                    instance.variables()[unknowns[place] as usize].name,
                    instance.variables()[known as usize].name,
                );
            }
        }
    }
}

/// A log that keeps the warnings.
#[derive(Clone, Default)]
struct Warnings(Arc<Mutex<Vec<String>>>);

impl Sink for Warnings {
    fn write(&self, _: Status, category: Category, message: &str) {
        if category == Category::Warning {
            self.0.lock().expect("one thread").push(message.to_owned());
        }
    }
}

/// Cam and roller move as a slider–crank, e = 5 mm and l = 28 mm. At the top the roller
/// accelerates by −e ω² (1 + e/l), where the spring presses with 82 N on 0.12 kg: beyond 343 rad/s
/// the follower would fly. One warning per turn.
#[test]
fn a_contact_that_pulls_is_reported_once_per_excursion() {
    for (omega, expected) in [(335.0, 0), (351.0, 2)] {
        let warnings = Warnings::default();
        let mechanism = shipped("valve_train");
        let model = MechanismModel::new(mechanism, Interface::CoSimulation).expect("it closes");
        let mut instance = Instance::new(model, Box::new(warnings.clone()), true);
        instance.setup_experiment(0.0, None).expect("legal");
        instance.set_real(&[1, 2], &[-0.8, omega]).expect("legal");
        instance.enter_initialization_mode().expect("legal");
        instance.exit_initialization_mode().expect("legal");
        // From before the top, over two of them.
        let steps = 100;
        let h = 1.5 * std::f64::consts::TAU / omega / f64::from(steps);
        for step in 0..steps {
            let t = h * f64::from(step);
            let angle = -0.8 + omega * (t + h);
            instance.set_real(&[1, 2], &[angle, omega]).expect("legal");
            instance.do_step(t, h).expect("the way is free");
        }
        let found = warnings.0.lock().expect("one thread");
        let lifted = found.iter().filter(|message| message.contains("lift off"));
        assert_eq!(lifted.count(), expected, "{found:?}");
        let all_contact = found.iter().all(|message| message.contains("`contact`"));
        assert!(all_contact, "{found:?}");
    }
}

/// The counterweight of a sash that accelerates faster than gravity cannot follow: its cord would
/// have to push. The acceleration is −0.2 m ω² sin ωt; one warning per period.
#[test]
fn a_rope_that_would_be_slack_is_reported_once_per_excursion() {
    for (omega, expected) in [(6.0_f64, 0), (10.0, 2)] {
        let warnings = Warnings::default();
        let mechanism = shipped("sash_window");
        let model = MechanismModel::new(mechanism, Interface::CoSimulation).expect("it closes");
        let mut instance = Instance::new(model, Box::new(warnings.clone()), true);
        let motion = |t: f64| {
            let (sin, cos) = (omega * t).sin_cos();
            [
                0.8 + 0.2 * sin,
                0.2 * omega * cos,
                -0.2 * omega * omega * sin,
            ]
        };
        instance.setup_experiment(0.0, None).expect("legal");
        instance.set_real(&[1, 2, 3], &motion(0.0)).expect("legal");
        instance.enter_initialization_mode().expect("legal");
        instance.exit_initialization_mode().expect("legal");
        let steps = 100;
        let h = 2.2 * std::f64::consts::TAU / omega / f64::from(steps);
        for step in 0..steps {
            let t = h * f64::from(step);
            instance
                .set_real(&[1, 2, 3], &motion(t + h))
                .expect("legal");
            instance.do_step(t, h).expect("the way is free");
        }
        let found = warnings.0.lock().expect("one thread");
        let slack = |message: &&String| message.contains("rope `cord` would be slack");
        assert_eq!(found.iter().filter(slack).count(), expected, "{found:?}");
        assert_eq!(found.len(), expected, "{found:?}");
    }
}

const HOIST: &str = r#"
    format = 1
    name = "hoist"
    ground.markers = { O = [0, 0, "90*deg"] }
    bodies.load = { markers = { P = [0, 0, "90*deg"] }, mass = 4, inertia = 1 }
    joints.guide = { type = "translational", markers = ["ground.O", "load.P"] }
    drivers.height = { coordinate = "x", markers = ["ground.O", "load.P"], start = 0 }
    forces.pull = { marker = "load.P" }
    forces.brake = { coordinate = "x", markers = ["ground.O", "load.P"], damping = 3 }
"#;

fn value(instance: &mut crate::common::Instance, quantity: Quantity) -> f64 {
    let [reference] = references(instance, |v| v.quantity == quantity)[..] else {
        panic!("{quantity:?} is a variable");
    };
    instance
        .reals(&[reference])
        .expect("it has a value")
        .next()
        .expect("one")
}

/// Force inputs follow their own paths, are saved, and are read back; effort = m (a + g) + d v − F.
#[test]
fn inputs_of_forces_are_held_saved_and_extrapolated() {
    let names = |instance: &crate::common::Instance| -> Vec<String> {
        let variables = instance.variables().iter();
        variables.map(|variable| variable.name.clone()).collect()
    };
    let mut instance = instance_of(parse(HOIST), Interface::CoSimulation);
    let all = names(&instance);
    assert_eq!(
        all[..6],
        [
            "height.position",
            "height.velocity",
            "height.acceleration",
            "pull.fx",
            "pull.fy",
            "pull.torque"
        ]
    );
    let first = all
        .iter()
        .position(|name| name == "height.effort")
        .expect("it is there");
    assert_eq!(
        all[first..first + 10],
        [
            "height.effort",
            "height.power",
            "height.inertia",
            "height.bias",
            "guide.fx",
            "guide.fy",
            "guide.torque",
            "brake.effort",
            "energy.kinetic",
            "energy.potential"
        ]
    );
    instance.setup_experiment(0.0, None).expect("legal");
    instance.set_real(&[2, 3], &[0.5, 2.0]).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    instance.exit_initialization_mode().expect("legal");
    let effort = OutputSource::Force(ForceQuantity::Effort(DriverId(0)));
    let effort = Quantity::Output(effort);
    let base = 4.0 * (2.0 + 9.81) + 3.0 * 0.5;
    let near = |value: f64, expected: f64| (value - expected).abs() < 1e-13 * base;
    assert!(near(value(&mut instance, effort), base));
    instance.set_real(&[5], &[7.0]).expect("legal");
    assert!(near(value(&mut instance, effort), base - 7.0));
    let state = instance.fmu_state().expect("it can be saved");
    instance
        .set_real_input_derivatives(&[5], &[1], &[10.0])
        .expect("legal");
    instance.set_real(&[2, 3], &[0.5, 2.0]).expect("legal");
    instance.do_step(0.0, 0.1).expect("the way is free");
    assert!(near(value(&mut instance, effort), base - 8.0));
    assert_eq!(instance.reals(&[5]).expect("it is set").next(), Some(7.0));
    instance
        .set_fmu_state(&state)
        .expect("it is one of this instance");
    assert!(near(value(&mut instance, effort), base - 7.0));
    let by = instance
        .directional_derivative(
            &references(&instance, |v| v.quantity == effort),
            &[3, 5],
            &[1.0, 0.0],
        )
        .expect("it is regular");
    assert!((by[0] - 4.0).abs() < 1e-13, "{by:?}");
}

//! Forces as variables of an FMU.

use std::collections::BTreeMap;

use std::sync::{Arc, Mutex};

use biela::fmi::{
    Category, Causality, Instance, Interface, Kind, MechanismModel, Order, Quantity, Sink, Status,
};
use biela::kinematics::ForceQuantity;
use biela::mechanism::{DriverId, Indeterminate, Mechanism};

use crate::common::{self, instance_of, parse, stems};
use crate::loaded::loaded;

/// A quarter of the way of a difference, in units of the known; see `tests/sensitivity.rs`.
const STEP: f64 = 1e-5;
/// Error of a derivative by differences of fourth order, relative to the largest derivative or
/// value of its unit: rounding 1e-16 / 1e-5 times the condition of poses near singular positions.
const DIFFERENCE: f64 = 1e-6;

fn references(instance: &common::Instance, which: impl Fn(Quantity) -> bool) -> Vec<u32> {
    let variables = (0..).zip(instance.variables());
    let found = variables.filter(|(_, variable)| which(variable.quantity));
    found.map(|(reference, _)| reference).collect()
}

/// Returns an instance in initialization mode, with all inputs moved on.
fn moving(mechanism: Mechanism) -> common::Instance {
    let mut instance = instance_of(Arc::new(mechanism), Interface::CoSimulation);
    instance.setup_experiment(0.317, None).expect("legal");
    for (reference, variable) in (0..).zip(instance.variables().to_vec()) {
        let more = 0.1 * f64::from(reference);
        let value = match (variable.quantity, variable.kind) {
            (Quantity::Input(_, order), Kind::Real { start, .. }) => match order {
                Order::Position => start.expect("inputs have one") + 0.003,
                Order::Velocity => 0.7 + more,
                Order::Acceleration => -0.4 + more,
            },
            (Quantity::ForceInput(_), _) => 2.0 + more,
            (Quantity::RateSource, _) => {
                instance.set_integer(&[reference], &[2]).expect("legal");
                continue;
            }
            _ => continue,
        };
        instance.set_real(&[reference], &[value]).expect("legal");
    }
    instance.enter_initialization_mode().expect("legal");
    instance
}

#[test]
fn every_derivative_of_a_force_agrees_with_differences() {
    for name in stems("mechanisms", "toml") {
        let mut mechanism = loaded(&name);
        mechanism.outputs.indeterminate = Indeterminate::MinimumNorm;
        let mut instance = moving(mechanism);
        let unknowns = references(&instance, |q| matches!(q, Quantity::Force(_)));
        let knowns = (0..).zip(instance.variables()).filter(|(_, variable)| {
            variable.causality == Causality::Input
                || variable.causality == Causality::Parameter && variable.kind.is_real()
        });
        let knowns: Vec<u32> = knowns.map(|(reference, _)| reference).collect();
        let values: Vec<f64> = instance.reals(&unknowns).expect("it closes").collect();
        let unit = |instance: &common::Instance, place: usize| match instance.variables()
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
            let mut value = [0.0];
            instance.get_real(&[known], &mut value).expect("it is set");
            let mut moved = |by: f64| -> Vec<f64> {
                instance
                    .set_real(&[known], &[value[0] + by])
                    .expect("legal");
                instance.reals(&unknowns).expect("it closes").collect()
            };
            let [far_before, before, after, far_after] =
                [-2.0, -1.0, 1.0, 2.0].map(|k| moved(k * STEP));
            moved(0.0);
            let way = (value[0] + STEP) - (value[0] - STEP);
            let mut largest: BTreeMap<&str, f64> = BTreeMap::new();
            for (place, exact) in exact.iter().enumerate() {
                let largest = largest.entry(unit(&instance, place)).or_insert(1.0);
                *largest = largest.max(exact.abs()).max(values[place].abs());
            }
            for (place, exact) in exact.iter().enumerate() {
                let near = after[place] - before[place];
                let far = far_after[place] - far_before[place];
                let difference = (8.0 * near - far) / (6.0 * way);
                assert!(
                    (exact - difference).abs() <= DIFFERENCE * largest[unit(&instance, place)],
                    "{name}: `{}` by `{}`: {exact} and {difference}",
                    instance.variables()[unknowns[place] as usize].name,
                    instance.variables()[known as usize].name,
                );
            }
        }
    }
}

const LIFT: &str = r#"
    format = 1
    name = "lift"
    ground.markers = { O = [0, 0], G = [0, 0, "90*deg"] }
    bodies.cam = { markers = { O = [0, 0] } }
    bodies.follower = { markers = { P = [0, 0, "90*deg"] }, estimate = [0, 0.06, 0], mass = 0.5 }
    joints.O = { type = "revolute", markers = ["ground.O", "cam.O"] }
    joints.G = { type = "translational", markers = ["ground.G", "follower.P"] }
    joints.contact = { type = "cam", follower = "roller", radius = 0.01, markers = ["cam.O", "follower.P"], profile = "0.05 + 0.01*cos(theta)" }
    drivers.turn = { coordinate = "angle", markers = ["ground.O", "cam.O"], start = 0 }
"#;

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

/// The follower's acceleration at the top is about −e ω²: beyond √(g/e) it would fly. One warning
/// per turn.
#[test]
fn a_contact_that_pulls_is_reported_once_per_excursion() {
    for (omega, expected) in [(20.0, 0), (60.0, 2)] {
        let warnings = Warnings::default();
        let model = MechanismModel::new(parse(LIFT), Interface::CoSimulation).expect("it closes");
        let mut instance = Instance::new(model, Box::new(warnings.clone()), true);
        instance.setup_experiment(0.0, None).expect("legal");
        instance.set_real(&[0, 1], &[-0.8, omega]).expect("legal");
        instance.enter_initialization_mode().expect("legal");
        instance.exit_initialization_mode().expect("legal");
        // From before the top, over two of them.
        let steps = 100;
        let h = 1.5 * std::f64::consts::TAU / omega / f64::from(steps);
        for step in 0..steps {
            let t = h * f64::from(step);
            let angle = -0.8 + omega * (t + h);
            instance.set_real(&[0, 1], &[angle, omega]).expect("legal");
            instance.do_step(t, h).expect("the way is free");
        }
        let found = warnings.0.lock().expect("one thread");
        let lifted = found.iter().filter(|message| message.contains("lift off"));
        assert_eq!(lifted.count(), expected, "{found:?}");
        let all_contact = found.iter().all(|message| message.contains("`contact`"));
        assert!(all_contact, "{found:?}");
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

fn value(instance: &mut common::Instance, quantity: Quantity) -> f64 {
    let [reference] = references(instance, |q| q == quantity)[..] else {
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
    let names = |instance: &common::Instance| -> Vec<String> {
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
    instance.set_real(&[1, 2], &[0.5, 2.0]).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    instance.exit_initialization_mode().expect("legal");
    let effort = Quantity::Force(ForceQuantity::Effort(DriverId(0)));
    let base = 4.0 * (2.0 + 9.81) + 3.0 * 0.5;
    let near = |value: f64, expected: f64| (value - expected).abs() < 1e-13 * base;
    assert!(near(value(&mut instance, effort), base));
    instance.set_real(&[4], &[7.0]).expect("legal");
    assert!(near(value(&mut instance, effort), base - 7.0));
    let state = instance.fmu_state().expect("it can be saved");
    instance
        .set_real_input_derivatives(&[4], &[1], &[10.0])
        .expect("legal");
    instance.set_real(&[1, 2], &[0.5, 2.0]).expect("legal");
    instance.do_step(0.0, 0.1).expect("the way is free");
    assert!(near(value(&mut instance, effort), base - 8.0));
    assert_eq!(instance.reals(&[4]).expect("it is set").next(), Some(7.0));
    instance
        .set_fmu_state(&state)
        .expect("it is one of this instance");
    assert!(near(value(&mut instance, effort), base - 7.0));
    let by = instance
        .directional_derivative(
            &references(&instance, |quantity| quantity == effort),
            &[2, 4],
            &[1.0, 0.0],
        )
        .expect("it is regular");
    assert!((by[0] - 4.0).abs() < 1e-13, "{by:?}");
}

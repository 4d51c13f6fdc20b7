//! The slave between communication points and after a step that failed.

mod common;

use biela::fmi::{Category, Error, Instance, Sink, State, Status};
use common::shipped;

struct Silent;

impl Sink for Silent {
    fn write(&self, _: Status, _: Category, _: &str) {}
}

fn running(name: &str) -> Instance {
    let mut instance = Instance::new(shipped(name), Box::new(Silent), true).unwrap();
    instance.setup_experiment(0.0, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    instance
}

/// Values of the outputs with these names.
fn read(instance: &mut Instance, names: &[&str]) -> Vec<f64> {
    let list = instance.variables().list();
    let references: Vec<u32> = names
        .iter()
        .map(|name| list.iter().position(|v| v.name == *name).unwrap() as u32)
        .collect();
    let mut values = vec![0.0; names.len()];
    instance.get_real(&references, &mut values).unwrap();
    values
}

/// What a host looked at in between does not show in the pose of a discarded step.
#[test]
fn a_discarded_step_leaves_pose_and_rates_of_the_last_communication_point() {
    let mut instance = running("tlv");
    for (step, length) in [0.36, 0.38, 0.41].into_iter().enumerate() {
        instance.set_real(&[0], &[length]).unwrap();
        instance.do_step(0.1 * step as f64, 0.1).unwrap();
    }
    let names = ["arm.phi", "arm.omega", "arm.alpha"];
    let before = read(&mut instance, &names);
    assert!(before[1] > 0.0);
    instance.set_real(&[0, 1], &[0.5, 7.0]).unwrap();
    assert_ne!(read(&mut instance, &names), before);
    instance.set_real(&[0], &[0.9]).unwrap();
    let error = instance.do_step(0.3, 0.1).expect_err("0.9 m is too long");
    assert!(matches!(error, Error::DeadPoint { .. }));
    assert_eq!(instance.state(), State::StepFailed);
    assert!(instance.is_terminated());
    assert_eq!(read(&mut instance, &names), before);
}

#[test]
fn a_step_that_would_never_end_is_discarded() {
    let mut instance = running("pendulum");
    instance.set_real(&[0], &[1e12]).unwrap();
    let error = instance.do_step(0.0, 0.1).expect_err("that is too far");
    assert!(error.to_string().contains("more sub-steps"), "{error}");
}

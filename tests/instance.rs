//! The slave between communication points and after a step that failed.

mod common;

use biela::fmi::{Error, Failure, Interface, State};
use common::{Instance, instance_of, shipped};

fn running(name: &str) -> Instance {
    let mut instance = instance_of(shipped(name), Interface::CoSimulation);
    instance.setup_experiment(0.0, None).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    instance.exit_initialization_mode().expect("it starts");
    instance
}

/// Values of the outputs with these names.
fn read(instance: &mut Instance, names: &[&str]) -> Vec<f64> {
    let list = instance.variables();
    let references: Vec<u32> = names
        .iter()
        .map(|name| {
            list.iter()
                .position(|v| v.name == *name)
                .expect("an output") as u32
        })
        .collect();
    let mut values = vec![0.0; names.len()];
    instance
        .get_real(&references, &mut values)
        .expect("readable");
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
    assert!(matches!(error, Error::Model(Failure::Discarded(_))));
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

/// The side grows as 0.35 + 0.2 t, told with derivatives; it ends at 0.65 m, at t = 1.5 s. Each
/// value is off by a nanometre from where the polynomial before it ended.
#[test]
fn the_last_successful_time_of_a_moving_input_is_where_it_stopped() {
    let mut instance = running("tlv");
    for step in 0.. {
        let t = 0.4 * f64::from(step);
        let off = if step % 2 == 0 { 1e-9 } else { 0.0 };
        instance.set_real(&[0], &[0.35 + 0.2 * t + off]).unwrap();
        instance
            .set_real_input_derivatives(&[0], &[1], &[0.2])
            .unwrap();
        if instance.do_step(t, 0.4).is_err() {
            break;
        }
    }
    // A nanometre is 5e-9 s of travel; the dead point itself is met to about as much.
    assert!((instance.last_successful_time() - 1.5).abs() < 1e-7);
}

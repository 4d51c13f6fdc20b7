//! Advice of an FMU with redundant constraints.

use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};

use biela::fmi::{Category, Instance, Interface, MechanismModel, Sink, Status};
use biela::kinematics::Redundancy;

use crate::common::parse;
use crate::redundancy::mechanisms::parallelogram;

/// The log says it once to a host that asks for a log.
#[test]
fn the_log_advises_once() {
    struct Advice(Arc<Mutex<Vec<String>>>);
    impl Sink for Advice {
        fn write(&self, status: Status, category: Category, message: &str) {
            assert_eq!(status, Status::Ok, "{message}");
            if category == Category::Warning {
                let mut advice = self.0.lock().expect("one thread");
                advice.push(message.to_owned());
            }
        }
    }
    let advice = Arc::new(Mutex::new(Vec::new()));
    let sink = Box::new(Advice(Arc::clone(&advice)));
    let mechanism = parse(&parallelogram(&[[0.2, 0.1]], 60.0, true));
    let model = MechanismModel::new(mechanism, Interface::CoSimulation).expect("it closes");
    let mut instance = Instance::new(model, sink, true);
    instance.setup_experiment(0.0, None).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    instance.exit_initialization_mode().expect("it starts");
    // Through both flat poses; what is saved next to one goes on as the original does.
    let mut saved = None;
    for step in 0..25 {
        let angle = TAU / 6.0 + TAU / 24.0 * f64::from(step + 1);
        instance.set_real(&[1], &[angle]).expect("an input");
        instance
            .do_step(f64::from(step), 1.0)
            .expect("nothing is in the way");
        if step == 7 {
            // At 180 degrees.
            saved = Some(instance.fmu_state().expect("legal"));
        }
    }
    let outputs: Vec<u32> = (6..15).collect();
    let mut values = [vec![0.0; 9], vec![0.0; 9]];
    instance
        .get_real(&outputs, &mut values[0])
        .expect("readable");
    instance
        .set_fmu_state(&saved.expect("it was saved"))
        .expect("its own");
    for step in 8..25 {
        let angle = TAU / 6.0 + TAU / 24.0 * f64::from(step + 1);
        instance.set_real(&[1], &[angle]).expect("an input");
        instance
            .do_step(f64::from(step), 1.0)
            .expect("nothing is in the way");
    }
    instance
        .get_real(&outputs, &mut values[1])
        .expect("readable");
    assert_eq!(values[0], values[1]);
    let advice = advice.lock().expect("one thread");
    assert_eq!(
        advice[..],
        [
            "constraint equations of joint `O5` are redundant: 1 of its 2 follows from the others; \
          it is set aside and watched"
        ]
    );
}

#[test]
fn all_equations_of_a_joint_or_its_only_one_are_told_as_such() {
    let redundancy = |redundant, equations| Redundancy {
        origin: "joint `k`".to_owned(),
        redundant,
        equations,
    };
    for (redundant, equations, says) in [
        (
            1,
            1,
            "the constraint equation of joint `k` is redundant: it follows from the others; it is \
             set aside and watched",
        ),
        (
            2,
            2,
            "constraint equations of joint `k` are redundant: all 2 follow from the others; they \
             are set aside and watched",
        ),
        (
            2,
            3,
            "constraint equations of joint `k` are redundant: 2 of its 3 follow from the others; \
             they are set aside and watched",
        ),
    ] {
        assert_eq!(redundancy(redundant, equations).to_string(), says);
    }
}

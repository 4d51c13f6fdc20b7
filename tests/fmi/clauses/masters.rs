//! Algorithms of hosts at a dead point (4.2.2): each ends cleanly, and one that can go back gets as
//! far as the mechanism reaches.
//!
//! The triangle's third side ends at 0.65 m.

use biela::fmi::{Error, Failure, State, Status};

use crate::clauses::{get, running, set, vr};
use crate::common::Instance;

const LENGTH: &str = "side_length.position";
const LIMIT: f64 = 0.65;

fn triangle() -> Instance {
    running("tlv")
}

/// End of a host's run.
#[derive(Debug, PartialEq)]
enum End {
    /// At the stop time.
    Stopped(f64),
    /// The FMU wants to terminate, at this time.
    Terminated(f64),
    /// A call failed.
    Failed(Error),
}

/// The side at 0.35 m + 0.2 m/s · t, which reaches the limit at 1.5 s; held over a step, or with
/// its derivative.
fn apply(instance: &mut Instance, t: f64, derivative: bool) {
    set(instance, [(LENGTH, 0.35 + 0.2 * t)]);
    if derivative {
        let length = vr(instance, LENGTH);
        let given = instance.set_real_input_derivatives(&[length], &[1], &[0.2]);
        given.expect("it is an input");
    }
}

/// FMPy's `simulateCS`: after a discard it asks `fmi2Terminated`; on true it ends at
/// `fmi2LastSuccessfulTime`, on false it goes on with the same step.
fn like_fmpy(instance: &mut Instance, h: f64, derivative: bool) -> End {
    let mut time = 0.0;
    while time < 3.0 {
        apply(instance, time, derivative);
        match instance.do_step(time, h) {
            Ok(()) => time += h,
            Err(error) if error.status() == Status::Discard => {
                if instance.is_terminated() {
                    return End::Terminated(instance.last_successful_time());
                }
            }
            Err(error) => return End::Failed(error),
        }
    }
    End::Stopped(time)
}

/// OMSimulator's `ComponentFMUCS::stepUntil`: a discard makes its time the stop time, any other
/// status than `fmi2OK` is an error; reading must return `fmi2OK`.
fn like_omsimulator(instance: &mut Instance, h: f64, derivative: bool) -> End {
    let (mut time, mut stop) = (0.0, 3.0);
    while time < stop {
        apply(instance, time, derivative);
        let stepped = instance.do_step(time, h);
        time += h;
        match stepped {
            Ok(()) => {}
            Err(error) if error.status() == Status::Discard => stop = time,
            Err(error) => return End::Failed(error),
        }
        get(instance, ["arm.phi"]);
    }
    if let Err(error) = instance.terminate() {
        return End::Failed(error);
    }
    End::Stopped(time)
}

/// PyFMI's `FMICSAlg.solve`: a discard ends the run; if `fmi2LastSuccessfulTime` is later than the
/// start of the step, its outputs are recorded.
fn like_pyfmi(instance: &mut Instance, h: f64, derivative: bool) -> End {
    let mut time = 0.0;
    while time < 3.0 {
        apply(instance, time, derivative);
        match instance.do_step(time, h) {
            Ok(()) => time += h,
            Err(error) if error.status() == Status::Discard => {
                let last = instance.last_successful_time();
                if last > time {
                    get(instance, ["arm.phi"]);
                }
                return End::Terminated(last);
            }
            Err(error) => return End::Failed(error),
        }
    }
    End::Stopped(time)
}

#[test]
fn hosts_that_do_not_go_back_end_at_the_dead_point() {
    for derivative in [false, true] {
        // Held, the side of a step is that of its start: from 1.6 s on it is too long. With its
        // derivative it reaches the limit itself.
        let last = if derivative { 1.5 } else { 1.6 };
        let ended = like_fmpy(&mut triangle(), 0.4, derivative);
        let End::Terminated(time) = ended else {
            panic!("{ended:?}")
        };
        assert!((time - last).abs() < 1e-7, "{time}");
        let ended = like_pyfmi(&mut triangle(), 0.4, derivative);
        let End::Terminated(time) = ended else {
            panic!("{ended:?}")
        };
        assert!((time - last).abs() < 1e-7, "{time}");
        let ended = like_omsimulator(&mut triangle(), 0.4, derivative);
        let End::Stopped(time) = ended else {
            panic!("{ended:?}")
        };
        assert!((1.5..2.1).contains(&time), "{time}");
    }
}

/// "If possible, the master should retry the simulation with a shorter communication step size":
/// it goes back to a state of the step's start and steps up to the last successful time, as long as
/// `fmi2Terminated` is false.
fn like_a_master_that_goes_back(instance: &mut Instance, h: f64) -> (End, u32) {
    let (mut time, mut retries) = (0.0, 0);
    let mut size = h;
    while time < 3.0 {
        let before = instance.fmu_state().expect("legal");
        apply(instance, time, true);
        match instance.do_step(time, size) {
            Ok(()) => {
                time += size;
                size = h;
            }
            Err(Error::Model(Failure::Discarded(_))) => {
                assert_eq!(instance.state(), State::StepFailed);
                if instance.is_terminated() {
                    return (End::Terminated(instance.last_successful_time()), retries);
                }
                size = instance.last_successful_time() - time;
                instance.set_fmu_state(&before).expect("its own");
                retries += 1;
                assert!(retries < 10, "it retries for ever");
            }
            Err(error) => return (End::Failed(error), retries),
        }
    }
    (End::Stopped(time), retries)
}

#[test]
fn a_master_that_goes_back_gets_to_the_dead_point_and_is_told_to_end_there() {
    let mut instance = triangle();
    let (ended, retries) = like_a_master_that_goes_back(&mut instance, 0.4);
    let End::Terminated(time) = ended else {
        panic!("{ended:?}")
    };
    assert!((time - 1.5).abs() < 1e-7, "{time}");
    assert!(retries >= 1);
    // The arm lies along the base but for the square root of what is left.
    let [phi] = get(&mut instance, ["arm.phi"]);
    let side = 0.35 + 0.2 * time;
    assert!((LIMIT - side).abs() < 1e-7 && phi > 3.0, "{phi} at {side}");
}

/// No shorter step helps against a held input beyond the dead point, whatever the host keeps.
#[test]
fn a_held_input_beyond_the_dead_point_ends_every_host() {
    for keeps_state in [false, true] {
        let mut instance = triangle();
        if keeps_state {
            instance.fmu_state().expect("legal");
        }
        set(&mut instance, [(LENGTH, 0.7)]);
        instance.do_step(0.0, 0.1).expect_err("too long");
        assert!(instance.is_terminated());
        assert_eq!(instance.last_successful_time(), 0.0);
        assert_eq!(instance.step_status(), Status::Discard);
    }
}

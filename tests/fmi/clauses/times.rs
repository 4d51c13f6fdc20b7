//! Communication points and stop times of hosts that count time in their own ways, early in a
//! simulation and at calendar times.

use biela::fmi::{CoSimulation, Error, Interface, MechanismModel, StepProgress, Version};

use crate::clauses::{get, initialized, set};
use crate::common::log::Heard;
use crate::common::mechanisms::crank;
use crate::common::{Instance, co_simulation, instance_of, parse, shipped};

/// Seconds from 1970 to a day in 2020.
const CALENDAR: f64 = 1.6e9;

const SWING: &str = "swing_angle.position";

/// A pendulum for co-simulation from `start` on.
fn pendulum(version: Version, start: f64, stop: Option<f64>) -> Instance {
    let model = MechanismModel::new(shipped("pendulum"), Interface::CoSimulation);
    let sink = Box::new(Heard::default());
    let mut instance = Instance::of_version(version, model.expect("it assembles"), sink, false);
    match version {
        Version::Fmi2 => {
            instance.setup_experiment(start, stop).expect("legal");
            instance.enter_initialization_mode().expect("legal");
        }
        Version::Fmi3 => {
            let entered = instance.enter_initialization_mode_at(start, stop);
            entered.expect("legal");
        }
    }
    instance.exit_initialization_mode().expect("it starts");
    instance
}

fn step(instance: &mut Instance, point: f64, h: f64) -> Result<(), Error> {
    match instance.version() {
        Version::Fmi2 => instance.do_step(point, h),
        Version::Fmi3 => instance.begin_step(point, h).map(|progress| {
            assert!(matches!(progress, StepProgress::Done(_)), "{progress:?}");
        }),
    }
}

#[track_caller]
fn assert_refused(outcome: Result<(), Error>, part: &str) {
    let error = outcome.expect_err(part);
    assert!(error.to_string().contains(part), "{error}");
}

/// A step that is left out, in whole or in part, and one that is taken twice.
#[test]
fn a_wrong_communication_point_is_refused_at_any_time() {
    for version in Version::ALL {
        for (start, h) in [
            (0.0, 50e-6),
            (1.0, 1e-3),
            (1e5, 50e-6),
            (CALENDAR, 0.5),
            (CALENDAR, 1e-3),
            (-CALENDAR, 1e-3),
        ] {
            let mut instance = pendulum(version, start, None);
            step(&mut instance, start, h).expect("legal");
            let now = start + h;
            for parts in [-2.0, -1.0, -0.5, -0.1, 0.1, 0.5, 1.0] {
                let wrong = step(&mut instance, now + parts * h, h);
                assert_refused(wrong, "is not where the last step ended");
                if version == Version::Fmi3 {
                    // A failed call ends a simulation of FMI 3.0; here it goes on all the same.
                    let state = instance.state();
                    assert_eq!(state, biela::fmi::State::StepMode);
                }
            }
            step(&mut instance, now, h).expect("the right one");
        }
    }
}

/// Two roundings of a time are less than a step, but a shorter step would lead back.
#[test]
fn no_step_leads_back_in_time() {
    let mut instance = pendulum(Version::Fmi2, 1e6, None);
    instance.do_step(1e6, 0.01).expect("legal");
    let [now] = get(&mut instance, ["time"]);
    let before = now.next_down().next_down();
    let back = instance.do_step(before, 0.5 * (now - before));
    assert_refused(back, "is not where the last step ended");
    instance.do_step(before, 0.01).expect("that is rounding");
    let [then] = get(&mut instance, ["time"]);
    assert!(then > now, "{then} {now}");
}

/// Time of a host's nth communication point, by start, step size, n and the time of the point before.
type Clock = fn(f64, f64, f64, f64) -> f64;

const CLOCKS: [(&str, Clock); 4] = [
    (
        "sum",
        |_, h, n, before| if n > 0.0 { before + h } else { before },
    ),
    ("product", |start, h, n, _| start + n * h),
    ("parts of the whole", |start, h, n, _| {
        start + n / 2e4 * (2e4 * h)
    }),
    ("nanoseconds", |start, h, n, _| {
        start + (n * h * 1e9).round() * 1e-9
    }),
];

/// Each host's points are accepted to the end, and the time is the host's: no rounding adds up.
#[test]
fn every_way_to_count_time_is_followed() {
    for (clock, point) in CLOCKS {
        for (start, h) in [
            (0.0, 1e-3),
            (0.0, 1.0 / 30.0),
            (1e5, 1e-3),
            (CALENDAR, 1e-3),
        ] {
            let mut instance = pendulum(Version::Fmi2, start, None);
            let mut time = start;
            for n in 0..2000 {
                time = point(start, h, f64::from(n), time);
                set(&mut instance, [(SWING, 1e-3 * f64::from(n))]);
                instance
                    .do_step(time, h)
                    .unwrap_or_else(|error| panic!("{clock}, step {n} of {h} s: {error}"));
                let [now] = get(&mut instance, ["time"]);
                assert_eq!(now.to_bits(), (time + h).to_bits(), "{clock}");
            }
        }
    }
}

/// The sum of a million steps of 0.1 s is 1.3e-6 s more than 1e5 s; that of a thousand steps of 1 ms
/// from a calendar time 0.17 ms more than a second, since each sum is rounded to 0.24 µs.
#[test]
fn a_host_that_adds_up_steps_reaches_its_stop_time() {
    for version in Version::ALL {
        for (start, h, n) in [
            (0.0, 0.1, 3),
            (0.0, 0.1, 1_000_000),
            (0.0, 1e-3, 1_000_000),
            (1e5, 50e-6, 100_000),
            (CALENDAR, 1e-3, 1000),
        ] {
            let stop = start + f64::from(n) * h;
            let last = (1..n).fold(start, |time, _| time + h);
            let mut instance = pendulum(version, start, Some(stop));
            // The steps before at once: the host's sum is what counts.
            step(&mut instance, start, last - start).expect("before the stop time");
            let [now] = get(&mut instance, ["time"]);
            assert!((now - last).abs() <= f64::EPSILON * last, "{now} {last}");
            let ended = step(&mut instance, last, h);
            ended.unwrap_or_else(|error| panic!("{n} steps of {h} s from {start} s: {error}"));
        }
    }
}

#[test]
fn a_step_past_the_stop_time_is_refused_at_any_time() {
    for version in Version::ALL {
        for (start, h) in [(0.0, 0.1), (1e5, 50e-6), (CALENDAR, 0.5), (CALENDAR, 1e-3)] {
            let stop = start + 10.0 * h;
            for past in [0.5, 0.6, 1.0] {
                let mut instance = pendulum(version, start, Some(stop));
                let last = stop + (past - 1.0) * h;
                step(&mut instance, start, last - start).expect("before the stop time");
                assert_refused(step(&mut instance, last, h), "passes the stop time");
            }
        }
    }
    // One step of another size does not make the experiment one of many steps.
    let mut instance = pendulum(Version::Fmi2, 0.0, Some(1e5));
    instance.do_step(0.0, 1e5).expect("up to the stop time");
    let past = instance.do_step(1e5, 50e-6);
    assert_refused(past, "passes the stop time");
}

/// The pose belongs to the host's time, whichever way that was rounded: 3 rad/s times the spacing of
/// numbers there, 2.4e-7 s, is the angle's resolution.
#[test]
fn a_prescribed_motion_follows_the_hosts_time() {
    // It turns at 3 rad/s by itself.
    let mechanism = parse(&crank("motion = '3*(t - 1.6e9)'"));
    for part in [0.0, 9e-7, -9e-7] {
        let mut instance = instance_of(mechanism.clone(), Interface::CoSimulation);
        instance.setup_experiment(CALENDAR, None).expect("legal");
        initialized(&mut instance);
        let h = 1.0;
        for n in 0..100 {
            // A host whose steps are a little longer or shorter than it says.
            let time = CALENDAR + f64::from(n) * h * (1.0 + part);
            instance.do_step(time, h).expect("rounding");
            let [now, phi, omega] = get(&mut instance, ["time", "crank.phi", "crank.omega"]);
            assert_eq!(now.to_bits(), (time + h).to_bits());
            let off = (phi - 3.0 * (now - CALENDAR)).abs();
            assert!(off <= 3.0 * 2.4e-7, "step {n}: {off}");
            assert!((omega - 3.0).abs() < 1e-12);
        }
    }
}

/// In model exchange the host accepts a point by `fmi2CompletedIntegratorStep` or an event.
#[test]
fn model_exchange_ends_at_its_stop_time_at_any_time() {
    for (start, h, n) in [
        (0.0, 0.1, 1_000_000),
        (CALENDAR, 1e-3, 1000),
        (CALENDAR, 0.5, 4),
    ] {
        let stop = start + f64::from(n) * h;
        let mut instance = instance_of(shipped("pendulum"), Interface::ModelExchange);
        instance.setup_experiment(start, Some(stop)).expect("legal");
        initialized(&mut instance);
        let last = (1..n).fold(start, |time, _| time + h);
        for time in [last, last + h] {
            instance.set_time(time).expect("finite");
            assert_eq!(
                instance
                    .completed_integrator_step()
                    .map(|step| step.must_end),
                Ok(false)
            );
        }
        // The same point again, at an event.
        instance.enter_event_mode().expect("it was accepted");
        instance.enter_continuous_time_mode().expect("legal");
        instance.set_time(stop + h).expect("a trial");
        let past = instance.completed_integrator_step();
        assert_refused(past.map(drop), "beyond the stop time");
        assert_refused(instance.enter_event_mode(), "beyond the stop time");
    }
}

/// The triangle closes up to a side of 0.65 m, which a side that grows from 0.35 m at 0.2 m/s reaches
/// after 1.5 s.
#[test]
fn a_dead_point_is_progress_at_any_time() {
    for start in [0.0, CALENDAR] {
        let mut instance = co_simulation("tlv");
        instance.setup_experiment(start, None).expect("legal");
        initialized(&mut instance);
        instance.fmu_state().expect("legal");
        let length = crate::clauses::vr(&instance, "side_length.position");
        let given = instance.set_real_input_derivatives(&[length], &[1], &[0.2]);
        given.expect("it is an input");
        instance.do_step(start, 2.0).expect_err("too long");
        // Four roundings of the time are 1e-6 s.
        let last = instance.last_successful_time() - start;
        assert!((last - 1.5).abs() < 1e-6, "{last}");
        assert!(!instance.is_terminated(), "a shorter step leads there");
    }
}

/// FMI 3.0: points of intermediate update, and a wish to end the step at its end or where it is.
#[test]
fn intermediate_update_has_the_steps_times_at_any_time() {
    for (start, h) in [(0.0, 0.1), (1e5, 50e-6), (CALENDAR, 1e-3)] {
        // Half a rounding of the time, and 1e-7 of the step.
        let rounding = (0.5 * f64::EPSILON * start).max(1e-7 * h);
        for (wish, early) in [
            (start + h - rounding, false),
            (start + h + rounding, false),
            (start + 0.6 * h, true),
        ] {
            let model = MechanismModel::new(shipped("pendulum"), Interface::CoSimulation);
            let sink = Box::new(Heard::default());
            let mut instance =
                Instance::of_version(Version::Fmi3, model.expect("it assembles"), sink, false);
            let agreed = CoSimulation {
                early_return_allowed: true,
                intermediate_update: true,
                ..CoSimulation::default()
            };
            instance.agree(agreed).expect("no variables");
            let entered = instance.enter_initialization_mode_at(start, None);
            entered.expect("legal");
            instance.exit_initialization_mode().expect("it starts");
            let mut progress = instance.begin_step(start, h).expect("legal");
            let mut last = start;
            let outcome = loop {
                match progress {
                    StepProgress::Intermediate { time, .. } => {
                        assert!(last < time && time <= start + h, "{last} {time}");
                        last = time;
                        progress = instance.resume_step(Some(wish)).expect("it goes on");
                    }
                    StepProgress::Done(outcome) => break outcome,
                }
            };
            assert_eq!(outcome.early_return, early, "{wish}");
            let reached = if early { wish } else { start + h };
            assert_eq!(outcome.last_successful_time.to_bits(), reached.to_bits());
            let wrong = instance.begin_step(reached + 0.5 * h, h).map(drop);
            assert_refused(wrong, "is not where the last step ended");
            instance.begin_step(reached, h).expect("the right one");
        }
    }
}

//! Messages to the logger (2.1.5, 2.2.4).

use std::f64::consts::TAU;

use biela::fmi::{Category, Error, Interface, MechanismModel, Status, Version, resource_path};
use biela::mechanism::Mechanism;

use crate::clauses::{initialized, set, started};
use crate::common::log::{Heard, Message};
use crate::common::mechanisms::crank;
use crate::common::{Instance, parse, shipped};

const LENGTH: &str = "side_length.position";

/// A parallelogram with a third crank: a redundant constraint.
fn redundant() -> std::sync::Arc<biela::mechanism::Mechanism> {
    parse(
        r#"
format = 1
name = "redundant"
[ground.markers]
A = [0, 0]
B = [1, 0]
C = [2, 0]
[bodies]
one = { markers = { O = [0, 0], P = [1, 0] }, estimate = [0, 0, "60*deg"] }
two = { markers = { O = [0, 0], P = [1, 0] }, estimate = [1, 0, "60*deg"] }
three = { markers = { O = [0, 0], P = [1, 0] }, estimate = [2, 0, "60*deg"] }
bar = { markers = { A = [0, 0], B = [1, 0], C = [2, 0] }, estimate = [0.5, 0.8, 0] }
[joints]
A = { type = "revolute", markers = ["ground.A", "one.O"] }
B = { type = "revolute", markers = ["ground.B", "two.O"] }
C = { type = "revolute", markers = ["ground.C", "three.O"] }
P = { type = "revolute", markers = ["one.P", "bar.A"] }
Q = { type = "revolute", markers = ["two.P", "bar.B"] }
R = { type = "revolute", markers = ["three.P", "bar.C"] }
[drivers]
angle = { coordinate = "angle", markers = ["ground.A", "one.O"], start = "60*deg" }
"#,
    )
}

/// A run with much to say: redundant constraints, an approach to a dead point, the dead point.
fn run(mut instance: Instance, heard: &Heard) -> Vec<(Result<Status, Error>, Vec<Message>)> {
    let mut calls = Vec::new();
    let mut call = |instance: &mut Instance, call: &dyn Fn(&mut Instance) -> Result<(), Error>| {
        let outcome = call(instance).map(|()| instance.succeeded());
        if let Err(error) = &outcome {
            instance.report("call", error);
        }
        calls.push((outcome, heard.take_all()));
    };
    call(&mut instance, &|i| i.setup_experiment(0.0, None));
    call(&mut instance, &Instance::enter_initialization_mode);
    call(&mut instance, &Instance::exit_initialization_mode);
    for (step, length) in [0.5, 0.65 - 1e-9, 0.5, 0.7].into_iter().enumerate() {
        if instance.variables().iter().any(|v| v.name == LENGTH) {
            call(&mut instance, &|i| {
                set(i, [(LENGTH, length)]);
                Ok(())
            });
        }
        call(&mut instance, &|i| i.do_step(step as f64, 1.0));
    }
    call(&mut instance, &Instance::reset);
    calls
}

/// "`logger` should only be called for log categories that were enabled": without logging there is
/// nothing but what goes with a warning, an error or a discard. A message of status `fmi2Warning` goes
/// with a call that does not return `fmi2OK`.
#[test]
fn a_message_of_a_call_that_returns_ok_is_ok_and_silent_without_logging() {
    let mut remarks = 0;
    for (mechanism, logging_on) in [
        (shipped("tlv"), false),
        (shipped("tlv"), true),
        (redundant(), false),
        (redundant(), true),
    ] {
        let heard = Heard::default();
        let instance = heard.instance(mechanism, Interface::CoSimulation, logging_on);
        for (outcome, messages) in run(instance, &heard) {
            if outcome == Ok(Status::Ok) {
                assert!(
                    messages.iter().all(|m| m.status == Status::Ok),
                    "{messages:?}"
                );
                assert!(logging_on || messages.is_empty(), "{messages:?}");
                let warnings = messages.iter().filter(|m| m.category == Category::Warning);
                remarks += warnings.count();
            } else {
                assert!(!messages.is_empty());
                assert_eq!(messages[0].status, Status::Warning);
            }
        }
    }
    // The redundant constraint.
    assert_eq!(remarks, 1);
}

/// Two rods on ground, each driven up to 2 rad.
const TWO_RODS: &str = r#"
format = 1
name = "two_rods"
[ground.markers]
O = [0, 0]
P = [1, 0]
[bodies.one]
markers = { O = [0, 0] }
[bodies.other]
markers = { P = [0, 0] }
estimate = [1, 0, 0]
[joints]
O = { type = "revolute", markers = ["ground.O", "one.O"] }
P = { type = "revolute", markers = ["ground.P", "other.P"] }
[drivers]
left = { coordinate = "angle", markers = ["ground.O", "one.O"], start = 0, max = 2 }
right = { coordinate = "angle", markers = ["ground.P", "other.P"], start = 0, max = 2 }
"#;

/// A wrong use: position and velocity of a driver at each step.
struct Misuse {
    interface: Interface,
    mechanism: fn() -> std::sync::Arc<Mechanism>,
    driver: &'static str,
    /// Values by the number of the step; from step 25 on likewise once more.
    motion: fn(u32) -> [f64; 2],
    /// A part of the advice.
    advice: &'static str,
}

/// Steps of 0.1 s.
const MISUSES: [Misuse; 5] = [
    Misuse {
        interface: Interface::CoSimulation,
        mechanism: || parse(&crank("start = 0, max = 3")),
        driver: "turn",
        motion: |step| {
            [
                if (5..8).contains(&(step % 25)) {
                    3.1
                } else {
                    2.9
                },
                0.0,
            ]
        },
        advice: "beyond its `max` = 3.0",
    },
    Misuse {
        interface: Interface::CoSimulation,
        mechanism: || parse(&crank("start = 0")),
        driver: "turn",
        // 1 rad per step, modulo one turn.
        motion: |step| [f64::from(step) % TAU, 0.0],
        advice: "set `wrapped = true`",
    },
    Misuse {
        interface: Interface::CoSimulation,
        mechanism: || parse(&crank("start = 0")),
        driver: "turn",
        // 1 rad per 0.1 s, said to be 3 rad/s.
        motion: |step| [f64::from(step), 3.0],
        advice: "is given as 3 rad/s, but its position changes by 10 rad/s",
    },
    // An angle alone.
    Misuse {
        interface: Interface::ModelExchange,
        mechanism: || parse(&crank("start = 0")),
        driver: "turn",
        motion: |step| [f64::from(step), 0.0],
        advice: "is given as 0 rad/s, but its position changes by 10 rad/s: connect \
                 `turn.velocity`",
    },
    Misuse {
        interface: Interface::CoSimulation,
        mechanism: || shipped("tlv"),
        driver: "side_length",
        motion: |step| [if step % 25 == 5 { 0.65 - 1e-9 } else { 0.5 }, 0.0],
        advice: "near a singular position",
    },
];

/// Runs 50 steps. Returns each step's status and messages.
fn misuse(instance: &mut Instance, heard: &Heard, wrong: &Misuse) -> Vec<(Status, Vec<Message>)> {
    match instance.version() {
        Version::Fmi2 => {
            instance.setup_experiment(0.0, None).expect("legal");
            initialized(instance);
        }
        Version::Fmi3 => {
            let entered = instance.enter_initialization_mode_at(0.0, None);
            entered.expect("legal");
            instance.exit_initialization_mode().expect("it starts");
            if wrong.interface == Interface::ModelExchange {
                instance.enter_continuous_time_mode().expect("legal");
            }
        }
    }
    assert_eq!(instance.succeeded(), Status::Ok);
    heard.take_all();
    let names = ["position", "velocity"].map(|input| format!("{}.{input}", wrong.driver));
    let steps = (0..50).map(|step| {
        let values = (wrong.motion)(step);
        set(instance, [(&names[0], values[0]), (&names[1], values[1])]);
        let time = 0.1 * f64::from(step);
        match (wrong.interface, instance.version()) {
            (Interface::CoSimulation, Version::Fmi2) => instance.do_step(time, 0.1),
            (Interface::CoSimulation, Version::Fmi3) => instance.begin_step(time, 0.1).map(drop),
            (Interface::ModelExchange, _) => {
                instance.set_time(time).expect("finite");
                instance.completed_integrator_step().map(drop)
            }
        }
        .expect("it can be followed");
        (instance.succeeded(), heard.take_all())
    });
    steps.collect()
}

/// `loggingOn` switches debug logging (2.1.5): whoever has not asked for that is told of a wrong use
/// all the same, once per kind and run, and the call returns `fmi2Warning`.
#[test]
fn advice_on_wrong_use_reaches_every_host_once_per_run() {
    for wrong in &MISUSES {
        for logging_on in [false, true] {
            let heard = Heard::default();
            let mut instance = heard.instance((wrong.mechanism)(), wrong.interface, logging_on);
            for _ in 0..2 {
                let steps = misuse(&mut instance, &heard, wrong);
                let warned: Vec<_> = steps
                    .iter()
                    .filter(|(s, _)| *s == Status::Warning)
                    .collect();
                let [(_, messages)] = &warned[..] else {
                    panic!("{}: {warned:?}", wrong.advice)
                };
                let of_advice = |m: &&Message| m.category == Category::Warning;
                let messages: Vec<_> = messages.iter().filter(of_advice).collect();
                assert_eq!(messages.len(), 1);
                assert_eq!(messages[0].status, Status::Warning);
                assert!(messages[0].text.contains(wrong.advice), "{messages:?}");
                for (status, messages) in &steps {
                    if *status == Status::Ok {
                        assert!(logging_on || messages.is_empty(), "{messages:?}");
                        assert!(messages.iter().all(|m| m.status == Status::Ok));
                    }
                }
                instance.reset().expect("legal");
            }
        }
    }
}

/// Going back to a state is no new run: a master that repeats steps is told once.
#[test]
fn advice_is_not_repeated_by_a_host_that_goes_back() {
    let heard = Heard::default();
    let mechanism = parse(&crank("start = 0, max = 3"));
    let mut instance = started(heard.instance(mechanism, Interface::CoSimulation, false));
    let before = instance.fmu_state().expect("legal");
    for repeat in 0..3 {
        set(&mut instance, [("turn.position", 3.1)]);
        instance.do_step(0.0, 1.0).expect("limits are no walls");
        assert_eq!(instance.succeeded() == Status::Warning, repeat == 0);
        assert_eq!(heard.take_all().len(), usize::from(repeat == 0));
        instance.set_fmu_state(&before).expect("its own");
    }
}

/// All drivers that one call finds beyond their limits are named, whatever the settings.
#[test]
fn advice_names_all_drivers_of_a_call() {
    let heard = Heard::default();
    let mut instance = started(heard.instance(parse(TWO_RODS), Interface::CoSimulation, false));
    set(
        &mut instance,
        [("left.position", 3.0), ("right.position", 3.0)],
    );
    instance.do_step(0.0, 1.0).expect("limits are no walls");
    let messages = heard.take_all();
    let texts: Vec<_> = messages.iter().map(|message| &message.text).collect();
    assert!(
        matches!(&texts[..], [left, right] if left.contains("`left`") && right.contains("`right`")),
        "{texts:?}"
    );
}

/// FMI 3.0, 2.3.1: nothing is logged while `loggingOn` is false. A status has its message with it
/// (2.2.2): without one it would tell nobody what is wrong, and hosts end on it.
#[test]
fn advice_obeys_logging_on_in_fmi_3() {
    for wrong in &MISUSES {
        for logging_on in [false, true] {
            let heard = Heard::default();
            let model = MechanismModel::new((wrong.mechanism)(), wrong.interface);
            let sink = Box::new(heard.clone());
            let mut instance = Instance::of_version(
                Version::Fmi3,
                model.expect("it assembles"),
                sink,
                logging_on,
            );
            let steps = misuse(&mut instance, &heard, wrong);
            let warned = steps.iter().filter(|(s, _)| *s == Status::Warning);
            assert_eq!(warned.count(), usize::from(logging_on), "{}", wrong.advice);
            let logged = steps.iter().flat_map(|(_, messages)| messages);
            let warnings = logged.filter(|m| m.status == Status::Warning);
            assert_eq!(warnings.count(), usize::from(logging_on));
            let any = steps.iter().any(|(_, messages)| !messages.is_empty());
            assert_eq!(any, logging_on);
        }
    }
}

/// The names of 2.2.4 where it has one.
#[test]
fn categories_have_the_names_of_the_standard() {
    let names = Category::ALL.map(|(category, _)| category.name());
    assert_eq!(
        names,
        [
            "logAll",
            "logStatusWarning",
            "logStatusDiscard",
            "logStatusError",
            "logStatusFatal",
            "logEvents",
            "logNonlinearSystems",
        ]
    );
}

/// Advice of a kind that the host knows obeys its category.
#[test]
fn repeated_advice_is_switched_by_its_category() {
    let heard = Heard::default();
    let mut instance = started(heard.instance(shipped("tlv"), Interface::CoSimulation, false));
    let (mut time, mut warnings) = (0.0, 0);
    let mut approach = |instance: &mut Instance| {
        for length in [0.65 - 1e-9, 0.5] {
            set(instance, [(LENGTH, length)]);
            instance.do_step(time, 1.0).expect("just within reach");
            warnings += u32::from(instance.succeeded() == Status::Warning);
            time += 1.0;
        }
        heard.take_all()
    };
    assert_eq!(approach(&mut instance).len(), 1);
    assert_eq!(approach(&mut instance).len(), 0);
    instance
        .set_debug_logging(true, &["logStatusWarning"])
        .expect("it is one");
    let messages = approach(&mut instance);
    let [message] = &messages[..] else {
        panic!("{messages:?}")
    };
    assert_eq!(
        (message.status, message.category),
        (Status::Ok, Category::Warning)
    );
    assert!(message.text.contains("near a singular position"));
    assert_eq!(warnings, 1);
}

/// A host follows two slashes (RFC 3986, 3.2); a drive follows three.
#[test]
fn a_drive_in_place_of_a_host_is_refused_with_the_right_form() {
    let error = resource_path("file://C:/temp/resources").expect_err("`C:` is no host");
    assert_eq!(
        error.to_string(),
        "the resource location `file://C:/temp/resources` names the host `C:`; a drive follows \
         `file:///`"
    );
}

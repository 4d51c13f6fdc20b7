//! Messages to the logger (2.1.5, 2.2.4).

use biela::fmi::{Category, Error, Interface, Status, resource_path};

use crate::common::log::{Heard, Message};
use crate::common::{Instance, parse, shipped};
use crate::{set, started};

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
fn run(mut instance: Instance, heard: &Heard) -> Vec<(Result<(), Error>, Vec<Message>)> {
    let mut calls = Vec::new();
    let mut call = |instance: &mut Instance, call: &dyn Fn(&mut Instance) -> Result<(), Error>| {
        let outcome = call(instance);
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
/// nothing but what goes with an error or a discard. A message of status `fmi2Warning` goes with a
/// call that does not return `fmi2OK`.
#[test]
fn a_call_that_succeeds_warns_of_nothing_and_is_silent_without_logging() {
    let mut advice = 0;
    for (mechanism, logging_on) in [
        (shipped("tlv"), false),
        (shipped("tlv"), true),
        (redundant(), false),
        (redundant(), true),
    ] {
        let heard = Heard::default();
        let instance = heard.instance(mechanism, Interface::CoSimulation, logging_on);
        for (outcome, messages) in run(instance, &heard) {
            if outcome.is_ok() {
                assert!(
                    messages.iter().all(|m| m.status == Status::Ok),
                    "{messages:?}"
                );
                assert!(logging_on || messages.is_empty(), "{messages:?}");
                let warnings = messages.iter().filter(|m| m.category == Category::Warning);
                advice += warnings.count();
            } else {
                assert!(!messages.is_empty());
                assert_eq!(messages[0].status, Status::Warning);
            }
        }
    }
    // The approach to the dead point, and the redundant constraint.
    assert_eq!(advice, 2);
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

/// Advice obeys its category.
#[test]
fn advice_is_switched_by_its_category() {
    let heard = Heard::default();
    let mut instance = started(heard.instance(shipped("tlv"), Interface::CoSimulation, false));
    instance
        .set_debug_logging(true, &["logStatusWarning"])
        .expect("it is one");
    set(&mut instance, [(LENGTH, 0.65 - 1e-9)]);
    instance.do_step(0.0, 1.0).expect("just within reach");
    let messages = heard.take_all();
    let [message] = &messages[..] else {
        panic!("{messages:?}")
    };
    assert_eq!(message.category, Category::Warning);
    assert!(message.text.contains("near a singular position"));
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

//! Messages to the logger.

use biela::fmi::Status;

use crate::c_host::driver::{A, Answer, B, Fmu, Host, Instantiate, NULL};

#[test]
fn a_message_arrives_as_it_was_written() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    let name = "ü %s\t模";
    let with = Instantiate {
        name: Some(name.to_owned()),
        ..Instantiate::right(&fmu)
    };
    assert!(host.instantiate(B, &with).0);
    for (category, arrives) in [
        ("%s%n%d", "%s%n%d"),
        (r"a\tb\nc\\d", "a\tb\nc\\d"),
        ("ü 模", "ü 模"),
        // `#r1#` would be a reference to a variable; doubled it is text (FMI 2.0, 2.1.5).
        ("#r1#", "##r1##"),
    ] {
        let answer = host.call(&["SetDebugLogging", B, "1", "1", category]);
        let [message] = &answer.log[..] else {
            panic!("{answer:?}")
        };
        assert_eq!(
            (message.slot.as_str(), message.instance.as_str()),
            (B, name)
        );
        let expected = format!("fmi2SetDebugLogging: there is no log category `{arrives}`;");
        assert!(message.text.starts_with(&expected), "{message:?}");
    }
}

/// A logger that reads, sets, steps, resets and frees the instance gets errors, and the call that
/// it interrupts goes on as if there had been none of it.
#[test]
fn a_logger_that_calls_back_is_refused() {
    let fmu = Fmu::of("four_bar");
    let with = |callbacks| Instantiate {
        logging_on: true,
        callbacks,
        ..Instantiate::right(&fmu)
    };
    let mut host = Host::start();
    assert!(host.instantiate(A, &with("calls back")).0);
    assert!(host.instantiate(B, &with("full")).0);
    for request in [
        &["EnterInitializationMode"][..],
        &["ExitInitializationMode"],
        &["SetReal", "1", "1", "1.5"],
        &["SetReal", "1", "1", "nan"],
        &["DoStep", "0", "0.1", "1"],
    ] {
        let at = |slot| [&request[..1], &[slot], &request[1..]].concat();
        let (disturbed, undisturbed) = (host.call(&at(A)), host.call(&at(B)));
        assert_eq!(disturbed.status, undisturbed.status, "{request:?}");
        let mut log = disturbed.log.iter();
        for message in &undisturbed.log {
            let expected = format!("{} called back: 3 3 3 3", message.text);
            assert_eq!(log.next().map(|m| &m.text), Some(&expected), "{request:?}");
        }
        // One word about all of them, to the same logger.
        let told = log.next().map(|message| message.text.as_str());
        let expected = format!("fmi2{}: another call on this instance came", request[0]);
        assert_eq!(
            told.is_some_and(|told| told.starts_with(&expected)),
            !undisturbed.log.is_empty(),
            "{told:?}"
        );
        assert_eq!(log.next(), None);
    }
    let everything = fmu.reals();
    assert_eq!(
        host.get_reals(A, &everything),
        host.get_reals(B, &everything)
    );
    host.ok(&["FreeInstance", A]);
}

#[test]
fn categories_are_switched_on_and_off() {
    fn categories(answer: &Answer) -> Vec<&str> {
        assert!(
            answer
                .log
                .iter()
                .all(|message| message.status == Status::Ok)
        );
        answer
            .log
            .iter()
            .map(|message| message.category.as_str())
            .collect()
    }
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    let with = Instantiate {
        logging_on: true,
        ..Instantiate::right(&fmu)
    };
    assert_eq!(host.instantiate(A, &with), (true, vec![]));
    host.ok(&["EnterInitializationMode", A]);
    assert_eq!(
        categories(&host.call(&["ExitInitializationMode", A])),
        ["logEvents"]
    );
    assert_eq!(
        categories(&host.do_step(A, 0.0, 0.1)),
        ["logNonlinearSystems"]
    );

    // Off altogether, and then some again.
    host.ok(&["SetDebugLogging", A, "0", "0", NULL]);
    assert_eq!(categories(&host.do_step(A, 0.1, 0.1)), [""; 0]);
    host.ok(&[
        "SetDebugLogging",
        A,
        "1",
        "2",
        "logEvents,logNonlinearSystems",
    ]);
    assert_eq!(
        categories(&host.do_step(A, 0.2, 0.1)),
        ["logNonlinearSystems"]
    );
    host.ok(&["SetDebugLogging", A, "0", "1", "logNonlinearSystems"]);
    assert_eq!(categories(&host.do_step(A, 0.3, 0.1)), [""; 0]);
    // Settings outlast a reset.
    assert_eq!(categories(&host.call(&["Reset", A])), ["logEvents"]);
    host.ok(&["SetDebugLogging", A, "0", "1", "logEvents"]);
    host.ok(&["SetDebugLogging", A, "1", "1", "logAll"]);
    assert_eq!(categories(&host.call(&["Reset", A])), ["logEvents"]);
}

/// Whoever has not asked for messages is told of a wrong use: `loggingOn` switches debug logging
/// (2.1.5). The call returns `fmi2Warning`, once in a run.
#[test]
fn advice_on_wrong_use_reaches_a_host_with_default_settings() {
    let fmu = Fmu::of("tlv");
    let mut host = Host::start();
    host.instantiated(A, &fmu);
    for _ in 0..2 {
        host.initialize(A);
        // To within a nanometre of the dead point, and back.
        for (step, length) in [0.65 - 1e-9, 0.5, 0.65 - 1e-9, 0.5].into_iter().enumerate() {
            host.set_real(A, "1", length);
            let answer = host.do_step(A, step as f64, 1.0);
            assert_advice(&answer, step == 0, "near a singular position");
        }
        host.ok(&["Reset", A]);
    }

    // An angle alone in model exchange, 10 rad/s by steps of 0.1 s.
    let fmu = Fmu::of("four_bar");
    let with = Instantiate {
        model_exchange: true,
        ..Instantiate::right(&fmu)
    };
    assert_eq!(host.instantiate(B, &with), (true, vec![]));
    host.initialize(B);
    host.ok(&["NewDiscreteStates", B, "room"]);
    host.ok(&["EnterContinuousTimeMode", B]);
    for step in 1..20 {
        host.ok(&["SetTime", B, &(0.1 * f64::from(step)).to_string()]);
        host.set_real(B, "1", f64::from(step));
        let answer = host.call(&["CompletedIntegratorStep", B, "room", "room"]);
        // The sixth sample ends the fifth step that contradicts.
        assert_advice(&answer, step == 6, "connect `crank_angle.velocity`");
    }
}

#[track_caller]
fn assert_advice(answer: &Answer, expected: bool, part: &str) {
    if !expected {
        assert_eq!((answer.status, &answer.log[..]), (Status::Ok, &[][..]));
        return;
    }
    assert_eq!(answer.status, Status::Warning);
    let [message] = &answer.log[..] else {
        panic!("{answer:?}")
    };
    let found = (message.status, message.category.as_str());
    assert_eq!(found, (Status::Warning, "logStatusWarning"));
    assert!(message.text.contains(part), "{message:?}");
}

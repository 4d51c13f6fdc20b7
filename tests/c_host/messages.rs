//! Messages to the logger.

use biela::fmi::Status;

use crate::driver::{A, Answer, B, Fmu, Host, Instantiate, NULL};

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

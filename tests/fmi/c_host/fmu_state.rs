//! FMU states, got and set, written and read.

use biela::fmi::Status;

use crate::c_host::driver::{A, B, Fmu, Host, Instantiate};

/// A triangle that has taken two steps, the second one with a derivative given.
fn running(host: &mut Host, slot: &str, fmu: &Fmu) {
    host.instantiated(slot, fmu);
    host.initialize(slot);
    host.set_real(slot, "1", 0.37);
    assert_eq!(host.do_step(slot, 0.0, 0.1).status, Status::Ok);
    host.ok(&["SetRealInputDerivatives", slot, "1", "1", "1", "0.2"]);
    assert_eq!(host.do_step(slot, 0.1, 0.1).status, Status::Ok);
}

/// All Reals after each of some steps from 0.2 s on.
fn go_on(host: &mut Host, slot: &str, fmu: &Fmu) -> Vec<Vec<f64>> {
    (2..10)
        .map(|step| {
            let t = 0.1 * f64::from(step);
            host.set_real(slot, "1", 0.35 + 0.1 * t);
            assert_eq!(host.do_step(slot, t, 0.1).status, Status::Ok, "{t}");
            host.get_reals(slot, &fmu.reals())
        })
        .collect()
}

/// The state in a slot as hexadecimal digits, and its size.
fn bytes(host: &mut Host, slot: &str, state: &str) -> (String, String) {
    let size = host
        .ok(&["SerializedFMUstateSize", slot, state, "room"])
        .remove(0);
    let bytes = host
        .ok(&["SerializeFMUstate", slot, state, &size, "room"])
        .remove(0);
    assert_eq!(bytes.len(), 2 * size.parse::<usize>().expect("a number"));
    (bytes, size)
}

#[test]
fn a_host_goes_back_to_a_state_and_gets_the_same_numbers() {
    let fmu = Fmu::of("tlv");
    let mut host = Host::start();
    running(&mut host, A, &fmu);
    // There is a state then, and it is not what was there before.
    assert_eq!(host.ok(&["GetFMUstate", A, "0"]), ["1", "0"]);
    let first = go_on(&mut host, A, &fmu);
    host.ok(&["SetFMUstate", A, "0"]);
    assert_eq!(go_on(&mut host, A, &fmu), first, "to the last bit");

    // As bytes, in another instance that has done nothing yet; the first is gone by then.
    let (bytes, size) = bytes(&mut host, A, "0");
    host.ok(&["FreeFMUstate", A, "0"]);
    host.ok(&["FreeInstance", A]);
    host.instantiated(B, &fmu);
    assert_eq!(
        host.ok(&["DeSerializeFMUstate", B, &bytes, &size, "1"]),
        ["1"]
    );
    host.ok(&["SetFMUstate", B, "1"]);
    assert_eq!(go_on(&mut host, B, &fmu), first, "to the last bit");
}

#[test]
fn a_step_that_failed_is_taken_back() {
    let fmu = Fmu::of("tlv");
    let mut host = Host::start();
    running(&mut host, B, &fmu);
    let expected = go_on(&mut host, B, &fmu);

    running(&mut host, A, &fmu);
    host.ok(&["GetFMUstate", A, "0"]);
    host.set_real(A, "1", 0.9);
    assert_eq!(host.do_step(A, 0.2, 0.1).status, Status::Discard);
    assert_eq!(host.ok(&["GetBooleanStatus", A, "3", "room"]), ["1"]);
    host.refused(&["DoStep", A, "0.2", "0.1", "1"]);
    host.ok(&["SetFMUstate", A, "0"]);
    assert_eq!(host.ok(&["GetBooleanStatus", A, "3", "room"]), ["0"]);
    assert_eq!(go_on(&mut host, A, &fmu), expected, "to the last bit");
}

#[test]
fn a_state_is_replaced_freed_and_outlives_its_instance() {
    let fmu = Fmu::of("tlv");
    let mut host = Host::start();
    running(&mut host, A, &fmu);
    assert_eq!(host.ok(&["GetFMUstate", A, "0"]), ["1", "0"]);
    let (early, _) = bytes(&mut host, A, "0");
    let after = go_on(&mut host, A, &fmu);
    // The same object, with the state of now in it.
    assert_eq!(host.ok(&["GetFMUstate", A, "0"]), ["1", "1"]);
    assert_ne!(bytes(&mut host, A, "0").0, early);
    host.ok(&["FreeInstance", A]);

    host.instantiated(B, &fmu);
    host.ok(&["SetFMUstate", B, "0"]);
    assert_eq!(Some(&host.get_reals(B, &fmu.reals())), after.last());
    // Null then, and once more is no harm.
    assert_eq!(host.ok(&["FreeFMUstate", B, "0"]), ["0", "0"]);
    assert_eq!(host.ok(&["FreeFMUstate", B, "0"]), ["0", "1"]);
}

#[test]
fn states_that_do_not_fit_are_refused_and_change_nothing() {
    let [fmu, other] = ["tlv", "tlv_crank"].map(Fmu::of);
    let mut host = Host::start();
    running(&mut host, A, &fmu);
    host.instantiated(B, &other);
    host.ok(&["GetFMUstate", B, "1"]);
    host.ok(&["GetFMUstate", A, "0"]);
    let before = host.get_reals(A, &fmu.reals());

    let (bytes_of_other, size_of_other) = bytes(&mut host, B, "1");
    for request in [
        &["SetFMUstate", A, "1"][..],
        &["SerializedFMUstateSize", A, "1", "room"],
        &["SerializeFMUstate", A, "1", &size_of_other, "room"],
        &[
            "DeSerializeFMUstate",
            A,
            &bytes_of_other,
            &size_of_other,
            "2",
        ],
    ] {
        let reason = host.refused(request);
        assert!(
            reason.contains(&other.guid) && reason.contains(&fmu.guid),
            "{reason}"
        );
    }

    // Room for one byte less or more; nothing is written there.
    let (bytes, size) = bytes(&mut host, A, "0");
    let right: usize = size.parse().unwrap();
    for wrong in [right - 1, right + 1] {
        let answer = host.call(&["SerializeFMUstate", A, "0", &wrong.to_string(), "room"]);
        assert_eq!(answer.status, Status::Error);
        assert_eq!(answer.results, ["07".repeat(wrong)]);
        let expected = format!("takes {right} bytes, and there is room for {wrong}");
        assert!(answer.log[0].text.contains(&expected), "{answer:?}");
    }
    host.refused(&["SerializeFMUstate", A, "0", &size, r"\N"]);
    host.refused(&["SerializedFMUstateSize", A, "0", r"\N"]);

    // Another hexadecimal digit at a place.
    let altered = |at: usize| {
        let mut bytes = bytes.clone();
        let digit = if &bytes[at..=at] == "2" { "4" } else { "2" };
        bytes.replace_range(at..=at, digit);
        bytes
    };
    let shorter = (right - 1).to_string();
    for (bytes, size, why) in [
        (&bytes, &shorter, "bytes long when it was written"),
        (&altered(0), &size, "no serialized FMU state of biela"),
        (
            &altered(17),
            &size,
            "has version 2; this FMU reads version 12",
        ),
        (&altered(2 * right - 1), &size, "checksum"),
    ] {
        let reason = host.refused(&["DeSerializeFMUstate", A, bytes, size, "2"]);
        assert!(reason.contains(why), "{reason}");
    }
    assert_eq!(host.get_reals(A, &fmu.reals()), before);
}

#[test]
fn setting_a_state_is_an_event() {
    let fmu = Fmu::of("tlv");
    let mut host = Host::start();
    let with = Instantiate {
        logging_on: true,
        ..Instantiate::right(&fmu)
    };
    assert!(host.instantiate(A, &with).0);
    host.ok(&["GetFMUstate", A, "0"]);
    let answer = host.call(&["SetFMUstate", A, "0"]);
    assert_eq!(answer.log[0].category, "logEvents");
    assert!(
        answer.log[0].text.contains("instantiated at t = 0 s"),
        "{answer:?}"
    );
}

//! Steps, those that fail, and what is told of them.

use biela::fmi::Status;

use crate::c_host::driver::{A, Fmu, Host, Instantiate};

#[test]
fn a_step_beyond_a_dead_point_is_discarded() {
    let fmu = Fmu::of("tlv");
    let mut host = Host::start();
    let with = Instantiate {
        logging_on: true,
        ..Instantiate::right(&fmu)
    };
    for (with, categories) in [
        (Instantiate::right(&fmu), &["logStatusWarning"][..]),
        (with, &["logStatusWarning", "logStatusDiscard"]),
    ] {
        assert_eq!(host.instantiate(A, &with), (true, vec![]));
        for request in ["EnterInitializationMode", "ExitInitializationMode"] {
            assert_eq!(host.call(&[request, A]).status, Status::Ok);
        }
        host.set_real(A, "1", 0.4);
        assert_eq!(host.do_step(A, 0.0, 0.1).status, Status::Ok);
        let before = host.get_reals(A, &fmu.outputs());

        host.set_real(A, "1", 0.9);
        let answer = host.do_step(A, 0.1, 0.1);
        assert_eq!(answer.status, Status::Discard);
        let logged: Vec<_> = answer
            .log
            .iter()
            .map(|message| message.category.as_str())
            .collect();
        assert_eq!(logged, categories);
        let warning = &answer.log[0];
        assert_eq!(warning.status, Status::Warning);
        for part in ["`side_length`", "0.900000000 m", "0.65"] {
            assert!(warning.text.contains(part), "{part}: {}", warning.text);
        }

        assert_eq!(
            host.ok(&["GetStatus", A, "0", "room"]),
            ["2"],
            "fmi2Discard"
        );
        assert_eq!(
            host.ok(&["GetBooleanStatus", A, "3", "room"]),
            ["1"],
            "fmi2True"
        );
        assert_eq!(
            host.ok(&["GetRealStatus", A, "2", "room"])[0].parse(),
            Ok(0.1)
        );
        // The pose of the last communication point, for a held input jumps at the very end.
        assert_eq!(host.get_reals(A, &fmu.outputs()), before);
        host.ok(&["FreeInstance", A]);
    }
}

#[test]
fn a_moving_input_gets_as_far_as_the_dead_point() {
    let fmu = Fmu::of("tlv");
    let mut host = Host::start();
    host.instantiated(A, &fmu);
    host.initialize(A);
    // From 0.35 m at 1 m/s, 0.65 m is reached after 0.3 s.
    host.ok(&["SetRealInputDerivatives", A, "1", "1", "1", "1"]);
    assert_eq!(host.do_step(A, 0.0, 0.5).status, Status::Discard);
    let last: f64 = host.ok(&["GetRealStatus", A, "2", "room"])[0]
        .parse()
        .unwrap();
    assert!((0.299..=0.3).contains(&last), "{last}");

    // After a reset there is nothing left of it.
    host.ok(&["Reset", A]);
    host.initialize(A);
    assert_eq!(host.ok(&["GetBooleanStatus", A, "3", "room"]), ["0"]);
    assert_eq!(host.do_step(A, 0.0, 0.5).status, Status::Ok);
}

#[test]
fn input_derivatives_carry_the_input_along() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    host.instantiated(A, &fmu);
    host.initialize(A);
    let (start, first, second, h) = (1.0, 2.0, -3.0, 0.25);
    host.set_real(A, "1", start);
    host.ok(&["SetRealInputDerivatives", A, "2", "1,1", "1,2", "2,-3"]);
    assert_eq!(host.do_step(A, 0.0, h).status, Status::Ok);
    for (name, expected) in [
        ("crank.phi", start + h * (first + 0.5 * h * second)),
        ("crank.omega", first + h * second),
        ("crank.alpha", second),
    ] {
        let value = host.get_real(A, &fmu.vr(name));
        assert!((value - expected).abs() < 1e-12, "{name}: {value}");
    }
}

#[test]
fn derivatives_of_outputs_are_the_outputs_of_the_next_order() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    host.instantiated(A, &fmu);
    host.initialize(A);
    host.ok(&["SetReal", A, "3", "1,2,3", "1.2,3,-4"]);
    assert_eq!(host.do_step(A, 0.0, 0.1).status, Status::Ok);
    let outputs = [
        "rocker.phi",
        "rocker.phi",
        "rocker.omega",
        "coupler.P.y",
        "coupler.P.vy",
    ];
    let orders = "1,2,1,2,1";
    let expected = [
        "rocker.omega",
        "rocker.alpha",
        "rocker.alpha",
        "coupler.P.ay",
        "coupler.P.ay",
    ];
    let list = |names: [&str; 5]| names.map(|name| fmu.vr(name)).join(",");
    let derivatives = host.ok(&[
        "GetRealOutputDerivatives",
        A,
        "5",
        &list(outputs),
        orders,
        "room",
    ]);
    assert_eq!(
        derivatives,
        host.ok(&["GetReal", A, "5", &list(expected), "room"])
    );
    assert_eq!(derivatives.iter().filter(|value| *value == "0").count(), 0);

    // Others up to order 2 are zero (4.2.1).
    let outputs = [
        ("rocker.alpha", "1"),
        ("rocker.omega", "2"),
        ("rocker.alpha", "2"),
    ];
    for (output, order) in outputs {
        let list = [fmu.vr("rocker.phi"), fmu.vr(output)].join(",");
        let orders = format!("1,{order}");
        let request = ["GetRealOutputDerivatives", A, "2", &list, &orders, "room"];
        let found = host.ok(&request);
        assert_eq!(found, [&derivatives[0], "0"], "{output}");
    }
}

#[test]
fn a_status_that_does_not_exist_is_discarded() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    host.instantiated(A, &fmu);
    host.initialize(A);
    for (call, kind, untouched) in [
        // `fmi2Pending`, which is what the host puts there.
        ("GetStatus", "1", "5"),
        ("GetRealStatus", "0", "7"),
        ("GetIntegerStatus", "0", "7"),
        ("GetBooleanStatus", "99", "7"),
    ] {
        let answer = host.call(&[call, A, kind, "room"]);
        assert_eq!(answer.status, Status::Discard, "{call}");
        assert_eq!(answer.results, [untouched], "{call}");
        assert_eq!(answer.log, [], "{call}");
    }
}

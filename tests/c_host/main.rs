//! The library as a host in C sees it: `tests/host.c` calls it through the standard's header.

#![cfg(c_host)]

mod driver;

use std::collections::BTreeSet;
use std::io::Write;
use std::process::Command;
use std::sync::Arc;

use biela::fmi::{Call, Category, Instance, Sink, State, Status};
use driver::{A, Answer, B, Fmu, Host, Instantiate, NULL, has, library, percent_encoded};

/// Functions of capabilities that are not declared, and why they are not served.
const NOT_SERVED: [(&str, &str); 19] = [
    ("GetFMUstate", "cannot get and set its state"),
    ("SetFMUstate", "cannot get and set its state"),
    ("FreeFMUstate", "cannot get and set its state"),
    ("SerializedFMUstateSize", "cannot get and set its state"),
    ("SerializeFMUstate", "cannot get and set its state"),
    ("DeSerializeFMUstate", "cannot get and set its state"),
    ("GetDirectionalDerivative", "no directional derivatives"),
    ("GetRealOutputDerivatives", "no output derivatives"),
    ("CancelStep", "does not run asynchronously"),
    ("EnterEventMode", "for co-simulation only"),
    ("NewDiscreteStates", "for co-simulation only"),
    ("EnterContinuousTimeMode", "for co-simulation only"),
    ("CompletedIntegratorStep", "for co-simulation only"),
    ("SetTime", "for co-simulation only"),
    ("SetContinuousStates", "for co-simulation only"),
    ("GetDerivatives", "for co-simulation only"),
    ("GetEventIndicators", "for co-simulation only"),
    ("GetContinuousStates", "for co-simulation only"),
    ("GetNominalsOfContinuousStates", "for co-simulation only"),
];

/// Calls that no state decides about.
const IN_NO_STATE: [&str; 4] = [
    "GetTypesPlatform",
    "GetVersion",
    "Instantiate",
    "FreeInstance",
];

#[test]
fn the_functions_of_the_header_are_exported_and_nothing_else() {
    let header = format!("{}/fmi2Functions.h", env!("BIELA_FMI_HEADERS"));
    let header = std::fs::read_to_string(header).unwrap();
    let declared: BTreeSet<_> = header
        .lines()
        .filter_map(|line| line.trim().strip_prefix("FMI2_Export fmi2"))
        .filter_map(|line| line.trim_end_matches(';').split_whitespace().last())
        .collect();
    assert_eq!(declared.len(), 44);

    let calls = Call::ALL.iter().map(|call| call.name());
    let here: BTreeSet<_> = calls
        .map(|name| name.strip_prefix("fmi2").unwrap())
        .chain(NOT_SERVED.map(|(name, _)| name))
        .chain(IN_NO_STATE)
        .map(|name| format!("fmi2{name}"))
        .collect();
    let declared: BTreeSet<_> = declared.iter().map(|name| name.to_string()).collect();
    assert_eq!(here, declared, "what these tests call");

    let list: &[&str] = if cfg!(target_vendor = "apple") {
        &["-g", "-U"]
    } else {
        &["-D", "--defined-only"]
    };
    let nm = Command::new("nm").args(list).arg(library()).output();
    let nm = nm.expect("the linker brings `nm` along");
    let exported: BTreeSet<_> = String::from_utf8(nm.stdout)
        .unwrap()
        .lines()
        .filter_map(|line| line.split_whitespace().last())
        .map(|symbol| symbol.trim_start_matches('_').to_owned())
        .collect();
    assert_eq!(exported, declared, "what the library exports");
}

/// Position, velocity and acceleration of the crank at time `t`.
fn motion(t: f64) -> [f64; 3] {
    [1.0 + 2.0 * t + t * t, 2.0 + 2.0 * t, 2.0]
}

/// The communication points of [`run`].
fn points() -> impl Iterator<Item = f64> {
    (0..20).map(|step| 0.1 * f64::from(step))
}

/// All Real variables after each step of a run with the first driver's three inputs set.
fn run(host: &mut Host, slot: &str, fmu: &Fmu) -> Vec<Vec<f64>> {
    host.instantiated(slot, fmu);
    host.initialize(slot);
    let rows = points()
        .map(|t| {
            let values = motion(t).map(|value| value.to_string()).join(",");
            host.ok(&["SetReal", slot, "3", "0,1,2", &values]);
            host.ok(&["DoStep", slot, &t.to_string(), "0.1", "1"]);
            host.get_reals(slot, &fmu.reals())
        })
        .collect();
    host.ok(&["Terminate", slot]);
    host.ok(&["FreeInstance", slot]);
    rows
}

/// The same in Rust.
fn run_in_rust(fmu: &Fmu) -> Vec<Vec<f64>> {
    struct Silent;
    impl Sink for Silent {
        fn write(&self, status: Status, _: Category, message: &str) {
            panic!("{status:?}: {message}");
        }
    }
    let mut instance =
        Instance::new(Arc::clone(&fmu.mechanism), Box::new(Silent), false).expect("it assembles");
    let ready = instance
        .setup_experiment(0.0, None)
        .and_then(|()| instance.enter_initialization_mode())
        .and_then(|()| instance.exit_initialization_mode());
    ready.expect("the start values are those of the file");
    points()
        .map(|t| {
            let reals = fmu.reals();
            let mut values = vec![0.0; reals.len()];
            let stepped = instance
                .set_real(&[0, 1, 2], &motion(t))
                .and_then(|()| instance.do_step(t, 0.1))
                .and_then(|()| instance.get_real(&reals, &mut values));
            stepped.expect("the crank turns fully");
            values
        })
        .collect()
}

#[test]
fn a_run_gives_what_it_gives_in_rust() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    let rows = run(&mut host, A, &fmu);
    assert_eq!(rows, run_in_rust(&fmu), "to the last bit");

    // And what it should: held inputs, so that the crank is where it was set before the step.
    let column = |name: &str| {
        let value_reference: u32 = fmu.vr(name).parse().unwrap();
        let mut reals = fmu.reals().into_iter();
        reals.position(|real| real == value_reference).unwrap()
    };
    let crank = ["crank.phi", "crank.omega", "crank.alpha"].map(column);
    for (t, row) in points().zip(&rows) {
        for (column, expected) in crank.into_iter().zip(motion(t)) {
            assert!((row[column] - expected).abs() < 1e-12, "{t}");
        }
    }
}

#[test]
fn one_thread_after_another_may_use_an_instance() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    let rows = run(&mut host, A, &fmu);
    host.in_threads = true;
    assert_eq!(run(&mut host, A, &fmu), rows);
}

#[test]
fn instances_do_not_know_of_each_other() {
    let [crank, triangle] = ["four_bar", "tlv"].map(Fmu::of);
    let start = |host: &mut Host, slot: &str, fmu: &Fmu| {
        host.instantiated(slot, fmu);
        host.initialize(slot);
    };
    // Both ways of driving keep within what the triangle can do.
    let step = |host: &mut Host, slot: &str, fmu: &Fmu, t: f64| {
        host.set_real(slot, "0", 0.35 + 0.1 * t);
        assert_eq!(host.do_step(slot, t, 0.1).status, Status::Ok);
        host.get_reals(slot, &fmu.reals())
    };

    let mut host = Host::start();
    let alone = [&crank, &triangle].map(|fmu| {
        start(&mut host, A, fmu);
        let rows: Vec<_> = points().map(|t| step(&mut host, A, fmu, t)).collect();
        host.ok(&["FreeInstance", A]);
        rows
    });

    start(&mut host, A, &crank);
    start(&mut host, B, &triangle);
    for (row, t) in points().enumerate() {
        assert_eq!(step(&mut host, A, &crank, t), alone[0][row]);
        assert_eq!(step(&mut host, B, &triangle, t), alone[1][row]);
    }
    // Each has its own environment.
    for slot in [A, B] {
        let answer = host.call(&["SetTime", slot]);
        assert_eq!(answer.log[0].slot, slot);
    }
}

#[test]
fn instances_come_and_go() {
    let fmu = Fmu::of("pendulum");
    let mut host = Host::start();
    let mut first = None;
    // More often than a process may usually have files open.
    for _ in 0..1100 {
        host.instantiated(A, &fmu);
        host.initialize(A);
        host.set_real(A, "0", 0.5);
        assert_eq!(host.do_step(A, 0.0, 0.1).status, Status::Ok);
        let values = host.get_reals(A, &fmu.reals());
        host.ok(&["FreeInstance", A]);
        assert_eq!(*first.get_or_insert_with(|| values.clone()), values);
    }
}

#[test]
fn memory_is_used_as_it_should() {
    if !has("valgrind") {
        // Not captured as `eprintln!` would be.
        writeln!(std::io::stderr(), "SKIPPED: valgrind is not installed").unwrap();
        return;
    }
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--quiet", "--error-exitcode=1", "--leak-check=full"]);
    valgrind.arg(env!("BIELA_C_HOST"));
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start_with(valgrind);
    run(&mut host, A, &fmu);
    let mut wrong = Instantiate::right(&fmu);
    wrong.guid = Some("wrong".to_owned());
    assert!(!host.instantiate(A, &wrong).0);
    host.instantiated(A, &fmu);
    host.initialize(A);
    for (request, _) in refusals(REFUSED, &fmu) {
        host.call(&request);
    }
    // What valgrind finds it tells on stderr, which has to be empty in the end.
}

#[test]
fn the_platform_and_version_are_those_of_the_standard() {
    let mut host = Host::start();
    assert_eq!(host.ok(&["GetTypesPlatform"]), ["default"]);
    assert_eq!(host.ok(&["GetVersion"]), ["2.0"]);
}

/// The call with right arguments for the triangle driven by its length, at 0.1 s.
fn request(call: Call, slot: &str, state: State) -> Vec<String> {
    // Position input, fixed parameter `rates`, and `arm.x`.
    let (input, rates, output) = ("0", "5", "7");
    let arguments: &[&str] = match call {
        Call::SetDebugLogging => &["1", "1", "logEvents"],
        Call::SetupExperiment => &["0.5", "2"],
        Call::EnterInitializationMode
        | Call::ExitInitializationMode
        | Call::Terminate
        | Call::Reset => &[],
        Call::GetReal => &["1", output, "room"],
        Call::GetInteger => &["1", rates, "room"],
        Call::SetReal => &["1", input, "0.41"],
        // After initialization there is nothing left to be set.
        Call::SetInteger if state == State::StepComplete => &["0", NULL, NULL],
        Call::SetInteger => &["1", rates, "2"],
        // There are no such variables.
        Call::GetBoolean | Call::GetString => &["0", "", "room"],
        Call::SetBoolean | Call::SetString => &["0", "", ""],
        Call::SetRealInputDerivatives => &["1", input, "1", "0.1"],
        Call::DoStep => &["0.1", "0.1", "1"],
        Call::GetStatus => &["0", "room"],
        Call::GetIntegerStatus | Call::GetStringStatus => &["1", "room"],
        Call::GetRealStatus => &["2", "room"],
        Call::GetBooleanStatus => &["3", "room"],
    };
    let name = call.name().trim_start_matches("fmi2");
    let request = [name, slot].into_iter().chain(arguments.iter().copied());
    request.map(str::to_owned).collect()
}

#[test]
fn the_null_instance_is_refused_by_every_function() {
    let mut host = Host::start();
    let nothing_but_an_error =
        |answer: Answer| answer.status == Status::Error && answer.log.is_empty();
    for &call in Call::ALL {
        let answer = host.call(&request(call, NULL, State::Instantiated));
        assert!(nothing_but_an_error(answer), "{}", call.name());
    }
    for (name, _) in NOT_SERVED {
        assert!(nothing_but_an_error(host.call(&[name, NULL])), "{name}");
    }
    host.ok(&["FreeInstance", NULL]);
}

/// Brings a new instance of the triangle into a state.
fn bring_to(host: &mut Host, state: State, fmu: &Fmu) {
    host.instantiated(A, fmu);
    match state {
        State::Instantiated => {}
        State::InitializationMode => {
            host.ok(&["SetupExperiment", A, "0", NULL]);
            host.ok(&["EnterInitializationMode", A]);
        }
        State::StepComplete | State::StepFailed | State::Terminated => {
            host.initialize(A);
            host.set_real(A, "0", 0.4);
            assert_eq!(host.do_step(A, 0.0, 0.1).status, Status::Ok);
            if state == State::StepFailed {
                host.set_real(A, "0", 0.9);
                assert_eq!(host.do_step(A, 0.1, 0.1).status, Status::Discard);
            } else if state == State::Terminated {
                host.ok(&["Terminate", A]);
            }
        }
        State::Error => {
            host.ok(&["SetupExperiment", A, "0", NULL]);
            host.ok(&["EnterInitializationMode", A]);
            // A side of 0.35 m and a base of 0.4 m do not reach that far.
            host.set_real(A, &fmu.vr("arm_length"), 10.0);
            host.refused(&["ExitInitializationMode", A]);
        }
        State::Fatal => unreachable!("no call leads there"),
    }
}

/// All that can be found out about the instance, in whatever state it is; frees it.
fn examine(host: &mut Host, fmu: &Fmu) -> Vec<Answer> {
    let reals: Vec<_> = fmu.reals().iter().map(u32::to_string).collect();
    let (n, reals) = (reals.len().to_string(), reals.join(","));
    let look: [&[&str]; 5] = [
        &["GetReal", A, &n, &reals, "room"],
        &["GetInteger", A, "2", "5,6", "room"],
        &["GetStatus", A, "0", "room"],
        &["GetRealStatus", A, "2", "room"],
        &["GetBooleanStatus", A, "3", "room"],
    ];
    let go_on: [&[&str]; 9] = [
        &["DoStep", A, "0.1", "0.1", "1"],
        &["EnterInitializationMode", A],
        &["ExitInitializationMode", A],
        &["DoStep", A, "0", "0.1", "1"],
        &["Terminate", A],
        &["Reset", A],
        &["EnterInitializationMode", A],
        &["ExitInitializationMode", A],
        &["FreeInstance", A],
    ];
    let mut answers: Vec<_> = look.iter().map(|request| host.call(request)).collect();
    for request in go_on {
        answers.push(host.call(request));
        if request[0] != "FreeInstance" {
            answers.extend(look.iter().map(|request| host.call(request)));
        }
    }
    answers
}

#[test]
fn each_state_allows_its_calls_and_refuses_the_others_without_a_trace() {
    let fmu = Fmu::of("tlv");
    let mut host = Host::start();
    for state in State::ALL {
        if state == State::Fatal {
            assert!(
                !Call::ALL
                    .iter()
                    .any(|call| call.allowed_in().contains(&state))
            );
            continue;
        }
        bring_to(&mut host, state, &fmu);
        let undisturbed = examine(&mut host, &fmu);
        for &call in Call::ALL {
            bring_to(&mut host, state, &fmu);
            let request = request(call, A, state);
            if call.allowed_in().contains(&state) {
                let answer = host.call(&request);
                // For the standard defines no status that these two could give.
                let none = matches!(call, Call::GetIntegerStatus | Call::GetStringStatus);
                let expected = if none { Status::Discard } else { Status::Ok };
                assert_eq!(answer.status, expected, "{} in {state}", call.name());
                host.ok(&["FreeInstance", A]);
            } else {
                let reason = host.refused(&request);
                let expected = format!("not allowed in state {state}");
                assert!(reason.contains(&expected), "{reason}");
                assert!(
                    examine(&mut host, &fmu) == undisturbed,
                    "{} left a trace in {state}",
                    call.name()
                );
            }
        }
    }
}

#[test]
fn functions_of_capabilities_not_declared_say_so_and_change_nothing() {
    let fmu = Fmu::of("tlv");
    let mut host = Host::start();
    for state in State::ALL
        .into_iter()
        .filter(|&state| state != State::Fatal)
    {
        bring_to(&mut host, state, &fmu);
        let undisturbed = examine(&mut host, &fmu);
        bring_to(&mut host, state, &fmu);
        for (name, why) in NOT_SERVED {
            let reason = host.refused(&[name, A]);
            assert!(reason.contains(why), "{reason}");
        }
        assert!(examine(&mut host, &fmu) == undisturbed, "in {state}");
    }
}

/// Calls in state `stepComplete` of the four-bar, at 0 s of 1 s, with the reason to refuse each;
/// `@` precedes a variable that stands for its value reference.
const REFUSED: &str = "
# References.
GetReal A 1 9999 room -> no variable with value reference 9999
SetReal A 1 9999 1 -> no variable with value reference 9999
GetInteger A 1 9999 room -> no variable with value reference 9999
SetInteger A 1 9999 1 -> no variable with value reference 9999
GetBoolean A 1 9999 room -> no variable with value reference 9999
GetString A 1 4294967295 room -> no variable with value reference 4294967295
SetRealInputDerivatives A 1 9999 1 1 -> no variable with value reference 9999
# Types.
GetReal A 1 @rates room -> `rates` is an Enumeration, not Real
SetReal A 1 @rates 2 -> `rates` is an Enumeration, not Real
GetReal A 1 @solver.iterations room -> `solver.iterations` is an Integer, not Real
GetInteger A 1 @crank.phi room -> `crank.phi` is a Real, not Integer
SetInteger A 1 @crank_angle.position 1 -> is a Real, not Integer
GetBoolean A 1 @crank.phi room -> `crank.phi` is a Real, not Boolean
SetBoolean A 1 @crank_angle.position 1 -> is a Real, not Boolean
GetString A 1 @rates room -> `rates` is an Enumeration, not String
SetString A 1 @crank_angle.position x -> is a Real, not String
# What cannot be set.
SetReal A 1 @crank.phi 1 -> `crank.phi` cannot be set: it is an output
SetReal A 1 @solver.residual 1 -> it is about the solver
SetInteger A 1 @solver.iterations 1 -> it is about the solver
SetReal A 1 @time 1 -> it is the time
SetReal A 1 @crank_length 0.1 -> a fixed parameter, and initialization has ended
SetInteger A 1 @rates 2 -> a fixed parameter, and initialization has ended
SetRealInputDerivatives A 1 @crank.phi 1 1 -> only inputs have input derivatives
# Values. What is right before what is wrong is not taken either.
SetReal A 1 @crank_angle.position nan -> not a finite number
SetReal A 1 @crank_angle.velocity inf -> not a finite number
SetReal A 2 @crank_angle.position,@crank_angle.acceleration 1.3,-inf -> not a finite number
SetReal A 2 @crank_angle.position,@rocker_length 1.3,0 -> cannot be set to 0: expected at least 0.001
SetRealInputDerivatives A 1 @crank_angle.position 0 1 -> order 0 are not known; expected 1 or 2
SetRealInputDerivatives A 2 @crank_angle.position,@crank_angle.position 1,3 1,1 -> order 3 are not known
SetRealInputDerivatives A 1 @crank_angle.position 1 nan -> not a finite number
# Steps.
DoStep A 0.5 0.1 1 -> is not where the last step ended, 0 s
DoStep A 0 0 1 -> the step size 0 s is not positive
DoStep A 0 -0.1 1 -> the step size -0.1 s is not positive
DoStep A nan 0.1 1 -> `currentCommunicationPoint` cannot be set to NaN
DoStep A 0 inf 1 -> `communicationStepSize` cannot be set to inf
DoStep A 0 1.5 1 -> passes the stop time 1 s
# Arrays.
GetReal A 1 NULL room -> `vr` is a null pointer
GetReal A 1 @crank.phi NULL -> `value` is a null pointer
SetReal A 1 NULL 1 -> `vr` is a null pointer
SetReal A 1 @crank_angle.position NULL -> `value` is a null pointer
GetInteger A 1 NULL room -> `vr` is a null pointer
GetInteger A 1 @rates NULL -> `value` is a null pointer
SetInteger A 1 NULL 1 -> `vr` is a null pointer
SetInteger A 1 @rates NULL -> `value` is a null pointer
GetBoolean A 1 NULL room -> `vr` is a null pointer
SetBoolean A 1 NULL 1 -> `vr` is a null pointer
GetString A 1 NULL room -> `vr` is a null pointer
SetString A 1 NULL x -> `vr` is a null pointer
SetRealInputDerivatives A 1 NULL 1 1 -> `vr` is a null pointer
SetRealInputDerivatives A 1 @crank_angle.position NULL 1 -> `order` is a null pointer
SetRealInputDerivatives A 1 @crank_angle.position 1 NULL -> `value` is a null pointer
GetReal A 18446744073709551615 @crank.phi room -> `vr` has an impossible length
GetStatus A 0 NULL -> `value` is a null pointer
GetRealStatus A 2 NULL -> `value` is a null pointer
GetBooleanStatus A 3 NULL -> `value` is a null pointer
# Log categories.
SetDebugLogging A 1 1 NULL -> `categories` is a null pointer
SetDebugLogging A 1 2 logEvents,NULL -> `category` is a null pointer
SetDebugLogging A 1 2 logEvents,logNothing -> no log category `logNothing`; expected logAll
";

/// The same in state `instantiated`.
const REFUSED_BEFORE: &str = "
SetupExperiment A nan NULL -> `startTime` cannot be set to NaN
SetupExperiment A 0 inf -> `stopTime` cannot be set to inf
SetupExperiment A 2 1 -> the stop time 1 s is before the start time 2 s
SetInteger A 1 @rates 0 -> expected 1 to 3
SetInteger A 2 @rates,@extrapolation 2,3 -> expected 1 to 2
SetInteger A 1 @rates -2147483648 -> expected 1 to 3
SetReal A 1 @crank_length -1 -> expected at least 0.001
SetReal A 1 @crank_length nan -> not a finite number
";

/// Each request of a list as the host takes it, and the reason to refuse it.
fn refusals<'a>(list: &'a str, fmu: &Fmu) -> impl Iterator<Item = (Vec<String>, &'a str)> {
    let item = |item: &str| match (item, item.strip_prefix('@')) {
        ("A", _) => A.to_owned(),
        ("NULL", _) => NULL.to_owned(),
        (_, Some(variable)) => fmu.vr(variable),
        (other, None) => other.to_owned(),
    };
    let field = move |field: &str| field.split(',').map(item).collect::<Vec<_>>().join(",");
    let entries = list
        .lines()
        .filter(|line| !(line.is_empty() || line.starts_with('#')));
    entries.map(move |line| {
        let (request, why) = line.split_once(" -> ").expect("a request and a reason");
        (request.split(' ').map(&field).collect(), why)
    })
}

#[test]
fn wrong_arguments_are_refused_and_change_nothing() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    host.instantiated(A, &fmu);
    host.ok(&["SetupExperiment", A, "0", "1"]);
    host.ok(&["EnterInitializationMode", A]);
    host.ok(&["ExitInitializationMode", A]);
    let everything = fmu.reals();
    let before = host.get_reals(A, &everything);
    for (request, why) in refusals(REFUSED, &fmu) {
        let reason = host.refused(&request);
        assert!(reason.contains(why), "{request:?}: {reason}");
        assert_eq!(host.get_reals(A, &everything), before, "{request:?}");
    }
    // Without events, which a refused list of categories would have switched on.
    let start = host.get_real(A, "0");
    host.ok(&["DoStep", A, "0", "1", "1"]);
    assert_eq!(
        host.get_real(A, &fmu.vr("crank.phi")).to_bits(),
        start.to_bits()
    );
    host.ok(&["Reset", A]);
}

#[test]
fn wrong_settings_before_the_start_are_refused() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    host.instantiated(A, &fmu);
    for (request, why) in refusals(REFUSED_BEFORE, &fmu) {
        let reason = host.refused(&request);
        assert!(reason.contains(why), "{request:?}: {reason}");
    }
    host.initialize(A);
    assert_eq!(host.get_real(A, &fmu.vr("crank_length")).to_string(), "0.1");
    let choices = ["rates", "extrapolation"]
        .map(|name| fmu.vr(name))
        .join(",");
    assert_eq!(
        host.ok(&["GetInteger", A, "2", &choices, "room"]),
        ["1", "1"]
    );
}

#[test]
fn nothing_may_be_asked_for_with_null_pointers() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    host.instantiated(A, &fmu);
    host.initialize(A);
    for kind in ["Real", "Integer", "Boolean", "String"] {
        host.ok(&[&format!("Get{kind}"), A, "0", NULL, NULL]);
        host.ok(&[&format!("Set{kind}"), A, "0", NULL, NULL]);
    }
    host.ok(&["SetRealInputDerivatives", A, "0", NULL, NULL, NULL]);
    host.ok(&["SetDebugLogging", A, "0", "0", NULL]);
}

#[test]
fn what_cannot_be_instantiated_is_null_and_tells_the_logger() {
    let fmu = Fmu::of("four_bar");
    let right = Instantiate::right(&fmu);
    let text = |text: &str| Some(text.to_owned());
    let with_uri = |uri: &str| Instantiate {
        uri: text(uri),
        ..right.clone()
    };
    let with_guid = |guid: &str| Instantiate {
        guid: text(guid),
        ..right.clone()
    };
    let broken = Fmu::of("pendulum");
    std::fs::write(
        broken.resources.join(biela::fmi::RESOURCE),
        "format = 1\nname = ",
    )
    .unwrap();

    let mut host = Host::start();
    let mut reason = |with: &Instantiate| {
        let (made, log) = host.instantiate(A, with);
        assert!(!made);
        let [message] = &log[..] else {
            panic!("{log:?}")
        };
        assert_eq!(message.status, Status::Error);
        assert_eq!(message.category, "logStatusError");
        assert_eq!(message.instance, with.name.clone().unwrap_or_default());
        assert!(message.text.starts_with("fmi2Instantiate: "), "{message:?}");
        message.text.clone()
    };
    for (with, why) in [
        (
            with_guid("{00000000-0000-0000-0000-000000000000}"),
            "do not belong together",
        ),
        // No format of `printf`.
        (with_guid("%s%n%d"), "the GUID `%s%n%d` is not"),
        (with_guid(""), "the GUID `` is not"),
        (
            Instantiate {
                guid: None,
                ..right.clone()
            },
            "`fmuGUID` is a null pointer",
        ),
        (
            Instantiate {
                uri: None,
                ..right.clone()
            },
            "`fmuResourceLocation` is a null pointer",
        ),
        (
            Instantiate {
                name: None,
                ..right.clone()
            },
            "`instanceName` is a null pointer",
        ),
        (
            Instantiate {
                name: text(""),
                ..right.clone()
            },
            "`instanceName` is empty",
        ),
        (
            Instantiate {
                model_exchange: true,
                ..right.clone()
            },
            "for co-simulation only",
        ),
        (with_uri(""), "the resource location is empty"),
        (
            with_uri("https://example.org/resources"),
            "is not a `file:` URI",
        ),
        (with_uri("resources"), "is not a `file:` URI"),
        (
            with_uri("file://server/share/resources"),
            "is on another host, `server`",
        ),
        (
            with_uri(&format!("{}/nowhere", fmu.uri())),
            "cannot read the mechanism",
        ),
        (
            with_uri(&format!("{}%00", fmu.uri())),
            "cannot read the mechanism",
        ),
        (
            Instantiate {
                uri: Some(broken.uri()),
                ..right.clone()
            },
            "2:8",
        ),
    ] {
        let reason = reason(&with);
        assert!(reason.contains(why), "{reason}");
    }

    // Without a logger there is nobody to tell.
    for callbacks in ["none", "no logger"] {
        let wrong = Instantiate {
            callbacks,
            ..with_guid("wrong")
        };
        assert_eq!(host.instantiate(A, &wrong), (false, vec![]));
    }
    let silent = Instantiate {
        callbacks: "no logger",
        ..right
    };
    assert_eq!(host.instantiate(A, &silent), (true, vec![]));
    let answer = host.call(&["Terminate", A]);
    assert_eq!((answer.status, answer.log), (Status::Error, vec![]));
}

#[test]
fn resources_are_found_in_any_usual_spelling() {
    let fmu = Fmu::in_folder("pendulum", "a b#c%20d ü 模");
    let encoded = percent_encoded(fmu.path());
    assert!(encoded.ends_with("a%20b%23c%2520d%20%C3%BC%20%E6%A8%A1"));
    // As some hosts write them: only what would be ambiguous is encoded.
    let sloppy = fmu.path().replace('%', "%25");
    let mut host = Host::start();
    for uri in [
        format!("file://{encoded}"),
        format!("file://{encoded}/"),
        format!("file:{encoded}"),
        format!("file://localhost{encoded}"),
        format!("FILE://{}", encoded.replace("%C3%BC", "%c3%bc")),
        format!("file://{sloppy}"),
        fmu.path().to_owned(),
    ] {
        let with = Instantiate {
            uri: Some(uri.clone()),
            ..Instantiate::right(&fmu)
        };
        assert_eq!(host.instantiate(A, &with), (true, vec![]), "{uri}");
        host.ok(&["FreeInstance", A]);
    }
}

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
    assert_eq!(categories(&host.do_step(A, 0.0, 0.1)), ["logSolver"]);

    // Off altogether, and then some again.
    host.ok(&["SetDebugLogging", A, "0", "0", NULL]);
    assert_eq!(categories(&host.do_step(A, 0.1, 0.1)), [""; 0]);
    host.ok(&["SetDebugLogging", A, "1", "2", "logEvents,logSolver"]);
    assert_eq!(categories(&host.do_step(A, 0.2, 0.1)), ["logSolver"]);
    host.ok(&["SetDebugLogging", A, "0", "1", "logSolver"]);
    assert_eq!(categories(&host.do_step(A, 0.3, 0.1)), [""; 0]);
    // Settings outlast a reset.
    assert_eq!(categories(&host.call(&["Reset", A])), ["logEvents"]);
    host.ok(&["SetDebugLogging", A, "0", "1", "logEvents"]);
    host.ok(&["SetDebugLogging", A, "1", "1", "logAll"]);
    assert_eq!(categories(&host.call(&["Reset", A])), ["logEvents"]);
}

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
        host.set_real(A, "0", 0.4);
        assert_eq!(host.do_step(A, 0.0, 0.1).status, Status::Ok);
        let before = host.get_reals(A, &fmu.outputs());

        host.set_real(A, "0", 0.9);
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
    host.ok(&["SetRealInputDerivatives", A, "1", "0", "1", "1"]);
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
    host.set_real(A, "0", start);
    host.ok(&["SetRealInputDerivatives", A, "2", "0,0", "1,2", "2,-3"]);
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

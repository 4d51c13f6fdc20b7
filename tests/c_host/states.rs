//! Which state allows which call.

use biela::fmi::{Call, State, Status};

use crate::NOT_SERVED;
use crate::driver::{A, Answer, Fmu, Host, NULL};

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

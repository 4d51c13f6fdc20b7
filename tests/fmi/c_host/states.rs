//! Which state allows which call.

use biela::fmi::{Interface, State, Status};

use crate::c_host::driver::{A, Answer, B, Fmu, Host, Instantiate, NULL};

/// The functions of the standard that go to an instance, and whether each is allowed (`x`): for
/// model exchange in the states `instantiated`, `initializationMode`, `eventMode`,
/// `continuousTimeMode`, `terminated` and `error` (FMI 2.0, 3.2.3), for co-simulation in
/// `instantiated`, `initializationMode`, `stepComplete`, `stepFailed`, `terminated` and `error`
/// (4.2.4), without asynchronous steps, which are not declared.
const TABLE: &str = "
SetDebugLogging                 x x x x x x   x x x x x x
SetupExperiment                 x - - - - -   x - - - - -
EnterInitializationMode         x - - - - -   x - - - - -
ExitInitializationMode          - x - - - -   - x - - - -
Terminate                       - - x x - -   - - x x - -
Reset                           x x x x x x   x x x x x x
GetReal                         - x x x x x   - x x x x x
GetInteger                      - x x x x x   - x x x x x
GetBoolean                      - x x x x x   - x x x x x
GetString                       - x x x x x   - x x x x x
SetReal                         x x x x - -   x x x - - -
SetInteger                      x x x - - -   x x x - - -
SetBoolean                      x x x - - -   x x x - - -
SetString                       x x x - - -   x x x - - -
GetFMUstate                     x x x x x x   x x x x x x
SetFMUstate                     x x x x x x   x x x x x x
FreeFMUstate                    x x x x x x   x x x x x x
SerializedFMUstateSize          x x x x x x   x x x x x x
SerializeFMUstate               x x x x x x   x x x x x x
DeSerializeFMUstate             x x x x x x   x x x x x x
GetDirectionalDerivative        - x x x x x   - x x x x x
SetRealInputDerivatives         - - - - - -   x x x - - -
GetRealOutputDerivatives        - - - - - -   - - x x x x
DoStep                          - - - - - -   - - x - - -
CancelStep                      - - - - - -   - - - - - -
GetStatus                       - - - - - -   - - x x x -
GetRealStatus                   - - - - - -   - - x x x -
GetIntegerStatus                - - - - - -   - - x x x -
GetBooleanStatus                - - - - - -   - - x x x -
GetStringStatus                 - - - - - -   - - x x x -
EnterEventMode                  - - x x - -   - - - - - -
NewDiscreteStates               - - x - - -   - - - - - -
EnterContinuousTimeMode         - - x - - -   - - - - - -
CompletedIntegratorStep         - - - x - -   - - - - - -
SetTime                         - - x x - -   - - - - - -
SetContinuousStates             - - - x - -   - - - - - -
GetDerivatives                  - x x x x x   - - - - - -
GetEventIndicators              - x x x x x   - - - - - -
GetContinuousStates             - x x x x x   - - - - - -
GetNominalsOfContinuousStates   x x x x x x   - - - - - -
";

/// The table's columns. A synchronous slave is never in another state; a caught defect leads to
/// `fatal`, and no call is known to lead to a defect.
const COLUMNS: [(Interface, State); 12] = [
    (Interface::ModelExchange, State::Instantiated),
    (Interface::ModelExchange, State::InitializationMode),
    (Interface::ModelExchange, State::EventMode),
    (Interface::ModelExchange, State::ContinuousTimeMode),
    (Interface::ModelExchange, State::Terminated),
    (Interface::ModelExchange, State::Error),
    (Interface::CoSimulation, State::Instantiated),
    (Interface::CoSimulation, State::InitializationMode),
    (Interface::CoSimulation, State::StepComplete),
    (Interface::CoSimulation, State::StepFailed),
    (Interface::CoSimulation, State::Terminated),
    (Interface::CoSimulation, State::Error),
];

/// The table's rows.
pub(crate) fn functions() -> impl Iterator<Item = (&'static str, [bool; 12])> {
    TABLE.lines().filter(|line| !line.is_empty()).map(|line| {
        let mut fields = line.split_whitespace();
        let name = fields.next().expect("a name");
        let allowed: Vec<_> = fields.map(|field| field == "x").collect();
        (name, allowed.try_into().expect("twelve columns"))
    })
}

/// An FMU state of the triangle in the host, and as bytes.
struct Saved {
    slot: &'static str,
    bytes: String,
    size: String,
}

impl Saved {
    /// Saves the state of a new instance in slot B.
    fn new(host: &mut Host, fmu: &Fmu, interface: Interface) -> Self {
        assert!(host.instantiate(B, &for_interface(fmu, interface)).0);
        host.ok(&["GetFMUstate", B, "0"]);
        let size = host
            .ok(&["SerializedFMUstateSize", B, "0", "room"])
            .remove(0);
        let bytes = host
            .ok(&["SerializeFMUstate", B, "0", &size, "room"])
            .remove(0);
        Self {
            slot: "0",
            bytes,
            size,
        }
    }
}

/// Arguments for an instance of an interface.
fn for_interface(fmu: &Fmu, interface: Interface) -> Instantiate {
    Instantiate {
        model_exchange: interface == Interface::ModelExchange,
        ..Instantiate::right(fmu)
    }
}

/// The call with right arguments for the triangle driven by its length, at 0.1 s.
fn request(function: &str, slot: &str, state: State, saved: &Saved) -> Vec<String> {
    // Position input, fixed parameter `rates`, and `arm.x`.
    let (input, rates, output) = ("1", "6", "8");
    let arguments: &[&str] = match function {
        "SetDebugLogging" => &["1", "1", "logEvents"],
        "SetupExperiment" => &["0.5", "2"],
        "GetReal" => &["1", output, "room"],
        "GetInteger" => &["1", rates, "room"],
        "SetReal" => &["1", input, "0.41"],
        // After initialization there is nothing left to be set.
        "SetInteger" if state == State::StepComplete || state == State::EventMode => {
            &["0", NULL, NULL]
        }
        "SetInteger" => &["1", rates, "2"],
        // There are no such variables.
        "GetBoolean" | "GetString" => &["0", "", "room"],
        "SetBoolean" | "SetString" => &["0", "", ""],
        // Into a slot that holds none, or one to be replaced.
        "GetFMUstate" => &["1"],
        "SetFMUstate" => &[saved.slot],
        // There is none in this slot.
        "FreeFMUstate" => &["2"],
        "SerializedFMUstateSize" => &[saved.slot, "room"],
        "SerializeFMUstate" => &[saved.slot, &saved.size, "room"],
        "DeSerializeFMUstate" => &[&saved.bytes, &saved.size, "3"],
        "SetRealInputDerivatives" => &["1", input, "1", "0.1"],
        "GetRealOutputDerivatives" => &["1", output, "1", "room"],
        "GetDirectionalDerivative" => &["1", output, "1", input, "1", "room"],
        "SetTime" => &["0.2"],
        "NewDiscreteStates" => &["room"],
        "CompletedIntegratorStep" => &["room", "room"],
        "SetContinuousStates"
        | "GetDerivatives"
        | "GetEventIndicators"
        | "GetContinuousStates"
        | "GetNominalsOfContinuousStates" => &["0"],
        "DoStep" => &["0.1", "0.1", "1"],
        "GetStatus" => &["0", "room"],
        "GetIntegerStatus" | "GetStringStatus" => &["1", "room"],
        "GetRealStatus" => &["2", "room"],
        "GetBooleanStatus" => &["3", "room"],
        _ => &[],
    };
    let request = [function, slot]
        .into_iter()
        .chain(arguments.iter().copied());
    request.map(str::to_owned).collect()
}

#[test]
fn the_null_instance_is_refused_by_every_function() {
    let fmu = Fmu::of("tlv");
    let mut host = Host::start();
    let saved = Saved::new(&mut host, &fmu, Interface::CoSimulation);
    for (function, _) in functions() {
        let answer = host.call(&request(function, NULL, State::Instantiated, &saved));
        assert_eq!(
            (answer.status, answer.log),
            (Status::Error, vec![]),
            "{function}"
        );
    }
    host.ok(&["FreeInstance", NULL]);
}

/// Brings a new instance of the triangle into a state.
fn bring_to(host: &mut Host, (interface, state): (Interface, State), fmu: &Fmu) {
    assert!(host.instantiate(A, &for_interface(fmu, interface)).0);
    match state {
        State::Instantiated => {}
        State::InitializationMode => {
            host.ok(&["SetupExperiment", A, "0", NULL]);
            host.ok(&["EnterInitializationMode", A]);
        }
        State::Error => {
            host.ok(&["SetupExperiment", A, "0", NULL]);
            host.ok(&["EnterInitializationMode", A]);
            // A side of 0.35 m and a base of 0.4 m do not reach that far.
            host.set_real(A, &fmu.vr("arm_length"), 10.0);
            host.refused(&["ExitInitializationMode", A]);
        }
        _ => {
            host.initialize(A);
            match interface {
                Interface::ModelExchange => integrate_to(host, state),
                Interface::CoSimulation => step_to(host, state),
            }
        }
    }
}

/// From the start of model exchange on, to 0.1 s.
fn integrate_to(host: &mut Host, state: State) {
    host.ok(&["EnterContinuousTimeMode", A]);
    host.ok(&["SetTime", A, "0.1"]);
    host.set_real(A, "1", 0.4);
    let answer = host.ok(&["CompletedIntegratorStep", A, "room", "room"]);
    assert_eq!(answer, ["0", "0"]);
    match state {
        State::ContinuousTimeMode => {}
        State::EventMode => drop(host.ok(&["EnterEventMode", A])),
        State::Terminated => drop(host.ok(&["Terminate", A])),
        _ => unreachable!("the table has no such column"),
    }
}

/// From the start of co-simulation on, to 0.1 s.
fn step_to(host: &mut Host, state: State) {
    host.set_real(A, "1", 0.4);
    assert_eq!(host.do_step(A, 0.0, 0.1).status, Status::Ok);
    match state {
        State::StepComplete => {}
        State::StepFailed => {
            host.set_real(A, "1", 0.9);
            assert_eq!(host.do_step(A, 0.1, 0.1).status, Status::Discard);
        }
        State::Terminated => drop(host.ok(&["Terminate", A])),
        _ => unreachable!("the table has no such column"),
    }
}

/// All that can be found out about the instance, in whatever state it is; frees it.
fn examine(host: &mut Host, fmu: &Fmu) -> Vec<Answer> {
    let reals: Vec<_> = fmu.reals().iter().map(u32::to_string).collect();
    let (n, reals) = (reals.len().to_string(), reals.join(","));
    let look: [&[&str]; 7] = [
        &["GetReal", A, &n, &reals, "room"],
        &["GetInteger", A, "2", "6,7", "room"],
        &["GetRealOutputDerivatives", A, "2", "8,11", "2,1", "room"],
        &[
            "GetDirectionalDerivative",
            A,
            "2",
            "8,11",
            "2",
            "1,2",
            "1,2",
            "room",
        ],
        &["GetStatus", A, "0", "room"],
        &["GetRealStatus", A, "2", "room"],
        &["GetBooleanStatus", A, "3", "room"],
    ];
    let go_on: [&[&str]; 14] = [
        &["DoStep", A, "0.1", "0.1", "1"],
        &["CompletedIntegratorStep", A, "room", "room"],
        &["EnterEventMode", A],
        &["EnterContinuousTimeMode", A],
        &["EnterInitializationMode", A],
        &["ExitInitializationMode", A],
        &["DoStep", A, "0", "0.1", "1"],
        &["EnterContinuousTimeMode", A],
        &["SetTime", A, "0.3"],
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
            answers.push(host.call(look[0]));
        }
    }
    answers
}

#[test]
fn states_of_model_exchange_allow_their_calls_and_refuse_the_others_without_a_trace() {
    check_states_of(Interface::ModelExchange);
}

#[test]
fn states_of_co_simulation_allow_their_calls_and_refuse_the_others_without_a_trace() {
    check_states_of(Interface::CoSimulation);
}

fn check_states_of(interface: Interface) {
    let fmu = Fmu::of("tlv");
    let columns = COLUMNS.into_iter().enumerate();
    for (column, (_, state)) in columns.filter(|(_, (of, _))| *of == interface) {
        let mut host = Host::start();
        let saved = Saved::new(&mut host, &fmu, interface);
        bring_to(&mut host, (interface, state), &fmu);
        let undisturbed = examine(&mut host, &fmu);
        for (function, allowed) in functions() {
            bring_to(&mut host, (interface, state), &fmu);
            let request = request(function, A, state, &saved);
            if allowed[column] {
                let answer = host.call(&request);
                // For the standard defines no status that these two could give.
                let none = ["GetIntegerStatus", "GetStringStatus"].contains(&function);
                let expected = if none { Status::Discard } else { Status::Ok };
                assert_eq!(
                    answer.status, expected,
                    "{function} in {state}, {interface}: {answer:?}"
                );
                host.ok(&["FreeFMUstate", A, "3"]);
                host.ok(&["FreeInstance", A]);
            } else {
                let reason = host.refused(&request);
                let (first, last) = allowed.split_at(6);
                let own = match interface {
                    Interface::ModelExchange => first,
                    Interface::CoSimulation => last,
                };
                let expected = if own.contains(&true) || function == "CancelStep" {
                    format!("not allowed in state {state}")
                } else {
                    format!("not for {interface}")
                };
                let expected = match (function, interface) {
                    ("CancelStep", Interface::ModelExchange) => "not for model exchange",
                    _ => &expected,
                };
                assert!(reason.contains(expected), "{reason}");
                assert!(
                    examine(&mut host, &fmu) == undisturbed,
                    "{function} left a trace in {state}, {interface}"
                );
            }
        }
    }
}

//! Which state allows which call.

use biela::fmi::{State, Status};

use crate::driver::{A, Answer, B, Fmu, Host, NULL};

/// The functions of the standard that go to an instance, and whether each is allowed (`x`) in
/// the states `instantiated`, `initializationMode`, `stepComplete`, `stepFailed`, `terminated`
/// and `error`. After the standard's table for co-simulation (FMI 2.0, 4.2.4), without what is
/// not declared: asynchronous steps, directional derivatives, model exchange.
pub(crate) const TABLE: &str = "
SetDebugLogging                 x x x x x x
SetupExperiment                 x - - - - -
EnterInitializationMode         x - - - - -
ExitInitializationMode          - x - - - -
Terminate                       - - x x - -
Reset                           x x x x x x
GetReal                         - x x x x x
GetInteger                      - x x x x x
GetBoolean                      - x x x x x
GetString                       - x x x x x
SetReal                         x x x - - -
SetInteger                      x x x - - -
SetBoolean                      x x x - - -
SetString                       x x x - - -
GetFMUstate                     x x x x x x
SetFMUstate                     x x x x x x
FreeFMUstate                    x x x x x x
SerializedFMUstateSize          x x x x x x
SerializeFMUstate               x x x x x x
DeSerializeFMUstate             x x x x x x
GetDirectionalDerivative        - - - - - -
SetRealInputDerivatives         x x x - - -
GetRealOutputDerivatives        - - x x x x
DoStep                          - - x - - -
CancelStep                      - - - - - -
GetStatus                       - - x x x -
GetRealStatus                   - - x x x -
GetIntegerStatus                - - x x x -
GetBooleanStatus                - - x x x -
GetStringStatus                 - - x x x -
EnterEventMode                  - - - - - -
NewDiscreteStates               - - - - - -
EnterContinuousTimeMode         - - - - - -
CompletedIntegratorStep         - - - - - -
SetTime                         - - - - - -
SetContinuousStates             - - - - - -
GetDerivatives                  - - - - - -
GetEventIndicators              - - - - - -
GetContinuousStates             - - - - - -
GetNominalsOfContinuousStates   - - - - - -
";

/// The table's columns. A synchronous slave is never in another one; a caught defect leads to
/// `fatal`, and no call is known to lead to a defect.
const STATES: [State; 6] = [
    State::Instantiated,
    State::InitializationMode,
    State::StepComplete,
    State::StepFailed,
    State::Terminated,
    State::Error,
];

/// The table's rows.
pub(crate) fn functions() -> impl Iterator<Item = (&'static str, [bool; 6])> {
    TABLE.lines().filter(|line| !line.is_empty()).map(|line| {
        let mut fields = line.split_whitespace();
        let name = fields.next().expect("a name");
        let allowed: Vec<_> = fields.map(|field| field == "x").collect();
        (name, allowed.try_into().expect("six states"))
    })
}

/// Why a function is refused in every state.
fn never(function: &str) -> &'static str {
    match function {
        "CancelStep" => "allowed in stepInProgress",
        "GetDirectionalDerivative" => "no directional derivatives",
        _ => "for co-simulation only",
    }
}

/// An FMU state of the triangle in the host, and as bytes.
struct Saved {
    slot: &'static str,
    bytes: String,
    size: String,
}

impl Saved {
    /// Saves the state of a new instance in slot B.
    fn new(host: &mut Host, fmu: &Fmu) -> Self {
        host.instantiated(B, fmu);
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

/// The call with right arguments for the triangle driven by its length, at 0.1 s.
fn request(function: &str, slot: &str, state: State, saved: &Saved) -> Vec<String> {
    // Position input, fixed parameter `rates`, and `arm.x`.
    let (input, rates, output) = ("0", "5", "7");
    let arguments: &[&str] = match function {
        "SetDebugLogging" => &["1", "1", "logEvents"],
        "SetupExperiment" => &["0.5", "2"],
        "GetReal" => &["1", output, "room"],
        "GetInteger" => &["1", rates, "room"],
        "SetReal" => &["1", input, "0.41"],
        // After initialization there is nothing left to be set.
        "SetInteger" if state == State::StepComplete => &["0", NULL, NULL],
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
    let saved = Saved::new(&mut host, &fmu);
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
        _ => unreachable!("the table has no such column"),
    }
}

/// All that can be found out about the instance, in whatever state it is; frees it.
fn examine(host: &mut Host, fmu: &Fmu) -> Vec<Answer> {
    let reals: Vec<_> = fmu.reals().iter().map(u32::to_string).collect();
    let (n, reals) = (reals.len().to_string(), reals.join(","));
    let look: [&[&str]; 6] = [
        &["GetReal", A, &n, &reals, "room"],
        &["GetInteger", A, "2", "5,6", "room"],
        &["GetRealOutputDerivatives", A, "2", "7,10", "2,1", "room"],
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
    let saved = Saved::new(&mut host, &fmu);
    for (column, state) in STATES.into_iter().enumerate() {
        bring_to(&mut host, state, &fmu);
        let undisturbed = examine(&mut host, &fmu);
        for (function, allowed) in functions() {
            bring_to(&mut host, state, &fmu);
            let request = request(function, A, state, &saved);
            if allowed[column] {
                let answer = host.call(&request);
                // For the standard defines no status that these two could give.
                let none = ["GetIntegerStatus", "GetStringStatus"].contains(&function);
                let expected = if none { Status::Discard } else { Status::Ok };
                assert_eq!(answer.status, expected, "{function} in {state}: {answer:?}");
                host.ok(&["FreeFMUstate", A, "3"]);
                host.ok(&["FreeInstance", A]);
            } else {
                let reason = host.refused(&request);
                let expected = if allowed.contains(&true) {
                    format!("not allowed in state {state}")
                } else {
                    never(function).to_owned()
                };
                assert!(reason.contains(&expected), "{reason}");
                assert!(
                    examine(&mut host, &fmu) == undisturbed,
                    "{function} left a trace in {state}"
                );
            }
        }
    }
}

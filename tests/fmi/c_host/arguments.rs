//! Arguments that are refused, and those that only look wrong.

use crate::c_host::driver::{A, Fmu, Host, Instantiate, NULL};

/// Calls in state `stepComplete` of the four-bar, at 0 s of 1 s, with the reason to refuse each;
/// `@` precedes a variable that stands for its value reference.
pub(crate) const REFUSED: &str = "
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
SetReal A 1 @crank_angle.position nan -> expected a finite number
SetReal A 1 @crank_angle.velocity inf -> expected a finite number
SetReal A 2 @crank_angle.position,@crank_angle.acceleration 1.3,-inf -> expected a finite number
SetRealInputDerivatives A 1 @crank_angle.position 0 1 -> order 0 are not known; expected 1 or 2
SetRealInputDerivatives A 2 @crank_angle.position,@crank_angle.position 1,3 1,1 -> order 3 are not known
SetRealInputDerivatives A 1 @crank_angle.position 1 nan -> expected a finite number
# Output derivatives.
GetRealOutputDerivatives A 1 9999 1 room -> no variable with value reference 9999
GetRealOutputDerivatives A 1 @crank_angle.position 1 room -> `crank_angle.position` is no output
GetRealOutputDerivatives A 1 @solver.residual 1 room -> only outputs have output derivatives
GetRealOutputDerivatives A 1 @crank.phi 0 room -> cannot be of order 0; expected 1 to 2
GetRealOutputDerivatives A 2 @crank.phi,@crank.phi 1,-2147483648 room -> cannot be of order -2147483648
GetRealOutputDerivatives A 1 @crank.phi 3 room -> cannot be of order 3; expected 1 to 2
# Steps.
DoStep A 0.5 0.1 1 -> is not where the last step ended, 0 s
DoStep A 0 0 1 -> the step size 0 s is not positive
DoStep A 0 -0.1 1 -> the step size -0.1 s is not positive
DoStep A nan 0.1 1 -> `currentCommunicationPoint` is NaN
DoStep A 0 inf 1 -> `communicationStepSize` is inf
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
GetRealOutputDerivatives A 1 NULL 1 room -> `vr` is a null pointer
GetRealOutputDerivatives A 1 @crank.phi NULL room -> `order` is a null pointer
GetRealOutputDerivatives A 1 @crank.phi 1 NULL -> `value` is a null pointer
GetReal A 18446744073709551615 @crank.phi room -> `vr` has an impossible length
GetStatus A 0 NULL -> `value` is a null pointer
GetRealStatus A 2 NULL -> `value` is a null pointer
GetBooleanStatus A 3 NULL -> `value` is a null pointer
GetDirectionalDerivative A 1 NULL 1 @crank_angle.position 1 room -> `vUnknown_ref` is a null pointer
GetDirectionalDerivative A 1 @crank.phi 1 NULL 1 room -> `vKnown_ref` is a null pointer
GetDirectionalDerivative A 1 @crank.phi 1 @crank_angle.position NULL room -> `dvKnown` is a null pointer
GetDirectionalDerivative A 1 @crank.phi 1 @crank_angle.position 1 NULL -> `dvUnknown` is a null pointer
GetDirectionalDerivative A 1 @crank.phi 1 @crank_angle.position nan room -> expected a finite number
GetDirectionalDerivative A 1 @crank.phi 1 9999 1 room -> no variable with value reference 9999
GetDirectionalDerivative A 1 9999 1 @crank_angle.position 1 room -> no variable with value reference 9999
GetDirectionalDerivative A 1 @crank.phi 1 @crank_length 1 room -> `crank_length`: derivatives are taken by inputs
GetDirectionalDerivative A 1 @crank.phi 1 @crank.phi 1 room -> `crank.phi`: derivatives are taken by inputs
GetDirectionalDerivative A 1 @solver.rcond 1 @crank_angle.position 1 room -> `solver.rcond`: derivatives are taken of outputs
GetDirectionalDerivative A 1 @rates 1 @crank_angle.position 1 room -> `rates`: derivatives are taken of outputs
# Model exchange is another interface.
SetTime A 1 -> not for co-simulation
GetDerivatives A 0 -> not for co-simulation
CompletedIntegratorStep A room room -> not for co-simulation
# FMU states; there is none in slot 0.
GetFMUstate A NULL -> `FMUstate` is a null pointer
SetFMUstate A NULL -> `FMUstate` is a null pointer
SetFMUstate A 0 -> `FMUstate` is a null pointer
SerializedFMUstateSize A 0 room -> `FMUstate` is a null pointer
SerializeFMUstate A 0 4 room -> `FMUstate` is a null pointer
DeSerializeFMUstate A NULL 5 0 -> `serializedState` is a null pointer
DeSerializeFMUstate A 00ff 2 NULL -> `FMUstate` is a null pointer
DeSerializeFMUstate A NULL 0 0 -> these 0 bytes are no serialized FMU state
DeSerializeFMUstate A 00ff 2 0 -> these 2 bytes are no serialized FMU state
# Log categories.
SetDebugLogging A 1 1 NULL -> `categories` is a null pointer
SetDebugLogging A 1 2 logEvents,NULL -> `category` is a null pointer
SetDebugLogging A 1 2 logEvents,log\\xff -> `category` is not UTF-8
SetDebugLogging A 1 2 logEvents,logNothing -> no log category `logNothing`; expected logAll
";

/// The same in state `instantiated`.
const REFUSED_BEFORE: &str = "
SetupExperiment A nan NULL -> `startTime` is NaN
SetupExperiment A 0 inf -> `stopTime` is inf
SetupExperiment A 2 1 -> the stop time 1 s is before the start time 2 s
SetReal A 1 @crank_length nan -> expected a finite number
";

/// Values of parameters outside their limits (FMI 2.0, 2.2.3) in state `instantiated`.
const DISCARDED_BEFORE: &str = "
SetInteger A 1 @rates 0 -> expected 1 to 3
SetInteger A 2 @rates,@extrapolation 2,3 -> expected 1 to 2
SetInteger A 1 @rates -2147483648 -> expected 1 to 3
SetReal A 1 @crank_length -1 -> expected at least 0.001
";

/// The same in state `stepComplete`. The value before the wrong one is not set either.
const DISCARDED: &str = "
SetReal A 2 @crank_angle.position,@rocker_length 1.3,0 -> cannot be set to 0: expected at least 0.001
";

/// The same in continuous-time mode of model exchange.
const REFUSED_IN_EXCHANGE: &str = "
SetTime A nan -> `time` is NaN
SetTime A inf -> `time` is inf
CompletedIntegratorStep A NULL room -> `enterEventMode` is a null pointer
CompletedIntegratorStep A room NULL -> `terminateSimulation` is a null pointer
SetContinuousStates A 1 -> there are none
GetDerivatives A 1 -> there are none
GetEventIndicators A 1 -> there are none
GetContinuousStates A 1 -> there are none
GetNominalsOfContinuousStates A 1 -> there are none
SetReal A 1 @rocker_length 0.31 -> `rocker_length` cannot be set: it is a tunable parameter, which changes in event mode
SetReal A 1 @crank_length 0.11 -> `crank_length` cannot be set: it is a fixed parameter
SetReal A 1 @crank.phi 1 -> `crank.phi` cannot be set: it is an output
SetReal A 1 @crank_angle.position nan -> expected a finite number
DoStep A 0 0.1 1 -> not for model exchange
SetRealInputDerivatives A 1 @crank_angle.position 1 1 -> not for model exchange
GetStatus A 0 room -> not for model exchange
NewDiscreteStates A room -> not allowed in state continuousTimeMode
";

/// Each request of a list as the host takes it, and the reason to refuse it.
pub(crate) fn refusals<'a>(
    list: &'a str,
    fmu: &Fmu,
) -> impl Iterator<Item = (Vec<String>, &'a str)> {
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
    for (request, why) in refusals(DISCARDED, &fmu) {
        let reason = host.discarded(&request);
        assert!(reason.contains(why), "{request:?}: {reason}");
        assert_eq!(host.get_reals(A, &everything), before, "{request:?}");
    }
    // Without events, which a refused list of categories would have switched on.
    let start = host.get_real(A, "1");
    host.ok(&["DoStep", A, "0", "1", "1"]);
    assert_eq!(
        host.get_real(A, &fmu.vr("crank.phi")).to_bits(),
        start.to_bits()
    );
    host.ok(&["Reset", A]);
}

#[test]
fn wrong_arguments_in_model_exchange_change_nothing() {
    let fmu = Fmu::of("four_bar");
    let mut host = Host::start();
    let exchange = Instantiate {
        model_exchange: true,
        ..Instantiate::right(&fmu)
    };
    assert!(host.instantiate(A, &exchange).0);
    host.ok(&["SetupExperiment", A, "0", "1"]);
    host.ok(&["EnterInitializationMode", A]);
    host.ok(&["ExitInitializationMode", A]);
    host.refused(&["NewDiscreteStates", A, NULL]);
    host.ok(&["EnterContinuousTimeMode", A]);
    let everything = fmu.reals();
    let before = host.get_reals(A, &everything);
    for (request, why) in refusals(REFUSED_IN_EXCHANGE, &fmu) {
        let reason = host.refused(&request);
        assert!(reason.contains(why), "{request:?}: {reason}");
        assert_eq!(host.get_reals(A, &everything), before, "{request:?}");
    }
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
    for (request, why) in refusals(DISCARDED_BEFORE, &fmu) {
        let reason = host.discarded(&request);
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
    host.ok(&["GetRealOutputDerivatives", A, "0", NULL, NULL, NULL]);
    host.ok(&["SetDebugLogging", A, "0", "0", NULL]);
    // No state, and no place for one.
    host.ok(&["FreeFMUstate", A, "0"]);
    host.ok(&["FreeFMUstate", A, NULL]);
}

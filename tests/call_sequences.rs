//! Any calls in any order: the state table decides, and what is refused leaves no trace.

mod common;

use biela::fmi::{Call, Error, Interface, Kind, State, Status};
use common::{FmuState, Instance, instance_of, shipped};
use proptest::prelude::*;
use proptest::sample::{Index, select};

/// A call with its arguments; an [`Index`] chooses among the variables or the states saved.
#[derive(Clone, Debug)]
enum Request {
    SetupExperiment(f64, Option<f64>),
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
    SetReal(Vec<(Index, f64)>),
    SetInteger(Vec<(Index, i32)>),
    SetRealInputDerivatives(Index, i32, f64),
    /// Whether the communication point is the right one, else which; and the size.
    DoStep(Result<(), f64>, f64),
    GetAll,
    GetFmuState,
    SetFmuState(Index),
    Serialize(Index),
}

/// A number such as hosts set, or one that no host should.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => 0.0..1.0_f64,
        2 => -3.0..3.0_f64,
        1 => select(vec![
            f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, f64::MIN_POSITIVE, 1e100, -1e300,
        ]),
    ]
}

fn request() -> impl Strategy<Value = Request> {
    let reals = prop::collection::vec((any::<Index>(), number()), 0..4);
    let integers = prop::collection::vec((any::<Index>(), -1..5_i32), 0..3);
    prop_oneof![
        1 => (number(), prop::option::of(number())).prop_map(|(a, b)| Request::SetupExperiment(a, b)),
        2 => Just(Request::EnterInitializationMode),
        3 => Just(Request::ExitInitializationMode),
        1 => Just(Request::Terminate),
        1 => Just(Request::Reset),
        6 => reals.prop_map(Request::SetReal),
        2 => integers.prop_map(Request::SetInteger),
        2 => (any::<Index>(), 0..4_i32, number())
            .prop_map(|(variable, order, value)| Request::SetRealInputDerivatives(variable, order, value)),
        8 => (prop_oneof![8 => Just(Ok(())), 1 => number().prop_map(Err)], number())
            .prop_map(|(point, size)| Request::DoStep(point, size)),
        4 => Just(Request::GetAll),
        3 => Just(Request::GetFmuState),
        3 => any::<Index>().prop_map(Request::SetFmuState),
        2 => any::<Index>().prop_map(Request::Serialize),
    ]
}

/// All of a state, for comparisons: what is not a number would differ from itself.
fn text(state: &Result<FmuState, Error>) -> String {
    format!("{state:?}")
}

/// Makes the call; gives its place in the state table with its outcome.
fn make(
    instance: &mut Instance,
    saved: &mut Vec<FmuState>,
    time: f64,
    request: &Request,
) -> (Call, Result<(), Error>) {
    let count = instance.variables().len();
    // One more than there are.
    let reference = |index: &Index| index.index(count + 1) as u32;
    match request {
        Request::SetupExperiment(start, stop) => (
            Call::SetupExperiment,
            instance.setup_experiment(*start, *stop),
        ),
        Request::EnterInitializationMode => (
            Call::EnterInitializationMode,
            instance.enter_initialization_mode(),
        ),
        Request::ExitInitializationMode => (
            Call::ExitInitializationMode,
            instance.exit_initialization_mode(),
        ),
        Request::Terminate => (Call::Terminate, instance.terminate()),
        Request::Reset => (Call::Reset, instance.reset()),
        Request::SetReal(pairs) => {
            let (references, values): (Vec<u32>, Vec<f64>) = pairs
                .iter()
                .map(|(v, value)| (reference(v), *value))
                .unzip();
            (Call::SetReal, instance.set_real(&references, &values))
        }
        Request::SetInteger(pairs) => {
            let (references, values): (Vec<u32>, Vec<i32>) = pairs
                .iter()
                .map(|(v, value)| (reference(v), *value))
                .unzip();
            (Call::SetInteger, instance.set_integer(&references, &values))
        }
        Request::SetRealInputDerivatives(variable, order, value) => (
            Call::SetRealInputDerivatives,
            instance.set_real_input_derivatives(&[reference(variable)], &[*order], &[*value]),
        ),
        Request::DoStep(point, size) => (
            Call::DoStep,
            instance.do_step(point.err().unwrap_or(time), *size),
        ),
        Request::GetAll => {
            let reals: Vec<u32> = (0..)
                .zip(instance.variables())
                .filter(|(_, variable)| matches!(variable.kind, Kind::Real { .. }))
                .map(|(reference, _)| reference)
                .collect();
            (
                Call::GetReal,
                instance.reals(&reals).map(|values| {
                    let values: Vec<f64> = values.collect();
                    assert!(values.iter().all(|value| value.is_finite()), "{values:?}");
                }),
            )
        }
        Request::GetFmuState => (
            Call::GetFMUstate,
            instance.fmu_state().map(|state| saved.push(state)),
        ),
        Request::SetFmuState(index) => {
            let state = &saved[index.index(saved.len())];
            let outcome = instance.set_fmu_state(state);
            assert_eq!(outcome, Ok(()), "no call leads to a defect");
            assert_eq!(text(&instance.fmu_state()), text(&Ok(state.clone())));
            (Call::SetFMUstate, outcome)
        }
        Request::Serialize(index) => {
            let state = &saved[index.index(saved.len())];
            let read = instance
                .serialize_fmu_state(state)
                .and_then(|bytes| instance.deserialize_fmu_state(&bytes));
            let outcome = read.map(|read| {
                assert_eq!(text(&Ok(read)), text(&Ok(state.clone())));
            });
            (Call::DeSerializeFMUstate, outcome)
        }
    }
}

proptest! {
    #[test]
    fn any_calls_in_any_order(
        name in select(vec!["tlv", "four_bar", "five_bar_robot"]),
        initialized in any::<bool>(),
        requests in prop::collection::vec(request(), 1..40),
    ) {
        let mut instance = instance_of(shipped(name), Interface::CoSimulation);
        if initialized {
            instance.enter_initialization_mode().unwrap();
            instance.exit_initialization_mode().unwrap();
        }
        let mut saved = vec![instance.fmu_state().expect("allowed")];
        for request in &requests {
            let state = instance.state();
            let before = instance.fmu_state();
            let time = instance.last_successful_time();
            let (call, outcome) = make(&mut instance, &mut saved, time, request);
            let allowed = call.allowed_in(Interface::CoSimulation).contains(&state);
            prop_assert_eq!(!allowed, matches!(outcome, Err(Error::State { .. })), "{:?}", request);
            let Err(error) = outcome else { continue };
            match (call, error.status()) {
                (Call::DoStep, Status::Discard) => {
                    prop_assert_eq!(instance.state(), State::StepFailed);
                }
                (Call::ExitInitializationMode, _) if allowed => {
                    prop_assert_eq!(instance.state(), State::Error);
                }
                // Finding no pose takes the rates of the drivers along, which nobody can see.
                (Call::GetReal, _) => prop_assert_eq!(instance.state(), state),
                (_, status) => {
                    prop_assert_eq!(status, Status::Error);
                    prop_assert_eq!(text(&instance.fmu_state()), text(&before), "{:?}", request);
                }
            }
        }
    }
}

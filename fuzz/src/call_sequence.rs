//! Any calls in any order: the state table decides, and what is refused leaves no trace.

use arbitrary::{Arbitrary, Unstructured};
use biela::fmi::{Call, Error, Failure, Interface, State, Status, Version};

use crate::{FmuState, Instance, instance, reals, shipped};

/// Calls that follow one another at the most.
const MOST_CALLS: usize = 60;

/// A call with its arguments. Which variable or saved state is meant, an index says, counted
/// round; one beyond the last variable is unknown.
#[derive(Arbitrary, Clone, Debug)]
enum Request {
    SetupExperiment(Value, Option<Value>),
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
    SetReal(Vec<(u8, Value)>),
    SetInteger(Vec<(u8, i8)>),
    SetRealInputDerivatives(u8, i8, Value),
    /// Whether the communication point is the right one, else which; and the size.
    DoStep(Option<Value>, Value),
    EnterEventMode,
    NewDiscreteStates,
    EnterContinuousTimeMode,
    CompletedIntegratorStep,
    SetTime(Value),
    GetContinuousStates(u8),
    GetAll,
    GetRealOutputDerivatives(u8, i8),
    GetDirectionalDerivative(Vec<u8>, Vec<(u8, Value)>),
    GetFmuState,
    SetFmuState(u8),
    Serialize(u8),
}

/// A number such as hosts set, or one that no host should.
#[derive(Arbitrary, Clone, Copy, Debug)]
enum Value {
    Usual(u16),
    Signed(i16),
    Any(f64),
    Special(u8),
}

impl Value {
    fn get(self) -> f64 {
        match self {
            Self::Usual(value) => f64::from(value) / f64::from(u16::MAX),
            Self::Signed(value) => f64::from(value) / 1e4,
            Self::Any(value) => value,
            Self::Special(index) => {
                const SPECIAL: [f64; 8] = [
                    f64::NAN,
                    f64::INFINITY,
                    f64::NEG_INFINITY,
                    0.0,
                    -0.0,
                    f64::MIN_POSITIVE,
                    1e100,
                    -1e300,
                ];
                SPECIAL[usize::from(index) % SPECIAL.len()]
            }
        }
    }
}

/// Makes the calls that `data` says.
///
/// # Panics
///
/// A fault of biela.
pub fn run(data: &[u8]) {
    // Data that end give the first of all choices.
    let _ = attempt(&mut Unstructured::new(data));
}

fn attempt(data: &mut Unstructured<'_>) -> arbitrary::Result<()> {
    let mechanism = shipped(data.arbitrary()?);
    let interface = *data.choose(&Interface::ALL)?;
    let mut instance = instance(&mechanism, interface).expect("it is shipped");
    let mut saved = vec![instance.fmu_state().expect("allowed")];
    for _ in 0..MOST_CALLS {
        if data.is_empty() {
            break;
        }
        let request = Request::arbitrary(data)?;
        check(&mut instance, &mut saved, &request);
    }
    Ok(())
}

/// Makes a call, and compares with the state table.
fn check(instance: &mut Instance, saved: &mut Vec<FmuState>, request: &Request) {
    let (state, interface) = (instance.state(), instance.interface());
    let before = instance.fmu_state();
    let (call, outcome) = make(instance, saved, request);
    let allowed = call.is_allowed_in(Version::Fmi2, interface, state);
    let refused = matches!(outcome, Err(Error::State { .. } | Error::Interface { .. }));
    assert_eq!(!allowed, refused, "{request:?} in {state}: {outcome:?}");
    let Err(error) = outcome else { return };
    match (call, &error) {
        (Call::DoStep, Error::Model(Failure::Discarded(_))) => {
            assert_eq!(instance.state(), State::StepFailed);
        }
        (Call::ExitInitializationMode, _) if allowed => {
            assert_eq!(instance.state(), State::Error);
        }
        // Finding no pose takes the rates of the drivers along, which nobody can see.
        (_, Error::Model(_)) => assert_eq!(instance.state(), state),
        _ => {
            let discarded = matches!(error, Error::Range { .. } | Error::Item { .. });
            let status = if discarded {
                Status::Discard
            } else {
                Status::Error
            };
            assert_eq!(error.status(), status, "{request:?}: {error}");
            assert_eq!(text(&instance.fmu_state()), text(&before), "{request:?}");
        }
    }
}

/// All of a state, for comparisons: what is not a number would differ from itself.
fn text(state: &Result<FmuState, Error>) -> String {
    format!("{state:?}")
}

/// Makes the call; gives its place in the state table with its outcome.
fn make(
    instance: &mut Instance,
    saved: &mut Vec<FmuState>,
    request: &Request,
) -> (Call, Result<(), Error>) {
    let count = instance.variables().len();
    let reference = |index: u8| (usize::from(index) % (count + 1)) as u32;
    let chosen = |saved: &[FmuState], index: u8| saved[usize::from(index) % saved.len()].clone();
    match request {
        Request::SetupExperiment(start, stop) => (
            Call::SetupExperiment,
            instance.setup_experiment(start.get(), stop.map(Value::get)),
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
            let (references, values): (Vec<_>, Vec<_>) = pairs
                .iter()
                .map(|(v, value)| (reference(*v), value.get()))
                .unzip();
            (Call::SetReal, instance.set_real(&references, &values))
        }
        Request::SetInteger(pairs) => {
            let (references, values): (Vec<_>, Vec<_>) = pairs
                .iter()
                .map(|(v, value)| (reference(*v), i32::from(*value)))
                .unzip();
            (Call::SetInteger, instance.set_integer(&references, &values))
        }
        Request::SetRealInputDerivatives(variable, order, value) => (
            Call::SetRealInputDerivatives,
            instance.set_real_input_derivatives(
                &[reference(*variable)],
                &[i32::from(*order)],
                &[value.get()],
            ),
        ),
        Request::DoStep(point, size) => {
            let point = point.map_or(instance.last_successful_time(), Value::get);
            (Call::DoStep, instance.do_step(point, size.get()))
        }
        Request::EnterEventMode => (Call::EnterEventMode, instance.enter_event_mode()),
        Request::NewDiscreteStates => (
            Call::NewDiscreteStates,
            instance.new_discrete_states().map(drop),
        ),
        Request::EnterContinuousTimeMode => (
            Call::EnterContinuousTimeMode,
            instance.enter_continuous_time_mode(),
        ),
        Request::CompletedIntegratorStep => (
            Call::CompletedIntegratorStep,
            instance.completed_integrator_step().map(drop),
        ),
        Request::SetTime(time) => (Call::SetTime, instance.set_time(time.get())),
        Request::GetContinuousStates(count) => (
            Call::GetContinuousStates,
            instance.continuous(Call::GetContinuousStates, usize::from(*count)),
        ),
        Request::GetAll => {
            let reals = reals(instance);
            let read = instance.reals(&reals);
            (
                Call::GetReal,
                read.map(|values| assert_finite(&values.collect::<Vec<_>>())),
            )
        }
        Request::GetRealOutputDerivatives(variable, order) => {
            let (variable, order) = ([reference(*variable)], [i32::from(*order)]);
            let read = instance.output_derivatives(&variable, &order);
            (
                Call::GetRealOutputDerivatives,
                read.map(|values| assert_finite(&values.collect::<Vec<_>>())),
            )
        }
        Request::GetDirectionalDerivative(unknowns, knowns) => {
            let unknowns: Vec<_> = unknowns.iter().map(|&v| reference(v)).collect();
            let (knowns, changes): (Vec<_>, Vec<_>) = knowns
                .iter()
                .map(|(v, change)| (reference(*v), change.get()))
                .unzip();
            (
                Call::GetDirectionalDerivative,
                instance
                    .directional_derivative(&unknowns, &knowns, &changes)
                    .map(drop),
            )
        }
        Request::GetFmuState => (
            Call::GetFMUstate,
            instance.fmu_state().map(|state| saved.push(state)),
        ),
        Request::SetFmuState(index) => {
            let state = chosen(saved, *index);
            let outcome = instance.set_fmu_state(&state);
            assert_eq!(outcome, Ok(()), "no call leads to a defect");
            assert_eq!(text(&instance.fmu_state()), text(&Ok(state)));
            (Call::SetFMUstate, outcome)
        }
        Request::Serialize(index) => {
            let state = chosen(saved, *index);
            let read = instance
                .serialize_fmu_state(&state)
                .and_then(|bytes| instance.deserialize_fmu_state(&bytes));
            let outcome = read.map(|read| assert_eq!(text(&Ok(read)), text(&Ok(state))));
            (Call::DeSerializeFMUstate, outcome)
        }
    }
}

fn assert_finite(values: &[f64]) {
    assert!(values.iter().all(|value| value.is_finite()), "{values:?}");
}

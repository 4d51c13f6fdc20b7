//! Any calls in any order: the state table decides, and what is refused leaves no trace.

use arbitrary::{Arbitrary, Unstructured};
use biela::fmi::{
    Call, Causality, CoSimulation, Error, Failure, Interface, State, Status, StepProgress, Version,
};

use crate::{FmuState, Instance, instance, reals, shipped};

/// Calls that follow one another at the most.
const MOST_CALLS: usize = 60;

/// A call of either version with its arguments. Which variable or saved state is meant, an index
/// says, counted round; one beyond the last variable is unknown.
#[derive(Arbitrary, Clone, Debug)]
enum Request {
    SetupExperiment(Value, Option<Value>),
    /// Start and stop time, of which FMI 3.0 is told here.
    EnterInitializationMode(Value, Option<Value>),
    ExitInitializationMode,
    Terminate,
    Reset,
    SetReal(Vec<(u8, Value)>),
    SetInteger(Vec<(u8, i8)>),
    SetRealInputDerivatives(u8, i8, Value),
    /// Whether the communication point is the right one, else which; and the size.
    DoStep(Option<Value>, Value),
    /// The way on from intermediate update, and an early return.
    ResumeStep(Option<Value>),
    EnterStepMode,
    EvaluateDiscreteStates,
    EnterEventMode,
    NewDiscreteStates,
    EnterContinuousTimeMode,
    CompletedIntegratorStep,
    SetTime(Value),
    GetContinuousStates(u8),
    SetContinuousStates(Vec<Value>),
    GetDerivatives(u8),
    GetNominals(u8),
    GetAll,
    GetSome(Vec<u8>),
    GetRealOutputDerivatives(u8, i8),
    GetDirectionalDerivative(Vec<u8>, Vec<(u8, Value)>),
    GetAdjointDerivative(Vec<(u8, Value)>, Vec<u8>),
    GetDependencies(u8),
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
    let mut interface = *data.choose(&Interface::ALL)?;
    if mechanism.has_freedoms() {
        // A long step of co-simulation would integrate for a long time.
        interface = Interface::ModelExchange;
    }
    let version = *data.choose(&Version::ALL)?;
    let mut instance = instance(&mechanism, version, interface).expect("it is shipped");
    if version == Version::Fmi3 && interface == Interface::CoSimulation {
        let agreements = agreements(&instance, data)?;
        instance.agree(agreements).expect("they cross");
    }
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

/// Chooses what an FMI 3.0 host and the instance agree on.
fn agreements(instance: &Instance, data: &mut Unstructured<'_>) -> arbitrary::Result<CoSimulation> {
    let crossing: Vec<u32> = (1..)
        .zip(instance.variables())
        .filter(|(_, variable)| {
            let crosses = matches!(variable.causality, Causality::Input | Causality::Output);
            crosses && variable.kind.is_real()
        })
        .map(|(reference, _)| reference)
        .collect();
    let mut required_intermediate_variables = Vec::new();
    for _ in 0..data.int_in_range(0..=4)? {
        required_intermediate_variables.push(*data.choose(&crossing)?);
    }
    Ok(CoSimulation {
        event_mode_used: data.arbitrary()?,
        early_return_allowed: data.arbitrary()?,
        intermediate_update: data.arbitrary()?,
        required_intermediate_variables,
    })
}

/// Makes a call, and compares with the state table.
fn check(instance: &mut Instance, saved: &mut Vec<FmuState>, request: &Request) {
    let (state, interface, version) = (instance.state(), instance.interface(), instance.version());
    let before = instance.fmu_state();
    let Some((call, outcome)) = make(instance, saved, request) else {
        return;
    };
    let resumes = matches!(request, Request::ResumeStep(_));
    let allowed = resumes || call.is_allowed_in(version, interface, state);
    let refused = match outcome {
        Err(Error::State { .. } | Error::Interface { .. }) => true,
        // The table allows event mode also where the host has not agreed on it.
        Err(Error::NotProvided { .. }) => !(allowed && call == Call::EnterEventMode),
        _ => false,
    };
    assert_eq!(!allowed, refused, "{request:?} in {state}: {outcome:?}");
    let Err(error) = outcome else { return };
    match (call, &error) {
        // The instance is as it was before the step.
        (Call::DoStep, _) if version == Version::Fmi3 && allowed => {
            assert_eq!(instance.state(), State::StepMode, "{request:?}: {error}");
            if state == State::StepMode {
                assert_eq!(text(&instance.fmu_state()), text(&before), "{request:?}");
            }
        }
        (Call::DoStep, Error::Model(Failure::Discarded(_))) => {
            assert_eq!(instance.state(), State::StepFailed);
        }
        (Call::ExitInitializationMode, _) if allowed && version == Version::Fmi2 => {
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
    let status = instance.report(&format!("{call:?}"), &error);
    if version == Version::Fmi3 && status == Status::Error {
        assert_eq!(instance.state(), State::Terminated, "{request:?}: {error}");
    }
}

/// All of a state, for comparisons: what is not a number would differ from itself.
fn text(state: &Result<FmuState, Error>) -> String {
    format!("{state:?}")
}

/// Makes the call; gives its place in the state table with its outcome. Nothing if there is no step
/// to resume.
fn make(
    instance: &mut Instance,
    saved: &mut Vec<FmuState>,
    request: &Request,
) -> Option<(Call, Result<(), Error>)> {
    let is_fmi3 = instance.version() == Version::Fmi3;
    let count = instance.variables().len();
    let reference = |index: u8| (usize::from(index) % (count + 2)) as u32;
    let chosen = |saved: &[FmuState], index: u8| saved[usize::from(index) % saved.len()].clone();
    let made = match request {
        Request::SetupExperiment(start, stop) => (
            Call::SetupExperiment,
            instance.setup_experiment(start.get(), stop.map(Value::get)),
        ),
        Request::EnterInitializationMode(start, stop) => (
            Call::EnterInitializationMode,
            if is_fmi3 {
                instance.enter_initialization_mode_at(start.get(), stop.map(Value::get))
            } else {
                instance.enter_initialization_mode()
            },
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
            let stepped = if is_fmi3 {
                instance.begin_step(point, size.get()).map(check_progress)
            } else {
                instance.do_step(point, size.get())
            };
            (Call::DoStep, stepped)
        }
        Request::ResumeStep(early_return) => {
            if instance.state() != State::IntermediateUpdateMode {
                return None;
            }
            let resumed = instance.resume_step(early_return.map(Value::get));
            (Call::DoStep, resumed.map(check_progress))
        }
        Request::EnterStepMode => (Call::EnterStepMode, instance.enter_step_mode()),
        Request::EvaluateDiscreteStates => (
            Call::EvaluateDiscreteStates,
            instance.allow(Call::EvaluateDiscreteStates),
        ),
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
            instance
                .continuous_states(usize::from(*count))
                .map(|states| states.for_each(drop)),
        ),
        Request::SetContinuousStates(values) => {
            let values: Vec<f64> = values.iter().map(|value| value.get()).collect();
            (
                Call::SetContinuousStates,
                instance.set_continuous_states(&values),
            )
        }
        Request::GetDerivatives(count) => (
            Call::GetDerivatives,
            instance
                .derivatives_of_states(usize::from(*count))
                .map(|rates| assert_finite(&rates.collect::<Vec<_>>())),
        ),
        Request::GetNominals(count) => (
            Call::GetNominalsOfContinuousStates,
            instance
                .nominals(usize::from(*count))
                .map(|nominals| assert_finite(&nominals.collect::<Vec<_>>())),
        ),
        Request::GetAll => {
            let reals = reals(instance);
            let read = instance.reals(&reals);
            (
                Call::GetReal,
                read.map(|values| assert_finite(&values.collect::<Vec<_>>())),
            )
        }
        Request::GetSome(variables) => {
            let variables: Vec<_> = variables.iter().map(|&v| reference(v)).collect();
            let read = instance.reals(&variables);
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
        Request::GetAdjointDerivative(unknowns, knowns) => {
            let knowns: Vec<_> = knowns.iter().map(|&v| reference(v)).collect();
            let (unknowns, weights): (Vec<_>, Vec<_>) = unknowns
                .iter()
                .map(|(v, weight)| (reference(*v), weight.get()))
                .unzip();
            (
                Call::GetAdjointDerivative,
                instance
                    .adjoint_derivative(&unknowns, &knowns, &weights)
                    .map(drop),
            )
        }
        Request::GetDependencies(variable) => {
            let call = Call::GetVariableDependencies;
            (
                call,
                instance.dependencies(call, reference(*variable)).map(drop),
            )
        }
        Request::GetFmuState => (
            Call::GetFMUstate,
            instance.fmu_state().map(|state| saved.push(state)),
        ),
        Request::SetFmuState(index) => {
            let state = chosen(saved, *index);
            let outcome = instance.set_fmu_state(&state);
            if instance.state() != State::IntermediateUpdateMode {
                assert_eq!(outcome, Ok(()), "no call leads to a defect");
                assert_eq!(text(&instance.fmu_state()), text(&Ok(state)));
            }
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
    };
    Some(made)
}

/// Checks what a step tells of itself.
fn check_progress(progress: StepProgress) {
    if let StepProgress::Done(outcome) = progress {
        assert!(outcome.last_successful_time.is_finite(), "{outcome:?}");
        let needs = outcome.event_handling_needed || outcome.terminate_simulation;
        assert!(outcome.early_return || !needs, "{outcome:?}");
    }
}

fn assert_finite(values: &[f64]) {
    assert!(values.iter().all(|value| value.is_finite()), "{values:?}");
}

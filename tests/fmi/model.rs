//! A model that is no mechanism: what the layer round a model does by itself.

use std::io::Cursor;

use biela::fmi::{
    Capabilities, Category, Causality, Codec, DependencyKind, Error, Experiment, Failure, Groups,
    Instance, Interface, Kind, Logger, Model, ModelDescription, Phase, Sink, State, StateError,
    Status, Unknown, Unreadable, Variability, Variable, Version, write_archive,
};

/// y′ = gain · u, with u held; y may not leave its range.
struct Integrator {
    interface: Interface,
    variables: Vec<Variable<Quantity>>,
    /// By value reference.
    reals: [f64; 4],
    state: Integrated,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Quantity {
    U,
    Gain,
    Y,
    Slope,
}

#[derive(Clone, Debug, PartialEq)]
struct Integrated {
    time: f64,
    u: f64,
    gain: f64,
    /// Place and time of the last commit.
    from: [f64; 2],
}

const GUID: &str = "an integrator";
/// y stays below.
const LIMIT: f64 = 10.0;

impl Integrator {
    fn new(interface: Interface) -> Self {
        let variable = |name: &str, quantity, causality, variability, kind| Variable {
            name: name.to_owned(),
            description: String::new(),
            quantity,
            causality,
            variability,
            kind,
            derivative_of: None,
        };
        let continuous = Variability::Continuous;
        let gain = Kind::Real {
            unit: None,
            start: Some(1.0),
            min: Some(0.0),
            max: None,
            nominal: None,
        };
        Self {
            interface,
            variables: vec![
                variable(
                    "u",
                    Quantity::U,
                    Causality::Input,
                    continuous,
                    Kind::real(None, Some(0.0)),
                ),
                variable(
                    "gain",
                    Quantity::Gain,
                    Causality::Parameter,
                    Variability::Fixed,
                    gain,
                ),
                variable(
                    "y",
                    Quantity::Y,
                    Causality::Output,
                    continuous,
                    Kind::real(None, None),
                ),
                Variable {
                    derivative_of: Some(2),
                    ..variable(
                        "slope",
                        Quantity::Slope,
                        Causality::Output,
                        continuous,
                        Kind::real(None, None),
                    )
                },
            ],
            reals: [0.0; 4],
            state: Integrated::START,
        }
    }

    fn y(&self) -> f64 {
        let [y, time] = self.state.from;
        y + self.slope() * (self.state.time - time)
    }

    fn slope(&self) -> f64 {
        self.state.gain * self.state.u
    }
}

impl Integrated {
    const START: Self = Self {
        time: 0.0,
        u: 0.0,
        gain: 1.0,
        from: [0.0; 2],
    };
}

impl Model for Integrator {
    type Quantity = Quantity;
    type State = Integrated;

    const CAPABILITIES: Capabilities = Capabilities {
        interpolates_inputs: false,
        output_derivatives: 1,
        directional_derivatives: false,
        intermediate_update: false,
    };

    fn load(_: &std::path::Path, interface: Interface) -> Result<Self, Failure> {
        Ok(Self::new(interface))
    }

    fn guid(&self) -> &str {
        GUID
    }

    fn interface(&self) -> Interface {
        self.interface
    }

    fn variables(&self) -> &[Variable<Quantity>] {
        &self.variables
    }

    fn time(&self) -> f64 {
        self.state.time
    }

    fn set_time(&mut self, time: f64) {
        self.state.time = time;
    }

    fn reset(&mut self) {
        self.state = Integrated::START;
    }

    fn set_reals(&mut self, values: impl Iterator<Item = (Quantity, f64)>) {
        for (quantity, value) in values {
            match quantity {
                Quantity::U => self.state.u = value,
                _ => self.state.gain = value,
            }
        }
    }

    fn groups(&self, quantity: Quantity) -> Groups {
        Groups::from(quantity == Quantity::Y) | 2
    }

    fn refresh(&mut self, groups: Groups, _: Phase, _: &Logger) -> Result<(), Failure> {
        if groups & 1 != 0 && self.y() > LIMIT {
            return Err(full());
        }
        self.reals = [self.state.u, self.state.gain, self.y(), self.slope()];
        Ok(())
    }

    fn reals(&self) -> &[f64] {
        &self.reals
    }

    fn commit(&mut self, phase: Phase, log: &Logger) -> Result<(), Failure> {
        if phase == Phase::Initialization {
            self.state.from = [0.0, self.state.time];
        }
        self.refresh(1, phase, log)?;
        self.state.from = [self.y(), self.state.time];
        Ok(())
    }

    fn step(&mut self, size: f64, end: f64, _: bool, _: &Logger) -> Result<(), Failure> {
        let [y, time] = self.state.from;
        let reached = y + self.slope() * size;
        if reached > LIMIT {
            self.state.time = time + (LIMIT - y) / self.slope();
            self.state.from = [LIMIT, self.state.time];
            return Err(full());
        }
        self.state.time = end;
        self.state.from = [reached, end];
        Ok(())
    }

    fn save(&mut self) -> Integrated {
        self.state.clone()
    }

    fn restore(&mut self, state: &Integrated) {
        self.state = state.clone();
    }

    fn visit(state: &mut Integrated, codec: &mut impl Codec) -> Result<(), Unreadable> {
        let Integrated {
            time,
            u,
            gain,
            from: [y, since],
        } = state;
        let mut numbers = [time, u, gain, y, since].into_iter();
        numbers.try_for_each(|number| codec.finite(number))
    }

    fn check(&mut self, state: &mut Integrated) -> Result<(), String> {
        if state.from[0] <= LIMIT {
            Ok(())
        } else {
            Err("it is beyond its limit".to_owned())
        }
    }
}

fn full() -> Failure {
    Failure::Discarded("full".to_owned())
}

/// Collects what is logged.
#[derive(Clone, Default)]
struct Log(std::sync::Arc<std::sync::Mutex<Vec<(Status, String)>>>);

impl Sink for Log {
    fn write(&self, status: Status, _: Category, message: &str) {
        let mut messages = self.0.lock().expect("no test panics here");
        messages.push((status, message.to_owned()));
    }
}

fn running(interface: Interface) -> (Instance<Integrator>, Log) {
    let log = Log::default();
    let mut instance = Instance::new(Integrator::new(interface), Box::new(log.clone()), false);
    let ready = instance
        .setup_experiment(1.0, Some(100.0))
        .and_then(|()| instance.set_real(&[2], &[2.0]))
        .and_then(|()| instance.enter_initialization_mode())
        .and_then(|()| instance.exit_initialization_mode());
    ready.expect("legal");
    (instance, log)
}

fn y(instance: &mut Instance<Integrator>) -> Result<f64, Error> {
    let mut value = [0.0];
    instance.get_real(&[3], &mut value).map(|()| value[0])
}

#[test]
fn it_steps_until_it_is_full() {
    let (mut instance, log) = running(Interface::CoSimulation);
    instance.set_real(&[1], &[1.5]).unwrap();
    instance.do_step(1.0, 2.0).unwrap();
    assert_eq!(y(&mut instance), Ok(6.0));
    let slope: Vec<_> = instance.output_derivatives(&[3], &[1]).unwrap().collect();
    assert_eq!(slope, [3.0]);
    let none = instance.output_derivatives(&[3], &[2]).map(|_| ());
    assert_eq!(none.unwrap_err().status(), Status::Error);
    // The state machine and the checks of arguments are the layer's.
    assert!(matches!(
        instance.set_real(&[2], &[3.0]),
        Err(Error::NotSettable { .. })
    ));
    assert!(matches!(
        instance.do_step(2.0, 1.0),
        Err(Error::Time { .. })
    ));
    let before = instance.fmu_state().unwrap();
    let error = instance.do_step(3.0, 2.0).unwrap_err();
    assert_eq!(instance.report("fmi2DoStep", &error), Status::Discard);
    assert_eq!(instance.state(), State::StepFailed);
    let reached = 3.0 + 4.0 / 3.0;
    assert!((instance.last_successful_time() - reached).abs() < 1e-15);
    // The host can go back to the state it has got, and step to where it was full.
    assert!(!instance.is_terminated());
    assert_eq!(
        *log.0.lock().unwrap(),
        [(Status::Warning, "full".to_owned())]
    );
    // Back, and on.
    instance.set_fmu_state(&before).unwrap();
    instance.set_real(&[1], &[-1.0]).unwrap();
    instance.do_step(3.0, 1.0).unwrap();
    assert_eq!(y(&mut instance), Ok(4.0));
    instance.reset().unwrap();
    assert_eq!(instance.state(), State::Instantiated);
}

#[test]
fn it_is_asked_at_any_time_in_model_exchange() {
    let (mut instance, _) = running(Interface::ModelExchange);
    assert_eq!(instance.state(), State::EventMode);
    instance.new_discrete_states().unwrap();
    instance.enter_continuous_time_mode().unwrap();
    instance.set_real(&[1], &[1.0]).unwrap();
    for (time, expected) in [(3.0, 4.0), (2.0, 2.0), (6.0, 10.0)] {
        instance.set_time(time).unwrap();
        assert_eq!(y(&mut instance), Ok(expected), "at {time}");
    }
    instance.set_time(7.0).unwrap();
    assert_eq!(y(&mut instance).unwrap_err().status(), Status::Discard);
    // Nothing was committed, so that it is possible to go on otherwise.
    instance.set_time(2.0).unwrap();
    instance.completed_integrator_step().unwrap();
    instance.set_real(&[1], &[0.0]).unwrap();
    instance.set_time(7.0).unwrap();
    assert_eq!(y(&mut instance), Ok(2.0));
    assert!(matches!(
        instance.do_step(7.0, 1.0),
        Err(Error::Interface { .. })
    ));
}

#[test]
fn its_state_survives_bytes_and_belongs_to_its_interface() {
    let (mut instance, _) = running(Interface::CoSimulation);
    instance.set_real(&[1], &[0.1]).unwrap();
    instance.do_step(1.0, 0.3).unwrap();
    let state = instance.fmu_state().unwrap();
    let bytes = instance.serialize_fmu_state(&state).unwrap();
    assert_eq!(instance.serialized_fmu_state_size(&state), Ok(bytes.len()));
    let (mut other, _) = running(Interface::CoSimulation);
    assert_eq!(other.deserialize_fmu_state(&bytes).as_ref(), Ok(&state));
    other.set_fmu_state(&state).unwrap();
    assert_eq!(y(&mut other), y(&mut instance));

    let (mut exchanged, _) = running(Interface::ModelExchange);
    let refused = [
        exchanged.deserialize_fmu_state(&bytes).map(|_| ()),
        exchanged.set_fmu_state(&state),
    ];
    for refused in refused {
        assert!(matches!(
            refused,
            Err(Error::FmuState(StateError::Interface { .. }))
        ));
    }
}

#[test]
fn it_is_described_and_packed() {
    let model = Integrator::new(Interface::CoSimulation);
    let unknown = Unknown {
        value_reference: 3,
        dependencies: [(1, DependencyKind::Dependent)].into(),
        parameters: [].into(),
    };
    let description = ModelDescription {
        standard: Version::Fmi2,
        name: "integrator",
        description: "y' = gain u",
        author: None,
        version: None,
        copyright: None,
        license: None,
        guid: model.guid().to_owned(),
        experiment: Experiment {
            start: 0.0,
            stop: 1.0,
            step: 0.1,
            tolerance: 1e-6,
        },
        capabilities: Integrator::CAPABILITIES,
        variables: model.variables().to_vec(),
        outputs: vec![unknown.clone()],
        derivatives: Vec::new(),
        initial_unknowns: vec![unknown],
        event_indicators: Vec::new(),
        terminals: Vec::new(),
    };
    let mut archive = Cursor::new(Vec::new());
    let resources = [("numbers.txt", &b"1 2 3"[..])];
    write_archive(&mut archive, &description, &[], &resources, &[], None).unwrap();
    let mut archive = zip::ZipArchive::new(archive).unwrap();
    let names: Vec<_> = archive
        .file_names()
        .map(|name| name.unwrap().into_owned())
        .collect();
    assert_eq!(names, ["modelDescription.xml", "resources/numbers.txt"]);
    let xml = std::io::read_to_string(archive.by_index(0).unwrap()).unwrap();
    for part in [
        "modelName=\"integrator\" guid=\"an integrator\"",
        "description=\"y&apos; = gain u\"",
        "maxOutputDerivativeOrder=\"1\"",
        "<Real min=\"0.0\" start=\"1.0\"/>",
        "<Unknown index=\"3\" dependencies=\"1\" dependenciesKind=\"dependent\"/>",
    ] {
        assert!(xml.contains(part), "{part} in {xml}");
    }
    // The schema forbids empty lists (2.2.2, 2.2.3).
    for list in ["<UnitDefinitions", "<TypeDefinitions"] {
        assert!(!xml.contains(list), "{list} in {xml}");
    }
}

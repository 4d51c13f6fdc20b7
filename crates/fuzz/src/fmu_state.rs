//! Serialized FMU states: bytes are a state of the FMU, or refused; a state can be gone on from.

use arbitrary::Unstructured;
use biela::fmi::{Error, Interface, State, StateError, Version};

use crate::{Instance, instance, reals, shipped};

/// Alters the bytes of a state as `data` says, and reads them.
///
/// # Panics
///
/// A fault of biela.
pub fn run(data: &[u8]) {
    let mut data = Unstructured::new(data);
    // Data that end give zeros.
    let _ = attempt(&mut data);
}

fn attempt(data: &mut Unstructured<'_>) -> arbitrary::Result<()> {
    let mechanism = shipped(data.arbitrary()?);
    let interface = *data.choose(&Interface::ALL)?;
    let version = *data.choose(&Version::ALL)?;
    let mut instance = instance(&mechanism, version, interface).expect("it is shipped");
    bring_on(&mut instance, data.int_in_range(0..=3)?);
    let state = instance.fmu_state().expect("allowed");
    let original = instance.serialize_fmu_state(&state).expect("it is its own");
    let mut bytes = original.clone();
    let content = bytes.len() - 4;
    for _ in 0..data.int_in_range(1..=8)? {
        // Most changes to the content, of whole numbers or of single bytes.
        let at = data.int_in_range(0..=content - 1)?;
        match data.int_in_range(0..=3)? {
            0 => bytes[at] = data.arbitrary()?,
            1 => bytes[at] ^= 1 << data.int_in_range(0..=7)?,
            2 if at + 8 <= content => {
                let value: f64 = data.arbitrary()?;
                bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
            }
            _ => bytes.truncate(bytes.len().min(at + 4)),
        }
        if bytes.len() < original.len() {
            break;
        }
    }
    let sealed = data.ratio(9, 10)? && bytes.len() == original.len();
    if sealed {
        let checksum = crc32fast::hash(&bytes[..content]);
        bytes[content..].copy_from_slice(&checksum.to_le_bytes());
    }
    match instance.deserialize_fmu_state(&bytes) {
        Ok(read) => {
            assert!(sealed || bytes == original, "an altered state was accepted");
            let again = instance.serialize_fmu_state(&read);
            let again = instance.deserialize_fmu_state(&again.expect("it is its own"));
            // Rates may be no numbers, which differ from themselves.
            assert_eq!(format!("{again:?}"), format!("{:?}", Ok::<_, Error>(&read)));
            assert_eq!(instance.set_fmu_state(&read), Ok(()));
            go_on(&mut instance);
        }
        Err(Error::FmuState(StateError::Interface { .. } | StateError::Guid { .. })) => {
            assert!(sealed, "the checksum is looked at first");
        }
        Err(Error::FmuState(_)) => {}
        Err(error) => panic!("not for the bytes: {error}"),
    }
    // Whatever became of it, the instance takes its own state.
    let own = instance.deserialize_fmu_state(&original).expect("its own");
    assert_eq!(own, state);
    instance.set_fmu_state(&own).expect("its own");
    assert_eq!(instance.fmu_state(), Ok(state));
    Ok(())
}

/// Some way into its life.
fn bring_on(instance: &mut Instance, how_far: u8) {
    let exchanges = instance.interface() == Interface::ModelExchange;
    for call in 0..how_far {
        let gone = match call {
            0 => instance.enter_initialization_mode(),
            1 => instance.exit_initialization_mode(),
            _ if exchanges => instance
                .enter_continuous_time_mode()
                .and_then(|()| instance.set_time(0.1)),
            _ => step(instance),
        };
        gone.expect("the start values are those of the file");
    }
}

/// Takes a step from where the last one ended.
fn step(instance: &mut Instance) -> Result<(), Error> {
    let time = instance.last_successful_time();
    match instance.version() {
        Version::Fmi2 => instance.do_step(time, 0.1),
        Version::Fmi3 => instance.begin_step(time, 0.1).map(drop),
    }
}

/// Does what a host might do next; it may fail, but not break.
fn go_on(instance: &mut Instance) {
    let reals = reals(instance);
    let _ = instance.reals(&reals).map(|values| values.sum::<f64>());
    let _ = match instance.state() {
        State::Instantiated => instance.enter_initialization_mode(),
        State::InitializationMode => instance.exit_initialization_mode(),
        State::StepComplete | State::StepMode => step(instance),
        State::ContinuousTimeMode => instance.completed_integrator_step().map(drop),
        _ => Ok(()),
    };
    let _ = instance.reals(&reals).map(|values| values.sum::<f64>());
    if instance.state() != State::Fatal {
        instance.reset().expect("always possible");
        instance.enter_initialization_mode().expect("legal");
        let start = instance.exit_initialization_mode();
        start.expect("a reset goes back to the file's own pose");
    }
}

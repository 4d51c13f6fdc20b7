//! States as bytes, and bytes that are none.

use std::collections::BTreeSet;

use biela::fmi::{Error, StateError};
use proptest::prelude::*;
use proptest::sample::Index;

use crate::common::{Instance, co_simulation, shipped};
use crate::fmu_state::{go_on, initialized, look};

/// A state in the middle of a run, as bytes.
fn written(name: &str) -> (Instance, Vec<u8>) {
    let mut instance = initialized(name, [1, 2]);
    go_on(&mut instance, 0);
    let bytes = instance
        .fmu_state()
        .and_then(|state| instance.serialize_fmu_state(&state));
    (instance, bytes.expect("allowed in this state"))
}

#[track_caller]
fn reason(instance: &mut Instance, bytes: &[u8]) -> StateError {
    match instance.deserialize_fmu_state(bytes) {
        Err(Error::FmuState(error)) => error,
        other => panic!("{other:?}"),
    }
}

#[test]
fn all_states_of_a_mechanism_have_one_size() {
    let (running, bytes) = written("four_bar");
    let mut new = co_simulation("four_bar");
    let state = new.fmu_state().unwrap();
    let first = running.serialized_fmu_state_size(&state);
    assert_eq!(first, Ok(bytes.len()));
}

#[test]
fn what_is_wrong_with_bytes_is_told() {
    let (mut instance, bytes) = written("tlv");
    let altered = |at: usize| {
        let mut altered = bytes.clone();
        altered[at] ^= 0x10;
        altered
    };
    for foreign in [
        &b""[..],
        b"x",
        b"[parameters]",
        &bytes[..19],
        &altered(0),
        &[0; 400],
    ] {
        let expected = StateError::Foreign {
            length: foreign.len(),
        };
        assert_eq!(reason(&mut instance, foreign), expected);
    }
    let version = reason(&mut instance, &altered(8));
    assert!(
        matches!(
            version,
            StateError::Version {
                given: 28,
                expected: 12
            }
        ),
        "{version}"
    );
    let mut longer = bytes.clone();
    longer.push(0);
    for wrong in [
        &bytes[..20],
        &bytes[..61],
        &bytes[..bytes.len() - 1],
        &longer,
    ] {
        let expected = StateError::Length {
            announced: bytes.len() as u64,
            given: wrong.len(),
        };
        assert_eq!(reason(&mut instance, wrong), expected);
    }
    // The GUID, a value, the checksum itself.
    for at in [20, 100, bytes.len() - 1] {
        assert_eq!(
            reason(&mut instance, &altered(at)),
            StateError::Checksum,
            "{at}"
        );
    }
}

/// The bytes with a checksum that fits.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let content = bytes.len() - 4;
    let checksum = crc32fast::hash(&bytes[..content]);
    bytes[content..].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

/// Another machine may have found the file's own pose with other rounding; here it is its time
/// that differs, which is the first number of the first of three poses at the end.
#[test]
fn initialization_starts_from_the_pose_of_the_state_until_a_reset() {
    let mut instance = co_simulation("tlv");
    let state = instance.fmu_state().unwrap();
    let mut bytes = instance.serialize_fmu_state(&state).unwrap();
    let mechanism = shipped("tlv");
    let unknowns = 3 * mechanism.bodies.len();
    let numbers = 1 + mechanism.parameters.len() + mechanism.drivers.len() + unknowns;
    // And how many crossings there are: none.
    let pose = 8 * numbers + 4 * unknowns + 8;
    let home = bytes.len() - 4 - 3 * pose;
    bytes[home..home + 8].copy_from_slice(&1.0_f64.to_le_bytes());

    let read = instance.deserialize_fmu_state(&sealed(bytes)).unwrap();
    assert_ne!(read, state);
    instance.set_fmu_state(&read).unwrap();
    assert_eq!(instance.fmu_state().as_ref(), Ok(&read));
    instance.reset().unwrap();
    assert_eq!(instance.fmu_state(), Ok(state));
}

proptest! {
    #[test]
    fn truncated_states_are_refused(length in any::<Index>()) {
        let (mut instance, bytes) = written("tlv");
        let length = length.index(bytes.len());
        let before = instance.fmu_state();
        prop_assert!(instance.deserialize_fmu_state(&bytes[..length]).is_err());
        prop_assert_eq!(instance.fmu_state(), before);
    }

    #[test]
    fn states_with_flipped_bits_are_refused(flips in prop::collection::vec(any::<Index>(), 1..4)) {
        let (mut instance, mut bytes) = written("tlv");
        let bits: BTreeSet<_> = flips.iter().map(|bit| bit.index(8 * bytes.len())).collect();
        for bit in bits {
            bytes[bit / 8] ^= 1 << (bit % 8);
        }
        prop_assert!(instance.deserialize_fmu_state(&bytes).is_err());
    }

    #[test]
    fn any_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let (mut instance, start) = written("tlv");
        prop_assert!(instance.deserialize_fmu_state(&bytes).is_err());
        // And after a beginning that is right.
        let bytes = [&start[..20], &bytes].concat();
        prop_assert!(instance.deserialize_fmu_state(&bytes).is_err());
    }

    /// Whoever forges the checksum gets no further than to a state that an instance can go on
    /// from, if only to a step that fails.
    #[test]
    fn forged_states_do_no_harm(
        name in prop::sample::select(vec!["tlv", "four_bar", "cam_roller", "cam_points", "rack_drive"]),
        changes in prop::collection::vec((any::<Index>(), any::<[u8; 8]>(), 1..9_usize), 1..4),
    ) {
        let (mut instance, mut bytes) = written(name);
        for (place, new, length) in changes {
            // Behind the envelope.
            let at = 58 + place.index(bytes.len() - 58 - 4 - 8);
            bytes[at..at + length].copy_from_slice(&new[..length]);
        }
        if let Ok(state) = instance.deserialize_fmu_state(&sealed(bytes)) {
            instance.set_fmu_state(&state).unwrap();
            look(&mut instance);
            go_on(&mut instance, 8);
            let _ = instance.exit_initialization_mode();
            instance.reset().unwrap();
            look(&mut instance);
        }
    }
}

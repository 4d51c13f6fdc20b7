//! Getting, setting and serializing the FMU state.

use super::types::{fmi3Byte, fmi3FMUState};
use crate::fmi::abi::saved_state::fmu_state_calls;

fmu_state_calls! {
    fmi3FMUState, fmi3Byte;
    fmi3GetFMUState fmi3SetFMUState fmi3FreeFMUState
    fmi3SerializedFMUStateSize fmi3SerializeFMUState fmi3DeserializeFMUState
}

//! Getting, setting and serializing the FMU state.

use crate::fmi::abi::saved_state::fmu_state_calls;

fmu_state_calls! {
    u8;
    fmi3GetFMUState fmi3SetFMUState fmi3FreeFMUState
    fmi3SerializedFMUStateSize fmi3SerializeFMUState fmi3DeserializeFMUState
}

//! Getting, setting and serializing the FMU state.

use super::types::{fmi2Byte, fmi2FMUstate};
use crate::fmi::abi::saved_state::fmu_state_calls;

fmu_state_calls! {
    fmi2FMUstate, fmi2Byte;
    fmi2GetFMUstate fmi2SetFMUstate fmi2FreeFMUstate
    fmi2SerializedFMUstateSize fmi2SerializeFMUstate fmi2DeSerializeFMUstate
}

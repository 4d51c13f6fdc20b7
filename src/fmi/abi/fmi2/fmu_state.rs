//! Getting, setting and serializing the FMU state.

use std::ffi::c_char;

use crate::fmi::abi::saved_state::fmu_state_calls;

fmu_state_calls! {
    c_char;
    fmi2GetFMUstate fmi2SetFMUstate fmi2FreeFMUstate
    fmi2SerializedFMUstateSize fmi2SerializeFMUstate fmi2DeSerializeFMUstate
}

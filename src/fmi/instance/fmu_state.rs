//! The FMU state: everything that decides how an instance goes on.

use std::sync::Arc;

use super::{Error, Instance};
use crate::fmi::codec::{Codec, Unreadable};
use crate::fmi::error::StateError;
use crate::fmi::model::Model;
use crate::fmi::serialized;
use crate::fmi::state::{Call, Interface, State, Version, is_allowed};

/// A state that [`Instance::fmu_state`] saves and [`Instance::set_fmu_state`] restores.
///
/// It fits any instance of the same model and interface, at any time; the instance goes on from
/// it with the same bits. Log settings are no part of it.
#[derive(Clone, Debug, PartialEq)]
pub struct FmuState<S> {
    guid: Arc<str>,
    version: Version,
    interface: Interface,
    state: State,
    stop_time: Option<f64>,
    last_successful_time: f64,
    discarded: bool,
    terminated: bool,
    set_since_step: bool,
    at_dead_point: bool,
    model: S,
}

impl<M: Model> Instance<M> {
    /// `fmi2GetFMUstate`: returns a copy of the FMU state.
    ///
    /// # Errors
    ///
    /// The state machine forbids the call.
    pub fn fmu_state(&mut self) -> Result<FmuState<M::State>, Error> {
        self.allow(Call::GetFMUstate)?;
        // Destructured, so that the compiler reports a new field.
        let Self {
            quantities: _,
            groups: _,
            request: _,
            derivatives: _,
            continuous_inputs: _,
            logger: _,
            allowed: _,
            // Agreements with the host.
            co_simulation: _,
            intermediate: _,
            // No state is saved during a step.
            pending_step: _,
            guid,
            version,
            model,
            interface,
            state,
            stop_time,
            last_successful_time,
            discarded,
            terminated,
            set_since_step,
            at_dead_point,
            state_held,
        } = self;
        *state_held = true;
        Ok(FmuState {
            guid: Arc::clone(guid),
            version: *version,
            interface: *interface,
            state: *state,
            stop_time: *stop_time,
            last_successful_time: *last_successful_time,
            discarded: *discarded,
            terminated: *terminated,
            set_since_step: *set_since_step,
            at_dead_point: *at_dead_point,
            model: model.save(),
        })
    }

    /// `fmi2SetFMUstate`: restores a state of this or another instance of the same FMU.
    ///
    /// # Errors
    ///
    /// The state belongs to another FMU, or the state machine forbids the call.
    pub fn set_fmu_state(&mut self, state: &FmuState<M::State>) -> Result<(), Error> {
        self.allow(Call::SetFMUstate)?;
        self.check_origin(state)?;
        let in_event_mode = state.state == State::EventMode;
        if in_event_mode && !self.has_event_mode() {
            return Err(Error::FmuState(StateError::EventMode));
        }
        self.model.restore(&state.model);
        self.state = state.state;
        self.stop_time = state.stop_time;
        self.last_successful_time = state.last_successful_time;
        self.discarded = state.discarded;
        self.terminated = state.terminated;
        self.set_since_step = state.set_since_step;
        self.at_dead_point = state.at_dead_point;
        self.state_held = true;
        self.log_event(|model| format!("FMU state set: {} at t = {} s", state.state, model.time()));
        Ok(())
    }

    /// `fmi2SerializedFMUstateSize`: returns the number of bytes of a serialized state.
    ///
    /// # Errors
    ///
    /// As [`serialize_fmu_state`](Self::serialize_fmu_state).
    pub fn serialized_fmu_state_size(&self, state: &FmuState<M::State>) -> Result<usize, Error> {
        self.allow(Call::SerializedFMUstateSize)?;
        Ok(self.serialized(state)?.len())
    }

    /// `fmi2SerializeFMUstate`: returns a state as bytes, which
    /// [`deserialize_fmu_state`](Self::deserialize_fmu_state) reads on any machine.
    ///
    /// # Errors
    ///
    /// The state belongs to another FMU, or the state machine forbids the call.
    pub fn serialize_fmu_state(&self, state: &FmuState<M::State>) -> Result<Vec<u8>, Error> {
        self.allow(Call::SerializeFMUstate)?;
        self.serialized(state)
    }

    fn serialized(&self, state: &FmuState<M::State>) -> Result<Vec<u8>, Error> {
        self.check_origin(state)?;
        Ok(serialized::write(&self.guid, |writer| {
            // A codec may replace the fields that it visits.
            Self::visit(&mut state.clone(), writer)
        }))
    }

    /// `fmi2DeSerializeFMUstate`: returns the state that was written as `bytes`. The instance does
    /// not change.
    ///
    /// # Errors
    ///
    /// [`StateError`] for bytes that are no state of this FMU; or the state machine forbids the
    /// call.
    pub fn deserialize_fmu_state(&mut self, bytes: &[u8]) -> Result<FmuState<M::State>, Error> {
        self.allow(Call::DeSerializeFMUstate)?;
        let here = self.fmu_state()?;
        // The reader replaces the content of a state with the right sizes.
        let mut state = here.clone();
        serialized::read(&self.guid, bytes, |reader| Self::visit(&mut state, reader))?;
        self.check_origin(&state)?;
        // No instance ever gets into `stepCanceled`.
        let allowed = is_allowed(self.allowed, Call::GetFMUstate, state.state);
        if !allowed || state.state == State::StepCanceled {
            return Err(Error::FmuState(StateError::Impossible {
                why: format!("it is in state {}", state.state),
            }));
        }
        let checked = self.model.check(&mut state.model);
        self.model.restore(&here.model);
        checked.map_err(|why| StateError::Impossible { why })?;
        Ok(state)
    }

    /// Checks that a state comes from an instance of the same FMU and interface.
    fn check_origin(&self, state: &FmuState<M::State>) -> Result<(), Error> {
        if state.guid != self.guid {
            return Err(Error::FmuState(StateError::Guid {
                given: state.guid.to_string(),
                expected: self.guid.to_string(),
            }));
        }
        if state.version != self.version {
            return Err(Error::FmuState(StateError::Standard {
                given: state.version,
                expected: self.version,
            }));
        }
        if state.interface != self.interface {
            return Err(Error::FmuState(StateError::Interface {
                given: state.interface,
                expected: self.interface,
            }));
        }
        Ok(())
    }

    fn visit(state: &mut FmuState<M::State>, codec: &mut impl Codec) -> Result<(), Unreadable> {
        let FmuState {
            guid: _,
            version,
            interface,
            state,
            stop_time,
            last_successful_time,
            discarded,
            terminated,
            set_since_step,
            at_dead_point,
            model,
        } = state;
        codec.one_of(version, &Version::ALL)?;
        codec.one_of(interface, &Interface::ALL)?;
        codec.one_of(state, &State::ALL)?;
        codec.option(stop_time, 0.0, |codec, time| codec.finite(time))?;
        codec.finite(last_successful_time)?;
        codec.flag(discarded)?;
        codec.flag(terminated)?;
        codec.flag(set_since_step)?;
        codec.flag(at_dead_point)?;
        M::visit(model, codec)
    }
}

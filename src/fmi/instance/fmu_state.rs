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
    lifecycle: Lifecycle,
    model: S,
}

/// Everything apart from the model that decides how an instance goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lifecycle {
    pub(super) state: State,
    pub(super) start_time: f64,
    pub(super) stop_time: Option<f64>,
    pub(super) last_successful_time: f64,
    /// Whether the last step was discarded.
    pub(super) discarded: bool,
    /// Whether the simulation must end, or go on from another state.
    pub(super) terminated: bool,
    /// FMI 3.0: whether values were set in step mode since the last step, or at the present point
    /// of intermediate update.
    pub(super) set_since_step: bool,
    /// FMI 3.0: whether the last step ended at a dead point.
    pub(super) at_dead_point: bool,
}

impl Lifecycle {
    /// Returns the lifecycle of an instance that starts at `time`.
    pub(super) fn new(time: f64) -> Self {
        Self {
            state: State::Instantiated,
            start_time: time,
            stop_time: None,
            last_successful_time: time,
            discarded: false,
            terminated: false,
            set_since_step: false,
            at_dead_point: false,
        }
    }

    /// Visits all fields.
    fn visit(&mut self, codec: &mut impl Codec) -> Result<(), Unreadable> {
        let Self {
            state,
            start_time,
            stop_time,
            last_successful_time,
            discarded,
            terminated,
            set_since_step,
            at_dead_point,
        } = self;
        codec.one_of(state, &State::ALL)?;
        codec.finite(start_time)?;
        codec.option(stop_time, 0.0, Codec::finite)?;
        codec.finite(last_successful_time)?;
        let flags = [discarded, terminated, set_since_step, at_dead_point];
        codec.each(flags, Codec::flag)
    }
}

impl<M: Model> Instance<M> {
    /// `fmi2GetFMUstate`: returns a copy of the FMU state.
    ///
    /// # Errors
    ///
    /// The state machine forbids the call.
    pub fn fmu_state(&mut self) -> Result<FmuState<M::State>, Error> {
        self.allow(Call::GetFMUstate)?;
        self.state_held = true;
        Ok(FmuState {
            guid: Arc::clone(&self.guid),
            version: self.version,
            interface: self.interface,
            lifecycle: self.lifecycle,
            model: self.model.save(),
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
        let now = state.lifecycle.state;
        if now == State::EventMode && !self.has_event_mode() {
            return Err(Error::FmuState(StateError::EventMode));
        }
        self.model.restore(&state.model);
        self.lifecycle = state.lifecycle;
        self.state_held = true;
        self.log_event(|model| format!("FMU state set: {now} at t = {} s", model.time()));
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
        let now = state.lifecycle.state;
        if !is_allowed(self.allowed, Call::GetFMUstate, now) || now == State::StepCanceled {
            return Err(Error::FmuState(StateError::Impossible {
                why: format!("it is in state {now}"),
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
        codec.one_of(&mut state.version, &Version::ALL)?;
        codec.one_of(&mut state.interface, &Interface::ALL)?;
        state.lifecycle.visit(codec)?;
        M::visit(&mut state.model, codec)
    }
}

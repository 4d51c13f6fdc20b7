//! The FMU state: all that decides how an instance goes on.

use std::sync::Arc;

use super::{Error, Freshness, Instance, Settings, Status};
use crate::fmi::codec::{Codec, Unreadable};
use crate::fmi::inputs::{DriverInput, Extrapolation, RateSource};
use crate::fmi::log::Category;
use crate::fmi::serialized;
use crate::fmi::state::{Call, State};
use crate::fmi::variables::Causality;
use crate::kinematics::{Crossing, Pose, Progress};
use crate::mechanism::{DriverId, Jet};

/// The residual below which a pose counts as one of the mechanism, relative to its largest
/// coordinate in characteristic lengths and radians. Newton leaves what rounding does, some
/// 1e-15; what is closed to this, the next step closes fully.
const CLOSED: f64 = 1e-9;

/// What [`Instance::fmu_state`] saves and [`Instance::set_fmu_state`] restores.
///
/// It belongs to a mechanism, not to an instance: any instance of the same mechanism takes it, at
/// any time, and goes on from it with the same bits. Log settings are no part of it.
#[derive(Clone, Debug, PartialEq)]
pub struct FmuState {
    guid: Arc<str>,
    home: Arc<Pose>,
    state: State,
    settings: Settings,
    inputs: Vec<DriverInput>,
    committed: Pose,
    /// Where the solver stands: the committed pose, or that of values set since.
    standing: Pose,
    at_committed: bool,
    driver_rates: Vec<Jet>,
    committed_rates: Vec<Jet>,
    /// Never [`Freshness::Rates`]: rates follow from the pose.
    freshness: Freshness,
    progress: Progress,
    time: f64,
    stop_time: Option<f64>,
    last_successful_time: f64,
    terminated: bool,
    near_singular: bool,
}

/// Why bytes are no FMU state of this FMU.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// They do not begin like one.
    #[error("these {length} bytes are no serialized FMU state of biela")]
    Foreign {
        /// How many there are.
        length: usize,
    },
    /// Another biela wrote them.
    #[error("the serialized FMU state has version {given}; this FMU reads version {expected}")]
    Version {
        /// The version of the bytes.
        given: u32,
        /// The one that can be read.
        expected: u32,
    },
    /// Too few or too many.
    #[error(
        "the serialized FMU state was {announced} bytes long when it was written and is {given} now"
    )]
    Length {
        /// As the bytes say.
        announced: u64,
        /// As they are.
        given: usize,
    },
    /// They are not as they were written.
    #[error("the serialized FMU state was altered: its checksum does not fit")]
    Checksum,
    /// They belong to another mechanism.
    #[error("the FMU state is of the FMU with GUID `{given}`, not of this one, `{expected}`")]
    Mechanism {
        /// The GUID in the state.
        given: String,
        /// That of this FMU.
        expected: String,
    },
    /// Their checksum fits, but they describe no state that an instance could be in.
    #[error("the serialized FMU state is none that an instance could be in: {what}")]
    Impossible {
        /// What is wrong.
        what: String,
    },
    /// There is not the room that the state takes.
    #[error("the serialized FMU state takes {needed} bytes, and there is room for {given}")]
    Room {
        /// The size of the state.
        needed: usize,
        /// The room there is.
        given: usize,
    },
}

impl Instance {
    /// `fmi2GetFMUstate`: a copy of all that decides how the instance goes on.
    ///
    /// # Errors
    ///
    /// The state machine does not allow it.
    pub fn fmu_state(&mut self) -> Result<FmuState, Error> {
        self.allow(Call::GetFMUstate)?;
        // A stale pose is found anew from the committed one.
        if self.freshness == Freshness::Stale {
            self.solver.restore(&self.committed);
            self.at_committed = true;
        }
        self.solver.forget_way();
        self.freshness = self.freshness.min(Freshness::Pose);
        // Field by field, so that a new one cannot be forgotten.
        let Self {
            mechanism: _,
            variables: _,
            logger: _,
            // The same for all instances of a mechanism, rounding apart.
            own_home: _,
            // Work space, laid anew for each step.
            path: _,
            // Computed from the pose when asked for.
            rates: _,
            coordinates: _,
            guid,
            home,
            state,
            settings,
            inputs,
            solver,
            committed,
            at_committed,
            driver_rates,
            committed_rates,
            freshness,
            progress,
            time,
            stop_time,
            last_successful_time,
            terminated,
            near_singular,
        } = self;
        let at_committed = *at_committed || *freshness == Freshness::Stale;
        Ok(FmuState {
            guid: Arc::clone(guid),
            home: Arc::clone(home),
            state: *state,
            settings: settings.clone(),
            inputs: inputs.clone(),
            committed: committed.clone(),
            standing: if at_committed {
                committed.clone()
            } else {
                solver.pose().clone()
            },
            at_committed,
            driver_rates: driver_rates.clone(),
            committed_rates: committed_rates.clone(),
            freshness: *freshness,
            progress: *progress,
            time: *time,
            stop_time: *stop_time,
            last_successful_time: *last_successful_time,
            terminated: *terminated,
            near_singular: *near_singular,
        })
    }

    /// `fmi2SetFMUstate`: goes on from a state of this instance or of another one of the same
    /// mechanism, whatever happened since.
    ///
    /// # Errors
    ///
    /// The state is of another mechanism, or the state machine does not allow it.
    pub fn set_fmu_state(&mut self, state: &FmuState) -> Result<(), Error> {
        self.allow(Call::SetFMUstate)?;
        self.check_guid(&state.guid)?;
        self.home = Arc::clone(&state.home);
        self.state = state.state;
        self.settings.clone_from(&state.settings);
        self.inputs.clone_from(&state.inputs);
        self.committed.clone_from(&state.committed);
        self.solver.restore(&state.standing);
        self.solver.forget_way();
        self.at_committed = state.at_committed;
        self.driver_rates.clone_from(&state.driver_rates);
        self.committed_rates.clone_from(&state.committed_rates);
        self.freshness = state.freshness;
        self.progress = state.progress;
        self.time = state.time;
        self.stop_time = state.stop_time;
        self.last_successful_time = state.last_successful_time;
        self.terminated = state.terminated;
        self.near_singular = state.near_singular;
        if self.logger.wants(Category::Events) {
            let message = format!("FMU state set: {} at t = {} s", self.state, self.time);
            self.logger.write(Status::Ok, Category::Events, &message);
        }
        Ok(())
    }

    /// `fmi2SerializedFMUstateSize`: how many bytes
    /// [`serialize_fmu_state`](Self::serialize_fmu_state) gives, which is the same for all states
    /// of a mechanism but those next to a change point.
    ///
    /// # Errors
    ///
    /// The state is of another mechanism, or the state machine does not allow the call.
    pub fn serialized_fmu_state_size(&self, state: &FmuState) -> Result<usize, Error> {
        self.allow(Call::SerializedFMUstateSize)?;
        Ok(self.serialized(state)?.len())
    }

    /// `fmi2SerializeFMUstate`: a state as bytes that
    /// [`deserialize_fmu_state`](Self::deserialize_fmu_state) reads, here or elsewhere.
    ///
    /// # Errors
    ///
    /// The state is of another mechanism, or the state machine does not allow the call.
    pub fn serialize_fmu_state(&self, state: &FmuState) -> Result<Vec<u8>, Error> {
        self.allow(Call::SerializeFMUstate)?;
        self.serialized(state)
    }

    fn serialized(&self, state: &FmuState) -> Result<Vec<u8>, Error> {
        self.check_guid(&state.guid)?;
        Ok(serialized::write(&self.guid, |writer| {
            // A walk may replace what it goes through.
            state.clone().walk(writer)
        }))
    }

    /// `fmi2DeSerializeFMUstate`: the state that was written as `bytes`. The instance stays as it
    /// is.
    ///
    /// # Errors
    ///
    /// The bytes are no state of this mechanism, as [`StateError`] has it; or the state machine
    /// does not allow the call.
    pub fn deserialize_fmu_state(&mut self, bytes: &[u8]) -> Result<FmuState, Error> {
        self.allow(Call::DeSerializeFMUstate)?;
        let here = self.fmu_state()?;
        // Of the right sizes, to be replaced.
        let mut state = here.clone();
        serialized::read(&self.guid, bytes, |reader| state.walk(reader))?;
        let checked = self.check_fmu_state(&mut state);
        self.solver.restore(&here.standing);
        checked?;
        // The usual case, which needs no second copy.
        if state.home == self.own_home {
            state.home = Arc::clone(&self.own_home);
        }
        Ok(state)
    }

    fn check_guid(&self, guid: &Arc<str>) -> Result<(), Error> {
        if *guid == self.guid {
            Ok(())
        } else {
            Err(Error::FmuState(StateError::Mechanism {
                given: guid.to_string(),
                expected: self.guid.to_string(),
            }))
        }
    }

    /// Makes sure that nothing in a state that was read can lead where no instance could be.
    /// Leaves the solver at any pose.
    fn check_fmu_state(&mut self, state: &mut FmuState) -> Result<(), Error> {
        // Whatever the bytes say of derived parameters.
        self.mechanism
            .derive_parameters(&mut state.settings.parameters);
        for variable in self.variables.list() {
            if variable.causality == Causality::Parameter
                && let Some(value) = state.settings.parameter(variable.quantity)
            {
                super::values::check_value(variable, value).map_err(impossible)?;
            }
        }
        for pose in [&state.home, &state.committed, &state.standing] {
            self.check_pose(pose)?;
        }
        Ok(())
    }

    /// Makes sure that the equations can be evaluated at a pose and hold there.
    fn check_pose(&mut self, pose: &Pose) -> Result<(), Error> {
        let system = self.solver.system();
        let (mut at, mut targets) = (system.configuration(), system.targets());
        system
            .set_parameters(&pose.parameters, &mut at, &mut targets)
            .and_then(|()| system.check_drivers(&pose.drivers))
            .map_err(impossible)?;
        let largest = (pose.q.iter().enumerate()).fold(1.0, |largest: f64, (column, q)| {
            largest.max((q / system.column_scale(column, at.size())).abs())
        });
        if !self.solver.admits_crossings(pose) {
            return Err(impossible("its change points are none of this mechanism"));
        }
        self.solver.restore(pose);
        let residual = self.solver.residual();
        // Not a number is not closed either.
        if residual <= CLOSED * largest {
            Ok(())
        } else {
            Err(impossible(format!("its joints are open by {residual:.1e}")))
        }
    }
}

fn impossible(what: impl ToString) -> Error {
    Error::FmuState(StateError::Impossible {
        what: what.to_string(),
    })
}

impl FmuState {
    fn walk(&mut self, codec: &mut impl Codec) -> Result<(), Unreadable> {
        let Self {
            guid: _,
            home,
            state,
            settings,
            inputs,
            committed,
            standing,
            at_committed,
            driver_rates,
            committed_rates,
            freshness,
            progress,
            time,
            stop_time,
            last_successful_time,
            terminated,
            near_singular,
        } = self;
        codec.one_of(state, &State::SAVED)?;
        codec.one_of(freshness, &[Freshness::Stale, Freshness::Pose])?;
        codec.flag(at_committed)?;
        codec.flag(terminated)?;
        codec.flag(near_singular)?;
        codec.finite(time)?;
        codec.option(stop_time, 0.0, |codec, time| codec.finite(time))?;
        codec.finite(last_successful_time)?;
        codec.count(&mut progress.iterations)?;
        codec.count(&mut progress.substeps)?;
        codec.count(&mut progress.crossings)?;
        codec.count(&mut progress.checked)?;
        // Derived parameters may be anything until values are looked at together.
        for value in &mut settings.parameters {
            codec.real(value)?;
        }
        codec.one_of(&mut settings.rates, &RateSource::ALL)?;
        codec.one_of(&mut settings.extrapolation, &Extrapolation::ALL)?;
        for input in inputs {
            input.walk(codec)?;
        }
        // A prescribed motion may have rates that are not finite; who asks for them is told.
        for rates in driver_rates.iter_mut().chain(committed_rates) {
            codec.real(&mut rates.value)?;
            codec.real(&mut rates.first)?;
            codec.real(&mut rates.second)?;
        }
        for pose in [Arc::make_mut(home), committed, standing] {
            walk_pose(pose, codec)?;
        }
        Ok(())
    }
}

fn walk_pose(pose: &mut Pose, codec: &mut impl Codec) -> Result<(), Unreadable> {
    let Pose {
        time,
        parameters,
        drivers,
        q,
        turns,
        crossings,
    } = pose;
    codec.finite(time)?;
    for value in parameters.iter_mut().chain(drivers).chain(&mut *q) {
        codec.finite(value)?;
    }
    turns.iter_mut().try_for_each(|turn| codec.signed(turn))?;
    let unknowns = q.len();
    codec.resize(crossings, unknowns, || {
        Arc::new(Crossing {
            kernel: 0,
            driver: DriverId(0),
            center: 0.0,
            half_width: 0.0,
            coefficients: Vec::new(),
            free: Vec::new(),
        })
    })?;
    crossings
        .iter_mut()
        .try_for_each(|crossing| walk_crossing(Arc::make_mut(crossing), unknowns, codec))
}

fn walk_crossing(
    crossing: &mut Crossing,
    unknowns: usize,
    codec: &mut impl Codec,
) -> Result<(), Unreadable> {
    let Crossing {
        kernel,
        driver,
        center,
        half_width,
        coefficients,
        free,
    } = crossing;
    codec.place(kernel)?;
    codec.place(&mut driver.0)?;
    codec.finite(center)?;
    codec.finite(half_width)?;
    codec.resize(coefficients, unknowns, || [0.0; 6])?;
    for value in coefficients.iter_mut().flatten() {
        codec.finite(value)?;
    }
    codec.resize(free, unknowns, || 0.0)?;
    free.iter_mut().try_for_each(|value| codec.finite(value))
}

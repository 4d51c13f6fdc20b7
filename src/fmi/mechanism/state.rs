//! All that decides how a mechanism goes on, as it is saved, restored and written.

use std::sync::Arc;

use super::inputs::{DriverInput, Extrapolation, RateSource};
use super::{Freshness, MechanismModel, Settings};
use crate::fmi::codec::{Codec, Unreadable};
use crate::fmi::instance::check_value;
use crate::fmi::variable::Causality;
use crate::kinematics::{Crossing, Pose, Progress};
use crate::mechanism::{DriverId, Jet};

/// The residual below which a pose counts as one of the mechanism, relative to its largest
/// coordinate in characteristic lengths and radians. Newton leaves what rounding does, some
/// 1e-15; what is closed to this, the next step closes fully.
const CLOSED: f64 = 1e-9;

/// The state of a [`MechanismModel`].
#[derive(Clone, Debug, PartialEq)]
pub struct MechanismState {
    home: Arc<Pose>,
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
    near_singular: bool,
}

impl MechanismModel {
    pub(super) fn saved(&mut self) -> MechanismState {
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
            guid: _,
            interface: _,
            variables: _,
            // The same for all instances of a mechanism, rounding apart.
            own_home: _,
            // Work space, laid anew for each step.
            path: _,
            // Computed from the pose when asked for.
            rates: _,
            row: _,
            coordinates: _,
            home,
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
            near_singular,
        } = self;
        MechanismState {
            home: Arc::clone(home),
            settings: settings.clone(),
            inputs: inputs.clone(),
            committed: committed.clone(),
            standing: if *at_committed {
                committed.clone()
            } else {
                solver.pose().clone()
            },
            at_committed: *at_committed,
            driver_rates: driver_rates.clone(),
            committed_rates: committed_rates.clone(),
            freshness: *freshness,
            progress: *progress,
            time: *time,
            near_singular: *near_singular,
        }
    }

    pub(super) fn go_back_to(&mut self, state: &MechanismState) {
        self.home = Arc::clone(&state.home);
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
        self.near_singular = state.near_singular;
    }

    /// Makes sure that nothing in a state that was read can lead where no model could be. Leaves
    /// the solver at any pose.
    pub(super) fn check_state(&mut self, state: &mut MechanismState) -> Result<(), String> {
        // Whatever the bytes say of derived parameters.
        self.mechanism
            .derive_parameters(&mut state.settings.parameters);
        for variable in &self.variables {
            if variable.causality == Causality::Parameter
                && let Some(value) = state.settings.parameter(variable.quantity)
            {
                check_value(variable, value).map_err(|error| error.to_string())?;
            }
        }
        for pose in [&state.home, &state.committed, &state.standing] {
            self.check_pose(pose)?;
        }
        // The usual case, which needs no second copy.
        if state.home == self.own_home {
            state.home = Arc::clone(&self.own_home);
        }
        Ok(())
    }

    /// Makes sure that the equations can be evaluated at a pose and hold there.
    fn check_pose(&mut self, pose: &Pose) -> Result<(), String> {
        let system = self.solver.system();
        let (mut at, mut targets) = (system.configuration(), system.targets());
        system
            .set_parameters(&pose.parameters, &mut at, &mut targets)
            .and_then(|()| system.check_drivers(&pose.drivers))
            .map_err(|error| error.to_string())?;
        let largest = (pose.q.iter().enumerate()).fold(1.0, |largest: f64, (column, q)| {
            largest.max((q / system.column_scale(column, at.size())).abs())
        });
        if !self.solver.admits_crossings(pose) {
            return Err("its change points are none of this mechanism".to_owned());
        }
        self.solver.restore(pose);
        let residual = self.solver.residual();
        // Not a number is not closed either.
        if residual <= CLOSED * largest {
            Ok(())
        } else {
            Err(format!("its joints are open by {residual:.1e}"))
        }
    }
}

impl MechanismState {
    pub(super) fn walk(&mut self, codec: &mut impl Codec) -> Result<(), Unreadable> {
        let Self {
            home,
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
            near_singular,
        } = self;
        codec.one_of(freshness, &[Freshness::Stale, Freshness::Pose])?;
        codec.flag(at_committed)?;
        codec.flag(near_singular)?;
        codec.finite(time)?;
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
            for rate in &mut rates.derivatives {
                codec.real(rate)?;
            }
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
            block: 0,
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
        block,
        driver,
        center,
        half_width,
        coefficients,
        free,
    } = crossing;
    codec.place(block)?;
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

//! The saved state: everything that decides how a mechanism goes on.

use std::sync::Arc;

use super::rule::Source;
use super::{Course, Freshness, MechanismModel, Quantity};
use crate::dynamics::{FreeState, Mode, Passive, Told};
use crate::fmi::codec::{Codec, Unreadable};
use crate::fmi::instance::check_value;
use crate::fmi::variable::Causality;
use crate::kinematics::{
    Alignment, BlockChoices, Crossing, LineRelation, Member, Origin, PivotOrder, Polynomial, Pose,
    Progress, SolverChoices,
};
use crate::mechanism::{BodyId, Corner, DriverId, Extrapolation, Jet, RateSource};

/// Largest residual of a pose that is read, relative to its largest coordinate in characteristic
/// lengths and radians. Newton leaves 1e-15; the next step closes a pose within this tolerance.
const CLOSED: f64 = 1e-9;

/// The state of a [`MechanismModel`].
#[derive(Clone, Debug, PartialEq)]
pub struct MechanismState {
    /// Its freshness is [`Freshness::Stale`] or [`Freshness::Pose`]: rates follow from the pose.
    course: Course,
    driver_rates: Vec<Jet>,
    told: Told,
    /// The solver's pose, the committed one or that of values set since, and its choices there.
    present: Pose,
    present_choices: SolverChoices,
}

impl MechanismModel {
    pub(super) fn save_state(&mut self) -> MechanismState {
        // The next evaluation starts from the committed pose anyway.
        if self.course.freshness == Freshness::Stale && !self.course.at_committed {
            self.return_to_committed();
        }
        self.set_freshness(self.course.freshness.min(Freshness::Pose));
        let mut present_choices = SolverChoices::default();
        self.motion.solver.copy_choices(&mut present_choices);
        let course = &mut self.course;
        let present = if course.at_committed {
            course.committed_choices.clone_from(&present_choices);
            course.committed.clone()
        } else {
            self.motion.solver.pose().clone()
        };
        MechanismState {
            course: course.clone(),
            driver_rates: self.motion.solution.driver_rates.clone(),
            told: self.motion.told.clone(),
            present,
            present_choices,
        }
    }

    pub(super) fn restore_state(&mut self, state: &MechanismState) {
        self.course.clone_from(&state.course);
        (self.motion.solution.driver_rates).copy_from_slice(&state.driver_rates);
        self.motion.told.clone_from(&state.told);
        let (pose, choices) = (&state.present, &state.present_choices);
        self.motion
            .return_to(pose, choices, state.course.free.as_ref());
        self.reals.invalidate();
        self.parts = None;
    }

    /// Checks that a model can be in a state that was read. Leaves the solver at any pose.
    ///
    /// # Errors
    ///
    /// A value is outside its limits, or a pose is none of this mechanism.
    pub(super) fn check_state(&mut self, state: &mut MechanismState) -> Result<(), String> {
        // Derived parameters follow from the others.
        self.mechanism
            .derive_parameters(&mut state.course.parameters);
        for variable in &self.variables {
            let value = match variable.quantity {
                Quantity::Parameter(parameter) if variable.causality == Causality::Parameter => {
                    state.course.parameters[parameter.index()]
                }
                Quantity::Budget => state.course.budget,
                _ => continue,
            };
            check_value(variable, value).map_err(|error| error.to_string())?;
        }
        self.check_free(self.motion.fresh().cloned().as_ref())?;
        self.check_pose(&state.course.start_pose)?;
        self.check_free(state.course.free.as_ref())?;
        for (pose, choices) in [
            (&state.course.committed, &state.course.committed_choices),
            (&state.present, &state.present_choices),
        ] {
            self.check_pose(pose)?;
            if !self.motion.solver.resume(pose, choices) {
                return Err("its choice of equations is none of this mechanism".to_owned());
            }
        }
        // The usual case, in which instances share one copy.
        if state.course.start_pose == self.file_pose {
            state.course.start_pose = Arc::clone(&self.file_pose);
        }
        Ok(())
    }

    /// Checks that freedoms can be in a state, and lets the solver be that of its coordinates.
    fn check_free(&mut self, state: Option<&FreeState>) -> Result<(), String> {
        let (Some((free, solver, solution)), Some(state)) = (self.motion.parts(), state) else {
            return Ok(());
        };
        free.select(solver, solution, state)
            .and_then(|()| free.resume(solver, state))
            .map_err(|error| error.to_string())
    }

    /// Checks that the equations exist at a pose and hold there.
    fn check_pose(&mut self, pose: &Pose) -> Result<(), String> {
        let system = self.motion.solver.system();
        let (mut at, mut targets) = (system.configuration(), system.targets());
        system
            .set_parameters(&pose.parameters, &mut at, &mut targets)
            .and_then(|()| system.check_drivers(&pose.drivers))
            .map_err(|error| error.to_string())?;
        let largest = (pose.q.iter().enumerate()).fold(1.0, |largest: f64, (column, q)| {
            largest.max((q / system.column_scale(column, at.size())).abs())
        });
        if !self.motion.solver.admits_crossings(pose) {
            return Err("its change points do not belong to this mechanism".to_owned());
        }
        self.motion.solver.restore(pose);
        let residual = self.motion.solver.residual();
        // False for NaN too.
        if residual <= CLOSED * largest {
            Ok(())
        } else {
            Err(format!("its joints are open by {residual:.1e}"))
        }
    }
}

impl MechanismState {
    pub(super) fn visit(&mut self, codec: &mut impl Codec) -> Result<(), Unreadable> {
        let Self {
            course,
            driver_rates,
            told,
            present,
            present_choices,
        } = self;
        let Told {
            near_singular,
            beyond,
            inputs_beyond,
            off_pulleys,
            lifted,
            beyond_points,
        } = told;
        let Course {
            time,
            start_pose,
            parameters,
            rule,
            budget,
            committed,
            committed_choices,
            committed_rates,
            at_committed,
            freshness,
            sources,
            inputs,
            force_inputs,
            free,
            monitors,
            path_progress,
            progress,
        } = course;
        codec.one_of(freshness, &[Freshness::Stale, Freshness::Pose])?;
        codec.flag(at_committed)?;
        codec.flag(near_singular)?;
        codec.finite(time)?;
        for Progress {
            iterations,
            substeps,
            crossings,
            checked,
        } in [path_progress, progress]
        {
            codec.each([iterations, substeps, crossings, checked], Codec::count)?;
        }
        // Derived parameters may have any value: `check_state` derives them again.
        codec.each(parameters, Codec::real)?;
        codec.one_of(&mut rule.rates, &RateSource::ALL)?;
        codec.one_of(&mut rule.extrapolation, &Extrapolation::ALL)?;
        codec.finite(budget)?;
        for ((input, monitor), beyond) in inputs.iter_mut().zip(monitors).zip(beyond) {
            input.visit(codec)?;
            monitor.visit(codec)?;
            codec.flag(beyond)?;
        }
        codec.each(force_inputs, |codec, input| input.visit(codec))?;
        codec.each(inputs_beyond, Codec::flag)?;
        if let Some(free) = free {
            visit_free(free, codec)?;
        }
        let flags = lifted.iter_mut().chain(off_pulleys).chain(beyond_points);
        codec.each(flags, Codec::flag)?;
        // A prescribed motion may have infinite rates, which the getters refuse.
        for rates in driver_rates.iter_mut().chain(committed_rates) {
            codec.real(&mut rates.value)?;
            codec.each(&mut rates.derivatives, Codec::real)?;
        }
        let sources = sources.iter_mut().flatten();
        codec.each(sources, |codec, source| codec.one_of(source, &Source::ALL))?;
        let (rows, unknowns) = (committed.turns.len(), committed.q.len());
        for choices in [committed_choices, present_choices] {
            visit_choices(choices, rows, unknowns, codec)?;
        }
        for pose in [Arc::make_mut(start_pose), committed, present] {
            visit_pose(pose, codec)?;
        }
        Ok(())
    }
}

fn visit_free(free: &mut FreeState, codec: &mut impl Codec) -> Result<(), Unreadable> {
    let FreeState {
        integrator,
        tolerance,
        coordinates,
        drivers,
        loads,
        energies,
        modes,
        passive,
        corners,
    } = free;
    integrator.visit(|word| codec.word(word))?;
    codec.finite(tolerance)?;
    codec.each(coordinates, Codec::index)?;
    for rates in drivers {
        codec.real(&mut rates.value)?;
        codec.each(&mut rates.derivatives, Codec::real)?;
    }
    codec.each(loads.iter_mut().chain(energies), Codec::real)?;
    for ((mode, anchor), at) in modes.iter_mut().zip(passive) {
        codec.one_of(mode, &Mode::ALL)?;
        let Passive {
            coordinate,
            force,
            bounds,
            roundings,
            force_rounding,
            is_dependent,
        } = at;
        let reals = [anchor, &mut coordinate.value, force, force_rounding];
        let reals = reals.into_iter().chain(&mut coordinate.derivatives);
        codec.each(reals.chain(bounds).chain(roundings), Codec::real)?;
        codec.one_of(is_dependent, &[false, true])?;
    }
    for Corner {
        argument,
        nearest,
        jumps,
    } in corners
    {
        codec.each([argument].into_iter().chain(nearest), Codec::real)?;
        codec.one_of(jumps, &[false, true])?;
    }
    Ok(())
}

fn visit_choices(
    choices: &mut SolverChoices,
    rows: usize,
    unknowns: usize,
    codec: &mut impl Codec,
) -> Result<(), Unreadable> {
    let SolverChoices { set_aside, blocks } = choices;
    visit_indices(set_aside, rows, codec)?;
    codec.resize(blocks, unknowns, BlockChoices::default)?;
    for BlockChoices { pivots } in blocks {
        for PivotOrder { rows, columns } in pivots {
            visit_indices(rows, unknowns, codec)?;
            visit_indices(columns, unknowns, codec)?;
        }
    }
    Ok(())
}

/// Visits a list of up to `most` indices.
fn visit_indices(
    list: &mut Vec<usize>,
    most: usize,
    codec: &mut impl Codec,
) -> Result<(), Unreadable> {
    codec.resize(list, most, || 0)?;
    codec.each(list, Codec::index)
}

fn visit_pose(pose: &mut Pose, codec: &mut impl Codec) -> Result<(), Unreadable> {
    let Pose {
        time,
        parameters,
        drivers,
        q,
        turns,
        crossings,
    } = pose;
    codec.finite(time)?;
    codec.each(
        parameters.iter_mut().chain(drivers).chain(&mut *q),
        Codec::finite,
    )?;
    codec.each(&mut *turns, Codec::signed)?;
    let (rows, unknowns) = (turns.len(), q.len());
    codec.resize(crossings, unknowns, || {
        Arc::new(Crossing {
            set_aside: Vec::new(),
            block: 0,
            driver: DriverId(0),
            center: 0.0,
            half_width: 0.0,
            coefficients: Vec::new(),
            free: Vec::new(),
            alignment: Alignment::default(),
        })
    })?;
    codec.each(crossings, |codec, crossing| {
        visit_crossing(Arc::make_mut(crossing), rows, unknowns, codec)
    })
}

fn visit_crossing(
    crossing: &mut Crossing,
    rows: usize,
    unknowns: usize,
    codec: &mut impl Codec,
) -> Result<(), Unreadable> {
    let Crossing {
        set_aside,
        block,
        driver,
        center,
        half_width,
        coefficients,
        free,
        alignment,
    } = crossing;
    visit_indices(set_aside, rows, codec)?;
    codec.index(block)?;
    codec.index(&mut driver.0)?;
    codec.finite(center)?;
    codec.finite(half_width)?;
    codec.resize(coefficients, unknowns, Polynomial::default)?;
    codec.each(coefficients.iter_mut().flatten().flatten(), Codec::finite)?;
    codec.resize(free, unknowns, || 0.0)?;
    codec.each(free, Codec::finite)?;
    visit_alignment(alignment, rows + unknowns, codec)
}

fn visit_alignment(
    alignment: &mut Alignment,
    most: usize,
    codec: &mut impl Codec,
) -> Result<(), Unreadable> {
    let Alignment { relation, members } = alignment;
    codec.one_of(relation, &LineRelation::ALL)?;
    codec.resize(members, most, || Member::Body(BodyId(0)))?;
    codec.each(members, |codec, member| {
        let (mut kind, mut index) = match *member {
            Member::Body(body) => (0, body.0),
            Member::Origin(Origin::Joint(joint)) => (1, joint),
            Member::Origin(Origin::Constraint(held)) => (2, held),
            Member::Origin(Origin::Driver(driver)) => (3, driver.0),
        };
        codec.index(&mut kind)?;
        codec.index(&mut index)?;
        *member = match kind {
            0 => Member::Body(BodyId(index)),
            1 => Member::Origin(Origin::Joint(index)),
            2 => Member::Origin(Origin::Constraint(index)),
            3 => Member::Origin(Origin::Driver(DriverId(index))),
            _ => return Err(Unreadable),
        };
        Ok(())
    })
}

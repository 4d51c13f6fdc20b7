//! A block near a change point, on the interpolated motion.

use std::sync::Arc;

use super::BlockSolver;
use super::choices::BlockChoices;
use super::crossing::{Crossing, SEAM};
use super::solve::SolveBlock;
use super::step::{BlockState, Step};
use crate::kinematics::certificate::ChordBound;
use crate::kinematics::newton::{Correction, Limits, Rejected};
use crate::mechanism::Jet;

/// Any block while its unknowns come from a [`Crossing`].
#[derive(Debug)]
pub(in crate::kinematics) struct InterpolatedBlock {
    /// The solver that takes over again beyond the crossing.
    pub(in crate::kinematics) block: BlockSolver,
    pub(in crate::kinematics) crossing: Arc<Crossing>,
    /// The driver's value at the last factorisation.
    value: f64,
    /// Whether the block could not be factorised there.
    singular: bool,
}

/// Rounding of the polynomials, in parts of the values.
const POLYNOMIAL_ROUNDING: f64 = 4.0 * f64::EPSILON;

impl InterpolatedBlock {
    pub(in crate::kinematics) fn new(block: BlockSolver, crossing: Arc<Crossing>) -> Self {
        Self {
            block,
            value: crossing.center,
            crossing,
            singular: false,
        }
    }

    /// Puts the unknowns where the driver's value says.
    ///
    /// # Errors
    ///
    /// [`Rejected`] outside of the crossing.
    fn interpolate(&self, state: &mut BlockState<'_>) -> Result<Correction, Rejected> {
        if !self.is_within(state.drivers) {
            return Err(Rejected);
        }
        let value = state.drivers[self.crossing.driver.index()];
        for (local, &column) in self.block.columns().iter().enumerate() {
            let [position, ..] = self.crossing.evaluate(local, value);
            state.at.set_coordinate(column, position);
        }
        Ok(Correction {
            iterations: 1,
            ..Correction::default()
        })
    }

    /// Returns whether these values of the drivers are within the crossing.
    pub(in crate::kinematics) fn is_within(&self, drivers: &[f64]) -> bool {
        let value = drivers[self.crossing.driver.index()];
        self.crossing.place(value).abs() <= SEAM
    }

    /// Puts the unknowns near the motion beyond the crossing, ahead of its end. Returns false within
    /// the crossing.
    pub(in crate::kinematics) fn start_beyond(&self, state: &mut BlockState<'_>) -> bool {
        if self.is_within(state.drivers) {
            return false;
        }
        let crossing = &self.crossing;
        let value = state.drivers[crossing.driver.index()];
        let end = crossing.center + crossing.half_width.copysign(value - crossing.center);
        let off = value - end;
        for (local, &column) in self.block.columns().iter().enumerate() {
            let [position, first, second] = crossing.evaluate(local, end);
            let ahead = position + off * (first + 0.5 * off * second);
            state.at.set_coordinate(column, ahead);
        }
        true
    }

    /// Writes the chord bounds: an eighth of the second derivative times the squared step, plus the
    /// slope times the deviation of the driver.
    fn write_bounds(&self, state: &BlockState<'_>, step: &mut Step<'_>) {
        let bounds = &mut *step.bounds;
        let driver = self.crossing.driver.index();
        let way = state.drivers[driver] - self.value;
        let bodies = state.system.mechanism().bodies.len();
        let driver_deviation = bounds.drivers[driver];
        // Angles first: the turn of a body moves its pivot.
        for angles in [true, false] {
            for (local, &column) in self.block.columns().iter().enumerate() {
                if state.system.is_angle(column) != angles {
                    continue;
                }
                let (body, before) = (column / 3, step.from[column]);
                let now = state.at.coordinate(column);
                let [slope, bend] = self.crossing.steepest(local);
                let deviation = 0.125 * bend * way * way
                    + slope * driver_deviation
                    + POLYNOMIAL_ROUNDING * (1.0 + before.abs() + now.abs());
                if angles && body < bodies {
                    bounds.set_spread(body, f64::INFINITY);
                    let (sin, cos) = before.sin_cos();
                    *bounds.body_mut(body) = ChordBound {
                        cos,
                        sin,
                        ..ChordBound::default()
                    };
                }
                let pivot = if angles { None } else { step.pivots.of(body) };
                if let Some(pivot) = pivot {
                    let bound = bounds.body_mut(body);
                    bound.point_deviation = bound
                        .point_deviation
                        .max(1.5 * deviation + bound.arc_deviation(pivot.norm()));
                } else {
                    bounds.set_unknown(column, now - before, deviation);
                }
            }
        }
    }
}

impl SolveBlock for InterpolatedBlock {
    fn rows(&self) -> &[usize] {
        self.block.rows()
    }

    fn columns(&self) -> &[usize] {
        self.block.columns()
    }

    fn work(&self) -> f64 {
        self.block.work()
    }

    /// Moves to the driver's value. The crossing is one motion from end to end and needs neither
    /// prediction nor proof.
    fn step(
        &mut self,
        state: &mut BlockState<'_>,
        step: &mut Step<'_>,
    ) -> Result<Correction, Rejected> {
        let correction = self
            .interpolate(state)
            .map_err(|Rejected| step.bounds.reject())?;
        self.write_bounds(state, step);
        self.factorise(state)?;
        Ok(correction)
    }

    fn close(
        &mut self,
        state: &mut BlockState<'_>,
        _limits: Limits,
    ) -> Result<Correction, Rejected> {
        self.interpolate(state)
    }

    /// Factorises the block's own equations for their condition alone; at the change point itself
    /// the condition is zero.
    fn factorise(&mut self, state: &mut BlockState<'_>) -> Result<(), Rejected> {
        self.value = state.drivers[self.crossing.driver.index()];
        self.singular = self.block.factorise(state).is_err();
        Ok(())
    }

    /// Multiplies the derivatives in the driver's value with the driver's rates.
    fn solve_rates(&mut self, state: &mut BlockState<'_>, drivers: &[Jet]) {
        let driver = self.crossing.driver.index();
        let (value, rates) = (state.drivers[driver], drivers[driver]);
        let (velocity, acceleration) = state.tangent.both_mut();
        for (local, &column) in self.block.columns().iter().enumerate() {
            let [_, first, second] = self.crossing.evaluate(local, value);
            velocity[column] = first * rates.first();
            acceleration[column] = first * rates.second() + second * rates.first() * rates.first();
        }
    }

    /// Returns the condition of the block's own equations.
    fn rcond(&mut self) -> f64 {
        if self.singular {
            0.0
        } else {
            self.block.rcond()
        }
    }

    fn keeps_pivots(&self) -> bool {
        self.block.keeps_pivots()
    }

    fn copy_choices(&self, to: &mut BlockChoices) {
        self.block.copy_choices(to);
    }

    fn take_choices(&mut self, from: &BlockChoices) -> bool {
        self.block.take_choices(from)
    }

    fn forget_pivots(&mut self) {
        self.block.forget_pivots();
    }
}

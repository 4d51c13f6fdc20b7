//! The changes of a free motion along directions at an event, whose instant moves with them.
//!
//! A mode ends where a function g of the motion is zero. Along a direction its instant moves by
//! δt = −δg/ġ. With the motion x⁻ before and x⁺ = R(x⁻) behind, and the rates ẋ on both sides,
//!
//! > δx⁺ = ∂R (δx⁻ + ẋ⁻ δt) − ẋ⁺ δt
//!
//! by the saltation matrix of Aizerman and Gantmakher. Where no contact strikes, R is the identity. A strike
//! changes velocities by J Δv = Aᵀ P, and those of the coordinates c that push to ċ⁺ = −e ċ⁻, so that
//!
//! > J δΔv − Aᵀ δP = −(δJ Δv − δAᵀ P), A δv⁺ = −δA v⁺ − e δċ⁻ − δe ċ⁻.

use nalgebra::DVector;

use super::equations::Equations;
use super::error::Error;
use super::function::FUNCTIONS;
use super::given::Given;
use super::passive::Mode;
use super::strike::{Push, Strike};
use super::triangular::{ascend, descend, factorise};
use crate::kinematics::{Direction, ForceQuantity, KnownMotion, Rates, Solver};
use crate::mechanism::{Dual, Jet, ParameterId};

/// Part by which the instants of functions that end at once may differ along a direction: far above the
/// rounding of their changes.
const SAME_INSTANT: f64 = 1e-6;

const JUMP: &str = "where the value of a force jumps";
const GRAZING: &str = "where something hardly comes about: its instant has no derivative";
const COINCIDENCE: &str =
    "where several things happen at once that come apart as parameters change";
const UNEQUAL: &str = "where contacts of different `restitution` are struck at once";

impl Equations {
    /// Moves the changes in x to the instant of the event at the accepted point, and returns how much later
    /// it is along each direction \[s per unit\].
    ///
    /// # Errors
    ///
    /// [`Error::NoDerivatives`] where there is no such instant.
    pub(super) fn reach_event(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        x: &mut [f64],
    ) -> Result<Vec<f64>, Error> {
        if self.directions.is_empty() {
            return Ok(Vec::new());
        }
        let time = solver.pose().time;
        if self.turns.jumps {
            return Err(Error::NoDerivatives { time, reason: JUMP });
        }
        self.strikes.clear();
        let mut rates = Rates::new(solver.pose().q.len());
        let varied = self.varied(solver, x, &mut rates)?;
        let mut flow = self.drift(solver, given, time);
        for freedom in &self.freedoms {
            let [velocity, acceleration] = self.point.drivers[freedom.index()].derivatives;
            flow.drivers[freedom.index()] = Jet::new(velocity, [acceleration, 0.0]);
        }
        let mut delays: Option<Vec<f64>> = None;
        for index in self.watch.ended.clone() {
            let Some(rate) = self.function_change(solver, &rates, &flow, index)? else {
                continue;
            };
            let mut own = Vec::with_capacity(varied.len());
            for direction in &varied {
                let change = self.function_change(solver, &rates, direction, index)?;
                own.push(-change.unwrap_or(0.0) / rate);
            }
            if !own.iter().all(|delay| delay.is_finite()) {
                return Err(Error::NoDerivatives {
                    time,
                    reason: GRAZING,
                });
            }
            let same = |(one, other): (&f64, &f64)| {
                (one - other).abs() <= SAME_INSTANT * one.abs().max(other.abs())
            };
            if !delays.get_or_insert(own.clone()).iter().zip(&own).all(same) {
                return Err(Error::NoDerivatives {
                    time,
                    reason: COINCIDENCE,
                });
            }
        }
        let delays = delays.unwrap_or_else(|| vec![0.0; varied.len()]);
        self.shift(&delays, x);
        Ok(delays)
    }

    /// Carries the changes in x, whose other values are those behind the event, over its strikes and to the
    /// time of the event.
    ///
    /// # Errors
    ///
    /// Those of [`reach_event`](Self::reach_event).
    pub(super) fn leave_event(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        delays: &[f64],
        x: &mut [f64],
    ) -> Result<(), Error> {
        if self.directions.is_empty() {
            return Ok(());
        }
        for strike in std::mem::take(&mut self.strikes) {
            self.carry(solver, given, &strike, delays, x)?;
        }
        self.evaluate(solver, given, solver.pose().time, x)?;
        let back: Vec<f64> = delays.iter().map(|delay| -delay).collect();
        self.shift(&back, x);
        Ok(())
    }

    /// Moves the changes in x along the motion at the present point, by these times.
    fn shift(&self, delays: &[f64], x: &mut [f64]) {
        let count = self.freedoms.len();
        let changes = x[2 * count + 1..].chunks_exact_mut(2 * count);
        for (changes, delay) in changes.zip(delays) {
            for (k, freedom) in self.freedoms.iter().enumerate() {
                let [velocity, acceleration] = self.point.drivers[freedom.index()].derivatives;
                changes[k] += velocity * delay;
                changes[count + k] += acceleration * delay;
            }
        }
    }

    /// Returns the change of a function that has ended a mode, along a direction; `None` where the motion and
    /// its rates do not depend on its instant: a contact is left, and an elastic stop becomes loose, where
    /// their forces are zero.
    fn function_change(
        &mut self,
        solver: &mut Solver,
        rates: &Rates,
        direction: &Direction,
        index: usize,
    ) -> Result<Option<f64>, Error> {
        let (force, side) = (index / FUNCTIONS, index % FUNCTIONS);
        let Self { passive, point, .. } = &*self;
        let Some(function) = passive.function(force, &point.passive[force], side) else {
            return Ok(None);
        };
        if function.rates[0].is_some() {
            let own = &passive.list[force];
            let along = solver.sensitivity(rates, &point.drivers, direction)?;
            let change = along.coordinate(&*own.relation);
            if function.gap.is_none() {
                return Ok(Some(change.first()));
            }
            let parameters = along.parameter_values();
            let limits = own
                .cause
                .limits(solver, &|id: ParameterId| parameters[id.index()]);
            let limit = match passive.modes[force] {
                Mode::AtMin | Mode::LooseAtMin => limits[0],
                Mode::AtMax | Mode::LooseAtMax => limits[1],
                _ => limits[side],
            };
            return Ok(Some(change.value - limit.first()));
        }
        if passive.list[force].cause.friction().is_none() {
            return Ok(None);
        }
        let mut direction = direction.clone();
        self.complete(solver, rates, &mut direction)?;
        let motion = KnownMotion {
            rates,
            driver_rates: &self.point.drivers,
            inputs: &self.point.loads,
        };
        let forces = solver.force_sensitivity(motion, &direction, &mut self.forces)?;
        let along = solver.sensitivity(rates, &self.point.drivers, &direction)?;
        let parameter = |id: ParameterId| along.parameter_value(id);
        let limit = self.passive.bound_change(force, &parameter, &forces);
        let change = direction.loads[self.inputs() + force];
        Ok(Some(if side == 0 {
            change + limit
        } else {
            change - limit
        }))
    }

    /// Carries the changes of velocities in x, which belong to the instant of the event, over a strike.
    fn carry(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        Strike { velocities, pushes }: &Strike,
        delays: &[f64],
        x: &mut [f64],
    ) -> Result<(), Error> {
        let count = self.freedoms.len();
        let directions = self.delayed(solver, given, delays, x);
        let [before, after] = velocities;
        let jump: Vec<f64> = after.iter().zip(before).map(|(b, a)| b - a).collect();
        let rest = vec![0.0; count];
        let struck = self.moving(solver, before, &jump)?;
        let [before, after] = [before, after].map(|v| self.moving(solver, v, &rest));
        let (before, after) = (before?, after?);
        let (mut without, of_passive) = (self.point.loads.clone(), self.inputs());
        without[of_passive..].fill(0.0);
        let mut with = without.clone();
        for push in pushes {
            with[of_passive + push.force] = push.impulse;
        }
        let some: Vec<usize> = pushes.iter().map(|push| push.force).collect();
        let columns = self.passive.columns(&some, &self.freedoms, &self.factor);
        let mut compliance = columns.transpose() * &columns;
        factorise(&mut compliance, some.len());
        for (place, direction) in directions.iter().enumerate() {
            let mut changes = DVector::zeros(count);
            for (sign, (rates, drivers), loads) in
                [(-1.0, &struck, &with), (1.0, &before, &without)]
            {
                let motion = KnownMotion {
                    rates,
                    driver_rates: drivers,
                    inputs: loads,
                };
                let forces = solver.force_sensitivity(motion, direction, &mut self.forces)?;
                for (change, freedom) in changes.iter_mut().zip(&self.freedoms) {
                    *change += sign * forces.change(ForceQuantity::Effort(*freedom))?;
                }
            }
            descend(&self.factor, changes.as_mut_slice());
            let of_before = self.coordinate_rates(solver, &before, direction, &some)?;
            let of_after = self.coordinate_rates(solver, &after, direction, &some)?;
            let parameter = |id: ParameterId| of_before.1[id.index()];
            let mut impulses = Vec::with_capacity(some.len());
            for (k, push) in pushes.iter().enumerate() {
                let part = self.restitution(solver, push, &parameter)?;
                let wanted =
                    -part.value * of_before.0[k] - part.first() * push.rate - of_after.0[k];
                impulses.push(wanted - columns.column(k).dot(&changes));
            }
            descend(&compliance, &mut impulses);
            ascend(&compliance, &mut impulses);
            changes += &columns * DVector::from_vec(impulses);
            ascend(&self.factor, changes.as_mut_slice());
            let first = 2 * count + 1 + 2 * count * place + count;
            for (x, change) in x[first..first + count].iter_mut().zip(&changes) {
                *x += change;
            }
        }
        Ok(())
    }

    /// Returns the part of the rate with which a contact has bounced, with its change.
    fn restitution(
        &self,
        solver: &Solver,
        push: &Push,
        parameter: &impl Fn(ParameterId) -> Dual,
    ) -> Result<Dual, Error> {
        let Some(part) = push.restitution else {
            return Ok(Dual::constant(0.0));
        };
        let cause = &self.passive.list[push.force].cause;
        let own = cause.restitution(solver.mechanism(), parameter);
        if own.value.to_bits() == part.to_bits() {
            return Ok(own);
        }
        let time = solver.pose().time;
        let reason = UNEQUAL;
        Err(Error::NoDerivatives { time, reason })
    }

    /// Returns the directions with the changes in x, which are later by these times.
    fn delayed(
        &mut self,
        solver: &Solver,
        given: &impl Given,
        delays: &[f64],
        x: &[f64],
    ) -> Vec<Direction> {
        let (count, time) = (self.freedoms.len(), solver.pose().time);
        self.set_drivers(solver, given, time, x);
        let flow = self.drift(solver, given, time);
        let mut directions = self.directions.clone();
        let changes = x[2 * count + 1..].chunks_exact(2 * count);
        for ((direction, delay), changes) in directions.iter_mut().zip(delays).zip(changes) {
            direction.time += delay;
            for (own, flow) in direction.drivers.iter_mut().zip(&flow.drivers) {
                own.value += flow.value * delay;
                own.derivatives[0] += flow.first() * delay;
            }
            for (k, freedom) in self.freedoms.iter().enumerate() {
                let change = Jet::new(changes[k], [changes[count + k], 0.0]);
                direction.drivers[freedom.index()] = change;
            }
        }
        directions
    }

    /// Returns the rates of q and of the drivers for velocities and accelerations of the freedoms, while no
    /// other driver accelerates.
    fn moving(
        &self,
        solver: &mut Solver,
        velocities: &[f64],
        accelerations: &[f64],
    ) -> Result<(Rates, Vec<Jet>), Error> {
        let still = self.point.drivers.iter();
        let still = still.map(|driver| Jet::new(driver.value, [driver.first(), 0.0]));
        let mut drivers: Vec<Jet> = still.collect();
        let free = velocities.iter().zip(accelerations);
        for (freedom, (velocity, acceleration)) in self.freedoms.iter().zip(free) {
            drivers[freedom.index()].derivatives = [*velocity, *acceleration];
        }
        let mut rates = Rates::new(solver.pose().q.len());
        solver.solve_rates(|driver| drivers[driver.index()], &mut rates)?;
        Ok((rates, drivers))
    }

    /// Returns the changes of the rates of some passive forces' coordinates along a direction, and all
    /// parameters with theirs.
    fn coordinate_rates(
        &self,
        solver: &mut Solver,
        (rates, drivers): &(Rates, Vec<Jet>),
        direction: &Direction,
        some: &[usize],
    ) -> Result<(Vec<f64>, Vec<Dual>), Error> {
        let along = solver.sensitivity(rates, drivers, direction)?;
        let relations = some.iter().map(|&k| &*self.passive.list[k].relation);
        let changes = relations.map(|relation| along.rate(relation).first());
        Ok((changes.collect(), along.parameter_values()))
    }
}

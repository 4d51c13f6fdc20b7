//! The least move that brings parts apart which overlap, at a start or where inputs or parameters jump.

use super::equations::Equations;
use super::error::Error;
use super::given::Given;
use super::overlap::{Overlap, describe, own_kind};
use super::passive::{Mode, PLACE_ROUNDING};
use super::settle::Touch;
use super::triangular::ascend;
use crate::kinematics::{Rates, Solver};
use crate::mechanism::{Mechanism, Order, Signal, show_time};

/// Depth from which an overlap is told, in gaps that are rounding: 1e-10 radians or sizes of the mechanism.
/// Halved or doubled, a start that is given with ten digits is told, or one that is wrong in the ninth is
/// not.
pub(super) const TOLD: f64 = 1e4;
/// Newton iterations, far more than a start in reach takes: each squares what is left.
const MOST_ITERATIONS: usize = 20;

impl Equations {
    /// Moves parts that overlap apart: freedoms by the least changes in the metric of their inertia, so
    /// that no coordinate is beyond a rigid stop or a limit of its joint. With the gaps g of all limits,
    /// G = ∂g/∂u and the inertia J
    ///
    /// > Δu = J⁻¹ Gᵀ P, G Δu + g ≥ 0, P ≥ 0, P = 0 where a gap stays open
    ///
    /// which is repeated at the new pose until no gap is negative. What sticks then does so at a new
    /// place. Returns what overlapped, unless by as little as a host that integrates misses an instant.
    ///
    /// # Errors
    ///
    /// The freedoms cannot bring the parts apart.
    pub(super) fn push_out(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        time: f64,
        x: &mut [f64],
    ) -> Result<Option<Overlap>, Error> {
        let count = self.freedoms.len();
        let depths = self.depths(solver.mechanism(), TOLD);
        if depths.is_empty() && self.depths(solver.mechanism(), 1.0).is_empty() {
            return Ok(None);
        }
        let before = self.own_values(solver);
        for _ in 0..MOST_ITERATIONS {
            if self.depths(solver.mechanism(), 1.0).is_empty() {
                break;
            }
            let limits = self.limits(solver.mechanism());
            let (touches, gaps): (Vec<Touch>, Vec<f64>) = limits.unzip();
            let pressed = self.press(solver, (&touches, &[]), &[], &gaps, Order::Position);
            let Ok(press) = pressed else {
                break;
            };
            let mut changes = &press.columns * &press.forces;
            ascend(self.factor(), changes.as_mut_slice());
            for (x, change) in x[..count].iter_mut().zip(&changes) {
                *x += change;
            }
            self.passive.anchors.fill(f64::INFINITY);
            self.evaluate(solver, given, time, x)?;
        }
        self.release(solver, given, time, x)?;
        let left = self.depths(solver.mechanism(), TOLD);
        if !left.is_empty() {
            return Err(Error::Blocked(format!(
                "at t = {} s {}, and no motion of the freedoms brings them apart",
                show_time(time),
                describe(&left, solver.mechanism())
            )));
        }
        if depths.is_empty() {
            return Ok(None);
        }
        let after = self.own_values(solver);
        let moves = self.freedoms.iter().zip(before.into_iter().zip(after));
        let moves = moves.filter_map(|(freedom, ([scale, before], [_, after]))| {
            let is_moved = (after - before).abs() > TOLD * PLACE_ROUNDING * scale;
            is_moved.then_some((*freedom, [before, after]))
        });
        Ok(Some(Overlap {
            time,
            depths,
            moves: moves.collect(),
        }))
    }

    /// Returns the limits of all contacts, with their gaps: zero down to where an impact may end a flight.
    fn limits(&self, mechanism: &Mechanism) -> impl Iterator<Item = (Touch, f64)> {
        let passive = self.passive.list.iter().zip(&self.point.passive);
        let contacts = passive
            .enumerate()
            .filter(|(_, (own, _))| mechanism.forces[own.index].load.is_contact());
        contacts.flat_map(|(force, (_, at))| {
            let sides = [Mode::AtMin, Mode::AtMax].into_iter().zip(at.gaps());
            let limited = sides.filter(|(_, gap)| gap.is_finite());
            limited.map(move |(side, gap)| {
                let is_beyond = gap < -at.gap_rounding();
                let gap = if is_beyond { gap } else { gap.max(0.0) };
                (Touch { force, side }, gap)
            })
        })
    }

    /// Returns the coordinates that are beyond a limit by more than so many roundings: the index of each
    /// force in the mechanism, and the depth.
    fn depths(&self, mechanism: &Mechanism, roundings: f64) -> Vec<(usize, f64)> {
        let beyond = self.limits(mechanism).filter_map(|(touch, gap)| {
            let is_beyond = gap < -roundings * self.at(touch).gap_rounding();
            is_beyond.then_some((self.passive.list[touch.force].index, -gap))
        });
        beyond.collect()
    }

    /// Returns the file's freedoms, whatever the coordinates in use: the natural size and the value of
    /// each.
    fn own_values(&self, solver: &Solver) -> Vec<[f64; 2]> {
        let still = Rates::new(solver.pose().q.len());
        let values = self.freedoms.iter().map(|freedom| {
            let driver = &solver.mechanism().drivers[freedom.index()];
            let signal = Signal::Motion(*freedom);
            let value = solver.signal(signal, &still, &self.point.drivers).value;
            let scale = if own_kind(driver).is_angle() {
                1.0
            } else {
                solver.size()
            };
            [scale, value]
        });
        values.collect()
    }
}

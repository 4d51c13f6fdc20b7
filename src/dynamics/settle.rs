//! The modes of passive forces after an event.

use super::equations::Equations;
use super::error::Error;
use super::event::{Event, EventKind};
use super::given::Given;
use super::overlap::Overlap;
use super::passive::{Mode, Passive};
use crate::kinematics::Solver;
use crate::mechanism::Order;

/// Corrections of held coordinates: two suffice where they are nearly linear, as over a step; a start may
/// be farther away.
const MOST_CORRECTIONS: usize = 20;

/// A contact that is touched, on one side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// Index of the passive force.
    pub(super) force: usize,
    /// [`Mode::AtMin`] or [`Mode::AtMax`].
    pub(super) side: Mode,
}

impl Equations {
    /// Moves held coordinates to where they are held, and lets them rest, by the least changes of the
    /// freedoms in the metric of their inertia.
    pub(super) fn project(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        time: f64,
        x: &mut [f64],
    ) -> Result<(), Error> {
        if !self.passive.holds() {
            return Ok(());
        }
        self.project_places(solver, given, time, x)?;
        let count = self.freedoms.len();
        self.correct(Order::Velocity, &mut x[count..2 * count]);
        Ok(())
    }

    /// Moves held coordinates to where they are held.
    fn project_places(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        time: f64,
        x: &mut [f64],
    ) -> Result<(), Error> {
        let count = self.freedoms.len();
        for _ in 0..MOST_CORRECTIONS {
            self.evaluate(solver, given, time, x)?;
            let Self { passive, point, .. } = self;
            let is_there = |k: usize| {
                let at = &point.passive[k];
                at.is_dependent
                    || (passive.anchors[k] - at.coordinate.value).abs() <= 0.1 * at.gap_rounding()
            };
            if (0..point.passive.len()).all(|k| !passive.is_held(k) || is_there(k)) {
                break;
            }
            self.correct(Order::Position, &mut x[..count]);
        }
        Ok(())
    }

    /// Decides the modes of all passive forces at the solver's pose: moves parts that overlap apart, lets
    /// contacts bounce or rest, and friction stick or slide. Changes values and velocities in `x`; the
    /// equations have to be evaluated again.
    ///
    /// # Errors
    ///
    /// [`Error::Stop`] at a stop of a coordinate that no freedom moves.
    pub(super) fn settle(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        x: &mut [f64],
        events: &mut Vec<Event>,
        overlaps: &mut Vec<Overlap>,
    ) -> Result<(), Error> {
        if self.passive.is_empty() {
            return Ok(());
        }
        let time = solver.pose().time;
        self.watch.begin();
        let before = self.passive.modes.clone();
        self.evaluate(solver, given, time, x)?;
        self.release(solver, given, time, x)?;
        overlaps.extend(self.push_out(solver, given, time, x)?);
        let rest = self.bounce(solver, given, time, x, events)?;
        self.choose(solver, given, time, x, &before)?;
        self.project(solver, given, time, x)?;
        for k in 0..before.len() {
            let (from, to) = (before[k], self.passive.modes[k]);
            let own = &self.passive.list[k];
            let event = own.cause.event(from, to, &self.point.passive[k]);
            let later = rest[own.group.clone()].iter().copied().fold(0.0, f64::max);
            // A contact that was touched at another place rests where it ceases to change them.
            let tells = || self.tells(k, &before) || later > 0.0 && own.group.len() > 1;
            let Some(kind) = event.filter(|_| from != to && tells()) else {
                continue;
            };
            let later = if kind == EventKind::Rests { later } else { 0.0 };
            events.push(Event {
                time: time + later,
                force: self.passive.told(k),
                kind,
            });
        }
        Ok(())
    }

    /// Returns whether the change of a passive force is one of its contact: the first place that touches, or
    /// the last one that is left.
    fn tells(&self, force: usize, before: &[Mode]) -> bool {
        let group = self.passive.list[force].group.clone();
        if group.len() == 1 {
            return true;
        }
        let now = &self.passive.modes;
        let touches = |modes: &[Mode]| modes[group.clone()].iter().any(|mode| *mode != Mode::Free);
        let mut changed = group.clone().filter(|&k| before[k] != now[k]);
        touches(before) != touches(now) && changed.next() == Some(force)
    }

    /// Opens all contacts, and leaves friction undecided where its coordinate rests; elsewhere it slides
    /// as the coordinate does. Evaluates the equations so.
    pub(super) fn release(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        time: f64,
        x: &[f64],
    ) -> Result<(), Error> {
        let Self { passive, point, .. } = self;
        let modes = passive.modes.iter_mut().zip(&passive.list);
        for ((mode, own), at) in modes.zip(&point.passive) {
            *mode = own.cause.released(solver, at);
        }
        self.evaluate(solver, given, time, x)
    }

    /// Returns what is touched at the present point.
    pub(super) fn touches(&self) -> Vec<Touch> {
        let all = self
            .passive
            .list
            .iter()
            .zip(&self.point.passive)
            .enumerate();
        let touches = all.flat_map(|(force, (own, at))| {
            let sides = own.cause.touched(at).into_iter().flatten();
            sides.map(move |side| Touch { force, side })
        });
        touches.collect()
    }

    /// Returns the passive force of a contact at the present point.
    pub(super) fn at(&self, touch: Touch) -> &Passive {
        &self.point.passive[touch.force]
    }

    /// Returns the speed at which a contact opens, negative where it closes, and the acceleration.
    pub(super) fn opening(&self, touch: Touch) -> [f64; 2] {
        self.at(touch).opening(touch.side)
    }
}

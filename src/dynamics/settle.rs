//! Events: impacts, and the modes of passive forces after them.

use nalgebra::{DMatrix, DVector};

use super::bounded;
use super::equations::Equations;
use super::error::Error;
use super::given::Given;
use super::passive::{Cause, Mode};
use super::triangular::ascend;
use crate::kinematics::{Solver, StopLimit};
use crate::mechanism::{Force, JointKind, Mechanism, Order, PassiveCause, fixed, shown};

/// Height of a bounce at which bouncing ends, in gaps that are rounding: some roundings of a place.
const LOWEST_BOUNCE: f64 = 1.0 / 16.0;
/// Height from which a fall ends at rest, in the same unit: below that of all bounces.
const LOWEST_FALL: f64 = 1.0 / 64.0;
/// Impacts at one instant, far more than several contacts make.
const MOST_IMPACTS: usize = 100;
/// A speed of so many roundings may be rest: 1e-8 radians or sizes of the mechanism per second. The
/// instant of an event is not known much better.
pub(super) const SLOW: f64 = 1e6;
/// Corrections of held coordinates: two suffice where they are nearly linear, as over a step; a start may
/// be farther away.
const MOST_CORRECTIONS: usize = 20;

/// An event of a free motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Time \[s\].
    pub time: f64,
    /// Index of the force of the stop or of friction in the mechanism.
    pub force: usize,
    /// Its kind.
    pub kind: EventKind,
}

/// Kinds of events.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventKind {
    /// A coordinate meets a stop.
    Impact {
        /// Speed before \[m/s or rad/s\].
        speed: f64,
    },
    /// A coordinate comes to rest at a stop: after the last bounce, if it bounces.
    Rests,
    /// A coordinate leaves a stop at which it rested.
    Leaves,
    /// Friction begins to stick.
    Sticks,
    /// Friction ceases to stick.
    Slides,
}

impl Event {
    /// Describes the event, with its time.
    #[must_use]
    pub fn describe(&self, mechanism: &Mechanism) -> String {
        let Force { name, load, .. } = &mechanism.forces[self.force];
        let coordinate = load.coordinate();
        let coordinate = coordinate.expect("events are those of passive forces");
        let joint = load.play().map(|joint| &mechanism.joints[joint].kind);
        let speed = |speed| {
            let unit = coordinate.kind.units()[1].suffix();
            format!("{}{unit}", shown(speed))
        };
        let happens = match (self.kind, joint) {
            (EventKind::Impact { speed: before }, None) => {
                format!("impact at stop `{name}` with {}", speed(before))
            }
            (EventKind::Rests, None) => format!("rest at stop `{name}`"),
            (EventKind::Leaves, None) => format!("stop `{name}` is left"),
            (EventKind::Impact { speed: before }, Some(JointKind::Rope(_))) => {
                format!("rope `{name}` pulls taut with {}", speed(before))
            }
            (EventKind::Rests, Some(JointKind::Rope(_))) => format!("rope `{name}` is taut"),
            (EventKind::Leaves, Some(JointKind::Rope(_))) => format!("rope `{name}` goes slack"),
            (EventKind::Impact { speed: before }, Some(_)) => {
                format!("the parts of joint `{name}` meet with {}", speed(before))
            }
            (EventKind::Rests, Some(_)) => format!("the parts of joint `{name}` touch"),
            (EventKind::Leaves, Some(_)) => format!("the parts of joint `{name}` part"),
            (EventKind::Sticks, _) => format!("friction `{name}` sticks"),
            (EventKind::Slides, _) => format!("friction `{name}` slides"),
        };
        format!("t = {} s: {happens}", fixed(self.time, 9))
    }
}

/// A stop that something touches, on one side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// Index of the passive force.
    pub(super) force: usize,
    pub(super) mode: Mode,
}

/// A contact at an impact.
struct Hit {
    contact: Contact,
    /// Speed before \[m/s or rad/s\].
    speed: f64,
    restitution: f64,
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
                (passive.anchors[k] - at.coordinate.value).abs() <= 0.1 * at.rounding
            };
            if (0..point.passive.len()).all(|k| !passive.is_held(k) || is_there(k)) {
                break;
            }
            self.correct(Order::Position, &mut x[..count]);
        }
        Ok(())
    }

    /// Moves coordinates that are beyond a rigid stop by as much as rounding back to it, as a host finds
    /// an instant less well; what sticks then does so at a new place.
    fn push_out(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        time: f64,
        x: &mut [f64],
    ) -> Result<(), Error> {
        for Contact { force, mode } in self.contacts() {
            let at = &self.point.passive[force];
            let limit = at.bounds[usize::from(mode == Mode::AtMax)];
            if mode.sign() * (at.coordinate.value - limit) < -0.9 * at.rounding {
                self.passive.modes[force] = mode;
                self.passive.anchors[force] = limit;
            }
        }
        if self.passive.holds() {
            self.project_places(solver, given, time, x)?;
            self.passive.anchors.fill(f64::INFINITY);
            self.release(solver, given, time, x)?;
        }
        Ok(())
    }

    /// Decides the modes of all passive forces at the solver's pose: lets contacts bounce or rest, and
    /// friction stick or slide. Changes values and velocities in `x`; the equations have to be evaluated
    /// again.
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
    ) -> Result<(), Error> {
        if self.passive.is_empty() {
            return Ok(());
        }
        let time = solver.pose().time;
        self.watch.begin();
        let before = self.passive.modes.clone();
        self.evaluate(solver, given, time, x)?;
        self.release(solver, given, time, x)?;
        self.push_out(solver, given, time, x)?;
        let rest = self.bounce(solver, given, time, x, events)?;
        self.choose(solver, given, time, x, &before)?;
        self.project(solver, given, time, x)?;
        for (k, before) in before.into_iter().enumerate() {
            let after = self.passive.modes[k];
            let kind = match (before, after) {
                _ if before == after => continue,
                (Mode::LooseAtMin | Mode::LooseAtMax, Mode::AtMin | Mode::AtMax)
                | (_, Mode::LooseAtMin | Mode::LooseAtMax) => continue,
                (_, Mode::AtMin | Mode::AtMax) if !self.passive.is_held(k) => EventKind::Impact {
                    speed: self.point.passive[k].coordinate.first().abs(),
                },
                (_, Mode::AtMin | Mode::AtMax) => EventKind::Rests,
                (Mode::AtMin | Mode::AtMax | Mode::LooseAtMin | Mode::LooseAtMax, _) => {
                    EventKind::Leaves
                }
                (_, Mode::Sticking) => EventKind::Sticks,
                (Mode::Sticking, _) => EventKind::Slides,
                _ => continue,
            };
            let later = if kind == EventKind::Rests {
                rest[k]
            } else {
                0.0
            };
            events.push(Event {
                time: time + later,
                force: self.passive.list[k].index,
                kind,
            });
        }
        Ok(())
    }

    /// Opens all contacts, and leaves friction undecided where its coordinate rests; elsewhere it slides
    /// as the coordinate does. Evaluates the equations so.
    fn release(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        time: f64,
        x: &[f64],
    ) -> Result<(), Error> {
        let Self { passive, point, .. } = self;
        for (k, at) in point.passive.iter().enumerate() {
            let rate = at.coordinate.first();
            let rests = rate.abs() <= SLOW * at.rounding;
            passive.modes[k] = match passive.list[k].cause {
                Cause::Elastic(_) => at.elastic_mode(),
                Cause::Lawless(PassiveCause::Friction(_)) if !rests && !passive.is_driven[k] => {
                    match rate > 0.0 {
                        true => Mode::Growing,
                        false => Mode::Falling,
                    }
                }
                Cause::Lawless(_) => Mode::Free,
            };
        }
        self.evaluate(solver, given, time, x)
    }

    /// Returns the contacts at the present point.
    pub(super) fn contacts(&self) -> Vec<Contact> {
        let passive = self.point.passive.iter().enumerate();
        let sides = passive.flat_map(|(force, at)| {
            let value = at.coordinate.value;
            let [least, most] = at.bounds;
            let is_contact = self.passive.list[force].cause.is_contact();
            let sides = [(Mode::AtMin, value - least), (Mode::AtMax, most - value)];
            let near = sides
                .into_iter()
                .filter(move |(_, gap)| is_contact && *gap <= 4.0 * at.rounding);
            near.map(move |(mode, _)| Contact { force, mode })
        });
        sides.collect()
    }

    /// Returns the speed at which a contact opens, negative where it closes, and the acceleration.
    pub(super) fn opening(&self, Contact { force, mode }: Contact) -> [f64; 2] {
        let rates = self.point.passive[force].coordinate.derivatives;
        rates.map(|rate| mode.sign() * rate)
    }

    /// Returns the speed of a contact that counts as rest: that of the lowest fall, or of as low a rise,
    /// as friction and other contacts may turn the acceleration round.
    pub(super) fn resting_speed(&self, contact: Contact) -> f64 {
        let rounding = self.point.passive[contact.force].rounding;
        let [_, acceleration] = self.opening(contact);
        rounding + (2.0 * LOWEST_FALL * rounding * acceleration.abs()).sqrt()
    }

    /// Lets all contacts that close bounce. Returns how long each passive force goes on bouncing beneath
    /// rounding.
    fn bounce(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        time: f64,
        x: &mut [f64],
        events: &mut Vec<Event>,
    ) -> Result<Vec<f64>, Error> {
        let mut rest = vec![0.0; self.passive.list.len()];
        let mut is_tired = vec![false; rest.len()];
        for impacts in 0..MOST_IMPACTS {
            let contacts = self.contacts();
            let closes =
                |contact: &Contact| self.opening(*contact)[0] < -self.resting_speed(*contact);
            if !contacts.iter().any(closes) {
                if impacts > 0 {
                    // Friction sticks, or turns, where an impact has changed the velocity.
                    self.release(solver, given, time, x)?;
                }
                return Ok(rest);
            }
            let mut hits: Vec<Hit> = contacts
                .iter()
                .map(|&contact| Hit {
                    contact,
                    speed: -self.opening(contact)[0],
                    restitution: match closes(&contact) && !is_tired[contact.force] {
                        true => self.restitution(solver, contact.force),
                        false => 0.0,
                    },
                })
                .collect();
            let start = x.to_vec();
            let energy = self.point.energy;
            let mut impulses = self.strike(solver, &hits, x)?;
            self.evaluate(solver, given, time, x)?;
            if self.point.energy > energy {
                // Contacts of different restitution may gain energy from each other.
                let closing = hits.iter().filter(|hit| hit.speed > 0.0);
                let least = closing.map(|hit| hit.restitution).fold(1.0, f64::min);
                for hit in &mut hits {
                    hit.restitution = hit.restitution.min(least);
                }
                x.copy_from_slice(&start);
                impulses = self.strike(solver, &hits, x)?;
                self.evaluate(solver, given, time, x)?;
            }
            let mut tires = false;
            for hit in hits.iter().filter(|hit| hit.restitution > 0.0) {
                let force = hit.contact.force;
                let [speed, acceleration] = self.opening(hit.contact);
                let lowest = LOWEST_BOUNCE * self.point.passive[force].rounding;
                if acceleration < 0.0 && speed * speed <= -2.0 * acceleration * lowest {
                    // Each bounce lasts 2 v / a, and the next one is slower by the restitution.
                    rest[force] = -2.0 * speed / acceleration / (1.0 - hit.restitution);
                    is_tired[force] = true;
                    tires = true;
                }
            }
            if tires {
                x.copy_from_slice(&start);
                self.evaluate(solver, given, time, x)?;
                continue;
            }
            x[2 * self.freedoms.len()] += self.point.energy - energy;
            let struck = hits.iter().zip(&impulses).filter(|(hit, impulse)| {
                **impulse > 0.0 && hit.speed > 0.0 && !is_tired[hit.contact.force]
            });
            events.extend(struck.map(|(hit, _)| Event {
                time,
                force: self.passive.list[hit.contact.force].index,
                kind: EventKind::Impact { speed: hit.speed },
            }));
        }
        let why = "impacts at one instant come to no end";
        Err(Error::Integrator(format!("t = {time} s: {why}")))
    }

    /// Returns the part of the velocity with which a contact bounces.
    fn restitution(&self, solver: &Solver, force: usize) -> f64 {
        match &self.passive.list[force].cause {
            Cause::Lawless(cause) => {
                cause.restitution(solver.mechanism(), &solver.pose().parameters)
            }
            Cause::Elastic(_) => 0.0,
        }
    }

    /// Changes the velocities in `x` by the impulses of contacts (Newton's law of restitution), and
    /// returns the impulses.
    fn strike(&self, solver: &Solver, hits: &[Hit], x: &mut [f64]) -> Result<Vec<f64>, Error> {
        let count = self.freedoms.len();
        let contacts: Vec<Contact> = hits.iter().map(|hit| hit.contact).collect();
        let rates = hits.iter().map(|hit| -hit.speed * (1.0 + hit.restitution));
        let rates: Vec<f64> = rates.collect();
        let (impulses, columns) = self.press(solver, &contacts, &[], &rates)?;
        let mut changes = &columns * &impulses;
        ascend(self.factor(), changes.as_mut_slice());
        for (x, change) in x[count..2 * count].iter_mut().zip(&changes) {
            *x += change;
        }
        Ok(impulses.as_slice().to_vec())
    }

    /// Returns the error at a stop of a coordinate that no freedom moves.
    fn stop(&self, solver: &Solver, Contact { force, mode }: Contact) -> Error {
        let time = solver.pose().time;
        let Cause::Lawless(PassiveCause::Stop(stop)) = self.passive.list[force].cause else {
            let Force { name, .. } = &solver.mechanism().forces[self.passive.list[force].index];
            return Error::Blocked(format!(
                "at t = {} s the parts of joint `{name}` meet, and no freedom moves them",
                fixed(time, 9)
            ));
        };
        let stop = &solver.mechanism().stops[stop];
        let is_max = mode == Mode::AtMax;
        let value = self.point.passive[force].bounds[usize::from(is_max)];
        Error::Stop {
            limit: Box::new(StopLimit::new(stop, is_max, value)),
            time,
        }
    }

    /// Finds the forces or impulses of contacts, which push, and of friction between its bounds, for these
    /// accelerations or rates without them. Also returns L⁻¹ (∂c/∂u)ᵀ by columns, with c the way by which
    /// a contact opens.
    pub(super) fn press(
        &self,
        solver: &Solver,
        contacts: &[Contact],
        frictions: &[usize],
        rates: &[f64],
    ) -> Result<(DVector<f64>, DMatrix<f64>), Error> {
        let some = contacts.iter().map(|contact| contact.force);
        let some: Vec<usize> = some.chain(frictions.iter().copied()).collect();
        let mut columns = self.passive.columns(&some, &self.freedoms, self.factor());
        for (mut column, contact) in columns.column_iter_mut().zip(contacts) {
            column *= contact.mode.sign();
        }
        let compliance = columns.transpose() * &columns;
        for (k, &contact) in contacts.iter().enumerate() {
            if compliance[(k, k)] == 0.0 && rates[k] < 0.0 {
                return Err(self.stop(solver, contact));
            }
        }
        let pushes = contacts.iter().map(|_| [0.0, f64::INFINITY]);
        let holds = frictions.iter().map(|&k| self.point.passive[k].bounds);
        let bounds: Vec<[f64; 2]> = pushes.chain(holds).collect();
        Ok((bounded::solve(&compliance, rates, &bounds), columns))
    }
}

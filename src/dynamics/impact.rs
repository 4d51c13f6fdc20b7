//! Impacts: the velocities after contacts have closed.
//!
//! Newton's law of restitution as a complementarity problem: with the impulses P ≥ 0 of all contacts that
//! are touched, the speed ċ⁺ at which each opens is at least −e ċ⁻, where it closes, and zero, where it
//! does not; it is more only without an impulse.

use nalgebra::{DMatrix, DVector};

use super::bounded;
use super::equations::Equations;
use super::error::Error;
use super::event::{Event, EventKind, Meeting};
use super::given::Given;
use super::passive::{Mode, TOUCHED};
use super::settle::Touch;
use super::strike::{Push, Strike};
use super::triangular::ascend;
use crate::kinematics::{Solver, StopLimit};
use crate::mechanism::{Dual, Force, Load, Mechanism, Order, ParameterId, PassiveCause, fixed};

/// Height of a bounce at which bouncing ends, in gaps that are rounding: some roundings of a place.
const LOWEST_BOUNCE: f64 = 1.0 / 16.0;
/// Impacts at one instant, far more than several contacts make.
const MOST_IMPACTS: usize = 100;

/// A contact at an impact.
struct Hit {
    touch: Touch,
    /// Speed before \[m/s or rad/s\], and whether it closes the contact.
    speed: f64,
    closes: bool,
    restitution: f64,
    /// Whether it comes to rest, as its bounces are beneath rounding.
    rests: bool,
    /// Whether it only takes over from another place of its contact.
    takes_over: bool,
}

impl Hit {
    /// Returns whether the impact is told, if there is an impulse.
    fn tells(&self) -> bool {
        self.closes && !self.rests && !self.takes_over
    }
}

/// Forces or impulses that act along some coordinates.
pub(super) struct Press {
    pub(super) forces: DVector<f64>,
    /// L⁻¹ (∂c/∂u)ᵀ by columns, with c the way by which a contact opens.
    pub(super) columns: DMatrix<f64>,
}

impl Equations {
    /// Lets all contacts that close bounce. Returns how long each passive force goes on bouncing beneath
    /// rounding.
    pub(super) fn bounce(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        time: f64,
        x: &mut [f64],
        events: &mut Vec<Event>,
    ) -> Result<Vec<f64>, Error> {
        let mut rest = vec![0.0; self.passive.list.len()];
        for impacts in 0..MOST_IMPACTS {
            let touches = self.touches();
            let closes = |touch: &Touch| self.opening(*touch)[0] < -self.at(*touch).resting_speed();
            if !touches.iter().any(closes) {
                if impacts > 0 {
                    // Friction sticks, or turns, where an impact has changed the velocity.
                    self.release(solver, given, time, x)?;
                }
                return Ok(rest);
            }
            let parameters = &solver.pose().parameters;
            let parameter = |id: ParameterId| Dual::constant(parameters[id.index()]);
            let hits = touches.iter().map(|touch| Hit {
                touch: *touch,
                speed: -self.opening(*touch)[0],
                closes: closes(touch),
                restitution: if closes(touch) {
                    let cause = &self.passive.list[touch.force].cause;
                    cause.restitution(solver.mechanism(), &parameter).value
                } else {
                    0.0
                },
                rests: false,
                takes_over: self.takes_over(*touch, &touches),
            });
            let mut hits: Vec<Hit> = hits.collect();
            self.share_restitution(solver.mechanism(), &mut hits);
            let start = x.to_vec();
            let energy = self.point.energy;
            let mut impulses = self.strike(solver, &hits, x)?;
            self.evaluate(solver, given, time, x)?;
            if self.point.energy > energy {
                // Contacts of different restitution may gain energy from each other.
                let closing = hits.iter().filter(|hit| hit.closes);
                let least = closing.map(|hit| hit.restitution).fold(1.0, f64::min);
                for hit in &mut hits {
                    hit.restitution = hit.restitution.min(least);
                }
                impulses = self.strike_again(solver, given, &hits, (time, &start), x)?;
            }
            while self.tire(solver, &mut hits, &mut rest)? {
                impulses = self.strike_again(solver, given, &hits, (time, &start), x)?;
            }
            x[2 * self.freedoms.len()] += self.point.energy - energy;
            self.note_strike(&hits, &impulses, [&start, x]);
            let struck = hits.iter().zip(&impulses);
            let struck = struck.filter(|(hit, impulse)| **impulse > 0.0 && hit.tells());
            let first = events.len();
            for (hit, _) in struck {
                let force = self.passive.told(hit.touch.force);
                let event = events[first..].iter_mut().find(|own| own.force == force);
                match event.map(|own| &mut own.kind) {
                    // A contact is struck once, with the largest of the speeds at its places.
                    Some(EventKind::Impact { speed }) => *speed = speed.max(hit.speed),
                    _ => events.push(Event {
                        time,
                        force,
                        kind: EventKind::Impact { speed: hit.speed },
                    }),
                }
            }
        }
        Err(Error::EndlessImpacts {
            time,
            contacts: self.names(solver, self.touches()),
        })
    }

    /// Returns whether a place of a contact closes as slowly as what counts as touched does, while another
    /// place of it is touched: the contact passes from one to the other.
    fn takes_over(&self, touch: Touch, touches: &[Touch]) -> bool {
        let [speed, acceleration] = self.opening(touch);
        let height = TOUCHED * self.at(touch).gap_rounding();
        let group = &self.passive.list[touch.force].group;
        let is_other = |other: &Touch| other.force != touch.force && group.contains(&other.force);
        speed * speed <= 2.0 * acceleration.abs() * height && touches.iter().any(is_other)
    }

    /// Returns kind and name of contacts, each once.
    fn names(&self, solver: &Solver, touches: impl IntoIterator<Item = Touch>) -> Vec<String> {
        let mechanism = solver.mechanism();
        let names = touches.into_iter().map(|touch| {
            let Force { name, load, .. } = &mechanism.forces[self.passive.list[touch.force].index];
            let kind = match Meeting::of(load, mechanism) {
                Meeting::Stop(kind) => kind,
                Meeting::Rope | Meeting::Parts => "joint",
            };
            format!("{kind} `{name}`")
        });
        let mut names: Vec<String> = names.collect();
        names.dedup();
        names
    }

    /// Lets stops of one coordinate that are met together bounce with the smallest of their
    /// restitutions.
    fn share_restitution(&self, mechanism: &Mechanism, hits: &mut [Hit]) {
        let place = |hit: &Hit| {
            let force = &mechanism.forces[self.passive.list[hit.touch.force].index];
            (force.load.play(), force.load.coordinate(), hit.touch.side)
        };
        for k in 0..hits.len() {
            let same = hits.iter().filter(|hit| place(hit) == place(&hits[k]));
            let least = same.map(|hit| hit.restitution).fold(1.0, f64::min);
            hits[k].restitution = least;
        }
    }

    /// Finds the contacts that come to rest after a strike, as they fall back from a height that is
    /// rounding, and returns whether there are more of them; `rest` is the time that their bounces would
    /// still take.
    ///
    /// Each falls as the others let it: on one that rests already, or bounces as low, it falls as if that
    /// were closed, whose impulses are those of its force at rest on an average. What rested before and
    /// is opened by the others stays touched up to a greater height.
    fn tire(&self, solver: &Solver, hits: &mut [Hit], rest: &mut [f64]) -> Result<bool, Error> {
        let openings: Vec<[f64; 2]> = hits.iter().map(|hit| self.opening(hit.touch)).collect();
        let lowest = |hit: &Hit| {
            let height = if hit.closes { LOWEST_BOUNCE } else { TOUCHED };
            height * self.at(hit.touch).gap_rounding()
        };
        let largest = openings.iter().map(|[_, a]| a.abs()).fold(0.0, f64::max);
        let low = hits.iter().zip(&openings).map(|(hit, [speed, _])| {
            let rests = hit.rests || *speed <= self.at(hit.touch).resting_speed();
            rests || speed * speed <= 2.0 * largest * lowest(hit)
        });
        let low: Vec<bool> = low.collect();
        let mut tired = Vec::new();
        for (k, hit) in hits.iter().enumerate() {
            let [speed, acceleration] = openings[k];
            let bounces = hit.restitution > 0.0 || speed > self.at(hit.touch).resting_speed();
            if hit.rests || !low[k] || !bounces {
                continue;
            }
            let others: Vec<usize> = (0..hits.len()).filter(|&j| j != k && low[j]).collect();
            let touches: Vec<Touch> = others.iter().map(|&j| hits[j].touch).collect();
            let rates: Vec<f64> = others.iter().map(|&j| openings[j][1]).collect();
            let press = self.press(solver, (&touches, &[]), &[], &rates, Order::Acceleration)?;
            let own = [hit.touch.force];
            let own = self.passive.columns(&own, &self.freedoms, self.factor());
            let of_others = own.column(0).dot(&(&press.columns * &press.forces));
            let fall = acceleration + hit.touch.side.sign() * of_others;
            if fall < 0.0 && speed * speed <= -2.0 * fall * lowest(hit) {
                // Each bounce lasts 2 v / a, and the next one is slower by the restitution, or as this one is
                // slower than the blow at another place of the contact that has opened it.
                let group = &self.passive.list[hit.touch.force].group;
                let blows = hits
                    .iter()
                    .filter(|other| group.contains(&other.touch.force));
                let blow = blows.filter(|other| other.closes && !hit.closes);
                let slower = blow
                    .map(|other| speed / other.speed)
                    .fold(hit.restitution, f64::max);
                rest[hit.touch.force] = -2.0 * speed / fall / (1.0 - slower);
                tired.push(k);
            }
        }
        for &k in &tired {
            hits[k].rests = true;
        }
        Ok(!tired.is_empty())
    }

    /// Notes a strike between two values of x, if its changes along directions are sought.
    fn note_strike(&mut self, hits: &[Hit], impulses: &[f64], x: [&[f64]; 2]) {
        if self.directions.is_empty() {
            return;
        }
        let pushing = hits.iter().zip(impulses);
        let pushing = pushing.filter(|(_, impulse)| **impulse > 0.0);
        let pushes = pushing.map(|(hit, impulse)| {
            let Touch { force, side } = hit.touch;
            Push {
                force,
                impulse: side.sign() * impulse,
                rate: -side.sign() * hit.speed,
                restitution: (hit.closes && !hit.rests).then_some(hit.restitution),
            }
        });
        let count = self.freedoms.len();
        let strike = Strike {
            velocities: x.map(|x| x[count..2 * count].to_vec()),
            pushes: pushes.collect(),
        };
        self.strikes.push(strike);
    }

    /// Strikes from a start of the velocities.
    fn strike_again(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        hits: &[Hit],
        (time, start): (f64, &[f64]),
        x: &mut [f64],
    ) -> Result<Vec<f64>, Error> {
        x.copy_from_slice(start);
        let impulses = self.strike(solver, hits, x)?;
        self.evaluate(solver, given, time, x)?;
        Ok(impulses)
    }

    /// Changes the velocities in `x` by the impulses of contacts, and returns the impulses. What comes to
    /// rest is held, so that it does not open by what others bring it.
    fn strike(&self, solver: &Solver, hits: &[Hit], x: &mut [f64]) -> Result<Vec<f64>, Error> {
        let count = self.freedoms.len();
        let touches: Vec<Touch> = hits.iter().map(|hit| hit.touch).collect();
        let rests: Vec<bool> = hits.iter().map(|hit| hit.rests).collect();
        let rates = hits.iter().map(|hit| {
            let restitution = if hit.rests { 0.0 } else { hit.restitution };
            -hit.speed * (1.0 + restitution)
        });
        let rates: Vec<f64> = rates.collect();
        let press = self.press(solver, (&touches, &rests), &[], &rates, Order::Velocity)?;
        let mut changes = &press.columns * &press.forces;
        ascend(self.factor(), changes.as_mut_slice());
        for (x, change) in x[count..2 * count].iter_mut().zip(&changes) {
            *x += change;
        }
        Ok(press.forces.as_slice().to_vec())
    }

    /// Returns the error at a stop of a coordinate that no freedom moves.
    fn stop(&self, solver: &Solver, touch: Touch) -> Error {
        let time = solver.pose().time;
        let mechanism = solver.mechanism();
        let Force { name, load, .. } = &mechanism.forces[self.passive.list[touch.force].index];
        let Load::Passive {
            cause: PassiveCause::Stop(stop),
            ..
        } = load
        else {
            return Error::Blocked(format!(
                "at t = {} s the parts of joint `{name}` meet, and no freedom moves them",
                fixed(time, 9)
            ));
        };
        let is_max = touch.side == Mode::AtMax;
        let value = self.at(touch).bounds[usize::from(is_max)];
        Error::Stop {
            limit: Box::new(StopLimit::new(
                mechanism,
                &mechanism.stops[*stop],
                is_max,
                value,
            )),
            time,
        }
    }

    /// Finds the forces or impulses of contacts, which push unless they are held, and of friction between
    /// its bounds, for these accelerations or rates without them.
    ///
    /// # Errors
    ///
    /// [`Error::Stop`] where a contact presses on what does not give way, [`Error::Squeezed`] where shapes are
    /// between several.
    pub(super) fn press(
        &self,
        solver: &Solver,
        (touches, held): (&[Touch], &[bool]),
        frictions: &[usize],
        rates: &[f64],
        order: Order,
    ) -> Result<Press, Error> {
        let some = touches.iter().map(|touch| touch.force);
        let some: Vec<usize> = some.chain(frictions.iter().copied()).collect();
        let mut columns = self.passive.columns(&some, &self.freedoms, self.factor());
        for (mut column, touch) in columns.column_iter_mut().zip(touches) {
            column *= touch.side.sign();
        }
        let compliance = columns.transpose() * &columns;
        let is_held = |k: usize| held.get(k).is_some_and(|held| *held);
        let pushes = (0..touches.len()).map(|k| {
            if is_held(k) {
                [f64::NEG_INFINITY, f64::INFINITY]
            } else {
                [0.0, f64::INFINITY]
            }
        });
        let holds = frictions.iter().map(|&k| self.point.passive[k].bounds);
        let bounds: Vec<[f64; 2]> = pushes.chain(holds).collect();
        let noise = some.iter().map(|&k| self.point.passive[k].slow(order));
        let noise: Vec<f64> = noise.collect();
        let pressed = match bounded::solve(&compliance, rates, &bounds, &noise) {
            Ok(forces) => return Ok(Press { forces, columns }),
            Err(pressed) => pressed,
        };
        let pressed = pressed.into_iter().filter_map(|k| touches.get(k).copied());
        let pressed: Vec<Touch> = pressed.collect();
        let has_shapes = |touch: &Touch| {
            let coordinate = &self.passive.list[touch.force].coordinate;
            coordinate.shapes().is_some()
        };
        let contacts = self.names(solver, pressed.iter().copied());
        if contacts.len() > 1 && pressed.iter().any(has_shapes) {
            let time = solver.pose().time;
            return Err(Error::Squeezed { time, contacts });
        }
        let closing = touches.iter().zip(rates);
        let worst = closing.min_by(|(_, a), (_, b)| a.total_cmp(b));
        let (touch, _) = worst.expect("contacts alone have no bounds");
        Err(self.stop(solver, *touch))
    }
}

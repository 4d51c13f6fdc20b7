//! The choice of what is held: which contacts stay closed, and which friction sticks.

use super::equations::Equations;
use super::error::Error;
use super::given::Given;
use super::impact::Press;
use super::passive::Mode;
use super::settle::Touch;
use crate::kinematics::{self, Solver};
use crate::mechanism::Order;

/// Choices of what sticks, far more than it takes until they agree with the reactions.
const MOST_CHOICES: usize = 10;
/// Combinations of modes that are tried where no choice agrees: those of six forces.
const MOST_TRIED: usize = 729;

impl Equations {
    /// Chooses which contacts stay closed and which friction sticks, by the accelerations.
    ///
    /// The bounds of friction in joints follow from the reactions, and these from the choice: it is made
    /// again until it agrees with them.
    ///
    /// # Errors
    ///
    /// [`NoForce`](crate::kinematics::Error::NoForce) if it never does.
    pub(super) fn choose(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        time: f64,
        x: &[f64],
        before: &[Mode],
    ) -> Result<(), Error> {
        let released = self.passive.modes.clone();
        let in_joint = self
            .passive
            .rubbing
            .iter()
            .find(|(_, joint)| joint.is_some());
        let in_joint = in_joint.map(|(force, _)| *force);
        let choices = in_joint.map_or(1, |_| MOST_CHOICES);
        for _ in 0..choices {
            self.passive.modes.clone_from(&released);
            self.passive.friction.freeze(true);
            let chosen = self.evaluate(solver, given, time, x);
            let chosen = chosen.and_then(|()| self.choose_for(solver, given, (time, x)));
            self.passive.friction.freeze(false);
            chosen?;
            self.evaluate(solver, given, time, x)?;
            if self.all_agree(&released) {
                self.set_anchors(before);
                return Ok(());
            }
        }
        let chosen = self.passive.modes.clone();
        if !self.try_all(solver, given, (time, x), &released) {
            if let Some(first) = in_joint {
                let force = self.passive.list[first].index;
                return Err(Error::Kinematics(kinematics::Error::NoForce {
                    force: solver.mechanism().forces[force].name.clone(),
                    reason: "neither sticks nor slides here: the reactions that it makes agree with neither",
                }));
            }
            self.passive.modes = chosen;
            self.evaluate(solver, given, time, x)?;
        }
        self.set_anchors(before);
        Ok(())
    }

    /// Tries all modes of what was released, and returns whether some agree. The order is that of the file,
    /// the first force changing fastest, closed before open and sticking before sliding: where several
    /// combinations agree, as with friction that jams, the one in which more is held is the motion's, since
    /// nothing makes what rests begin to move.
    fn try_all(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        (time, x): (f64, &[f64]),
        released: &[Mode],
    ) -> bool {
        self.passive.modes.copy_from_slice(released);
        if self.evaluate(solver, given, time, x).is_err() {
            return false;
        }
        let of_contacts = self.closed().into_iter();
        let of_contacts = of_contacts.map(|Touch { force, side }| (force, vec![side, Mode::Free]));
        let sliding = vec![Mode::Sticking, Mode::Growing, Mode::Falling];
        let of_frictions = self.undecided().into_iter().map(|k| (k, sliding.clone()));
        let options: Vec<(usize, Vec<Mode>)> = of_contacts.chain(of_frictions).collect();
        let counts = options.iter().map(|(_, modes)| modes.len());
        let count = counts.fold(1, |count: usize, more| count.saturating_mul(more));
        for choice in 0..count.min(MOST_TRIED) {
            let mut rest = choice;
            for (k, modes) in &options {
                self.passive.modes[*k] = modes[rest % modes.len()];
                rest /= modes.len();
            }
            if self.evaluate(solver, given, time, x).is_ok() && self.all_agree(released) {
                return true;
            }
        }
        false
    }

    /// Returns whether all that was released has a mode that agrees with the motion.
    fn all_agree(&self, released: &[Mode]) -> bool {
        let agrees = |k: usize| {
            let own = &self.passive.list[k];
            own.cause
                .agrees(self.passive.modes[k], &self.point.passive[k])
        };
        (0..released.len()).all(|k| released[k] != Mode::Free || agrees(k))
    }

    /// Returns the contacts that do not open.
    fn closed(&self) -> Vec<Touch> {
        let mut touches = self.touches();
        touches.retain(|touch| self.opening(*touch)[0] <= self.at(*touch).resting_speed());
        touches
    }

    /// Returns the friction that neither sticks nor slides yet.
    fn undecided(&self) -> Vec<usize> {
        let undecided = |k: &usize| {
            let is_friction = self.passive.list[*k].cause.friction().is_some();
            is_friction && self.passive.modes[*k] == Mode::Free
        };
        (0..self.passive.list.len()).filter(undecided).collect()
    }

    /// Notes the values at which coordinates are held.
    fn set_anchors(&mut self, before: &[Mode]) {
        for (k, before) in before.iter().enumerate() {
            let at = &self.point.passive[k];
            let value = at.coordinate.value;
            // A driver that jumps takes along what sticks.
            let is_there = (value - self.passive.anchors[k]).abs() <= at.slow(Order::Position);
            match self.passive.modes[k] {
                Mode::AtMin => self.passive.anchors[k] = at.bounds[0],
                Mode::AtMax => self.passive.anchors[k] = at.bounds[1],
                Mode::Sticking if *before != Mode::Sticking || !is_there => {
                    self.passive.anchors[k] = value;
                }
                Mode::Free
                | Mode::LooseAtMin
                | Mode::LooseAtMax
                | Mode::Sticking
                | Mode::Growing
                | Mode::Falling => {}
            }
        }
    }

    /// Chooses, for friction in joints with the reactions at hand.
    fn choose_for(
        &mut self,
        solver: &mut Solver,
        given: &impl Given,
        (time, x): (f64, &[f64]),
    ) -> Result<(), Error> {
        let (mut decided, mut reconsidered) = (Vec::new(), Vec::new());
        loop {
            let contacts = self.closed();
            let frictions = self.undecided();
            let of_contacts = contacts.iter().map(|contact| self.opening(*contact)[1]);
            let of_frictions = frictions
                .iter()
                .map(|&k| self.point.passive[k].coordinate.second());
            let accelerations: Vec<f64> = of_contacts.chain(of_frictions).collect();
            let held = (&*contacts, &[][..]);
            let Press { forces, columns } = self.press(
                solver,
                held,
                &frictions,
                &accelerations,
                Order::Acceleration,
            )?;
            let (of_contacts, of_frictions) = forces.as_slice().split_at(contacts.len());
            // One begins to slide at a time, the one that does so with most energy: it exerts less then,
            // and others may stick.
            let motion = &columns * &forces;
            let eagerness = |place: usize| {
                let (column, first) = (columns.column(place), accelerations[place]);
                (first + column.dot(&motion)).abs() / column.norm()
            };
            let at_limit = frictions.iter().zip(of_frictions).enumerate();
            let at_limit = at_limit
                .filter(|(_, (k, force))| force.abs() >= self.point.passive[**k].most_sticking());
            let slides = at_limit.max_by(|(a, _), (b, _)| {
                let [a, b] = [a, b].map(|place| eagerness(contacts.len() + place));
                a.total_cmp(&b)
            });
            if let Some((_, (&k, &force))) = slides {
                let at = &self.point.passive[k];
                // At its limit friction pushes against the motion that begins.
                let grows = if at.bounds[0] < at.bounds[1] {
                    force < 0.0
                } else {
                    at.coordinate.second() > 0.0
                };
                self.passive.modes[k] = if grows { Mode::Growing } else { Mode::Falling };
                decided.push(k);
                self.evaluate(solver, given, time, x)?;
                continue;
            }
            // Others that slide since may hold one back.
            let turns_back = |k: &usize| {
                let at = &self.point.passive[*k];
                let column = self.passive.columns(&[*k], &self.freedoms, self.factor());
                let second = at.coordinate.second() + column.column(0).dot(&motion);
                self.passive.modes[*k].sign() * second < -at.slow(Order::Acceleration)
                    && !reconsidered.contains(k)
            };
            if let Some(place) = decided.iter().position(turns_back) {
                let k = decided.swap_remove(place);
                reconsidered.push(k);
                self.passive.modes[k] = Mode::Free;
                self.evaluate(solver, given, time, x)?;
                continue;
            }
            for (contact, &force) in contacts.iter().zip(of_contacts) {
                if force > 0.0 {
                    self.passive.modes[contact.force] = contact.side;
                }
            }
            for k in frictions {
                self.passive.modes[k] = Mode::Sticking;
            }
            return Ok(());
        }
    }
}

//! Friction, along a coordinate or in a joint: it holds the coordinate while it sticks, and acts against
//! its rate while it slides.
//!
//! Its size, and in a joint that of the reaction which presses, is
//! [`kinematics::Friction`](crate::kinematics::Friction)'s matter. A coordinate that drivers alone move
//! cannot be held: there the force of friction that sticks is zero, and it slides as soon as a driver
//! moves it.

use super::{Cause, Function, Mode, Passive};
use crate::dynamics::event::EventKind;
use crate::dynamics::function::FORCE_ROUNDING;
use crate::kinematics::Solver;
use crate::mechanism::Order;

/// Friction of a mechanism, by its place among all.
#[derive(Debug)]
pub(super) struct Rubbing(pub(super) usize);

impl Cause for Rubbing {
    fn read(&self, _: &Solver, _: Mode, _: &mut Passive) {}

    fn friction(&self) -> Option<usize> {
        Some(self.0)
    }

    fn holds(&self, mode: Mode) -> bool {
        mode == Mode::Sticking
    }

    /// Leaves friction undecided, [`Mode::Free`], where its coordinate rests.
    fn released(&self, _: &Solver, at: &Passive) -> Mode {
        let rate = at.coordinate.first();
        if rate.abs() <= at.slow(Order::Velocity) {
            Mode::Free
        } else if rate > 0.0 {
            Mode::Growing
        } else {
            Mode::Falling
        }
    }

    fn function(&self, mode: Mode, at: &Passive, side: usize) -> Option<Function> {
        let sign = if side == 0 { 1.0 } else { -1.0 };
        match mode {
            // While other forces hold the coordinate, friction neither turns nor begins to stick.
            Mode::Growing | Mode::Falling if at.is_dependent => None,
            Mode::Growing | Mode::Falling if side == 0 => Some(at.speed(mode.sign())),
            // It rests as others do, until something drives it away.
            Mode::Sticking if at.is_dependent => {
                let speed = at.speed(-sign);
                Some(Function {
                    value: at.slow(Order::Velocity) + speed.value,
                    ..speed
                })
            }
            Mode::Sticking => Some(at.push(sign * (at.force - at.bounds[side]))),
            _ => None,
        }
    }

    fn agrees(&self, mode: Mode, at: &Passive) -> bool {
        let acceleration = at.coordinate.second();
        match mode {
            Mode::Sticking if at.is_dependent => acceleration.abs() <= at.slow(Order::Acceleration),
            Mode::Sticking => at.force.abs() < at.most_sticking(),
            mode => mode.sign() * acceleration >= -at.slow(Order::Acceleration),
        }
    }

    fn event(&self, before: Mode, after: Mode, _: &Passive) -> Option<EventKind> {
        match (before, after) {
            (_, Mode::Sticking) => Some(EventKind::Sticks),
            (Mode::Sticking, _) => Some(EventKind::Slides),
            _ => None,
        }
    }
}

impl Passive {
    /// Returns the force up to which friction sticks; at its limit it does not, where the watch sees that
    /// sticking ends.
    pub(in crate::dynamics) fn most_sticking(&self) -> f64 {
        (1.0 - 4.0 * FORCE_ROUNDING) * self.bounds[1]
    }
}

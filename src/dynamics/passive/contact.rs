//! A contact: a rigid stop, or the two parts of a joint with play. It holds its coordinate at a limit
//! while it pushes.

use std::f64::consts::TAU;

use super::{Cause, Function, Mode, Passive};
use crate::dynamics::event::EventKind;
use crate::kinematics::Solver;
use crate::mechanism::{Dual, Mechanism, Number, Order, ParameterId, PassiveCause};

/// Height from which a fall ends at rest, in gaps that are rounding: below that of all bounces.
const LOWEST_FALL: f64 = 1.0 / 64.0;
/// Gap up to which a contact is touched, in the same unit.
pub(in crate::dynamics) const TOUCHED: f64 = 4.0;

/// A contact of a mechanism.
#[derive(Debug)]
pub(super) struct Contact {
    pub(super) cause: PassiveCause,
    pub(super) is_angle: bool,
}

impl Contact {
    /// Returns least and largest value of the coordinate for these parameters, at the solver's pose.
    fn limits_for<N: Number>(
        &self,
        solver: &Solver,
        parameter: &impl Fn(ParameterId) -> N,
    ) -> [N; 2] {
        match self.cause {
            PassiveCause::Stop(stop) => solver.mechanism().stops[stop].limits(parameter),
            PassiveCause::Play(joint) => solver.limits_of_play(joint, parameter),
            PassiveCause::Friction(_) => unreachable!("friction is no contact"),
        }
    }
}

impl Cause for Contact {
    fn read(&self, solver: &Solver, _: Mode, at: &mut Passive) {
        let parameters = &solver.pose().parameters;
        at.bounds = self.limits_for(solver, &|id| parameters[id.index()]);
        let middle = 0.5 * (at.bounds[0] + at.bounds[1]);
        let has_play = matches!(self.cause, PassiveCause::Play(_));
        if has_play && self.is_angle && middle.is_finite() {
            // The bodies' whole turns are no play in a gap.
            let turns = ((at.coordinate.value - middle) / TAU).round();
            at.coordinate.value -= TAU * turns;
        }
    }

    fn limits(&self, solver: &Solver, parameter: &dyn Fn(ParameterId) -> Dual) -> [Dual; 2] {
        self.limits_for(solver, &parameter)
    }

    fn holds(&self, mode: Mode) -> bool {
        mode != Mode::Free
    }

    fn released(&self, _: &Solver, _: &Passive) -> Mode {
        Mode::Free
    }

    fn touched(&self, at: &Passive) -> [Option<Mode>; 2] {
        let gaps = at.gaps();
        let modes = [Mode::AtMin, Mode::AtMax].into_iter().zip(gaps);
        let mut touched =
            modes.map(|(mode, gap)| (gap <= TOUCHED * at.gap_rounding()).then_some(mode));
        std::array::from_fn(|_| touched.next().flatten())
    }

    fn is_contact(&self) -> bool {
        true
    }

    fn restitution(&self, mechanism: &Mechanism, parameter: &dyn Fn(ParameterId) -> Dual) -> Dual {
        self.cause.restitution(mechanism, &parameter)
    }

    fn function(&self, mode: Mode, at: &Passive, side: usize) -> Option<Function> {
        match (mode, side) {
            (Mode::Free, side) => {
                let sign = if side == 0 { 1.0 } else { -1.0 };
                at.bounds[side]
                    .is_finite()
                    .then(|| at.place(sign, at.bounds[side]))
            }
            (_, 0) => Some(at.push(mode.sign() * at.force)),
            _ => None,
        }
    }

    fn agrees(&self, mode: Mode, at: &Passive) -> bool {
        match mode {
            Mode::Free => {
                let closes = |mode: Mode| {
                    let [speed, acceleration] = at.opening(mode);
                    speed <= at.resting_speed() && acceleration < -at.slow(Order::Acceleration)
                };
                !self.touched(at).into_iter().flatten().any(closes)
            }
            mode => mode.sign() * at.force >= 0.0,
        }
    }

    fn event(&self, before: Mode, after: Mode, _: &Passive) -> Option<EventKind> {
        match (before, after) {
            (_, Mode::Free) => Some(EventKind::Leaves),
            _ => Some(EventKind::Rests),
        }
    }
}

impl Passive {
    /// Returns whether the coordinate is within its limits, to rounding.
    pub(in crate::dynamics) fn is_inside(&self) -> bool {
        let gaps = self.gaps();
        gaps.iter()
            .all(|gap| *gap >= -TOUCHED * self.gap_rounding())
    }

    /// Returns the gaps at the least and at the largest value.
    pub(in crate::dynamics) fn gaps(&self) -> [f64; 2] {
        let [least, most] = self.bounds;
        [self.coordinate.value - least, most - self.coordinate.value]
    }

    /// Returns the speed at which a contact opens on a side, negative where it closes, and the
    /// acceleration.
    pub(in crate::dynamics) fn opening(&self, side: Mode) -> [f64; 2] {
        self.coordinate.derivatives.map(|rate| side.sign() * rate)
    }

    /// Returns the speed of a contact that counts as rest: that of the lowest fall, or of as low a rise,
    /// as friction and other contacts may turn the acceleration round.
    pub(in crate::dynamics) fn resting_speed(&self) -> f64 {
        let height = LOWEST_FALL * self.gap_rounding();
        self.speed_rounding() + (2.0 * height * self.coordinate.second().abs()).sqrt()
    }
}

//! An elastic stop: a spring and a damper beyond its limits, which never pull.
//!
//! While its mode lasts its force is that of the mode also where a trial step goes beyond the limit, so that
//! the motion is smooth up to the instant at which the mode ends.

use super::{Cause, Function, Mode, Passive};
use crate::dynamics::event::EventKind;
use crate::kinematics::Solver;
use crate::mechanism::{Dual, ElasticStop, ParameterId};

impl Cause for ElasticStop {
    fn read(&self, solver: &Solver, mode: Mode, at: &mut Passive) {
        let parameters = &solver.pose().parameters;
        at.bounds = self.limits(&|id| parameters[id.index()]);
        at.force = push(self, solver, mode, at);
        at.force_rounding = self.stiffness.value(parameters) * at.gap_rounding();
    }

    fn limits(&self, _: &Solver, parameter: &dyn Fn(ParameterId) -> Dual) -> [Dual; 2] {
        Self::limits(self, &parameter)
    }

    fn beyond_law(&self, solver: &Solver, mode: Mode, at: &Passive) -> f64 {
        let parameters = &solver.pose().parameters;
        let value = |id: ParameterId| parameters[id.index()];
        let by_law = self.force(&value, [at.coordinate.value, at.coordinate.first()]);
        let by_mode = match mode {
            Mode::AtMin | Mode::AtMax => at.force,
            _ => 0.0,
        };
        by_mode - by_law
    }

    fn holds(&self, _: Mode) -> bool {
        false
    }

    fn has_law(&self) -> bool {
        true
    }

    fn released(&self, solver: &Solver, at: &Passive) -> Mode {
        let rate = at.coordinate.first();
        let [below, above] = at.gaps().map(|gap| -gap);
        // At a limit it is touched if the coordinate goes beyond.
        let is_beyond = |beyond: f64, rate: f64| {
            let rounding = at.gap_rounding();
            beyond > rounding || beyond.abs() <= rounding && rate > at.speed_rounding()
        };
        let touched = if is_beyond(below, -rate) {
            Mode::AtMin
        } else if is_beyond(above, rate) {
            Mode::AtMax
        } else {
            return Mode::Free;
        };
        let is_inside = below <= 0.0 && above <= 0.0;
        if is_inside || touched.sign() * push(self, solver, touched, at) > 0.0 {
            touched
        } else if touched == Mode::AtMin {
            Mode::LooseAtMin
        } else {
            Mode::LooseAtMax
        }
    }

    fn function(&self, mode: Mode, at: &Passive, side: usize) -> Option<Function> {
        let sign = mode.sign();
        Some(match mode {
            Mode::Free if at.bounds[side].is_infinite() => return None,
            Mode::Free => at.place(if side == 0 { 1.0 } else { -1.0 }, at.bounds[side]),
            Mode::AtMin | Mode::AtMax if side == 0 => at.push(sign * at.force),
            Mode::LooseAtMin | Mode::LooseAtMax if side == 0 => at.push(-sign * at.force),
            Mode::AtMin | Mode::LooseAtMin => at.place(-1.0, at.bounds[0]),
            _ => at.place(1.0, at.bounds[1]),
        })
    }

    fn agrees(&self, _: Mode, _: &Passive) -> bool {
        true
    }

    fn event(&self, before: Mode, after: Mode, at: &Passive) -> Option<EventKind> {
        match (before, after) {
            (Mode::LooseAtMin | Mode::LooseAtMax, Mode::AtMin | Mode::AtMax)
            | (_, Mode::LooseAtMin | Mode::LooseAtMax) => None,
            (_, Mode::Free) => Some(EventKind::Leaves),
            _ => Some(EventKind::Impact {
                speed: at.coordinate.first().abs(),
            }),
        }
    }
}

/// Returns the force along the coordinate with which spring and damper push from the side of a mode, or
/// pull.
fn push(stop: &ElasticStop, solver: &Solver, mode: Mode, at: &Passive) -> f64 {
    let parameters = &solver.pose().parameters;
    let value = |id: ParameterId| parameters[id.index()];
    let sign = mode.sign();
    let [below, above] = at.gaps();
    let beyond = match mode {
        Mode::AtMin | Mode::LooseAtMin => -below,
        Mode::AtMax | Mode::LooseAtMax => -above,
        _ => return 0.0,
    };
    sign * stop.push(&value, [beyond, sign * at.coordinate.first()])
}

//! How far drivers leave their chords during a sub-step.

use crate::kinematics::Error;
use crate::kinematics::path::{Curve, Path};
use crate::kinematics::solver::Solver;
use crate::mechanism::{DriverId, Interval, Jet3, ParameterId};

/// How far a prescribed motion that is not smooth may leave its chord, in radians and
/// characteristic lengths: one that jumps by more is refused where it jumps.
const LARGEST_JUMP: f64 = 0.1;

impl Solver {
    /// Notes how drivers and parameters run over a part of `path`, at whose end drivers and
    /// parameters are those in force. False if nothing can be said: a motion jumps, or a number
    /// cannot be bounded.
    ///
    /// # Errors
    ///
    /// A value on the way is one for which the mechanism does not exist.
    pub(super) fn bound_course(&mut self, path: &Path, part: [f64; 2]) -> Result<bool, Error> {
        self.tubes.slips.moving = self.parameters_move;
        if self.parameters_move
            && !self
                .tubes
                .slips
                .bound(&self.system, &self.at, &self.targets, path, part)
        {
            return Ok(false);
        }
        let [start, end] = part;
        for (index, curve) in path.curves.iter().enumerate() {
            let [from, to] = [self.pose.drivers[index], self.next_drivers[index]];
            let rounding = f64::EPSILON * (from.abs() + to.abs());
            let strays = match curve {
                // Of second order: its second derivative is the same everywhere.
                Curve::Input { .. } => {
                    let second = self.path_drivers[index].second();
                    Some(0.125 * (end - start).powi(2) * second.abs())
                }
                Curve::Motion => self.motion_strays(path, part, DriverId(index), [from, to]),
            };
            let Some(strays) = strays else {
                return Ok(false);
            };
            self.tubes.drivers[index] = strays + rounding;
        }
        Ok(true)
    }

    /// How far a prescribed motion leaves the straight line from one end to the other.
    // Its stack of operands is no part of steps that have none.
    #[inline(never)]
    fn motion_strays(
        &mut self,
        path: &Path,
        [start, end]: [f64; 2],
        driver: DriverId,
        [from, to]: [f64; 2],
    ) -> Option<f64> {
        let [begin, stop] = [path.time(start), path.time(end)];
        let duration = stop - begin;
        let bounds = if self.parameters_move {
            let duration = Interval::point(path.duration);
            let t = Jet3::linear(Interval::new(begin, stop), duration);
            let parameters = &self.tubes.slips.parameters;
            let bounds = self
                .motions
                .enclose(driver, t, &|p: ParameterId| parameters[p.index()]);
            if bounds.is_none() {
                // A table whose points move: at both ends its second derivative is at hand.
                self.tubes.checked = true;
                let second = self.path_drivers[driver.index()].second();
                let before = self.origin_drivers[driver.index()].second();
                let most = 2.0 * second.abs().max(before.abs());
                return Some(0.125 * (end - start).powi(2) * most);
            }
            bounds?
        } else {
            if duration == 0.0 {
                return Some(0.0);
            }
            if let Some(most) = self.motions.curvature(driver, begin, stop) {
                return Some(0.125 * duration * duration * most);
            }
            let t = Jet3::fixed(Interval::new(begin, stop));
            let parameters = &self.pose.parameters;
            let parameter = |p: ParameterId| Jet3::constant(parameters[p.index()]);
            self.motions.enclose(driver, t, &parameter)?
        };
        let second = bounds.second().magnitude();
        if self.parameters_move && second.is_finite() {
            return Some(0.125 * (end - start).powi(2) * second);
        }
        // Not smooth: between the least and the largest value.
        let Interval { low, high } = bounds.value;
        let strays = (high - from.min(to)).max(from.max(to) - low);
        (strays <= LARGEST_JUMP * self.at.size().min(1.0)).then_some(strays)
    }
}

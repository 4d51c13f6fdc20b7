//! What moves a mechanism from outside during a sub-step: how far drivers leave their chords, and
//! how far parameters on their way move what hangs on them.

use crate::kinematics::Error;
use crate::kinematics::path::{Curve, Path};
use crate::kinematics::solver::Solver;
use crate::kinematics::system::{System, Target};
use crate::mechanism::{DriverId, Expression, Interval, Jet3, MarkerId, ParameterId};

/// How far a prescribed motion that is not smooth may leave its chord, in radians and
/// characteristic lengths: one that jumps by more is refused where it jumps.
const LARGEST_JUMP: f64 = 0.1;

/// While parameters move, equations are written down with their values at the end of a sub-step.
/// This is how far each number in them may differ from that on the way.
#[derive(Debug)]
pub(in crate::kinematics) struct Slips {
    moving: bool,
    /// All parameters over the sub-step, as functions of s.
    parameters: Vec<Jet3<Interval>>,
    /// One a marker: of s \[m\], and of its angle \[rad\].
    positions: Vec<f64>,
    angles: Vec<f64>,
    /// What each row is held at, zero for drivers \[m or rad\].
    constants: Vec<f64>,
}

impl Slips {
    pub(super) fn new(system: &System) -> Self {
        let mechanism = system.mechanism();
        let markers = mechanism.markers.len();
        Self {
            moving: false,
            parameters: vec![Jet3::constant(0.0); mechanism.parameters.len()],
            positions: vec![0.0; markers],
            angles: vec![0.0; markers],
            constants: vec![0.0; system.equations().len()],
        }
    }

    pub(super) fn of_moving(&self) -> Option<&Self> {
        self.moving.then_some(self)
    }

    /// How far the marker's point may differ, in its body's frame \[m\].
    pub(in crate::kinematics) fn position(&self, marker: MarkerId) -> f64 {
        self.positions[marker.index()]
    }

    /// How far the marker's angle may differ \[rad\].
    pub(in crate::kinematics) fn angle(&self, marker: MarkerId) -> f64 {
        self.angles[marker.index()]
    }

    /// How far what a row is held at may differ; zero for a driver's.
    pub(in crate::kinematics) fn constant(&self, row: usize) -> f64 {
        self.constants[row]
    }
}

/// A number over a range, with this slope throughout.
fn linear(range: Interval, slope: f64) -> Jet3<Interval> {
    let zero = Interval::point(0.0);
    Jet3::new(range, [Interval::point(slope), zero, zero])
}

impl Solver {
    /// Notes how drivers and parameters run over a part of `path`, at whose end drivers and
    /// parameters are those in force. False if nothing can be said: a motion jumps, or a number
    /// cannot be bounded.
    ///
    /// # Errors
    ///
    /// A value on the way is one for which the mechanism does not exist.
    pub(in crate::kinematics) fn bound_course(
        &mut self,
        path: &Path,
        part: [f64; 2],
    ) -> Result<bool, Error> {
        self.tubes.slips.moving = self.parameters_move;
        if self.parameters_move && !self.bound_parameters(path, part) {
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
            let t = linear(Interval::new(begin, stop), path.duration);
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

    /// Bounds how far the numbers in the equations may differ from those in force.
    #[inline(never)]
    fn bound_parameters(&mut self, path: &Path, [start, end]: [f64; 2]) -> bool {
        let mechanism = self.system.mechanism();
        let slips = &mut self.tubes.slips;
        let at = |s: f64, from: f64, to: f64| if s < 1.0 { from + s * (to - from) } else { to };
        let ways = path.from.iter().zip(&path.to);
        for (parameter, (&from, &to)) in slips.parameters.iter_mut().zip(ways) {
            let ends = [at(start, from, to), at(end, from, to)];
            let range = Interval::new(ends[0].min(ends[1]), ends[0].max(ends[1]));
            *parameter = linear(range, to - from);
        }
        mechanism.derive_parameters(&mut slips.parameters);
        let parameters = &slips.parameters;
        let differs = |expression: &Expression, in_force: f64| {
            let range = expression.evaluate(&|p| Jet3::fixed(parameters[p.index()].value), {
                Jet3::constant(0.0)
            });
            (range.value - Interval::point(in_force)).magnitude()
        };
        let mut sum = 0.0;
        let markers = slips.positions.iter_mut().zip(&mut slips.angles);
        for (index, (position, angle)) in markers.enumerate() {
            let marker = &mechanism.markers[index];
            let (s, turned) = self.at.local(MarkerId(index));
            let [x, y] = [0, 1].map(|axis| differs(&marker.position[axis], s[axis]));
            *position = x.hypot(y);
            *angle = differs(&marker.angle, turned);
            sum += *position + *angle;
        }
        let rows = slips.constants.iter_mut().zip(self.system.equations());
        for (row, (constant, equation)) in rows.enumerate() {
            if let Target::Constant(expression) = &equation.target {
                *constant = differs(expression, self.targets.constant(row));
                sum += *constant;
            }
        }
        sum.is_finite()
    }
}

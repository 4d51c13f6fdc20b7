//! Bounds of the deviation of drivers from their chords during a sub-step.

use crate::kinematics::certificate::{LARGEST_JUMP, PASSED_AT_ONCE, ParameterBounds, StepBounds};
use crate::kinematics::constraint::moving_configuration::bend;
use crate::kinematics::path::{DriverPath, Path, PathDrivers, polynomial};
use crate::kinematics::state::State;
use crate::kinematics::system::{Equation, System};
use crate::mechanism::{DriverId, Interval, Jet3, Number, ParameterId};

/// Bounds drivers and parameters over a part of `path`, at whose end the drivers ahead and the
/// parameters in force are.
///
/// # Errors
///
/// The driver whose motion jumps; `None` where another number is not bounded.
pub(super) fn bound_drivers(
    system: &System,
    state: &State,
    drivers: &PathDrivers,
    path: &Path,
    part: [f64; 2],
    bounds: &mut StepBounds,
) -> Result<(), Option<DriverId>> {
    let parameters = &mut bounds.parameters;
    parameters.moving = drivers.parameters_move;
    if parameters.moving {
        parameters
            .drivers_before
            .copy_from_slice(&state.pose.drivers);
        if !parameters.bound(
            system,
            (&state.at, &state.targets),
            [&state.pose.parameters, &drivers.parameters],
            path,
            part,
        ) {
            return Err(None);
        }
    }
    let [start, end] = part;
    for (index, driver_path) in path.driver_paths.iter().enumerate() {
        let ends = [state.pose.drivers[index], drivers.values[index]];
        let rounding = f64::EPSILON * (ends[0].abs() + ends[1].abs());
        let deviation = match driver_path {
            // The second derivative is constant.
            DriverPath::Input { .. } => {
                let second = drivers.ahead[index].second();
                Some(0.125 * (end - start).powi(2) * second.abs())
            }
            DriverPath::Polynomial(coefficients) => {
                // Taylor's formula from the middle, whose terms add up to a bound.
                let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
                let terms = (2..6).rev().fold(0.0, |sum, derivative| {
                    let term = polynomial(coefficients, derivative, middle).abs();
                    term + sum * half / (derivative - 1) as f64
                });
                Some(0.125 * (end - start).powi(2) * terms)
            }
            DriverPath::Motion => {
                let driver = DriverId(index);
                let motion = MotionOverStep {
                    driver,
                    ends,
                    row: system.driver_row(driver),
                };
                motion.deviation(state, path, part, bounds.moving_parameters())
            }
        };
        let deviation = deviation.ok_or(Some(DriverId(index)))?;
        bounds.drivers[index] = deviation + rounding;
    }
    Ok(())
}

/// A prescribed motion over a sub-step.
struct MotionOverStep<'a> {
    driver: DriverId,
    /// Its values at both ends.
    ends: [f64; 2],
    /// Its row, which has the unit of its values.
    row: &'a Equation,
}

impl MotionOverStep<'_> {
    /// Bounds the deviation from the straight line between the ends, for parameters that may move.
    // Its stack of operands is no part of steps without motions.
    #[inline(never)]
    fn deviation(
        &self,
        state: &State,
        path: &Path,
        [start, end]: [f64; 2],
        moving: Option<&ParameterBounds>,
    ) -> Option<f64> {
        let motions = &state.motions;
        let [begin, stop] = [path.time(start), path.time(end)];
        let duration = stop - begin;
        let time = Interval::new(begin, stop);
        let along = || Jet3::linear(time, Interval::point(stop) - Interval::point(begin));
        let range = if let Some(moving) = moving {
            let range = moving.motion(self.driver, along())?;
            if range.first().is_finite() {
                return Some(0.125 * bend(&range));
            }
            range
        } else {
            if duration == 0.0 {
                return Some(0.0);
            }
            if let Some(most) = motions.curvature(self.driver, begin, stop) {
                return Some(0.125 * duration * duration * most);
            }
            let parameters = &state.pose.parameters;
            let parameter = |p: ParameterId| Jet3::constant(parameters[p.index()]);
            motions.enclose(self.driver, Jet3::fixed(time), &parameter)?
        };
        // Not smooth: between the least and the largest value.
        let [from, to] = self.ends;
        let Interval { low, high } = range.value;
        let deviation = (high - from.min(to)).max(from.max(to) - low);
        let is_small = |deviation: &f64| deviation * self.row.row_scale(&state.at) <= LARGEST_JUMP;
        // Parts of it may jump together.
        Some(deviation).filter(is_small).or_else(|| {
            if moving.is_some() {
                let is_passed = end - start <= PASSED_AT_ONCE;
                return Some((to - from).abs()).filter(|jump| is_passed && is_small(jump));
            }
            let pieces = motions.enclose_joined(self.driver, along())?;
            Some(0.125 * bend(&pieces))
        })
    }
}

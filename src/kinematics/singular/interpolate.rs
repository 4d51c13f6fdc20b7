//! The motion through a change point, interpolated between its two sides.

use super::locate::Finding;
use super::reduced::ReducedEquation;
use crate::kinematics::block::Crossing;
use crate::mechanism::DriverId;

/// Distance from the point to either end of a crossing at first, and the least one, as turn of the
/// fastest body or its way in characteristic lengths. Newton–Raphson at the distance δ gives
/// accelerations to some eps/δ³, 1e-10 at 0.01.
const REACH: f64 = 0.02;
const LEAST_REACH: f64 = 0.004;
/// Largest error of an acceleration at the change point, which is known independently, for
/// velocities of one.
const INTERPOLATED: f64 = 1e-6;
/// Largest error of a prediction, as part of the distance between both motions.
const OFF: f64 = 0.25;
/// Least slope of the equation on a regular side.
const FLAT: f64 = 1e-5;

/// Makes the crossing of a block whose change point is in `finding`; `None` if the motion cannot
/// be shown to go on beyond it.
pub(super) fn crossing_of(
    equation: &mut ReducedEquation<'_>,
    finding: Finding,
    block: usize,
    driver: DriverId,
) -> Option<Crossing> {
    let Finding::Crossing(point, [slope, other]) = finding else {
        return None;
    };
    let velocity = &point.tangents[1] + slope * &point.tangents[0];
    let speed = equation.scaled_speed(&velocity);
    let free = &point.tangents[0] / point.tangents[0].amax();
    let mut reach = REACH;
    while reach >= LEAST_REACH {
        let half_width = reach / speed;
        let ends = [-half_width, half_width].map(|off| {
            let slopes = [slope, other];
            End::find(equation, [point.alpha, point.tau], off, slopes)
        });
        if let [Some(before), Some(behind)] = ends {
            let crossing = Crossing {
                block,
                driver,
                center: point.tau,
                half_width,
                coefficients: interpolate(&before, &behind, half_width),
                free: free.iter().copied().collect(),
            };
            let error = error_at_center(&crossing, equation, &point.z, &velocity, speed);
            if error <= INTERPOLATED {
                return Some(crossing);
            }
        }
        reach *= 0.5;
    }
    None
}

/// Returns the error of the interpolated motion at the point and of its tangent there, as an error
/// of the acceleration: (1 − x²)³, the shape of the error, bends by 6 at its top.
fn error_at_center(
    crossing: &Crossing,
    equation: &ReducedEquation<'_>,
    z: &[f64],
    velocity: &nalgebra::DVector<f64>,
    speed: f64,
) -> f64 {
    let unit = equation.unscaled(&nalgebra::DVector::repeat(z.len(), 1.0));
    let velocity = equation.unscaled(velocity);
    let width = crossing.half_width * speed;
    let errors = (0..z.len()).map(|k| {
        let [value, first, _] = crossing.evaluate(k, crossing.center);
        let position = (value - z[k]).abs() / unit[k];
        let tangent = (first - velocity[k]).abs() / (unit[k] * speed);
        (6.0 * position / (width * width)).max(tangent / width)
    });
    errors.fold(0.0, f64::max)
}

/// The motion at one end of a crossing.
struct End {
    z: Vec<f64>,
    rates: [Vec<f64>; 2],
}

impl End {
    /// Finds the pose on the motion of slope `slope` at the distance `off` from the point, by
    /// Newton's method on ε from the tangent. The pose has to stay near, compared with the distance
    /// of the motion of slope `other`, and its own slope has to be nearer to `slope`.
    fn find(
        equation: &mut ReducedEquation<'_>,
        [alpha, tau]: [f64; 2],
        off: f64,
        [slope, other]: [f64; 2],
    ) -> Option<Self> {
        let tau = tau + off;
        let expected = alpha + slope * off;
        let apart = if other.is_finite() {
            ((slope - other) * off).abs()
        } else {
            off.abs() * equation.speed
        };
        let mut alpha = expected;
        let mut last = f64::INFINITY;
        for _ in 0..10 {
            let point = equation.solve(alpha, tau)?;
            let step = -point.epsilon / point.first[0];
            alpha += step;
            let astray = (alpha - expected).abs();
            if astray.is_nan() || astray > OFF * apart {
                return None;
            }
            if step.abs() <= 1e-15 || (step.abs() < 1e-9 && step.abs() >= 0.5 * last) {
                let own = -point.first[1] / point.first[0];
                let kept = point.first[0].abs() >= FLAT
                    && (!other.is_finite() || (own - slope).abs() < (own - other).abs());
                return kept.then(|| Self {
                    rates: equation.rates(&point),
                    z: point.z,
                });
            }
            last = step.abs();
        }
        None
    }
}

/// Returns the polynomials of fifth degree with values and derivatives of both ends.
fn interpolate(before: &End, behind: &End, half_width: f64) -> Vec<[f64; 6]> {
    let half = |a: f64, b: f64| (0.5 * (b + a), 0.5 * (b - a));
    (0..before.z.len())
        .map(|k| {
            let (value_even, value_odd) = half(before.z[k], behind.z[k]);
            let (first_even, first_odd) = half(
                before.rates[0][k] * half_width,
                behind.rates[0][k] * half_width,
            );
            let square = half_width * half_width;
            let (second_even, second_odd) =
                half(before.rates[1][k] * square, behind.rates[1][k] * square);
            // The odd powers have an even first derivative, and the other way round.
            let a5 = (second_odd - 3.0 * (first_even - value_odd)) / 8.0;
            let a3 = 0.5 * (first_even - value_odd) - 2.0 * a5;
            let a1 = value_odd - a3 - a5;
            let a4 = (second_even - first_odd) / 8.0;
            let a2 = 0.5 * first_odd - 2.0 * a4;
            let a0 = value_even - a2 - a4;
            [a0, a1, a2, a3, a4, a5]
        })
        .collect()
}

//! The motion through a change point, interpolated between its two sides.

use super::locate::{Finding, ROUNDING};
use super::reduced::ReducedEquation;
use crate::kinematics::block::{Crossing, INNER, Polynomial, divided_differences};
use crate::kinematics::linear::nan_or_larger;
use crate::mechanism::DriverId;

/// Distance from the point to either end of a crossing at first, and the least one, as turn of the
/// fastest body or its way in characteristic lengths. Newton–Raphson at the distance δ gives
/// accelerations to some eps/δ³, 1e-12 at the inner places of the first; the error of the
/// polynomials falls with the twelfth power of the distance.
const REACH: f64 = 0.2;
const LEAST_REACH: f64 = 0.004;
/// Place between inner places and ends at which the error of the polynomials is about the largest.
const BETWEEN: f64 = 0.85;
/// Error of an acceleration, for velocities of one, with which no shorter crossing is tried.
const GOOD: f64 = 4e-12;
/// Largest error of an acceleration; far from the origin there is more rounding.
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
    let center = Center {
        alpha: point.alpha,
        tau: point.tau,
        epsilon: point.epsilon,
        slopes: [slope, other],
        rate: equation.unscaled(&velocity),
        z: point.z,
    };
    let mut best: Option<(f64, Crossing)> = None;
    let mut reach = REACH;
    while reach >= LEAST_REACH {
        let half_width = reach / speed;
        let interpolated = interpolate(equation, &center, half_width);
        if let Some((coefficients, between)) = interpolated {
            let crossing = Crossing {
                block,
                driver,
                center: center.tau,
                half_width,
                coefficients,
                free: free.iter().copied().collect(),
            };
            let error = error_between(&crossing, equation, &between, speed);
            let rounding = error_of_shape(ROUNDING * equation.extent(), reach);
            let least = best.as_ref().map_or(INTERPOLATED + rounding, |best| best.0);
            if error <= least {
                best = Some((error, crossing));
            }
            // In shorter ones there is more rounding.
            if error <= GOOD || error > least && best.is_some() {
                break;
            }
        }
        reach *= 0.5;
    }
    best.map(|(_, crossing)| crossing)
}

/// Returns the error of an acceleration that goes with one of a position, for ends at the distance
/// `width`: (1 − x²)³, the shape of the error, bends by 6 at its top.
fn error_of_shape(position: f64, width: f64) -> f64 {
    6.0 * position / (width * width)
}

/// Returns the largest error of the interpolated motion at places where it is known, as an error of
/// the acceleration.
fn error_between(
    crossing: &Crossing,
    equation: &ReducedEquation<'_>,
    places: &[Place; 2],
    speed: f64,
) -> f64 {
    let order = crossing.coefficients.len();
    let unit = equation.unscaled(&nalgebra::DVector::repeat(order, 1.0));
    let width = crossing.half_width * speed;
    let mut largest = 0.0;
    for place in places {
        for k in 0..order {
            let [value, first, second] = crossing.evaluate(k, place.tau);
            let [velocity, acceleration] = &place.rates;
            let position = (value - place.z[k]).abs() / unit[k];
            let tangent = (first - velocity[k]).abs() / (unit[k] * speed);
            let bend = (second - acceleration[k]).abs() / (unit[k] * speed * speed);
            let error = error_of_shape(position, width).max(tangent / width);
            largest = nan_or_larger(largest, error.max(bend));
        }
    }
    largest
}

/// The change point.
struct Center {
    alpha: f64,
    tau: f64,
    /// ε there, some rounding.
    epsilon: f64,
    /// Slopes dα/dτ of the motion and of the other one, which may be infinite.
    slopes: [f64; 2],
    z: Vec<f64>,
    /// First derivative of z along the motion.
    rate: Vec<f64>,
}

/// The motion at one place of a crossing.
struct Place {
    tau: f64,
    alpha: f64,
    z: Vec<f64>,
    rates: [Vec<f64>; 2],
}

impl Place {
    /// Finds the pose on the motion at the distance `off` from the point, where α is predicted to be
    /// off the tangent by `bend`, by Newton's method on ε. The pose has to stay near, compared with
    /// the distance of the other motion, and its own slope has to be nearer to that of the motion.
    ///
    /// The rounding of ε at the point parts the motions by its root; without it they cross.
    fn find(
        equation: &mut ReducedEquation<'_>,
        center: &Center,
        off: f64,
        bend: f64,
    ) -> Option<Self> {
        let [slope, other] = center.slopes;
        let tau = center.tau + off;
        let tangent = center.alpha + slope * off;
        let apart = if other.is_finite() {
            ((slope - other) * off).abs()
        } else {
            off.abs() * equation.speed
        };
        let mut alpha = tangent + bend;
        let mut last = f64::INFINITY;
        for _ in 0..10 {
            let point = equation.solve(alpha, tau)?;
            let step = (center.epsilon - point.epsilon) / point.first[0];
            alpha += step;
            let astray = (alpha - tangent).abs();
            if astray.is_nan() || astray > OFF * apart {
                return None;
            }
            if step.abs() <= 1e-15 || (step.abs() < 1e-9 && step.abs() >= 0.5 * last) {
                let own = -point.first[1] / point.first[0];
                let kept = point.first[0].abs() >= FLAT
                    && (!other.is_finite() || (own - slope).abs() < (own - other).abs());
                return kept.then(|| Self {
                    tau,
                    alpha: point.alpha,
                    rates: equation.rates(&point),
                    z: point.z,
                });
            }
            last = step.abs();
        }
        None
    }
}

/// Returns the polynomials of a crossing of this width, and the motion at two places that they do
/// not know of; `None` if the motion was not found at all places.
fn interpolate(
    equation: &mut ReducedEquation<'_>,
    center: &Center,
    half_width: f64,
) -> Option<(Vec<Polynomial>, [Place; 2])> {
    // The second derivative of α, once it is known.
    let mut curvature = 0.0;
    let mut pair = |place: f64| {
        let off = place * half_width;
        let mut find = |off: f64| Place::find(equation, center, off, 0.5 * curvature * off * off);
        let (before, behind) = (find(-off)?, find(off)?);
        curvature = (before.alpha + behind.alpha - 2.0 * center.alpha) / (off * off);
        Some([before, behind])
    };
    let (inner, between, end) = (pair(INNER)?, pair(BETWEEN)?, pair(1.0)?);
    let coefficients = (0..center.z.len()).map(|k| {
        let parts = [(INNER, &inner), (1.0, &end)];
        let [inner, end] = parts.map(|(x, pair)| even_and_odd(x, pair, k, half_width));
        [
            divided_differences(center.z[k], inner[0], end[0]),
            divided_differences(center.rate[k] * half_width, inner[1], end[1]),
        ]
    });
    Some((coefficients.collect(), between))
}

/// Splits an unknown at ±x into an even part E(y) and an odd part x P(y), y = x². Returns E with its
/// first and second derivative in y, then P.
fn even_and_odd(x: f64, [before, behind]: &[Place; 2], k: usize, half_width: f64) -> [[f64; 3]; 2] {
    let jet = |place: &Place| {
        let [first, second] = &place.rates;
        let square = half_width * half_width;
        [place.z[k], first[k] * half_width, second[k] * square]
    };
    let (before, behind) = (jet(before), jet(behind));
    let sum = [0, 1, 2].map(|order| 0.5 * (behind[order] + before[order]));
    let difference = [0, 1, 2].map(|order| 0.5 * (behind[order] - before[order]));
    // The odd part has an even first derivative, and the other way round.
    let even = [sum[0], difference[1], sum[2]];
    let odd = [difference[0], sum[1], difference[2]];
    let square = x * x;
    let e1 = even[1] / (2.0 * x);
    let e2 = (even[2] - 2.0 * e1) / (4.0 * square);
    let p = odd[0] / x;
    let p1 = (odd[1] - p) / (2.0 * square);
    let p2 = (odd[2] - 6.0 * x * p1) / (4.0 * square * x);
    [[even[0], e1, e2], [p, p1, p2]]
}

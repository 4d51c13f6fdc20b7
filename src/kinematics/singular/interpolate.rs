//! The motion through a change point, interpolated between its two sides.

use super::locate::Finding;
use super::reduced::{BlockOnLine, ReducedEquation};
use crate::kinematics::alignment::Alignment;
use crate::kinematics::linear::nan_or_larger;
use crate::kinematics::plan::{Crossing, INNER, Polynomial, divided_differences};
use crate::mechanism::{DriverId, Jet};

/// Distance from the point to either end of a crossing at first, and the least one, as turn of the
/// fastest body or its way in characteristic lengths. Newton–Raphson at the distance δ gives
/// accelerations to some eps/δ³, 1e-12 at the inner places of the first; the error of the
/// polynomials falls with the twelfth power of the distance. No change point is looked for farther
/// away than the first.
pub(super) const REACH: f64 = 0.25;
const LEAST_REACH: f64 = 0.004;
/// Ratio of the distance of a trial to that of the one before it.
const SHORTER: f64 = 0.8;
/// BlockOnLine between inner places and ends at which the error of the polynomials is about the largest.
const BETWEEN: f64 = 0.85;
/// Error of an acceleration, for velocities of one, with which no shorter crossing is tried.
const ACCURATE_ENOUGH: f64 = 4e-12;
/// Largest error of an acceleration, near the origin; farther away there is as much more rounding.
const LARGEST_ERROR: f64 = 1e-6;
/// Largest error of a prediction, as part of the distance between both motions.
const OFF: f64 = 0.25;

/// Makes the crossing of a block whose change point is in `finding`; `None` if the motion cannot
/// be shown to go on beyond it, or if the start is not within any crossing.
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
    if (equation.start() - point.tau).abs() * speed >= REACH {
        return None;
    }
    let free = &point.tangents[0] / point.tangents[0].amax();
    let rates = velocity.iter().zip(&equation.scales);
    let rates = rates.map(|(velocity, scale)| velocity * scale);
    let unknowns = point.z.iter().zip(rates);
    let center = Center {
        place: BlockOnLine {
            tau: point.tau,
            unknowns: unknowns
                .map(|(z, rate)| Jet::new(*z, [rate, 0.0]))
                .collect(),
        },
        alpha: point.alpha,
        slopes: [slope, other],
    };
    let mut best: Option<(f64, Crossing)> = None;
    let mut reach = REACH;
    while reach >= LEAST_REACH {
        let half_width = reach / speed;
        let interpolated = interpolate(equation, &center, half_width);
        if let Some((coefficients, between)) = interpolated {
            let crossing = Crossing {
                set_aside: equation.set_aside.to_vec(),
                block,
                driver,
                center: center.place.tau,
                half_width,
                coefficients,
                free: free.iter().copied().collect(),
                alignment: Alignment::default(),
            };
            let error = error_between(&crossing, equation, &between, speed);
            let most = LARGEST_ERROR * equation.extent();
            let least = best.as_ref().map_or(most, |best| best.0);
            if error <= least {
                best = Some((error, crossing));
            }
            // In shorter ones there is more rounding.
            if error <= ACCURATE_ENOUGH || error > least && best.is_some() {
                break;
            }
        }
        reach *= SHORTER;
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
    places: &[BlockOnLine; 2],
    speed: f64,
) -> f64 {
    let width = crossing.half_width * speed;
    let mut largest = 0.0;
    for place in places {
        for (k, (known, unit)) in place.unknowns.iter().zip(&equation.scales).enumerate() {
            let [value, first, second] = crossing.evaluate(k, place.tau);
            let position = (value - known.value).abs() / unit;
            let tangent = (first - known.first()).abs() / (unit * speed);
            let bend = (second - known.second()).abs() / (unit * speed * speed);
            let error = error_of_shape(position, width).max(tangent / width);
            largest = nan_or_larger(largest, error.max(bend));
        }
    }
    largest
}

/// The change point.
struct Center {
    /// The motion there, its second derivative being unknown: zero.
    place: BlockOnLine,
    alpha: f64,
    /// Slopes dα/dτ of the motion and of the other one, which may be infinite.
    slopes: [f64; 2],
}

/// Finds the motion at the distance `off` from the point, from a place near there. The pose has to
/// stay near the tangent at the point, compared with the distance of the other motion, and its own
/// slope has to be nearer to that of the motion.
fn place_at(
    equation: &mut ReducedEquation<'_>,
    center: &Center,
    near: &BlockOnLine,
    off: f64,
) -> Option<BlockOnLine> {
    let [slope, other] = center.slopes;
    let apart = if other.is_finite() {
        ((slope - other) * off).abs()
    } else {
        off.abs() * equation.speed
    };
    let found = equation.follow(near, center.place.tau + off)?;
    let [alpha, own] = equation.alpha_along(&found);
    let astray = (alpha - (center.alpha + slope * off)).abs();
    let is_own = !other.is_finite() || (own - slope).abs() < (own - other).abs();
    (is_own && astray <= OFF * apart).then_some(found)
}

/// Returns the polynomials of a crossing of this width, and the motion at two places that they do
/// not know of; `None` if the motion was not found at all places.
fn interpolate(
    equation: &mut ReducedEquation<'_>,
    center: &Center,
    half_width: f64,
) -> Option<(Vec<Polynomial>, [BlockOnLine; 2])> {
    let mut pair = |near: [&BlockOnLine; 2], place: f64| {
        let off = place * half_width;
        let before = place_at(equation, center, near[0], -off)?;
        let behind = place_at(equation, center, near[1], off)?;
        Some([before, behind])
    };
    let inner = pair([&center.place; 2], INNER)?;
    let between = pair(inner.each_ref(), BETWEEN)?;
    let end = pair(between.each_ref(), 1.0)?;
    let center = center.place.unknowns.iter();
    let coefficients = center.enumerate().map(|(k, center)| {
        let parts = [(INNER, &inner), (1.0, &end)];
        let [inner, end] = parts.map(|(x, pair)| even_and_odd(x, pair, k, half_width));
        [
            divided_differences(center.value, inner[0], end[0]),
            divided_differences(center.first() * half_width, inner[1], end[1]),
        ]
    });
    Some((coefficients.collect(), between))
}

/// Splits an unknown at ±x into an even part E(y) and an odd part x P(y), y = x². Returns E with its
/// first and second derivative in y, then P.
fn even_and_odd(
    x: f64,
    [before, behind]: &[BlockOnLine; 2],
    k: usize,
    half_width: f64,
) -> [[f64; 3]; 2] {
    let jet = |place: &BlockOnLine| {
        let unknown = &place.unknowns[k];
        let second = unknown.second() * (half_width * half_width);
        [unknown.value, unknown.first() * half_width, second]
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

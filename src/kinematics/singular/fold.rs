//! The dead point of a block that loses several ranks there, as where all cells of a ring fold at
//! once.
//!
//! No border of one row and one column makes the Jacobian regular at such a point. But the motion
//! is smooth: along it τ is a function of α = c · (z − z⁰) with a maximum at the dead point. Places of
//! the motion on both sides of the point, at which it is regular as a function of α, give τ(α) with
//! its slope; a polynomial through them (Hermite) gives the maximum.

use super::reduced::{Along, ReducedEquation, ReducedPoint};

/// Places of the motion, as parts of the way in α to the point: on both sides of it, as beyond
/// all of them a polynomial would multiply their rounding.
const PARTS_OF_WAY: [f64; 6] = [0.0, 0.3, 0.6, 1.4, 1.7, 2.0];
/// Distance in α of the place that tells how far the point is.
const PROBE: f64 = 0.01;
/// Largest difference of the point's τ from that without the first place, relative to the way to it.
const SAME_TOP: f64 = 1e-8;
/// Rounding of τ, which runs from 0 to 1.
const TOP_ROUNDING: f64 = 1e-14;
/// Most Newton corrections of the maximum of the polynomial.
const MOST_STEPS_TO_TOP: usize = 20;

/// Finds the dead point ahead of the start on a path, within the distance `reach` of it.
pub(super) fn find_fold(
    equation: &mut ReducedEquation<'_>,
    mut start: ReducedPoint,
    reach: f64,
) -> Option<ReducedPoint> {
    let at_rest = Along {
        alpha: start.alpha,
        tau: start.tau,
        z: start.z.clone(),
        slope: 0.0,
        tangent: vec![0.0; start.z.len()],
    };
    let first = equation.at_alpha(&at_rest, start.alpha)?;
    let probe = equation.at_alpha(&first, first.alpha + PROBE.copysign(first.slope))?;
    let bend = (probe.slope - first.slope) / (probe.alpha - first.alpha);
    let way = -first.slope / bend;
    if !(way * first.slope > 0.0 && way.abs() <= reach) {
        return None;
    }
    let mut places = vec![first];
    for part in &PARTS_OF_WAY[1..] {
        let here = places.last()?;
        places.push(equation.at_alpha(here, start.alpha + part * way)?);
    }
    let top_of = |places: &[Along]| {
        let nodes = places.iter();
        let along = Hermite::through(nodes.map(|place| [place.alpha, place.tau, place.slope]));
        let top = along.top(start.alpha + way)?;
        Some((top, along.at(top)[0]))
    };
    let (top, tau) = top_of(&places)?;
    let (_, of_fewer) = top_of(&places[1..])?;
    let (before, behind) = (places[2].alpha, places[3].alpha);
    let is_between = (top - before) * (top - behind) < 0.0;
    if !is_between || (tau - of_fewer).abs() > SAME_TOP * (tau - start.tau) + TOP_ROUNDING {
        return None;
    }
    for (k, scale) in equation.scales.iter().enumerate() {
        let nodes = places.iter();
        let nodes = nodes.map(|place| [place.alpha, place.z[k], place.tangent[k] * scale]);
        let [value, slope, _] = Hermite::through(nodes).at(top);
        start.z[k] = value;
        start.tangents[0][k] = slope / scale;
    }
    Some(ReducedPoint {
        alpha: top,
        tau,
        ..start
    })
}

/// A polynomial through values with slopes, in Newton's form on nodes that count twice.
struct Hermite {
    nodes: Vec<f64>,
    coefficients: Vec<f64>,
}

impl Hermite {
    /// Returns the polynomial through points: argument, value and slope of each.
    fn through(points: impl Iterator<Item = [f64; 3]>) -> Self {
        let (mut nodes, mut coefficients, mut slopes) = (Vec::new(), Vec::new(), Vec::new());
        for [argument, value, slope] in points {
            nodes.extend([argument; 2]);
            coefficients.extend([value; 2]);
            slopes.push(slope);
        }
        for order in 1..nodes.len() {
            for k in (order..nodes.len()).rev() {
                coefficients[k] = if order == 1 && k % 2 == 1 {
                    slopes[k / 2]
                } else {
                    (coefficients[k] - coefficients[k - 1]) / (nodes[k] - nodes[k - order])
                };
            }
        }
        Self {
            nodes,
            coefficients,
        }
    }

    /// Returns its value and its first and second derivative.
    fn at(&self, argument: f64) -> [f64; 3] {
        let terms = self.nodes.iter().zip(&self.coefficients).rev();
        terms.fold([0.0; 3], |[value, first, second], (node, coefficient)| {
            let off = argument - node;
            [
                value * off + coefficient,
                first * off + value,
                second * off + 2.0 * first,
            ]
        })
    }

    /// Returns the place of its maximum near an argument.
    fn top(&self, near: f64) -> Option<f64> {
        let mut argument = near;
        for _ in 0..MOST_STEPS_TO_TOP {
            let [_, first, second] = self.at(argument);
            let step = first / second;
            argument -= step;
            if step.abs() <= 4.0 * f64::EPSILON * argument.abs().max(1.0) {
                return (second < 0.0).then_some(argument);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::Hermite;

    /// A cubic is reproduced from two nodes to rounding.
    #[test]
    fn a_cubic_through_two_nodes_is_itself() {
        let cubic = |x: f64| [x, x * (3.0 - x * x), 3.0 - 3.0 * x * x];
        let through = Hermite::through([0.25, 0.5].map(cubic).into_iter());
        for x in [-0.5, 0.3, 1.5] {
            let [_, value, slope] = cubic(x);
            let found = through.at(x);
            let expected = [value, slope, -6.0 * x];
            for (found, expected) in found.iter().zip(expected) {
                // Differences of values of about one, divided by a quarter up to twice.
                assert!((found - expected).abs() < 64.0 * f64::EPSILON, "{x}");
            }
        }
        let top = through.top(0.8).expect("the cubic has a maximum at 1");
        assert!((top - 1.0).abs() < 64.0 * f64::EPSILON);
    }
}

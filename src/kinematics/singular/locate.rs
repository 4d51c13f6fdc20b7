//! The singular position near a pose, found and classified in the reduced equation.

use std::fmt;

use super::reduced::{ReducedEquation, ReducedPoint};

/// The kind of a singular position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SingularKind {
    /// A dead point: the motion turns back. No velocity exists there.
    DeadPoint,
    /// A change point: two motions cross.
    ChangePoint,
    /// A dead point at which the poses of the block turn back along a cusp, not a parabola.
    Cusp,
    /// Two motions that touch, or coincide.
    TangentBranches,
    /// The Jacobian loses more than one rank.
    HigherRank,
}

impl fmt::Display for SingularKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::DeadPoint => "dead point",
            Self::ChangePoint => "change point that cannot be crossed here",
            Self::Cusp => "cusp",
            Self::TangentBranches => "point where two motions touch",
            Self::HigherRank => "singular position of higher order",
        })
    }
}

/// The largest ε that counts as rounding, per scaled length.
pub(super) const EPSILON_ROUNDING: f64 = 64.0 * f64::EPSILON;
/// The same behind a block that comes from a crossing: the accuracy of the interpolation, which is
/// more than the rounding of any mechanism near the origin.
const EPSILON_INTERPOLATED: f64 = 1e-10;
/// Most Newton corrections in the plane of α and τ. A few are enough where it converges
/// quadratically; where motions touch, each of them removes about a third of the distance.
const MOST_CORRECTIONS: usize = 60;
/// A correction of this length, scaled, ends the search.
const CONVERGED: f64 = 1e-13;
/// A correction up to this length ends it as well once corrections stop falling: large angles have
/// more rounding.
const NEARLY: f64 = 1e-9;
/// Least ratio of a correction to the one before that has stopped falling. At a degenerate position
/// they fall by a half or a third each time. Halved, the search ends there at [`NEARLY`], where a cusp
/// is not told from a dead point. At one, it goes on as long as rounding falls by chance.
const STALLED: f64 = 0.75;
/// Squared sine of the largest angle between two motions that count as touching.
const TOUCHING: f64 = 1e-8;
/// A singular value up to this part of the largest one is zero.
const NO_RANK: f64 = 1e-8;
/// Ratio of the extreme pivots of a bordered Jacobian above which it is regular.
const REGULAR: f64 = 1e-4;

/// The result of a search near a pose.
pub(super) enum Finding {
    /// No position that stops the motion, which may pass near one.
    Nothing,
    /// The motion turns back, or reaches a position that cannot be crossed.
    End(SingularKind, Box<ReducedPoint>),
    /// Two motions cross, with these slopes dα/dτ: first the slope of the motion through the pose;
    /// the other one may be infinite.
    Crossing(Box<ReducedPoint>, [f64; 2]),
}

/// Looks for a singular position within the distance `reach` of the point at the start, scaled by
/// the speed of the motion there.
pub(super) fn find(equation: &mut ReducedEquation<'_>, start: ReducedPoint, reach: f64) -> Finding {
    let rounding = if equation.reads_crossings() {
        EPSILON_INTERPOLATED
    } else {
        EPSILON_ROUNDING * equation.extent()
    };
    let mut near = None;
    if let Some(point) = critical(equation, start.clone(), reach) {
        if point.epsilon.abs() <= rounding {
            return crossing(equation, point);
        }
        match vertex(&point, start.tau) {
            Vertex::Here([alpha, tau]) => near = Some([alpha, tau - start.tau]),
            // The motion passes by.
            Vertex::Nowhere => return Finding::Nothing,
            Vertex::Far => {}
        }
    }
    let from = match near {
        Some(by) => equation.solve(start, by),
        None => Some(start),
    };
    let fold = from.and_then(|from| {
        newton(equation, from, reach, |point| {
            let [aa, at, _] = point.second;
            ([point.epsilon, point.first[0]], [point.first, [aa, at]])
        })
    });
    match fold {
        Some(point) => {
            let kind = end(equation, &point);
            // Motions that cross seem to touch, too, as far as they can be told apart there.
            if kind == SingularKind::TangentBranches
                && let Some(point) = critical(equation, point.clone(), reach)
                && point.epsilon.abs() <= rounding
            {
                return crossing(equation, point);
            }
            Finding::End(kind, Box::new(point))
        }
        None => Finding::Nothing,
    }
}

/// Looks for a critical point of ε.
fn critical(
    equation: &mut ReducedEquation<'_>,
    from: ReducedPoint,
    reach: f64,
) -> Option<ReducedPoint> {
    newton(equation, from, reach, |point| {
        let [aa, at, tt] = point.second;
        (point.first, [[aa, at], [at, tt]])
    })
}

/// Solves two equations in the plane of α and τ by Newton's method from a point; `equations` returns
/// their values and their Jacobian.
fn newton(
    equation: &mut ReducedEquation<'_>,
    mut point: ReducedPoint,
    reach: f64,
    equations: impl Fn(&ReducedPoint) -> ([f64; 2], [[f64; 2]; 2]),
) -> Option<ReducedPoint> {
    let speed = equation.speed;
    let mut last = f64::INFINITY;
    for step in 0..MOST_CORRECTIONS {
        let ([f, g], [[fa, ft], [ga, gt]]) = equations(&point);
        let determinant = fa * gt - ft * ga;
        let by_alpha = -(f * gt - g * ft) / determinant;
        let by_tau = -(g * fa - f * ga) / determinant;
        let length = by_alpha.abs().max(by_tau.abs() * speed);
        if length <= CONVERGED {
            // The last correction takes off what rounding alone does not explain.
            return Some(equation.extrapolate(point, [by_alpha, by_tau]));
        }
        if step > 2 && length < NEARLY && length >= STALLED * last {
            return Some(point);
        }
        // Not a number is not within reach either.
        let within = length <= reach
            && (point.alpha + by_alpha).abs() <= 2.0 * reach
            && (point.tau + by_tau - equation.start()).abs() * speed <= 2.0 * reach;
        if !within {
            return None;
        }
        point = equation.solve(point, [by_alpha, by_tau])?;
        last = length;
    }
    // Convergence by halves means a degenerate position, and near enough to name it.
    (last < NEARLY).then_some(point)
}

/// The place where a hyperbola turns back.
enum Vertex {
    Here([f64; 2]),
    Nowhere,
    Far,
}

/// Returns the place where the hyperbola ε = 0 near a saddle turns back, on the side of `start`:
/// there ε_α = 0. Nowhere if its branches are the other two.
fn vertex(saddle: &ReducedPoint, start: f64) -> Vertex {
    let [aa, at, tt] = saddle.second;
    let discriminant = at * at - aa * tt;
    // ε = ε_C − ½ (D / ε_αα) (τ − τ_C)² where ε_α = 0.
    let square = 2.0 * saddle.epsilon * aa / discriminant;
    if !(discriminant > 0.0 && square.is_finite()) || saddle.epsilon.abs() > 1e-4 {
        return Vertex::Far;
    }
    if square < 0.0 {
        return Vertex::Nowhere;
    }
    let off = square.sqrt().copysign(start - saddle.tau);
    Vertex::Here([saddle.alpha - at / aa * off, saddle.tau + off])
}

/// Returns whether the Jacobian loses more than one rank at a point, the last place.
fn loses_more_ranks(equation: &ReducedEquation<'_>, point: &ReducedPoint) -> bool {
    // Then the bordered Jacobian is singular, too.
    if point.pivot_ratio > REGULAR {
        return false;
    }
    let values = equation.singular_values();
    values.len() > 1 && values[values.len() - 2] <= NO_RANK * values[0]
}

/// Returns the kind of a point with ε = ε_α = 0.
fn end(equation: &ReducedEquation<'_>, point: &ReducedPoint) -> SingularKind {
    if loses_more_ranks(equation, point) {
        return SingularKind::HigherRank;
    }
    let [aa, at, tt] = point.second;
    let speed = equation.speed;
    let largest = aa
        .abs()
        .max(at.abs() / speed)
        .max(tt.abs() / (speed * speed));
    let steep = point.first[1].abs() / speed;
    if steep <= NO_RANK {
        SingularKind::TangentBranches
    } else if aa.abs() <= TOUCHING * largest.max(steep) {
        SingularKind::Cusp
    } else {
        SingularKind::DeadPoint
    }
}

/// Separates the two motions that cross at a saddle of ε with ε = 0.
fn crossing(equation: &ReducedEquation<'_>, point: ReducedPoint) -> Finding {
    let refuse = |kind, point| Finding::End(kind, Box::new(point));
    if loses_more_ranks(equation, &point) {
        return refuse(SingularKind::HigherRank, point);
    }
    // Scaled, so that α and τ run equally fast.
    let speed = equation.speed;
    let [a, b, c] = point.second;
    let (b, c) = (b / speed, c / (speed * speed));
    let discriminant = b * b - a * c;
    let largest = a.abs().max(b.abs()).max(c.abs());
    if discriminant.is_nan() || discriminant <= TOUCHING * largest * largest {
        return refuse(SingularKind::TangentBranches, point);
    }
    let sum = -(b + discriminant.sqrt().copysign(b));
    // a α′² + 2 b α′ + c = 0, without cancellation; a = 0 leaves one of them infinite.
    let slopes = [sum / a, c / sum];
    // The pose, at α = 0, lies on one of them.
    let off = [-point.alpha, (equation.start() - point.tau) * speed];
    let away = |slope: f64| {
        let along = if slope.is_finite() {
            [slope, 1.0]
        } else {
            [1.0, 0.0]
        };
        let cross = off[0] * along[1] - off[1] * along[0];
        cross.abs() / along[0].hypot(along[1])
    };
    let own = usize::from(away(slopes[1]) < away(slopes[0]));
    let slopes = [slopes[own] * speed, slopes[1 - own] * speed];
    if slopes[0].is_finite() {
        Finding::Crossing(Box::new(point), slopes)
    } else {
        // On the motion through the pose the driver rests.
        refuse(SingularKind::TangentBranches, point)
    }
}

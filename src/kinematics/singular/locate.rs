//! Singular positions near a pose, found and told apart in the reduced equation.

use std::fmt;

use super::reduced::{Reduced, Sheet};

/// A singular position of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SingularKind {
    /// A dead point: the motion turns back. No velocity exists there.
    DeadPoint,
    /// A change point: two motions cross.
    ChangePoint,
    /// A dead point at which the poses of the block do not turn back as a parabola does.
    Cusp,
    /// Two motions that touch, or run together.
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

/// The largest ε, in eps of the mechanism's size, that counts as rounding.
pub(super) const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// The same where what is read comes from a crossing: how well that is interpolated, and more than
/// the rounding of any mechanism that lies near the origin.
const INTERPOLATED: f64 = 1e-10;
/// Newton's corrections in the plane of α and τ. Where it converges quadratically a few are
/// enough; where motions touch each of them takes a part of the distance, a third as a rule.
const MAX_STEPS: usize = 60;
/// A correction of this length, scaled, ends the search.
const CONVERGED: f64 = 1e-13;
/// One that was to end it, but did not for the rounding of large angles, may be this long.
const NEARLY: f64 = 1e-9;
/// The square of the sine of the angle between two motions that count as touching.
const TOUCHING: f64 = 1e-8;
/// A singular value of this part of the largest is zero.
const NO_RANK: f64 = 1e-8;

/// What was found near a pose.
pub(super) enum Finding {
    /// Nothing that stops the motion: it may pass near by.
    Nothing,
    /// The motion turns back, or comes to what has to be refused.
    End(SingularKind, Box<Sheet>),
    /// Two motions cross. The slopes dα/dτ of both, that of the motion on which the pose lies
    /// first; the other one's may be infinite.
    Crossing(Box<Sheet>, [f64; 2]),
}

/// Looks for a singular position within `reach` of the start, in scaled units of the motion's
/// speed there.
pub(super) fn find(block: &mut Reduced<'_>, reach: f64) -> Finding {
    let start = block.start;
    let critical = newton(block, [0.0, start], reach, |sheet| {
        let [aa, at, tt] = sheet.second;
        (sheet.first, [[aa, at], [at, tt]])
    });
    let mut near = None;
    if let Some(sheet) = critical {
        let rounding = if block.reads_crossings() {
            INTERPOLATED
        } else {
            ROUNDING * block.extent()
        };
        if sheet.epsilon.abs() <= rounding {
            return crossing(block, sheet);
        }
        match vertex(&sheet, start) {
            Vertex::Here(place) => near = Some(place),
            // The motion passes by.
            Vertex::Nowhere => return Finding::Nothing,
            Vertex::Far => {}
        }
    }
    let from = near.unwrap_or([0.0, start]);
    block.return_to_start();
    let fold = newton(block, from, reach, |sheet| {
        let [aa, at, _] = sheet.second;
        ([sheet.epsilon, sheet.first[0]], [sheet.first, [aa, at]])
    });
    match fold {
        Some(sheet) => {
            let kind = end(block, &sheet);
            Finding::End(kind, Box::new(sheet))
        }
        None => Finding::Nothing,
    }
}

/// Newton's method in the plane of α and τ on two functions of it with their Jacobian.
fn newton(
    block: &mut Reduced<'_>,
    [mut alpha, mut tau]: [f64; 2],
    reach: f64,
    equations: impl Fn(&Sheet) -> ([f64; 2], [[f64; 2]; 2]),
) -> Option<Sheet> {
    let speed = block.speed;
    let mut last = f64::INFINITY;
    for step in 0..MAX_STEPS {
        let sheet = block.sheet(alpha, tau)?;
        let ([f, g], [[fa, ft], [ga, gt]]) = equations(&sheet);
        let determinant = fa * gt - ft * ga;
        let by_alpha = -(f * gt - g * ft) / determinant;
        let by_tau = -(g * fa - f * ga) / determinant;
        let length = by_alpha.abs().max(by_tau.abs() * speed);
        if length <= CONVERGED || (step > 2 && length < NEARLY && length >= 0.5 * last) {
            return Some(sheet);
        }
        // Not a number is not within reach either.
        let within = length <= reach
            && (alpha + by_alpha).abs() <= 2.0 * reach
            && (tau + by_tau - block.start).abs() * speed <= 2.0 * reach;
        if !within {
            return None;
        }
        alpha += by_alpha;
        tau += by_tau;
        last = length;
    }
    // What converges no better than by halves is degenerate, and near enough to be named.
    if last < NEARLY {
        block.sheet(alpha, tau)
    } else {
        None
    }
}

enum Vertex {
    Here([f64; 2]),
    Nowhere,
    Far,
}

/// Where the hyperbola that ε is near a saddle turns back, on the side of `start`: at ε = 0 and
/// ε_α = 0. Nowhere if its branches are the other two.
fn vertex(saddle: &Sheet, start: f64) -> Vertex {
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

fn loses_more_ranks(block: &Reduced<'_>) -> bool {
    let values = block.singular_values();
    values.len() > 1 && values[values.len() - 2] <= NO_RANK * values[0]
}

/// What kind of end a point with ε = ε_α = 0 is.
fn end(block: &Reduced<'_>, sheet: &Sheet) -> SingularKind {
    if loses_more_ranks(block) {
        return SingularKind::HigherRank;
    }
    let [aa, at, tt] = sheet.second;
    let speed = block.speed;
    let largest = aa
        .abs()
        .max(at.abs() / speed)
        .max(tt.abs() / (speed * speed));
    let steep = sheet.first[1].abs() / speed;
    if steep <= NO_RANK {
        SingularKind::TangentBranches
    } else if aa.abs() <= TOUCHING * largest.max(steep) {
        SingularKind::Cusp
    } else {
        SingularKind::DeadPoint
    }
}

/// Tells the two motions apart that cross at a saddle of ε with ε = 0.
fn crossing(block: &Reduced<'_>, sheet: Sheet) -> Finding {
    let refuse = |kind, sheet| Finding::End(kind, Box::new(sheet));
    if loses_more_ranks(block) {
        return refuse(SingularKind::HigherRank, sheet);
    }
    // Scaled, so that α and τ run equally fast.
    let speed = block.speed;
    let [a, b, c] = sheet.second;
    let (b, c) = (b / speed, c / (speed * speed));
    let discriminant = b * b - a * c;
    let largest = a.abs().max(b.abs()).max(c.abs());
    if discriminant.is_nan() || discriminant <= TOUCHING * largest * largest {
        return refuse(SingularKind::TangentBranches, sheet);
    }
    let sum = -(b + discriminant.sqrt().copysign(b));
    // a α′² + 2 b α′ + c = 0, without cancellation; a = 0 leaves one of them infinite.
    let slopes = [sum / a, c / sum];
    // The pose, at α = 0, lies on one of them.
    let off = [-sheet.alpha, (block.start - sheet.tau) * speed];
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
        Finding::Crossing(Box::new(sheet), slopes)
    } else {
        // The pose is on the motion on which the line stands still.
        refuse(SingularKind::TangentBranches, sheet)
    }
}

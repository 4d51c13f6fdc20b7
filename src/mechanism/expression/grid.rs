//! Functions of two arguments through the points of a grid.

use super::points::nearest;
use crate::mechanism::{Ends, Expression, Interval, Number, ParameterId};

/// A function of two arguments: a value for each pair of abscissas.
#[derive(Clone, Debug)]
pub struct Grid {
    /// First and second abscissas, each rising, two at least.
    abscissas: [Vec<f64>; 2],
    /// Per point, by rows of one first abscissa: value, its slopes along both arguments, and the slope of
    /// one along the other.
    points: Vec<[f64; 4]>,
    /// Whether it is a spline, otherwise bilinear.
    is_smooth: bool,
    /// Course outside: [`Ends::Clamped`], [`Ends::Linear`] or [`Ends::Zero`].
    ends: Ends,
    /// Factors of both arguments and of the values.
    pub(in crate::mechanism) scale: [Expression; 3],
}

impl Grid {
    /// Makes the function through `values`, rows of one first abscissa each. A spline is cubic along each
    /// argument, with no knot at the second and the last but one point.
    pub(in crate::mechanism) fn new(
        abscissas: [Vec<f64>; 2],
        values: &[f64],
        is_smooth: bool,
        ends: Ends,
        scale: [Expression; 3],
    ) -> Self {
        let [rows, columns] = abscissas.each_ref().map(Vec::len);
        let mut points: Vec<[f64; 4]> = values.iter().map(|f| [*f, 0.0, 0.0, 0.0]).collect();
        if is_smooth {
            // Slopes along each argument, then those of the first slopes along the second.
            let mut lay = |axis: usize, from: usize, to: usize| {
                let (lines, count, step) = match axis {
                    0 => (columns, rows, columns),
                    _ => (rows, columns, 1),
                };
                for line in 0..lines {
                    let first = if axis == 0 { line } else { line * columns };
                    let place = |k: usize| first + k * step;
                    let own: Vec<f64> = (0..count).map(|k| points[place(k)][from]).collect();
                    for (k, slope) in slopes(&abscissas[axis], &own).into_iter().enumerate() {
                        points[place(k)][to] = slope;
                    }
                }
            };
            lay(0, 0, 1);
            lay(1, 0, 2);
            lay(1, 1, 3);
        }
        Self {
            abscissas,
            points,
            is_smooth,
            ends,
            scale,
        }
    }

    /// Returns the order of the first derivative that jumps somewhere, 0 for the value itself.
    pub(in crate::mechanism) fn first_jump(&self) -> Option<usize> {
        match (self.ends, self.is_smooth) {
            (Ends::Zero, _) => Some(0),
            (Ends::Linear, true) => Some(2),
            _ => Some(1),
        }
    }

    /// Returns the value, or bounds of it over ranges of the arguments, with its derivatives.
    pub(in crate::mechanism) fn evaluate<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        arguments: [N; 2],
    ) -> N {
        let zero = N::constant(0.0);
        let [first, second, up] =
            (self.scale.each_ref()).map(|factor| factor.evaluate(parameter, zero));
        let [x, y] = arguments;
        let value = self.joined(0, x / first, &|first| {
            self.joined(1, y / second, &|second| self.on(first, second))
        });
        value * up
    }

    /// Joins the values on the pieces that an argument may meet.
    fn joined<N: Number>(&self, axis: usize, x: N, value: &dyn Fn(Piece<N>) -> N) -> N {
        let inside = if self.is_smooth { 3 } else { 1 };
        let at_ends = self.first_jump().unwrap_or(inside).min(inside);
        let mut found: Option<(N, bool)> = None;
        for piece in self.pieces(axis, x) {
            let own = value(piece);
            let all = match found {
                Some((found, was_outside)) if was_outside == piece.is_outside => {
                    found.joined(own, inside)
                }
                Some((found, _)) => found.joined(own, at_ends),
                None => own,
            };
            found = Some((all, piece.is_outside));
        }
        found.map_or_else(N::unknown, |(value, _)| value)
    }

    /// Returns the pieces that an argument may meet, in their order.
    fn pieces<N: Number>(&self, axis: usize, x: N) -> impl Iterator<Item = Piece<N>> {
        let abscissas = &self.abscissas[axis];
        let last = abscissas.len() - 1;
        let (start, end) = (abscissas[0], abscissas[last]);
        let range = x.range();
        let segment = |x: f64| abscissas[1..last].partition_point(|knot| *knot <= x);
        let outside = move |segment: usize, at: f64, x: N| Piece {
            segment,
            at: N::constant(at),
            beyond: match self.ends {
                Ends::Linear => x - N::constant(at),
                _ => N::constant(0.0),
            },
            is_outside: true,
        };
        let below = (range.low < start).then(|| outside(0, start, x));
        let above = (range.high > end).then(|| outside(last - 1, end, x));
        let segments = if x.is_single() {
            segment(range.low)..segment(range.low) + 1
        } else {
            segment(range.low).saturating_sub(1)..segment(range.high) + 1
        };
        let inside = segments.filter_map(move |segment| {
            let part = Interval::new(abscissas[segment], abscissas[segment + 1]);
            Some(Piece {
                segment,
                at: x.within(part)?,
                beyond: N::constant(0.0),
                is_outside: false,
            })
        });
        below.into_iter().chain(inside).chain(above)
    }

    /// Returns the value on a piece of each argument: the polynomial of a cell at the border, and from
    /// there straight on.
    fn on<N: Number>(&self, first: Piece<N>, second: Piece<N>) -> N {
        if self.ends == Ends::Zero && (first.is_outside || second.is_outside) {
            return N::constant(0.0);
        }
        let columns = self.abscissas[1].len();
        let corner = |i: usize, j: usize| {
            let point = (first.segment + i) * columns + second.segment + j;
            self.points[point].map(N::constant)
        };
        let shape = |axis: usize, piece: Piece<N>| {
            let [from, to] = [0, 1].map(|k| self.abscissas[axis][piece.segment + k]);
            self.shape([from, to], piece)
        };
        let (along_first, along_second) = (shape(0, first), shape(1, second));
        let mut sum = N::constant(0.0);
        for (i, [value_i, slope_i]) in along_first.into_iter().enumerate() {
            for (j, [value_j, slope_j]) in along_second.into_iter().enumerate() {
                let [f, f_x, f_y, f_xy] = corner(i, j);
                sum += value_i * (f * value_j + f_y * slope_j);
                sum += slope_i * (f_x * value_j + f_xy * slope_j);
            }
        }
        sum
    }

    /// Returns the factors of value and slope at both ends of a segment: Hermite's cubics, or the straight
    /// lines of a bilinear function.
    fn shape<N: Number>(&self, [from, to]: [f64; 2], piece: Piece<N>) -> [[N; 2]; 2] {
        let (one, zero) = (N::constant(1.0), N::constant(0.0));
        let width = N::constant(to - from);
        let t = (piece.at - N::constant(from)) / width;
        let u = one - t;
        if !self.is_smooth {
            let out = piece.beyond / width;
            return [[u - out, zero], [t + out, zero]];
        }
        let h = |k: f64| N::constant(k);
        // Value and slope along the segment of each factor.
        let at_start = [u * u * (one + h(2.0) * t), t * u * u * width];
        let at_end = [t * t * (one + h(2.0) * u), zero - t * t * u * width];
        let steep = h(6.0) * t * u / width;
        let rises = [zero - steep, u * (u - h(2.0) * t)];
        let falls = [steep, t * (t - h(2.0) * u)];
        let beyond = |value: [N; 2], slope: [N; 2]| {
            [
                value[0] + slope[0] * piece.beyond,
                value[1] + slope[1] * piece.beyond,
            ]
        };
        [beyond(at_start, rises), beyond(at_end, falls)]
    }

    /// Returns the nearest abscissas of an argument at or below `x` and above it at which the function has
    /// a corner or jumps; infinite where there is none.
    pub(super) fn corners(&self, axis: usize, factor: f64, x: f64) -> [f64; 2] {
        let abscissas = &self.abscissas[axis];
        let last = abscissas.len() - 1;
        let corners = match (self.is_smooth, self.ends) {
            (true, Ends::Linear) => return [f64::NEG_INFINITY, f64::INFINITY],
            (false, Ends::Linear) => &abscissas[1..last],
            (false, _) => &abscissas[..],
            (true, _) => {
                return nearest(
                    [abscissas[0] * factor, abscissas[last] * factor].into_iter(),
                    x,
                );
            }
        };
        nearest(corners.iter().map(|abscissa| abscissa * factor), x)
    }

    /// Returns the first and the last abscissa of an argument, before scaling.
    pub(super) fn ends(&self, axis: usize) -> [f64; 2] {
        let abscissas = &self.abscissas[axis];
        [abscissas[0], abscissas[abscissas.len() - 1]]
    }
}

/// A piece of an argument: a place in a segment, and how far the argument is beyond it, outside.
#[derive(Clone, Copy, Debug)]
struct Piece<N> {
    segment: usize,
    at: N,
    beyond: N,
    is_outside: bool,
}

/// Returns the slopes of a cubic spline through points with no knot at the second and the last but one:
/// the third derivative is continuous there. Two points make a straight line, three a parabola.
fn slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let segments = x.len() - 1;
    let width = |k: usize| x[k + 1] - x[k];
    let chord = |k: usize| (y[k + 1] - y[k]) / width(k);
    if segments == 1 {
        return vec![chord(0); 2];
    }
    if segments == 2 {
        let bend = (chord(1) - chord(0)) / (x[2] - x[0]);
        return vec![
            chord(0) - bend * width(0),
            chord(0) + bend * width(0),
            chord(1) + bend * width(1),
        ];
    }
    // Rows [lower, diagonal, upper, side]: h s₋ + 2 (h + h₋) s + h₋ s₊ = 3 (h d₋ + h₋ d), with the widths
    // h and chords d before and behind a point.
    let mut rows: Vec<[f64; 4]> = vec![[0.0; 4]; segments + 1];
    for (k, row) in rows.iter_mut().enumerate().take(segments).skip(1) {
        let [before, after] = [width(k - 1), width(k)];
        let side = 3.0 * (after * chord(k - 1) + before * chord(k));
        *row = [after, 2.0 * (before + after), before, side];
    }
    let end = |[h, next]: [f64; 2], [d, d_next]: [f64; 2]| {
        let side = ((h + 2.0 * (h + next)) * next * d + h * h * d_next) / (h + next);
        [next, h + next, side]
    };
    let [diagonal, upper, side] = end([width(0), width(1)], [chord(0), chord(1)]);
    rows[0] = [0.0, diagonal, upper, side];
    let (a, b) = (segments - 1, segments - 2);
    let [diagonal, lower, side] = end([width(a), width(b)], [chord(a), chord(b)]);
    rows[segments] = [lower, diagonal, 0.0, side];
    for k in 1..=segments {
        let factor = rows[k][0] / rows[k - 1][1];
        rows[k][1] -= factor * rows[k - 1][2];
        rows[k][3] -= factor * rows[k - 1][3];
    }
    let mut slopes = vec![0.0; segments + 1];
    for k in (0..=segments).rev() {
        let after = slopes.get(k + 1).map_or(0.0, |after| rows[k][2] * after);
        slopes[k] = (rows[k][3] - after) / rows[k][1];
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spline with no knot at the second and last but one point is exact for a cubic.
    #[test]
    fn cubics_are_met() {
        let x = [-1.0, -0.2, 0.5, 0.9, 2.0];
        let cubic = |x: f64| 2.0 - x + 3.0 * x * x - 0.5 * x * x * x;
        let slope = |x: f64| -1.0 + 6.0 * x - 1.5 * x * x;
        let y = x.map(cubic);
        for (found, x) in slopes(&x, &y).into_iter().zip(x) {
            assert!((found - slope(x)).abs() < 1e-13, "{x}: {found}");
        }
        let parabola = |x: f64| 1.0 + x * x;
        let found = slopes(&x[..3], &x.map(parabola)[..3]);
        for (found, x) in found.into_iter().zip(x) {
            assert!((found - 2.0 * x).abs() < 1e-14);
        }
    }
}

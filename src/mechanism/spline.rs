//! Cubic splines through given points: twice continuously differentiable.

use super::{Interval, Number};

/// End conditions of a spline, and what a function through points is outside them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// At rest: the slope of a spline is zero at both ends, the end values hold outside.
    Clamped,
    /// The second derivative is zero at both ends; outside it goes on straight.
    Natural,
    /// It repeats. Where the last value differs from the first, each period starts from where
    /// the one before ended.
    Periodic,
    /// Outside it goes on with the slope that it has at the end; a spline is natural.
    Linear,
    /// Outside it is zero; a spline is natural.
    Zero,
}

impl Ends {
    /// Returns whether the second derivative of a spline is zero at its ends.
    fn are_natural(self) -> bool {
        matches!(self, Self::Natural | Self::Linear | Self::Zero)
    }
}

/// Cubic spline on plain numbers or on numbers with derivatives.
///
/// Made once for a number of points; [`points_mut`](Self::points_mut) and [`fit`](Self::fit) then
/// change it without allocating.
#[derive(Clone, Debug)]
pub struct Spline<N> {
    knots: Vec<N>,
    values: Vec<N>,
    /// Second derivatives at the knots.
    moments: Vec<N>,
    /// Work space of the elimination.
    upper: Vec<N>,
    corner: Vec<N>,
    ends: Ends,
}

impl<N: Number> Spline<N> {
    /// Makes a spline through `count` points, at least two, which are set later.
    #[must_use]
    pub fn new(count: usize, ends: Ends) -> Self {
        assert!(count >= 2, "a spline has two points at least");
        let zeros = vec![N::constant(0.0); count];
        Self {
            knots: zeros.clone(),
            values: zeros.clone(),
            moments: zeros.clone(),
            upper: zeros.clone(),
            corner: zeros,
            ends,
        }
    }

    /// Returns the abscissas and the ordinates. Call [`fit`](Self::fit) after a change.
    pub fn points_mut(&mut self) -> (&mut [N], &mut [N]) {
        (&mut self.knots, &mut self.values)
    }

    /// Returns the abscissas.
    #[must_use]
    pub fn knots(&self) -> &[N] {
        &self.knots
    }

    /// Returns the ordinates.
    #[must_use]
    pub fn values(&self) -> &[N] {
        &self.values
    }

    /// Returns whether each abscissa is larger than the one before, and every number finite.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let rises = |pair: &[N]| pair[0].real() < pair[1].real();
        self.knots.windows(2).all(rises)
            && (self.knots.iter().chain(&self.values)).all(|number| number.real().is_finite())
    }

    /// Finds the second derivatives M for which the first is continuous.
    pub fn fit(&mut self) {
        let Self {
            knots,
            values,
            moments,
            upper,
            corner,
            ends,
        } = self;
        let points = Points {
            knots,
            values,
            ends: *ends,
        };
        points.fit(moments, [upper, corner]);
    }

    /// Returns the segment that contains `x`, the nearest one if `x` is beyond the ends.
    #[must_use]
    pub fn segment(&self, x: f64) -> usize {
        self.laid().segment_of(x)
    }

    /// Returns the points with the second derivatives.
    pub(in crate::mechanism) fn laid(&self) -> Laid<'_, N> {
        Laid {
            knots: &self.knots,
            values: &self.values,
            moments: &self.moments,
        }
    }

    /// Returns the value at `x`, by the cubic of a segment.
    #[must_use]
    pub fn on_segment(&self, segment: usize, x: N) -> N {
        self.laid().part(segment).value(x)
    }

    /// Returns the first derivative at `x`, by the cubic of a segment.
    #[must_use]
    pub fn slope_on_segment(&self, segment: usize, x: N) -> N {
        self.laid().part(segment).slope(x)
    }

    /// Returns the second and third derivatives at `x`, by the cubic of a segment.
    #[must_use]
    pub fn curvature_on_segment(&self, segment: usize, x: N) -> [N; 2] {
        let Segment {
            abscissas, moments, ..
        } = self.laid().part(segment);
        let third = (moments[1] - moments[0]) / (abscissas[1] - abscissas[0]);
        [moments[0] + (x - abscissas[0]) * third, third]
    }
}

/// Points through which a spline is laid.
pub(in crate::mechanism) struct Points<'a, N> {
    pub(in crate::mechanism) knots: &'a [N],
    pub(in crate::mechanism) values: &'a [N],
    pub(in crate::mechanism) ends: Ends,
}

impl<N: Number> Points<'_, N> {
    /// Finds the second derivatives M for which the first is continuous.
    ///
    /// The matrix of their equations, one per knot, is diagonally dominant, so that elimination
    /// needs no pivots. That of a periodic spline has two more entries, in its corners: elimination
    /// carries the column of the last unknown along and reduces the last row step by step.
    pub(in crate::mechanism) fn fit(&self, moments: &mut [N], [uppers, corners]: [&mut [N]; 2]) {
        let zero = N::constant(0.0);
        let is_periodic = self.ends == Ends::Periodic;
        // The last knot of a period is the first one of the next.
        let last = self.knots.len() - if is_periodic { 2 } else { 1 };
        let corner_entry = if is_periodic { self.width(last) } else { zero };
        let [last_lower, mut last_diagonal, _, mut last_side] = self.equation(last);
        // The last row's entry in the column under elimination.
        let mut last_entry = corner_entry;
        for row in 0..last {
            let [lower, mut pivot, mut upper, mut side] = self.equation(row);
            let mut corner = if row == 0 { corner_entry } else { zero };
            if row + 1 == last {
                corner += upper;
                upper = zero;
                last_entry += last_lower;
            }
            if row > 0 {
                pivot -= lower * uppers[row - 1];
                corner -= lower * corners[row - 1];
                side -= lower * moments[row - 1];
            }
            uppers[row] = upper / pivot;
            corners[row] = corner / pivot;
            moments[row] = side / pivot;
            last_diagonal -= last_entry * corners[row];
            last_side -= last_entry * moments[row];
            last_entry = zero - last_entry * uppers[row];
        }
        // A single segment repeats as a straight line.
        moments[last] = if last == 0 {
            zero
        } else {
            last_side / last_diagonal
        };
        for row in (0..last).rev() {
            moments[row] =
                moments[row] - uppers[row] * moments[row + 1] - corners[row] * moments[last];
        }
        if is_periodic {
            moments[last + 1] = moments[0];
        }
    }

    /// Returns the equation of a knot: the factors of M before, at and after it, and the right-hand
    /// side.
    ///
    /// With h the widths and d the slopes of the chords beside the knot it is
    /// `h₋ M₋ + 2 (h₋ + h) M + h M₊ = 6 (d − d₋)`. Beyond a clamped end h and d are zero.
    fn equation(&self, knot: usize) -> [N; 4] {
        let zero = N::constant(0.0);
        let segments = self.knots.len() - 1;
        let beside = match self.ends {
            Ends::Periodic => [Some((knot + segments - 1) % segments), Some(knot)],
            _ => [knot.checked_sub(1), Some(knot).filter(|k| *k < segments)],
        };
        if self.ends.are_natural() && beside.contains(&None) {
            return [zero, N::constant(1.0), zero, zero];
        }
        let [left, right] = beside.map(|k| k.map_or(zero, |k| self.width(k)));
        let [before, after] = beside.map(|k| k.map_or(zero, |k| self.slope(k)));
        let diagonal = N::constant(2.0) * (left + right);
        [left, diagonal, right, N::constant(6.0) * (after - before)]
    }

    fn width(&self, segment: usize) -> N {
        self.knots[segment + 1] - self.knots[segment]
    }

    fn slope(&self, segment: usize) -> N {
        (self.values[segment + 1] - self.values[segment]) / self.width(segment)
    }
}

/// The stretch from one point of a spline to the next.
#[derive(Clone, Copy, Debug)]
pub(in crate::mechanism) struct Segment<N> {
    /// At both ends.
    pub(in crate::mechanism) abscissas: [N; 2],
    /// At both ends.
    pub(in crate::mechanism) ordinates: [N; 2],
    /// Second derivatives at both ends.
    pub(in crate::mechanism) moments: [N; 2],
}

impl<N: Number> Segment<N> {
    /// Returns the value at `x`, by the cubic.
    pub(in crate::mechanism) fn value(&self, x: N) -> N {
        let [[from, to], [low, high], [before, after]] =
            [self.abscissas, self.ordinates, self.moments];
        let width = to - from;
        let b = (x - from) / width;
        let a = (to - x) / width;
        let bend = (a * a * a - a) * before + (b * b * b - b) * after;
        a * low + b * high + bend * width * width / N::constant(6.0)
    }

    /// Returns the first derivative at `x`, by the cubic.
    pub(in crate::mechanism) fn slope(&self, x: N) -> N {
        let [[from, to], [low, high], [before, after]] =
            [self.abscissas, self.ordinates, self.moments];
        let (half, sixth) = (N::constant(0.5), N::constant(1.0 / 6.0));
        let width = to - from;
        let (left, right) = (x - from, to - x);
        let bend = left * left * after - right * right * before;
        let chord = (high - low) / width;
        chord + half * bend / width - sixth * width * (after - before)
    }
}

/// Points with the second derivatives of a spline through them, which a function through points is
/// evaluated on.
pub(in crate::mechanism) trait Knots<N: Number> {
    /// Returns the number of points.
    fn count(&self) -> usize;

    /// Returns the abscissa of a point.
    fn abscissa(&self, point: usize) -> N;

    /// Returns the ordinate of a point.
    fn ordinate(&self, point: usize) -> N;

    /// Returns the stretch from a point to the next one.
    fn part(&self, segment: usize) -> Segment<N>;

    /// Returns the segment that contains `x`, the nearest one if `x` is beyond the ends.
    fn segment_of(&self, x: f64) -> usize;

    /// Returns whether all points are single numbers.
    fn are_single(&self) -> bool {
        (0..self.count()).all(|point| self.abscissa(point).is_single())
    }

    /// Returns whether each abscissa is larger than the one before, whatever single numbers they are.
    fn rise(&self) -> bool {
        let mut segments = 0..self.count() - 1;
        segments.all(|segment| {
            let Segment { abscissas, .. } = self.part(segment);
            abscissas[0].range().high < abscissas[1].range().low
        })
    }

    /// Returns the segments that a range may meet.
    fn segments_in(&self, _range: Interval) -> std::ops::Range<usize> {
        0..self.count() - 1
    }
}

/// Points on their own numbers.
#[derive(Clone, Copy, Debug)]
pub(in crate::mechanism) struct Laid<'a, N> {
    pub(in crate::mechanism) knots: &'a [N],
    pub(in crate::mechanism) values: &'a [N],
    pub(in crate::mechanism) moments: &'a [N],
}

impl<N: Number> Knots<N> for Laid<'_, N> {
    fn count(&self) -> usize {
        self.knots.len()
    }

    fn abscissa(&self, point: usize) -> N {
        self.knots[point]
    }

    fn ordinate(&self, point: usize) -> N {
        self.values[point]
    }

    fn part(&self, segment: usize) -> Segment<N> {
        let ends = |of: &[N]| [of[segment], of[segment + 1]];
        Segment {
            abscissas: ends(self.knots),
            ordinates: ends(self.values),
            moments: ends(self.moments),
        }
    }

    fn segment_of(&self, x: f64) -> usize {
        let inner = &self.knots[1..self.knots.len() - 1];
        inner.partition_point(|knot| knot.real() <= x)
    }
}

/// Points that no parameter moves, on any numbers.
#[derive(Clone, Copy, Debug)]
pub(in crate::mechanism) struct Fixed<'a>(pub(in crate::mechanism) &'a Spline<f64>);

impl<N: Number> Knots<N> for Fixed<'_> {
    fn count(&self) -> usize {
        self.0.knots.len()
    }

    fn abscissa(&self, point: usize) -> N {
        N::constant(self.0.knots[point])
    }

    fn ordinate(&self, point: usize) -> N {
        N::constant(self.0.values[point])
    }

    fn part(&self, segment: usize) -> Segment<N> {
        let part = self.0.laid().part(segment);
        let on_numbers = |of: [f64; 2]| of.map(N::constant);
        Segment {
            abscissas: on_numbers(part.abscissas),
            ordinates: on_numbers(part.ordinates),
            moments: on_numbers(part.moments),
        }
    }

    fn segment_of(&self, x: f64) -> usize {
        self.0.segment(x)
    }

    fn are_single(&self) -> bool {
        true
    }

    fn rise(&self) -> bool {
        true
    }

    fn segments_in(&self, range: Interval) -> std::ops::Range<usize> {
        // A point belongs to the segment that begins there, and to the one before.
        let first = self.0.segment(range.low).saturating_sub(1);
        first..self.0.segment(range.high) + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn spline(points: &[(f64, f64)], ends: Ends) -> Spline<f64> {
        let mut spline = Spline::new(points.len(), ends);
        let (knots, values) = spline.points_mut();
        for (k, (x, y)) in points.iter().enumerate() {
            (knots[k], values[k]) = (*x, *y);
        }
        spline.fit();
        spline
    }

    /// Points with widths between 0.1 and 2 and values up to 3.
    fn points(count: usize) -> impl Strategy<Value = Vec<(f64, f64)>> {
        prop::collection::vec((0.1..2.0_f64, -3.0..3.0_f64), count).prop_map(|steps| {
            let mut x = -1.0;
            steps
                .into_iter()
                .map(|(width, y)| {
                    x += width;
                    (x, y)
                })
                .collect()
        })
    }

    fn all(spline: &Spline<f64>, segment: usize, x: f64) -> [f64; 3] {
        [
            spline.on_segment(segment, x),
            spline.slope_on_segment(segment, x),
            spline.curvature_on_segment(segment, x)[0],
        ]
    }

    // Widths of 0.1 and values of 3 make slopes of 60 and second derivatives of some 6 · 60/0.1,
    // which carry 1e-16 relative each; the conditions hold to some thousand ulp of those.
    const ROUNDING: f64 = 1e-10;

    proptest! {
        /// Value, slope and second derivative meet at each knot, and the ends are as asked for:
        /// these conditions determine the spline.
        #[test]
        fn pieces_meet(
            points in (2_usize..9).prop_flat_map(points),
            ends in prop::sample::select(vec![
                Ends::Clamped, Ends::Natural, Ends::Linear, Ends::Zero, Ends::Periodic,
            ]),
        ) {
            let spline = spline(&points, ends);
            prop_assert!(spline.is_valid());
            let last = points.len() - 2;
            for (k, (x, y)) in points.iter().enumerate() {
                prop_assert!((spline.on_segment(k.min(last), *x) - y).abs() < ROUNDING);
                prop_assert_eq!(spline.segment(*x), k.min(last));
                if 0 < k && k <= last {
                    let (before, after) = (all(&spline, k - 1, *x), all(&spline, k, *x));
                    for (before, after) in before.iter().zip(after) {
                        prop_assert!((before - after).abs() < ROUNDING, "{before} {after}");
                    }
                }
            }
            let first = all(&spline, 0, points[0].0);
            let end = all(&spline, last, points[last + 1].0);
            match ends {
                Ends::Clamped => {
                    prop_assert!(first[1].abs() < ROUNDING && end[1].abs() < ROUNDING);
                }
                Ends::Natural | Ends::Linear | Ends::Zero => {
                    prop_assert!(first[2].abs() < ROUNDING && end[2].abs() < ROUNDING);
                }
                Ends::Periodic => {
                    prop_assert!((first[1] - end[1]).abs() < ROUNDING);
                    prop_assert!((first[2] - end[2]).abs() < ROUNDING);
                }
            }
        }

        /// The derivatives are those of the value: on a cubic, central differences of third
        /// order are exact up to the cubic's own term, here by comparing with its expansion.
        #[test]
        fn derivatives_agree(points in points(4), part in 0.0..1.0_f64, step in -0.5..0.5_f64) {
            let spline = spline(&points, Ends::Natural);
            for segment in 0..3 {
                let (low, high) = (points[segment].0, points[segment + 1].0);
                let x = low + part * (high - low);
                let h = step * (high - low);
                let [value, first, second] = all(&spline, segment, x);
                let third = spline.curvature_on_segment(segment, x)[1];
                let expanded = value + h * (first + h * (0.5 * second + h * third / 6.0));
                let there = spline.on_segment(segment, x + h);
                prop_assert!((expanded - there).abs() < ROUNDING, "{expanded} {there}");
            }
        }
    }

    #[test]
    fn order_and_finite_numbers_make_it_valid() {
        assert!(!spline(&[(0.0, 1.0), (0.0, 2.0)], Ends::Natural).is_valid());
        assert!(!spline(&[(1.0, 1.0), (0.0, 2.0)], Ends::Clamped).is_valid());
        assert!(!spline(&[(0.0, 1.0), (1.0, f64::NAN)], Ends::Periodic).is_valid());
        assert!(!spline(&[(f64::NAN, 1.0), (1.0, 1.0)], Ends::Periodic).is_valid());
    }
}

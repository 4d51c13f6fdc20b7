//! Bounds of a function and of its derivatives over a range of its variable.

use super::{Interval, Jet3, Number};

/// Encloses a function and its first three derivatives over a range of the variable: `f` on the
/// variable as an interval with derivatives.
///
/// `None` where the function cannot be shown to be three times differentiable with finite
/// derivatives in the whole range. The narrower the range, the nearer are the bounds to the true
/// ones: their excess is of first order in its width for the third derivative, of higher order for
/// the others.
pub(in crate::mechanism) fn enclose(
    f: impl Fn(Jet3<Interval>) -> Jet3<Interval>,
    range: Interval,
) -> Option<Jet3<Interval>> {
    let middle = range.midpoint();
    let [there, parts] = expand(f, range, middle)?;
    let narrowed = parts.narrowed(there, range - Interval::point(middle));
    Some(narrowed).filter(|bounds| bounds.is_finite())
}

/// Encloses a function and its first three derivatives in one point and, less narrowly than
/// [`enclose`], over a range; `None` as there.
pub(in crate::mechanism) fn expand(
    f: impl Fn(Jet3<Interval>) -> Jet3<Interval>,
    range: Interval,
    point: f64,
) -> Option<[Jet3<Interval>; 2]> {
    let bounds = |range| Some(f(Jet3::variable(range))).filter(|bounds| bounds.is_finite());
    // Only the whole range shows a kink between two parts.
    bounds(range)?;
    let middle = range.midpoint();
    let ends = [
        range.low,
        range.low.midpoint(middle),
        middle,
        middle.midpoint(range.high),
        range.high,
    ];
    let mut parts = bounds(Interval::new(ends[0], ends[1]))?;
    for pair in ends[1..].windows(2) {
        parts = parts.hull(bounds(Interval::new(pair[0], pair[1]))?);
    }
    Some([bounds(Interval::point(point))?, parts])
}

impl Jet3<Interval> {
    /// Returns the bounds that enclose both, order by order.
    // Inlined, it would be many times in the libraries of FMUs.
    #[inline(never)]
    pub(in crate::mechanism) fn hull(self, other: Self) -> Self {
        self.pairwise(other, |x, y| Interval::hull([x, y]))
    }

    /// Returns narrower bounds of a function by Taylor's theorem: `there` holds in a point from
    /// which the whole range lies within `offset`; the third derivative makes the remainder.
    fn narrowed(self, there: Self, offset: Interval) -> Self {
        let half_square = offset.square() * 0.5;
        let second = there.second() + self.third() * offset;
        let first = there.first() + there.second() * offset + self.third() * half_square;
        let value = there.value
            + there.first() * offset
            + there.second() * half_square
            + self.third() * offset.cube() / Interval::point(6.0);
        self.pairwise(
            Self::new(value, [first, second, self.third()]),
            Interval::intersection,
        )
    }

    fn pairwise(self, other: Self, of: impl Fn(Interval, Interval) -> Interval) -> Self {
        let [x, y] = [self, other].map(|number| number.derivatives);
        let derivatives = [0, 1, 2].map(|k| of(x[k], y[k]));
        Self::new(of(self.value, other.value), derivatives)
    }
}

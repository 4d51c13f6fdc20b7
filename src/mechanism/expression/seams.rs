//! Whether a function is continuous where parts of it jump.
//!
//! Interval arithmetic finds no bound of the slope across a jump, even where another part cancels
//! it, as in `floor(x) + mod(x, 1)`. Between the jumps it does: what is left are *seams*, stretches
//! of a few roundings, across which the function is compared with itself.

use crate::mechanism::number::{Interval, Jet, Jet3, Number};

/// Width of a part that is not halved further, as a part of the range.
const NARROWEST: f64 = 1.0 / (1_u64 << 26) as f64;
/// Width of such a part in units of the variable, or of its magnitude where that is more: some
/// roundings. Halved, seams in ranges of a few roundings take twice as many parts. Doubled, a jump
/// and its return within 2e-15 count as none.
const NARROW_ROUNDINGS: f64 = 4.0 * f64::EPSILON;
/// Distance from a seam at which the function is evaluated, likewise: rounding moves the jumps of
/// parts, so that next to them they do not cancel. A number counts as whole some 4e-15 of it below
/// one: halved, that is still far from there. Doubled, jumps of parts 2e-12 apart count as one.
const BESIDE: f64 = 1e-12;
/// Change of the function across a seam that is rounding, relative to its value or one.
const JUMP: f64 = 1e-9;
/// Most parts that wait while a range is halved down to [`NARROWEST`].
const MOST_PARTS: usize = 32;
/// Most parts that are examined: those of some ten seams.
const MOST_LOOKS: usize = 600;

/// Returns whether a function is continuous over a range: across each stretch without a bound of the
/// slope it must not change by more than its slopes make it. `bounds` encloses it over a part, `at`
/// evaluates it. Allocates nothing.
pub(crate) fn joins(
    range: Interval,
    bounds: impl Fn(Interval) -> Jet3<Interval>,
    at: impl Fn(f64) -> Jet,
) -> bool {
    let is_smooth = |part| bounds(part).first().is_finite();
    seams(range, is_smooth, |[from, to]| {
        let [before, after] = [from, to].map(&at);
        let slope = before.first().abs() + after.first().abs();
        let rounding = JUMP * (1.0 + before.value.abs());
        (after.value - before.value).abs() <= 2.0 * slope * (to - from) + rounding
    })
}

/// Shows `meets` a place before and one behind each stretch of a range of which `is_smooth` holds for
/// no part: halves each part down to a few roundings. Returns whether it holds for all of them, and
/// they are not too many.
pub(in crate::mechanism) fn seams(
    range: Interval,
    is_smooth: impl Fn(Interval) -> bool,
    mut meets: impl FnMut([f64; 2]) -> bool,
) -> bool {
    let unit = range.magnitude().max(1.0);
    let Interval { low, high } = range;
    let value = |part: f64| low + part * (high - low);
    let mut meets = |[from, to]: [f64; 2]| meets([from - BESIDE * unit, to + BESIDE * unit]);
    // The seam that the parts examined last make.
    let mut seam: Option<[f64; 2]> = None;
    // Parts still to be examined, the first one last.
    let mut open = [[0.0, 1.0]; MOST_PARTS];
    let mut count = 1_usize;
    for _ in 0..MOST_LOOKS {
        let Some(last) = count.checked_sub(1) else {
            return seam.is_none_or(meets);
        };
        count = last;
        let [from, to] = open[last];
        let ends = [value(from), value(to)];
        let is_narrow = to - from <= NARROWEST || ends[1] - ends[0] <= NARROW_ROUNDINGS * unit;
        if is_smooth(Interval::new(ends[0], ends[1])) {
            if !seam.take().is_none_or(&mut meets) {
                return false;
            }
        } else if is_narrow || last + 2 > MOST_PARTS {
            let begin = seam.map_or(ends[0], |[begin, _]| begin);
            seam = Some([begin, ends[1]]);
        } else {
            let middle = from.midpoint(to);
            open[last] = [middle, to];
            open[last + 1] = [from, middle];
            count = last + 2;
        }
    }
    false
}

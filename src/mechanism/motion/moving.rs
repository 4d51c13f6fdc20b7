//! Bounds of motions and of curves through points over a stretch in which their numbers move.
//!
//! Abscissas, ordinates and the variable are functions of the place on a sub-step, enclosed over
//! all of it. Pieces that the variable may meet join with their slopes for any of these numbers:
//! the hull of their bounds holds for the whole curve and its slope, and for their derivatives up
//! to the first that jumps.

use super::{Law, MotionInForce, PrescribedMotion};
use crate::mechanism::spline::Knots;
use crate::mechanism::{Interpolation, Interval, Jet3, Number, Spline, Taylor};

/// A number along a sub-step.
type Enclosed = Jet3<Interval>;

impl MotionInForce<Enclosed> {
    /// Encloses the value over the range of `t`, with derivatives with respect to the variable of
    /// evaluation; bounds that are not known are not finite. `None` where the times of a table may
    /// not rise, or more than one period begins. Allocates nothing.
    #[must_use]
    pub fn enclose(&self, t: Enclosed) -> Option<Enclosed> {
        match (&self.motion, &self.spline) {
            (PrescribedMotion::Expression(_), _) => Some(self.evaluate(t)),
            (PrescribedMotion::Table(motion), Some(spline)) if spline.laid().rise() => {
                Some(motion.evaluate(&spline.laid(), t))
            }
            (PrescribedMotion::Table(_), _) => None,
        }
    }
}

impl Interpolation {
    /// Encloses the curve through the points of a spline and its slope for abscissas `x`, within
    /// the first and the last point; `None` if `x` is beyond them.
    pub(in crate::mechanism) fn enclose(
        self,
        spline: &Spline<Enclosed>,
        x: Enclosed,
    ) -> Option<[Enclosed; 2]> {
        let knots = spline.knots();
        let mut found: Option<[Enclosed; 2]> = None;
        for segment in 0..knots.len() - 1 {
            let [from, to] = [segment, segment + 1].map(|k| knots[k].value);
            let Some(x) = clipped(x, Interval::new(from.low, to.high)) else {
                continue;
            };
            let piece = match self {
                Self::Spline => {
                    let slope = spline.slope_on_segment(segment, x);
                    [spline.on_segment(segment, x), slope]
                }
                Self::Law(law) => law.enclose(spline, segment, x)?,
                Self::Linear | Self::Steps => {
                    let part = spline.laid().part(segment);
                    let slope = self.slope_at(&part, 0);
                    [self.on(&part, x), slope]
                }
            };
            found = Some(found.map_or(piece, |found| self.join(found, piece)));
        }
        found
    }

    /// Returns bounds of the curve and of its slope over two pieces that join.
    pub(in crate::mechanism) fn join(
        self,
        [value, slope]: [Enclosed; 2],
        piece: [Enclosed; 2],
    ) -> [Enclosed; 2] {
        let mut slope = slope.hull(piece[1]);
        if self.jumps() {
            // It has a corner.
            slope.derivatives[1] = Interval::unknown();
        }
        [value.hull(piece[0]), slope]
    }
}

impl Law {
    /// Encloses a rise between two points and its slope, piece by piece of the law.
    fn enclose(
        self,
        spline: &Spline<Enclosed>,
        segment: usize,
        x: Enclosed,
    ) -> Option<[Enclosed; 2]> {
        let [from, to] = [segment, segment + 1].map(|k| spline.knots()[k]);
        let [low, high] = [segment, segment + 1].map(|k| spline.values()[k]);
        let width = to - from;
        let tau = (x - from) / width;
        let pieces = Self::PIECES.windows(2).filter_map(|part| {
            let tau = clipped(tau, Interval::new(part[0], part[1]))?;
            let stroke = self.stroke(Taylor::<Enclosed, 1>::variable(tau));
            let rise = high - low;
            Some([low + rise * stroke.value, rise * stroke.first() / width])
        });
        pieces.reduce(|found, piece| Interpolation::Law(self).join(found, piece))
    }
}

/// Returns the part of a number within a range; `None` if it has none.
fn clipped(x: Enclosed, range: Interval) -> Option<Enclosed> {
    let part = x.value.intersection(range);
    (!part.is_undefined()).then(|| Enclosed::new(part, x.derivatives))
}

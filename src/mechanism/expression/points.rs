//! Functions through points: of a motion, of a coupling's law, or called by name.

use super::table::Table;
use crate::mechanism::spline::{Fixed, Knots, Laid, Points, Segment};
use crate::mechanism::{Ends, Interval, Law, Number, ParameterId, Spline};

/// A function of one argument through given points.
#[derive(Clone, Debug)]
pub struct PointFunction {
    /// Abscissas, rising, and ordinates.
    pub table: Table,
    /// Course from one point to the next.
    pub interpolation: Interpolation,
    /// Course before the first and after the last point.
    pub ends: Ends,
}

/// Course of a function from one point of its table to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// A cubic spline through all points.
    Spline,
    /// From rest to rest between neighbours.
    Law(Law),
    /// A straight line between neighbours.
    Linear,
    /// The value of a point until the next one.
    Steps,
}

/// Order of a derivative that no function has: none jumps.
const NONE_JUMPS: usize = 4;

impl Interpolation {
    /// Returns whether the second derivative jumps somewhere.
    #[must_use]
    pub fn jumps(self) -> bool {
        self.first_jump() <= 2
    }

    /// Returns the order of the first derivative that jumps at a point, 0 for the value itself.
    #[must_use]
    pub fn first_jump(self) -> usize {
        match self {
            Self::Spline => 3,
            Self::Law(law) if law.jumps() => 2,
            Self::Law(_) => 3,
            Self::Linear => 1,
            Self::Steps => 0,
        }
    }

    /// Returns the value at `x` on a segment.
    pub(in crate::mechanism) fn on<N: Number>(self, part: &Segment<N>, x: N) -> N {
        let [[from, to], [low, high]] = [part.abscissas, part.ordinates];
        match self {
            Self::Spline => part.value(x),
            Self::Law(law) => low + (high - low) * law.stroke((x - from) / (to - from)),
            Self::Linear => low + (high - low) * ((x - from) / (to - from)),
            Self::Steps => low,
        }
    }

    /// Returns the slope at the beginning (0) or the end (1) of a segment.
    pub(in crate::mechanism) fn slope_at<N: Number>(self, part: &Segment<N>, end: usize) -> N {
        let [[from, to], [low, high]] = [part.abscissas, part.ordinates];
        match self {
            Self::Spline => part.slope(part.abscissas[end]),
            Self::Linear => (high - low) / (to - from),
            Self::Law(_) | Self::Steps => N::constant(0.0),
        }
    }

    /// Returns bounds of the values for a range of `x` within a segment.
    fn over<N: Number>(self, part: &Segment<N>, x: N) -> Option<N> {
        let [from, to] = part.abscissas;
        let x = x.within(Interval::new(from.range().low, to.range().high))?;
        let Self::Law(law) = self else {
            return Some(self.on(part, x));
        };
        // Piece by piece of the law.
        let [low, high] = part.ordinates;
        let tau = (x - from) / (to - from);
        let pieces = Law::PIECES.windows(2).filter_map(|piece| {
            let tau = tau.within(Interval::new(piece[0], piece[1]))?;
            Some(low + (high - low) * law.stroke(tau))
        });
        pieces.reduce(|found, piece| found.joined(piece, self.first_jump()))
    }
}

impl PointFunction {
    /// Returns the order of the first derivative that jumps somewhere, 0 for the value itself; `None` if
    /// those up to the third are continuous or bounded.
    #[must_use]
    pub fn first_jump(&self) -> Option<usize> {
        let jump = self.interpolation.first_jump().min(self.jump_at_ends());
        (jump <= 2).then_some(jump)
    }

    /// Returns the order of the first derivative that jumps at the first and the last point.
    fn jump_at_ends(&self) -> usize {
        match (self.ends, self.interpolation) {
            (Ends::Zero, _) => 0,
            (Ends::Clamped, Interpolation::Spline) => 2,
            (Ends::Clamped, Interpolation::Linear) => 1,
            // The last value holds.
            (Ends::Clamped | Ends::Linear | Ends::Natural, Interpolation::Steps)
            | (Ends::Linear | Ends::Natural, Interpolation::Linear) => NONE_JUMPS,
            (_, interpolation) => interpolation.first_jump(),
        }
    }

    /// Returns the value at `x`, or bounds of it over a range of `x` and of the points, with its
    /// derivatives.
    ///
    /// At a point the derivatives are those of the next piece.
    pub(in crate::mechanism) fn evaluate<N: Number>(&self, knots: &dyn Knots<N>, x: N) -> N {
        if !x.is_single() || !knots.are_single() {
            return self.over(knots, x).unwrap_or_else(N::unknown);
        }
        let last = knots.count() - 1;
        let (start, end) = (knots.abscissa(0), knots.abscissa(last));
        match self.ends {
            Ends::Periodic => {
                let period = end - start;
                let laps = ((x.real() - start.real()) / period.real()).floor();
                let laps = N::constant(laps);
                let gained = laps * (knots.ordinate(last) - knots.ordinate(0));
                gained + self.between(knots, x - laps * period)
            }
            _ if x.real() < start.real() => self.beyond(knots, 0, x),
            // The value at the last point still counts.
            Ends::Zero if x.real() <= end.real() => self.between(knots, x),
            _ if x.real() >= end.real() => self.beyond(knots, last, x),
            _ => self.between(knots, x),
        }
    }

    /// Returns the value within the points.
    fn between<N: Number>(&self, knots: &dyn Knots<N>, x: N) -> N {
        let segment = knots.segment_of(x.real());
        let last = knots.count() - 1;
        // A step up to the last point is passed there.
        if self.interpolation == Interpolation::Steps && x.real() >= knots.abscissa(last).real() {
            return knots.ordinate(last);
        }
        self.interpolation.on(&knots.part(segment), x)
    }

    /// Returns the value before the first or after the last point.
    fn beyond<N: Number>(&self, knots: &dyn Knots<N>, point: usize, x: N) -> N {
        let (from, value) = (knots.abscissa(point), knots.ordinate(point));
        match self.ends {
            Ends::Natural | Ends::Linear => {
                let segment = point.saturating_sub(1);
                let end = usize::from(point > 0);
                let slope = self.interpolation.slope_at(&knots.part(segment), end);
                value + slope * (x - from)
            }
            Ends::Zero => N::constant(0.0),
            Ends::Clamped | Ends::Periodic => value,
        }
    }

    /// Returns bounds over all pieces that `x` may meet; `None` where abscissas may not rise, or more than
    /// one period begins.
    fn over<N: Number>(&self, knots: &dyn Knots<N>, x: N) -> Option<N> {
        let last = knots.count() - 1;
        if !knots.rise() {
            return None;
        }
        let (start, end) = (knots.abscissa(0), knots.abscissa(last));
        if self.ends != Ends::Periodic {
            let before = x.range().low < start.range().high;
            let after = x.range().high >= end.range().low;
            let beyond = [(before, 0), (after, last)].into_iter();
            let beyond = beyond.filter(|(meets, _)| *meets);
            let beyond = beyond.map(|(_, point)| self.beyond(knots, point, x));
            let inside = self.inside(knots, x);
            let join = |found: N, piece| found.joined(piece, self.jump_at_ends());
            return beyond.chain(inside).reduce(join);
        }
        let period = end - start;
        let laps = ((x - start) / period).range().floor();
        let gain = knots.ordinate(last) - knots.ordinate(0);
        let on_lap = |lap: f64| {
            let laps = N::constant(lap);
            let inside = self.inside(knots, x - laps * period);
            inside.map(|value| laps * gain + value)
        };
        let before = on_lap(laps.low)?;
        match laps.high - laps.low {
            0.0 => Some(before),
            1.0 => Some(before.joined(on_lap(laps.high)?, self.jump_at_ends())),
            _ => None,
        }
    }

    /// Returns bounds over the segments that `x` may meet.
    fn inside<N: Number>(&self, knots: &dyn Knots<N>, x: N) -> Option<N> {
        let segments = knots.segments_in(x.range());
        let pieces = segments.filter_map(|k| self.interpolation.over(&knots.part(k), x));
        pieces.reduce(|found, piece| found.joined(piece, self.interpolation.first_jump()))
    }
}

/// Most points of a spline that is laid anew for each call, as parameters move its points: as many as one
/// writes by hand. Doubled, a call takes twice as much of the stack, some 80 kB for numbers of a proof.
pub(crate) const MOST_MOVING_POINTS: usize = 64;

/// A function through points for any parameters, ready to be evaluated.
#[derive(Clone, Debug)]
pub struct CalledPoints {
    function: PointFunction,
    /// Through the points in SI units, if no parameter moves points or factors; before scaling, if
    /// parameters move the factors alone.
    fixed: Option<Spline<f64>>,
    /// Whether the factors are still to be multiplied.
    is_scaled_later: bool,
}

impl CalledPoints {
    /// Makes the function; `None` for more than [`MOST_MOVING_POINTS`] points that parameters move.
    pub(in crate::mechanism) fn new(function: PointFunction) -> Option<Self> {
        let table = &function.table;
        let is_literal = |mut of: std::slice::Iter<'_, _>| {
            of.all(|number: &crate::mechanism::Expression| number.literal().is_some())
        };
        let has_fixed_points = table.points.iter().all(|point| is_literal(point.iter()));
        let is_scaled_later = has_fixed_points && !is_literal(table.scale.iter());
        if !has_fixed_points && table.points.len() > MOST_MOVING_POINTS {
            return None;
        }
        let fixed = has_fixed_points.then(|| {
            let mut spline = Spline::new(table.points.len(), function.ends);
            let (x, y) = spline.points_mut();
            let none = |_| f64::NAN;
            if is_scaled_later {
                table.write_unscaled(&none, x, y)
            } else {
                table.write(&none, x, y)
            }
            spline.fit();
            spline
        });
        Some(Self {
            function,
            fixed,
            is_scaled_later,
        })
    }

    /// Returns the points and their course.
    #[must_use]
    pub fn function(&self) -> &PointFunction {
        &self.function
    }

    /// Returns the value at `x`. Allocates nothing.
    pub(in crate::mechanism) fn evaluate<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        x: N,
    ) -> N {
        match &self.fixed {
            Some(spline) if self.is_scaled_later => {
                let [across, up] = self.function.table.factors(parameter);
                let inside = self.function.evaluate(&Fixed(spline), x / across);
                inside * up
            }
            Some(spline) => self.function.evaluate(&Fixed(spline), x),
            None => self.evaluate_moving(parameter, x),
        }
    }

    /// Returns the value at `x` where parameters move the points.
    // Inlined, its arrays would be on the stack of each expression.
    #[inline(never)]
    fn evaluate_moving<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N, x: N) -> N {
        let table = &self.function.table;
        let count = table.points.len();
        let zeros = [N::constant(0.0); MOST_MOVING_POINTS];
        let (mut knots, mut values, mut moments) = (zeros, zeros, zeros);
        let [knots, values, moments] =
            [&mut knots, &mut values, &mut moments].map(|numbers| &mut numbers[..count]);
        table.write(parameter, knots, values);
        let rises = |pair: &[N]| pair[0].real() < pair[1].real();
        if !knots.windows(2).all(rises) {
            return N::unknown();
        }
        if self.function.interpolation == Interpolation::Spline {
            let points = Points {
                knots,
                values,
                ends: self.function.ends,
            };
            let (mut upper, mut corner) = (zeros, zeros);
            points.fit(moments, [&mut upper[..count], &mut corner[..count]]);
        }
        let laid = Laid {
            knots,
            values,
            moments,
        };
        self.function.evaluate(&laid, x)
    }

    /// Returns the first and the last abscissa for these parameters; `None` where the points repeat.
    pub(in crate::mechanism) fn ends(
        &self,
        parameter: &impl Fn(ParameterId) -> f64,
    ) -> Option<[f64; 2]> {
        let PointFunction { table, ends, .. } = &self.function;
        let [across, _] = table.factors(parameter);
        let points = [table.points.first()?, table.points.last()?];
        let abscissas = points.map(|[x, _]| x.evaluate(parameter, 0.0) * across);
        (*ends != Ends::Periodic).then_some(abscissas)
    }

    /// Returns the abscissas at which the function has a corner or jumps, for these parameters: the
    /// nearest one at or below `x` and the nearest one above; infinite where there is none.
    pub(in crate::mechanism) fn corners(
        &self,
        parameter: &impl Fn(ParameterId) -> f64,
        x: f64,
    ) -> [f64; 2] {
        let none = [f64::NEG_INFINITY, f64::INFINITY];
        let PointFunction {
            table,
            interpolation,
            ends,
        } = &self.function;
        let (inside, at_ends) = (interpolation.first_jump(), self.function.jump_at_ends());
        if inside > 1 && at_ends > 1 {
            return none;
        }
        let [across, _] = table.factors(parameter);
        let abscissa = |point: usize| table.points[point][0].evaluate(parameter, 0.0) * across;
        let last = table.points.len() - 1;
        let (start, end) = (abscissa(0), abscissa(last));
        let (first, end_point) = match (inside > 1, at_ends > 1) {
            // Only the ends.
            (true, _) => return nearest([start, end].into_iter(), x),
            (false, true) => (1, last),
            (false, false) => (0, last + 1),
        };
        let lap = match ends {
            Ends::Periodic => ((x - start) / (end - start)).floor() * (end - start),
            _ => 0.0,
        };
        nearest((first..end_point).map(|point| abscissa(point) + lap), x)
    }
}

/// Returns the largest number up to `x` and the smallest above it.
pub(super) fn nearest(numbers: impl Iterator<Item = f64>, x: f64) -> [f64; 2] {
    let around = [f64::NEG_INFINITY, f64::INFINITY];
    numbers.fold(around, |[below, above], number| {
        if number <= x {
            [below.max(number), above]
        } else {
            [below, above.min(number)]
        }
    })
}

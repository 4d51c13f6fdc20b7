//! Contours through points, once round.

use std::f64::consts::TAU;

use super::ProfileError;
use crate::mechanism::spline::{Fixed, Knots};
use crate::mechanism::{
    Dual, Ends, Interpolation, Interval, Jet3, Law, Number, ParameterId, Spline, Table,
};

/// A contour through points: a segment leads from each point to the next, the last one back to the
/// first point.
#[derive(Clone, Debug)]
pub(super) struct ClosedPoints<N> {
    interpolation: Interpolation,
    /// Through the points, the last of which is the first one, a turn later.
    spline: Spline<N>,
}

impl<N: Number> ClosedPoints<N> {
    /// Makes a contour through `count` points, which are set later.
    pub(super) fn new(count: usize, interpolation: Interpolation) -> Self {
        Self {
            interpolation,
            spline: Spline::new(count + 1, Ends::Periodic),
        }
    }

    /// Writes the points of a table.
    fn write(&mut self, table: &Table, parameter: &impl Fn(ParameterId) -> N) {
        let (angles, radii) = self.spline.points_mut();
        table.write(parameter, angles, radii);
        let last = angles.len() - 1;
        (angles[last], radii[last]) = (angles[0] + N::constant(TAU), radii[0]);
    }

    /// Lays the segments through the points.
    fn fit(&mut self) {
        if self.interpolation == Interpolation::Spline {
            self.spline.fit();
        }
    }
}

impl ClosedPoints<f64> {
    /// Takes over the points of a table.
    ///
    /// # Errors
    ///
    /// Their angles do not rise within one turn.
    pub(super) fn set(
        &mut self,
        table: &Table,
        parameter: &impl Fn(ParameterId) -> f64,
    ) -> Result<(), ProfileError> {
        self.write(table, parameter);
        if !self.spline.is_valid() {
            return Err(ProfileError::Disordered);
        }
        self.fit();
        Ok(())
    }

    /// Returns the contour through the points of its table for parameters that change along a
    /// direction.
    pub(super) fn along(
        &self,
        table: &Table,
        parameter: &impl Fn(ParameterId) -> Jet3<Dual>,
    ) -> ClosedPoints<Jet3<Dual>> {
        let mut along = ClosedPoints::new(table.points.len(), self.interpolation);
        along.write(table, parameter);
        along.fit();
        along
    }

    /// Makes the contour for points that move, which are set later.
    pub(super) fn moving(&self) -> ClosedPoints<Jet3<Interval>> {
        ClosedPoints::new(self.spline.knots().len() - 1, self.interpolation)
    }

    /// Returns whether the second derivative may jump.
    pub(super) fn jumps(&self) -> bool {
        self.interpolation.jumps()
    }

    /// Returns R and its first three derivatives at a polar angle, of any number of turns.
    pub(super) fn radius(&self, theta: f64) -> Jet3 {
        let theta = self.first_turn(theta);
        self.on_segment(self.spline.segment(theta), theta)
    }

    /// Returns the angle in the turn that the points cover.
    fn first_turn(&self, theta: f64) -> f64 {
        let start = self.spline.knots()[0];
        start + (theta - start).rem_euclid(TAU)
    }

    /// Returns R and its first three derivatives on one segment.
    fn on_segment(&self, segment: usize, theta: f64) -> Jet3 {
        let spline = &self.spline;
        match self.interpolation {
            Interpolation::Spline => {
                let [second, third] = spline.curvature_on_segment(segment, theta);
                Jet3::new(
                    spline.on_segment(segment, theta),
                    [spline.slope_on_segment(segment, theta), second, third],
                )
            }
            interpolation => interpolation.on(&Fixed(spline).part(segment), Jet3::variable(theta)),
        }
    }

    /// Returns bounds for polar angles up to `reach` from `theta`.
    pub(super) fn bounds(&self, theta: f64, reach: f64) -> Jet3<Interval> {
        let knots = self.spline.knots();
        let segments = knots.len() - 1;
        let reach = reach.min(0.5 * TAU);
        let low = self.first_turn(theta - reach);
        let high = low + 2.0 * reach;
        // The segment that contains `low`, then what else the region meets; it may go on past the
        // end of the turn, into its beginning.
        let first = self.spline.segment(low);
        let end = high.min(knots[first + 1]).max(low);
        let mut bounds = self.segment_bounds(first, [low, end]);
        for lap in [0.0, TAU] {
            for segment in 0..segments {
                let from = (knots[segment] + lap).max(low);
                let to = (knots[segment + 1] + lap).min(high);
                if from < to {
                    bounds = bounds.hull(self.segment_bounds(segment, [from - lap, to - lap]));
                }
            }
        }
        bounds
    }

    /// Returns bounds on a part of one segment.
    fn segment_bounds(&self, segment: usize, [from, to]: [f64; 2]) -> Jet3<Interval> {
        let law = match self.interpolation {
            Interpolation::Spline => {
                let third = self.on_segment(segment, from.midpoint(to)).third();
                return self.around_middle(segment, [from, to], Interval::point(third));
            }
            Interpolation::Linear | Interpolation::Steps => {
                return self.around_middle(segment, [from, to], Interval::point(0.0));
            }
            Interpolation::Law(law) => law,
        };
        // Piece by piece of the law: within each the third derivative is continuous.
        let (knots, radii) = (self.spline.knots(), self.spline.values());
        let width = knots[segment + 1] - knots[segment];
        let stroke = radii[segment + 1] - radii[segment];
        let mut bounds: Option<Jet3<Interval>> = None;
        for (piece, part) in Law::PIECES.windows(2).enumerate() {
            let [first, last] = [piece == 0, piece + 2 == Law::PIECES.len()];
            let [begin, end] = [part[0], part[1]].map(|part| knots[segment] + part * width);
            // The first and the last piece take what rounding leaves.
            let begin = if first { from } else { begin.max(from) };
            let end = if last { to } else { end.min(to) };
            if begin > end {
                continue;
            }
            let tau = [begin, end].map(|x| ((x - knots[segment]) / width).clamp(part[0], part[1]));
            let third = law
                .stroke(Jet3::variable(Interval::new(tau[0], tau[1])))
                .third();
            let third = third * Interval::point(stroke / (width * width * width));
            let piece = self.around_middle(segment, [begin, end], third);
            bounds = Some(bounds.map_or(piece, |bounds| bounds.hull(piece)));
        }
        bounds.expect("the pieces cover the segment")
    }

    /// Returns bounds on a part of one segment with this bound of the third derivative: each
    /// derivative differs from its value in the middle by at most half the width times the bound of
    /// the next one.
    fn around_middle(
        &self,
        segment: usize,
        [from, to]: [f64; 2],
        third: Interval,
    ) -> Jet3<Interval> {
        let half = 0.5 * (to - from);
        let middle = self.on_segment(segment, from + half);
        let around = |value: f64, slope: Interval| {
            let off = half * slope.magnitude();
            Interval::new(value - off, value + off)
        };
        let second = around(middle.second(), third);
        let first = around(middle.first(), second);
        Jet3::new(around(middle.value, first), [first, second, third])
    }
}

impl ClosedPoints<Jet3<Interval>> {
    /// Takes over the points of a table whose parameters move.
    pub(super) fn set_moving(
        &mut self,
        table: &Table,
        parameter: &impl Fn(ParameterId) -> Jet3<Interval>,
    ) {
        self.write(table, parameter);
        self.fit();
    }

    /// Encloses R and R′ for a moving polar angle; `None` where the points may not rise.
    pub(super) fn enclose(&self, theta: Jet3<Interval>) -> Option<[Jet3<Interval>; 2]> {
        if !self.spline.laid().rise() {
            return None;
        }
        let start = self.spline.knots()[0].value;
        let parts = parts_of_turn(theta, start).into_iter();
        let parts = parts.filter_map(|theta| self.interpolation.enclose(&self.spline, theta));
        parts.reduce(|found, part| self.interpolation.join(found, part))
    }
}

impl ClosedPoints<Jet3<Dual>> {
    /// Returns R and its first three derivatives at a polar angle, of any number of turns, each
    /// with its change along a direction.
    pub(super) fn radius_along(&self, theta: Dual) -> Jet3<Dual> {
        let spline = &self.spline;
        let start = spline.knots()[0].value.value;
        let turn = start + (theta.value - start).rem_euclid(TAU);
        let theta = Jet3::variable(Dual::new(turn, theta.derivatives));
        let segment = spline.segment(turn);
        self.interpolation.on(&spline.laid().part(segment), theta)
    }
}

/// Returns an angle in the turn that begins at `start`, and a turn before and after that.
pub(super) fn parts_of_turn(theta: Jet3<Interval>, start: Interval) -> [Jet3<Interval>; 3] {
    let turn = |turns: f64| Jet3::constant(turns * TAU);
    let turns = ((theta.value.low - start.low) / TAU).floor();
    [turns - 1.0, turns, turns + 1.0].map(|turns| theta - turn(turns))
}

//! Relations that are watched over a sub-step without being solved.

use crate::kinematics::certificate::{Pivots, StepBounds};
use crate::kinematics::constraint::configuration::Configuration;
use crate::kinematics::constraint::{Constraint, Gradient, Region};

/// A sub-step whose end is certified, for a relation c(q).
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) struct Watched<'a> {
    pub(in crate::kinematics) relation: &'a dyn Constraint,
    /// The unknowns in the relation, each once.
    pub(in crate::kinematics) columns: &'a [usize],
    /// The mechanism at the end of the sub-step.
    pub(in crate::kinematics) at: &'a Configuration,
    /// q at its start.
    pub(in crate::kinematics) from: &'a [f64],
    pub(in crate::kinematics) pivots: &'a Pivots,
}

impl Watched<'_> {
    /// Bounds the deviation of c from the straight line between its values at both ends, while
    /// parameters rest: an eighth of its second derivative along the chords of its unknowns, and
    /// what these deviate from there. `None` without a bound. Allocates nothing.
    pub(in crate::kinematics) fn deviation(&self, bounds: &mut StepBounds) -> Option<f64> {
        for &column in self.columns {
            let chord = self.at.coordinate(column) - self.from[column];
            bounds.chord[column] = chord;
            // The region contains the whole chord, seen from its end.
            bounds.region[column] = chord.abs() + bounds.deviation(column, self.pivots);
        }
        let (mut gradient, mut change) = (Gradient::new(), Gradient::new());
        self.relation.gradient(self.at, &mut gradient);
        let region = Region::around(&bounds.region);
        let along = self
            .relation
            .bend(self.at, &region, &bounds.chord, &mut change);
        let steepest = gradient.entries().chain(change.entries());
        let off_chord = steepest.map(|(column, slope)| {
            let deviation = bounds.deviation(column, self.pivots);
            slope.abs() * deviation
        });
        let off_chord: f64 = off_chord.sum();
        for &column in self.columns {
            bounds.region[column] = 0.0;
            bounds.chord[column] = 0.0;
        }
        along.map(|along| 0.125 * along + off_chord)
    }

    /// Bounds the same while parameters move; a deviation of up to `largest_jump` may be a jump.
    #[cold]
    pub(in crate::kinematics) fn deviation_while_moving(
        &self,
        bounds: &mut StepBounds,
        largest_jump: f64,
    ) -> Option<f64> {
        for &column in self.columns {
            let ends = [self.from[column], self.at.coordinate(column)];
            let radius = bounds.deviation(column, self.pivots);
            bounds.parameters.set_chord(column, ends, radius);
        }
        let profiles = self.at.profiles();
        let bend = (bounds.parameters).bend_along(self.relation, profiles, largest_jump);
        let mut deviation = 0.125 * bend;
        for &column in self.columns {
            let radius = bounds.deviation(column, self.pivots);
            let slope = (bounds.parameters).partial(self.relation, profiles, column);
            deviation += slope.magnitude() * radius;
        }
        deviation.is_finite().then_some(deviation)
    }

    /// Returns the largest move of the relation's unknowns, each divided by its `scale`.
    pub(in crate::kinematics) fn largest_move(
        &self,
        bounds: &StepBounds,
        scale: impl Fn(usize) -> f64,
    ) -> f64 {
        let moves = self.columns.iter().map(|&column| {
            let chord = self.at.coordinate(column) - self.from[column];
            (chord.abs() + bounds.deviation(column, self.pivots)) / scale(column)
        });
        moves.fold(0.0, f64::max)
    }
}

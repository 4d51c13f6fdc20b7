//! The animation of a run.

use biela::dynamics::Motion;
use biela::kinematics::Output;
use biela::mechanism::Mechanism;
use biela_tools::drawing::ForcePlace;
use biela_tools::drawing::animation::{Animation, Clock, Moment, page};

/// Time between two poses of a motion without times \[s\].
const FRAME: f64 = 0.02;
/// Largest difference of two intervals that count as equal, relative.
const SAME: f64 = 1e-6;

/// The poses of a run.
pub(crate) struct Film {
    columns: Vec<Output>,
    /// Forces that arrows can show.
    forces: Vec<ForcePlace>,
    parameters: Vec<f64>,
    stride: usize,
    times: Vec<f64>,
    moments: Vec<Moment>,
}

impl Film {
    /// Returns an empty film of a run with this number of rows, which tells the columns in numbers
    /// and can show forces by arrows.
    pub(crate) fn new(
        columns: Vec<Output>,
        forces: Vec<ForcePlace>,
        rows: usize,
        parameters: &[f64],
    ) -> Self {
        Self {
            columns,
            forces,
            parameters: parameters.to_vec(),
            stride: Animation::stride(rows),
            times: Vec::new(),
            moments: Vec::new(),
        }
    }

    /// Adds a row, if it is one to show.
    pub(crate) fn add(&mut self, row: usize, motion: &Motion) {
        if !row.is_multiple_of(self.stride) {
            return;
        }
        let Motion {
            solver, solution, ..
        } = motion;
        let moment = Moment::record(solver, solution, &self.columns, &self.forces);
        self.moments.push(moment);
        self.times.push(solver.pose().time);
    }

    /// Returns whether there are forces that arrows can show.
    pub(crate) fn has_forces(&self) -> bool {
        !self.forces.is_empty()
    }

    /// Returns the page on which the mechanism moves, with arrows for forces if wanted; `None`
    /// without a pose.
    pub(crate) fn page(&self, mechanism: &Mechanism, with_forces: bool) -> Option<String> {
        self.moments.first()?;
        let (clock, moments) = self.paced();
        let mut animation = Animation::of_moments(
            mechanism,
            &self.parameters,
            &self.columns,
            self.forces.clone(),
            clock,
            self.moments.clone(),
        );
        // The paths of points are those of all moments.
        animation.moments = moments;
        if !with_forces {
            animation.forces.clear();
            let moments = animation.moments.iter_mut();
            moments.for_each(|moment| moment.forces.clear());
        }
        Some(page(&animation))
    }

    /// Returns the moments with equal times between them, each the last one not after its time.
    fn paced(&self) -> (Clock, Vec<Moment>) {
        let last = self.times.len() - 1;
        let [start, stop] = [self.times[0], self.times[last]];
        let mut clock = Clock {
            start,
            step: (stop - start) / last.max(1) as f64,
            stop,
        };
        if stop <= start {
            clock.step = FRAME;
            clock.stop = start + FRAME * last as f64;
            return (clock, self.moments.clone());
        }
        let due = |row: usize| start + row as f64 * clock.step;
        let is_even = (0..=last).all(|row| (self.times[row] - due(row)).abs() <= SAME * clock.step);
        if is_even {
            return (clock, self.moments.clone());
        }
        let shown = |row: usize| {
            let time = due(row) + SAME * clock.step;
            self.times.partition_point(|known| *known <= time).max(1) - 1
        };
        let moments = (0..=last).map(|row| self.moments[shown(row)].clone());
        (clock, moments.collect())
    }
}

//! A run as a page on which the mechanism moves, or as a picture that moves.

use std::path::PathBuf;

use super::column::Output;
use super::output::{tell_written, write};
use super::picture::extension;
use super::recorder::Recorder;
use crate::cli::told::error::Error;
use crate::drawing::ForcePlace;
use crate::drawing::animation::{Animation, Clock, Moment, moving_gif, moving_svg, page};
use biela::dynamics::{Event, Motion};

/// The moments of a run.
pub(in crate::cli) struct Film {
    columns: Vec<Output>,
    clock: Clock,
    /// Rows per moment.
    stride: usize,
    rows: usize,
    /// Forces that arrows show.
    forces: Vec<ForcePlace>,
    moments: Vec<Moment>,
}

impl Film {
    /// Returns an empty film of a run of `steps` steps from `start`, `step` seconds apart, which
    /// tells these columns in numbers.
    pub(in crate::cli) fn new(columns: Vec<Output>, steps: u64, [start, step]: [f64; 2]) -> Self {
        let steps = usize::try_from(steps).unwrap_or(usize::MAX);
        let stride = Animation::stride(steps.saturating_add(1));
        Self {
            columns,
            clock: Clock {
                start,
                step: step * stride as f64,
                stop: start,
            },
            stride,
            rows: 0,
            forces: Vec::new(),
            moments: Vec::new(),
        }
    }

    /// Shows these forces by arrows.
    pub(in crate::cli) fn show_forces(&mut self, forces: Vec<ForcePlace>) {
        self.forces = forces;
    }

    /// Adds the row of the current time, if it is one to show.
    pub(in crate::cli) fn add(&mut self, motion: &Motion) {
        if self.rows.is_multiple_of(self.stride) {
            let Motion {
                solver, solution, ..
            } = &motion;
            let moment = Moment::record(solver, solution, &self.columns, &self.forces);
            self.moments.push(moment);
            self.clock.stop = solver.pose().time;
        }
        self.rows += 1;
    }

    /// Returns the animation of all rows added.
    pub(in crate::cli) fn animation(self, motion: &Motion) -> Animation {
        Animation::of_moments(
            motion.mechanism(),
            &motion.pose().parameters,
            &self.columns,
            self.forces,
            self.clock,
            self.moments,
        )
    }
}

/// The file of a run's film: a page, or a picture that moves.
pub(in crate::cli) struct FilmFile {
    pub(in crate::cli) film: Film,
    pub(in crate::cli) path: PathBuf,
}

impl Recorder for FilmFile {
    fn add(&mut self, motion: &Motion) -> Result<(), Error> {
        self.film.add(motion);
        Ok(())
    }

    fn finish(self: Box<Self>, motion: &Motion, _events: &[Event]) -> Result<(), Error> {
        let animation = self.film.animation(motion);
        let content = match &*extension(&self.path) {
            "svg" => moving_svg(&animation).into_bytes(),
            "gif" => moving_gif(&animation),
            _ => page(&animation).into_bytes(),
        };
        write(&self.path, &content)?;
        tell_written(&self.path);
        Ok(())
    }
}

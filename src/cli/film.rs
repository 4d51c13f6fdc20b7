//! A run as a page on which the mechanism moves, or as a picture that moves.

use std::path::PathBuf;

use super::column::Output;
use super::error::Error;
use super::motion::Motion;
use super::output::{tell_written, write};
use super::picture::extension;
use super::plot::axis;
use super::recorder::Recorder;
use crate::drawing::animation::{Animation, Clock, Moment, Reading, moving_svg, page};
use crate::drawing::{ForcePlace, Scene};

/// Largest number of moments of a film; of more rows it shows every second, third and so on.
const MOST_MOMENTS: u64 = 10_000;
/// Largest number of poses that the paths of the points of interest are made from.
const POSES: usize = 2000;

/// The moments of a run.
pub(super) struct Film {
    columns: Vec<Output>,
    start: f64,
    /// Time between two moments \[s\].
    step: f64,
    /// Rows per moment.
    stride: u64,
    rows: u64,
    /// Time of the last moment \[s\].
    stop: f64,
    /// Forces that arrows show.
    forces: Vec<ForcePlace>,
    moments: Vec<Moment>,
}

impl Film {
    /// Returns an empty film of a run of `steps` steps from `start`, `step` seconds apart, which
    /// tells these columns in numbers.
    pub(super) fn new(columns: Vec<Output>, steps: u64, [start, step]: [f64; 2]) -> Self {
        let stride = steps / MOST_MOMENTS + 1;
        Self {
            columns,
            start,
            step: step * stride as f64,
            stride,
            rows: 0,
            stop: start,
            forces: Vec::new(),
            moments: Vec::new(),
        }
    }

    /// Shows these forces by arrows.
    pub(super) fn show_forces(&mut self, forces: Vec<ForcePlace>) {
        self.forces = forces;
    }

    /// Adds the row of the current time, if it is one to show.
    pub(super) fn add(&mut self, motion: &Motion) {
        if self.rows.is_multiple_of(self.stride) {
            let readings = (self.columns.iter())
                .map(|column| column.read(motion) * column.unit.display_factor());
            let rates = [motion.rates.velocity(), motion.rates.acceleration()];
            let pose = motion.solver.pose();
            self.moments.push(Moment {
                q: pose.q.clone(),
                rates: rates.map(<[f64]>::to_vec),
                readings: readings.collect(),
                forces: motion.values(&self.forces),
            });
            self.stop = pose.time;
        }
        self.rows += 1;
    }

    /// Returns the animation of all rows added.
    pub(super) fn animation(self, motion: &Motion) -> Animation {
        let stride = self.moments.len().div_ceil(POSES).max(1);
        let poses = self
            .moments
            .iter()
            .step_by(stride)
            .chain(self.moments.last());
        let poses: Vec<Vec<f64>> = poses.map(|moment| moment.q.clone()).collect();
        let home = poses.first().map_or(&[][..], Vec::as_slice);
        let parameters = &motion.solver.pose().parameters;
        Animation {
            scene: Scene::along(motion.solver.mechanism(), parameters, home, &poses, true),
            clock: Clock {
                start: self.start,
                step: self.step,
                stop: self.stop,
            },
            readings: (self.columns.into_iter())
                .map(|column| Reading {
                    name: column.name.trim_end_matches(".position").to_owned(),
                    unit: axis(column.unit).unit,
                })
                .collect(),
            forces: self.forces,
            moments: self.moments,
        }
    }
}

/// The page or the picture of a run's film.
pub(super) struct Page {
    pub(super) film: Film,
    pub(super) path: PathBuf,
}

impl Recorder for Page {
    fn add(&mut self, motion: &Motion) -> Result<(), Error> {
        self.film.add(motion);
        Ok(())
    }

    fn finish(self: Box<Self>, motion: &Motion) -> Result<(), Error> {
        let animation = self.film.animation(motion);
        let content = match &*extension(&self.path) {
            "svg" => moving_svg(&animation),
            _ => page(&animation),
        };
        write(&self.path, content.as_bytes())?;
        tell_written(&self.path);
        Ok(())
    }
}

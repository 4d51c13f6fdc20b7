//! A run as a page on which the mechanism moves.

use super::columns::{Column, axis};
use super::motion::Motion;
use crate::drawing::Scene;
use crate::drawing::animation::{Animation, Clock, Moment, Reading};
use crate::fmi::{Order, Signal};
use crate::mechanism::Mechanism;

/// A film has at most so many moments: of more rows every second, third and so on is shown.
const MOST_MOMENTS: u64 = 10_000;
/// So many poses say how the mechanism moves: where its points of interest go.
const POSES: usize = 2000;

/// The moments of a run.
pub(super) struct Recording {
    columns: Vec<Column>,
    /// Every so many rows one is kept.
    every: u64,
    rows: u64,
    /// The last row's time.
    time: f64,
    moments: Vec<Moment>,
}

impl Recording {
    /// Of a run of so many steps, in which these quantities are told in numbers.
    pub(super) fn new(columns: Vec<Column>, steps: u64) -> Self {
        Self {
            columns,
            every: (steps / MOST_MOMENTS) + 1,
            rows: 0,
            time: 0.0,
            moments: Vec::new(),
        }
    }

    /// What is told in numbers if nothing is asked for: where drivers, points of interest and
    /// measures are.
    pub(super) fn of_interest(columns: &[Column]) -> Vec<Column> {
        let columns = columns.iter().filter(|column| {
            let of_body = matches!(column.signal, Signal::Body(..));
            column.order == Order::Position && !of_body
        });
        columns.cloned().collect()
    }

    pub(super) fn add(&mut self, motion: &Motion) {
        if self.rows.is_multiple_of(self.every) {
            let readings = self.columns.iter().map(|column| {
                let factor = column.unit.display.map_or(1.0, |display| display.factor);
                column.read(motion) * factor
            });
            let rates = [motion.rates.velocity(), motion.rates.acceleration()];
            self.moments.push(Moment {
                q: motion.solver.pose().q.clone(),
                rates: rates.map(<[f64]>::to_vec),
                readings: readings.collect(),
            });
            self.time = motion.solver.pose().time;
        }
        self.rows += 1;
    }

    /// The animation of what there is, which started at `start` with rows `step` apart.
    pub(super) fn animation(
        self,
        mechanism: &Mechanism,
        parameters: &[f64],
        [start, step]: [f64; 2],
    ) -> Animation {
        let every = self.moments.len().div_ceil(POSES).max(1);
        let mut poses: Vec<Vec<f64>> = (self.moments.iter().step_by(every))
            .map(|moment| moment.q.clone())
            .collect();
        poses.extend(self.moments.last().map(|moment| moment.q.clone()));
        let home = poses.first().cloned().unwrap_or_default();
        Animation {
            scene: Scene::along(mechanism, parameters, &home, &poses, true),
            clock: Clock {
                start,
                step: step * self.every as f64,
                stop: self.time,
            },
            readings: (self.columns.into_iter())
                .map(|column| Reading {
                    name: column.name.trim_end_matches(".position").to_owned(),
                    unit: axis(column.unit).unit,
                })
                .collect(),
            moments: self.moments,
        }
    }
}

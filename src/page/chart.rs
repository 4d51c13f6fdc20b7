//! Variables over time or over a driver.

use serde_json::{Value, json};

use super::outcome::Outcome;
use super::session::Session;
use crate::kinematics::Curve;
use crate::mechanism::DriverId;

/// The variable along the horizontal axis of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Time, from the simulation's start to its end.
    Time,
    /// The range of a driver that is an input.
    Driver(DriverId),
}

impl Session {
    /// Returns values of variables, by their places in the description, at `samples` points along
    /// time or a driver: `x`, a list `y` per variable, with `null` where there is no value, and the
    /// `events` of a free motion, each with its time `x` and a `text`. The pose is unchanged. The time of a free motion begins where it was let go, or here if that is
    /// more than the simulation's time ago.
    pub fn chart(&mut self, over: Over, variables: &[usize], samples: usize) -> Value {
        let chart = |session: &mut Self| {
            if let Some(freedoms) = &mut session.freedoms {
                freedoms.events = Some(Vec::new());
            }
            let mut chart = session.chart_apart(over, variables, samples);
            chart["events"] = session.events().into();
            chart
        };
        match over {
            Over::Time => self.apart(chart),
            Over::Driver(_) => self.apart_by_hand(chart),
        }
    }

    /// Takes the events since the chart was begun.
    fn events(&mut self) -> Vec<Value> {
        let freedoms = self.freedoms.as_mut();
        let events = freedoms.and_then(|freedoms| freedoms.events.take());
        let told = events
            .unwrap_or_default()
            .into_iter()
            .map(|event| json!({ "x": event.time, "text": event.describe(&self.mechanism) }));
        told.collect()
    }

    fn chart_apart(&mut self, over: Over, variables: &[usize], samples: usize) -> Value {
        let here = self.pose().clone();
        let ends = match over {
            Over::Time => Some(self.span()),
            Over::Driver(driver) => {
                let range = self.ranges.get(driver.index()).cloned().flatten();
                range.map(|range| {
                    let [low, high] = range.ends;
                    // A crank may have turned away from its first turn.
                    let turns = ((here.drivers[driver.index()] - low) / (high - low)).floor();
                    let shift = if range.turns {
                        turns * (high - low)
                    } else {
                        0.0
                    };
                    [low + shift, high + shift]
                })
            }
        };
        let Some([low, high]) = ends else {
            return json!({ "x": [], "y": [] });
        };
        let last = samples.clamp(2, 10_000) - 1;
        let point = |k: usize| low + (high - low) * (k as f64 / last as f64);
        let mut rows: Vec<(f64, Vec<f64>)> = Vec::new();
        match over {
            Over::Time => {
                if self.pose().time > low && self.return_to_start().is_err() {
                    return json!({ "x": [], "y": [] });
                }
                for k in 0..=last {
                    if !self.sample(over, point(k), variables, &mut rows) {
                        break;
                    }
                }
            }
            Over::Driver(driver) => {
                let value = here.drivers[driver.index()];
                let below: Vec<f64> = (0..=last).map(point).filter(|x| *x < value).collect();
                for x in below.into_iter().rev() {
                    if !self.sample(over, x, variables, &mut rows) {
                        break;
                    }
                }
                rows.reverse();
                self.solver.restore(&here);
                for x in (0..=last).map(point).filter(|x| *x >= value) {
                    if !self.sample(over, x, variables, &mut rows) {
                        break;
                    }
                }
            }
        }
        if self.freedoms.is_none() {
            self.solver.restore(&here);
            self.refresh();
        }
        let x: Vec<f64> = rows.iter().map(|(x, _)| *x).collect();
        let y = (0..variables.len()).map(|k| rows.iter().map(|(_, y)| y[k]).collect::<Vec<f64>>());
        json!({ "x": x, "y": y.collect::<Vec<_>>() })
    }

    /// Returns start and end of the simulation; for freedoms, of as long a time from where they were
    /// let go, or from here if that is over.
    fn span(&self) -> [f64; 2] {
        let simulation = &self.mechanism().simulation;
        let [start, stop] = [simulation.start, simulation.stop];
        if self.freedoms.is_none() {
            return [start, stop];
        }
        let (first, now) = (self.start.pose.time, self.pose().time);
        let low = if now > first + (stop - start) {
            now
        } else {
            first
        };
        [low, low + (stop - start)]
    }

    /// Moves on to a point and adds a row there, or where the mechanism stops; false if it does.
    fn sample(
        &mut self,
        over: Over,
        x: f64,
        variables: &[usize],
        rows: &mut Vec<(f64, Vec<f64>)>,
    ) -> bool {
        let path = self.path_here();
        match over {
            Over::Time => path.duration = x - path.start,
            Over::Driver(driver) => {
                if let Curve::Input { position, .. } = path.curves[driver.index()] {
                    path.curves[driver.index()] = Curve::held(x, position);
                }
            }
        }
        let outcome = if over == Over::Time && self.freedoms.is_some() {
            self.fly(x)
        } else {
            self.follow(|_| true)
        };
        let reached = outcome == Outcome::Reached;
        self.refresh();
        let x = match over {
            Over::Time => self.pose().time,
            Over::Driver(driver) => self.pose().drivers[driver.index()],
        };
        let values = variables.iter().map(|index| self.variable(*index));
        rows.push((x, values.collect()));
        reached
    }
}

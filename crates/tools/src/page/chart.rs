//! Variables over time or over a driver.

use serde_json::{Value, json};

use super::along::Over;
use super::session::Session;

impl Session {
    /// Returns values of variables, by their places in the description, at `samples` points along
    /// time or a driver: `x`, a list `y` per variable, with `null` where there is no value, and the
    /// `events` of a free motion, each with its time `x` and a `text`. The pose is unchanged. The time
    /// of a free motion begins where it was let go, or here if that is more than the simulation's time
    /// ago.
    pub fn chart(&mut self, over: Over, variables: &[usize], samples: usize) -> Value {
        let (rows, events) = self.along(over, samples, |session| {
            let values = variables.iter().map(|index| session.variable(*index));
            values.collect::<Vec<f64>>()
        });
        let x: Vec<f64> = rows.iter().map(|(x, _)| *x).collect();
        let y = (0..variables.len()).map(|k| rows.iter().map(|(_, y)| y[k]).collect::<Vec<f64>>());
        let events = (events.into_iter())
            .map(|event| json!({ "x": event.time, "text": event.describe(&self.mechanism) }));
        json!({ "x": x, "y": y.collect::<Vec<_>>(), "events": events.collect::<Vec<_>>() })
    }
}

//! The path of a point, and poses laid over each other.

use serde_json::{Value, json};

use super::along::Over;
use super::session::Session;
use biela::mechanism::BodyId;

impl Session {
    /// Chooses the point whose path and speed are shown: of a body, in its frame \[m\].
    pub fn trace(&mut self, point: Option<(BodyId, [f64; 2])>) {
        let is_known = |body: BodyId| body.index() < self.mechanism().bodies.len();
        self.traced = point.filter(|(body, _)| is_known(*body));
    }

    /// Returns place \[m\] and velocity \[m/s\] of the traced point in ground axes; not numbers
    /// without one, or without rates.
    pub(super) fn traced(&self) -> [[f64; 2]; 2] {
        let Some((body, at)) = self.traced else {
            return [[f64::NAN; 2]; 2];
        };
        let point = self.point(body, at);
        let [x, y, _] = self.place_of(body);
        let rates = self.motion.solution.rates.velocity();
        let [vx, vy, omega] = [0, 1, 2].map(|k| rates[3 * body.index() + k]);
        let velocity = [vx - omega * (point.y - y), vy + omega * (point.x - x)];
        let known = |v: f64| if self.has_rates { v } else { f64::NAN };
        [point.into(), velocity.map(known)]
    }

    /// Returns the path of the traced point along time or a driver, in the picture; empty without one.
    /// The pose is unchanged.
    pub fn path(&mut self, over: Over, samples: usize) -> Value {
        if self.traced.is_none() {
            return json!([]);
        }
        let (rows, _) = self.along(over, samples, |session| {
            session.picture.place(session.traced()[0])
        });
        json!(rows.into_iter().map(|(_, place)| place).collect::<Vec<_>>())
    }

    /// Returns the places of the picture's parts at `samples` poses along time or a driver, each as in
    /// the [`layout`](Self::layout) from `attachments` on. The pose is unchanged.
    pub fn poses(&mut self, over: Over, samples: usize) -> Value {
        let (rows, _) = self.along(over, samples, |session| {
            let mut places = Vec::new();
            session.picture.add_places(&session.pose().q, &mut places);
            places
        });
        json!(
            rows.into_iter()
                .map(|(_, places)| places)
                .collect::<Vec<_>>()
        )
    }
}

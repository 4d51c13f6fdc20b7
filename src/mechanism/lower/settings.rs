//! Outputs and the default experiment.

use std::collections::HashSet;
use std::hash::Hash;

use crate::mechanism::diagnostic::code;
use crate::mechanism::names::{quoted, shown};
use crate::mechanism::syntax::Value;
use crate::mechanism::{BodyId, MarkerId, Outputs, Simulation};

use super::context::{Context, Fields, Quantity};

/// The keys of `[outputs]` and of `[simulation]`.
pub(super) const OUTPUT_KEYS: [&str; 2] = ["bodies", "markers"];
pub(super) const SIMULATION_KEYS: [&str; 5] = ["start", "stop", "step", "tolerance", "gravity"];

/// Communication steps of a default experiment that does not give its step.
const DEFAULT_STEPS: f64 = 500.0;

impl<'a> Context<'a> {
    pub(super) fn lower_outputs(&mut self, root: &Fields<'a>) -> Outputs {
        let mut outputs = Outputs {
            bodies: (0..self.body_names.len()).map(BodyId).collect(),
            markers: Vec::new(),
        };
        let Some(fields) = self.section(root, "outputs") else {
            return outputs;
        };
        self.check_keys(&fields, &OUTPUT_KEYS);
        if let Some(value) = fields.get("bodies") {
            outputs.bodies = self.list(value, "an array of bodies", Self::moving_body);
            outputs.bodies.sort_unstable();
        }
        if let Some(value) = fields.get("markers") {
            outputs.markers = self.list::<MarkerId>(value, "an array of markers", Self::marker);
        }
        outputs
    }

    /// The things that an array names, each once.
    fn list<T: Copy + Eq + Hash>(
        &mut self,
        value: &'a Value<'a>,
        expected: &str,
        find: fn(&mut Self, &'a Value<'a>) -> Option<T>,
    ) -> Vec<T> {
        let mut seen = HashSet::new();
        let mut found = Vec::new();
        for item in self.items(value, expected).unwrap_or_default() {
            let Some(thing) = find(self, item) else {
                continue;
            };
            if seen.insert(thing) {
                found.push(thing);
            } else {
                let name = quoted(item.get_ref().as_str().unwrap_or_default());
                let message = format!("{name} is listed twice");
                self.error(code::DUPLICATE_OUTPUT, item.span(), message);
            }
        }
        found
    }

    pub(super) fn lower_simulation(&mut self, root: &Fields<'a>) -> Simulation {
        let mut simulation = Simulation {
            start: 0.0,
            stop: 1.0,
            step: 1.0 / DEFAULT_STEPS,
            tolerance: 1e-6,
            gravity: [0.0, 0.0],
        };
        let Some(fields) = self.section(root, "simulation") else {
            return simulation;
        };
        self.check_keys(&fields, &SIMULATION_KEYS);
        let mut number = |key: &str| fields.get(key).and_then(|value| self.quantity(value));
        let [start, stop, step, tolerance] =
            ["start", "stop", "step", "tolerance"].map(&mut number);
        let value = |quantity: &Option<Quantity>| quantity.as_ref().and_then(|q| q.value);
        simulation.start = value(&start).unwrap_or(simulation.start);
        simulation.stop = value(&stop).unwrap_or(simulation.stop);
        let duration = simulation.stop - simulation.start;
        // What could not be read says nothing about the order of the two.
        let known = |key: &str, quantity: &Option<Quantity>| {
            fields.get(key).is_none() || value(quantity).is_some()
        };
        if duration <= 0.0 && known("start", &start) && known("stop", &stop) {
            let span = stop.or(start).map_or(fields.place.clone(), |q| q.span);
            let message = format!(
                "`stop` = {} is not after `start` = {}",
                shown(simulation.stop),
                shown(simulation.start)
            );
            self.error(code::ILLEGAL_VALUE, span, message);
        }
        simulation.step = value(&step).unwrap_or(duration / DEFAULT_STEPS);
        if duration > 0.0 && (simulation.step.is_infinite() || duration / DEFAULT_STEPS == 0.0) {
            let message = "from `start` to `stop` is too far or too near to be divided into steps";
            self.error(code::ILLEGAL_VALUE, fields.place.clone(), message);
        }
        simulation.tolerance = value(&tolerance).unwrap_or(simulation.tolerance);
        for (quantity, what) in [(&step, "`step`"), (&tolerance, "`tolerance`")] {
            if let Some(quantity) = quantity {
                self.check_positive(quantity, what);
            }
        }
        if let Some(gravity) = fields.get("gravity")
            && let Some(gravity) = self.quantities::<2>(gravity, "an array `[x, y]`")
        {
            simulation.gravity = gravity.map(|component| component.value.unwrap_or(0.0));
        }
        simulation
    }
}

//! Outputs and the default experiment.

use crate::mechanism::diagnostic::code;
use crate::mechanism::wording::shown_apart;
use crate::mechanism::{BodyId, MarkerId, Outputs, Simulation, Unit};

use super::context::Context;
use super::kind::{Array, Fields, List};
use super::number::{NUMBER, Quantity, RATIO, TIME};
use super::reference::{BodyName, MarkerName};
use super::table::{Field, table};

table! {
    /// Outputs of the FMU.
    struct OutputKeys<'a> {
        /// Bodies that are outputs; all if left out.
        bodies: Vec<BodyId> = List { plural: "bodies", item: BodyName },
        /// Points of interest that are outputs.
        markers: Vec<MarkerId> = List { plural: "markers", item: MarkerName },
    }

    /// The default experiment.
    struct SimulationKeys<'a> {
        /// Start time.
        start: Quantity = TIME,
        /// Stop time.
        stop: Quantity = TIME,
        /// Communication step; a 500th of the duration if left out.
        step: Quantity = TIME.positive(),
        /// Tolerance for hosts; biela solves to rounding.
        tolerance: Quantity = RATIO.positive(),
        /// Acceleration of gravity.
        gravity: [Quantity; 2] = Array::new("[x, y]", [NUMBER.in_unit(Unit::METRE_PER_SECOND_SQUARED); 2]),
    }
}

/// Communication steps of a default experiment that does not give its step.
const DEFAULT_STEPS: f64 = 500.0;

impl<'a> Context<'a> {
    pub(super) fn outputs(&mut self, fields: Option<&Fields<'a>>) -> Outputs {
        let keys = fields.map(|fields| self.table::<OutputKeys<'a>>(fields));
        let (bodies, markers) = keys
            .map(|keys| (keys.bodies.value, keys.markers.value))
            .unwrap_or_default();
        let all = || (0..self.body_names.len()).map(BodyId).collect();
        let mut bodies: Vec<BodyId> = bodies.unwrap_or_else(all);
        bodies.sort_unstable();
        Outputs {
            bodies,
            markers: markers.unwrap_or_default(),
        }
    }

    pub(super) fn simulation(&mut self, fields: Option<&Fields<'a>>) -> Simulation {
        let mut simulation = Simulation {
            start: 0.0,
            stop: 1.0,
            step: 1.0 / DEFAULT_STEPS,
            tolerance: 1e-6,
            gravity: [0.0, 0.0],
        };
        let Some(fields) = fields else {
            return simulation;
        };
        let keys = self.table::<SimulationKeys<'a>>(fields);
        // An unreadable time says nothing about the order of the two.
        let is_known = |field: &Field<Quantity>| field.key.is_none() || field.number().is_some();
        simulation.start = keys.start.number().unwrap_or(simulation.start);
        simulation.stop = keys.stop.number().unwrap_or(simulation.stop);
        let duration = simulation.stop - simulation.start;
        if duration <= 0.0 && is_known(&keys.start) && is_known(&keys.stop) {
            let later = if keys.stop.key.is_some() {
                &keys.stop
            } else {
                &keys.start
            };
            let [stop, start] = shown_apart(simulation.stop, simulation.start);
            let message = format!("`stop` = {stop} is not after `start` = {start}");
            self.error(code::ILLEGAL_VALUE, later.span.clone(), message);
        }
        simulation.step = keys.step.number().unwrap_or(duration / DEFAULT_STEPS);
        if duration > 0.0 && (simulation.step.is_infinite() || duration / DEFAULT_STEPS == 0.0) {
            let message = "from `start` to `stop` is too far or too near to be divided into steps";
            self.error(code::ILLEGAL_VALUE, fields.place.clone(), message);
        }
        simulation.tolerance = keys.tolerance.number().unwrap_or(simulation.tolerance);
        if let Some(gravity) = keys.gravity.value {
            simulation.gravity = gravity.map(|component| component.value.unwrap_or(0.0));
        }
        simulation
    }
}

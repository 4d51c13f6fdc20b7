//! Outputs and the default experiment.

use crate::mechanism::diagnostic::code;
use crate::mechanism::wording::shown_apart;
use crate::mechanism::{BodyId, Expression, Indeterminate, MarkerId, Outputs, Simulation, Unit};

use super::context::Context;
use super::kind::{Array, Fields, List, Word};
use super::number::{NUMBER, Quantity, RATIO, TIME};
use super::reference::{BodyName, HolderName, MarkerName};
use super::table::{Field, table};

table! {
    /// Outputs of the FMU.
    struct OutputKeys<'a> {
        /// Bodies that are outputs; all if left out.
        bodies: Vec<BodyId> = List { plural: "bodies", item: BodyName },
        /// Points of interest that are outputs.
        markers: Vec<MarkerId> = List { plural: "markers", item: MarkerName },
        /// Joints and constraints whose reactions are outputs; all if left out.
        reactions: Vec<usize> = List { plural: "joints and constraints", item: HolderName },
        /// Treatment of reactions that redundant constraints leave indeterminate.
        indeterminate: Indeterminate = INDETERMINATE,
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
        /// Acceleration of gravity; [0, -9.81] if left out.
        gravity: [Quantity; 2] = Array::new("[x, y]", [NUMBER.in_unit(Unit::METRE_PER_SECOND_SQUARED); 2]),
    }
}

const INDETERMINATE: Word<Indeterminate> = Word::new("treatment", code::ILLEGAL_VALUE, || {
    vec![
        ("omit", Indeterminate::Omit),
        ("minimum_norm", Indeterminate::MinimumNorm),
    ]
});

/// Acceleration of gravity that a file does not give \[m/s²\].
const GRAVITY: [f64; 2] = [0.0, -9.81];

/// Communication steps of a default experiment that does not give its step.
const DEFAULT_STEPS: f64 = 500.0;

impl<'a> Context<'a> {
    pub(super) fn outputs(&mut self, fields: Option<&Fields<'a>>) -> Outputs {
        let keys = fields.map(|fields| self.table::<OutputKeys<'a>>(fields));
        let (bodies, markers, reactions, indeterminate) = keys
            .map(|keys| {
                let markers = keys.markers.value;
                let (reactions, indeterminate) = (keys.reactions.value, keys.indeterminate.value);
                (keys.bodies.value, markers, reactions, indeterminate)
            })
            .unwrap_or_default();
        let all = || (0..self.body_names.len()).map(BodyId).collect();
        let mut bodies: Vec<BodyId> = bodies.unwrap_or_else(all);
        bodies.sort_unstable();
        let mut reactions =
            reactions.unwrap_or_else(|| (0..self.holder_counts.iter().sum()).collect());
        reactions.sort_unstable();
        let [joint_count, _] = self.holder_counts;
        let (joints, constraints): (Vec<_>, Vec<_>) = reactions
            .into_iter()
            .partition(|&place| place < joint_count);
        let constraints = constraints.into_iter();
        Outputs {
            bodies,
            markers: markers.unwrap_or_default(),
            constraints: constraints.map(|place| place - joint_count).collect(),
            joints,
            indeterminate: indeterminate.unwrap_or_default(),
        }
    }

    pub(super) fn simulation(&mut self, fields: Option<&Fields<'a>>) -> Simulation {
        let mut simulation = Simulation {
            start: 0.0,
            stop: 1.0,
            step: 1.0 / DEFAULT_STEPS,
            tolerance: 1e-6,
            gravity: GRAVITY.map(Expression::constant),
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
        if let Some(gravity) = keys.gravity.expressions() {
            simulation.gravity = gravity;
        }
        simulation
    }
}

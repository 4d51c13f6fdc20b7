//! Outputs and the default experiment.

use crate::mechanism::diagnostic::code;
use crate::mechanism::wording::shown_apart;
use crate::mechanism::{
    BodyId, Expression, Extrapolation, Indeterminate, MarkerId, Outputs, RateSource, Simulation,
    Unit,
};

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
        /// Relative tolerance of free motion, by default 1e-8; without freedoms for hosts alone, by
        /// default 1e-6.
        tolerance: Quantity = RATIO.positive(),
        /// Acceleration of gravity; [0, -9.81] if left out.
        gravity: [Quantity; 2] = Array::new("[x, y]", [NUMBER.in_unit(Unit::METRE_PER_SECOND_SQUARED); 2]),
        /// Start value of the FMU's parameter `rates`: the source of the drivers' rates.
        rates: RateSource = RATES,
        /// Start value of the FMU's parameter `extrapolation`: the path of inputs during a step.
        extrapolation: Extrapolation = EXTRAPOLATION,
    }
}

const RATES: Word<RateSource> = Word::new("source of rates", code::ILLEGAL_VALUE, || {
    RateSource::ALL.map(|source| (source.word(), source)).into()
});
const EXTRAPOLATION: Word<Extrapolation> = Word::new("extrapolation", code::ILLEGAL_VALUE, || {
    Extrapolation::ALL.map(|path| (path.word(), path)).into()
});

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
    pub(super) fn outputs(&mut self, fields: &Fields<'a>) -> Outputs {
        let keys = self.table::<OutputKeys<'a>>(fields);
        let all_bodies = || (0..self.body_names.len()).map(BodyId).collect();
        let mut bodies: Vec<BodyId> = keys.bodies.value.unwrap_or_else(all_bodies);
        bodies.sort_unstable();
        let [joint_count, constraint_count] = self.holder_counts;
        let all_reactions = || (0..joint_count + constraint_count).collect();
        let mut reactions: Vec<usize> = keys.reactions.value.unwrap_or_else(all_reactions);
        reactions.sort_unstable();
        let constraints = reactions.split_off(reactions.partition_point(|&p| p < joint_count));
        Outputs {
            bodies,
            markers: keys.markers.value.unwrap_or_default(),
            constraints: constraints
                .iter()
                .map(|place| place - joint_count)
                .collect(),
            joints: reactions,
            indeterminate: keys.indeterminate.value.unwrap_or_default(),
        }
    }

    pub(super) fn simulation(&mut self, fields: &Fields<'a>, has_freedoms: bool) -> Simulation {
        let keys = self.table::<SimulationKeys<'a>>(fields);
        let [start, stop] = [(&keys.start, 0.0), (&keys.stop, 1.0)]
            .map(|(field, default)| field.number().unwrap_or(default));
        let duration = stop - start;
        // An unreadable time says nothing about the order of the two.
        let is_known = |field: &Field<Quantity>| field.key.is_none() || field.number().is_some();
        if duration <= 0.0 && is_known(&keys.start) && is_known(&keys.stop) {
            let later = if keys.stop.key.is_some() {
                &keys.stop
            } else {
                &keys.start
            };
            let [stop, start] = shown_apart(stop, start);
            let message = format!("`stop` = {stop} is not after `start` = {start}");
            self.error(code::ILLEGAL_VALUE, later.span.clone(), message);
        }
        let default_step = duration / DEFAULT_STEPS;
        let step = keys.step.number().unwrap_or(default_step);
        if duration > 0.0 && (step.is_infinite() || default_step == 0.0) {
            let message = "from `start` to `stop` is too far or too near to be divided into steps";
            self.error(code::ILLEGAL_VALUE, fields.place.clone(), message);
        }
        if let Some(tolerance) = keys
            .tolerance
            .number()
            .filter(|tolerance| *tolerance >= 1.0)
            && has_freedoms
        {
            let message = format!("`tolerance` = {tolerance} is none for a free motion");
            self.error(code::OUT_OF_RANGE, keys.tolerance.span.clone(), message)
                .suggest("relative to the values: above 0 and below 1, such as 1e-8");
        }
        let gravity = keys.gravity.expressions();
        Simulation {
            start,
            stop,
            step,
            tolerance: keys
                .tolerance
                .number()
                .unwrap_or(if has_freedoms { 1e-8 } else { 1e-6 }),
            gravity: gravity.unwrap_or_else(|| GRAVITY.map(Expression::constant)),
            rates: keys.rates.value.unwrap_or_default(),
            extrapolation: keys.extrapolation.value.unwrap_or_default(),
        }
    }
}

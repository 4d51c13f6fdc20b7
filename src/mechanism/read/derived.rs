//! Measures that are computed from others.

use std::collections::HashMap;

use crate::mechanism::expression::MovingNames;
use crate::mechanism::syntax::Value;
use crate::mechanism::{DerivedMeasure, ForceQuantity, Mechanism, Unit, Variable};

use super::context::Context;
use super::coordinate::{ClearanceKeys, CoordinateKeys, MeasureKeys};
use super::kind::{AnyOf, Entry, Item, Kind, Text, schema};
use super::number::NUMBER;
use super::table::table;
use super::unit::SI_UNIT;

table! {
    /// An output computed from others, without velocity and acceleration.
    struct DerivedKeys<'a> {
        /// Expression over the parameters and the variables of bodies, markers, drivers and
        /// measures and over forces, such as "-travel.velocity/shock.velocity".
        #[required("\"-travel.velocity/shock.velocity\"")]
        value: &'a Value<'a> = Unread,
        /// SI unit of the value.
        unit: Unit = SI_UNIT,
        /// Description in one line.
        description: String = Text,
    }
}

/// Number or expression, not read yet.
pub(super) struct Unread;

impl<'a> Kind<'a> for Unread {
    type Value = &'a Value<'a>;

    fn read(&self, _: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<&'a Value<'a>> {
        Some(item.value)
    }

    schema! { NUMBER.schema() }
}

/// A measure: a coordinate, or computed from others.
pub(super) type AnyMeasure = AnyOf<
    (CoordinateKeys<'static>, MeasureKeys<'static>),
    AnyOf<(ClearanceKeys<'static>, MeasureKeys<'static>), DerivedKeys<'static>>,
>;

/// Returns whether a measure is computed from others.
pub(super) fn is_derived(entry: &Entry<'_>) -> bool {
    let table = entry.value.get_ref().as_table();
    table.is_some_and(|table| table.contains_key("value") && !table.contains_key("coordinate"))
}

impl<'a> Context<'a> {
    /// Reads the measures that are computed from others, in a mechanism that is complete but for
    /// these; after an error elsewhere it may lack what they use, so that only their keys are read.
    pub(super) fn derived(
        &mut self,
        measures: &[Entry<'a>],
        mechanism: &Mechanism,
    ) -> Vec<DerivedMeasure> {
        let entries: Vec<_> = measures.iter().filter(|entry| is_derived(entry)).collect();
        if entries.is_empty() {
            return Vec::new();
        }
        if self.failed {
            // Names of what is incomplete lead nowhere.
            for entry in entries {
                self.entry::<DerivedKeys<'a>>(*entry, "measure");
            }
            return Vec::new();
        }
        let signals = mechanism.signals();
        let signals = signals.iter().map(|(name, signal, order)| {
            let variable = Variable::Signal(*signal, *order);
            (name.as_str(), variable)
        });
        let forces = mechanism.named_forces();
        let given = mechanism.force_inputs();
        let forces = forces
            .iter()
            .map(|force| (force.name.as_str(), force.quantity));
        let inputs = given.iter().map(|input| {
            let quantity = ForceQuantity::Applied(input.force, input.component);
            (input.name.as_str(), quantity)
        });
        let forces = forces.chain(inputs);
        let forces = forces.map(|(name, quantity)| (name, Variable::Force(quantity)));
        let signals = MovingNames {
            known: signals.chain(forces).collect(),
            dimensions: Vec::new(),
            of_signals: HashMap::new(),
            computed: entries.iter().map(|entry| entry.name()).collect(),
            usable: "a measure may use parameters, the variables of bodies, markers, drivers and \
                     measures with a coordinate, and forces where bodies have masses",
            law: None,
            may_jump: true,
        };
        let read = |entry: &Entry<'a>| {
            let keys = self.entry::<DerivedKeys<'a>>(*entry, "measure")?;
            let value = keys.value.value?;
            Some(DerivedMeasure {
                name: entry.name().to_owned(),
                description: keys.description.value.unwrap_or_default(),
                value: self.formula(value, &[], Some(&signals))?.expression,
                unit: keys.unit.optional()?,
            })
        };
        entries.into_iter().filter_map(read).collect()
    }
}

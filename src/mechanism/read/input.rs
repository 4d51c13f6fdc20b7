//! Inputs: numbers from outside.

use crate::mechanism::{Input, Unit};

use super::context::Context;
use super::kind::{Entry, Text};
use super::number::{NUMBER, Quantity};
use super::table::table;
use super::unit::SI_UNIT;

table! {
    /// A number from outside: an FMI input.
    struct InputKeys<'a> {
        /// SI unit of its values.
        unit: Unit = SI_UNIT,
        /// Value at the start; zero if left out.
        start: Quantity = NUMBER,
        /// Lower limit, which advises.
        min: Quantity = NUMBER,
        /// Upper limit, which advises.
        max: Quantity = NUMBER,
        /// Description in one line.
        description: String = Text,
    }
}

impl<'a> Context<'a> {
    /// Reads an input.
    pub(super) fn input(&mut self, entry: Entry<'a>) -> Option<Input> {
        let keys = self.entry::<InputKeys<'a>>(entry, "input")?;
        let unit = keys.unit.optional()?;
        let start = ("`start`", keys.start.value.as_ref());
        let [min, max] = self.limits([keys.min, keys.max], start, unit);
        Some(Input {
            name: entry.name().to_owned(),
            description: keys.description.value.unwrap_or_default(),
            unit,
            start: keys.start.number_or(0.0)?,
            min,
            max,
            given: None,
        })
    }
}

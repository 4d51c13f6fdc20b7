//! Limits `min` and `max` of parameters and drivers.

use crate::mechanism::Unit;
use crate::mechanism::diagnostic::code;
use crate::mechanism::wording::shown_apart;

use super::context::Context;
use super::number::Quantity;
use super::table::Field;

impl Context<'_> {
    /// Returns the limits for the file's parameters; reports limits in the wrong order and a
    /// `value`, called `name`, beyond them. Messages give numbers in the unit for display.
    pub(super) fn limits(
        &mut self,
        [min, max]: [Field<Quantity>; 2],
        (name, value): (&str, Option<&Quantity>),
        unit: Option<Unit>,
    ) -> [Option<f64>; 2] {
        let max_span = max.span.clone();
        let [min, max] = [min, max].map(|limit| {
            let mut quantity = limit.value?;
            self.evaluate(&mut quantity)?;
            quantity.value
        });
        let (factor, suffix) = match unit {
            Some(Unit {
                display: Some(display),
                ..
            }) => (display.factor, format!(" {}", display.name)),
            _ => (1.0, unit.map_or_else(String::new, Unit::suffix)),
        };
        let show = |a: f64, b: f64| {
            shown_apart(a * factor, b * factor).map(|number| format!("{number}{suffix}"))
        };
        if let (Some(min), Some(max)) = (min, max)
            && min > max
        {
            let [max, min] = show(max, min);
            let message = format!("`max` = {max} is below `min` = {min}");
            self.error(code::OUT_OF_RANGE, max_span, message);
        } else if let Some(quantity) = value
            && let Some(value) = quantity.value
        {
            let violation = match (min, max) {
                (Some(min), _) if value < min => Some(("below `min`", min)),
                (_, Some(max)) if value > max => Some(("above `max`", max)),
                _ => None,
            };
            if let Some((violation, limit)) = violation {
                let [value, limit] = show(value, limit);
                let message = format!("{name} = {value} is {violation} = {limit}");
                self.error(code::OUT_OF_RANGE, quantity.span.clone(), message);
            }
        }
        [min, max]
    }
}

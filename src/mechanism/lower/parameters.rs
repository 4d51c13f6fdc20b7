//! The parameters: their attributes, their order of derivation and their values.

use std::collections::VecDeque;

use toml::de::DeValue;

use crate::mechanism::diagnostic::code;
use crate::mechanism::expression::CONSTANTS;
use crate::mechanism::names::{either, quoted, shown};
use crate::mechanism::syntax::{Value, number};
use crate::mechanism::{Diagnostic, DisplayUnit, Expression, Parameter, ParameterId, Unit};

use super::context::{Context, Entry, Fields, Quantity};

/// The keys of a parameter's attributes.
pub(super) const KEYS: [&str; 7] = [
    "value",
    "unit",
    "display",
    "min",
    "max",
    "tunable",
    "description",
];

/// Most parameters of a cycle that its message names and marks.
const MAX_SHOWN_IN_CYCLE: usize = 8;

/// A parameter half read: its expression is known, its value not yet.
struct Draft<'a> {
    entry: Entry<'a>,
    expression: Option<Expression>,
    value: &'a Value<'a>,
    /// The table of its attributes, if it is written as one.
    attributes: Option<Fields<'a>>,
}

impl<'a> Context<'a> {
    /// Reads the parameters and gives them their values; returns with them the derived ones, each
    /// after those it uses.
    pub(super) fn lower_parameters(
        &mut self,
        entries: &[Entry<'a>],
    ) -> (Vec<Parameter>, Vec<ParameterId>) {
        let drafts: Vec<Draft<'a>> = entries.iter().map(|entry| self.draft(*entry)).collect();
        let order = self.order_parameters(&drafts);
        for id in &order {
            self.evaluate_parameter(*id, &drafts[id.index()]);
        }
        let parameters = drafts
            .iter()
            .enumerate()
            .filter_map(|(index, draft)| self.finish_parameter(ParameterId(index), draft))
            .collect();
        let is_derived = |id: &ParameterId| {
            let expression = drafts[id.index()].expression.as_ref();
            expression.is_some_and(|expression| expression.parameters().next().is_some())
        };
        (parameters, order.into_iter().filter(is_derived).collect())
    }

    fn draft(&mut self, entry: Entry<'a>) -> Draft<'a> {
        let mut draft = Draft {
            entry,
            expression: None,
            value: entry.value,
            attributes: None,
        };
        if let DeValue::Table(_) = entry.value.get_ref() {
            let subject = format!("parameter {}", quoted(entry.name()));
            if let Some(fields) = self.fields(entry.key, entry.value, subject) {
                self.check_keys(&fields, &KEYS);
                if let Some(value) = self.required(&fields, "value", "0.1") {
                    draft.value = value;
                    draft.expression = self.expression(value, None);
                }
                draft.attributes = Some(fields);
            }
        } else {
            draft.expression = self.expression(entry.value, None);
        }
        draft
    }

    /// The parameters in an order in which each comes after those it uses, without those that
    /// are in a cycle or use one that is. Reports the cycles.
    fn order_parameters(&mut self, drafts: &[Draft<'a>]) -> Vec<ParameterId> {
        let uses = |index: usize| {
            drafts[index]
                .expression
                .iter()
                .flat_map(Expression::parameters)
        };
        let mut users: Vec<Vec<usize>> = vec![Vec::new(); drafts.len()];
        let mut waiting_for: Vec<usize> = vec![0; drafts.len()];
        for (user, waiting_for) in waiting_for.iter_mut().enumerate() {
            for used in uses(user) {
                users[used.index()].push(user);
                *waiting_for += 1;
            }
        }
        let mut order = Vec::with_capacity(drafts.len());
        let mut ready: VecDeque<usize> = (0..drafts.len())
            .filter(|index| waiting_for[*index] == 0)
            .collect();
        while let Some(index) = ready.pop_front() {
            order.push(ParameterId(index));
            for user in &users[index] {
                waiting_for[*user] -= 1;
                if waiting_for[*user] == 0 {
                    ready.push_back(*user);
                }
            }
        }
        // Who still waits, waits for another who does. Following the first such, one comes back
        // to where one was: that is a cycle.
        let next = |index: usize| {
            uses(index)
                .map(ParameterId::index)
                .find(|used| waiting_for[*used] > 0)
        };
        let mut seen_from: Vec<Option<usize>> = vec![None; drafts.len()];
        for start in (0..drafts.len()).filter(|index| waiting_for[*index] > 0) {
            let mut at = start;
            while seen_from[at].is_none() {
                seen_from[at] = Some(start);
                at = next(at).expect("it waits for another that waits");
            }
            if seen_from[at] == Some(start) {
                let around = std::iter::successors(Some(at), |index| next(*index));
                let rest = around.skip(1).take_while(|index| *index != at);
                let cycle: Vec<usize> = std::iter::once(at).chain(rest).collect();
                self.report_cycle(drafts, cycle);
            }
        }
        order
    }

    fn report_cycle(&mut self, drafts: &[Draft<'a>], mut cycle: Vec<usize>) {
        // It starts at the parameter that comes first in the file.
        let first = (0..cycle.len()).min_by_key(|at| cycle[*at]).unwrap_or(0);
        cycle.rotate_left(first);
        let name = |index: usize| drafts[index].entry.name();
        let shown = &cycle[..cycle.len().min(MAX_SHOWN_IN_CYCLE)];
        let mut names: Vec<String> = shown.iter().map(|index| quoted(name(*index))).collect();
        if shown.len() < cycle.len() {
            names.push(format!("… ({} more)", cycle.len() - shown.len()));
        }
        names.push(quoted(name(cycle[0])));
        let message = if cycle.len() == 1 {
            format!("the parameter {} uses itself", names[0])
        } else {
            format!("the parameters use one another: {}", names.join(" → "))
        };
        let mut diagnostic = Diagnostic::error(code::PARAMETER_CYCLE, message);
        for (place, index) in shown.iter().enumerate() {
            let used = cycle[(place + 1) % cycle.len()];
            let text = format!("uses {}", quoted(name(used)));
            diagnostic = diagnostic.label(drafts[*index].value.span(), text);
        }
        self.problems.push(diagnostic);
    }

    /// Gives a parameter its value, if all those it uses have theirs.
    fn evaluate_parameter(&mut self, id: ParameterId, draft: &Draft<'a>) {
        let Some(expression) = &draft.expression else {
            return;
        };
        let Some(jet) = self.value_at(expression, 0.0) else {
            return;
        };
        if jet.value.is_finite() {
            self.parameter_values[id.index()] = Some(jet.value);
        } else {
            self.not_finite(draft.value.span(), "the value");
        }
    }

    /// Reads the attributes, for which all parameters must have their values.
    fn finish_parameter(&mut self, id: ParameterId, draft: &Draft<'a>) -> Option<Parameter> {
        let mut parameter = Parameter {
            name: draft.entry.name().to_owned(),
            description: String::new(),
            expression: draft
                .expression
                .clone()
                .unwrap_or(Expression::constant(0.0)),
            default: 0.0,
            derived: false,
            tunable: false,
            unit: None,
            min: None,
            max: None,
        };
        parameter.derived = parameter.expression.parameters().next().is_some();
        let default = self.parameter_values[id.index()];
        if let Some(fields) = &draft.attributes {
            parameter.description = self.description(fields);
            parameter.unit = self.lower_unit(fields);
            parameter.tunable = self.lower_tunable(fields, &parameter);
            (parameter.min, parameter.max) = self.lower_range(fields, draft, default);
        }
        parameter.default = default?;
        Some(parameter)
    }

    fn lower_tunable(&mut self, fields: &Fields<'a>, parameter: &Parameter) -> bool {
        let Some(value) = fields.get("tunable") else {
            return false;
        };
        let tunable = self.boolean(value).unwrap_or(false);
        if tunable && parameter.derived {
            let name = quoted(&parameter.name);
            self.error_with_help(
                code::NOT_TUNABLE,
                value.span(),
                format!("{name} is derived from other parameters: nobody can set it"),
                "make those parameters tunable".to_owned(),
            );
        }
        tunable
    }

    fn lower_range(
        &mut self,
        fields: &Fields<'a>,
        draft: &Draft<'a>,
        default: Option<f64>,
    ) -> (Option<f64>, Option<f64>) {
        let mut bound = |key: &str| fields.get(key).and_then(|value| self.quantity(value));
        let (min, max) = (bound("min"), bound("max"));
        let value_of = |bound: &Option<Quantity>| bound.as_ref().and_then(|bound| bound.value);
        let (least, most) = (value_of(&min), value_of(&max));
        if let (Some(least), Some(most), Some(max)) = (least, most, &max)
            && least > most
        {
            self.error(
                code::OUT_OF_RANGE,
                max.span.clone(),
                format!("`max` = {} is below `min` = {}", shown(most), shown(least)),
            );
        } else if let Some(default) = default {
            let violation = match (least, most) {
                (Some(least), _) if default < least => Some(("below `min`", least)),
                (_, Some(most)) if default > most => Some(("above `max`", most)),
                _ => None,
            };
            if let Some((violation, bound)) = violation {
                let name = quoted(draft.entry.name());
                let (default, bound) = (shown(default), shown(bound));
                let message = format!("{name} = {default} is {violation} = {bound}");
                self.error(code::OUT_OF_RANGE, draft.value.span(), message);
            }
        }
        (least, most)
    }

    fn lower_unit(&mut self, fields: &Fields<'a>) -> Option<Unit> {
        let display = fields.get("display");
        let Some(value) = fields.get("unit") else {
            if let Some(display) = display {
                self.error_with_help(
                    code::WRONG_DISPLAY_UNIT,
                    display.span(),
                    format!("{} has a `display` unit but no `unit`", fields.subject),
                    "add the SI unit of its value: `unit = \"m\"`".to_owned(),
                );
            }
            return None;
        };
        let units = Unit::ALL.map(|unit| (unit.name, unit));
        let name = self.text(value)?;
        let unit = if let Some(display) = DisplayUnit::by_name(name) {
            let message = format!("{} is not an SI unit", quoted(name));
            let si = units
                .iter()
                .find(|(_, unit)| unit.dimension == display.dimension);
            // Whoever writes millimetres means them.
            let number = fields
                .get("value")
                .and_then(|value| number(value.get_ref()));
            let is_known = |name: &&str| CONSTANTS.iter().any(|(known, _)| known == name);
            let constant = name.split('/').next().filter(is_known);
            let given = match (number, constant) {
                (Some(number), Some(constant)) => {
                    format!("value = \"{}*{constant}\", ", shown(number))
                }
                _ => String::new(),
            };
            let help = si.map(|(si, _)| {
                format!("values are SI: `{given}unit = \"{si}\", display = \"{name}\"`")
            });
            self.error_with_help(code::UNKNOWN_UNIT, value.span(), message, help);
            None
        } else {
            self.choice(value, &units, code::UNKNOWN_UNIT, "unit")
        };
        let Some(display_value) = display else {
            return unit;
        };
        let displays = DisplayUnit::ALL.map(|display| (display.name, display));
        let display = self.choice(display_value, &displays, code::UNKNOWN_UNIT, "display unit")?;
        let unit = unit?;
        if display.dimension != unit.dimension {
            let fitting: Vec<&str> = unit.display_units().map(|unit| unit.name).collect();
            let help = match fitting.as_slice() {
                [] => "leave `display` out".to_owned(),
                fitting => format!("expected {}", either(fitting)),
            };
            let message = format!("`{}` is no unit for showing `{}`", display.name, unit.name);
            self.error_with_help(
                code::WRONG_DISPLAY_UNIT,
                display_value.span(),
                message,
                help,
            );
        }
        Some(unit.shown_in(display))
    }
}

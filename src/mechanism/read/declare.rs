//! Declaration of the names in the file, before anything refers to them.

use std::collections::{HashMap, HashSet};

use crate::mechanism::diagnostic::code;
use crate::mechanism::expression::is_taken;
use crate::mechanism::names::is_legal;
use crate::mechanism::wording::quoted;
use crate::mechanism::{
    BodyId, Coordinate, Diagnostic, Dimension, Driver, Measure, ParameterId, Unit,
};

use super::context::Context;
use super::derived::is_derived;
use super::kind::Entry;
use super::root::Root;
use super::table::Field;

impl<'a> Context<'a> {
    /// Declares parameters and bodies; reports illegal, taken and repeated names.
    pub(super) fn declare(&mut self, root: &Root<'a>) {
        self.check_shared_names(root);
        let parameters = root.parameters.items().iter().map(Entry::name);
        self.parameters = parameters.zip((0..).map(ParameterId)).collect();
        self.parameter_values = vec![None; root.parameters.items().len()];
        self.parameter_dimensions = root.parameters.items().iter().map(declared).collect();
        self.parameters_used = vec![false; root.parameters.items().len()];
        self.body_names = root.bodies.items().iter().map(Entry::name).collect();
        let bodies = self.body_names.iter().copied();
        self.bodies = bodies.zip((0..).map(BodyId)).collect();
        if !root.functions.items().is_empty() {
            self.declare_functions(root.functions.items());
        }
        let inputs = root.inputs.items().iter().map(Entry::name);
        self.inputs = inputs.zip(0..).collect();
        self.inputs_used = vec![false; root.inputs.items().len()];
        let units = root.inputs.items().iter().map(declared);
        self.input_dimensions = units.collect();
        let joints = root.joints.items().iter().map(Entry::name);
        let constraints = root.constraints.items().iter().map(Entry::name);
        self.holder_counts = [joints.len(), constraints.len()];
        self.holders = joints.chain(constraints).zip(0..).collect();
    }

    /// Declares the coordinates that equations and stops may name: those in the sections of
    /// drivers, freedoms and measures.
    pub(super) fn declare_coordinates(
        &mut self,
        sections: [&Field<Vec<Entry<'a>>>; 3],
        drivers: &[Driver],
        measures: &[Measure],
    ) {
        let drivers = drivers
            .iter()
            .map(|driver| (&*driver.name, driver.coordinate));
        let measures = measures
            .iter()
            .map(|measure| (&*measure.name, measure.coordinate));
        let known: HashMap<&str, Coordinate> = drivers.chain(measures).collect();
        let entries = sections.into_iter().flat_map(Field::items);
        for entry in entries {
            let name = entry.name();
            if is_derived(entry) {
                self.computed.push(name)
            } else {
                self.coordinates.push((name, known.get(name).copied()))
            }
        }
    }

    /// Checks the names that become FMI variables or their prefixes.
    fn check_shared_names(&mut self, root: &Root<'a>) {
        let sections = [
            ("parameter", &root.parameters),
            ("input", &root.inputs),
            ("function", &root.functions),
            ("body", &root.bodies),
            ("joint", &root.joints),
            ("constraint", &root.constraints),
            ("driver", &root.drivers),
            ("freedom", &root.freedoms),
            ("measure", &root.measures),
            ("force", &root.forces),
            ("stop", &root.stops),
            ("contact", &root.contacts),
            ("friction", &root.friction),
        ];
        let entries = sections
            .iter()
            .flat_map(|(noun, section)| section.items().iter().map(|entry| (*noun, *entry)));
        let mut all: Vec<(&str, Entry<'a>)> = entries.collect();
        all.sort_by_key(|(_, entry)| entry.key.span().start);
        let names: HashSet<&str> = all.iter().map(|(_, entry)| entry.name()).collect();
        let mut earlier: HashMap<&str, (&str, Entry<'a>)> = HashMap::new();
        for (noun, entry) in all {
            let (name, span) = (entry.name(), entry.key.span());
            if self.check_name(entry, noun) && is_taken(name) {
                let message = format!("the name {} is taken by the language", quoted(name));
                let help = free_name([(noun, entry); 2], &names);
                self.error(code::RESERVED_NAME, span.clone(), message)
                    .suggest(help);
            }
            let Some(first @ (first_noun, first_entry)) = earlier.get(name) else {
                earlier.insert(name, (noun, entry));
                continue;
            };
            let article = if first_noun.starts_with('i') {
                "an"
            } else {
                "a"
            };
            let message = format!(
                "the {noun} {} has the name of {article} {first_noun}",
                quoted(name)
            );
            self.report(
                Diagnostic::error(code::DUPLICATE_NAME, message)
                    .label(span, "")
                    .label(first_entry.key.span(), format!("the {first_noun}")),
            )
            .suggest(free_name([*first, (noun, entry)], &names));
        }
    }

    /// Returns whether a name is legal; reports it otherwise.
    pub(super) fn check_name(&mut self, entry: Entry<'a>, noun: &str) -> bool {
        let legal = is_legal(entry.name());
        if !legal {
            let message = format!("illegal name {} of a {noun}", quoted(entry.name()));
            self.error(code::ILLEGAL_NAME, entry.key.span(), message)
                .suggest("a letter, then letters, digits and `_`");
        }
        legal
    }
}

/// Returns help for two things of one name: a free name for the one that is a quantity, otherwise for
/// the second.
fn free_name(things: [(&str, Entry<'_>); 2], names: &HashSet<&str>) -> String {
    let [first, second] = things;
    let (noun, entry, quantity) = match things.map(|(noun, entry)| quantity(noun, entry)) {
        [Some(quantity), None] => (first.0, first.1, quantity),
        [_, Some(quantity)] => (second.0, second.1, quantity),
        [None, None] => (second.0, second.1, second.0),
    };
    let name = entry.name();
    let numbered = (2..).map(|number| format!("{name}_{noun}_{number}"));
    // Not `angle_angle`.
    let words = [quantity, noun].into_iter().filter(|word| *word != name);
    let mut candidates = words.map(|word| format!("{name}_{word}")).chain(numbered);
    let free = candidates.find(|free| !names.contains(&**free));
    let free = quoted(&free.unwrap_or_default());
    format!("all these share one name space: call the {noun} {free}")
}

/// Returns the word for what a parameter is by its unit, or a driver, a freedom or a measure by its
/// coordinate; `None` for other things.
fn quantity(noun: &str, entry: Entry<'_>) -> Option<&'static str> {
    let text = |key| {
        entry
            .value
            .get_ref()
            .as_table()?
            .get(key)?
            .get_ref()
            .as_str()
    };
    match noun {
        "parameter" => Some(match declared(&entry) {
            Some(Dimension::LENGTH) => "length",
            Some(Dimension::ANGLE) => "angle",
            _ => "value",
        }),
        "driver" | "freedom" | "measure" => Some(match text("coordinate") {
            Some("angle") => "angle",
            Some("x") => "x",
            Some("y") => "y",
            Some("distance") => "distance",
            _ => return None,
        }),
        _ => None,
    }
}

/// Returns the dimension of a parameter's `unit`, before the parameters are read.
fn declared(entry: &Entry<'_>) -> Option<Dimension> {
    let unit = entry.value.get_ref().as_table()?.get("unit")?;
    let unit = Unit::by_name(unit.get_ref().as_str()?)?;
    Some(unit.dimension)
}

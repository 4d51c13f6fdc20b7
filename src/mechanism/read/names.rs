//! Declaration of the names in the file, before anything refers to them.

use std::collections::{HashMap, HashSet};

use crate::mechanism::diagnostic::code;
use crate::mechanism::expression::is_taken;
use crate::mechanism::names::is_legal;
use crate::mechanism::wording::quoted;
use crate::mechanism::{
    BodyId, Coordinate, Diagnostic, Dimension, Driver, Measure, ParameterId, Span, Unit,
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
            match is_derived(entry) {
                true => self.computed.push(name),
                false => self.coordinates.push((name, known.get(name).copied())),
            }
        }
    }

    /// Checks the names that become FMI variables or their prefixes.
    fn check_shared_names(&mut self, root: &Root<'a>) {
        let sections = [
            ("parameter", &root.parameters),
            ("body", &root.bodies),
            ("joint", &root.joints),
            ("constraint", &root.constraints),
            ("driver", &root.drivers),
            ("freedom", &root.freedoms),
            ("measure", &root.measures),
            ("force", &root.forces),
            ("stop", &root.stops),
            ("friction", &root.friction),
        ];
        let entries = sections
            .iter()
            .flat_map(|(noun, section)| section.items().iter().map(|entry| (*noun, *entry)));
        let mut all: Vec<(&str, Entry<'a>)> = entries.collect();
        all.sort_by_key(|(_, entry)| entry.key.span().start);
        let names: HashSet<&str> = all.iter().map(|(_, entry)| entry.name()).collect();
        let mut earlier: HashMap<&str, (&str, Span)> = HashMap::new();
        for (noun, entry) in all {
            let (name, span) = (entry.name(), entry.key.span());
            if self.check_name(entry, noun) && is_taken(name) {
                let message = format!("the name {} is taken by the language", quoted(name));
                self.error(code::RESERVED_NAME, span.clone(), message);
            }
            let Some((first_noun, first_span)) = earlier.get(name) else {
                earlier.insert(name, (noun, span));
                continue;
            };
            let message = format!("the {noun} {} has the name of a {first_noun}", quoted(name));
            self.report(
                Diagnostic::error(code::DUPLICATE_NAME, message)
                    .label(span, "")
                    .label(first_span.clone(), format!("the {first_noun}")),
            )
            .suggest(match format!("{name}_{noun}") {
                free if !names.contains(&*free) => {
                    format!(
                        "all these share one name space: call the {noun} {}",
                        quoted(&free)
                    )
                }
                _ => "all these share one name space".to_owned(),
            });
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

/// Returns the dimension of a parameter's `unit`, before the parameters are read.
fn declared(entry: &Entry<'_>) -> Option<Dimension> {
    let unit = entry.value.get_ref().as_table()?.get("unit")?;
    let unit = Unit::by_name(unit.get_ref().as_str()?)?;
    Some(unit.dimension)
}

//! Reader of mechanism files: from the TOML document to the mechanism, with all problems.
//!
//! Each table of the file is declared once, by [`table::table`]: its keys, their kinds, which of
//! them are required, and their meaning. Reading, the messages about keys and the JSON Schema
//! follow from the declarations. A kind of value ([`kind::Kind`]) knows how it is read and what
//! its schema is.
//!
//! | to add | do |
//! |---|---|
//! | a key | a line in the declaration of its table; the compiler then asks for its use |
//! | a joint | a file in `joint`, and its line in `joint/mod.rs` |
//! | a coordinate | a word in `coordinate.rs` |
//!
//! Names are declared first, then the parameters get their values, then all else is read. An
//! unreadable value leaves one error; what refers to it adds no other.

mod body;
mod contact;
mod context;
mod coordinate;
mod declare;
mod derived;
mod driver;
mod force;
mod freedom;
mod friction;
mod function;
mod input;
mod joint;
mod kind;
mod limits;
mod motion;
mod number;
mod other_words;
mod parameter;
mod placed;
mod plausible;
mod points;
mod reference;
mod root;
mod settings;
mod shape;
mod stop;
mod table;
mod unit;
mod usage;

#[cfg(test)]
mod tests;

use context::Context;
use derived::is_derived;
use kind::{Entry, Fields};
use root::Root;
use table::Field;

use super::{Diagnostic, Mechanism, Source, syntax};

impl Mechanism {
    /// Reads a mechanism file; returns the warnings with the mechanism.
    ///
    /// # Errors
    ///
    /// All errors and warnings, in the order of the file; after a syntax error only that.
    ///
    /// # Example
    ///
    /// ```
    /// use biela::mechanism::{Mechanism, Source};
    ///
    /// let source = Source::new("pendulum.toml", r#"
    ///     format = 1
    ///     name = "pendulum"
    ///     ground.markers = { O = [0, 0] }
    ///     bodies.rod.markers = { O = ["-0.5*length", 0] }
    ///     parameters.length = 0.8
    ///     joints.O = { type = "revolute", markers = ["ground.O", "rod.O"] }
    ///     drivers.swing = { coordinate = "angle", markers = ["ground.O", "rodd.O"], start = 0 }
    /// "#);
    /// let problems = Mechanism::parse(&source).unwrap_err();
    /// assert_eq!(
    ///     problems[0].one_line(&source),
    ///     "pendulum.toml:8:69: error: no body `rodd`; did you mean `rod`?"
    /// );
    /// ```
    pub fn parse(source: &Source) -> Result<(Self, Vec<Diagnostic>), Vec<Diagnostic>> {
        let (document, duplicates) = syntax::parse(source).map_err(|error| vec![error])?;
        let mut context = Context::new(source);
        for second in duplicates {
            context.duplicate_key(second);
        }
        let mechanism = context.mechanism(&document);
        let failed = context.failed;
        let problems = context.into_problems();
        match mechanism {
            Some(mechanism) if !failed => Ok((mechanism, problems)),
            _ => Err(problems),
        }
    }

    /// Returns a JSON Schema (2020-12) of mechanism files, by which editors complete and check
    /// them.
    ///
    /// It knows keys, types, units and choices. Only [`parse`](Self::parse) finds problems that
    /// depend on several places, such as a name that does not exist.
    #[must_use]
    pub fn schema() -> serde_json::Value {
        root::schema()
    }

    /// Returns the keys of a file in their order: its own texts, then its sections.
    pub fn keys() -> impl Iterator<Item = &'static str> {
        <Root as table::Keys>::names().into_iter()
    }
}

impl<'a> Context<'a> {
    /// Reads the mechanism, which is incomplete after an error; `None` in another format.
    fn mechanism(&mut self, document: &'a syntax::Table<'a>) -> Option<Mechanism> {
        let file = Fields {
            table: document,
            place: 0..0,
            subject: "the file".to_owned(),
        };
        let root = self.table::<Root<'a>>(&file);
        if root.format.key.is_some() {
            root.format.value?;
        }
        self.declare(&root);
        let parameters = self.parameter_drafts(root.parameters.items());
        let functions = self.functions(root.functions.items());
        let (parameters, derivation_order) = self.parameters(parameters, &functions);
        self.check_functions(root.functions.items(), &functions);
        let has_freedoms = !root.freedoms.items().is_empty();
        let simulation = self.simulation(&root.simulation.or_empty(), has_freedoms);
        let inputs = self.each(&root.inputs, Self::input);
        self.input_starts = inputs.iter().map(|input| input.start).collect();
        let (bodies, markers, shapes) = self.bodies(&root.ground, &root.bodies);
        let driver = |context: &mut Self, entry| context.driver(entry, simulation.start);
        let mut drivers = self.each(&root.drivers, driver);
        drivers.extend(self.each(&root.freedoms, Self::freedom));
        let measure = |context: &mut Self, entry| {
            if is_derived(&entry) {
                None
            } else {
                context.measure(entry)
            }
        };
        let measures = self.each(&root.measures, measure);
        let sections = [&root.drivers, &root.freedoms, &root.measures];
        self.declare_coordinates(sections, &drivers, &measures);
        let mut stops = self.each(&root.stops, Self::stop);
        let mut forces = self.forces(&root.forces, &drivers, &measures, simulation.start);
        let of_stops = stops.iter().enumerate();
        let of_stops = of_stops.filter(|(_, stop)| stop.exerts(has_freedoms));
        forces.extend(of_stops.map(|(index, stop)| stop.force(index, stop.coordinate)));
        stops.extend(self.contacts(root.contacts.items()));
        let joints = self.each(&root.joints, Self::joint);
        // Indices are known once all joints have been read.
        let all = (joints.len() == root.joints.items().len()).then_some(&*joints);
        let friction = |context: &mut Self, entry| context.friction(entry, all);
        forces.extend(self.each(&root.friction, friction).into_iter().flatten());
        if has_freedoms {
            let plays = joints.iter().enumerate();
            forces.extend(plays.filter_map(|(index, joint)| joint.force_of_play(index)));
        }
        let mut mechanism = Mechanism {
            name: root.name.value.unwrap_or_default(),
            description: root.description.value.unwrap_or_default(),
            author: root.author.value,
            version: root.version.value,
            license: root.license.value,
            copyright: root.copyright.value,
            parameters,
            derivation_order,
            functions,
            inputs,
            bodies,
            markers,
            shapes,
            joints,
            constraints: self.each(&root.constraints, Self::constraint),
            drivers,
            measures,
            derived: Vec::new(),
            forces,
            stops,
            outputs: self.outputs(&root.outputs.or_empty()),
            simulation,
            canonical: syntax::canonical(document) + &self.file_tables,
            table_files: std::mem::take(&mut self.table_files),
        };
        if !self.failed {
            mechanism.start_at_estimates();
            self.check_shapes(&mechanism);
        }
        if !self.failed {
            self.check_contacts(&mechanism, root.contacts.items());
            mechanism.add_forces_of_contacts();
        }
        mechanism.derived = self.derived(root.measures.items(), &mechanism);
        if !self.failed {
            self.warn_of_large_lengths();
            self.check_freedoms(&mechanism, root.freedoms.items());
            self.warn_of_unused(&mechanism, root.parameters.items(), root.bodies.items());
            self.warn_of_uncalled(root.functions.items());
            self.warn_of_unused_inputs(root.inputs.items());
        }
        Some(mechanism)
    }

    /// Reads each of the entries that can be read.
    fn each<T>(
        &mut self,
        entries: &Field<Vec<Entry<'a>>>,
        read: impl Fn(&mut Self, Entry<'a>) -> Option<T>,
    ) -> Vec<T> {
        let entries = entries.items().iter();
        entries.filter_map(|entry| read(self, *entry)).collect()
    }
}

//! Declaring every name before anything refers to it, and finding what a name refers to.

use std::collections::HashMap;

use crate::mechanism::diagnostic::code;
use crate::mechanism::names::{NameTable, is_body_quantity, is_legal, is_taken, quoted};
use crate::mechanism::syntax::{self, Value};
use crate::mechanism::{BodyId, Diagnostic, MarkerId, ParameterId, Span};

use super::context::{Context, Entry, Fields};

/// The name of what never moves.
const GROUND: &str = "ground";

/// The entries of the file's sections, in file order.
#[derive(Default)]
pub(super) struct Sections<'a> {
    pub(super) parameters: Vec<Entry<'a>>,
    pub(super) bodies: Vec<Entry<'a>>,
    /// The markers in the order of their ids, each with what carries it.
    pub(super) markers: Vec<(Option<BodyId>, Entry<'a>)>,
    pub(super) joints: Vec<Entry<'a>>,
    pub(super) constraints: Vec<Entry<'a>>,
    pub(super) drivers: Vec<Entry<'a>>,
    pub(super) measures: Vec<Entry<'a>>,
}

/// The keys of `[ground]`.
pub(super) const GROUND_KEYS: [&str; 1] = ["markers"];

impl<'a> Context<'a> {
    /// Declares all names; reports illegal, taken and repeated ones.
    pub(super) fn declare(&mut self, root: &Fields<'a>) -> Sections<'a> {
        let mut entries = |name: &str| -> Vec<Entry<'a>> {
            self.section(root, name)
                .map(|section| section.entries().collect())
                .unwrap_or_default()
        };
        let mut sections = Sections {
            parameters: entries("parameters"),
            bodies: entries("bodies"),
            markers: Vec::new(),
            joints: entries("joints"),
            constraints: entries("constraints"),
            drivers: entries("drivers"),
            measures: entries("measures"),
        };
        self.check_shared_names(&sections);

        let parameter_names = sections.parameters.iter().map(Entry::name);
        self.parameters = parameter_names.zip((0..).map(ParameterId)).collect();
        self.parameter_values = vec![None; sections.parameters.len()];
        self.parameters_used = vec![false; sections.parameters.len()];

        self.declare_bodies(root, &mut sections);
        sections
    }

    /// Declares ground and the bodies with their markers.
    fn declare_bodies(&mut self, root: &Fields<'a>, sections: &mut Sections<'a>) {
        self.body_names = sections.bodies.iter().map(Entry::name).collect();
        let names = self.body_names.iter().copied();
        self.bodies = names.zip((0..).map(BodyId)).collect();
        if sections.bodies.is_empty() && self.bodies_are_readable(root) {
            let place = root.key_span("bodies").unwrap_or(0..0);
            self.error_with_help(
                code::NO_BODIES,
                place,
                "the mechanism has no bodies",
                "add one: `[bodies.crank]`".to_owned(),
            );
        }
        let ground = self.section(root, "ground");
        if let Some(ground) = &ground {
            self.check_keys(ground, &GROUND_KEYS);
        }
        self.declare_markers(None, ground.as_ref(), sections);
        for (index, body) in sections.bodies.clone().into_iter().enumerate() {
            let subject = format!("body {}", quoted(body.name()));
            let fields = self.fields(body.key, body.value, subject);
            self.declare_markers(Some(BodyId(index)), fields.as_ref(), sections);
        }
    }

    /// Whether `[bodies]` is missing or a table: otherwise its type has been reported.
    fn bodies_are_readable(&self, root: &Fields<'a>) -> bool {
        root.get("bodies")
            .is_none_or(|bodies| bodies.get_ref().is_table())
    }

    fn declare_markers(
        &mut self,
        carrier: Option<BodyId>,
        fields: Option<&Fields<'a>>,
        sections: &mut Sections<'a>,
    ) {
        let mut table = NameTable::new();
        let markers = fields.and_then(|fields| fields.table.get_key_value("markers"));
        let subject = || "`markers`".to_owned();
        if let Some(markers) = markers.and_then(|(key, value)| self.fields(key, value, subject())) {
            for entry in markers.entries() {
                self.check_name(entry, "marker");
                if is_body_quantity(entry.name()) {
                    self.error(
                        code::RESERVED_NAME,
                        entry.key.span(),
                        format!("{} is a quantity of the body itself", quoted(entry.name())),
                    );
                }
                table.insert(entry.name(), MarkerId(self.carriers.len()));
                let owner = self.carrier_name(carrier);
                self.owners.entry(entry.name()).or_insert(owner);
                self.carriers.push(carrier);
                sections.markers.push((carrier, entry));
            }
        }
        self.markers.push(table);
    }

    /// Checks the names that become FMI variables or their prefixes.
    fn check_shared_names(&mut self, sections: &Sections<'a>) {
        let named = [
            ("parameter", &sections.parameters),
            ("body", &sections.bodies),
            ("joint", &sections.joints),
            ("constraint", &sections.constraints),
            ("driver", &sections.drivers),
            ("measure", &sections.measures),
        ];
        let mut all: Vec<(&str, Entry<'a>)> = named
            .iter()
            .flat_map(|(what, entries)| entries.iter().map(|entry| (*what, *entry)))
            .collect();
        all.sort_by_key(|(_, entry)| entry.key.span().start);
        let mut earlier: HashMap<&str, (&str, Span)> = HashMap::new();
        for (what, entry) in all {
            let (name, span) = (entry.name(), entry.key.span());
            if self.check_name(entry, what) && is_taken(name) {
                self.error(
                    code::RESERVED_NAME,
                    span.clone(),
                    format!("the name {} is taken by the language", quoted(name)),
                );
            }
            match earlier.get(name) {
                None => {
                    earlier.insert(name, (what, span));
                }
                Some((first_what, first_span)) => self.problems.push(
                    Diagnostic::error(
                        code::DUPLICATE_NAME,
                        format!("the {what} {} has the name of a {first_what}", quoted(name)),
                    )
                    .label(span, "")
                    .label(first_span.clone(), format!("the {first_what}"))
                    .help("all these share one name space".to_owned()),
                ),
            }
        }
    }

    /// Whether a name is legal; otherwise reports it.
    fn check_name(&mut self, entry: Entry<'a>, what: &str) -> bool {
        let legal = is_legal(entry.name());
        if !legal {
            self.error_with_help(
                code::ILLEGAL_NAME,
                entry.key.span(),
                format!("illegal name {} of a {what}", quoted(entry.name())),
                "a letter, then letters, digits and `_`".to_owned(),
            );
        }
        legal
    }

    /// The marker that a value such as `"crank.A"` refers to.
    pub(super) fn marker(&mut self, value: &'a Value<'a>) -> Option<MarkerId> {
        let text = self.text(value)?;
        let Some((body_name, marker_name)) = text.split_once('.') else {
            let help = match self.owners.get(text) {
                Some(owner) => format!("did you mean `{owner}.{text}`?"),
                None => "a marker is written `body.marker`".to_owned(),
            };
            let message = format!("no marker {}", quoted(text));
            self.error_with_help(code::UNKNOWN_MARKER, value.span(), message, help);
            return None;
        };
        let content = syntax::content_span(self.source, value.span(), text);
        let part = |start: usize, part: &str| match &content {
            // An empty part has no character to point at.
            Some(content) if !part.is_empty() => {
                content.start + start..content.start + start + part.len()
            }
            _ => value.span(),
        };
        let body_span = part(0, body_name);
        let marker_span = part(body_name.len() + 1, marker_name);
        let body = if body_name == GROUND {
            None
        } else {
            Some(self.body_at(body_name, body_span, &[GROUND])?)
        };
        let table = &self.markers[body.map_or(0, |body| body.index() + 1)];
        let marker = table.get(marker_name);
        if marker.is_none() {
            let message = format!("no marker {} on {}", quoted(marker_name), quoted(body_name));
            let help = table.help(marker_name, &[]);
            self.error_with_help(code::UNKNOWN_MARKER, marker_span, message, help);
        }
        marker
    }

    /// The moving body that a value names.
    pub(super) fn moving_body(&mut self, value: &'a Value<'a>) -> Option<BodyId> {
        let name = self.text(value)?;
        let span = syntax::content_span(self.source, value.span(), name)
            .filter(|content| !content.is_empty())
            .unwrap_or_else(|| value.span());
        if name == GROUND {
            self.error(code::UNKNOWN_BODY, span, "`ground` is no moving body");
            return None;
        }
        self.body_at(name, span, &[])
    }

    /// The moving body called `name`, where the names `further` would be right too.
    fn body_at(&mut self, name: &str, span: Span, further: &[&str]) -> Option<BodyId> {
        let body = self.bodies.get(name);
        if body.is_none() {
            let message = format!("no body {}", quoted(name));
            let help = self.bodies.help(name, further);
            self.error_with_help(code::UNKNOWN_BODY, span, message, help);
        }
        body
    }

    /// The name of a body, or of ground.
    pub(super) fn carrier_name(&self, carrier: Option<BodyId>) -> &'a str {
        carrier.map_or(GROUND, |body| self.body_names[body.index()])
    }
}

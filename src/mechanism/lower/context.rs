//! What reading a file needs at hand, and the readers of single values.

use std::collections::HashMap;
use std::f64::consts::TAU;

use toml::de::DeValue;

use crate::mechanism::diagnostic::code;
use crate::mechanism::expression::Scope;
use crate::mechanism::names::{self, NameTable, quoted, shown};
use crate::mechanism::syntax::{self, Key, Table, Value};
use crate::mechanism::{
    BodyId, Diagnostic, Expression, Jet, MarkerId, ParameterId, Severity, Source, Span, TableFile,
    Variable,
};

/// More problems than this are counted, not shown: nobody reads them, and a file of garbage would
/// make a million.
const MAX_PROBLEMS: usize = 100;

/// The problems found so far.
#[derive(Debug, Default)]
pub(super) struct Problems {
    diagnostics: Vec<Diagnostic>,
    omitted: usize,
    errors: usize,
}

impl Problems {
    pub(super) fn push(&mut self, diagnostic: Diagnostic) {
        if diagnostic.severity == Severity::Error {
            self.errors += 1;
        }
        if self.diagnostics.len() < MAX_PROBLEMS {
            self.diagnostics.push(diagnostic);
        } else {
            self.omitted += 1;
        }
    }

    pub(super) fn has_errors(&self) -> bool {
        self.errors > 0
    }

    /// The problems in the order of the file, those without a place first; last, how many more
    /// there are.
    pub(super) fn into_diagnostics(mut self) -> Vec<Diagnostic> {
        self.diagnostics
            .sort_by_key(|problem| problem.labels.first().map(|label| label.span.start));
        if self.omitted > 0 {
            let message = format!("{} more problems are not shown", self.omitted);
            self.diagnostics.push(if self.errors > 0 {
                Diagnostic::error(code::TOO_MANY_PROBLEMS, message)
            } else {
                Diagnostic::warning(code::TOO_MANY_PROBLEMS, message)
            });
        }
        self.diagnostics
    }
}

/// The state of reading one file.
pub(super) struct Context<'a> {
    pub(super) source: &'a Source,
    pub(super) problems: Problems,
    pub(super) parameters: NameTable<'a, ParameterId>,
    /// The file's value of each parameter, `None` while or because it has none.
    pub(super) parameter_values: Vec<Option<f64>>,
    /// Which parameters something uses.
    pub(super) parameters_used: Vec<bool>,
    /// The moving bodies.
    pub(super) bodies: NameTable<'a, BodyId>,
    /// The markers of ground, then of each body.
    pub(super) markers: Vec<NameTable<'a, MarkerId>>,
    /// The names of the bodies.
    pub(super) body_names: Vec<&'a str>,
    /// For each marker's name, what carries the first marker so called.
    pub(super) owners: HashMap<&'a str, &'a str>,
    /// What each marker is fixed on.
    pub(super) carriers: Vec<Option<BodyId>>,
    /// The CSV files read so far.
    pub(super) table_files: Vec<TableFile>,
    /// The numbers taken from them, for the canonical form.
    pub(super) file_tables: String,
}

/// A number of the file: an expression, with its value for the file's parameters.
pub(super) struct Quantity {
    pub(super) expression: Expression,
    /// Finite; `None` if it uses a parameter that has no value, or time.
    pub(super) value: Option<f64>,
    pub(super) span: Span,
}

/// A named entry of a section: `crank` in `[bodies]`.
#[derive(Clone, Copy)]
pub(super) struct Entry<'a> {
    pub(super) key: &'a Key<'a>,
    pub(super) value: &'a Value<'a>,
}

impl<'a> Entry<'a> {
    pub(super) fn name(&self) -> &'a str {
        self.key.get_ref()
    }
}

/// The keys and values of a table that describes something.
pub(super) struct Fields<'a> {
    pub(super) table: &'a Table<'a>,
    /// Where to say that a key is missing: at the table's name.
    pub(super) place: Span,
    /// What it describes: "joint `A`".
    pub(super) subject: String,
}

impl<'a> Fields<'a> {
    pub(super) fn get(&self, key: &str) -> Option<&'a Value<'a>> {
        self.table.get(key)
    }

    pub(super) fn key_span(&self, key: &str) -> Option<Span> {
        let (key, _) = self.table.get_key_value(key)?;
        Some(key.span())
    }

    pub(super) fn entries(&self) -> impl Iterator<Item = Entry<'a>> {
        self.table.iter().map(|(key, value)| Entry { key, value })
    }
}

impl<'a> Context<'a> {
    pub(super) fn new(source: &'a Source, problems: Vec<Diagnostic>) -> Self {
        let mut context = Self {
            source,
            problems: Problems::default(),
            parameters: NameTable::new(),
            parameter_values: Vec::new(),
            parameters_used: Vec::new(),
            bodies: NameTable::new(),
            markers: Vec::new(),
            body_names: Vec::new(),
            owners: HashMap::new(),
            carriers: Vec::new(),
            table_files: Vec::new(),
            file_tables: String::new(),
        };
        for problem in problems {
            context.problems.push(problem);
        }
        context
    }

    pub(super) fn error(&mut self, code: &'static str, span: Span, message: impl Into<String>) {
        self.problems
            .push(Diagnostic::error(code, message).label(span, ""));
    }

    pub(super) fn error_with_help(
        &mut self,
        code: &'static str,
        span: Span,
        message: impl Into<String>,
        help: impl Into<Option<String>>,
    ) {
        self.problems
            .push(Diagnostic::error(code, message).label(span, "").help(help));
    }

    fn wrong_type(&mut self, value: &Value<'_>, expected: &str) {
        let found = match value.get_ref() {
            DeValue::Array(items) if expected.starts_with("an array") => match items.len() {
                1 => "one of 1 item".to_owned(),
                length => format!("one of {length} items"),
            },
            other => syntax::kind(other).to_owned(),
        };
        let message = format!("expected {expected}, found {found}");
        self.error(code::WRONG_TYPE, value.span(), message);
    }

    /// Reports the keys that are not among `legal`.
    pub(super) fn check_keys(&mut self, fields: &Fields<'a>, legal: &[&str]) {
        for entry in fields.entries() {
            let key = entry.name();
            if !legal.contains(&key) {
                let message = format!("unknown key {} in {}", quoted(key), fields.subject);
                let help = names::help(key, legal, &[]);
                self.error_with_help(code::UNKNOWN_KEY, entry.key.span(), message, help);
            }
        }
    }

    /// The value of a key that must be there; `form` shows how it is written.
    pub(super) fn required(
        &mut self,
        fields: &Fields<'a>,
        key: &str,
        form: &str,
    ) -> Option<&'a Value<'a>> {
        let value = fields.get(key);
        if value.is_none() {
            self.error_with_help(
                code::MISSING_KEY,
                fields.place.clone(),
                format!("{} has no `{key}`", fields.subject),
                format!("add `{key} = {form}`"),
            );
        }
        value
    }

    /// A table that stands under `key`, described as `subject`.
    pub(super) fn fields(
        &mut self,
        key: &Key<'a>,
        value: &'a Value<'a>,
        subject: String,
    ) -> Option<Fields<'a>> {
        match value.get_ref() {
            DeValue::Table(table) => Some(Fields {
                table,
                place: key.span(),
                subject,
            }),
            _ => {
                self.wrong_type(value, "a table");
                None
            }
        }
    }

    /// A section of the file, `None` if it is left out.
    pub(super) fn section(&mut self, root: &Fields<'a>, name: &str) -> Option<Fields<'a>> {
        let (key, value) = root.table.get_key_value(name)?;
        self.fields(key, value, format!("`[{name}]`"))
    }

    pub(super) fn text(&mut self, value: &'a Value<'a>) -> Option<&'a str> {
        if let DeValue::String(text) = value.get_ref() {
            return Some(text);
        }
        self.wrong_type(value, "a string");
        None
    }

    /// The text for people under a key that may be left out; it must be fit for XML.
    pub(super) fn optional_text(&mut self, fields: &Fields<'a>, key: &str) -> Option<String> {
        let value = fields.get(key)?;
        let text = self.text(value)?;
        // XML 1.0, section 2.2: the characters that no document may have, not even escaped.
        let illegal = |c: &char| matches!(c, '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}');
        if let Some(character) = text.chars().find(illegal) {
            let message = format!(
                "`{key}` has the character U+{:04X}, which the FMU's XML cannot have",
                u32::from(character)
            );
            self.error(code::ILLEGAL_TEXT, value.span(), message);
            return None;
        }
        Some(text.to_owned())
    }

    /// The description, empty if left out.
    pub(super) fn description(&mut self, fields: &Fields<'a>) -> String {
        self.optional_text(fields, "description")
            .unwrap_or_default()
    }

    pub(super) fn boolean(&mut self, value: &'a Value<'a>) -> Option<bool> {
        if let DeValue::Boolean(boolean) = value.get_ref() {
            return Some(*boolean);
        }
        self.wrong_type(value, "`true` or `false`");
        None
    }

    /// The items of an array.
    pub(super) fn items(
        &mut self,
        value: &'a Value<'a>,
        expected: &str,
    ) -> Option<&'a [Value<'a>]> {
        if let DeValue::Array(items) = value.get_ref() {
            return Some(items);
        }
        self.wrong_type(value, expected);
        None
    }

    /// The items of an array that has as many as `counts` allows.
    pub(super) fn items_of(
        &mut self,
        value: &'a Value<'a>,
        counts: std::ops::RangeInclusive<usize>,
        expected: &str,
    ) -> Option<&'a [Value<'a>]> {
        let items = self.items(value, expected)?;
        if counts.contains(&items.len()) {
            return Some(items);
        }
        self.wrong_type(value, expected);
        None
    }

    /// N numbers in an array, such as `[x, y]`.
    pub(super) fn quantities<const N: usize>(
        &mut self,
        value: &'a Value<'a>,
        expected: &str,
    ) -> Option<[Quantity; N]> {
        let items = self.items_of(value, N..=N, expected)?;
        // All are read, so that each says what is wrong with it.
        let read: Vec<Option<Quantity>> = items.iter().map(|item| self.quantity(item)).collect();
        let quantities: Vec<Quantity> = read.into_iter().collect::<Option<_>>()?;
        quantities.try_into().ok()
    }

    /// A number or an expression over the parameters, finite with the file's values.
    pub(super) fn quantity(&mut self, value: &'a Value<'a>) -> Option<Quantity> {
        let expression = self.expression(value, None)?;
        let mut quantity = Quantity {
            expression,
            value: None,
            span: value.span(),
        };
        self.evaluate(&mut quantity)?;
        Some(quantity)
    }

    /// Gives a quantity its value for the file's parameters; `None` if that is not finite.
    pub(super) fn evaluate(&mut self, quantity: &mut Quantity) -> Option<()> {
        let Some(jet) = self.value_at(&quantity.expression, 0.0) else {
            return Some(());
        };
        if jet.value.is_finite() {
            quantity.value = Some(jet.value);
            return Some(());
        }
        self.not_finite(quantity.span.clone(), "the value");
        None
    }

    /// The value at `variable` for the file's parameters, `None` if one of them has no value.
    pub(super) fn value_at(&self, expression: &Expression, variable: f64) -> Option<Jet> {
        let values = &self.parameter_values;
        expression
            .parameters()
            .all(|id| values[id.index()].is_some())
            .then(|| {
                let parameter = |id: ParameterId| {
                    Jet::constant(values[id.index()].expect("just seen to have a value"))
                };
                expression.evaluate(&parameter, Jet::variable(variable))
            })
    }

    pub(super) fn not_finite(&mut self, span: Span, what: &str) {
        let text = self.source.text().get(span.clone()).unwrap_or_default();
        let text = text.trim_matches(['"', '\'']);
        let message = format!(
            "{what} of {} is not finite with the file's parameters",
            quoted(text)
        );
        self.error(code::NOT_FINITE, span, message);
    }

    /// A number or an expression, not evaluated.
    pub(super) fn expression(
        &mut self,
        value: &'a Value<'a>,
        variable: Option<Variable>,
    ) -> Option<Expression> {
        if let Some(number) = syntax::number(value.get_ref()) {
            if number.is_finite() {
                return Some(Expression::constant(number));
            }
            self.error(code::NOT_FINITE, value.span(), "the number is not finite");
            return None;
        }
        let DeValue::String(text) = value.get_ref() else {
            self.wrong_type(value, "a number or an expression string");
            return None;
        };
        let scope = Scope {
            parameters: &self.parameters,
            variable,
        };
        match Expression::parse(text, scope) {
            Ok(expression) => {
                for id in expression.parameters() {
                    self.parameters_used[id.index()] = true;
                }
                Some(expression)
            }
            Err(error) => {
                let span = match syntax::content_span(self.source, value.span(), text) {
                    Some(content) if !content.is_empty() => {
                        content.start + error.span.start..content.start + error.span.end
                    }
                    _ => value.span(),
                };
                self.error_with_help(code::BAD_EXPRESSION, span, error.message, error.help);
                None
            }
        }
    }

    /// Reports a value that is not positive.
    pub(super) fn check_positive(&mut self, quantity: &Quantity, what: &str) {
        if let Some(value) = quantity.value.filter(|value| *value <= 0.0) {
            self.error(
                code::ILLEGAL_VALUE,
                quantity.span.clone(),
                format!("{what} must be positive, is {}", shown(value)),
            );
        }
    }

    /// Warns of an angle that is a bare number of more than a turn: it looks like degrees.
    pub(super) fn warn_of_degrees(&mut self, angle: &Quantity) {
        let text = self.source.text().get(angle.span.clone());
        // Whoever writes an expression knows what they do.
        let is_bare = text.is_some_and(|text| !text.starts_with(['"', '\'']));
        if let Some(value) = angle.value.filter(|value| is_bare && value.abs() > TAU) {
            let message = format!(
                "an angle of {} rad is {:.1} deg",
                shown(value),
                value.to_degrees()
            );
            let warning = Diagnostic::warning(code::LARGE_ANGLE, message)
                .label(angle.span.clone(), "")
                .help(format!("degrees are written `\"{}*deg\"`", shown(value)));
            self.problems.push(warning);
        }
    }

    /// One of the words in `choices`.
    pub(super) fn choice<T: Copy>(
        &mut self,
        value: &'a Value<'a>,
        choices: &[(&str, T)],
        code: &'static str,
        what: &str,
    ) -> Option<T> {
        let text = self.text(value)?;
        if let Some((_, meaning)) = choices.iter().find(|(word, _)| *word == text) {
            return Some(*meaning);
        }
        let words: Vec<&str> = choices.iter().map(|(word, _)| *word).collect();
        let message = format!("no {what} {}", quoted(text));
        self.error_with_help(code, value.span(), message, names::help(text, &words, &[]));
        None
    }
}

//! State of reading a file: the names and values known so far, and the problems found.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use toml::de::DeValue;

use crate::mechanism::diagnostic::code;
use crate::mechanism::expression::FunctionNames;
use crate::mechanism::names::NameTable;
use crate::mechanism::syntax::{self, Value};
use crate::mechanism::wording::quoted;
use crate::mechanism::{
    BodyId, Coordinate, Diagnostic, Dimension, Label, MarkerId, ParameterId, Severity, ShapeId,
    Source, Span, TableFile,
};

/// Most problems that are shown; the others are counted. A file of garbage would make a million.
const MAX_PROBLEMS: usize = 100;

/// Name of the body that never moves.
pub(super) const GROUND: &str = "ground";

/// Names of a body's own quantities, which no marker and no shape may have.
pub(super) const BODY_QUANTITIES: [&str; 9] =
    ["x", "y", "phi", "vx", "vy", "omega", "ax", "ay", "alpha"];

/// Length of the file, for the comparison with all others.
pub(super) struct Length {
    /// Magnitude \[m\], positive.
    pub(super) size: f64,
    /// Place, `None` if an expression makes it.
    pub(super) bare: Option<Span>,
}

/// A shape as references see it.
pub(super) struct KnownShape {
    pub(super) place: Span,
    pub(super) carrier: Option<BodyId>,
    /// Its first marker, `None` if it could not be read.
    pub(super) marker: Option<MarkerId>,
    pub(super) is_round: bool,
}

/// State of reading one file.
pub(super) struct Context<'a> {
    pub(super) source: &'a Source,
    problems: Vec<Diagnostic>,
    /// Number of problems that are not shown, and the last of them.
    omitted: (usize, Option<Diagnostic>),
    /// Whether one of the problems is an error.
    pub(super) failed: bool,
    pub(super) parameters: NameTable<'a, ParameterId>,
    /// The file's value of each parameter, `None` before it is computed and if it is wrong.
    pub(super) parameter_values: Vec<Option<f64>>,
    /// Dimension of each parameter with a unit.
    pub(super) parameter_dimensions: Vec<Option<Dimension>>,
    /// Lengths read so far, but for zeros.
    pub(super) lengths: Vec<Length>,
    /// Keys that other ones were probably meant to be, by the place of their table.
    pub(super) misspelt_keys: HashSet<(usize, &'static str)>,
    /// Whether anything uses each parameter.
    pub(super) parameters_used: Vec<bool>,
    /// Moving bodies.
    pub(super) bodies: NameTable<'a, BodyId>,
    pub(super) body_names: Vec<&'a str>,
    /// Coordinates of drivers and measures, `None` after an error.
    pub(super) coordinates: Vec<(&'a str, Option<Coordinate>)>,
    /// Names of computed measures.
    pub(super) computed: Vec<&'a str>,
    /// Joints, then constraints, by their places among these.
    pub(super) holders: NameTable<'a, usize>,
    /// Numbers of joints and of constraints.
    pub(super) holder_counts: [usize; 2],
    /// Markers of ground, then of each body; `None` where they cannot be read.
    pub(super) markers: Vec<Option<NameTable<'a, MarkerId>>>,
    /// Body of each marker, `None` for ground.
    pub(super) carriers: Vec<Option<BodyId>>,
    /// Shapes of ground, then of each body; `None` where they cannot be read.
    pub(super) shape_names: Vec<Option<NameTable<'a, ShapeId>>>,
    /// Shapes as references see them.
    pub(super) shapes: Vec<KnownShape>,
    /// Name of the first body, or `ground`, that has a marker of this name.
    pub(super) owners: HashMap<&'a str, &'a str>,
    /// Inputs by their places.
    pub(super) inputs: NameTable<'a, usize>,
    /// Whether anything uses each input.
    pub(super) inputs_used: Vec<bool>,
    /// Value of each input at the start.
    pub(super) input_starts: Vec<f64>,
    /// Dimension of each input with a unit.
    pub(super) input_dimensions: Vec<Option<Dimension>>,
    /// Functions, `None` in a file without.
    pub(super) functions: Option<Rc<FunctionNames<'a>>>,
    /// Whether all functions could be read, or are still to be read.
    pub(super) has_functions: bool,
    /// Whether anything calls each function.
    pub(super) functions_used: Vec<bool>,
    /// Names of the arguments of the function that is read.
    pub(super) arguments: Vec<&'a str>,
    /// CSV files read so far.
    pub(super) table_files: Vec<TableFile>,
    /// Numbers taken from them, for the canonical form.
    pub(super) file_tables: String,
}

impl<'a> Context<'a> {
    pub(super) fn new(source: &'a Source) -> Self {
        Self {
            source,
            problems: Vec::new(),
            omitted: (0, None),
            failed: false,
            parameters: NameTable::new(),
            parameter_values: Vec::new(),
            parameter_dimensions: Vec::new(),
            lengths: Vec::new(),
            misspelt_keys: HashSet::new(),
            parameters_used: Vec::new(),
            bodies: NameTable::new(),
            body_names: Vec::new(),
            coordinates: Vec::new(),
            computed: Vec::new(),
            holders: NameTable::new(),
            holder_counts: [0; 2],
            markers: Vec::new(),
            carriers: Vec::new(),
            shape_names: Vec::new(),
            shapes: Vec::new(),
            owners: HashMap::new(),
            inputs: NameTable::new(),
            inputs_used: Vec::new(),
            input_starts: Vec::new(),
            input_dimensions: Vec::new(),
            functions: None,
            has_functions: true,
            functions_used: Vec::new(),
            arguments: Vec::new(),
            table_files: Vec::new(),
            file_tables: String::new(),
        }
    }

    /// Adds a problem; returns it, so that labels and help can be added.
    pub(super) fn report(&mut self, problem: Diagnostic) -> &mut Diagnostic {
        self.failed |= problem.severity == Severity::Error;
        if self.problems.len() < MAX_PROBLEMS {
            self.problems.push(problem);
            return self.problems.last_mut().expect("a problem was added");
        }
        self.omitted.0 += 1;
        self.omitted.1.insert(problem)
    }

    pub(super) fn error(
        &mut self,
        code: &'static str,
        span: Span,
        message: impl Into<String>,
    ) -> &mut Diagnostic {
        self.report(Diagnostic::error(code, message).label(span, ""))
    }

    pub(super) fn warn(
        &mut self,
        code: &'static str,
        span: Span,
        message: impl Into<String>,
    ) -> &mut Diagnostic {
        self.report(Diagnostic::warning(code, message).label(span, ""))
    }

    /// Adds a further place to a warning of this kind, whose help begins in this way, if there is one
    /// already; of very many only the first.
    pub(super) fn warn_again(&mut self, code: &'static str, help: &str, span: &Span) -> bool {
        const MOST_PLACES: usize = 8;
        let is_alike = |problem: &&mut Diagnostic| {
            let own = problem.help.as_deref().unwrap_or_default();
            problem.code == code && own.starts_with(help)
        };
        let Some(problem) = self.problems.iter_mut().find(is_alike) else {
            return false;
        };
        if problem.labels.len() < MOST_PLACES {
            let (span, text) = (span.clone(), "likewise".to_owned());
            problem.labels.push(Label { span, text });
        }
        true
    }

    /// Reports a key that a table already has.
    pub(super) fn duplicate_key(&mut self, second: Span) {
        let text = self.source.text();
        let key = quoted(text.get(second.clone()).unwrap_or_default());
        let message = format!("the key {key} is given twice");
        let mut problem = Diagnostic::error(code::DUPLICATE_KEY, message).label(second.clone(), "");
        // The search reads the whole file, which a problem that is not shown is not worth.
        if self.problems.len() < MAX_PROBLEMS
            && let Some(first) = syntax::first_place(text, &second)
        {
            problem = problem.label(first, "the first one");
        }
        self.report(problem);
    }

    /// Returns the problems in the order of the file, those without a place first; the last one
    /// counts those not shown.
    pub(super) fn into_problems(mut self) -> Vec<Diagnostic> {
        self.problems
            .sort_by_key(|problem| problem.labels.first().map(|label| label.span.start));
        if self.omitted.0 > 0 {
            let message = format!("{} more problems are not shown", self.omitted.0);
            let mut problem = Diagnostic::warning(code::TOO_MANY_PROBLEMS, message);
            if self.failed {
                problem.severity = Severity::Error;
            }
            self.problems.push(problem);
        }
        self.problems
    }

    pub(super) fn wrong_type(&mut self, value: &Value<'_>, expected: &str) -> &mut Diagnostic {
        let found = match value.get_ref() {
            DeValue::Array(items) if expected.starts_with("an array") => match items.len() {
                1 => "one of 1 item".to_owned(),
                length => format!("one of {length} items"),
            },
            other => syntax::kind(other).to_owned(),
        };
        let message = format!("expected {expected}, found {found}");
        self.error(code::WRONG_TYPE, value.span(), message)
    }

    pub(super) fn text(&mut self, value: &'a Value<'a>) -> Option<&'a str> {
        let text = value.get_ref().as_str();
        if text.is_none() {
            self.wrong_type(value, "a string");
        }
        text
    }

    /// Returns the items of an array.
    pub(super) fn items(
        &mut self,
        value: &'a Value<'a>,
        expected: &str,
    ) -> Option<&'a [Value<'a>]> {
        let items = value.get_ref().as_array();
        if items.is_none() {
            self.wrong_type(value, expected);
        }
        Some(items?)
    }

    /// Returns whether these parameters have values, and functions that are called could be read.
    pub(super) fn knows(&self, mut parameters: impl Iterator<Item = ParameterId>) -> bool {
        let has_functions = self.functions_used.is_empty() || self.has_functions;
        has_functions && parameters.all(|id| self.parameter_values[id.index()].is_some())
    }

    /// Returns the file's value of a parameter that [has one](Self::knows), otherwise 0.
    pub(super) fn known_value(&self, id: ParameterId) -> f64 {
        self.parameter_values[id.index()].unwrap_or(0.0)
    }

    /// Returns the name of a body, of ground if it is `None`.
    pub(super) fn carrier_name(&self, carrier: Option<BodyId>) -> &'a str {
        carrier.map_or(GROUND, |body| self.body_names[body.index()])
    }
}

//! Functions: expressions, points and grids that expressions call by name.

use std::collections::HashSet;

use crate::mechanism::diagnostic::code;
use crate::mechanism::expression::{FunctionNames, Signature, is_taken};
use crate::mechanism::names::is_legal;
use crate::mechanism::syntax::{self, Value};
use crate::mechanism::wording::quoted;
use crate::mechanism::{
    CalledPoints, Diagnostic, Ends, Expression, Function, FunctionBody, Functions, Grid,
    Interpolation, MOST_ARGUMENTS, MOST_MOVING_POINTS, ParameterId, PointFunction, Span,
};

use super::context::Context;
use super::derived::Unread;
use super::kind::{AnyOf, Array, Entry, ExternalName, Item, Kind, Text, schema};
use super::motion::{ENDS, LAW};
use super::number::{Limit, Quantity};
use super::points::PointKeys;
use super::table::table;
use super::unit::Factor;

table! {
    /// A function given by an expression.
    struct FormulaKeys<'a> {
        /// Expression over the arguments, parameters and other functions.
        #[required("\"max(0, x)\"")]
        value: &'a Value<'a> = Unread,
        /// Names of the arguments; x if left out.
        of: Vec<&'a str> = Arguments,
        /// Description in one line.
        description: String = Text,
    }

    /// A function of one argument through points.
    struct FunctionPointKeys<'a> {
        /// Way from each point to the next; a spline if left out. With steps a point's value holds until
        /// the next one.
        law: Interpolation = LAW,
        /// Course before the first point and after the last; clamped if left out.
        ends: Ends = ENDS,
        /// Number of arguments; one if left out.
        arguments: usize = ARGUMENTS,
        /// Description in one line.
        description: String = Text,
    }

    /// A function of two arguments through the points of a grid.
    struct GridKeys<'a> {
        /// Name of a CSV file beside this one: first argument down the first column, second one along the
        /// first row, values between; the first cell counts for nothing.
        #[required("\"map.csv\"")]
        file: &'a str = ExternalName,
        /// Number of arguments: 2.
        arguments: usize = ARGUMENTS,
        /// Factors of both arguments and of the values: numbers or units.
        scale: [Quantity; 3] = Array::new("[1, 1, 1]", [const { Factor }; 3]),
        /// Way from each point to the next, spline or linear; a spline if left out.
        law: Interpolation = LAW,
        /// Course outside: clamped, linear or zero; clamped if left out.
        ends: Ends = ENDS,
        /// Description in one line.
        description: String = Text,
    }
}

/// A function of any shape.
pub(super) type AnyFunction = AnyOf<
    FormulaKeys<'static>,
    AnyOf<(PointKeys<'static>, FunctionPointKeys<'static>), GridKeys<'static>>,
>;

const ARGUMENTS: Count = Count;

/// Number of arguments: 1 or 2.
struct Count;

impl<'a> Kind<'a> for Count {
    type Value = usize;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<usize> {
        let count = one_or_two(item.value);
        if count.is_some() {
            return count;
        }
        let message = "points make a function of one argument or of two";
        context
            .error(code::ILLEGAL_VALUE, item.span(), message)
            .suggest("more arguments have a function with `of` and `value`");
        None
    }

    schema! {{ "enum": [1, 2] }}
}

/// Names of arguments.
struct Arguments;

impl<'a> Kind<'a> for Arguments {
    type Value = Vec<&'a str>;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Vec<&'a str>> {
        let items = context.items(item.value, "an array of names such as `[\"x\", \"v\"]`")?;
        let mut names = Vec::new();
        for value in items {
            let name = context.text(value)?;
            let (message, help) = if !is_legal(name) {
                let message = format!("illegal name {} of an argument", quoted(name));
                (message, "a letter, then letters, digits and `_`")
            } else if is_taken(name) {
                let message = format!("the name {} is taken by the language", quoted(name));
                (message, "choose another name for the argument")
            } else if names.contains(&name) {
                let message = format!("{} is listed twice", quoted(name));
                (message, "each argument has a name of its own")
            } else {
                names.push(name);
                continue;
            };
            context
                .error(code::ILLEGAL_NAME, value.span(), message)
                .suggest(help);
            return None;
        }
        if (1..=MOST_ARGUMENTS).contains(&names.len()) {
            return Some(names);
        }
        let message = format!(
            "a function has from one to {MOST_ARGUMENTS} arguments, this one {}",
            names.len()
        );
        context.error(code::ILLEGAL_VALUE, item.span(), message);
        None
    }

    schema! {
        { "type": "array", "items": { "type": "string" }, "minItems": 1, "maxItems": MOST_ARGUMENTS }
    }
}

/// Most operations of a call, with those of all functions that are called on the way: of some hundred
/// formulas as one writes them. Doubled, a motion that calls such a function takes twice as long.
const MOST_OPERATIONS: usize = 10_000;
/// Most functions that call one another in a row: each takes a part of the stack. Doubled, a call takes up
/// to a megabyte of it.
const MOST_IN_A_ROW: usize = 16;

/// A function while it is read.
struct Draft<'a> {
    entry: Entry<'a>,
    /// Place of its expression.
    span: Span,
    function: Option<Function>,
}

impl Draft<'_> {
    /// Returns the places of the functions that it calls.
    fn calls(&self) -> Vec<usize> {
        match &self.function {
            Some(Function {
                body: FunctionBody::Formula(expression),
                ..
            }) => expression.calls().collect(),
            _ => Vec::new(),
        }
    }
}

impl<'a> Context<'a> {
    /// Reads the functions. Parameters that call none have their values.
    pub(super) fn functions(&mut self, entries: &[Entry<'a>]) -> Functions {
        if entries.is_empty() {
            return Functions::default();
        }
        let drafts = entries.iter().map(|entry| self.function_draft(*entry));
        let mut drafts: Vec<Draft<'a>> = drafts.collect();
        let Some(order) = self.order_of_functions(&drafts) else {
            self.has_functions = false;
            return Functions::default();
        };
        self.complete_functions(&mut drafts, &order);
        let read = drafts.into_iter().map(|draft| draft.function);
        let read: Option<Vec<_>> = read.collect();
        self.has_functions = read.is_some();
        let functions = Functions::new(read.unwrap_or_default());
        let known = entries.iter().enumerate().map(|(place, entry)| {
            let own = functions.list().get(place);
            let arguments = own.map(|function| function.arguments);
            (entry.name(), Signature { place, arguments })
        });
        let names = FunctionNames {
            known: known.collect(),
            list: functions.clone(),
        };
        self.functions = Some(names.into());
        functions
    }

    /// Declares the names of the functions, which are read later.
    pub(super) fn declare_functions(&mut self, entries: &[Entry<'a>]) {
        let places = entries.iter().enumerate();
        let known = places.map(|(place, entry)| {
            let arguments = number_of_arguments(entry);
            (entry.name(), Signature { place, arguments })
        });
        let names = FunctionNames {
            known: known.collect(),
            list: Functions::default(),
        };
        self.functions = Some(names.into());
        self.functions_used = vec![false; entries.len()];
    }

    /// Reads a function, which lacks what others that it calls bring in; a parameter may be listed twice.
    fn function_draft(&mut self, entry: Entry<'a>) -> Draft<'a> {
        let mut span = entry.value.span();
        let read = self.function(entry, &mut span);
        let function = read.map(|(arguments, body, description)| {
            let (parameters, first_jump, has_pieces) = match &body {
                FunctionBody::Formula(formula) => {
                    (formula.parameters().collect(), None, formula.has_pieces())
                }
                FunctionBody::Points(points) => {
                    let function = points.function();
                    let parameters = function.table.parameters().collect();
                    (parameters, function.first_jump(), false)
                }
                FunctionBody::Grid(grid) => {
                    let parameters = grid.scale.iter().flat_map(Expression::parameters);
                    (parameters.collect(), grid.first_jump(), false)
                }
            };
            Function {
                name: entry.name().to_owned(),
                description,
                arguments,
                body,
                parameters,
                first_jump,
                has_pieces,
                says_ends: entry
                    .value
                    .get_ref()
                    .as_table()
                    .is_some_and(|keys| keys.contains_key("ends")),
            }
        });
        Draft {
            entry,
            span,
            function,
        }
    }

    /// Returns the number of arguments of a function, what it computes, and its description.
    fn function(
        &mut self,
        entry: Entry<'a>,
        span: &mut Span,
    ) -> Option<(usize, FunctionBody, String)> {
        if !entry.value.get_ref().is_table() {
            self.wrong_type(entry.value, "a table").suggest(
                "write `{ value = \"max(0, x)\" }`, `{ table = [[0, 0], [1, 2]] }` or \
                 `{ file = \"a.csv\" }`",
            );
            return None;
        }
        let fields = self.entry_fields(entry, "function")?;
        let has = |key| fields.table.contains_key(key);
        if has("value") {
            let keys = self.table::<FormulaKeys<'a>>(&fields);
            self.arguments = keys.of.or(vec!["x"])?;
            *span = keys.value.span.clone();
            let value = keys
                .value
                .value
                .and_then(|value| self.formula(value, &[], None));
            let arguments = std::mem::take(&mut self.arguments);
            let description = keys.description.value.unwrap_or_default();
            let body = FunctionBody::Formula(value?.expression);
            return Some((arguments.len(), body, description));
        }
        if number_of_arguments(&entry) == Some(2) {
            let keys = self.table::<GridKeys<'a>>(&fields);
            return self.grid(keys);
        }
        let (points, keys) = self.table::<(PointKeys<'a>, FunctionPointKeys<'a>)>(&fields);
        let interpolation = keys.law.or(Interpolation::Spline);
        let ends = keys.ends.or(Ends::Clamped);
        keys.arguments.optional()?;
        let place = points.owner.place.clone();
        let points = self.points(points)?;
        let function = PointFunction {
            table: points.table,
            interpolation: interpolation?,
            ends: ends?,
        };
        let description = keys.description.value.unwrap_or_default();
        let Some(points) = CalledPoints::new(function) else {
            let most = MOST_MOVING_POINTS;
            let message = format!(
                "{} has more than {most} points that use parameters",
                fields.subject
            );
            self.error(code::BAD_TABLE, place, message)
                .suggest("write numbers, and multiply all of them by a parameter with `scale`");
            return None;
        };
        Some((1, FunctionBody::Points(points), description))
    }

    /// Reads a grid.
    fn grid(&mut self, keys: GridKeys<'a>) -> Option<(usize, FunctionBody, String)> {
        let law_place = keys.law.span.clone();
        let ends_place = keys.ends.span.clone();
        let is_smooth = match keys.law.or(Interpolation::Spline)? {
            Interpolation::Spline => true,
            Interpolation::Linear => false,
            Interpolation::Law(_) | Interpolation::Steps => {
                let message = "a grid of two arguments is a spline or linear";
                self.error(code::ILLEGAL_VALUE, law_place, message)
                    .suggest("leave `law` out, or write `law = \"linear\"`");
                return None;
            }
        };
        let ends = keys.ends.or(Ends::Clamped)?;
        if matches!(ends, Ends::Natural | Ends::Periodic) {
            let message = "a grid of two arguments has ends that are clamped, linear or zero";
            self.error(code::ILLEGAL_VALUE, ends_place, message)
                .suggest("`clamped` holds the value at the border");
            return None;
        }
        keys.arguments.value?;
        let scale = match keys.scale.optional()? {
            None => [1.0; 3].map(Expression::constant),
            Some(scale) => {
                for factor in &scale[..2] {
                    let subject = "the factor of an argument";
                    self.check_limit(Limit::Positive, factor, subject)?;
                }
                scale.map(|factor| factor.expression)
            }
        };
        let (abscissas, values) = self.grid_of_file(keys.file.value?, &keys.file.span)?;
        let grid = Grid::new(abscissas, &values, is_smooth, ends, scale);
        let description = keys.description.value.unwrap_or_default();
        Some((2, FunctionBody::Grid(grid), description))
    }

    /// Returns the functions in an order in which each comes after those that it calls; `None` after a
    /// ring, which is reported.
    fn order_of_functions(&mut self, drafts: &[Draft<'a>]) -> Option<Vec<usize>> {
        let mut order = Vec::new();
        // Places on the way to the function at hand, each with its calls that are left.
        let mut is_done = vec![false; drafts.len()];
        for start in 0..drafts.len() {
            let mut way = vec![(start, drafts[start].calls())];
            while let Some((at, calls)) = way.last_mut() {
                let at = *at;
                let Some(called) = calls.pop().filter(|_| !is_done[at]) else {
                    if !std::mem::replace(&mut is_done[at], true) {
                        order.push(at);
                    }
                    way.pop();
                    continue;
                };
                if let Some(begin) = way.iter().position(|(place, _)| *place == called) {
                    let ring: Vec<usize> = way[begin..].iter().map(|(place, _)| *place).collect();
                    self.report_ring(drafts, ring);
                    return None;
                }
                if !is_done[called] {
                    way.push((called, drafts[called].calls()));
                }
            }
        }
        Some(order)
    }

    /// Reports functions that call one another.
    fn report_ring(&mut self, drafts: &[Draft<'a>], mut ring: Vec<usize>) {
        /// Most functions of a ring that a message names.
        const MOST_SHOWN: usize = 10;
        let first = (0..ring.len()).min_by_key(|at| ring[*at]).unwrap_or(0);
        ring.rotate_left(first);
        let name = |place: usize| quoted(drafts[place].entry.name());
        let shown = &ring[..ring.len().min(MOST_SHOWN)];
        let mut names: Vec<String> = shown.iter().map(|place| name(*place)).collect();
        if shown.len() < ring.len() {
            names.push(format!("… ({} more)", ring.len() - shown.len()));
        }
        names.push(name(ring[0]));
        let message = match ring.len() {
            1 => format!("the function {} calls itself", names[0]),
            _ => format!("the functions call one another: {}", names.join(" → ")),
        };
        let mut problem = Diagnostic::error(code::FUNCTION_RING, message);
        for (at, place) in shown.iter().enumerate() {
            let called = ring[(at + 1) % ring.len()];
            problem = problem.label(
                drafts[*place].span.clone(),
                format!("calls {}", name(called)),
            );
        }
        self.report(problem);
    }

    /// Gives functions what those that they call bring in; reports those that take too much.
    fn complete_functions(&mut self, drafts: &mut [Draft<'a>], order: &[usize]) {
        let mut costs = vec![(0_usize, 0_usize); drafts.len()];
        for &place in order {
            let calls = drafts[place].calls();
            let distinct: HashSet<usize> = calls.iter().copied().collect();
            let mut parameters = Vec::new();
            let (mut first_jump, mut has_pieces) = (None, false);
            for called in distinct
                .iter()
                .filter_map(|called| drafts[*called].function.as_ref())
            {
                parameters.extend_from_slice(&called.parameters);
                first_jump = [first_jump, called.first_jump].into_iter().flatten().min();
                has_pieces |= called.has_pieces;
            }
            let in_a_row = distinct
                .iter()
                .map(|called| costs[*called].1)
                .max()
                .unwrap_or(0)
                + 1;
            let Draft {
                function: Some(function),
                span,
                ..
            } = &mut drafts[place]
            else {
                continue;
            };
            let own = match &function.body {
                FunctionBody::Formula(formula) => formula.length(),
                FunctionBody::Points(_) | FunctionBody::Grid(_) => 1,
            };
            let called = calls.iter().map(|called| costs[*called].0);
            let operations = called.fold(own, usize::saturating_add);
            costs[place] = (operations, in_a_row);
            parameters.extend_from_slice(&function.parameters);
            parameters.sort_unstable();
            parameters.dedup();
            function.parameters = parameters.into();
            function.first_jump = [function.first_jump, first_jump]
                .into_iter()
                .flatten()
                .min();
            function.has_pieces |= has_pieces || function.first_jump.is_some_and(|jump| jump < 2);
            if operations > MOST_OPERATIONS || in_a_row > MOST_IN_A_ROW {
                let name = quoted(&function.name);
                let message = if in_a_row > MOST_IN_A_ROW {
                    format!(
                        "the function {name} calls others, which call others, {in_a_row} in a row; \
                         {MOST_IN_A_ROW} at most are possible"
                    )
                } else {
                    format!(
                        "a call of the function {name} takes {operations} operations, \
                         {MOST_OPERATIONS} at most are possible"
                    )
                };
                self.error(code::BAD_EXPRESSION, span.clone(), message)
                    .suggest("write a table of its values: `table = [[0, 0], [1, 2]]`");
                // Those that call it would tell the same.
                costs[place] = (0, 0);
            }
        }
    }

    /// Checks the functions whose points use parameters that call functions, which had no values when they
    /// were read: their arguments rise.
    pub(super) fn check_functions(&mut self, entries: &[Entry<'a>], functions: &Functions) {
        for (entry, function) in entries.iter().zip(functions.list()) {
            if !self.knows(function.parameters.iter().copied()) {
                continue;
            }
            let parameter = |id: ParameterId| self.known_value(id);
            let rises = match &function.body {
                FunctionBody::Formula(_) => true,
                FunctionBody::Points(points) => {
                    let table = &points.function().table;
                    let [mut x, mut y] = [(); 2].map(|()| vec![0.0; table.points.len()]);
                    table.write(&parameter, &mut x, &mut y);
                    x.windows(2).all(|pair| pair[0] < pair[1])
                }
                FunctionBody::Grid(grid) => {
                    let mut factors = grid.scale[..2].iter();
                    factors.all(|factor| factor.evaluate(&parameter, 0.0) > 0.0)
                }
            };
            if !rises {
                let name = quoted(&function.name);
                let message = format!(
                    "the arguments of the points of the function {name} do not rise with the file's \
                     parameters"
                );
                self.error(code::BAD_TABLE, entry.value.span(), message);
            }
        }
    }

    /// Reports functions whose value jumps where only forces and measures may use them.
    pub(super) fn refuse_jumps(&mut self, expression: &Expression, span: &Span) -> Option<()> {
        let Some(jumping) = expression.jumping_function() else {
            return Some(());
        };
        let message = format!("the function {} jumps", quoted(&jumping.name));
        self.error(code::BAD_EXPRESSION, span.clone(), message).suggest(
            "only the `value` of forces and measures may jump; elsewhere give it another `law` than \
             `steps` and other `ends` than `zero`",
        );
        None
    }
}

/// Returns the number of arguments as the keys tell it, `None` if they do not.
fn number_of_arguments(entry: &Entry<'_>) -> Option<usize> {
    let table = entry.value.get_ref().as_table()?;
    if table.contains_key("value") {
        return match table.get("of") {
            Some(names) => Some(names.get_ref().as_array()?.len()),
            None => Some(1),
        };
    }
    match table.get("arguments") {
        Some(count) => one_or_two(count),
        None => Some(1),
    }
}

/// Returns a number of arguments of a function through points.
fn one_or_two(value: &Value<'_>) -> Option<usize> {
    match syntax::number(value.get_ref()) {
        Some(1.0) => Some(1),
        Some(2.0) => Some(2),
        _ => None,
    }
}

//! The parameters: their attributes, their order of derivation and their values.

use std::collections::HashSet;

use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use crate::mechanism::diagnostic::code;
use crate::mechanism::wording::{either, quoted};
use crate::mechanism::{
    Diagnostic, DisplayUnit, Expression, Function, FunctionBody, Functions, Parameter, ParameterId,
    Unit,
};

use super::context::Context;
use super::kind::{Described, Entry, Flag, Kind, Text};
use super::number::NUMBER;
use super::number::{Formula, Limit, Quantity};
use super::table::{Field, table};
use super::unit::{ShownUnit, SiUnit};

table! {
    /// A parameter with attributes.
    struct ParameterKeys<'a> {
        /// Value in the SI unit; an expression over other parameters makes it a derived parameter.
        #[required("0.1")]
        value: Quantity = Formula(&[]),
        /// SI unit of the value.
        unit: Unit = SiUnit { has_display: true },
        /// Unit in which hosts show the value.
        display: DisplayUnit = ShownUnit,
        /// Smallest permitted value.
        min: Quantity = Formula(&[]),
        /// Largest permitted value.
        max: Quantity = Formula(&[]),
        /// Largest deviation of the real value from the value, up or down.
        tolerance: Quantity = Formula(&[]),
        /// Whether the value may change between steps.
        tunable: bool = Flag,
        /// Description in one line.
        description: String = Text,
    }
}

/// A parameter: a number, or a table with its attributes.
pub(super) struct AnyParameter;

impl Described for AnyParameter {
    fn schema() -> serde_json::Value {
        serde_json::json!({ "anyOf": [NUMBER.schema(), ParameterKeys::schema()] })
    }
}

/// Most parameters of a cycle that its message names and marks.
const MAX_SHOWN_IN_CYCLE: usize = 8;

/// Parameter before all parameters have their values.
pub(super) struct Draft<'a> {
    entry: Entry<'a>,
    value: Option<Quantity>,
    /// Whether the value was computed, which may have failed.
    is_computed: bool,
    /// Attributes, if the parameter is a table.
    keys: Option<ParameterKeys<'a>>,
}

impl Draft<'_> {
    /// Returns the value and the attributes that are numbers.
    fn quantities(&mut self) -> impl Iterator<Item = &mut Quantity> {
        let keys = self.keys.iter_mut();
        let attributes = keys.flat_map(|keys| [&mut keys.min, &mut keys.max, &mut keys.tolerance]);
        let attributes = attributes.filter_map(|field| field.value.as_mut());
        self.value.iter_mut().chain(attributes)
    }

    /// Returns the indices of the parameters that the value uses, also through functions.
    fn uses(&self) -> impl Iterator<Item = usize> {
        let expressions = self.value.iter().map(|value| &value.expression);
        expressions
            .flat_map(Expression::parameters)
            .map(ParameterId::index)
    }
}

/// Returns the parameters that use one another, each such group after those that it uses.
fn components(drafts: &[Draft<'_>]) -> Vec<Vec<usize>> {
    let mut graph: DiGraph<(), (), usize> = DiGraph::default();
    for _ in drafts {
        graph.add_node(());
    }
    for (user, draft) in drafts.iter().enumerate() {
        for used in draft.uses() {
            graph.add_edge(NodeIndex::new(user), NodeIndex::new(used), ());
        }
    }
    // Strongly connected components come after those that they use.
    let components = kosaraju_scc(&graph).into_iter();
    let places =
        |component: Vec<NodeIndex<usize>>| component.into_iter().map(NodeIndex::index).collect();
    components.map(places).collect()
}

impl<'a> Context<'a> {
    /// Reads the values of the parameters, and computes those that call no functions, which are still to be
    /// read.
    pub(super) fn parameter_drafts(&mut self, entries: &[Entry<'a>]) -> Vec<Draft<'a>> {
        let mut drafts: Vec<Draft<'a>> = entries.iter().map(|entry| self.draft(*entry)).collect();
        for component in components(&drafts) {
            if let [only] = *component
                && let Some(value) = &drafts[only].value
                && value.expression.calls().next().is_none()
            {
                self.compute(&mut drafts, only);
            }
        }
        drafts
    }

    /// Computes the values that call functions, and reads the attributes. Returns with the parameters the
    /// derived ones, each after those it uses.
    pub(super) fn parameters(
        &mut self,
        mut drafts: Vec<Draft<'a>>,
        functions: &Functions,
    ) -> (Vec<Parameter>, Vec<ParameterId>) {
        for draft in &mut drafts {
            for quantity in draft.quantities() {
                quantity.expression = quantity.expression.with_functions(functions);
                self.refuse_jumps(&quantity.expression, &quantity.span);
            }
        }
        let mut derived = Vec::new();
        for component in components(&drafts) {
            match *component {
                [only] if drafts[only].uses().all(|used| used != only) => {
                    self.compute(&mut drafts, only);
                    let is_derived = drafts[only].uses().next().is_some();
                    derived.extend(is_derived.then_some(ParameterId(only)));
                }
                _ => self.report_cycle(&drafts, functions.list(), &component),
            }
        }
        let drafts = drafts.into_iter();
        (
            drafts.filter_map(|draft| self.parameter(draft)).collect(),
            derived,
        )
    }

    /// Computes the value of a parameter, once those that it uses have theirs.
    fn compute(&mut self, drafts: &mut [Draft<'a>], index: usize) {
        let draft = &mut drafts[index];
        if let Some(value) = &mut draft.value
            && !draft.is_computed
            && self.knows(value.expression.parameters())
        {
            draft.is_computed = true;
            self.evaluate(value);
            self.parameter_values[index] = value.value;
        }
    }

    fn draft(&mut self, entry: Entry<'a>) -> Draft<'a> {
        let mut keys = None;
        let value = if entry.value.get_ref().is_table() {
            keys = self.entry::<ParameterKeys<'a>>(entry, "parameter");
            keys.as_mut().and_then(|keys| keys.value.value.take())
        } else {
            self.formula(entry.value, &[], None)
        };
        Draft {
            entry,
            value,
            is_computed: false,
            keys,
        }
    }

    /// Reports one cycle among parameters of which each depends on each other one.
    fn report_cycle(&mut self, drafts: &[Draft<'a>], functions: &[Function], members: &[usize]) {
        let members: HashSet<usize> = members.iter().copied().collect();
        let next = |index: usize| drafts[index].uses().find(|used| members.contains(used));
        let mut seen = HashSet::new();
        let mut at = members.iter().copied().min().unwrap_or(0);
        while seen.insert(at) {
            at = next(at).expect("a parameter of a cycle uses another one of it");
        }
        let around = std::iter::successors(Some(at), |index| next(*index));
        let rest = around.skip(1).take_while(|index| *index != at);
        let mut cycle: Vec<usize> = std::iter::once(at).chain(rest).collect();
        // It starts at the parameter that comes first in the file.
        let first = (0..cycle.len()).min_by_key(|at| cycle[*at]).unwrap_or(0);
        cycle.rotate_left(first);
        let name = |index: usize| quoted(drafts[index].entry.name());
        let shown = &cycle[..cycle.len().min(MAX_SHOWN_IN_CYCLE)];
        let called = |place: usize| {
            let used = ParameterId(cycle[(place + 1) % cycle.len()]);
            let value = drafts[cycle[place]].value.as_ref();
            value.map_or_else(Vec::new, |value| way(&value.expression, functions, used))
        };
        let called: Vec<Vec<String>> = (0..shown.len()).map(called).collect();
        let named = shown.iter().zip(&called).flat_map(|(index, called)| {
            let called = called.iter().cloned();
            std::iter::once(name(*index)).chain(called)
        });
        let mut names: Vec<String> = named.collect();
        if shown.len() < cycle.len() {
            names.push(format!("… ({} more)", cycle.len() - shown.len()));
        }
        names.push(name(cycle[0]));
        let message = match (cycle.len(), names.len()) {
            (1, 2) => format!("the parameter {} uses itself", names[0]),
            (1, _) => format!("the parameter uses itself: {}", names.join(" → ")),
            _ => format!("the parameters use one another: {}", names.join(" → ")),
        };
        let mut problem = Diagnostic::error(code::PARAMETER_CYCLE, message);
        for (place, index) in shown.iter().enumerate() {
            let used = cycle[(place + 1) % cycle.len()];
            let value = drafts[*index].value.as_ref();
            let span = value.map_or(0..0, |value| value.span.clone());
            let label = match called[place].first() {
                Some(function) => format!("calls {function}"),
                None => format!("uses {}", name(used)),
            };
            problem = problem.label(span, label);
        }
        self.report(problem);
    }

    /// Reads the attributes of a parameter, for which all parameters must have their values.
    fn parameter(&mut self, draft: Draft<'a>) -> Option<Parameter> {
        let value = draft.value.as_ref();
        let mut parameter = Parameter {
            name: draft.entry.name().to_owned(),
            description: String::new(),
            derived: draft.uses().next().is_some(),
            expression: Expression::constant(0.0),
            default: 0.0,
            tunable: false,
            unit: None,
            min: None,
            max: None,
            tolerance: None,
        };
        if let Some(keys) = draft.keys {
            parameter.tunable = self.tunable(&keys.tunable, &parameter);
            parameter.tolerance = self.tolerance(keys.tolerance, &parameter);
            parameter.unit = self.unit(keys.unit, keys.display, &keys.owner.subject);
            if let (Some(value), Some(unit)) = (value, parameter.unit) {
                self.warn_of_parameter(value, unit);
            }
            let name = quoted(&parameter.name);
            [parameter.min, parameter.max] =
                self.limits([keys.min, keys.max], (&name, value), parameter.unit);
            parameter.description = keys.description.value.unwrap_or_default();
        }
        let value = draft.value?;
        parameter.default = value.value?;
        parameter.expression = value.expression;
        Some(parameter)
    }

    fn tunable(&mut self, field: &Field<bool>, parameter: &Parameter) -> bool {
        let tunable = field.value.unwrap_or(false);
        if tunable && parameter.derived {
            let name = quoted(&parameter.name);
            let message = format!("{name} is derived from other parameters and cannot be set");
            self.error(code::NOT_TUNABLE, field.span.clone(), message)
                .suggest("make those parameters tunable");
        }
        tunable
    }

    /// Returns the tolerance, which a derived parameter has from those that it uses.
    fn tolerance(&mut self, field: Field<Quantity>, parameter: &Parameter) -> Option<f64> {
        let mut quantity = field.value?;
        self.evaluate(&mut quantity)?;
        let name = quoted(&parameter.name);
        if parameter.derived {
            let message = format!("{name} is derived from other parameters and has no tolerance");
            self.error(code::ILLEGAL_VALUE, quantity.span.clone(), message)
                .suggest("give those parameters tolerances");
        }
        self.check_limit(Limit::Positive, &quantity, "`tolerance`");
        quantity.value
    }

    /// Returns the unit with the display unit, which must have its dimension.
    fn unit(
        &mut self,
        unit: Field<Unit>,
        display: Field<DisplayUnit>,
        subject: &str,
    ) -> Option<Unit> {
        if display.key.is_some() && unit.key.is_none() {
            let message = format!("{subject} has a `display` unit but no `unit`");
            self.error(code::WRONG_DISPLAY_UNIT, display.span, message)
                .suggest("add the SI unit of its value: `unit = \"m\"`");
            return None;
        }
        let (unit, display_span) = (unit.value?, display.span);
        let Some(display) = display.value else {
            return Some(unit);
        };
        if display.dimension != unit.dimension {
            let fitting: Vec<DisplayUnit> = unit.display_units().collect();
            let fitting: Vec<&str> = fitting.iter().map(|unit| &*unit.name).collect();
            let help = match fitting.as_slice() {
                [] => format!("expected a multiple or a part of `{}`", unit.name),
                fitting => format!("expected {}", either(fitting)),
            };
            let message = format!("`{}` is no unit for showing `{}`", display.name, unit.name);
            self.error(code::WRONG_DISPLAY_UNIT, display_span, message)
                .suggest(help);
        }
        Some(unit.shown_in(display))
    }
}

/// Returns the names of the functions by way of which an expression uses a parameter; none if it stands in
/// the expression itself.
fn way(expression: &Expression, functions: &[Function], used: ParameterId) -> Vec<String> {
    let mut names = Vec::new();
    let mut formula = Some(expression);
    while let Some(expression) = formula.filter(|formula| !formula.names(used)) {
        let mut called = expression.calls().filter_map(|place| functions.get(place));
        let Some(function) = called.find(|function| function.parameters.contains(&used)) else {
            break;
        };
        names.push(quoted(&function.name));
        formula = match &function.body {
            FunctionBody::Formula(formula) => Some(formula),
            FunctionBody::Points(_) | FunctionBody::Grid(_) => None,
        };
    }
    names
}

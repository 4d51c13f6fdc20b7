//! Numbers: a TOML number or an expression string, in the SI unit that its key has.

use toml::de::DeValue;

use crate::mechanism::diagnostic::code;
use crate::mechanism::expression::{MovingNames, Parsed, Scope};
use crate::mechanism::syntax::{self, Value};
use crate::mechanism::wording::{quoted, shown};
use crate::mechanism::{Dimension, Expression, ExpressionError, Jet, Span, Unit, Variable};
use crate::unit::UnitName;

use super::context::Context;
use super::kind::{Array, Item, Kind, schema};

/// Number of the file: an expression, with its value for the file's parameters.
pub(super) struct Quantity {
    pub(super) expression: Expression,
    /// Finite; `None` if it uses a parameter that has no value, or is not computed yet.
    pub(super) value: Option<f64>,
    /// `None` if it is not known.
    pub(super) dimension: Option<Dimension>,
    pub(super) span: Span,
}

/// Number or expression over the parameters, computed for the file's parameters.
#[derive(Clone, Copy)]
pub(super) struct Number {
    /// Unit, `None` if it depends on other keys.
    unit: Option<Unit>,
    limit: Limit,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Limit {
    None,
    Positive,
    NotNegative,
}

/// Number in a unit that depends on other keys.
pub(super) const NUMBER: Number = Number {
    unit: None,
    limit: Limit::None,
};
pub(super) const RATIO: Number = NUMBER.in_unit(Unit::ONE);
pub(super) const LENGTH: Number = NUMBER.in_unit(Unit::METRE);
pub(super) const ANGLE: Number = NUMBER.in_unit(Unit::RADIAN);
pub(super) const TIME: Number = NUMBER.in_unit(Unit::SECOND);
/// Components `[x, y]` of a point.
pub(super) const POINT: Array<Number, 2> = Array::new("[x, y]", [LENGTH; 2]);

impl Number {
    pub(super) const fn in_unit(self, unit: Unit) -> Self {
        Self {
            unit: Some(unit),
            ..self
        }
    }

    pub(super) const fn positive(self) -> Self {
        Self {
            limit: Limit::Positive,
            ..self
        }
    }

    pub(super) const fn not_negative(self) -> Self {
        Self {
            limit: Limit::NotNegative,
            ..self
        }
    }
}

impl<'a> Kind<'a> for Number {
    type Value = Quantity;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Quantity> {
        let mut quantity = context.formula(item.value, &[], None)?;
        context.evaluate(&mut quantity)?;
        if let Some(unit) = self.unit {
            context.warn_of_unit(&quantity, unit);
        }
        let subject = format!("`{}`", item.key.get_ref());
        context.check_limit(self.limit, &quantity, &subject);
        Some(quantity)
    }

    schema! {
        number => match number.limit {
            Limit::None => serde_json::json!({ "$ref": "#/$defs/number" }),
            Limit::Positive => serde_json::json!({ "$ref": "#/$defs/number", "exclusiveMinimum": 0 }),
            Limit::NotNegative => serde_json::json!({ "$ref": "#/$defs/number", "minimum": 0 }),
        }
    }

    fn unit(&self) -> Option<UnitName> {
        self.unit.map(|unit| unit.name)
    }
}

/// Number or expression over the parameters and variables, not computed yet.
#[derive(Clone, Copy)]
pub(super) struct Formula(pub(super) &'static [Variable]);

impl<'a> Kind<'a> for Formula {
    type Value = Quantity;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Quantity> {
        context.formula(item.value, self.0, None)
    }

    schema! { NUMBER.schema() }
}

impl<'a> Context<'a> {
    /// Reads a number or an expression over the parameters, `variables` and `moving` quantities; warns
    /// if it adds quantities of different dimensions.
    pub(super) fn formula(
        &mut self,
        value: &'a Value<'a>,
        variables: &[Variable],
        moving: Option<&MovingNames<'_>>,
    ) -> Option<Quantity> {
        let quantity = |expression, dimension| Quantity {
            expression,
            value: None,
            dimension,
            span: value.span(),
        };
        if let Some(number) = syntax::number(value.get_ref()) {
            if number.is_finite() {
                return Some(quantity(Expression::constant(number), Some(Dimension::ONE)));
            }
            self.error(code::NOT_FINITE, value.span(), "the number is not finite");
            return None;
        }
        let DeValue::String(text) = value.get_ref() else {
            self.wrong_type(value, "a number or an expression string");
            return None;
        };
        let parsed = self.parse(
            value,
            text,
            (variables, moving),
            Expression::parse_with_dimension,
        )?;
        Some(quantity(parsed.expression, parsed.dimension))
    }

    /// Reads the equation of a coupling over the parameters and `moving` quantities.
    pub(super) fn equation(
        &mut self,
        value: &'a Value<'a>,
        moving: &MovingNames<'_>,
    ) -> Option<Parsed> {
        let text = self.text(value)?;
        self.parse(value, text, (&[], Some(moving)), Expression::parse_equation)
    }

    /// Parses a text; reports its first fault, or warns of quantities of different dimensions that
    /// it adds, and of a function of an angle that looks like degrees.
    fn parse(
        &mut self,
        value: &'a Value<'a>,
        text: &str,
        (variables, moving): (&[Variable], Option<&MovingNames<'_>>),
        parse: impl Fn(&str, Scope<'_>, &[Option<Dimension>]) -> Result<Parsed, ExpressionError>,
    ) -> Option<Parsed> {
        let scope = Scope {
            parameters: &self.parameters,
            variables,
            moving,
            functions: self.functions.as_deref(),
            inputs: Some(&self.inputs),
            arguments: &self.arguments,
        };
        match parse(text, scope, &self.parameter_dimensions) {
            Ok(parsed) => {
                let may_jump = moving.is_some_and(|moving| moving.may_jump);
                if !may_jump {
                    self.refuse_jumps(&parsed.expression, &value.span())?;
                }
                for id in parsed.expression.parameters() {
                    self.parameters_used[id.index()] = true;
                }
                for variable in parsed.expression.variables() {
                    if let Variable::Input(place) = variable {
                        self.inputs_used[place] = true;
                    }
                }
                for place in parsed.expression.calls() {
                    self.functions_used[place] = true;
                }
                if let Some(clash) = &parsed.clash {
                    let part = text.get(clash.span.clone());
                    let part = part.map_or_else(|| quoted(text), quoted);
                    let span =
                        syntax::part_span(self.source, value.span(), text, clash.span.clone());
                    self.warn_of_clash(span, &part, clash.dimensions);
                }
                if let Some(argument) = &parsed.large_angle {
                    let span = syntax::part_span(self.source, value.span(), text, argument.clone());
                    let argument = text.get(argument.clone()).unwrap_or_default();
                    self.warn_of_argument(&span, argument);
                }
                Some(parsed)
            }
            Err(error) => {
                let span = syntax::part_span(self.source, value.span(), text, error.span);
                self.error(code::BAD_EXPRESSION, span, error.message).help = error.help;
                None
            }
        }
    }

    /// Computes a quantity's value for the file's parameters; `None` if it is not finite, which
    /// is reported.
    pub(super) fn evaluate(&mut self, quantity: &mut Quantity) -> Option<()> {
        if !self.knows(quantity.expression.parameters()) {
            return Some(());
        }
        let parameter = |id| Jet::constant(self.known_value(id));
        let value = quantity
            .expression
            .evaluate(&parameter, Jet::constant(0.0))
            .value;
        if !value.is_finite() {
            self.not_finite(quantity.span.clone(), "the value");
            return None;
        }
        quantity.value = Some(value);
        Some(())
    }

    pub(super) fn not_finite(&mut self, span: Span, what: &str) {
        let text = self.source.text().get(span.clone()).unwrap_or_default();
        let text = quoted(text.trim_matches(['"', '\'']));
        let message = format!("{what} of {text} is not finite with the file's parameters");
        self.error(code::NOT_FINITE, span, message);
    }

    /// Returns `None` if a value is beyond a limit, which is reported.
    pub(super) fn check_limit(
        &mut self,
        limit: Limit,
        quantity: &Quantity,
        subject: &str,
    ) -> Option<()> {
        let value = quantity.value?;
        let demand = match limit {
            Limit::Positive if value <= 0.0 => "be positive",
            Limit::NotNegative if value < 0.0 => "not be negative",
            _ => return Some(()),
        };
        let message = format!("{subject} must {demand}, is {}", shown(value));
        self.error(code::ILLEGAL_VALUE, quantity.span.clone(), message);
        None
    }
}

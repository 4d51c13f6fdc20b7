//! Faults of an expression, with what would be right.

use super::{LAW, Parser};
use crate::mechanism::Span;
use crate::mechanism::expression::Variable;
use crate::mechanism::expression::error::ExpressionError;
use crate::mechanism::expression::function::{CONSTANTS, FUNCTIONS};
use crate::mechanism::expression::reserved::is_taken;
use crate::mechanism::expression::token::{CHOICE, Token, TokenKind};
use crate::mechanism::names;
use crate::mechanism::synonym::in_our_words;
use crate::mechanism::wording::quoted;

/// Help for a quantity that no function sees.
const SEEN_BY_FUNCTIONS: &str = "a function sees its arguments, parameters and other functions: give it the \
                                 value where it is called";

impl Parser<'_> {
    /// Returns the error for a token that cannot follow a complete operand.
    pub(super) fn missing_operator(&self) -> ExpressionError {
        let found = &self.text[self.token.span()];
        let error = ExpressionError::new(
            self.token.span(),
            format!("expected an operator, found {}", quoted(found)),
        );
        if found == "=" && self.text[self.token.span().end..].starts_with('=') {
            return error.help(CHOICE);
        }
        if found == "=" {
            return error.help("only the `equation` of a coupling has a `=`");
        }
        if !self.token.starts_operand() {
            return error.help("the decimal mark is a point");
        }
        let left = match self.previous {
            Some(token) if token.kind != TokenKind::Symbol(b')') => &self.text[token.span()],
            _ => "(…)",
        };
        let right = match found {
            "(" => "(…)",
            "in" => "inch",
            _ => found,
        };
        if left.len() + right.len() > 40 {
            return error.help("multiplication is written out");
        }
        if let Some(help) = self.unit_help(right, self.token.start) {
            return error.help(help);
        }
        error.help(format!("multiplication is written out: `{left}*{right}`"))
    }

    /// Returns the error for a token where an operand is expected.
    pub(super) fn missing_operand(&self) -> ExpressionError {
        let error = match (self.token.kind, self.previous) {
            (TokenKind::End, Some(previous)) => {
                let text = &self.text[previous.span()];
                ExpressionError::new(
                    previous.span(),
                    format!("expected an operand after `{text}`"),
                )
            }
            _ => {
                let text = &self.text[self.token.span()];
                ExpressionError::new(
                    self.token.span(),
                    format!("expected an operand, found {}", quoted(text)),
                )
            }
        };
        let twice = |previous: Token<'_>| {
            previous.kind == TokenKind::Symbol(b'*') && previous.end == self.token.start
        };
        if self.token.kind == TokenKind::Symbol(b'*') && self.previous.is_some_and(twice) {
            return error.help("a power is written `x^2`");
        }
        error
    }

    pub(super) fn unknown_name(&self, name: &str, span: Span, called: bool) -> ExpressionError {
        if called {
            let error = ExpressionError::new(span, format!("no function {}", quoted(name)));
            if name == LAW
                && self
                    .scope
                    .moving
                    .is_some_and(|moving| !moving.dimensions.is_empty())
            {
                return error.help("give the coupling the function: add `law = …`");
            }
            let name = without_module(name);
            let of_file = self
                .scope
                .functions
                .and_then(|names| names.known.near(name, &[]));
            return match of_file.or_else(|| function_help(name)) {
                Some(help) => error.help(help),
                None => error,
            };
        }
        if name == Variable::Time.name() {
            let error = ExpressionError::new(
                span,
                "only a `motion` or the `value` of a force may use time `t`",
            );
            if !self.scope.arguments.is_empty() {
                return error.help(SEEN_BY_FUNCTIONS);
            }
            return match self.scope.variables {
                [own, ..] => error.help(format!("here the variable is `{}`", own.name())),
                [] => error,
            };
        }
        if self
            .scope
            .inputs
            .is_some_and(|inputs| inputs.get(name).is_some())
        {
            let error = ExpressionError::new(span, format!("{} is an input", quoted(name)));
            return error.help(match self.scope.arguments {
                [] => "only a `motion` and the `value` of a force may use inputs",
                _ => SEEN_BY_FUNCTIONS,
            });
        }
        let is_computed = |name| {
            let moving = self.scope.moving;
            moving.is_some_and(|moving| moving.computed.contains(&name))
        };
        let owner = name.split_once('.').map_or(name, |(owner, _)| owner);
        let usable = self.scope.moving.map_or("", |moving| moving.usable);
        if is_computed(owner) {
            let message = format!("{} is a computed measure", quoted(owner));
            let help = format!("write its formula here; {usable}");
            return ExpressionError::new(span, message).help(help);
        }
        if let Some((message, help)) = self.loop_of_forces(name) {
            return ExpressionError::new(span, message).help(help);
        }
        if name.contains('.') {
            let error = ExpressionError::new(span, format!("no variable {}", quoted(name)));
            let constant = without_module(name);
            if CONSTANTS.iter().any(|(known, _)| *known == constant) {
                return error.help(format!("did you mean `{constant}`?"));
            }
            let Some(moving) = self.scope.moving else {
                return error.help(match self.scope.arguments {
                    [] => "only the `value` of a measure or of a force may use variables that move",
                    _ => SEEN_BY_FUNCTIONS,
                });
            };
            let is_coordinate = moving.known.get(owner).is_some();
            let own = is_coordinate.then(|| format!("did you mean `{owner}`?"));
            let words = || in_our_words(name, &moving.known.candidates()?);
            let near = || moving.known.near(name, &[]);
            let help = own.or_else(words).or_else(near);
            let help = help.or_else(|| moving.known.of_same_owner(name));
            return error.help(help.unwrap_or_else(|| usable.to_owned()));
        }
        let nouns = match self.scope.moving {
            Some(moving) if !moving.dimensions.is_empty() => "parameter, driver or measure",
            _ => "parameter",
        };
        let start = span.start;
        let error = ExpressionError::new(span, format!("no {nouns} {}", quoted(name)));
        if name == Variable::PolarAngle.name() {
            return error.help("only a cam's `profile` may use `theta`, its polar angle");
        }
        if [Variable::Position, Variable::Velocity]
            .map(Variable::name)
            .contains(&name)
        {
            return error.help(format!(
                "only the `value` of a force along a coordinate may use the coordinate's `{name}`"
            ));
        }
        let constants = CONSTANTS.map(|(constant, _)| constant);
        // A measure, a driver or a body without its quantity.
        let moving = || {
            let moving = self.scope.moving?;
            let mut full = ["position", "phi"]
                .map(|part| format!("{name}.{part}"))
                .into_iter();
            let full = full.find(|full| moving.known.get(full).is_some())?;
            Some(format!("did you mean `{full}`?"))
        };
        let taken = || self.taken_help(name);
        let near = || {
            let variables = self.scope.variables.iter().map(|own| own.name());
            let own: Vec<&str> = constants.into_iter().chain(variables).collect();
            let near = self.scope.parameters.near(name, &own);
            let coordinates = self
                .scope
                .moving
                .filter(|moving| !moving.dimensions.is_empty() || !moving.of_signals.is_empty());
            near.or_else(|| coordinates?.known.near(name, &[]))
        };
        let help = self.unit_help(name, start).or_else(moving).or_else(taken);
        let polar_angle = match (self.scope.variables, name) {
            ([Variable::PolarAngle], "phi" | "angle" | "alpha") => {
                Some("did you mean `theta`?".to_owned())
            }
            _ => None,
        };
        let own = || match self.scope.variables {
            [Variable::Argument(_)] => Some("a law is a function of `x`".to_owned()),
            variables if variables.contains(&Variable::Position) => Some(
                "give it a value in `[parameters]`; the force's own coordinate is `position`"
                    .to_owned(),
            ),
            _ => None,
        };
        let arguments = || {
            let [first, ..] = self.scope.arguments else {
                return None;
            };
            let near = names::help(name, self.scope.arguments, &[])?;
            Some(if near.starts_with("did") {
                near
            } else {
                format!("name it as an argument: `of = [\"{first}\", \"{name}\"]`")
            })
        };
        let help = help
            .or(polar_angle)
            .or_else(near)
            .or_else(arguments)
            .or_else(own);
        error.help(help.unwrap_or_else(|| "give it a value in `[parameters]`".to_owned()))
    }

    /// Returns message and help for a quantity that follows from forces, within the size of one.
    fn loop_of_forces(&self, name: &str) -> Option<(String, &'static str)> {
        let (_, part) = name.rsplit_once('.')?;
        let moving = self.scope.moving;
        moving.filter(|moving| moving.may_jump && !moving.of_signals.is_empty())?;
        let name = quoted(name);
        match part {
            "acceleration" | "ax" | "ay" | "alpha" => Some((
                format!(
                    "a force cannot use the acceleration {name}, which follows from all forces"
                ),
                "use the position or the velocity",
            )),
            "effort" | "fx" | "fy" | "torque" | "tension" | "power" | "bias" => Some((
                format!("a force cannot use {name}, which follows from all forces"),
                "friction by the load of a joint is `[friction]` with its `joint`",
            )),
            _ => None,
        }
    }

    /// Returns help for a unit's symbol that begins at a place, after a number.
    fn unit_help(&self, name: &str, start: usize) -> Option<String> {
        if self.scope.parameters.get(name).is_some() {
            return None;
        }
        let before = self.text[..start].trim_end_matches([' ', '*']);
        let number = before.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.');
        let number = before[number.len()..].parse::<f64>().ok();
        match (name, number) {
            ("m", Some(metres)) if metres < 1.0 => {
                // Without the rounding of a product in binary.
                let millimetres = (metres * 1e15).round() / 1e12;
                Some(format!(
                    "numbers are in SI units: write `{metres}`, or `{millimetres}*mm`"
                ))
            }
            ("m" | "rad" | "s" | "kg" | "N" | "Nm", _) => {
                Some(format!("numbers are in SI units: leave out `{name}`"))
            }
            ("g", _) => Some("numbers are in SI units: a gram is `0.001`".to_owned()),
            _ => None,
        }
    }

    /// Returns help for a name that no parameter can have.
    fn taken_help(&self, name: &str) -> Option<String> {
        let has_time = self.scope.variables.contains(&Variable::Time);
        match name {
            "time" if has_time => Some("did you mean `t`?".to_owned()),
            "time" => {
                Some("only a `motion` or the `value` of a force may use time, `t`".to_owned())
            }
            _ if is_taken(name) => Some(format!(
                "`{name}` is taken by the language; choose another name"
            )),
            _ => None,
        }
    }

    pub(super) fn nested_too_deeply(&self) -> ExpressionError {
        ExpressionError::new(
            self.token.span(),
            "the expression is nested too deeply here",
        )
        .help("give a part of it a name: a parameter of its own")
    }
}

/// Returns a name without the module that other languages have it in: `pi` for `math.pi`.
fn without_module(name: &str) -> &str {
    match name.split_once('.') {
        Some(("math" | "Math" | "np" | "numpy", own)) => own,
        _ => name,
    }
}

/// Returns help for an unknown function: the name of the one that other programs call so, or the
/// nearest name.
fn function_help(name: &str) -> Option<String> {
    let ours = match name {
        "log" => return Some("`ln` is the natural logarithm, `log10` the decimal one".to_owned()),
        "if" | "ifelse" | "where" => return Some(CHOICE.to_owned()),
        "radians" | "deg2rad" | "rad" => return Some("degrees are written `30*deg`".to_owned()),
        "pow" => return Some("a power is written `x^y`".to_owned()),
        "arcsin" => "asin",
        "arccos" => "acos",
        "arctan" => "atan",
        "arctan2" => "atan2",
        "sgn" | "signum" => "sign",
        "fabs" => "abs",
        "fmod" | "rem" => "mod",
        _ => return names::help(name, &FUNCTIONS.map(|(known, _)| known), &[]),
    };
    Some(format!("did you mean `{ours}`?"))
}

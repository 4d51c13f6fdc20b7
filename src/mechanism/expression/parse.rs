//! Parser of expressions (Pratt), which gives the place of an error.

mod fault;

use std::collections::HashMap;
use std::f64::consts::TAU;

use super::called::Functions;
use super::dimension::{Clash, Dimensions};
use super::error::ExpressionError;
use super::function::{Binary, LAW, constant, function};
use super::token::{Token, TokenKind, scan};
use super::{Expression, MAX_STACK, Operation, Variable, run};
use crate::mechanism::names::NameTable;
use crate::mechanism::number::Unary;
use crate::mechanism::wording::quoted;
use crate::mechanism::{Dimension, ParameterId, Span};

/// Largest depth of the parser's recursion: nested parentheses, signs, powers and operators.
const MAX_DEPTH: usize = 128;

/// Names that an expression may use.
#[derive(Clone, Copy, Debug)]
pub(in crate::mechanism) struct Scope<'a> {
    /// Parameters.
    pub(in crate::mechanism) parameters: &'a NameTable<'a, ParameterId>,
    /// Variables that the expression may use.
    pub(in crate::mechanism) variables: &'a [Variable],
    /// Moving quantities that it may use.
    pub(in crate::mechanism) moving: Option<&'a MovingNames<'a>>,
    /// Functions of the file that it may call.
    pub(in crate::mechanism) functions: Option<&'a FunctionNames<'a>>,
    /// Inputs of the file, which only some expressions may use.
    pub(in crate::mechanism) inputs: Option<&'a NameTable<'a, usize>>,
    /// Names of the arguments, within a function.
    pub(in crate::mechanism) arguments: &'a [&'a str],
}

impl<'a> Scope<'a> {
    /// Makes the scope of parameters and these variables alone.
    pub(in crate::mechanism) fn new(
        parameters: &'a NameTable<'a, ParameterId>,
        variables: &'a [Variable],
    ) -> Self {
        Self {
            parameters,
            variables,
            moving: None,
            functions: None,
            inputs: None,
            arguments: &[],
        }
    }
}

/// Names of the functions of the file.
#[derive(Debug)]
pub(in crate::mechanism) struct FunctionNames<'a> {
    pub(in crate::mechanism) known: NameTable<'a, Signature>,
    /// The functions, none while they are read.
    pub(in crate::mechanism) list: Functions,
}

/// The shape of a call of a function.
#[derive(Clone, Copy, Debug)]
pub(in crate::mechanism) struct Signature {
    /// Place of the function among all.
    pub(in crate::mechanism) place: usize,
    /// Number of its arguments; `None` if they cannot be read.
    pub(in crate::mechanism) arguments: Option<usize>,
}

/// Names of moving quantities in the formula of a computed measure or in the equation of a coupling.
#[derive(Debug)]
pub(in crate::mechanism) struct MovingNames<'a> {
    /// Their meanings: signals by the names of their FMU variables, or coordinates.
    pub(in crate::mechanism) known: NameTable<'a, Variable>,
    /// Dimensions of coordinates.
    pub(in crate::mechanism) dimensions: Vec<Dimension>,
    /// Dimensions of the signals that a force may use, by their names.
    pub(in crate::mechanism) of_signals: HashMap<&'a str, Dimension>,
    /// Computed measures, which no formula can use.
    pub(in crate::mechanism) computed: Vec<&'a str>,
    /// Says which names can be used.
    pub(in crate::mechanism) usable: &'static str,
    /// The coupling's law.
    pub(in crate::mechanism) law: Option<LawOfCoupling<'a>>,
    /// Whether the expression may jump, as a force may.
    pub(in crate::mechanism) may_jump: bool,
}

/// A law that an equation calls as a function of one argument.
#[derive(Clone, Copy, Debug)]
pub(in crate::mechanism) enum LawOfCoupling<'a> {
    /// An expression in `x`, and its dimension.
    Expression(&'a Expression, Option<Dimension>),
    /// A table.
    Table,
}

/// An expression with its dimension.
pub(in crate::mechanism) struct Parsed {
    pub(in crate::mechanism) expression: Expression,
    /// `None` if it is not known.
    pub(in crate::mechanism) dimension: Option<Dimension>,
    /// First operation on operands that cannot be added.
    pub(in crate::mechanism) clash: Option<Clash>,
    /// Place of the first number of more than a turn whose sine, cosine or tangent is taken.
    pub(in crate::mechanism) large_angle: Option<Span>,
}

impl Expression {
    /// Parses `text` with the names in `scope`.
    ///
    /// # Errors
    ///
    /// First fault of the text: syntax, an unknown name, too deep nesting, or a constant part that
    /// is not a finite number.
    pub(in crate::mechanism) fn parse(
        text: &str,
        scope: Scope<'_>,
    ) -> Result<Self, ExpressionError> {
        Self::parse_with_dimension(text, scope, &[]).map(|parsed| parsed.expression)
    }

    /// Parses `text` and tells its dimension; `dimensions` are those of the parameters.
    ///
    /// # Errors
    ///
    /// Those of [`parse`](Self::parse).
    pub(in crate::mechanism) fn parse_with_dimension(
        text: &str,
        scope: Scope<'_>,
        dimensions: &[Option<Dimension>],
    ) -> Result<Parsed, ExpressionError> {
        let mut parser = Parser::new(text, scope, dimensions)?;
        if parser.token.kind == TokenKind::End {
            return Err(
                ExpressionError::new(0..text.len(), "the expression is empty")
                    .help("write a number or a formula over the parameters"),
            );
        }
        parser.parse_operators(0)?;
        parser.expect_end()?;
        Ok(parser.finish())
    }

    /// Parses the equation `left = right`; the expression is left − right, the dimension that of the
    /// side that has one.
    ///
    /// # Errors
    ///
    /// Those of [`parse`](Self::parse), and a text without exactly one `=`.
    pub(in crate::mechanism) fn parse_equation(
        text: &str,
        scope: Scope<'_>,
        dimensions: &[Option<Dimension>],
    ) -> Result<Parsed, ExpressionError> {
        let mut parser = Parser::new(text, scope, dimensions)?;
        if parser.token.kind == TokenKind::End {
            return Err(ExpressionError::new(0..text.len(), "the equation is empty").help(EQUATION));
        }
        let mut span = parser.parse_operators(0)?;
        let left = parser.dimensions.result();
        if parser.token.kind != TokenKind::Symbol(b'=') {
            parser.expect_end()?;
            let message = "an equation has two sides";
            return Err(ExpressionError::new(span, message).help(EQUATION));
        }
        parser.advance()?;
        span.end = parser.parse_operators(0)?.end;
        let right = parser.dimensions.result();
        if parser.token.kind == TokenKind::Symbol(b'=') {
            let message = "an equation has one `=`";
            return Err(ExpressionError::new(parser.token.span(), message).help(EQUATION));
        }
        parser.expect_end()?;
        parser.emit(Operation::Subtract, &span)?;
        let mut parsed = parser.finish();
        let is_known = |side: &Option<Dimension>| side.is_some_and(|of| of != Dimension::ONE);
        parsed.dimension = [left, right].into_iter().find(is_known).flatten();
        Ok(parsed)
    }
}

/// Help for a text that is no equation.
const EQUATION: &str = "write `left = right`, such as \"travel = pitch*turn/(2*pi)\"";

/// Binding of a sign: tighter than a product, looser than a power.
const SIGN: u8 = 5;

/// Returns how tightly the operands to the left and to the right of an infix operator have to bind
/// at least, and its operation.
fn infix(kind: TokenKind<'_>) -> Option<(u8, u8, Operation)> {
    let TokenKind::Symbol(symbol) = kind else {
        return None;
    };
    match symbol {
        b'+' => Some((1, 2, Operation::Add)),
        b'-' => Some((1, 2, Operation::Subtract)),
        b'*' => Some((3, 4, Operation::Multiply)),
        b'/' => Some((3, 4, Operation::Divide)),
        b'^' => Some((8, 7, Operation::Power)),
        _ => None,
    }
}

struct Parser<'a> {
    text: &'a str,
    scope: Scope<'a>,
    /// Next token, not yet taken.
    token: Token<'a>,
    /// Last token taken.
    previous: Option<Token<'a>>,
    program: Vec<Operation>,
    /// Place of the first number of more than a turn whose sine, cosine or tangent is taken.
    large_angle: Option<Span>,
    dimensions: Dimensions<'a>,
    /// Number of operands that wait at the end of the program.
    height: usize,
    depth: usize,
}

impl<'a> Parser<'a> {
    fn new(
        text: &'a str,
        scope: Scope<'a>,
        dimensions: &'a [Option<Dimension>],
    ) -> Result<Self, ExpressionError> {
        Ok(Self {
            text,
            scope,
            token: scan(text, 0)?,
            previous: None,
            program: Vec::new(),
            dimensions: Dimensions::new(dimensions),
            large_angle: None,
            height: 0,
            depth: 0,
        })
    }

    /// Returns the expression of all that has been parsed.
    fn finish(self) -> Parsed {
        let functions = self.functions();
        Parsed {
            expression: Expression::new(self.program, &functions),
            dimension: self.dimensions.result(),
            clash: self.dimensions.clash,
            large_angle: self.large_angle,
        }
    }

    /// Returns the functions of the file.
    fn functions(&self) -> Functions {
        let names = self.scope.functions;
        names.map_or_else(Functions::default, |names| names.list.clone())
    }

    /// Takes the next token.
    fn advance(&mut self) -> Result<Token<'a>, ExpressionError> {
        let taken = self.token;
        self.previous = Some(taken);
        self.token = scan(self.text, taken.end)?;
        Ok(taken)
    }

    /// Parses an operand and all operators after it that bind at least as tightly as `least`;
    /// returns their place.
    fn parse_operators(&mut self, least: u8) -> Result<Span, ExpressionError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.nested_too_deeply());
        }
        let mut span = self.parse_operand()?;
        while let Some((left, right, operation)) = infix(self.token.kind)
            && left >= least
        {
            self.advance()?;
            span.end = self.parse_operators(right)?.end;
            self.emit(operation, &span)?;
        }
        self.depth -= 1;
        Ok(span)
    }

    fn parse_operand(&mut self) -> Result<Span, ExpressionError> {
        let token = self.token;
        match token.kind {
            TokenKind::Number(value) => {
                self.advance()?;
                self.emit(Operation::Number(value), &token.span())?;
                Ok(token.span())
            }
            TokenKind::Name(name) => {
                self.advance()?;
                self.parse_name(name, token.span())
            }
            TokenKind::Symbol(b'(') => {
                self.advance()?;
                self.parse_operators(0)?;
                let close = self.expect_close(&token)?;
                Ok(token.start..close.end)
            }
            TokenKind::Symbol(sign @ (b'+' | b'-')) => {
                self.advance()?;
                let span = token.start..self.parse_operators(SIGN)?.end;
                if sign == b'-' {
                    self.emit(Operation::Negate, &span)?;
                }
                Ok(span)
            }
            TokenKind::Symbol(_) | TokenKind::End => Err(self.missing_operand()),
        }
    }

    /// Parses a constant, a parameter, the variable, or a function with its arguments.
    fn parse_name(&mut self, name: &str, span: Span) -> Result<Span, ExpressionError> {
        let called = self.token.kind == TokenKind::Symbol(b'(');
        let constant = constant(name);
        let operation = if let (true, Some(law)) = (name == LAW, self.law()) {
            if called {
                return self.parse_law(law, span);
            }
            return Err(ExpressionError::new(span, format!("`{LAW}` is a function"))
                .help(format!("write `{LAW}(…)` with a coordinate in it")));
        } else if let Some(function) = function(name) {
            if called {
                return self.parse_call(function, name, span);
            }
            return Err(
                ExpressionError::new(span, format!("`{name}` is a function"))
                    .help(format!("write `{name}(…)`")),
            );
        } else if let Some(signature) = self.scope.functions.and_then(|f| f.known.get(name)) {
            return self.parse_called(signature, name, span, called);
        } else if let Some(value) = constant {
            Operation::Number(value)
        } else if let Some(variable) = self.variable(name) {
            if self.scope.parameters.get(name).is_some() {
                let message = format!("`{name}` is both a parameter and the variable here");
                return Err(ExpressionError::new(span, message).help("rename the parameter"));
            }
            Operation::Variable(variable)
        } else if let Some(id) = self.scope.parameters.get(name) {
            Operation::Parameter(id)
        } else {
            return Err(self.unknown_name(name, span, called));
        };
        if called {
            return Err(
                ExpressionError::new(span, format!("{} is not a function", quoted(name)))
                    .help(format!("multiplication is written out: `{name}*(…)`")),
            );
        }
        self.emit(operation, &span)?;
        if constant.is_some() {
            self.dimensions.set_constant(name);
        } else if let (Operation::Variable(Variable::Coordinate(place)), Some(moving)) =
            (operation, self.scope.moving)
        {
            self.dimensions.set(moving.dimensions[place]);
        } else if let Some(moving) = self.scope.moving
            && let Some(dimension) = moving.of_signals.get(name)
        {
            self.dimensions.set(*dimension);
        }
        Ok(span)
    }

    fn variable(&self, name: &str) -> Option<Variable> {
        let mut arguments = self.scope.arguments.iter();
        if let Some(place) = arguments.position(|argument| *argument == name) {
            return Some(Variable::Argument(place));
        }
        let mut variables = self.scope.variables.iter().copied();
        let variable = variables.find(|variable| variable.name() == name);
        variable.or_else(|| self.scope.moving?.known.get(name))
    }

    fn law(&self) -> Option<LawOfCoupling<'a>> {
        self.scope.moving?.law
    }

    /// Parses the argument of the law, whose name stands at `place`.
    fn parse_law(&mut self, law: LawOfCoupling<'_>, place: Span) -> Result<Span, ExpressionError> {
        let open = self.advance()?;
        let start = self.program.len();
        self.parse_operators(0)?;
        if self.token.kind == TokenKind::Symbol(b',') {
            let message = format!("`{LAW}` takes 1 argument, found more");
            return Err(ExpressionError::new(self.token.span(), message));
        }
        let span = place.start..self.expect_close(&open)?.end;
        match law {
            LawOfCoupling::Table => self.emit(Operation::Law, &span)?,
            LawOfCoupling::Expression(law, dimension) => {
                // The argument takes the place of the variable.
                let argument = self.program.split_off(start);
                for &operation in &law.program {
                    match operation {
                        Operation::Variable(_) => self.program.extend_from_slice(&argument),
                        _ => self.program.push(operation),
                    }
                }
                let height = self.height + law.height + argument.len();
                let functions = self.functions();
                if height > MAX_STACK
                    && Expression::new(self.program.clone(), &functions).height > MAX_STACK
                {
                    return Err(self.nested_too_deeply());
                }
                self.dimensions.replace(dimension);
            }
        }
        Ok(span)
    }

    /// Parses the arguments of a function of the file called `name`, which stands at `place`.
    fn parse_called(
        &mut self,
        signature: Signature,
        name: &str,
        place: Span,
        called: bool,
    ) -> Result<Span, ExpressionError> {
        if !called {
            let error = ExpressionError::new(place, format!("{} is a function", quoted(name)));
            return Err(error.help(format!("write `{name}(…)`")));
        }
        let open = self.advance()?;
        let mut count = 0_u8;
        if self.token.kind != TokenKind::Symbol(b')') {
            loop {
                self.parse_operators(0)?;
                count = count.saturating_add(1);
                if self.token.kind != TokenKind::Symbol(b',') {
                    break;
                }
                self.advance()?;
            }
        }
        let span = place.start..self.expect_close(&open)?.end;
        // The fault of a function that cannot be read has been told.
        let wanted = signature.arguments.unwrap_or(count.into());
        if usize::from(count) != wanted {
            let arguments = if wanted == 1 { "argument" } else { "arguments" };
            let message = format!("`{name}` takes {wanted} {arguments}, found {count}");
            return Err(ExpressionError::new(span, message));
        }
        let place = u32::try_from(signature.place).expect("a file has fewer functions");
        self.emit(Operation::Call(place, count), &span)?;
        Ok(span)
    }

    /// Parses the arguments of a function called `name`, which stands at `place`.
    fn parse_call(
        &mut self,
        function: Operation,
        name: &str,
        place: Span,
    ) -> Result<Span, ExpressionError> {
        let open = self.advance()?;
        let least = function.arity();
        let variadic = matches!(function, Operation::Binary(Binary::Min | Binary::Max));
        let mut count = 0;
        if self.token.kind != TokenKind::Symbol(b')') {
            loop {
                self.parse_operators(0)?;
                count += 1;
                if variadic && count >= 2 {
                    self.emit(function, &(place.start..self.token.start))?;
                }
                if self.token.kind != TokenKind::Symbol(b',') {
                    break;
                }
                self.advance()?;
            }
        }
        let close = self.expect_close(&open)?;
        let span = place.start..close.end;
        if let Operation::Unary(Unary::Sin | Unary::Cos | Unary::Tan) = function {
            self.note_angle(open.end..close.start);
        }
        if count < least || (count > least && !variadic) {
            let wanted = match (least, variadic) {
                (1, _) => "1 argument",
                (_, false) => "2 arguments",
                (_, true) => "2 arguments or more",
            };
            return Err(ExpressionError::new(
                span,
                format!("`{name}` takes {wanted}, found {count}"),
            ));
        }
        if !variadic {
            self.emit(function, &span)?;
        }
        Ok(span)
    }

    /// Notes the argument of a function of an angle, if it is a plain number of more than a turn.
    fn note_angle(&mut self, argument: Span) {
        let text = &self.text[argument.clone()];
        let start = argument.start + text.len() - text.trim_start().len();
        let text = text.trim();
        if text.parse().is_ok_and(|angle: f64| angle.abs() > TAU) {
            self.large_angle.get_or_insert(start..start + text.len());
        }
    }

    /// Appends the last operation of the text at `span`; computes it at once if its operands are
    /// constant.
    fn emit(&mut self, operation: Operation, span: &Span) -> Result<(), ExpressionError> {
        let arity = operation.arity();
        let operands = self.program.len() - arity;
        let constant = self.program[operands..]
            .iter()
            .all(|operand| matches!(operand, Operation::Number(_)));
        let exponent = match self.program.last() {
            Some(Operation::Number(exponent)) => Some(*exponent),
            _ => None,
        };
        self.dimensions.apply(operation, span, exponent);
        self.program.push(operation);
        self.height = self.height - arity + 1;
        if self.height > MAX_STACK {
            return Err(self.nested_too_deeply());
        }
        let is_called = matches!(operation, Operation::Law | Operation::Call(..));
        if arity > 0 && constant && !is_called {
            let none = (&|_| f64::NAN, &|_| f64::NAN);
            let value = run::<f64, MAX_STACK>(&self.program[operands..], &[], &none);
            if !value.is_finite() {
                let text = quoted(&self.text[span.clone()]);
                return Err(ExpressionError::new(
                    span.clone(),
                    format!("{text} is not a finite number"),
                ));
            }
            self.program.truncate(operands);
            self.program.push(Operation::Number(value));
        }
        Ok(())
    }

    fn expect_end(&self) -> Result<(), ExpressionError> {
        match self.token.kind {
            TokenKind::End => Ok(()),
            TokenKind::Symbol(b')') => Err(ExpressionError::new(
                self.token.span(),
                "no `(` belongs to this `)`",
            )),
            _ => Err(self.missing_operator()),
        }
    }

    fn expect_close(&mut self, open: &Token<'_>) -> Result<Token<'a>, ExpressionError> {
        match self.token.kind {
            TokenKind::Symbol(b')') => self.advance(),
            TokenKind::End => Err(ExpressionError::new(
                open.span(),
                "no `)` belongs to this `(`",
            )),
            _ => Err(self.missing_operator()),
        }
    }
}

//! Text of an expression.

use std::fmt;

use crate::mechanism::ParameterId;
use crate::mechanism::expression::function::FUNCTIONS;
use crate::mechanism::expression::{Expression, Operation};

/// Binding strength of the outermost operator of a text. An operand that binds more loosely than
/// its place demands goes into parentheses.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Sign,
    Power,
    Atom,
}

impl Expression {
    /// Returns the expression as text in its own language, with the fewest parentheses.
    ///
    /// Parsing the text gives an equal expression.
    pub(in crate::mechanism) fn display<'a>(
        &'a self,
        parameter_name: impl Fn(ParameterId) -> &'a str,
    ) -> impl fmt::Display {
        let mut texts: Vec<(String, Binding)> = Vec::new();
        for operation in &self.program {
            let last = texts.len() - operation.arity();
            let operands = texts.split_off(last);
            texts.push(join(*operation, operands, &parameter_name));
        }
        texts
            .pop()
            .map(|(text, _)| text)
            .expect("a program leaves one operand")
    }
}

/// Returns the text of an operation on the texts of its operands.
fn join<'a>(
    operation: Operation,
    operands: Vec<(String, Binding)>,
    parameter_name: &impl Fn(ParameterId) -> &'a str,
) -> (String, Binding) {
    let mut operands = operands.into_iter();
    let mut operand = |least: Binding| {
        let (text, binding) = operands.next().expect("as many as the operation takes");
        if binding < least {
            format!("({text})")
        } else {
            text
        }
    };
    use Binding::{Atom, Power, Product, Sign, Sum};
    let mut infix = |left: Binding, symbol: &str, right: Binding| {
        // Appended to the left operand: a long sum is written in linear time.
        let mut text = operand(left);
        text.push_str(symbol);
        text.push_str(&operand(right));
        text
    };
    match operation {
        Operation::Add => (infix(Sum, " + ", Product), Sum),
        Operation::Subtract => (infix(Sum, " - ", Product), Sum),
        Operation::Multiply => (infix(Product, "*", Sign), Product),
        Operation::Divide => (infix(Product, "/", Sign), Product),
        Operation::Power => (infix(Atom, "^", Sign), Power),
        Operation::Negate => (format!("-{}", operand(Sign)), Sign),
        Operation::Number(value) if value.is_sign_negative() => (format!("{value:?}"), Sign),
        Operation::Number(value) => (format!("{value:?}"), Atom),
        Operation::Parameter(id) => (parameter_name(id).to_owned(), Atom),
        Operation::Variable(variable) => (variable.name().to_owned(), Atom),
        Operation::Call(..) => unreachable!("the texts call no functions of a file"),
        Operation::Law => (format!("law({})", operand(Sum)), Atom),
        Operation::Unary(_) => {
            let name = name(operation);
            (format!("{name}({})", operand(Sum)), Atom)
        }
        Operation::Binary(_) => {
            let name = name(operation);
            let first = operand(Sum);
            (format!("{name}({first}, {})", operand(Sum)), Atom)
        }
    }
}

/// Returns the name of a function.
fn name(function: Operation) -> &'static str {
    let known = FUNCTIONS.iter().find(|(_, known)| *known == function);
    known.expect("the table lists every function").0
}

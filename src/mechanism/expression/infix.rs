//! Expressions of time as texts of other programs.

use super::function::FUNCTIONS;
use super::{Expression, Operation, ParameterId, Variable};

/// Longest text.
const LONGEST: usize = 4000;

impl Expression {
    /// Returns the expression with the values of its parameters in place of their names, `time` for
    /// time, and each operation in brackets; `None` if it has a function for whose name `function` has
    /// no other.
    pub fn infix(
        &self,
        parameter: &impl Fn(ParameterId) -> f64,
        time: &str,
        function: &impl Fn(&str) -> Option<&'static str>,
    ) -> Option<String> {
        let number = |value: f64| {
            if value < 0.0 {
                format!("({value})")
            } else {
                format!("{value}")
            }
        };
        let mut stack: Vec<String> = Vec::new();
        for &operation in &self.program {
            let operands = stack.split_off(stack.len() - operation.arity());
            let between = |sign: char| format!("({} {sign} {})", operands[0], operands[1]);
            let text = match operation {
                Operation::Number(value) => number(value),
                Operation::Parameter(id) => number(parameter(id)),
                Operation::Variable(Variable::Time) => time.to_owned(),
                Operation::Negate => format!("(-{})", operands[0]),
                Operation::Add => between('+'),
                Operation::Subtract => between('-'),
                Operation::Multiply => between('*'),
                Operation::Divide => between('/'),
                Operation::Power => between('^'),
                Operation::Unary(_) => {
                    let mut known = FUNCTIONS.iter();
                    let (name, _) = known.find(|(_, known)| *known == operation)?;
                    format!("{}({})", function(name)?, operands[0])
                }
                Operation::Variable(_)
                | Operation::Binary(_)
                | Operation::Law
                | Operation::Call(..) => return None,
            };
            stack.push(text);
            if stack.iter().map(String::len).sum::<usize>() > LONGEST {
                return None;
            }
        }
        stack.pop()
    }
}

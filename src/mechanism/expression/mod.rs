//! Expressions over the parameters: parsed once, evaluated often.
//!
//! The language is small: numbers (`1`, `.5`, `2.`, `1e-3`), `+ - * / ^` and parentheses, the
//! constants `pi deg rpm mm cm inch`, parameters, the functions `sin cos tan asin acos atan atan2
//! sinh cosh tanh sqrt hypot exp ln log10 abs sign floor ceil mod min max`, and variables: time `t`
//! in a motion, the polar angle `theta` in a cam's profile, `t`, `position` and `velocity` in a
//! force, signals such as `crank.omega` in a measure, coordinates and the function `law` in a
//! coupling, whose law is a function of `x`. Powers bind tighter than a sign and associate to the
//! right: `-x^2` is `-(x^2)` and `2^3^2` is `2^9`.
//!
//! Functions of the file (`called`) are expressions, or points (`points`, `grid`) whose numbers are
//! expressions, and expressions call them: one recursion, in one module.

mod called;
mod dimension;
mod error;
mod function;
mod grid;
mod in_force;
mod infix;
mod linear;
mod parse;
mod pieces;
mod points;
mod polar;
mod reserved;
mod seams;
mod table;
mod token;

#[cfg(test)]
mod tests;

pub use called::{BeyondPoints, Corner, Function, FunctionBody, Functions, MOST_ARGUMENTS};
pub use error::ExpressionError;
use function::Binary;
pub(super) use function::CONSTANTS;
pub use function::constant;
pub use grid::Grid;
pub(super) use in_force::ExpressionInForce;
pub use linear::LinearForm;
pub(super) use parse::{FunctionNames, LawOfCoupling, MovingNames, Parsed, Scope, Signature};
pub(super) use pieces::MOST_SWITCHES;
pub(crate) use points::MOST_MOVING_POINTS;
pub use points::{CalledPoints, Interpolation, PointFunction};
pub use reserved::is_taken;
pub(super) use reserved::taken;
pub(crate) use seams::joins;
pub(super) use seams::seams;
pub use table::Table;
pub use token::names_in;

use super::force_quantity::ForceQuantity;
use super::number::{self, Interval, Jet3, Number, Unary};
use super::{Order, ParameterId, Signal};

/// Variable of an expression, besides the parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variable {
    /// Time \[s\], `t` in a motion or a force.
    Time,
    /// Polar angle \[rad\], `theta` in a cam's profile.
    PolarAngle,
    /// Parameter of a curve, `s` in its x and y.
    CurveParameter,
    /// Coordinate along which a force acts \[m or rad\], `position` there.
    Position,
    /// Its rate \[m/s or rad/s\], `velocity` there.
    Velocity,
    /// A signal of the mechanism, in a measure that is computed.
    Signal(Signal, Order),
    /// A force, an energy or an inertia, in a measure that is computed.
    Force(ForceQuantity),
    /// An input of the mechanism, by its index.
    Input(usize),
    /// A coordinate of a coupling, by its place among these.
    Coordinate(usize),
    /// An argument of a function by its place, or that of a coupling's law, `x` there.
    Argument(usize),
}

impl Variable {
    /// Returns the name in the language; a signal has that of its FMU variable.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "t",
            Self::PolarAngle => "theta",
            Self::CurveParameter => "s",
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Signal(..) => "a signal",
            Self::Force(_) => "a force",
            Self::Input(_) => "an input",
            Self::Coordinate(_) => "a coordinate",
            Self::Argument(_) => "x",
        }
    }
}

/// The numbers of type N that an expression takes from outside.
pub(crate) trait Values<N> {
    /// Returns the value of a parameter.
    fn parameter(&self, id: ParameterId) -> N;

    /// Returns the value of a variable.
    fn variable(&self, which: Variable) -> N;

    /// Returns the table of a coupling's law at an argument.
    fn law(&self, argument: N) -> N;
}

/// Parameters and variables, where there is no law.
impl<N: Number, P: Fn(ParameterId) -> N, V: Fn(Variable) -> N> Values<N> for (&P, &V) {
    fn parameter(&self, id: ParameterId) -> N {
        self.0(id)
    }

    fn variable(&self, which: Variable) -> N {
        self.1(which)
    }

    fn law(&self, _argument: N) -> N {
        N::unknown()
    }
}

/// Capacity of the stack of operands that wait for their operator: far more than anyone writes by
/// hand.
const MAX_STACK: usize = 32;
/// The same for most expressions.
const USUAL_STACK: usize = 6;

/// A number as a function of the parameters, and where its place has them of [`Variable`]s.
///
/// A flat postfix program whose constant parts are computed, so that evaluation neither allocates
/// nor recurs.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// Leaves one operand; the parser has checked that never more than [`MAX_STACK`] wait.
    program: Box<[Operation]>,
    /// Most operands that wait.
    height: usize,
    /// Parameters used, ascending, each once.
    parameters: Box<[ParameterId]>,
    /// The functions of the mechanism, if it calls one.
    functions: Functions,
}

/// Step of the program. It takes its operands off a stack and puts its result there.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operation {
    Number(f64),
    Parameter(ParameterId),
    Variable(Variable),
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Unary(Unary),
    Binary(Binary),
    /// The table of a coupling's law.
    Law,
    /// A function of the file by its place, with its number of arguments.
    Call(u32, u8),
}

impl Operation {
    /// Returns the number of operands.
    fn arity(self) -> usize {
        match self {
            Self::Number(_) | Self::Parameter(_) | Self::Variable(_) => 0,
            Self::Negate | Self::Unary(_) | Self::Law => 1,
            Self::Add
            | Self::Subtract
            | Self::Multiply
            | Self::Divide
            | Self::Power
            | Self::Binary(_) => 2,
            Self::Call(_, arguments) => arguments.into(),
        }
    }

    /// Takes the operands from the top of `stack` and leaves the result there.
    #[inline]
    fn apply<N: Number>(
        self,
        stack: &mut [N],
        height: &mut usize,
        functions: &[Function],
        values: &dyn Values<N>,
    ) {
        let first = *height - self.arity();
        let result = match self {
            Self::Number(value) => N::constant(value),
            Self::Parameter(id) => values.parameter(id),
            Self::Variable(which) => values.variable(which),
            Self::Negate => -stack[first],
            Self::Add => stack[first] + stack[first + 1],
            Self::Subtract => stack[first] - stack[first + 1],
            Self::Multiply => stack[first] * stack[first + 1],
            Self::Divide => stack[first] / stack[first + 1],
            Self::Power => stack[first].powf(stack[first + 1]),
            Self::Unary(function) => stack[first].apply(function),
            Self::Binary(function) => function.apply(stack[first], stack[first + 1]),
            Self::Law => values.law(stack[first]),
            Self::Call(place, _) => {
                let parameter = |id| values.parameter(id);
                let arguments = &stack[first..*height];
                // Those that could not be read have no value.
                functions
                    .get(place as usize)
                    .map_or_else(N::unknown, |function| {
                        function.evaluate(functions, &parameter, arguments)
                    })
            }
        };
        stack[first] = result;
        *height = first + 1;
    }
}

impl Expression {
    /// Makes an expression that is a plain number.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Self::new(vec![Operation::Number(value)], &Functions::default())
    }

    /// Makes the value of a parameter.
    #[must_use]
    pub fn parameter(id: ParameterId) -> Self {
        Self::new(vec![Operation::Parameter(id)], &Functions::default())
    }

    /// Makes the multiple of a variable.
    pub fn multiple(factor: f64, of: Variable) -> Self {
        let program = vec![
            Operation::Number(factor),
            Operation::Variable(of),
            Operation::Multiply,
        ];
        Self::new(program, &Functions::default())
    }

    fn new(program: Vec<Operation>, functions: &Functions) -> Self {
        let mut parameters = Vec::new();
        let mut calls = false;
        for operation in &program {
            match operation {
                Operation::Parameter(id) => parameters.push(*id),
                Operation::Call(place, _) => {
                    // Within a function those of others are added when all are read.
                    let called = functions.list().get(*place as usize);
                    parameters.extend(called.iter().flat_map(|function| &function.parameters));
                    calls = true;
                }
                _ => {}
            }
        }
        parameters.sort_unstable();
        parameters.dedup();
        let heights = program.iter().scan(0, |height, operation| {
            *height = *height + 1 - operation.arity();
            Some(*height)
        });
        Self {
            height: heights.max().unwrap_or(0),
            program: program.into(),
            parameters: parameters.into(),
            functions: if calls {
                functions.clone()
            } else {
                Functions::default()
            },
        }
    }

    /// Evaluates the expression, which has no variables, for values of all parameters.
    ///
    /// Outside the domain of a function the result is not finite. Allocates nothing.
    #[must_use]
    pub fn value(&self, parameters: &[f64]) -> f64 {
        self.evaluate(&|p: ParameterId| parameters[p.index()], 0.0)
    }

    /// Evaluates the expression for the given parameters and the value of its only variable.
    ///
    /// Outside the domain of a function the result is not finite. Allocates nothing.
    pub fn evaluate<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N, variable: N) -> N {
        self.evaluate_at(parameter, &|_| variable)
    }

    /// Evaluates the expression for the given parameters and variables.
    ///
    /// Outside the domain of a function the result is not finite. Allocates nothing.
    pub fn evaluate_at<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        variable: &impl Fn(Variable) -> N,
    ) -> N {
        self.evaluate_with(&(parameter, variable))
    }

    /// Evaluates the expression for all that it may take from outside.
    ///
    /// Outside the domain of a function the result is not finite. Allocates nothing.
    pub(crate) fn evaluate_with<N: Number>(&self, values: &impl Values<N>) -> N {
        self.evaluate_among(self.functions.list(), values)
    }

    /// Evaluates the expression, which calls these functions.
    pub(in crate::mechanism) fn evaluate_among<N: Number>(
        &self,
        functions: &[Function],
        values: &impl Values<N>,
    ) -> N {
        match *self.program {
            // Most numbers of a mechanism are one of these two.
            [Operation::Number(value)] => N::constant(value),
            [Operation::Parameter(id)] => values.parameter(id),
            _ if self.height <= USUAL_STACK => {
                run::<N, USUAL_STACK>(&self.program, functions, values)
            }
            _ => run::<N, MAX_STACK>(&self.program, functions, values),
        }
    }

    /// Encloses the value and its first three derivatives over a range of the variable, for the
    /// given parameters.
    ///
    /// The expression is a function of real numbers, its parameters are exact; the enclosures hold
    /// in every point of the range, rounding included. `None` where the function cannot be shown
    /// to be three times differentiable with finite derivatives in the whole range: it leaves its
    /// domain, or has a kink or a jump there. A part that does not vary needs a value only.
    /// Allocates nothing.
    pub fn enclose(
        &self,
        parameter: &impl Fn(ParameterId) -> f64,
        variable: Interval,
    ) -> Option<Jet3<Interval>> {
        let parameter = |id| Jet3::constant(parameter(id));
        number::enclose(|variable| self.evaluate(&parameter, variable), variable)
    }

    /// Encloses the value and its first three derivatives at one value of the variable and, less
    /// narrowly than [`enclose`](Self::enclose), over a range; `None` as there.
    pub fn expand(
        &self,
        parameter: &impl Fn(ParameterId) -> f64,
        variable: Interval,
        point: f64,
    ) -> Option<[Jet3<Interval>; 2]> {
        let parameter = |id| Jet3::constant(parameter(id));
        number::expand(
            |variable| self.evaluate(&parameter, variable),
            variable,
            point,
        )
    }

    /// Returns whether it is made of pieces: it has a kink or a jump where it switches from one to
    /// the next, unless they join smoothly.
    #[must_use]
    pub fn has_pieces(&self) -> bool {
        use Operation::{Binary as Two, Unary as One};
        let functions = self.functions.list();
        self.program.iter().any(|operation| match operation {
            One(Unary::Abs | Unary::Sign | Unary::Floor | Unary::Ceil)
            | Two(Binary::Mod | Binary::Min | Binary::Max) => true,
            Operation::Call(place, _) => {
                // The reader adds what functions call that are being read.
                let called = functions.get(*place as usize);
                called.is_some_and(|function| function.has_pieces)
            }
            _ => false,
        })
    }

    /// Returns the expression with the functions that it calls, which could not be read before it.
    pub(in crate::mechanism) fn with_functions(&self, functions: &Functions) -> Self {
        Self::new(self.program.to_vec(), functions)
    }

    /// Returns whether a parameter stands in it, not only in functions that it calls.
    pub(in crate::mechanism) fn names(&self, parameter: ParameterId) -> bool {
        self.program.contains(&Operation::Parameter(parameter))
    }

    /// Returns the places of the functions that it calls, each as often as it does.
    pub(in crate::mechanism) fn calls(&self) -> impl Iterator<Item = usize> {
        let operations = self.program.iter();
        operations.filter_map(|operation| match operation {
            Operation::Call(place, _) => Some(*place as usize),
            _ => None,
        })
    }

    /// Returns whether it calls a function whose points make corners or jumps.
    #[must_use]
    pub fn has_corners(&self) -> bool {
        let called = self
            .calls()
            .filter_map(|place| self.functions.list().get(place));
        let mut jumps = called.filter_map(|function| function.first_jump);
        jumps.any(|jump| jump < 2)
    }

    /// Shows `meet` each argument of a function on whose points the value, or its slope, jumps, in a fixed
    /// order. Allocates nothing.
    pub(crate) fn visit_corners(
        &self,
        parameter: &dyn Fn(ParameterId) -> f64,
        variable: &dyn Fn(Variable) -> f64,
        meet: &mut dyn FnMut(Corner),
    ) {
        let has_corners = |function: &Function| function.first_jump.is_some_and(|jump| jump < 2);
        self.visit_tables(
            self.functions.list(),
            (parameter, variable),
            &has_corners,
            &mut |_, function, arguments| function.visit_corners(parameter, arguments, meet),
        );
    }

    /// Shows `meet` each function with points that has an argument beyond them. Allocates nothing.
    pub(crate) fn visit_beyond(
        &self,
        parameter: &dyn Fn(ParameterId) -> f64,
        variable: &dyn Fn(Variable) -> f64,
        meet: &mut dyn FnMut(BeyondPoints),
    ) {
        self.visit_tables(
            self.functions.list(),
            (parameter, variable),
            &|_| true,
            &mut |place, function, arguments| {
                if let Some((argument, ends)) = function.beyond(parameter, arguments) {
                    meet(BeyondPoints {
                        function: place,
                        argument,
                        ends,
                    });
                }
            },
        );
    }

    /// Shows `meet` the functions with points that it calls, also through others, with their places and
    /// arguments; those alone that are wanted.
    fn visit_tables(
        &self,
        functions: &[Function],
        (parameter, variable): (&dyn Fn(ParameterId) -> f64, &dyn Fn(Variable) -> f64),
        is_wanted: &dyn Fn(&Function) -> bool,
        meet: &mut dyn FnMut(usize, &Function, &[f64]),
    ) {
        let values = (&parameter, &variable);
        let mut stack = [0.0; MAX_STACK];
        let mut height = 0;
        for operation in &self.program {
            if let Operation::Call(place, count) = operation
                && let Some(function) = functions.get(*place as usize).filter(|f| is_wanted(f))
            {
                let arguments = &stack[height - usize::from(*count)..height];
                match &function.body {
                    FunctionBody::Formula(expression) => {
                        let inside = |which| match which {
                            Variable::Argument(place) => arguments[place],
                            _ => f64::NAN,
                        };
                        expression.visit_tables(functions, (parameter, &inside), is_wanted, meet);
                    }
                    _ => meet(*place as usize, function, arguments),
                }
            }
            operation.apply(&mut stack, &mut height, functions, &values);
        }
    }

    /// Returns the number of its operations.
    pub(in crate::mechanism) fn length(&self) -> usize {
        self.program.len()
    }

    /// Returns the first function that it calls whose value jumps somewhere.
    pub(in crate::mechanism) fn jumping_function(&self) -> Option<&Function> {
        let called = self
            .calls()
            .filter_map(|place| self.functions.list().get(place));
        let mut jumping = called.filter(|function| function.first_jump == Some(0));
        jumping.next()
    }

    /// Returns the parameters that it uses, ascending, each once.
    pub fn parameters(&self) -> impl Iterator<Item = ParameterId> {
        self.parameters.iter().copied()
    }

    /// Returns the variables that it uses, each as often as it does.
    pub fn variables(&self) -> impl Iterator<Item = Variable> {
        self.program.iter().filter_map(|operation| match operation {
            Operation::Variable(variable) => Some(*variable),
            _ => None,
        })
    }

    /// Returns whether it uses a variable.
    #[must_use]
    pub fn uses(&self, variable: Variable) -> bool {
        self.program.contains(&Operation::Variable(variable))
    }

    /// Returns the inputs of the mechanism that it uses, each as often as it does.
    pub fn inputs(&self) -> impl Iterator<Item = usize> {
        self.variables().filter_map(|variable| match variable {
            Variable::Input(index) => Some(index),
            _ => None,
        })
    }

    /// Returns the expression with these expressions in the places of inputs that have one; `None` if that
    /// is nested too deeply.
    pub(in crate::mechanism) fn with_inputs(
        &self,
        of: impl Fn(usize) -> Option<Self>,
    ) -> Option<Self> {
        let mut program = Vec::new();
        let mut functions = self.functions.clone();
        for operation in &self.program {
            if let Operation::Variable(Variable::Input(index)) = operation
                && let Some(given) = of(*index)
            {
                program.extend_from_slice(&given.program);
                functions = functions.or(&given.functions);
            } else {
                program.push(*operation);
            }
        }
        let expression = Self::new(program, &functions);
        (expression.height <= MAX_STACK).then_some(expression)
    }

    /// Returns the expression with each coordinate's place in `places` as its place.
    pub(in crate::mechanism) fn with_coordinates(mut self, places: &[usize]) -> Self {
        for operation in &mut self.program {
            if let Operation::Variable(Variable::Coordinate(place)) = operation
                && let Some(new) = places.iter().position(|known| known == place)
            {
                *place = new;
            }
        }
        self
    }

    /// Returns the value if it uses neither parameters nor a variable.
    #[must_use]
    pub fn literal(&self) -> Option<f64> {
        match *self.program {
            [Operation::Number(value)] => Some(value),
            _ => None,
        }
    }
}

/// Runs a program that leaves one operand and never has more than `STACK` waiting.
fn run<N: Number, const STACK: usize>(
    program: &[Operation],
    functions: &[Function],
    values: &dyn Values<N>,
) -> N {
    let mut stack = [N::constant(0.0); STACK];
    run_on(&mut stack, program, functions, values);
    stack[0]
}

/// Runs a program on a stack, at whose bottom the operand is that it leaves.
// With a type of its own for the values from outside, the library of an FMU would have a hundred of it.
#[inline(never)]
fn run_on<N: Number>(
    stack: &mut [N],
    program: &[Operation],
    functions: &[Function],
    values: &dyn Values<N>,
) {
    let mut height = 0;
    for operation in program {
        operation.apply(stack, &mut height, functions, values);
    }
}

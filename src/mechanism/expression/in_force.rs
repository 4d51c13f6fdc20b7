//! Expressions of one variable with the parameters in force, for evaluation at many places.

use super::{Expression, Operation};
use crate::mechanism::ParameterId;
use crate::mechanism::number::{Jet3, Number, Unary};

/// Most numbers that vary in a program: more than most contours have.
const MOST: usize = 16;

/// Most operands that wait for their operation.
const MOST_WAITING: usize = 16;

/// An expression of one variable, prepared for these values of its parameters: parts that do not
/// vary are computed, equal parts are one, and a sine comes with its cosine.
#[derive(Clone, Debug, Default)]
pub(in crate::mechanism) struct ExpressionInForce {
    /// Step k computes number k + 1; number 0 is the variable.
    steps: [Step; MOST - 1],
    count: usize,
    /// `None` if the expression takes more numbers than there are places, or calls functions.
    result: Option<Operand>,
}

/// An operand of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operand {
    Constant(f64),
    /// A number that varies.
    Place(u8),
}

/// A step of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Step {
    /// Computed together with the number before it.
    #[default]
    Done,
    /// x + c.
    Shift(u8, f64),
    /// c − x.
    From(f64, u8),
    /// c x.
    Scale(u8, f64),
    /// x + y.
    Sum(u8, u8),
    Square(u8),
    Sqrt(u8),
    /// The sine, and the cosine as the next number.
    SineAndCosine(u8),
    /// Any other operation.
    Other(Operation, [Operand; 2]),
}

impl ExpressionInForce {
    /// Prepares an expression for these values of the parameters. Allocates nothing.
    pub(in crate::mechanism) fn set(
        &mut self,
        expression: &Expression,
        parameter: &impl Fn(ParameterId) -> f64,
    ) {
        self.count = 0;
        self.result = self.compile(expression, parameter);
    }

    /// Returns the result; `None` if there are too few places.
    fn compile(
        &mut self,
        expression: &Expression,
        parameter: &impl Fn(ParameterId) -> f64,
    ) -> Option<Operand> {
        let mut stack = [Operand::Constant(0.0); MOST_WAITING];
        let mut height = 0;
        for &operation in &expression.program {
            let first = height - operation.arity();
            let result = match operation {
                Operation::Number(value) => Operand::Constant(value),
                Operation::Parameter(id) => Operand::Constant(parameter(id)),
                Operation::Variable(_) => Operand::Place(0),
                // Functions are called by the expression itself.
                Operation::Call(..) => return None,
                _ => {
                    let operands = match operation.arity() {
                        1 => [stack[first]; 2],
                        _ => [stack[first], stack[first + 1]],
                    };
                    self.apply(operation, operands)?
                }
            };
            *stack.get_mut(first)? = result;
            height = first + 1;
        }
        Some(stack[0])
    }

    /// Returns the result of an operation, of one operand twice or of two.
    fn apply(&mut self, operation: Operation, operands: [Operand; 2]) -> Option<Operand> {
        use Operand::{Constant, Place};
        let step = match (operation, operands) {
            (_, [Constant(a), Constant(b)]) => {
                return Some(Constant(operation.of(a, b)));
            }
            (Operation::Add, [Place(x), Constant(c)] | [Constant(c), Place(x)]) => {
                Step::Shift(x, c)
            }
            (Operation::Add, [Place(x), Place(y)]) => Step::Sum(x, y),
            (Operation::Subtract, [Place(x), Constant(c)]) => Step::Shift(x, -c),
            (Operation::Subtract, [Constant(c), Place(x)]) => Step::From(c, x),
            (Operation::Multiply, [Place(x), Constant(c)] | [Constant(c), Place(x)]) => {
                Step::Scale(x, c)
            }
            (Operation::Negate, [Place(x), _]) => Step::Scale(x, -1.0),
            (Operation::Power, [Place(x), Constant(2.0)]) => Step::Square(x),
            (Operation::Unary(Unary::Sqrt), [Place(x), _]) => Step::Sqrt(x),
            (Operation::Unary(Unary::Sin), [Place(x), _]) => Step::SineAndCosine(x),
            (Operation::Unary(Unary::Cos), [Place(x), _]) => {
                let sine = self.add(Step::SineAndCosine(x))?;
                return Some(Place(sine + 1));
            }
            _ => Step::Other(operation, operands),
        };
        self.add(step).map(Place)
    }

    /// Adds a step unless it is there. Returns the place of the number that it computes.
    fn add(&mut self, step: Step) -> Option<u8> {
        let known = self.steps[..self.count].iter().position(|s| *s == step);
        let place = match known {
            Some(place) => place,
            None => {
                let place = self.count;
                *self.steps.get_mut(place)? = step;
                self.count += 1;
                if let Step::SineAndCosine(_) = step {
                    *self.steps.get_mut(self.count)? = Step::Done;
                    self.count += 1;
                }
                place
            }
        };
        u8::try_from(place + 1).ok()
    }

    /// Returns the value and its first three derivatives; `None` if the expression is too long.
    pub(in crate::mechanism) fn evaluate(&self, variable: f64) -> Option<Jet3> {
        let result = self.result?;
        let mut numbers = [Jet3::constant(0.0); MOST];
        numbers[0] = Jet3::variable(variable);
        for (k, step) in self.steps[..self.count].iter().enumerate() {
            // All places are below MOST; the remainder spares their check.
            let x = |place: u8| numbers[usize::from(place) % MOST];
            numbers[k + 1] = match *step {
                Step::Done => continue,
                Step::Shift(place, c) => {
                    let mut sum = x(place);
                    sum.value += c;
                    sum
                }
                Step::From(c, place) => {
                    let mut difference = -x(place);
                    difference.value += c;
                    difference
                }
                Step::Scale(place, c) => x(place) * c,
                Step::Sum(place, other) => x(place) + x(other),
                Step::Square(place) => square(x(place)),
                Step::Sqrt(place) => sqrt(x(place)),
                Step::SineAndCosine(place) => {
                    let [sine, cosine] = sine_and_cosine(x(place));
                    numbers[k + 2] = cosine;
                    sine
                }
                Step::Other(operation, operands) => {
                    let [a, b] = operands.map(|operand| match operand {
                        Operand::Constant(value) => Jet3::constant(value),
                        Operand::Place(place) => x(place),
                    });
                    operation.of(a, b)
                }
            };
        }
        Some(match result {
            Operand::Constant(value) => Jet3::constant(value),
            Operand::Place(place) => numbers[usize::from(place) % MOST],
        })
    }
}

// The usual operations of a contour: straight code takes a part of the time of the chain rule for any
// function ([`Jet3::apply`]).

/// Returns x².
#[inline(always)]
fn square(x: Jet3) -> Jet3 {
    let [x1, x2, x3] = x.derivatives;
    let x = x.value;
    let derivatives = [
        2.0 * x * x1,
        2.0 * (x * x2 + x1 * x1),
        2.0 * (x * x3 + 3.0 * x1 * x2),
    ];
    Jet3::new(x * x, derivatives)
}

/// Returns √x: the derivatives of its square are those of x.
#[inline(always)]
fn sqrt(x: Jet3) -> Jet3 {
    if x.value <= 0.0 || x.value.is_nan() {
        return x.apply(Unary::Sqrt);
    }
    let [x1, x2, x3] = x.derivatives;
    let root = x.value.sqrt();
    let half = 0.5 / root;
    let r1 = half * x1;
    let r2 = half * (x2 - 2.0 * r1 * r1);
    let r3 = half * (x3 - 6.0 * r1 * r2);
    Jet3::new(root, [r1, r2, r3])
}

/// Returns sin x and cos x.
#[inline(always)]
fn sine_and_cosine(x: Jet3) -> [Jet3; 2] {
    let [x1, x2, x3] = x.derivatives;
    let (sin, cos) = x.value.sin_cos();
    let square = x1 * x1;
    // The derivatives of the angle's motion along the unit circle and towards its centre.
    let (along, inwards) = (x3 - square * x1, 3.0 * x1 * x2);
    let sine = [
        cos * x1,
        cos * x2 - sin * square,
        cos * along - sin * inwards,
    ];
    let cosine = [
        -sin * x1,
        -sin * x2 - cos * square,
        -sin * along - cos * inwards,
    ];
    [Jet3::new(sin, sine), Jet3::new(cos, cosine)]
}

impl Operation {
    /// Returns the result of an operation of one operand, which is `a`, or of two.
    fn of<N: Number>(self, a: N, b: N) -> N {
        let mut stack = [a, b];
        let mut height = self.arity();
        // Neither parameters nor variables have operands.
        self.apply(&mut stack, &mut height, &[], &(&|_| a, &|_| a));
        stack[0]
    }
}

//! Functions of the file, which expressions call by their names.
//!
//! A function sees its arguments, parameters and other functions. Expressions call it by its place among
//! the functions of the mechanism, which each of them holds.

use std::sync::Arc;

use super::grid::Grid;
use super::points::CalledPoints;
use super::{Expression, Values, Variable};
use crate::mechanism::{Number, ParameterId};

/// Most arguments of a function.
pub const MOST_ARGUMENTS: usize = 8;

/// A function of the file.
#[derive(Clone, Debug)]
pub struct Function {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// Number of arguments.
    pub arguments: usize,
    /// Its law.
    pub body: FunctionBody,
    /// Parameters that it uses, also through others that it calls; ascending, each once.
    pub parameters: Box<[ParameterId]>,
    /// Order of the first derivative that jumps somewhere, 0 for the value itself; `None` if those up to
    /// the second are continuous, or pieces of its expression alone make corners.
    pub first_jump: Option<usize>,
    /// Whether it is made of pieces that may meet with a corner.
    pub has_pieces: bool,
    /// Whether the file itself says what holds beyond its points: a call there is meant.
    pub says_ends: bool,
}

/// An argument of a function on whose points the value, or its slope, jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// The argument.
    pub argument: f64,
    /// The nearest of these points at or below the argument, and above it; infinite where there is none.
    pub nearest: [f64; 2],
    /// Whether the value jumps there.
    pub jumps: bool,
}

/// An argument of a function beyond its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeyondPoints {
    /// Place of the function.
    pub function: usize,
    /// The argument.
    pub argument: f64,
    /// The least and the largest one that has a point.
    pub ends: [f64; 2],
}

/// The law of a function.
#[derive(Clone, Debug)]
pub enum FunctionBody {
    /// An expression in its arguments.
    Formula(Expression),
    /// Points of a function of one argument.
    Points(CalledPoints),
    /// Points of a function of two arguments.
    Grid(Grid),
}

/// The functions of a mechanism, shared by all that calls them.
#[derive(Clone, Debug, Default)]
pub struct Functions(Option<Arc<[Function]>>);

impl Functions {
    /// Makes the list.
    #[must_use]
    pub fn new(functions: Vec<Function>) -> Self {
        Self((!functions.is_empty()).then(|| functions.into()))
    }

    /// Returns the functions in file order.
    #[must_use]
    pub fn list(&self) -> &[Function] {
        self.0.as_deref().unwrap_or_default()
    }

    /// Returns this list, or `other` where it is empty.
    pub(in crate::mechanism) fn or(&self, other: &Self) -> Self {
        if self.0.is_some() { self } else { other }.clone()
    }
}

/// Lists are equal if they are one.
impl PartialEq for Functions {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            (one, other) => one.is_none() && other.is_none(),
        }
    }
}

impl Function {
    /// Returns the value for these arguments, or bounds of it over ranges. Allocates nothing.
    pub(super) fn evaluate<N: Number>(
        &self,
        functions: &[Self],
        parameter: &dyn Fn(ParameterId) -> N,
        arguments: &[N],
    ) -> N {
        match &self.body {
            FunctionBody::Points(points) => points.evaluate(&parameter, arguments[0]),
            FunctionBody::Grid(grid) => grid.evaluate(&parameter, [arguments[0], arguments[1]]),
            FunctionBody::Formula(expression) => {
                let inside = Inside {
                    parameter,
                    arguments,
                };
                expression.evaluate_among(functions, &inside)
            }
        }
    }

    /// Shows `meet` each argument on whose points the value or its slope jumps.
    pub(super) fn visit_corners(
        &self,
        parameter: &dyn Fn(ParameterId) -> f64,
        arguments: &[f64],
        meet: &mut dyn FnMut(Corner),
    ) {
        let corner = |argument, nearest| Corner {
            argument,
            nearest,
            jumps: self.first_jump == Some(0),
        };
        match &self.body {
            FunctionBody::Points(points) => {
                let [x, ..] = *arguments else { return };
                meet(corner(x, points.corners(&parameter, x)));
            }
            FunctionBody::Grid(grid) => {
                for (axis, x) in arguments.iter().enumerate() {
                    let factor = grid.scale[axis].evaluate(&parameter, 0.0);
                    meet(corner(*x, grid.corners(axis, factor, *x)));
                }
            }
            FunctionBody::Formula(_) => {}
        }
    }

    /// Returns the first argument beyond the points, by more than rounding, with the ends of these; `None`
    /// for a formula, where points repeat, and where the file says what holds beyond them.
    pub(super) fn beyond(
        &self,
        parameter: &dyn Fn(ParameterId) -> f64,
        arguments: &[f64],
    ) -> Option<(f64, [f64; 2])> {
        /// Part of the range of a table within which an argument is at its end.
        const ROUNDING: f64 = 1e-9;
        if self.says_ends {
            return None;
        }
        let ends = |axis: usize| match &self.body {
            FunctionBody::Points(points) => points.ends(&parameter),
            FunctionBody::Grid(grid) => {
                let factor = grid.scale[axis].evaluate(&parameter, 0.0);
                Some(grid.ends(axis).map(|end| end * factor))
            }
            FunctionBody::Formula(_) => None,
        };
        let arguments = arguments.iter().enumerate();
        let mut beyond = arguments.filter_map(|(axis, x)| {
            let [start, end] = ends(axis)?;
            let slack = ROUNDING * (end - start);
            (*x < start - slack || *x > end + slack).then_some((*x, [start, end]))
        });
        beyond.next()
    }
}

/// The numbers that the expression of a function takes from outside.
struct Inside<'a, N> {
    parameter: &'a dyn Fn(ParameterId) -> N,
    arguments: &'a [N],
}

impl<N: Number> Values<N> for Inside<'_, N> {
    fn parameter(&self, id: ParameterId) -> N {
        (self.parameter)(id)
    }

    fn variable(&self, which: Variable) -> N {
        match which {
            Variable::Argument(place) => self.arguments[place],
            _ => N::unknown(),
        }
    }

    fn law(&self, _argument: N) -> N {
        N::unknown()
    }
}

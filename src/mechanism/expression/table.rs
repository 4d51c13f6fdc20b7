//! Points whose numbers are expressions over the parameters.

use super::Expression;
use crate::mechanism::{Number, ParameterId};

/// Points of a function, given in the mechanism file or in a CSV file beside it.
#[derive(Clone, Debug)]
pub struct Table {
    /// Abscissa and ordinate of each point, before scaling; two points at least.
    pub points: Vec<[Expression; 2]>,
    /// Factors that bring abscissas and ordinates to SI units.
    pub scale: [Expression; 2],
}

impl Table {
    /// Writes the points in SI units, for the given parameters. Both slices are at least as long
    /// as the table.
    pub(in crate::mechanism) fn write<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        abscissas: &mut [N],
        ordinates: &mut [N],
    ) {
        let [across, up] = self.factors(parameter);
        self.write_unscaled(parameter, abscissas, ordinates);
        for (abscissa, ordinate) in abscissas.iter_mut().zip(ordinates) {
            *abscissa = *abscissa * across;
            *ordinate = *ordinate * up;
        }
    }

    /// Writes the points as the table has them.
    pub(in crate::mechanism) fn write_unscaled<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        abscissas: &mut [N],
        ordinates: &mut [N],
    ) {
        let evaluate = |expression: &Expression| expression.evaluate(parameter, N::constant(0.0));
        for (([x, y], abscissa), ordinate) in self.points.iter().zip(abscissas).zip(ordinates) {
            (*abscissa, *ordinate) = (evaluate(x), evaluate(y));
        }
    }

    /// Returns the factors of abscissas and ordinates.
    pub(in crate::mechanism) fn factors<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
    ) -> [N; 2] {
        let zero = N::constant(0.0);
        (self.scale.each_ref()).map(|factor| factor.evaluate(parameter, zero))
    }

    /// Returns the parameters that it uses; one may come twice.
    pub fn parameters(&self) -> impl Iterator<Item = ParameterId> {
        let expressions = self.points.iter().flatten().chain(&self.scale);
        expressions.flat_map(Expression::parameters)
    }
}

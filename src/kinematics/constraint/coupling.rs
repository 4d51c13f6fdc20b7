//! An equation between coordinates.

use super::CoordinateRelation;
use super::configuration::{CoefficientId, Configuration, LawId, ParameterCoefficients};
use super::definition::{Constraint, Dimension, Formula, Incidence, TurnEffect};
use super::gradient::Gradient;
use super::moving_configuration::{Enclosed, Moving, Varied, VariedMechanism, bend};
use super::region::Region;
use crate::mechanism::{
    Dual, Expression, Interval, Jet, MOST_COUPLED, Mechanism, Number, ParameterId, Values,
    Variable, joins,
};

/// c = f(s₁, s₂, …), the difference of both sides of an equation between coordinates s.
///
/// With f_i = ∂f/∂s_i the gradient is Σ f_i ∂s_i/∂q, and the second derivatives follow by the chain
/// rule: f on numbers s_i with derivatives has those of c.
#[derive(Clone, Debug)]
pub struct Coupling {
    /// The coordinates.
    pub coordinates: Vec<CoordinateRelation>,
    /// f.
    pub function: CoupledFunction,
    /// The dimension of both sides.
    pub dimension: Dimension,
}

/// A function of coordinates.
#[derive(Clone, Debug)]
pub enum CoupledFunction {
    /// Σ k_i s_i + k.
    Linear {
        /// k_i.
        factors: Vec<CoefficientId>,
        /// k.
        rest: CoefficientId,
        /// Whether no k_i depends on parameters, and none is zero.
        is_fixed: bool,
    },
    /// An expression.
    Expression(CoupledExpression),
}

/// An expression of coordinates.
#[derive(Clone, Debug)]
pub struct CoupledExpression {
    /// Over the coordinates by their places.
    pub expression: Expression,
    /// Its parameters.
    pub parameters: ParameterCoefficients,
    /// The table that it calls.
    pub law: Option<LawId>,
    /// The place of the coordinate on which all parts that jump depend, if it is one.
    pub jumps_by: Option<usize>,
}

impl CoupledExpression {
    /// Returns the numbers in the expression.
    fn inputs<N: Number>(
        &self,
        coordinates: [N; MOST_COUPLED],
        coefficient: impl Fn(CoefficientId) -> N,
        law: impl Fn(LawId, N) -> N,
    ) -> impl Values<N> {
        Inputs {
            coordinates,
            parameters: &self.parameters,
            coefficient,
            law: move |argument| self.law.map_or_else(N::unknown, |own| law(own, argument)),
        }
    }
}

/// The numbers in an expression.
struct Inputs<'a, N, C, L> {
    coordinates: [N; MOST_COUPLED],
    parameters: &'a ParameterCoefficients,
    coefficient: C,
    law: L,
}

impl<N: Number, C: Fn(CoefficientId) -> N, L: Fn(N) -> N> Values<N> for Inputs<'_, N, C, L> {
    fn parameter(&self, id: ParameterId) -> N {
        (self.coefficient)(self.parameters.of(id))
    }

    fn variable(&self, which: Variable) -> N {
        match which {
            Variable::Coordinate(place) => self.coordinates[place],
            _ => N::unknown(),
        }
    }

    fn law(&self, argument: N) -> N {
        (self.law)(argument)
    }
}

/// Returns the coefficients in force as ranges.
fn enclosed_coefficient(at: &Configuration) -> impl Fn(CoefficientId) -> Enclosed {
    |id| Enclosed::constant(at.coefficient(id))
}

/// Returns the laws in force on ranges.
fn enclosed_law(at: &Configuration) -> impl Fn(LawId, Enclosed) -> Enclosed {
    |law, argument| {
        let law = at.law(law).enclosed.enclose(argument);
        law.unwrap_or_else(Enclosed::unknown)
    }
}

impl Coupling {
    /// Returns f for these coordinates.
    fn function<N: Number>(
        &self,
        coordinates: [N; MOST_COUPLED],
        coefficient: impl Fn(CoefficientId) -> N,
        law: impl Fn(LawId, N) -> N,
    ) -> N {
        match &self.function {
            CoupledFunction::Linear { factors, rest, .. } => {
                let terms = coordinates.into_iter().zip(factors);
                terms.fold(coefficient(*rest), |sum, (s, factor)| {
                    sum + coefficient(*factor) * s
                })
            }
            CoupledFunction::Expression(coupled) => {
                let inputs = coupled.inputs(coordinates, coefficient, law);
                coupled.expression.evaluate_with(&inputs)
            }
        }
    }

    /// Returns f for these moving coordinates with the parameters in force.
    fn in_force(&self, at: &Configuration, coordinates: [Jet; MOST_COUPLED]) -> Jet {
        let coefficient = |id| Jet::constant(at.coefficient(id));
        let law = |law, argument| at.law(law).in_force.evaluate(argument);
        self.function(coordinates, coefficient, law)
    }

    /// Encloses f for ranges of the coordinates with the parameters in force. Derivatives across a jump
    /// are not finite.
    fn enclosed_at_once(
        &self,
        at: &Configuration,
        coordinates: [Enclosed; MOST_COUPLED],
    ) -> Enclosed {
        self.function(coordinates, enclosed_coefficient(at), enclosed_law(at))
    }

    /// Encloses f likewise; where parts of it jump and are shown to join, the derivatives are those of
    /// all pieces.
    fn enclosed(&self, at: &Configuration, coordinates: [Enclosed; MOST_COUPLED]) -> Enclosed {
        let enclosed = self.enclosed_at_once(at, coordinates);
        let CoupledFunction::Expression(coupled) = &self.function else {
            return enclosed;
        };
        let Some(place) = coupled.jumps_by.filter(|_| !enclosed.first().is_finite()) else {
            return enclosed;
        };
        let inputs = coupled.inputs(coordinates, enclosed_coefficient(at), enclosed_law(at));
        let pieces = coupled.expression.enclose_all_pieces(&inputs);
        let pieces = pieces.filter(|_| self.joins(at, coordinates.map(|s| s.value), place));
        pieces.unwrap_or(enclosed)
    }

    /// Returns whether f is continuous where its parts jump, which depend on the coordinate at `place`
    /// alone: from its lowest to its highest value, all others being at their lowest or highest.
    fn joins(&self, at: &Configuration, ranges: [Interval; MOST_COUPLED], place: usize) -> bool {
        let at_ends = |end: fn(Interval) -> f64| ranges.map(|range| Interval::point(end(range)));
        let mut ways = [at_ends(|range| range.low), at_ends(|range| range.high)];
        ways.iter_mut().all(|way| {
            way[place] = ranges[place];
            self.joins_along(at, way, place)
        })
    }

    /// Returns whether f is continuous along the range of the coordinate at `place`, all others being
    /// at their lowest.
    fn joins_along(
        &self,
        at: &Configuration,
        ranges: &[Interval; MOST_COUPLED],
        place: usize,
    ) -> bool {
        let bounds = |part: Interval| {
            let mut numbers = ranges.map(Enclosed::fixed);
            numbers[place] = Enclosed::variable(part);
            self.enclosed_at_once(at, numbers)
        };
        let value = |s: f64| {
            let mut numbers = ranges.map(|range| Jet::constant(range.low));
            numbers[place] = Jet::variable(s);
            self.in_force(at, numbers)
        };
        joins(ranges[place], bounds, value)
    }

    /// Returns one number per coordinate, zero beyond the last.
    fn each<N: Number>(&self, of: impl Fn(&CoordinateRelation) -> N) -> [N; MOST_COUPLED] {
        let mut numbers = [N::constant(0.0); MOST_COUPLED];
        for (number, coordinate) in numbers.iter_mut().zip(&self.coordinates) {
            *number = of(coordinate);
        }
        numbers
    }

    /// Returns the values of the coordinates.
    fn values(&self, at: &Configuration) -> [f64; MOST_COUPLED] {
        self.each(|coordinate| coordinate.constraint().value(at))
    }

    /// Returns f_i.
    pub(in crate::kinematics) fn partials(&self, at: &Configuration) -> [f64; MOST_COUPLED] {
        let mut partials = [0.0; MOST_COUPLED];
        if let CoupledFunction::Linear { factors, .. } = &self.function {
            for (partial, factor) in partials.iter_mut().zip(factors) {
                *partial = at.coefficient(*factor);
            }
            return partials;
        }
        let mut numbers = self.values(at).map(Jet::constant);
        for (k, partial) in partials[..self.coordinates.len()].iter_mut().enumerate() {
            numbers[k] = Jet::variable(numbers[k].value);
            *partial = self.in_force(at, numbers).first();
            numbers[k] = Jet::constant(numbers[k].value);
        }
        partials
    }

    /// Returns f_i of a coordinate with its change along a direction.
    pub(in crate::kinematics) fn varied_partial(
        &self,
        at: &VariedMechanism<'_, '_>,
        place: usize,
    ) -> Dual {
        let mut numbers = self.each(|coordinate| Varied::fixed(coordinate.evaluate(at).value));
        numbers[place] = Varied::variable(numbers[place].value);
        let coefficient = |id| Varied::fixed(at.coefficient(id).value);
        let law = |law, argument| at.law(law, argument);
        self.function(numbers, coefficient, law).first()
    }
}

impl Formula for Coupling {
    fn evaluate<N: Moving>(&self, at: &VariedMechanism<'_, '_, N>) -> N {
        let coordinates = self.each(|coordinate| coordinate.evaluate(at));
        let law = |law, argument| at.law(law, argument);
        self.function(coordinates, |id| at.coefficient(id), law)
    }
}

impl Constraint for Coupling {
    fn dimension(&self) -> Dimension {
        self.dimension
    }

    fn value(&self, at: &Configuration) -> f64 {
        self.in_force(at, self.values(at).map(Jet::constant)).value
    }

    fn value_and_gradient(&self, at: &Configuration, row: &mut Gradient) -> f64 {
        let mut own = Gradient::new();
        for (coordinate, partial) in self.coordinates.iter().zip(self.partials(at)) {
            own.clear();
            coordinate.constraint().gradient(at, &mut own);
            row.add_multiple(partial, &own);
        }
        self.value(at)
    }

    fn has_given_function(&self) -> bool {
        matches!(self.function, CoupledFunction::Expression(_))
    }

    fn is_linear(&self, mechanism: &Mechanism) -> bool {
        let mut coordinates = self.coordinates.iter();
        matches!(
            self.function,
            CoupledFunction::Linear { is_fixed: true, .. }
        ) && coordinates.all(|coordinate| coordinate.constraint().is_linear(mechanism))
    }

    fn turn_effect(&self) -> TurnEffect {
        let mut effects = self
            .coordinates
            .iter()
            .map(|own| own.constraint().turn_effect());
        if effects.any(|effect| effect != TurnEffect::None) {
            TurnEffect::Proportional
        } else {
            TurnEffect::None
        }
    }

    /// Encloses each coordinate over the region with its first two derivatives along v, and f on
    /// these. At a corner of f, eight times the distance from the chord takes the place of the second
    /// derivative.
    fn bend(
        &self,
        at: &Configuration,
        region: &Region<'_>,
        v: &[f64],
        row: &mut Gradient,
    ) -> Option<f64> {
        let partials = self.partials(at);
        let mut own = Gradient::new();
        let mut numbers = [Enclosed::constant(0.0); MOST_COUPLED];
        let mut changes: [Gradient; MOST_COUPLED] = Default::default();
        for (k, coordinate) in self.coordinates.iter().enumerate() {
            let coordinate = coordinate.constraint();
            let change = &mut changes[k];
            let bend = coordinate.bend(at, region, v, change)?;
            own.clear();
            let value = coordinate.value_and_gradient(at, &mut own);
            let rate = own.dot(v);
            let off_rate: f64 = change.entries().map(|(k, by)| by * v[k].abs()).sum();
            let reach = own.entries().chain(change.entries());
            let reach: f64 = reach.map(|(k, by)| by.abs() * region.radius(k)).sum();
            let about = |middle: f64, off: f64| Interval::new(middle - off, middle + off);
            let derivatives = [about(rate, off_rate), about(0.0, bend), Interval::unknown()];
            numbers[k] = Enclosed::new(about(value, reach), derivatives);
        }
        for (k, coordinate) in self.coordinates.iter().enumerate() {
            let mut still = numbers.map(|number| Enclosed::fixed(number.value));
            still[k] = Enclosed::variable(numbers[k].value);
            let slope = self.enclosed(at, still).first();
            let change = (slope - Interval::point(partials[k])).magnitude();
            if !change.is_finite() {
                return None;
            }
            own.clear();
            coordinate.constraint().gradient(at, &mut own);
            own.replace(|_, entry| entry.abs());
            row.add_multiple(change, &own);
            row.add_multiple(slope.magnitude(), &changes[k]);
        }
        let along = self.enclosed(at, numbers);
        let bound = bend(&along);
        (along.first().is_finite() && bound.is_finite()).then_some(bound)
    }

    fn incidence(&self, mechanism: &Mechanism, incidence: &mut Incidence) {
        for coordinate in &self.coordinates {
            coordinate.constraint().incidence(mechanism, incidence);
        }
    }
}

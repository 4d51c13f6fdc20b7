//! The size of friction.

use super::{Expression, Number, ParameterId};

/// Size of friction while something slides, and the limit up to which it sticks.
#[derive(Clone, Debug)]
pub struct FrictionLaw {
    /// Coulomb's force \[N or N m\].
    pub coulomb: Expression,
    /// Largest force while it sticks \[N or N m\], `None` for Coulomb's.
    pub sticking: Option<Expression>,
    /// Stribeck's speed \[m/s or rad/s\]: about so fast, the force has fallen from that of sticking
    /// to Coulomb's. `None` if it falls at once.
    pub stribeck: Option<Expression>,
    /// Coefficient of the part that grows with the speed \[N s/m or N m s/rad\].
    pub viscous: Option<Expression>,
}

impl FrictionLaw {
    /// Returns the force against the motion at a rate of the coordinate in the direction of the
    /// motion: [`dry`](Self::dry) and viscous friction.
    fn sliding<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N, speed: N) -> N {
        self.dry(parameter, speed) + self.viscous(parameter) * speed
    }

    /// Returns the force along a coordinate that slides at this rate in the direction of a sign.
    pub fn along<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N, rate: N, sign: f64) -> N {
        // No negative zero at rest.
        self.sliding(parameter, rate * sign) * (0.0 - sign)
    }

    /// Returns the direction in which a coordinate slides: zero where it rests.
    #[must_use]
    pub fn direction(rate: f64) -> f64 {
        if rate == 0.0 { 0.0 } else { rate.signum() }
    }

    /// Returns the part of the force that does not grow with the rate of the coordinate:
    /// C + (S − C) exp(−(ċ / v)²), with C of Coulomb, S of sticking and v of Stribeck.
    pub fn dry<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N, rate: N) -> N {
        let value = |expression: &Expression| expression.evaluate(parameter, N::constant(0.0));
        let coulomb = value(&self.coulomb);
        let Some(stribeck) = &self.stribeck else {
            return coulomb;
        };
        let part = (-(rate / value(stribeck)).square()).exp();
        coulomb + (self.sticking(parameter) - coulomb) * part
    }

    /// Returns the coefficient of viscous friction.
    pub fn viscous<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N) -> N {
        let zero = N::constant(0.0);
        let viscous = self.viscous.as_ref();
        viscous.map_or(zero, |viscous| viscous.evaluate(parameter, zero))
    }

    /// Returns the largest force while it sticks.
    pub fn sticking<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N) -> N {
        let limit = self.sticking.as_ref().unwrap_or(&self.coulomb);
        limit.evaluate(parameter, N::constant(0.0))
    }

    /// Returns its expressions.
    pub fn expressions(&self) -> impl Iterator<Item = &Expression> {
        let others = [&self.sticking, &self.stribeck, &self.viscous];
        [&self.coulomb]
            .into_iter()
            .chain(others.into_iter().flatten())
    }
}

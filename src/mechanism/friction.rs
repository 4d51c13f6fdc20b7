//! The size of friction.

use super::{Expression, Number, ParameterId};

/// Size of friction while something slides, and the limit up to which it sticks.
///
/// Its dry part is a force, or in a joint a coefficient that the [pressure](Bearing::pressure)
/// multiplies.
#[derive(Clone, Debug)]
pub struct FrictionLaw {
    /// Coulomb's force \[N or N m\], or coefficient \[1\].
    pub coulomb: Expression,
    /// Largest force or coefficient while it sticks, `None` for Coulomb's.
    pub sticking: Option<Expression>,
    /// Stribeck's speed \[m/s or rad/s\]: about so fast, the force has fallen from that of sticking
    /// to Coulomb's. `None` if it falls at once.
    pub stribeck: Option<Expression>,
    /// Stribeck's exponent \[1\], at least 1: below, the force would fall with an infinite slope as
    /// sliding begins. `None` for 2.
    pub exponent: Option<Expression>,
    /// Coefficient of the part that grows with the speed \[N s/m or N m s/rad\].
    pub viscous: Option<Expression>,
    /// The joint that presses the two sides on each other, `None` for friction of a given force.
    pub bearing: Option<Bearing>,
}

/// Joint that presses the two sides of friction on each other.
#[derive(Clone, Debug)]
pub struct Bearing {
    /// Index of the joint.
    pub joint: usize,
    /// Its shape.
    pub shape: BearingShape,
    /// The way along which its sides slide.
    pub way: SlidingWay,
}

/// Way along which the two sides of a [`Bearing`] slide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlidingWay {
    /// The coordinate of the force.
    Coordinate,
    /// The tangent at the contact of a cam or at the point on a curve; on a roller the turning of its pin.
    Contact,
    /// The turning of a link against the body of its first (0) or second (1) marker.
    Rod(usize),
}

/// Shape of a [`Bearing`].
#[derive(Clone, Debug)]
pub enum BearingShape {
    /// A round pin.
    Pin {
        /// Radius \[m\].
        radius: Expression,
    },
    /// A straight guide.
    Guide {
        /// Length, with the second marker in the middle \[m\]; `None` where the pressure acts at one
        /// point, or everywhere alike.
        length: Option<Expression>,
    },
    /// The contact that an equation between lengths keeps: its effort presses.
    Effort,
}

impl Bearing {
    /// Returns the force, or the torque, of friction per unit of its coefficient \[N or N m\], for force
    /// and torque of the joint at its second marker: a norm of these.
    ///
    /// A guide bears a force N and a torque M with N/2 + M/L and N/2 − M/L at its ends.
    pub fn pressure<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        [fx, fy, torque]: [N; 3],
    ) -> N {
        let zero = N::constant(0.0);
        // A norm has no derivative at zero.
        let is_zero = fx.is_zero() && fy.is_zero();
        let force = if is_zero { zero } else { fx.hypot(fy) };
        match &self.shape {
            BearingShape::Pin { radius } => force * radius.evaluate(parameter, zero),
            BearingShape::Guide { length: None } => force,
            BearingShape::Effort => torque.abs(),
            BearingShape::Guide {
                length: Some(length),
            } => force.larger(torque.abs() * 2.0 / length.evaluate(parameter, zero)),
        }
    }
}

impl FrictionLaw {
    /// Returns the force along a coordinate that slides at this rate in the direction of a sign:
    /// [`dry`](Self::dry) friction under a pressure, and viscous friction.
    pub fn along<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        pressure: N,
        rate: N,
        sign: f64,
    ) -> N {
        let speed = rate * sign;
        let against = self.dry(parameter, speed) * pressure + self.viscous(parameter) * speed;
        // No negative zero at rest.
        against * (0.0 - sign)
    }

    /// Returns the part of the force that does not grow with the rate of the coordinate:
    /// C + (S − C) exp(−|ċ / v|ⁿ), with C of Coulomb, S of sticking, v and n of Stribeck.
    pub fn dry<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N, rate: N) -> N {
        let value = |expression: &Expression| expression.evaluate(parameter, N::constant(0.0));
        let coulomb = value(&self.coulomb);
        let Some(stribeck) = &self.stribeck else {
            return coulomb;
        };
        let ratio = rate / value(stribeck);
        let power = match &self.exponent {
            None => ratio.square(),
            Some(exponent) => ratio.abs().powf(value(exponent)),
        };
        coulomb + (self.sticking(parameter) - coulomb) * (-power).exp()
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
        let of_bearing = self
            .bearing
            .as_ref()
            .and_then(|bearing| match &bearing.shape {
                BearingShape::Pin { radius } => Some(radius),
                BearingShape::Guide { length } => length.as_ref(),
                BearingShape::Effort => None,
            });
        let others = [
            &self.sticking,
            &self.stribeck,
            &self.viscous,
            &self.exponent,
        ];
        let others = others.map(Option::as_ref);
        let others = others.into_iter().chain([of_bearing]);
        [&self.coulomb].into_iter().chain(others.flatten())
    }
}

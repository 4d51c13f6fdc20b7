//! Forces on a mechanism, besides gravity.

use super::{Coordinate, Expression, MarkerId, Mechanism, Number, ParameterId, Unit, Variable};

/// Force on a mechanism.
#[derive(Clone, Debug)]
pub struct Force {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// Place and size of the force.
    pub load: Load,
}

/// Place and size of a force.
#[derive(Clone, Debug)]
pub enum Load {
    /// A generalized force f conjugate to a coordinate c: Q = f ∂c/∂q \[N or N m\].
    Coordinate {
        /// Coordinate c.
        coordinate: Coordinate,
        /// Size f, `None` for an FMI input.
        law: Option<ForceLaw>,
    },
    /// A force at a marker's point and a torque on its body.
    Marker {
        /// Marker at whose point the force acts.
        marker: MarkerId,
        /// Marker along whose axes the components are, `None` for those of ground's frame.
        axes: Option<MarkerId>,
        /// Components \[N\] and torque \[N m\], `None` for FMI inputs.
        law: Option<[Expression; 3]>,
    },
}

/// Size of a generalized force: f = value − stiffness (c − free) − damping ċ.
#[derive(Clone, Debug)]
pub struct ForceLaw {
    /// Part that is a function of time, of c and of its rate \[N or N m\].
    pub value: Option<Expression>,
    /// Spring.
    pub spring: Option<Spring>,
    /// Coefficient of a damper \[N s/m or N m s/rad\].
    pub damping: Option<Expression>,
}

/// Linear spring.
#[derive(Clone, Debug)]
pub struct Spring {
    /// Stiffness \[N/m or N m/rad\].
    pub stiffness: Expression,
    /// Value of the coordinate at which the spring is free of force \[m or rad\].
    pub free: Expression,
}

impl Spring {
    /// Returns the stiffness, and the extension of the spring at a value of the coordinate.
    pub fn evaluate<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        position: N,
    ) -> [N; 2] {
        let zero = N::constant(0.0);
        let free = self.free.evaluate(parameter, zero);
        [self.stiffness.evaluate(parameter, zero), position - free]
    }
}

impl ForceLaw {
    /// Returns the force f \[N or N m\] at a time \[s\], for a value and a rate of the
    /// coordinate. Allocates nothing.
    pub fn evaluate<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        time: N,
        [position, velocity]: [N; 2],
    ) -> N {
        let mut force = match &self.value {
            Some(value) => value.evaluate_at(parameter, &|variable| match variable {
                Variable::Position => position,
                Variable::Velocity => velocity,
                Variable::Time | Variable::PolarAngle => time,
            }),
            None => N::constant(0.0),
        };
        if let Some(spring) = &self.spring {
            let [stiffness, extension] = spring.evaluate(parameter, position);
            force -= stiffness * extension;
        }
        if let Some(damping) = &self.damping {
            force -= damping.evaluate(parameter, N::constant(0.0)) * velocity;
        }
        force
    }

    /// Returns its expressions.
    pub fn expressions(&self) -> impl Iterator<Item = &Expression> {
        let spring = self.spring.iter().flat_map(|s| [&s.stiffness, &s.free]);
        self.value.iter().chain(spring).chain(&self.damping)
    }
}

impl Load {
    /// Last parts of the names of a marker's force and torque.
    pub const COMPONENTS: [&str; 3] = ["fx", "fy", "torque"];

    /// Returns whether its size is an FMI input.
    #[must_use]
    pub fn is_input(&self) -> bool {
        match self {
            Self::Coordinate { law, .. } => law.is_none(),
            Self::Marker { law, .. } => law.is_none(),
        }
    }

    /// Returns the last parts of the names of its FMI variables, with their units.
    #[must_use]
    pub fn variables(&self) -> Vec<(&'static str, Unit)> {
        match self {
            Self::Coordinate { coordinate, .. } => vec![("effort", coordinate.kind.effort_unit())],
            Self::Marker { .. } => {
                let units = [Unit::NEWTON, Unit::NEWTON, Unit::NEWTON_METRE];
                Self::COMPONENTS.into_iter().zip(units).collect()
            }
        }
    }

    /// Returns its expressions.
    #[must_use]
    pub fn expressions(&self) -> Vec<&Expression> {
        match self {
            Self::Coordinate { law, .. } => law.iter().flat_map(ForceLaw::expressions).collect(),
            Self::Marker { law, .. } => law.iter().flatten().collect(),
        }
    }
}

impl Mechanism {
    /// Returns whether it has dynamics: a body with mass, or a force.
    #[must_use]
    pub fn has_dynamics(&self) -> bool {
        !self.forces.is_empty() || self.bodies.iter().any(|body| body.mass.is_some())
    }
}

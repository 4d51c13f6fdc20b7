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

/// Component of a force under the name of its variable.
#[derive(Clone, Debug)]
pub struct ForceComponent {
    /// Name, such as `cylinder.effort` or `load.fx`.
    pub name: String,
    /// Description in one line.
    pub description: String,
    /// Unit of its values.
    pub unit: Unit,
    /// Index of the force.
    pub force: usize,
    /// Index of the component: x, y and torque of a force at a marker.
    pub component: usize,
}

impl Mechanism {
    /// Returns the components of the forces that are inputs, in the order of these inputs.
    #[must_use]
    pub fn force_inputs(&self) -> Vec<ForceComponent> {
        self.force_components(Load::is_input)
    }

    /// Returns the components of the forces whose sizes the file gives.
    #[must_use]
    pub fn given_forces(&self) -> Vec<ForceComponent> {
        self.force_components(|load| !load.is_input())
    }

    fn force_components(&self, is_wanted: impl Fn(&Load) -> bool) -> Vec<ForceComponent> {
        let forces = self.forces.iter().enumerate();
        let wanted = forces.filter(|(_, force)| is_wanted(&force.load));
        let components = wanted.flat_map(|(index, force)| {
            let whole = force.describe(self);
            let variables = force.load.variables().into_iter().enumerate();
            variables.map(move |(component, (suffix, unit))| ForceComponent {
                name: format!("{}.{suffix}", force.name),
                description: match suffix {
                    "effort" => whole.clone(),
                    component => format!("{component}: {whole}"),
                },
                unit,
                force: index,
                component,
            })
        });
        components.collect()
    }
}

impl Force {
    /// Returns the file's own description, or else the place where the force acts.
    fn describe(&self, mechanism: &Mechanism) -> String {
        match &self.load {
            _ if !self.description.is_empty() => self.description.clone(),
            Load::Coordinate { coordinate, .. } => {
                let word = coordinate.kind.effort_word();
                format!("{word} along {}", coordinate.describe(mechanism))
            }
            Load::Marker { marker, .. } => {
                format!("force and torque at `{}`", mechanism.marker_path(*marker))
            }
        }
    }
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
                _ => time,
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

    /// Gives a component of an input a size, an expression in t and the parameters; those without
    /// one are zero. The force is no input any more.
    pub fn set_component(&mut self, component: usize, size: Expression) {
        match self {
            Self::Coordinate { law, .. } => {
                *law = Some(ForceLaw {
                    value: Some(size),
                    spring: None,
                    damping: None,
                });
            }
            Self::Marker { law, .. } => {
                let zero = || Expression::constant(0.0);
                let law = law.get_or_insert_with(|| [zero(), zero(), zero()]);
                law[component] = size;
            }
        }
    }

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
    fn variables(&self) -> Vec<(&'static str, Unit)> {
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

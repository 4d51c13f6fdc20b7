//! Forces on a mechanism, besides gravity.

use std::ops::Range;

use super::friction::{Bearing, FrictionLaw, SlidingWay};
use super::{
    Body, Coordinate, Expression, MarkerId, Mechanism, Number, Order, ParameterId, Signal, Unit,
    Variable,
};

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
    /// A generalized force along a coordinate that follows from the motion.
    Passive {
        /// Coordinate c.
        coordinate: Coordinate,
        /// Its cause.
        cause: PassiveCause,
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

/// Cause of a force that follows from the motion.
#[derive(Clone, Debug)]
pub enum PassiveCause {
    /// A rigid stop, by its index: it pushes where something touches it.
    Stop(usize),
    /// A joint with play, by its index: its parts push each other where they meet. It acts along the
    /// joint's relation; the coordinate has its unit.
    Play(usize),
    /// Friction: it acts against the rate of the coordinate, and holds it at rest.
    Friction(Box<FrictionLaw>),
}

impl PassiveCause {
    /// Returns whether it is a contact, which holds its coordinate at a limit.
    #[must_use]
    pub fn is_contact(&self) -> bool {
        matches!(self, Self::Stop(_) | Self::Play(_))
    }

    /// Returns the part of the velocity with which something bounces, zero for friction.
    #[must_use]
    pub fn restitution<N: Number>(
        &self,
        mechanism: &Mechanism,
        parameter: &impl Fn(ParameterId) -> N,
    ) -> N {
        let restitution = match self {
            Self::Stop(stop) => mechanism.stops[*stop].restitution(),
            Self::Play(joint) => {
                let play = mechanism.joints[*joint].kind.play();
                play.and_then(|play| play.restitution.as_ref())
            }
            Self::Friction(_) => None,
        };
        let zero = N::constant(0.0);
        restitution.map_or(zero, |restitution| restitution.evaluate(parameter, zero))
    }

    /// Returns the fault of parameters for which it is none, as the end of a sentence.
    #[must_use]
    pub fn fault(&self, mechanism: &Mechanism, parameters: &[f64]) -> Option<&'static str> {
        match self {
            Self::Stop(_) | Self::Play(_) => {
                let is_possible = (0.0..=1.0)
                    .contains(&self.restitution(mechanism, &|id| parameters[id.index()]));
                (!is_possible).then_some("has a `restitution` that is not from 0 to 1")
            }
            Self::Friction(law) => {
                let value = |id: ParameterId| parameters[id.index()];
                let [dry, sticking] = [law.coulomb.value(parameters), law.sticking(&value)];
                let mut sizes = law.expressions().map(|size| size.value(parameters));
                let is_possible = sizes.all(|size| size >= 0.0) && sticking >= dry;
                let mut exponent = law.exponent.iter();
                if !is_possible {
                    Some("has a negative number, or sticks with less than it slides")
                } else if exponent.all(|exponent| exponent.value(parameters) >= 1.0) {
                    None
                } else {
                    Some("has an `exponent` below 1")
                }
            }
        }
    }
}

/// Size of a generalized force: f = value − stiffness (c − free) − damping ċ, and those of an elastic
/// stop and of friction.
#[derive(Clone, Debug, Default)]
pub struct ForceLaw {
    /// Part that is a function of time, of c and its rate, and of what moves elsewhere \[N or N m\].
    pub value: Option<Expression>,
    /// Whether that part is a number, the force of a spring of constant force: it has a potential,
    /// −value · c.
    pub is_constant: bool,
    /// Spring.
    pub spring: Option<Spring>,
    /// Coefficient of a damper \[N s/m or N m s/rad\].
    pub damping: Option<Expression>,
    /// Elastic stop.
    pub stop: Option<Box<ElasticStop>>,
    /// Friction that never sticks.
    pub friction: Option<Box<RegularisedFriction>>,
}

/// A stop that yields: beyond its limits a spring and a damper push the coordinate back, and never
/// pull.
#[derive(Clone, Debug)]
pub struct ElasticStop {
    /// Least and largest value at which it does not push \[m or rad\].
    pub limits: [Option<Expression>; 2],
    /// Stiffness \[N/m or N m/rad\].
    pub stiffness: Expression,
    /// Coefficient of the damper \[N s/m or N m s/rad\].
    pub damping: Option<Expression>,
}

/// Friction that falls to zero at low rates and never sticks: its dry part is multiplied by
/// tanh(ċ / speed).
#[derive(Clone, Debug)]
pub struct RegularisedFriction {
    /// F.
    pub law: FrictionLaw,
    /// Rate from which most of the force acts \[m/s or rad/s\].
    pub speed: Expression,
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

    /// Returns the forces at the elements of a contact, of which one has this index; for any other force
    /// this one alone.
    #[must_use]
    pub fn elements_with(&self, force: usize) -> Range<usize> {
        let shapes = |k: usize| self.forces[k].load.coordinate()?.shapes();
        let Some(own) = shapes(force) else {
            return force..force + 1;
        };
        let is_one = |k: &usize| shapes(*k) == Some(own);
        let first = (0..force).rev().take_while(is_one).last();
        let last = (force..self.forces.len()).take_while(is_one).last();
        first.unwrap_or(force)..last.map_or(force, |last| last + 1)
    }

    /// Returns the components of the forces whose sizes are no inputs, of a contact that of all its
    /// elements. Joints with play have their reactions instead.
    #[must_use]
    pub fn given_forces(&self) -> Vec<ForceComponent> {
        let is_given = |load: &Load| !load.is_input() && load.play().is_none();
        let components = self.force_components(is_given).into_iter();
        let is_first = |own: &ForceComponent| self.elements_with(own.force).start == own.force;
        components.filter(is_first).collect()
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
        if !self.description.is_empty() {
            return self.description.clone();
        }
        if let Some((bearing, coordinate)) = self.load.slides().zip(self.load.coordinate()) {
            let joint = &mechanism.joints[bearing.joint];
            let word = coordinate.kind.effort_word();
            return match bearing.way {
                SlidingWay::Rod(end) => {
                    let marker = mechanism.marker_path([joint.from, joint.to][end]);
                    format!(
                        "{word} of friction at the pin of link `{}` at `{marker}`",
                        joint.name
                    )
                }
                _ => format!("{word} of friction in joint `{}`", joint.name),
            };
        }
        match &self.load {
            load @ (Load::Coordinate { coordinate, .. } | Load::Passive { coordinate, .. }) => {
                let word = coordinate.kind.effort_word();
                let along = coordinate.describe(mechanism);
                let origin = match coordinate.shapes() {
                    Some(_) => " of a contact",
                    None => load.origin(),
                };
                format!("{word}{origin} along {along}")
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
    /// Returns whether it is that of a spring of free length zero and nothing else: along a distance c
    /// its force −k c ∂c/∂q is one along x and one along y, which needs no direction where c = 0.
    pub fn is_through_zero(&self, parameter: &impl Fn(ParameterId) -> f64) -> bool {
        let Self {
            value: None,
            spring: Some(spring),
            damping: None,
            stop: None,
            friction: None,
            ..
        } = self
        else {
            return false;
        };
        spring.free.evaluate(parameter, 0.0) == 0.0
    }

    /// Returns the force f \[N or N m\] for a value and a rate of the coordinate; `other` gives the
    /// variables but these: time, inputs and signals. Allocates nothing.
    pub fn evaluate<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        other: &impl Fn(Variable) -> N,
        [position, velocity]: [N; 2],
    ) -> N {
        let mut force = match &self.value {
            Some(value) => value.evaluate_at(parameter, &|variable| match variable {
                Variable::Position => position,
                Variable::Velocity => velocity,
                _ => other(variable),
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
        if let Some(stop) = &self.stop {
            force += stop.force(parameter, [position, velocity]);
        }
        if let Some(friction) = &self.friction {
            force -= friction.against(parameter, velocity);
        }
        force
    }

    /// Returns its expressions.
    pub fn expressions(&self) -> impl Iterator<Item = &Expression> {
        let spring = self.spring.iter().flat_map(|s| [&s.stiffness, &s.free]);
        let stop = self.stop.iter().flat_map(|stop| {
            let limits = stop.limits.iter().flatten();
            limits.chain([&stop.stiffness]).chain(&stop.damping)
        });
        let friction = self.friction.iter();
        let friction = friction.flat_map(|f| f.law.expressions().chain([&f.speed]));
        let own = self.value.iter().chain(spring).chain(&self.damping);
        own.chain(stop).chain(friction)
    }
}

impl ElasticStop {
    /// Returns least and largest value at which it does not push \[m or rad\], infinite without a limit.
    #[must_use]
    pub fn limits<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N) -> [N; 2] {
        limits(self.limits.each_ref(), parameter)
    }

    /// Returns how far a value is beyond a limit, and 1 for the least or −1 for the largest one; `None`
    /// between the limits.
    fn beyond<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        position: N,
    ) -> Option<(N, f64)> {
        let [least, most] = self.limits.each_ref().map(|limit| {
            let limit = limit.as_ref()?;
            Some(limit.evaluate(parameter, N::constant(0.0)))
        });
        let below = least.map(|least| (least - position, 1.0));
        let above = most.map(|most| (position - most, -1.0));
        let mut sides = [below, above].into_iter().flatten();
        sides.find(|(beyond, _)| beyond.real() > 0.0)
    }

    /// Returns the force along the coordinate: towards the limits, and never away from them.
    pub fn force<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        [position, velocity]: [N; 2],
    ) -> N {
        let push = self.beyond(parameter, position).map(|(beyond, sign)| {
            let push = self.push(parameter, [beyond, velocity * sign]);
            (push, sign)
        });
        push.filter(|(push, _)| push.real() > 0.0)
            .map_or(N::constant(0.0), |(push, sign)| push * sign)
    }

    /// Returns the push of spring and damper on a coordinate beyond a limit, with the rate at which it comes
    /// back; negative where it would pull.
    pub fn push<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        [beyond, back]: [N; 2],
    ) -> N {
        let zero = N::constant(0.0);
        let mut push = self.stiffness.evaluate(parameter, zero) * beyond;
        if let Some(damping) = &self.damping {
            push -= damping.evaluate(parameter, zero) * back;
        }
        push
    }

    /// Returns the energy of its spring.
    pub fn energy<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N, position: N) -> N {
        let zero = N::constant(0.0);
        let beyond = self.beyond(parameter, position);
        beyond.map_or(zero, |(beyond, _)| {
            self.stiffness.evaluate(parameter, zero) * beyond.square() * 0.5
        })
    }
}

impl RegularisedFriction {
    /// Returns the force against a rate of the coordinate.
    fn against<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N, rate: N) -> N {
        let speed = self.speed.evaluate(parameter, N::constant(0.0));
        let dry = self.law.dry(parameter, rate) * (rate / speed).tanh();
        dry + self.law.viscous(parameter) * rate
    }
}

impl Load {
    /// Last parts of the names of a marker's force and torque.
    pub const COMPONENTS: [&str; 3] = ["fx", "fy", "torque"];

    /// Returns the coordinate along which it acts, if there is one.
    #[must_use]
    pub fn coordinate(&self) -> Option<&Coordinate> {
        match self {
            Self::Coordinate { coordinate, .. } | Self::Passive { coordinate, .. } => {
                Some(coordinate)
            }
            Self::Marker { .. } => None,
        }
    }

    /// Gives a component of an input a size, an expression in t and the parameters; those without
    /// one are zero. The force is no input any more.
    pub fn set_component(&mut self, component: usize, size: Expression) {
        match self {
            Self::Coordinate { law, .. } => {
                *law = Some(ForceLaw {
                    value: Some(size),
                    ..ForceLaw::default()
                });
            }
            Self::Passive { .. } => unreachable!("it is no input"),
            Self::Marker { law, .. } => {
                let zero = || Expression::constant(0.0);
                let law = law.get_or_insert_with(|| [zero(), zero(), zero()]);
                law[component] = size;
            }
        }
    }

    /// Returns the size of a force along a coordinate, if the file gives one.
    #[must_use]
    pub fn law(&self) -> Option<&ForceLaw> {
        match self {
            Self::Coordinate { law, .. } => law.as_ref(),
            Self::Passive { .. } | Self::Marker { .. } => None,
        }
    }

    /// Returns the cause of a force that follows from the motion.
    #[must_use]
    pub fn cause(&self) -> Option<&PassiveCause> {
        match self {
            Self::Passive { cause, .. } => Some(cause),
            Self::Coordinate { .. } | Self::Marker { .. } => None,
        }
    }

    /// Returns the law of friction that sticks.
    #[must_use]
    pub fn friction(&self) -> Option<&FrictionLaw> {
        match self.cause() {
            Some(PassiveCause::Friction(law)) => Some(law),
            _ => None,
        }
    }

    /// Returns the joint in which friction acts along a way of its own, no coordinate.
    #[must_use]
    pub fn slides(&self) -> Option<&Bearing> {
        let bearing = self.friction()?.bearing.as_ref();
        bearing.filter(|bearing| bearing.way != SlidingWay::Coordinate)
    }

    /// Returns the part of a description that tells a stop and friction from other forces.
    fn origin(&self) -> &'static str {
        match (self.cause(), self.law()) {
            (Some(PassiveCause::Stop(_)), _) => " of a stop",
            (Some(PassiveCause::Friction(_)), _) => " of friction",
            (_, Some(ForceLaw { stop: Some(_), .. })) => " of a stop",
            (_, Some(law)) if law.friction.is_some() => " of friction",
            _ => "",
        }
    }

    /// Returns the joint whose parts meet, for the force of a joint with play.
    #[must_use]
    pub fn play(&self) -> Option<usize> {
        match self.cause() {
            Some(PassiveCause::Play(joint)) => Some(*joint),
            _ => None,
        }
    }

    /// Returns whether it is that of a contact, which holds its coordinate at a limit.
    #[must_use]
    pub fn is_contact(&self) -> bool {
        self.cause().is_some_and(PassiveCause::is_contact)
    }

    /// Returns whether its size is an FMI input.
    #[must_use]
    pub fn is_input(&self) -> bool {
        match self {
            Self::Coordinate { law, .. } => law.is_none(),
            Self::Passive { .. } => false,
            Self::Marker { law, .. } => law.is_none(),
        }
    }

    /// Returns the number of its components.
    #[must_use]
    pub fn components(&self) -> usize {
        self.variables().len()
    }

    /// Returns the last parts of the names of its FMI variables, with their units.
    #[must_use]
    fn variables(&self) -> Vec<(&'static str, Unit)> {
        match self {
            Self::Coordinate { coordinate, .. } | Self::Passive { coordinate, .. } => {
                vec![("effort", coordinate.kind.effort_unit())]
            }
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
            Self::Passive { cause, .. } => match cause {
                PassiveCause::Stop(_) | PassiveCause::Play(_) => Vec::new(),
                PassiveCause::Friction(law) => law.expressions().collect(),
            },
            Self::Marker { law, .. } => law.iter().flatten().collect(),
        }
    }

    /// Returns the expressions of its size that depend on what moves.
    pub fn moving_expressions(&self) -> impl Iterator<Item = &Expression> {
        let (along, at) = match self {
            Self::Coordinate { law, .. } => (law.as_ref().and_then(|law| law.value.as_ref()), None),
            Self::Passive { .. } => (None, None),
            Self::Marker { law, .. } => (None, law.as_ref()),
        };
        along.into_iter().chain(at.into_iter().flatten())
    }

    /// Returns the number of arguments of functions on whose points its size has corners or jumps.
    #[must_use]
    pub fn corners(&self) -> usize {
        let mut count = 0;
        for expression in self.moving_expressions() {
            expression.visit_corners(&|_| 0.0, &|_| 0.0, &mut |_| count += 1);
        }
        count
    }

    /// Returns the signals on which its size depends, besides its own coordinate; one may come twice.
    pub fn signals(&self) -> impl Iterator<Item = (Signal, Order)> {
        let variables = self.moving_expressions().flat_map(Expression::variables);
        variables.filter_map(|variable| match variable {
            Variable::Signal(signal, order) => Some((signal, order)),
            _ => None,
        })
    }
}

impl Mechanism {
    /// Returns the friction that sticks.
    pub fn frictions(&self) -> impl Iterator<Item = &FrictionLaw> {
        self.forces.iter().filter_map(|force| force.load.friction())
    }

    /// Returns whether friction acts in joints, by their reactions.
    #[must_use]
    pub fn has_joint_friction(&self) -> bool {
        self.frictions().any(|law| law.bearing.is_some())
    }

    /// Returns whether it has contacts of shapes.
    #[must_use]
    pub fn has_contacts(&self) -> bool {
        (self.stops.iter()).any(|stop| stop.coordinate.shapes().is_some())
    }

    /// Returns whether it has dynamics: a body with mass, or a force.
    #[must_use]
    pub fn has_dynamics(&self) -> bool {
        !self.forces.is_empty() || self.bodies.iter().any(Body::has_mass)
    }
}

/// Returns least and largest value for these parameters, infinite without a limit.
pub(super) fn limits<N: Number>(
    limits: [&Option<Expression>; 2],
    parameter: &impl Fn(ParameterId) -> N,
) -> [N; 2] {
    let zero = N::constant(0.0);
    let [least, most] = limits.map(|limit| Some(limit.as_ref()?.evaluate(parameter, zero)));
    [
        least.unwrap_or(N::constant(f64::NEG_INFINITY)),
        most.unwrap_or(N::constant(f64::INFINITY)),
    ]
}

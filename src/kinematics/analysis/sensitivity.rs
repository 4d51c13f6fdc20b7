//! Sensitivity: the derivatives of a motion with respect to drivers and parameters.
//!
//! With Phi(q, t, p) = 0 along a direction in the space of u, u̇, ü and p, the changes of q, q̇ and
//! q̈ solve three systems with the same matrix, by the implicit function theorem:
//!
//! | | |
//! |---|---|
//! | Phi_q δq = δu − Phi_p δp | from Phi = 0 |
//! | Phi_q δq̇ = δu̇ − δΦ̇, with δΦ̇ for δq, δp and δq̇ = 0 | from Eq. 3.6.10 |
//! | Phi_q δq̈ = δü − δΦ̈, with δΦ̈ for δq, δq̇, δp and δq̈ = 0 | from Eq. 3.6.11 |
//!
//! The relations on [`Varied`] numbers give Φ, Φ̇ and Φ̈ with their changes.

use crate::kinematics::block::JacobianFactors;
use crate::kinematics::constraint::Constraint;
use crate::kinematics::error::Error;
use crate::kinematics::model::Model;
use crate::kinematics::newton::Rejected;
use crate::kinematics::path::Rates;
use crate::kinematics::state::{SINGULAR_HERE, State};
use crate::kinematics::system::Target;
use crate::kinematics::variation::{Varied, VariedConfiguration, VariedMechanism, evaluate};
use crate::mechanism::{
    DerivedMeasure, DriverId, Dual, Jet, Mechanism, MotionInForce, Order, ParameterId,
    ProfileAlong, Signal,
};

/// A direction in the space of drivers and parameters.
#[derive(Clone, Debug)]
pub struct Direction {
    /// Changes of value, velocity and acceleration of each driver that is an input
    /// (`value`, `first`, `second`).
    pub drivers: Vec<Jet>,
    /// Changes of all parameters; those of derived ones are not read.
    pub parameters: Vec<f64>,
    /// Change of the time, for prescribed motions.
    pub time: f64,
}

impl Direction {
    /// Returns the direction in which nothing changes.
    #[must_use]
    pub fn zero(mechanism: &Mechanism) -> Self {
        Self {
            drivers: vec![Jet::constant(0.0); mechanism.drivers.len()],
            parameters: vec![0.0; mechanism.parameters.len()],
            time: 0.0,
        }
    }

    /// Returns the direction in which one parameter grows.
    #[must_use]
    pub fn by_parameter(mechanism: &Mechanism, parameter: ParameterId) -> Self {
        let mut direction = Self::zero(mechanism);
        direction.parameters[parameter.index()] = 1.0;
        direction
    }
}

/// The derivative of a motion along a direction.
#[derive(Debug)]
pub struct Sensitivity<'a> {
    at: VariedConfiguration,
    profiles: Vec<ProfileAlong>,
    drivers: Vec<Varied>,
    parameters: Vec<Varied>,
    measures: &'a [Box<dyn Constraint>],
}

impl Sensitivity<'_> {
    /// Returns the changes of a signal's value, velocity and acceleration.
    #[must_use]
    pub fn signal(&self, signal: Signal) -> Jet {
        let varied = self.varied(signal);
        Jet::new(
            varied.value.first(),
            varied.derivatives.map(|derivative| derivative.first()),
        )
    }

    /// Returns the mechanism along the direction.
    pub(in crate::kinematics) fn mechanism(&self) -> VariedMechanism<'_> {
        VariedMechanism {
            bodies: &self.at,
            profiles: &self.profiles,
        }
    }

    /// Returns a driver along the direction.
    pub(in crate::kinematics) fn driver_value(&self, driver: DriverId) -> Varied {
        self.drivers[driver.index()]
    }

    /// Returns a parameter with its change.
    pub(in crate::kinematics) fn parameter_value(&self, parameter: ParameterId) -> Dual {
        self.parameters[parameter.index()].value
    }

    /// Returns the change of a measure that is computed from others.
    #[must_use]
    pub fn derived(&self, measure: &DerivedMeasure) -> f64 {
        let signal = |signal: Signal, order: Order| {
            let varied = self.varied(signal);
            match order {
                Order::Position => varied.value,
                Order::Velocity => varied.derivatives[0],
                Order::Acceleration => varied.derivatives[1],
            }
        };
        let parameter = |id: ParameterId| self.parameter_value(id);
        measure.evaluate(&parameter, &signal).first()
    }

    /// Returns the change of a parameter; the change of a derived one follows from the others.
    #[must_use]
    pub fn parameter(&self, parameter: ParameterId) -> f64 {
        self.parameters[parameter.index()].value.first()
    }

    fn varied(&self, signal: Signal) -> Varied {
        match signal {
            Signal::Body(body, component) => self.at.coordinate(3 * body.index() + component),
            Signal::Marker(marker, component) => self.at.marker(marker).point[component],
            Signal::Measure(index) => self.measures[index].along(&self.mechanism()),
            Signal::Motion(driver) => self.driver_value(driver),
        }
    }
}

impl State {
    /// Returns the derivative of the motion at the pose along a direction. See
    /// [`Solver::sensitivity`](crate::kinematics::Solver::sensitivity).
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] where the pose is singular.
    pub(in crate::kinematics) fn sensitivity<'a>(
        &mut self,
        model: &'a Model,
        rates: &Rates,
        driver_rates: &[Jet],
        direction: &Direction,
    ) -> Result<Sensitivity<'a>, Error> {
        let mut factors = self.factorised(model)?;
        let order = Order::Acceleration;
        let along = self.along(model, &mut factors, rates, driver_rates, direction, order);
        self.keep_factors(model, factors);
        along
    }

    /// Gives the derivatives of the motion at the pose along each of some directions to `each`. See
    /// [`Solver::sensitivities`](crate::kinematics::Solver::sensitivities).
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] where the pose is singular.
    pub(in crate::kinematics) fn sensitivities(
        &mut self,
        model: &Model,
        rates: &Rates,
        driver_rates: &[Jet],
        (directions, order): (&[Direction], Order),
        mut each: impl FnMut(&Sensitivity<'_>),
    ) -> Result<(), Error> {
        let mut factors = self.factorised(model)?;
        let mut all = directions.iter();
        let done = all.try_for_each(|direction| {
            let along = self.along(model, &mut factors, rates, driver_rates, direction, order);
            along.map(|along| each(&along))
        });
        self.keep_factors(model, factors);
        done
    }

    /// Factorises the Jacobian at the pose.
    fn factorised(&mut self, model: &Model) -> Result<JacobianFactors, Error> {
        let mut factors = self.take_factors(model);
        factors
            .factorise(&model.system, &self.at)
            .map_err(|Rejected| SINGULAR_HERE)?;
        Ok(factors)
    }

    /// Returns the derivative of the motion along a direction, up to an order.
    fn along<'a>(
        &self,
        model: &'a Model,
        factors: &mut JacobianFactors,
        rates: &Rates,
        driver_rates: &[Jet],
        direction: &Direction,
        highest: Order,
    ) -> Result<Sensitivity<'a>, Error> {
        let system = &model.system;
        let mechanism = system.mechanism();
        let changes = self.pose.parameters.iter().zip(&direction.parameters);
        let mut parameters: Vec<_> = changes
            .map(|(&value, &along)| Varied::fixed(Dual::new(value, [along])))
            .collect();
        mechanism.derive_parameters(&mut parameters);
        let parameter = |p: ParameterId| parameters[p.index()];

        let time = Varied::variable(Dual::new(self.pose.time, [direction.time]));
        let drivers = mechanism.drivers.iter().enumerate();
        let drivers: Vec<_> = drivers
            .map(|(index, driver)| match driver.motion() {
                Some(motion) => {
                    let mut motion = MotionInForce::new(motion, parameters.len());
                    motion.set_parameters(parameter);
                    motion.evaluate(time)
                }
                None => {
                    let (is, change) = (driver_rates[index], direction.drivers[index]);
                    let dual = |value, along| Dual::new(value, [along]);
                    Varied::new(
                        dual(self.pose.drivers[index], change.value),
                        [
                            dual(is.first(), change.first()),
                            dual(is.second(), change.second()),
                        ],
                    )
                }
            })
            .collect();

        let motion = self.pose.q.iter().zip(rates.velocity());
        let motion = motion
            .zip(rates.acceleration())
            .map(|((&q, &velocity), &acceleration)| [q, velocity, acceleration]);
        let mut at = system.varied();
        system.vary_parameters(&mut at, &parameters, None);
        for (column, motion) in motion.enumerate() {
            let [value, first, second] = motion.map(Dual::constant);
            at.set_coordinate(column, Varied::new(value, [first, second]));
        }
        let profiles = self.at.profiles().iter();
        let profiles: Vec<_> = profiles
            .map(|profile| profile.in_force.along(|p| parameter(p).value.first()))
            .collect();

        let targets: Vec<_> = system
            .equations()
            .iter()
            .map(|equation| match &equation.target {
                Target::Constant(value) => evaluate(value, &parameters),
                Target::Driver(driver) => drivers[driver.index()],
            })
            .collect();
        let mut side = vec![0.0; targets.len()];
        let mut change = vec![0.0; system.unknowns()];
        for order in 0..=highest as usize {
            let rows = system.equations().iter().zip(&targets);
            let varied = VariedMechanism {
                bodies: &at,
                profiles: &profiles,
            };
            for (side, (equation, target)) in side.iter_mut().zip(rows) {
                let error = *target - equation.constraint.along(&varied);
                *side = [error.value, error.first(), error.second()][order].first();
            }
            factors.solve(system, &self.at, &side, &mut change);
            at.change(order, &change);
        }
        if !change.iter().all(|change| change.is_finite()) {
            return Err(SINGULAR_HERE);
        }
        Ok(Sensitivity {
            at,
            profiles,
            drivers,
            parameters,
            measures: &model.measures,
        })
    }
}

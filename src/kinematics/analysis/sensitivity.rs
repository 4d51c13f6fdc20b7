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

use crate::kinematics::constraint::Constraint;
use crate::kinematics::constraint::moving_configuration::{
    Bodies, CurvesAlong, Varied, VariedConfiguration, VariedMechanism, evaluate,
};
use crate::kinematics::error::{Error, NoLimit};
use crate::kinematics::path::Rates;
use crate::kinematics::plan::JacobianFactors;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::singular::{Kind, NearPoint, near_point};
use crate::kinematics::state::{SINGULAR_HERE, State};
use crate::kinematics::system::{EquationTarget, System};
use crate::mechanism::{
    DerivedMeasure, DriverId, Dual, Expression, ForceQuantity, Jet, MarkerId, Mechanism,
    MotionInForce, Order, ParameterId, PrescribedMotion, Signal,
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
    /// Changes of inputs and of the sizes of forces without a law, in the order of
    /// [`Solution::loads`](crate::kinematics::Solution::loads).
    pub loads: Vec<f64>,
}

impl Direction {
    /// Returns the direction in which nothing changes.
    #[must_use]
    pub fn zero(mechanism: &Mechanism) -> Self {
        Self {
            drivers: vec![Jet::constant(0.0); mechanism.drivers.len()],
            parameters: vec![0.0; mechanism.parameters.len()],
            time: 0.0,
            loads: vec![0.0; mechanism.load_places().1],
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
    curves: CurvesAlong,
    drivers: Vec<Varied>,
    parameters: Vec<Varied>,
    time: Dual,
    loads: Vec<f64>,
    measures: &'a [Box<dyn Constraint>],
    /// The file's coordinates of freedoms that are followed in others.
    named: &'a [Option<Box<dyn Constraint>>],
    system: &'a System,
    /// The cause of derivatives that are not numbers, if it is not that of an expression.
    fault: Option<Error>,
}

impl Sensitivity<'_> {
    /// Returns the changes of a signal's value, velocity and acceleration.
    #[must_use]
    pub fn signal(&self, signal: Signal) -> Jet {
        change_of(self.varied(signal))
    }

    /// Returns the changes of a coordinate's value, velocity and acceleration.
    pub(crate) fn coordinate(&self, relation: &dyn Constraint) -> Jet {
        change_of(relation.along(&self.mechanism()))
    }

    /// Returns the rate of a coordinate with its change.
    pub(crate) fn rate(&self, relation: &dyn Constraint) -> Dual {
        relation.along(&self.mechanism()).first()
    }

    /// Returns the mechanism along the direction.
    pub(in crate::kinematics) fn mechanism(&self) -> VariedMechanism<'_, '_> {
        VariedMechanism {
            bodies: &self.at,
            curves: &self.curves,
        }
    }

    /// Returns a driver along the direction.
    pub(in crate::kinematics) fn driver_value(&self, driver: DriverId) -> Varied {
        self.drivers[driver.index()]
    }

    /// Returns a parameter with its change.
    pub(crate) fn parameter_value(&self, parameter: ParameterId) -> Dual {
        self.parameters[parameter.index()].value
    }

    /// Returns all parameters with their changes.
    pub(crate) fn parameter_values(&self) -> Vec<Dual> {
        let all = self.parameters.iter();
        all.map(|parameter| parameter.value).collect()
    }

    /// Returns a measure that is computed from others, with its change, for these forces with their
    /// changes.
    pub(in crate::kinematics) fn derived_value(
        &self,
        measure: &DerivedMeasure,
        force: &impl Fn(ForceQuantity) -> Dual,
    ) -> Dual {
        let signal = |signal: Signal, order: Order| {
            let varied = self.varied(signal);
            match order {
                Order::Position => varied.value,
                Order::Velocity => varied.derivatives[0],
                Order::Acceleration => varied.derivatives[1],
            }
        };
        let parameter = |id: ParameterId| self.parameter_value(id);
        measure.evaluate(&parameter, &signal, force)
    }

    /// Returns the change of a parameter; the change of a derived one follows from the others.
    #[must_use]
    pub fn parameter(&self, parameter: ParameterId) -> f64 {
        self.parameters[parameter.index()].value.first()
    }

    /// Returns the change of an input: that of what gives it, or of the load.
    pub(in crate::kinematics) fn input(&self, index: usize) -> f64 {
        let mechanism = self.system.mechanism();
        let parameter = |id: ParameterId| self.parameter_value(id);
        match &mechanism.inputs[index].given {
            Some(size) => size.evaluate(&parameter, self.time).first(),
            None => self.loads[mechanism.input_place(index)],
        }
    }

    /// Returns the largest scaled change of q, or of the first of its derivatives that changes.
    pub(in crate::kinematics) fn largest_change(&self, size: f64) -> f64 {
        let unknowns = self.system.unknowns();
        let of_order = |order: usize| {
            let changes = (0..unknowns).map(|column| {
                let scale = self.system.column_scale(column, size);
                (self.at.change_of(order, column) / scale).abs()
            });
            changes.fold(0.0, f64::max)
        };
        let mut changes = (0..3).map(of_order);
        changes.find(|change| *change > 0.0).unwrap_or(0.0)
    }

    /// Returns the cause of a derivative that is not finite.
    #[must_use]
    pub fn fault(&self) -> Error {
        let missing = self.missing_derivative();
        missing
            .or_else(|| self.fault.clone())
            .unwrap_or(SINGULAR_HERE)
    }

    /// Returns the error of the first expression without a finite derivative.
    fn missing_derivative(&self) -> Option<Error> {
        let system = self.system;
        let mechanism = system.mechanism();
        let parameters = (mechanism.parameters.iter().zip(&self.parameters))
            .filter(|(parameter, _)| parameter.derived)
            .filter(|(parameter, _)| {
                let mut used = parameter.expression.parameters();
                used.all(|p| has_change(self.parameters[p.index()]))
            })
            .map(|(parameter, value)| {
                let what = format!("parameter `{}`", parameter.name);
                (*value, &parameter.expression, what)
            });
        let markers = (0..mechanism.markers.len()).map(MarkerId).flat_map(|id| {
            let marker = &mechanism.markers[id.index()];
            let ([x, y], angle) = self.at.local(id);
            let what = format!("marker `{}`", mechanism.marker_path(id));
            let [of_x, of_y] = &marker.position;
            [(x, of_x), (y, of_y), (angle, &marker.angle)]
                .map(|(value, expression)| (value, expression, what.clone()))
        });
        let targets = system.equations().iter().filter_map(|equation| {
            let EquationTarget::Constant(expression) = &equation.target else {
                return None;
            };
            let value = evaluate(expression, &self.parameters);
            Some((value, expression, equation.origin.describe(mechanism)))
        });
        let motions = mechanism.drivers.iter().zip(&self.drivers).enumerate();
        let motions = motions.filter_map(|(index, (driver, value))| match driver.motion() {
            Some(PrescribedMotion::Expression(expression)) => {
                let what = format!("the motion of {}", system.describe_driver(DriverId(index)));
                Some((*value, expression, what))
            }
            _ => None,
        });
        let mut all = parameters.chain(markers).chain(targets).chain(motions);
        let (_, expression, what) = all.find(|(value, ..)| !has_change(*value))?;
        Some(self.no_derivative(what, [expression].into_iter()))
    }

    /// Returns the error of expressions without a finite derivative.
    pub(in crate::kinematics) fn no_derivative<'e>(
        &self,
        what: String,
        mut expressions: impl Iterator<Item = &'e Expression>,
    ) -> Error {
        let parameters = &self.system.mechanism().parameters;
        let by = expressions.find_map(|expression| {
            let mut used = expression.parameters();
            used.find(|p| self.parameter_value(*p).first() != 0.0)
        });
        Error::NoDerivative {
            what,
            by: by.map(|p| format!("`{}`", parameters[p.index()].name)),
        }
    }

    fn varied(&self, signal: Signal) -> Varied {
        match signal {
            Signal::Body(body, component) => self.at.coordinate(3 * body.index() + component),
            Signal::Marker(marker, component) => self.at.point(marker)[component],
            Signal::Measure(index) => self.measures[index].along(&self.mechanism()),
            Signal::Motion(driver) => match &self.named[driver.index()] {
                Some(own) => own.along(&self.mechanism()),
                None => self.driver_value(driver),
            },
        }
    }
}

/// Returns the change of a number and of its derivatives along the direction.
fn change_of(number: Varied) -> Jet {
    let changes = number.derivatives.map(|derivative| derivative.first());
    Jet::new(number.value.first(), changes)
}

/// Returns whether a number and its derivatives have finite changes along the direction.
fn has_change(number: Varied) -> bool {
    let changes = [number.value, number.first(), number.second()];
    changes.iter().all(|change| change.first().is_finite())
}

impl State {
    /// Returns the derivative of the motion at the pose along a direction, by the Jacobian there. See
    /// [`Solver::sensitivity`](crate::kinematics::Solver::sensitivity).
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] where the pose is singular.
    pub(in crate::kinematics) fn sensitivity<'a>(
        &mut self,
        compiled: &'a CompiledMechanism,
        rates: &Rates,
        driver_rates: &[Jet],
        direction: &Direction,
    ) -> Result<Sensitivity<'a>, Error> {
        let mut factors = self.factorised(compiled)?;
        let bodies = compiled.system.varied();
        let mut along = self.unsolved(compiled, rates, driver_rates, direction, bodies);
        self.solve_changes(compiled, &mut factors, &mut along, Order::Acceleration);
        self.keep_factors(compiled, factors);
        Ok(along)
    }

    /// Gives the derivatives of the motion at the pose along each of some directions to `each`, by the
    /// Jacobian there, which is factorised once; with the state and the number of the direction.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] where the pose is singular, and those of `each`.
    pub(in crate::kinematics) fn sensitivities_here(
        &mut self,
        compiled: &CompiledMechanism,
        (rates, driver_rates): (&Rates, &[Jet]),
        directions: &[Direction],
        mut each: impl FnMut(&Self, usize, &Sensitivity<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let mut factors = self.factorised(compiled)?;
        let bodies = compiled.system.varied();
        let done = directions
            .iter()
            .enumerate()
            .try_for_each(|(k, direction)| {
                let bodies = bodies.clone();
                let mut along = self.unsolved(compiled, rates, driver_rates, direction, bodies);
                self.solve_changes(compiled, &mut factors, &mut along, Order::Acceleration);
                each(self, k, &along)
            });
        self.keep_factors(compiled, factors);
        done
    }

    /// Gives the derivatives of the motion at the pose along each of some directions to `each`. See
    /// [`Solver::sensitivities`](crate::kinematics::Solver::sensitivities).
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] where the pose is singular, and those of `each`.
    pub(in crate::kinematics) fn sensitivities<'a>(
        &mut self,
        compiled: &'a mut CompiledMechanism,
        rates: &Rates,
        driver_rates: &[Jet],
        sought: (&[Direction], Order),
        mut each: impl FnMut(Sensitivity<'a>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let (directions, order) = sought;
        let near = near_point(compiled, self);
        let motion = (rates, driver_rates);
        let found = near
            .as_ref()
            .and_then(|point| self.interpolated_changes(point, compiled, motion, sought));
        let compiled: &'a CompiledMechanism = compiled;
        let has_all = |found: &Vec<f64>| !found.iter().any(|change| change.is_nan());
        let is_at = near.as_ref().is_some_and(|point| point.is_at);
        let is_solved = !is_at && !found.as_ref().is_some_and(has_all);
        let mut factors = is_solved.then(|| self.factorised(compiled)).transpose()?;
        let unknowns = self.pose.q.len();
        let bodies = compiled.system.varied();
        let done = directions
            .iter()
            .enumerate()
            .try_for_each(|(k, direction)| {
                let bodies = bodies.clone();
                let mut along = self.unsolved(compiled, rates, driver_rates, direction, bodies);
                if let Some(factors) = &mut factors {
                    self.solve_changes(compiled, factors, &mut along, order);
                }
                if let Some(point) = &near {
                    let orders = order as usize + 1;
                    for order in 0..orders {
                        let first = (k * orders + order) * unknowns;
                        let found = found.as_ref().map(|found| &found[first..first + unknowns]);
                        along.at.take_changes(order, |column| {
                            let found = found.map_or(f64::NAN, |found| found[column]);
                            (is_at || !found.is_nan()).then_some(found)
                        });
                    }
                    if is_at {
                        along.fault = Some(point.no_limit(compiled, NoLimit::Derivatives));
                    }
                }
                each(along)
            });
        if let Some(factors) = factors {
            self.keep_factors(compiled, factors);
        }
        done
    }

    /// Returns the changes of q, q̇ and q̈ next to a change point, by direction and order; see
    /// [`NearPoint::interpolate`].
    #[cold]
    fn interpolated_changes(
        &mut self,
        point: &NearPoint,
        compiled: &mut CompiledMechanism,
        (rates, driver_rates): (&Rates, &[Jet]),
        (directions, highest): (&[Direction], Order),
    ) -> Option<Vec<f64>> {
        let (unknowns, orders) = (self.pose.q.len(), highest as usize + 1);
        let size = self.at.size();
        let scales = (0..unknowns).map(|q| compiled.system.column_scale(q, size));
        let scales: Vec<f64> = scales.collect();
        // Radians per second of the fastest body, or one at rest: with it changes of all orders
        // compare, and those that are zero up to rounding are seen to be.
        let largest = |rates: &[f64]| {
            let scaled = rates.iter().zip(&scales);
            scaled.fold(0.0, |most: f64, (rate, scale)| {
                most.max((rate / scale).abs())
            })
        };
        let [first, second] = [rates.velocity(), rates.acceleration()].map(largest);
        let rate = match first.max(second.sqrt()) {
            0.0 => 1.0,
            rate => rate,
        };
        let scale = |index: usize| {
            let order = index / unknowns % orders;
            scales[index % unknowns] * rate.powi(order as i32)
        };
        let scaled = point.interpolate(
            compiled,
            self,
            driver_rates,
            |index| Kind {
                group: index / (unknowns * orders),
                level: index / unknowns % orders,
            },
            |compiled, state, place, values| {
                let mut factors = state.factorised(compiled)?;
                for direction in directions {
                    let (rates, drivers) = (place.rates, place.driver_rates);
                    let bodies = compiled.system.varied();
                    let mut along = state.unsolved(compiled, rates, drivers, direction, bodies);
                    state.solve_changes(compiled, &mut factors, &mut along, highest);
                    for order in 0..orders {
                        values.extend((0..unknowns).map(|q| along.at.change_of(order, q)));
                    }
                }
                state.keep_factors(compiled, factors);
                for (index, value) in values.iter_mut().enumerate() {
                    *value /= scale(index);
                }
                Ok(())
            },
        )?;
        let changes = scaled.iter().enumerate();
        Some(changes.map(|(index, value)| value * scale(index)).collect())
    }

    /// Factorises the Jacobian at the pose.
    fn factorised(&mut self, compiled: &CompiledMechanism) -> Result<JacobianFactors, Error> {
        let mut factors = self.take_factors(compiled);
        let factorised = factors.factorise(&compiled.system, &self.at);
        if factorised.is_err() {
            self.keep_factors(compiled, factors);
            return Err(SINGULAR_HERE);
        }
        Ok(factors)
    }

    /// Returns the motion along a direction, on which the bodies have no changes yet; `at` is a
    /// mechanism on such numbers.
    fn unsolved<'a>(
        &self,
        compiled: &'a CompiledMechanism,
        rates: &Rates,
        driver_rates: &[Jet],
        direction: &Direction,
        mut at: VariedConfiguration,
    ) -> Sensitivity<'a> {
        let system = &compiled.system;
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
        let fixed: Vec<_> = parameters.iter().map(|parameter| parameter.value).collect();
        system.vary_numbers(&mut at, &|number| {
            Some(Varied::fixed(evaluate(number, &fixed)))
        });
        for (column, motion) in motion.enumerate() {
            let [value, first, second] = motion.map(Dual::constant);
            at.set_coordinate(column, Varied::new(value, [first, second]));
        }
        let profiles = self.at.profiles().iter();
        let profiles: Vec<_> = profiles
            .map(|profile| profile.in_force.along(|p| parameter(p).value.first()))
            .collect();
        let mut laws = system.laws();
        for law in &mut laws {
            law.set_parameters(|p| Varied::fixed(parameter(p).value));
        }
        let curves = CurvesAlong { profiles, laws };

        Sensitivity {
            at,
            curves,
            drivers,
            parameters,
            time: Dual::new(self.pose.time, [direction.time]),
            loads: direction.loads.clone(),
            measures: &compiled.measures,
            named: &compiled.named,
            system,
            fault: None,
        }
    }

    /// Solves the changes of q and of its derivatives up to an order.
    fn solve_changes(
        &self,
        compiled: &CompiledMechanism,
        factors: &mut JacobianFactors,
        along: &mut Sensitivity<'_>,
        highest: Order,
    ) {
        let system = &compiled.system;
        let targets: Vec<_> = system
            .equations()
            .iter()
            .map(|equation| match &equation.target {
                EquationTarget::Constant(value) => evaluate(value, &along.parameters),
                EquationTarget::Driver(driver) => along.drivers[driver.index()],
            })
            .collect();
        let mut side = vec![0.0; targets.len()];
        let mut change = vec![0.0; system.unknowns()];
        // Without changes of q, numbers and curves no relation changes.
        let stays = along.curves.is_empty() && !along.at.numbers_change();
        for order in 0..=highest as usize {
            let rows = system.equations().iter().zip(&targets);
            let varied = along.mechanism();
            for (side, (equation, target)) in side.iter_mut().zip(rows) {
                let error = if stays && order == 0 {
                    *target
                } else {
                    *target - equation.constraint.along(&varied)
                };
                *side = [error.value, error.first(), error.second()][order].first();
            }
            if along.fault.is_none()
                && let Some(row) = side.iter().position(|side| !side.is_finite())
            {
                let origin = system.equations()[row].origin;
                along.fault = Some(Error::NoDerivative {
                    what: origin.describe(system.mechanism()),
                    by: None,
                });
            }
            factors.solve(system, &self.at, &side, &mut change);
            along.at.change(order, &change);
            if along.fault.is_none() && !change.iter().all(|change| change.is_finite()) {
                along.fault = Some(SINGULAR_HERE);
            }
        }
    }
}

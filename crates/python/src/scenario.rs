//! Parameters and motions of drivers as a call sets them.

use std::sync::Arc;

use biela::kinematics::{Pose, SolverChoices};
use biela::mechanism::{
    DriverId, DriverSource, Dual, Expression, Jet, Mechanism, Number, Order, ParameterId,
    PrescribedMotion, Taylor, Variable, whole_angles,
};
use biela_tools::cli::{check_parameter, parameter_value, unknown_name};
use pyo3::prelude::*;

use crate::error::Failure;

/// A value of a parameter: a number in the SI unit, or an expression such as `120*mm`.
#[derive(FromPyObject)]
pub(crate) enum Value {
    Number(f64),
    Text(String),
}

/// A motion of a driver: an expression in t, or position, velocity and acceleration at each time.
#[derive(FromPyObject)]
pub(crate) enum Drive {
    Text(String),
    Samples([Vec<f64>; 3]),
}

/// Values of a driver at the times of a run.
#[derive(Clone, Debug)]
pub(crate) struct Samples {
    pub(crate) driver: DriverId,
    orders: [Vec<f64>; 3],
}

impl Samples {
    /// Returns value, velocity and acceleration at a time, by its index.
    pub(crate) fn at(&self, row: usize) -> Jet {
        let [position, velocity, acceleration] = &self.orders;
        Jet::new(position[row], [velocity[row], acceleration[row]])
    }

    /// Takes over value, velocity and acceleration at the times.
    pub(crate) fn take(&mut self, orders: [&[f64]; 3]) {
        let own = self.orders.iter_mut().zip(orders);
        own.for_each(|(own, order)| own.copy_from_slice(order));
    }

    /// Sets the value at a time, by its index.
    pub(crate) fn set(&mut self, row: usize, value: f64) {
        self.orders[0][row] = value;
    }
}

/// The pose of the file's own values, with the solver's choices there.
pub(crate) type Home = (Pose, SolverChoices);

/// A mechanism with the motions of its drivers.
#[derive(Clone, Debug)]
pub(crate) struct Scenario {
    /// The mechanism as its file has it.
    pub(crate) own: Arc<Mechanism>,
    /// The mechanism with the motions of the call; drivers that follow samples are inputs.
    pub(crate) driven: Arc<Mechanism>,
    pub(crate) home: Arc<Home>,
    /// Time at which the motion begins \[s\]: that of the first row, or of the file where freedoms move.
    pub(crate) start: f64,
    /// Times of the rows \[s\], ascending; at least one.
    pub(crate) times: Vec<f64>,
    pub(crate) samples: Vec<Samples>,
    /// Sizes of inputs at the times with their rates, by their places.
    pub(crate) loads: Vec<(usize, [Vec<f64>; 3])>,
}

/// Value or velocity of a freedom at the start \[SI\].
pub(crate) type Start = (DriverId, Order, f64);

/// Place of what a call gives as arrays.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ArrayPlace {
    /// Samples of a driver, by their index.
    Samples(usize),
    /// Sizes of an input of forces, by their index.
    Loads(usize),
}

impl Scenario {
    /// Returns the place of the arrays of a driver or an input of forces of this name, if it has some.
    pub(crate) fn place(&self, name: &str) -> Option<ArrayPlace> {
        let driver = self.own.driver_id(name);
        let samples = self.samples.iter();
        let samples = samples.enumerate().find(|(_, s)| Some(s.driver) == driver);
        let inputs = self.driven.load_inputs();
        let loads = || {
            let mut loads = self.loads.iter();
            loads.position(|(place, _)| inputs[*place].name == name)
        };
        samples
            .map(|(index, _)| ArrayPlace::Samples(index))
            .or_else(|| loads().map(ArrayPlace::Loads))
    }

    /// Returns value, velocity and acceleration at a time, by its index, of a driver that has samples, or
    /// follows inputs that have some.
    pub(crate) fn sample(&self, driver: DriverId, row: usize, parameters: &[f64]) -> Option<Jet> {
        let mut samples = self.samples.iter();
        if let Some(samples) = samples.find(|samples| samples.driver == driver) {
            return Some(samples.at(row));
        }
        let parameter = |id: ParameterId| Jet::constant(parameters[id.index()]);
        self.followed(driver, row, &parameter, |jet| jet)
    }

    /// Returns the change of [`sample`](Self::sample) along a direction of parameters, whose values come
    /// with their changes; zero where samples give it.
    pub(crate) fn change(&self, driver: DriverId, row: usize, parameters: &[Dual]) -> Option<Jet> {
        let constant = |x: f64| Dual::constant(x);
        let parameter = |id: ParameterId| Taylor::new(parameters[id.index()], [constant(0.0); 2]);
        let varied = |jet: Jet| Taylor::new(constant(jet.value), jet.derivatives.map(constant));
        let followed: Taylor<Dual, 2> = self.followed(driver, row, &parameter, varied)?;
        let rates = followed.derivatives.map(|rate| rate.first());
        Some(Jet::new(followed.value.first(), rates))
    }

    /// Returns what a driver follows at a time, by its index, on numbers that are made of jets.
    fn followed<N: Number>(
        &self,
        driver: DriverId,
        row: usize,
        parameter: &impl Fn(ParameterId) -> N,
        number: impl Fn(Jet) -> N,
    ) -> Option<N> {
        let driver = &self.driven.drivers[driver.index()];
        if !driver.is_moved_by_inputs() {
            return None;
        }
        let input = |index: usize| {
            let place = self.driven.input_place(index);
            let mut loads = self.loads.iter();
            let jet = match loads.find(|(load, _)| *load == place) {
                Some((_, [size, first, second])) => Jet::new(size[row], [first[row], second[row]]),
                None => Jet::constant(self.driven.inputs[index].start),
            };
            number(jet)
        };
        driver.followed(parameter, &input, number(Jet::variable(self.times[row])))
    }

    /// Returns warnings of angles that look like degrees.
    pub(crate) fn whole_angles(&self) -> Vec<String> {
        let samples = self.samples.iter().filter_map(|samples| {
            let driver = &self.own.drivers[samples.driver.index()];
            let is_angle = driver.coordinate.kind.is_angle();
            let message = whole_angles(&samples.orders[0]).filter(|_| is_angle)?;
            Some(format!(
                "drive: `{}`: {message}; NumPy has `np.radians`",
                driver.name
            ))
        });
        samples.collect()
    }

    /// Lets freedoms begin elsewhere, or with other velocities, than the file says.
    ///
    /// # Errors
    ///
    /// The motions of the call drive one of them.
    pub(crate) fn set_starts(&mut self, starts: &[Start]) -> Result<(), Failure> {
        for &(freedom, order, value) in starts {
            let driver = &self.driven.drivers[freedom.index()];
            if !driver.is_free() {
                return Err(Failure::Usage(format!(
                    "parameters: the start of `{0}` has no effect: `drive` has an entry for `{0}`",
                    driver.name
                )));
            }
            Arc::make_mut(&mut self.driven).set_start(freedom, order, value);
        }
        Ok(())
    }

    /// Checks that the times are those of a free motion, which begins at the start of the file: without
    /// arrays that begin later, or that have no times.
    fn check_free(&self) -> Result<(), Failure> {
        let refuse = |message: String| Err(Failure::Usage(message));
        let Some(freedom) = self.driven.drivers.iter().find(|driver| driver.is_free()) else {
            return Ok(());
        };
        let (name, start, [first, .., last] | [first @ last]) =
            (&freedom.name, self.start, &*self.times)
        else {
            return Ok(());
        };
        let samples = self.samples.iter().map(|samples| {
            let driver = &self.driven.drivers[samples.driver.index()];
            driver.name.clone()
        });
        let inputs = self.driven.load_inputs();
        let loads = self
            .loads
            .iter()
            .map(|(place, _)| inputs[*place].name.clone());
        let sampled = samples.chain(loads).next();
        if *first < start {
            return refuse(format!(
                "t[0] = {first} is before {start}, the `start` of the file, from which `{name}` moves"
            ));
        }
        match sampled {
            Some(sampled) if *first > start => refuse(format!(
                "t[0] = {first}: `{name}` moves from {start} on, the `start` of the file; give the \
                 values of `{sampled}` from there on"
            )),
            Some(sampled) if self.times.len() > 1 && first >= last => refuse(format!(
                "`{sampled}` has values without times, and `{name}` takes time to move; give `t`"
            )),
            _ => Ok(()),
        }
    }

    /// Applies motions to a mechanism.
    ///
    /// # Errors
    ///
    /// A driver or an expression is unknown, or an array does not fit the times.
    pub(crate) fn new(
        own: &Arc<Mechanism>,
        home: &Arc<Home>,
        times: Vec<f64>,
        drives: Vec<(String, Drive)>,
    ) -> Result<Self, Failure> {
        check_times(&times)?;
        let mut driven = Mechanism::clone(own);
        let mut samples = Vec::new();
        let mut loads: Vec<(String, [Vec<f64>; 3])> = Vec::new();
        let inputs = own.load_inputs();
        for (name, drive) in drives {
            if let Some(place) = inputs.iter().position(|input| input.name == name) {
                let input = &inputs[place];
                match drive {
                    Drive::Text(text) => {
                        let size = expression(own, &text)?;
                        if !driven.give_load(input.target, size) {
                            let message = "is nested too deeply for the motion that follows it";
                            return Err(Failure::Usage(format!("drive: `{name}` {message}")));
                        }
                    }
                    Drive::Samples(orders) => {
                        check_samples(&name, &orders, times.len())?;
                        loads.push((name, orders));
                    }
                }
                continue;
            }
            let Some(driver) = own.driver_id(&name) else {
                let names = own.drivers.iter().map(|d| d.name.as_str());
                let names = names.chain(inputs.iter().map(|input| input.name.as_str()));
                let names: Vec<&str> = names.collect();
                return Err(Failure::Usage(format!(
                    "drive: {}",
                    unknown_name("driver", &name, &names)
                )));
            };
            driven.drivers[driver.index()].follows = None;
            driven.drivers[driver.index()].source = match drive {
                Drive::Text(text) => {
                    DriverSource::Motion(PrescribedMotion::Expression(expression(own, &text)?))
                }
                Drive::Samples(orders) => {
                    check_samples(&name, &orders, times.len())?;
                    let start = orders[0][0];
                    samples.push(Samples { driver, orders });
                    DriverSource::Input { start }
                }
            };
        }
        let start = if driven.has_freedoms() {
            own.simulation.start
        } else {
            times[0]
        };
        let loads = places(&driven, loads);
        let has_array: Vec<bool> = (driven.inputs.iter().enumerate())
            .map(|(index, input)| {
                let place = driven.input_place(index);
                input.given.is_none() && loads.iter().any(|(load, _)| *load == place)
            })
            .collect();
        driven.give_followers(|input| has_array[input], &own.default_parameters(), start);
        let scenario = Self {
            own: Arc::clone(own),
            home: Arc::clone(home),
            start,
            times,
            samples,
            loads,
            driven: Arc::new(driven),
        };
        scenario.check_free()?;
        Ok(scenario)
    }
}

/// Returns the sizes of inputs of forces by their places among those of the driven mechanism.
fn places(driven: &Mechanism, loads: Vec<(String, [Vec<f64>; 3])>) -> Vec<(usize, [Vec<f64>; 3])> {
    let inputs = driven.load_inputs();
    let placed = loads.into_iter().filter_map(|(name, sizes)| {
        let place = inputs.iter().position(|input| input.name == name)?;
        Some((place, sizes))
    });
    placed.collect()
}

/// Returns an expression in t and the parameters.
fn expression(own: &Mechanism, text: &str) -> Result<Expression, Failure> {
    let parsed = own.parse_expression(text, Some(Variable::Time));
    parsed.map_err(|error| Failure::Usage(format!("drive: {}\n  {text}", error.message)))
}

/// Takes the starts of freedoms out of values that are set by name \[SI\].
///
/// # Errors
///
/// An expression is none, or its value is not finite.
pub(crate) fn take_starts(
    own: &Mechanism,
    set: &mut Vec<(String, Value)>,
) -> Result<Vec<Start>, Failure> {
    let known = own.starts_of_freedoms();
    let refuse = |name: &str, why: String| Failure::Usage(format!("parameters: `{name}`: {why}"));
    let mut starts = Vec::new();
    for (name, freedom, order) in known {
        let Some(place) = set.iter().position(|(given, _)| *given == name) else {
            continue;
        };
        let value = match set.remove(place).1 {
            Value::Number(value) => value,
            Value::Text(text) => own
                .parse_expression(&text, None)
                .map_err(|error| refuse(&name, error.message))?
                .value(&own.default_parameters()),
        };
        if !value.is_finite() {
            return Err(refuse(&name, format!("{value} is not finite")));
        }
        starts.push((freedom, order, value));
    }
    Ok(starts)
}

/// Returns all parameters in force for values of some \[SI\].
///
/// # Errors
///
/// A parameter is unknown or derived, or its value is beyond its limits.
pub(crate) fn parameters(own: &Mechanism, set: Vec<(String, Value)>) -> Result<Vec<f64>, Failure> {
    let mut values = own.default_parameters();
    for (name, value) in set {
        let id = parameter(own, &name)?;
        let value = match value {
            Value::Number(value) => check_parameter(own, id, value).map(|()| value),
            Value::Text(text) => parameter_value(own, id, &text),
        };
        values[id.index()] =
            value.map_err(|error| Failure::Usage(format!("parameters: {error}")))?;
    }
    own.derive_parameters(&mut values);
    Ok(values)
}

/// Returns the parameter of a name.
pub(crate) fn parameter(mechanism: &Mechanism, name: &str) -> Result<ParameterId, Failure> {
    mechanism.parameter_id(name).ok_or_else(|| {
        let names: Vec<&str> = mechanism
            .parameters
            .iter()
            .map(|p| p.name.as_str())
            .collect();
        Failure::Usage(format!(
            "parameters: {}",
            unknown_name("parameter", name, &names)
        ))
    })
}

fn check_times(times: &[f64]) -> Result<(), Failure> {
    let refuse = |message: String| Err(Failure::Usage(message));
    if times.is_empty() {
        return refuse("t: there are no times".to_owned());
    }
    if let Some(row) = times.iter().position(|time| !time.is_finite()) {
        return refuse(format!(
            "t[{row}] is {}; expected a finite number",
            times[row]
        ));
    }
    match times.windows(2).position(|pair| pair[1] < pair[0]) {
        Some(row) => refuse(format!(
            "t[{}] = {} is before t[{row}] = {}; expected times in ascending order",
            row + 1,
            times[row + 1],
            times[row]
        )),
        None => Ok(()),
    }
}

fn check_samples(name: &str, orders: &[Vec<f64>; 3], rows: usize) -> Result<(), Failure> {
    for values in orders {
        let count = values.len();
        if count != rows {
            return Err(Failure::Usage(format!(
                "drive: `{name}` has {count} values for {rows} times"
            )));
        }
        if let Some(row) = values.iter().position(|value| !value.is_finite()) {
            return Err(Failure::Usage(format!(
                "drive: `{name}` is {} at t[{row}]; expected a finite number",
                values[row]
            )));
        }
    }
    Ok(())
}

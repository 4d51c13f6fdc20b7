//! The names, units and limits that a page shows once.

use std::f64::consts::TAU;

use serde_json::{Value, json};

use super::ranges::{DriverRange, driver_speeds};
use super::session::Session;
use super::values::{is_told, shown_in};
use biela::mechanism::{BodyId, DriverId, LoadTarget, Mechanism, Parameter, Unit};

impl Session {
    /// Returns what a page shows once: names, units, limits.
    #[must_use]
    pub fn description(&self) -> Value {
        let mechanism = self.mechanism();
        let pose = self.pose();
        let own = &self.own.drivers;
        let drivers = own.iter().enumerate();
        let drivers = drivers.zip(driver_speeds(mechanism, &self.ranges));
        let drivers: Vec<Value> = drivers
            .map(|((index, driver), usual)| {
                let now = self.driver(DriverId(index));
                let kind = driver.coordinate.kind;
                let [(unit, factor), velocity, acceleration] =
                    kind.units().map(|unit| shown_in(unit, self.length));
                json!({
                    "name": driver.name,
                    "description": driver.description,
                    "is_angle": kind.is_angle(),
                    "is_input": driver.motion().is_none(),
                    "is_free": driver.is_free(),
                    "value": now.value,
                    "velocity": now.first(),
                    "acceleration": now.second(),
                    "unit": unit,
                    "factor": factor,
                    "usual_velocity": usual.first(),
                    "velocity_unit": velocity.0,
                    "velocity_factor": velocity.1,
                    "acceleration_unit": acceleration.0,
                    "acceleration_factor": acceleration.1,
                })
            })
            .collect();
        let parameters: Vec<Value> = (mechanism.parameters.iter().zip(&pose.parameters))
            .map(|(parameter, value)| {
                let (unit, factor) = shown_in(parameter.unit.unwrap_or(Unit::ONE), None);
                json!({
                    "name": parameter.name,
                    "description": parameter.description,
                    "is_derived": parameter.derived,
                    "value": value,
                    "default": parameter.default,
                    "min": parameter.min,
                    "max": parameter.max,
                    "slider": slider(parameter),
                    "unit": unit,
                    "factor": factor,
                })
            })
            .collect();
        let mut variables: Vec<Value> = (self.outputs.iter())
            .map(|output| {
                let (unit, factor) = shown_in(output.unit, self.length);
                json!({
                    "name": output.name,
                    "unit": unit,
                    "factor": factor,
                    "is_told": is_told(output),
                })
            })
            .collect();
        let energies = self.energies();
        if energies.is_some() {
            variables.push(json!({
                "name": "energy.total",
                "unit": Unit::JOULE.name.as_str(),
                "factor": 1.0,
                "is_told": false,
            }));
        }
        let largest = largest_load(mechanism, &pose.parameters);
        let loads = self.own.load_inputs().into_iter().enumerate();
        let loads = loads.filter_map(|(place, input)| {
            let load = self.load(place)?;
            // The slider of an input reaches as far as its limits, or some starts.
            let limits = input.limits.iter().flatten();
            let reach = limits.fold(input.start.abs(), |most, limit| most.max(limit.abs()));
            let largest = match input.target {
                LoadTarget::Force(..) => largest,
                LoadTarget::Input(_) if reach > 0.0 => reach,
                LoadTarget::Input(_) => 1.0,
            };
            let is_input = matches!(input.target, LoadTarget::Input(_));
            Some(json!({
                "name": input.name,
                "description": input.description,
                "unit": input.unit.map_or_else(String::new, |unit| unit.name.to_string()),
                "factor": 1.0,
                "value": load,
                "largest": largest,
                "moves": is_input && mechanism.has_followers(place),
            }))
        });
        let loads: Vec<Value> = loads.collect();
        // Prescribed motions have none.
        let range = |range: &Option<DriverRange>| {
            let DriverRange {
                ends,
                turns,
                causes,
            } = range.as_ref()?;
            Some(json!({
                "low": ends[0],
                "high": ends[1],
                "turns": turns,
                "low_end": causes[0],
                "high_end": causes[1],
            }))
        };
        let bodies = mechanism.bodies.iter().map(|body| &*body.name);
        let length = shown_in(Unit::METRE, self.length);
        let ranges = self.ranges.iter().take(own.len()).map(range);
        let ranges: Vec<Option<Value>> = ranges.collect();
        json!({
            "name": mechanism.name,
            "description": mechanism.description,
            "bodies": bodies.collect::<Vec<_>>(),
            "length": { "unit": length.0, "factor": length.1 },
            "warnings": self.warnings,
            "drivers": drivers,
            "parameters": parameters,
            "variables": variables,
            "loads": loads,
            "is_free": self.motion.free().is_some(),
            "energies": energies.as_ref().map_or(&[][..], |energies| energies),
            "uses_time": mechanism.uses_time() || self.motion.free().is_some(),
            "start": mechanism.simulation.start,
            "stop": mechanism.simulation.stop,
            "has_forces": self.motion.solution.forces().is_some(),
            "places": self.layout(),
            "ranges": ranges,
        })
    }
}

/// Returns the end of a load's slider \[N or N m\]: ten times the weight of all bodies.
fn largest_load(mechanism: &Mechanism, parameters: &[f64]) -> f64 {
    let bodies = (0..mechanism.bodies.len()).map(BodyId);
    let weights = bodies.filter_map(|id| mechanism.weight_at(id, parameters));
    let mass: f64 = weights.map(|weight| weight.mass).sum();
    if mass > 0.0 {
        10.0 * 9.81 * mass
    } else {
        100.0
    }
}

/// Returns the ends of a parameter's slider: its limits, or a range in which most mechanisms move.
fn slider(parameter: &Parameter) -> [f64; 2] {
    let value = parameter.default;
    let is_angle = parameter
        .unit
        .is_some_and(|u| u.dimension == Unit::RADIAN.dimension);
    let [low, high] = if is_angle {
        [value - 0.25 * TAU, value + 0.25 * TAU]
    } else if value == 0.0 {
        [-1.0, 1.0]
    } else {
        let ends = [0.25 * value, 2.0 * value];
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    };
    // A limit far away would make the slider coarse.
    let near = |limit: Option<f64>, end: f64, extreme: fn(f64, f64) -> f64| {
        limit.map_or(end, |limit| extreme(limit, end))
    };
    let low = near(parameter.min, low, f64::max);
    let high = near(parameter.max, high, f64::min);
    [low.min(value), high.max(value)]
}

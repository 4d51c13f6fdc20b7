//! A start beside a singular position.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::kinematics::assembly::closure::is_small;
use crate::kinematics::assembly::estimate::go_to_estimate;
use crate::kinematics::error::Error;
use crate::kinematics::path::{DriverPath, Path};
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::solver::Solver;
use crate::kinematics::state::State;
use crate::mechanism::{Driver, Mechanism, shown};

/// Distance of such a start for an angle \[rad\]: far enough for a good condition, near enough for
/// the same motion.
const ANGLE: f64 = PI / 180.0;
/// Largest distance for a length, in sizes of the mechanism.
const LENGTH: f64 = 0.02;

/// Completes the error of an assembly at the mechanism's own values: in a singular position it names
/// a start a little aside at which the mechanism closes and is determined.
#[must_use]
pub fn offer_start(error: Error, mechanism: &Arc<Mechanism>) -> Error {
    match error {
        Error::Singular { rcond, bodies, .. } => Error::Singular {
            rcond,
            bodies,
            aside: find_start(mechanism),
        },
        other => other,
    }
}

/// Returns a driver and its value at such a start, in words. A large mechanism has none: each start
/// takes an assembly.
fn find_start(mechanism: &Arc<Mechanism>) -> Option<String> {
    let home = Path::new(mechanism);
    let (mut compiled, _) = CompiledMechanism::new(Arc::clone(mechanism));
    if !is_small(&compiled.system) {
        return None;
    }
    let mut state = State::new(&compiled.system);
    go_to_estimate(&mut compiled, &mut state, &home).ok()?;
    // A power of ten, which people read at once.
    let length = 10_f64.powf((LENGTH * state.at.size()).log10().floor());
    for (index, driver) in mechanism.drivers.iter().enumerate() {
        let Some(start) = driver.start() else {
            continue;
        };
        let is_angle = driver.coordinate.kind.is_angle();
        let step = if is_angle { ANGLE } else { length };
        for value in [start + step, start - step] {
            let mut path = home.clone();
            path.driver_paths[index] = DriverPath::held(value, start);
            if is_within_limits(driver, value)
                && Solver::assembled(Arc::clone(mechanism), &path).is_ok()
            {
                let value = if is_angle {
                    format!("{} deg", shown(value.to_degrees()))
                } else {
                    format!("{} m", shown(value))
                };
                return Some(format!("{} `{}` at {value}", driver.noun(), driver.name));
            }
        }
    }
    None
}

fn is_within_limits(driver: &Driver, value: f64) -> bool {
    driver.min.is_none_or(|min| min <= value) && driver.max.is_none_or(|max| value <= max)
}

//! Steps of any size keep to the continuous motion, and stop where it ends.

mod accuracy;
mod corners;
mod large_steps;
mod motions;
mod parameters;
mod substeps;

/// q at rounding level: some eps times the condition, 1e-14, in metres and radians below ten.
const SAME_POSE: f64 = 1e-13;

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

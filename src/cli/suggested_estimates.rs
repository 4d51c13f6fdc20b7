//! A pose written as estimates of a mechanism file.

use std::fmt::Write as _;

use crate::mechanism::{Mechanism, rounded};

/// Digits of an estimate after the first: far more than assembly needs, few enough to hide
/// rounding.
const DIGITS: usize = 11;

/// Returns the pose q as lines to paste into a mechanism file.
pub(super) fn as_estimates(mechanism: &Mechanism, q: &[f64]) -> String {
    let mut out = String::new();
    let lengths = q.chunks_exact(3).flat_map(|q| [q[0].abs(), q[1].abs()]);
    let size = lengths.fold(0.0, f64::max);
    for (body, q) in mechanism.bodies.iter().zip(q.chunks_exact(3)) {
        let [x, y] = [q[0], q[1]].map(|length| estimate(length, size));
        let phi = estimate(q[2].to_degrees(), 360.0);
        // Zero needs no unit.
        let phi = if phi == "0" {
            phi
        } else {
            format!("\"{phi}*deg\"")
        };
        let _ = writeln!(out, "[bodies.{}]\nestimate = [{x}, {y}, {phi}]", body.name);
    }
    out
}

/// Formats a number without the rounding at its end.
fn estimate(value: f64, scale: f64) -> String {
    let smallest = scale * 10_f64.powi(-(DIGITS as i32));
    if value.abs() <= smallest {
        return "0".to_owned();
    }
    format!("{}", rounded(value, DIGITS + 1))
}

#[cfg(test)]
mod tests {
    use super::estimate;

    #[test]
    fn numbers_are_short_and_exact_enough() {
        for (value, text) in [
            (59.999_999_999_999_99, "60"),
            (-6e-17, "0"),
            (0.1 + 0.2, "0.3"),
            (41.451_705_977_309_4, "41.4517059773"),
            (-1.5e-7, "-0.00000015"),
        ] {
            assert_eq!(estimate(value, 0.1), text);
        }
    }
}

//! A pose written as estimates of a mechanism file.

use std::fmt::Write as _;

use crate::write::{estimate, largest_coordinate};
use biela::mechanism::Mechanism;

/// Returns the pose q as lines to paste into a mechanism file.
pub(in crate::cli) fn as_estimates(mechanism: &Mechanism, q: &[f64]) -> String {
    let mut out = String::new();
    let size = largest_coordinate(q);
    for (body, q) in mechanism.bodies.iter().zip(q.chunks_exact(3)) {
        let estimate = estimate([q[0], q[1], q[2]], size, |_| None);
        let _ = writeln!(out, "[bodies.{}]\nestimate = {estimate}", body.name);
    }
    out
}

//! Norms of vectors.

/// Returns the larger of two numbers; unlike `f64::max` it keeps a NaN, whichever of them it is.
pub(in crate::kinematics) fn nan_or_larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a >= b { a } else { b }
}

/// Returns the sum of the magnitudes of all entries.
pub(super) fn norm1(v: &[f64]) -> f64 {
    v.iter().map(|value| value.abs()).sum()
}

/// Returns the index of the entry of largest magnitude.
pub(super) fn largest_entry(v: &[f64]) -> usize {
    let mut largest_entry = 0;
    for (k, value) in v.iter().enumerate() {
        if value.abs() > v[largest_entry].abs() {
            largest_entry = k;
        }
    }
    largest_entry
}

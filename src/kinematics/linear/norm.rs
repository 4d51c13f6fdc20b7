//! Norms of vectors.

/// The larger of two numbers; unlike `f64::max` it keeps a NaN, wherever it stands.
pub(in crate::kinematics) fn nan_or_larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a >= b { a } else { b }
}

/// The sum of the magnitudes of all entries.
pub(super) fn norm1(v: &[f64]) -> f64 {
    v.iter().map(|value| value.abs()).sum()
}

/// The place of the entry of largest magnitude.
pub(super) fn steepest(v: &[f64]) -> usize {
    let mut steepest = 0;
    for (k, value) in v.iter().enumerate() {
        if value.abs() > v[steepest].abs() {
            steepest = k;
        }
    }
    steepest
}

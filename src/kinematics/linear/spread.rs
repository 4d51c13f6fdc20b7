//! Numbers without a pattern.

/// Returns the k-th of a sequence of numbers from 0 to 1 that the golden ratio spreads evenly,
/// however many are taken.
pub(in crate::kinematics) fn spread(k: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    (GOLDEN * k as f64).fract()
}

//! Sizes that are measured.

/// Steps per turn: fine, by degrees, coarse.
pub const SWEEPS: [u32; 3] = [10_000, 360, 100];
/// Cells of the scissor lift that is set up: ten bodies.
pub const TEN_BODIES: usize = 5;

/// Loops of a chain.
#[must_use]
pub fn chain() -> Vec<usize> {
    up_to_largest(&[1, 10, 100, 1_000, 10_000])
}

/// Cells of a scissor lift.
#[must_use]
pub fn lift() -> Vec<usize> {
    up_to_largest(&[1, 2, 4, 8, 16, 32, 64, 128])
}

/// Loops of a chain that is set up.
#[must_use]
pub fn set_up() -> Vec<usize> {
    up_to_largest(&[1, 10, 100, 1_000])
}

/// Returns the sizes up to the number in the environment variable `BIELA_BENCH_LARGEST`, all of
/// them without one.
fn up_to_largest(sizes: &[usize]) -> Vec<usize> {
    let given = std::env::var("BIELA_BENCH_LARGEST").ok();
    let largest = given.map(|text| text.parse().expect("BIELA_BENCH_LARGEST is a number"));
    let within = |n: &usize| largest.is_none_or(|largest| *n <= largest);
    sizes.iter().copied().filter(within).collect()
}

//! Which sizes are measured.

/// Loops of a chain.
pub const CHAIN: [usize; 5] = [1, 10, 100, 1_000, 10_000];
/// Cells of a scissor lift.
pub const LIFT: [usize; 8] = [1, 2, 4, 8, 16, 32, 64, 128];
/// Loops of a chain that is set up.
pub const SET_UP: [usize; 4] = [1, 10, 100, 1_000];
/// Cells of the scissor lift that is set up: ten bodies.
pub const TEN_BODIES: usize = 5;

/// Those that biela is asked for: all of them, or up to the number in the environment variable
/// `BIELA_BENCH_LARGEST`.
fn up_to_largest(sizes: &[usize]) -> Vec<usize> {
    let given = std::env::var("BIELA_BENCH_LARGEST").ok();
    let largest = given.map(|text| text.parse().expect("BIELA_BENCH_LARGEST is a number"));
    let within = |n: &usize| largest.is_none_or(|largest| *n <= largest);
    sizes.iter().copied().filter(within).collect()
}

/// Chains that biela steps.
#[must_use]
pub fn chain() -> Vec<usize> {
    up_to_largest(&CHAIN)
}

/// Scissor lifts that biela steps.
#[must_use]
pub fn lift() -> Vec<usize> {
    up_to_largest(&LIFT)
}

/// Chains that biela sets up.
#[must_use]
pub fn set_up() -> Vec<usize> {
    up_to_largest(&SET_UP)
}

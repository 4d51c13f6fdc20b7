//! Which sizes are measured.

/// Loops of a chain.
pub const CHAIN: [usize; 5] = [1, 10, 100, 1_000, 10_000];
/// Cells of a scissor lift.
pub const LIFT: [usize; 8] = [1, 2, 4, 8, 16, 32, 64, 128];
/// Loops of a chain that is set up.
pub const SET_UP: [usize; 4] = [1, 10, 100, 1_000];
/// Cells of the scissor lift that is set up: ten bodies.
pub const TEN_BODIES: usize = 5;

/// The largest sizes that biela is asked for: a dense solver's time
/// grows as the cube.
const LARGEST: Largest = Largest {
    chain: 10,
    lift: 8,
    set_up: 10,
};

struct Largest {
    chain: usize,
    lift: usize,
    set_up: usize,
}

/// The environment variable `BIELA_BENCH_LARGEST` replaces all three.
fn up_to(sizes: &[usize], largest: usize) -> Vec<usize> {
    let given = std::env::var("BIELA_BENCH_LARGEST").ok();
    let largest = given
        .map(|text| text.parse().expect("BIELA_BENCH_LARGEST is a number"))
        .unwrap_or(largest);
    sizes.iter().copied().filter(|n| *n <= largest).collect()
}

/// Chains that biela steps.
#[must_use]
pub fn chain() -> Vec<usize> {
    up_to(&CHAIN, LARGEST.chain)
}

/// Scissor lifts that biela steps.
#[must_use]
pub fn lift() -> Vec<usize> {
    up_to(&LIFT, LARGEST.lift)
}

/// Chains that biela sets up.
#[must_use]
pub fn set_up() -> Vec<usize> {
    up_to(&SET_UP, LARGEST.set_up)
}

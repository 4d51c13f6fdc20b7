//! Pendulums against elliptic functions.

use std::f64::consts::{FRAC_PI_2, PI};

use super::run::{Fed, assert_follows, assert_follows_in, times};
use crate::common::{parse, shipped};

const GRAVITY: f64 = 9.81;

/// Modulus k of elliptic functions, with √(1 − k²).
#[derive(Clone, Copy)]
struct Modulus {
    k: f64,
    complement: f64,
}

impl Modulus {
    fn of_angle(angle: f64) -> Self {
        let (k, complement) = angle.sin_cos();
        Self { k, complement }
    }
}

/// Arithmetic-geometric mean of 1 and √(1 − k²): the means and half differences, down to rounding.
fn means(modulus: Modulus) -> Vec<[f64; 2]> {
    let mut b = modulus.complement;
    let mut means = vec![[1.0, modulus.k]];
    while let Some(&[a, c]) = means.last()
        && c > 1e-17
        && means.len() < 12
    {
        means.push([0.5 * (a + b), 0.5 * (a - b)]);
        b = (a * b).sqrt();
    }
    means
}

/// Complete elliptic integral of the first kind.
fn complete(k: Modulus) -> f64 {
    let means = means(k);
    FRAC_PI_2 / means[means.len() - 1][0]
}

/// Jacobi's amplitude am(u, k), which counts turns (Abramowitz, Stegun, 16.4).
fn amplitude(u: f64, k: Modulus) -> f64 {
    let means = means(k);
    let last = means.len() - 1;
    let mut phi = 2.0_f64.powi(i32::try_from(last).expect("few")) * means[last][0] * u;
    for [a, c] in means[1..].iter().rev() {
        phi = 0.5 * (phi + (c * phi.sin() / a).asin());
    }
    phi
}

/// Angle and rate of a pendulum that is let go at an angle: sin(φ/2) = k sn(ω t + K).
pub(super) fn swinging(omega: f64, start: f64, t: f64) -> Vec<f64> {
    let modulus = Modulus::of_angle(0.5 * start);
    let am = amplitude(omega * t + complete(modulus), modulus);
    let k = modulus.k;
    vec![2.0 * (k * am.sin()).asin(), 2.0 * k * omega * am.cos()]
}

/// k = 2 ω/v.
fn faster(omega: f64, speed: f64) -> Modulus {
    let k = 2.0 * omega / speed;
    Modulus {
        k,
        complement: ((1.0 - k) * (1.0 + k)).sqrt(),
    }
}

/// Angle and rate of a pendulum that passes its lowest position fast enough to turn over:
/// φ = 2 am(v t/2, 2 ω/v).
pub(super) fn turning(omega: f64, speed: f64, t: f64) -> Vec<f64> {
    let modulus = faster(omega, speed);
    let am = amplitude(0.5 * speed * t, modulus);
    let dn = am.cos().hypot(modulus.complement * am.sin());
    vec![2.0 * am, speed * dn]
}

/// Angle and rate of a pendulum that passes its highest position at a speed: as above, a quarter of
/// a period later.
pub(super) fn turning_from_above(omega: f64, speed: f64, t: f64) -> Vec<f64> {
    let below = (speed * speed + 4.0 * omega * omega).sqrt();
    let quarter = 2.0 * complete(faster(omega, below)) / below;
    turning(omega, below, t + quarter)
}

/// A point mass of 1 kg on a rod of this length at a pivot.
fn text(length: f64, pivot: [f64; 2], start: f64, velocity: f64) -> String {
    let [x, y] = pivot;
    format!(
        "format = 1\nname = \"pendulum\"\n[ground.markers]\nO = [{x}, {y}, \"-90*deg\"]\n\
         [bodies.rod]\nmarkers = {{ O = [0, 0], P = [{length}, 0] }}\n\
         estimate = [{x}, {y}, {}]\nmass = 1\ncenter = [{length}, 0]\n\
         [joints]\nO = {{ type = \"revolute\", markers = [\"ground.O\", \"rod.O\"] }}\n\
         [freedoms]\nswing = {{ coordinate = \"angle\", markers = [\"ground.O\", \"rod.O\"], \
         start = {start}, velocity = {velocity} }}\n",
        start - FRAC_PI_2
    )
}

/// Small and large amplitudes, sizes from a micrometre to a kilometre, three periods each.
#[test]
fn pendulums_swing_by_elliptic_functions() {
    for length in [1e-6, 1.0, 1e3] {
        for start in [1e-3, 0.5, 2.0, 3.1] {
            let mechanism = parse(&text(length, [0.0, 0.0], start, 0.0));
            let omega = (GRAVITY / length).sqrt();
            let period = 4.0 * complete(Modulus::of_angle(0.5 * start)) / omega;
            let times = times(3.0 * period, 30);
            // Errors of velocities in the pendulum's own unit of time.
            assert_follows_in(
                [1.0, omega.max(1.0)],
                &format!("pendulum {length} m, {start} rad"),
                &mechanism,
                Fed::default(),
                &times,
                |index| swinging(omega, start, times[index]),
                GRAVITY * length * (1.0 - start.cos()),
            );
        }
    }
}

#[test]
fn pendulums_turn_over_by_elliptic_functions() {
    for length in [1e-6, 1.0, 1e3] {
        let omega = (GRAVITY / length).sqrt();
        for ratio in [2.001, 3.0] {
            let speed = ratio * omega;
            let mechanism = parse(&text(length, [0.0, 0.0], 0.0, speed));
            let times = times(12.0 / omega, 24);
            assert_follows(
                &format!("turning {length} m, {ratio} ω"),
                &mechanism,
                Fed::default(),
                &times,
                |index| turning(omega, speed, times[index]),
                0.5 * (speed * length).powi(2),
            );
        }
    }
}

/// The pivot is a kilometre off: the rounding of a place, 1e-13 m, is 1e-13 rad of the rod.
#[test]
fn a_pendulum_swings_far_from_the_origin() {
    let start = 2.0;
    let mechanism = parse(&text(1.0, [1e3, -1e3], start, 0.0));
    let omega = GRAVITY.sqrt();
    let times = times(6.0, 24);
    assert_follows(
        "pendulum far away",
        &mechanism,
        Fed::default(),
        &times,
        |index| swinging(omega, start, times[index]),
        GRAVITY * (1.0 - start.cos()),
    );
}

/// The shipped rod of 0.5 m: ω² = m g a/(I + m a²) with a the half of its length.
#[test]
fn the_shipped_pendulum_has_its_period() {
    let start = 2.0 * PI / 3.0;
    let omega = (1.5_f64 * GRAVITY / 0.5).sqrt();
    let period = 4.0 * complete(Modulus::of_angle(0.5 * start)) / omega;
    assert!((period - 1.590).abs() < 5e-4, "as its comment says");
    let times = times(4.0, 40);
    assert_follows(
        "pendulum_free",
        &shipped("pendulum_free"),
        Fed::default(),
        &times,
        |index| swinging(omega, start, times[index]),
        1.2 * GRAVITY * 0.25 * (1.0 - start.cos()),
    );
}

//! Instant centres of velocity.

use crate::kinematics::path::Rates;
use crate::kinematics::state::State;
use crate::mechanism::BodyId;

/// The instant centre of a body and ground: the point of the body's plane whose velocity is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InstantCentre {
    /// A point, in ground axes \[m\].
    At([f64; 2]),
    /// The body translates.
    AtInfinity,
    /// The body is at rest, and each of its points an instant centre.
    AtRest,
}

/// Distance of an instant centre, in sizes of the mechanism, beyond which a rotation is taken for
/// the rounding of a translation: 1e-16 divided by a reciprocal condition of 1e-7, a thousandth of
/// those that `check` warns of.
const FARTHEST: f64 = 1e9;

/// Returns the instant centre of one of the mechanism's bodies for rates of the state's pose.
pub(in crate::kinematics) fn instant_centre(
    state: &State,
    bodies: usize,
    body: BodyId,
    rates: &Rates,
) -> InstantCentre {
    let size = state.at.size();
    let of_body = |values: &[f64], body: usize| [0, 1, 2].map(|k| values[3 * body + k]);
    // The speed of a body as that of a point about one size from its origin.
    let speed = |[vx, vy, omega]: [f64; 3]| f64::hypot(vx, vy).max(size * omega.abs());
    let fastest = (0..bodies).map(|body| speed(of_body(rates.velocity(), body)));
    let fastest = fastest.fold(0.0, f64::max);
    let [x, y, _] = of_body(&state.pose.q, body.index());
    let [vx, vy, omega] = of_body(rates.velocity(), body.index());
    if speed([vx, vy, omega]) * FARTHEST <= fastest {
        InstantCentre::AtRest
    } else if omega.abs() * size * FARTHEST <= f64::hypot(vx, vy) {
        InstantCentre::AtInfinity
    } else {
        // v + ω × (P − r) = 0.
        InstantCentre::At([x - vy / omega, y + vx / omega])
    }
}

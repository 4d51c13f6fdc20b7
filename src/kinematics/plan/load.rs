//! Forces and moments on bodies, as `side` of Phi_qᵀ λ = `side` holds them: per body the x and y of
//! the force, then the moment about the origin of its frame.

use nalgebra::Vector2;

/// Returns the force on a body and its moment about the end of `arm`, which starts at the body's
/// origin.
#[inline(always)]
pub(super) fn load_about(side: &[f64], body: usize, arm: Vector2<f64>) -> (Vector2<f64>, f64) {
    let load = &side[3 * body..3 * body + 3];
    let force = Vector2::new(load[0], load[1]);
    (force, load[2] - arm.perp(&force))
}

/// Adds a force on a body that acts at the end of `arm`.
#[inline(always)]
pub(super) fn add_force(side: &mut [f64], body: usize, arm: Vector2<f64>, force: Vector2<f64>) {
    let load = &mut side[3 * body..3 * body + 3];
    load[0] += force.x;
    load[1] += force.y;
    load[2] += arm.perp(&force);
}

/// Adds a moment on a body.
#[inline(always)]
pub(super) fn add_moment(side: &mut [f64], body: usize, moment: f64) {
    side[3 * body + 2] += moment;
}

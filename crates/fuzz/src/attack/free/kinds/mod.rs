//! The kinds of mechanisms that move freely.

mod bouncing;
mod cams;
mod friction;
mod linkages;
mod pendulums;
mod plays;

use super::case::Case;
use super::text::Text;
use crate::mutation::Chance;

/// Draws a mechanism into an empty text.
pub type Draw = fn(&mut Chance, Text) -> Case;

/// Refusals where driven parts meet stops or each other.
const STOPS: &[&str] = &["stop `", "no freedom moves them"];
/// Refusals where joints with friction jam.
const JAMS: &[&str] = &["jams", "neither sticks nor slides", "stop `"];
/// Refusals of linkages at change points, where a coordinate has no limit.
const DEAD_POINTS: &[&str] = &[
    "dead point",
    "assembly modes meet",
    "jams",
    "neither sticks nor slides",
];

/// The kinds with their names.
pub const FREE_KINDS: [(&str, Draw); 20] = [
    ("vibrating_table", bouncing::vibrating_table),
    ("row_of_masses", bouncing::row_of_masses),
    ("elastic_row", bouncing::elastic_row),
    ("friction_plate", friction::friction_plate),
    ("rubbing_blocks", friction::rubbing_blocks),
    ("stick_slip", friction::stick_slip),
    ("driven_arm", friction::driven_arm),
    ("pusher", friction::pusher),
    ("lifting_cam_tappet", cams::cam_tappet),
    ("lifting_cam_arm", cams::cam_arm),
    ("backlash", plays::backlash),
    ("rack_play", plays::rack_play),
    ("ball_on_ropes", plays::ball_on_ropes),
    ("hoist", plays::hoist),
    ("pendulum_obstacles", pendulums::pendulum_obstacles),
    ("cradle", pendulums::cradle),
    ("chain", pendulums::chain),
    ("free_four_bar", linkages::four_bar),
    ("free_slider_crank", linkages::slider_crank),
    ("dead_points", linkages::dead_points),
];

/// Returns a number whose logarithm is drawn.
fn log_between(chance: &mut Chance, low: f64, high: f64) -> f64 {
    chance.between(low.ln(), high.ln()).exp()
}

/// Returns whether something of this probability is so.
fn is(chance: &mut Chance, probability: f64) -> bool {
    chance.between(0.0, 1.0) < probability
}

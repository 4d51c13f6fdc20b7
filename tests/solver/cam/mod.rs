//! Cams: their contact, contours of any kind, and contours that a follower cannot follow.

mod contact;
mod contours;
mod misfits;
mod moving;

use crate::common::{assembled, parse};
use biela::kinematics::Solver;
use biela::mechanism::Mechanism;

fn follower_height(solver: &Solver, mechanism: &Mechanism) -> f64 {
    let follower = mechanism.body_id("follower").expect("it has one");
    solver.pose().q[3 * follower.index() + 1]
}

/// A shipped cam with another contour.
fn with_profile(name: &str, profile: &str) -> Solver {
    assembled(&parse(&text_with_profile(name, profile))).0
}

fn text_with_profile(name: &str, profile: &str) -> String {
    let path = format!("{}/mechanisms/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("shipped mechanisms can be read");
    let start = text.find("profile = ").expect("it has a profile");
    let quoted = text[start..].match_indices('"').nth(1);
    let end = start + quoted.expect("it is a text").0 + 1;
    text.replace(&text[start..end], &format!("profile = {profile}"))
}

//! A cam in reach of its follower and one that is not.

use std::f64::consts::PI;

use crate::Expected::{Closes, NotFound};
use crate::mechanisms::{across, cranked};
use crate::{Case, case};

/// A follower on an arm of 1 about (`pivot`, 0) and a cam of radius 1 about the origin.
fn cam_and_arm(pivot: f64) -> String {
    cranked(
        &format!("P = [{pivot}, 0]"),
        "O = [0, 0]",
        0.0,
        &[("arm", "P = [0, 0], tip = [1, 0]", "0, 0, 2")],
        r#"P = { type = "revolute", markers = ["ground.P", "arm.P"] }
contact = { type = "cam", markers = ["crank.O", "arm.tip"], follower = "knife", profile = "1 + 0*theta" }"#,
    )
}

pub(crate) fn cases() -> Vec<Case> {
    vec![
        case(
            "a cam in reach",
            cam_and_arm(1.5),
            Closes(vec![("arm.phi", PI - across(1.0, 1.0, 1.5))]),
        ),
        // 5 less both radii; there is no closed form for contours.
        case(
            "a cam out of reach",
            cam_and_arm(5.0),
            NotFound(vec![("joint `contact`", 3.0, 0.0)]),
        ),
    ]
}

//! Two loops on one crank, one of which may be open.

use crate::verdicts::Expected::{Closes, Impossible};
use crate::verdicts::mechanisms::cranked;
use crate::verdicts::{Case, case};

/// Two loops on one crank of 1, upright: rockers of 1 about (2, 0) and (−2, 0), √5 from its tip.
fn two_loops(right: f64, left: f64) -> String {
    cranked(
        "P = [2, 0]\nQ = [-2, 0]",
        "O = [0, 0], A = [1, 0]",
        90.0,
        &[
            (
                "coupler_1",
                &format!("A = [0, 0], B = [{right}, 0]"),
                "0, 0, 0",
            ),
            ("rocker_1", "P = [0, 0], B = [1, 0]", "2, 0, 1"),
            (
                "coupler_2",
                &format!("A = [0, 0], B = [{left}, 0]"),
                "0, 0, 3",
            ),
            ("rocker_2", "Q = [0, 0], B = [1, 0]", "-2, 0, 2"),
        ],
        r#"A1 = { type = "revolute", markers = ["crank.A", "coupler_1.A"] }
B1 = { type = "revolute", markers = ["coupler_1.B", "rocker_1.B"] }
P = { type = "revolute", markers = ["ground.P", "rocker_1.P"] }
A2 = { type = "revolute", markers = ["crank.A", "coupler_2.A"] }
B2 = { type = "revolute", markers = ["coupler_2.B", "rocker_2.B"] }
Q = { type = "revolute", markers = ["ground.Q", "rocker_2.Q"] }"#,
    )
}

pub(crate) fn cases() -> Vec<Case> {
    let root = 5_f64.sqrt();
    vec![
        case(
            "two loops that close",
            two_loops(2.0, 2.0),
            Closes(vec![("rocker_1.x", 2.0), ("rocker_2.x", -2.0)]),
        ),
        // The other one closes, and is not spoken of.
        case(
            "the first of two loops open",
            two_loops(1.0, 2.0),
            Impossible(1, vec![("joint `P`", root - 2.0, 0.0)]),
        ),
        case(
            "the second of two loops open",
            two_loops(2.0, 1.1),
            Impossible(1, vec![("joint `Q`", root - 2.1, 0.0)]),
        ),
        case(
            "both loops open",
            two_loops(1.0, 1.1),
            Impossible(
                1,
                vec![
                    ("joint `P`", root - 2.0, 0.0),
                    ("joint `Q`", root - 2.1, 0.0),
                ],
            ),
        ),
    ]
}

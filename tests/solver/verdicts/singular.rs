//! Mechanisms that close in a singular position, or nearly.

use std::f64::consts::TAU;

use biela::kinematics::Reason;

use crate::common::mechanisms::four_bar;
use crate::verdicts::Expected::{GivenUp, NearlySingular, Singular};
use crate::verdicts::mechanisms::{cranked, linked, upright};
use crate::verdicts::{Case, case};

pub(crate) fn cases() -> Vec<Case> {
    let root = 5_f64.sqrt();
    vec![
        // The longest that coupler and rocker span is 1e-9 more than the √5 between their ends:
        // cos of half the angle at B is 1 − 1e-9/√5, so that the sine between the links, which
        // the condition is, is √(8·1e-9/√5).
        case(
            "links nearly in line",
            upright([1.0, 1.0, root - 1.0 + 1e-9, 2.0], 90.0),
            NearlySingular((8e-9 / root).sqrt()),
        ),
        // The ends of coupler and rocker are 1.9997 to 1.9999 apart, so that the sine between them is
        // sin 2 acos 0.99985 = 0.035 to sin 2 acos 0.99995 = 0.02, whatever the crank's angle. Where
        // they are farther from their line, the path is only too long.
        case(
            "a million turns beside a dead point",
            upright([1e-4, 1.0, 1.0, 1.9998], 90.0),
            GivenUp(1e6 * TAU, Reason::NearSingular),
        ),
        case(
            "a million turns far from dead points",
            upright([1e-4, 1.0, 1.0, 1.5], 90.0),
            GivenUp(1e6 * TAU, Reason::TooLong),
        ),
        case(
            "a parallelogram laid flat",
            four_bar(
                [1.0, 2.0, 1.0, 2.0],
                "0*deg",
                ["0, 0, 0", "1, 0, 0", "2, 0, 0"],
            ),
            Singular,
        ),
        case(
            "links that only just reach",
            upright([1.0, 2.0, 2.0, 3.0], 180.0),
            Singular,
        ),
        case(
            "a link that only just reaches",
            linked(17_f64.sqrt() + 2.0, 90.0, ["0, 0, 1", "4, 0, 1.5"]),
            Singular,
        ),
        // Equal links between a tip and a pivot in the same place turn freely.
        case(
            "a coupler and a rocker on top of each other",
            upright([2.0, 1.0, 1.0, 2.0], 0.0),
            Singular,
        ),
        case(
            "a slot whose pin is on its pivot",
            cranked(
                "P = [1, 0]",
                "O = [0, 0], A = [1, 0]",
                0.0,
                &[("lever", "P = [0, 0]", "0, 0, 0")],
                r#"P = { type = "revolute", markers = ["ground.P", "lever.P"] }
slot = { type = "slot", markers = ["lever.P", "crank.A"] }"#,
            ),
            Singular,
        ),
    ]
}

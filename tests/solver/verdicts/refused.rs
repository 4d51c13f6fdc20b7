//! Files that are refused before anything is assembled.

use crate::common::mechanisms::four_bar;
use crate::verdicts::Expected::Refused;
use crate::verdicts::mechanisms::{linked, triangle, upright};
use crate::verdicts::{Case, case};

pub(crate) fn cases() -> Vec<Case> {
    vec![
        case(
            "a link of no length",
            linked(0.0, 90.0, ["0, 0, 1", "4, 0, 1.5"]),
            Refused("`length` must be positive, is 0"),
        ),
        case(
            "a distance driven below zero",
            triangle("-5", ["0, 0, 1", "4, 0, 2", "0, 3, 2"])
                .replace("coordinate = \"x\"", "coordinate = \"distance\""),
            Refused("the `start` of a distance must be positive, is -5"),
        ),
        case(
            "a motion without a value",
            upright([1.0, 2.0, 1.0, 2.0], 60.0)
                .replace("start = \"60*deg\"", "motion = \"sqrt(t - 1)\""),
            Refused(
                "at t = 0, the value of `sqrt(t - 1)` is not finite with the file's parameters",
            ),
        ),
        case(
            "an estimate without a value",
            four_bar(
                [1.0, 2.0, 1.0, 2.0],
                "60*deg",
                ["0, 0, 1", "0, 0, 0", "0, 0, \"1/(1 - 1)\""],
            ),
            Refused("`1/(1 - 1)` is not a finite number"),
        ),
    ]
}

//! Mechanisms that are proved not to close, with their gaps.

use crate::common::mechanisms::slider_crank;
use crate::verdicts::Expected::Impossible;
use crate::verdicts::mechanisms::{
    CROSSED, ON_LINE, PARALLEL, cranked, driven_at_the_coupler, lever, linked, middle_when_crossed,
    six_bar, triangle, upright,
};
use crate::verdicts::{Case, case};

pub(crate) fn cases() -> Vec<Case> {
    let one = |element, gap| Impossible(1, vec![(element, gap, 0.0)]);
    let crossed = middle_when_crossed();
    let far = |middle: [f64; 2], height: f64| (middle[0] - 1.5).hypot(middle[1] - height);
    vec![
        // The crank's tip (0, 1) is √5 from (2, 0).
        case(
            "links too short",
            upright([1.0, 1.0, 1.0, 2.0], 90.0),
            one("joint `O4`", 5_f64.sqrt() - 2.0),
        ),
        case(
            "a rocker too long",
            upright([1.0, 1.0, 4.0, 2.0], 90.0),
            one("joint `O4`", 3.0 - 5_f64.sqrt()),
        ),
        case(
            "a coupler too long, the crank's tip on the rocker's pivot",
            upright([2.0, 3.0, 1.0, 2.0], 0.0),
            one("joint `O4`", 2.0),
        ),
        // Beyond its dead point: a tip at 170° is √(1 + 4 + 4 cos 10°) from (2, 0).
        case(
            "a driver out of range",
            upright([1.0, 1.5, 1.2, 2.0], 170.0),
            one(
                "joint `O4`",
                (5.0 + 4.0 * 10_f64.to_radians().cos()).sqrt() - 2.7,
            ),
        ),
        // The tip (0, 1) is 3 below the guide, the rod is 2 long.
        case(
            "a guide out of reach",
            slider_crank([1.0, 2.0], 4.0, "90*deg", ["0, 0, 1", "0, 0, 0", "1, 0, 0"]),
            one("joint `guide`", 1.0),
        ),
        // The third side is between 1 and 7.
        case(
            "a side of a triangle too long",
            triangle("10", ["0, 0, 1", "4, 0, 2", "0, 3, 2"]),
            one("driver `side`", 3.0),
        ),
        // From the tip (0, 1) it is √17 ± 2 to the rocker's points.
        case(
            "a link too long",
            linked(9.0, 90.0, ["0, 0, 1", "4, 0, 1.5"]),
            one("joint `rod`", 9.0 - (17_f64.sqrt() + 2.0)),
        ),
        case(
            "a link too short",
            linked(1.0, 90.0, ["0, 0, 0", "0, 0, 0"]),
            one("joint `rod`", 17_f64.sqrt() - 2.0 - 1.0),
        ),
        case(
            "a link too long by a hundred-millionth",
            linked(17_f64.sqrt() + 2.0 + 1e-8, 90.0, ["0, 0, 1", "4, 0, 1.5"]),
            one("joint `rod`", 1e-8),
        ),
        // Coupler 3 and rocker 4 at a right angle leave A 5 from the pivot: 5 + 2 is less than 8.
        case(
            "a driver between coupler and rocker that asks too much",
            driven_at_the_coupler(8.0, 90.0),
            one("joint `O4`", 1.0),
        ),
        // A lever's point 2 from its pivot, and a line 3 away.
        case(
            "a line out of reach",
            lever(3.0, ON_LINE),
            one("joint `line`", 1.0),
        ),
        // The same, of a joint with an offset.
        case(
            "an offset out of reach",
            lever(
                0.0,
                r#"type = "revolute_translational", markers = ["ground.line", "lever.Q"], offset = -2.5"#,
            ),
            one("joint `line`", 0.5),
        ),
        // A lever whose slot runs 2 beside its pivot, and a pin 1 from there.
        case(
            "a slot that cannot reach its pin",
            cranked(
                "P = [3, 0]",
                "O = [0, 0], A = [2, 0]",
                0.0,
                &[("lever", "P = [0, 0], slot = [0, 2]", "0, 0, 0")],
                r#"P = { type = "revolute", markers = ["ground.P", "lever.P"] }
slot = { type = "slot", markers = ["lever.slot", "crank.A"] }"#,
            ),
            one("joint `slot`", 1.0),
        ),
        // Both ways of the parallelogram leave the links, 1 to 3 long together, too short: the
        // parallel coupler is nearer to (1.5, 9).
        case(
            "a second loop that closes in no mode of the first",
            six_bar([1.0, 2.0], 9.0, PARALLEL),
            Impossible(2, vec![("joint `O6`", 7.0 - 3.0, 0.0)]),
        ),
        // The crossed one is nearer to (1.5, −6).
        case(
            "a second loop that closes in no mode of the first, below",
            six_bar([1.0, 2.0], -6.0, PARALLEL),
            Impossible(2, vec![("joint `O6`", far(crossed, -6.0) - 3.0, 0.0)]),
        ),
        // Whatever is estimated.
        case(
            "a second loop that closes in no mode of the first, crossed",
            six_bar([1.0, 2.0], 9.0, CROSSED),
            Impossible(2, vec![("joint `O6`", 7.0 - 3.0, 0.0)]),
        ),
    ]
}

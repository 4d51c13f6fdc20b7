//! Mechanisms that close, with their poses.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::common::mechanisms::{four_bar, slider_crank};
use crate::verdicts::Expected::Closes;
use crate::verdicts::mechanisms::{
    ON_LINE, PARALLEL, across, cranked, driven_at_the_coupler, hung, lever, linked,
    middle_when_crossed, six_bar, triangle, upright,
};
use crate::verdicts::{Case, case};

pub(crate) fn cases() -> Vec<Case> {
    let root = 3_f64.sqrt();
    // In the link's triangle the crank's tip (0, 1) is √17 from (4, 0).
    let diagonal = 17_f64.sqrt();
    let direction = (-1_f64).atan2(4.0) + PI;
    vec![
        case(
            "a parallelogram, parallel",
            upright([1.0, 2.0, 1.0, 2.0], 60.0),
            Closes(vec![("coupler.phi", 0.0), ("rocker.phi", PI / 3.0)]),
        ),
        // Mirrored in the diagonal from (1/2, √3/2) to (2, 0), which points to −30°.
        case(
            "a parallelogram, crossed",
            four_bar(
                [1.0, 2.0, 1.0, 2.0],
                "60*deg",
                ["0, 0, 1", "0, 0, -1", "0, 0, -2"],
            ),
            Closes(vec![
                ("coupler.phi", -PI / 3.0),
                ("rocker.phi", -2.0 * PI / 3.0),
            ]),
        ),
        // The turn nearest the estimate: two back.
        case(
            "a rocker whose turns are estimated",
            four_bar(
                [1.0, 2.0, 1.0, 2.0],
                "60*deg",
                ["0, 0, 1", "0, 0, 0", "0, 0, \"1 - 4*pi\""],
            ),
            Closes(vec![("rocker.phi", PI / 3.0 - 2.0 * TAU)]),
        ),
        case(
            "estimates a thousand lengths off",
            four_bar(
                [1.0, 2.0, 1.0, 2.0],
                "60*deg",
                ["900, 0, 1", "500, -800, 0", "0, 1000, 1"],
            ),
            Closes(vec![("rocker.x", 2.0), ("rocker.y", 0.0)]),
        ),
        case(
            "a crank of no length",
            upright([0.0, 3.0, 3.0, 2.0], 60.0),
            Closes(vec![("coupler.phi", (1.0_f64 / 3.0).acos())]),
        ),
        case(
            "a slider–crank, upright",
            slider_crank([1.0, 2.0], 0.0, "90*deg", ["0, 0, 1", "0, 0, 0", "1, 0, 0"]),
            Closes(vec![("slider.x", root), ("rod.phi", -PI / 6.0)]),
        ),
        case(
            "a slider–crank, its slider estimated on the left",
            slider_crank(
                [1.0, 2.0],
                0.0,
                "90*deg",
                ["0, 0, 1", "0, 1, -2.5", "-1, 0, 0"],
            ),
            Closes(vec![("slider.x", -root)]),
        ),
        // 3, 4, 5: the arm is upright.
        case(
            "a triangle of three, four and five",
            triangle("5", ["0, 0, 1", "4, 0, 2", "0, 3, 2"]),
            Closes(vec![
                ("arm.phi", FRAC_PI_2),
                ("barrel.phi", 3_f64.atan2(-4.0)),
            ]),
        ),
        // The rod lies against the barrel's x-axis: the same triangle.
        case(
            "a triangle driven to a negative stroke",
            triangle("-5", ["0, 0, 1", "4, 0, -1", "0, 3, -1"]),
            Closes(vec![
                ("arm.phi", FRAC_PI_2),
                ("barrel.phi", (-3_f64).atan2(4.0)),
            ]),
        ),
        case(
            "a triangle without estimates",
            triangle("5", ["0, 0, 0", "0, 0, 0", "0, 0, 0"]),
            Closes(vec![("arm.x", 0.0)]),
        ),
        // From (4, 0) the rocker stands off the diagonal by the angle between 2 and √17 across
        // from 3.
        case(
            "a link between two cranks",
            linked(3.0, 90.0, ["0, 0, 1", "4, 0, 1.5"]),
            Closes(vec![("rocker.phi", direction - across(3.0, 2.0, diagonal))]),
        ),
        case(
            "a link between two cranks, the rocker estimated below",
            linked(3.0, 90.0, ["0, 0, 1", "4, 0, -2"]),
            Closes(vec![(
                "rocker.phi",
                direction + across(3.0, 2.0, diagonal) - TAU,
            )]),
        ),
        case(
            "a link without estimates",
            linked(3.0, 90.0, ["0, 0, 0", "0, 0, 0"]),
            Closes(vec![("rocker.x", 4.0)]),
        ),
        // 3² − 1.8² = 4² − 3.2² = 2.4²; both points at the origin, where a distance has no slope.
        case(
            "a plate on two links without estimates",
            hung(3.0, 4.0),
            Closes(vec![("plate.x", 1.8), ("plate.phi", 0.0)]),
        ),
        // cos 60°, on a slot through the origin.
        case(
            "a Scotch yoke",
            cranked(
                "way = [0, 0]",
                "O = [0, 0], A = [1, 0]",
                60.0,
                &[("yoke", "S = [0, 0], slot = [0, 0, \"90*deg\"]", "0, 0, 0")],
                r#"way = { type = "translational", markers = ["ground.way", "yoke.S"] }
slot = { type = "slot", markers = ["yoke.slot", "crank.A"] }"#,
            ),
            Closes(vec![("yoke.x", 0.5)]),
        ),
        // A welded bracket stands off the crank at its tip.
        case(
            "a weld",
            cranked(
                "",
                "O = [0, 0], A = [2, 0, \"90*deg\"]",
                30.0,
                &[("bracket", "W = [0, 0]", "0, 0, 0")],
                r#"W = { type = "weld", markers = ["crank.A", "bracket.W"] }"#,
            ),
            Closes(vec![
                ("bracket.x", root),
                ("bracket.y", 1.0),
                ("bracket.phi", 2.0 * PI / 3.0),
            ]),
        ),
        // External wheels of 1 and 2: −30° for 60°.
        case(
            "a pair of gears",
            cranked(
                "P = [3, 0]",
                "O = [0, 0]",
                60.0,
                &[("wheel", "O = [0, 0]", "0, 0, 0")],
                r#"P = { type = "revolute", markers = ["ground.P", "wheel.O"] }
mesh = { type = "gear", markers = ["crank.O", "wheel.O"], radii = [1, 2] }"#,
            ),
            Closes(vec![("wheel.phi", -PI / 6.0), ("wheel.x", 3.0)]),
        ),
        // An open belt on wheels of 1 and 2: 30° for 60°.
        case(
            "a belt",
            cranked(
                "P = [9, 0]",
                "O = [0, 0]",
                60.0,
                &[("wheel", "O = [0, 0]", "0, 0, 0")],
                r#"P = { type = "revolute", markers = ["ground.P", "wheel.O"] }
belt = { type = "belt", markers = ["crank.O", "wheel.O"], radii = [1, 2] }"#,
            ),
            Closes(vec![("wheel.phi", PI / 6.0)]),
        ),
        // A rack under a pinion of 1/2 that turns by 60° goes by π/6.
        case(
            "a rack",
            cranked(
                "way = [0, -0.5]",
                "O = [0, 0]",
                60.0,
                &[("rack", "R = [0, 0]", "0, 0, 0")],
                r#"way = { type = "translational", markers = ["ground.way", "rack.R"] }
mesh = { type = "rack_and_pinion", markers = ["crank.O", "rack.R"], radius = 0.5, side = "above" }"#,
            ),
            Closes(vec![("rack.x", PI / 6.0)]),
        ),
        // A disc of 2 with its centre 1 from the axle lifts a flat face to 2 + sin 60°.
        case(
            "a cam with a flat follower",
            cranked(
                "way = [0, 0, \"90*deg\"]",
                "O = [0, 0]",
                60.0,
                &[("follower", "F = [0, 0], up = [0, 0, \"90*deg\"]", "0, 3, 0")],
                r#"way = { type = "translational", markers = ["ground.way", "follower.up"] }
contact = { type = "cam", markers = ["crank.O", "follower.F"], follower = "flat", profile = "cos(theta) + sqrt(4 - sin(theta)^2)" }"#,
            ),
            Closes(vec![("follower.y", 2.0 + 0.5 * root)]),
        ),
        // A point of a lever of 2 on a line 1 above its pivot.
        case(
            "a point held on a line",
            lever(1.0, ON_LINE),
            Closes(vec![("lever.phi", PI / 6.0)]),
        ),
        case(
            "a triangle of two links and a driver between them",
            driven_at_the_coupler(6.0, 90.0),
            // Coupler 3 and rocker 4 at a right angle: A is 5 from the pivot, 2 from the other.
            Closes(vec![("crank.phi", across(5.0, 2.0, 6.0))]),
        ),
        // In the mode of the first loop nearest the estimates the second does not close: its
        // links span 1 to 2, the point is 3 above the parallel coupler's middle.
        case(
            "a second loop that closes in the other mode of the first only",
            six_bar([1.5, 0.5], middle_when_crossed()[1] + 1.5, PARALLEL),
            Closes(vec![(
                "coupler.phi",
                (-10.0_f64 / 13.0 - 2.0).atan2(15.0 / 13.0),
            )]),
        ),
    ]
}

//! A bank of small mechanisms and what has to be said of each: that it closes, and where; that it
//! is proved not to close, and by how much; that it was not found to close; that it closes in a
//! singular position. All numbers come from closed forms, said beside each.

mod common;

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;
use std::sync::Arc;

use biela::kinematics::{Error, OpenJoint, Path, Solver, Verdict};
use biela::mechanism::{Mechanism, Source};
use common::parse;

/// What is expected.
enum Expected {
    /// It closes: some coordinates, such as `rocker.phi`.
    Closes(Vec<(&'static str, f64)>),
    /// It closes nearly in a singular position, with a reciprocal condition of this or down to a
    /// third of it, as the norms of two unit vectors have it.
    NearlySingular(f64),
    /// It is proved not to, in so many ways: what stays open, by how many metres and radians.
    Impossible(usize, Vec<(&'static str, f64, f64)>),
    /// It was not found to, and what stays open.
    NotFound(Vec<(&'static str, f64, f64)>),
    /// It closes in a singular position.
    Singular,
    /// Its file is refused, with this message.
    Refused(&'static str),
}

use Expected::{Closes, Impossible, NearlySingular, NotFound, Refused, Singular};

struct Case {
    name: &'static str,
    text: String,
    expected: Expected,
}

/// A mechanism file: ground's markers, bodies with markers and estimates, and the rest.
fn file(ground: &str, bodies: &[(&str, &str, &str)], rest: &str) -> String {
    let mut text = format!("format = 1\nname = \"bank\"\n[ground.markers]\n{ground}\n");
    for (name, markers, estimate) in bodies {
        let _ = writeln!(
            text,
            "[bodies.{name}]\nmarkers = {{ {markers} }}\nestimate = [{estimate}]"
        );
    }
    text + rest
}

/// Joints of a four-bar with crank, coupler and rocker, and a driven crank.
const FOUR_BAR: &str = r#"
[joints]
O2 = { type = "revolute", markers = ["ground.O2", "crank.O"] }
A = { type = "revolute", markers = ["crank.A", "coupler.A"] }
B = { type = "revolute", markers = ["coupler.B", "rocker.B"] }
O4 = { type = "revolute", markers = ["ground.O4", "rocker.O"] }
[drivers]
angle = { coordinate = "angle", markers = ["ground.O2", "crank.O"], start = "START*deg" }
"#;

/// A four-bar of these lengths, estimated at these angles \[deg\].
fn four_bar([a, b, c, d]: [f64; 4], start: f64, estimates: [&str; 3]) -> String {
    file(
        &format!("O2 = [0, 0]\nO4 = [{d}, 0]"),
        &[
            ("crank", &format!("O = [0, 0], A = [{a}, 0]"), estimates[0]),
            (
                "coupler",
                &format!("A = [0, 0], B = [{b}, 0]"),
                estimates[1],
            ),
            ("rocker", &format!("O = [0, 0], B = [{c}, 0]"), estimates[2]),
        ],
        &FOUR_BAR.replace("START", &start.to_string()),
    )
}

/// A four-bar estimated upright.
fn upright(lengths: [f64; 4], start: f64) -> String {
    four_bar(lengths, start, ["0, 0, 1", "0, 0, 0", "0, 0, 1"])
}

const SLIDER_CRANK: &str = r#"
[joints]
O = { type = "revolute", markers = ["ground.O", "crank.O"] }
A = { type = "revolute", markers = ["crank.A", "rod.A"] }
B = { type = "revolute", markers = ["rod.B", "slider.B"] }
guide = { type = "translational", markers = ["ground.guide", "slider.B"] }
[drivers]
angle = { coordinate = "angle", markers = ["ground.O", "crank.O"], start = "START*deg" }
"#;

/// A slider–crank with crank 1 whose guide is `offset` above the crank's pivot.
fn slider_crank(rod: f64, offset: f64, start: f64, estimates: [&str; 3]) -> String {
    file(
        &format!("O = [0, 0]\nguide = [0, {offset}]"),
        &[
            ("crank", "O = [0, 0], A = [1, 0]", estimates[0]),
            ("rod", &format!("A = [0, 0], B = [{rod}, 0]"), estimates[1]),
            ("slider", "B = [0, 0]", estimates[2]),
        ],
        &SLIDER_CRANK.replace("START", &start.to_string()),
    )
}

/// A triangle with sides 4 (base) and 3 (arm) whose third side is driven.
fn triangle(length: &str, estimates: [&str; 3]) -> String {
    file(
        "O = [0, 0]\nC = [4, 0]",
        &[
            ("arm", "O = [0, 0], A = [3, 0]", estimates[0]),
            ("barrel", "C = [0, 0]", estimates[1]),
            ("rod", "A = [0, 0]", estimates[2]),
        ],
        &r#"
[joints]
O = { type = "revolute", markers = ["ground.O", "arm.O"] }
C = { type = "revolute", markers = ["ground.C", "barrel.C"] }
A = { type = "revolute", markers = ["arm.A", "rod.A"] }
slide = { type = "translational", markers = ["barrel.C", "rod.A"] }
[drivers]
side = { coordinate = "x", markers = ["barrel.C", "rod.A"], start = START }
"#
        .replace("START", length),
    )
}

/// A crank of 1, driven, and a rocker of 2 about (4, 0), joined by a link without a body.
fn linked(length: f64, start: f64, estimates: [&str; 2]) -> String {
    file(
        "O2 = [0, 0]\nO4 = [4, 0]",
        &[
            ("crank", "O = [0, 0], A = [1, 0]", estimates[0]),
            ("rocker", "O = [0, 0], B = [2, 0]", estimates[1]),
        ],
        &format!(
            r#"
[joints]
O2 = {{ type = "revolute", markers = ["ground.O2", "crank.O"] }}
O4 = {{ type = "revolute", markers = ["ground.O4", "rocker.O"] }}
rod = {{ type = "link", markers = ["crank.A", "rocker.B"], length = {length} }}
[drivers]
angle = {{ coordinate = "angle", markers = ["ground.O2", "crank.O"], start = "{start}*deg" }}
"#
        ),
    )
}

/// A plate held level whose corners hang on two links from (0, 0) and (5, 0).
fn hung(first: f64, second: f64) -> String {
    file(
        "P = [0, 0]\nQ = [5, 0]",
        &[("plate", "A = [0, 0]", "0, 0, 0")],
        &format!(
            r#"
[joints]
first = {{ type = "link", markers = ["ground.P", "plate.A"], length = {first} }}
second = {{ type = "link", markers = ["ground.Q", "plate.A"], length = {second} }}
[constraints]
level = {{ coordinate = "angle", markers = ["ground.P", "plate.A"], value = 0 }}
"#
        ),
    )
}

/// A four-bar driven between its coupler and its rocker: an angle of the triangle that the two
/// make is given, and the crank and one side of the triangle close the loop.
fn driven_at_the_coupler(base: f64, start: f64) -> String {
    file(
        &format!("O2 = [0, 0]\nO4 = [{base}, 0]"),
        &[
            ("crank", "O = [0, 0], A = [2, 0]", "0, 0, 1"),
            ("coupler", "A = [0, 0], B = [3, 0]", "1, 2, 0"),
            ("rocker", "O = [0, 0], B = [4, 0]", "4, 0, 2"),
        ],
        &format!(
            r#"
[joints]
O2 = {{ type = "revolute", markers = ["ground.O2", "crank.O"] }}
A = {{ type = "revolute", markers = ["crank.A", "coupler.A"] }}
B = {{ type = "revolute", markers = ["coupler.B", "rocker.B"] }}
O4 = {{ type = "revolute", markers = ["ground.O4", "rocker.O"] }}
[drivers]
angle = {{ coordinate = "angle", markers = ["coupler.B", "rocker.B"], start = "{start}*deg" }}
"#
        ),
    )
}

/// A parallelogram with cranks of 2 and a base of 3, its crank upright, and a dyad of two links
/// from the middle of its coupler to the point (1.5, `height`).
fn six_bar(links: [f64; 2], height: f64, estimates: [&str; 3]) -> String {
    let [e, f] = links;
    file(
        &format!("O2 = [0, 0]\nO4 = [3, 0]\nO6 = [1.5, {height}]"),
        &[
            ("crank", "O = [0, 0], A = [2, 0]", "0, 0, 1.5"),
            (
                "coupler",
                "A = [0, 0], B = [3, 0], C = [1.5, 0]",
                estimates[0],
            ),
            ("rocker", "O = [0, 0], B = [2, 0]", estimates[1]),
            ("link", &format!("C = [0, 0], E = [{e}, 0]"), estimates[2]),
            ("output", &format!("O = [0, 0], E = [{f}, 0]"), "0, 0, 0"),
        ],
        &FOUR_BAR.replace("START", "90").replace(
            "[drivers]",
            r#"C = { type = "revolute", markers = ["coupler.C", "link.C"] }
E = { type = "revolute", markers = ["link.E", "output.E"] }
O6 = { type = "revolute", markers = ["ground.O6", "output.O"] }
[drivers]"#,
        ),
    )
}

/// The mode of `six_bar`'s parallelogram that is estimated.
const PARALLEL: [&str; 3] = ["0, 2, 0", "3, 0, \"90*deg\"", "0, 0, 0"];
const CROSSED: [&str; 3] = ["0, 2, -1.2", "3, 0, -2", "0, 0, 0"];

/// The middle of the crossed coupler of `six_bar`: with the crank's tip at (0, 2), the rocker's
/// pivot at (3, 0) and 3 and 2 between them, B is the mirror image of (3, 2) in the line from the
/// tip to the pivot, (3, 2) − 2·((3, 2) − (3, 0))·n n with n = (2, 3)/√13: (3, 2) − 12/13·(2, 3).
fn middle_when_crossed() -> [f64; 2] {
    let b = [3.0 - 24.0 / 13.0, 2.0 - 36.0 / 13.0];
    [0.5 * b[0], 0.5 * (2.0 + b[1])]
}

/// A driven crank and what `joint` does with it, `bodies` apart from the crank.
fn cranked(
    ground: &str,
    crank: &str,
    start: f64,
    bodies: &[(&str, &str, &str)],
    joints: &str,
) -> String {
    let mut all = vec![("crank", crank, "0, 0, 0")];
    all.extend(bodies);
    file(
        &format!("O = [0, 0]\n{ground}"),
        &all,
        &format!(
            r#"
[joints]
O = {{ type = "revolute", markers = ["ground.O", "crank.O"] }}
{joints}
[drivers]
angle = {{ coordinate = "angle", markers = ["ground.O", "crank.O"], start = "{start}*deg" }}
"#
        ),
    )
}

/// The angle between the sides b and c of a triangle, across from a.
fn across(a: f64, b: f64, c: f64) -> f64 {
    ((b * b + c * c - a * a) / (2.0 * b * c)).acos()
}

fn good() -> Vec<Case> {
    let case = |name, text, expected| Case {
        name,
        text,
        expected,
    };
    let root = 3_f64.sqrt();
    // Of the link's triangle: the crank's tip (0, 1) is √17 from (4, 0).
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
                60.0,
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
                60.0,
                ["0, 0, 1", "0, 0, 0", "0, 0, \"1 - 4*pi\""],
            ),
            Closes(vec![("rocker.phi", PI / 3.0 - 2.0 * TAU)]),
        ),
        case(
            "estimates a thousand lengths off",
            four_bar(
                [1.0, 2.0, 1.0, 2.0],
                60.0,
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
            slider_crank(2.0, 0.0, 90.0, ["0, 0, 1", "0, 0, 0", "1, 0, 0"]),
            Closes(vec![("slider.x", root), ("rod.phi", -PI / 6.0)]),
        ),
        case(
            "a slider–crank, its slider estimated on the left",
            slider_crank(2.0, 0.0, 90.0, ["0, 0, 1", "0, 1, -2.5", "-1, 0, 0"]),
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
            file(
                "P = [0, 0]\nline = [0, 1]",
                &[("lever", "P = [0, 0], Q = [2, 0]", "0, 0, 0")],
                r#"
[joints]
P = { type = "revolute", markers = ["ground.P", "lever.P"] }
line = { type = "slot", markers = ["ground.line", "lever.Q"] }
"#,
            ),
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
            six_bar(
                [1.5, 0.5],
                middle_when_crossed()[1] + 1.5,
                ["0, 2, 0", "3, 0, \"90*deg\"", "0, 0, 0"],
            ),
            Closes(vec![(
                "coupler.phi",
                (-10.0_f64 / 13.0 - 2.0).atan2(15.0 / 13.0),
            )]),
        ),
    ]
}

fn impossible() -> Vec<Case> {
    let case = |name, text, expected| Case {
        name,
        text,
        expected,
    };
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
            slider_crank(2.0, 4.0, 90.0, ["0, 0, 1", "0, 0, 0", "1, 0, 0"]),
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
            file(
                "P = [0, 0]\nline = [0, 3]",
                &[("lever", "P = [0, 0], Q = [2, 0]", "0, 0, 0")],
                r#"
[joints]
P = { type = "revolute", markers = ["ground.P", "lever.P"] }
line = { type = "slot", markers = ["ground.line", "lever.Q"] }
"#,
            ),
            one("joint `line`", 1.0),
        ),
        // The same, of a joint with an offset.
        case(
            "an offset out of reach",
            file(
                "P = [0, 0]",
                &[("lever", "P = [0, 0], Q = [2, 0]", "0, 0, 0")],
                r#"
[joints]
P = { type = "revolute", markers = ["ground.P", "lever.P"] }
line = { type = "revolute_translational", markers = ["ground.P", "lever.Q"], offset = -2.5 }
"#,
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

fn others() -> Vec<Case> {
    let case = |name, text, expected| Case {
        name,
        text,
        expected,
    };
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
        // The longest that coupler and rocker span is 1e-9 more than the √5 between their ends:
        // cos of half the angle at B is 1 − 1e-9/√5, so that the sine between the links, which
        // the condition is, is √(8·1e-9/√5).
        case(
            "links nearly in line",
            upright([1.0, 1.0, root - 1.0 + 1e-9, 2.0], 90.0),
            NearlySingular((8e-9 / root).sqrt()),
        ),
        case(
            "a parallelogram laid flat",
            four_bar([1.0, 2.0, 1.0, 2.0], 0.0, ["0, 0, 0", "1, 0, 0", "2, 0, 0"]),
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
                60.0,
                ["0, 0, 1", "0, 0, 0", "0, 0, \"1/(1 - 1)\""],
            ),
            Refused("`1/(1 - 1)` is not a finite number"),
        ),
    ]
}

/// Assembles, and returns the solver or what is wrong.
fn solve(text: &str) -> Result<Solver, Error> {
    let mechanism = parse(text);
    let mut solver = Solver::new(Arc::clone(&mechanism))?;
    solver.assemble(&Path::new(&mechanism))?;
    Ok(solver)
}

fn coordinate(solver: &Solver, path: &str) -> f64 {
    let (body, coordinate) = path.split_once('.').expect("body and coordinate");
    let body = solver.mechanism().body_id(body).expect("it is there");
    let k = ["x", "y", "phi"]
        .iter()
        .position(|name| *name == coordinate);
    solver.pose().q[3 * body.index() + k.expect("a coordinate")]
}

/// The joints open, and their gaps, within a part of the largest or of the rounding.
fn assert_open(name: &str, open: &[OpenJoint], expected: &[(&str, f64, f64)], part: f64) {
    assert_eq!(open.len(), expected.len(), "{name}: {open:?}");
    for (open, (element, gap, angle)) in open.iter().zip(expected) {
        assert_eq!(open.element, *element, "{name}");
        assert!(
            (open.gap - gap).abs() <= part * gap + 1e-14,
            "{name}: {open:?}, {gap}"
        );
        assert!(
            (open.angle - angle).abs() <= part * angle,
            "{name}: {open:?}, {angle}"
        );
    }
}

fn judge(case: &Case) {
    let Case {
        name,
        text,
        expected,
    } = case;
    if let Refused(message) = expected {
        let errors = Mechanism::parse(&Source::new("test.toml", text.as_str()))
            .err()
            .unwrap_or_default();
        let messages: Vec<_> = errors.iter().map(|error| &error.message).collect();
        assert_eq!(messages, [message], "{name}");
        return;
    }
    let found = solve(text);
    let described = match &found {
        Ok(solver) => format!("{:?}", solver.pose()),
        Err(error) => error.to_string(),
    };
    match (expected, found) {
        (Closes(coordinates), Ok(solver)) => {
            assert!(solver.residual() < 1e-14, "{name}");
            for (path, value) in coordinates {
                let found = coordinate(&solver, path);
                assert!(
                    (found - value).abs() < 1e-13,
                    "{name}: {path} = {found}, not {value}"
                );
            }
        }
        (NearlySingular(rcond), Ok(mut solver)) => {
            let found = solver.rcond();
            assert!(
                found > rcond / 3.0 && found < *rcond,
                "{name}: {found}, not {rcond}"
            );
        }
        (
            Impossible(expected_ways, expected),
            Err(Error::NotAssembled {
                verdict,
                open,
                nearest,
            }),
        ) => {
            let Verdict::Impossible { ways, .. } = verdict else {
                panic!("{name}: {described}");
            };
            assert_eq!(ways, *expected_ways, "{name}");
            // Closed forms are exact; elsewhere what is closed is held ten thousand times harder
            // than what is open, and each joint gives a hundred-millionth of the gap.
            assert_open(name, &open, expected, 1e-7);
            assert!(nearest.iter().all(|x| x.is_finite()), "{name}");
            assert!(
                described.starts_with("the mechanism cannot close"),
                "{name}: {described}"
            );
        }
        (NotFound(expected), Err(Error::NotAssembled { verdict, open, .. })) => {
            assert!(
                matches!(verdict, Verdict::NotFound { .. }),
                "{name}: {described}"
            );
            assert_open(name, &open, expected, 1e-7);
            assert!(
                described.contains("deterministic starts, which is no proof"),
                "{described}"
            );
        }
        (Singular, Err(Error::Singular { rcond, .. })) => assert!(rcond < 1e-7, "{name}: {rcond}"),
        _ => panic!("{name}: {described}"),
    }
}

#[test]
fn every_mechanism_of_the_bank_gets_its_verdict() {
    let bank: Vec<_> = [good(), impossible(), others()]
        .into_iter()
        .flatten()
        .collect();
    assert!(bank.len() >= 30);
    let failed: Vec<_> = bank
        .iter()
        .filter(|case| {
            std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| judge(case))).is_err()
        })
        .map(|case| case.name)
        .collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

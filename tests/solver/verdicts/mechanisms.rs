//! Texts of small mechanisms, and their geometry.

use crate::common::mechanisms::{file, four_bar};

/// A four-bar estimated upright.
pub(crate) fn upright(lengths: [f64; 4], start: f64) -> String {
    four_bar(
        lengths,
        &format!("{start}*deg"),
        ["0, 0, 1", "0, 0, 0", "0, 0, 1"],
    )
}

/// A triangle with sides 4 (base) and 3 (arm) whose third side is driven.
pub(crate) fn triangle(length: &str, estimates: [&str; 3]) -> String {
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
pub(crate) fn linked(length: f64, start: f64, estimates: [&str; 2]) -> String {
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
pub(crate) fn hung(first: f64, second: f64) -> String {
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
pub(crate) fn driven_at_the_coupler(base: f64, start: f64) -> String {
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
pub(crate) fn six_bar(links: [f64; 2], height: f64, estimates: [&str; 3]) -> String {
    let [e, f] = links;
    let [coupler, rocker, link] = estimates;
    let four_bar = four_bar(
        [2.0, 3.0, 2.0, 3.0],
        "90*deg",
        ["0, 0, 1.5", coupler, rocker],
    )
    .replace("O4 = [3, 0]", &format!("O4 = [3, 0]\nO6 = [1.5, {height}]"))
    .replace("B = [3, 0] }", "B = [3, 0], C = [1.5, 0] }");
    four_bar
        + &format!(
            r#"
[bodies.link]
markers = {{ C = [0, 0], E = [{e}, 0] }}
estimate = [{link}]
[bodies.output]
markers = {{ O = [0, 0], E = [{f}, 0] }}
estimate = [0, 0, 0]
[joints.C]
type = "revolute"
markers = ["coupler.C", "link.C"]
[joints.E]
type = "revolute"
markers = ["link.E", "output.E"]
[joints.O6]
type = "revolute"
markers = ["ground.O6", "output.O"]
"#
        )
}

/// The mode of `six_bar`'s parallelogram that is estimated.
pub(crate) const PARALLEL: [&str; 3] = ["0, 2, 0", "3, 0, \"90*deg\"", "0, 0, 0"];

pub(crate) const CROSSED: [&str; 3] = ["0, 2, -1.2", "3, 0, -2", "0, 0, 0"];

/// The middle of the crossed coupler of `six_bar`: with the crank's tip at (0, 2), the rocker's
/// pivot at (3, 0) and 3 and 2 between them, B is the mirror image of (3, 2) in the line from the
/// tip to the pivot, (3, 2) − 2·((3, 2) − (3, 0))·n n with n = (2, 3)/√13: (3, 2) − 12/13·(2, 3).
pub(crate) fn middle_when_crossed() -> [f64; 2] {
    let b = [3.0 - 24.0 / 13.0, 2.0 - 36.0 / 13.0];
    [0.5 * b[0], 0.5 * (2.0 + b[1])]
}

/// A lever of 2 about the origin, its tip held in this way against a line at `height`.
pub(crate) fn lever(height: f64, held: &str) -> String {
    file(
        &format!("P = [0, 0]\nline = [0, {height}]"),
        &[("lever", "P = [0, 0], Q = [2, 0]", "0, 0, 0")],
        &format!(
            r#"
[joints]
P = {{ type = "revolute", markers = ["ground.P", "lever.P"] }}
line = {{ {held} }}
"#
        ),
    )
}

/// The tip of the lever on that line.
pub(crate) const ON_LINE: &str = r#"type = "slot", markers = ["ground.line", "lever.Q"]"#;

/// A driven crank and what `joint` does with it, `bodies` apart from the crank.
pub(crate) fn cranked(
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
pub(crate) fn across(a: f64, b: f64, c: f64) -> f64 {
    ((b * b + c * c - a * a) / (2.0 * b * c)).acos()
}

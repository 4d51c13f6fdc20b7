//! Texts of the mechanisms that many tests need, to which they add tables of their own.

use std::fmt::Write as _;

/// A mechanism file: ground's markers, bodies with markers and estimates, and the rest.
pub(crate) fn file(ground: &str, bodies: &[(&str, &str, &str)], rest: &str) -> String {
    let mut text = format!("format = 1\nname = \"bank\"\n[ground.markers]\n{ground}\n");
    for (name, markers, estimate) in bodies {
        let _ = writeln!(
            text,
            "[bodies.{name}]\nmarkers = {{ {markers} }}\nestimate = [{estimate}]"
        );
    }
    text + rest
}

/// A crank of 0.5 m on a pin, driven by its angle `turn`, whose driver has the keys `driven`, such as
/// `start = 0.3`. Its keys are dotted: `bodies.crank.mass = 2` behind them adds to the crank.
pub(crate) fn crank(driven: &str) -> String {
    format!(
        r#"
format = 1
name = "crank"
ground.markers.O = [0, 0]
bodies.crank.markers = {{ O = [0, 0], A = [0.5, 0] }}
joints.O = {{ type = "revolute", markers = ["ground.O", "crank.O"] }}
drivers.turn = {{ coordinate = "angle", markers = ["ground.O", "crank.O"], {driven} }}
"#
    )
}

/// A four-bar with these lengths of crank, coupler, rocker and base, whose crank `turn` drives.
pub(crate) fn four_bar([a, b, c, d]: [f64; 4], start: &str, estimates: [&str; 3]) -> String {
    let [crank, coupler, rocker] = estimates;
    file(
        &format!("O2 = [0, 0]\nO4 = [{d}, 0]"),
        &[
            ("crank", &format!("O = [0, 0], A = [{a}, 0]"), crank),
            ("coupler", &format!("A = [0, 0], B = [{b}, 0]"), coupler),
            ("rocker", &format!("O = [0, 0], B = [{c}, 0]"), rocker),
        ],
        &format!(
            r#"
[joints]
O2 = {{ type = "revolute", markers = ["ground.O2", "crank.O"] }}
A = {{ type = "revolute", markers = ["crank.A", "coupler.A"] }}
B = {{ type = "revolute", markers = ["coupler.B", "rocker.B"] }}
O4 = {{ type = "revolute", markers = ["ground.O4", "rocker.O"] }}
[drivers]
turn = {{ coordinate = "angle", markers = ["ground.O2", "crank.O"], start = "{start}" }}
"#
        ),
    )
}

/// A four-bar at an angle of its crank; none where its coupler and its rocker are in line to 1 % or do
/// not meet. `side` is the sign of the angle from the diagonal, from A to O4, to the coupler.
pub(crate) fn four_bar_at(lengths: [f64; 4], crank: f64, side: f64) -> Option<String> {
    let [a, b, c, d] = lengths;
    let (x, y) = (a * crank.cos(), a * crank.sin());
    let diagonal = (d - x).hypot(y);
    let cosine = (diagonal * diagonal + b * b - c * c) / (2.0 * diagonal * b);
    if cosine.abs() > 0.99 {
        return None;
    }
    let coupler = f64::atan2(-y, d - x) + side * cosine.acos();
    let rocker = (y + b * coupler.sin()).atan2(x + b * coupler.cos() - d);
    let start = crank.to_string();
    let poses = [[0.0, 0.0, crank], [x, y, coupler], [d, 0.0, rocker]];
    let poses = poses.map(|[x, y, phi]| format!("{x}, {y}, {phi}"));
    Some(four_bar(
        lengths,
        &start,
        poses.each_ref().map(String::as_str),
    ))
}

/// A slider–crank with these lengths of crank and rod, whose guide is `offset` above the crank's pivot,
/// and whose crank `turn` drives.
pub(crate) fn slider_crank(
    [crank, rod]: [f64; 2],
    offset: f64,
    start: &str,
    estimates: [&str; 3],
) -> String {
    file(
        &format!("O = [0, 0]\nguide = [0, {offset}]"),
        &[
            (
                "crank",
                &format!("O = [0, 0], A = [{crank}, 0]"),
                estimates[0],
            ),
            ("rod", &format!("A = [0, 0], B = [{rod}, 0]"), estimates[1]),
            ("slider", "B = [0, 0]", estimates[2]),
        ],
        &format!(
            r#"
[joints]
O = {{ type = "revolute", markers = ["ground.O", "crank.O"] }}
A = {{ type = "revolute", markers = ["crank.A", "rod.A"] }}
B = {{ type = "revolute", markers = ["rod.B", "slider.B"] }}
guide = {{ type = "translational", markers = ["ground.guide", "slider.B"] }}
[drivers]
turn = {{ coordinate = "angle", markers = ["ground.O", "crank.O"], start = "{start}" }}
"#
        ),
    )
}

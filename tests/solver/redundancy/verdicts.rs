//! A bank of small mechanisms and what has to be said of each.

use biela::kinematics::{Error, Fit};

use crate::common::{solve, text};
use crate::redundancy::mechanisms::{
    angle_driver, belt, body, cam_touched_twice, crank_angle, file, joint, lined_up, parallelogram,
    rhombic_drive, slider_crank, welded, wheels, with_joints, without_driver,
};

/// Expected verdict on a mechanism.
enum Verdict {
    /// It runs, with so many of how many equations of these redundant.
    Redundant(&'static [(&'static str, usize, usize)]),
    /// The message, word for word.
    Says(&'static str),
    /// A contradiction between these.
    Contradicts(&'static [&'static str]),
    /// A singular position, with these bodies.
    Singular(&'static [&'static str]),
}

use Verdict::{Contradicts, Redundant, Says, Singular};

/// Compares the verdict on each mechanism with the expected one.
fn check(bank: Vec<(&str, String, Verdict)>) {
    for (name, text, verdict) in bank {
        match (solve(&text), verdict) {
            (Ok(solver), Redundant(expected)) => {
                let found = solver.redundancies();
                let found: Vec<_> = found
                    .iter()
                    .map(|r| (r.origin.as_str(), r.redundant, r.equations))
                    .collect();
                assert_eq!(found, expected, "{name}");
                // All rows, those set aside as well.
                assert!(solver.residual() < 8.0 * f64::EPSILON, "{name}");
            }
            (Err(error), Says(expected)) => assert_eq!(error.to_string(), expected, "{name}"),
            (Err(Error::Contradiction { origins, .. }), Contradicts(expected)) => {
                assert_eq!(origins, expected, "{name}");
            }
            (Err(Error::Singular { bodies, rcond, .. }), Singular(expected)) => {
                assert_eq!(bodies, expected, "{name}");
                assert!(rcond < 1e-7, "{name}: {rcond}");
            }
            (Ok(solver), _) => panic!("{name}: {:?}", solver.redundancies()),
            (Err(error), _) => panic!("{name}: {error}"),
        }
    }
}

/// Redundant equations, with their numbers.
#[test]
fn redundant_equations_are_counted() {
    check(vec![
        (
            "nothing redundant",
            parallelogram(&[], 60.0, true),
            Redundant(&[]),
        ),
        (
            "third crank in line",
            parallelogram(&[[0.2, 0.0]], 60.0, true),
            Redundant(&[("joint `O5`", 1, 2)]),
        ),
        (
            "third crank off the line, flat",
            parallelogram(&[[0.2, 0.1]], 0.0, true),
            Redundant(&[("joint `O5`", 1, 2)]),
        ),
        (
            "five cranks",
            parallelogram(&[[0.1, 0.1], [0.2, -0.1], [0.3, 0.2]], 130.0, true),
            Redundant(&[
                ("joint `O5`", 1, 2),
                ("joint `O6`", 1, 2),
                ("joint `O7`", 1, 2),
            ]),
        ),
        (
            "a link beside the coupler of a parallelogram",
            with_joints(
                &parallelogram(&[], 60.0, true),
                "rod = { type = \"link\", markers = [\"crank.A\", \"rocker.B\"], length = 0.4 }",
            ),
            Redundant(&[("joint `rod`", 1, 1)]),
        ),
        (
            "two guides on one line",
            slider_crank(
                "",
                &joint("again", "translational", "ground.guide_2", "slider.front"),
                &crank_angle(),
            ),
            Redundant(&[("joint `again`", 2, 2)]),
        ),
        (
            "two guides declared before all others",
            slider_crank(
                &joint("first", "translational", "ground.guide_2", "slider.front"),
                "",
                &crank_angle(),
            ),
            Redundant(&[("joint `guide`", 2, 2)]),
        ),
        (
            "welded twice",
            welded(
                &(joint("weld", "weld", "arm.P", "plate.P")
                    + "weld_2 = { type = \"weld\", markers = [\"arm.R\", \"plate.Q\"] }"),
            )
            .replace("Q = [0.3, 0.001]", "R = [0.3, 0]"),
            Redundant(&[("joint `weld_2`", 3, 3)]),
        ),
        (
            "a pin doubled",
            with_joints(
                &text("mechanisms/four_bar.toml"),
                &joint("A_again", "revolute", "coupler.A", "crank.A"),
            ),
            Redundant(&[("joint `A_again`", 2, 2)]),
        ),
        (
            "a belt around two gears that agree with it",
            wheels(&belt(false)),
            Redundant(&[("joint `ac`", 1, 1)]),
        ),
        (
            "a cam's follower touching it twice",
            cam_touched_twice(),
            Redundant(&[("joint `again`", 1, 2)]),
        ),
    ]);
}

/// Degrees of freedom that do not match the drivers, with the bodies and drivers.
#[test]
fn free_bodies_and_surplus_drivers_are_named() {
    check(vec![
        (
            "a belt around two gears against it",
            wheels(&belt(true)),
            Says(
                "the mechanism has no degree of freedom and 1 driver; too many: remove one of \
                 joint `ab`, joint `bc`, joint `ac`, driver `turn`",
            ),
        ),
        (
            "a free crank with three pins",
            parallelogram(&[[0.2, 0.1]], 60.0, false),
            Says(
                "the mechanism has 1 degree of freedom and no driver; free to move: body `crank`, \
                 body `rocker`, body `crank_5`, body `coupler`: add a driver for one of them; \
                 `turn = { coordinate = \"angle\", markers = [\"ground.O2\", \"crank.O\"] }` under \
                 `[drivers]`, with a `start` or a `motion`, drives it, and under `[freedoms]` the \
                 forces move it",
            ),
        ),
        (
            "half a five-bar",
            std::fs::read_to_string("mechanisms/five_bar_robot.toml")
                .map(|text| without_driver(&text, "right_angle"))
                .expect("it is shipped"),
            Says(
                "the mechanism has 2 degrees of freedom and 1 driver; free to move: body \
                 `right_arm`, body `left_forearm`, body `right_forearm`: add a driver for one of \
                 them; `turn = { coordinate = \"angle\", markers = [\"ground.right\", \
                 \"right_arm.motor\"] }` under `[drivers]`, with a `start` or a `motion`, drives \
                 it, and under `[freedoms]` the forces move it",
            ),
        ),
        (
            "a body without joints",
            parallelogram(&[], 60.0, true).replace(
                "[joints]",
                &(body("loose", "P = [0, 0]", "0, 0, 0") + "[joints]"),
            ),
            Says(
                "the mechanism has 4 degrees of freedom and 1 driver; free to move: body `loose`: \
                 add 3 drivers for them",
            ),
        ),
        (
            "driven at both ends",
            text("mechanisms/four_bar.toml").replace(
                "[measures]",
                &(angle_driver("rocker_angle", "ground.O4", "rocker.O", 120.0) + "[measures]"),
            ),
            Says(
                "the mechanism has 1 degree of freedom and 2 drivers; too many: remove one of \
                 driver `crank_angle`, driver `rocker_angle`",
            ),
        ),
        (
            "a slot in place of a slider",
            slider_crank("", "", &crank_angle()).replace("\"translational\"", "\"slot\""),
            Says(
                "the mechanism has 2 degrees of freedom and 1 driver; free to move: body \
                 `slider`: add a driver for one of them; a `slot` holds a point, `translational` \
                 the angle too: joint `guide`",
            ),
        ),
        (
            "driven twice at one end, free at another",
            parallelogram(&[], 60.0, true).replace(
                "[joints]",
                &(body("loose", "P = [0, 0]", "0, 0, 0")
                    + "[joints]\n"
                    + &joint("pin", "revolute", "rocker.B", "loose.P")),
            ) + &angle_driver("again", "ground.O4", "rocker.O", 60.0),
            Says(
                "the mechanism has 2 degrees of freedom and 2 drivers; driver `crank_angle` and \
                 driver `again` drive one motion: give one of them a coordinate that is free, such \
                 as `coordinate = \"angle\", markers = [\"rocker.B\", \"loose.P\"]`; free to move: \
                 body `loose`",
            ),
        ),
        (
            "driven where it is held",
            slider_crank(
                "",
                "",
                &angle_driver("tilt", "ground.guide", "slider.B", 0.0),
            ),
            Says(
                "the mechanism has 1 degree of freedom and 1 driver; driver `tilt` drives what \
                 joint `guide` already holds: give it a coordinate that is free, such as \
                 `coordinate = \"x\", markers = [\"ground.guide\", \"slider.B\"]`; free to move: \
                 body `crank`, body `rod`, body `slider`",
            ),
        ),
        (
            "driven twice where it is held",
            slider_crank(
                "",
                "",
                &(angle_driver("tilt", "ground.guide", "slider.B", 0.0)
                    + "lift = { coordinate = \"y\", markers = [\"ground.guide\", \"slider.B\"], \
                       start = 0 }\n"),
            ),
            Says(
                "the mechanism has 1 degree of freedom and 2 drivers; driver `tilt` and driver \
                 `lift` drive what joint `guide` already holds: give one of them a coordinate \
                 that is free, and remove the rest, such as `coordinate = \"x\", markers = [\"ground.guide\", \
                 \"slider.B\"]`; free to move: body `crank`, body `rod`, body `slider`",
            ),
        ),
    ]);
}

/// Constraints that contradict each other, with their gaps.
#[test]
fn contradictions_are_named_with_their_gaps() {
    check(vec![
        (
            "welded in two places",
            welded(
                &(joint("weld", "weld", "arm.P", "plate.P")
                    + "weld_2 = { type = \"weld\", markers = [\"arm.Q\", \"plate.Q\"] }"),
            ),
            Says(
                "joint `weld`, joint `weld_2` contradict each other: all others closed, joint \
                 `weld_2` stays open by 1.000 mm; remove one of them, or make them agree",
            ),
        ),
        (
            "a belt with a wrong phase",
            with_joints(
                &parallelogram(&[], 60.0, true)
                    .replace("O = [0, 0], B", "O = [0, 0, \"30*deg\"], B"),
                "k = { type = \"belt\", markers = [\"crank.O\", \"rocker.O\"], radii = [1, 1] }",
            ),
            Says(
                "joint `k` contradicts all others: with these closed, it stays open by 30.00 deg; \
                 move one of its markers by as much, or remove it: joint `k` would close with \
                 `phase = \"drawn\"`",
            ),
        ),
        (
            "a rhombic drive whose gears mesh half a turn off",
            rhombic_drive(),
            Says(
                "joint `mesh` contradicts all others: with these closed, it stays open by 180.0 \
                 deg; move one of its markers by as much, or remove it: joint `mesh` would close \
                 with `phase = \"drawn\"`",
            ),
        ),
        (
            "two guides at an angle",
            slider_crank(
                "",
                "again = { type = \"translational\", markers = [\"ground.tilted\", \"slider.B\"] }",
                &crank_angle(),
            ),
            Says(
                "joint `guide`, joint `again` contradict each other: all others closed, joint \
                 `again` stays open by 3.000 deg; remove one of them, or make them agree",
            ),
        ),
        (
            "a rod that is longer than the coupler beside it",
            with_joints(
                &parallelogram(&[], 60.0, true),
                "rod = { type = \"link\", markers = [\"crank.A\", \"rocker.B\"], length = 0.41 }",
            ),
            Says(
                "joint `A`, joint `B`, joint `rod` contradict each other: all others closed, joint \
                 `rod` stays open by 10.00 mm; remove one of them, or make them agree: joint `rod` \
                 would fit with a length of 400.0 mm, which is 410.0 mm now",
            ),
        ),
        (
            "a truss with a driver",
            parallelogram(&[[0.2, 0.1]], 60.0, true).replace("C = [0.1, 0]", "C = [0.12, 0]"),
            Contradicts(&[
                "joint `O2`",
                "joint `A`",
                "joint `B`",
                "joint `O4`",
                "joint `C5`",
                "joint `O5`",
            ]),
        ),
        (
            "redundant, and out of reach",
            with_joints(
                &text("mechanisms/four_bar.toml").replace("value = 0.10", "value = 0.80"),
                &joint("A_again", "revolute", "coupler.A", "crank.A"),
            ),
            // √(0.8² + 0.4² − 0.8·0.4) − 0.55, as without the second pin.
            Says(
                "the mechanism cannot close: joint `O4` stays open by 142.8 mm; `crank.A` and \
                 `ground.O4` are 692.8 mm apart, `coupler` and `rocker` together span 50.00 mm to \
                 550.0 mm; body `rocker` would reach with more than 442.9 mm from `B` to `O`, \
                 which is 300.0 mm now",
            ),
        ),
    ]);
}

/// Singular positions, with the bodies that can move.
#[test]
fn singular_positions_name_the_bodies_that_can_move() {
    check(vec![
        (
            "flat parallelogram",
            parallelogram(&[], 0.0, true),
            Singular(&["body `rocker`", "body `coupler`"]),
        ),
        (
            "three cranks in line, flat",
            parallelogram(&[[0.2, 0.0]], 180.0, true),
            Singular(&["body `rocker`", "body `crank_5`", "body `coupler`"]),
        ),
        (
            "slider at the end of its stroke, driven",
            lined_up(
                "stroke = { coordinate = \"x\", markers = [\"ground.O\", \"slider.B\"], \
                 start = 0.4 }",
            ),
            Singular(&["body `crank`", "body `rod`"]),
        ),
        (
            "two bars stretched between walls",
            file(
                "O = [0, 0]\nQ = [0.3, 0]",
                &(body("a", "O = [0, 0], A = [0.1, 0]", "0, 0, 0")
                    + &body("b", "A = [0, 0], B = [0.2, 0]", "0.1, 0, 0")),
                &(joint("O", "revolute", "ground.O", "a.O")
                    + &joint("A", "revolute", "a.A", "b.A")
                    + &joint("B", "revolute", "b.B", "ground.Q")),
                "",
            ),
            Singular(&["body `a`", "body `b`"]),
        ),
    ]);
}

/// Half of the last of the digits that messages show.
const FOUR_DIGITS: f64 = 5e-5;
/// Rounding of lengths below half a metre, in the few that make a gap \[m\].
const ROUNDING: f64 = 1e-15;

/// Expects the contradiction of these origins, open by so much in the last one, and returns the
/// length that would close it, with the present one.
#[track_caller]
fn expect_slip(name: &str, text: &str, expected: &[&str], gap: f64) -> Option<[f64; 2]> {
    let error = solve(text).map(|_| ()).expect_err(name);
    let Error::Contradiction {
        origins, open, fit, ..
    } = &error
    else {
        panic!("{name}: {error}");
    };
    assert_eq!(origins, expected, "{name}");
    assert_eq!(Some(&open.origin), origins.last(), "{name}");
    let off = (open.gap - gap).abs();
    assert!(off <= FOUR_DIGITS * gap + ROUNDING, "{name}: {error}");
    match fit.as_deref() {
        Some(Fit::Length {
            length, present, ..
        }) => Some([*length, *present]),
        _ => None,
    }
}

/// A third crank that is too long or too short by whatever length is told in the same words: the
/// joints that contradict each other, the gap, and the length that would fit.
#[test]
fn a_slip_of_any_size_has_one_verdict() {
    for slip in [1e-10_f64, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3] {
        for (place, start) in [([0.2, 0.1], 60.0), ([0.2, 0.0], 60.0), ([0.3, -0.2], 200.0)] {
            for slip in [slip, -slip] {
                let name = format!("a crank at {place:?} longer by {slip:e}");
                let text = parallelogram(&[place], start, true);
                let text = text.replace("C = [0.1, 0]", &format!("C = [{}, 0]", 0.1 + slip));
                let joints = ["O2", "A", "B", "O4", "C5", "O5"];
                let joints = joints.map(|joint| format!("joint `{joint}`"));
                let joints = joints.each_ref().map(String::as_str);
                let fit = expect_slip(&name, &text, &joints, slip.abs());
                let [length, present] = fit.expect("a crank has one length");
                assert!(
                    (length - 0.1).abs() <= FOUR_DIGITS * slip.abs() + ROUNDING,
                    "{name}"
                );
                assert!((present - 0.1 - slip).abs() < ROUNDING, "{name}");
            }
        }
        let name = format!("a rod longer by {slip:e}");
        let rod = format!(
            "rod = {{ type = \"link\", markers = [\"crank.A\", \"rocker.B\"], length = {} }}",
            0.4 + slip
        );
        let text = with_joints(&parallelogram(&[], 60.0, true), &rod);
        let joints = ["joint `A`", "joint `B`", "joint `rod`"];
        let [length, _] = expect_slip(&name, &text, &joints, slip).expect("a rod has a length");
        assert!(
            (length - 0.4).abs() <= FOUR_DIGITS * slip + ROUNDING,
            "{name}"
        );
        let name = format!("two guides apart by {slip:e}");
        let text = slider_crank(
            "",
            &joint("again", "translational", "ground.guide_2", "slider.front"),
            &crank_angle(),
        );
        let text = text.replace("front = [0.05, 0]", &format!("front = [0.05, {slip}]"));
        expect_slip(&name, &text, &["joint `guide`", "joint `again`"], slip);
    }
    let text =
        parallelogram(&[[0.2, 0.1]], 60.0, true).replace("C = [0.1, 0]", "C = [0.100001, 0]");
    let error = solve(&text).map(|_| ()).expect_err("it is too long");
    assert_eq!(
        error.to_string(),
        "joint `O2`, joint `A`, joint `B`, joint `O4`, joint `C5`, joint `O5` contradict each \
         other: all others closed, joint `O5` stays open by 1.000e-3 mm; remove one of them, or \
         make them agree: body `crank_5` would fit with 100.0000 mm from `C` to `O`, which is \
         100.0010 mm now"
    );
}

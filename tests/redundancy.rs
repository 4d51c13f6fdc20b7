//! Constraints that say nothing new or contradict each other, and drivers that are too few, too
//! many or on the wrong things.

mod common;
#[path = "common/generated.rs"]
#[allow(dead_code, reason = "also used by `benches/`")]
mod generated;

use std::f64::consts::{PI, TAU};
use std::sync::{Arc, Mutex};

use biela::fmi::{Category, Instance, Interface, MechanismModel, Sink, Status};
use biela::kinematics::{Error, Path, Rates, Reason, Solver};
use biela::mechanism::{Jet, Mechanism};
use common::{assembled, parse, shipped, stems, straight_to};
use generated::{Ground, chain};
use proptest::prelude::*;

fn solve(text: &str) -> Result<Solver, Error> {
    let mechanism: Arc<Mechanism> = parse(text);
    let path = Path::new(&mechanism);
    let mut solver = Solver::new(mechanism)?;
    solver.assemble(&path)?;
    Ok(solver)
}

/// A file of these sections.
fn file(ground: &str, bodies: &str, joints: &str, drivers: &str) -> String {
    format!(
        "format = 1\nname = \"test\"\n[ground.markers]\n{ground}\n{bodies}\n[joints]\n{joints}\n\
         [drivers]\n{drivers}\n"
    )
}

/// A body with markers and an estimate.
fn body(name: &str, markers: &str, estimate: &str) -> String {
    format!("[bodies.{name}]\nmarkers = {{ {markers} }}\nestimate = [{estimate}]\n")
}

/// A joint of a kind that needs two markers only.
fn joint(name: &str, kind: &str, from: &str, to: &str) -> String {
    format!("{name} = {{ type = \"{kind}\", markers = [\"{from}\", \"{to}\"] }}\n")
}

fn angle_driver(name: &str, from: &str, to: &str, degrees: f64) -> String {
    format!(
        "{name} = {{ coordinate = \"angle\", markers = [\"{from}\", \"{to}\"], \
         start = \"{degrees}*deg\" }}\n"
    )
}

/// Two cranks of 0.1 m, 0.4 m apart, and more of them at these places, all on one coupler: all
/// turn alike.
fn parallelogram(more: &[[f64; 2]], start: f64, driver: bool) -> String {
    let (sin, cos) = start.to_radians().sin_cos();
    let mut ground = "O2 = [0, 0]\nO4 = [0.4, 0]\n".to_owned();
    let mut coupler = "A = [0, 0], B = [0.4, 0]".to_owned();
    let turned = |x: f64, y: f64| format!("{x}, {y}, \"{start}*deg\"");
    let mut bodies = body("crank", "O = [0, 0], A = [0.1, 0]", &turned(0.0, 0.0));
    bodies += &body("rocker", "O = [0, 0], B = [0.1, 0]", &turned(0.4, 0.0));
    let mut joints = joint("O2", "revolute", "ground.O2", "crank.O")
        + &joint("A", "revolute", "crank.A", "coupler.A")
        + &joint("B", "revolute", "coupler.B", "rocker.B")
        + &joint("O4", "revolute", "ground.O4", "rocker.O");
    for (k, &[x, y]) in more.iter().enumerate() {
        let k = k + 5;
        ground += &format!("O{k} = [{x}, {y}]\n");
        coupler += &format!(", C{k} = [{x}, {y}]");
        let name = format!("crank_{k}");
        bodies += &body(&name, "O = [0, 0], C = [0.1, 0]", &turned(x, y));
        let (pin, pivot) = (format!("C{k}"), format!("O{k}"));
        joints += &joint(
            &pin,
            "revolute",
            &format!("coupler.{pin}"),
            &format!("{name}.C"),
        );
        joints += &joint(
            &pivot,
            "revolute",
            &format!("ground.{pivot}"),
            &format!("{name}.O"),
        );
    }
    bodies += &body(
        "coupler",
        &coupler,
        &format!("{}, {}, 0", 0.1 * cos, 0.1 * sin),
    );
    let driver = if driver {
        angle_driver("crank_angle", "ground.O2", "crank.O", start)
    } else {
        String::new()
    };
    file(&ground, &bodies, &joints, &driver)
}

/// A slider-crank whose guide runs at an angle, with these joints before and after its own.
fn slider_crank(before: &str, after: &str, drivers: &str) -> String {
    let ground = "O = [0, 0]\nguide = [0, 0, \"20*deg\"]\n\
                  guide_2 = [\"0.1*cos(20*deg)\", \"0.1*sin(20*deg)\", \"20*deg\"]\n\
                  tilted = [0, 0, \"23*deg\"]\n";
    let bodies = body("crank", "O = [0, 0], A = [0.1, 0]", "0, 0, \"65*deg\"")
        + &body("rod", "A = [0, 0], B = [0.3, 0]", "0.04, 0.09, 0.1")
        + &body(
            "slider",
            "B = [0, 0], front = [0.05, 0]",
            "0.32, 0.12, \"20*deg\"",
        );
    let joints = before.to_owned()
        + &joint("guide", "translational", "ground.guide", "slider.B")
        + &joint("O", "revolute", "ground.O", "crank.O")
        + &joint("A", "revolute", "crank.A", "rod.A")
        + &joint("B", "revolute", "rod.B", "slider.B")
        + after;
    file(ground, &bodies, &joints, drivers)
}

fn crank_angle() -> String {
    angle_driver("crank_angle", "ground.O", "crank.O", 65.0)
}

/// A slider-crank in line, the crank's pin turned by so much; the rod is straight behind it.
fn lined_up(drivers: &str) -> String {
    let bodies = body("crank", "O = [0, 0], A = [0.1, 0]", "0, 0, 0")
        + &body("rod", "A = [0, 0], B = [0.3, 0]", "0.1, 0, 0")
        + &body("slider", "B = [0, 0]", "0.4, 0, 0");
    let joints = joint("O", "revolute", "ground.O", "crank.O")
        + &joint("A", "revolute", "crank.A", "rod.A")
        + &joint("B", "revolute", "rod.B", "slider.B")
        + &joint("guide", "translational", "ground.O", "slider.B");
    file("O = [0, 0]", &bodies, &joints, drivers)
}

/// Three wheels on one line of shafts, the first driven, with these joints between them.
fn wheels(between: &str, start: f64) -> String {
    let mut bodies = String::new();
    let mut joints = String::new();
    for (name, x) in [("a", 0.0), ("b", 0.2), ("c", 0.5)] {
        bodies += &body(name, "O = [0, 0]", &format!("{x}, 0, 0"));
        let (ground, own) = (format!("ground.{name}"), format!("{name}.O"));
        joints += &joint(&format!("shaft_{name}"), "revolute", &ground, &own);
    }
    let ground = "a = [0, 0]\nb = [0.2, 0]\nc = [0.5, 0]";
    let driver = angle_driver("turn", "ground.a", "a.O", start);
    file(ground, &bodies, &(joints + between), &driver)
}

fn pair(name: &str, kind: &str, from: &str, to: &str, radii: &str, more: &str) -> String {
    format!(
        "{name} = {{ type = \"{kind}\", markers = [\"{from}.O\", \"{to}.O\"], radii = {radii}{more} }}\n"
    )
}

/// An arm turned by a driver, with plates welded to it in these ways.
fn welded(welds: &str) -> String {
    let bodies = body(
        "arm",
        "O = [0, 0], P = [0.2, 0], Q = [0.3, 0.001]",
        "0, 0, 0.5",
    ) + &body("plate", "P = [0, 0], Q = [0.1, 0]", "0.18, 0.1, 0.5");
    let joints = joint("O", "revolute", "ground.O", "arm.O") + welds;
    let driver = angle_driver("arm_angle", "ground.O", "arm.O", 30.0);
    file("O = [0, 0]", &bodies, &joints, &driver)
}

fn four_bar() -> String {
    std::fs::read_to_string("mechanisms/four_bar.toml").expect("it is shipped")
}

fn with_joints(text: &str, joints: &str) -> String {
    text.replacen("[drivers]", &format!("{joints}\n[drivers]"), 1)
}

/// What is to be said of a mechanism.
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

/// Every kind of verdict, with names and numbers.
#[test]
#[allow(clippy::too_many_lines, reason = "one entry a mechanism")]
fn each_mechanism_has_its_verdict() {
    let bank: Vec<(&str, String, Verdict)> = vec![
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
                &four_bar(),
                &joint("A_again", "revolute", "coupler.A", "crank.A"),
            ),
            Redundant(&[("joint `A_again`", 2, 2)]),
        ),
        (
            "a belt around two gears that agree with it",
            wheels(
                &(pair("ab", "gear", "a", "b", "[0.1, 0.1]", "")
                    + &pair("bc", "gear", "b", "c", "[0.1, 0.2]", "")
                    + &pair("ac", "belt", "a", "c", "[0.05, 0.1]", "")),
                40.0,
            ),
            Redundant(&[("joint `ac`", 1, 1)]),
        ),
        (
            "a cam's follower touching it twice",
            cam_touched_twice(),
            Redundant(&[("joint `again`", 1, 2)]),
        ),
        (
            "a belt around two gears against it",
            wheels(
                &(pair("ab", "gear", "a", "b", "[0.1, 0.1]", "")
                    + &pair("bc", "gear", "b", "c", "[0.1, 0.2]", "")
                    + &pair("ac", "belt", "a", "c", "[0.05, 0.1]", ", crossed = true")),
                40.0,
            ),
            Says(
                "the mechanism has no degree of freedom and 1 driver; too many: remove one of \
                 joint `ab`, joint `bc`, joint `ac`, driver `turn`",
            ),
        ),
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
            "a free crank with three pins",
            parallelogram(&[[0.2, 0.1]], 60.0, false),
            Says(
                "the mechanism has 1 degree of freedom and no driver; free to move: body `crank`, \
                 body `rocker`, body `crank_5`, body `coupler`: add a driver for one of them",
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
                 them",
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
            four_bar().replace(
                "[measures]",
                &(angle_driver("rocker_angle", "ground.O4", "rocker.O", 120.0) + "[measures]"),
            ),
            Says(
                "the mechanism has 1 degree of freedom and 2 drivers; too many: remove one of \
                 driver `crank_angle`, driver `rocker_angle`",
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
                "the mechanism has 1 degree of freedom and 1 driver; free to move: body `crank`, \
                 body `rod`, body `slider`: add a driver for one of them; too many: remove one of \
                 joint `guide`, driver `tilt`",
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
                 `rod` stays open by 10.00 mm; remove one of them, or make them agree",
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
        (
            "redundant, and out of reach",
            with_joints(
                &four_bar().replace("value = 0.10", "value = 0.80"),
                &joint("A_again", "revolute", "coupler.A", "crank.A"),
            ),
            // √(0.8² + 0.4² − 0.8·0.4) − 0.55, as without the second pin.
            Says(
                "the mechanism cannot close: joint `O4` stays open by 142.8 mm; `crank.A` and \
                 `ground.O4` are 692.8 mm apart, `coupler` and `rocker` together span 50.00 mm to \
                 550.0 mm",
            ),
        ),
    ];
    for (name, text, verdict) in bank {
        match (solve(&text), verdict) {
            (Ok(solver), Redundant(expected)) => {
                let found = solver.redundancies();
                let found: Vec<_> = found
                    .iter()
                    .map(|r| (r.element.as_str(), r.redundant, r.equations))
                    .collect();
                assert_eq!(found, expected, "{name}");
                // All rows, those set aside as well.
                assert!(solver.residual() < 8.0 * f64::EPSILON, "{name}");
            }
            (Err(error), Says(expected)) => assert_eq!(error.to_string(), expected, "{name}"),
            (Err(Error::Contradiction { elements, .. }), Contradicts(expected)) => {
                assert_eq!(elements, expected, "{name}");
            }
            (Err(Error::Singular { bodies, rcond }), Singular(expected)) => {
                assert_eq!(bodies, expected, "{name}");
                assert!(rcond < 1e-7, "{name}: {rcond}");
            }
            (Ok(solver), _) => panic!("{name}: {:?}", solver.redundancies()),
            (Err(error), _) => panic!("{name}: {error}"),
        }
    }
}

fn without_driver(text: &str, name: &str) -> String {
    let lines = text.lines().filter(|line| !line.starts_with(name));
    lines.flat_map(|line| [line, "\n"]).collect()
}

/// A cam with its joint twice, each with a contact of its own to find.
fn cam_touched_twice() -> String {
    let text = std::fs::read_to_string("mechanisms/cam_roller.toml").expect("it is shipped");
    let start = text.find("[joints.contact]").expect("it has a cam");
    let length = text[start + 1..]
        .find("\n[")
        .expect("it is not the last table")
        + 2;
    let again = text[start..start + length].replace("joints.contact", "joints.again");
    let mut text = text;
    text.insert_str(start + length, &again);
    text
}

/// The same joint once more, declared behind all others on lines.
fn double(text: &str, name: &str) -> String {
    let joints = text.split_once("[joints]").expect("it has joints").1;
    let mut lines = joints.lines().filter_map(|line| line.split_once('='));
    let line = lines.find(|(key, _)| key.trim() == name);
    let (_, table) = line.expect("it has this joint on a line");
    let again = format!("{name}_again = {table}");
    let end = text.len() - joints.len() + joints.find("\n[").expect("it is not the last table");
    let mut text = text.to_owned();
    text.insert_str(end, &format!("\n{again}\n"));
    text
}

/// q and its rates of the bodies of `twin`, as `solver` has them: body by body, by name.
fn motion_of(solver: &mut Solver, twin: &Mechanism) -> [Vec<f64>; 3] {
    let mut rates = Rates::new(solver.pose().q.len());
    let unit = |_| Jet {
        value: 0.0,
        first: 1.0,
        second: 0.5,
    };
    solver
        .solve_rates(unit, &mut rates)
        .expect("the pose is regular");
    let places: Vec<_> = twin
        .bodies
        .iter()
        .map(|body| {
            solver
                .mechanism()
                .body_id(&body.name)
                .expect("both have it")
        })
        .flat_map(|body| (0..3).map(move |k| 3 * body.index() + k))
        .collect();
    let of = |all: &[f64]| places.iter().map(|&place| all[place]).collect();
    [
        of(&solver.pose().q),
        of(rates.velocity()),
        of(rates.acceleration()),
    ]
}

/// Moves both along the first driver's values and compares: q, velocity and acceleration, each
/// once more amplified by the condition.
fn compare(redundant: &Arc<Mechanism>, twin: &Arc<Mechanism>, values: &[f64], what: &str) {
    let (mut solver, mut path) = assembled(redundant);
    let (mut other, mut other_path) = assembled(twin);
    assert!(!solver.redundancies().is_empty(), "{what}");
    assert!(other.redundancies().is_empty(), "{what}");
    for &value in values {
        straight_to(&solver, &mut path, value);
        straight_to(&other, &mut other_path, value);
        let moved = (
            solver.follow(&path).is_ok(),
            other.follow(&other_path).is_ok(),
        );
        assert_eq!(moved.0, moved.1, "{what} at {value}");
        if !moved.0 {
            return;
        }
        let rcond = other.rcond();
        assert!(solver.residual() < 1e-9, "{what} at {value}");
        let found = motion_of(&mut solver, twin);
        let expected = motion_of(&mut other, twin);
        for (order, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let size = expected.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
            let rounding = 100.0 * f64::EPSILON * size / rcond.powi(order as i32 + 1).min(1.0);
            for (a, b) in found.iter().zip(expected) {
                assert!(
                    (a - b).abs() <= rounding,
                    "{what} at {value}, order {order}: {a} {b}"
                );
            }
        }
    }
}

fn turn_from(start: f64) -> Vec<f64> {
    (1..=36)
        .map(|k| start.to_radians() + f64::from(k) * TAU / 36.0)
        .collect()
}

#[test]
fn redundant_mechanisms_move_like_their_twins() {
    let again = joint("again", "translational", "ground.guide_2", "slider.front");
    let guided = slider_crank("", "", &crank_angle());
    let pairs = [
        (
            slider_crank("", &again, &crank_angle()),
            guided.clone(),
            65.0,
        ),
        (slider_crank(&again, "", &crank_angle()), guided, 65.0),
        (double(&four_bar(), "A"), four_bar(), 60.0),
        (double(&four_bar(), "O4"), four_bar(), 60.0),
        (
            wheels(
                &(pair("ab", "gear", "a", "b", "[0.1, 0.1]", "")
                    + &pair("bc", "gear", "b", "c", "[0.1, 0.2]", "")
                    + &pair("ac", "belt", "a", "c", "[0.05, 0.1]", "")),
                40.0,
            ),
            wheels(
                &(pair("ab", "gear", "a", "b", "[0.1, 0.1]", "")
                    + &pair("bc", "gear", "b", "c", "[0.1, 0.2]", "")),
                40.0,
            ),
            40.0,
        ),
    ];
    for (k, (redundant, twin, start)) in pairs.iter().enumerate() {
        compare(
            &parse(redundant),
            &parse(twin),
            &turn_from(*start),
            &format!("pair {k}"),
        );
    }
    compare(
        &parse(&cam_touched_twice()),
        &shipped("cam_roller"),
        &turn_from(60.0),
        "cam",
    );
}

/// The shipped mechanisms whose joints are each on one line, with the names of these.
fn joints_on_lines() -> Vec<(String, Vec<String>)> {
    let mut found = Vec::new();
    for name in stems("mechanisms", "toml") {
        let text =
            std::fs::read_to_string(format!("mechanisms/{name}.toml")).expect("it is shipped");
        let (_, rest) = text.split_once("[joints]").expect("it has joints");
        let (joints, _) = rest.split_once("\n[").expect("it has drivers");
        let lines = joints.lines().filter(|line| line.contains("= {"));
        let names: Vec<_> = lines
            .filter_map(|line| line.split_once('='))
            .map(|(key, _)| key.trim().to_owned())
            .collect();
        // A mechanism with a table in a file beside it is read from its place only.
        if !names.is_empty() && !text.contains("file = ") {
            found.push((name, names));
        }
    }
    assert!(found.len() > 20, "{found:?}");
    found
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 24,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// A joint declared twice changes nothing, and the second one is named.
    #[test]
    fn a_doubled_joint_changes_nothing(which in 0..1000_usize, joint in 0..1000_usize) {
        let all = joints_on_lines();
        let (name, joints) = &all[which % all.len()];
        let joint = &joints[joint % joints.len()];
        let text = std::fs::read_to_string(format!("mechanisms/{name}.toml")).expect("it is shipped");
        let doubled = parse(&double(&text, joint));
        let (solver, _) = assembled(&doubled);
        let start = solver.pose().drivers.first().copied().unwrap_or(0.0);
        let redundancies = solver.redundancies();
        prop_assert_eq!(redundancies.len(), 1);
        prop_assert_eq!(&redundancies[0].element, &format!("joint `{joint}_again`"));
        prop_assert_eq!(redundancies[0].redundant, redundancies[0].equations);
        let twin = shipped(name);
        if twin.drivers.first().is_some_and(|driver| driver.motion().is_none()) {
            let values: Vec<_> = (1..=10).map(|k| start + 0.004 * f64::from(k)).collect();
            compare(&doubled, &twin, &values, &format!("{name}, {joint}"));
        }
    }
}

/// Cranks that all turn alike, their pins not in one line: regular at every angle, the flat ones
/// included, for who may choose among the equations.
#[test]
fn three_cranks_turn_through_their_flat_poses() {
    turn_three_cranks(&[(10, 100), (100, 20), (1000, 2)]);
}

/// The same for longer.
#[test]
#[ignore = "takes a minute without optimisation"]
fn three_cranks_turn_a_hundred_times() {
    turn_three_cranks(&[(10, 100), (100, 100), (1000, 100)]);
}

/// Turns them with so many steps a turn, for so many turns.
fn turn_three_cranks(runs: &[(u32, u32)]) {
    let mechanism = parse(&parallelogram(&[[0.2, 0.1]], 60.0, true));
    let phi = |name: &str| 3 * mechanism.body_id(name).expect("it has it").index() + 2;
    let phi = ["crank", "rocker", "crank_5", "coupler"].map(phi);
    for &(steps, turns) in runs {
        let (mut solver, mut path) = assembled(&mechanism);
        for step in 1..=turns * steps {
            let angle = TAU / 6.0 + TAU * f64::from(step) / f64::from(steps);
            straight_to(&solver, &mut path, angle);
            let progress = solver
                .follow(&path)
                .unwrap_or_else(|blocked| panic!("{blocked:?}"));
            assert!(progress.substeps < 30, "{step} of {steps}: {progress:?}");
            let q = &solver.pose().q;
            // Rows that are not quite fit are kept: some digits are lost, three at the most.
            let rounding = 1e3 * f64::EPSILON * angle.max(1.0);
            for &phi in &phi[..3] {
                assert!(
                    (q[phi] - angle).abs() < rounding,
                    "{step} of {steps}: {}",
                    q[phi] - angle
                );
            }
            assert!(q[phi[3]].abs() < rounding, "{step} of {steps}");
        }
    }
}

/// With their pins in line three cranks laid flat lose rank whatever rows are chosen: refused for
/// that, and not for a contradiction, though nothing holds to rounding there.
#[test]
fn three_cranks_in_line_stop_where_they_are_flat() {
    let text = parallelogram(&[[0.2, 0.0]], 60.0, true);
    let (mut solver, mut path) = assembled(&parse(&text));
    straight_to(&solver, &mut path, 1.2 * PI);
    let blocked = solver
        .follow(&path)
        .expect_err("a change point with redundant rows");
    assert!(
        !matches!(blocked.reason, Reason::Contradiction(_)),
        "{blocked:?}"
    );
    // As near as the rows set aside hold to 1e-9: rounding by the square of the distance.
    assert!((solver.pose().drivers[0] - PI).abs() < 1e-3, "{blocked:?}");
    assert!(solver.residual() < 1.1e-9);
}

/// A change point is one for all rows: redundant ones elsewhere do not keep the mechanism from
/// crossing it.
#[test]
fn a_parallelogram_with_a_doubled_pin_crosses_its_change_points() {
    let text = double(&parallelogram(&[], 60.0, true), "A");
    let (mut solver, mut path) = assembled(&parse(&text));
    let rocker = solver.mechanism().body_id("rocker").expect("it has one");
    for step in 1..=72 {
        let angle = TAU / 6.0 + TAU / 24.0 * f64::from(step);
        straight_to(&solver, &mut path, angle);
        solver
            .follow(&path)
            .unwrap_or_else(|blocked| panic!("{step}: {blocked:?}"));
        // The change points are known to 1e-9, as is what is said next to them.
        let off = solver.pose().q[3 * rocker.index() + 2] - angle;
        assert!(off.abs() < 1e-9, "{step}: {off:e}");
    }
}

/// Chains of loops with one joint too many: at the end, in the middle, and declared before all
/// others where the pattern of the equations does not tell that it is too many.
fn long_chains(loops: usize) -> [(&'static str, String, String); 3] {
    let text = chain(loops, Ground::Zigzag);
    let middle = loops / 2;
    let pivot = joint(
        "again",
        "revolute",
        &format!("ground.O{loops}"),
        &format!("rocker_{loops}.O"),
    );
    let rod = format!(
        "again = {{ type = \"link\", markers = [\"rocker_{}.B\", \"rocker_{middle}.B\"], \
         length = 0.25 }}\n",
        middle - 1
    );
    let pin = joint(
        "pin",
        "revolute",
        &format!("coupler_{middle}.B"),
        &format!("rocker_{middle}.B"),
    );
    let first = text.replacen("[joints]\n", &format!("[joints]\n{pin}"), 1);
    [
        (
            "at the end",
            with_joints(&text, &pivot),
            "joint `again`".to_owned(),
        ),
        (
            "beside a coupler",
            with_joints(&text, &rod),
            "joint `again`".to_owned(),
        ),
        ("declared first", first, format!("joint `B{middle}`")),
    ]
}

/// A long chain is looked at loop by loop: with one dense matrix of this size the test would
/// take minutes.
#[test]
fn one_joint_too_many_in_a_long_chain_is_found() {
    for (what, text, name) in long_chains(45) {
        let (mut solver, mut path) = assembled(&parse(&text));
        let redundancies = solver.redundancies();
        assert_eq!(redundancies.len(), 1, "{what}");
        assert_eq!(redundancies[0].element, name, "{what}");
        let angle = TAU / 6.0 + 0.1;
        straight_to(&solver, &mut path, angle);
        solver
            .follow(&path)
            .unwrap_or_else(|blocked| panic!("{what}: {blocked:?}"));
        // Every rocker turns like the first.
        let phi = |k: usize| {
            let rocker = solver.mechanism().body_id(&format!("rocker_{k}"));
            solver.pose().q[3 * rocker.expect("it has it").index() + 2]
        };
        for k in 2..=45 {
            assert!(
                (phi(k) - phi(1)).abs() < 1e-12,
                "{what}: {k} {}",
                phi(k) - phi(1)
            );
        }
    }
}

/// A rod beside the coupler that may have another length.
fn with_rod() -> Arc<Mechanism> {
    let text = with_joints(
        &parallelogram(&[], 60.0, true),
        "rod = { type = \"link\", markers = [\"crank.A\", \"rocker.B\"], length = \"rod_length\" }",
    );
    parse(&text.replace(
        "[ground.markers]",
        "[parameters]\nrod_length = 0.4\n[ground.markers]",
    ))
}

#[test]
fn a_parameter_that_ends_a_redundancy_is_refused() {
    let mechanism = with_rod();
    let (mut solver, mut path) = assembled(&mechanism);
    let home = solver.pose().clone();
    path.from = vec![0.4];
    path.to = vec![0.41];
    let blocked = solver.follow(&path).expect_err("the rod is too long");
    let Reason::Contradiction(open) = &blocked.reason else {
        panic!("{blocked:?}");
    };
    assert_eq!(open.element, "joint `rod`");
    // The gap is that of the first attempt, over all of the path.
    assert!((open.gap - 0.01).abs() < 1e-12, "{open}");
    // A gap of a thousand millionth of the size counts as one.
    let reached = solver.pose().parameters[0] - 0.4;
    assert!((0.0..1e-9).contains(&reached), "{reached:e}");
    let error = solver.assemble(&path).expect_err("nor can it be assembled");
    let Error::Contradiction { elements, open } = &error else {
        panic!("{error}");
    };
    assert_eq!(elements[..], ["joint `A`", "joint `B`", "joint `rod`"]);
    assert_eq!(open.to_string(), "joint `rod` stays open by 10.00 mm");
    // Nothing is lost.
    solver.restore(&home);
    assert!(solver.residual() < 4.0 * f64::EPSILON);
    path.to = vec![0.4];
    straight_to(&solver, &mut path, 2.0);
    solver.follow(&path).expect("it moves as before");
    assert!(solver.residual() < 8.0 * f64::EPSILON);
}

/// A follower held at the height of a cam that is round for anyone who measures, until it has
/// turned on to its lobe.
#[test]
fn a_redundancy_that_ends_on_the_way_stops_the_mechanism_there() {
    let bodies = body("cam", "O = [0, 0]", "0, 0, \"90*deg\"")
        + &body("follower", "P = [0, 0, \"90*deg\"]", "0, 0.05, 0");
    let joints = joint("O", "revolute", "ground.O", "cam.O")
        + &joint("guide", "translational", "ground.up", "follower.P")
        + "contact = { type = \"cam\", markers = [\"cam.O\", \"follower.P\"], follower = \"knife\", \
           profile = \"0.05 + 0.01*sin(theta/2)^40\" }\n\
           [constraints]\n\
           level = { coordinate = \"y\", markers = [\"ground.O\", \"follower.P\"], value = 0.05 }\n";
    let driver = angle_driver("turn", "ground.O", "cam.O", 90.0);
    let ground = "O = [0, 0]\nup = [0, 0, \"90*deg\"]";
    let text = file(ground, &bodies, &joints, &driver);
    let (mut solver, mut path) = assembled(&parse(&text));
    assert_eq!(solver.redundancies()[0].element, "constraint `level`");
    // The contact is at theta = 90° − u.
    straight_to(&solver, &mut path, -TAU / 12.0);
    let blocked = solver
        .follow(&path)
        .expect_err("the lobe begins on the way");
    let Reason::Contradiction(open) = &blocked.reason else {
        panic!("{blocked:?}");
    };
    assert_eq!(open.element, "constraint `level`");
    // A gap is a thousand millionth of the size, 0.05 m; its rounding is a thousandth of that.
    let theta = 2.0 * (1e-9_f64 * 0.05 / 0.01).powf(1.0 / 40.0).asin();
    let reached = solver.pose().drivers[0];
    assert!((TAU / 4.0 - reached - theta).abs() < 1e-3, "{reached}");
    // What is told is what was found to be open beyond.
    assert!(open.gap > 5e-11, "{open}");
}

/// What was said above is said in the FMU's log, once.
#[test]
fn the_host_is_warned_once() {
    struct Warnings(Arc<Mutex<Vec<String>>>);
    impl Sink for Warnings {
        fn write(&self, status: Status, _: Category, message: &str) {
            if status == Status::Warning {
                let mut warnings = self.0.lock().expect("one thread");
                warnings.push(message.to_owned());
            }
        }
    }
    let warnings = Arc::new(Mutex::new(Vec::new()));
    let sink = Box::new(Warnings(Arc::clone(&warnings)));
    let mechanism = parse(&parallelogram(&[[0.2, 0.1]], 60.0, true));
    let model = MechanismModel::new(mechanism, Interface::CoSimulation).expect("it closes");
    let mut instance = Instance::new(model, sink, false);
    instance.setup_experiment(0.0, None).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    instance.exit_initialization_mode().expect("it starts");
    // Through both flat poses; what is saved next to one goes on as the original does.
    let mut saved = None;
    for step in 0..25 {
        let angle = TAU / 6.0 + TAU / 24.0 * f64::from(step + 1);
        instance.set_real(&[0], &[angle]).expect("an input");
        instance
            .do_step(f64::from(step), 1.0)
            .expect("nothing is in the way");
        if step == 7 {
            // At 180 degrees.
            saved = Some(instance.fmu_state().expect("legal"));
        }
    }
    let outputs: Vec<u32> = (5..14).collect();
    let mut values = [vec![0.0; 9], vec![0.0; 9]];
    instance
        .get_real(&outputs, &mut values[0])
        .expect("readable");
    instance
        .set_fmu_state(&saved.expect("it was saved"))
        .expect("its own");
    for step in 8..25 {
        let angle = TAU / 6.0 + TAU / 24.0 * f64::from(step + 1);
        instance.set_real(&[0], &[angle]).expect("an input");
        instance
            .do_step(f64::from(step), 1.0)
            .expect("nothing is in the way");
    }
    instance
        .get_real(&outputs, &mut values[1])
        .expect("readable");
    assert_eq!(values[0], values[1]);
    let warnings = warnings.lock().expect("one thread");
    assert_eq!(
        warnings[..],
        [
            "constraint equations of joint `O5` are redundant: 1 of its 2 follows from the others; \
          it is set aside and watched"
        ]
    );
}

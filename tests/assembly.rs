//! The first pose, and what is said where there is none.

mod common;

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use biela::kinematics::{Error, Path, Proof, Solver, Verdict};
use biela::mechanism::Mechanism;
use common::{EXACT, assembled, parse, shipped};
use proptest::prelude::*;

fn four_bar() -> String {
    std::fs::read_to_string("mechanisms/four_bar.toml").expect("it is shipped")
}

fn failure(mechanism: &Arc<Mechanism>) -> Error {
    let path = Path::new(mechanism);
    match Solver::new(Arc::clone(mechanism)) {
        Ok(mut solver) => solver.assemble(&path).expect_err("it does not close"),
        Err(error) => error,
    }
}

#[test]
fn shipped_mechanisms_assemble_as_their_closed_forms_say() {
    for exact in EXACT {
        let mechanism = shipped(exact.file);
        let (solver, _) = assembled(&mechanism);
        let driver = biela::mechanism::Jet::constant(solver.pose().drivers[0]);
        for (k, q) in exact.solution(&mechanism, driver).iter().enumerate() {
            // Some eps times a condition above 0.1.
            assert!(
                (solver.pose().q[k] - q.value).abs() < 1e-14,
                "{} q[{k}]",
                exact.file
            );
        }
        assert!(solver.residual() < 4.0 * f64::EPSILON);
    }
}

proptest! {
    /// Estimates off by up to 30 degrees and a third of a link still assemble; which of the two
    /// modes, the sign of the angle from coupler to rocker tells.
    #[test]
    fn rough_estimates_assemble(off in prop::collection::vec(-1.0..1.0_f64, 9)) {
        let mut text = four_bar();
        for (body, estimate) in [
            ("crank", "[0, 0, \"60*deg\"]"),
            ("coupler", "[0.05, 0.09, \"20*deg\"]"),
            ("rocker", "[\"base\", 0, \"110*deg\"]"),
        ].iter().enumerate().map(|(k, (_, estimate))| (k, *estimate)) {
            let truth = [[0.0, 0.0, 60.0], [0.05, 0.0866, 41.45], [0.4, 0.0, 122.8]][body];
            let [x, y, phi] = [0, 1, 2].map(|k| {
                let spread = if k == 2 { 30.0 } else { 0.1 };
                truth[k] + spread * off[3 * body + k]
            });
            let rough = format!("[{x:.6}, {y:.6}, \"{phi:.6}*deg\"]");
            prop_assert!(text.contains(estimate));
            text = text.replace(estimate, &rough);
        }
        let mechanism = parse(&text);
        let (solver, _) = assembled(&mechanism);
        prop_assert!(solver.residual() < 8.0 * f64::EPSILON);
        let q = &solver.pose().q;
        let mode = (q[8] - q[5]).sin();
        let exact = 81.373_073_f64.to_radians().sin();
        // In either mode the transmission angle is the same up to its sign.
        prop_assert!((mode.abs() - exact).abs() < 1e-8, "{mode}");
    }
}

#[test]
fn estimates_left_out_are_good_enough_for_the_shipped_mechanisms() {
    for exact in EXACT {
        let path = format!("mechanisms/{}.toml", exact.file);
        let text: String = std::fs::read_to_string(path)
            .expect("it is shipped")
            .lines()
            .filter(|line| !line.starts_with("estimate"))
            .flat_map(|line| [line, "\n"])
            .collect();
        let (solver, _) = assembled(&parse(&text));
        assert!(solver.residual() < 8.0 * f64::EPSILON, "{}", exact.file);
    }
}

#[test]
fn an_assembled_angle_is_the_one_nearest_its_estimate() {
    let text = four_bar()
        .replace("\"20*deg\"", "\"20*deg - 4*pi\"")
        .replace("\"110*deg\"", "\"110*deg + 2*pi\"");
    let (near, _) = assembled(&shipped("four_bar"));
    let (far, _) = assembled(&parse(&text));
    let (near, far) = (&near.pose().q, &far.pose().q);
    for (k, turns) in [(2, 0.0), (5, -2.0), (8, 1.0)] {
        assert!((far[k] - near[k] - turns * TAU).abs() < 1e-13, "q[{k}]");
    }
}

#[test]
fn angle_rows_hold_modulo_one_turn_and_keep_their_turn() {
    // The slider's estimate is two turns away: its guide holds it there.
    let text = std::fs::read_to_string("mechanisms/slider_crank.toml")
        .expect("it is shipped")
        .replace(
            "estimate = [0.18, 0.01, 0]",
            "estimate = [0.18, 0.01, \"4*pi\"]",
        );
    let (solver, _) = assembled(&parse(&text));
    assert!((solver.pose().q[8] - 2.0 * TAU).abs() < 1e-13);
}

/// The crank's tip is at most 0.25 + 0.30 from (0.4, 0): at 60 degrees a crank of 0.8 m is
/// √(0.8² + 0.4² − 0.8·0.4) = 0.6928 m away, 0.1428 m too far.
#[test]
fn a_crank_too_long_is_proved_to_leave_one_joint_open() {
    let mechanism = parse(&four_bar().replace("value = 0.10", "value = 0.80"));
    let error = failure(&mechanism);
    let Error::NotAssembled {
        verdict,
        open,
        nearest,
    } = &error
    else {
        panic!("{error}")
    };
    assert!(
        matches!(
            verdict,
            Verdict::Impossible {
                proof: Proof::Reach { .. },
                ways: 1
            }
        ),
        "{error}"
    );
    let distance = (0.64_f64 + 0.16 - 0.32).sqrt();
    assert_eq!(open.len(), 1, "{error}");
    assert_eq!(open[0].element, "joint `O4`");
    // Some eps of the lengths.
    assert!((open[0].gap - (distance - 0.55)).abs() < 1e-15, "{error}");
    assert_eq!(
        error.to_string(),
        "the mechanism cannot close: joint `O4` stays open by 142.8 mm; `crank.A` and \
         `ground.O4` are 692.8 mm apart, `coupler` and `rocker` together span 50.00 mm to 550.0 mm"
    );
    // The crank's tip is right above the pivot: stretched out, the links point straight down and
    // back up.
    assert!((nearest[5] + FRAC_PI_2).abs() < 1e-14, "{nearest:?}");
    assert!((nearest[8] - FRAC_PI_2).abs() < 1e-14, "{nearest:?}");
}

#[test]
fn a_flat_parallelogram_is_singular_not_open() {
    let text = four_bar()
        .replace("value = 0.25", "value = 0.40")
        .replace("value = 0.30", "value = 0.10")
        .replace("start = \"60*deg\"", "start = 0")
        .replace("\"60*deg\"", "0")
        .replace("\"20*deg\"", "0")
        .replace("\"110*deg\"", "0");
    let error = failure(&parse(&text));
    assert!(
        matches!(error, Error::Singular { rcond, .. } if rcond < 1e-7),
        "{error}"
    );
}

#[test]
fn drivers_have_to_match_the_degrees_of_freedom() {
    let undriven = four_bar().replace(
        "crank_angle = { coordinate = \"angle\", markers = [\"ground.O2\", \"crank.O\"], start = \"60*deg\" }",
        "",
    );
    let error = failure(&parse(&undriven));
    assert_eq!(
        error.to_string(),
        "the mechanism has 1 degree of freedom and no driver; free to move: body `crank`, body \
         `coupler`, body `rocker`: add a driver for one of them"
    );

    let twice = four_bar().replace(
        "[measures]",
        "rocker_angle = { coordinate = \"angle\", markers = [\"ground.O4\", \"rocker.O\"], \
         start = \"120*deg\" }\n[measures]",
    );
    let error = failure(&parse(&twice));
    let Error::Structure { loose, excess, .. } = &error else {
        panic!("{error}")
    };
    assert!(loose.is_empty(), "{error}");
    assert!(
        excess.contains(&"driver `rocker_angle`".to_owned()),
        "{error}"
    );
}

#[test]
fn as_many_equations_as_unknowns_in_the_wrong_places_are_named() {
    // The driver holds the slider's angle, which its guide holds already; the crank is free.
    let text = std::fs::read_to_string("mechanisms/slider_crank.toml")
        .expect("it is shipped")
        .replace(
            "markers = [\"ground.O\", \"crank.O\"], start = \"45*deg\"",
            "markers = [\"ground.guide\", \"slider.B\"], start = 0",
        );
    let error = failure(&parse(&text));
    let Error::Structure { loose, excess, .. } = &error else {
        panic!("{error}")
    };
    assert!(loose.contains(&"body `crank`".to_owned()), "{error}");
    assert_eq!(
        excess[..],
        ["joint `guide`", "driver `crank_angle`"],
        "{error}"
    );
}

#[test]
fn values_that_make_no_mechanism_are_named() {
    let mechanism = parse(
        r#"
        format = 1
        name = "link"
        [parameters]
        l = { value = 1, min = -2 }
        r = { value = 1, min = -2 }
        [ground.markers]
        O = [0, 0]
        Q = [1, 1]
        [bodies.b]
        markers = { O = [0, 0], P = ["sqrt(r)", 0] }
        [joints]
        O = { type = "revolute", markers = ["ground.O", "b.O"] }
        rod = { type = "link", markers = ["b.P", "ground.Q"], length = "l" }
        "#,
    );
    let (mut solver, mut path) = assembled(&mechanism);
    let home = solver.pose().clone();
    path.to = vec![-1.0, 1.0];
    let error = solver.assemble(&path).expect_err("a length is positive");
    assert_eq!(
        error.to_string(),
        "joint `rod` would hold a distance at -1 m; a distance must be positive"
    );
    path.to = vec![1.0, -1.0];
    let error = solver.assemble(&path).expect_err("no root of -1");
    assert_eq!(
        error.to_string(),
        "marker `b.P` has no finite value with these parameter values"
    );
    // Nothing is lost.
    solver.restore(&home);
    assert_eq!(solver.pose(), &home);
    assert!(solver.residual() < 4.0 * f64::EPSILON);
}

/// Squares of such lengths overflow: an answer, not an endless search.
#[test]
fn lengths_beyond_all_numbers_are_answered() {
    for (file, parameter) in [
        ("four_bar", "crank_length"),
        ("tlv", "arm_length"),
        ("tlv", "base"),
        ("slider_crank", "rod_length"),
    ] {
        let mechanism = shipped(file);
        let parameter = mechanism.parameter_id(parameter).expect("it has one");
        for value in [1e160, 1e300] {
            let (mut solver, mut path) = assembled(&mechanism);
            path.to[parameter.index()] = value;
            let error = solver.assemble(&path).expect_err(file).to_string();
            assert!(!error.ends_with(": "), "{file}: {error}");
        }
    }
}

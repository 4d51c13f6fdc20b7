//! The first pose, and what is said where there is none.

mod random;

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use crate::common::exact::EXACT;
use crate::common::{assembled, parse, shipped, text};
use crate::generated::{BAR, scissor_lift};
use biela::kinematics::{Error, Path, Proof, Solver, Verdict};
use biela::mechanism::Mechanism;
use proptest::prelude::*;

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
        let mut text = text("mechanisms/four_bar.toml");
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
    let text = text("mechanisms/four_bar.toml")
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
    let mechanism =
        parse(&text("mechanisms/four_bar.toml").replace("value = 0.10", "value = 0.80"));
    let error = failure(&mechanism);
    let Error::NotAssembled {
        verdict,
        open,
        nearest,
        ..
    } = &error
    else {
        panic!("{error}")
    };
    let Verdict::Impossible { proof, ways: 1 } = verdict else {
        panic!("{error}")
    };
    assert!(matches!(**proof, Proof::Reach { .. }), "{error}");
    let distance = (0.64_f64 + 0.16 - 0.32).sqrt();
    assert_eq!(open.len(), 1, "{error}");
    assert_eq!(open[0].origin, "joint `O4`");
    // Some eps of the lengths.
    assert!((open[0].gap - (distance - 0.55)).abs() < 1e-15, "{error}");
    assert_eq!(
        error.to_string(),
        "the mechanism cannot close: joint `O4` stays open by 142.8 mm; `crank.A` and \
         `ground.O4` are 692.8 mm apart, `coupler` and `rocker` together span 50.00 mm to 550.0 mm; \
         body `rocker` would reach with more than 442.9 mm from `B` to `O`, which is 300.0 mm now"
    );
    // The crank's tip is right above the pivot: stretched out, the links point straight down and
    // back up.
    assert!((nearest[5] + FRAC_PI_2).abs() < 1e-14, "{nearest:?}");
    assert!((nearest[8] - FRAC_PI_2).abs() < 1e-14, "{nearest:?}");
}

#[test]
fn a_flat_parallelogram_is_singular_not_open() {
    let text = text("mechanisms/four_bar.toml")
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
    let undriven = text("mechanisms/four_bar.toml").replace(
        "crank_angle = { coordinate = \"angle\", markers = [\"ground.O2\", \"crank.O\"], start = \"60*deg\" }",
        "",
    );
    let error = failure(&parse(&undriven));
    assert_eq!(
        error.to_string(),
        "the mechanism has 1 degree of freedom and no driver; free to move: body `crank`, body \
         `coupler`, body `rocker`: add a driver for one of them; `turn = { coordinate = \"angle\", \
         markers = [\"ground.O2\", \"crank.O\"] }` under `[drivers]`, with a `start` or a `motion`, \
         drives it, and under `[freedoms]` the forces move it"
    );

    let twice = text("mechanisms/four_bar.toml").replace(
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

/// Parallelograms hung on each other: cranks of 1 on pivots 2 apart, the first driven, couplers
/// of 2 but for the last, which has this length.
fn chain(loops: usize, last: f64) -> Arc<Mechanism> {
    let mut text = String::from("format = 1\nname = \"chain\"\n[ground.markers]\n");
    let (mut bodies, mut joints) = (String::new(), String::new());
    for k in 0..=loops {
        let x = 2 * k;
        text += &format!("O{k} = [{x}, 0]\n");
        bodies += &format!(
            "[bodies.crank_{k}]\nmarkers = {{ O = [0, 0], A = [1, 0] }}\n\
             estimate = [{x}, 0, \"60*deg\"]\n"
        );
        joints += &format!(
            "O{k} = {{ type = \"revolute\", markers = [\"ground.O{k}\", \"crank_{k}.O\"] }}\n"
        );
        if let Some(before) = k.checked_sub(1) {
            let length = if k == loops { last } else { 2.0 };
            bodies += &format!(
                "[bodies.coupler_{k}]\nmarkers = {{ A = [0, 0], B = [{length}, 0] }}\n\
                 estimate = [\"{x} - 1.5\", 0.9, 0]\n"
            );
            joints += &format!(
                "A{k} = {{ type = \"revolute\", markers = [\"crank_{before}.A\", \"coupler_{k}.A\"] }}\n\
                 B{k} = {{ type = \"revolute\", markers = [\"coupler_{k}.B\", \"crank_{k}.A\"] }}\n"
            );
        }
    }
    text += &format!(
        "{bodies}[joints]\n{joints}[drivers]\n\
         angle = {{ coordinate = \"angle\", markers = [\"ground.O0\", \"crank_0.O\"], \
         start = \"60*deg\" }}\n"
    );
    parse(&text)
}

/// At 60 degrees the tip of a crank is √3 from the next pivot. A last coupler of 3.5 needs 2.5 at
/// least, which only a crank that is crossed has: mirrored in the line from the tip before it,
/// which points to −30 degrees, its angle is −120 degrees, and its tip √7 from the last pivot.
#[test]
fn the_last_loop_of_a_chain_sends_only_the_one_before_it_to_its_other_mode() {
    const LOOPS: usize = 300;
    let mechanism = chain(LOOPS, 3.5);
    let (solver, _) = assembled(&mechanism);
    let phi = |k: usize| {
        let body = mechanism
            .body_id(&format!("crank_{k}"))
            .expect("it is there");
        solver.pose().q[3 * body.index() + 2]
    };
    for k in 0..LOOPS - 1 {
        assert!((phi(k) - PI / 3.0).abs() < 1e-12, "crank {k}");
    }
    assert!((phi(LOOPS - 1) + 2.0 * PI / 3.0).abs() < 1e-12);
    assert!(solver.residual() < 1e-14);
}

/// No tip is nearer than 1 to the next pivot, so that links of 0.4 and 1 close in no mode of the
/// 2²⁹⁹ before them unless the crank before points nearly at it: nobody can try them all.
#[test]
fn a_chain_of_too_many_modes_is_not_said_to_be_impossible() {
    let error = failure(&chain(300, 0.4));
    let Error::NotAssembled { verdict, open, .. } = &error else {
        panic!("{error}")
    };
    assert!(
        matches!(verdict, Verdict::NotFound { starts } if *starts > 100),
        "{error}"
    );
    assert_eq!(open.len(), 1, "{error}");
    assert_eq!(open[0].origin, "joint `B300`");
    // The parallel mode leaves √3 − 1.4, the crossed one before it √7 − 1.4.
    assert!(
        (open[0].gap - (3_f64.sqrt() - 1.4)).abs() < 1e-12,
        "{error}"
    );
}

/// A scissor lift of sixty cells is one block of 360 unknowns. It stands at most as high as its
/// bars are long together; where more is asked for there is neither a closed form nor room for
/// bounds, but an answer, with the lift stretched to its full height.
#[test]
fn a_large_block_that_does_not_close_is_answered() {
    const CELLS: usize = 60;
    let text = scissor_lift(CELLS);
    let (before, _) = text.split_once("start = ").expect("it has a driver");
    let height = BAR * CELLS as f64;
    let error = failure(&parse(&format!("{before}start = {} }}\n", 1.5 * height)));
    let Error::NotAssembled { verdict, open, .. } = &error else {
        panic!("{error}")
    };
    assert!(matches!(verdict, Verdict::NotFound { .. }), "{error}");
    let gaps: f64 = open.iter().map(|joint| joint.gap).sum();
    assert!(
        gaps > 0.0 && error.to_string().contains("no proof"),
        "{error}"
    );
}

/// A belt from a wheel, which a rod holds at one of two angles, to a wheel on the coupler of a four-bar.
const BELT_ON_COUPLER: &str = r#"
format = 1
name = "belt_on_coupler"
[ground.markers]
O = [0.0, 0.0, 0.0]
D = [0.38594992650190496, 0.0, 0.0]
G = [0.1315224448515666, -0.22659539428996406, -0.7735187006958495]
[bodies.crank]
markers = { a = [0, 0], b = [0.18874190485752187, 0] }
estimate = [-0.05934795991805433, -0.1451574210273714, 2.2147717778313702]
[bodies.coupler]
markers = { a = [0, 0], b = [0.4663722597724724, 0], w = [0, 0, 2.674002420991302] }
estimate = [-0.2580791628660719, 0.2572330547570323, -0.7210971819941532]
[bodies.rocker]
markers = { a = [0, 0], b = [0.0861779043301373, 0] }
estimate = [0.32777665146131485, -0.12020740376703604, -2.477058917432659]
[bodies.wheel]
markers = { a = [0.0, 0.0, 0.0], b = [0.11138596836302196, 1.734723475976807e-18, 0.0], w = [0.0, 0.0, 3.7326525929192136] }
estimate = [-0.0594110349793526, 0.14926622992390332, -0.7728577927603897]
[bodies.rod]
markers = { a = [0, 0], b = [0.16580457565895382, 0] }
estimate = [0.1550850060452913, -0.2690794942597517, -1.3313167040969924]
[joints]
O = { type = "revolute", markers = ["ground.O", "crank.a"] }
W = { type = "revolute", markers = ["ground.O", "wheel.a"] }
A = { type = "revolute", markers = ["crank.b", "coupler.a"] }
B = { type = "revolute", markers = ["coupler.b", "rocker.b"] }
D = { type = "revolute", markers = ["ground.D", "rocker.a"] }
H = { type = "revolute", markers = ["wheel.b", "rod.a"] }
G = { type = "slot", markers = ["ground.G", "rod.b"] }
mesh = { type = "belt", markers = ["coupler.w", "wheel.w"], teeth = [25, 53], carrier = "crank" }
[drivers]
u = { coordinate = "x", markers = ["ground.G", "rod.b"], start = 0.0 }
"#;

/// The coupler turns with the crank in a ratio, so that the four-bar closes at single angles: behind
/// the angle of the wheel that is nearest its estimate some turns away, behind the other one near the
/// estimates.
#[test]
fn a_loop_that_counts_turns_closes_near_its_estimates() {
    let mechanism = parse(BELT_ON_COUPLER);
    let (solver, _) = assembled(&mechanism);
    assert!(solver.residual() < 1e-14);
    for (body, q) in mechanism.bodies.iter().zip(solver.pose().q.chunks_exact(3)) {
        let estimate = body.estimate[2].literal().expect("it is a number");
        assert!((q[2] - estimate).abs() < 1.0, "{}: {}", body.name, q[2]);
    }
}

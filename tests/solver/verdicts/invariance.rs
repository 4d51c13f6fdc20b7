//! Transformations of a mechanism that change nothing: moved, turned, with an unrelated mechanism
//! beside it.

use std::f64::consts::TAU;
use std::sync::Arc;

use biela::kinematics::{DriverPath, Path, Solver};
use biela::mechanism::{JointKind, Mechanism, Source};

use crate::common::mechanisms::{four_bar, slider_crank};
use crate::common::{assembled, moved, solve, stems};

/// A mechanism file as shipped.
fn text(name: &str) -> String {
    let path = format!("{}/mechanisms/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).expect("shipped mechanisms can be read")
}

/// A run of the first driver that is an input: over a turn, or over a tenth of its value.
struct Run {
    /// The pose after each step that succeeded.
    poses: Vec<Vec<f64>>,
    /// The driver's value at the end.
    reached: f64,
    substeps: Vec<u32>,
}

/// Number of steps of a run.
const STEPS: usize = 24;

fn run(mechanism: &Arc<Mechanism>) -> Option<Run> {
    let input = |driver: &biela::mechanism::Driver| driver.motion().is_none();
    // A freedom first: it is not an unrelated driver.
    let mut freedoms = mechanism.drivers.iter();
    let freedom = freedoms.position(biela::mechanism::Driver::is_free);
    let driver = freedom.or_else(|| mechanism.drivers.iter().position(input))?;
    let (mut solver, mut path) = assembled(mechanism);
    let start = solver.pose().drivers[driver];
    let way = if mechanism.drivers[driver].coordinate.kind.is_angle() {
        TAU
    } else {
        0.1 * start
    };
    let mut run = Run {
        poses: vec![solver.pose().q.clone()],
        reached: start,
        substeps: Vec::new(),
    };
    for step in 1..=STEPS {
        let to = start + way * step as f64 / STEPS as f64;
        hold(&solver, &mut path);
        path.driver_paths[driver] = DriverPath::Input {
            position: to,
            velocity: 0.0,
            acceleration: 0.0,
            jump: solver.pose().drivers[driver] - to,
        };
        let tracked = solver.track(&path);
        run.reached = solver.pose().drivers[driver];
        match tracked {
            Ok(progress) => run.substeps.push(progress.substeps),
            Err(_) => break,
        }
        run.poses.push(solver.pose().q.clone());
    }
    Some(run)
}

/// Lets all drivers stay where they are.
fn hold(solver: &Solver, path: &mut Path) {
    path.start = solver.pose().time;
    path.from.clone_from(&solver.pose().parameters);
    path.to.clone_from(&solver.pose().parameters);
    for (driver_path, value) in path.driver_paths.iter_mut().zip(&solver.pose().drivers) {
        if let DriverPath::Input { .. } = driver_path {
            *driver_path = DriverPath::Input {
                position: *value,
                velocity: 0.0,
                acceleration: 0.0,
                jump: 0.0,
            };
        }
    }
}

/// Expects the same verdict, the same branch and the same effort: as many steps, poses that
/// `places` makes of the others, and sub-steps within a factor of two.
fn expect_alike(name: &str, here: &Run, there: &Run, places: impl Fn(&[f64]) -> Vec<f64>) {
    assert_eq!(here.poses.len(), there.poses.len(), "{name}");
    // Dead points are located to the square root of the rounding of what is near them.
    assert!((here.reached - there.reached).abs() < 1e-6, "{name}");
    for (step, (q, other)) in here.poses.iter().zip(&there.poses).enumerate() {
        for (k, (expected, found)) in places(q).iter().zip(other).enumerate() {
            // Next to change points outputs are interpolated, to 1e-9.
            assert!(
                (expected - found).abs() < 1e-8,
                "{name}, step {step}, unknown {k}: {expected} {found}"
            );
        }
    }
    for (step, (a, b)) in here.substeps.iter().zip(&there.substeps).enumerate() {
        let [fewer, more] = [a.min(b), a.max(b)];
        assert!(
            *more <= 2 * fewer + 1,
            "{name}, step {step}: {a} and {b} sub-steps"
        );
    }
}

#[test]
fn a_moved_and_turned_mechanism_moves_alike() {
    for name in stems("mechanisms", "toml") {
        let mechanism = crate::common::shipped(&name);
        // Wheels on ground count their angles from ground itself, which cannot be turned.
        let on_ground = |joint: &biela::mechanism::Joint| {
            matches!(
                joint.kind,
                JointKind::Gear { carrier: None, .. } | JointKind::Belt { carrier: None, .. }
            )
        };
        if mechanism.joints.iter().any(on_ground) {
            continue;
        }
        let Some(here) = run(&mechanism) else {
            continue;
        };
        let bodies = 3 * mechanism.bodies.len();
        for (turn, to) in [(0.3, [0.0, 0.0]), (2.0, [0.7, -1.1])] {
            let there = run(&moved(&mechanism, turn, to)).expect("it has the same drivers");
            let (sin, cos) = f64::sin_cos(turn);
            expect_alike(&name, &here, &there, |q| {
                let mut q = q.to_vec();
                for body in q[..bodies].chunks_exact_mut(3) {
                    let (x, y) = (body[0], body[1]);
                    body[0] = cos * x - sin * y + to[0];
                    body[1] = sin * x + cos * y + to[1];
                    body[2] += turn;
                }
                q
            });
        }
    }
}

#[test]
fn an_unrelated_mechanism_beside_it_changes_nothing() {
    for name in stems("mechanisms", "toml") {
        let mechanism = crate::common::shipped(&name);
        // Files of tables are found beside the mechanism file only.
        if !mechanism.table_files.is_empty() {
            continue;
        }
        let Some(here) = run(&mechanism) else {
            continue;
        };
        for length in ["0.1", "1e6", "1e-7"] {
            beside_an_arm(&name, &here, 3 * mechanism.bodies.len(), length);
        }
    }
}

#[test]
fn an_arm_of_any_size_beside_it_leaves_the_nearest_mode_the_same() {
    // Estimates all around: lengths speak for one mode and angles for the other in many of them.
    let spread = |k: usize| 4.0 * (0.618_033_988_749_894_9 * k as f64).fract() - 2.0;
    for k in 0..100 {
        let estimate = |body: usize| {
            let [x, y, phi] = [0, 1, 2].map(|i| spread(9 * k + 3 * body + i));
            format!("{x}, {y}, {phi}")
        };
        let estimates = [estimate(0), estimate(1), estimate(2)];
        let estimates = estimates.each_ref().map(String::as_str);
        // Origins far from the joints, so that both modes have places of their own.
        let four_bar = four_bar([1.0, 3.0, 2.5, 3.0], "70*deg", estimates)
            .replace("A = [0, 0], B = [3, 0]", "A = [-1.5, 0], B = [1.5, 0]")
            .replace("O = [0, 0], B = [2.5, 0]", "O = [-2.5, 0], B = [0, 0]");
        for text in [four_bar, slider_crank([1.0, 2.0], 0.3, "70*deg", estimates)] {
            let alone = solve(&text).expect("it closes");
            let bodies = alone.pose().q.len();
            for length in ["1e6", "1e3", "1e-3", "1e-7"] {
                let beside = solve(&with_arm(&text, length)).expect("it closes");
                for (a, b) in alone.pose().q.iter().zip(&beside.pose().q[..bodies]) {
                    assert!((a - b).abs() < 1e-13, "{estimates:?} beside {length} m");
                }
            }
        }
    }
}

/// Returns the file of a mechanism with an unrelated arm of this length beside it, declared last, so
/// that the unknowns before keep their places.
pub(crate) fn with_arm(text: &str, length: &str) -> String {
    text.replacen(
        "[ground.markers]",
        "[ground.markers]\nunrelated = [0.1, 0.2]",
        1,
    ) + &format!(
        "\n[bodies.unrelated_arm]\nmarkers = {{ O = [0, 0], P = [{length}, 0] }}\n\
         [joints.unrelated_pin]\ntype = \"revolute\"\n\
         markers = [\"ground.unrelated\", \"unrelated_arm.O\"]\n\
         [drivers.unrelated_turn]\ncoordinate = \"angle\"\n\
         markers = [\"ground.unrelated\", \"unrelated_arm.O\"]\nstart = 0.5\n"
    )
}

/// Compares a run with that of the mechanism beside an arm of this length, be it a million times
/// larger or smaller.
fn beside_an_arm(name: &str, here: &Run, bodies: usize, length: &str) {
    let beside = with_arm(&text(name), length);
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/mechanisms");
    let source = Source::new(format!("{folder}/{name}.toml"), beside);
    let Ok((beside, _)) = Mechanism::parse(&source) else {
        panic!("{name} with an unrelated arm");
    };
    let there = run(&Arc::new(beside)).expect("it has the same drivers");
    let there = Run {
        poses: there
            .poses
            .iter()
            .map(|q| [&q[..bodies], &q[bodies + 3..]].concat())
            .collect(),
        ..there
    };
    let name = format!("{name} beside an arm of {length} m");
    expect_alike(&name, here, &there, <[f64]>::to_vec);
}

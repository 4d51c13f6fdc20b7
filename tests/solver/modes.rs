//! All the ways in which a mechanism closes.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::sync::Arc;

use crate::common::{assembled, parse, pasted};
use biela::kinematics::{AssemblyMode, Error, Modes, Path, Solver, Verdict};
use biela::mechanism::Mechanism;

fn shipped_text(name: &str) -> String {
    std::fs::read_to_string(format!("mechanisms/{name}.toml")).expect("it is shipped")
}

/// The other modes of a mechanism. Each is checked to be one: pasted into the file, the mechanism
/// assembles there.
fn modes_of(text: &str) -> Modes {
    let mechanism = parse(text);
    let (mut solver, _) = assembled(&mechanism);
    let home = solver.pose().clone();
    let modes = solver.modes().expect("the estimates are numbers");
    assert_eq!(solver.pose(), &home);
    let mut seen = vec![home.q];
    for mode in &modes.others {
        let text = pasted(text, &estimates(&mechanism, mode));
        let (other, _) = assembled(&parse(&text));
        let q = &other.pose().q;
        // The rounding of the pose over its condition; assembly starts from all its digits.
        assert!(apart(q, &mode.q) < 1e-13 / mode.rcond, "{text}");
        assert!(other.residual() < 1e-14);
        for known in &seen {
            assert!(apart(q, known) > 1e-3, "twice the same: {q:?}");
        }
        seen.push(q.clone());
    }
    modes
}

fn estimates(mechanism: &Mechanism, mode: &AssemblyMode) -> String {
    let bodies = mechanism.bodies.iter().zip(mode.q.chunks_exact(3));
    bodies.fold(String::new(), |mut out, (body, q)| {
        let [x, y, phi] = [q[0], q[1], q[2]];
        let _ = writeln!(out, "[bodies.{}]\nestimate = [{x}, {y}, {phi}]", body.name);
        out
    })
}

/// The largest difference of two poses, angles modulo whole turns.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).enumerate().map(|(k, (a, b))| {
        let turns = if k % 3 == 2 {
            ((a - b) / TAU).round()
        } else {
            0.0
        };
        (a - b - TAU * turns).abs()
    });
    differences.fold(0.0, f64::max)
}

/// The points in which two circles meet.
fn meet(a: [f64; 2], radius_a: f64, b: [f64; 2], radius_b: f64) -> Option<[[f64; 2]; 2]> {
    let (x, y) = (b[0] - a[0], b[1] - a[1]);
    let square = x * x + y * y;
    let along = 0.5 * (1.0 + (radius_a - radius_b) * (radius_a + radius_b) / square);
    let across = radius_a * radius_a / square - along * along;
    (across > 0.0).then(|| {
        [across.sqrt(), -across.sqrt()]
            .map(|h| [a[0] + along * x - h * y, a[1] + along * y + h * x])
    })
}

/// The poses that a search for many variants finds are the assembled one and the other modes.
#[test]
fn poses_are_those_of_all_modes() {
    for name in ["four_bar", "slider_crank", "jansen_leg"] {
        let mechanism = parse(&shipped_text(name));
        let (mut solver, _) = assembled(&mechanism);
        let mut expected = vec![solver.pose().q.clone()];
        let others = solver.modes().expect("the estimates are numbers").others;
        expected.extend(others.into_iter().map(|mode| mode.q));
        let path = Path::new(solver.mechanism());
        let poses = solver.poses(&path).expect("the values are valid");
        assert_eq!(poses.len(), expected.len(), "{name}");
        for q in &expected {
            let nearest = poses.iter().map(|pose| apart(&pose.q, q));
            assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-12, "{name}");
        }
        for pose in &poses {
            solver.restore(pose);
            assert!(solver.residual() < 1e-14, "{name}");
        }
    }
}

/// A crank that is too long has no pose.
#[test]
fn a_mechanism_that_does_not_close_has_no_poses() {
    let mechanism = parse(&shipped_text("four_bar"));
    let (mut solver, _) = assembled(&mechanism);
    let mut path = Path::new(solver.mechanism());
    let crank = mechanism.parameter_id("crank_length").expect("it has one");
    path.to[crank.index()] = 1.0;
    assert!(
        solver
            .poses(&path)
            .expect("the values are valid")
            .is_empty()
    );
}

#[test]
fn loops_of_dyads_and_slides_have_all_their_modes() {
    for (name, others) in [
        ("pendulum", 0),
        ("four_bar", 1),
        ("slider_crank", 1),
        ("five_bar_robot", 1),
    ] {
        let modes = modes_of(&shipped_text(name));
        assert!(modes.complete, "{name}");
        assert_eq!((modes.others.len(), modes.starts), (others, 0), "{name}");
    }
}

/// The crank's four-bar closes in two ways, and the second loop in two for each of them if its
/// links reach: counted by circles that meet.
#[test]
fn six_bars_have_as_many_modes_as_circles_meet() {
    // From the file: crank 40, coupler A–B–C equilateral of 100, rocker 100 from (80, 0), then
    // 107 and an output link to (77.5, 115.2) [mm].
    let text = shipped_text("stephenson_six_bar");
    let mut counts = Vec::new();
    for (degrees, output) in [(90.0_f64, 0.1), (0.0, 0.1), (90.0, 0.03), (180.0, 0.03)] {
        let theta = degrees.to_radians();
        let a = [0.04 * theta.cos(), 0.04 * theta.sin()];
        let ways = meet(a, 0.1, [0.08, 0.0], 0.1).expect("the crank turns fully");
        let closes = |b: &&[f64; 2]| {
            let (x, y) = (b[0] - a[0], b[1] - a[1]);
            let (sin, cos) = 60_f64.to_radians().sin_cos();
            let c = [a[0] + cos * x - sin * y, a[1] + sin * x + cos * y];
            meet(c, 0.107, [0.0775, 0.1152], output).is_some()
        };
        let expected = 2 * ways.iter().filter(closes).count();
        let text = text
            .replace("start = \"90*deg\"", &format!("start = \"{degrees}*deg\""))
            .replace(
                "output_length  = { value = 0.100",
                &format!("output_length = {{ value = {output}"),
            );
        let modes = modes_of(&text);
        assert!(modes.complete, "{degrees}, {output}");
        assert_eq!(modes.others.len() + 1, expected, "{degrees}, {output}");
        counts.push(expected);
    }
    // Both answers occur.
    assert!(counts.contains(&2) && counts.contains(&4), "{counts:?}");
}

/// A triangle whose corners lie on three circles: their centres and radii, and the corners in
/// the triangle's frame.
struct Triad {
    centres: [[f64; 2]; 3],
    radii: [f64; 3],
    corners: [[f64; 2]; 3],
}

impl Triad {
    /// In how many ways it closes, by turning the triangle in small steps: the first two circles
    /// leave two places for it, and the third distance changes its sign at a way.
    fn count(&self) -> usize {
        const STEPS: usize = 5_000;
        let turned = |corner: [f64; 2], phi: f64| {
            let (sin, cos) = phi.sin_cos();
            [
                cos * corner[0] - sin * corner[1],
                sin * corner[0] + cos * corner[1],
            ]
        };
        let excess = |step: usize| {
            let phi = TAU * step as f64 / STEPS as f64;
            let arms = self.corners.map(|corner| turned(corner, phi));
            let centre = |k: usize| [0, 1].map(|c| self.centres[k][c] - arms[k][c]);
            let places = meet(centre(0), self.radii[0], centre(1), self.radii[1])?;
            let third = centre(2);
            Some(places.map(|p| (p[0] - third[0]).hypot(p[1] - third[1]) > self.radii[2]))
        };
        let mut count = 0;
        for step in 0..STEPS {
            match (excess(step), excess(step + 1)) {
                (Some(a), Some(b)) => {
                    count += usize::from(a[0] != b[0]) + usize::from(a[1] != b[1]);
                }
                // Circles that only touch have one common place: a sign that differs
                // between them changes before that.
                (Some(ends), None) | (None, Some(ends)) => count += usize::from(ends[0] != ends[1]),
                (None, None) => {}
            }
        }
        count
    }
}

impl Triad {
    /// As a platform on three legs, estimated nowhere in particular.
    fn platform(&self) -> String {
        let Self {
            centres: [a1, a2, a3],
            radii: [r1, r2, r3],
            corners: [b1, b2, b3],
        } = self;
        format!(
            r#"
format = 1
name = "platform"
[ground.markers]
A1 = {a1:?}
A2 = {a2:?}
A3 = {a3:?}
[bodies.leg_1]
markers = {{ A = [0, 0] }}
[bodies.leg_2]
markers = {{ A = [0, 0] }}
[bodies.leg_3]
markers = {{ A = [0, 0] }}
[bodies.platform]
markers = {{ B1 = {b1:?}, B2 = {b2:?}, B3 = {b3:?} }}
[joints]
A1 = {{ type = "revolute", markers = ["ground.A1", "leg_1.A"] }}
A2 = {{ type = "revolute", markers = ["ground.A2", "leg_2.A"] }}
A3 = {{ type = "revolute", markers = ["ground.A3", "leg_3.A"] }}
B1 = {{ type = "slot", markers = ["leg_1.A", "platform.B1"] }}
B2 = {{ type = "slot", markers = ["leg_2.A", "platform.B2"] }}
B3 = {{ type = "slot", markers = ["leg_3.A", "platform.B3"] }}
[drivers]
length_1 = {{ coordinate = "x", markers = ["leg_1.A", "platform.B1"], start = {r1} }}
length_2 = {{ coordinate = "x", markers = ["leg_2.A", "platform.B2"], start = {r2} }}
length_3 = {{ coordinate = "x", markers = ["leg_3.A", "platform.B3"], start = {r3} }}
"#
        )
    }
}

/// The planar platform of three legs by which six assembly modes were first shown (Gosselin,
/// Sefrioui and Richard 1992): base (0, 0), (15.91, 0), (0, 10), platform with the sides 17.04,
/// 16.54 and 20.84, legs 14.98, 15.38 and 12.
#[test]
fn a_platform_on_three_legs_has_six_modes() {
    let cos = (17.04_f64.powi(2) + 20.84_f64.powi(2) - 16.54_f64.powi(2)) / (2.0 * 17.04 * 20.84);
    let third = [20.84 * cos, 20.84 * (1.0 - cos * cos).sqrt()];
    let triad = Triad {
        centres: [[0.0, 0.0], [15.91, 0.0], [0.0, 10.0]],
        radii: [14.98, 15.38, 12.0],
        corners: [[0.0, 0.0], [17.04, 0.0], third],
    };
    assert_eq!(triad.count(), 6);
    let modes = modes_of(&triad.platform());
    assert_eq!(modes.others.len() + 1, 6);
    assert!(modes.complete && modes.starts == 0);
}

/// No mode of a platform is missed, and none is made up: against the count of signs.
#[test]
fn platforms_have_as_many_modes_as_their_circles_say() {
    // Spread evenly by the golden ratio.
    let mut spread = (1..).map(|k| (0.618_033_988_749_894_9 * f64::from(k * k)).fract());
    let mut next = |low: f64, high: f64| low + (high - low) * spread.next().unwrap_or_default();
    let mut counts = [0; 7];
    for _ in 0..16 {
        let triad = Triad {
            centres: [
                [0.0, 0.0],
                [next(2.0, 4.0), 0.0],
                [next(0.0, 3.0), next(1.0, 4.0)],
            ],
            radii: [0; 3].map(|_| next(0.5, 4.0)),
            corners: [
                [0.0, 0.0],
                [next(0.5, 3.0), 0.0],
                [next(-1.0, 3.0), next(-3.0, 3.0)],
            ],
        };
        let expected = triad.count();
        counts[expected] += 1;
        let mechanism = parse(&triad.platform());
        let path = Path::new(&mechanism);
        let mut solver = Solver::new(Arc::clone(&mechanism)).expect("the drivers match");
        match solver.assemble(&path) {
            Ok(_) => {
                let modes = solver.modes().expect("the estimates are numbers");
                assert!(modes.complete, "{:?}", triad.radii);
                assert_eq!(modes.others.len() + 1, expected, "{:?}", triad.radii);
            }
            Err(Error::NotAssembled { verdict, .. }) => {
                assert!(
                    matches!(verdict, Verdict::Impossible { .. }),
                    "{:?}",
                    triad.radii
                );
                assert_eq!(expected, 0, "{:?}", triad.radii);
            }
            Err(error) => panic!("{error}"),
        }
    }
    // Each answer that there is comes up, but for six, which are rare.
    assert!(
        counts[0] > 1 && counts[2] > 1 && counts[4] > 1,
        "{counts:?}"
    );
}

/// Stephenson's six-bar driven at the link that carries no loop of its own: three links carry a
/// triangle, and all angles are found together.
#[test]
fn a_coupled_six_bar_has_as_many_modes_as_its_circles_say() {
    let text = shipped_text("stephenson_six_bar").replace(
        r#"crank_angle = { coordinate = "angle", markers = ["ground.O2", "crank.O"], start = "90*deg" }"#,
        r#"output_drive = { coordinate = "angle", markers = ["ground.O6", "output.O"], start = "-130*deg" }"#,
    );
    let (sin, cos) = (-130_f64).to_radians().sin_cos();
    let (sin_60, cos_60) = 60_f64.to_radians().sin_cos();
    let triad = Triad {
        centres: [
            [0.0, 0.0],
            [0.08, 0.0],
            [0.0775 + 0.1 * cos, 0.1152 + 0.1 * sin],
        ],
        radii: [0.04, 0.1, 0.107],
        corners: [[0.0, 0.0], [0.1, 0.0], [0.1 * cos_60, 0.1 * sin_60]],
    };
    let expected = triad.count();
    assert!(expected >= 2 && expected.is_multiple_of(2));
    let modes = modes_of(&text);
    assert_eq!(modes.others.len() + 1, expected);
    assert!(modes.complete);
}

/// A knife edge on an arm meets a round cam of radius 1 in two places; of contours there is no
/// closed form, nor are there bounds.
#[test]
fn modes_without_a_proof_are_said_to_be_found() {
    let modes = modes_of(
        r#"
format = 1
name = "arm"
[ground.markers]
O = [0, 0]
P = [1.5, 0]
[bodies.cam]
markers = { O = [0, 0] }
[bodies.arm]
markers = { P = [0, 0], tip = [1, 0] }
estimate = [1.5, 0, 2]
[joints]
O = { type = "revolute", markers = ["ground.O", "cam.O"] }
P = { type = "revolute", markers = ["ground.P", "arm.P"] }
contact = { type = "cam", markers = ["cam.O", "arm.tip"], follower = "knife", profile = "1 + 0*theta" }
[drivers]
angle = { coordinate = "angle", markers = ["ground.O", "cam.O"], start = 0 }
"#,
    );
    assert_eq!(modes.others.len(), 1);
    assert!(!modes.complete && modes.starts > 8);
}

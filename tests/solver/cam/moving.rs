//! Parameters that move in the contour of a cam and in the table of a motion: one step follows the
//! motion of many tiny ones, or stops where they stop.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use biela::kinematics::{Blocked, DriverPath, Path, Progress, Solver};

use crate::common::{assembled, parse};

/// A follower of a kind on an arm, on a cam of this profile; the parameters are r0, a and c.
fn arm(follower: &str, profile: &str, [r0, a, c]: [f64; 3]) -> String {
    format!(
        "format = 1\nname = 'cam'\n[parameters]\nr0 = {{ value = {r0}, tunable = true }}\n\
         a = {{ value = {a}, tunable = true }}\nc = {{ value = {c}, tunable = true }}\n\
         [ground.markers]\nO = [0, 0]\nG = [0.13, 0.03]\n[bodies.cam]\nmarkers = {{ O = [0, 0] }}\n\
         estimate = [0, 0, 0.6]\n[bodies.arm]\nmarkers = {{ G = [0, 0], T = [0.106, 0] }}\n\
         estimate = [0.13, 0.03, 3.6]\n[joints]\n\
         O = {{ type = 'revolute', markers = ['ground.O', 'cam.O'] }}\n\
         G = {{ type = 'revolute', markers = ['ground.G', 'arm.G'] }}\n\
         k = {{ type = 'cam', markers = ['cam.O', 'arm.T'], follower = {follower}, \
         profile = {profile} }}\n[drivers]\n\
         u = {{ coordinate = 'angle', markers = ['ground.O', 'cam.O'], start = 0.6 }}\n"
    )
}

/// Moves the parameters and the driver in equal steps. Returns the part of the way reached, and the
/// work.
fn go_to(solver: &mut Solver, to: &[f64], u: f64, steps: u32) -> (f64, Progress, Option<Blocked>) {
    let mechanism = std::sync::Arc::clone(solver.mechanism());
    let mut path = Path::new(&mechanism);
    let start = solver.pose().clone();
    let mut most = Progress::default();
    for step in 1..=steps {
        let s = f64::from(step) / f64::from(steps);
        path.start = solver.pose().time;
        path.from.clone_from(&solver.pose().parameters);
        for (k, to) in to.iter().enumerate() {
            path.to[k] = start.parameters[k] + s * (to - start.parameters[k]);
        }
        for (k, driver_path) in path.driver_paths.iter_mut().enumerate() {
            if let DriverPath::Input { .. } = driver_path {
                let from = start.drivers[k];
                *driver_path = DriverPath::held(from + s * (u - from), solver.pose().drivers[k]);
            }
        }
        let tracked = solver.track(&path);
        let progress = match &tracked {
            Ok(progress) => *progress,
            Err(blocked) => blocked.progress,
        };
        most.substeps = most.substeps.max(progress.substeps);
        most.checked += progress.checked;
        if let Err(blocked) = tracked {
            let s = (f64::from(step - 1) + blocked.s) / f64::from(steps);
            return (s, most, Some(blocked));
        }
    }
    (1.0, most, None)
}

/// Two changes of a profile: next to a fold, which the follower passes, and over a fold, where it
/// jams. The truth is one equation in the arm's angle, by Newton's method at 400,000 places and at
/// the fold itself.
#[test]
fn a_step_does_not_pass_over_a_fold() {
    let start = [0.05, 0.010529687682642515, 1.3709931003382425];
    let text = arm("'knife'", "'r0 + a*cos(4*(theta - c))'", start)
        .replace("[0.13, 0.03", "[0.1306659704604168, 0.027171651264110995")
        .replace("[0.106, 0]", "[0.10606830320554927, 0]")
        .replace("0.6]", "0.5930226871533847]")
        .replace("3.6]", "3.5982535216581715]")
        .replace("start = 0.6 ", "start = 0.5930226871533847 ");
    let (r0, u) = (0.051902527316741866, 0.6105862313710353);
    let before = [r0, 0.016967936749062145, 1.4346068716084408];
    for steps in [1, 2, 7, 50] {
        for (a, place) in [(0.01826493439953437, 1.0), (0.02, 0.8305321406)] {
            let (mut solver, _) = assembled(&parse(&text));
            let (reached, ..) = go_to(&mut solver, &before, u, 1);
            assert!(reached >= 1.0, "{reached}");
            let after = [r0, a, -0.40664534365420524];
            let (reached, work, blocked) = go_to(&mut solver, &after, u, steps);
            // The motion slows down in front of a fold as the root of the distance.
            assert!(
                (reached - place).abs() < 1e-6,
                "{steps}, {a}: {reached} {blocked:?}"
            );
            assert_eq!(work.checked, 0, "{steps}, {a}");
            if reached >= 1.0 {
                let phi = solver.pose().q[5];
                assert!((phi - 3.554430704655038).abs() < 1e-11, "{steps}: {phi}");
            }
        }
    }
}

/// Contours by expressions, with pieces, by tables and by laws, under all followers: one step ends
/// where many do.
#[test]
fn one_step_ends_where_many_do() {
    let mut table = String::new();
    for k in 0..12 {
        let theta = f64::from(k) * TAU / 12.0;
        let _ = write!(
            table,
            "['{theta} + 0.1*c', 'r0 + a*{}'], ",
            (2.0 * theta).cos()
        );
    }
    let table = table.trim_end_matches(", ");
    let rises =
        "['0.3 + 0.1*c', 'r0'], ['1.5 + 0.2*c', 'r0 + a'], ['3 + 0.1*c', 'r0 + 2*a'], [5, 'r0']";
    let profiles = [
        "'r0 + a*cos(2*(theta - c))'".to_owned(),
        "'sqrt(r0^2 - (a*sin(theta - c))^2) + a*cos(theta - c)'".to_owned(),
        "'r0 + a*exp((cos(theta - c) - 1)/0.003)'".to_owned(),
        "'r0 + a*max(0, cos(theta - c))^2'".to_owned(),
        "'r0 + a*max(0, cos(theta - c))^4'".to_owned(),
        "'r0 + a*abs(sin(theta - c))^3'".to_owned(),
        format!("{{ table = [{table}] }}"),
        format!("{{ table = [{rises}], law = 'cycloidal' }}"),
        format!("{{ table = [{rises}], law = 'harmonic' }}"),
        format!("{{ table = [{rises}], law = 'modified_trapezoidal' }}"),
    ];
    let mut refused = 0;
    for profile in &profiles {
        for follower in ["'knife'", "'roller', radius = 0.01", "'flat'"] {
            let text = arm(follower, profile, [0.05, 0.003, 0.4]);
            let (mechanism, what) = (parse(&text), format!("{follower}, {profile}"));
            for (to, u) in [([0.055, 0.004, 2.0], 0.6), ([0.045, 0.005, -1.0], 1.6)] {
                let (mut whole, _) = assembled(&mechanism);
                let (mut tiny, _) = assembled(&mechanism);
                let (reached, work, why) = go_to(&mut whole, &to, u, 1);
                let (truth, ..) = go_to(&mut tiny, &to, u, 12);
                assert_eq!(work.checked, 0, "{what}");
                assert!(
                    (reached - truth).abs() < 1e-4,
                    "{what}: {reached} {truth} {why:?}"
                );
                refused += u32::from(reached < 1.0);
                if reached < 1.0 {
                    continue;
                }
                assert!(work.substeps < 300, "{what}: {work:?}");
                for (whole, tiny) in whole.pose().q.iter().zip(&tiny.pose().q) {
                    // Rounding, over reciprocal conditions of a hundredth.
                    assert!((whole - tiny).abs() < 1e-11, "{what}: {whole} {tiny}");
                }
            }
        }
    }
    assert!(refused < 30, "{refused}");
}

/// Contours that are circles at both ends of the step and have a corner in between: one step stops
/// where many do, as the roller comes to the corner.
#[test]
fn one_step_stops_at_a_corner_between_its_ends() {
    for (shape, a) in [
        ("abs", 0.001),
        ("abs", 0.01),
        ("-abs", 0.001),
        ("-abs", 0.01),
    ] {
        let profile = format!("'r0 + a*c*(1 - c)*{shape}(sin(theta - 1))'");
        let text = arm("'roller', radius = 0.01", &profile, [0.05, a, 0.0]);
        for u in [-2.0, 4.0] {
            let follow = |steps: u32| {
                let (mut solver, _) = assembled(&parse(&text));
                go_to(&mut solver, &[0.05, a, 1.0], u, steps).0
            };
            let (whole, truth) = (follow(1), follow(12));
            assert!(truth < 0.9, "{shape}, {a}, to {u}: {truth}");
            // The stop is where the box of the proof touches the corner.
            assert!(
                (whole - truth).abs() < 1e-9,
                "{shape}, {a}: {whole} {truth}"
            );
        }
    }
}

/// The table of a prescribed motion moves while it runs: the value is that of the table at the end.
#[test]
fn tables_of_motions_are_proved() {
    for rest in [
        "",
        ", law = 'cycloidal'",
        ", law = 'trapezoidal'",
        ", ends = 'periodic'",
    ] {
        let text = format!(
            "format = 1\nname = 'm'\n[parameters]\nh = {{ value = 0.3, tunable = true }}\n\
             w = {{ value = 1, tunable = true }}\n[ground.markers]\nO = [0, 0]\nD = [0.4, 0]\n\
             [bodies.crank]\nmarkers = {{ O = [0, 0], A = [0.1, 0] }}\n[bodies.coupler]\n\
             markers = {{ A = [0, 0], B = [0.25, 0] }}\nestimate = [0.1, 0, 0.9]\n[bodies.rocker]\n\
             markers = {{ D = [0, 0], B = [0.3, 0] }}\nestimate = [0.4, 0, 2]\n[joints]\n\
             O = {{ type = 'revolute', markers = ['ground.O', 'crank.O'] }}\n\
             A = {{ type = 'revolute', markers = ['crank.A', 'coupler.A'] }}\n\
             B = {{ type = 'revolute', markers = ['coupler.B', 'rocker.B'] }}\n\
             D = {{ type = 'revolute', markers = ['ground.D', 'rocker.D'] }}\n[drivers]\n\
             u = {{ coordinate = 'angle', markers = ['ground.O', 'crank.O'], \
             motion = {{ table = [[0, 0], ['w', 'h'], ['2*w', '3*h'], [3, 0.5], [4, 0]]{rest} }} }}\n"
        );
        let mechanism = parse(&text);
        for (to, duration) in [([1.5, 1.2], 0.0), ([-0.6, 0.7], 2.3), ([0.9, 1.4], 3.7)] {
            let follow = |steps: u32| {
                let (mut solver, mut path) = assembled(&mechanism);
                let from = path.from.clone();
                let mut checked = 0;
                for step in 1..=steps {
                    let s = f64::from(step) / f64::from(steps);
                    path.start = solver.pose().time;
                    path.duration = s * duration - path.start;
                    path.from.clone_from(&solver.pose().parameters);
                    for (k, to) in to.iter().enumerate() {
                        path.to[k] = from[k] + s * (to - from[k]);
                    }
                    let tracked = solver.track(&path);
                    let progress = tracked.unwrap_or_else(|blocked| panic!("{rest}: {blocked:?}"));
                    checked += progress.checked;
                }
                assert_eq!(checked, 0, "{rest}");
                solver.pose().q.clone()
            };
            let (whole, tiny) = (follow(1), follow(300));
            for (whole, tiny) in whole.iter().zip(&tiny) {
                assert!((whole - tiny).abs() < 1e-12, "{rest}: {whole} {tiny}");
            }
        }
    }
}

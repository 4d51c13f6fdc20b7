//! Freedoms without inertia, and coordinates that meet their dead points.

use biela::dynamics::Error;
use biela::mechanism::Jet;

use super::lagrange::{FOUR_BAR, four_bar_kinematics, torque_input};
use super::run::{Fed, Run, times};
use super::taylor::Taylor;
use crate::common::{folder, parse};

/// Returns the names in the refusal of a mechanism whose freedoms move no mass.
fn refused(text: &str) -> Vec<String> {
    match Run::try_new(&parse(text), 1e-8, Fed::default()) {
        Err(Error::NoInertia { freedoms }) => freedoms,
        Err(other) => panic!("{other}"),
        Ok(run) => panic!("it moves: {:?}", run.freedoms()),
    }
}

/// Two rods in a row; `upper` and `lower` are lines of their masses.
fn two_rods(upper: &str, lower: &str, elbow: f64) -> String {
    format!(
        "format = 1\nname = \"rods\"\n[ground.markers]\nO = [0, 0, \"-90*deg\"]\n\
         [bodies.upper]\nmarkers = {{ O = [0, 0], A = [1, 0] }}\nestimate = [0, 0, \"-90*deg\"]\n\
         {upper}\n[bodies.lower]\nmarkers = {{ A = [0, 0], P = [1, 0] }}\n\
         estimate = [0, -1, \"-90*deg\"]\n{lower}\n\
         [joints]\nO = {{ type = \"revolute\", markers = [\"ground.O\", \"upper.O\"] }}\n\
         A = {{ type = \"revolute\", markers = [\"upper.A\", \"lower.A\"] }}\n\
         [freedoms]\n\
         shoulder = {{ coordinate = \"angle\", markers = [\"ground.O\", \"upper.O\"], start = 0 }}\n\
         elbow = {{ coordinate = \"angle\", markers = [\"upper.A\", \"lower.A\"], start = {elbow} }}\n"
    )
}

#[test]
fn a_freedom_that_moves_no_mass_is_refused() {
    let bar = "mass = 1\ncenter = [0.5, 0]";
    let names = refused(&two_rods(bar, "", 0.3));
    assert_eq!(names, ["freedom `elbow`"]);
    // A point mass on the elbow itself.
    let names = refused(&two_rods(bar, "mass = 1", 0.3));
    assert_eq!(names, ["freedom `elbow`"]);
}

/// One point mass at the end of two rods in one line: no motion along the line.
#[test]
fn a_singular_mass_matrix_is_refused() {
    let names = refused(&two_rods("", "mass = 1\ncenter = [1, 0]", 0.0));
    assert_eq!(names, ["freedom `elbow`"]);
}

/// A point mass at the end of two massless rods flies on a parabola until the rods are stretched;
/// there its velocity would have to jump. It follows the parabola to that point and goes no further.
#[test]
fn a_mass_flies_until_its_rods_are_stretched() {
    let elbow: f64 = 2.0;
    let mechanism = parse(&two_rods("", "mass = 1\ncenter = [1, 0]", elbow));
    let mut run = Run::new(&mechanism, 1e-6, Fed::default());
    // From rest at x = sin 2, y = −1 − cos 2: the distance from the pivot is 2 at this time.
    let (x, y) = (elbow.sin(), -1.0 - elbow.cos());
    let depth = (4.0 - x * x).sqrt();
    let stretched = ((depth + y) / (0.5 * 9.81)).sqrt();
    for time in times(1.2 * stretched, 24) {
        match run.try_to(time) {
            Ok(()) => {
                assert!(time < stretched, "beyond the stretched position");
                let [z, ..] = run.freedoms();
                let found = [
                    z[0].sin() + (z[0] + z[1]).sin(),
                    -z[0].cos() - (z[0] + z[1]).cos(),
                ];
                let fallen = y - 0.5 * 9.81 * time * time;
                // The host's tolerance times the growth of errors near the stretched position.
                assert!((found[0] - x).abs() < 1e-5, "at {time}: {found:?}");
                assert!((found[1] - fallen).abs() < 1e-5, "at {time}: {found:?}");
            }
            Err(error) => {
                let at = run.solver.pose().time;
                println!(
                    "| stretched rods | stopped {:.1e} s before: {error} | {:?} |",
                    stretched - at,
                    run.statistics()
                );
                assert!(
                    at <= stretched + 1e-9,
                    "stopped at {at}, stretched at {stretched}"
                );
                assert!(stretched - at < 1e-2, "stopped early, at {at}");
                return;
            }
        }
    }
    panic!("it goes on");
}

/// The shipped four-bar with another freedom.
pub(super) fn four_bar_with(markers: &str, start: f64, velocity: f64) -> String {
    let path = folder("mechanisms").join("four_bar_free.toml");
    let text = std::fs::read_to_string(path).expect("it is shipped");
    let begin = text.find("crank_angle = ").expect("its freedom");
    let end = begin + text[begin..].find('\n').expect("a line");
    format!(
        "{}other = {{ coordinate = \"angle\", markers = {markers}, start = {start:?}, \
         velocity = {velocity:?} }}{}",
        &text[..begin],
        &text[end..]
    )
}

/// The rocker's angle is the freedom; the crank turns at 12 rad/s and takes the rocker to its
/// extreme position. From there on the rocker's angle says nothing about the crank. The mechanism
/// goes on rightly or stops with an error: each pose that it reaches is on the true motion, to the
/// square root of the tolerance near the extreme position.
#[test]
fn a_rocker_at_its_dead_point_goes_on_rightly_or_stops() {
    let start = 60.0_f64.to_radians();
    let (_, coupler, rocker) = four_bar_kinematics(Taylor::new(start, 12.0, 0.0));
    for (name, markers, at) in [
        ("rocker", "[\"ground.O4\", \"rocker.O\"]", rocker),
        ("coupler", "[\"ground.O2\", \"coupler.A\"]", coupler),
    ] {
        let mechanism = parse(&four_bar_with(markers, at.value, at.first));
        for tolerance in [1e-6, 1e-10] {
            let mut run = Run::new(&mechanism, tolerance, torque_input());
            let times = times(1.5, 60);
            let exact = FOUR_BAR.motion(&[start, 12.0], &times);
            let largest_energy = 0.5 * 0.012 * 144.0;
            let (mut largest, mut stopped) = (0.0_f64, None);
            for (time, exact) in times.iter().zip(&exact) {
                if let Err(error) = run.try_to(*time) {
                    stopped = Some((run.solver.pose().time, error.to_string()));
                    break;
                }
                let crank = run.solver.pose().q[2];
                let off = (0.5 * (crank - exact[0])).sin().abs();
                largest = largest.max(off);
            }
            println!(
                "| {name} as freedom {tolerance:e} | {largest:.1e} | energy {:.1e} J | {stopped:?} \
                 | {:?} |",
                run.energy_error,
                run.statistics()
            );
            assert!(largest < 10.0 * f64::sqrt(tolerance), "{name}: {largest}");
            assert!(run.energy_error < 1e-2 * largest_energy, "{name}");
        }
    }
}

/// A jump of an input that is refused leaves the motion as it was.
#[test]
fn a_jump_without_a_way_leaves_the_motion() {
    // A crank of 0.2 m that is driven by its height, with a free arm.
    let path = folder("mechanisms").join("swinging_tip.toml");
    let text = std::fs::read_to_string(path).expect("it is shipped");
    let from = "coordinate = \"angle\", markers = [\"ground.O\", \"crank.O\"], \
                motion = \"sway*sin(frequency*t)\"";
    let to = "coordinate = \"y\", markers = [\"ground.O\", \"crank.A\"], start = 0";
    assert!(text.contains(from));
    let mechanism = parse(&text.replace(from, to));
    let held = Fed {
        driver: |_, _| Jet::constant(0.0),
        ..Fed::default()
    };
    let beyond = Fed {
        driver: |_, _| Jet::constant(0.3),
        ..held
    };
    let mut straight = Run::new(&mechanism, 1e-8, held);
    let mut detour = Run::new(&mechanism, 1e-8, held);
    for run in [&mut straight, &mut detour] {
        run.to(0.4);
    }
    let parameters = detour.solver.pose().parameters.clone();
    let Run { solver, free, .. } = &mut detour;
    assert!(free.jump(solver, &beyond, &parameters).is_err());
    for run in [&mut straight, &mut detour] {
        run.to(0.9);
    }
    assert_eq!(detour.state(), straight.state());
    assert_eq!(detour.solver.pose(), straight.solver.pose());
}
